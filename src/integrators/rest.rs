//! Active set of wall contacts in an implicit step.

use super::{
    Dynamics, Work,
    axes::{self, Axis, pair, put},
    implicit::{Affine, PARTS, holds, predict},
    parts,
};
use crate::state::State;

/// What walls do to what was held at them from the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Walls {
    /// All of them push: what was solved for is the step.
    Push,
    /// They may pull: to be solved again.
    Pull,
    /// Nothing is held, or there is no telling.
    Other,
}

/// A wall may pull by so small a share of the greatest push: that is round-off, and what the solution is off.
const ROUND_OFF: f64 = 1e-6;

/// Holds what touches a smooth wall where the step begins, and is pressed to it by the forces there. If anything is,
/// the accelerations make it stay, the step is one of implicit Euler if the scheme does not end at its stage, and it is for [`release`]
/// to say whether that can be.
pub(super) fn hold(system: &mut dyn Dynamics, state: &State, work: &mut Work, (affine, h): (Affine, f64)) -> Walls {
    if system.grips() || !system.constrains() {
        return Walls::Other;
    }
    let Work { numbers, spare, axes, pushes, .. } = work;
    let [predicted_x, predicted_v, _, v, z, inverse, end_x, end_v, _] = parts::<PARTS>(numbers, state.x.len());
    system.force(&state.x, &state.v, v);
    for (((v, before), inverse), end) in v.iter_mut().zip(&state.v).zip(&*inverse).zip(&mut *end_v) {
        *v = if *inverse == 0.0 { 0.0 } else { before + h * *v * inverse };
        *end = *v;
    }
    if !system.rest([&state.x, &state.v], end_x, end_v) {
        return Walls::Other;
    }
    // As it would have been without the walls: velocities, then positions.
    spare.clear();
    spare.extend(v.iter().chain(&state.x));
    pushes.clear();
    pushes.resize(state.x.len(), 0.0);
    let mut rests = false;
    for vertex in 0..state.x.len() / 2 {
        let [end, free] = [&*end_v, &*v].map(|v| pair(v, vertex));
        let stays = pair(end_x, vertex) == pair(&state.x, vertex) && is_stopped(end, free);
        if !stays || !axes::hold(vertex, (axes, inverse, z), [&*end_x, &*end_v], spare, true) {
            continue;
        }
        rests = true;
        let push = Axis::of(axes, vertex).into_own(axes::less(end, free));
        let held = holds(inverse, system.inverse_mass(), vertex);
        put(pushes, vertex, [0, 1].map(|k| if held[k] { push[k] } else { 0.0 }));
    }
    if !rests {
        return Walls::Other;
    }
    let affine = if affine.end == 1.0 {
        affine
    } else {
        predict(system, state, [&mut *predicted_x, &mut *predicted_v], h);
        Affine::euler(h)
    };
    for vertex in 0..state.x.len() / 2 {
        let stay = Axis::of(axes, vertex).into_own(axes::less(pair(&state.x, vertex), pair(predicted_x, vertex)));
        let held = holds(inverse, system.inverse_mass(), vertex);
        put(z, vertex, [0, 1].map(|k| if held[k] { stay[k] / affine.ax } else { 0.0 }));
    }
    Walls::Pull
}

/// Whether what took from a velocity left nothing of it across: a bounce leaves some, and so does most of what stops an edge.
fn is_stopped(end: [f64; 2], free: [f64; 2]) -> bool {
    let change = axes::less(end, free);
    axes::dot(end, change).abs() <= ROUND_OFF * axes::dot(change, change)
}

/// Lets go what [`hold`] held where `M z - f`, which the wall does to hold it, points into the wall; and with it whatever came to be
/// held while that was.
pub(super) fn release(system: &mut dyn Dynamics, work: &mut Work) -> Walls {
    let Work { numbers, axes, pushes, .. } = work;
    let [_, _, x, v, z, inverse, _, _, force] = parts::<PARTS>(numbers, pushes.len());
    system.force(x, v, force);
    axes::turn(axes, force);
    let reactions = force.iter_mut().zip(system.mass()).zip(&*z).zip(&*pushes);
    for (((force, mass), z), push) in reactions {
        *force = if *push == 0.0 { 0.0 } else { (mass * z - *force) * push.signum() };
    }
    let most = force.iter().copied().fold(0.0, f64::max);
    let pulls = |reaction: f64| reaction.is_nan() || reaction < -ROUND_OFF * most;
    let held = |inverse: &[f64], vertex| holds(inverse, system.inverse_mass(), vertex);
    let is_unclear = |vertex| {
        // Which of two walls pushes, neither of which is along an axis, cannot be told.
        !Axis::of(axes, vertex).is_straight() && held(inverse, vertex) == [true; 2] && pair(pushes, vertex) != [0.0; 2]
    };
    if (0..pushes.len() / 2).any(is_unclear) {
        return Walls::Other;
    }
    if !force.iter().copied().any(pulls) {
        return Walls::Push;
    }
    for vertex in 0..pushes.len() / 2 {
        let (held, reaction, push) = (held(inverse, vertex), pair(force, vertex), pair(pushes, vertex));
        let goes = [0, 1].map(|k| held[k] && (push[k] == 0.0 || pulls(reaction[k])));
        if goes == [false; 2] {
            continue;
        }
        put(z, vertex, Axis::of(axes, vertex).out_of_own(pair(z, vertex)));
        axes::straighten_one(axes, vertex);
        for k in (0..2).filter(|k| goes[*k]) {
            inverse[2 * vertex + k] = system.inverse_mass()[2 * vertex + k];
            pushes[2 * vertex + k] = 0.0;
        }
    }
    Walls::Pull
}

/// Whether any wall holds anything.
pub(super) fn is_held(system: &dyn Dynamics, work: &mut Work) -> bool {
    let numbers = work.pushes.len();
    let [_, _, _, _, _, inverse, ..] = parts::<PARTS>(&mut work.numbers, numbers);
    inverse.iter().zip(system.inverse_mass()).any(|(inverse, inverse_mass)| inverse != inverse_mass)
}

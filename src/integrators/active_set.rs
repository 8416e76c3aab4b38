//! Active set of wall contacts in an implicit step.

use super::{
    Dynamics, Workspace,
    axes::{self, Axis, pair, put},
    implicit::{Affine, PARTS, constrained_axes, predict},
    parts,
};
use crate::state::State;

/// Wall reactions of the active set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum WallReactions {
    /// All reactions push: the solution is the step.
    Push,
    /// Some may pull: solve again.
    Pull,
    /// The set is empty, or the reactions cannot be determined.
    Other,
}

/// Greatest pull as a fraction of the greatest push: round-off and error of the solution.
const ROUND_OFF: f64 = 1e-6;

/// Adds vertices to the active set that touch a smooth wall at the start of the step and are pressed to it by the
/// forces there. If there are any, their accelerations keep them in place, the step is one of implicit Euler if the
/// scheme does not end at its stage, and [`drop_pulling`] checks the reactions.
pub(super) fn add_resting(
    system: &mut dyn Dynamics,
    state: &State,
    workspace: &mut Workspace,
    (affine, h): (Affine, f64),
) -> WallReactions {
    if system.has_friction() || !system.constrains() {
        return WallReactions::Other;
    }
    let Workspace { numbers, spare, axes, pushes, .. } = workspace;
    let [predicted_x, predicted_v, _, v, z, inverse, end_x, end_v, _] = parts::<PARTS>(numbers, state.x.len());
    system.force(&state.x, &state.v, v);
    for (((v, before), inverse), end) in v.iter_mut().zip(&state.v).zip(&*inverse).zip(&mut *end_v) {
        *v = if *inverse == 0.0 { 0.0 } else { before + h * *v * inverse };
        *end = *v;
    }
    if !system.project_contact_velocity([&state.x, &state.v], end_x, end_v) {
        return WallReactions::Other;
    }
    // Prediction without walls: velocities, then positions.
    spare.clear();
    spare.extend(v.iter().chain(&state.x));
    pushes.clear();
    pushes.resize(state.x.len(), 0.0);
    let mut rests = false;
    for vertex in 0..state.x.len() / 2 {
        let [end, predicted] = [&*end_v, &*v].map(|v| pair(v, vertex));
        let stays = pair(end_x, vertex) == pair(&state.x, vertex) && is_stopped(end, predicted);
        if !stays || !axes::add_constraint(vertex, (axes, inverse, z), [&*end_x, &*end_v], spare, true) {
            continue;
        }
        rests = true;
        let push = Axis::of(axes, vertex).into_own(axes::less(end, predicted));
        let constrained = constrained_axes(inverse, system.inverse_mass(), vertex);
        put(pushes, vertex, [0, 1].map(|k| if constrained[k] { push[k] } else { 0.0 }));
    }
    if !rests {
        return WallReactions::Other;
    }
    let affine = if affine.end == 1.0 {
        affine
    } else {
        predict(system, state, [&mut *predicted_x, &mut *predicted_v], h);
        Affine::euler(h)
    };
    for vertex in 0..state.x.len() / 2 {
        let stay = Axis::of(axes, vertex).into_own(axes::less(pair(&state.x, vertex), pair(predicted_x, vertex)));
        let constrained = constrained_axes(inverse, system.inverse_mass(), vertex);
        put(z, vertex, [0, 1].map(|k| if constrained[k] { stay[k] / affine.ax } else { 0.0 }));
    }
    WallReactions::Pull
}

/// Whether a velocity change leaves no normal component: an impact with restitution leaves some, and so do most edge
/// contacts.
fn is_stopped(end: [f64; 2], predicted: [f64; 2]) -> bool {
    let change = axes::less(end, predicted);
    axes::dot(end, change).abs() <= ROUND_OFF * axes::dot(change, change)
}

/// Drops constraints of [`add_resting`] whose reaction `M z - f` pulls, and constraints that were added during the
/// solve.
pub(super) fn drop_pulling(system: &mut dyn Dynamics, workspace: &mut Workspace) -> WallReactions {
    let Workspace { numbers, axes, pushes, .. } = workspace;
    let [_, _, x, v, z, inverse, _, _, force] = parts::<PARTS>(numbers, pushes.len());
    system.force(x, v, force);
    axes::turn(axes, force);
    let reactions = force.iter_mut().zip(system.mass()).zip(&*z).zip(&*pushes);
    for (((force, mass), z), push) in reactions {
        *force = if *push == 0.0 { 0.0 } else { (mass * z - *force) * push.signum() };
    }
    let most = force.iter().copied().fold(0.0, f64::max);
    let pulls = |reaction: f64| reaction.is_nan() || reaction < -ROUND_OFF * most;
    let constrained = |inverse: &[f64], vertex| constrained_axes(inverse, system.inverse_mass(), vertex);
    let is_unclear = |vertex| {
        // With two oblique walls the reaction of each cannot be determined.
        !Axis::of(axes, vertex).is_world()
            && constrained(inverse, vertex) == [true; 2]
            && pair(pushes, vertex) != [0.0; 2]
    };
    if (0..pushes.len() / 2).any(is_unclear) {
        return WallReactions::Other;
    }
    if !force.iter().copied().any(pulls) {
        return WallReactions::Push;
    }
    for vertex in 0..pushes.len() / 2 {
        let (constrained, reaction, push) = (constrained(inverse, vertex), pair(force, vertex), pair(pushes, vertex));
        let goes = [0, 1].map(|k| constrained[k] && (push[k] == 0.0 || pulls(reaction[k])));
        if goes == [false; 2] {
            continue;
        }
        put(z, vertex, Axis::of(axes, vertex).out_of_own(pair(z, vertex)));
        axes::reset_axis(axes, vertex);
        for k in (0..2).filter(|k| goes[*k]) {
            inverse[2 * vertex + k] = system.inverse_mass()[2 * vertex + k];
            pushes[2 * vertex + k] = 0.0;
        }
    }
    WallReactions::Pull
}

/// Whether any wall constrains a vertex.
pub(super) fn is_any_active(system: &dyn Dynamics, workspace: &mut Workspace) -> bool {
    let numbers = workspace.pushes.len();
    let [_, _, _, _, _, inverse, ..] = parts::<PARTS>(&mut workspace.numbers, numbers);
    inverse.iter().zip(system.inverse_mass()).any(|(inverse, inverse_mass)| inverse != inverse_mass)
}

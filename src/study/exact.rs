//! Closed-form solutions of scenes.

use super::{strip, trial::Trial};
use crate::{
    effects::{Grab, Motion},
    scene::Scene,
    state::State,
    toys::ToyKind,
};

/// Closed form of a scene from a given time on.
#[derive(Clone)]
pub struct ClosedForm {
    /// Description in plain words.
    pub words: String,
    /// Positions from which motion is measured, for relative errors [m].
    pub(super) origin: Vec<f64>,
    solution: Solution,
}

#[derive(Clone)]
enum Solution {
    /// Exact solution of a toy, from time 0.
    Toy(ToyKind),
    /// `place + u (rest + swing cos wt + way sin wt)` of one particle with the unit vector u; all other particles are
    /// fixed.
    Oscillator { since: f64, free: usize, place: [f64; 2], u: [f64; 2], rest: f64, swing: f64, way: f64, omega: f64 },
    /// `x0 + v t + g t²/2`.
    FreeFall { since: f64, v: [f64; 2], g: [f64; 2] },
    /// Positions at rest [m].
    Rest(Vec<f64>),
}

impl ClosedForm {
    /// Closed form of a trial, if it has one.
    pub(super) fn of_trial(trial: &Trial) -> Option<Self> {
        let start = State { memory: Vec::new(), ..trial.start.clone() };
        let toy = toy(&trial.scene).filter(|_| start == trial.scene.start);
        toy.or_else(|| motion(&trial.scene, &start, trial.grab))
    }

    /// Closed form for the error of a running scene, if one is known.
    /// It is the exact motion of a toy since its start, a motion from the present time on, or the shape of a strip at
    /// rest.
    pub fn of_running(scene: &Scene, state: &State, grab: Option<Grab>) -> Option<Self> {
        let rest = || {
            let (words, x) = strip::at_rest(scene, state).filter(|_| grab.is_none())?;
            Some(Self { words, origin: scene.rest.clone(), solution: Solution::Rest(x) })
        };
        toy(scene).or_else(|| motion(scene, state, grab)).or_else(rest)
    }

    /// Positions at a simulated time [m].
    pub fn positions(&self, time: f64) -> Vec<f64> {
        match &self.solution {
            Solution::Toy(toy) => toy.kind().exact(time).to_vec(),
            &Solution::Oscillator { since, free, place, u, rest, swing, way, omega } => {
                let (sine, cosine) = libm::sincos(omega * (time - since));
                let s = rest + swing * cosine + way * sine;
                let mut x = self.origin.clone();
                (x[free], x[free + 1]) = (place[0] + s * u[0], place[1] + s * u[1]);
                x
            }
            Solution::FreeFall { since, v, g } => {
                let t = time - since;
                let moved = [0, 1].map(|axis| v[axis] * t + 0.5 * g[axis] * t * t);
                self.origin.iter().zip(moved.iter().cycle()).map(|(x, moved)| x + moved).collect()
            }
            Solution::Rest(x) => x.clone(),
        }
    }
}

/// Whether the scene has only these effects and elements.
pub(super) fn only(scene: &Scene, names: &[&str]) -> bool {
    // A mouse spring without a grabbed vertex has no force.
    let known = |name: &str| name == "Mouse spring" || names.contains(&name);
    scene.effects.iter().all(|effect| known(effect.name()))
}

/// Exact solution of a toy.
fn toy(scene: &Scene) -> Option<ClosedForm> {
    let toy = scene.toy.clone()?;
    Some(ClosedForm {
        words: toy.kind().about().to_owned(),
        origin: scene.start.x.clone(),
        solution: Solution::Toy(toy),
    })
}

/// Oscillation or free fall from the given state on.
fn motion(scene: &Scene, start: &State, grab: Option<Grab>) -> Option<ClosedForm> {
    if grab.is_some() || start.x.is_empty() || start.v.len() != start.x.len() {
        return None;
    }
    oscillator(scene, start).or_else(|| free_fall(scene, start))
}

/// Oscillation of one particle along one spring: `s = s_e + (s0 - s_e) cos wt + v0/w sin wt`.
/// `w² = k/m` and `s_e = r + m g/k`. It holds as long as the particle does not reach the other end.
fn oscillator(scene: &Scene, start: &State) -> Option<ClosedForm> {
    let [net] = scene.nets.as_slice() else { return None };
    let ([link], [pin], true) = (net.springs.links(), scene.pins.as_slice(), scene.bodies.is_empty()) else {
        return None;
    };
    if start.x.len() != 4 || !only(scene, &["Springs", "Gravity"]) {
        return None;
    }
    let (fixed, free) = (2 * *pin as usize, 2 - 2 * *pin as usize);
    let d = [start.x[free] - start.x[fixed], start.x[free + 1] - start.x[fixed + 1]];
    let s0 = (d[0] * d[0] + d[1] * d[1]).sqrt();
    let u = [d[0] / s0, d[1] / s0];
    let along = |a: &[f64]| a[0] * u[0] + a[1] * u[1];
    let across = |a: &[f64]| (a[0] * u[1] - a[1] * u[0]).abs();
    let (a, v) = (acceleration(scene, start), &start.v[free..free + 2]);
    let straight = across(&a[free..]) <= 1e-12 * along(&a[free..]).abs() && across(v) <= 1e-12 * along(v).abs();
    let square = link.stiffness * scene.inverse_mass[free];
    // a = -w² (s0 - s_e): the acceleration at the start gives the position of rest.
    let (omega, swing) = (square.sqrt(), -along(&a[free..]) / square);
    let (rest, way) = (s0 - swing, along(v) / omega);
    if !straight || square <= 0.0 || rest <= (swing * swing + way * way).sqrt() {
        return None;
    }
    let place = [start.x[fixed], start.x[fixed + 1]];
    let solution = Solution::Oscillator { since: start.time, free, place, u, rest, swing, way, omega };
    let words = "harmonic oscillator, s_e + (s0 - s_e) cos wt + v0/w sin wt".to_owned();
    Some(ClosedForm { words, origin: start.x.clone(), solution })
}

/// Free fall of a body without stress under gravity alone: `x = x0 + v t + g t²/2`.
fn free_fall(scene: &Scene, start: &State) -> Option<ClosedForm> {
    if !only(scene, &["Elasticity", "Springs", "Gravity"]) || scene.inverse_mass.contains(&0.0) {
        return None;
    }
    let acceleration = acceleration(scene, start);
    let (g, v) = ([acceleration[0], acceleration[1]], [start.v[0], start.v[1]]);
    let size = g.iter().chain(&v).map(|value| value.abs()).fold(0.0, f64::max);
    let uniform = |values: &[f64], first: [f64; 2]| {
        values.chunks_exact(2).flatten().zip(first.iter().cycle()).all(|(a, b)| (a - b).abs() <= 1e-11 * size)
    };
    if size == 0.0 || !uniform(&acceleration, g) || !uniform(&start.v, v) {
        return None;
    }
    let solution = Solution::FreeFall { since: start.time, v, g };
    Some(ClosedForm { words: "free fall, x0 + v t + g t^2/2".to_owned(), origin: start.x.clone(), solution })
}

/// Force over mass, flat [m/s²].
fn acceleration(scene: &Scene, start: &State) -> Vec<f64> {
    let motion: Motion<'_> = scene.motion(start, None);
    let mut force = vec![0.0; start.x.len()];
    for effect in &scene.effects {
        effect.force(motion, &mut vec![0.0; effect.scratch()], &mut force);
    }
    force.iter().zip(&scene.inverse_mass).map(|(force, inverse_mass)| force * inverse_mass).collect()
}

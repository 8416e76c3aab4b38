//! Closed forms: trials whose solution is known.

use super::trial::Trial;
use crate::{effects::Motion, state::State};

/// The closed form of a trial in words, and the positions at the end of every frame.
pub(super) fn solution(trial: &Trial) -> Option<(&'static str, Vec<Vec<f64>>)> {
    toy(trial).or_else(|| oscillator(trial)).or_else(|| free_fall(trial))
}

/// Whether only these effects and elements act, and nothing is pulled.
fn only(trial: &Trial, names: &[&str]) -> bool {
    // A mouse spring that pulls nothing does nothing.
    let known = |name: &str| name == "Mouse spring" || names.contains(&name);
    trial.grab.is_none() && trial.scene.effects.iter().all(|effect| known(effect.name()))
}

/// A toy knows its own solution.
fn toy(trial: &Trial) -> Option<(&'static str, Vec<Vec<f64>>)> {
    let toy = trial.scene.toy.as_ref()?.kind();
    let start = State { memory: Vec::new(), ..trial.start.clone() };
    let at = |frame: u32| toy.exact(f64::from(frame) / 60.0).to_vec();
    (start == trial.scene.start).then(|| (toy.about(), (1..=trial.frames).map(at).collect()))
}

/// One particle on one spring that moves along it: `s = s_e + (s0 - s_e) cos wt + v0/w sin wt`, with `w² = k/m` and
/// `s_e = r + m g/k`, as long as it never reaches the other end.
fn oscillator(trial: &Trial) -> Option<(&'static str, Vec<Vec<f64>>)> {
    let (scene, start) = (&trial.scene, &trial.start);
    let [net] = scene.nets.as_slice() else { return None };
    let ([link], [pin], true) = (net.springs.links(), scene.pins.as_slice(), scene.bodies.is_empty()) else {
        return None;
    };
    if start.x.len() != 4 || !only(trial, &["Springs", "Gravity"]) {
        return None;
    }
    let (fixed, free) = (2 * *pin as usize, 2 - 2 * *pin as usize);
    let d = [start.x[free] - start.x[fixed], start.x[free + 1] - start.x[fixed + 1]];
    let s0 = (d[0] * d[0] + d[1] * d[1]).sqrt();
    let u = [d[0] / s0, d[1] / s0];
    let along = |a: &[f64]| a[0] * u[0] + a[1] * u[1];
    let across = |a: &[f64]| (a[0] * u[1] - a[1] * u[0]).abs();
    let (a, v) = (acceleration(trial), &start.v[free..free + 2]);
    let straight = across(&a[free..]) <= 1e-12 * along(&a[free..]).abs() && across(v) <= 1e-12 * along(v).abs();
    let square = link.stiffness * scene.inverse_mass[free];
    // a = -w² (s0 - s_e), so the place of rest follows from the acceleration at the start.
    let (omega, swing) = (square.sqrt(), -along(&a[free..]) / square);
    let (rest, speed) = (s0 - swing, along(v) / omega);
    if !straight || square <= 0.0 || rest <= (swing * swing + speed * speed).sqrt() {
        return None;
    }
    let at = |frame: u32| {
        let (sine, cosine) = libm::sincos(omega * f64::from(frame) / 60.0);
        let s = rest + swing * cosine + speed * sine;
        let mut x = start.x.clone();
        (x[free], x[free + 1]) = (x[fixed] + s * u[0], x[fixed + 1] + s * u[1]);
        x
    };
    Some(("harmonic oscillator, s_e + (s0 - s_e) cos wt + v0/w sin wt", (1..=trial.frames).map(at).collect()))
}

/// A body without stress under gravity alone moves as one: `x = x0 + v t + g t²/2`.
fn free_fall(trial: &Trial) -> Option<(&'static str, Vec<Vec<f64>>)> {
    let (scene, start) = (&trial.scene, &trial.start);
    if !only(trial, &["Elasticity", "Springs", "Gravity"]) || !scene.pins.is_empty() || start.v.len() != start.x.len() {
        return None;
    }
    let acceleration = acceleration(trial);
    let (g, v) = (acceleration.get(..2)?, start.v.get(..2)?);
    let size = g.iter().chain(v).map(|value| value.abs()).fold(0.0, f64::max);
    let uniform = |values: &[f64], first: &[f64]| {
        values.chunks_exact(2).flatten().zip(first.iter().cycle()).all(|(a, b)| (a - b).abs() <= 1e-11 * size)
    };
    if size == 0.0 || !uniform(&acceleration, g) || !uniform(&start.v, v) {
        return None;
    }
    let place = |frame: u32| {
        let t = f64::from(frame) / 60.0;
        let moved = [0, 1].map(|axis| v[axis] * t + 0.5 * g[axis] * t * t);
        start.x.iter().zip(moved.iter().cycle()).map(|(x, moved)| x + moved).collect()
    };
    Some(("free fall, x0 + v t + g t^2/2", (1..=trial.frames).map(place).collect()))
}

/// Force over mass at the start, flat [m/s²].
fn acceleration(trial: &Trial) -> Vec<f64> {
    let scene = &trial.scene;
    let motion: Motion<'_> = scene.motion(&trial.start, trial.grab);
    let mut force = vec![0.0; trial.start.x.len()];
    for effect in &scene.effects {
        effect.force(motion, &mut vec![0.0; effect.scratch()], &mut force);
    }
    force.iter().zip(&scene.inverse_mass).map(|(force, inverse_mass)| force * inverse_mass).collect()
}

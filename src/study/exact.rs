//! Closed forms: trials whose solution is known.

use super::trial::Trial;
use crate::effects::Motion;

/// The closed form of a trial in words, and the positions at the end of every frame.
pub(super) fn solution(trial: &Trial) -> Option<(&'static str, Vec<Vec<f64>>)> {
    free_fall(trial)
}

/// A body without stress under gravity alone moves as one: `x = x0 + v t + g t²/2`.
fn free_fall(trial: &Trial) -> Option<(&'static str, Vec<Vec<f64>>)> {
    let (scene, start) = (&trial.scene, &trial.start);
    let others =
        scene.effects.iter().filter(|effect| !["Elasticity", "Mouse spring", "Gravity"].contains(&effect.name()));
    if others.count() > 0 || trial.grab.is_some() || !scene.pins.is_empty() || start.v.len() != start.x.len() {
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

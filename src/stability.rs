//! How long a step may be: the highest natural frequency of a scene, by power iteration on the stiffness.

use crate::{scene::Scene, state::State};

/// The longest stable step of symplectic Euler near a state [s], or `None` if nothing is stiff there or the stiffness is
/// not a number.
///
/// Without damping a vibration of angular frequency w is stable for h < 2/w. With a damping rate c = alpha + beta w² taken
/// at the old velocity, the characteristic polynomial `z² - (2 - h c - h² w²) z + (1 - h c)` has both roots inside the
/// unit circle while `h² w² + 2 h c < 4`.
pub fn critical_step(scene: &Scene, state: &State) -> Option<f64> {
    let square = largest_eigenvalue(scene, state)?;
    let motion = scene.motion(state, None);
    let [alpha, beta] =
        scene.effects.iter().map(|effect| effect.damping(motion)).fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
    let rate = alpha + beta * square;
    let step = 4.0 / (rate + (rate * rate + 4.0 * square).sqrt());
    step.is_finite().then_some(step)
}

/// The largest eigenvalue of M⁻¹ K [1/s²], from below: K is the stiffness of all effects at the state.
///
/// Power iteration on the symmetric `M^(-1/2) K M^(-1/2)` from a fixed irregular start; 60 rounds leave an error of a few
/// per cent, and the Rayleigh quotient never overestimates.
pub fn largest_eigenvalue(scene: &Scene, state: &State) -> Option<f64> {
    let root: Vec<f64> = scene.inverse_mass.iter().map(|inverse| inverse.sqrt()).collect();
    let motion = scene.motion(state, None);
    let mut vector: Vec<f64> = (0..root.len() as u64).map(irregular).collect();
    let mut displacement = vec![0.0; root.len()];
    let mut product = vec![0.0; root.len()];
    let mut eigenvalue = 0.0;
    for _ in 0..60 {
        let norm = vector.iter().map(|value| value * value).sum::<f64>().sqrt();
        for ((displacement, vector), root) in displacement.iter_mut().zip(&mut vector).zip(&root) {
            *vector /= norm;
            *displacement = *vector * root;
        }
        product.fill(0.0);
        for effect in &scene.effects {
            effect.stiffness_times(motion, &displacement, &mut product);
        }
        eigenvalue = 0.0;
        for ((vector, product), root) in vector.iter_mut().zip(&product).zip(&root) {
            let next = product * root;
            eigenvalue += *vector * next;
            *vector = next;
        }
    }
    (eigenvalue.is_finite() && eigenvalue > 0.0).then_some(eigenvalue)
}

/// A fixed irregular sequence in [-1, 1): the high half of a 64-bit mix (Steele, Lea and Flood, *Fast splittable pseudorandom number generators*, 2014).
fn irregular(number: u64) -> f64 {
    let mut z = number.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 32) as f64 / f64::from(1_u32 << 31) - 1.0
}

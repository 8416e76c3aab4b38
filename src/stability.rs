//! How long a step may be: the highest natural frequency of a scene, by power iteration on the stiffness.

use crate::{scene::Scene, state::State};

/// The longest stable step of symplectic Euler near a state [s], or `None` if nothing is stiff there or the stiffness is
/// not a number.
///
/// Without damping a vibration of angular frequency w is stable for h < 2/w. With a damping rate c = alpha + beta w² taken
/// at the old velocity, the characteristic polynomial `z² - (2 - h c - h² w²) z + (1 - h c)` has both roots inside the
/// unit circle while `h² w² + 2 h c < 4`.
pub fn critical_step(scene: &Scene, state: &State) -> Option<f64> {
    StabilityProbe::default().refine(scene, state, 100)
}

/// The largest eigenvalue of M⁻¹ K [1/s²], from below, K the stiffness of all effects at the state.
pub fn largest_eigenvalue(scene: &Scene, state: &State) -> Option<f64> {
    StabilityProbe::default().largest_eigenvalue(scene, state, 100)
}

/// A search for the stiffest vibration that can be spread over many frames: it keeps what it found so far.
///
/// Power iteration on the symmetric `M^(-1/2) K M^(-1/2)`, K the stiffness of all effects, from a fixed irregular start. The
/// Rayleigh quotient never overestimates; after 100 rounds it is within about a per cent, and a state that moves a little
/// needs only a few rounds more.
#[derive(Clone, Debug, Default)]
pub struct StabilityProbe {
    /// The stiffest direction, of length 1, in coordinates weighted by the root of mass.
    vector: Vec<f64>,
    displacement: Vec<f64>,
    product: Vec<f64>,
}

impl StabilityProbe {
    /// Goes some rounds on at a state. Returns the longest stable step [s] as [`critical_step`] does, as far as it is known.
    pub fn refine(&mut self, scene: &Scene, state: &State, rounds: u32) -> Option<f64> {
        let square = self.largest_eigenvalue(scene, state, rounds)?;
        let motion = scene.motion(state, None);
        let dampings = scene.effects.iter().map(|effect| effect.damping(motion));
        let [alpha, beta] = dampings.fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
        let rate = alpha + beta * square;
        let step = 4.0 / (rate + (rate * rate + 4.0 * square).sqrt());
        step.is_finite().then_some(step)
    }

    /// The largest eigenvalue of M⁻¹ K [1/s²], from below.
    fn largest_eigenvalue(&mut self, scene: &Scene, state: &State, rounds: u32) -> Option<f64> {
        let count = scene.inverse_mass.len();
        if self.vector.len() != count || !self.vector.iter().all(|value| value.is_finite()) {
            self.vector = (0..count as u64).map(irregular).collect();
        }
        self.displacement.resize(count, 0.0);
        self.product.resize(count, 0.0);
        let motion = scene.motion(state, None);
        let mut eigenvalue = 0.0;
        for _ in 0..rounds {
            let norm = self.vector.iter().map(|value| value * value).sum::<f64>().sqrt();
            for ((displacement, vector), inverse) in
                self.displacement.iter_mut().zip(&mut self.vector).zip(&scene.inverse_mass)
            {
                *vector /= norm;
                *displacement = *vector * inverse.sqrt();
            }
            self.product.fill(0.0);
            for effect in &scene.effects {
                effect.stiffness_times(motion, &self.displacement, &mut self.product);
            }
            eigenvalue = 0.0;
            for ((vector, product), inverse) in self.vector.iter_mut().zip(&self.product).zip(&scene.inverse_mass) {
                let next = product * inverse.sqrt();
                eigenvalue += *vector * next;
                *vector = next;
            }
        }
        (eigenvalue.is_finite() && eigenvalue > 0.0).then_some(eigenvalue)
    }
}

/// A fixed irregular sequence in [-1, 1): the high half of a 64-bit mix (Steele, Lea and Flood, *Fast splittable pseudorandom number generators*, 2014).
fn irregular(number: u64) -> f64 {
    let mut z = number.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 32) as f64 / f64::from(1_u32 << 31) - 1.0
}

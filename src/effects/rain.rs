//! Effect: drops that fall on cloth.

use super::{
    Effect, EffectParameters, Motion, ZERO,
    air::{coordinates, faces},
};
use crate::{
    elements::Elements,
    quantity::{DropDuration, DropImpulse, DropRate, Quantity},
    random,
};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Drops that hit random points of random triangles of cloth in space, large and small ones as often, and push them down. A drop has the impulse J and acts for the time T with
///
/// `f(t) = J/T (1 - cos(2 pi t/T))`,
///
/// at the three corners by the barycentric coordinates of its point, so that the nearest corner gets most. Drops begin one after another, 1/r apart
/// on average. When and where is a function of the seed alone: a run can be saved, rewound and divided into other steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rain {
    /// r [1/s].
    pub rate: DropRate,
    /// J [N s].
    pub impulse: DropImpulse,
    /// T \[s\].
    #[serde(default = "twentieth")]
    pub duration: DropDuration,
    /// Number that chooses the drops: the same number gives the same rain.
    #[serde(default)]
    pub seed: u32,
}

const fn twentieth() -> DropDuration {
    DropDuration::literal(0.05)
}

impl Default for Rain {
    fn default() -> Self {
        Self { rate: DropRate::literal(50.0), impulse: DropImpulse::literal(1e-4), duration: twentieth(), seed: 0 }
    }
}

impl EffectParameters for Rain {
    fn title(&self) -> &'static str {
        "Rain"
    }

    fn about(&self) -> &'static str {
        "Drops hit random triangles of cloth: f = J/T (1 − cos(2πt/T)) downwards, shared by the three corners."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.rate, &mut self.impulse, &mut self.duration]
    }

    fn build(&self, elements: &Elements) -> Result<Box<dyn Effect>, String> {
        let (rate, impulse, duration) = (self.rate.get(), self.impulse.get(), self.duration.get());
        if !(impulse / duration).is_finite() || rate * duration > MOST {
            return Err(format!(
                "at most {MOST} drops may fall at a time, each for long enough to compute with; shorten the duration or the rate"
            ));
        }
        Ok(Box::new(Falling { faces: faces(elements)?, rate, impulse, duration, seed: self.seed }))
    }
}

/// Rain, built.
struct Falling {
    faces: Vec<[u32; 3]>,
    rate: f64,
    impulse: f64,
    duration: f64,
    seed: u32,
}

/// Most drops at a time.
const MOST: f64 = 1e5;

impl Falling {
    /// Calls `act` with the triangle, the shares of its corners, and the force \[N\] of each drop that acts at a time \[s\].
    fn each(&self, time: f64, mut act: impl FnMut(&[u32; 3], [f64; 3], f64)) {
        // Drop number k begins at (k + u)/r with a random u in [0, 1).
        let newest = libm::floor(time * self.rate);
        let count = libm::ceil(self.duration * self.rate).min(MOST) + 1.0;
        // At times so late that numbers of drops are rounded, some come twice.
        for offset in (0..=count as u64).rev() {
            let number = newest - offset as f64;
            if number < 0.0 {
                continue;
            }
            let mut random = random::stream(self.seed ^ (number as u64 as u32).wrapping_mul(0x9e37_79b9))
                .map(|one| 0.5 * (one + 1.0));
            let mut next = || random.next().unwrap_or_default();
            let age = time - (number + next()) / self.rate;
            if (0.0..self.duration).contains(&age) {
                let force = self.impulse / self.duration * (1.0 - libm::cos(TAU * age / self.duration));
                let face = (next() * self.faces.len() as f64) as usize;
                // Uniform over the triangle.
                let (along, across) = (next().sqrt(), next());
                let shares = [1.0 - along, along * (1.0 - across), along * across];
                if let Some(face) = self.faces.get(face) {
                    act(face, shares, force);
                }
            }
        }
    }
}

impl Effect for Falling {
    fn name(&self) -> &'static str {
        "Rain"
    }

    fn dimension(&self) -> Option<usize> {
        Some(3)
    }

    fn elements(&self, motion: Motion<'_>) -> usize {
        let mut count = 0;
        self.each(motion.time, |_, _, _| count += 1);
        count
    }

    fn idle(&self, _: Motion<'_>) -> Option<&'static str> {
        (self.impulse == 0.0 || self.rate == 0.0).then_some(ZERO)
    }

    fn couples_parts(&self) -> bool {
        true
    }

    fn is_steady(&self) -> bool {
        false
    }

    fn force(&self, motion: Motion<'_>, _: &mut [f64], force: &mut [f64]) {
        if self.rate == 0.0 {
            return;
        }
        self.each(motion.time, |face, shares, push| {
            for (corner, share) in face.iter().zip(shares) {
                force[3 * *corner as usize + 1] -= share * push;
            }
        });
    }

    fn supplies(&self) -> bool {
        true
    }

    fn supplied_power(&self, motion: Motion<'_>, _: &mut Vec<f64>) -> Option<f64> {
        let mut power = 0.0;
        if self.rate > 0.0 {
            self.each(motion.time, |face, shares, push| {
                for (corner, share) in face.iter().zip(shares) {
                    power -= share * push * coordinates(motion.v, *corner)[1];
                }
            });
        }
        Some(power)
    }
}

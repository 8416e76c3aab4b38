//! Sudden changes of velocities about a point: a push or a burst.

use crate::{scene::Scene, state::State};

/// A sudden change of the velocities of all vertices that are near a point.
///
/// With the vector `d` from the point to a vertex, its length `r` and the radius `R`, the velocity changes by
/// `(1 - r²/R²)² (push + burst d/R)` for `r < R`. So neighbours move together, on coarse and on fine meshes alike. Pinned vertices stay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impulse {
    /// The point \[m\]; in the plane its third coordinate is not used, here and below.
    pub centre: [f64; 3],
    /// R \[m\].
    pub radius: f64,
    /// Velocity that is the same for all [m/s].
    pub push: [f64; 3],
    /// Velocity away from the point [m/s].
    pub burst: f64,
}

impl Impulse {
    /// Radius of a push and of a burst, as a fraction of the diagonal of a scene.
    const RADII: [f64; 2] = [0.12, 0.5];

    /// Velocity of a push and of a burst, in diagonals of a scene a second [1/s].
    const RATES: [f64; 2] = [1.0, 6.0];

    /// A push along a unit vector, in a scene with a diagonal \[m\].
    pub fn push(centre: [f64; 3], along: [f64; 3], diagonal: f64) -> Self {
        let push = along.map(|part| Self::RATES[0] * diagonal * part);
        Self { centre, radius: Self::RADII[0] * diagonal, push, burst: 0.0 }
    }

    /// A burst in a scene with a diagonal \[m\].
    pub fn burst(centre: [f64; 3], diagonal: f64) -> Self {
        let (radius, burst) = (Self::RADII[1] * diagonal, Self::RATES[1] * diagonal);
        Self { centre, radius, push: [0.0; 3], burst }
    }

    /// Whether all its numbers are finite, and its radius is positive.
    pub fn is_valid(&self) -> bool {
        let numbers = self.centre.iter().chain(&self.push).chain([&self.radius, &self.burst]);
        numbers.into_iter().all(|number| number.is_finite()) && self.radius > 0.0
    }

    /// Changes the velocities of a state of a scene.
    pub fn give(&self, scene: &Scene, state: &mut State) {
        let size = scene.dimension;
        let vertices = state.x.chunks_exact(size).zip(state.v.chunks_exact_mut(size));
        for ((x, v), inverse_mass) in vertices.zip(scene.inverse_mass.chunks_exact(size)) {
            let d: [f64; 3] =
                std::array::from_fn(|axis| x.get(axis).map_or(0.0, |x| x - self.centre[axis]) / self.radius);
            let left = (1.0 - d.iter().map(|d| d * d).sum::<f64>()).max(0.0);
            for (axis, v) in v.iter_mut().enumerate().filter(|(axis, _)| inverse_mass[*axis] > 0.0) {
                *v += left * left * (self.push[axis] + self.burst * d[axis]);
            }
        }
    }
}

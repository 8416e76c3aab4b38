//! Estimated error of the stress of each triangle.
//!
//! The stress of linear triangles jumps from one to the next, where the true one is continuous. The *recovered* stress P* is continuous: at each vertex
//! it is the mean of the first Piola-Kirchhoff stresses P of its triangles, weighted by their volumes, and it is linear in between. It is
//! nearer to the true stress, so that `∫ |P* - P|² dV` estimates the square of the error in each triangle. With the differences d1, d2, d3 at
//! its corners that is `V/12 (|d1|² + |d2|² + |d3|² + |d1 + d2 + d3|²)`. Source: Zienkiewicz and Zhu, *A simple error estimator and adaptive
//! procedure for practical engineering analysis*, International Journal for Numerical Methods in Engineering 24, 1987.
//!
//! It is chosen over hierarchical estimates, which solve for the displacements of more nodes, as it needs the present shape alone: no
//! equilibrium and no second mesh. Each body and each membrane is a material of its own, across whose border no mean is taken. Elements of
//! six nodes count as the four triangles that they are divided into.

use super::Scene;

/// Estimated errors of the stress of all triangles: of the bodies, then of the membranes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StressErrors {
    /// `∫ |P* - P|² dV` of each triangle \[Pa² m³\].
    pub squares: Vec<f64>,
    /// `∫ |P|² dV` of all triangles together \[Pa² m³\].
    pub stress_squared: f64,
    /// Sums of the squares up to this count as zero: they are round-off \[Pa² m³\].
    negligible: f64,
}

/// Stress that is at most round-off, relative to the shear modulus.
const ROUND_OFF: f64 = 1e-10;

impl StressErrors {
    /// Share of the sum of the squares in the triangles that are divided at once.
    pub const HALF: f64 = 0.5;

    /// Estimated relative error of the stress, `sqrt(e / (s + e))` with the sums e of [`Self::squares`] and s of the stress; zero without stress.
    pub fn relative(&self) -> f64 {
        let error = self.sum();
        if error > 0.0 { (error / (self.stress_squared + error)).sqrt() } else { 0.0 }
    }

    /// Sum of the squares; zero if it is round-off or not finite.
    fn sum(&self) -> f64 {
        let sum: f64 = self.squares.iter().sum();
        if sum.is_finite() && sum > self.negligible { sum } else { 0.0 }
    }

    /// Share of each triangle in the sum of the squares; all are zero if the sum is zero or not finite.
    pub fn shares(&self) -> impl Iterator<Item = f64> {
        let sum = self.sum();
        self.squares.iter().map(move |square| if sum > 0.0 { square / sum } else { 0.0 })
    }

    /// The fewest triangles that have together at least a share of the sum of the squares, ascending; of equal ones the first. Source: Dörfler,
    /// *A convergent adaptive algorithm for Poisson's equation*, SIAM Journal on Numerical Analysis 33, 1996.
    pub fn worst(&self, share: f64) -> Vec<usize> {
        let mut all: Vec<_> = self.shares().enumerate().filter(|(_, share)| *share > 0.0).collect();
        all.sort_by(|one, other| other.1.total_cmp(&one.1));
        let mut sum = 0.0;
        let mut worst: Vec<_> = all
            .into_iter()
            .take_while(|(_, own)| {
                let is_needed = sum < share;
                sum += own;
                is_needed
            })
            .map(|(triangle, _)| triangle)
            .collect();
        worst.sort_unstable();
        worst
    }
}

impl Scene {
    /// Estimates the error of the stress at positions \[m\].
    pub fn stress_errors(&self, x: &[f64]) -> StressErrors {
        let mut all = StressErrors::default();
        for body in &self.bodies {
            let elements = &body.elements;
            let stress = (0..elements.corners().len()).map(|triangle| {
                let [[p11, p21], [p12, p22]] = elements.point_stress(x, triangle).piola.data.0;
                [[p11, p21, 0.0], [p12, p22, 0.0]]
            });
            all.add(elements.corners(), elements.rest_areas(), stress, elements.material().lame().mu);
        }
        for membrane in &self.membranes {
            let elements = &membrane.elements;
            let volumes = elements.rest_areas().map(|area| area * elements.thickness());
            all.add(elements.corners(), volumes, elements.stresses(x), elements.material().lame().mu);
        }
        all
    }
}

/// First Piola-Kirchhoff stress, column by column \[Pa\].
type Stress = [[f64; 3]; 2];

impl StressErrors {
    /// Adds the triangles of one material, with their corners, volumes \[m³\], stresses, and the shear modulus \[Pa\].
    fn add(
        &mut self,
        corners: &[[u32; 3]],
        volumes: impl Iterator<Item = f64>,
        stress: impl Iterator<Item = Stress>,
        mu: f64,
    ) {
        let all: Vec<_> = volumes.zip(stress).collect();
        let (mut first, mut last) = (u32::MAX, 0);
        for corner in corners.as_flattened() {
            (first, last) = (first.min(*corner), last.max(*corner));
        }
        let mut sums = vec![(0.0, Stress::default()); (last + 1).saturating_sub(first) as usize];
        for (own, (volume, stress)) in corners.iter().zip(&all) {
            for corner in own {
                let (weight, sum) = &mut sums[(corner - first) as usize];
                *weight += volume;
                sum.as_flattened_mut().iter_mut().zip(stress.as_flattened()).for_each(|(sum, p)| *sum += volume * p);
            }
        }
        let square = |values: [f64; 6]| values.iter().map(|value| value * value).sum::<f64>();
        for (own, (volume, stress)) in corners.iter().zip(&all) {
            let p: [f64; 6] = std::array::from_fn(|entry| stress.as_flattened()[entry]);
            let differences = own.map(|corner| {
                let (weight, sum) = &sums[(corner - first) as usize];
                std::array::from_fn(|entry| sum.as_flattened()[entry] / weight - p[entry])
            });
            let together = std::array::from_fn(|entry| differences.iter().map(|d: &[f64; 6]| d[entry]).sum());
            self.squares.push(volume / 12.0 * (differences.map(square).iter().sum::<f64>() + square(together)));
            self.stress_squared += volume * square(p);
            self.negligible += volume * (ROUND_OFF * mu) * (ROUND_OFF * mu);
        }
    }
}

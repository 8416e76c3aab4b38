//! Toy: the mathematical pendulum.

use super::{Reading, Toy, relative_error};
use crate::quantity::{Length, Quantity, Swing, Weight};
use std::f64::consts::{FRAC_PI_2, PI};

/// The pendulum on a rigid rod, exactly: `theta'' = -(g/L) sin(theta)`, let go at rest. Its state is theta \[rad\] and
/// its rate [rad/s].
///
/// With `k = sin(theta0/2)`, `w = sqrt(g/L)` and `u = K(k) + w t` the solution is `sin(theta/2) = k sn(u, k)` and
/// `theta' = 2 k w cn(u, k)`; its period is `4 K(k) / w` (Abramowitz and Stegun, *Handbook of Mathematical Functions*,
/// chapters 16 and 17, where both K and sn come from arithmetic-geometric means).
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pendulum {
    /// L \[m\].
    pub length: Length,
    /// g [m/s²].
    pub gravity: Weight,
    /// theta0 \[degrees\].
    pub start: Swing,
}

impl Default for Pendulum {
    fn default() -> Self {
        Self { length: Length::literal(0.4), gravity: Weight::literal(9.8), start: Swing::literal(90.0) }
    }
}

/// Pivot of the rod \[m\].
const PIVOT: [f64; 2] = [0.5, 0.5];

/// Rounds after which both means agree to the last bit for every allowed start angle.
const ROUNDS: usize = 8;

/// Arithmetic-geometric means of 1 and k' for `k = sin(half)`, with `c_n = (a_(n-1) - b_(n-1))/2`: pairs (a, c).
fn means(half: f64) -> [(f64, f64); ROUNDS] {
    let (mut a, mut b, mut c) = (1.0, libm::cos(half), libm::sin(half));
    std::array::from_fn(|_| {
        let pair = (a, c);
        (a, b, c) = (0.5 * (a + b), (a * b).sqrt(), 0.5 * (a - b));
        pair
    })
}

/// Period ratio T/T0 for a start angle `theta0` \[rad\], with T0 for a very small angle: `2 K(sin(theta0/2)) / pi`.
/// It is 1 over the arithmetic-geometric mean of 1 and `cos(theta0/2)`.
pub fn period_ratio(theta0: f64) -> f64 {
    1.0 / means(0.5 * theta0)[ROUNDS - 1].0
}

/// Jacobi functions sn and cn of `u` for `k = sin(half)`, by descending from the last mean.
fn jacobi(u: f64, half: f64) -> [f64; 2] {
    let means = means(half);
    let mut phi = f64::from(1_u32 << (ROUNDS - 1)) * means[ROUNDS - 1].0 * u;
    for (a, c) in means[1..].iter().rev() {
        phi = 0.5 * (phi + libm::asin(c / a * libm::sin(phi)));
    }
    [libm::sin(phi), libm::cos(phi)]
}

impl Pendulum {
    /// g/L [1/s²].
    fn square(&self) -> f64 {
        self.gravity.get() / self.length.get()
    }

    /// theta0 \[rad\].
    fn theta0(&self) -> f64 {
        self.start.get().to_radians()
    }

    /// Period of a very small swing \[s\].
    fn small_period(&self) -> f64 {
        2.0 * PI / self.square().sqrt()
    }
}

impl Toy for Pendulum {
    fn title(&self) -> &'static str {
        "Pendulum"
    }

    fn about(&self) -> &'static str {
        "d²θ/dt² = −(g/L) sin θ, let go at rest: a wide swing takes longer than a small one, T/T₀ = 2 K(sin(θ₀/2))/π."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.length, &mut self.gravity, &mut self.start]
    }

    fn columns(&self) -> [&'static str; 2] {
        ["angle_rad", "rate_rad_per_s"]
    }

    fn rate(&self, [theta, speed]: [f64; 2]) -> [f64; 2] {
        [speed, -self.square() * libm::sin(theta)]
    }

    fn exact(&self, time: f64) -> [f64; 2] {
        let (half, frequency) = (0.5 * self.theta0(), self.square().sqrt());
        let quarter = FRAC_PI_2 * period_ratio(2.0 * half);
        // The phase is reduced to one period, so that it keeps its digits over a long time.
        let turns = time / self.period();
        let [sn, cn] = jacobi(quarter * (1.0 + 4.0 * (turns - libm::floor(turns))), half);
        let k = libm::sin(half);
        [2.0 * libm::asin(k * sn), 2.0 * k * frequency * cn]
    }

    fn period(&self) -> f64 {
        self.small_period() * period_ratio(self.theta0())
    }

    fn energies(&self, [theta, speed]: [f64; 2]) -> [f64; 2] {
        let (length, gravity) = (self.length.get(), self.gravity.get());
        [0.5 * length * length * speed * speed, gravity * length * (1.0 - libm::cos(theta))]
    }

    fn place(&self, [theta, _]: [f64; 2]) -> [f64; 2] {
        let length = self.length.get();
        [PIVOT[0] + length * libm::sin(theta), PIVOT[1] - length * libm::cos(theta)]
    }

    fn pivot(&self) -> Option<[f64; 2]> {
        Some(PIVOT)
    }

    fn path(&self) -> (Vec<[f64; 2]>, bool) {
        let at = |i: i32| self.place([self.theta0() * f64::from(i) / 60.0, 0.0]);
        ((-60..=60).map(at).collect(), false)
    }

    fn readings(&self, time: f64, state: [f64; 2]) -> Vec<Reading> {
        let reading = |name, value, unit, help| Reading { name, value, unit, help };
        let ratio = period_ratio(self.theta0());
        vec![
            reading("Angle", state[0].to_degrees(), "°", "θ from hanging straight down"),
            reading("Period", self.period(), "s", "The exact period T = 4 K(sin(θ₀/2)) √(L/g) [s]"),
            reading("T/T₀", ratio, "", "2 K(sin(θ₀/2))/π: the period over that of a very small swing"),
            reading("Error", relative_error(self, time, state), "", "Distance from the exact state, over the start"),
        ]
    }
}

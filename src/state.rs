//! State: positions, velocities and everything else that is needed to continue a scene exactly.

/// Positions and velocities, flat: two numbers a vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Positions [m].
    pub x: Vec<f64>,
    /// Velocities [m/s].
    pub v: Vec<f64>,
    /// Simulated time [s].
    pub time: f64,
    /// Steps taken.
    pub steps: u64,
    /// Memory of the integrator between steps.
    pub memory: Vec<f64>,
    /// For each body and then each net, the number of consecutive checks below the sleep threshold; the greatest number
    /// if it sleeps. Empty before the first check.
    pub slow_checks: Vec<u32>,
}

impl State {
    /// Greatest valid distance [m] and speed [m/s]; beyond, the body has exploded.
    pub const LIMIT: f64 = 1e15;

    /// Whether every position and velocity is finite and at most [`Self::LIMIT`].
    pub fn is_finite(&self) -> bool {
        // No early exit: a loop without branches is vectorised.
        let within = |values: &[f64]| values.iter().fold(true, |all, value| all & (value.abs() <= Self::LIMIT));
        pulp::Arch::new().dispatch(|| within(&self.x) && within(&self.v))
    }

    /// Whether every position lies in a box and every velocity is at most [`Self::LIMIT`].
    pub fn is_within(&self, [least, greatest]: [[f64; 2]; 2]) -> bool {
        // Sums of numbers instead of conditions are vectorised.
        const COUNT: usize = 16;
        let corners = [least, greatest].map(|corner| std::array::from_fn::<f64, COUNT, _>(|number| corner[number % 2]));
        let [least, greatest] = &corners;
        let beyond = |x: f64, least: f64, greatest: f64| {
            // NaN fails both comparisons.
            let (low, high) = (if x >= least { 0.0 } else { 1.0 }, if x <= greatest { 0.0 } else { 1.0 });
            low + high
        };
        let (chunks, rest) = self.x.as_chunks::<COUNT>();
        let within = || {
            let mut outside = [0.0; COUNT];
            for chunk in chunks {
                for (number, sum) in outside.iter_mut().enumerate() {
                    *sum += beyond(chunk[number], least[number], greatest[number]);
                }
            }
            let slow = |all: bool, v: &f64| all & (v.abs() <= Self::LIMIT);
            outside.iter().sum::<f64>() == 0.0 && self.v.iter().fold(true, slow)
        };
        let rest = rest
            .iter()
            .zip(least.iter().zip(greatest))
            .all(|(x, (least, greatest))| beyond(*x, *least, *greatest) == 0.0);
        rest && pulp::Arch::new().dispatch(within)
    }

    /// Hash of every bit of positions and velocities (FNV-1a, 64 bit): equal states have equal hashes.
    pub fn hash(&self) -> u64 {
        let numbers = self.x.iter().chain(&self.v);
        numbers
            .flat_map(|number| number.to_bits().to_le_bytes())
            .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
    }
}

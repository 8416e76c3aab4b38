//! What moves: everything that is needed to continue a scene exactly.

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
    /// What the integrator remembers between steps.
    pub memory: Vec<f64>,
}

impl State {
    /// Whether every position and velocity is a number.
    ///
    /// A finite number times zero is zero and anything else times zero is not: eight independent sums keep the processor busy.
    pub fn is_finite(&self) -> bool {
        let zero = |values: &[f64]| {
            let chunks = values.chunks_exact(8);
            let rest: f64 = chunks.remainder().iter().map(|value| value * 0.0).sum();
            let mut sums = [0.0; 8];
            for chunk in chunks {
                for (sum, value) in sums.iter_mut().zip(chunk) {
                    *sum += value * 0.0;
                }
            }
            sums.iter().sum::<f64>() + rest == 0.0
        };
        zero(&self.x) && zero(&self.v)
    }

    /// A fingerprint of every bit of positions and velocities (FNV-1a, 64 bit): equal states, equal numbers.
    pub fn hash(&self) -> u64 {
        let numbers = self.x.iter().chain(&self.v);
        numbers.flat_map(|number| number.to_bits().to_le_bytes()).fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
        })
    }
}

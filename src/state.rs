//! State: positions, velocities and everything else that is needed to continue a scene exactly.
//!
//! ```
//! use gingerbread::state::State;
//!
//! let state = State { x: vec![1.0, 2.0], v: vec![0.0, f64::NAN], ..State::default() };
//! assert!(!state.is_finite());
//! ```

use crate::{contact::Anchor, effects::Bounds};

/// Positions and velocities, flat: as many numbers a vertex as the scene has dimensions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Positions \[m\].
    pub x: Vec<f64>,
    /// Velocities [m/s].
    pub v: Vec<f64>,
    /// Simulated time \[s\].
    pub time: f64,
    /// Steps taken.
    pub steps: u64,
    /// Memory of the integrator between steps.
    pub memory: Vec<f64>,
    /// Memory of contacts, in the order of their names.
    pub anchors: Vec<Anchor>,
    /// For each body, net and membrane, and then each region of bodies, the number of consecutive checks below the sleep threshold; the
    /// greatest number if it sleeps. Empty before the first check.
    pub slow_checks: Vec<u32>,
    /// Where each vertex was when a region beside it fell asleep \[m\]; empty while no region sleeps.
    pub calm_positions: Vec<f64>,
}

impl State {
    /// Greatest valid distance \[m\] and speed [m/s]; beyond, the body has exploded.
    pub const LIMIT: f64 = 1e15;

    /// Whether every position and velocity is finite and at most [`Self::LIMIT`].
    pub fn is_finite(&self) -> bool {
        is_valid(&self.x) && is_valid(&self.v)
    }

    /// Whether every position lies in a box, if there is one, and every number is at most [`Self::LIMIT`].
    pub fn is_within(&self, bounds: Option<Bounds>) -> bool {
        bounds.map_or_else(|| is_valid(&self.x), |bounds| bounds.contains(&self.x)) && is_valid(&self.v)
    }

    /// Copies positions and then velocities to a vector of that length.
    pub fn copy_to(&self, flat: &mut [f64]) {
        let (x, v) = flat.split_at_mut(self.x.len());
        x.copy_from_slice(&self.x);
        v.copy_from_slice(&self.v);
    }

    /// Copies positions and velocities from what [`Self::copy_to`] writes.
    pub fn copy_from(&mut self, flat: &[f64]) {
        let (x, v) = flat.split_at(self.x.len());
        self.x.copy_from_slice(x);
        self.v.copy_from_slice(v);
    }

    /// Hash of every bit of positions, velocities and the memory of contacts (FNV-1a, 64 bit): equal states have equal hashes.
    pub fn hash(&self) -> u64 {
        // In the plane the third number is zero and left out.
        let point = |anchor: &'_ Anchor| {
            anchor.point.into_iter().enumerate().filter(|(axis, along)| *axis < 2 || *along != 0.0)
        };
        let anchors = self
            .anchors
            .iter()
            .flat_map(move |anchor| point(anchor).map(|(_, along)| along).chain([anchor.penetration]));
        let numbers = self.x.iter().chain(&self.v).copied().chain(anchors);
        numbers
            .flat_map(|number| number.to_bits().to_le_bytes())
            .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
    }
}

/// Whether all values are finite and at most [`State::LIMIT`].
fn is_valid(values: &[f64]) -> bool {
    // No early exit: a loop without branches is vectorised.
    let within = || values.iter().fold(true, |all, value| all & (value.abs() <= State::LIMIT));
    pulp::Arch::new().dispatch(within)
}

//! Step length and multirate setting of a level.

use serde::{Deserialize, Serialize};

/// Steps per 1/60 s: a whole number from 1 to 100,000.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "f64", into = "u32")]
pub struct Substeps(u32);

impl Substeps {
    /// Most steps a frame may have.
    pub const MAX: u32 = 100_000;

    /// A checked number of steps.
    ///
    /// # Errors
    /// A sentence with the range.
    pub fn new(count: u32) -> Result<Self, String> {
        if (1..=Self::MAX).contains(&count) {
            Ok(Self(count))
        } else {
            Err(format!("substeps must be at least 1 and at most {}, got {count}", Self::MAX))
        }
    }

    /// The allowed number next above a number of steps that need not be whole.
    pub fn nearest(steps: f64) -> Self {
        Self(libm::ceil(steps).clamp(1.0, f64::from(Self::MAX)) as u32)
    }

    /// The least number of steps that are no longer than a length \[s\]; `None` if a frame cannot be divided so.
    pub fn for_step(longest: f64) -> Option<Self> {
        let least = 1.0 / (60.0 * f64::from(Self::MAX));
        let range = least * (1.0 - 1e-9)..=1.0 / 60.0 * (1.0 + 1e-9);
        range.contains(&longest).then(|| Self::nearest(1.0 / (60.0 * longest) - 1e-9))
    }

    /// Greatest number of equal parts of a step \[s\] of which a frame has no more than [`Self::MAX`]; at least one.
    pub fn most_parts(step: f64) -> f64 {
        libm::floor(f64::from(Self::MAX) * 60.0 * step).max(1.0)
    }

    /// Twice as many, as far as that is allowed.
    #[must_use]
    pub fn doubled(self) -> Self {
        Self((2 * self.0).min(Self::MAX))
    }

    /// The number of steps.
    pub const fn get(self) -> u32 {
        self.0
    }

    /// The length of a step, h = 1 / (60 substeps) \[s\].
    pub fn step(self) -> f64 {
        1.0 / (60.0 * f64::from(self.0))
    }
}

impl Default for Substeps {
    fn default() -> Self {
        Self(100)
    }
}

/// As a file has it.
impl TryFrom<f64> for Substeps {
    type Error = String;
    fn try_from(count: f64) -> Result<Self, String> {
        if count.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&count) {
            return Self::new(count as u32);
        }
        Err(format!("substeps must be a whole number, at least 1 and at most {}, got {count}", Self::MAX))
    }
}

impl From<Substeps> for u32 {
    fn from(substeps: Substeps) -> Self {
        substeps.0
    }
}

/// Whether bodies and nets have step lengths of their own. This needs bodies that do not touch each other: with a contact potential all take the same steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum SubstepMode {
    /// All take the steps of the level, however stiff one of them is.
    #[default]
    Same,
    /// Each body and net takes every step of the level in as many equal parts as keep it stable, and all meet again at its end.
    /// For explicit schemes; with the others, which no stiffness limits, it changes nothing.
    Own,
}

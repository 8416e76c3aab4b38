//! Known results of a level.

use crate::quantity::{Deviation, KnownValue, Position, Time};
use serde::{Deserialize, Serialize};

/// A number that a level is known to lead to, by a closed form or a publication.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Check {
    /// What it is, in words.
    pub name: String,
    /// Where it is measured.
    pub place: CheckPlace,
    /// Which number is measured there: the name of a column without that of its probe, such as `uy`.
    pub column: String,
    /// When it is measured, rounded to a step \[s\].
    pub at: Time,
    /// The known value, in the unit of the column.
    pub value: KnownValue,
    /// How far the measured value may be from it.
    pub tolerance: Deviation,
    /// Formula or publication that the value is from.
    pub source: String,
}

/// Where a number is measured: a probe, whose vertex or triangle is named by its place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum CheckPlace {
    /// The vertex that is nearest to a point at rest \[m\].
    Vertex(Position),
    /// The triangle of a body whose middle is nearest to a point at rest \[m\].
    Triangle(Position),
    /// The force of all pins.
    Reaction,
    /// Energies by kind.
    Energy,
    /// Linear and angular momentum.
    Momentum,
    /// The numbers of a toy.
    Numbers,
}

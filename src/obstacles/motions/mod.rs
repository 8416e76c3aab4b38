//! Prescribed motions of obstacles: placement and velocity as closed functions of time, so that rewinding, saving and
//! shorter steps reproduce them bit for bit. Each motion is one file; [`MotionKind`] lists them all.

mod slide;
mod swing;
mod turn;

pub use slide::Slide;
pub use swing::Swing;
pub use turn::Turn;

use super::Rigid;
use crate::{quantity::Quantity, registry::registry};

registry! {
    /// Kinds of motion.
    pub enum MotionKind: dyn Motion {
        Swing(Swing),
        Slide(Slide),
        Turn(Turn),
    }
}

/// A motion with its parameters.
pub trait Motion {
    /// Placement and velocity at a time \[s\].
    fn at(&self, time: f64) -> Rigid<3>;

    /// Whether it needs a third coordinate.
    fn is_in_space(&self) -> bool;

    /// The numbers a panel may change.
    fn parameters(&mut self) -> Vec<&mut dyn Quantity>;
}

/// Composition of several motions, each applied after the ones before, at a time \[s\].
pub fn placed<const D: usize>(motions: &[MotionKind], time: f64) -> Rigid<D> {
    motions.iter().fold(Rigid::STILL, |moved, motion| motion.kind().at(time).within().of(&moved))
}

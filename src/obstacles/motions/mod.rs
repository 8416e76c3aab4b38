//! How obstacles move: where they are and how fast is a closed function of time, so that going back, saving and shorter steps
//! find them at the same place to the bit. Each motion is one file; [`MotionKind`] lists them all.

mod slide;
mod swing;
mod turn;

pub use slide::Slide;
pub use swing::Swing;
pub use turn::Turn;

use super::Rigid;
use crate::{quantity::Quantity, registry::registry};

registry! {
    /// How an obstacle moves.
    pub enum MotionKind: dyn Motion {
        Swing(Swing),
        Slide(Slide),
        Turn(Turn),
    }
}

/// A motion with its parameters.
pub trait Motion {
    /// Where something is at a time [s], and how it moves there.
    fn at(&self, time: f64) -> Rigid;

    /// The numbers a panel may change.
    fn parameters(&mut self) -> Vec<&mut dyn Quantity>;
}

/// Where several motions, each of what the ones before it have moved, bring something at a time [s].
pub fn placed(motions: &[MotionKind], time: f64) -> Rigid {
    motions.iter().fold(Rigid::STILL, |moved, motion| motion.kind().at(time).of(&moved))
}

//! Prescribed motions of obstacles: placement and velocity as closed functions of time, so that rewinding, saving and
//! shorter steps reproduce them bit for bit. Each motion is one file; [`MotionKind`] lists them all.

mod slide;
mod spline;
mod swing;
mod turn;

pub use slide::Slide;
pub use spline::Spline;
pub use swing::Swing;
pub use turn::Turn;

use super::{Rigid, Similarity};
use crate::{quantity::Quantity, registry::registry};

registry! {
    /// Kinds of motion.
    pub enum MotionKind: dyn Motion {
        Swing(Swing),
        Slide(Slide),
        Turn(Turn),
        Spline(Spline),
    }
}

/// A motion with its parameters.
pub trait Motion {
    /// Placement and velocity at a time \[s\].
    fn at(&self, time: f64) -> Rigid<3>;

    /// Whether it needs a third coordinate.
    fn is_in_space(&self) -> bool;

    /// Moves, scales and turns it with its obstacle. `None` if a number would leave its range.
    fn arrange(&mut self, by: &Similarity) -> Option<()>;

    /// The numbers a panel may change.
    fn parameters(&mut self) -> Vec<&mut dyn Quantity>;
}

/// Composition of several motions, each applied after the ones before, at a time \[s\].
pub fn placed<const D: usize>(motions: &[MotionKind], time: f64) -> Rigid<D> {
    motions.iter().fold(Rigid::STILL, |moved, motion| motion.kind().at(time).within().of(&moved))
}

/// Checks that motions fit a scene with this number of coordinates.
///
/// # Errors
/// A sentence that names the motion.
pub fn check(motions: &[MotionKind], dimension: usize) -> Result<(), String> {
    let fault = |motion: &MotionKind| if let MotionKind::Spline(spline) = motion { spline.fault() } else { None };
    if let Some(fault) = motions.iter().find_map(fault) {
        return Err(fault);
    }
    if dimension == 2
        && let Some(motion) = motions.iter().find(|motion| motion.kind().is_in_space())
    {
        return Err(format!("its motion {} is in space, but the scene is in the plane", motion.name()));
    }
    let has_direction = |motion: &MotionKind| match motion {
        MotionKind::Turn(turn) => turn.axis.is_none_or(|axis| axis.get() != [0.0; 3]),
        _ => true,
    };
    if motions.iter().all(has_direction) {
        Ok(())
    } else {
        Err("the axis of a turn must have a direction, got (0, 0, 0)".to_owned())
    }
}

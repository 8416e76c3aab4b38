//! Effect: a vortex in the air about cloth.

use super::{
    Effect, EffectParameters,
    air::{Air, FacePressure, unit},
};
use crate::{
    elements::{
        Elements,
        frame::{cross, dot, minus},
    },
    quantity::{Circulation, Coordinate, CoreRadius, FaceResistance, OwnMotion, Quantity, SpacePoint, Updraft},
};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Air that turns about an axis and rises along it, as in a tornado, and presses on faces as [`super::Wind`] does. At the distance r from the
/// axis it turns with the speed of Lamb and Oseen's vortex,
///
/// `u = G/(2 pi r) (1 - exp(-r²/r0²))`,
///
/// fastest at r = 1.12 r0, and rises with `w exp(-r²/r0²)` (H. Lamb, *Hydrodynamics*, 6th edition, 1932, section 334a).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Vortex {
    /// A point of the axis \[m\].
    pub centre: SpacePoint,
    /// Direction of the axis, of any length but zero; upwards, if it is not said.
    #[serde(default = "up")]
    pub axis: SpacePoint,
    /// G, counter-clockwise about the axis [m²/s].
    pub circulation: Circulation,
    /// r0 \[m\].
    pub core: CoreRadius,
    /// w [m/s].
    #[serde(default = "no_updraft")]
    pub updraft: Updraft,
    /// c [Pa s/m].
    pub resistance: FaceResistance,
    /// s: share of the velocity of the cloth that the air feels.
    #[serde(default = "whole")]
    pub own_motion: OwnMotion,
}

const fn up() -> SpacePoint {
    SpacePoint(Coordinate::literal(0.0), Coordinate::literal(1.0), Coordinate::literal(0.0))
}

const fn no_updraft() -> Updraft {
    Updraft::literal(0.0)
}

const fn whole() -> OwnMotion {
    OwnMotion::literal(1.0)
}

impl Default for Vortex {
    fn default() -> Self {
        let zero = Coordinate::literal(0.0);
        Self {
            centre: SpacePoint(zero, zero, zero),
            axis: up(),
            circulation: Circulation::literal(5.0),
            core: CoreRadius::literal(0.3),
            updraft: no_updraft(),
            resistance: FaceResistance::literal(1.0),
            own_motion: whole(),
        }
    }
}

impl EffectParameters for Vortex {
    fn title(&self) -> &'static str {
        "Vortex"
    }

    fn about(&self) -> &'static str {
        "Air that turns with u = Γ/(2πr) (1 − exp(−r²/r₀²)) about an axis and rises along it presses on every triangle of cloth."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.circulation, &mut self.core, &mut self.updraft, &mut self.resistance, &mut self.own_motion]
    }

    fn build(&self, elements: &Elements) -> Result<Box<dyn Effect>, String> {
        let axis = self.axis.get();
        if dot(axis, axis) == 0.0 {
            return Err("its axis must have a direction, got (0, 0, 0)".to_owned());
        }
        let air = Swirl {
            centre: self.centre.get(),
            axis: unit(axis),
            circulation: self.circulation.get(),
            core: self.core.get(),
            updraft: self.updraft.get(),
        };
        if !(TAU * air.core * air.core).is_normal() {
            return Err(format!("its core of {} m is too small or too large to compute with", air.core));
        }
        let factors = [self.resistance.get(), self.own_motion.get()];
        Ok(Box::new(FacePressure::new("Vortex", elements, factors, air)?))
    }
}

/// The air of a [`Vortex`].
struct Swirl {
    centre: [f64; 3],
    /// Unit vector.
    axis: [f64; 3],
    circulation: f64,
    core: f64,
    updraft: f64,
}

impl Air for Swirl {
    fn velocity(&self, point: [f64; 3], _: f64) -> [f64; 3] {
        let from = minus(point, self.centre);
        // As long as the distance from the axis, along the circle.
        let around = cross(self.axis, from);
        let share = dot(around, around) / (self.core * self.core);
        // (1 - exp(-s))/s tends to 1 on the axis.
        let profile = if share > 0.0 { -libm::expm1(-share) / share } else { 1.0 };
        let turn = self.circulation / (TAU * self.core * self.core) * profile;
        let rise = self.updraft * libm::exp(-share);
        std::array::from_fn(|axis| turn * around[axis] + rise * self.axis[axis])
    }

    fn is_still(&self) -> bool {
        self.circulation == 0.0 && self.updraft == 0.0
    }

    fn is_steady(&self) -> bool {
        true
    }
}

//! Effect: wind on the faces of cloth.

use super::{
    Effect, EffectParameters,
    air::{Air, FacePressure, unit},
};
use crate::{
    elements::{
        Elements,
        frame::{cross, dot},
    },
    quantity::{
        Coordinate, EddySize, FaceResistance, GustPeriod, GustShare, OwnMotion, Quantity, SpacePoint, TurbulenceShare,
        WindSpeed,
    },
    random,
};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Wind on every triangle of membranes, and of sheets of springs, in space: a pressure proportional to the velocity of the air
/// relative to the triangle, along its normal n. With A the area, w the velocity of the air at its centre and v the mean velocity of
/// its corners, the force on the triangle is
///
/// `f = c A (n · (w - s v)) n`,
///
/// a third at each corner. A wind of zero speed is the drag of air on faces. With s = 0 the motion of the cloth does not
/// count, as in the cloth of Princeton's course COS 426.
///
/// The speed of the wind is `w (1 + g sin(2 pi t/T))` with gusts. Turbulence adds
///
/// `b w sum_k a_k cos(k_k · (x - w t) + phi_k)/2` over [`MODES`] random modes with unit vectors `a_k` across the wave vectors `k_k`: a field without divergence,
/// whose root mean square is b times the speed, and which the mean wind carries (R. H. Kraichnan, *Diffusion by a random velocity field*,
/// Physics of Fluids 13, 1970; G. I. Taylor, *The spectrum of turbulence*, Proceedings of the Royal Society A 164, 1938). The wavelengths are between
/// the largest eddies and a quarter of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wind {
    /// w [m/s].
    pub speed: WindSpeed,
    /// Where it blows to; any length but zero.
    #[serde(default = "along_x")]
    pub direction: SpacePoint,
    /// c [Pa s/m].
    pub resistance: FaceResistance,
    /// s.
    #[serde(default = "whole")]
    pub own_motion: OwnMotion,
    /// g.
    #[serde(default = "no_gusts")]
    pub gusts: GustShare,
    /// T \[s\].
    #[serde(default = "two_seconds")]
    pub period: GustPeriod,
    /// b.
    #[serde(default = "no_turbulence")]
    pub turbulence: TurbulenceShare,
    /// Largest wavelength of the turbulence \[m\].
    #[serde(default = "half_metre")]
    pub eddies: EddySize,
    /// Number that chooses the turbulence: the same number gives the same wind.
    #[serde(default)]
    pub seed: u32,
}

/// Random modes of the turbulence.
pub const MODES: usize = 8;

const fn along_x() -> SpacePoint {
    SpacePoint(Coordinate::literal(1.0), Coordinate::literal(0.0), Coordinate::literal(0.0))
}

const fn whole() -> OwnMotion {
    OwnMotion::literal(1.0)
}

const fn no_gusts() -> GustShare {
    GustShare::literal(0.0)
}

const fn two_seconds() -> GustPeriod {
    GustPeriod::literal(2.0)
}

const fn no_turbulence() -> TurbulenceShare {
    TurbulenceShare::literal(0.0)
}

const fn half_metre() -> EddySize {
    EddySize::literal(0.5)
}

impl Default for Wind {
    fn default() -> Self {
        Self {
            speed: WindSpeed::literal(3.0),
            direction: along_x(),
            resistance: FaceResistance::literal(1.0),
            own_motion: whole(),
            gusts: no_gusts(),
            period: two_seconds(),
            turbulence: no_turbulence(),
            eddies: half_metre(),
            seed: 0,
        }
    }
}

impl EffectParameters for Wind {
    fn title(&self) -> &'static str {
        "Wind"
    }

    fn about(&self) -> &'static str {
        "f = c A (n·(w − s v)) n on every triangle of cloth, with gusts w (1 + g sin(2πt/T)) and turbulence. A wind of zero speed is air drag on faces."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![
            &mut self.speed,
            &mut self.resistance,
            &mut self.own_motion,
            &mut self.gusts,
            &mut self.period,
            &mut self.turbulence,
            &mut self.eddies,
        ]
    }

    fn build(&self, elements: &Elements) -> Result<Box<dyn Effect>, String> {
        let direction = self.direction.get();
        let length = dot(direction, direction).sqrt();
        if length == 0.0 {
            return Err("its direction must not be zero".to_owned());
        }
        let speed = self.speed.get();
        let mean = direction.map(|along| speed / length * along);
        let gusts = self.gusts.get();
        let modes = modes(self.seed, mean, self.turbulence.get() * speed, self.eddies.get());
        let rate = TAU / self.period.get();
        if !rate.is_finite() {
            return Err(format!("its period of {} s is too short to compute with", self.period.get()));
        }
        let air = Blowing { mean, gusts, rate, modes };
        let factors = [self.resistance.get(), self.own_motion.get()];
        Ok(Box::new(FacePressure::new("Wind", elements, factors, air)?))
    }
}

/// One mode of the turbulence.
#[derive(Clone, Copy, Debug)]
struct Mode {
    /// Half the amplitude along each axis [m/s].
    amplitude: [f64; 3],
    /// Wave vector [1/m].
    wave: [f64; 3],
    /// Angular frequency [rad/s].
    frequency: f64,
    phase: f64,
}

/// Random modes of turbulence with this root mean square [m/s]; none if that is zero.
fn modes(seed: u32, mean: [f64; 3], strength: f64, largest: f64) -> Vec<Mode> {
    if strength == 0.0 {
        return Vec::new();
    }
    let mut numbers = random::stream(seed);
    let mut next = || numbers.next().unwrap_or_default();
    let mode = |_| {
        let direction = unit([(); 3].map(|()| next()));
        let number = TAU / largest * (2.5 + 1.5 * next());
        let wave = direction.map(|along| number * along);
        let across = unit(cross(direction, unit([(); 3].map(|()| next()))));
        // The mean square of a cosine is a half.
        let amplitude = across.map(|along| strength * (2.0 / MODES as f64).sqrt() * along);
        Mode { amplitude, wave, frequency: dot(wave, mean), phase: 0.5 * TAU * next() }
    };
    (0..MODES).map(mode).collect()
}

/// Gusts and turbulence.
struct Blowing {
    /// Mean velocity of the air [m/s].
    mean: [f64; 3],
    gusts: f64,
    /// Angular frequency of gusts [rad/s].
    rate: f64,
    modes: Vec<Mode>,
}

impl Air for Blowing {
    fn velocity(&self, point: [f64; 3], time: f64) -> [f64; 3] {
        let gust = if self.gusts == 0.0 { 1.0 } else { 1.0 + self.gusts * libm::sin(self.rate * time) };
        let mut velocity = self.mean.map(|along| gust * along);
        for mode in &self.modes {
            let now = libm::cos(dot(mode.wave, point) - mode.frequency * time + mode.phase);
            velocity = std::array::from_fn(|axis| velocity[axis] + now * mode.amplitude[axis]);
        }
        velocity
    }

    fn is_still(&self) -> bool {
        self.mean == [0.0; 3] && self.modes.is_empty()
    }

    fn is_steady(&self) -> bool {
        self.gusts == 0.0 && self.modes.is_empty()
    }
}

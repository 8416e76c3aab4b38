//! Wind that a key switches.

use super::Refused;
use crate::{
    document::Document,
    effects::{EffectKind, Wind},
    elements::NetSprings,
    level::{EffectLevel, Level, Switch, When},
    quantity::{
        Coordinate, EddySize, FaceResistance, GustShare, OutOfRange, OwnMotion, SpacePoint, TurbulenceShare, WindSpeed,
    },
    scene::Scene,
};

/// Whether an effect is wind.
pub(super) const fn is_wind(listed: &EffectLevel) -> bool {
    matches!(listed.effect, EffectKind::Wind(_) | EffectKind::Vortex(_))
}

/// Switches all winds of a document, and adds one that suits the scene if there is none.
pub(super) fn set_wind(document: &mut Document, scene: &Scene, on: bool) -> Result<(), Refused> {
    let switch = if on { Switch::default() } else { Switch::Off };
    if on && !document.level.effects.iter().any(is_wind) {
        let wind = suited(scene, &document.level);
        let effect = wind.ok_or(Refused::NotHere("wind acts on cloth in space, and there is none"))?;
        document.level.effects.push(EffectLevel { effect: effect.into(), switch, when: When::Always });
    }
    document.level.effects.iter_mut().filter(|listed| is_wind(listed)).for_each(|listed| listed.switch = switch);
    Ok(())
}

/// A turbulent wind away from the viewer that suits the cloth of a scene: its pressure is half of the weight of the cloth for each unit of area, and
/// loose cloth goes with it within half a second. `None` if there is no cloth in space, or its size is out of range.
fn suited(scene: &Scene, level: &Level) -> Option<Wind> {
    /// Rate at which cloth takes the speed of the wind [1/s].
    const RATE: f64 = 2.0;
    let sheets = scene.nets.iter().filter(|net| matches!(net.springs, NetSprings::Space(_)));
    let sheets = sheets.map(|net| (net.faces.as_slice(), net.vertices.clone()));
    let membranes = scene.membranes.iter().map(|membrane| (membrane.elements.corners(), membrane.vertices.clone()));
    let (mut area, mut mass, mut size) = (0.0, 0.0, 0.0_f64);
    for (faces, vertices) in sheets.chain(membranes).filter(|(faces, _)| !faces.is_empty()) {
        area += faces.iter().map(|face| self::area(&scene.rest, *face)).sum::<f64>();
        mass += scene.mass[scene.numbers(&vertices)].iter().step_by(3).sum::<f64>();
        size = size.max(scene.size(&vertices));
    }
    if area == 0.0 {
        return None;
    }
    let gravity = level.effects.iter().find_map(|listed| match &listed.effect {
        EffectKind::Gravity(gravity) => Some(gravity.down.get().abs()),
        _ => None,
    });
    let speed = gravity.filter(|gravity| *gravity > 0.0).unwrap_or(9.81) / (2.0 * RATE);
    let wind = || -> Result<Wind, OutOfRange> {
        Ok(Wind {
            speed: WindSpeed::new(speed)?,
            direction: SpacePoint(Coordinate::new(0.3)?, Coordinate::new(0.1)?, Coordinate::new(-1.0)?),
            resistance: FaceResistance::new(RATE * mass / area)?,
            own_motion: OwnMotion::new(1.0)?,
            gusts: GustShare::new(0.3)?,
            turbulence: TurbulenceShare::new(0.3)?,
            eddies: EddySize::new(0.5 * size)?,
            ..Wind::default()
        })
    };
    wind().ok()
}

/// Area of a triangle \[m²\].
fn area(x: &[f64], face: [u32; 3]) -> f64 {
    let [a, b, c] = face.map(|corner| nalgebra::Vector3::from_column_slice(&x[3 * corner as usize..][..3]));
    0.5 * (b - a).cross(&(c - a)).norm()
}

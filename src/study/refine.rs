//! Refines the mesh of a level.

use super::StudyError;
use crate::{
    level::{Level, Pin},
    quantity::{Cells, Rings, Triangles},
};

/// Level with about `share` times as many triangles, as nearly as its meshes allow.
/// Numbers of triangles are scaled by `share`, numbers of cells and rings by its square root.
pub fn with_triangles(level: &Level, share: f64) -> Result<Level, StudyError> {
    let mut level = level.clone();
    let mut refined = false;
    for body in &mut level.bodies {
        let mut own = false;
        for parameter in body.mesh.kind_mut().parameters() {
            let factor = match parameter.spec().name {
                name if name == Triangles::SPEC.name => share,
                name if name == Cells::SPEC.name || name == Rings::SPEC.name => share.sqrt(),
                _ => continue,
            };
            let (slider, value) = (parameter.spec(), parameter.get());
            let wanted = (value * factor).round();
            // A number below the least allowed value becomes that value.
            if parameter.set(wanted.max(1.0)).is_err() && wanted < slider.slider.0 {
                let _ = parameter.set(100.0);
            }
            own = true;
        }
        if own && body.pins.iter().any(|pin| matches!(pin, Pin::Vertex(_))) {
            return Err(StudyError::NotHere(
                "a pin names a vertex by number, and another mesh has that number elsewhere: pin an edge, or the vertex nearest to a point",
            ));
        }
        refined |= own;
    }
    if refined { Ok(level) } else { Err(StudyError::NotHere("no mesh of this level has a resolution to vary")) }
}

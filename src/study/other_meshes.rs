//! Levels whose bodies have other meshes: more triangles, another kind of elements, or some triangles divided.

use super::StudyError;
use crate::{
    elements::ElementKind,
    level::{Level, Pin},
    meshes::Refined,
    quantity::{Cells, Rings, Triangles},
    scene::Scene,
};

/// Level with about `share` times as many triangles, of bodies with elements of one kind, if it is given.
pub(super) fn with_elements(level: &Level, element: Option<ElementKind>, share: f64) -> Result<Level, StudyError> {
    let Some(element) = element else { return with_triangles(level, share) };
    let mut level = level.clone();
    let divided = |kind: ElementKind| if kind.has_six_nodes() { 4.0 } else { 1.0 };
    let shares: Vec<_> = level.bodies.iter().map(|body| share * divided(body.element) / divided(element)).collect();
    level.bodies.iter_mut().for_each(|body| body.element = element);
    with_shares(&level, &shares)
}

/// Level with about `share` times as many triangles, as nearly as its meshes allow.
/// Numbers of triangles are scaled by `share`, numbers of cells and rings by its square root.
pub fn with_triangles(level: &Level, share: f64) -> Result<Level, StudyError> {
    with_shares(level, &vec![share; level.bodies.len()])
}

/// The same with a share for each body.
fn with_shares(level: &Level, shares: &[f64]) -> Result<Level, StudyError> {
    let mut level = level.clone();
    let mut refined = false;
    for (body, &share) in level.bodies.iter_mut().zip(shares) {
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

/// Divides triangles of the bodies of a level, by their numbers in its scene. Returns whether there are any. Meshes from files stay as they are.
pub(super) fn refine(level: &mut Level, scene: &Scene, triangles: &[usize]) -> bool {
    let mut has_any = false;
    for (part, divided) in scene.divided(triangles) {
        let body = level.bodies.get_mut(part);
        if let Some(body) = body.filter(|body| body.mesh.clone().kind_mut().path_mut().is_none()) {
            body.mesh = Refined::of(body.mesh.clone(), divided).into();
            has_any = true;
        }
    }
    has_any
}

//! Closed form of the uniaxial strip for every model.

use super::exact::only;
use crate::{
    scene::{Body, Scene, extent},
    state::State,
};

/// Equilibrium of a strip whose ends slide on rollers: description in plain words and positions [m].
///
/// The ends are held at a stretch s and slide freely, so no force acts on the sides. The deformation gradient is
/// diag(w, s) throughout. The width w follows from zero lateral stress, `P11(diag(w, s)) = 0`
/// ([`Material::free_width`]). Linear triangles represent this shape exactly, so a scene at rest has only the error
/// of its solver. A third side, left or right, slides along y and fixes the position in x. Damping may act; other
/// forces may not.
pub(super) fn at_rest(scene: &Scene, state: &State) -> Option<(String, Vec<f64>)> {
    let [body] = scene.bodies.as_slice() else { return None };
    let alone = scene.nets.is_empty() && scene.pins.is_empty();
    if !alone || !only(scene, &["Elasticity", "Damping", "Drag"]) {
        return None;
    }
    let held = |vertex: u32, axis: usize| scene.inverse_mass[2 * vertex as usize + axis] == 0.0;
    let ((left, right), (bottom, top)) = (extent(&scene.rest, 0), extent(&scene.rest, 1));
    if !is_strip(body, &scene.rest, |vertex| held(vertex, 1)) {
        return None;
    }
    // Present coordinate of a side that is held in its normal direction.
    let place = |axis: usize, at: f64| {
        let on_side = |vertex: &u32| {
            let here = scene.rest[2 * *vertex as usize + axis];
            (here - at).abs() <= 1e-9 * (right - left) && held(*vertex, axis)
        };
        let vertex = (0..scene.rest.len() as u32 / 2).find(on_side)?;
        Some(state.x[2 * vertex as usize + axis])
    };
    let (low, high) = (place(1, bottom)?, place(1, top)?);
    let (fixed, anchor) = match (place(0, left), place(0, right)) {
        (Some(x), None) => (left, x),
        (None, Some(x)) => (right, x),
        _ => return None,
    };
    let stretch = (high - low) / (top - bottom);
    let width = body.elements.material().free_width(stretch)?;
    let moved = |point: &[f64]| [anchor + width * (point[0] - fixed), low + stretch * (point[1] - bottom)];
    let words = format!("strip at rest, {stretch:.4} times as high and {width:.4} times as wide");
    Some((words, scene.rest.chunks_exact(2).flat_map(moved).collect()))
}

/// Whether every edge of the boundary is vertical or held in its height.
fn is_strip(body: &Body, rest: &[f64], held: impl Fn(u32) -> bool) -> bool {
    let slack = 1e-9 * body.rest_height;
    body.boundary.iter().all(|edge| {
        let [a, b] = edge.map(|i| i as usize + body.vertices.start);
        (rest[2 * a] - rest[2 * b]).abs() <= slack || (held(a as u32) && held(b as u32))
    })
}

//! Draws an earlier shape of the scene as thin lines: outlines of bodies and membranes, and the springs of nets.

use super::{View, shape_buffer::ShapeBuffer};
use crate::{nets::Role, snapshot::Snapshot};
use eframe::egui::Pos2;
use std::sync::Arc;

/// Half width of the lines [points].
const REACH: f32 = 1.5;

/// The positions of a moment.
#[derive(Clone, Debug)]
pub struct EarlierShape {
    /// Generation of the scene whose positions these are.
    pub generation: u64,
    /// The coordinates of each vertex \[m\].
    pub positions: Arc<Vec<f64>>,
}

/// Lines of the earlier shape.
#[derive(Default)]
pub struct Ghost {
    generation: Option<u64>,
    /// Vertices of each line, by their numbers in the scene.
    lines: Vec<[u32; 2]>,
    points: Vec<Pos2>,
}

impl Ghost {
    /// Draws the shape of a moment of this scene; `seen` maps a point of the scene to the screen.
    pub fn draw(
        &mut self,
        buffer: &mut ShapeBuffer,
        view: View,
        snapshot: &Snapshot,
        moment: &EarlierShape,
        seen: impl Fn([f64; 3]) -> Pos2,
    ) {
        if moment.generation != snapshot.generation || moment.positions.len() != snapshot.positions.len() {
            return;
        }
        if self.generation != Some(snapshot.generation) {
            self.generation = Some(snapshot.generation);
            self.lines = lines(snapshot);
        }
        let coordinate = |own: &[f64], axis: usize| own.get(axis).copied().unwrap_or(0.0);
        let places = moment.positions.chunks_exact(snapshot.dimension.max(1));
        self.points.clear();
        self.points.extend(places.map(|own| seen([0, 1, 2].map(|axis| coordinate(own, axis)))));
        buffer.threads(&self.points, &self.lines, REACH, view.theme.annotation.gamma_multiply(0.7));
    }
}

/// Outlines and springs of a scene.
fn lines(snapshot: &Snapshot) -> Vec<[u32; 2]> {
    let bodies = snapshot.bodies.iter().map(|body| (&body.mesh, body.vertices.start));
    let membranes = snapshot.membranes.iter().map(|membrane| (&membrane.mesh, membrane.vertices.start));
    let outlines = bodies.chain(membranes).flat_map(|(mesh, first)| {
        let edges = mesh.boundary_edges();
        edges.into_iter().map(move |ends| ends.map(|end| end + first as u32)).collect::<Vec<_>>()
    });
    let springs = snapshot.nets.iter().flat_map(|net| net.springs.links());
    let springs = springs.filter(|link| link.role == Role::Structural).map(|link| link.ends);
    outlines.chain(springs).collect()
}

//! Probes on the stage: what a click means, and marks at what is probed.

use crate::{
    app::{
        draw::{View, legends, shape_buffer::ShapeBuffer},
        probes::Target,
    },
    snapshot::Snapshot,
};
use eframe::egui::{Painter, Pos2, Rect, Vec2, vec2};
use std::f32::consts::TAU;

/// A mark at a probe.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProbeMark {
    /// What is probed.
    pub target: Target,
    /// Its short name.
    pub label: String,
}

/// Probes of a stage.
#[derive(Default)]
pub struct Probing {
    /// Marks of all probes.
    pub marks: Vec<ProbeMark>,
    /// Whether what is under the pointer is probed in this frame.
    pub now: bool,
    /// What was probed.
    pub found: Option<Target>,
}

/// What is meant at a point of the screen: the triangle there, unless the nearest vertex is far nearer than its middle.
pub fn target(
    snapshot: &Snapshot,
    points: &[Pos2],
    at: Pos2,
    (triangle, vertex): (Option<usize>, Option<usize>),
) -> Option<Target> {
    /// Distance of a vertex, as a fraction of that of the middle of the triangle.
    const NEAR: f32 = 0.6;
    let Some(triangle) = triangle else { return vertex.map(Target::Vertex) };
    let middle = middle(&corners(snapshot, points, triangle)?);
    let near = vertex
        .filter(|vertex| points.get(*vertex).is_some_and(|point| point.distance(at) < NEAR * middle.distance(at)));
    Some(near.map_or(Target::Triangle(triangle), Target::Vertex))
}

/// Corners of a triangle on the screen.
pub(super) fn corners(snapshot: &Snapshot, points: &[Pos2], triangle: usize) -> Option<[Pos2; 3]> {
    let bodies = snapshot.triangles.len();
    let membranes = || snapshot.membranes.iter().flat_map(|membrane| membrane.elements.corners());
    let corners = match triangle.checked_sub(bodies) {
        None => snapshot.triangles.get(triangle),
        Some(triangle) => membranes().nth(triangle),
    };
    let [a, b, c] = corners?.map(|corner| points.get(corner as usize).copied());
    Some([a?, b?, c?])
}

fn middle(corners: &[Pos2; 3]) -> Pos2 {
    let [a, b, c] = corners.map(Pos2::to_vec2);
    ((a + b + c) / 3.0).to_pos2()
}

/// Draws a closed line that is seen on any ground.
fn outline(buffer: &mut ShapeBuffer, view: View, points: &[Pos2]) {
    buffer.line(points, true, 5.0, view.theme.card);
    buffer.line(points, true, 2.0, view.theme.annotation);
}

impl Probing {
    /// Draws the marks.
    pub fn draw(&self, buffer: &mut ShapeBuffer, view: View, snapshot: &Snapshot, points: &[Pos2]) {
        for mark in &self.marks {
            match mark.target {
                Target::Vertex(vertex) => {
                    let Some(at) = points.get(vertex) else { continue };
                    let around = (0..24_u8).map(|i| *at + 6.0 * Vec2::angled(TAU * f32::from(i) / 24.0));
                    outline(buffer, view, &around.collect::<Vec<_>>());
                }
                Target::Triangle(triangle) => {
                    let Some(corners) = corners(snapshot, points, triangle) else { continue };
                    outline(buffer, view, &corners);
                }
            }
        }
    }

    /// Writes the labels.
    pub fn write(&self, painter: &Painter, view: View, canvas: Rect, snapshot: &Snapshot, points: &[Pos2]) {
        for mark in &self.marks {
            let at = match mark.target {
                Target::Vertex(vertex) => points.get(vertex).copied(),
                Target::Triangle(triangle) => corners(snapshot, points, triangle).map(|corners| middle(&corners)),
            };
            if let Some(at) = at.filter(|at| canvas.contains(*at)) {
                legends::tag(painter, view, canvas, at + vec2(9.0, -9.0), &mark.label);
            }
        }
    }
}

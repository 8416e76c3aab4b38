//! A ruler on the stage: the distance of two points that are clicked, or of the ends of a drag, and the angle at the second of three.

use super::pointer_state::Sight;
use crate::{
    app::{
        draw::{View, legends, shape_buffer::ShapeBuffer},
        numbers,
    },
    snapshot::Snapshot,
};
use eframe::egui::{Painter, PointerButton, Pos2, Rect, Response, Vec2, vec2};

/// Most points.
const MOST: usize = 3;

/// Distance at which a vertex is taken in place of the point of a click [points].
const NEAR: f32 = 10.0;

/// Radius of the arc of an angle [points].
const ARC: f32 = 26.0;

/// A point of a ruler.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Mark {
    /// A vertex, by its number in the scene. The ruler moves with it.
    Vertex(usize),
    /// A place in the plane \[m\].
    Place([f64; 2]),
}

/// What a ruler measures now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// From its first point to its second \[m\]; in the plane without the last coordinate.
    pub along: [f64; 3],
    /// Distance of the two at the start \[m\], if both are vertices.
    pub at_start: Option<f64>,
    /// Angle at the second point between the first and the third \[rad\], if there are three.
    pub corner: Option<f64>,
}

impl Measured {
    /// Distance of the first two points \[m\].
    pub fn length(&self) -> f64 {
        length(self.along)
    }

    /// Angle of their line from the direction of x, anticlockwise in the plane \[rad\].
    pub fn slope(&self) -> f64 {
        libm::atan2(self.along[1], self.along[0])
    }

    /// Distance over that at the start, if this is known.
    pub fn stretch(&self) -> Option<f64> {
        self.at_start.filter(|start| *start > 0.0).map(|start| self.length() / start)
    }
}

/// A ruler with its points, of which there are up to three.
#[derive(Default)]
pub struct Ruler {
    marks: Vec<Mark>,
    /// Name and number of vertices of the scene that it belongs to, and its number of dimensions.
    scene: (String, usize, usize),
    /// Whether its last point follows a drag.
    is_dragged: bool,
}

impl Ruler {
    /// Removes its points.
    pub fn clear(&mut self) {
        self.marks.clear();
        self.is_dragged = false;
    }

    /// Follows the pointer for a frame, if clicks measure. `points` are the vertices on the screen.
    pub fn follow(
        &mut self,
        response: &Response,
        sight: Sight<'_>,
        (snapshot, points): (&Snapshot, &[Pos2]),
        measures: bool,
    ) {
        let (name, count, dimension) = &mut self.scene;
        if (name.as_str(), *count, *dimension) != (snapshot.level.name.as_str(), points.len(), snapshot.dimension) {
            name.clone_from(&snapshot.level.name);
            (*count, *dimension) = (points.len(), snapshot.dimension);
            self.clear();
        }
        if !measures {
            self.is_dragged = false;
            return;
        }
        let at = response.interact_pointer_pos().or(response.hover_pos());
        if response.drag_started_by(PointerButton::Primary) {
            let origin = response.ctx.input(|input| input.pointer.press_origin());
            self.marks.clear();
            self.marks.extend(origin.and_then(|origin| mark(sight, points, origin)));
            self.is_dragged = !self.marks.is_empty();
        }
        if self.is_dragged {
            self.marks.truncate(1);
            self.marks.extend(at.and_then(|at| mark(sight, points, at)));
            self.is_dragged = response.dragged_by(PointerButton::Primary);
        } else if response.clicked_by(PointerButton::Primary) {
            if self.marks.len() >= MOST {
                self.marks.clear();
            }
            self.marks.extend(at.and_then(|at| mark(sight, points, at)));
        }
    }

    /// What it measures; `None` with fewer than two points.
    pub fn measured(&self, snapshot: &Snapshot) -> Option<Measured> {
        let places: Vec<_> = self.marks.iter().filter_map(|mark| mark.place(snapshot, &snapshot.positions)).collect();
        let [first, second, ..] = places[..] else { return None };
        let along = minus(second, first);
        let is_vertex = |mark: &Mark| matches!(mark, Mark::Vertex(_));
        let at_start = || {
            let [first, second] = [0, 1].map(|end| self.marks[end].place(snapshot, &snapshot.start));
            Some(length(minus(second?, first?)))
        };
        let at_start = if self.marks[..2].iter().all(is_vertex) { at_start() } else { None };
        let corner = places.get(2).map(|third| {
            let [a, b] = [minus(first, second), minus(*third, second)];
            let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
            libm::atan2(length(cross), (0..3).map(|axis| a[axis] * b[axis]).sum())
        });
        Some(Measured { along, at_start, corner })
    }

    /// Its points on the screen.
    fn seen(&self, sight: Sight<'_>, points: &[Pos2]) -> Vec<Pos2> {
        let seen = |mark: &Mark| match *mark {
            Mark::Vertex(vertex) => points.get(vertex).copied(),
            Mark::Place([x, y]) => Some(sight.seen([x, y, 0.0])),
        };
        self.marks.iter().filter_map(seen).collect()
    }

    /// Draws its lines and points, and the arc of its angle.
    pub fn draw(&self, buffer: &mut ShapeBuffer, view: View, sight: Sight<'_>, points: &[Pos2]) {
        let seen = self.seen(sight, points);
        let mut line = |points: &[Pos2]| {
            buffer.line(points, false, 4.0, view.theme.card);
            buffer.line(points, false, 1.8, view.theme.annotation);
        };
        line(&seen);
        if let [first, second, third] = seen[..] {
            let [a, b] = [first, third].map(|end| (end - second).angle());
            // The smaller of the two angles between the lines.
            let turn = std::f32::consts::TAU;
            let by = (b - a).rem_euclid(turn);
            let by = if by > 0.5 * turn { by - turn } else { by };
            let arc: Vec<_> = (0..=16_u8).map(|i| second + ARC * Vec2::angled(a + by * f32::from(i) / 16.0)).collect();
            line(&arc);
        }
        for at in seen {
            buffer.disc(at, 5.0, view.theme.card);
            buffer.disc(at, 3.5, view.theme.annotation);
        }
    }

    /// Writes the distance, and the angle if there is one.
    pub fn write(
        &self,
        painter: &Painter,
        (view, canvas): (View, Rect),
        snapshot: &Snapshot,
        (sight, points): (Sight<'_>, &[Pos2]),
    ) {
        let (Some(measured), seen) = (self.measured(snapshot), self.seen(sight, points)) else { return };
        let [first, second, ..] = seen[..] else { return };
        let stretch = measured.stretch().map_or_else(String::new, |stretch| format!("  ×{stretch:.3}"));
        let text = format!("{}{stretch}", numbers::si(measured.length(), "m"));
        legends::tag(painter, view, canvas, first.lerp(second, 0.5) + vec2(8.0, -8.0), &text);
        if let Some(corner) = measured.corner {
            let text = format!("{:.1}°", corner.to_degrees());
            legends::tag(painter, view, canvas, second + vec2(12.0, 26.0), &text);
        }
    }
}

impl Mark {
    /// Where it is \[m\], with the positions of the vertices; a vertex that is not there is nowhere.
    fn place(self, snapshot: &Snapshot, positions: &[f64]) -> Option<[f64; 3]> {
        let mut place = [0.0; 3];
        match self {
            Self::Vertex(vertex) => {
                let size = snapshot.dimension;
                let own = positions.get(size * vertex..size * (vertex + 1))?;
                place[..size].copy_from_slice(own);
            }
            Self::Place(own) => place[..2].copy_from_slice(&own),
        }
        Some(place)
    }
}

/// What is meant at a point of the screen: a vertex near it, or the place in the plane.
pub(super) fn mark(sight: Sight<'_>, points: &[Pos2], at: Pos2) -> Option<Mark> {
    let vertex = sight.nearest(points, at);
    match sight {
        Sight::Space(..) => vertex.map(Mark::Vertex),
        Sight::Plane(camera) => {
            let near = vertex.filter(|vertex| points[*vertex].distance(at) <= NEAR);
            Some(near.map_or_else(|| Mark::Place(camera.world_from_screen(at)), Mark::Vertex))
        }
    }
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|part| part * part).sum::<f64>().sqrt()
}

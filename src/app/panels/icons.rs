//! Icons of buttons, drawn with lines.

use eframe::egui::{self, Color32, Mesh, Painter, Pos2, Shape, Stroke, Vec2, pos2, vec2};
use std::f32::consts::{FRAC_PI_2, PI, TAU};

/// Icon of a button.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Icon {
    /// Run.
    Play,
    /// Pause.
    Pause,
    /// Take one step.
    Step,
    /// Go back in time.
    Back,
    /// Start over.
    Reset,
    /// Undo.
    Undo,
    /// Redo.
    Redo,
    /// Light theme.
    Sun,
    /// Dark theme.
    Moon,
    /// Help.
    Help,
    /// The panel on the left.
    Left,
    /// The panel on the right.
    Right,
    /// Close.
    Close,
}

impl Icon {
    /// Draws the icon centred at a point, 14 points wide.
    pub fn paint(self, painter: &Painter, at: Pos2, color: Color32) {
        let stroke = Stroke::new(1.6, color);
        let p = |x: f32, y: f32| at + vec2(x, y);
        match self {
            Self::Play => fill(painter, vec![p(-4.5, -6.0), p(6.5, 0.0), p(-4.5, 6.0)], color),
            Self::Pause => {
                for x in [-4.5, 1.5] {
                    fill(painter, vec![p(x, -5.5), p(x + 3.0, -5.5), p(x + 3.0, 5.5), p(x, 5.5)], color);
                }
            }
            Self::Step => {
                fill(painter, vec![p(-6.0, -5.5), p(2.5, 0.0), p(-6.0, 5.5)], color);
                fill(painter, vec![p(3.5, -5.5), p(6.0, -5.5), p(6.0, 5.5), p(3.5, 5.5)], color);
            }
            Self::Back => {
                for x in [-6.0, 0.5] {
                    fill(painter, vec![p(x, 0.0), p(x + 5.5, -5.5), p(x + 5.5, 5.5)], color);
                }
            }
            Self::Reset => {
                arc(painter, at, 5.5, -0.15 * PI, 1.35 * PI, stroke);
                head(painter, at + 5.5 * Vec2::angled(-0.15 * PI), -0.15 * PI - FRAC_PI_2, color);
            }
            Self::Undo | Self::Redo => turn_arrow(painter, at, self == Self::Undo, stroke),
            Self::Sun => sun(painter, at, stroke),
            Self::Moon => moon(painter, at, stroke),
            Self::Help => {
                arc(painter, p(0.0, -3.0), 3.3, -PI, 0.35 * PI, stroke);
                painter.line_segment([p(1.5, -0.1), p(0.0, 2.6)], stroke);
                painter.circle_filled(p(0.0, 5.8), 1.2, color);
            }
            Self::Left | Self::Right => {
                let corners = [p(-7.0, -5.5), p(7.0, -5.5), p(7.0, 5.5), p(-7.0, 5.5), p(-7.0, -5.5)];
                painter.line(corners.to_vec(), stroke);
                let x = if self == Self::Left { -7.0 } else { 2.0 };
                fill(painter, vec![p(x, -5.5), p(x + 5.0, -5.5), p(x + 5.0, 5.5), p(x, 5.5)], color);
            }
            Self::Close => {
                painter.line_segment([p(-4.0, -4.0), p(4.0, 4.0)], stroke);
                painter.line_segment([p(-4.0, 4.0), p(4.0, -4.0)], stroke);
            }
        }
    }
}

fn fill(painter: &Painter, points: Vec<Pos2>, color: Color32) {
    painter.add(Shape::convex_polygon(points, color, Stroke::NONE));
}

/// Draws an arc of a circle. Angles are measured clockwise from the right.
fn arc(painter: &Painter, center: Pos2, radius: f32, from: f32, to: f32, stroke: Stroke) {
    let points = (0..=24).map(|i| center + radius * Vec2::angled(egui::lerp(from..=to, i as f32 / 24.0)));
    painter.line(points.collect(), stroke);
}

/// Draws a small triangle at `tip` that points along `angle`.
fn head(painter: &Painter, tip: Pos2, angle: f32, color: Color32) {
    let (along, across) = (Vec2::angled(angle), Vec2::angled(angle + FRAC_PI_2));
    fill(painter, vec![tip + 3.6 * along, tip - 1.2 * along + 3.4 * across, tip - 1.2 * along - 3.4 * across], color);
}

fn turn_arrow(painter: &Painter, at: Pos2, left: bool, stroke: Stroke) {
    let side = if left { 1.0 } else { -1.0 };
    let p = |x: f32, y: f32| pos2(at.x + side * x, at.y + y);
    let bend = (0..=16).map(|i| {
        let angle = egui::lerp(-FRAC_PI_2..=FRAC_PI_2, i as f32 / 16.0);
        p(2.0 + 3.8 * angle.cos(), 1.2 + 3.8 * angle.sin())
    });
    let line = std::iter::once(p(-4.0, -2.6)).chain(bend).chain([p(-3.0, 5.0)]);
    painter.line(line.collect(), stroke);
    fill(painter, vec![p(-7.0, -2.6), p(-2.6, -6.2), p(-2.6, 1.0)], stroke.color);
}

fn sun(painter: &Painter, at: Pos2, stroke: Stroke) {
    painter.circle_filled(at, 3.4, stroke.color);
    for ray in 0..8 {
        let along = Vec2::angled(TAU * ray as f32 / 8.0);
        painter.line_segment([at + 5.0 * along, at + 7.2 * along], stroke);
    }
}

/// Draws a crescent: a disk minus another disk. It is not convex, so it is a strip of triangles between two arcs.
fn moon(painter: &Painter, at: Pos2, stroke: Stroke) {
    let (shift, outer, inner) = (vec2(3.0, -2.4), 6.4_f32, 5.4_f32);
    let apart = shift.length();
    // Angles at which the circles cross, seen from each centre and measured from the direction of the shift.
    let crossing = (apart * apart + outer * outer - inner * inner) / (2.0 * apart);
    let (from_outer, from_inner) = ((crossing / outer).acos(), ((crossing - apart) / inner).acos());
    let along = |middle: Pos2, radius: f32, first: f32, t: f32| {
        middle + radius * Vec2::angled(shift.angle() + egui::lerp(first..=TAU - first, t))
    };
    let mut mesh = Mesh::default();
    for i in 0..=24 {
        let t = i as f32 / 24.0;
        mesh.colored_vertex(along(at, outer, from_outer, t), stroke.color);
        mesh.colored_vertex(along(at + shift, inner, from_inner, t), stroke.color);
    }
    for i in 0..48 {
        mesh.add_triangle(i, i + 1, i + 2);
    }
    let rim = mesh.vertices.iter().step_by(2).chain(mesh.vertices.iter().skip(1).step_by(2).rev());
    let rim = rim.map(|vertex| vertex.pos).collect();
    painter.add(mesh);
    // The line along the rim smooths the edge, which the triangles alone do not.
    painter.add(Shape::closed_line(rim, Stroke::new(0.6, stroke.color)));
}

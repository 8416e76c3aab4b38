//! Draws the gingerbread house; its inner faces are the contact surfaces.

use super::{View, roof, shape_buffer::ShapeBuffer};
use eframe::egui::{Color32, Pos2, Rect, lerp, pos2};

/// Thickness of walls, floor and roof [m].
pub const THICKNESS: f64 = 0.05;

/// Depths below the floor of the snow behind and in front of the house [m].
const HILLS: [f64; 2] = [0.03, 0.055];

/// Kind of an edge of the room.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Lower edge.
    Floor,
    /// Side edge.
    Wall,
    /// Upper edge.
    Roof,
    /// Edge of the world, without a wall.
    Open,
}

/// One edge of the room, counter-clockwise.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// Kind of the edge.
    pub kind: Kind,
    /// Ends on the inner face [m].
    pub ends: [[f64; 2]; 2],
    /// Ends on the outer face [m].
    pub outer: [[f64; 2]; 2],
    /// Outward unit normal.
    pub out: [f64; 2],
}

/// Draws in world coordinates with the colours of the theme.
pub struct Baker<'a> {
    pub(super) buffer: &'a mut ShapeBuffer,
    pub(super) view: View,
    pub(super) presence: f32,
}

impl Baker<'_> {
    pub(super) fn color(&self, color: Color32) -> Color32 {
        self.view.theme.present(color, self.presence)
    }

    fn points(&self, points: &[[f64; 2]]) -> Vec<Pos2> {
        points.iter().map(|&point| self.view.camera.screen_from_world(point)).collect()
    }

    pub(super) fn area(&mut self, points: &[[f64; 2]], color: Color32) {
        let (points, color) = (self.points(points), self.color(color));
        self.buffer.area(&points, color);
    }

    pub(super) fn line(&mut self, points: &[[f64; 2]], width: f32, color: Color32) {
        let (points, color) = (self.points(points), self.color(color));
        self.buffer.line(&points, false, self.view.size(width, 1.2, 100.0), color);
    }

    pub(super) fn disc(&mut self, at: [f64; 2], radius: f32, color: Color32) {
        let (at, color) = (self.view.camera.screen_from_world(at), self.color(color));
        self.buffer.disc(at, self.view.camera.length(radius), color);
    }

    /// Draws a candy button with a highlight.
    pub(super) fn button(&mut self, at: [f64; 2], radius: f32, color: Color32) {
        self.disc([at[0], at[1] - 0.1 * f64::from(radius)], 1.18 * radius, self.view.theme.wall_shade);
        self.disc(at, radius, color);
        let light = 0.3 * f64::from(radius);
        self.disc([at[0] - light, at[1] + light], 0.24 * radius, color.lerp_to_gamma(Color32::WHITE, 0.7));
    }
}

/// Point between two others, or beyond them.
pub(super) fn between(a: [f64; 2], b: [f64; 2], share: f64) -> [f64; 2] {
    [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]
}

/// Point moved along a direction.
pub(super) fn moved(point: [f64; 2], direction: [f64; 2], by: f64) -> [f64; 2] {
    [point[0] + by * direction[0], point[1] + by * direction[1]]
}

/// Draws the house around a convex room, with snow across the canvas.
pub fn house(buffer: &mut ShapeBuffer, view: View, canvas: Rect, room: &[[f64; 2]], presence: f32) {
    let sides = sides(room);
    let mut baker = Baker { buffer, view, presence };
    let floor = sides.iter().find(|side| side.kind == Kind::Floor).map(|side| side.ends[0][1]);
    if let Some(floor) = floor {
        ground(&mut baker, canvas, floor - HILLS[0], 0.4);
    }
    roof::chimney(&mut baker, &sides);
    inside(&mut baker, room);
    windows(&mut baker, room, &sides);
    for kind in [Kind::Floor, Kind::Wall] {
        sides.iter().filter(|side| side.kind == kind).for_each(|side| wall(&mut baker, side));
    }
    roof::roof(&mut baker, &sides);
    seam(&mut baker, &sides);
    if let Some(floor) = floor {
        ground(&mut baker, canvas, floor - HILLS[1], 2.6);
    }
}

/// Draws icing along the inner faces; bodies touch its inner rim.
fn seam(baker: &mut Baker<'_>, sides: &[Side]) {
    let icing = baker.view.theme.icing;
    let (half, width) = (0.006 / THICKNESS, 0.012);
    let end = |side: &Side, i: usize| between(side.ends[i], side.outer[i], half);
    for side in sides.iter().filter(|side| side.kind != Kind::Open) {
        // The round ends of the lines form the corners.
        baker.line(&[end(side, 0), end(side, 1)], width, icing);
    }
}

fn sides(room: &[[f64; 2]]) -> Vec<Side> {
    let count = room.len();
    let out = |i: usize| {
        let ([ax, ay], [bx, by]) = (room[i % count], room[(i + 1) % count]);
        let length = (bx - ax).hypot(by - ay).max(1e-12);
        [(by - ay) / length, (ax - bx) / length]
    };
    // A corner of the outer face has the same distance from both neighbouring inner faces.
    let corner = |i: usize| {
        let (a, b) = (out(i + count - 1), out(i));
        let cosine = (1.0 + a[0] * b[0] + a[1] * b[1]).max(0.5);
        moved(room[i % count], [a[0] + b[0], a[1] + b[1]], THICKNESS / cosine)
    };
    (0..count)
        .map(|i| {
            let ends = [room[i], room[(i + 1) % count]];
            Side { kind: kind(ends, out(i)), ends, outer: [corner(i), corner(i + 1)], out: out(i) }
        })
        .collect()
}

fn kind(ends: [[f64; 2]; 2], out: [f64; 2]) -> Kind {
    let on = |axis: usize, at: f64| ends.iter().all(|end| (end[axis] - at).abs() < 1e-9);
    let worlds_end = on(0, 0.0) || on(0, 1.0) || on(1, 0.0) || on(1, 1.0);
    match out[1] {
        _ if worlds_end => Kind::Open,
        up if up < -0.7 => Kind::Floor,
        up if up < 0.3 => Kind::Wall,
        _ => Kind::Roof,
    }
}

/// Draws snow hills on the ground.
fn ground(baker: &mut Baker<'_>, canvas: Rect, level: f64, shift: f32) {
    let [near, far] = baker.view.theme.ground.map(|color| baker.color(color));
    let base = baker.view.camera.screen_from_world([0.0, level]).y;
    let height = baker.view.camera.length(0.012);
    let steps = 48;
    for i in 0..=steps {
        let x = lerp(canvas.x_range(), i as f32 / steps as f32);
        let along = baker.view.camera.world_from_screen(pos2(x, 0.0))[0] as f32;
        let y = base - height * ((3.1 * along + shift).sin() + 0.6 * (7.3 * along + 5.0 * shift).sin());
        let [top, bottom] =
            [(y, near), (canvas.bottom().max(y), far)].map(|(y, color)| baker.buffer.vertex(pos2(x, y), color));
        if i > 0 {
            baker.buffer.triangle(top - 2, top, bottom);
            baker.buffer.triangle(top - 2, bottom, bottom - 2);
        }
    }
}

/// Draws the wall behind the bodies.
fn inside(baker: &mut Baker<'_>, room: &[[f64; 2]]) {
    let points = baker.points(room);
    let [top, bottom] = baker.view.theme.inside.map(|color| baker.color(color));
    let bounds = Rect::from_points(&points);
    baker.buffer.shaded(&points, |at| top.lerp_to_gamma(bottom, (at.y - bounds.top()) / bounds.height().max(1.0)));
}

/// Draws two windows in the back wall, in weak colours so that bodies in front stand out.
fn windows(baker: &mut Baker<'_>, room: &[[f64; 2]], sides: &[Side]) {
    let theme = baker.view.theme;
    let extent = |axis: usize| {
        let all = || room.iter().map(|corner| corner[axis]);
        [all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max)]
    };
    let ([left, right], [bottom, top]) = (extent(0), extent(1));
    let enclosed = sides.iter().all(|side| side.kind != Kind::Open);
    if !enclosed || right - left < 0.6 || top - bottom < 0.6 {
        return;
    }
    let [pane, frame] = theme.window;
    let y = bottom + 0.42 * (top - bottom);
    for x in [left + 0.12, right - 0.12] {
        let (w, h) = (0.046, 0.065);
        let corners = [[x - w, y - h], [x + w, y - h], [x + w, y + h], [x - w, y + h]];
        baker.area(&corners, pane);
        baker.disc([x - 0.4 * w, y + 0.45 * h], 0.0022, theme.snow);
        baker.disc([x + 0.55 * w, y + 0.7 * h], 0.0016, theme.snow);
        baker.disc([x + 0.4 * w, y - 0.4 * h], 0.0018, theme.snow);
        for bar in [[[x, y - h], [x, y + h]], [[x - w, y], [x + w, y]]] {
            baker.line(&bar, 0.006, frame);
        }
        for i in 0..4 {
            baker.line(&[corners[i], corners[(i + 1) % 4]], 0.01, frame);
        }
        baker.line(&[[x - 1.35 * w, y - h], [x + 1.35 * w, y - h]], 0.014, frame);
    }
}

/// Draws a wall or the floor: dough with candy.
fn wall(baker: &mut Baker<'_>, side: &Side) {
    let theme = baker.view.theme;
    let ([a, b], [c, d]) = (side.ends, side.outer);
    baker.area(&[a, c, d, b], theme.wall);
    let shade = [0.72, 1.0].map(|share| [between(a, c, share), between(b, d, share)]);
    baker.area(&[shade[0][0], shade[1][0], shade[1][1], shade[0][1]], theme.wall_shade);
    let length = (b[0] - a[0]).hypot(b[1] - a[1]);
    let count = (length / 0.1).floor().max(1.0) as usize;
    for i in 0..count {
        let at = between(
            between(a, b, (i as f64 + 0.5) / count as f64),
            between(c, d, (i as f64 + 0.5) / count as f64),
            0.52,
        );
        baker.button(at, 0.0105, theme.candy[i % 2]);
    }
}

#[cfg(test)]
mod tests {
    use super::{Kind, sides};

    #[test]
    fn knows_floor_walls_roof_and_where_the_world_ends() {
        let room = [[0.05, 0.1], [0.95, 0.1], [0.95, 0.6], [0.5, 1.0], [0.05, 0.6]];
        let kinds: Vec<Kind> = sides(&room).iter().map(|side| side.kind).collect();
        assert_eq!(kinds, [Kind::Floor, Kind::Wall, Kind::Roof, Kind::Roof, Kind::Wall]);
        let open = [[0.0, 0.1], [1.0, 0.1], [1.0, 1.0], [0.0, 1.0]];
        let kinds: Vec<Kind> = sides(&open).iter().map(|side| side.kind).collect();
        assert_eq!(kinds, [Kind::Floor, Kind::Open, Kind::Open, Kind::Open]);
    }
}

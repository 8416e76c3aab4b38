//! Draws the surroundings of bodies: the gingerbread house with its roof, obstacles, the domain boundary, sky and snow.
//!
//! The inner faces of the house are the contact surfaces.

use super::{View, scatter, shape_buffer::ShapeBuffer};
use eframe::egui::{Color32, CornerRadius, Painter, Pos2, Rect, Stroke, StrokeKind, lerp, pos2, vec2};

/// Thickness of walls, floor and roof \[m\].
const THICKNESS: f64 = 0.05;

/// Depths below the floor of the snow behind and in front of the house \[m\].
const HILLS: [f64; 2] = [0.03, 0.055];

/// Kind of an edge of the room.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
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
struct Side {
    /// Kind of the edge.
    pub kind: Kind,
    /// Ends on the inner face \[m\].
    pub ends: [[f64; 2]; 2],
    /// Ends on the outer face \[m\].
    pub outer: [[f64; 2]; 2],
    /// Outward unit normal.
    pub out: [f64; 2],
}

/// Draws in world coordinates with the colours of the theme.
struct Baker<'a> {
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
fn between(a: [f64; 2], b: [f64; 2], share: f64) -> [f64; 2] {
    [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]
}

/// Point moved along a direction.
fn moved(point: [f64; 2], direction: [f64; 2], by: f64) -> [f64; 2] {
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
    chimney(&mut baker, &sides);
    inside(&mut baker, room);
    windows(&mut baker, room, &sides);
    for kind in [Kind::Floor, Kind::Wall] {
        sides.iter().filter(|side| side.kind == kind).for_each(|side| wall(&mut baker, side));
    }
    roof(&mut baker, &sides);
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

/// Overhang of the roof beyond the walls \[m\].
const EAVES: f64 = 0.055;

/// Distance of scallops \[m\].
const SCALLOP: f64 = 0.052;

/// Slope of the roof on the inner face, from its lower to its upper end, with its outward direction.
struct Slope {
    low: [f64; 2],
    high: [f64; 2],
    out: [f64; 2],
    /// Whether the upper end is a ridge between two slopes.
    ridge: bool,
}

fn slopes(sides: &[Side]) -> impl Iterator<Item = Slope> {
    let count = sides.len();
    (0..count).filter(|&i| sides[i].kind == Kind::Roof).map(move |i| {
        let (before, here, after) = (&sides[(i + count - 1) % count], &sides[i], &sides[(i + 1) % count]);
        // In counter-clockwise order the right slope ascends and the left one descends.
        let climbs = here.ends[0][1] <= here.ends[1][1];
        let (low, high) = if climbs { (here.ends[0], here.ends[1]) } else { (here.ends[1], here.ends[0]) };
        let next = if climbs { after } else { before };
        Slope { low, high, out: here.out, ridge: next.kind == Kind::Roof }
    })
}

/// Draws all slopes and the decoration on the ridge.
fn roof(baker: &mut Baker<'_>, sides: &[Side]) {
    let theme = baker.view.theme;
    let ends: Vec<Slope> = slopes(sides).collect();
    for slope in &ends {
        boards(baker, slope);
    }
    for (color, lower) in [(theme.icing_shade, 0.006), (theme.icing, 0.0)] {
        for slope in &ends {
            blanket(baker, slope, color, lower);
        }
    }
    for slope in &ends {
        gumdrops(baker, slope);
    }
    if let Some(ridge) = ends.iter().find(|slope| slope.ridge) {
        let top = [ridge.high[0], ridge.high[1] + THICKNESS + 0.006];
        baker.disc(top, 0.026, theme.icing);
        baker.button([top[0], top[1] + 0.017], 0.02, theme.candy[0]);
    }
}

impl Slope {
    /// Point along the slope (0 at the wall, 1 at the top), moved outwards by a share of the thickness.
    fn at(&self, along: f64, out: f64) -> [f64; 2] {
        moved(between(self.low, self.high, along), self.out, out * THICKNESS)
    }

    fn length(&self) -> f64 {
        (self.high[0] - self.low[0]).hypot(self.high[1] - self.low[1]).max(1e-9)
    }

    /// Lower end of the roof, as a position along the slope.
    fn eaves(&self) -> f64 {
        -(EAVES + THICKNESS) / self.length()
    }

    /// Upper end at a share of the thickness: the slopes meet above the ridge.
    fn top(&self, out: f64) -> [f64; 2] {
        if self.ridge {
            [self.high[0], self.high[1] + out * THICKNESS / self.out[1].max(0.3)]
        } else {
            self.at(1.0, out)
        }
    }
}

/// Draws the dough.
fn boards(baker: &mut Baker<'_>, slope: &Slope) {
    let theme = baker.view.theme;
    baker.area(
        &[slope.at(slope.eaves(), 0.0), slope.at(slope.eaves(), 1.0), slope.top(1.0), slope.top(0.0)],
        theme.wall,
    );
    baker.line(&[slope.at(slope.eaves(), 0.06), slope.top(0.06)], 0.006, theme.wall_shade);
}

/// Draws the icing on top, with scallops of uneven length; `wider` extends it on all sides for its rim \[m\].
fn blanket(baker: &mut Baker<'_>, slope: &Slope, icing: Color32, wider: f32) {
    let low = slope.eaves() - 0.004;
    baker.line(&[slope.at(low, 1.05), slope.top(1.05)], 0.03 + wider, icing);
    let count = ((1.0 - low) * slope.length() / SCALLOP).round().max(1.0);
    for i in 0..=count as usize {
        let along = low + (1.0 - low) * i as f64 / count;
        let (radius, drop) = if i % 2 == 0 { (0.019, 0.82) } else { (0.0165, 0.92) };
        if along < 1.0 - 0.02 / slope.length() {
            baker.disc(slope.at(along, drop), radius + 0.5 * wider, icing);
        }
    }
}

/// Draws candy in the icing.
fn gumdrops(baker: &mut Baker<'_>, slope: &Slope) {
    let candy = baker.view.theme.candy;
    let low = slope.eaves();
    let count = ((1.0 - low) * slope.length() / (2.0 * SCALLOP)).floor().max(1.0);
    for i in 0..count as usize {
        let along = low + (1.0 - low) * (i as f64 + 0.35) / count;
        baker.button(slope.at(along, 1.12), 0.0095, candy[i % 2]);
    }
}

/// Draws a chimney on the right slope, behind the roof.
fn chimney(baker: &mut Baker<'_>, sides: &[Side]) {
    let theme = baker.view.theme;
    let Some(slope) = slopes(sides).find(|slope| slope.ridge && slope.out[0] > 0.2) else { return };
    let [x, y] = slope.at(0.45, 1.0);
    let (half, top) = (0.042, y + 0.12);
    baker.area(&[[x - half, y - 0.08], [x + half, y - 0.08], [x + half, top], [x - half, top]], theme.wall);
    baker.area(
        &[[x + 0.4 * half, y - 0.08], [x + half, y - 0.08], [x + half, top], [x + 0.4 * half, top]],
        theme.wall_shade,
    );
    for (color, wider) in [(theme.icing_shade, 0.0045), (theme.icing, 0.0)] {
        baker.line(&[[x - half, top], [x + half, top]], 0.026 + wider, color);
        for (at, drop) in [(-0.7, 0.014), (0.0, 0.022), (0.75, 0.012)] {
            baker.disc([x + at * half, top - drop], 0.012 + 0.5 * wider, color);
        }
    }
}

/// Draws a solid as a gumdrop: lighter on top, with sugar and a dark foot. `number` selects its colour.
pub fn gumdrop(buffer: &mut ShapeBuffer, view: View, outline: &[[f64; 2]], number: usize, presence: f32) {
    let points: Vec<Pos2> = outline.iter().map(|&point| view.camera.screen_from_world(point)).collect();
    if points.len() < 3 {
        return;
    }
    let color = |color| view.theme.present(color, presence);
    let candy = view.theme.candy[number % 2];
    let bounds = Rect::from_points(&points);
    let (bright, dark) = (candy.lerp_to_gamma(Color32::WHITE, 0.22), candy.lerp_to_gamma(Color32::BLACK, 0.3));
    buffer.shaded(&points, |at| color(bright.lerp_to_gamma(dark, (at.y - bounds.top()) / bounds.height().max(1.0))));
    buffer.line(&points, true, view.size(0.005, 1.5, 20.0), color(dark));
    sugar(buffer, view, &points, bounds, color(candy.lerp_to_gamma(Color32::WHITE, 0.75)));
}

/// Draws a line around a highlighted solid.
pub fn ring(buffer: &mut ShapeBuffer, view: View, outline: &[[f64; 2]], presence: f32) {
    let points: Vec<Pos2> = outline.iter().map(|&point| view.camera.screen_from_world(point)).collect();
    buffer.line(&points, true, view.size(0.009, 3.0, 20.0), view.theme.accent_line.gamma_multiply(presence));
}

/// Draws sugar grains inside an outline.
fn sugar(buffer: &mut ShapeBuffer, view: View, outline: &[Pos2], bounds: Rect, color: Color32) {
    let size = view.size(0.0028, 0.8, 8.0);
    let world = view.camera.length(1.0);
    let count = (1800.0 * bounds.area() / (world * world)).clamp(8.0, 300.0) as usize;
    for grain in 0..count {
        let at = bounds.min + vec2(scatter(grain, 11), scatter(grain, 12)) * bounds.size();
        if is_inside(outline, at) {
            buffer.disc(at, size * (0.6 + 0.6 * scatter(grain, 13)), color.gamma_multiply(0.8));
        }
    }
}

/// Whether a point lies inside an outline, by the number of edges to its right.
fn is_inside(outline: &[Pos2], at: Pos2) -> bool {
    let mut inside = false;
    for (i, a) in outline.iter().enumerate() {
        let b = outline[(i + 1) % outline.len()];
        if (a.y > at.y) != (b.y > at.y) && at.x < a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x) {
            inside = !inside;
        }
    }
    inside
}

/// Draws the boundary of the domain as a thread of icing.
pub fn edges(buffer: &mut ShapeBuffer, view: View, [least, greatest]: [[f64; 2]; 2], presence: f32) {
    let corners = [least, [greatest[0], least[1]], greatest, [least[0], greatest[1]]];
    let points = corners.map(|corner| view.camera.screen_from_world(corner));
    let color = view.theme.world_edge.gamma_multiply(presence);
    buffer.line(&points, true, view.size(0.003, 1.5, 8.0), color);
}

/// Slow sparse snow, which falls only while simulated time runs.
#[derive(Debug, Default)]
pub struct Snow {
    /// Time that the snow has fallen \[s\].
    time: f32,
}

impl Snow {
    /// Advances the snow by a time \[s\].
    pub fn fall(&mut self, dt: f32) {
        self.time += dt;
    }

    /// Draws the flakes.
    pub fn draw(&self, buffer: &mut ShapeBuffer, canvas: Rect, view: View) {
        let count = (canvas.area() / 9000.0).clamp(24.0, 240.0) as usize;
        let unit = (canvas.height() / 700.0).clamp(0.8, 2.5);
        for flake in 0..count {
            let near = scatter(flake, 1);
            let across = scatter(flake, 2) + 0.012 * (self.time * (0.3 + 0.4 * near) + 40.0 * near).sin();
            let down = (scatter(flake, 3) + self.time * (0.006 + 0.016 * near)).fract();
            let at = pos2(canvas.left() + canvas.width() * across, canvas.top() + canvas.height() * down);
            buffer.disc(at, unit * (0.7 + 1.5 * near * near), view.theme.snow.gamma_multiply(0.2 + 0.55 * near));
        }
    }
}

/// Draws the sky.
pub fn sky(buffer: &mut ShapeBuffer, canvas: Rect, view: View) {
    buffer.gradient(canvas, view.theme.sky);
}

/// Draws the world square, where there is no house.
pub fn square(painter: &Painter, view: View, presence: f32) {
    let (theme, corner) = (view.theme, CornerRadius::same(2));
    let world = view.camera.world();
    painter.rect_filled(world, corner, theme.world.gamma_multiply(presence));
    let edge = Stroke::new(1.0, theme.world_edge.gamma_multiply(presence));
    painter.rect_stroke(world, corner, edge, StrokeKind::Inside);
}

#[cfg(test)]
mod tests {
    use super::*;

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

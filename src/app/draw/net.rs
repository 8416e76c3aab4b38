//! Draws nets: springs and particles; and toys: the exact path, the exact point and the computed point.

use super::{
    View,
    body::dots,
    scatter,
    shape_buffer::{Detail, Fill, ShapeBuffer},
};
use crate::{
    app::canvas::Options,
    effects::EffectKind,
    nets::{Link, Role},
    snapshot::{NetSnapshot, Snapshot, ToySnapshot},
};
use eframe::egui::{Color32, Pos2, Vec2, vec2};
use std::{collections::VecDeque, f32::consts::TAU};

/// Maximum number of springs that are drawn as coils.
const FEW: usize = 24;

/// Relative change of length at which the colour of a spring is saturated.
const STRAIN: f64 = 0.25;

/// Draws all nets at their vertices.
pub fn nets(
    (buffer, fill): (&mut ShapeBuffer, &mut Fill),
    view: View,
    snapshot: &Snapshot,
    options: &Options,
    points: &[Pos2],
) {
    for net in &snapshot.nets {
        let ends = net.springs.links().iter().map(|link| link.ends);
        let length = fill.lines(points, ends, 1.0);
        let width = view.size(0.0042, 1.6, 9.0);
        match fill.choose([width * length, length]) {
            Detail::Full => {}
            Detail::Outline => {
                let structural = net.springs.links().iter().filter(|link| link.role == Role::Structural);
                for link in structural {
                    let [Some(&from), Some(&to)] = link.ends.map(|end| points.get(end as usize)) else { continue };
                    string(buffer, [from, to], 1.0, view.theme.icing);
                }
                continue;
            }
            Detail::Points => {
                dots(buffer, points.get(net.vertices.clone()).unwrap_or_default(), view.theme.icing);
                continue;
            }
        }
        let is_rigid = has_rods(snapshot, net);
        let coiled = net.springs.links().len() <= FEW;
        // Flexion springs lie over the structural ones, which they would only thicken.
        for role in [Role::Flexion, Role::Shear, Role::Structural] {
            let seen = role != Role::Flexion || options.wireframe;
            for link in net.springs.links().iter().filter(|link| seen && link.role == role) {
                let [Some(&from), Some(&to)] = link.ends.map(|end| points.get(end as usize)) else { continue };
                let color = color(view, link, net.springs.length(link, &snapshot.positions));
                match role {
                    Role::Structural if is_rigid => rod(buffer, view, from, to),
                    Role::Structural if coiled => coil(buffer, view, [from, to], link, color),
                    Role::Structural => string(buffer, [from, to], view.size(0.0042, 1.6, 9.0), color),
                    Role::Shear => string(buffer, [from, to], view.size(0.0022, 1.0, 5.0), color.gamma_multiply(0.4)),
                    Role::Flexion => string(buffer, [from, to], 1.0, color.gamma_multiply(0.3)),
                }
            }
        }
        candies(buffer, view, net, points);
    }
}

/// Whether the structural springs of a net are rigid rods.
fn has_rods(snapshot: &Snapshot, net: &NetSnapshot) -> bool {
    snapshot.level.effects.iter().filter(|listed| listed.switch.is_on()).any(|listed| match &listed.effect {
        EffectKind::Rods(rods) => rods.of.as_ref().is_none_or(|name| *name == net.name),
        _ => false,
    })
}

/// Draws the particles of a net in space that has few springs and no faces.
pub(super) fn particles_in_space(buffer: &mut ShapeBuffer, view: View, net: &NetSnapshot, points: &[Pos2]) {
    if net.faces.is_empty() && net.springs.links().len() <= FEW {
        for (number, &at) in points.get(net.vertices.clone()).unwrap_or_default().iter().enumerate() {
            candy(buffer, at, 5.0, view.theme.candy[number % 2]);
        }
    }
}

/// Colour of a spring: that of icing at rest, redder when stretched, bluer when compressed.
fn color(view: View, link: &Link, length: f64) -> Color32 {
    let strain = if link.rest > 0.0 { (length - link.rest) / link.rest } else { 0.0 };
    let share = (strain / STRAIN).clamp(-1.0, 1.0) as f32;
    let towards = if share > 0.0 { view.theme.candy[0] } else { view.theme.series[1] };
    view.theme.icing.lerp_to_gamma(towards, 0.85 * share.abs())
}

/// Draws a straight string.
fn string(buffer: &mut ShapeBuffer, ends: [Pos2; 2], width: f32, color: Color32) {
    let (half, soft) = (0.5 * width, 0.5 * buffer.pixel());
    let distances = [half + soft, (half - soft).max(0.0), -(half - soft).max(0.0), -half - soft];
    buffer.bands(&ends, false, &distances, &[0.0, 1.0, 1.0, 0.0], color);
}

/// Draws a coil with straight ends, which opens as the spring gets longer.
fn coil(buffer: &mut ShapeBuffer, view: View, [from, to]: [Pos2; 2], link: &Link, color: Color32) {
    const SMOOTH: u16 = 10;
    let (along, aside) = (to - from, (to - from).normalized().rot90());
    let turns = (link.rest / 0.028).clamp(4.0, 30.0) as u16;
    let (height, lead) = (view.size(0.011, 4.0, 26.0), 0.1);
    let mut line = vec![from];
    line.extend((0..=turns * SMOOTH).map(|i| {
        let share = f32::from(i) / f32::from(turns * SMOOTH);
        let wave = (TAU * f32::from(turns) * share).sin();
        from + along * (lead + (1.0 - 2.0 * lead) * share) + aside * (height * wave)
    }));
    line.push(to);
    let width = view.size(0.0046, 2.0, 11.0);
    buffer.line(&line, false, width + 2.0, view.theme.crust);
    buffer.line(&line, false, width, color);
}

/// Draws a candy for each particle, as large as the springs leave room for.
fn candies(buffer: &mut ShapeBuffer, view: View, net: &NetSnapshot, points: &[Pos2]) {
    let lengths = net.springs.links().iter().map(|link| link.rest).filter(|rest| *rest > 0.0);
    let room = lengths.fold(f64::INFINITY, f64::min).min(0.1) as f32;
    let radius = view.size((0.13 * room).clamp(0.004, 0.022), 2.0, 46.0);
    let colors = [view.theme.candy[0], view.theme.candy[1], view.theme.icing];
    for (number, &at) in points.get(net.vertices.clone()).unwrap_or_default().iter().enumerate() {
        candy(buffer, at, radius, colors[(scatter(number, 21) * 2.999) as usize]);
    }
}

/// Draws a round candy, lit from above.
pub(super) fn candy(buffer: &mut ShapeBuffer, at: Pos2, radius: f32, color: Color32) {
    buffer.disc(at + vec2(0.0, 0.14 * radius), 1.12 * radius, Color32::from_black_alpha(100));
    buffer.disc(at, radius, color.lerp_to_gamma(Color32::BLACK, 0.25));
    buffer.disc(at - vec2(0.0, 0.1 * radius), 0.84 * radius, color);
    if radius > 3.5 {
        let light = Color32::WHITE.gamma_multiply(0.75);
        buffer.disc(at - Vec2::splat(0.34 * radius), 0.2 * radius, light);
    }
}

/// Minimum distance of points of a trail \[m\].
const APART: f64 = 0.003;

/// Maximum number of points of a trail.
const LONGEST: usize = 2500;

/// Number of parts of a trail, each with one opacity.
const PARTS: usize = 40;

/// Recent path of a toy.
#[derive(Debug, Default)]
pub struct Trail {
    generation: u64,
    time: f64,
    /// Points in the world \[m\], the newest last.
    points: VecDeque<[f64; 2]>,
}

impl Trail {
    /// Records the position of the toy. It clears the trail if time went backwards or the scene has changed.
    pub fn follow(&mut self, snapshot: &Snapshot) {
        if self.generation != snapshot.generation || snapshot.time < self.time {
            self.points.clear();
            self.generation = snapshot.generation;
        }
        self.time = snapshot.time;
        let Some(toy) = &snapshot.toy else { return };
        let far = |last: &[f64; 2]| (last[0] - toy.at[0]).abs() + (last[1] - toy.at[1]).abs() > APART;
        if self.points.back().is_none_or(far) {
            self.points.push_back(toy.at);
        }
        if self.points.len() > LONGEST {
            self.points.pop_front();
        }
    }

    /// Draws the toy with its trail.
    pub fn draw(&self, buffer: &mut ShapeBuffer, view: View, snapshot: &Snapshot) {
        let Some(toy) = &snapshot.toy else { return };
        self.draw_trail(buffer, view, toy);
        let path: Vec<Pos2> = toy.path.0.iter().map(|point| view.camera.screen_from_world(*point)).collect();
        buffer.line(&path, toy.path.1, 1.5, view.theme.annotation.gamma_multiply(0.75));
        let (at, exact) = (view.camera.screen_from_world(toy.at), view.camera.screen_from_world(toy.exact));
        if let Some(pivot) = toy.pivot {
            rod(buffer, view, view.camera.screen_from_world(pivot), at);
        }
        candy(buffer, at, view.size(0.02, 8.0, 44.0), view.theme.candy[0]);
        let radius = view.size(0.027, 10.0, 56.0);
        let ring: Vec<Pos2> = (0..40).map(|i| exact + Vec2::angled(TAU / 40.0 * i as f32) * radius).collect();
        buffer.line(&ring, true, 2.0, view.theme.glow);
    }

    fn draw_trail(&self, buffer: &mut ShapeBuffer, view: View, toy: &ToySnapshot) {
        let newest = std::iter::once(&toy.at);
        let line: Vec<Pos2> =
            self.points.iter().chain(newest).map(|point| view.camera.screen_from_world(*point)).collect();
        let (width, parts) = (view.size(0.007, 2.5, 16.0), line.len().div_ceil(PARTS).max(1));
        let (half, soft) = (0.5 * width, buffer.pixel());
        for (number, first) in (0..line.len().saturating_sub(1)).step_by(parts).enumerate() {
            let part = &line[first..(first + parts + 1).min(line.len())];
            let share = (number + 1) as f32 / PARTS as f32;
            let color = view.theme.candy[0].gamma_multiply(0.08 + 0.7 * share.min(1.0));
            buffer.bands(part, false, &[half + soft, half, -half, -half - soft], &[0.0, 1.0, 1.0, 0.0], color);
        }
    }
}

/// Draws a candy stick from the pivot to the toy.
fn rod(buffer: &mut ShapeBuffer, view: View, pivot: Pos2, at: Pos2) {
    let (width, along) = (view.size(0.009, 3.0, 20.0), at - pivot);
    buffer.line(&[pivot, at], false, width + 2.0, Color32::from_black_alpha(110));
    buffer.line(&[pivot, at], false, width, view.theme.icing);
    let stripes = (along.length() / (3.0 * width)).clamp(1.0, 200.0) as u16;
    for stripe in 0..stripes {
        let from = pivot + along * ((f32::from(stripe) + 0.3) / f32::from(stripes));
        let slant = (along.normalized() + along.normalized().rot90()) * (0.42 * width);
        let step = along.normalized() * (0.9 * width);
        buffer.area(&[from - slant, from + slant, from + slant + step, from - slant + step], view.theme.candy[1]);
    }
    candy(buffer, pivot, view.size(0.013, 5.0, 30.0), view.theme.icing);
}

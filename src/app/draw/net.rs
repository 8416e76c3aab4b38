//! Draws nets: springs and particles.

use super::{
    View,
    body::dots,
    fill::{Detail, Fill},
    scatter,
    shape_buffer::ShapeBuffer,
};
use crate::{
    app::canvas::Options,
    nets::{Link, Role},
    snapshot::{NetSnapshot, Snapshot},
};
use eframe::egui::{Color32, Pos2, Vec2, vec2};
use std::f32::consts::TAU;

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
        let coiled = net.springs.links().len() <= FEW;
        // Flexion springs lie over the structural ones, which they would only thicken.
        for role in [Role::Flexion, Role::Shear, Role::Structural] {
            let seen = role != Role::Flexion || options.wireframe;
            for link in net.springs.links().iter().filter(|link| seen && link.role == role) {
                let [Some(&from), Some(&to)] = link.ends.map(|end| points.get(end as usize)) else { continue };
                let color = color(view, link, &snapshot.positions);
                match role {
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

/// Colour of a spring: that of icing at rest, redder when stretched, bluer when compressed.
fn color(view: View, link: &Link, positions: &[f64]) -> Color32 {
    let length = link.length(positions);
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

//! Draws icing that moves with the body.

use super::{View, body::gather, shape_buffer::ShapeBuffer};
use crate::meshes::{Embedded, IcingColor, Mesh};
use eframe::egui::{Pos2, vec2};

/// Point of a body on the screen, from its vertices on the screen.
pub fn place(point: &Embedded, triangles: &[[u32; 3]], points: &[Pos2]) -> Pos2 {
    let mut sum = vec2(0.0, 0.0);
    for (&vertex, &weight) in triangles[point.triangle as usize].iter().zip(&point.weights) {
        sum += points[vertex as usize].to_vec2() * weight as f32;
    }
    sum.to_pos2()
}

/// Style of a body's icing.
#[derive(Clone, Copy, Debug)]
pub struct IcingStyle {
    /// Opacity: 1 hides what is below, 0 hides the icing.
    pub opacity: f32,
    /// Scale from the mesh to the world.
    pub scale: f32,
}

/// Draws the icing strokes of the mesh, each with a small shadow below.
pub fn strokes(
    buffer: &mut ShapeBuffer,
    view: View,
    mesh: &Mesh,
    points: &[Pos2],
    line: &mut Vec<Pos2>,
    style: IcingStyle,
) {
    let theme = view.theme;
    let lift = vec2(0.0, view.size(0.0025 * style.scale, 0.7, 6.0));
    let shade = theme.crust.gamma_multiply(0.7 * style.opacity);
    for stroke in mesh.icing() {
        let color = match stroke.color {
            IcingColor::White => theme.icing,
            IcingColor::Red => theme.candy[0],
            IcingColor::Green => theme.candy[1],
        };
        line.clear();
        line.extend(stroke.points.iter().map(|point| place(point, mesh.triangles(), points) + lift));
        let width = view.camera.length(stroke.width as f32 * style.scale).max(1.5);
        for (color, back) in [(shade, vec2(0.0, 0.0)), (color.gamma_multiply(style.opacity), -lift)] {
            for point in line.iter_mut() {
                *point += back;
            }
            if stroke.filled {
                buffer.area(line, color);
            } else {
                buffer.line(line, stroke.closed, width, color);
            }
        }
    }
}

/// Draws a plain line of icing along the boundary of a body without icing strokes.
pub fn edge(
    buffer: &mut ShapeBuffer,
    view: View,
    loops: &[Vec<u32>],
    points: &[Pos2],
    line: &mut Vec<Pos2>,
    style: IcingStyle,
) {
    let (inset, half, pixel) =
        (view.size(0.016 * style.scale, 3.0, 60.0), view.size(0.003 * style.scale, 0.9, 12.0), buffer.pixel());
    for vertices in loops {
        gather(line, points, vertices);
        let distances = [-half - 0.5 * pixel, 0.5 * pixel - half, half - 0.5 * pixel, half + 0.5 * pixel];
        let color = view.theme.icing.gamma_multiply(style.opacity);
        buffer.bands(line, true, &distances.map(|distance| inset + distance), &[0.0, 1.0, 1.0, 0.0], color);
    }
}

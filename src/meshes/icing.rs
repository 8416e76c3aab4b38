//! Icing: lines and discs that are embedded in a mesh.

use super::Locator;

/// Point embedded in the body: a triangle and the weights of its three vertices, which sum to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Embedded {
    /// The triangle.
    pub triangle: u32,
    /// Weight of each corner.
    pub weights: [f64; 3],
}

impl Embedded {
    /// Present position of the point [m], for vertex positions `x` with two numbers per vertex.
    pub fn position(&self, triangles: &[[u32; 3]], x: &[f64]) -> [f64; 2] {
        let mut point = [0.0; 2];
        for (&vertex, weight) in triangles[self.triangle as usize].iter().zip(self.weights) {
            let start = 2 * vertex as usize;
            point[0] += weight * x[start];
            point[1] += weight * x[start + 1];
        }
        point
    }
}

/// Colour role of a stroke. The window's theme assigns the colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IcingColor {
    /// Royal icing.
    White,
    /// First candy.
    Red,
    /// Second candy.
    Green,
}

/// Line or area of icing, sampled finely so that it stays smooth when the body bends.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Points in drawing order, none repeated.
    pub points: Vec<Embedded>,
    /// Whether the last point joins the first.
    pub closed: bool,
    /// Whether the inside is filled, for closed strokes.
    pub filled: bool,
    /// Line width [m].
    pub width: f64,
    /// Colour role.
    pub color: IcingColor,
}

impl Stroke {
    /// Line of the given width [m] through points of the body at rest [m].
    pub fn line(locator: &Locator, points: &[[f64; 2]], closed: bool, width: f64, color: IcingColor) -> Self {
        let points = points.iter().map(|&point| locator.embed(point)).collect();
        Self { points, closed, filled: false, width, color }
    }

    /// Filled area inside points of the body at rest [m].
    pub fn area(locator: &Locator, points: &[[f64; 2]], color: IcingColor) -> Self {
        Self { filled: true, ..Self::line(locator, points, true, 0.0, color) }
    }

    /// Present positions of the points [m], for vertex positions `x` with two numbers per vertex.
    pub fn positions(&self, triangles: &[[u32; 3]], x: &[f64]) -> impl Iterator<Item = [f64; 2]> {
        self.points.iter().map(move |point| point.position(triangles, x))
    }
}

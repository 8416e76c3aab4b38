//! Outlines as an SVG drawing.

use super::Shape;
use std::fmt::Write as _;

/// A drawing of shapes \[m\] in their true size, each as a path with holes.
pub fn to_svg(shapes: &[Shape]) -> String {
    let points = || shapes.iter().flat_map(|shape| shape.holes.iter().chain([&shape.outer])).flatten();
    let least = |axis: usize| points().map(|point| point[axis]).fold(f64::INFINITY, f64::min);
    let greatest = |axis: usize| points().map(|point| point[axis]).fold(f64::NEG_INFINITY, f64::max);
    let [left, top] = [least(0), greatest(1)];
    let [width, height] = [greatest(0) - left, top - least(1)];
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}mm\" height=\"{}mm\" viewBox=\"{left} {} {width} {height}\">\n",
        1e3 * width,
        1e3 * height,
        -top
    );
    for shape in shapes {
        text += "<path fill-rule=\"evenodd\" d=\"";
        for line in std::iter::once(&shape.outer).chain(&shape.holes) {
            for (number, [x, y]) in line.iter().enumerate() {
                // Writing to a string cannot fail.
                let _ = write!(text, "{}{x} {} ", if number == 0 { 'M' } else { 'L' }, -y);
            }
            text += "Z ";
        }
        text += "\"/>\n";
    }
    text + "</svg>\n"
}

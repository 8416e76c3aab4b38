//! Outlines of the filled or stroked paths of an SVG drawing.

use super::{FillRule, MOST_POINTS, OutlineError, Shape, TOLERANCE, shapes};
use usvg::{
    Group, Node, Options, Path, Tree,
    tiny_skia_path::{PathSegment, Point, Transform},
};

/// Length of a unit of a drawing \[m\]: 96 to an inch.
pub(super) const UNIT: f64 = 0.0254 / 96.0;

/// Reads a drawing. Paths are taken in their order; each gives shapes of its own.
pub(super) fn read(bytes: &[u8]) -> Result<Vec<Shape>, OutlineError> {
    let broken = |error: usvg::Error| OutlineError::Broken(format!("this is no SVG drawing: {error}"));
    let tree = Tree::from_data(bytes, &Options::default()).map_err(broken)?;
    let size = tree.root().abs_bounding_box();
    let tolerance = TOLERANCE * f64::from(size.width().max(size.height()));
    let mut found = Vec::new();
    let mut points = 0;
    add_group(tree.root(), tolerance, (&mut found, &mut points))?;
    Ok(found)
}

fn add_group(
    group: &Group,
    tolerance: f64,
    (found, points): (&mut Vec<Shape>, &mut usize),
) -> Result<(), OutlineError> {
    for node in group.children() {
        match node {
            Node::Group(group) => add_group(group, tolerance, (found, points))?,
            Node::Path(path) if path.is_visible() => {
                let loops = loops_of(path, tolerance);
                *points += loops.iter().map(Vec::len).sum::<usize>();
                if *points > MOST_POINTS {
                    return Err(OutlineError::TooLong);
                }
                let rule = match path.fill().map(usvg::Fill::rule) {
                    Some(usvg::FillRule::NonZero) => FillRule::NonZero,
                    _ => FillRule::EvenOdd,
                };
                found.extend(shapes(&loops, rule)?);
            }
            Node::Path(_) | Node::Image(_) | Node::Text(_) => {}
        }
    }
    Ok(())
}

/// The closed lines of a path \[m\], y upwards. A filled path is closed where it is open; of a path with a stroke alone, open lines are passed over.
fn loops_of(path: &Path, tolerance: f64) -> Vec<Vec<[f64; 2]>> {
    let transform = path.abs_transform();
    let mut lines = Vec::new();
    let mut line: Vec<[f64; 2]> = Vec::new();
    let mut end = |line: &mut Vec<[f64; 2]>, is_closed: bool| {
        let mut points = std::mem::take(line);
        let returns = points.len() > 2 && near(points[0], points[points.len() - 1], tolerance);
        if returns {
            points.pop();
        }
        points.dedup();
        if points.len() > 2 && (is_closed || returns || path.fill().is_some()) {
            lines.push(points.into_iter().map(|[x, y]| [UNIT * x, -UNIT * y]).collect());
        }
    };
    for segment in path.data().segments() {
        match segment {
            PathSegment::MoveTo(to) => {
                end(&mut line, false);
                line.push(mapped(transform, to));
            }
            PathSegment::LineTo(to) => line.push(mapped(transform, to)),
            PathSegment::QuadTo(by, to) => {
                let [by, to] = [by, to].map(|point| mapped(transform, point));
                let Some(from) = line.last().copied() else { continue };
                // The same curve as a cubic one.
                let toward = |end: [f64; 2]| [0, 1].map(|axis| end[axis] + 2.0 / 3.0 * (by[axis] - end[axis]));
                add_curve(&mut line, [from, toward(from), toward(to), to], tolerance);
            }
            PathSegment::CubicTo(one, other, to) => {
                let [one, other, to] = [one, other, to].map(|point| mapped(transform, point));
                let Some(from) = line.last().copied() else { continue };
                add_curve(&mut line, [from, one, other, to], tolerance);
            }
            PathSegment::Close => {
                let begin = line.first().copied();
                end(&mut line, true);
                line.extend(begin);
            }
        }
    }
    end(&mut line, false);
    lines
}

fn mapped(transform: Transform, Point { x, y }: Point) -> [f64; 2] {
    let [x, y, sx, kx, tx] = [x, y, transform.sx, transform.kx, transform.tx].map(f64::from);
    let [ky, sy, ty] = [transform.ky, transform.sy, transform.ty].map(f64::from);
    [sx * x + kx * y + tx, ky * x + sy * y + ty]
}

fn near(a: [f64; 2], b: [f64; 2], distance: f64) -> bool {
    libm::hypot(a[0] - b[0], a[1] - b[1]) <= distance
}

/// Adds a cubic Bézier curve as a line of chords. With n of them the error is at most 6 d/(8 n²), where d is the greater of the second differences
/// of its control points.
fn add_curve(line: &mut Vec<[f64; 2]>, [a, b, c, d]: [[f64; 2]; 4], tolerance: f64) {
    /// Most chords of a curve.
    const MOST: f64 = 200.0;
    let bend = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| libm::hypot(a[0] - 2.0 * b[0] + c[0], a[1] - 2.0 * b[1] + c[1]);
    let bend = bend(a, b, c).max(bend(b, c, d));
    let count = (0.75 * bend / tolerance).sqrt().ceil().clamp(1.0, MOST) as usize;
    for step in 1..=count {
        let t = step as f64 / count as f64;
        let s = 1.0 - t;
        let weights = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
        line.push(
            [0, 1].map(|axis| weights.iter().zip([a, b, c, d]).map(|(weight, point)| weight * point[axis]).sum()),
        );
    }
}

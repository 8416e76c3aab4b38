//! Outlines of bodies in pictures: read from SVG drawings and black-and-white PNG pictures, and written as SVG.
//!
//! ```
//! use gingerbread::outlines;
//!
//! let drawing = br#"<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="50mm"><rect width="100%" height="100%"/></svg>"#;
//! let shapes = outlines::read("sign.svg", drawing)?;
//! assert_eq!(shapes.len(), 1);
//! assert!((shapes[0].outer[2][0] - shapes[0].outer[0][0]).abs() < 0.1001, "in metres");
//! # Ok::<(), outlines::OutlineError>(())
//! ```

mod export;
mod png;
mod svg;

use crate::meshes::{Mesh, contains, signed_area};

pub use export::to_svg;

/// Most shapes of a picture.
pub const MOST_SHAPES: usize = 32;

/// Most points along all outlines of a picture.
pub const MOST_POINTS: usize = 200_000;

/// Most closed lines of a path or a picture: each is compared with all others.
const MOST_LOOPS: usize = 2000;

/// Largest distance of an outline from its curve in the picture, as a fraction of the size of all outlines.
const TOLERANCE: f64 = 2e-4;

/// A shape: its closed outline and those of its holes \[m\], with y upwards. The last point is not the first one again.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shape {
    /// The outline.
    pub outer: Vec<[f64; 2]>,
    /// Outlines of the holes.
    pub holes: Vec<Vec<[f64; 2]>>,
}

/// Reason why a picture gives no outlines.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OutlineError {
    /// The file is broken, or is not of this format.
    #[error("{0}")]
    Broken(String),
    /// There is no closed area.
    #[error("there is no closed outline in it: fill a shape, or close a line")]
    Nothing,
    /// There are too many shapes.
    #[error("it has {0} separate shapes or lines, and {MOST_SHAPES} shapes at most can be read: join or remove some")]
    TooMany(usize),
    /// The outlines have too many points.
    #[error("its outlines have over {MOST_POINTS} points: simplify them")]
    TooLong,
}

/// Rule by which a closed path has an inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FillRule {
    NonZero,
    EvenOdd,
}

/// Whether a file of this name is a picture that outlines can be read from.
pub fn is_picture(name: &str) -> bool {
    format_of(name).is_some()
}

/// Reads the shapes of a picture.
type Reader = fn(&[u8]) -> Result<Vec<Shape>, OutlineError>;

fn format_of(name: &str) -> Option<Reader> {
    let (_, ending) = name.rsplit_once('.')?;
    match ending.to_ascii_lowercase().as_str() {
        "svg" => Some(svg::read),
        "png" => Some(png::read),
        _ => None,
    }
}

/// Reads the shapes of a picture, whose format the end of its name tells: `.svg` or `.png`. A drawing keeps its size; a pixel is a millimetre.
///
/// # Errors
/// [`OutlineError`] with the reason.
pub fn read(name: &str, bytes: &[u8]) -> Result<Vec<Shape>, OutlineError> {
    let read =
        format_of(name).ok_or_else(|| OutlineError::Broken("expected a name that ends in .svg or .png".to_owned()))?;
    let shapes = read(bytes)?;
    match shapes.len() {
        0 => Err(OutlineError::Nothing),
        count if count > MOST_SHAPES => Err(OutlineError::TooMany(count)),
        _ if shapes.iter().map(Shape::points).sum::<usize>() > MOST_POINTS => Err(OutlineError::TooLong),
        _ => Ok(shapes),
    }
}

impl Shape {
    /// The shapes of a mesh at rest.
    pub fn of_mesh(mesh: &Mesh) -> Vec<Self> {
        let points = |line: &Vec<u32>| line.iter().map(|vertex| mesh.points()[*vertex as usize]).collect();
        shapes(&mesh.boundary_loops().iter().map(points).collect::<Vec<_>>(), FillRule::EvenOdd).unwrap_or_default()
    }

    fn points(&self) -> usize {
        self.outer.len() + self.holes.iter().map(Vec::len).sum::<usize>()
    }
}

/// The shapes that closed loops enclose by a fill rule. A loop is the outline of a shape if there is something on its inner side alone, and that of a hole if there is on its
/// outer side alone; the loops do not cross.
fn shapes(loops: &[Vec<[f64; 2]>], rule: FillRule) -> Result<Vec<Shape>, OutlineError> {
    if loops.len() > MOST_LOOPS {
        return Err(OutlineError::TooMany(loops.len()));
    }
    let areas: Vec<f64> = loops.iter().map(|points| signed_area(points)).collect();
    let within = |inner: usize, outer: usize| {
        inner != outer && areas[outer].abs() > areas[inner].abs() && contains(&loops[outer], loops[inner][0])
    };
    let around: Vec<Vec<usize>> =
        (0..loops.len()).map(|own| (0..loops.len()).filter(|other| within(own, *other)).collect()).collect();
    let is_filled = |all: &mut dyn Iterator<Item = usize>| match rule {
        FillRule::EvenOdd => all.count() % 2 == 1,
        FillRule::NonZero => all.map(|own| areas[own].signum()).sum::<f64>() != 0.0,
    };
    let outside: Vec<bool> = (0..loops.len()).map(|own| is_filled(&mut around[own].iter().copied())).collect();
    let inside: Vec<bool> =
        (0..loops.len()).map(|own| is_filled(&mut around[own].iter().copied().chain([own]))).collect();
    let is_outer = |own: usize| inside[own] && !outside[own];
    let mut found: Vec<(usize, Shape)> = (0..loops.len())
        .filter(|own| is_outer(*own))
        .map(|own| (own, Shape { outer: loops[own].clone(), holes: Vec::new() }))
        .collect();
    for hole in (0..loops.len()).filter(|own| !inside[*own] && outside[*own]) {
        let outers = around[hole].iter().copied().filter(|own| is_outer(*own));
        let owner = outers.min_by(|a, b| areas[*a].abs().total_cmp(&areas[*b].abs()));
        if let Some((_, shape)) = found.iter_mut().find(|(own, _)| Some(*own) == owner) {
            shape.holes.push(loops[hole].clone());
        }
    }
    Ok(found.into_iter().map(|(_, shape)| shape).collect())
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a failing test should panic")]
mod tests;

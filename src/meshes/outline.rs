//! Mesh of a polygon given by its outline.

use super::{
    Files, Mesh, MeshError, MeshSource, Whole,
    mesh::{NEAR, nearest_on_side, size, squared_distance},
    numbering, polygon, triangulate,
};
use crate::quantity::{Coordinate, Point, Quantity, Tolerance, Triangles};

/// Cosine of the turn above which a point of the outline is a corner: 20 degrees.
const CORNER: f64 = 0.939_692_620_785_908_4;

/// Distance, as a share of the triangles' side, below which points count as one.
const SAME: f64 = 1e-3;

/// Ratio of actual to requested triangles above which a simpler outline is suggested.
const FAR_MORE: f64 = 1.25;

/// Greatest number of points along an outline. Compact outlines stay far below it; long thin ones take very long to
/// triangulate.
const MOST_ALONG: f64 = 10_000.0;

/// The inside of a polygon, in about `resolution` triangles. Corners stay sharp; a run of sides shorter than the
/// triangles is taken for a curve. No angle is below 25 degrees unless the polygon itself has corners that sharp.
///
/// A point counts as the one before it if it is nearer than a thousandth of the triangles' side or 2e-5 of the outline's size. The first
/// point may be repeated at the end, as the formats `GeoJSON` and WKT have it.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Outline {
    /// The corners in order, in either direction \[m\].
    pub points: Vec<Point>,
    /// Corners of holes in it, which do not touch it or each other \[m\].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub holes: Vec<Vec<Point>>,
    /// Number of triangles to aim for.
    #[serde(default = "thousand")]
    pub resolution: Whole<Triangles>,
    /// How far the outline may be moved to do with fewer points \[m\].
    #[serde(default = "exactly", skip_serializing_if = "is_exact")]
    pub simplify: Tolerance,
}

/// Default: no simplification.
const fn exactly() -> Tolerance {
    Tolerance::literal(0.0)
}

fn is_exact(tolerance: &Tolerance) -> bool {
    *tolerance == exactly()
}

/// Default resolution.
fn thousand() -> Whole<Triangles> {
    Whole::literal(Triangles::literal(1000.0))
}

impl Default for Outline {
    /// A fir tree.
    fn default() -> Self {
        let at = |x, y| Point(Coordinate::literal(x), Coordinate::literal(y));
        let right = [
            (0.5, 0.84),
            (0.62, 0.64),
            (0.57, 0.64),
            (0.7, 0.44),
            (0.63, 0.44),
            (0.77, 0.23),
            (0.55, 0.23),
            (0.55, 0.14),
        ];
        let left = right.iter().rev().take(right.len() - 1).map(|&(x, y)| at(1.0 - x, y));
        Self {
            points: right.iter().map(|&(x, y)| at(x, y)).chain(left).collect(),
            holes: Vec::new(),
            resolution: thousand(),
            simplify: exactly(),
        }
    }
}

impl Outline {
    /// The outline of a closed line \[m\], which it may leave by a tolerance \[m\]; `None` if fewer than three corners remain.
    pub fn of_line(line: &[[f64; 2]], tolerance: f64) -> Option<Self> {
        if line.is_empty() {
            return None;
        }
        let corner = |[x, y]: &[f64; 2]| Some(Point(Coordinate::new(*x).ok()?, Coordinate::new(*y).ok()?));
        let points = polygon::simplified(line, tolerance).iter().map(corner).collect::<Option<Vec<_>>>()?;
        (points.len() >= 3).then(|| Self { points, ..Self::default() })
    }

    /// The outline of a closed line and those of its holes \[m\], as they are; `None` if a coordinate is out of range.
    pub fn of_shape(outer: &[[f64; 2]], holes: &[Vec<[f64; 2]>]) -> Option<Self> {
        let corners = |line: &[[f64; 2]]| line.iter().map(|point| Point::new(*point).ok()).collect::<Option<Vec<_>>>();
        let holes = holes.iter().map(|hole| corners(hole)).collect::<Option<_>>()?;
        Some(Self { points: corners(outer)?, holes, ..Self::default() })
    }

    /// Area without that of the holes \[m²\].
    pub fn area(&self) -> f64 {
        let area = |points: &Vec<Point>| {
            polygon::signed_area(&points.iter().map(|point| point.get()).collect::<Vec<_>>()).abs()
        };
        area(&self.points) - self.holes.iter().map(area).sum::<f64>()
    }
}

impl MeshSource for Outline {
    fn build(&self, _: &dyn Files) -> Result<Mesh, MeshError> {
        let given: Vec<[f64; 2]> = self.points.iter().map(|point| point.get()).collect();
        let target = f64::from(self.resolution.count());
        let (kept, mut messages) = apart(&given, target);
        let mut corners: Vec<_> = kept.iter().map(|&number| given[number]).collect();
        if corners.len() < 3 {
            return Err(MeshError::Recipe(format!("an outline needs at least 3 points, got {}", corners.len())));
        }
        if let Some((first, second)) = polygon::crossing(&corners) {
            return Err(MeshError::Crossing { first: kept[first], second: kept[second] });
        }
        if !is_exact(&self.simplify) {
            let before = corners.len();
            corners = polygon::simplified(&corners, self.simplify.get());
            messages.push(format!(
                "{} of the outline's {before} points are left out to simplify it",
                before - corners.len()
            ));
        }
        if polygon::signed_area(&corners) < 0.0 {
            corners.reverse();
        }
        let mut loops = vec![corners];
        for (number, hole) in self.holes.iter().enumerate() {
            loops.push(self.hole(number, hole, target)?);
        }
        check_holes(&loops)?;
        let area = area_of(&loops);
        // n points along the edge give at least n - 2 triangles. Too many are refused here, before they fill the
        // memory.
        let along = loops.iter().map(|corners| polygon::perimeter(corners)).sum::<f64>()
            / triangulate::edge_length(area / target);
        if along > target.min(MOST_ALONG) {
            let reason =
                format!("the outline is too long and thin: {along:.0} points would lie along it; make it wider");
            return Err(MeshError::Recipe(reason));
        }
        let (points, triangles) =
            triangulate::fill(target, area, &|edge| loops.iter().map(|corners| sampled(corners, edge)).collect())?;
        let (points, triangles) = numbering::by_place(&points, &triangles);
        // The given points are distinct. In a sharp corner, added points may be near each other.
        let mesh =
            Mesh::counted_from((0, 0.0), points.clone(), triangles).map_err(|error| named(error, &points, &given))?;
        let angle = mesh.min_angle();
        if angle < triangulate::GOOD_ANGLE {
            messages.push(format!("the outline's sharp corners leave triangles with an angle of {angle:.1}°"));
        }
        if mesh.triangles().len() as f64 > FAR_MORE * target {
            messages.extend(simpler(&loops, target, mesh.triangles().len()));
        }
        Ok(messages.into_iter().fold(mesh, Mesh::with_message))
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.resolution, &mut self.simplify]
    }

    fn onto_outline(&self, point: [f64; 2]) -> [f64; 2] {
        // The mesh of a simplified outline does not follow the given points.
        if !is_exact(&self.simplify) {
            return point;
        }
        let loops = std::iter::once(&self.points).chain(&self.holes);
        let sides = loops.flat_map(|corners| corners.iter().zip(corners.iter().cycle().skip(1)));
        let nearest = sides.map(|(from, to)| nearest_on_side(from.get(), to.get(), point));
        nearest.min_by(|a, b| squared_distance(*a, point).total_cmp(&squared_distance(*b, point))).unwrap_or(point)
    }
}

impl Outline {
    /// Corners of a hole, without repeated ones and simplified as the outline.
    fn hole(&self, number: usize, hole: &[Point], target: f64) -> Result<Vec<[f64; 2]>, MeshError> {
        let given: Vec<[f64; 2]> = hole.iter().map(|point| point.get()).collect();
        let (kept, _) = apart(&given, target);
        let corners: Vec<_> = kept.iter().map(|&number| given[number]).collect();
        if corners.len() < 3 {
            return Err(MeshError::Recipe(format!("hole {number} needs at least 3 points, got {}", corners.len())));
        }
        if let Some((first, second)) = polygon::crossing(&corners) {
            let (first, second) = (kept[first], kept[second]);
            return Err(MeshError::Recipe(format!(
                "the sides of hole {number} after its points {first} and {second} cross"
            )));
        }
        Ok(if is_exact(&self.simplify) { corners } else { polygon::simplified(&corners, self.simplify.get()) })
    }
}

/// Area of an outline without that of its holes \[m²\].
fn area_of(loops: &[Vec<[f64; 2]>]) -> f64 {
    let mut areas = loops.iter().map(|corners| polygon::signed_area(corners).abs());
    areas.next().unwrap_or(0.0) - areas.sum::<f64>()
}

/// Checks that the holes of an outline, which come after it, lie in it and apart from each other.
fn check_holes(loops: &[Vec<[f64; 2]>]) -> Result<(), MeshError> {
    let fail = |why: String| Err(MeshError::Recipe(why));
    let Some((outer, holes)) = loops.split_first() else { return Ok(()) };
    let all: Vec<&[[f64; 2]]> = loops.iter().map(Vec::as_slice).collect();
    if let Some((first, second)) = polygon::crossing_of_loops(&all) {
        // The outline and each hole alone were found sound.
        let name = |corner: usize| {
            let mut left = corner;
            let place = all.iter().position(|corners| {
                let is_here = left < corners.len();
                left -= if is_here { 0 } else { corners.len() };
                is_here
            });
            place.unwrap_or(0)
        };
        let (first, second) = (name(first), name(second));
        let other = if first == 0 { "the outline".to_owned() } else { format!("hole {}", first - 1) };
        return fail(format!("hole {} touches or crosses {other}", second - 1));
    }
    for (number, hole) in holes.iter().enumerate() {
        if !polygon::contains(outer, hole[0]) {
            return fail(format!("hole {number} lies outside of the outline"));
        }
        let within = |other: &usize| *other != number && polygon::contains(&holes[*other], hole[0]);
        if let Some(other) = (0..holes.len()).find(within) {
            return fail(format!("hole {number} lies in hole {other}"));
        }
    }
    Ok(())
}

/// Numbers of the points that differ from the point before, and a message with the number of the others.
fn apart(given: &[[f64; 2]], target: f64) -> (Vec<usize>, Vec<String>) {
    let open = match given {
        [first, .., last] if first == last => &given[..given.len() - 1],
        _ => given,
    };
    let edge = triangulate::edge_length(polygon::signed_area(open).abs() / target);
    let near = (SAME * edge).max(NEAR * size(open));
    let kept = polygon::merged(open, near);
    let messages = match open.len() - kept.len() {
        0 => Vec::new(),
        1 => vec![format!(
            "1 of the outline's points is nearer than {near:.1e} m to the one before and is merged with it"
        )],
        count => vec![format!(
            "{count} of the outline's points are nearer than {near:.1e} m to the one before and are merged with it"
        )],
    };
    (kept, messages)
}

/// Error of the mesh, with the place in the outline where the outline causes it.
fn named(error: MeshError, points: &[[f64; 2]], given: &[[f64; 2]]) -> MeshError {
    let at: &[usize] = match &error {
        MeshError::Near { vertices, .. } => vertices,
        MeshError::NoArea { corners, .. } => corners,
        _ => return error,
    };
    let [x, y] = [0, 1].map(|axis| at.iter().map(|&vertex| points[vertex][axis]).sum::<f64>() / at.len() as f64);
    let square = |number: &usize| squared_distance(given[*number], [x, y]);
    let nearest = (0..given.len()).min_by(|a, b| square(a).total_cmp(&square(b))).unwrap_or(0);
    MeshError::Recipe(format!(
        "a triangle at ({x:.4}, {y:.4}), beside point {nearest} of the outline, has next to no area: the outline nearly touches itself \
         there, or has a corner that is too sharp; move its points apart"
    ))
}

/// Message on the number of triangles of an outline with many points, and on a tolerance that meets the request.
fn simpler(loops: &[Vec<[f64; 2]>], target: f64, triangles: usize) -> Option<String> {
    let edge = triangulate::edge_length(area_of(loops) / target);
    // Corners this near to each other add triangles but no visible detail.
    let start = libm::floor(libm::log10(0.02 * edge)) as i32;
    let steps =
        (start..start + 3).flat_map(|power| [1.0, 2.0, 5.0].map(|digit| digit * libm::pow(10.0, f64::from(power))));
    let tried = steps.filter(|tolerance| *tolerance < 0.1 * size(&loops[0])).find_map(|tolerance| {
        let fewer: Vec<_> = loops.iter().map(|corners| polygon::simplified(corners, tolerance)).collect();
        let sampled = |edge| fewer.iter().map(|corners| sampled(corners, edge)).collect();
        let (_, made) = triangulate::fill(target, area_of(&fewer), &sampled).ok()?;
        let points = fewer.iter().map(Vec::len).sum::<usize>();
        (made.len() as f64 <= FAR_MORE * target).then_some((tolerance, points, made.len()))
    });
    let (tolerance, points, count) = tried?;
    Some(format!(
        "the outline's {} points take {triangles} triangles where {target} were asked for, as the mesh keeps its corners; with \
         `simplify: {tolerance}` in the outline, which moves it by up to so many metres, {points} points and {count} triangles are left",
        loops.iter().map(Vec::len).sum::<usize>()
    ))
}

/// Points along the outline about one edge length \[m\] apart, its corners among them.
fn sampled(corners: &[[f64; 2]], edge: f64) -> Vec<[f64; 2]> {
    let count = corners.len();
    let mut kept: Vec<usize> = (0..count)
        .filter(|&index| {
            let ring = [corners[(index + count - 1) % count], corners[index], corners[(index + 1) % count]];
            is_corner(ring, edge)
        })
        .collect();
    if kept.is_empty() {
        kept.push(0);
    }
    // One or two corners alone need extra points to bound an area.
    let least = 3_usize.div_ceil(kept.len());
    let mut points = Vec::new();
    for (index, &from) in kept.iter().enumerate() {
        let to = if index + 1 < kept.len() { kept[index + 1] } else { kept[0] + count };
        let run: Vec<_> = (from..=to).map(|corner| corners[corner % count]).collect();
        let length: f64 = run.windows(2).map(|pair| squared_distance(pair[0], pair[1]).sqrt()).sum();
        let pieces = ((length / edge).round() as usize).max(least);
        points.extend_from_slice(&polygon::spaced(&run, pieces + 1)[..pieces]);
    }
    points
}

/// Whether the outline turns sharply at the middle point, or a side there is longer than an edge.
fn is_corner([before, here, after]: [[f64; 2]; 3], edge: f64) -> bool {
    let (came, goes) = (squared_distance(before, here), squared_distance(here, after));
    let along = (here[0] - before[0]) * (after[0] - here[0]) + (here[1] - before[1]) * (after[1] - here[1]);
    came > edge * edge || goes > edge * edge || along < CORNER * (came * goes).sqrt()
}

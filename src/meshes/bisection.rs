//! Conforming refinement by newest-vertex bisection.
//!
//! Every triangle has a refinement edge. It is divided at the middle of this edge, and the edges opposite to the new vertex are the refinement
//! edges of both halves, so that the shapes of all descendants of a triangle are among finitely many. An edge is divided in both of its triangles: a
//! triangle that has a divided edge also divides its refinement edge. Source: Mitchell, *A comparison of adaptive refinement techniques for
//! elliptic problems*, ACM Transactions on Mathematical Software 15, 1989; Funken, Praetorius and Wissgott, *Efficient implementation of adaptive
//! P1-FEM in Matlab*, Computational Methods in Applied Mathematics 11, 2011.

use super::mesh::{area, squared_distance};

/// Least area of a half of a triangle whose new vertex is on the outline, as a fraction of that with the vertex at the middle of the edge. If one half would be
/// smaller, the vertex stays there.
const LEAST_HALF: f64 = 0.3;

/// A mesh that is refined. The refinement edge of a triangle is that from its first vertex to its second.
pub(super) struct Bisection {
    pub points: Vec<[f64; 2]>,
    pub triangles: Vec<[u32; 3]>,
}

impl Bisection {
    /// Begins with a mesh. Its longest edges are the refinement edges; of equally long ones, that with the lower vertices.
    pub fn new(points: &[[f64; 2]], triangles: &[[u32; 3]]) -> Self {
        let key = |[a, b]: [u32; 2]| {
            let ends = ordered([a, b]);
            (squared_distance(points[ends[0] as usize], points[ends[1] as usize]), ends)
        };
        let labelled = |&[a, b, c]: &[u32; 3]| {
            let turns = [[a, b, c], [b, c, a], [c, a, b]];
            let longer = |one: &[u32; 3], other: &[u32; 3]| {
                let ((long, ends), (other_long, other_ends)) = (key([one[0], one[1]]), key([other[0], other[1]]));
                long.total_cmp(&other_long).then(other_ends.cmp(&ends))
            };
            turns.into_iter().max_by(longer).unwrap_or([a, b, c])
        };
        Self { points: points.to_vec(), triangles: triangles.iter().map(labelled).collect() }
    }

    /// Divides all edges of the marked triangles, and further ones, so that no vertex is left on the side of a triangle. The parts of a triangle take its place in the list, and new
    /// vertices come after all others. Those on the boundary are put where `onto_outline` says.
    pub fn refine(&mut self, marked: &[u32], onto_outline: &dyn Fn([f64; 2]) -> [f64; 2]) {
        if marked.is_empty() {
            return;
        }
        let edges = Edges::new(&self.triangles);
        let mut is_divided = vec![false; edges.triangles.len()];
        let mut open: Vec<u32> = marked.iter().flat_map(|triangle| edges.of[*triangle as usize]).collect();
        while let Some(edge) = open.pop() {
            if !std::mem::replace(&mut is_divided[edge as usize], true) {
                // The refinement edges of both triangles.
                open.extend(
                    edges.triangles[edge as usize].into_iter().flatten().map(|other| edges.of[other as usize][0]),
                );
            }
        }
        let mut middles = vec![None; is_divided.len()];
        for (triangle, corners) in self.triangles.iter().enumerate() {
            for (place, edge) in edges.of[triangle].iter().map(|edge| *edge as usize).enumerate() {
                if is_divided[edge] && middles[edge].is_none() {
                    middles[edge] = Some(self.points.len() as u32);
                    let [a, b, c] = [0, 1, 2].map(|next| self.points[corners[(place + next) % 3] as usize]);
                    // The halves of the other edges have the middle of the refinement edge, which is known by now, as their third vertex.
                    let first = if place == 0 { None } else { middles[edges.of[triangle][0] as usize] };
                    let opposite = first.map_or(c, |middle: u32| self.points[middle as usize]);
                    let is_outer = edges.triangles[edge][1].is_none();
                    let middle = [0, 1].map(|axis| 0.5 * (a[axis] + b[axis]));
                    self.points.push(if is_outer {
                        put([a, b, opposite], middle, onto_outline(middle))
                    } else {
                        middle
                    });
                }
            }
        }
        let mut parts = Vec::with_capacity(self.triangles.len());
        for (&[a, b, c], of) in self.triangles.iter().zip(&edges.of) {
            match of.map(|edge| middles[edge as usize]) {
                [Some(ab), bc, ca] => {
                    add_half(&mut parts, [c, a, ab], ca);
                    add_half(&mut parts, [b, c, ab], bc);
                }
                _ => parts.push([a, b, c]),
            }
        }
        self.triangles = parts;
    }
}

/// Adds a half of a triangle, or its two halves if its refinement edge is divided as well.
fn add_half(parts: &mut Vec<[u32; 3]>, [a, b, c]: [u32; 3], middle: Option<u32>) {
    match middle {
        Some(middle) => parts.extend([[c, a, middle], [b, c, middle]]),
        None => parts.push([a, b, c]),
    }
}

/// The place on the outline of the middle of the edge ab of a triangle, unless that leaves one half too little area.
fn put([a, b, c]: [[f64; 2]; 3], middle: [f64; 2], outline: [f64; 2]) -> [f64; 2] {
    /// Distance from the edge, relative to its length, that counts as none.
    const NONE: f64 = 1e-9;
    let (moved, length) = (squared_distance(middle, outline), squared_distance(a, b));
    let least = 0.5 * LEAST_HALF * area([a, b, c]);
    let fits = [[c, a, outline], [b, c, outline]].map(area).into_iter().all(|half| half >= least);
    if moved > NONE * NONE * length && moved < 0.25 * length && fits { outline } else { middle }
}

const fn ordered([a, b]: [u32; 2]) -> [u32; 2] {
    if a < b { [a, b] } else { [b, a] }
}

/// The edges of triangles.
struct Edges {
    /// Edges of each triangle: from its first vertex to its second, and so on.
    of: Vec<[u32; 3]>,
    /// One or two triangles at each edge.
    triangles: Vec<[Option<u32>; 2]>,
}

impl Edges {
    fn new(corners: &[[u32; 3]]) -> Self {
        let sides = corners.iter().zip(0_u32..).flat_map(|(&[a, b, c], triangle)| {
            [[a, b], [b, c], [c, a]].into_iter().zip(0_usize..).map(move |(ends, side)| (ordered(ends), triangle, side))
        });
        let mut sides: Vec<_> = sides.collect();
        sides.sort_unstable();
        let (mut of, mut triangles) = (vec![[0; 3]; corners.len()], Vec::new());
        for same in sides.chunk_by(|one, other| one.0 == other.0) {
            for (_, triangle, side) in same {
                of[*triangle as usize][*side] = triangles.len() as u32;
            }
            triangles.push([same.first().map(|first| first.1), same.get(1).map(|second| second.1)]);
        }
        Self { of, triangles }
    }
}

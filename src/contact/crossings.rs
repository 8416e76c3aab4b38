//! Certificate that nothing has crossed: an exact test, independent of how contact is computed.

use super::{SurfaceVertices, touch::vector};
use crate::obstacles::{segments_meet, side_of};

/// Part and ends of an edge, by number and position.
type Edge = (u32, [u32; 2], [[f64; 2]; 2]);

/// Number of pairs of boundary edges that cross or touch each other at positions x \[m\], without those that share a vertex, and of
/// particles of nets inside bodies. `touch` tells of two parts, by their numbers in the list, whether they are compared. Zero is a
/// proof, because [`segments_meet`] is exact. Positions that are not finite count as one.
pub fn count_crossings(surface: &SurfaceVertices, x: &[f64], touch: impl Fn(u32, u32) -> bool) -> usize {
    if !surface.iter().all(|vertex| vector(x, vertex.vertex).iter().all(|number| number.is_finite())) {
        return 1;
    }
    // Sorted by their left ends, so that only edges that overlap along x are compared.
    let ends = |edge: &super::SurfaceEdge| (edge.part, edge.ends, edge.ends.map(|end| vector(x, end)));
    let mut edges: Vec<Edge> = surface.edges().iter().map(ends).collect();
    let left = |(.., [a, b]): &Edge| a[0].min(b[0]);
    edges.sort_unstable_by(|a, b| left(a).total_cmp(&left(b)));
    let mut count = 0;
    for (number, (part, names, one)) in edges.iter().enumerate() {
        let right = one[0][0].max(one[1][0]);
        for (other_part, others, other) in edges[number + 1..].iter().take_while(|other| left(other) <= right) {
            let shared = names.iter().any(|name| others.contains(name));
            count += usize::from(!shared && touch(*part, *other_part) && segments_meet(*one, *other));
        }
    }
    let particles = surface.iter().filter(|vertex| !surface.is_body(vertex.part));
    let is_inside = |vertex: &&super::SurfaceVertex| {
        is_inside(edges.iter().filter(|(part, ..)| touch(*part, vertex.part)), vector(x, vertex.vertex))
    };
    count + particles.filter(is_inside).count()
}

/// Whether a point is inside the boundary: a ray to the right crosses it an odd number of times.
fn is_inside<'a>(edges: impl Iterator<Item = &'a Edge>, point: [f64; 2]) -> bool {
    let crossed = edges.filter(|(.., [a, b])| {
        let upwards = a[1] <= point[1] && b[1] > point[1];
        let downwards = b[1] <= point[1] && a[1] > point[1];
        upwards && side_of([*a, *b], point) > 0.0 || downwards && side_of([*a, *b], point) < 0.0
    });
    crossed.count() % 2 == 1
}

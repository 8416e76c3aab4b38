//! Certificate that nothing has crossed: an exact test, independent of how contact is computed.

use super::{SurfaceVertices, touch::vector};
use crate::obstacles::{segments_meet, side_of};

/// Part and ends of an edge, by number and position.
type Edge = (u32, [u32; 2], [[f64; 2]; 2]);

/// Number of pairs of boundary edges that cross or touch each other at positions x \[m\], without those that share a vertex, and of
/// particles of nets inside bodies. Where no edges cross, bodies inside others count. `touch` tells of two parts, by their numbers in the
/// list, whether they are compared. Zero is a proof, because [`segments_meet`] is exact. Positions that are not finite count as one.
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
    // Where no edges cross, a body is inside another one with all of its vertices.
    let is_free = count == 0;
    let bodies = (0..surface.parts()).filter(|part| is_free && surface.is_body(*part as u32));
    let first = |part: usize| surface.vertices_of(part).next().map(|place| surface.at(place as u32));
    let mut inside = vec![false; surface.parts()];
    for vertex in particles.chain(bodies.filter_map(first)) {
        // A ray to the right crosses the boundary of a part that the vertex is inside of an odd number of times.
        inside.fill(false);
        let others = edges.iter().filter(|(part, ..)| *part != vertex.part && touch(*part, vertex.part));
        let crossed = others.filter(|(.., ends)| is_right_of(vector(x, vertex.vertex), *ends));
        crossed.for_each(|(part, ..)| inside[*part as usize] ^= true);
        count += inside.iter().filter(|inside| **inside).count();
    }
    count
}

/// Whether an edge crosses the ray to the right from a point.
fn is_right_of(point: [f64; 2], [a, b]: [[f64; 2]; 2]) -> bool {
    let upwards = a[1] <= point[1] && b[1] > point[1];
    let downwards = b[1] <= point[1] && a[1] > point[1];
    upwards && side_of([a, b], point) > 0.0 || downwards && side_of([a, b], point) < 0.0
}

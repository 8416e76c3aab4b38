//! Fans: pairs of triangles that share an edge.
//!
//! Forces are assembled fan by fan. The four vertices of a fan are each read once and receive one force; two separate
//! triangles have six corners. Nearly every triangle of a mesh is paired. The others form fans of one triangle.

use super::{
    mesh::squared_distance,
    topology::{BOUNDARY, Topology, ends},
};

/// Triangles of a fan, counter-clockwise; [`Fan::ALONE`] in place of a missing second one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fan(pub [u32; 2]);

impl Fan {
    /// Placeholder for a missing second triangle.
    pub const ALONE: u32 = u32::MAX;

    /// Triangles of the fan.
    pub fn triangles(self) -> impl Iterator<Item = u32> {
        self.0.into_iter().filter(|triangle| *triangle != Self::ALONE)
    }

    /// Vertices of the fan: the middle vertex, then the others counter-clockwise. Without a second triangle the
    /// fourth repeats the second.
    pub fn corners(self, triangles: &[[u32; 3]]) -> [u32; 4] {
        let [first, second] = self.0;
        let [a, b, c] = triangles[first as usize];
        let Some(&second) = triangles.get(second as usize) else { return [a, b, c, b] };
        // The shared edge, reversed in the second triangle.
        let shared = |[end, middle, _]: &[u32; 3]| (0..3).any(|i| second[i] == *middle && second[(i + 1) % 3] == *end);
        let [end, middle, from] = [[a, b, c], [b, c, a]].into_iter().find(shared).unwrap_or([c, a, b]);
        let to = second.into_iter().find(|corner| *corner != end && *corner != middle).unwrap_or(from);
        [middle, from, end, to]
    }
}

/// Matching of triangles, each across its longest free edge. Triangles with one unpaired neighbour come first.
/// Source: R. M. Karp and M. Sipser, *Maximum matchings in sparse random graphs*, Proc. 22nd IEEE Symposium on
/// Foundations of Computer Science, 1981. Fans are in the order of their first triangles.
pub(super) fn fans(points: &[[f64; 2]], topology: &Topology<'_>) -> Vec<Fan> {
    let (triangles, twins) = (topology.triangles(), topology.twins());
    let length = |half: usize| {
        let [a, b] = ends(triangles, half).map(|vertex| points[vertex as usize]);
        squared_distance(a, b)
    };
    let mut partners = vec![Fan::ALONE; triangles.len()];
    let free = |triangle: usize, partners: &[u32]| {
        let is_free = |half: &usize| twins[*half] != BOUNDARY && partners[twins[*half] as usize / 3] == Fan::ALONE;
        let mut halves = [None; 3];
        halves.iter_mut().zip((3 * triangle..3 * triangle + 3).filter(is_free)).for_each(|(to, half)| *to = Some(half));
        halves.into_iter().flatten()
    };
    let mut lonely: Vec<_> = (0..triangles.len()).filter(|triangle| free(*triangle, &partners).count() == 1).collect();
    let mut others = 0..triangles.len();
    while let Some(triangle) = lonely.pop().or_else(|| others.next()) {
        if partners[triangle] != Fan::ALONE {
            continue;
        }
        // Of edges of equal length the first is taken.
        let longest = |one: usize, other: usize| if length(other) > length(one) { other } else { one };
        let Some(half) = free(triangle, &partners).reduce(longest) else { continue };
        let partner = twins[half] as usize / 3;
        (partners[triangle], partners[partner]) = (partner as u32, triangle as u32);
        for neighbour in [triangle, partner].into_iter().flat_map(|triangle| free(triangle, &partners)) {
            let neighbour = twins[neighbour] as usize / 3;
            if free(neighbour, &partners).count() == 1 {
                lonely.push(neighbour);
            }
        }
    }
    let all = partners.into_iter().enumerate().map(|(triangle, partner)| [triangle as u32, partner]);
    all.filter(|[triangle, partner]| triangle < partner).map(Fan).collect()
}

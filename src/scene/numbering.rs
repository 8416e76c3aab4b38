//! Vertex numbers of the level, which may differ from those in the scene; see [`Numbering`].
//!
//! # Renumbering for locality (reverse Cuthill-McKee)
//!
//! Small generated meshes have good locality. Meshes from files and nets have arbitrary numbers: on a shuffled mesh
//! every corner of a triangle is a cache miss. In large meshes whose numbering follows a space-filling curve, the
//! forces of a vertex are summed long after the first of them is computed. A large body cannot be partitioned
//! if its vertices are in another order than its triangles. Such meshes are renumbered while a scene is
//! built, in the order in which they are stepped: fan by fan ([`Mesh::fans`]). Levels, saved states, tables and
//! messages keep the names from the file ([`Numbering`]).

use super::{Owner, Scene};
use crate::{
    contact::{Anchor, ContactName},
    elements::{STAGE_ELEMENTS, is_unpartitioned},
    meshes::{Mesh, Numbering},
    nets::Net,
    quantity::{Position, Reach},
    state::State,
};
use std::{borrow::Cow, ops::Range};

impl Scene {
    /// The body or net that a vertex belongs to, and its number there as a level counts.
    pub fn owner_of(&self, vertex: usize) -> Option<(Owner, usize)> {
        let (owner, vertices, numbering) = self.owners().find(|(_, vertices, _)| vertices.contains(&vertex))?;
        Some((owner, numbering.name((vertex - vertices.start) as u32) as usize))
    }

    /// The place of a vertex where the level lists all of them, as in a saved state.
    pub fn listed_vertex(&self, vertex: usize) -> Option<usize> {
        let (_, vertices, numbering) = self.owners().find(|(_, vertices, _)| vertices.contains(&vertex))?;
        Some(vertices.start + numbering.name((vertex - vertices.start) as u32) as usize)
    }

    /// The vertex at a place where the level lists all of them.
    pub fn unlisted_vertex(&self, place: usize) -> Option<usize> {
        let (_, vertices, numbering) = self.owners().find(|(_, vertices, _)| vertices.contains(&place))?;
        Some(vertices.start + numbering.vertex((place - vertices.start) as u32) as usize)
    }

    /// The place of a triangle, by its number among those of all bodies and then all membranes, where the level lists all of them.
    pub fn listed_triangle(&self, triangle: usize) -> Option<usize> {
        let is_own = |(_, first, mesh): &(usize, usize, &Mesh)| triangle < first + mesh.triangles().len();
        let (_, first, mesh) = self.triangle_parts().find(is_own)?;
        Some(first + mesh.numbering().element_name(triangle - first))
    }

    /// The number of the triangle at a place where the level lists all of them.
    pub fn unlisted_triangle(&self, place: usize) -> Option<usize> {
        let is_own = |(_, first, mesh): &(usize, usize, &Mesh)| place < first + mesh.triangles().len();
        let (_, first, mesh) = self.triangle_parts().find(is_own)?;
        let mut all = first..first + mesh.triangles().len();
        all.find(|triangle| first + mesh.numbering().element_name(triangle - first) == place)
    }

    /// The meshes of all bodies and then all membranes, with the number of the part, where nets come between, and of its first triangle.
    pub fn triangle_parts(&self) -> impl Iterator<Item = (usize, usize, &Mesh)> {
        let bodies = self.bodies.iter().map(|body| &*body.mesh).enumerate();
        let others = self.bodies.len() + self.nets.len();
        let membranes = (others..).zip(self.membranes.iter().map(|membrane| &*membrane.mesh));
        bodies.chain(membranes).scan(0, |next, (part, mesh)| {
            let first = *next;
            *next += mesh.triangles().len();
            Some((part, first, mesh))
        })
    }

    /// The parts that some triangles belong to, by their numbers among those of all bodies and then all membranes, and for each part the names of
    /// its triangles as [`Refined`](crate::meshes::Refined) counts them, ascending: elements of six nodes are one triangle there.
    pub fn divided(&self, triangles: &[usize]) -> Vec<(usize, Vec<u32>)> {
        let of_part = |(part, first, mesh): (usize, usize, &Mesh)| {
            let has_six_nodes = self.bodies.get(part).is_some_and(|body| body.elements.kind().has_six_nodes());
            let own = triangles.iter().filter_map(|triangle| triangle.checked_sub(first));
            let own = own.filter(|triangle| *triangle < mesh.triangles().len());
            let mut names: Vec<_> = own
                .map(|own| (mesh.numbering().element_name(own) / if has_six_nodes { 4 } else { 1 }) as u32)
                .collect();
            names.sort_unstable();
            names.dedup();
            (part, names)
        };
        self.triangle_parts().map(of_part).filter(|(_, names)| !names.is_empty()).collect()
    }

    /// Positions or velocities of all vertices, flat, as the level lists them.
    pub fn listed<'a>(&self, values: &'a [f64]) -> Cow<'a, [f64]> {
        self.rearranged(values, |[vertex, name]| [vertex, name])
    }

    /// Positions or velocities of all vertices, flat, from how the level lists them.
    pub(super) fn unlisted(&self, values: &[f64]) -> Vec<f64> {
        self.rearranged(values, |[vertex, name]| [name, vertex]).into_owned()
    }

    /// A state with its vertices as the level lists them, for saving. The memory of the integrator keeps the order of
    /// the scene.
    pub fn listed_state<'a>(&self, state: &'a State) -> Cow<'a, State> {
        match (self.listed(&state.x), self.listed(&state.v)) {
            (Cow::Owned(x), Cow::Owned(v)) => {
                let mut anchors = state.anchors.clone();
                for anchor in &mut anchors {
                    let vertex = &mut anchor.contact.vertex;
                    *vertex = self.listed_vertex(*vertex as usize).map_or(*vertex, |listed| listed as u32);
                }
                let calm_positions = match &state.calm_positions[..] {
                    [] => Vec::new(),
                    positions => self.listed(positions).into_owned(),
                };
                Cow::Owned(State { x, v, anchors, calm_positions, ..state.clone() })
            }
            _ => Cow::Borrowed(state),
        }
    }

    /// Anchors of friction from how the level lists vertices; those of vertices that do not exist are omitted.
    pub(super) fn unlisted_anchors(&self, saved: &[((u32, u32, u32), Position, Reach)]) -> Vec<Anchor> {
        let anchor = |((effect, surface, place), point, penetration): &((u32, u32, u32), Position, Reach)| {
            let vertex = self.unlisted_vertex(*place as usize)? as u32;
            let contact = ContactName { effect: *effect, surface: *surface, vertex };
            Some(Anchor { contact, point: point.get(), penetration: penetration.get() })
        };
        let mut anchors: Vec<_> = saved.iter().filter_map(anchor).collect();
        anchors.sort_unstable_by_key(|anchor| anchor.contact);
        anchors
    }

    /// All bodies, nets and membranes.
    fn owners(&self) -> impl Iterator<Item = (Owner, Range<usize>, &Numbering)> {
        let bodies = self.bodies.iter().enumerate();
        let bodies = bodies.map(|(number, body)| (Owner::Body(number), body.vertices.clone(), body.mesh.numbering()));
        let nets = self.nets.iter().enumerate();
        let nets = nets.map(|(number, net)| (Owner::Net(number), net.vertices.clone(), &net.numbering));
        let membranes =
            self.membranes.iter().enumerate().map(|(number, membrane)| {
                (Owner::Membrane(number), membrane.vertices.clone(), membrane.mesh.numbering())
            });
        bodies.chain(nets).chain(membranes)
    }

    /// Moves values from the first of two numbers to the second, both computed from a vertex and its name.
    fn rearranged<'a>(&self, values: &'a [f64], way: impl Fn([usize; 2]) -> [usize; 2]) -> Cow<'a, [f64]> {
        let mut values = Cow::Borrowed(values);
        for (_, vertices, numbering) in self.owners().filter(|(_, _, numbering)| !numbering.is_as_listed()) {
            let before = values[self.numbers(&vertices)].to_vec();
            let now = &mut values.to_mut()[self.numbers(&vertices)];
            for vertex in 0..vertices.len() {
                let [from, to] = way([vertex, numbering.name(vertex as u32) as usize]);
                let [from, to] = [from, to].map(|vertex| self.numbers(&(vertex..vertex + 1)));
                now[to].copy_from_slice(&before[from]);
            }
        }
        values
    }
}

/// Vertices with positions in one cache line.
const LINE: usize = 4;

/// A cache line counts as cached for this many corner accesses after its last use.
const RECENT: usize = 256;

/// A mesh is renumbered if each cache line is fetched more than this many times in a step. For numbers along rows,
/// rings or a space-filling curve it is at most 0.5 times, because of prefetching; for arbitrary numbers of thousands
/// of vertices or triangles it is 2 to 16 times. A mesh that fits the cache has good locality in any order.
const MAX_FETCHES: f64 = 1.5;

/// A mesh is also renumbered if elements with more corners than this lie between two that share a vertex, and in
/// another order less than half as many: the forces at all those corners must be kept meanwhile. For numbers along rows
/// it is one row or two; a space-filling curve returns to a place after half the mesh.
const MAX_SPREAD: usize = 8192;

/// Renumbers a mesh with poor locality; returns others unchanged.
pub(super) fn mesh(mesh: Mesh) -> Mesh {
    let fans: Vec<_> = mesh.fans().iter().map(|fan| fan.corners(mesh.triangles())).collect();
    let vertices = mesh.points().len();
    let mended = mended(vertices, &fans).or_else(|| partitionable(vertices, &fans));
    let Some([names, order]) = mended else { return mesh };
    let triangles = order.iter().flat_map(|fan| mesh.fans()[*fan as usize].triangles());
    mesh.renumbered(Numbering::new(names, triangles.collect()))
}

/// Renumbers a net with poor locality.
pub(super) fn net(net: Net) -> Net {
    let ends: Vec<_> = net.links().iter().map(|link| link.ends).collect();
    let Some([names, order]) = mended(net.points().len(), &ends) else { return net };
    net.renumbered(Numbering::new(names, order))
}

/// Names of vertices and of elements, springs or fans of triangles, in a better order; `None` if locality is good.
fn mended<const N: usize>(vertices: usize, elements: &[[u32; N]]) -> Option<[Vec<u32>; 2]> {
    let (scattered, apart) = (fetches(vertices, elements) > MAX_FETCHES, spread(vertices, elements.iter()));
    if !scattered && N * apart <= MAX_SPREAD {
        return None;
    }
    let near = by_neighbours(vertices, elements);
    // Elements are sorted by their vertices; the stable sort keeps the order of the file for equal keys.
    let key = |element: &u32| {
        let mut corners = elements[*element as usize].map(|corner| near[corner as usize]);
        corners.sort_unstable();
        corners
    };
    let mut order: Vec<_> = (0..elements.len() as u32).collect();
    order.sort_by_cached_key(key);
    let better = || 2 * spread(vertices, order.iter().map(|element| &elements[*element as usize])) < apart;
    if !scattered && !better() {
        return None;
    }
    Some([by_stages(vertices, elements, &order), order])
}

/// Renumbers the vertices in the order of the elements of the file, if a large body can be partitioned only then.
fn partitionable(vertices: usize, fans: &[[u32; 4]]) -> Option<[Vec<u32>; 2]> {
    if !is_unpartitioned(fans, vertices) {
        return None;
    }
    let order: Vec<_> = (0..fans.len() as u32).collect();
    let names = by_stages(vertices, fans, &order);
    let mut places = vec![0; vertices];
    names.iter().zip(0..).for_each(|(name, place)| places[*name as usize] = place);
    let renamed: Vec<_> = fans.iter().map(|fan| fan.map(|corner| places[corner as usize])).collect();
    (!is_unpartitioned(&renamed, vertices)).then_some([names, order])
}

/// Average number of fetches of a cache line of positions in one pass over all elements: accesses when neither it nor a
/// line beside it was used recently.
fn fetches<const N: usize>(vertices: usize, elements: &[[u32; N]]) -> f64 {
    let mut seen = vec![None; vertices.div_ceil(LINE)];
    let mut fetched = 0_usize;
    for (now, corner) in elements.as_flattened().iter().enumerate() {
        let line = *corner as usize / LINE;
        let beside = &seen[line.saturating_sub(1)..seen.len().min(line + 2)];
        fetched += usize::from(!beside.iter().flatten().any(|before| now - before <= RECENT));
        seen[line] = Some(now);
    }
    fetched as f64 / seen.len() as f64
}

/// Greatest number of elements between the first and the last that share a vertex.
fn spread<'a, const N: usize>(vertices: usize, elements: impl Iterator<Item = &'a [u32; N]>) -> usize {
    let mut first = vec![None; vertices];
    let mut most = 0;
    for (element, corners) in elements.enumerate() {
        for &corner in corners {
            most = most.max(element - *first[corner as usize].get_or_insert(element));
        }
    }
    most
}

/// Place of each vertex in Cuthill-McKee order: breadth-first, with neighbours of few elements first, from a peripheral
/// vertex (E. Cuthill and J. `McKee`, *Reducing the bandwidth of sparse symmetric matrices*, Proc. 24th ACM National
/// Conference, 1969).
fn by_neighbours<const N: usize>(vertices: usize, elements: &[[u32; N]]) -> Vec<u32> {
    let mut around = vec![Vec::new(); vertices];
    for (element, corners) in elements.iter().enumerate() {
        for &corner in corners {
            around[corner as usize].push(element);
        }
    }
    // Number of the last traversal that visited each vertex.
    let mut visited = vec![0_u32; vertices];
    let mut traversals = 0;
    let mut traverse = |from: u32, order: &mut Vec<u32>| {
        traversals += 1;
        let mut next = order.len();
        order.push(from);
        visited[from as usize] = traversals;
        while let Some(&vertex) = order.get(next) {
            let first = order.len();
            for &corner in around[vertex as usize].iter().flat_map(|element| &elements[*element]) {
                if std::mem::replace(&mut visited[corner as usize], traversals) != traversals {
                    order.push(corner);
                }
            }
            order[first..].sort_unstable_by_key(|vertex| (around[*vertex as usize].len(), *vertex));
            next += 1;
        }
    };
    let (mut order, mut places) = (Vec::new(), vec![u32::MAX; vertices]);
    for start in 0..vertices as u32 {
        if places[start as usize] != u32::MAX {
            continue;
        }
        // The last visited vertex is peripheral; a second traversal finds a more distant one.
        let (begin, mut from) = (order.len(), start);
        for _ in 0..2 {
            traverse(from, &mut order);
            from = order.last().copied().unwrap_or(from);
            order.truncate(begin);
        }
        traverse(from, &mut order);
        for (place, vertex) in order.iter().enumerate().skip(begin) {
            places[*vertex as usize] = place as u32;
        }
    }
    places
}

/// Vertices in the order in which their forces are summed: by the stage after which all forces are known, and there by
/// the number of elements. So they are contiguous in memory.
fn by_stages<const N: usize>(vertices: usize, elements: &[[u32; N]], order: &[u32]) -> Vec<u32> {
    let (mut count, mut last) = (vec![0_u32; vertices], vec![0; vertices]);
    for (place, element) in order.iter().enumerate() {
        for corner in elements[*element as usize] {
            count[corner as usize] += 1;
            last[corner as usize] = place;
        }
    }
    let mut names: Vec<_> = (0..vertices as u32).collect();
    names.sort_by_key(|name| {
        let (count, last) = (count[*name as usize], last[*name as usize]);
        (last / STAGE_ELEMENTS, count, last)
    });
    names
}

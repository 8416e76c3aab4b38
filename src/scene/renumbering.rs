//! Renumbering of vertices for locality (reverse Cuthill-McKee).
//!
//! Meshes that are made here have one, as long as they are small. Those from files, and nets, have the numbers that somebody gave them: on
//! a shuffled mesh every corner of a triangle would be fetched from far away. And in large ones that follow a curve through the plane,
//! the forces at a vertex are wanted long after the first of them were known. Such meshes are numbered anew while a scene is built, as they
//! are stepped: fan by fan ([`Mesh::fans`]).
//! Nobody outside needs to know: levels, saved states, tables and messages go on with the names from the file ([`Numbering`]).

use crate::{
    elements::STAGE_ELEMENTS,
    meshes::{Mesh, Numbering},
    nets::Net,
};

/// Vertices whose positions lie in the same line of memory.
const LINE: usize = 4;

/// For so many corners that are looked at after it, a line of memory is taken to be still near.
const RECENT: usize = 256;

/// A mesh is out of order if each line is fetched from far away more than so many times in a step. Where rows, rings or a curve that fills the
/// plane are followed that is at most 0.5 times, as the processor sees the next line coming; where thousands of vertices or triangles
/// are listed anyhow it is 2 to 16 times. What is so small that it is always near is in order in any order.
const MAX_FETCHES: f64 = 1.5;

/// Nor is it in order if elements with more corners than these lie between two that meet at a vertex, and in another order less than half
/// as many: the forces at all those corners have to be kept meanwhile. Where rows are followed it is one row or two; a curve that fills
/// the plane passes where it has been before half the mesh ago.
const MAX_SPREAD: usize = 8192;

/// A mesh in a better order, if it is out of order; others are left as they are.
pub(super) fn mesh(mesh: Mesh) -> Mesh {
    let fans: Vec<_> = mesh.fans().iter().map(|fan| fan.corners(mesh.triangles())).collect();
    let Some([names, order]) = mended(mesh.points().len(), &fans) else { return mesh };
    let triangles = order.iter().flat_map(|fan| mesh.fans()[*fan as usize].triangles());
    mesh.renumbered(Numbering::new(names, triangles.collect()))
}

/// A net in a better order, if it is out of order.
pub(super) fn net(net: Net) -> Net {
    let ends: Vec<_> = net.links().iter().map(|link| link.ends).collect();
    let Some([names, order]) = mended(net.points().len(), &ends) else { return net };
    net.renumbered(Numbering::new(names, order))
}

/// The names of vertices and of elements, springs or fans of triangles, in a better order; nothing where they are in order.
fn mended<const N: usize>(vertices: usize, elements: &[[u32; N]]) -> Option<[Vec<u32>; 2]> {
    let (scattered, apart) = (fetches(vertices, elements) > MAX_FETCHES, spread(vertices, elements.iter()));
    if !scattered && N * apart <= MAX_SPREAD {
        return None;
    }
    let near = by_neighbours(vertices, elements);
    // What is listed with the lowest vertex comes first; a stable sort keeps the order of the file where that says nothing.
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

/// How often a line of positions is fetched from far away in a sweep over all elements, on average: when neither it nor a line
/// beside it was looked at lately.
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

/// The most elements between the first and the last that meet at a vertex.
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

/// The place of each vertex in an order in which neighbours are near: one after another names its neighbours, those with few
/// elements first, beginning at the edge (E. Cuthill and J. `McKee`, *Reducing the bandwidth of sparse symmetric matrices*, Proc. 24th
/// ACM National Conference, 1969).
fn by_neighbours<const N: usize>(vertices: usize, elements: &[[u32; N]]) -> Vec<u32> {
    let mut around = vec![Vec::new(); vertices];
    for (element, corners) in elements.iter().enumerate() {
        for &corner in corners {
            around[corner as usize].push(element);
        }
    }
    // In which walk each vertex was met last.
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
        // Who is met last is at the edge; twice, as far away as can be.
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

/// The vertices in the order in which their forces are summed: by the stretch of elements after which they have them all, and there
/// those with as many elements as each other in a row. Then they follow each other in memory.
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

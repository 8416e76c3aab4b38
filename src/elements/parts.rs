//! A large body cut into parts that several threads step together ([`super::walk`]).
//!
//! Each part has its own copy of its vertices, and of those on the seams between parts, which all of them keep. Sums at the seams
//! are sums over the parts whoever steps ([`super::gather`]), so that any number of threads comes to the same bits.

use super::{
    blocks::{Block, Laws},
    corners::Corners,
    gather::Gather,
    sweep::Piece,
    walk::{Ground, More, Outcome, Way, walk},
};
use crate::lanes::LANES;
use pulp::Arch;
use std::ops::Range;

/// Bodies of so many triangles are cut in two: a part has to be worth a thread.
const LARGE: usize = 8192;

/// A mesh in whose seams more than this share of its vertices would lie is left whole.
const SEAM: f64 = 0.1;

/// The triangles at which the second and further parts begin, for a mesh that is worth being cut.
pub fn cuts(corners: &[[u32; 3]]) -> Vec<usize> {
    if corners.len() < LARGE {
        return Vec::new();
    }
    let cuts = vec![corners.len() / 2 / LANES * LANES];
    let vertices = corners.as_flattened().iter().max().map_or(0, |most| *most as usize + 1);
    let first = corners.as_flattened().iter().min().map_or(0, |least| *least as usize);
    let seam = seam(corners, &cuts, &(first..vertices)).len();
    if seam as f64 > SEAM * (vertices - first) as f64 { Vec::new() } else { cuts }
}

/// The vertices that lie in several parts, ascending.
fn seam(corners: &[[u32; 3]], cuts: &[usize], vertices: &Range<usize>) -> Vec<u32> {
    let mut part_of = vec![None; vertices.len()];
    let mut found = Vec::new();
    for (triangle, corners) in corners.iter().enumerate() {
        let part = cuts.partition_point(|cut| *cut <= triangle);
        for &corner in corners {
            if *part_of[corner as usize - vertices.start].get_or_insert(part) != part {
                found.push(corner);
            }
        }
    }
    found.sort_unstable();
    found.dedup();
    found
}

/// A body in parts.
#[derive(Debug)]
pub struct Parts {
    parts: Vec<Part>,
    /// Scene numbers of the vertices on the seams.
    seam: Vec<u32>,
}

/// A part of a body.
#[derive(Debug)]
struct Part {
    /// Scene numbers of the vertices that are its alone; in its own numbers those on the seams come after them.
    own: Vec<u32>,
    /// Of its triangles, in its own numbers.
    corners: Corners,
    /// The first block of triangles.
    block: usize,
    gather: Gather,
    /// The stage after which it has all its forces at the seams.
    met: usize,
}

impl Part {
    /// The numbers of the vertices that are its alone, if they follow each other.
    fn in_a_row(&self) -> Option<Range<usize>> {
        let (first, last) = (*self.own.first()? as usize, *self.own.last()? as usize);
        (last - first < self.own.len()).then_some(first..last + 1)
    }
}

impl Parts {
    /// The parts of a mesh, for an instruction set; none if it is to be left whole.
    pub fn new(corners: &[[u32; 3]], vertices: &Range<usize>, set: Arch) -> Option<Self> {
        let cuts = Some(cuts(corners)).filter(|cuts| !cuts.is_empty())?;
        let seam = seam(corners, &cuts, vertices);
        let ends = cuts.iter().copied().chain([corners.len()]);
        let begins = [0].into_iter().chain(cuts.iter().copied());
        let part = |(number, (begin, end)): (usize, (usize, usize))| {
            let corners = &corners[begin..end];
            let mut own: Vec<_> =
                corners.as_flattened().iter().copied().filter(|vertex| seam.binary_search(vertex).is_err()).collect();
            own.sort_unstable();
            own.dedup();
            let renamed = |vertex: u32| match own.binary_search(&vertex) {
                Ok(number) => number,
                Err(_) => own.len() + seam.partition_point(|other| *other < vertex),
            };
            let corners: Vec<_> = corners.iter().map(|corners| corners.map(|vertex| renamed(vertex) as u32)).collect();
            // The first ends at the seam, and begins with it, so that both know early in a step how the seam moves.
            let gather = Gather::new(&corners, &(0..own.len() + seam.len()), (&[], number == 0), set);
            let on_seam = |corners: &[u32; 3]| corners.iter().any(|corner| *corner as usize >= own.len());
            let stages = corners.iter().enumerate().filter(|(_, corners)| on_seam(corners));
            let met = stages.map(|(triangle, _)| gather.stage(triangle)).max().unwrap_or(0);
            Part { own, corners: Corners::new(&corners), block: begin / LANES, gather, met }
        };
        Some(Self { parts: begins.zip(ends).enumerate().map(part).collect(), seam })
    }

    /// How many parts there are.
    pub const fn count(&self) -> usize {
        self.parts.len()
    }

    /// How many vertices lie on the seams.
    pub const fn seam(&self) -> usize {
        self.seam.len()
    }
}

/// Who walks for a part, with its own copy of what it moves.
#[derive(Debug, Default)]
pub struct Walker {
    part: usize,
    x: Vec<[f64; 2]>,
    v: Vec<[f64; 2]>,
    mass: Vec<[f64; 2]>,
    inverse_mass: Vec<[f64; 2]>,
    scratch: Vec<f64>,
    /// What came of the last walk.
    pub outcome: Outcome,
}

impl Walker {
    /// For one part.
    pub fn new(part: usize) -> Self {
        Self { part, ..Self::default() }
    }

    /// Takes positions, velocities, masses and their reciprocals from the whole scene; all flat.
    pub fn set_out(&mut self, parts: &Parts, whole: [&[f64]; 4]) {
        let part = &parts.parts[self.part];
        let own = [&mut self.x, &mut self.v, &mut self.mass, &mut self.inverse_mass];
        for (own, whole) in own.into_iter().zip(whole) {
            let whole: &[[f64; 2]] = whole.as_chunks().0;
            own.clear();
            match part.in_a_row() {
                Some(run) => own.extend_from_slice(&whole[run]),
                None => own.extend(part.own.iter().map(|vertex| whole[*vertex as usize])),
            }
            own.extend(parts.seam.iter().map(|vertex| whole[*vertex as usize]));
        }
    }

    /// Writes positions and velocities to the whole scene; the first part also those on the seams.
    pub fn arrive(&self, parts: &Parts, x: &mut [f64], v: &mut [f64]) {
        let part = &parts.parts[self.part];
        let seam = if self.part == 0 { parts.seam.as_slice() } else { &[] };
        for (whole, own) in [(x, &self.x), (v, &self.v)] {
            let whole: &mut [[f64; 2]] = whole.as_chunks_mut().0;
            let (own, of_seam) = own.split_at(part.own.len());
            match part.in_a_row() {
                Some(run) => whole[run].copy_from_slice(own),
                None => part.own.iter().zip(own).for_each(|(vertex, own)| whole[*vertex as usize] = *own),
            }
            seam.iter().zip(of_seam).for_each(|(vertex, own)| whole[*vertex as usize] = *own);
        }
    }

    /// Takes steps together with the walkers of the other parts.
    pub fn walk<L: Laws<N>, const N: usize>(
        &mut self,
        laws: L,
        parts: &Parts,
        blocks: &[Block],
        way: (&Way, More<'_>),
    ) {
        let part = &parts.parts[self.part];
        let ground = Ground {
            piece: Piece { corners: &part.corners, blocks: &blocks[part.block..], gather: &part.gather },
            number: self.part,
            x: &mut self.x,
            v: &mut self.v,
            masses: [&self.mass, &self.inverse_mass],
            own: part.own.len(),
            met: part.met,
        };
        self.outcome = walk(laws, ground, way, &mut self.scratch);
    }
}

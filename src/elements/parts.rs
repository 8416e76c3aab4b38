//! A large body cut into parts that several threads step together ([`super::walk`]).
//!
//! Each part has its own copy of its vertices, and of those on the seams between parts, which all of them keep. Sums at the seams
//! are sums over the parts whoever steps ([`super::gather`]), so that any number of threads comes to the same bits.

use super::{
    blocks::{Blocks, StressModel},
    corners::Corners,
    gather::{Gather, STRETCH},
    patience::Patience,
    sweep::Piece,
    triangle::Rest,
    walk::{Ground, More, Outcome, Way, walk},
};
use crate::simd::{LANES, Lined, Order};
use pulp::Arch;
use std::ops::Range;

/// Bodies of so many fans are cut in two: a part has to be worth a thread.
const LARGE: usize = 4096;

/// A mesh in whose seams more than this share of its vertices would lie is left whole.
const SEAM: f64 = 0.1;

/// The fans at which the second and further parts begin, for a mesh that is worth being cut.
pub fn cuts(corners: &[[u32; 4]]) -> Vec<usize> {
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
fn seam(corners: &[[u32; 4]], cuts: &[usize], vertices: &Range<usize>) -> Vec<u32> {
    let mut part_of = vec![None; vertices.len()];
    let mut found = Vec::new();
    for (fan, corners) in corners.iter().enumerate() {
        let part = cuts.partition_point(|cut| *cut <= fan);
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

/// A part of a body. All it has is in the order in which it is swept over, from the seam on: memory is read from front to back then,
/// as the processor expects.
#[derive(Debug)]
struct Part {
    /// Scene numbers of the vertices that are its alone; in its own numbers those on the seams come after them.
    own: Vec<u32>,
    /// Of its fans, in its own numbers.
    corners: Corners<4>,
    blocks: Blocks,
    gather: Gather,
    /// The stage after which it has all its forces at the seams.
    met: usize,
}

impl Parts {
    /// The parts of a mesh, whose fans have these rest shapes, for an instruction set; none if it is to be left whole.
    pub(super) fn new(
        corners: &[[u32; 4]],
        vertices: &Range<usize>,
        rest: impl Fn(usize) -> [Rest; 2],
        set: Arch,
    ) -> Option<Self> {
        let cuts = Some(cuts(corners)).filter(|cuts| !cuts.is_empty())?;
        let seam = seam(corners, &cuts, vertices);
        let ends = cuts.iter().copied().chain([corners.len()]);
        let begins = [0].into_iter().chain(cuts.iter().copied());
        let part = |(number, fans): (usize, Range<usize>)| {
            // The first ends at the seam, so it is taken the other way round: both know early in a step how the seam moves.
            let turned = number == 0;
            let mut fans: Vec<_> = fans.collect();
            let of_fans = fans.iter().flat_map(|fan| corners[*fan]);
            let mut own: Vec<_> = of_fans.filter(|vertex| seam.binary_search(vertex).is_err()).collect();
            own.sort_unstable();
            own.dedup();
            if turned {
                fans.reverse();
                own.reverse();
            }
            let renamed = |vertex: u32| match seam.binary_search(&vertex) {
                Ok(at) => own.len() + at,
                Err(_) => own.partition_point(|other| if turned { *other > vertex } else { *other < vertex }),
            };
            let corners = fans.iter().map(|fan| corners[*fan].map(|vertex| renamed(vertex) as u32));
            let corners: Vec<_> = corners.collect();
            let shapes: Vec<_> = fans.iter().map(|fan| rest(*fan)).collect();
            let gather = Gather::new(&corners, &(0..own.len() + seam.len()), (&[], turned), &Order::of_pairs(set));
            let on_seam = |corners: &[u32; 4]| corners.iter().any(|corner| *corner as usize >= own.len());
            let met = corners.iter().rposition(on_seam).map_or(0, |fan| fan / STRETCH);
            Part { own, corners: Corners::new(&corners, 0), blocks: Blocks::new(&shapes, set), gather, met }
        };
        let fans = begins.zip(ends).map(|(begin, end)| begin..end);
        Some(Self { parts: fans.enumerate().map(part).collect(), seam })
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

/// Who walks for a part or, where there are no parts, for a whole body, with its own copy of what it moves.
#[derive(Debug, Default)]
pub struct Walker {
    part: usize,
    /// Positions, velocities, masses and their reciprocals; flat.
    own: [Lined; 4],
    scratch: Vec<f64>,
    patience: Patience,
    /// What came of the last walk.
    pub outcome: Outcome,
}

impl Walker {
    /// For one part; the first, if there are none.
    pub fn new(part: usize) -> Self {
        Self { part, ..Self::default() }
    }

    /// Takes positions, velocities, masses and their reciprocals from the whole scene; all flat.
    pub fn set_out(&mut self, parts: Option<&Parts>, whole: [&[f64]; 4]) {
        for (own, whole) in self.own.iter_mut().zip(whole) {
            let Some(parts) = parts else {
                own.fit(whole.len()).copy_from_slice(whole);
                continue;
            };
            let part = &parts.parts[self.part];
            let whole: &[[f64; 2]] = whole.as_chunks().0;
            let own = own.fit(2 * (part.own.len() + parts.seam.len()));
            let (own, of_seam) = own.as_chunks_mut().0.split_at_mut(part.own.len());
            own.iter_mut().zip(&part.own).for_each(|(own, vertex)| *own = whole[*vertex as usize]);
            of_seam.iter_mut().zip(&parts.seam).for_each(|(own, vertex)| *own = whole[*vertex as usize]);
        }
    }

    /// Writes positions and velocities to the whole scene; the first part also those on the seams.
    pub fn arrive(&self, parts: Option<&Parts>, moving: [&mut [f64]; 2]) {
        for (whole, own) in moving.into_iter().zip(&self.own) {
            let Some(parts) = parts else {
                whole.copy_from_slice(own.numbers());
                continue;
            };
            let part = &parts.parts[self.part];
            let seam = if self.part == 0 { parts.seam.as_slice() } else { &[] };
            let whole: &mut [[f64; 2]] = whole.as_chunks_mut().0;
            let (own, of_seam) = own.numbers().as_chunks().0.split_at(part.own.len());
            part.own.iter().zip(own).for_each(|(vertex, own)| whole[*vertex as usize] = *own);
            seam.iter().zip(of_seam).for_each(|(vertex, own)| whole[*vertex as usize] = *own);
        }
    }

    /// Takes steps over a body, together with the walkers of the other parts.
    pub fn walk<L: StressModel<N>, const N: usize>(
        &mut self,
        laws: L,
        (whole, parts): (Piece<'_>, Option<&Parts>),
        way: (&Way, More<'_>),
    ) {
        let [x, v, mass, inverse_mass] = &mut self.own;
        let masses: [&[_]; 2] = [mass, inverse_mass].map(|masses| masses.numbers().as_chunks().0);
        let (piece, own, met) = parts.map_or((whole.clone(), masses[0].len(), 0), |parts| {
            let part = &parts.parts[self.part];
            let piece = Piece {
                vertices: 0..masses[0].len(),
                corners: &part.corners,
                blocks: part.blocks.all(),
                gather: &part.gather,
            };
            (piece, part.own.len(), part.met)
        });
        let [x, v] = [x, v].map(|moving| moving.and_more().as_chunks_mut().0);
        let ground = Ground { piece, number: self.part, x, v, masses, own, met };
        self.outcome = walk(laws, ground, way, (&mut self.scratch, &mut self.patience));
    }
}

//! Triangles in blocks of eight, one in each lane: where a whole mesh is swept over.

use super::{
    corners::{Corners, RUN},
    triangle::{Rest, edges, edges_between},
};
use crate::{
    lanes::{LANES, Lanes, Order, Pairs, Quads, Real, Square, Wide},
    materials::Material,
};
use nalgebra::Matrix2;
use pulp::{Arch, Simd, WithSimd};

/// Forces at the first, second and third corners of a block [N].
pub type CornerForces = [Pairs; 3];

/// Rest shapes of eight triangles, in the lanes that [`Order`] gives them.
#[derive(Clone, Debug, Default)]
#[repr(align(64))]
pub struct Block {
    /// D0⁻¹, column by column [1/m].
    inverse: [Lanes; 4],
    /// Minus the area [m²], which is the volume of unit thickness: as forces are computed from it.
    minus_area: Lanes,
}

/// A first Piola-Kirchhoff stress as a function of F and, if it asks for it, dF/dt.
pub trait Law: Copy {
    /// Whether it asks for dF/dt; if not, `rate` is not to be used.
    const RATE: bool;

    /// The stress [Pa].
    fn stress<R: Real>(&self, f: Square<R>, rate: Square<R>) -> Square<R>;
}

/// Several stresses of the same triangles, whose forces are summed up each by itself.
pub trait Laws<const N: usize>: Copy {
    /// Whether any asks for dF/dt; if not, `rate` is not to be used.
    const RATE: bool;

    /// The stresses [Pa].
    fn stresses<R: Real>(&self, f: Square<R>, rate: Square<R>) -> [Square<R>; N];
}

impl<L: Law> Laws<1> for L {
    const RATE: bool = L::RATE;

    #[inline(always)]
    fn stresses<R: Real>(&self, f: Square<R>, rate: Square<R>) -> [Square<R>; 1] {
        [self.stress(f, rate)]
    }
}

/// Two of them.
#[derive(Clone, Copy)]
pub struct Both<A, B>(pub A, pub B);

impl<A: Law, B: Law> Laws<2> for Both<A, B> {
    const RATE: bool = A::RATE || B::RATE;

    #[inline(always)]
    fn stresses<R: Real>(&self, f: Square<R>, rate: Square<R>) -> [Square<R>; 2] {
        [self.0.stress(f, rate), self.1.stress(f, rate)]
    }
}

/// The stress of a material.
#[derive(Clone, Copy)]
pub struct Elastic<M>(pub M);

impl<M: Material> Law for Elastic<M> {
    const RATE: bool = false;

    #[inline(always)]
    fn stress<R: Real>(&self, f: Square<R>, _: Square<R>) -> Square<R> {
        self.0.piola(f)
    }
}

/// Rest shapes in blocks.
#[derive(Debug)]
pub struct Blocks {
    blocks: Vec<Block>,
    order: Order,
}

impl Blocks {
    /// Packs rest shapes for an instruction set; the lanes left over are triangles of no area.
    pub fn new(shapes: &[Rest], set: Arch) -> Self {
        let order = Order::new(set);
        let pack = |shapes: &[Rest]| {
            let mut block = Block::default();
            for (Rest { inverse, area }, lane) in shapes.iter().zip(order.lane) {
                for (to, from) in block.inverse.iter_mut().zip(inverse.as_slice()) {
                    to[lane] = *from;
                }
                block.minus_area[lane] = -*area;
            }
            block
        };
        Self { blocks: shapes.chunks(LANES).map(pack).collect(), order }
    }

    /// The instruction set.
    pub const fn set(&self) -> Arch {
        self.order.set
    }

    /// All of them.
    pub fn all(&self) -> &[Block] {
        &self.blocks
    }

    /// The rest shape of one triangle.
    #[inline]
    pub fn rest(&self, triangle: usize) -> Rest {
        let (block, lane) = (&self.blocks[triangle / LANES], self.order.lane[triangle % LANES]);
        let [m11, m21, m12, m22] = [0, 1, 2, 3].map(|entry| block.inverse[entry][lane]);
        Rest { inverse: Matrix2::new(m11, m12, m21, m22), area: -block.minus_area[lane] }
    }
}

/// Part of the matrices of a block, taken apart.
#[inline(always)]
fn taken_apart<S: Simd>(set: S, of: &Quads, part: usize) -> Square<Wide<S>> {
    let [m11, m21, m12, m22] = Wide::load_quads(set, of, part);
    Square::new(m11, m12, m21, m22)
}

/// Part of D0⁻¹.
#[inline(always)]
fn inverse<S: Simd>(set: S, of: &Block, part: usize) -> Square<Wide<S>> {
    let [m11, m21, m12, m22] = &of.inverse;
    Square::new(
        Wide::load(set, m11, part),
        Wide::load(set, m12, part),
        Wide::load(set, m21, part),
        Wide::load(set, m22, part),
    )
}

/// The matrices D of a run.
#[derive(Default)]
#[repr(align(64))]
struct Run([Quads; RUN]);

/// Computes the forces at all corners from [`Laws`].
pub struct Forces<'a, L, const N: usize> {
    pub laws: L,
    pub corners: &'a Corners<3>,
    /// The run with which `blocks` begins.
    pub first: usize,
    pub blocks: &'a [Block],
    pub x: &'a [f64],
    pub v: &'a [f64],
    /// Those of each stress, run by run.
    pub out: [&'a mut [[CornerForces; RUN]]; N],
}

impl<const N: usize, L: Laws<N>> WithSimd for Forces<'_, L, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) {
        let Self { laws, corners, first, blocks, x, v, mut out } = self;
        let (mut now, mut rates) = (Run::default(), Run::default());
        let runs = blocks.chunks(RUN);
        let end = first + runs.len();
        let mut ahead = None;
        for (run, blocks) in (first..end).zip(runs) {
            let out = out.each_mut().map(|out| &mut out[run - first]);
            if ahead.is_none() {
                corners.collect(run, x, edges_between, &mut now.0);
                if L::RATE {
                    corners.collect(run, v, edges_between, &mut rates.0);
                }
            }
            let of = |moving| if run + 1 < end { corners.ahead(run + 1, moving) } else { None };
            ahead = of(x).zip(of(if L::RATE { v } else { x }));
            for (number, (block, now)) in blocks.iter().zip(&mut now.0).enumerate() {
                for part in 0..Wide::<S>::PARTS {
                    let inverse = inverse(set, block, part);
                    let f = taken_apart(set, now, part).times(inverse);
                    let rate = if L::RATE { taken_apart(set, &rates.0[number], part).times(inverse) } else { f };
                    let stresses = laws.stresses(f, rate);
                    let (turned, minus_area) = (inverse.transpose(), Wide::load(set, &block.minus_area, part));
                    for law in 0..N {
                        let h = stresses[law].times(turned) * minus_area;
                        let forces = [[-h.m11 - h.m12, -h.m21 - h.m22], [h.m11, h.m21], [h.m12, h.m22]];
                        for (out, [x, y]) in out[law][number].iter_mut().zip(forces) {
                            Wide::store_pairs(x, y, out, part);
                        }
                    }
                }
                // What is collected needs other parts of the processor than the stresses do, and both go on at once.
                if let Some((of_x, of_v)) = ahead {
                    of_x.collect(number, edges_between, now);
                    if L::RATE {
                        of_v.collect(number, edges_between, &mut rates.0[number]);
                    }
                }
            }
        }
    }
}

/// Sums the energy of all triangles [J], in their order.
pub struct Energy<'a, M> {
    pub material: &'a M,
    pub corners: &'a [[u32; 3]],
    pub blocks: &'a Blocks,
    pub x: &'a [f64],
}

impl<M: Material> WithSimd for Energy<'_, M> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) -> f64 {
        let x = self.x.as_chunks().0;
        let mut now = [Quads::default()];
        let mut energies = Lanes::default();
        let mut sum = 0.0;
        for (corners, block) in self.corners.chunks(LANES).zip(&self.blocks.blocks) {
            for (to, &triangle) in now.as_flattened_mut().iter_mut().zip(corners) {
                *to = edges(x, triangle);
            }
            for part in 0..Wide::<S>::PARTS {
                let f = taken_apart(set, &now[0], part).times(inverse(set, block, part));
                (self.material.psi(f) * -Wide::load(set, &block.minus_area, part)).store(&mut energies, part);
            }
            // A lane left over holds what is not a triangle.
            sum = self.blocks.order.lane[..corners.len()].iter().fold(sum, |sum, &lane| sum + energies[lane]);
        }
        sum
    }
}

//! Triangles in blocks of eight, one in each lane: where a whole mesh is swept over.

use super::triangle::{Rest, edges};
use crate::{
    lanes::{LANES, Lanes, Pairs, Real, Square, Wide},
    materials::Material,
};
use nalgebra::Matrix2;
use pulp::{Simd, WithSimd};

/// How many blocks have their corners collected at a time: enough for what is stored number by number to have arrived when
/// it is read lane by lane, and little enough to stay near the processor.
const RUN: usize = 8;

/// Numbers for each triangle of a block: an entry of a 2 x 2 matrix after the other (11, 12, 21, 22).
type Matrices = [Lanes; 4];

/// Forces at the first, second and third corners of a block [N].
pub type CornerForces = [Pairs; 3];

/// Rest shapes of eight triangles.
#[derive(Clone, Debug, Default)]
#[repr(align(64))]
pub struct Block {
    /// D0⁻¹ [1/m].
    inverse: Matrices,
    /// Area [m²], which is the volume of unit thickness.
    area: Lanes,
}

/// A first Piola-Kirchhoff stress as a function of F and, if it asks for it, dF/dt.
pub trait Law: Copy {
    /// Whether it asks for dF/dt; if not, `rate` is not to be used.
    const RATE: bool;

    /// The stress [Pa].
    fn stress<R: Real>(&self, f: Square<R>, rate: Square<R>) -> Square<R>;
}

/// The stress of a material.
#[derive(Clone, Copy)]
pub struct Elastic<'a, M>(pub &'a M);

impl<M: Material> Law for Elastic<'_, M> {
    const RATE: bool = false;

    #[inline(always)]
    fn stress<R: Real>(&self, f: Square<R>, _: Square<R>) -> Square<R> {
        self.0.piola(f)
    }
}

/// Packs rest shapes; the lanes left over are triangles of no area.
pub fn packed(shapes: &[Rest]) -> Vec<Block> {
    let pack = |shapes: &[Rest]| {
        let mut block = Block::default();
        for (lane, Rest { inverse, area }) in shapes.iter().enumerate() {
            for (to, from) in block.inverse.iter_mut().zip([inverse.m11, inverse.m12, inverse.m21, inverse.m22]) {
                to[lane] = from;
            }
            block.area[lane] = *area;
        }
        block
    };
    shapes.chunks(LANES).map(pack).collect()
}

/// The rest shape of one triangle.
#[inline(always)]
pub fn rest(blocks: &[Block], triangle: usize) -> Rest {
    let (block, lane) = (&blocks[triangle / LANES], triangle % LANES);
    let [m11, m12, m21, m22] = block.inverse.map(|entries| entries[lane]);
    Rest { inverse: Matrix2::new(m11, m12, m21, m22), area: block.area[lane] }
}

/// D of each triangle, from the vertices of its corners.
#[inline(always)]
fn collect(x: &[[f64; 2]], corners: &[[u32; 3]], out: &mut [Matrices]) {
    for (corners, out) in corners.chunks(LANES).zip(out) {
        for (lane, &triangle) in corners.iter().enumerate() {
            let [m11, m12, m21, m22] = edges(x, triangle);
            out[0][lane] = m11;
            out[1][lane] = m12;
            out[2][lane] = m21;
            out[3][lane] = m22;
        }
    }
}

/// Part of the matrices of a block.
#[inline(always)]
fn square<S: Simd>(set: S, of: &Matrices, part: usize) -> Square<Wide<S>> {
    let [m11, m12, m21, m22] = [0, 1, 2, 3].map(|entry| Wide::load(set, &of[entry], part));
    Square::new(m11, m12, m21, m22)
}

/// Computes the forces at all corners from a [`Law`].
pub struct Forces<'a, L> {
    pub law: L,
    pub corners: &'a [[u32; 3]],
    pub blocks: &'a [Block],
    pub x: &'a [f64],
    pub v: &'a [f64],
    pub out: &'a mut [CornerForces],
}

impl<L: Law> WithSimd for Forces<'_, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) {
        let Self { law, corners, blocks, x, v, out } = self;
        let (x, v) = (x.as_chunks().0, v.as_chunks().0);
        let (mut now, mut rates) = ([Matrices::default(); RUN], [Matrices::default(); RUN]);
        for ((corners, blocks), out) in corners.chunks(RUN * LANES).zip(blocks.chunks(RUN)).zip(out.chunks_mut(RUN)) {
            collect(x, corners, &mut now);
            if L::RATE {
                collect(v, corners, &mut rates);
            }
            for (((block, now), rates), out) in blocks.iter().zip(&now).zip(&rates).zip(out) {
                for part in 0..Wide::<S>::PARTS {
                    let inverse = square(set, &block.inverse, part);
                    let f = square(set, now, part).times(inverse);
                    let rate = if L::RATE { square(set, rates, part).times(inverse) } else { f };
                    let h = law.stress(f, rate).times(inverse.transpose()) * -Wide::load(set, &block.area, part);
                    let forces = [[-h.m11 - h.m12, -h.m21 - h.m22], [h.m11, h.m21], [h.m12, h.m22]];
                    for (out, [x, y]) in out.iter_mut().zip(forces) {
                        Wide::store_pairs(x, y, out, part);
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
    pub blocks: &'a [Block],
    pub x: &'a [f64],
}

impl<M: Material> WithSimd for Energy<'_, M> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) -> f64 {
        let x = self.x.as_chunks().0;
        let mut now = [Matrices::default()];
        let mut energies = Lanes::default();
        let mut sum = 0.0;
        for (corners, block) in self.corners.chunks(LANES).zip(self.blocks) {
            collect(x, corners, &mut now);
            for part in 0..Wide::<S>::PARTS {
                let f = square(set, &now[0], part).times(square(set, &block.inverse, part));
                (self.material.psi(f) * Wide::load(set, &block.area, part)).store(&mut energies, part);
            }
            // A lane left over holds what is not a triangle.
            sum = energies[..corners.len()].iter().fold(sum, |sum, energy| sum + energy);
        }
        sum
    }
}

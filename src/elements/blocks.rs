//! Blocks of eight fans of two triangles, one fan in each SIMD lane, for passes over a whole mesh.

use super::{
    gather::{Corners, RUN_BLOCKS},
    triangle::Rest,
};
use crate::{
    materials::Material,
    simd::{Interleaved, LANES, Lanes, Mat2, Order, Pairs, Real, Wide},
};
use nalgebra::Matrix2;
use pulp::{Arch, Simd, WithSimd};
use std::array;

/// Forces on the middle vertex of each fan of a block and at the ends of its edge vectors \[N\].
pub type CornerForces = [Pairs; 4];

/// Edge vectors of each fan of a block \[m\], or their rates [m/s].
pub type EdgeVectors = [Pairs; 3];

/// Matrices (2 x 2) of the first, or of the second, triangles of eight fans, column by column.
#[derive(Clone, Debug, Default)]
struct Matrices([Lanes; 4]);

/// Rest shapes of the first, or of the second, triangles of eight fans, in the lanes that [`Order::of_pairs`] gives them.
#[derive(Clone, Debug, Default)]
struct Shapes {
    /// D0⁻¹ [1/m].
    inverse: Matrices,
    /// Minus the area \[m²\], which is the volume of unit thickness; the factor of forces.
    minus_area: Lanes,
}

/// Rest shapes of eight fans: those of their first triangles, and those of their second.
#[derive(Clone, Debug, Default)]
#[repr(align(64))]
pub struct Block([Shapes; 2]);

/// A first Piola-Kirchhoff stress as a function of F and, if [`Self::RATE`], of dF/dt.
pub trait StressLaw: Copy + Send + Sync {
    /// Whether it depends on dF/dt; if not, `rate` is undefined.
    const RATE: bool;

    /// The stress \[Pa\].
    fn stress<R: Real>(&self, f: Mat2<R>, rate: Mat2<R>) -> Mat2<R>;
}

/// Several stresses of the same triangles, whose forces are summed separately.
pub trait StressModel<const N: usize>: Copy + Send + Sync {
    /// Whether any depends on dF/dt; if not, `rate` is undefined.
    const RATE: bool;

    /// The stresses \[Pa\].
    fn stresses<R: Real>(&self, f: Mat2<R>, rate: Mat2<R>) -> [Mat2<R>; N];
}

impl<L: StressLaw> StressModel<1> for L {
    const RATE: bool = L::RATE;

    #[inline(always)]
    fn stresses<R: Real>(&self, f: Mat2<R>, rate: Mat2<R>) -> [Mat2<R>; 1] {
        [self.stress(f, rate)]
    }
}

/// Two stresses.
#[derive(Clone, Copy)]
pub struct Both<A, B>(pub A, pub B);

impl<A: StressLaw, B: StressLaw> StressModel<2> for Both<A, B> {
    const RATE: bool = A::RATE || B::RATE;

    #[inline(always)]
    fn stresses<R: Real>(&self, f: Mat2<R>, rate: Mat2<R>) -> [Mat2<R>; 2] {
        [self.0.stress(f, rate), self.1.stress(f, rate)]
    }
}

/// The stress of a material.
#[derive(Clone, Copy)]
pub struct Elastic<M>(pub M);

impl<M: Material> StressLaw for Elastic<M> {
    const RATE: bool = false;

    #[inline(always)]
    fn stress<R: Real>(&self, f: Mat2<R>, _: Mat2<R>) -> Mat2<R> {
        self.0.piola(f)
    }
}

/// A stress that is the derivative of an energy density.
pub trait EnergyLaw: StressLaw {
    /// The energy density \[Pa\].
    fn energy<R: Real>(&self, f: Mat2<R>) -> R;

    /// See [`Material::volumetric`].
    #[inline(always)]
    fn volumetric<R: Real>(&self, measure: R) -> [R; 3] {
        [measure.of(0.0); 3]
    }

    /// The stress through the thickness in plane strain, P33 \[Pa\].
    fn thickness_stress(&self, _f: Mat2<f64>) -> f64 {
        0.0
    }
}

impl<M: Material> EnergyLaw for Elastic<M> {
    #[inline(always)]
    fn energy<R: Real>(&self, f: Mat2<R>) -> R {
        self.0.psi(f)
    }

    #[inline(always)]
    fn volumetric<R: Real>(&self, measure: R) -> [R; 3] {
        self.0.volumetric(measure)
    }

    fn thickness_stress(&self, f: Mat2<f64>) -> f64 {
        self.0.thickness_stress(f)
    }
}

/// Rest shapes in blocks.
#[derive(Debug)]
pub struct Blocks {
    all: Vec<Block>,
    fans: usize,
    order: Order,
}

impl Blocks {
    /// Packs the rest shapes of fans for an instruction set; unused lanes are triangles of zero area.
    pub fn new(fans: &[[Rest; 2]], set: Arch) -> Self {
        let order = Order::of_pairs(set);
        let pack = |fans: &[[Rest; 2]]| {
            let mut block = Block::default();
            for (fan, lane) in fans.iter().zip(order.lane) {
                for (shapes, Rest { inverse, area }) in block.0.iter_mut().zip(fan) {
                    for (to, from) in shapes.inverse.0.iter_mut().zip(inverse.as_slice()) {
                        to[lane] = *from;
                    }
                    shapes.minus_area[lane] = -*area;
                }
            }
            block
        };
        Self { all: fans.chunks(LANES).map(pack).collect(), fans: fans.len(), order }
    }

    /// The instruction set.
    pub const fn set(&self) -> Arch {
        self.order.set
    }

    /// Number of fans.
    pub const fn fans(&self) -> usize {
        self.fans
    }

    /// All blocks.
    pub fn all(&self) -> &[Block] {
        &self.all
    }

    /// The rest shape of one triangle, which is the first or the second of a fan.
    #[inline]
    pub fn rest(&self, fan: usize, side: usize) -> Rest {
        let (shapes, lane) = (&self.all[fan / LANES].0[side], self.order.lane[fan % LANES]);
        let [m11, m21, m12, m22] = [0, 1, 2, 3].map(|entry| shapes.inverse.0[entry][lane]);
        Rest { inverse: Matrix2::new(m11, m12, m21, m22), area: -shapes.minus_area[lane] }
    }

    /// The rest shapes of the first and the second triangle of a fan.
    pub fn fan(&self, fan: usize) -> [Rest; 2] {
        [self.rest(fan, 0), self.rest(fan, 1)]
    }
}

/// Edge vectors of a fan, from the positions of its middle vertex and its other vertices.
#[inline(always)]
pub fn edge_vectors([middle, first, second, third]: [[f64; 2]; 4]) -> [[f64; 2]; 3] {
    let to = |end: [f64; 2]| [end[0] - middle[0], end[1] - middle[1]];
    [to(first), to(second), to(third)]
}

impl Matrices {
    #[inline(always)]
    fn load<S: Simd>(&self, set: S, part: usize) -> Mat2<Wide<S>> {
        load(set, &self.0, part)
    }

    #[inline(always)]
    fn store<S: Simd>(&mut self, matrix: Mat2<Wide<S>>, part: usize) {
        store(matrix, &mut self.0, part);
    }
}

/// Loads one SIMD register of each entry.
#[inline(always)]
pub(super) fn load<S: Simd>(set: S, [m11, m21, m12, m22]: &[Lanes; 4], part: usize) -> Mat2<Wide<S>> {
    Mat2::new(
        Wide::load(set, m11, part),
        Wide::load(set, m12, part),
        Wide::load(set, m21, part),
        Wide::load(set, m22, part),
    )
}

/// Stores one SIMD register of each entry.
#[inline(always)]
pub(super) fn store<S: Simd>(matrix: Mat2<Wide<S>>, [m11, m21, m12, m22]: &mut [Lanes; 4], part: usize) {
    matrix.m11.store(m11, part);
    matrix.m21.store(m21, part);
    matrix.m12.store(m12, part);
    matrix.m22.store(m22, part);
}

/// The matrices D of the first or the second triangles of part of a block.
#[inline(always)]
fn edges<S: Simd>(set: S, edge_vectors: &EdgeVectors, side: usize, part: usize) -> Mat2<Wide<S>> {
    let ([m11, m21], [m12, m22]) =
        (Wide::load_pairs(set, &edge_vectors[side], part), Wide::load_pairs(set, &edge_vectors[side + 1], part));
    Mat2::new(m11, m12, m21, m22)
}

/// F, or dF/dt, of the first and of the second triangles of part of a block: D D0⁻¹.
#[inline(always)]
fn gradients<S: Simd>(set: S, edge_vectors: &EdgeVectors, block: &Block, part: usize) -> Mat2<Interleaved<Wide<S>>> {
    let Block([first, second]) = block;
    let of_first = edges(set, edge_vectors, 0, part).times(first.inverse.load(set, part));
    let of_second = edges(set, edge_vectors, 1, part).times(second.inverse.load(set, part));
    Mat2::interleaved(of_first, of_second)
}

/// Edge vectors of a run of blocks.
#[derive(Debug, Default)]
#[repr(align(64))]
struct EdgeVectorBuffer([EdgeVectors; RUN_BLOCKS]);

/// Edge vectors and rates of the next run, gathered while the forces of the run before were computed; also across
/// stages, because no stage moves a vertex of a later one.
#[derive(Debug, Default)]
pub struct Collected {
    now: EdgeVectorBuffer,
    rates: EdgeVectorBuffer,
    /// Whether they were gathered.
    is_there: bool,
}

/// Stresses in the first and in the second triangles of two blocks: the present and the previous one, alternating.
#[derive(Default)]
#[repr(align(64))]
struct Stresses([[Matrices; 2]; 2]);

/// Computes the forces on all fans from [`StressModel`].
///
/// Roots, quotients and logarithms have a long latency, longer than the reordering window of the processor. So the
/// stresses of both triangles of a fan are computed [`Interleaved`], and the forces one block later.
pub struct Forces<'a, L, const N: usize> {
    pub model: L,
    pub corners: &'a Corners<4>,
    /// Number of the first run in `blocks`.
    pub first: usize,
    pub blocks: &'a [Block],
    pub x: &'a [f64],
    pub v: &'a [f64],
    /// Edge vectors of the first run, if gathered; on return those of the run after the last.
    pub collected: &'a mut Collected,
    /// Forces of each stress, run by run.
    pub out: [&'a mut [[CornerForces; RUN_BLOCKS]]; N],
}

impl<const N: usize, L: StressModel<N>> WithSimd for Forces<'_, L, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) {
        let Self { model, corners, first, blocks, x, v, collected, mut out } = self;
        let Collected { now, rates, is_there } = collected;
        let mut stresses: [Stresses; N] = array::from_fn(|_| Stresses::default());
        for (run, blocks) in (first..).zip(blocks.chunks(RUN_BLOCKS)) {
            let out = out.each_mut().map(|out| &mut out[run - first]);
            if !*is_there {
                corners.collect(run, x, edge_vectors, &mut now.0);
                if L::RATE {
                    corners.collect(run, v, edge_vectors, &mut rates.0);
                }
            }
            let of = |moving| corners.ahead(run + 1, moving);
            let ahead = of(x).zip(of(if L::RATE { v } else { x }));
            *is_there = ahead.is_some();
            for number in 0..=blocks.len() {
                if let Some(block) = blocks.get(number) {
                    let (now, rates) = (&mut now.0[number], &mut rates.0[number]);
                    for part in 0..Wide::<S>::PARTS {
                        let f = gradients(set, now, block, part);
                        let rate = if L::RATE { gradients(set, rates, block, part) } else { f };
                        let of_model = model.stresses(f, rate);
                        for stress in 0..N {
                            let [first, second] = of_model[stress].both();
                            let [to_first, to_second] = &mut stresses[stress].0[number % 2];
                            to_first.store(first, part);
                            to_second.store(second, part);
                        }
                    }
                    // Gathers use other execution units than stresses, so that both run in parallel.
                    if let Some((of_x, of_v)) = ahead {
                        of_x.collect(number, edge_vectors, now);
                        if L::RATE {
                            of_v.collect(number, edge_vectors, rates);
                        }
                    }
                }
                let Some(before) = number.checked_sub(1) else { continue };
                let Block([shapes, others]) = &blocks[before];
                for part in 0..Wide::<S>::PARTS {
                    for stress in 0..N {
                        let [one, other] = &stresses[stress].0[before % 2];
                        let [first, second] = edge_forces(set, shapes, one, part);
                        let [also, third] = edge_forces(set, others, other, part);
                        let second = [second[0] + also[0], second[1] + also[1]];
                        let middle = [-first[0] - second[0] - third[0], -first[1] - second[1] - third[1]];
                        for (out, [x, y]) in out[stress][before].iter_mut().zip([middle, first, second, third]) {
                            Wide::store_pairs(x, y, out, part);
                        }
                    }
                }
            }
        }
    }
}

/// Forces at the ends of two edge vectors, x and y, from the stresses in the triangles between: the columns of -A P
/// D0⁻ᵀ.
#[inline(always)]
fn edge_forces<S: Simd>(set: S, shapes: &Shapes, stresses: &Matrices, part: usize) -> [[Wide<S>; 2]; 2] {
    let (turned, minus_area) = (shapes.inverse.load(set, part).transpose(), Wide::load(set, &shapes.minus_area, part));
    let h = stresses.load(set, part).times(turned) * minus_area;
    [[h.m11, h.m21], [h.m12, h.m22]]
}

/// Sums the energy of all triangles \[J\], in the order of their fans.
pub struct Energy<'a, M> {
    pub material: &'a M,
    pub corners: &'a Corners<4>,
    pub blocks: &'a Blocks,
    pub x: &'a [f64],
}

impl<M: Material> WithSimd for Energy<'_, M> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) -> f64 {
        let mut now = EdgeVectorBuffer::default();
        let mut energies = [Lanes::default(); 2];
        let mut sum = 0.0;
        for (run, blocks) in self.blocks.all().chunks(RUN_BLOCKS).enumerate() {
            self.corners.collect(run, self.x, edge_vectors, &mut now.0);
            for (now, block) in now.0.iter().zip(blocks) {
                let Block(shapes) = block;
                for part in 0..Wide::<S>::PARTS {
                    let Interleaved(first, second) = self.material.psi(gradients(set, now, block, part));
                    for (psi, (shapes, energies)) in [first, second].into_iter().zip(shapes.iter().zip(&mut energies)) {
                        (psi * -Wide::load(set, &shapes.minus_area, part)).store(energies, part);
                    }
                }
                for lane in self.blocks.order.lane {
                    for (shapes, energies) in shapes.iter().zip(&energies) {
                        // A lane without area has no triangle, and may contain NaN.
                        if shapes.minus_area[lane] != 0.0 {
                            sum += energies[lane];
                        }
                    }
                }
            }
        }
        sum
    }
}

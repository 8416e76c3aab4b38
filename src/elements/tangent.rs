//! Tangent stiffness of triangles: as 2 x 2 blocks between their corners, and as a matrix-free product with a
//! displacement.

use super::{
    Adding, Triangles,
    blocks::{Elastic, EnergyLaw, StressLaw},
    six_nodes::ElementLaw,
    triangle::{Rest, edges},
};
use crate::{
    materials::{Material, Moduli, Parts},
    simd::{LANES, Lanes, Mat2, Order, Quads, Real, Wide},
    solvers::{Block as MatrixBlock, BlockMatrix, BlockRows, Weights},
};
use nalgebra::{Matrix2, Matrix4};
use pulp::{Simd, WithSimd};

/// Number of blocks of eight triangles gathered at a time: enough for scalar stores to complete before they are read as
/// SIMD vectors, and few enough to stay in the cache.
const RUN_BLOCKS: usize = 8;

/// The second derivative of an isotropic energy density.
pub trait Isotropic: Copy + Send + Sync {
    /// See [`Moduli`] \[Pa\].
    fn moduli<R: Real>(&self, parts: &Parts<R>) -> Moduli<R>;
}

impl<M: Material> Isotropic for Elastic<M> {
    #[inline(always)]
    fn moduli<R: Real>(&self, parts: &Parts<R>) -> Moduli<R> {
        self.0.moduli(parts)
    }
}

/// Minus the directional derivative of a stress by F, in the direction of `change`, which is passed as dF/dt.
#[derive(Clone, Copy)]
struct Change<L>(L);

impl<L: Isotropic> StressLaw for Change<L> {
    const RATE: bool = true;

    #[inline(always)]
    fn stress<R: Real>(&self, f: Mat2<R>, change: Mat2<R>) -> Mat2<R> {
        let parts = Parts::of(f);
        self.0.moduli(&parts).change(&parts, change) * -1.0
    }
}

impl Triangles {
    /// Adds the vertex pairs of each element to a sparsity pattern.
    pub(crate) fn add_sparsity(&self, add: &mut dyn FnMut(u32, u32)) {
        if let Some(six) = self.six_nodes() {
            return six.add_sparsity(add);
        }
        for &[a, b, c] in self.corners() {
            add(a, b);
            add(a, c);
            add(b, c);
        }
    }

    /// Adds d²E/dx² at x times a displacement d \[m\] to `product` \[N\], for the energy E of an isotropic density.
    pub(crate) fn add_energy_change(
        &self,
        [x, d]: [&[f64]; 2],
        scratch: &mut [f64],
        product: &mut [f64],
        density: impl EnergyLaw + Isotropic,
    ) {
        if let Some(six) = self.six_nodes() {
            return six.add_energy_change([x, d], product, ElementLaw::at_points(&density));
        }
        self.assemble(Change(density), &mut Adding { x, v: d, force: product }, scratch);
    }

    /// Adds blocks for every triangle from the second derivative of an isotropic energy density by F, projected as the
    /// tangent requires.
    pub(crate) fn add_energy_tangent(
        &self,
        x: &[f64],
        weights: Weights,
        matrix: &mut BlockMatrix<2>,
        density: impl EnergyLaw + Isotropic,
    ) {
        if let Some(six) = self.six_nodes() {
            return six.add_energy_tangent(x, weights, matrix, ElementLaw::at_points(&density));
        }
        let negative = weights.tangent.negative_factor();
        let (x, weight) = (x.as_chunks().0, weights.position);
        let set = self.set();
        matrix.add_by_rows(3 * self.corners().len(), self.vertices().clone(), |rows| {
            set.dispatch(Assemble { density, of: self, x, weight, negative, rows });
        });
    }

    /// Adds blocks for every triangle, taken as a linear one, from `tangent`, the derivative of its first Piola-Kirchhoff stress by F or dF/dt
    /// (4 x 4, entries column by column, symmetric) [Pa or Pa s], times `weight`. The pairs of the matrix are the first corner with the second and the
    /// third, and these two, triangle by triangle.
    #[inline]
    pub(crate) fn add_tangent(
        &self,
        x: &[f64],
        weight: f64,
        matrix: &mut BlockMatrix<2>,
        tangent: impl Fn(usize, &Matrix2<f64>) -> Matrix4<f64> + Sync,
    ) {
        matrix.add_by_rows(3 * self.corners().len(), self.vertices().clone(), |mut rows| {
            for (number, corners) in self.corners().iter().enumerate() {
                if rows.have_any(corners) {
                    let tangent = tangent(number, &self.gradient_of(x, number));
                    add_corner_blocks(&mut rows, number, *corners, self.rest(number).corner_blocks(&tangent, weight));
                }
            }
        });
    }
}

/// Adds the blocks of a triangle from those of its second corner with itself, of the third with itself, and of the second with the third.
/// The rows of the first corner are minus the sum of the other two, by translation invariance.
#[inline]
pub(super) fn add_corner_blocks<const D: usize>(
    rows: &mut BlockRows<'_, D>,
    number: usize,
    corners: [u32; 3],
    [one, two, across]: [MatrixBlock<D>; 3],
) {
    let (to_one, to_two) = (-one - across.transpose(), -across - two);
    for (corner, block) in corners.into_iter().zip([-to_one - to_two, one, two]) {
        rows.diagonal(corner, &block);
    }
    for (pair, block) in (3 * number..).zip([to_one, to_two, across]) {
        rows.off_diagonal(pair, &block);
    }
}

impl Rest {
    /// Blocks of the second corner with itself, of the third with itself, and of the second with the third:
    /// `K_ab[i, k] = weight A sum over J, L of g_a[J] C[iJ, kL] g_b[L]`, with `g_a` the gradient of a corner's shape
    /// function, a row of D0⁻¹ (Bonet and Wood, *Nonlinear Continuum Mechanics for Finite Element Analysis*, section 9.4).
    #[inline]
    pub(super) fn corner_blocks(&self, tangent: &Matrix4<f64>, weight: f64) -> [Matrix2<f64>; 3] {
        let scale = weight * self.area;
        let gradient = |corner: usize| [self.inverse[(corner, 0)], self.inverse[(corner, 1)]];
        let (g1, g2) = (gradient(0), gradient(1));
        let quarter = |row: usize, column: usize| tangent.fixed_view::<2, 2>(row, column).into_owned();
        let (c00, c01, c11) = (quarter(0, 0), quarter(0, 2), quarter(2, 2));
        let c10 = c01.transpose();
        let block = |a: [f64; 2], b: [f64; 2]| {
            (c00 * (a[0] * b[0]) + c01 * (a[0] * b[1]) + c10 * (a[1] * b[0]) + c11 * (a[1] * b[1])) * scale
        };
        [block(g1, g1), block(g2, g2), block(g1, g2)]
    }
}

/// Adds the blocks of the triangles that have vertices in some rows, eight at a time.
struct Assemble<'a, L> {
    density: L,
    of: &'a Triangles,
    x: &'a [[f64; 2]],
    weight: f64,
    /// Factor of negative eigenvalues.
    negative: Option<f64>,
    rows: BlockRows<'a, 2>,
}

impl<L: Isotropic> WithSimd for Assemble<'_, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) {
        let Self { density, of, x, weight, negative, mut rows } = self;
        let order = Order::new(of.set());
        let (mut now, mut rest) = ([Quads::default(); RUN_BLOCKS], [Quads::default(); RUN_BLOCKS]);
        let mut scales = [Lanes::default(); RUN_BLOCKS];
        let mut out = [[Quads::default(); 6]; RUN_BLOCKS];
        for (run, triangles) in of.corners().chunks(RUN_BLOCKS * LANES).enumerate() {
            if !rows.have_any(triangles.as_flattened()) {
                continue;
            }
            for (number, &triangle) in triangles.iter().enumerate() {
                let Rest { inverse, area } = of.rest(run * RUN_BLOCKS * LANES + number);
                let (block, lane) = (number / LANES, number % LANES);
                now[block][lane] = edges(x, triangle);
                rest[block][lane] = [inverse.m11, inverse.m21, inverse.m12, inverse.m22];
                scales[block][order.lane[lane]] = area * weight;
            }
            for (((now, rest), scale), out) in now.iter().zip(&rest).zip(&scales).zip(&mut out) {
                for part in 0..Wide::<S>::PARTS {
                    let [m11, m21, m12, m22] = Wide::load_quads(set, rest, part);
                    let inverse = Mat2::new(m11, m12, m21, m22);
                    let [m11, m21, m12, m22] = Wide::load_quads(set, now, part);
                    let parts = Parts::of(Mat2::new(m11, m12, m21, m22).times(inverse));
                    let moduli = density.moduli(&parts);
                    let moduli = if let Some(factor) = negative { moduli.with_negative_times(factor) } else { moduli };
                    let moduli = moduli.times(Wide::load(set, scale, part));
                    for (out, block) in out.iter_mut().zip(corner_blocks(&parts, &moduli, inverse)) {
                        Wide::store_quads(block, out, part);
                    }
                }
            }
            for (number, &triangle) in triangles.iter().enumerate() {
                let (block, quad) = (&out[number / LANES], order.quad[number % LANES]);
                let blocks = [0, 1, 2, 3, 4, 5].map(|entry| block[entry][quad]);
                rows.triangle(run * RUN_BLOCKS * LANES + number, triangle, &blocks);
            }
        }
    }
}

/// The gradient of a corner's shape function transformed by both parts of F, U and M, and multiplied by the moduli.
#[derive(Clone, Copy)]
pub(super) struct Corner<R> {
    turned: [R; 2],
    mirrored: [R; 2],
    by_turned: [R; 2],
    by_mirrored: [R; 2],
    twisted: [R; 2],
    flipped: [R; 2],
}

impl<R: Real> Corner<R> {
    #[inline(always)]
    pub fn new(parts: &Parts<R>, moduli: &Moduli<R>, [x, y]: [R; 2]) -> Self {
        let ([c, s], [d, t]) = (parts.turned, parts.mirrored);
        let (turned, mirrored) = ([c * x - s * y, s * x + c * y], [d * x + t * y, t * x - d * y]);
        let (([u0, u1], [m0, m1]), [pp, pq, qq]) = ((turned, mirrored), moduli.sizes);
        Self {
            turned,
            mirrored,
            by_turned: [u0 * pp + m0 * pq, u1 * pp + m1 * pq],
            by_mirrored: [u0 * pq + m0 * qq, u1 * pq + m1 * qq],
            twisted: [u0 * moduli.twist, u1 * moduli.twist],
            flipped: [m0 * moduli.flip, m1 * moduli.flip],
        }
    }

    /// An entry of the block of this corner with another.
    #[inline(always)]
    pub fn entry(&self, of: &Self, row: usize, column: usize) -> R {
        let along = self.by_turned[row] * of.turned[column] + self.by_mirrored[row] * of.mirrored[column];
        let across = self.twisted[1 - row] * of.turned[1 - column] + self.flipped[1 - row] * of.mirrored[1 - column];
        if row == column { along + across } else { along - across }
    }
}

/// Blocks of the three corners with themselves, then of the first with the second, the first with the third and the second with
/// the third, each column by column: the formula of [`Rest::corner_blocks`], with C taken apart into its eigenvectors.
#[inline(always)]
pub(super) fn corner_blocks<R: Real>(parts: &Parts<R>, moduli: &Moduli<R>, inverse: Mat2<R>) -> [[R; 4]; 6] {
    let one = Corner::new(parts, moduli, [inverse.m11, inverse.m12]);
    let two = Corner::new(parts, moduli, [inverse.m21, inverse.m22]);
    let (b11, b12, b22) = (one.entry(&one, 0, 0), one.entry(&one, 0, 1), one.entry(&one, 1, 1));
    let (c11, c12, c22) = (two.entry(&two, 0, 0), two.entry(&two, 0, 1), two.entry(&two, 1, 1));
    let (a11, a21) = (one.entry(&two, 0, 0), one.entry(&two, 1, 0));
    let (a12, a22) = (one.entry(&two, 0, 1), one.entry(&two, 1, 1));
    // The rows of the first corner are minus the sum of the other two, by translation invariance.
    let to_one = [-b11 - a11, -b12 - a12, -b12 - a21, -b22 - a22];
    let to_two = [-a11 - c11, -a21 - c12, -a12 - c12, -a22 - c22];
    let off = -to_one[2] - to_two[2];
    [
        [-to_one[0] - to_two[0], off, off, -to_one[3] - to_two[3]],
        [b11, b12, b12, b22],
        [c11, c12, c12, c22],
        to_one,
        to_two,
        [a11, a21, a12, a22],
    ]
}

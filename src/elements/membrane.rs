//! Linear triangles in space: membranes of any isotropic material.
//!
//! ```
//! use gingerbread::{
//!     elements::Membranes,
//!     materials::MaterialParameters,
//!     meshes::Mesh,
//!     scene::Scene,
//!     simulation::Simulation,
//! };
//! use std::sync::Arc;
//!
//! // A triangle, which hangs from two corners and stands out from the wall.
//! let mesh = Mesh::new(vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], vec![[0, 1, 2]])?;
//! let triangle = Membranes::new(0..3, &mesh, MaterialParameters::default().into(), 0.001);
//! let rest = vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
//! assert_eq!(triangle.elastic_energy(&rest), 0.0);
//! let mut scene = Scene::of_elements(3, rest, &triangle.lumped_mass(100.0), vec![Arc::new(triangle)])?;
//! scene.pin(&[0, 1]);
//! let start = scene.start.clone();
//! Simulation::new(scene, start).advance(10, &mut || true);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::{
    BodyMaterial, ElasticElements,
    blocks::{EnergyLaw, StressLaw},
    frame::{Columns, Frame, dot, minus, moved, plus, product, times},
    tangent::{Isotropic, add_corner_blocks, corner_blocks},
    triangle::Rest,
};
use crate::{
    effects::{Effect, Motion},
    materials::Parts,
    meshes::Mesh,
    simd::{LANES, Lanes, Mat2, Real, Wide},
    solvers::{Block as MatrixBlock, BlockMatrix, BlockRows, SparseMatrix, Weights},
};
use nalgebra::{Matrix2, Matrix3x2, Matrix4};
use pulp::{Arch, Simd, WithSimd};
use std::{array, ops::Range, sync::Arc};

/// The linear triangles of one membrane, of one material and thickness. The mesh at rest is flat, the triangles are in space.
///
/// With the edges D = [x1 - x0, x2 - x0] now (3 x 2) and D0 at rest (2 x 2), the deformation gradient is `F = D D0⁻¹` (3 x 2). Its
/// QR decomposition `F = Q G` has orthonormal columns Q (3 x 2) and an upper triangular G (2 x 2) with `det G >= 0`. An isotropic
/// energy density in the plane then is one of the membrane, `psi(F) = psi(G)`, because `FᵀF = GᵀG`, and
///
/// `P(F) = Q P(G)`, `dP = Q C(G)[Qᵀ dF] + n (nᵀ dF) S`,
///
/// with the unit normal n = q1 x q2 and the second Piola-Kirchhoff stress `S = G⁻¹ P(G)`, which is symmetric: it resists motion
/// along the normal where it pulls, and makes the membrane buckle where it presses. (The first term is that of the plane in the
/// frame Q. For `dF = n bᵀ` the product `FᵀF` does not change in the first order, and neither does S, so that `dP = dF S`; Bonet and Wood, *Nonlinear Continuum
/// Mechanics for Finite Element Analysis*, section 7.4.)
///
/// A triangle that is a line or a point has no normal: a fixed one is taken. Nothing can be inverted.
#[derive(Clone, Debug)]
pub struct Membranes {
    shape: Arc<Shape>,
    material: BodyMaterial,
    thickness: f64,
}

/// Everything but the material.
#[derive(Debug)]
struct Shape {
    vertices: Range<usize>,
    corners: Vec<[u32; 3]>,
    blocks: Vec<Block>,
    set: Arch,
}

/// Rest shapes of eight triangles, one in each lane; unused lanes have no volume.
#[derive(Clone, Debug, Default)]
#[repr(align(64))]
struct Block {
    /// D0⁻¹, column by column [1/m].
    inverse: [Lanes; 4],
    /// Area times thickness \[m³\].
    volume: Lanes,
}

/// The edge vectors of eight triangles, or their forces.
type Edges = [[Lanes; 3]; 2];

/// Number of blocks gathered at a time: enough for scalar stores to complete before they are read as SIMD vectors.
const RUN_BLOCKS: usize = 4;

/// The first Piola-Kirchhoff stress of a membrane (3 x 2) as a function of F and dF/dt.
trait MembraneLaw: Copy + Send + Sync {
    /// Whether it depends on dF/dt; if not, `rate` is undefined.
    const RATE: bool;

    /// P \[Pa\].
    fn stress<R: Real>(&self, f: Columns<R>, rate: Columns<R>) -> Columns<R>;
}

/// A stress in the plane of each triangle.
#[derive(Clone, Copy)]
struct InPlane<L>(L);

impl<L: StressLaw> MembraneLaw for InPlane<L> {
    const RATE: bool = L::RATE;

    #[inline(always)]
    fn stress<R: Real>(&self, f: Columns<R>, rate: Columns<R>) -> Columns<R> {
        let frame = Frame::of(f);
        let rate = if L::RATE { frame.along(rate) } else { frame.g };
        frame.in_space(self.0.stress(frame.g, rate))
    }
}

/// The mean stress of a step over a time \[s\]: that of [`Mean`](super::discrete_gradient::Mean), with F and H in space.
#[derive(Clone, Copy)]
struct Mean<L>(L, f64);

impl<L: EnergyLaw> MembraneLaw for Mean<L> {
    const RATE: bool = true;

    #[inline(always)]
    fn stress<R: Real>(&self, f: Columns<R>, rate: Columns<R>) -> Columns<R> {
        /// Square of D : D below which round-off of the energy may exceed the correction, which fades.
        const ROUND_OFF: f64 = 1e-20;
        let frame = Frame::of(f);
        let half = frame.along(rate) * (0.5 * self.1);
        let stress = self.0.stress(frame.g, half);
        let twice = frame.g.transpose().times(half) * 2.0;
        let change = twice + twice.transpose();
        let energy = |part: f64| self.0.energy(Frame::of(moved(f, rate, part * self.1)).g);
        let missing = energy(0.5) - energy(-0.5) - stress.dot(half) * 2.0;
        let square = change.norm_squared();
        let factor = missing * square * 2.0 / (square * square + ROUND_OFF);
        frame.in_space(stress + frame.g.times(change) * factor)
    }
}

/// Minus the directional derivative of a stress, in the direction that is passed as dF/dt.
#[derive(Clone, Copy)]
struct Change<L>(L);

impl<L: Isotropic + StressLaw> MembraneLaw for Change<L> {
    const RATE: bool = true;

    #[inline(always)]
    fn stress<R: Real>(&self, f: Columns<R>, change: Columns<R>) -> Columns<R> {
        let frame = Frame::of(f);
        let parts = Parts::of(frame.g);
        let in_plane = frame.in_space(self.0.moduli(&parts).change(&parts, frame.along(change)));
        let [s11, s12, s22] = frame.second_stress(self.0.stress(frame.g, frame.g));
        let normal = frame.normal();
        let (first, second) = (dot(normal, change[0]), dot(normal, change[1]));
        let out = [times(normal, first * s11 + second * s12), times(normal, first * s12 + second * s22)];
        let minus_one = normal[0].of(-1.0);
        [0, 1].map(|column| times(plus(in_plane[column], out[column]), minus_one))
    }
}

impl Membranes {
    /// The triangles of a flat mesh, whose vertices are these of the scene, of a thickness \[m\].
    pub fn new(vertices: Range<usize>, mesh: &Mesh, material: BodyMaterial, thickness: f64) -> Self {
        Self::in_set(vertices, mesh, material, thickness, Arch::new())
    }

    /// The same with another instruction set: the same bits in more time.
    pub fn in_set(vertices: Range<usize>, mesh: &Mesh, material: BodyMaterial, thickness: f64, set: Arch) -> Self {
        let first = vertices.start as u32;
        let pack = |triangles: &[[u32; 3]]| {
            let mut block = Block::default();
            for (lane, corners) in triangles.iter().enumerate() {
                let [a, b, c] = corners.map(|corner| mesh.points()[corner as usize]);
                let (one, two) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
                let twice = one[0] * two[1] - one[1] * two[0];
                for (to, entry) in block.inverse.iter_mut().zip([two[1], -one[1], -two[0], one[0]]) {
                    to[lane] = entry / twice;
                }
                block.volume[lane] = 0.5 * twice * thickness;
            }
            block
        };
        let blocks = mesh.triangles().chunks(LANES).map(pack).collect();
        let corners = mesh.triangles().iter().map(|corners| corners.map(|corner| corner + first)).collect();
        Self { shape: Arc::new(Shape { vertices, corners, blocks, set }), material, thickness }
    }

    /// The same triangles of another material. Shapes are shared.
    #[must_use]
    pub fn with_material(&self, material: BodyMaterial) -> Self {
        Self { shape: Arc::clone(&self.shape), material, thickness: self.thickness }
    }

    /// Scene numbers of the vertices.
    pub fn vertices(&self) -> &Range<usize> {
        &self.shape.vertices
    }

    /// Scene vertex numbers of each triangle's corners, counter-clockwise at rest.
    pub fn corners(&self) -> &[[u32; 3]] {
        &self.shape.corners
    }

    /// Thickness at rest \[m\].
    pub const fn thickness(&self) -> f64 {
        self.thickness
    }

    /// The material.
    pub const fn material(&self) -> &BodyMaterial {
        &self.material
    }

    /// Area of each triangle at rest \[m²\].
    pub fn rest_areas(&self) -> impl Iterator<Item = f64> {
        (0..self.shape.corners.len())
            .map(|number| self.shape.blocks[number / LANES].volume[number % LANES] / self.thickness)
    }

    /// G of each triangle (see [`Self`]): its deformation gradient in its own plane.
    pub fn gradients(&self, x: &[f64]) -> impl Iterator<Item = Matrix2<f64>> {
        let x = x.as_chunks().0;
        self.shape.corners.iter().enumerate().map(|(number, corners)| {
            let inverse = self.inverse(number);
            Frame::of(product(edges(x, *corners), inverse)).g.into()
        })
    }

    /// The first Piola-Kirchhoff stress of each triangle, P = Q P(G), column by column \[Pa\].
    pub fn stresses(&self, x: &[f64]) -> impl Iterator<Item = [[f64; 3]; 2]> {
        let x = x.as_chunks().0;
        self.shape.corners.iter().enumerate().map(|(number, corners)| {
            let frame = Frame::of(product(edges(x, *corners), self.inverse(number)));
            frame.in_space(Mat2::from(&self.material.at(&frame.g.into()).piola))
        })
    }

    /// D0⁻¹ of a triangle, column by column [1/m].
    fn inverse(&self, number: usize) -> [f64; 4] {
        self.shape.blocks[number / LANES].inverse.each_ref().map(|entry| entry[number % LANES])
    }

    /// Masses of the vertices \[kg\] of a density [kg/m³]: a third of each triangle at each corner.
    pub fn lumped_mass(&self, density: f64) -> Vec<f64> {
        let mut masses = vec![0.0; self.shape.vertices.len()];
        for (corners, area) in self.shape.corners.iter().zip(self.rest_areas()) {
            for corner in corners {
                masses[*corner as usize - self.shape.vertices.start] += density * self.thickness * area / 3.0;
            }
        }
        masses
    }

    /// Stored energy at these positions \[J\].
    pub fn elastic_energy(&self, x: &[f64]) -> f64 {
        self.material.passes().membrane_energy(self, x)
    }

    /// The same for a law of known type.
    pub(super) fn energy_of(&self, law: impl EnergyLaw, x: &[f64]) -> f64 {
        self.shape.set.dispatch(Energy { law, shape: &self.shape, x: x.as_chunks().0 })
    }

    /// Adds the forces of an energy density, or their means over a step.
    pub(super) fn add_force_of(&self, motion: Motion<'_>, force: &mut [f64], law: impl EnergyLaw) {
        if motion.elastic_span == 0.0 {
            self.assemble(InPlane(law), [motion.x, &[]], force);
        } else {
            self.assemble(Mean(law, motion.elastic_span), [motion.x, motion.v], force);
        }
    }

    /// Adds d²E/dx² at x times a displacement d \[m\] to `product` \[N\].
    pub(super) fn add_energy_change(&self, moving: [&[f64]; 2], product: &mut [f64], law: impl Isotropic + StressLaw) {
        self.assemble(Change(law), moving, product);
    }

    /// Adds the blocks of the stiffness, projected as the tangent requires.
    pub(super) fn add_energy_tangent(
        &self,
        x: &[f64],
        weights: Weights,
        matrix: &mut BlockMatrix<3>,
        law: impl Isotropic + StressLaw,
    ) {
        let negative = weights.tangent.negative_factor();
        let (shape, x, weight) = (&*self.shape, x.as_chunks().0, weights.position);
        matrix.add_by_rows(3 * shape.corners.len(), shape.vertices.clone(), |rows| {
            shape.set.dispatch(Assemble { law, shape, x, weight, negative, rows });
        });
    }

    /// Adds the forces of a viscous stress in the plane of each triangle.
    pub(crate) fn add_viscous_force(&self, moving: [&[f64]; 2], law: impl StressLaw, force: &mut [f64]) {
        self.assemble(InPlane(law), moving, force);
    }

    /// Adds blocks for every triangle from `tangent`, the derivative of its stress in the plane by G or dG/dt (4 x 4, entries column by column,
    /// symmetric) [Pa or Pa s].
    pub(crate) fn add_tangent(
        &self,
        x: &[f64],
        matrix: &mut BlockMatrix<3>,
        tangent: impl Fn(&Matrix2<f64>) -> Matrix4<f64> + Sync,
    ) {
        let (x, shape) = (x.as_chunks().0, &*self.shape);
        matrix.add_by_rows(3 * shape.corners.len(), shape.vertices.clone(), |mut rows| {
            for (number, corners) in shape.corners.iter().enumerate() {
                if !rows.have_any(corners) {
                    continue;
                }
                let (inverse, area) = (self.inverse(number), shape.blocks[number / LANES].volume[number % LANES]);
                let Frame { q: [q1, q2], g } = Frame::of(product(edges(x, *corners), inverse));
                let rest = Rest { inverse: Matrix2::from_column_slice(&inverse), area };
                let q = Matrix3x2::from_columns(&[q1.into(), q2.into()]);
                let blocks = rest.corner_blocks(&tangent(&g.into()), 1.0).map(|block| q * block * q.transpose());
                add_corner_blocks(&mut rows, number, *corners, blocks);
            }
        });
    }

    /// Adds the forces of a stress on the corners, `[f1 f2] = -V P D0⁻ᵀ`.
    fn assemble(&self, law: impl MembraneLaw, [x, v]: [&[f64]; 2], force: &mut [f64]) {
        let (x, v, force) = (x.as_chunks().0, v.as_chunks().0, force.as_chunks_mut().0);
        self.shape.set.dispatch(Forces { law, shape: &self.shape, x, v, force });
    }
}

/// Edge vectors of a triangle.
#[inline(always)]
fn edges(x: &[[f64; 3]], corners: [u32; 3]) -> Columns<f64> {
    let [a, b, c] = corners.map(|corner| x[corner as usize]);
    [minus(b, a), minus(c, a)]
}

/// Edge vectors of some triangles, block by block.
#[inline(always)]
fn collect(triangles: &[[u32; 3]], x: &[[f64; 3]], edges: &mut [Edges; RUN_BLOCKS]) {
    for (number, corners) in triangles.iter().enumerate() {
        let (block, lane) = (number / LANES, number % LANES);
        let [one, two] = self::edges(x, *corners);
        for axis in 0..3 {
            edges[block][0][axis][lane] = one[axis];
            edges[block][1][axis][lane] = two[axis];
        }
    }
}

#[inline(always)]
fn load<S: Simd>(set: S, edges: &Edges, part: usize) -> Columns<Wide<S>> {
    let [one, two] = edges;
    let of = |lanes: &[Lanes; 3]| {
        [Wide::load(set, &lanes[0], part), Wide::load(set, &lanes[1], part), Wide::load(set, &lanes[2], part)]
    };
    [of(one), of(two)]
}

#[inline(always)]
fn inverse<S: Simd>(set: S, block: &Block, part: usize) -> [Wide<S>; 4] {
    let [m11, m21, m12, m22] = &block.inverse;
    [Wide::load(set, m11, part), Wide::load(set, m21, part), Wide::load(set, m12, part), Wide::load(set, m22, part)]
}

/// Triangles of a run, with their blocks.
fn runs(shape: &Shape) -> impl Iterator<Item = (&[[u32; 3]], &[Block])> {
    shape.corners.chunks(RUN_BLOCKS * LANES).zip(shape.blocks.chunks(RUN_BLOCKS))
}

/// Adds the forces of all triangles.
struct Forces<'a, L> {
    law: L,
    shape: &'a Shape,
    x: &'a [[f64; 3]],
    v: &'a [[f64; 3]],
    force: &'a mut [[f64; 3]],
}

impl<L: MembraneLaw> WithSimd for Forces<'_, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) {
        let Self { law, shape, x, v, force } = self;
        let (mut now, mut rates) = ([Edges::default(); RUN_BLOCKS], [Edges::default(); RUN_BLOCKS]);
        for (triangles, blocks) in runs(shape) {
            collect(triangles, x, &mut now);
            if L::RATE {
                collect(triangles, v, &mut rates);
            }
            for ((now, rates), block) in now.iter_mut().zip(&rates).zip(blocks) {
                for part in 0..Wide::<S>::PARTS {
                    let rest = inverse(set, block, part);
                    let f = product(load(set, now, part), rest);
                    let rate = if L::RATE { product(load(set, rates, part), rest) } else { f };
                    let [m11, m21, m12, m22] = rest;
                    let stress = law.stress(f, rate);
                    let minus_volume = -Wide::load(set, &block.volume, part);
                    let [one, two] = product(stress, [m11, m12, m21, m22]);
                    for (to, column) in now.iter_mut().zip([one, two]) {
                        let [x, y, z] = times(column, minus_volume);
                        x.store(&mut to[0], part);
                        y.store(&mut to[1], part);
                        z.store(&mut to[2], part);
                    }
                }
            }
            for (number, corners) in triangles.iter().enumerate() {
                let (block, lane) = (&now[number / LANES], number % LANES);
                let [a, b, c] = corners.map(|corner| corner as usize);
                for axis in 0..3 {
                    let (one, two) = (block[0][axis][lane], block[1][axis][lane]);
                    force[a][axis] -= one + two;
                    force[b][axis] += one;
                    force[c][axis] += two;
                }
            }
        }
    }
}

/// Sums the energy of all triangles \[J\], in their order.
struct Energy<'a, L> {
    law: L,
    shape: &'a Shape,
    x: &'a [[f64; 3]],
}

impl<L: EnergyLaw> WithSimd for Energy<'_, L> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) -> f64 {
        let Self { law, shape, x } = self;
        let (mut now, mut energies, mut sum) = ([Edges::default(); RUN_BLOCKS], Lanes::default(), 0.0);
        for (triangles, blocks) in runs(shape) {
            collect(triangles, x, &mut now);
            for (number, (now, block)) in now.iter().zip(blocks).enumerate() {
                for part in 0..Wide::<S>::PARTS {
                    let f = product(load(set, now, part), inverse(set, block, part));
                    (law.energy(Frame::of(f).g) * Wide::load(set, &block.volume, part)).store(&mut energies, part);
                }
                let there = (triangles.len() - number * LANES).min(LANES);
                sum = energies[..there].iter().fold(sum, |sum, energy| sum + energy);
            }
        }
        sum
    }
}

/// Adds the blocks of the triangles that have vertices in some rows.
///
/// With the blocks K of the plane in the frame of the triangle ([`corner_blocks`]) and the gradient g of the shape function of each corner, the block
/// of two corners is `Q K Qᵀ + V (gᵀ S g') n nᵀ`.
struct Assemble<'a, L> {
    law: L,
    shape: &'a Shape,
    x: &'a [[f64; 3]],
    weight: f64,
    /// Factor of negative eigenvalues.
    negative: Option<f64>,
    rows: BlockRows<'a, 3>,
}

impl<L: Isotropic + StressLaw> WithSimd for Assemble<'_, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) {
        let Self { law, shape, x, weight, negative, mut rows } = self;
        let mut now = [Edges::default(); RUN_BLOCKS];
        let mut out = [[[[Lanes::default(); 3]; 3]; 6]; RUN_BLOCKS];
        for (run, (triangles, blocks)) in runs(shape).enumerate() {
            if !rows.have_any(triangles.as_flattened()) {
                continue;
            }
            collect(triangles, x, &mut now);
            for ((now, block), out) in now.iter().zip(blocks).zip(&mut out) {
                for part in 0..Wide::<S>::PARTS {
                    let rest = inverse(set, block, part);
                    let scale = Wide::load(set, &block.volume, part) * weight;
                    let all = corner_matrices(&law, product(load(set, now, part), rest), rest, (scale, negative));
                    for (out, matrix) in out.iter_mut().zip(all) {
                        for (out, row) in out.iter_mut().zip(matrix) {
                            for (out, entry) in out.iter_mut().zip(row) {
                                entry.store(out, part);
                            }
                        }
                    }
                }
            }
            for (number, corners) in triangles.iter().enumerate() {
                let (block, lane) = (&out[number / LANES], number % LANES);
                let of = |pair: usize| MatrixBlock::<3>::from_fn(|row, column| block[pair][row][column][lane]);
                let pairs = 3 * (run * RUN_BLOCKS * LANES + number);
                for (beside, corner) in corners.iter().enumerate() {
                    rows.diagonal(*corner, &of(beside));
                    rows.off_diagonal(pairs + beside, &of(3 + beside));
                }
            }
        }
    }
}

/// Blocks (3 x 3, row by row) of the three corners with themselves, then of the first with the second, the first with the third and the
/// second with the third.
#[inline(always)]
fn corner_matrices<R: Real>(
    law: &(impl Isotropic + StressLaw),
    f: Columns<R>,
    [m11, m21, m12, m22]: [R; 4],
    (scale, negative): (R, Option<f64>),
) -> [[[R; 3]; 3]; 6] {
    let frame = Frame::of(f);
    let parts = Parts::of(frame.g);
    let moduli = law.moduli(&parts);
    let moduli = if let Some(factor) = negative { moduli.with_negative_times(factor) } else { moduli };
    let in_plane = corner_blocks(&parts, &moduli.times(scale), Mat2::new(m11, m12, m21, m22));
    let stress = frame.second_stress(law.stress(frame.g, frame.g));
    let [s11, s12, s22] = if let Some(factor) = negative { with_negative_times(stress, factor) } else { stress };
    // Rows of D0⁻¹ are the gradients of the second and the third corner; that of the first is minus their sum.
    let across = |[a, b]: [R; 2], [c, d]: [R; 2]| (a * (s11 * c + s12 * d) + b * (s12 * c + s22 * d)) * scale;
    let (one, two) = ([m11, m12], [m21, m22]);
    let (bb, cc, bc) = (across(one, one), across(two, two), across(one, two));
    let (ab, ac) = (-bb - bc, -bc - cc);
    let along_normal = [-ab - ac, bb, cc, ab, ac, bc];
    let ([q1, q2], normal) = (frame.q, frame.normal());
    array::from_fn(|pair| {
        let [k11, k21, k12, k22] = in_plane[pair];
        array::from_fn(|row| {
            let (first, second) = (q1[row] * k11 + q2[row] * k21, q1[row] * k12 + q2[row] * k22);
            let third = normal[row] * along_normal[pair];
            array::from_fn(|column| first * q1[column] + second * q2[column] + third * normal[column])
        })
    })
}

/// A symmetric matrix (s11, s12, s22) with its negative eigenvalues times a factor.
#[inline(always)]
fn with_negative_times<R: Real>([a, b, c]: [R; 3], factor: f64) -> [R; 3] {
    let zero = a.of(0.0);
    let changed = |eigenvalue: R| eigenvalue.if_less(zero, eigenvalue * factor, eigenvalue);
    let (middle, half) = ((a + c) * 0.5, (a - c) * 0.5);
    let radius = (half * half + b * b).sqrt();
    let (least, greatest) = (changed(middle - radius), changed(middle + radius));
    let slope = zero.if_less(radius, (greatest - least) / zero.if_less(radius, radius * 2.0, a.of(1.0)), zero);
    let centre = (least + greatest) * 0.5;
    [centre + slope * half, slope * b, centre - slope * half]
}

impl ElasticElements for Membranes {
    fn vertices(&self) -> Range<usize> {
        self.shape.vertices.clone()
    }

    /// mu V, and (2 mu + lambda) V, for the volume V at rest.
    fn energy_scales(&self) -> [f64; 2] {
        let volume: f64 = self.rest_areas().sum::<f64>() * self.thickness;
        let lame = self.material.lame();
        [lame.mu * volume, (2.0 * lame.mu + lame.lambda) * volume]
    }
}

impl Effect for Membranes {
    fn name(&self) -> &'static str {
        "Elasticity"
    }

    fn dimension(&self) -> Option<usize> {
        Some(3)
    }

    fn elements(&self, _: Motion<'_>) -> usize {
        self.shape.corners.len()
    }

    fn energy(&self, motion: Motion<'_>) -> f64 {
        self.elastic_energy(motion.x)
    }

    fn force(&self, motion: Motion<'_>, _: &mut [f64], force: &mut [f64]) {
        self.material.passes().add_membrane_force(self, motion, force);
    }

    fn stiffness_times(&self, motion: Motion<'_>, d: &[f64], _: &mut [f64], product: &mut [f64]) {
        self.material.passes().membrane_stiffness_times(self, [motion.x, d], product);
    }

    fn sparsity_pattern(&self, add: &mut dyn FnMut(u32, u32)) {
        for &[a, b, c] in &self.shape.corners {
            add(a, b);
            add(a, c);
            add(b, c);
        }
    }

    fn add_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix) {
        if let Some(matrix) = matrix.blocks::<3>() {
            self.material.passes().add_membrane_stiffness(self, motion.x, weights, matrix);
        }
    }
}

//! Triangles of six nodes, each divided into four.

use super::{
    ElementKind, PointStress,
    blocks::{StressLaw, load, store},
    point_law::{AddGradients, Added, MeanChange, Measured, POINTS, PointLaw, PointMatrices, Stresses},
    tangent::Corner,
};
use crate::{
    effects::Motion,
    materials::{Parts, VolumeMeasure},
    meshes::Mesh,
    simd::{LANES, Lanes, Mat2, Wide},
    solvers::{Block as MatrixBlock, BlockMatrix, Weights},
};
use nalgebra::{Matrix2, Matrix4, Vector2};
use pulp::{Arch, Simd, WithSimd};
use std::{array, ops::Range};

/// Elements of six nodes: the corners of a triangle and the middles of its sides, in the order of [`Mesh::refined`].
///
/// With the edges D0 = [X1 - X0, X2 - X0] at rest and the derivatives c (2 numbers) of the shape function of each node by the two
/// coordinates along these edges, F at a point is `sum over nodes of x cᵀ D0⁻¹`. There are four points, one in each of the four triangles that the
/// element is divided into, at their centroids. The energy is a sum over the points with the shares w of the area A, and the force on a node
/// `-A sum over points of w P D0⁻ᵀ c`.
///
/// [`ElementKind::Quadratic`]: quadratic shape functions, and w = 1/3 at the three points beside the corners. That rule is exact for
/// polynomials of second degree, and with three strains at each of three points the element has no motion without energy but the three rigid ones (Zienkiewicz, Taylor and
/// Zhu, *The Finite Element Method: Its Basis and Fundamentals*, sections 4.7 and 5.11). The fourth point serves for what is drawn.
///
/// [`ElementKind::MeanDilatation`]: shape functions that are linear in each of the four triangles, w = 1/4, and
///
/// `E = A sum over points of w (psi(F) - U(m(F))) + A U(sum over points of w m(F))`
///
/// with the part `U(m)` of the energy that resists changes of volume ([`Material::volumetric`](crate::materials::Material::volumetric)): one condition on the volume for four triangles,
/// where linear triangles have one each and lock. This is the mean dilatation method (Simo, Taylor and Pister, *Variational and projection methods for
/// the volume constraint in finite deformation elasto-plasticity*, Computer Methods in Applied Mechanics and Engineering 51, 1985) on patches of
/// triangles (de Souza Neto, Pires and Owen, *F-bar-based linear triangles and tetrahedra for finite strain analysis of nearly incompressible
/// solids*, International Journal for Numerical Methods in Engineering 62, 2005). With a constant pressure in the element it is stable: the node in
/// the middle of a side sets the flux through that side alone (Boffi, Brezzi and Fortin, *Mixed Finite Element Methods and Applications*, Springer
/// 2013, chapter 8).
///
/// Masses and loads are those of the four triangles in both. Under distributed loads quadratic elements so have order 2, not 3.
#[derive(Clone, Debug)]
pub struct SixNodes {
    kind: ElementKind,
    vertices: Range<usize>,
    /// Scene numbers of the nodes.
    nodes: Vec<[u32; 6]>,
    blocks: Vec<Block>,
    set: Arch,
}

/// Rest shapes of eight elements, one in each lane; unused lanes have no area.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
struct Block {
    /// D0⁻¹, column by column [1/m].
    inverse: [Lanes; 4],
    /// Area \[m²\].
    area: Lanes,
}

/// Energy densities at the points of eight elements.
type Densities = [Lanes; POINTS];

/// Vectors at the nodes of eight elements.
type Nodes = [[Lanes; 2]; 6];

/// The derivatives of the shape functions of six nodes.
type Derivatives = [[f64; 2]; 6];

/// Linear shape functions in each of the four triangles.
const LINEAR: [Derivatives; POINTS] = [
    [[-2.0, -2.0], [0.0, 0.0], [0.0, 0.0], [2.0, 0.0], [0.0, 0.0], [0.0, 2.0]],
    [[0.0, 0.0], [2.0, 0.0], [0.0, 0.0], [-2.0, -2.0], [0.0, 2.0], [0.0, 0.0]],
    [[0.0, 0.0], [0.0, 0.0], [0.0, 2.0], [0.0, 0.0], [2.0, 0.0], [-2.0, -2.0]],
    [[0.0, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, -2.0], [2.0, 2.0], [-2.0, 0.0]],
];

/// Quadratic shape functions at the centroids of the four triangles.
const QUADRATIC: [Derivatives; POINTS] = [
    quadratic([4.0 / 6.0, 1.0 / 6.0, 1.0 / 6.0]),
    quadratic([1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0]),
    quadratic([1.0 / 6.0, 1.0 / 6.0, 4.0 / 6.0]),
    quadratic([1.0 / 3.0; 3]),
];

/// The derivatives of `L0 (2 L0 - 1)` and so on at the corners and `4 L0 L1`, `4 L1 L2` and `4 L2 L0` in the middles by L1 and L2, where
/// L0 is `1 - L1 - L2`.
const fn quadratic([l0, l1, l2]: [f64; 3]) -> Derivatives {
    [
        [1.0 - 4.0 * l0, 1.0 - 4.0 * l0],
        [4.0 * l1 - 1.0, 0.0],
        [0.0, 4.0 * l2 - 1.0],
        [4.0 * (l0 - l1), -4.0 * l1],
        [4.0 * l2, 4.0 * l1],
        [-4.0 * l2, 4.0 * (l0 - l2)],
    ]
}

/// A law at each point, whose part U is that of the mean of a measure, if there is one.
#[derive(Clone, Copy)]
pub struct ElementLaw<'a> {
    pub law: &'a dyn PointLaw,
    pub measure: Option<VolumeMeasure>,
}

impl<'a> ElementLaw<'a> {
    /// A law of each point alone.
    pub fn at_points(law: &'a dyn PointLaw) -> Self {
        Self { law, measure: None }
    }
}

impl SixNodes {
    /// The elements of a refined mesh, whose vertices are these of the scene, at rest positions of the whole scene, flat \[m\].
    pub fn new(kind: ElementKind, rest: &[f64], vertices: Range<usize>, mesh: &Mesh, set: Arch) -> Self {
        let first = vertices.start as u32;
        let of_four = |four: &[[u32; 3]; POINTS]| {
            let [[a, ab, ca], [_, b, bc], [_, _, c], _] = *four;
            [a, b, c, ab, bc, ca].map(|node| node + first)
        };
        let nodes: Vec<_> = mesh.triangles().as_chunks().0.iter().map(of_four).collect();
        let rest: &[[f64; 2]] = rest.as_chunks().0;
        let pack = |elements: &[[u32; 6]]| {
            let mut block = Block::default();
            for (lane, nodes) in elements.iter().enumerate() {
                let [a, b, c] = [nodes[0], nodes[1], nodes[2]].map(|node| rest[node as usize]);
                let (one, two) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
                let twice = one[0] * two[1] - one[1] * two[0];
                for (to, entry) in block.inverse.iter_mut().zip([two[1], -one[1], -two[0], one[0]]) {
                    to[lane] = entry / twice;
                }
                block.area[lane] = 0.5 * twice;
            }
            block
        };
        let blocks = nodes.chunks(LANES).map(pack).collect();
        Self { kind, vertices, nodes, blocks, set }
    }

    /// The same with another instruction set: the same bits in more time.
    #[must_use]
    pub fn in_set(&self, set: Arch) -> Self {
        Self { set, ..self.clone() }
    }

    /// Which they are.
    pub const fn kind(&self) -> ElementKind {
        self.kind
    }

    /// The law of a material, with its measure of volume, in these elements.
    pub fn elastic<'a>(&self, law: &'a dyn PointLaw, measure: Option<VolumeMeasure>) -> ElementLaw<'a> {
        ElementLaw { law, measure: measure.filter(|_| self.kind == ElementKind::MeanDilatation) }
    }

    /// The shares of the points in the area.
    pub const fn weights(&self) -> &'static [f64; POINTS] {
        match self.kind {
            ElementKind::Quadratic => &[1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0, 0.0],
            _ => &[0.25; POINTS],
        }
    }

    const fn derivatives(&self) -> &'static [Derivatives; POINTS] {
        match self.kind {
            ElementKind::Quadratic => &QUADRATIC,
            _ => &LINEAR,
        }
    }

    /// Number of elements.
    pub const fn count(&self) -> usize {
        self.nodes.len()
    }

    /// The points that have a share in the area.
    pub fn loaded_points(&self) -> impl Iterator<Item = usize> + use<> {
        let weights = self.weights();
        (0..POINTS).filter(|point| weights[*point] > 0.0)
    }

    /// The gradient of positions, displacements or velocities at a point of an element.
    pub fn gradient(&self, field: &[f64], element: usize, point: usize) -> Matrix2<f64> {
        let at = relative(field.as_chunks().0, self.nodes[element]);
        let mut edges = Matrix2::zeros();
        for (at, [along, across]) in at.map(Vector2::from).iter().zip(self.derivatives()[point]) {
            edges += Matrix2::from_columns(&[at * along, at * across]);
        }
        edges * self.inverse(element)
    }

    /// The same at each point.
    pub fn gradients(&self, field: &[f64], element: usize) -> [Matrix2<f64>; POINTS] {
        [0, 1, 2, 3].map(|point| self.gradient(field, element, point))
    }

    fn inverse(&self, element: usize) -> Matrix2<f64> {
        let block = &self.blocks[element / LANES];
        Matrix2::from_column_slice(&block.inverse.each_ref().map(|entry| entry[element % LANES]))
    }

    /// Area at rest \[m²\].
    fn area(&self, element: usize) -> f64 {
        self.blocks[element / LANES].area[element % LANES]
    }

    /// Stored energy at these positions \[J\].
    pub fn energy(&self, x: &[f64], law: ElementLaw<'_>) -> f64 {
        let (mut f, mut densities, mut sum) = (PointMatrices::default(), Densities::default(), 0.0);
        for (elements, block) in self.blocks() {
            self.collect(elements, block, x, &mut f);
            self.energies(law, &f, &mut densities);
            // Unused lanes may contain NaN, and so may points without a share.
            for (lane, area) in block.area.iter().enumerate().take(elements.len()) {
                sum += area
                    * self.loaded_points().map(|point| self.weights()[point] * densities[point][lane]).sum::<f64>();
            }
        }
        sum
    }

    /// Adds the forces of an energy, or their means over a step.
    pub fn add_force(&self, motion: Motion<'_>, force: &mut [f64], law: ElementLaw<'_>) {
        let span = motion.elastic_span;
        let mut rates = PointMatrices::default();
        self.assemble(motion.x, force, |elements, block, f, stresses| {
            self.stresses(law, f, stresses);
            if span != 0.0 {
                self.collect(elements, block, motion.v, &mut rates);
                self.make_conserving(law, span, [f, &rates], stresses);
            }
        });
    }

    /// Adds d²E/dx² at x times a displacement d \[m\] to `product` \[N\].
    pub fn add_energy_change(&self, [x, d]: [&[f64]; 2], product: &mut [f64], law: ElementLaw<'_>) {
        let mut changes = PointMatrices::default();
        self.assemble(x, product, |elements, block, f, stresses| {
            self.collect(elements, block, d, &mut changes);
            let moving = [f, &changes];
            let Some(measure) = law.measure else {
                law.law.changes(self.set, moving, None, stresses);
                return negate(stresses);
            };
            let parts = self.set.dispatch(Measured { measure, weights: self.weights(), f });
            let of = law.law.volumetric(self.set, &parts);
            let factors = [0, 1, 2, 3].map(|point| {
                let second = array::from_fn(|lane| of[POINTS][1][lane] - of[point][1][lane]);
                [second, of[point][2].map(|bend| -bend)]
            });
            law.law.changes(self.set, moving, Some(&Added { measure, factors }), stresses);
            let along = self.set.dispatch(MeanChange { measure, weights: self.weights(), moving });
            let factors = [array::from_fn(|lane| of[POINTS][2][lane] * along[lane]); POINTS];
            self.set.dispatch(AddGradients { measure, f, factors: &factors, out: stresses });
            negate(stresses);
        });
    }

    /// Adds the forces of a viscous stress `F (2 mu E' + lambda tr(E') I)`: for [`ElementKind::MeanDilatation`] with the mean of tr(E').
    pub fn add_viscous_force(&self, [x, v]: [&[f64]; 2], force: &mut [f64], law: impl StressLaw, lambda: f64) {
        let mut rates = PointMatrices::default();
        self.assemble(x, force, |elements, block, f, stresses| {
            self.collect(elements, block, v, &mut rates);
            self.set.dispatch(Stresses { law, f, rate: &rates, out: stresses });
            if self.kind == ElementKind::MeanDilatation {
                // tr(E') is F : dF/dt, half of the rate of the square.
                let traces = [0, 1, 2, 3].map(|point| {
                    array::from_fn(|lane| (0..4).map(|entry| f[point][entry][lane] * rates[point][entry][lane]).sum())
                });
                let mean: Lanes = array::from_fn(|lane| {
                    traces.iter().zip(self.weights()).map(|(trace, share): (&Lanes, _)| share * trace[lane]).sum()
                });
                let factors = traces.map(|trace| array::from_fn(|lane| 0.5 * lambda * (mean[lane] - trace[lane])));
                self.set.dispatch(AddGradients { measure: VolumeMeasure::Square, f, factors: &factors, out: stresses });
            }
        });
    }

    /// The stresses at the points.
    fn stresses(&self, law: ElementLaw<'_>, f: &PointMatrices, stresses: &mut PointMatrices) {
        law.law.stresses(self.set, f, stresses);
        if let Some(measure) = law.measure {
            let factors = self.excess(law, measure, f);
            self.set.dispatch(AddGradients { measure, f, factors: &factors, out: stresses });
        }
    }

    /// U' of the mean measure less that of the one at each point.
    fn excess(&self, law: ElementLaw<'_>, measure: VolumeMeasure, f: &PointMatrices) -> [Lanes; POINTS] {
        let of = law.law.volumetric(self.set, &self.set.dispatch(Measured { measure, weights: self.weights(), f }));
        [0, 1, 2, 3].map(|point| array::from_fn(|lane| of[POINTS][1][lane] - of[point][1][lane]))
    }

    /// The energy densities at the points.
    fn energies(&self, law: ElementLaw<'_>, f: &PointMatrices, densities: &mut Densities) {
        law.law.energies(self.set, f, densities);
        let Some(measure) = law.measure else { return };
        let of = law.law.volumetric(self.set, &self.set.dispatch(Measured { measure, weights: self.weights(), f }));
        for (density, own) in densities.iter_mut().zip(&of) {
            for (lane, density) in density.iter_mut().enumerate() {
                *density += of[POINTS][0][lane] - own[0][lane];
            }
        }
    }

    /// Makes the stresses in the middle of a step of a time \[s\] those of [`Mean`](super::discrete_gradient::Mean), with one factor b for the points
    /// of an element, so that their work together is the change of its energy.
    fn make_conserving(
        &self,
        law: ElementLaw<'_>,
        span: f64,
        [f, rates]: [&PointMatrices; 2],
        stresses: &mut PointMatrices,
    ) {
        /// Square of D : D below which round-off of the energy may exceed the correction, which fades.
        const ROUND_OFF: f64 = 1e-20;
        let moved = |by: f64| {
            let entry =
                |point: usize, entry: usize, lane: usize| f[point][entry][lane] + by * span * rates[point][entry][lane];
            array::from_fn(|point| array::from_fn(|number| array::from_fn(|lane| entry(point, number, lane))))
        };
        let (mut before, mut after) = (Densities::default(), Densities::default());
        self.energies(law, &moved(-0.5), &mut before);
        self.energies(law, &moved(0.5), &mut after);
        let at = |of: &PointMatrices, point: usize, lane: usize| {
            let [m11, m21, m12, m22] = of[point].each_ref().map(|entry| entry[lane]);
            Mat2::new(m11, m12, m21, m22)
        };
        for lane in 0..LANES {
            let (mut missing, mut square) = (0.0, 0.0);
            let mut changes = [Mat2::new(0.0, 0.0, 0.0, 0.0); POINTS];
            for point in self.loaded_points() {
                let (f, rate, share) = (at(f, point, lane), at(rates, point, lane), self.weights()[point]);
                let twice = f.transpose().times(rate) * span;
                changes[point] = twice + twice.transpose();
                let work = at(stresses, point, lane).dot(rate) * span;
                missing += share * (after[point][lane] - before[point][lane] - work);
                square += share * changes[point].norm_squared();
            }
            let factor = missing * square * 2.0 / (square * square + ROUND_OFF);
            for point in self.loaded_points() {
                let Mat2 { m11, m12, m21, m22 } = at(f, point, lane).times(changes[point]) * factor;
                for (entry, added) in stresses[point].iter_mut().zip([m11, m21, m12, m22]) {
                    entry[lane] += added;
                }
            }
        }
    }

    /// F, energy density and stress at each point of an element, at these positions \[m\].
    pub fn points(
        &self,
        x: &[f64],
        element: usize,
        law: ElementLaw<'_>,
        is_plane_stress: bool,
    ) -> [(Matrix2<f64>, PointStress); POINTS] {
        let gradients = self.gradients(x, element);
        let f: PointMatrices =
            array::from_fn(|point| array::from_fn(|entry| [gradients[point].as_slice()[entry]; LANES]));
        let (mut densities, mut stresses) = (Densities::default(), PointMatrices::default());
        self.energies(law, &f, &mut densities);
        self.stresses(law, &f, &mut stresses);
        let excess = law.measure.map(|measure| (measure, self.excess(law, measure, &f)));
        array::from_fn(|point| {
            let own = gradients[point];
            let more =
                excess.as_ref().map_or(0.0, |(measure, of)| of[point][0] * measure.by_thickness(Mat2::from(&own)));
            let thickness = if is_plane_stress { 0.0 } else { law.law.thickness_stress(Mat2::from(&own)) + more };
            let piola = Matrix2::from_column_slice(&stresses[point].each_ref().map(|entry| entry[0]));
            (own, PointStress::new(&own, densities[point][0], piola, thickness))
        })
    }

    /// The nodes of eight elements at a time, with their blocks.
    fn blocks(&self) -> impl Iterator<Item = (&[[u32; 6]], &Block)> {
        self.nodes.chunks(LANES).zip(&self.blocks)
    }

    /// The gradients of positions or velocities at the points of up to eight elements.
    fn collect(&self, elements: &[[u32; 6]], block: &Block, field: &[f64], out: &mut PointMatrices) {
        let mut nodes = Nodes::default();
        for (lane, of) in elements.iter().enumerate() {
            for (node, [x, y]) in relative(field.as_chunks().0, *of).into_iter().enumerate() {
                nodes[node][0][lane] = x;
                nodes[node][1][lane] = y;
            }
        }
        self.set.dispatch(Gradients { derivatives: self.derivatives(), inverse: &block.inverse, nodes: &nodes, out });
    }

    /// Adds the forces on the nodes of stresses that are computed from F at the points, block by block.
    fn assemble(
        &self,
        x: &[f64],
        force: &mut [f64],
        mut stresses_of: impl FnMut(&[[u32; 6]], &Block, &PointMatrices, &mut PointMatrices),
    ) {
        let force: &mut [[f64; 2]] = force.as_chunks_mut().0;
        let (mut f, mut stresses, mut on_nodes) =
            (PointMatrices::default(), PointMatrices::default(), Nodes::default());
        for (elements, block) in self.blocks() {
            self.collect(elements, block, x, &mut f);
            stresses_of(elements, block, &f, &mut stresses);
            self.set.dispatch(NodeForces { of: self, block, stresses: &stresses, out: &mut on_nodes });
            for (lane, nodes) in elements.iter().enumerate() {
                // By translation invariance the force on the first node is minus the sum of the others.
                let mut sum = [0.0; 2];
                for node in 1..6 {
                    let on = &mut force[nodes[node] as usize];
                    for axis in 0..2 {
                        on[axis] += on_nodes[node][axis][lane];
                        sum[axis] += on_nodes[node][axis][lane];
                    }
                }
                let on = &mut force[nodes[0] as usize];
                *on = [on[0] - sum[0], on[1] - sum[1]];
            }
        }
    }

    /// Calls `add` for the pairs of nodes of each element.
    pub fn add_sparsity(&self, add: &mut dyn FnMut(u32, u32)) {
        for nodes in &self.nodes {
            for (one, other) in pairs() {
                add(nodes[one], nodes[other]);
            }
        }
    }

    /// Adds the blocks of the second derivative of an energy, projected as the tangent requires.
    pub fn add_energy_tangent(&self, x: &[f64], weights: Weights, matrix: &mut BlockMatrix<2>, law: ElementLaw<'_>) {
        let negative = weights.tangent.negative_factor();
        self.add_blocks(matrix, |element, blocks| {
            let f = self.gradients(x, element).map(|f| Mat2::from(&f));
            let parts = f.map(Parts::of);
            let mut moduli = f.map(|f| law.law.moduli(f));
            let gradients = self.shape_gradients(element);
            if let Some(measure) = law.measure {
                let each = f.map(|f| measure.of(f));
                let mean = each.iter().zip(self.weights()).map(|(measure, share)| share * measure).sum();
                let [a, b, c, d] = each;
                let of = law.law.volumetric(Arch::Scalar, &[a, b, c, d, mean].map(|measure| [measure; LANES]));
                let [_, slope, bend] = of[POINTS].map(|lanes| lanes[0]);
                for (point, moduli) in moduli.iter_mut().enumerate() {
                    let [_, own_slope, own_bend] = of[point].map(|lanes| lanes[0]);
                    *moduli = moduli.plus(measure.moduli(&parts[point], [slope - own_slope, -own_bend]));
                }
                let bend = if bend < 0.0 { bend * negative.unwrap_or(1.0) } else { bend };
                let scale = bend * self.area(element) * weights.position;
                let by_f = f.map(|f| measure.gradient(f).into());
                blocks.add_square(scale, self.weights(), &gradients, &by_f);
            }
            for point in self.loaded_points() {
                let moduli = negative.map_or(moduli[point], |factor| moduli[point].with_negative_times(factor));
                let moduli = moduli.times(self.weights()[point] * self.area(element) * weights.position);
                let corners = gradients[point].map(|gradient| Corner::new(&parts[point], &moduli, gradient));
                blocks.add(&gradients[point], |one, other| {
                    let entry = |row, column| corners[one].entry(&corners[other], row, column);
                    Matrix2::new(entry(0, 0), entry(0, 1), entry(1, 0), entry(1, 1))
                });
            }
        });
    }

    /// Adds blocks from `tangent`, the derivative of the stress at a point by F or dF/dt from both (4 x 4, entries column by column, symmetric) [Pa or
    /// Pa s], and from the square of the mean of `F : dF/dt` times a modulus.
    pub fn add_tangent(
        &self,
        [x, v]: [&[f64]; 2],
        matrix: &mut BlockMatrix<2>,
        tangent: impl Fn(&Matrix2<f64>, &Matrix2<f64>) -> Matrix4<f64> + Sync,
        modulus: f64,
    ) {
        self.add_blocks(matrix, |element, blocks| {
            let (f, rates) = (self.gradients(x, element), self.gradients(v, element));
            let gradients = self.shape_gradients(element);
            for point in self.loaded_points() {
                let share = self.weights()[point];
                let tangent = tangent(&f[point], &rates[point]) * (share * self.area(element));
                let quarter = |row: usize, column: usize| tangent.fixed_view::<2, 2>(row, column).into_owned();
                let (c00, c01, c11) = (quarter(0, 0), quarter(0, 2), quarter(2, 2));
                let c10 = c01.transpose();
                blocks.add(&gradients[point], |one, other| {
                    let (a, b) = (gradients[point][one], gradients[point][other]);
                    c00 * (a[0] * b[0]) + c01 * (a[0] * b[1]) + c10 * (a[1] * b[0]) + c11 * (a[1] * b[1])
                });
            }
            if modulus != 0.0 {
                blocks.add_square(modulus * self.area(element), self.weights(), &gradients, &f);
            }
        });
    }

    /// The gradients of the shape functions at each point by the coordinates at rest [1/m]: `D0⁻ᵀ c`.
    fn shape_gradients(&self, element: usize) -> [Derivatives; POINTS] {
        let inverse = self.inverse(element);
        self.derivatives().map(|derivatives| {
            derivatives.map(|[along, across]| {
                [along * inverse.m11 + across * inverse.m21, along * inverse.m12 + across * inverse.m22]
            })
        })
    }

    /// Adds the blocks of all elements that have nodes in some rows.
    fn add_blocks(&self, matrix: &mut BlockMatrix<2>, of: impl Fn(usize, &mut ElementBlocks) + Sync) {
        matrix.add_by_rows(PAIRS * self.nodes.len(), self.vertices.clone(), |mut rows| {
            for (element, nodes) in self.nodes.iter().enumerate() {
                if !rows.have_any(nodes) {
                    continue;
                }
                let mut blocks = ElementBlocks::default();
                of(element, &mut blocks);
                for (node, block) in nodes.iter().zip(&blocks.own) {
                    rows.diagonal(*node, block);
                }
                for (pair, block) in (PAIRS * element..).zip(&blocks.between) {
                    rows.off_diagonal(pair, block);
                }
            }
        });
    }
}

/// Number of pairs of nodes of an element.
const PAIRS: usize = 15;

/// The pairs of nodes of an element.
fn pairs() -> impl Iterator<Item = (usize, usize)> {
    (0..6).flat_map(|one| (one + 1..6).map(move |other| (one, other)))
}

/// Blocks of the nodes of an element with themselves, and of its pairs.
#[derive(Default)]
struct ElementBlocks {
    own: [MatrixBlock<2>; 6],
    between: [MatrixBlock<2>; PAIRS],
}

impl ElementBlocks {
    /// Adds a block for each two nodes whose shape functions have a gradient.
    fn add(&mut self, gradients: &Derivatives, block: impl Fn(usize, usize) -> MatrixBlock<2>) {
        let moves = |node: usize| gradients[node] != [0.0; 2];
        for node in (0..6).filter(|node| moves(*node)) {
            self.own[node] += block(node, node);
        }
        for (number, (one, other)) in pairs().enumerate().filter(|(_, (one, other))| moves(*one) && moves(*other)) {
            self.between[number] += block(one, other);
        }
    }

    /// Adds the square of the derivative of a weighted sum by the nodes, from its derivatives by F at the points.
    fn add_square(
        &mut self,
        scale: f64,
        weights: &[f64; POINTS],
        gradients: &[Derivatives; POINTS],
        by_f: &[Matrix2<f64>; POINTS],
    ) {
        let mut along = [Vector2::zeros(); 6];
        for ((share, gradients), by_f) in weights.iter().zip(gradients).zip(by_f) {
            for (along, gradient) in along.iter_mut().zip(gradients) {
                *along += by_f * Vector2::from(*gradient) * *share;
            }
        }
        for (own, along) in self.own.iter_mut().zip(&along) {
            *own += along * along.transpose() * scale;
        }
        for (between, (one, other)) in self.between.iter_mut().zip(pairs()) {
            *between += along[one] * along[other].transpose() * scale;
        }
    }
}

/// Vectors at the nodes of an element, less that at the first, which cancels no digits later.
#[inline(always)]
fn relative(field: &[[f64; 2]], nodes: [u32; 6]) -> [[f64; 2]; 6] {
    let first = field[nodes[0] as usize];
    let mut all = [[0.0; 2]; 6];
    for node in 1..6 {
        let at = field[nodes[node] as usize];
        all[node] = [at[0] - first[0], at[1] - first[1]];
    }
    all
}

/// Changes the sign of all.
fn negate(all: &mut PointMatrices) {
    all.as_flattened_mut().as_flattened_mut().iter_mut().for_each(|value| *value = -*value);
}

/// F at each point, from the nodes and D0⁻¹.
struct Gradients<'a> {
    derivatives: &'a [Derivatives; POINTS],
    inverse: &'a [Lanes; 4],
    nodes: &'a Nodes,
    out: &'a mut PointMatrices,
}

impl WithSimd for Gradients<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) {
        let zero = Wide::all(set, 0.0);
        for part in 0..Wide::<S>::PARTS {
            let inverse = load(set, self.inverse, part);
            for (derivatives, out) in self.derivatives.iter().zip(&mut *self.out) {
                let mut edges = Mat2::new(zero, zero, zero, zero);
                // The first node is the origin.
                for (node, [along, across]) in self.nodes.iter().zip(derivatives).skip(1) {
                    let (x, y) = (Wide::load(set, &node[0], part), Wide::load(set, &node[1], part));
                    edges = edges + Mat2::new(x * *along, x * *across, y * *along, y * *across);
                }
                store(edges.times(inverse), out, part);
            }
        }
    }
}

/// The forces of stresses on the nodes, but for the first.
struct NodeForces<'a> {
    of: &'a SixNodes,
    block: &'a Block,
    stresses: &'a PointMatrices,
    out: &'a mut Nodes,
}

impl WithSimd for NodeForces<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) {
        let Self { of, block, stresses, out } = self;
        for part in 0..Wide::<S>::PARTS {
            let turned = load(set, &block.inverse, part).transpose();
            let minus_area = -Wide::load(set, &block.area, part);
            let mut forces = [[Wide::all(set, 0.0); 2]; 6];
            for ((stress, share), derivatives) in stresses.iter().zip(of.weights()).zip(of.derivatives()) {
                if *share == 0.0 {
                    continue;
                }
                let h = load(set, stress, part).times(turned) * (minus_area * *share);
                for (force, [along, across]) in forces.iter_mut().zip(derivatives).skip(1) {
                    force[0] = force[0] + h.m11 * *along + h.m12 * *across;
                    force[1] = force[1] + h.m21 * *along + h.m22 * *across;
                }
            }
            for (to, [x, y]) in out.iter_mut().zip(forces) {
                x.store(&mut to[0], part);
                y.store(&mut to[1], part);
            }
        }
    }
}

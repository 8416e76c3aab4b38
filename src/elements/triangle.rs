//! Linear triangle elements.

use super::{
    Accumulator, Adding, ElasticElements, ElementKind, EulerUpdate, SixNodes,
    blocks::{self, Blocks, Elastic, StressModel},
    material::BodyMaterial,
    partitions::Partitions,
    point_law::POINTS,
};
use crate::{
    effects::{Effect, Motion, Viscous},
    materials::{Material, VolumeMeasure},
    meshes::{Fan, Mesh},
    simd::Order,
    solvers::{SparseMatrix, Weights},
};
use nalgebra::Matrix2;
use pulp::Arch;
use std::{ops::Range, sync::Arc};

/// The triangles of one body, of one material and unit thickness: linear ones, or those that [elements of six nodes](SixNodes) are divided
/// into. What follows is for linear ones.
///
/// With the edges D = [x1 - x0, x2 - x0] now and D0 at rest, the deformation gradient is `F = D D0⁻¹`, constant over a
/// triangle. The forces on its corners are `[f1 f2] = -A P(F) D0⁻ᵀ` and `f0 = -f1 - f2`
/// (Sifakis and Barbic, *FEM Simulation of 3D Deformable Solids*, SIGGRAPH 2012 course, section 4.2).
///
/// Forces are computed for two triangles that share an edge at a time ([`Fan`]), so that their four vertices are read
/// and written once.
#[derive(Clone, Debug)]
pub struct Triangles {
    shape: Arc<Shape>,
    six_nodes: Option<Arc<SixNodes>>,
    material: BodyMaterial,
}

/// Everything but the material.
#[derive(Debug)]
struct Shape {
    vertices: Range<usize>,
    /// The corner in the middle of its fan comes first.
    corners: Vec<[u32; 3]>,
    /// Slot of each triangle: twice the number of its fan, plus one for the second triangle.
    slots: Vec<u32>,
    /// The rest shapes of the fans.
    blocks: Blocks,
    partitions: Partitions,
}

/// The rest shape of a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rest {
    /// D0⁻¹ [1/m].
    pub inverse: Matrix2<f64>,
    /// Area \[m²\], which is the volume of unit thickness.
    pub area: f64,
}

impl Rest {
    /// The same with swapped edges and zero area: it adds nothing.
    fn once_more(&self) -> Self {
        let mut inverse = self.inverse;
        inverse.swap_rows(0, 1);
        Self { inverse, area: 0.0 }
    }
}

impl Triangles {
    /// The elements of a body, whose vertices are these of the scene, with the triangles of a mesh.
    ///
    /// `rest` is flat, two numbers for each vertex of the whole scene \[m\].
    pub fn new(rest: &[f64], vertices: Range<usize>, mesh: &Mesh, material: BodyMaterial) -> Self {
        let first = vertices.start as u32;
        let mut corners: Vec<_> = mesh.triangles().iter().map(|corners| corners.map(|corner| corner + first)).collect();
        let mut slots = vec![0; corners.len()];
        let shape = |corners: [u32; 3]| {
            let edges = edge_matrix(rest, corners);
            let area = 0.5 * edges.determinant();
            Rest { inverse: Matrix2::new(edges.m22, -edges.m12, -edges.m21, edges.m11) / (2.0 * area), area }
        };
        let pack = |(number, fan): (usize, &Fan)| {
            let [middle, from, across, to] = fan.corners(&corners);
            let both = [[middle, from, across], [middle, across, to]];
            for (side, triangle) in fan.triangles().enumerate() {
                corners[triangle as usize] = both[side];
                slots[triangle as usize] = 2 * number as u32 + side as u32;
            }
            let one = shape(both[0]);
            let other = if fan.triangles().count() == 2 { shape(both[1]) } else { one.once_more() };
            ([middle, from, across, to], [one, other])
        };
        let fans = mesh.fans().iter().enumerate().map(pack).unzip();
        Self::of_fans(fans, vertices, (corners, slots), material, Arch::new())
    }

    /// From the vertices and rest shapes of the fans, and the corners of the triangles and where these are in fans.
    fn of_fans(
        (fans, shapes): (Vec<[u32; 4]>, Vec<[Rest; 2]>),
        vertices: Range<usize>,
        (corners, slots): (Vec<[u32; 3]>, Vec<u32>),
        material: BodyMaterial,
        set: Arch,
    ) -> Self {
        let fans: Vec<_> = fans.iter().map(|fan| fan.map(|corner| corner - vertices.start as u32)).collect();
        let partitions = Partitions::new(&fans, (vertices.start, vertices.len()), &Order::of_pairs(set));
        let shape = Shape { corners, slots, blocks: Blocks::new(&shapes, set), partitions, vertices };
        Self { shape: Arc::new(shape), six_nodes: None, material }
    }

    /// The same triangles as parts of elements of this kind; those of six nodes are those of a [refined mesh](Mesh::refined), which it is
    /// then. `rest` is that of [`Self::new`].
    #[must_use]
    pub fn of_kind(self, kind: ElementKind, rest: &[f64], mesh: &Mesh) -> Self {
        let six = || Arc::new(SixNodes::new(kind, rest, self.shape.vertices.clone(), mesh, self.set()));
        Self { six_nodes: kind.has_six_nodes().then(six), ..self }
    }

    /// Their elements of six nodes, unless they are linear.
    pub(crate) fn six_nodes(&self) -> Option<&SixNodes> {
        self.six_nodes.as_deref()
    }

    /// The kind of the elements.
    pub fn kind(&self) -> ElementKind {
        self.six_nodes().map_or(ElementKind::Linear, SixNodes::kind)
    }

    /// The vertices of each fan, as [`Fan::corners`] has them.
    fn fans(&self) -> Vec<[u32; 4]> {
        let mut fans = vec![[0; 4]; self.shape.blocks.fans()];
        let of_side =
            |side| self.shape.slots.iter().zip(&self.shape.corners).filter(move |(slot, _)| **slot % 2 == side);
        for (slot, &[middle, from, across]) in of_side(0) {
            fans[*slot as usize / 2] = [middle, from, across, from];
        }
        for (slot, &[.., to]) in of_side(1) {
            fans[*slot as usize / 2][3] = to;
        }
        fans
    }

    /// The same with another instruction set: the same bits in more time.
    #[must_use]
    pub fn in_set(&self, set: Arch) -> Self {
        let fans = self.fans();
        let shapes = (0..fans.len()).map(|fan| self.shape.blocks.fan(fan)).collect();
        let of = (self.shape.corners.clone(), self.shape.slots.clone());
        let six_nodes = self.six_nodes().map(|six| Arc::new(six.in_set(set)));
        let same = Self::of_fans((fans, shapes), self.shape.vertices.clone(), of, self.material.clone(), set);
        Self { six_nodes, ..same }
    }

    /// The triangles without those of fans all of whose vertices, by their numbers in the scene, do not move; `None` for elements of six nodes, and where
    /// all are left.
    pub fn restricted_to(&self, moves: &dyn Fn(usize) -> bool) -> Option<Self> {
        if self.six_nodes.is_some() {
            return None;
        }
        let fans = self.fans();
        let mut kept: Vec<_> =
            (0..fans.len()).filter(|fan| fans[*fan].iter().any(|vertex| moves(*vertex as usize))).collect();
        if kept.len() == fans.len() {
            return None;
        }
        if kept.is_empty() {
            kept.push(0);
        }
        let shapes = kept.iter().map(|fan| self.shape.blocks.fan(*fan)).collect();
        let of_kept = self.shape.corners.iter().zip(&self.shape.slots).filter_map(|(corners, slot)| {
            let fan = kept.binary_search(&(*slot as usize / 2)).ok()?;
            Some((*corners, 2 * fan as u32 + slot % 2))
        });
        let left = (kept.iter().map(|fan| fans[*fan]).collect(), shapes);
        Some(Self::of_fans(left, self.shape.vertices.clone(), of_kept.unzip(), self.material.clone(), self.set()))
    }

    /// The same triangles of another material. Shapes are shared.
    #[must_use]
    pub fn with_material(&self, material: BodyMaterial) -> Self {
        Self { shape: Arc::clone(&self.shape), six_nodes: self.six_nodes.clone(), material }
    }

    /// The instruction set that forces, energies and stiffness are computed with.
    pub(super) fn set(&self) -> Arch {
        self.shape.blocks.set()
    }

    /// Scene numbers of the body's vertices.
    pub fn vertices(&self) -> &Range<usize> {
        &self.shape.vertices
    }

    /// Scene vertex numbers of each triangle's corners, counter-clockwise at rest.
    pub fn corners(&self) -> &[[u32; 3]] {
        &self.shape.corners
    }

    /// The material.
    pub const fn material(&self) -> &BodyMaterial {
        &self.material
    }

    /// Slot of a triangle among those of all fans, two each.
    #[inline]
    pub(super) fn slot(&self, triangle: usize) -> usize {
        self.shape.slots[triangle] as usize
    }

    /// Number of slots, including empty ones of fans with one triangle.
    pub(super) fn slots(&self) -> usize {
        2 * self.shape.blocks.fans()
    }

    /// The rest shape of a triangle.
    #[inline]
    pub(super) fn rest(&self, triangle: usize) -> Rest {
        let slot = self.slot(triangle);
        self.shape.blocks.rest(slot / 2, slot % 2)
    }

    /// Area of each triangle at rest \[m²\].
    pub fn rest_areas(&self) -> impl Iterator<Item = f64> {
        (0..self.shape.corners.len()).map(|triangle| self.rest(triangle).area)
    }

    /// The deformation gradient of each triangle, with its rest area \[m²\]; that at the centroid, where it is not constant.
    pub fn gradients(&self, x: &[f64]) -> impl Iterator<Item = (Matrix2<f64>, f64)> {
        (0..self.shape.corners.len()).map(|number| (self.gradient_of(x, number), self.rest(number).area))
    }

    /// Adds the elastic forces on this body's vertices to `force` \[N\].
    pub fn elastic_force(&self, x: &[f64], scratch: &mut [f64], force: &mut [f64]) {
        self.material.passes().add_force(self, Motion { x, ..Motion::NONE }, scratch, force);
    }

    /// Stored energy at these positions \[J\].
    pub fn elastic_energy(&self, x: &[f64]) -> f64 {
        self.material.passes().energy(self, x)
    }

    /// Adds the viscous forces of Rayleigh damping.
    pub(crate) fn add_viscous_force(&self, motion: Motion<'_>, law: Viscous, scratch: &mut [f64], force: &mut [f64]) {
        match self.six_nodes() {
            Some(six) => six.add_viscous_force([motion.x, motion.v], force, law, law.lambda()),
            None => {
                self.assemble(law, &mut Adding { x: motion.x, v: motion.v, force }, scratch);
            }
        }
    }

    /// The same for a material of known type.
    pub(super) fn energy_of(&self, material: &impl Material, x: &[f64]) -> f64 {
        if let Some(six) = self.six_nodes() {
            return six.energy(x, six.elastic(&Elastic(*material), volume_of(material)));
        }
        let Shape { vertices, partitions, blocks, .. } = &*self.shape;
        let corners = partitions.corners();
        blocks.set().dispatch(blocks::Energy { material, corners, blocks, x: &x[2 * vertices.start..] })
    }

    /// Assembles the forces of stresses on this body's vertices, `[f1 f2] = -A P D0⁻ᵀ`, into an accumulator. Each
    /// stress needs scratch. Returns the [sum](Accumulator::sum) of the accumulator.
    pub(crate) fn assemble<const N: usize>(
        &self,
        model: impl StressModel<N>,
        accumulator: &mut impl Accumulator<N>,
        scratch: &mut [f64],
    ) -> f64 {
        let mut own = accumulator.view(self.shape.vertices.clone());
        self.shape.partitions.assemble(model, &self.shape.blocks, &mut own, scratch)
    }

    /// Number of partitions for parallel assembly.
    pub fn partitions(&self) -> usize {
        self.shape.partitions.count()
    }

    /// The gradient of a velocity or displacement field in one triangle, with respect to the rest shape.
    pub(crate) fn gradient_of(&self, field: &[f64], number: usize) -> Matrix2<f64> {
        match self.six_nodes() {
            Some(six) => six.gradient(field, number / POINTS, number % POINTS),
            None => edge_matrix(field, self.shape.corners[number]) * self.rest(number).inverse,
        }
    }
}

/// The measure of volume of a material.
pub(super) const fn volume_of<M: Material>(_: &M) -> Option<VolumeMeasure> {
    M::VOLUME
}

/// D = [x1 - x0, x2 - x0] of a triangle, column by column.
#[inline(always)]
pub(super) fn edges(x: &[[f64; 2]], corners: [u32; 3]) -> [f64; 4] {
    let [a, b, c] = corners.map(|corner| x[corner as usize]);
    [b[0] - a[0], b[1] - a[1], c[0] - a[0], c[1] - a[1]]
}

/// D = [x1 - x0, x2 - x0] of a triangle.
fn edge_matrix(x: &[f64], corners: [u32; 3]) -> Matrix2<f64> {
    Matrix2::from_column_slice(&edges(x.as_chunks().0, corners))
}

/// Fraction of its rest area below which a triangle counts as flat; less could be round-off.
const FLAT: f64 = 1e-6;

/// The least t >= 0 after which `det(D + t D') = c + b t + a t²` is less than `least`; infinite if there is none.
fn until_flat(edges: &Matrix2<f64>, change: &Matrix2<f64>, least: f64) -> f64 {
    let (a, c) = (change.determinant(), edges.determinant() - least);
    let b = edges.m11 * change.m22 + change.m11 * edges.m22 - edges.m12 * change.m21 - change.m12 * edges.m21;
    // The reciprocals 1/t solve c s² + b s + a = 0; the first t is the greatest s, which is written so that nothing cancels.
    if c <= 0.0 {
        return if b < 0.0 { 0.0 } else { f64::INFINITY };
    }
    let square = b * b - 4.0 * a * c;
    if square < 0.0 {
        return f64::INFINITY;
    }
    let root = square.sqrt();
    let greatest = if b <= 0.0 { (root - b) / (2.0 * c) } else { -2.0 * a / (b + root) };
    if greatest > 0.0 { 1.0 / greatest } else { f64::INFINITY }
}

impl ElasticElements for Triangles {
    fn vertices(&self) -> Range<usize> {
        self.shape.vertices.clone()
    }

    /// mu A, and (2 mu + lambda) A, for the rest area A.
    fn energy_scales(&self) -> [f64; 2] {
        let area: f64 = self.rest_areas().sum();
        let lame = self.material.lame();
        [lame.mu * area, (2.0 * lame.mu + lame.lambda) * area]
    }

    fn inverted(&self, x: &[f64]) -> [usize; 2] {
        [self.volume_ratios(x).filter(|ratio| *ratio <= 0.0).count(), self.shape.corners.len()]
    }
}

impl Effect for Triangles {
    fn name(&self) -> &'static str {
        "Elasticity"
    }

    fn elements(&self, _: Motion<'_>) -> usize {
        self.shape.corners.len()
    }

    fn restricted(&self, moves: &dyn Fn(usize) -> bool) -> Option<Arc<dyn Effect>> {
        self.restricted_to(moves).map(|left| Arc::new(left) as Arc<dyn Effect>)
    }

    fn scratch(&self) -> usize {
        self.shape.partitions.scratch()
    }

    fn energy(&self, motion: Motion<'_>) -> f64 {
        self.elastic_energy(motion.x)
    }

    fn force(&self, motion: Motion<'_>, scratch: &mut [f64], force: &mut [f64]) {
        self.material.passes().add_force(self, motion, scratch, force);
    }

    fn has_euler_update(&self) -> bool {
        self.six_nodes.is_none()
    }

    fn euler_update(&self, vertices: &mut EulerUpdate<'_>, scratch: &mut [f64]) {
        let damped = vertices.uniform_force.stiffness_damping != 0.0;
        let size = if damped { 2 * self.scratch() } else { self.scratch() };
        self.material.passes().euler_update(self, vertices, &mut scratch[..size]);
    }

    /// If the material has a barrier and no triangle is inverted, none may invert.
    fn longest_step(&self, x: &[f64], d: &[f64]) -> f64 {
        if !self.material.passes().has_barrier() {
            return f64::INFINITY;
        }
        let mut longest = f64::INFINITY;
        if let Some(six) = self.six_nodes() {
            for (point, element) in
                (0..six.count()).flat_map(|element| six.loaded_points().map(move |point| (point, element)))
            {
                let (f, change) = (six.gradient(x, element, point), six.gradient(d, element, point));
                if f.determinant() <= 0.0 {
                    return f64::INFINITY;
                }
                longest = longest.min(until_flat(&f, &change, FLAT));
            }
            return longest;
        }
        for (number, &triangle) in self.shape.corners.iter().enumerate() {
            let (edges, change) = (edge_matrix(x, triangle), edge_matrix(d, triangle));
            if edges.determinant() <= 0.0 {
                return f64::INFINITY;
            }
            longest = longest.min(until_flat(&edges, &change, 2.0 * FLAT * self.rest(number).area));
        }
        longest
    }

    fn stiffness_times(&self, motion: Motion<'_>, d: &[f64], scratch: &mut [f64], product: &mut [f64]) {
        self.material.passes().stiffness_times(self, [motion.x, d], scratch, product);
    }

    fn sparsity_pattern(&self, add: &mut dyn FnMut(u32, u32)) {
        self.add_sparsity(add);
    }

    fn add_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix) {
        if let Some(matrix) = matrix.blocks::<2>() {
            self.material.passes().add_stiffness(self, motion.x, weights, matrix);
        }
    }
}

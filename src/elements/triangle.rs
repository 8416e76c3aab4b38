use crate::{
    effects::{Effect, Motion},
    materials::{Lame, Material, Model, Visitor, times},
    solvers::{BlockMatrix, Weights},
};
use nalgebra::{Matrix2, Vector4};
use std::ops::Range;

/// The linear triangles of one body, all of one material and unit thickness.
///
/// With the edges D = [x1 - x0, x2 - x0] now and D0 at rest, the deformation gradient is `F = D D0⁻¹`, constant over a
/// triangle. The forces on its corners are `[f1 f2] = -A P(F) D0⁻ᵀ` and `f0 = -f1 - f2`
/// (Sifakis and Barbic, *FEM Simulation of 3D Deformable Solids*, SIGGRAPH 2012 course, section 4.2).
///
/// Forces go to a buffer of corners first and are then gathered vertex by vertex, always in the same order: the sum
/// is the same on every run, and no two triangles write to the same place.
#[derive(Debug)]
pub struct Triangles {
    vertices: Range<usize>,
    corners: Vec<[u32; 3]>,
    rest: Vec<Rest>,
    model: Model,
    lame: Lame,
    plane_stress: bool,
    /// For each vertex the end of its list in `incident`; the list begins where the one before ends.
    ends: Vec<u32>,
    /// Corner numbers (3 triangle + corner) of each vertex, one list after another.
    incident: Vec<u32>,
}

/// The rest shape of a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rest {
    /// D0⁻¹ [1/m].
    pub inverse: Matrix2<f64>,
    /// Area [m²], which is the volume of unit thickness.
    pub area: f64,
}

impl Triangles {
    /// The elements of a body.
    ///
    /// `rest` is flat, two numbers for each vertex of the whole scene [m]; `vertices` are this body's; `corners` holds
    /// scene vertex numbers, counter-clockwise.
    pub fn new(rest: &[f64], vertices: Range<usize>, corners: Vec<[u32; 3]>, material: (Model, Lame, bool)) -> Self {
        let shapes = corners.iter().map(|&triangle| {
            let edges = edges(rest, triangle);
            let area = 0.5 * edges.determinant();
            Rest { inverse: Matrix2::new(edges.m22, -edges.m12, -edges.m21, edges.m11) / (2.0 * area), area }
        });
        let shapes = shapes.collect();
        let (ends, incident) = incidence(&corners, &vertices);
        let (model, lame, plane_stress) = material;
        Self { vertices, corners, rest: shapes, model, lame, plane_stress, ends, incident }
    }

    /// Scene numbers of the body's vertices.
    pub const fn vertices(&self) -> &Range<usize> {
        &self.vertices
    }

    /// Scene vertex numbers of each triangle's corners, counter-clockwise at rest.
    pub fn corners(&self) -> &[[u32; 3]] {
        &self.corners
    }

    /// The constitutive model.
    pub const fn model(&self) -> Model {
        self.model
    }

    /// Lame's parameters [Pa].
    pub const fn lame(&self) -> Lame {
        self.lame
    }

    /// The rest shape of each triangle.
    pub(super) fn rest(&self) -> &[Rest] {
        &self.rest
    }

    /// Whether the faces of the sheet are free of stress.
    pub(super) const fn plane_stress(&self) -> bool {
        self.plane_stress
    }

    /// Area of each triangle at rest [m²].
    pub fn rest_areas(&self) -> impl Iterator<Item = f64> {
        self.rest.iter().map(|rest| rest.area)
    }

    /// The deformation gradient of each triangle, with its rest area [m²].
    pub fn gradients(&self, x: &[f64]) -> impl Iterator<Item = (Matrix2<f64>, f64)> {
        self.corners
            .iter()
            .zip(&self.rest)
            .map(|(&triangle, rest)| (times(&edges(x, triangle), &rest.inverse), rest.area))
    }

    /// Elastic forces alone on this body's vertices, added to `force` [N].
    pub fn elastic_force(&self, x: &[f64], scratch: &mut [f64], force: &mut [f64]) {
        self.model.visit(self.lame, CornerForces { of: self, x, out: scratch });
        self.gather(scratch, force);
    }

    /// Stored energy at these positions [J].
    pub fn elastic_energy(&self, x: &[f64]) -> f64 {
        self.model.visit(self.lame, Energy(self, x))
    }

    /// Adds a force at each corner, computed from the triangle's number, F, and D0⁻¹, as `[f1 f2] = -A stress D0⁻ᵀ`.
    pub(crate) fn add_stress(
        &self,
        x: &[f64],
        scratch: &mut [f64],
        force: &mut [f64],
        stress: impl Fn(usize, &Self, &Matrix2<f64>) -> Matrix2<f64>,
    ) {
        for (number, (out, (f, _))) in scratch.chunks_exact_mut(6).zip(self.gradients(x)).enumerate() {
            self.rest[number].corner_forces(&stress(number, self, &f), out);
        }
        self.gather(scratch, force);
    }

    /// The gradient of a velocity or displacement field in one triangle, with respect to the rest shape.
    pub(crate) fn gradient_of(&self, field: &[f64], number: usize) -> Matrix2<f64> {
        edges(field, self.corners[number]) * self.rest[number].inverse
    }

    fn gather(&self, corner_forces: &[f64], force: &mut [f64]) {
        let mut begin = 0;
        let own = &mut force[2 * self.vertices.start..2 * self.vertices.end];
        for (force, &end) in own.chunks_exact_mut(2).zip(&self.ends) {
            let (mut fx, mut fy) = (0.0, 0.0);
            for &corner in &self.incident[begin as usize..end as usize] {
                let at = 2 * corner as usize;
                fx += corner_forces[at];
                fy += corner_forces[at + 1];
            }
            force[0] += fx;
            force[1] += fy;
            begin = end;
        }
    }
}

impl Rest {
    /// Forces on the three corners, x and y each [N], from a first Piola-Kirchhoff stress.
    #[inline(always)]
    fn corner_forces(&self, stress: &Matrix2<f64>, out: &mut [f64]) {
        let h = times(stress, &self.inverse.transpose());
        let [h11, h21, h12, h22] = [h.m11, h.m21, h.m12, h.m22].map(|h| -self.area * h);
        out.copy_from_slice(&[-h11 - h12, -h21 - h22, h11, h21, h12, h22]);
    }
}

/// D = [x1 - x0, x2 - x0] of a triangle.
#[inline(always)]
fn edges(x: &[f64], [a, b, c]: [u32; 3]) -> Matrix2<f64> {
    let point = |i: u32| [x[2 * i as usize], x[2 * i as usize + 1]];
    let ([ax, ay], [bx, by], [cx, cy]) = (point(a), point(b), point(c));
    Matrix2::new(bx - ax, cx - ax, by - ay, cy - ay)
}

/// For each vertex the corners that meet there, in ascending order, as one list with the ends of its parts.
fn incidence(corners: &[[u32; 3]], vertices: &Range<usize>) -> (Vec<u32>, Vec<u32>) {
    let mut ends = vec![0_u32; vertices.len()];
    for &corner in corners.as_flattened() {
        ends[corner as usize - vertices.start] += 1;
    }
    let mut sum = 0;
    for end in &mut ends {
        let count = *end;
        *end = sum;
        sum += count;
    }
    let mut incident = vec![0; sum as usize];
    for (number, &corner) in corners.as_flattened().iter().enumerate() {
        let end = &mut ends[corner as usize - vertices.start];
        incident[*end as usize] = number as u32;
        *end += 1;
    }
    (ends, incident)
}

struct CornerForces<'a> {
    of: &'a Triangles,
    x: &'a [f64],
    out: &'a mut [f64],
}

impl Visitor for CornerForces<'_> {
    type Output = ();
    fn visit<M: Material>(self, material: &M) {
        let of = self.of;
        for ((out, &triangle), rest) in self.out.chunks_exact_mut(6).zip(&of.corners).zip(&of.rest) {
            let stress = material.stress(&times(&edges(self.x, triangle), &rest.inverse));
            rest.corner_forces(&stress, out);
        }
    }
}

struct Energy<'a>(&'a Triangles, &'a [f64]);

impl Visitor for Energy<'_> {
    type Output = f64;
    fn visit<M: Material>(self, material: &M) -> f64 {
        self.0.gradients(self.1).map(|(f, area)| area * material.energy(&f)).sum()
    }
}

struct StiffnessTimes<'a> {
    of: &'a Triangles,
    x: &'a [f64],
    d: &'a [f64],
    product: &'a mut [f64],
}

impl Visitor for StiffnessTimes<'_> {
    type Output = ();
    fn visit<M: Material>(self, material: &M) {
        for ((&triangle, rest), (f, _)) in self.of.corners.iter().zip(&self.of.rest).zip(self.of.gradients(self.x)) {
            let df = edges(self.d, triangle) * rest.inverse;
            let dp = material.stiffness(&f) * Vector4::from_column_slice(df.as_slice());
            let mut forces = [0.0; 6];
            rest.corner_forces(&Matrix2::from_column_slice(dp.as_slice()), &mut forces);
            for (corner, force) in triangle.iter().zip(forces.chunks_exact(2)) {
                self.product[2 * *corner as usize] -= force[0];
                self.product[2 * *corner as usize + 1] -= force[1];
            }
        }
    }
}

impl Effect for Triangles {
    fn name(&self) -> &'static str {
        "Elasticity"
    }

    fn elements(&self, _: Motion<'_>) -> usize {
        self.corners.len()
    }

    fn scratch(&self) -> usize {
        6 * self.corners.len()
    }

    fn energy(&self, motion: Motion<'_>) -> f64 {
        self.elastic_energy(motion.x)
    }

    fn force(&self, motion: Motion<'_>, scratch: &mut [f64], force: &mut [f64]) {
        self.elastic_force(motion.x, scratch, force);
    }

    fn stiffness_times(&self, motion: Motion<'_>, d: &[f64], product: &mut [f64]) {
        self.model.visit(self.lame, StiffnessTimes { of: self, x: motion.x, d, product });
    }

    fn couples(&self, add: &mut dyn FnMut(u32, u32)) {
        self.name_couples(add);
    }

    fn add_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut BlockMatrix) {
        self.add_elastic_tangent(motion.x, weights.position, matrix);
    }
}

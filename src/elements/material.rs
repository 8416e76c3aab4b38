//! Material of a body: a constitutive model for all triangles of a mesh at a time.

use super::{
    Diagnostics, EulerUpdate, Field, Membranes, PointStress, Triangles,
    blocks::{Both, Elastic},
};
use crate::{
    effects::{Motion, Viscous},
    materials::{Lame, Material, MaterialParameters, Model, Plane, TypedMaterial, Visitor},
    solvers::{BlockMatrix, Weights},
};
use nalgebra::Matrix2;
use std::{fmt, sync::Arc};

/// The material of a body. Its constitutive model is compiled into the loops over triangles, which are called once for
/// a whole mesh.
#[derive(Clone, Debug)]
pub struct BodyMaterial {
    passes: Arc<dyn MeshMaterial>,
    model: Option<Model>,
    lame: Lame,
    plane: Plane,
}

impl BodyMaterial {
    /// A listed model with Lame's parameters of a plane.
    pub fn new(model: Model, lame: Lame, plane: Plane) -> Self {
        struct Shared;
        impl Visitor for Shared {
            type Output = Arc<dyn MeshMaterial>;
            fn visit<M: Material>(self, material: &M) -> Self::Output {
                Arc::new(*material)
            }
        }
        Self { passes: model.visit_in(plane, lame, Shared), model: Some(model), lame, plane }
    }

    /// A typed energy.
    pub fn typed(material: TypedMaterial, plane: Plane) -> Self {
        Self { passes: Arc::new(material), model: None, lame: material.lame(), plane }
    }

    /// The listed model, if it is one.
    pub const fn model(&self) -> Option<Model> {
        self.model
    }

    /// Runs a visitor on the listed model; `None` for a material from outside the crate.
    pub fn visit<V: Visitor>(&self, visitor: V) -> Option<V::Output> {
        Some(self.model?.visit_in(self.plane, self.lame, visitor))
    }

    /// Name of the model.
    pub fn title(&self) -> &'static str {
        self.passes.title()
    }

    /// Where and how the formula of the model is continued; empty if it is not.
    pub fn continuation(&self) -> &'static str {
        self.passes.continuation()
    }

    /// Lame's parameters of the plane \[Pa\]: those of Hooke's law, to which the model linearises at rest.
    pub const fn lame(&self) -> Lame {
        self.lame
    }

    /// Condition through the thickness.
    pub const fn plane(&self) -> Plane {
        self.plane
    }

    /// See [`Material::free_width`].
    pub fn free_width(&self, stretch: f64) -> Option<f64> {
        self.passes.free_width(stretch)
    }

    /// See [`Material::strip_warning`].
    pub fn strip_warning(&self, stretch: f64) -> Option<String> {
        self.passes.strip_warning(stretch)
    }

    /// Energy density and stress at a deformation gradient.
    pub fn at(&self, f: &Matrix2<f64>) -> PointStress {
        self.passes.at(f, self.plane.is_stress())
    }

    /// Whether its energy can be that of a mean dilatation: see [`Material::VOLUME`].
    pub fn has_volume_measure(&self) -> bool {
        self.passes.has_volume_measure()
    }

    /// Passes over all triangles.
    pub(super) fn passes(&self) -> &dyn MeshMaterial {
        &*self.passes
    }
}

impl From<MaterialParameters> for BodyMaterial {
    fn from(parameters: MaterialParameters) -> Self {
        Self::new(parameters.model(), parameters.lame(), parameters.plane())
    }
}

/// A material from outside the crate, for any elastic moduli. Level files cannot hold it.
#[derive(Clone)]
pub struct OwnMaterial {
    title: &'static str,
    build: Arc<dyn Fn(Lame) -> Arc<dyn MeshMaterial> + Send + Sync>,
}

impl OwnMaterial {
    /// From a function that makes the material of Lame's parameters \[Pa\]. At rest it must linearise to Hooke's law with
    /// those: damping, the energy check and estimates of speed use them.
    pub fn new<M: Material>(build: impl Fn(Lame) -> M + Send + Sync + 'static) -> Self {
        Self { title: M::TITLE, build: Arc::new(move |lame| Arc::new(build(lame))) }
    }

    /// The material with the moduli of a level; its model is not used.
    pub fn with(&self, parameters: MaterialParameters) -> BodyMaterial {
        let (lame, plane) = (parameters.lame(), parameters.plane());
        BodyMaterial { passes: (self.build)(lame), model: None, lame, plane }
    }
}

impl fmt::Debug for OwnMaterial {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.title)
    }
}

/// Equal are only clones of one.
impl PartialEq for OwnMaterial {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.build, &other.build)
    }
}

/// Passes over all triangles of a mesh, for a material of a type known when they were compiled.
pub trait MeshMaterial: Send + Sync {
    /// See [`Material::TITLE`].
    fn title(&self) -> &'static str;

    /// See [`Material::CONTINUATION`].
    fn continuation(&self) -> &'static str;

    /// See [`Material::BARRIER`].
    fn has_barrier(&self) -> bool;

    /// See [`Material::free_width`].
    fn free_width(&self, stretch: f64) -> Option<f64>;

    /// See [`Material::strip_warning`].
    fn strip_warning(&self, stretch: f64) -> Option<String>;

    /// Energy density and stress at a deformation gradient.
    fn at(&self, f: &Matrix2<f64>, is_plane_stress: bool) -> PointStress;

    /// See [`Triangles::point_stress`].
    fn point_stress(&self, of: &Triangles, x: &[f64], number: usize) -> PointStress;

    /// Whether it is known which part of the energy resists changes of volume: see [`Material::VOLUME`].
    fn has_volume_measure(&self) -> bool;

    /// See [`Triangles::elastic_force`].
    fn add_force(&self, of: &Triangles, motion: Motion<'_>, scratch: &mut [f64], force: &mut [f64]);

    /// Updates the vertices, with viscous forces too if there is stiffness damping.
    fn euler_update(&self, of: &Triangles, vertices: &mut EulerUpdate<'_>, scratch: &mut [f64]);

    /// See [`Triangles::elastic_energy`].
    fn energy(&self, of: &Triangles, x: &[f64]) -> f64;

    /// See [`Triangles::diagnose_with_energy`].
    fn diagnose(
        &self,
        of: &Triangles,
        energy: Option<f64>,
        field: Field,
        x: &[f64],
        values: &mut Vec<f64>,
    ) -> Diagnostics;

    /// Adds the elastic stiffness at the first positions, times the second displacement, to a product.
    fn stiffness_times(&self, of: &Triangles, moving: [&[f64]; 2], scratch: &mut [f64], product: &mut [f64]);

    /// Adds the blocks of the elastic stiffness.
    fn add_stiffness(&self, of: &Triangles, x: &[f64], weights: Weights, matrix: &mut BlockMatrix<2>);

    /// See [`Membranes::add_values`].
    fn add_membrane_values(&self, of: &Membranes, field: Field, x: &[f64], values: &mut Vec<f64>);

    /// See [`Membranes::elastic_energy`].
    fn membrane_energy(&self, of: &Membranes, x: &[f64]) -> f64;

    /// Adds the forces of a membrane.
    fn add_membrane_force(&self, of: &Membranes, motion: Motion<'_>, force: &mut [f64]);

    /// Adds the stiffness of a membrane at the first positions, times the second displacement, to a product.
    fn membrane_stiffness_times(&self, of: &Membranes, moving: [&[f64]; 2], product: &mut [f64]);

    /// Adds the blocks of the stiffness of a membrane.
    fn add_membrane_stiffness(&self, of: &Membranes, x: &[f64], weights: Weights, matrix: &mut BlockMatrix<3>);
}

impl fmt::Debug for dyn MeshMaterial {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.title())
    }
}

impl<M: Material> MeshMaterial for M {
    fn title(&self) -> &'static str {
        M::TITLE
    }

    fn continuation(&self) -> &'static str {
        M::CONTINUATION
    }

    fn has_barrier(&self) -> bool {
        M::BARRIER
    }

    fn free_width(&self, stretch: f64) -> Option<f64> {
        Material::free_width(self, stretch)
    }

    fn strip_warning(&self, stretch: f64) -> Option<String> {
        Material::strip_warning(self, stretch)
    }

    fn at(&self, f: &Matrix2<f64>, is_plane_stress: bool) -> PointStress {
        PointStress::of(self, f, is_plane_stress)
    }

    fn point_stress(&self, of: &Triangles, x: &[f64], number: usize) -> PointStress {
        of.point_stress_as(self, x, number)
    }

    fn has_volume_measure(&self) -> bool {
        M::VOLUME.is_some()
    }

    fn add_force(&self, of: &Triangles, motion: Motion<'_>, scratch: &mut [f64], force: &mut [f64]) {
        match of.six_nodes() {
            Some(six) => six.add_force(motion, force, six.elastic(&Elastic(*self), M::VOLUME)),
            None => of.add_force_of(motion, scratch, force, Elastic(*self)),
        }
    }

    fn euler_update(&self, of: &Triangles, vertices: &mut EulerUpdate<'_>, scratch: &mut [f64]) {
        let damping = vertices.uniform_force.stiffness_damping;
        vertices.twice_kinetic += if damping == 0.0 {
            of.assemble(Elastic(*self), vertices, scratch)
        } else {
            of.assemble(Both(Elastic(*self), Viscous::new(damping, of.material().lame())), vertices, scratch)
        };
    }

    fn energy(&self, of: &Triangles, x: &[f64]) -> f64 {
        of.energy_of(self, x)
    }

    fn diagnose(
        &self,
        of: &Triangles,
        energy: Option<f64>,
        field: Field,
        x: &[f64],
        values: &mut Vec<f64>,
    ) -> Diagnostics {
        of.diagnose_as(self, energy, field, x, values)
    }

    fn stiffness_times(&self, of: &Triangles, moving: [&[f64]; 2], scratch: &mut [f64], product: &mut [f64]) {
        match of.six_nodes() {
            Some(six) => six.add_energy_change(moving, product, six.elastic(&Elastic(*self), M::VOLUME)),
            None => of.add_energy_change(moving, scratch, product, Elastic(*self)),
        }
    }

    fn add_stiffness(&self, of: &Triangles, x: &[f64], weights: Weights, matrix: &mut BlockMatrix<2>) {
        match of.six_nodes() {
            Some(six) => six.add_energy_tangent(x, weights, matrix, six.elastic(&Elastic(*self), M::VOLUME)),
            None => of.add_energy_tangent(x, weights, matrix, Elastic(*self)),
        }
    }

    fn add_membrane_values(&self, of: &Membranes, field: Field, x: &[f64], values: &mut Vec<f64>) {
        of.add_values_as(self, field, x, values);
    }

    fn membrane_energy(&self, of: &Membranes, x: &[f64]) -> f64 {
        of.energy_of(Elastic(*self), x)
    }

    fn add_membrane_force(&self, of: &Membranes, motion: Motion<'_>, force: &mut [f64]) {
        of.add_force_of(motion, force, Elastic(*self));
    }

    fn membrane_stiffness_times(&self, of: &Membranes, moving: [&[f64]; 2], product: &mut [f64]) {
        of.add_energy_change(moving, product, Elastic(*self));
    }

    fn add_membrane_stiffness(&self, of: &Membranes, x: &[f64], weights: Weights, matrix: &mut BlockMatrix<3>) {
        of.add_energy_tangent(x, weights, matrix, Elastic(*self));
    }
}

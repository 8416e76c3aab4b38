//! Constitutive models: hyperelastic materials as functions of the deformation gradient F alone, independent of mesh,
//! time and solver. Each model is one file; [`Model`] lists them all.
//!
//! A model implements its energy [`Material::psi`] and stress [`Material::piola`] once, over any [`Real`]: with `f64`
//! for single triangles, with SIMD lanes for eight triangles at a time. So formulas use the operations of [`Real`] and
//! [`Mat2`] alone, and where a formula has cases, both sides are computed and [`Real::if_less`] selects one. Closed
//! forms of strips are written for `f64`, and so is the textbook form of the stiffness, which the moduli are tested
//! against.
//!
//! Every model linearises to the same Hooke law at rest: `P = 2 mu e + lambda tr(e) I` with `e = sym(F - I)`.

mod continuation;
mod corotated;
mod fixed_corotated;
mod hencky;
mod moduli;
mod neo_hookean;
mod parameters;
mod principal;
mod sheet;
mod st_venant_kirchhoff;
mod stable_neo_hookean;
mod typed;
mod volume;

pub use corotated::{Corotated, nearest_rotation};
pub use fixed_corotated::FixedCorotated;
pub use hencky::Hencky;
pub use moduli::{Moduli, Parts, with_eigenvalues};
pub use neo_hookean::NeoHookean;
pub use parameters::{BadMaterial, Lame, MaterialParameters, Plane};
pub use principal::{Principal, PrincipalEnergy};
pub use sheet::{FixedCorotatedSheet, NeoHookeanSheet};
pub use st_venant_kirchhoff::StVenantKirchhoff;
pub use stable_neo_hookean::StableNeoHookean;
pub use typed::{BadEnergy, TypedEnergy, TypedMaterial};
pub use volume::VolumeMeasure;

use crate::{
    registry::registry,
    simd::{Mat2, Real},
};
use nalgebra::{Matrix2, Matrix4};

registry! {
    /// Which constitutive model a body follows.
    pub enum Model: static Material(Lame) via Visitor {
        Corotated(Corotated),
        StVenantKirchhoff(StVenantKirchhoff),
        NeoHookean(NeoHookean),
        StableNeoHookean(StableNeoHookean),
        FixedCorotated(FixedCorotated),
        Hencky(Hencky),
    }
}

/// Least J = det F from which the formula of every model is used unchanged, if no principal stretch is below [`THIN`].
pub const WHOLE: f64 = 0.25;

/// Least principal stretch from which the formula of every model is used unchanged, if J = det F is not below [`WHOLE`].
pub const THIN: f64 = 0.125;

/// A hyperelastic material in two dimensions, per unit thickness.
///
/// `f` is the deformation gradient F (2 x 2, no unit): column j is where the rest direction j went.
pub trait Material: Copy + Send + Sync + 'static {
    /// Name as it is said, such as `St. Venant-Kirchhoff`.
    const TITLE: &'static str;
    /// The letter on its button.
    const LETTER: &'static str;
    /// The energy density in plain characters, for tooltips.
    const FORMULA: &'static str;
    /// Whether the energy of the model tends to infinity as a triangle becomes flat, so that no exact solution inverts
    /// one.
    const BARRIER: bool = false;
    /// Where and how the formula is continued, if it is: see [`Self::is_continued`].
    const CONTINUATION: &'static str = "";

    /// How the faces of a sheet stay free of stress at large strain.
    const PLANE_STRESS: PlaneStress = PlaneStress::Approximate;

    /// The measure m(F) of [`Self::volumetric`]; `None` if it is not known which part of the energy resists changes of volume.
    const VOLUME: Option<VolumeMeasure> = None;

    /// The model whose thickness solves P33 = 0, for [`PlaneStress::Solved`]; otherwise the model itself.
    type Sheet: Material;

    /// The same material with its thickness solved for.
    fn sheet(&self) -> Self::Sheet;

    /// Energy density psi [J/m²]; zero at rest.
    fn psi<R: Real>(&self, f: Mat2<R>) -> R;

    /// First Piola-Kirchhoff stress P = dpsi/dF [N/m per unit rest length, that is Pa of a 1 m thick sheet].
    fn piola<R: Real>(&self, f: Mat2<R>) -> Mat2<R>;

    /// U, U' and U'' of the part `U(m(F))` of psi that resists changes of volume, where it is stiff: with [`Self::VOLUME`] as m, what is
    /// left of psi without it has no factor lambda.
    #[inline(always)]
    fn volumetric<R: Real>(&self, measure: R) -> [R; 3] {
        [measure.of(0.0); 3]
    }

    /// [`Self::psi`] of one gradient [J/m²].
    fn energy(&self, f: &Matrix2<f64>) -> f64 {
        self.psi(Mat2::from(f))
    }

    /// [`Self::piola`] of one gradient \[Pa\].
    fn stress(&self, f: &Matrix2<f64>) -> Matrix2<f64> {
        self.piola(Mat2::from(f)).into()
    }

    /// dP/dF (4 x 4) \[Pa\]: entry (i, j) is the derivative of the i-th entry of P by the j-th of F, both column by column.
    fn stiffness(&self, f: &Matrix2<f64>) -> Matrix4<f64>;

    /// The same by the parts of F, in SIMD lanes.
    fn moduli<R: Real>(&self, parts: &Parts<R>) -> Moduli<R>;

    /// Whether this gradient is in the continued range of the formula: never where its determinant is [`WHOLE`] or
    /// more and both principal stretches are [`THIN`] or more.
    fn is_continued(&self, _f: &Matrix2<f64>) -> bool {
        false
    }

    /// The stress through the thickness, P33 \[Pa\], in plane strain, F33 = 1; plane stress has none. Undefined where F
    /// is NaN.
    fn thickness_stress<R: Real>(&self, f: Mat2<R>) -> R;

    /// The width w of a strip of stretch s with free sides: P22(diag(s, w)) = 0. `None` where there is no positive one.
    fn free_width(&self, stretch: f64) -> Option<f64>;

    /// Warning for a strip of this stretch: where the model has no solution, or softens, `dP11/ds < 0` along the strip.
    fn strip_warning(&self, stretch: f64) -> Option<String> {
        let Some(width) = self.free_width(stretch) else {
            return Some(format!(
                "{} has no solution here: with free sides, no positive width is in equilibrium at {stretch:.2} x.",
                Self::TITLE
            ));
        };
        let stiffness = self.stiffness(&Matrix2::new(stretch, 0.0, 0.0, width));
        let along = stiffness.m11 - stiffness.m14 * stiffness.m41 / stiffness.m44;
        (along < 0.0).then(|| {
            format!("{} gives way here (softening): with free sides, stretching or pressing further from {stretch:.2} x needs less force.", Self::TITLE)
        })
    }
}

/// How the faces of a sheet stay free of stress: `lambda` of Hooke's law in plane stress, put into the formula of plane
/// strain, leaves none at small strain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaneStress {
    /// It leaves exactly none at any strain: the thickness strain of Hooke's law is also that of the model, in its own
    /// measure of strain.
    Exact,
    /// It leaves some at large strain; [`Material::Sheet`] leaves none.
    Solved,
    /// It leaves some at large strain, and there is no other.
    Approximate,
}

/// An operation on a material of a type known at compile time.
pub trait Visitor {
    /// Result of the operation.
    type Output;
    /// Performs the operation.
    fn visit<M: Material>(self, material: &M) -> Self::Output;
}

/// A model by its name in level files or the letter on its button, in any case.
impl std::str::FromStr for Model {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let is_meant =
            |model: &&Self| [model.name(), model.letter()].iter().any(|known| known.eq_ignore_ascii_case(text));
        let names = || Self::ALL.iter().map(|model| model.name()).collect::<Vec<_>>().join(", ");
        Self::ALL.iter().find(is_meant).copied().ok_or_else(|| format!("expected one of {}", names()))
    }
}

impl Model {
    /// Name as it is said, such as `St. Venant-Kirchhoff`.
    pub fn title(self) -> &'static str {
        self.words()[0]
    }

    /// The letter on its button.
    pub fn letter(self) -> &'static str {
        self.words()[1]
    }

    /// The energy density in plain characters.
    pub fn formula(self) -> &'static str {
        self.words()[2]
    }

    /// Where and how the formula is continued; empty if it is not.
    pub fn continuation(self) -> &'static str {
        self.words()[3]
    }

    fn words(self) -> [&'static str; 4] {
        struct Words;
        impl Visitor for Words {
            type Output = [&'static str; 4];
            fn visit<M: Material>(self, _: &M) -> Self::Output {
                [M::TITLE, M::LETTER, M::FORMULA, M::CONTINUATION]
            }
        }
        self.visit(Lame { mu: 1.0, lambda: 0.0 }, Words)
    }

    /// Runs the visitor on the model as it is in this plane, with Lame's parameters of that plane.
    pub fn visit_in<V: Visitor>(self, plane: Plane, lame: Lame, visitor: V) -> V::Output {
        struct InPlane<V>(Plane, V);
        impl<V: Visitor> Visitor for InPlane<V> {
            type Output = V::Output;
            fn visit<M: Material>(self, material: &M) -> V::Output {
                let Self(plane, visitor) = self;
                if plane == Plane::StressExact && M::PLANE_STRESS == PlaneStress::Solved {
                    visitor.visit(&material.sheet())
                } else {
                    visitor.visit(material)
                }
            }
        }
        self.visit(lame, InPlane(plane, visitor))
    }

    /// See [`Material::PLANE_STRESS`].
    pub fn plane_stress(self) -> PlaneStress {
        struct Kind;
        impl Visitor for Kind {
            type Output = PlaneStress;
            fn visit<M: Material>(self, _: &M) -> PlaneStress {
                M::PLANE_STRESS
            }
        }
        self.visit(Lame { mu: 1.0, lambda: 0.0 }, Kind)
    }

    /// See [`Material::strip_warning`].
    pub fn strip_warning(self, lame: Lame, stretch: f64) -> Option<String> {
        self.visit(lame, StripWarning(stretch))
    }
}

/// Visitor for [`Material::strip_warning`] at a stretch.
#[derive(Clone, Copy, Debug)]
pub struct StripWarning(pub f64);

impl Visitor for StripWarning {
    type Output = Option<String>;
    fn visit<M: Material>(self, material: &M) -> Option<String> {
        material.strip_warning(self.0)
    }
}

/// The outer product of two 2 x 2 matrices, each read column by column: (4 x 4).
fn outer(a: &Matrix2<f64>, b: &Matrix2<f64>) -> Matrix4<f64> {
    Matrix4::from_fn(|i, j| a.as_slice()[i] * b.as_slice()[j])
}

/// The derivative of the cofactor matrix (4 x 4), as in [`Material::stiffness`]: dG has the entries of dF, turned around.
#[rustfmt::skip]
const COFACTOR: Matrix4<f64> = Matrix4::new(
    0.0,  0.0,  0.0, 1.0,
    0.0,  0.0, -1.0, 0.0,
    0.0, -1.0,  0.0, 0.0,
    1.0,  0.0,  0.0, 0.0,
);

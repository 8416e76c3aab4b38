//! Diagnostics of triangles: energy, least det F, and fields for their colour.

use super::{
    Membranes, SixNodes, Triangles,
    blocks::Elastic,
    point_law::POINTS,
    triangle::{Rest, edges, volume_of},
};
use crate::{
    materials::{Material, THIN, WHOLE},
    simd::{LANES, Lanes, Mat2, Real, Wide},
};
use nalgebra::Matrix2;
use pulp::{Arch, Simd, WithSimd};

/// Number of blocks of triangles gathered at a time: enough for scalar stores to complete before they are read as SIMD
/// vectors.
const RUN_BLOCKS: usize = 4;

/// Diagnostics of all triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diagnostics {
    /// Elastic energy \[J\].
    pub energy: f64,
    /// Least det F; infinite if there are none.
    pub least: f64,
    /// Number of triangles with det F <= 0 at their centroids. For quadratic elements that is not quite what is drawn.
    pub inverted: usize,
    /// Number of triangles in the continued range of the model's formula.
    pub continued: usize,
}

impl Triangles {
    /// Computes the diagnostics and, in the same pass, appends one value for each triangle to `values`, in their order;
    /// nothing for a field that is not [of triangles](Field::is_of_triangles).
    pub fn diagnose(&self, field: Field, x: &[f64], values: &mut Vec<f64>) -> Diagnostics {
        self.diagnose_with_energy(None, field, x, values)
    }

    /// The same with an energy \[J\] that may be known and is not computed then.
    pub fn diagnose_with_energy(
        &self,
        energy: Option<f64>,
        field: Field,
        x: &[f64],
        values: &mut Vec<f64>,
    ) -> Diagnostics {
        self.material().passes().diagnose(self, energy, field, x, values)
    }

    /// The same for a material of known type.
    pub(super) fn diagnose_as(
        &self,
        material: &impl Material,
        energy: Option<f64>,
        field: Field,
        x: &[f64],
        out: &mut Vec<f64>,
    ) -> Diagnostics {
        if let Some(six) = self.six_nodes() {
            return six.diagnose(material, self.material().plane().is_stress(), energy, field, x, out);
        }
        Arch::new().dispatch(DiagnosticsKernel { of: self, material, energy, field, x, out })
    }
}

/// Eight triangles: D = [x1 - x0, x2 - x0] and D0⁻¹, column by column, and the area at rest \[m²\].
#[derive(Clone, Copy, Default)]
struct Eight {
    edges: [Lanes; 4],
    inverse: [Lanes; 4],
    area: Lanes,
}

impl Eight {
    #[inline(always)]
    fn collect(&mut self, of: &Triangles, x: &[[f64; 2]], first: usize, corners: &[[u32; 3]]) {
        for (lane, &triangle) in corners.iter().enumerate() {
            let Rest { inverse, area } = of.rest(first + lane);
            let (edges, inverse) = (edges(x, triangle), inverse.as_slice());
            for entry in 0..4 {
                self.edges[entry][lane] = edges[entry];
                self.inverse[entry][lane] = inverse[entry];
            }
            self.area[lane] = area;
        }
    }

    /// One SIMD register of deformation gradients and of areas.
    #[inline(always)]
    fn part<S: Simd>(&self, set: S, part: usize) -> (Mat2<Wide<S>>, Wide<S>) {
        let matrix = |of: &[Lanes; 4]| {
            let [m11, m21, m12, m22] = [0, 1, 2, 3].map(|entry| Wide::load(set, &of[entry], part));
            Mat2::new(m11, m12, m21, m22)
        };
        (matrix(&self.edges).times(matrix(&self.inverse)), Wide::load(set, &self.area, part))
    }
}

struct DiagnosticsKernel<'a, M> {
    of: &'a Triangles,
    material: &'a M,
    energy: Option<f64>,
    field: Field,
    x: &'a [f64],
    out: &'a mut Vec<f64>,
}

impl<M: Material> WithSimd for DiagnosticsKernel<'_, M> {
    type Output = Diagnostics;

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) -> Diagnostics {
        let Self { of, material, energy, field, x, out } = self;
        let x = x.as_chunks().0;
        // Energies are stored behind the values and summed in the order of the fans, as without fields.
        let end = out.len() + if field.is_of_triangles() { of.corners().len() } else { 0 };
        let mut next = out.len();
        out.resize(end + if energy.is_some() { 0 } else { of.slots() }, 0.0);
        let mut found = Diagnostics { energy: 0.0, least: f64::INFINITY, inverted: 0, continued: 0 };
        let mut eights = [Eight::default(); RUN_BLOCKS];
        let [mut ratios, mut slacks, mut energies, mut values] = [Lanes::default(); 4];
        for (run, corners) in of.corners().chunks(RUN_BLOCKS * LANES).enumerate() {
            for (number, (eight, corners)) in eights.iter_mut().zip(corners.chunks(LANES)).enumerate() {
                eight.collect(of, x, (run * RUN_BLOCKS + number) * LANES, corners);
            }
            for (number, (eight, corners)) in eights.iter().zip(corners.chunks(LANES)).enumerate() {
                for part in 0..Wide::<S>::PARTS {
                    let (f, area) = eight.part(set, part);
                    let j = f.determinant();
                    j.store(&mut ratios, part);
                    // Negative where a principal stretch is below THIN: J² is the product of their squares, |F|² the sum.
                    (j * j - f.norm_squared() * (THIN * THIN)).store(&mut slacks, part);
                    if energy.is_none() {
                        (material.psi(f) * area).store(&mut energies, part);
                    }
                    if let Some(value) = value_of(field, material, f, of.material().plane().is_stress()) {
                        value.store(&mut values, part);
                    }
                }
                // Unused lanes are skipped.
                for lane in 0..corners.len() {
                    let (j, triangle) = (ratios[lane], (run * RUN_BLOCKS + number) * LANES + lane);
                    if energy.is_none() {
                        out[end + of.slot(triangle)] = energies[lane];
                    }
                    found.least = found.least.min(j);
                    found.inverted += usize::from(j <= 0.0);
                    if j < WHOLE || slacks[lane] < 0.0 {
                        let f = of.gradient_of(x.as_flattened(), triangle);
                        found.continued += usize::from(material.is_continued(&f));
                    }
                }
                if field.is_of_triangles() {
                    out[next..][..corners.len()].copy_from_slice(&values[..corners.len()]);
                    next += corners.len();
                }
            }
        }
        found.energy = energy.unwrap_or_else(|| out[end..].iter().fold(0.0, |sum, energy| sum + energy));
        out.truncate(end);
        found
    }
}

impl SixNodes {
    /// See [`Triangles::diagnose_as`].
    fn diagnose(
        &self,
        material: &impl Material,
        is_plane_stress: bool,
        energy: Option<f64>,
        field: Field,
        x: &[f64],
        out: &mut Vec<f64>,
    ) -> Diagnostics {
        let elastic = Elastic(*material);
        let law = self.elastic(&elastic, volume_of(material));
        let energy = energy.unwrap_or_else(|| self.energy(x, law));
        let mut found = Diagnostics { energy, least: f64::INFINITY, inverted: 0, continued: 0 };
        for element in 0..self.count() {
            let mut add = |f: &Matrix2<f64>| {
                let j = f.determinant();
                found.least = found.least.min(j);
                found.inverted += usize::from(j <= 0.0);
                found.continued += usize::from(material.is_continued(f));
            };
            if field.is_of_triangles() {
                for (f, point) in self.points(x, element, law, is_plane_stress) {
                    add(&f);
                    let stress = || CauchyStress::new(Mat2::from(&f), Mat2::from(&point.piola), point.thickness);
                    out.extend(value_from(field, Mat2::from(&f), || point.energy, stress));
                }
            } else {
                self.gradients(x, element).iter().for_each(&mut add);
            }
        }
        found
    }
}

impl Membranes {
    /// Appends one value for each triangle to `values`, in their order, at these positions \[m\]; nothing for a field that is not
    /// [of triangles](Field::is_of_triangles). The energy density is that of the thickness.
    pub fn add_values(&self, field: Field, x: &[f64], values: &mut Vec<f64>) {
        self.material().passes().add_membrane_values(self, field, x, values);
    }

    /// The same for a material of known type.
    pub(super) fn add_values_as(&self, material: &impl Material, field: Field, x: &[f64], values: &mut Vec<f64>) {
        let is_stress = self.material().plane().is_stress();
        let factor = if field == Field::EnergyDensity { self.thickness() } else { 1.0 };
        let value = |f: Mat2<f64>| value_of(field, material, f, is_stress).map(|value| factor * value);
        values.extend(self.gradients(x).filter_map(|f| value(Mat2::from(&f))));
    }
}

/// Energy density and stress at one deformation gradient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointStress {
    /// Energy density psi \[J/m³\].
    pub energy: f64,
    /// First Piola-Kirchhoff stress P \[Pa\].
    pub piola: Matrix2<f64>,
    /// The stress through the thickness, P33 \[Pa\]: none in plane stress.
    pub thickness: f64,
    /// Von Mises equivalent of the Cauchy stress \[Pa\].
    pub von_mises: f64,
}

impl PointStress {
    /// Of a material of known type.
    pub(super) fn of(material: &impl Material, f: &Matrix2<f64>, is_plane_stress: bool) -> Self {
        let thickness = if is_plane_stress { 0.0 } else { material.thickness_stress(Mat2::from(f)) };
        Self::new(f, material.energy(f), material.stress(f), thickness)
    }

    /// From F, psi, P and P33.
    pub(super) fn new(f: &Matrix2<f64>, energy: f64, piola: Matrix2<f64>, thickness: f64) -> Self {
        let von_mises = CauchyStress::new(Mat2::from(f), Mat2::from(&piola), thickness).von_mises();
        Self { energy, piola, thickness, von_mises }
    }
}

/// Value of a field at a deformation gradient; `None` for one that is not of triangles.
#[inline(always)]
fn value_of<M: Material, R: Real>(field: Field, material: &M, f: Mat2<R>, plane_stress: bool) -> Option<R> {
    value_from(field, f, || material.psi(f), || CauchyStress::of(material, f, plane_stress))
}

/// The same from energy density and stress.
#[inline(always)]
fn value_from<R: Real>(
    field: Field,
    f: Mat2<R>,
    energy: impl FnOnce() -> R,
    of_stress: impl FnOnce() -> CauchyStress<R>,
) -> Option<R> {
    match field {
        Field::None | Field::Speed | Field::Displacement | Field::StressError => None,
        Field::Volume => Some(f.determinant()),
        Field::Stretch => Some(greatest_stretch(f)),
        Field::EnergyDensity => Some(energy()),
        Field::VonMises => Some(of_stress().von_mises()),
        Field::Pressure => Some(of_stress().pressure()),
        Field::PrincipalStress => Some(of_stress().greatest()),
    }
}

/// The greater principal stretch: half of |F + cof F| and |F - cof F| together, the similar and the antisimilar part of F.
#[inline(always)]
fn greatest_stretch<R: Real>(f: Mat2<R>) -> R {
    let (a, b) = (f.m11 + f.m22, f.m21 - f.m12);
    let (c, d) = (f.m11 - f.m22, f.m21 + f.m12);
    ((a * a + b * b).sqrt() + (c * c + d * d).sqrt()) * 0.5
}

/// Cauchy stress `sigma = P Fᵀ / J` \[Pa\]; through the thickness `P33/J` in plane strain and 0 in plane stress.
#[derive(Clone, Copy)]
struct CauchyStress<R> {
    x: R,
    y: R,
    xy: R,
    thickness: R,
}

impl<R: Real> CauchyStress<R> {
    #[inline(always)]
    fn of<M: Material>(material: &M, f: Mat2<R>, plane_stress: bool) -> Self {
        let thickness = if plane_stress { f.m11.of(0.0) } else { material.thickness_stress(f) };
        Self::new(f, material.piola(f), thickness)
    }

    /// From F, P and P33.
    #[inline(always)]
    fn new(f: Mat2<R>, piola: Mat2<R>, thickness: R) -> Self {
        let j = f.determinant();
        let sigma = piola.times(f.transpose());
        Self { x: sigma.m11 / j, y: sigma.m22 / j, xy: (sigma.m12 + sigma.m21) / j * 0.5, thickness: thickness / j }
    }

    /// Equivalent by von Mises: `sqrt(((sx - sy)² + (sy - sz)² + (sz - sx)²)/2 + 3 sxy²)`.
    #[inline(always)]
    fn von_mises(self) -> R {
        let Self { x, y, xy, thickness } = self;
        let differences = (x - y) * (x - y) + (y - thickness) * (y - thickness) + (thickness - x) * (thickness - x);
        (differences * 0.5 + xy * xy * 3.0).sqrt()
    }

    /// `-(sx + sy + sz)/3`.
    #[inline(always)]
    fn pressure(self) -> R {
        (self.x + self.y + self.thickness) * (-1.0 / 3.0)
    }

    /// The greater principal stress in the plane: `(sx + sy)/2 + sqrt(((sx - sy)/2)² + sxy²)`.
    #[inline(always)]
    fn greatest(self) -> R {
        let half = (self.x - self.y) * 0.5;
        (self.x + self.y) * 0.5 + (half * half + self.xy * self.xy).sqrt()
    }
}

/// Field that triangles are coloured by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Field {
    /// Plain gingerbread.
    #[default]
    None,
    /// Elastic energy density psi [J/m²].
    EnergyDensity,
    /// Von Mises equivalent of the Cauchy stress \[Pa\].
    VonMises,
    /// J = det F: area over rest area.
    Volume,
    /// Greater principal stretch.
    Stretch,
    /// Greater principal Cauchy stress in the plane \[Pa\].
    PrincipalStress,
    /// Pressure: minus the mean of the principal Cauchy stresses \[Pa\].
    Pressure,
    /// Mean speed of the corners [m/s].
    Speed,
    /// Mean displacement of the corners from the start \[m\].
    Displacement,
    /// Share of a triangle in the estimated square of the error of the stress \[%\].
    StressError,
}

impl Field {
    /// All of them, in the order of the menu.
    pub const ALL: [Self; 10] = [
        Self::None,
        Self::EnergyDensity,
        Self::VonMises,
        Self::Volume,
        Self::Stretch,
        Self::PrincipalStress,
        Self::Pressure,
        Self::Speed,
        Self::Displacement,
        Self::StressError,
    ];

    /// Name in the menu.
    pub const fn title(self) -> &'static str {
        match self {
            Self::None => "Gingerbread",
            Self::EnergyDensity => "Energy density",
            Self::VonMises => "Von Mises stress",
            Self::Volume => "Area ratio J",
            Self::Stretch => "Principal stretch",
            Self::PrincipalStress => "Principal stress",
            Self::Pressure => "Pressure",
            Self::Speed => "Speed",
            Self::Displacement => "Displacement",
            Self::StressError => "Stress error",
        }
    }

    /// Unit symbol.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::None | Self::Volume | Self::Stretch => "",
            Self::EnergyDensity => "J/m²",
            Self::VonMises | Self::PrincipalStress | Self::Pressure => "Pa",
            Self::Speed => "m/s",
            Self::Displacement => "m",
            Self::StressError => "%",
        }
    }

    /// Value at rest.
    pub const fn rest(self) -> f64 {
        match self {
            Self::Volume | Self::Stretch => 1.0,
            _ => 0.0,
        }
    }

    /// Whether values lie on both sides of that at rest.
    pub const fn is_signed(self) -> bool {
        matches!(self, Self::Volume | Self::Stretch | Self::PrincipalStress | Self::Pressure)
    }

    /// Whether it follows from the deformation gradients and the material alone.
    pub const fn is_of_triangles(self) -> bool {
        !matches!(self, Self::None | Self::Speed | Self::Displacement | Self::StressError)
    }
}

impl Triangles {
    /// Energy density and stress at the centroid of a triangle, at these positions \[m\].
    pub fn point_stress(&self, x: &[f64], number: usize) -> PointStress {
        self.material().passes().point_stress(self, x, number)
    }

    /// The same for a material of known type.
    pub(super) fn point_stress_as(&self, material: &impl Material, x: &[f64], number: usize) -> PointStress {
        let is_plane_stress = self.material().plane().is_stress();
        let Some(six) = self.six_nodes() else {
            return PointStress::of(material, &self.gradient_of(x, number), is_plane_stress);
        };
        let elastic = Elastic(*material);
        let points = six.points(x, number / POINTS, six.elastic(&elastic, volume_of(material)), is_plane_stress);
        points[number % POINTS].1
    }

    /// det F of each triangle.
    pub fn volume_ratios(&self, x: &[f64]) -> impl Iterator<Item = f64> {
        self.gradients(x).map(|(f, _)| f.determinant())
    }
}

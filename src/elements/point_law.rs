//! Laws of materials at the points of elements of six nodes, for eight elements at a time.

use super::{
    blocks::{EnergyLaw, StressLaw, load, store},
    tangent::Isotropic,
};
use crate::{
    materials::{Moduli, Parts, VolumeMeasure},
    simd::{Lanes, Mat2, Wide},
};
use pulp::{Arch, Simd, WithSimd};

/// Number of points of an element.
pub const POINTS: usize = 4;

/// Matrices (2 x 2) at the points of eight elements, column by column.
pub type PointMatrices = [[Lanes; 4]; POINTS];

/// The measure of volume at the points of eight elements, and its mean over them.
pub type Measures = [Lanes; POINTS + 1];

/// An energy density at the points. Each method is compiled once for each material; what elements do with it is common to all.
pub trait PointLaw: Sync {
    /// The first Piola-Kirchhoff stresses \[Pa\].
    fn stresses(&self, set: Arch, f: &PointMatrices, out: &mut PointMatrices);

    /// The energy densities \[J/m³\].
    fn energies(&self, set: Arch, f: &PointMatrices, out: &mut [Lanes; POINTS]);

    /// The changes of the stresses with a change of F \[Pa\], with these second derivatives added.
    fn changes(&self, set: Arch, moving: [&PointMatrices; 2], added: Option<&Added>, out: &mut PointMatrices);

    /// U, U' and U'' of each of these measures: see [`Material::volumetric`](crate::materials::Material::volumetric).
    fn volumetric(&self, set: Arch, measures: &Measures) -> [[Lanes; 3]; POINTS + 1];

    /// The second derivative at one F \[Pa\].
    fn moduli(&self, f: Mat2<f64>) -> Moduli<f64>;

    /// The stress through the thickness in plane strain at one F, P33 \[Pa\].
    fn thickness_stress(&self, f: Mat2<f64>) -> f64;
}

/// Second derivatives of a measure at each point, times a factor, and the squares of its first ones, times another: see
/// [`VolumeMeasure::moduli`].
#[derive(Debug)]
pub struct Added {
    pub measure: VolumeMeasure,
    pub factors: [[Lanes; 2]; POINTS],
}

impl<L: EnergyLaw + Isotropic> PointLaw for L {
    fn stresses(&self, set: Arch, f: &PointMatrices, out: &mut PointMatrices) {
        set.dispatch(Stresses { law: *self, f, rate: f, out });
    }

    fn energies(&self, set: Arch, f: &PointMatrices, out: &mut [Lanes; POINTS]) {
        set.dispatch(Energies { law: *self, f, out });
    }

    fn changes(&self, set: Arch, moving: [&PointMatrices; 2], added: Option<&Added>, out: &mut PointMatrices) {
        set.dispatch(Changes { law: *self, moving, added, out });
    }

    fn volumetric(&self, set: Arch, measures: &Measures) -> [[Lanes; 3]; POINTS + 1] {
        let mut out = [[Lanes::default(); 3]; POINTS + 1];
        set.dispatch(Volumetric { law: *self, measures, out: &mut out });
        out
    }

    fn moduli(&self, f: Mat2<f64>) -> Moduli<f64> {
        Isotropic::moduli(self, &Parts::of(f))
    }

    fn thickness_stress(&self, f: Mat2<f64>) -> f64 {
        EnergyLaw::thickness_stress(self, f)
    }
}

/// The stresses of a law of F and, if [`StressLaw::RATE`], of dF/dt.
pub(super) struct Stresses<'a, L> {
    pub law: L,
    pub f: &'a PointMatrices,
    pub rate: &'a PointMatrices,
    pub out: &'a mut PointMatrices,
}

impl<L: StressLaw> WithSimd for Stresses<'_, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) {
        for ((f, rate), out) in self.f.iter().zip(self.rate).zip(self.out) {
            for part in 0..Wide::<S>::PARTS {
                let f = load(set, f, part);
                let rate = if L::RATE { load(set, rate, part) } else { f };
                store(self.law.stress(f, rate), out, part);
            }
        }
    }
}

struct Energies<'a, L> {
    law: L,
    f: &'a PointMatrices,
    out: &'a mut [Lanes; POINTS],
}

impl<L: EnergyLaw> WithSimd for Energies<'_, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) {
        for (f, out) in self.f.iter().zip(self.out) {
            for part in 0..Wide::<S>::PARTS {
                self.law.energy(load(set, f, part)).store(out, part);
            }
        }
    }
}

struct Changes<'a, L> {
    law: L,
    moving: [&'a PointMatrices; 2],
    added: Option<&'a Added>,
    out: &'a mut PointMatrices,
}

impl<L: Isotropic> WithSimd for Changes<'_, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) {
        let Self { law, moving: [f, changes], added, out } = self;
        for point in 0..POINTS {
            for part in 0..Wide::<S>::PARTS {
                let parts = Parts::of(load(set, &f[point], part));
                let mut moduli = law.moduli(&parts);
                if let Some(Added { measure, factors }) = added {
                    let [second, square] = &factors[point];
                    let factors = [Wide::load(set, second, part), Wide::load(set, square, part)];
                    moduli = moduli.plus(measure.moduli(&parts, factors));
                }
                store(moduli.change(&parts, load(set, &changes[point], part)), &mut out[point], part);
            }
        }
    }
}

struct Volumetric<'a, L> {
    law: L,
    measures: &'a Measures,
    out: &'a mut [[Lanes; 3]; POINTS + 1],
}

impl<L: EnergyLaw> WithSimd for Volumetric<'_, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) {
        for (measure, out) in self.measures.iter().zip(self.out) {
            for part in 0..Wide::<S>::PARTS {
                let of = self.law.volumetric(Wide::load(set, measure, part));
                for (value, out) in of.into_iter().zip(out.iter_mut()) {
                    value.store(out, part);
                }
            }
        }
    }
}

/// The measure at each point, and its mean with these weights.
pub(super) struct Measured<'a> {
    pub measure: VolumeMeasure,
    pub weights: &'a [f64; POINTS],
    pub f: &'a PointMatrices,
}

impl WithSimd for Measured<'_> {
    type Output = Measures;

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) -> Measures {
        let mut all = Measures::default();
        for part in 0..Wide::<S>::PARTS {
            let mut mean = Wide::all(set, 0.0);
            for ((f, weight), out) in self.f.iter().zip(self.weights).zip(&mut all) {
                let measure = self.measure.of(load(set, f, part));
                measure.store(out, part);
                mean = mean + measure * *weight;
            }
            mean.store(&mut all[POINTS], part);
        }
        all
    }
}

/// Adds the derivatives of the measure by F, times a factor at each point.
pub(super) struct AddGradients<'a> {
    pub measure: VolumeMeasure,
    pub f: &'a PointMatrices,
    pub factors: &'a [Lanes; POINTS],
    pub out: &'a mut PointMatrices,
}

impl WithSimd for AddGradients<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) {
        for ((f, factor), out) in self.f.iter().zip(self.factors).zip(self.out) {
            for part in 0..Wide::<S>::PARTS {
                let added = self.measure.gradient(load(set, f, part)) * Wide::load(set, factor, part);
                store(load(set, out, part) + added, out, part);
            }
        }
    }
}

/// The weighted sum over the points of `(dm/dF) : dF`.
pub(super) struct MeanChange<'a> {
    pub measure: VolumeMeasure,
    pub weights: &'a [f64; POINTS],
    pub moving: [&'a PointMatrices; 2],
}

impl WithSimd for MeanChange<'_> {
    type Output = Lanes;

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) -> Lanes {
        let (mut all, [f, change]) = (Lanes::default(), self.moving);
        for part in 0..Wide::<S>::PARTS {
            let mut mean = Wide::all(set, 0.0);
            for point in 0..POINTS {
                let gradient = self.measure.gradient(load(set, &f[point], part));
                mean = mean + gradient.dot(load(set, &change[point], part)) * self.weights[point];
            }
            mean.store(&mut all, part);
        }
        all
    }
}

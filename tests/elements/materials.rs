//! Facts about constitutive models, for every registered one.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{Random, rotation};
use gingerbread::{
    materials::{Hencky, Lame, Material, MaterialParameters, Model, Plane, Principal, PrincipalEnergy, Visitor},
    quantity::{Poisson, Young},
    simd::{Mat2, Real},
};
use nalgebra::{Matrix2, Matrix4, Vector4};

const LAME: Lame = Lame { mu: 0.7, lambda: 1.1 };

/// A check of one model.
struct Check(fn(&dyn Probe));

/// A material without its type.
trait Probe {
    fn title(&self) -> &'static str;
    fn energy(&self, f: &Matrix2<f64>) -> f64;
    fn stress(&self, f: &Matrix2<f64>) -> Matrix2<f64>;
    fn stiffness(&self, f: &Matrix2<f64>) -> Matrix4<f64>;
    fn free_width(&self, stretch: f64) -> Option<f64>;
    fn has_barrier(&self) -> bool;
}

impl<M: Material> Probe for M {
    fn title(&self) -> &'static str {
        M::TITLE
    }
    fn has_barrier(&self) -> bool {
        M::BARRIER
    }
    fn energy(&self, f: &Matrix2<f64>) -> f64 {
        Material::energy(self, f)
    }
    fn stress(&self, f: &Matrix2<f64>) -> Matrix2<f64> {
        Material::stress(self, f)
    }
    fn stiffness(&self, f: &Matrix2<f64>) -> Matrix4<f64> {
        Material::stiffness(self, f)
    }
    fn free_width(&self, stretch: f64) -> Option<f64> {
        Material::free_width(self, stretch)
    }
}

impl Visitor for Check {
    type Output = ();
    fn visit<M: Material>(self, material: &M) {
        self.0(material);
    }
}

fn for_every_model(check: fn(&dyn Probe)) {
    for &model in Model::ALL {
        model.visit(LAME, Check(check));
    }
    // The same LAME is that of plane stress here.
    for model in SHEETS {
        model.visit_in(Plane::StressExact, LAME, Check(check));
    }
    check(&Principal(Logarithmic(LAME)));
}

/// Hencky's energy, from which stress and stiffness are derived by differentiation.
#[derive(Clone, Copy)]
struct Logarithmic(Lame);

impl PrincipalEnergy for Logarithmic {
    const TITLE: &'static str = "Logarithmic";
    const BARRIER: bool = true;

    fn psi<R: Real>(&self, stretches: [R; 3]) -> R {
        let [a, b, c] = stretches.map(Real::logarithm);
        (a * a + b * b + c * c) * self.0.mu + (a + b + c) * (a + b + c) * (0.5 * self.0.lambda)
    }
}

#[test]
fn differentiated_energy_matches_written_formulas() {
    let (own, listed) = (Principal(Logarithmic(LAME)), Hencky::new(LAME));
    let mut random = Random(8);
    for number in 0..300 {
        // Near a rotation too, where both stretches are equal.
        let size = if number % 3 == 0 { 1e-7 } else { 0.5 };
        let f = crate::common::rotation(f64::from(number)) * (Matrix2::identity() + random.gradient(-1.0, 1.0) * size);
        if listed.is_continued(&f) {
            continue;
        }
        let near = |found: f64, expected: f64, size: f64| {
            assert!((found - expected).abs() <= 1e-9 * size, "{found:e} is not {expected:e} at {f}");
        };
        let energies = [Material::energy(&own, &f), Material::energy(&listed, &f)];
        near(energies[0], energies[1], 1.0 + energies[1]);
        let stiffness = Material::stiffness(&listed, &f);
        let size = stiffness.norm();
        near((Material::stress(&own, &f) - Material::stress(&listed, &f)).norm(), 0.0, size);
        near((Material::stiffness(&own, &f) - stiffness).norm(), 0.0, size);
        let thickness = |of: f64, expected: f64| near(of, expected, size);
        thickness(own.thickness_stress(Mat2::from(&f)), listed.thickness_stress(Mat2::from(&f)));
    }
    for stretch in [0.4, 1.0, 2.2] {
        let [own, listed] = [Material::free_width(&own, stretch), Material::free_width(&listed, stretch)];
        assert!((own.unwrap() - listed.unwrap()).abs() < 1e-12);
    }
}

/// The models whose thickness has to be solved for in plane stress.
const SHEETS: [Model; 2] = [Model::NeoHookean, Model::FixedCorotated];

/// The least error of central differences over a sweep of steps: truncation falls and round-off grows with smaller ones.
fn best_difference<const N: usize>(exact: [f64; N], along: impl Fn(f64) -> [f64; N], scale: f64) -> f64 {
    let error = |epsilon: f64| {
        let (ahead, behind) = (along(epsilon), along(-epsilon));
        let errors = (0..N).map(|i| ((ahead[i] - behind[i]) / (2.0 * epsilon) - exact[i]).abs());
        // NaN counts as infinite.
        errors.fold(0.0, |most: f64, error| {
            if error <= most {
                most
            } else if error.is_nan() {
                f64::INFINITY
            } else {
                error
            }
        }) / scale
    };
    (6..=14).map(|power| error(10.0_f64.powf(-0.5 * f64::from(power)))).fold(f64::INFINITY, f64::min)
}

fn moved(f: &Matrix2<f64>, entry: usize, by: f64) -> Matrix2<f64> {
    let mut f = *f;
    f.as_mut_slice()[entry] += by;
    f
}

#[test]
fn stress_is_the_derivative_of_energy() {
    for_every_model(|material| {
        let mut random = Random(1);
        for _ in 0..1000 {
            let f = random.gradient(0.2, 5.0);
            let stress = material.stress(&f);
            for entry in 0..4 {
                let along = |by: f64| [material.energy(&moved(&f, entry, by))];
                let error = best_difference([stress.as_slice()[entry]], along, stress.norm().max(1.0));
                assert!(error < 1e-8, "{} at {f}: {error:e}", material.title());
            }
        }
    });
}

#[test]
fn stiffness_is_the_derivative_of_stress_and_symmetric() {
    for_every_model(|material| {
        let mut random = Random(2);
        for _ in 0..1000 {
            let f = random.gradient(0.2, 5.0);
            let stiffness = material.stiffness(&f);
            let scale = stiffness.norm().max(1.0);
            assert!((stiffness - stiffness.transpose()).norm() < 1e-13 * scale, "{}", material.title());
            for entry in 0..4 {
                let exact: [f64; 4] = stiffness.column(entry).into_owned().into();
                let along =
                    |by: f64| Vector4::from_column_slice(material.stress(&moved(&f, entry, by)).as_slice()).into();
                let error = best_difference(exact, along, scale);
                assert!(error < 1e-8, "{} at {f}: {error:e}", material.title());
            }
        }
    });
}

#[test]
fn turning_the_body_turns_the_stress() {
    for_every_model(|material| {
        let mut random = Random(3);
        for _ in 0..1000 {
            let (f, q) = (random.gradient(0.2, 5.0), rotation(random.between(0.0, 7.0)));
            let difference = material.stress(&(q * f)) - q * material.stress(&f);
            assert!(difference.norm() < 1e-12 * (1.0 + material.stress(&f).norm()), "{}", material.title());
            assert!((material.energy(&(q * f)) - material.energy(&f)).abs() < 1e-12 * (1.0 + material.energy(&f)));
        }
    });
}

#[test]
fn rest_has_no_energy_and_no_stress_however_it_is_turned() {
    for_every_model(|material| {
        for degrees in (0..360).step_by(15) {
            let q = rotation(f64::from(degrees).to_radians());
            assert!(material.energy(&q).abs() < 1e-15, "{}", material.title());
            assert!(material.stress(&q).norm() < 1e-14, "{}", material.title());
        }
        assert_eq!(material.stress(&Matrix2::identity()), Matrix2::zeros(), "{}", material.title());
    });
}

#[test]
fn small_strains_obey_hookes_law() {
    let hooke = |e: &Matrix2<f64>| e * (2.0 * LAME.mu) + Matrix2::identity() * (LAME.lambda * e.trace());
    let expected = Matrix4::from_fn(|i, j| {
        let mut unit = Matrix2::zeros();
        unit.as_mut_slice()[j] = 1.0;
        hooke(&((unit + unit.transpose()) * 0.5)).as_slice()[i]
    });
    model_stiffness_at_rest(|title, stiffness| {
        assert!((stiffness - expected).norm() < 1e-14, "{title}: {stiffness}");
    });
}

fn model_stiffness_at_rest(check: impl Fn(&'static str, Matrix4<f64>)) {
    struct AtRest;
    impl Visitor for AtRest {
        type Output = (&'static str, Matrix4<f64>);
        fn visit<M: Material>(self, material: &M) -> Self::Output {
            (M::TITLE, Material::stiffness(material, &Matrix2::identity()))
        }
    }
    for &model in Model::ALL {
        let (title, stiffness) = model.visit(LAME, AtRest);
        check(title, stiffness);
    }
    for model in SHEETS {
        let (title, stiffness) = model.visit_in(Plane::StressExact, LAME, AtRest);
        check(title, stiffness);
    }
}

/// P11 of a strip stretched by s whose sides are held at width 1, written out by hand for each model.
#[test]
fn a_clamped_strip_pulls_as_its_closed_form_says() {
    let Lame { mu, lambda } = LAME;
    for s in [0.6_f64, 2.0] {
        let expected = [
            ("Corotated", (2.0 * mu + lambda) * (s - 1.0)),
            ("St. Venant-Kirchhoff", (mu + 0.5 * lambda) * s * (s * s - 1.0)),
            ("Neo-Hookean", mu * (s - 1.0 / s) + lambda * s.ln() / s),
            ("Stable neo-Hookean", stable_pull(s, 1.0)),
            ("Fixed corotated", (2.0 * mu + lambda) * (s - 1.0)),
            ("Hencky", (2.0 * mu + lambda) * s.ln() / s),
        ];
        check_strip(s, 1.0, &expected);
    }
}

/// P11 of the stable neo-Hookean model at diag(s, w), as Smith, de Goes and Kim write it.
fn stable_pull(s: f64, w: f64) -> f64 {
    let (m, l) = (1.5 * LAME.mu, LAME.lambda + 2.0 / 3.0 * LAME.mu);
    let a = 1.0 + 2.0 / 3.0 * m / l;
    m * (1.0 - 1.0 / (s * s + w * w + 1.0)) * s + l * (s * w - a) * w
}

/// P11 and the width of a strip stretched by s whose sides are free.
#[test]
fn a_free_strip_narrows_and_pulls_as_its_closed_form_says() {
    let Lame { mu, lambda } = LAME;
    let ratio = lambda / (2.0 * mu + lambda);
    let corotated = |s: f64| 1.0 - ratio * (s - 1.0);
    let kirchhoff = |s: f64| (1.0 - ratio * (s * s - 1.0)).sqrt();
    let neo_hookean = |s: f64| root(&|w| mu * (w * w - 1.0) + lambda * (s * w).ln());
    // P22 is P11 with s and w exchanged.
    let stable = |s: f64| root(&|w| stable_pull(w, s));
    let fixed = |s: f64| (2.0 * mu + lambda * s) / (2.0 * mu + lambda * s * s);
    let young_of = 4.0 * mu * (mu + lambda) / (2.0 * mu + lambda);
    for s in [0.6_f64, 1.4] {
        check_strip(s, corotated(s), &[("Corotated", young_of * (s - 1.0))]);
        check_strip(s, kirchhoff(s), &[("St. Venant-Kirchhoff", 0.5 * young_of * s * (s * s - 1.0))]);
    }
    check_strip(2.0, corotated(2.0), &[("Corotated", young_of)]);
    for s in [0.6_f64, 2.0] {
        let w = neo_hookean(s);
        check_strip(s, w, &[("Neo-Hookean", mu * (s - 1.0 / s) + lambda * (s * w).ln() / s)]);
        let w = stable(s);
        check_strip(s, w, &[("Stable neo-Hookean", stable_pull(s, w))]);
        let w = fixed(s);
        check_strip(s, w, &[("Fixed corotated", 2.0 * mu * (s - 1.0) + lambda * (s * w - 1.0) * w)]);
        // As in Hooke's law, with logarithmic strain: ln w = -ratio ln s, and the force per present width is E ln s.
        check_strip(s, s.powf(-ratio), &[("Hencky", young_of * s.ln() / s)]);
    }
    for_every_model(|material| {
        for s in [0.6, 1.0, 1.4] {
            let width = material.free_width(s).unwrap();
            let side = material.stress(&Matrix2::new(s, 0.0, 0.0, width)).m22;
            assert!(side.abs() < 1e-12, "{} at {s}: {side:e}", material.title());
        }
    });
}

/// The root of a growing function of a width, by bisection.
fn root(function: &dyn Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (1e-6_f64, 10.0_f64);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if function(middle) > 0.0 { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

fn check_strip(stretch: f64, width: f64, expected: &[(&str, f64)]) {
    struct Pull(f64, f64);
    impl Visitor for Pull {
        type Output = f64;
        fn visit<M: Material>(self, material: &M) -> f64 {
            Material::stress(material, &Matrix2::new(self.0, 0.0, 0.0, self.1)).m11
        }
    }
    for (title, force) in expected {
        let model = Model::ALL.iter().find(|model| model.title() == *title).unwrap();
        let pull = model.visit(LAME, Pull(stretch, width));
        assert!((pull - force).abs() < 1e-10 * force.abs().max(1.0), "{title} at {stretch}: {pull} against {force}");
    }
}

/// The energy in three dimensions, least over the thickness stretch t: found by trying, with lambda of three dimensions.
#[test]
fn exact_plane_stress_is_the_least_energy_over_the_thickness() {
    let Lame { mu, lambda } = LAME;
    let lambda = 2.0 * mu * lambda / (2.0 * mu - lambda);
    let least = |energy: &dyn Fn(f64) -> f64| {
        let (mut low, mut high) = (1e-3_f64, 30.0_f64);
        for _ in 0..200 {
            let [a, b] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
            if energy(a) < energy(b) { high = b } else { low = a }
        }
        energy(0.5 * (low + high))
    };
    let mut random = Random(8);
    for _ in 0..300 {
        let f = random.gradient(0.12, 9.0);
        let (square, j) = (f.norm_squared(), f.determinant());
        let rubber = least(&|t| {
            let log = (j * t).ln();
            0.5 * mu * (square + t * t - 3.0) - mu * log + 0.5 * lambda * log * log
        });
        let trace = (f.m11 + f.m22).hypot(f.m21 - f.m12);
        let fixed = least(&|t| {
            mu * (square - 2.0 * trace + 2.0 + (t - 1.0) * (t - 1.0)) + 0.5 * lambda * (j * t - 1.0) * (j * t - 1.0)
        });
        for (model, expected) in [(Model::NeoHookean, rubber), (Model::FixedCorotated, fixed)] {
            let found = model.visit_in(Plane::StressExact, LAME, EnergyOf(f));
            assert!((found - expected).abs() < 1e-11 * expected.max(1.0), "{model:?} at {f}: {found} not {expected}");
        }
    }
}

/// This is in exact plane stress.
/// Where the volume cannot change, a strip pulled to twice its length is 1/sqrt(2) times as wide and as thick; the lambda of Hooke's
/// law alone leaves it 0.6621 times as wide.
#[test]
fn an_incompressible_strip_keeps_its_volume() {
    struct Width(f64);
    impl Visitor for Width {
        type Output = f64;
        fn visit<M: Material>(self, material: &M) -> f64 {
            material.free_width(self.0).unwrap()
        }
    }
    for (nu, tolerance) in [(0.4999, 1e-3), (0.5, 1e-12)] {
        for model in SHEETS {
            for stretch in [0.5_f64, 0.8, 1.0, 2.0, 3.0] {
                let lame = of(model, 1e3, nu, Plane::StressExact).unwrap().lame();
                let width = model.visit_in(Plane::StressExact, lame, Width(stretch));
                assert!((width - stretch.sqrt().recip()).abs() < tolerance, "{model:?} {nu} {stretch}: {width}");
            }
        }
    }
    let lame = of(Model::NeoHookean, 1e3, 0.5, Plane::Stress).unwrap().lame();
    assert!((Model::NeoHookean.visit_in(Plane::Stress, lame, Width(2.0)) - 0.6621).abs() < 1e-4);
}

/// Over all of nu and a wide range of stretches the thickness is found: the force on a strip is smooth and finite.
#[test]
fn the_thickness_is_found_for_every_ratio_and_stretch() {
    for nu in [0.0, 1e-6, 0.05, 0.2, 0.35, 0.45, 0.499, 0.5] {
        let lame = of(Model::NeoHookean, 1.0, nu, Plane::StressExact).unwrap().lame();
        for step in 0..107 {
            let s = 0.1 * 1.06_f64.powi(step);
            let stress = Model::NeoHookean.visit_in(Plane::StressExact, lame, StressOf(Matrix2::new(s, 0.0, 0.0, 1.0)));
            // P11 = mu (s - T/s) with T from a ln T + b (T - 1) + 2 a ln s = 0.
            let (a, square) = ((nu / (1.0 - nu)).min(1.0), (s - stress.m11 / lame.mu) * s);
            let residual = a * square.ln() + (1.0 - a) * (square - 1.0) + 2.0 * a * s.ln();
            let slope = a / square + 1.0 - a;
            // T is a difference here, of which s² is lost.
            assert!(residual.abs() < 1e-13 * (1.0 + slope * (square + s * s)), "{nu} {s}: {residual:e}");
        }
    }
}

#[test]
fn exact_plane_stress_is_plane_stress_where_that_is_exact() {
    for model in [Model::Corotated, Model::StVenantKirchhoff, Model::Hencky] {
        let mut random = Random(9);
        for nu in [-0.5, 0.0, 0.3, 0.5] {
            let [exact, linear] = [Plane::StressExact, Plane::Stress].map(|plane| of(model, 1e3, nu, plane).unwrap());
            assert_eq!(exact.lame(), linear.lame());
            let f = random.gradient(0.2, 5.0);
            let stress = |plane| model.visit_in(plane, linear.lame(), StressOf(f));
            assert_eq!(stress(Plane::StressExact), stress(Plane::Stress), "{model:?}");
        }
    }
}

#[test]
fn exact_plane_stress_is_refused_in_words_where_there_is_none() {
    let why = of(Model::StableNeoHookean, 1e3, 0.3, Plane::StressExact).unwrap_err();
    assert!(
        why.contains("Stable neo-Hookean has no exact plane stress") && why.contains("Choose plane stress"),
        "{why}"
    );
    for model in SHEETS {
        let why = of(model, 1e3, -0.1, Plane::StressExact).unwrap_err();
        assert!(why.contains("at least 0 and at most 0.5, got -0.1"), "{why}");
    }
    let rubber = of(Model::NeoHookean, 1e3, 0.3, Plane::StressExact).unwrap();
    assert!(rubber.try_with_model(Model::StableNeoHookean).is_err());
    assert_eq!(rubber.with_model(Model::StableNeoHookean).plane(), Plane::Stress);
    assert_eq!(rubber.with_model(Model::FixedCorotated).plane(), Plane::StressExact);
}

fn of(model: Model, young: f64, nu: f64, plane: Plane) -> Result<MaterialParameters, String> {
    let (young, poisson) = (Young::new(young).unwrap(), Poisson::new(nu).unwrap());
    MaterialParameters::new(model, young, poisson, plane).map_err(|error| error.to_string())
}

/// Pressed, flat and turned over, for the models that are defined there: the height is pushed to grow.
#[test]
fn a_model_defined_for_inverted_triangles_pushes_them_back() {
    for model in [Model::NeoHookean, Model::StableNeoHookean, Model::FixedCorotated, Model::Hencky] {
        for height in [-1.5, -1.0, -0.1, 0.0, 0.1] {
            for width in [0.3, 1.0] {
                let f = Matrix2::new(width, 0.0, 0.0, height);
                let stress = model.visit(LAME, StressOf(f));
                assert!(stress.m22 < -0.1, "{model:?} at {width} x {height}: {stress}");
                let stress = model.visit_in(Plane::StressExact, LAME, StressOf(f));
                assert!(stress.m22 < -0.1, "{model:?} in exact plane stress at {width} x {height}: {stress}");
            }
        }
        let folded = model.visit(LAME, StressOf(Matrix2::new(1e-9, 0.0, 0.0, 1e-9)));
        assert!(folded.iter().all(|entry| entry.is_finite()), "{model:?}");
    }
}

/// A model that is defined for every gradient has derivatives there and no jump.
/// Also where they are pressed flat, and where the neo-Hookean energy and that of Hencky are continued.
#[test]
fn derivatives_also_hold_for_inverted_triangles() {
    for_every_model(|material| {
        let is_undefined = material.energy(&Matrix2::new(1.0, 0.0, 0.0, -1.0)).is_nan();
        assert!(!is_undefined || material.has_barrier(), "{}", material.title());
        if is_undefined || material.title() == "Corotated" {
            return;
        }
        let mut random = Random(5);
        for _ in 0..1000 {
            let f = random.gradient(-5.0, 0.2);
            // Where a reflection is all there is, corotated frames jump.
            if (f.m11 + f.m22).hypot(f.m21 - f.m12) < 0.3 {
                continue;
            }
            let (stress, stiffness) = (material.stress(&f), material.stiffness(&f));
            let (stress_scale, scale) = (stress.norm().max(1.0), stiffness.norm().max(1.0));
            for entry in 0..4 {
                let along = |by: f64| [material.energy(&moved(&f, entry, by))];
                let error = best_difference([stress.as_slice()[entry]], along, stress_scale);
                assert!(error < 1e-8, "{} at {f}: {error:e}", material.title());
                let exact: [f64; 4] = stiffness.column(entry).into_owned().into();
                let along =
                    |by: f64| Vector4::from_column_slice(material.stress(&moved(&f, entry, by)).as_slice()).into();
                let error = best_difference(exact, along, scale);
                assert!(error < 1e-7, "{} at {f}: {error:e}", material.title());
            }
        }
        for width in [0.2, 1.0, 3.0] {
            let at = |j: f64| Matrix2::new(width, 0.3, 0.0, j / width);
            let (under, over) = (at(0.1 * (1.0 - 1e-9)), at(0.1 * (1.0 + 1e-9)));
            let title = material.title();
            let scale = material.stiffness(&over).norm();
            assert!((material.energy(&under) - material.energy(&over)).abs() < 1e-7 * scale, "{title}");
            assert!((material.stress(&under) - material.stress(&over)).norm() < 1e-7 * scale, "{title}");
            assert!((material.stiffness(&under) - material.stiffness(&over)).norm() < 1e-7 * scale, "{title}");
        }
    });
}

#[test]
fn neo_hookean_follows_its_logarithm_to_a_tenth_of_area() {
    let Lame { mu, lambda } = LAME;
    for j in [0.1_f64, 0.100_001, 0.5, 3.0] {
        let pull = Model::NeoHookean.visit(LAME, StressOf(Matrix2::new(1.0, 0.0, 0.0, j))).m22;
        assert!((pull - (mu * (j - 1.0 / j) + lambda * j.ln() / j)).abs() < 1e-13 * pull.abs().max(1.0), "{j}");
    }
    // Below, U'' falls from c at J = 0.1 to k at J = 0, where the force is that at 0.1 plus 0.1 (k + (c - k)/7).
    let (k, c) = (lambda + mu, 100.0 * (lambda * (1.0 - 0.1_f64.ln()) + mu));
    let flat = 10.0 * (mu - lambda * 0.1_f64.ln()) + 0.1 * k + 0.1 / 7.0 * (c - k);
    let pull = |j: f64| Model::NeoHookean.visit(LAME, StressOf(Matrix2::new(1.0, 0.0, 0.0, j))).m22;
    for j in [0.0, -0.1, -1.0, -100.0] {
        let exact = (mu + k) * j - flat;
        assert!((pull(j) - exact).abs() < 1e-12 * exact.abs(), "{j}: {} is not {exact}", pull(j));
    }
}

/// Models whose logarithm is continued below a tenth.
const CONTINUED: [Model; 2] = [Model::NeoHookean, Model::Hencky];

/// mu = 1; in plane stress lambda is at most 2 mu.
const RATIOS: [f64; 4] = [0.0, 1.0, 2.0, 50.0];

/// The width is squeezed through zero, and further inside out: the push back has no maximum on the way.
#[test]
fn the_push_back_grows_all_the_way_inside_out() {
    for (model, lambda) in CONTINUED.into_iter().flat_map(|model| RATIOS.map(|lambda| (model, lambda))) {
        for length in [0.05, 0.1, 0.3, 1.0, 3.0, 40.0] {
            let mut last = 0.0;
            for step in 0..=400 {
                let width = 0.1 * (1.0_f64).min(1.0 / length) - f64::from(step) * 0.005 * length;
                let f = rotation(0.4) * Matrix2::new(length, 0.0, 0.0, width) * rotation(1.1);
                let stress = model.visit(Lame { mu: 1.0, lambda }, StressOf(f));
                let push = -(rotation(-0.4) * stress * rotation(-1.1)).m22;
                // Beyond -length it is the shorter way to turn the length over.
                if width <= -length {
                    break;
                }
                assert!(push > last, "{model:?} {lambda}: {length} x {width} is pushed by {push} after {last}");
                last = push;
            }
        }
    }
}

/// The length is that of rest. The exact formulas have some 330 times the stiffness of rest where they are continued.
#[test]
fn stiffness_inside_out_is_some_twenty_times_that_of_rest() {
    for (model, lambda) in CONTINUED.into_iter().flat_map(|model| RATIOS.map(|lambda| (model, lambda))) {
        let mut most = 0.0_f64;
        for width in (0..100).map(|part| -0.01 * f64::from(part)) {
            let f = Matrix2::new(1.0, 0.0, 0.0, width);
            let stiffness = model.visit(Lame { mu: 1.0, lambda }, StiffnessOf(f));
            most = most.max(stiffness.symmetric_eigenvalues().max() / (2.0 + lambda));
        }
        let limit = if model == Model::NeoHookean && lambda <= 2.0 { 20.0 } else { 31.0 };
        assert!(most < limit, "{model:?} with lambda = {lambda} mu: {most} times");
    }
}

/// Least stretch s2 at a J above a tenth, and J at a length so large that s2 is below a tenth on both sides.
#[test]
fn nothing_jumps_where_hencky_is_continued() {
    for (length, width) in [(1.0, 0.1), (2.0, 0.1), (20.0, 0.1), (0.4, 0.25), (3.0, 0.1 / 3.0), (0.1, 0.1), (0.1, 0.05)]
    {
        for (before, after) in [(0.0, 0.0), (0.7, 2.9)] {
            let at = |by: f64| rotation(after) * Matrix2::new(length, 0.0, 0.0, width * (1.0 + by)) * rotation(before);
            let (under, over) = (at(-1e-9), at(1e-9));
            let stiffness = |f| Model::Hencky.visit(LAME, StiffnessOf(f));
            let stress = |f| Model::Hencky.visit(LAME, StressOf(f));
            let energy = |f| Model::Hencky.visit(LAME, EnergyOf(f));
            let scale = stiffness(over).norm();
            assert!((energy(under) - energy(over)).abs() < 1e-8 * scale, "{length} x {width}");
            assert!((stress(under) - stress(over)).norm() < 1e-7 * scale, "{length} x {width}");
            assert!((stiffness(under) - stiffness(over)).norm() < 1e-7 * scale, "{length} x {width}");
        }
    }
}

/// Pressed or pulled so far that a logarithm is continued, a strip's free sides still have no stress.
#[test]
fn a_strip_of_a_continued_model_has_free_sides() {
    struct Side(f64);
    impl Visitor for Side {
        type Output = Option<f64>;
        fn visit<M: Material>(self, material: &M) -> Self::Output {
            let f = Matrix2::new(self.0, 0.0, 0.0, material.free_width(self.0)?);
            Some(Material::stress(material, &f).m22 / Material::stiffness(material, &f).m44)
        }
    }
    for (model, lambda) in CONTINUED.into_iter().flat_map(|model| RATIOS.map(|lambda| (model, lambda))) {
        for stretch in [0.01, 0.05, 0.09, 0.2, 5.0, 12.0, 40.0] {
            let off = model.visit(Lame { mu: 1.0, lambda }, Side(stretch));
            assert!(off.is_some_and(|off| off.abs() < 1e-12), "{model:?} {lambda} at {stretch}: {off:?}");
        }
    }
}

#[test]
fn hencky_is_its_formula_where_stretches_and_area_are_a_tenth() {
    let Lame { mu, lambda } = LAME;
    let mut random = Random(21);
    for _ in 0..2000 {
        let [a, b] = [0; 2].map(|_| 10.0_f64.powf(random.between(-1.0, 1.5)));
        if a * b < 0.1 {
            continue;
        }
        let f = rotation(random.between(0.0, 7.0)) * Matrix2::new(a, 0.0, 0.0, b) * rotation(random.between(0.0, 7.0));
        let exact = mu * (a.ln().powi(2) + b.ln().powi(2)) + 0.5 * lambda * (a * b).ln().powi(2);
        let found = Model::Hencky.visit(LAME, EnergyOf(f));
        assert!((found - exact).abs() < 1e-12 * (1.0 + exact) * (a / b).max(b / a), "{a} {b}: {found} is not {exact}");
    }
}

/// Where the principal stretches are of opposite size every rotation is equally near: such a gradient is left out.
#[test]
fn an_inverted_triangle_may_be_turned() {
    for model in [Model::NeoHookean, Model::StableNeoHookean, Model::FixedCorotated, Model::Hencky] {
        let mut random = Random(22);
        for _ in 0..1000 {
            let f = random.gradient(-5.0, 0.2);
            if (f.m11 + f.m22).hypot(f.m21 - f.m12) < 0.01 {
                continue;
            }
            let [before, after] = [0; 2].map(|_| rotation(random.between(0.0, 7.0)));
            let turned = after * f * before;
            let (energy, stress) = (model.visit(LAME, EnergyOf(f)), model.visit(LAME, StressOf(f)));
            let difference = model.visit(LAME, StressOf(turned)) - after * stress * before;
            assert!(difference.norm() < 1e-11 * (1.0 + stress.norm()), "{model:?} at {f}: {difference}");
            assert!((model.visit(LAME, EnergyOf(turned)) - energy).abs() < 1e-12 * (1.0 + energy), "{model:?} at {f}");
        }
    }
}

#[test]
fn lines_and_points_have_finite_energy_stress_and_stiffness() {
    let column = Matrix2::new(1.0, 0.0, 0.5, 0.0);
    let flat =
        [Matrix2::zeros(), column, column.transpose(), Matrix2::from_element(1e-3), Matrix2::new(3.0, -6.0, -1.0, 2.0)];
    let small =
        [Matrix2::new(1e-300, 0.0, 0.0, 1e-300), Matrix2::new(0.0, 1e-9, 1e-9, 0.0), Matrix2::new(1.0, 0.0, 0.0, -1.0)];
    for model in Model::ALL {
        for f in flat.into_iter().chain(small) {
            for plane in [Plane::Strain, Plane::StressExact] {
                assert!(model.visit_in(plane, LAME, EnergyOf(f)).is_finite(), "{model:?} at {f}");
                assert!(
                    model.visit_in(plane, LAME, StressOf(f)).iter().all(|entry| entry.is_finite()),
                    "{model:?} at {f}"
                );
                let stiffness = model.visit_in(plane, LAME, StiffnessOf(f));
                assert!(stiffness.iter().all(|entry| entry.is_finite()), "{model:?} at {f}: {stiffness}");
            }
        }
    }
}

/// However far it is inside out: a stiffness that grew with the distance would leave Newton's method no way back.
#[test]
fn inverted_neo_hookean_energy_is_quadratic_in_area() {
    let energy = |j: f64| Model::NeoHookean.visit(LAME, EnergyOf(Matrix2::new(j, 0.0, 0.0, 1.0)));
    for j in [-1e4, -1e6, -1e9] {
        assert!((energy(2.0 * j) / energy(j) - 4.0).abs() < 1e-2, "{j}: {}", energy(2.0 * j) / energy(j));
    }
}

/// Its frame is a rotation.
#[test]
fn an_inverted_corotated_triangle_is_pushed_back() {
    let mut random = Random(4);
    for _ in 0..1000 {
        let f = random.gradient(-5.0, -0.01);
        let (r, trace) = gingerbread::materials::nearest_rotation(gingerbread::simd::Mat2::from(&f));
        let r = Matrix2::from(r);
        assert!((r.determinant() - 1.0).abs() < 1e-14);
        assert!(((r.transpose() * f).trace() - trace).abs() < 1e-13);
        let stress = Model::Corotated.visit(LAME, StressOf(f));
        assert!(stress.norm() > 1e-3, "a mirrored triangle must not be at rest");
    }
}

struct EnergyOf(Matrix2<f64>);

impl Visitor for EnergyOf {
    type Output = f64;
    fn visit<M: Material>(self, material: &M) -> f64 {
        Material::energy(material, &self.0)
    }
}

struct StiffnessOf(Matrix2<f64>);

impl Visitor for StiffnessOf {
    type Output = Matrix4<f64>;
    fn visit<M: Material>(self, material: &M) -> Matrix4<f64> {
        Material::stiffness(material, &self.0)
    }
}

struct StressOf(Matrix2<f64>);

impl Visitor for StressOf {
    type Output = Matrix2<f64>;
    fn visit<M: Material>(self, material: &M) -> Matrix2<f64> {
        Material::stress(material, &self.0)
    }
}

fn parameters(young: f64, nu: f64, plane: Plane) -> Result<MaterialParameters, String> {
    let young = Young::new(young).map_err(|error| error.to_string())?;
    let poisson = Poisson::new(nu).map_err(|error| error.to_string())?;
    MaterialParameters::new(Model::Corotated, young, poisson, plane).map_err(|error| error.to_string())
}

#[test]
fn lame_parameters_give_back_young_and_poisson() {
    for nu in [-0.5, 0.0, 0.3, 0.49] {
        let Lame { mu, lambda } = parameters(200.0, nu, Plane::Strain).unwrap().lame();
        assert!((mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu) - 200.0).abs() < 1e-9);
        assert!((0.5 * lambda / (lambda + mu) - nu).abs() < 1e-12);
        // In plane stress a strip with free sides has exactly E and nu.
        let Lame { mu, lambda } = parameters(200.0, nu, Plane::Stress).unwrap().lame();
        assert!((4.0 * mu * (mu + lambda) / (2.0 * mu + lambda) - 200.0).abs() < 1e-9);
        assert!((lambda / (2.0 * mu + lambda) - nu).abs() < 1e-12);
    }
}

#[test]
fn impossible_elasticity_is_refused_with_its_range() {
    for (young, nu, plane, range) in [
        (0.0, 0.3, Plane::Strain, "greater than 0 and at most 1e15 Pa"),
        (-5.0, 0.3, Plane::Stress, "greater than 0 and at most 1e15 Pa"),
        (f64::NAN, 0.3, Plane::Stress, "greater than 0 and at most 1e15 Pa"),
        (1.0, 0.5, Plane::Strain, "greater than -1 and less than 0.5"),
        (1.0, 0.51, Plane::Stress, "greater than -1 and at most 0.5"),
        (1.0, -1.0, Plane::Strain, "greater than -1 and at most 0.5"),
    ] {
        let error = parameters(young, nu, plane).unwrap_err();
        assert!(error.contains(range), "{error}");
    }
    assert!(parameters(1.0, 0.5, Plane::Stress).is_ok());
}

#[test]
fn a_model_without_an_answer_says_so() {
    let half = parameters(100.0, 0.5, Plane::Stress).unwrap().lame();
    let strip_warning = |model: Model, stretch| model.strip_warning(half, stretch);
    assert!(strip_warning(Model::StVenantKirchhoff, 2.0).unwrap().contains("width"));
    assert!(strip_warning(Model::StVenantKirchhoff, 0.57).unwrap().contains("58 %"));
    assert!(strip_warning(Model::StVenantKirchhoff, 0.6).is_none());
    assert!(strip_warning(Model::StVenantKirchhoff, 1.7).is_none());
    // nu = 0.5 in plane stress: no width from s² - 1 = 1/nu on, that is from s = sqrt(3) = 1.732.
    assert!(strip_warning(Model::StVenantKirchhoff, 1.733).is_some());
    assert!(strip_warning(Model::NeoHookean, 2.0).is_none());
    assert!(strip_warning(Model::Corotated, 2.0).is_none());
    // The force of a logarithmic strip goes as ln(s)/s: it falls from s = e on.
    assert!(strip_warning(Model::Hencky, 2.71).is_none());
    assert!(strip_warning(Model::Hencky, 2.73).unwrap().contains("gives way"));
    // Flat is no barrier for the model that takes an inverted triangle: a strip pressed far enough collapses.
    assert!(strip_warning(Model::StableNeoHookean, 0.3).is_none());
    assert!(strip_warning(Model::StableNeoHookean, 0.2).unwrap().contains("gives way"));
    assert!([0.01, 0.6, 2.0].iter().all(|&stretch| strip_warning(Model::FixedCorotated, stretch).is_none()));
    let strain = parameters(100.0, 0.25, Plane::Strain).unwrap().lame();
    // nu >= 1/s² in plane strain: from s = 2 on.
    assert!(Model::StVenantKirchhoff.strip_warning(strain, 1.999).is_none());
    assert!(Model::StVenantKirchhoff.strip_warning(strain, 2.001).is_some());
}

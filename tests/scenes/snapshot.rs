//! What the window draws from.
#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "a failing test should panic; what is computed once is equal"
)]

use crate::common::{Random, sheet};
use gingerbread::{
    command::{Command, Mode},
    files,
    materials::{Lame, Material, Model, THIN, Visitor, WHOLE},
    meshes::NoFiles,
    sandbox::Sandbox,
    simd::Mat2,
    snapshot::{Field, Snapshot},
};
use nalgebra::{Matrix2, Matrix3};

#[test]
fn a_state_is_surveyed_once_however_often_it_is_drawn() {
    let effects = "effects: [(effect: MouseSpring(stiffness: 50))]";
    let level = sheet("Corotated", "stretch: (1.2, 1)", effects);
    let mut sandbox = Sandbox::new(level, Box::new(NoFiles)).unwrap();
    let mut snapshot = Snapshot::default();
    for _ in 0..5 {
        sandbox.snapshot(Field::VonMises, &mut snapshot);
    }
    assert_eq!(snapshot.evaluations, 1, "one sweep for energies, shapes and stress");
    sandbox.snapshot(Field::None, &mut snapshot);
    assert_eq!((snapshot.evaluations, snapshot.values.len()), (2, 0), "stress is not computed where it is not shown");
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    sandbox.advance(7, &mut || true);
    sandbox.snapshot(Field::Volume, &mut snapshot);
    let (energies, (min_j, inverted)) = (sandbox.simulation().energies(), sandbox.simulation().inversion());
    assert_eq!((snapshot.energies, snapshot.min_j, snapshot.inverted), (energies, min_j, inverted));
    assert_eq!(snapshot.values.iter().copied().fold(f64::INFINITY, f64::min), min_j);
    let (sweeps, before) = (snapshot.evaluations, snapshot.energies);
    sandbox.apply(Command::Grab(0, [0.5, 0.5, 0.0])).unwrap();
    sandbox.snapshot(Field::Volume, &mut snapshot);
    assert_eq!((snapshot.evaluations, snapshot.energies), (sweeps, sandbox.simulation().energies()));
    assert!(snapshot.energies.potential > before.potential, "a pull stores energy, and moves nothing yet");
}

/// Stepping, pulling and drawing share it.
#[test]
fn elastic_energy_is_computed_once_per_shape() {
    let effects = "effects: [(effect: MouseSpring(stiffness: 50))]";
    let level = sheet("Corotated", "stretch: (1.2, 1)", effects);
    let mut sandbox = Sandbox::new(level, Box::new(NoFiles)).unwrap();
    let mut snapshot = Snapshot::default();
    sandbox.snapshot(Field::VonMises, &mut snapshot);
    let sweeps =
        |sandbox: &Sandbox, drawn: &Snapshot| sandbox.simulation().energy_evaluations() + drawn.energy_evaluations;
    assert_eq!(sweeps(&sandbox, &snapshot), 1);
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    sandbox.advance(1, &mut || true);
    sandbox.snapshot(Field::VonMises, &mut snapshot);
    assert_eq!(sweeps(&sandbox, &snapshot), 3, "the guard looks before and after the first step");
    for frame in 0..30 {
        let before = sweeps(&sandbox, &snapshot);
        // Energies before and after the hand has moved, and those that are drawn, are all of one shape.
        sandbox.apply(Command::Grab(0, [0.5, 0.01 * f64::from(frame), 0.0])).unwrap();
        sandbox.snapshot(Field::VonMises, &mut snapshot);
        assert_eq!(sweeps(&sandbox, &snapshot), before);
        sandbox.advance(1, &mut || true);
        sandbox.snapshot(Field::VonMises, &mut snapshot);
        let energies = sandbox.simulation().energies();
        assert_eq!((snapshot.energies, sweeps(&sandbox, &snapshot)), (energies, before + 1));
        let sum: f64 = snapshot.bodies.iter().map(|body| body.energy).sum();
        let anew: f64 = sandbox
            .simulation()
            .scene()
            .bodies
            .iter()
            .map(|body| body.elements.elastic_energy(&sandbox.simulation().state().x))
            .sum();
        assert_eq!((sum, energies.elastic), (anew, anew));
    }
}

/// psi, von Mises stress and J of one triangle, and whether its model is used to the letter, straight from the model.
struct SubScene(Matrix2<f64>, bool);

impl Visitor for SubScene {
    type Output = ([f64; 3], bool);
    fn visit<M: Material>(self, material: &M) -> Self::Output {
        let Self(f, plane_stress) = self;
        let j = f.determinant();
        let cauchy = material.stress(&f) * f.transpose() / j;
        let through = if plane_stress { 0.0 } else { material.thickness_stress(Mat2::from(&f)) / j };
        let deviator = Matrix3::new(cauchy.m11, cauchy.m12, 0.0, cauchy.m21, cauchy.m22, 0.0, 0.0, 0.0, through)
            - Matrix3::identity() * ((cauchy.trace() + through) / 3.0);
        ([material.energy(&f), (1.5 * deviator.norm_squared()).sqrt(), j], material.is_continued(&f))
    }
}

fn planes() -> impl Iterator<Item = (Model, &'static str)> {
    let planes = Model::ALL.iter().flat_map(|model| ["Strain", "Stress", "StressExact"].map(|plane| (*model, plane)));
    planes.filter(|planes| *planes != (Model::StableNeoHookean, "StressExact"))
}

/// This holds for every model and plane.
#[test]
fn colours_and_counts_match_single_triangles() {
    for (model, plane) in planes() {
        let text = format!(
            "(name: \"sheet\", bodies: [(name: \"sheet\", mesh: Rectangle(width: 1, height: 1, columns: 5, rows: 5, diagonals: Grid),
              mass: Density(1), material: (model: {}, young: 1000, poisson: 0.3, plane: {plane}))])",
            model.name()
        );
        let sandbox = Sandbox::new(files::parse(&text, "sheet").unwrap(), Box::new(NoFiles)).unwrap();
        let scene = sandbox.simulation().scene();
        let elements = &scene.bodies[0].elements;
        // All sizes of J from -1 to 2, none of them special.
        let x: Vec<f64> = scene.rest.iter().enumerate().map(|(i, x)| x + 0.17 * (7.3 * i as f64).sin()).collect();
        let each: Vec<_> = elements
            .gradients(&x)
            .map(|(f, area)| (elements.material().visit(SubScene(f, plane != "Strain")).unwrap(), area))
            .collect();
        for (place, field) in [Field::EnergyDensity, Field::VonMises, Field::Volume].into_iter().enumerate() {
            let mut values = Vec::new();
            let found = elements.diagnose(field, &x, &mut values);
            assert_eq!(values.len(), each.len());
            for (value, ((alone, _), _)) in values.iter().zip(&each) {
                let alone = alone[place];
                let same = (value - alone).abs() <= 1e-12 * alone.abs() || value.is_nan() && alone.is_nan();
                assert!(same, "{} {plane} {field:?}: {value} {alone}", model.name());
            }
            let ratios = || each.iter().map(|((alone, _), _)| alone[2]);
            assert_eq!(found.least, ratios().fold(f64::INFINITY, f64::min));
            assert_eq!(found.inverted, ratios().filter(|j| *j <= 0.0).count());
            assert!(found.inverted > 0 && found.inverted < each.len() / 2);
            assert_eq!(found.continued, each.iter().filter(|((_, continued), _)| *continued).count());
            let energy: f64 = each.iter().map(|((alone, _), area)| alone[0] * area).sum();
            assert!((found.energy - energy).abs() <= 1e-12 * energy || energy.is_nan() && found.energy.is_nan());
            assert_eq!(elements.diagnose_with_energy(Some(7.0), field, &x, &mut values).energy, 7.0);
        }
    }
}

#[test]
fn no_model_is_continued_above_a_quarter_of_the_area() {
    for model in Model::ALL {
        let mut random = Random(12);
        for _ in 0..1000 {
            let f = random.gradient(0.01, 8.0);
            let scaled = f * (WHOLE / f.determinant()).sqrt() * 1.000_001;
            if scaled.singular_values().min() < THIN {
                continue;
            }
            let continued = |f| model.visit(Lame { mu: 1.0, lambda: 1.0 }, SubScene(f, true)).1;
            assert!(!continued(scaled), "{} at {scaled}", model.name());
            // At nine hundredths of its area two of them are.
            let expected = [Model::NeoHookean, Model::Hencky].contains(model);
            assert_eq!(continued(scaled * 0.6), expected, "{} at {scaled}", model.name());
        }
    }
}

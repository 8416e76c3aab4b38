//! Energies typed as formulas: a typed one moves, converges, saves and is refused as the built-in one or in words.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::level;
use gingerbread::{
    command::{Command, Mode},
    files,
    integrators::IntegratorKind,
    level::{Level, RunMode, Substeps},
    levels::built_in,
    materials::Plane,
    materials::{Lame, Material as _, MaterialParameters, Model, NeoHookean, StVenantKirchhoff, TypedEnergy},
    meshes::NoFiles,
    quantity::{Factor, Poisson, Young},
    sandbox::Sandbox,
    scene::Scene,
    simulation::Simulation,
};
use nalgebra::{Matrix2, Vector4};

const NEO_HOOKEAN: &str = TypedEnergy::NEO_HOOKEAN;
/// mu |E|² + lambda/2 tr²E with tr E = (I1 - 2)/2 and |E|² = (I1² - 2 J² - 2 I1 + 2)/4.
const ST_VENANT_KIRCHHOFF: &str = "mu*(I1^2 - 2*J^2 - 2*I1 + 2)/4 + lambda/8*(I1 - 2)^2";

fn energy(text: &str) -> TypedEnergy {
    TypedEnergy::new(text, Vec::new()).unwrap()
}

fn parameters(model: Model, young: f64, poisson: f64) -> MaterialParameters {
    let (young, poisson) = (Young::new(young).unwrap(), Poisson::new(poisson).unwrap());
    MaterialParameters::new(model, young, poisson, Plane::Strain).unwrap()
}

/// Gradients with J from 0.5 to 1.6, and their turns.
fn gradients() -> impl Iterator<Item = Matrix2<f64>> {
    (0..40).map(|number| {
        let wave = |k: f64| (f64::from(number) * k + k).sin();
        let (sin, cos) = (3.0 * wave(0.7)).sin_cos();
        let stretch = Matrix2::new(1.1 + 0.3 * wave(1.3), 0.3 * wave(2.1), 0.3 * wave(1.7), 1.0 + 0.25 * wave(3.3));
        Matrix2::new(cos, -sin, sin, cos) * stretch
    })
}

#[test]
fn a_typed_energy_has_the_stress_and_stiffness_of_the_built_in_one() {
    let of = parameters(Model::NeoHookean, 130.0, 0.3);
    let lame = of.lame();
    let typed = energy(NEO_HOOKEAN).material(of).unwrap();
    let other = energy(ST_VENANT_KIRCHHOFF).material(of).unwrap();
    let (neo, stvk) = (NeoHookean::new(lame), StVenantKirchhoff::new(lame));
    let same = |found: f64, known: f64| (found - known).abs() < 1e-11 * (lame.mu + known.abs());
    for f in gradients() {
        assert!(same(typed.energy(&f), neo.energy(&f)) && same(other.energy(&f), stvk.energy(&f)), "{f}");
        let pairs = [(typed.stress(&f), neo.stress(&f)), (other.stress(&f), stvk.stress(&f))];
        assert!(pairs.iter().all(|(found, known)| same((found - known).amax(), 0.0)), "{f} {pairs:?}");
        let pairs = [(typed.stiffness(&f), neo.stiffness(&f)), (other.stiffness(&f), stvk.stiffness(&f))];
        assert!(pairs.iter().all(|(found, known)| (found - known).amax() < 1e-10 * known.amax()), "{f} {pairs:?}");
    }
    let Lame { mu, lambda } = typed.lame();
    assert!((mu / lame.mu - 1.0).abs() < 1e-14 && (lambda / lame.lambda - 1.0).abs() < 1e-13);
    for stretch in [0.7, 1.0, 1.8] {
        let (found, known) = (typed.free_width(stretch).unwrap(), neo.free_width(stretch).unwrap());
        assert!((found - known).abs() < 1e-12, "{stretch}: {found} {known}");
    }
}

/// With a mixed derivative by I1 and J too: stress and stiffness are derivatives of the energy.
#[test]
fn stress_and_stiffness_are_derivatives() {
    let text = "30*(I1/J - 2) + 20*(J - 1)^2 + 4*(I1 - 2)^2*J + 5*exp(I1 - 2*J) - 5";
    let typed = energy(text).material(MaterialParameters::default()).unwrap();
    let h = 1e-6;
    for f in gradients() {
        let stiffness = typed.stiffness(&f);
        for entry in 0..4 {
            let moved = |by: f64| {
                let mut moved = f;
                moved[entry] += by;
                moved
            };
            let slope = (typed.energy(&moved(h)) - typed.energy(&moved(-h))) / (2.0 * h);
            let stress = typed.stress(&f);
            assert!((slope - stress[entry]).abs() < 1e-6 * (1.0 + stress.amax()), "{f} {entry}: {slope} {stress}");
            let change = (typed.stress(&moved(h)) - typed.stress(&moved(-h))) / (2.0 * h);
            let change = Vector4::from_column_slice(change.as_slice()) - stiffness.column(entry);
            assert!(change.amax() < 1e-6 * (1.0 + stiffness.amax()), "{f} {entry}: {change}");
        }
    }
}

fn man(typed: bool) -> Level {
    let mut level = files::parse(built_in("gingerbread_house").unwrap(), "house").unwrap();
    level.set_model(Model::NeoHookean).unwrap();
    level.bodies[0].stretch = (Factor::new(1.1).unwrap(), Factor::new(0.93).unwrap());
    if typed {
        level.bodies[0].energy = Some(energy(NEO_HOOKEAN));
    }
    level
}

fn simulation(level: &Level) -> Simulation {
    let scene = Scene::build(level, RunMode::Collide, &NoFiles, None).unwrap();
    let state = scene.first_state(level.state.as_ref()).unwrap();
    Simulation::new(scene, state)
}

#[test]
fn typed_neo_hookean_moves_as_the_built_in_one() {
    let [mut known, mut typed] = [false, true].map(|typed| simulation(&man(typed)));
    for simulation in [&mut known, &mut typed] {
        assert_eq!(simulation.advance(600, &mut || true), 600);
    }
    let apart = known.state().x.iter().zip(&typed.state().x).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart > 0.0, "they are computed in another way");
    assert!(apart < 1e-12, "{apart} m apart");
}

#[test]
fn implicit_steps_take_the_same_newton_iterations() {
    let all = IntegratorKind::all();
    let implicit = all.iter().filter(|kind| ["ImplicitEuler", "Bdf2", "ImplicitMidpoint"].contains(&kind.name()));
    for integrator in implicit {
        let [known, typed] = [false, true].map(|typed| {
            let mut level = man(typed);
            level.integrator = integrator.clone();
            level.substeps = Substeps::nearest(2.0);
            let mut simulation = simulation(&level);
            simulation.advance(20, &mut || true);
            let counts = simulation.counts();
            (counts.newton_iterations, simulation.state().x.clone())
        });
        assert!(known.0 > 20, "{}: {}", integrator.name(), known.0);
        assert_eq!(known.0, typed.0, "{}", integrator.name());
        let apart = known.1.iter().zip(&typed.1).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-9, "{}: {apart} m apart", integrator.name());
    }
}

#[test]
fn membranes_take_typed_energies_too() {
    let [known, typed] = [false, true].map(|typed| {
        let mut level = files::parse(built_in("toronto_cloth").unwrap(), "cloth").unwrap();
        level.set_model(Model::NeoHookean).unwrap();
        if typed {
            level.membranes[0].energy = Some(energy(NEO_HOOKEAN));
        }
        let mut simulation = simulation(&level);
        simulation.advance(20, &mut || true);
        simulation.state().x.clone()
    });
    let apart = known.iter().zip(&typed).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-10, "{apart} m apart");
}

#[test]
fn a_level_with_a_typed_energy_is_saved_and_read_again() {
    let text = "(name: \"sheet\", bodies: [(name: \"s\", mesh: Rectangle(width: 0.4, height: 0.4, columns: 3, rows: 3), mass: Total(1),
        material: (model: Corotated, young: 130, poisson: 0.3),
        energy: (formula: \"c/2*(I1 - 2) - c*log(J) + k*(J - 1)^2\", parameters: [(\"c\", 40), (\"k\", 2.5)]))])";
    let level = level(text);
    let written = files::write(&level).unwrap();
    assert_eq!(files::parse(&written, "again").unwrap(), level, "{written}");
    let sandbox = Sandbox::new(level, Box::new(NoFiles)).unwrap();
    let lame = sandbox.simulation().scene().bodies[0].elements.material().lame();
    assert!((lame.mu - 40.0).abs() < 1e-12 && (lame.lambda - 5.0).abs() < 1e-12, "{lame:?}");
}

#[test]
fn a_wrong_energy_is_refused_in_words_and_the_scene_stays() {
    let refused = |text: &str, more: &str| {
        let level = format!(
            "(name: \"sheet\", bodies: [(name: \"s\", mesh: Rectangle(width: 0.4, height: 0.4, columns: 3, rows: 3), mass: Total(1),
            material: (model: Corotated, young: 130, poisson: 0.3), energy: (formula: \"{text}\"{more}))])"
        );
        match files::parse(&level, "wrong") {
            Ok(level) => Sandbox::new(level, Box::new(NoFiles)).map(drop).unwrap_err().to_string(),
            Err(error) => error.to_string(),
        }
    };
    for (text, more, words) in [
        ("mu/2*(I1 - 2", "", "expected `)`"),
        ("c*(I1 - 2)", "", "there is no `c`; the names are I1, J, mu, lambda, E, nu"),
        ("mu/2*(I1 - 2)", "", "at rest there is a stress of 5"),
        ("-mu/2*(I1 - 2 - 2*log(J))", "", "at rest it is not stiff"),
        ("mu/2*(I1 - 2)/(J - 1)", "", "is not finite"),
        ("mu*sin(I1)", "", "an energy has the functions"),
        ("mu*I1", ", parameters: [(\"J\", 1)]", "`J` cannot be the name of a parameter"),
        ("mu*I1", ", parameters: [(\"2c\", 1)]", "`2c` cannot be the name of a parameter"),
        ("mu*I1", ", parameters: [(\"c\", inf)]", "`c` must be a finite number"),
        ("mu*I1", ", parameters: [(\"c\", 1), (\"c\", 2)]", "two parameters `c`"),
        ("mu*I1", ", parameter: []", "parameter"),
    ] {
        let said = refused(text, more);
        assert!(said.contains(words), "{text}{more}: {said}");
    }
    let mut sandbox = Sandbox::new(man(true), Box::new(NoFiles)).unwrap();
    let before = sandbox.document().clone();
    let wrong = Command::SetEnergy(0, Some(energy("mu/2*(I1 - 2)")));
    assert!(sandbox.apply(wrong).unwrap_err().to_string().contains("at rest there is a stress"));
    assert_eq!(*sandbox.document(), before);
    // A model replaces it, and undo brings it back.
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    sandbox.apply(Command::SetModel(Model::Corotated)).unwrap();
    assert_eq!(sandbox.document().level.bodies[0].energy, None);
    sandbox.apply(Command::Undo).unwrap();
    assert_eq!(sandbox.document().level, before.level);
    sandbox.apply(Command::SetEnergy(0, None)).unwrap();
    assert_eq!(sandbox.simulation().scene().bodies[0].elements.material().model(), Some(Model::NeoHookean));
}

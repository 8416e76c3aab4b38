//! Kinds from outside the crate, those of the examples, work wherever listed ones do; only files cannot hold them.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

#[path = "../../examples/own_effect.rs"]
#[allow(dead_code, reason = "an example is a program")]
mod own_effect;
#[path = "../../examples/own_integrator.rs"]
#[allow(dead_code, reason = "an example is a program")]
mod own_integrator;
#[path = "../../examples/own_material.rs"]
#[allow(dead_code, reason = "an example is a program")]
mod own_material;

use crate::common::{level, named, sheet, simulation};
use gingerbread::{
    command::Command,
    effects::{Drag, EffectKind},
    elements::OwnMaterial,
    files,
    integrators::IntegratorKind,
    level::{EffectLevel, Level, RunMode, SubstepMode, Substeps, Switch, When},
    materials::{MaterialParameters, Model, Plane, Principal},
    meshes::{Files, Mesh, MeshError, MeshKind, MeshSource, NoFiles, Rectangle},
    quantity::{DragCoefficient, Poisson, VelocityX, Young},
    sandbox::Sandbox,
    scene::Scene,
    study::{Plan, Trial, WorkPrecision},
};
use own_effect::Wind;
use own_integrator::RungeKutta3;
use own_material::Ogden;
use std::time::Duration;

/// Ogden with the exponent 2, which is neo-Hookean.
fn ogden() -> OwnMaterial {
    OwnMaterial::new(|lame| Principal(Ogden { lame, exponent: 2.0 }))
}

fn wind(speed: f64) -> EffectKind {
    let coefficient = DragCoefficient::new(0.02).unwrap();
    EffectKind::own("Wind", Wind { speed: VelocityX::new(speed).unwrap(), coefficient })
}

fn blown(mut level: Level, effect: EffectKind) -> Level {
    level.effects.push(EffectLevel { effect, switch: Switch::Auto, when: When::Always });
    level
}

fn with_own_material(mut level: Level) -> Level {
    level.bodies[0].own_material = Some(ogden());
    level
}

/// Positions after a tenth of a second.
fn end(level: &Level) -> Vec<f64> {
    let mut run = simulation(level);
    run.advance(6 * u64::from(level.substeps.get()), &mut || true);
    assert!(run.fault().is_none(), "{:?}", run.fault());
    run.state().x.clone()
}

fn gap(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()))
}

/// A sheet that is stretched at first and falls.
fn falling(integrator: IntegratorKind) -> Level {
    let extra = "effects: [(effect: Gravity(down: 9.81)), (effect: Rayleigh(mass: 0.5, stiffness: 0.0002))]";
    let mut level = sheet("NeoHookean", "stretch: (1.2, 0.9), pins: [Top]", extra);
    (level.integrator, level.substeps) = (integrator, Substeps::new(40).unwrap());
    level
}

/// With every integrator.
#[test]
fn own_material_moves_as_the_same_listed_one() {
    for kind in IntegratorKind::all() {
        let level = falling(kind);
        let (listed, own) = (end(&level), end(&with_own_material(level.clone())));
        let apart = gap(&listed, &own);
        assert!(apart < 1e-7, "{}: {apart:e} m", level.integrator.name());
    }
}

/// Every listed model has an energy there.
#[test]
fn a_crushed_triangle_is_named_where_its_model_has_no_energy() {
    let mut simulation = simulation(&with_own_material(sheet("NeoHookean", "", "guard: Off")));
    let mut state = simulation.state().clone();
    // Vertex 12 is in the middle; it is shot through the body.
    state.v[24] = 2000.0;
    simulation.set_state(state);
    simulation.advance(1000, &mut || true);
    let fault = simulation.fault().unwrap().to_string();
    assert!(fault.contains("inverted (inside out), where the energy of Ogden is not defined"), "{fault}");
}

/// Wind of no speed is drag. With every integrator.
#[test]
fn own_effect_acts_as_the_same_listed_one() {
    let drag = || EffectKind::from(Drag { coefficient: DragCoefficient::new(0.02).unwrap() });
    for kind in IntegratorKind::all() {
        let level = falling(kind);
        let (listed, own) = (end(&blown(level.clone(), drag())), end(&blown(level.clone(), wind(0.0))));
        let apart = gap(&listed, &own);
        assert!(apart < 1e-7, "{}: {apart:e} m", level.integrator.name());
        assert!(gap(&own, &end(&blown(level.clone(), wind(5.0)))) > 1e-4, "{}", level.integrator.name());
    }
}

/// It is measured in a study, beside a listed one, with own material and effect, with multirate stepping too.
#[test]
fn own_integrator_has_its_order_in_a_study() {
    let level = blown(with_own_material(falling(IntegratorKind::own("RungeKutta3", RungeKutta3))), wind(1.0));
    for paces in [SubstepMode::Same, SubstepMode::Own] {
        let level = Level { paces, ..level.clone() };
        let trial = Trial::new(&level, &NoFiles, 0.1).unwrap();
        let integrators = vec![level.integrator.clone(), named("RungeKutta4")];
        let mut diagram = WorkPrecision::new(trial, Plan { integrators, ..Plan::default() });
        while !diagram.advance(Duration::MAX).unwrap().finished {}
        let csv = diagram.csv();
        assert!(csv.contains("RungeKutta3") && csv.contains("RungeKutta4"), "{csv}");
    }
    let errors = [1, 2].map(|refine| {
        let exact =
            end(&Level { integrator: named("RungeKutta4"), substeps: Substeps::new(400).unwrap(), ..level.clone() });
        gap(&exact, &end(&Level { substeps: Substeps::new(50 * refine).unwrap(), ..level.clone() }))
    });
    let order = (errors[0] / errors[1]).log2();
    assert!((order - 3.0).abs() < 0.3, "order {order}");
}

/// A mesh made in code.
#[derive(Clone, Debug, PartialEq)]
struct Sheared(Rectangle);

impl MeshSource for Sheared {
    fn build(&self, files: &dyn Files) -> Result<Mesh, MeshError> {
        let mesh = self.0.build(files)?;
        let points = mesh.points().iter().map(|[x, y]| [x + 0.3 * y, *y]).collect();
        Mesh::new(points, mesh.triangles().to_vec())
    }
}

#[test]
fn own_mesh_fills_a_body() {
    let mut level = falling(named("ImplicitEuler"));
    level.bodies[0].mesh = MeshKind::own("Sheared", Sheared(Rectangle::default()));
    let run = simulation(&level);
    let (low, high) = gingerbread::scene::extent(&run.scene().rest, 0);
    let mesh = Rectangle::default().build(&NoFiles).unwrap();
    let [[left, bottom], [right, top]] = mesh.bounds();
    assert!((high - low - (right - left) - 0.3 * (top - bottom)).abs() < 1e-12);
    end(&level);
}

/// The window's commands, undo and rewind.
#[test]
fn sandbox_keeps_own_kinds_and_files_refuse_them() {
    let level = blown(with_own_material(falling(IntegratorKind::own("RungeKutta3", RungeKutta3))), wind(2.0));
    let mut sandbox = Sandbox::new(level.clone(), Box::new(NoFiles)).unwrap();
    let title = |sandbox: &Sandbox| sandbox.simulation().scene().bodies[0].elements.material().title();
    assert_eq!(title(&sandbox), "Ogden");
    let text = files::write(&sandbox.saved());
    let error = text.unwrap_err().to_string();
    assert!(error.contains("cannot hold RungeKutta3"), "{error}");
    sandbox.apply(Command::SetModel(Model::Corotated)).unwrap();
    assert_eq!(title(&sandbox), "Corotated");
    sandbox.apply(Command::Undo).unwrap();
    assert_eq!(title(&sandbox), "Ogden");
    // Own parameters have sliders.
    let mut effect = sandbox.document().level.effects.last().unwrap().clone();
    effect.effect.kind_mut().parameters()[0].set(3.0).unwrap();
    assert_ne!(effect, *sandbox.document().level.effects.last().unwrap());
    assert_eq!(effect.effect, wind(3.0));
}

/// A slider of the material keeps the blocks of the body; another place does not.
#[test]
fn shapes_are_kept_while_a_material_changes() {
    let level = level(
        "(name: \"two\", bodies: [
            (name: \"a\", mesh: Rectangle(width: 0.4, height: 0.3, columns: 4, rows: 3), material: (model: Corotated, young: 100, poisson: 0.3), mass: Density(1)),
            (name: \"b\", mesh: Rectangle(width: 0.4, height: 0.3, columns: 4, rows: 3), material: (model: Hencky, young: 100, poisson: 0.3), mass: Density(1))])",
    );
    let mut sandbox = Sandbox::new(level, Box::new(NoFiles)).unwrap();
    let corners = |sandbox: &Sandbox| {
        sandbox.simulation().scene().bodies.iter().map(|body| body.elements.corners().as_ptr()).collect::<Vec<_>>()
    };
    let before = corners(&sandbox);
    let (young, poisson) = (Young::new(333.0).unwrap(), Poisson::new(0.1).unwrap());
    let material = MaterialParameters::new(Model::Corotated, young, poisson, Plane::default()).unwrap();
    sandbox.apply(Command::SetMaterial(0, material)).unwrap();
    let elements = &sandbox.simulation().scene().bodies[0].elements;
    assert_eq!((corners(&sandbox), elements.material().lame()), (before.clone(), material.lame()));
    let anew = Scene::build(&sandbox.document().level, RunMode::default(), &NoFiles, None).unwrap();
    let x: Vec<f64> = anew.rest.iter().map(|x| 1.1 * x).collect();
    assert_eq!(anew.bodies[0].elements.elastic_energy(&x), elements.elastic_energy(&x));
    let mut moved = sandbox.document().level.clone();
    moved.bodies[1].place.offset = gingerbread::quantity::Point::new([0.5, 0.0]).unwrap();
    let moved = Scene::build(&moved, RunMode::default(), &NoFiles, Some(sandbox.simulation().scene())).unwrap();
    let moved: Vec<_> = moved.bodies.iter().map(|body| body.elements.corners().as_ptr()).collect();
    assert!(moved[0] == before[0] && moved[1] != before[1]);
}

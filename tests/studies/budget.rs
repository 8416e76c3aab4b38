//! Error budgets: each source of error is measured by refining it alone.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{built_in, named as scheme_named};
use gingerbread::{
    elements::ElementKind,
    level::{Level, Substeps},
    meshes::NoFiles,
    study::{ErrorBudget, ErrorSource, Plan, SourceKind, Trial, WorkPrecision},
};
use std::time::Duration;

fn budget(level: &Level, seconds: f64, threads: usize) -> Vec<ErrorSource> {
    let mut budget = ErrorBudget::new(level, &NoFiles, seconds, threads).unwrap();
    while !budget.advance(Duration::from_millis(5)).unwrap().finished {}
    budget.sources().cloned().collect()
}

fn named<'a>(sources: &'a [ErrorSource], name: &str) -> &'a ErrorSource {
    sources.iter().find(|source| source.name == name).unwrap()
}

/// What half of the step tells is the error that a study measures against a reference, for schemes of several orders.
#[test]
fn the_part_of_the_time_step_is_the_error_of_a_study() {
    for scheme in ["SymplecticEuler", "VelocityVerlet", "Heun"] {
        let substeps = Substeps::new(40).unwrap();
        let level = Level { integrator: scheme_named(scheme), substeps, ..built_in("hanging_net") };
        let sources = budget(&level, 0.5, 1);
        let step = named(&sources, "time step");
        let plan = Plan { integrators: vec![level.integrator.clone()], substeps: vec![substeps], ..Plan::default() };
        let mut diagram = WorkPrecision::new(Trial::new(&level, &NoFiles, 0.5).unwrap(), plan);
        while !diagram.advance(Duration::from_secs(1)).unwrap().finished {}
        let true_error = diagram.curves()[0].points[0].outcome.as_ref().unwrap().error;
        let found = step.error.unwrap();
        assert!((found / true_error - 1.0).abs() < 0.1, "{scheme}: {found} for {true_error}");
        assert!(sources.iter().all(|source| source.name != "mesh"), "a net of springs has no mesh");
    }
}

#[test]
fn the_parts_of_a_body_are_told_with_every_effect() {
    let sources = budget(&built_in("cantilever"), 0.2, 2);
    let names: Vec<_> = sources.iter().map(|source| source.name.as_str()).collect();
    assert!(names.contains(&"time step") && names.contains(&"mesh") && names.contains(&"all of these"), "{names:?}");
    assert!(named(&sources, "gravity").moved.unwrap() > 0.9, "without its weight it does not bend");
    let kinds: Vec<_> = sources.iter().map(|source| source.kind).collect();
    let split = kinds.iter().position(|kind| *kind == SourceKind::Together).unwrap();
    assert!(kinds[..split].iter().all(|kind| *kind == SourceKind::Numerical), "{names:?}");
    assert_eq!(kinds[split + 1], SourceKind::Replaced);
    assert!(kinds[split + 2..].iter().all(|kind| *kind == SourceKind::Effect), "{names:?}");
    let worth: Vec<_> = sources[..split].iter().map(|source| source.worth().unwrap()).collect();
    assert!(worth.is_sorted_by(|a, b| a >= b), "what removes most error for its price comes first: {worth:?}");
    for again in budget(&built_in("cantilever"), 0.2, 1) {
        let found = named(&sources, &again.name);
        assert_eq!((again.moved, again.error, &again.trouble), (found.moved, found.error, &found.trouble));
    }
    let [step, mesh, all] = ["time step", "mesh", "all of these"].map(|name| named(&sources, name).moved.unwrap());
    assert!(mesh > step && (all / (step + mesh) - 1.0).abs() < 0.2, "they add up: {step} {mesh} {all}");
}

/// Nearly incompressible linear triangles lock, which more of them mend slowly and quadratic ones at once. A level of quadratic ones has no such part.
#[test]
fn elements_that_lock_are_the_greatest_part() {
    let mut level = built_in("locking");
    level.bodies.retain(|body| body.element == ElementKind::Linear);
    let sources = budget(&level, 0.4, 2);
    let [elements, mesh] = ["elements", "mesh"].map(|name| named(&sources, name).moved.unwrap());
    assert!(elements > 1.2 * mesh && mesh > 0.05, "{elements} by the elements, {mesh} by the mesh");
    level.bodies[0].element = ElementKind::Quadratic;
    let sources = budget(&level, 0.1, 2);
    assert!(sources.iter().all(|source| source.name != "elements"));
    let mesh = named(&sources, "mesh");
    assert!((mesh.error.unwrap() / mesh.moved.unwrap() - 8.0 / 7.0).abs() < 1e-12);
}

#[test]
fn a_scene_that_does_not_move_and_a_toy_have_no_budget() {
    for name in ["gingerbread", "pendulum"] {
        let budget = ErrorBudget::new(&built_in(name), &NoFiles, 0.1, 1);
        assert!(budget.and_then(|mut budget| budget.advance(Duration::from_secs(9))).is_err(), "{name}");
    }
}

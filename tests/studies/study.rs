//! Promises about what accuracy costs: errors against better references, diagrams, suggestions, and that all of it repeats.
//! Drift and meshes have a file of their own.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{
    built_in, level, named, released, released_of,
    studies::{RESTING, WHOLE, trial, without_times},
};
use crate::program::{Folder, gingerbread, said};
use gingerbread::{
    command::Command,
    integrators::{Class, IntegratorKind},
    level::{Level, Substeps},
    meshes::NoFiles,
    sandbox::Sandbox,
    study::{
        MOST_RUNS, NoErrors, NoOrder, Plan, Price, ReferenceJob, Setting, Source, Status, Trial, TrialRun,
        WorkPrecision,
    },
};
use std::{fs, time::Duration};

fn substeps(counts: &[u32]) -> Vec<Substeps> {
    counts.iter().map(|count| Substeps::new(*count).unwrap()).collect()
}

fn diagram(level: &Level, seconds: f64, plan: Plan) -> WorkPrecision {
    let mut diagram = WorkPrecision::new(trial(level, seconds), plan);
    assert!(diagram.advance(WHOLE).unwrap().finished);
    diagram
}

/// It keeps runs that were unstable.
#[test]
fn the_automatic_diagram_has_a_line_for_every_integrator() {
    let diagram = diagram(&released(""), 0.1, Plan { threads: 2, ..Plan::default() });
    let curves = diagram.curves();
    assert_eq!(curves.len(), IntegratorKind::all().len());
    for curve in &curves {
        let name = curve.integrator.name();
        assert!(curve.points.len() >= 5, "{name}");
        let outcomes: Vec<_> = curve.points.iter().map(|point| point.outcome.as_ref().unwrap()).collect();
        assert!(outcomes.iter().all(|outcome| outcome.counts.force_evaluations > 0), "{name}");
        assert!(outcomes.last().unwrap().status != Status::Unstable || name == "ForwardEuler", "{name}");
        let errors: Vec<_> = outcomes.iter().map(|outcome| outcome.error).collect();
        assert!(errors.last() < errors.first(), "{name}: {errors:?}");
    }
    let symplectic = &curves.iter().find(|curve| curve.integrator.name() == "SymplecticEuler").unwrap().points;
    let status = |at: usize| symplectic[at].outcome.as_ref().unwrap().status;
    assert_eq!(status(0), Status::Unstable, "the first step is above the stability limit");
    assert_eq!(status(1), Status::Ok, "the second one is below");
    assert_eq!(symplectic.iter().filter(|point| point.current).count(), 1, "the level's own setting is on the diagram");
}

#[test]
fn the_measured_order_is_the_declared_one_for_every_fixed_step() {
    let plan = Plan { substeps: substeps(&[32, 64, 128, 256]), smallest_error: 1e-9, ..Plan::default() };
    for curve in diagram(&released_of(100, ""), 0.1, plan).curves() {
        let (name, declared) = (curve.integrator.name(), f64::from(curve.integrator.kind().order()));
        if curve.integrator.kind().class() == Class::ErrorControlled {
            continue;
        }
        let errors: Vec<_> = curve.points.iter().map(|point| point.outcome.clone().unwrap().error).collect();
        let measured = curve.order.unwrap_or(f64::NAN);
        assert!((measured - declared).abs() < 0.15, "{name}: {measured} instead of {declared} from {errors:?}");
    }
}

fn reference_of(trial: &Trial, smallest_error: f64) -> gingerbread::study::Reference {
    let mut job = ReferenceJob::new(trial, smallest_error);
    assert!(job.advance(trial, 1, WHOLE).finished);
    job.result().unwrap().clone().unwrap()
}

/// It is a hundred times better than asked.
#[test]
fn a_reference_meets_its_own_error_bound() {
    let trial = trial(&released(""), 0.1);
    let rough = reference_of(&trial, 1e-4);
    assert!(rough.own_error <= 1e-6 && rough.own_error > 0.0);
    let finer = reference_of(&trial, 1e-10);
    let Source::Fine(setting) = &rough.source else { unreachable!("nothing here is known exactly") };
    let outcome = TrialRun::new(&trial, setting).advance(&trial, &finer, WHOLE).unwrap();
    assert!(outcome.error <= rough.own_error, "{:e} above {:e}", outcome.error, rough.own_error);
}

#[test]
fn a_free_fall_is_measured_against_its_closed_form() {
    let text = "(name: \"fall\", bodies: [(name: \"sheet\", mass: Density(1), velocity: (0.5, 1),
        mesh: Rectangle(width: 0.4, height: 0.4, columns: 2, rows: 2),
        material: (model: NeoHookean, young: 50, poisson: 0.3))], effects: [(effect: Gravity(down: 2))])";
    let plan = Plan { substeps: substeps(&[1, 2, 4, 8]), ..Plan::default() };
    let diagram = diagram(&level(text), 0.5, plan);
    assert!(matches!(diagram.reference().unwrap().source, Source::Exact(_)));
    for curve in diagram.curves() {
        let name = curve.integrator.name();
        let finest = curve.points.last().unwrap().outcome.clone().unwrap();
        if name == "RungeKutta4" || name == "VelocityVerlet" {
            assert!(finest.error < 1e-10, "{name} is exact for a parabola: {:e}", finest.error);
        }
        if name == "SymplecticEuler" {
            assert!((curve.order.unwrap() - 1.0).abs() < 0.05, "{:?}", curve.order);
        }
    }
}

/// The largest error stands beside it.
/// Symplectic Euler is late by g h t/2 in a fall, so that errors grow like the time.
#[test]
fn an_error_is_a_mean_over_frames() {
    let text = "(name: \"fall\", bodies: [(name: \"sheet\", mass: Density(1), mesh: Rectangle(width: 0.4, height: 0.4, columns: 2, rows: 2),
        material: (model: NeoHookean, young: 50, poisson: 0.3))], effects: [(effect: Gravity(down: 2))])";
    let plan = Plan { integrators: vec![named("SymplecticEuler")], substeps: substeps(&[40]), ..Plan::default() };
    let diagram = diagram(&level(text), 0.5, plan);
    let outcome = diagram.curves()[0].points[0].outcome.clone().unwrap();
    let times = || (1..=30).map(|frame| f64::from(frame) / 60.0);
    let rms = |of: fn(f64) -> f64| (times().map(|t| of(t) * of(t)).sum::<f64>() / 30.0).sqrt();
    let (mean, motion) = (rms(|t| t / 2400.0), rms(|t| t * t));
    assert!((outcome.error / (mean / motion) - 1.0).abs() < 1e-6, "{outcome:?}");
    assert!((outcome.greatest_error / (0.5 / 2400.0 / motion) - 1.0).abs() < 1e-6, "{outcome:?}");
    let csv = diagram.csv();
    assert!(
        csv.contains("# error: relative RMS position error, mean over frames")
            && csv.contains(",error,greatest_error,")
    );
}

#[test]
fn where_nothing_moves_there_are_no_errors_and_no_suggestion() {
    let diagram = diagram(&level(RESTING), 0.1, Plan::default());
    assert!(matches!(diagram.no_errors(), Some(NoErrors::NothingMoves(_))));
    for price in [Price::Time, Price::ForceEvaluations] {
        assert!(diagram.suggest(1.0, price).is_none() && diagram.suggest_usual(price).is_none());
    }
    for curve in diagram.curves() {
        assert_eq!(curve.order, Err(NoOrder::NothingMoves));
    }
    let csv = diagram.csv();
    assert!(csv.contains("# remark: Nothing moves here") && !csv.contains("unstable"), "{csv}");
    assert!(!csv.contains("inf") && !csv.contains("NaN"), "{csv}");
}

#[test]
fn prices_are_the_least_of_several_runs_and_the_table_says_so() {
    let diagram = diagram(&released(""), 0.1, Plan { threads: 1, smallest_error: 1e-3, ..Plan::default() });
    let outcomes: Vec<_> =
        diagram.curves().into_iter().flat_map(|curve| curve.points).filter_map(|point| point.outcome).collect();
    assert!(outcomes.iter().all(|outcome| (1..=MOST_RUNS).contains(&outcome.runs)));
    assert!(outcomes.iter().any(|outcome| outcome.runs > 2), "short runs are repeated");
    let unstable = outcomes.iter().filter(|outcome| outcome.status == Status::Unstable);
    assert!(unstable.clone().count() > 0 && unstable.clone().all(|outcome| outcome.runs == 1));
    let csv = diagram.csv();
    assert!(
        csv.contains("# ms_per_simulated_s: processor time of the thread that computes, least of 1 to 5 runs"),
        "{csv}"
    );
}

/// It begins at one per cent.
#[test]
fn the_usual_suggestion_is_the_least_decade_of_error() {
    let circle = level("(name: \"circle\", integrator: Heun(), toy: Circle(radius: 0.3))");
    for (seconds, expected) in [(1.0, Some(0.01)), (4.0, Some(0.1)), (40.0, None)] {
        let plan = Plan { integrators: vec![named("ForwardEuler")], substeps: substeps(&[1]), ..Plan::default() };
        let diagram = diagram(&circle, seconds, plan);
        assert_eq!(diagram.suggest_usual(Price::Time).map(|(error, _)| error), expected, "{:?}", diagram.curves());
    }
}

#[test]
fn toys_and_springs_are_measured_against_closed_forms() {
    let spring = "(name: \"bounce\", nets: [(name: \"s\", net: Chain(from: (0.5, 0.9), to: (0.5, 0.4), springs: 1, stiffness: 100, rest: 0.4),
        mass: 1, pins: [Vertex(0)])], effects: [(effect: Gravity(down: 9.8)), (effect: MouseSpring(stiffness: 100))])";
    let circle = "(name: \"circle\", integrator: Heun(), toy: Circle(radius: 0.3))";
    let pendulum = "(name: \"pendulum\", integrator: Heun(), toy: Pendulum(length: 0.4, gravity: 9.8, start: 90))";
    for (text, least) in [(spring, 10), (circle, 4), (pendulum, 4)] {
        let plan = Plan { substeps: substeps(&[1, 2, 4, 8]), ..Plan::default() };
        let diagram = diagram(&level(text), 0.5, plan);
        assert!(matches!(diagram.reference().unwrap().source, Source::Exact(_)), "{text}");
        let curves = diagram.curves();
        assert!(curves.len() >= least, "{text}");
        for curve in curves.iter().filter(|curve| curve.integrator.kind().class() != Class::ErrorControlled) {
            let declared = f64::from(curve.integrator.kind().order());
            let measured = curve.order.unwrap_or(f64::NAN);
            assert!((measured - declared).abs() < 0.2, "{text} {}: {measured}", curve.integrator.name());
        }
    }
}

#[test]
fn a_reference_with_contact_states_its_error() {
    let effects = "effects: [(effect: Gravity(down: 20)), (effect: Boundary(least: (0, 0.28), greatest: (1, 1)))]";
    let reference = reference_of(&trial(&released(effects), 0.2), 1e-2);
    assert!(reference.own_error > 0.0 && reference.own_error < 0.05, "{:e}", reference.own_error);
}

#[test]
fn an_applied_suggestion_keeps_its_promise() {
    let level = released("");
    let diagram = diagram(&level, 0.2, Plan::default());
    for (per_cent, price) in [(5.0, Price::ForceEvaluations), (1.0, Price::Time), (0.01, Price::ForceEvaluations)] {
        let suggestion = diagram.suggest(0.01 * per_cent, price).unwrap();
        assert!(suggestion.outcome.error <= 0.01 * per_cent);
        let mut sandbox = Sandbox::new(level.clone(), Box::new(NoFiles)).unwrap();
        for command in suggestion.commands() {
            sandbox.apply(command).unwrap();
        }
        let changed = Level { state: None, ..sandbox.saved() };
        assert_eq!(Setting::of(&changed), suggestion.setting);
        let again = trial(&changed, 0.2);
        let reference = reference_of(&again, Plan::default().smallest_error);
        let outcome = TrialRun::new(&again, &again.current).advance(&again, &reference, WHOLE).unwrap();
        assert_eq!(outcome.error, suggestion.outcome.error, "{suggestion}");
    }
    let sentence = diagram.suggest(0.01, Price::Time).unwrap().to_string();
    assert!(sentence.contains("than now"), "it says what it would save: {sentence}");
    assert!(diagram.suggest(1e-30, Price::Time).is_none(), "nothing is promised that was not measured");
}

/// Budget and number of threads change only the measured times.
#[test]
fn accuracy_tables_are_reproducible() {
    let plan = |threads| Plan { threads, smallest_error: 1e-3, ..Plan::default() };
    let once = diagram(&released(""), 0.05, plan(1)).csv();
    let again = diagram(&released(""), 0.05, plan(1)).csv();
    assert_eq!(without_times(&once), without_times(&again));
    let mut slow = WorkPrecision::new(trial(&released(""), 0.05), plan(3));
    let mut last = 0.0;
    loop {
        let progress = slow.advance(Duration::from_micros(300)).unwrap();
        assert!(progress.done >= last - 1e-9 && progress.done <= 1.0, "progress never goes back");
        last = progress.done;
        if progress.finished {
            break;
        }
    }
    let rows = |csv: &str| without_times(csv).into_iter().filter(|row| !row[0].starts_with('#')).collect::<Vec<_>>();
    assert_eq!(rows(&once), rows(&slow.csv()));
    for entry in
        ["level: released", "start_hash: ", "commit: ", "processor: ", "threads: 1", "reference: ", "error_at_most: "]
    {
        assert!(once.contains(entry), "{entry} is missing in\n{once}");
    }
}

#[test]
fn partial_results_can_be_read_and_are_not_changed_by_going_on() {
    let mut job = WorkPrecision::new(trial(&released(""), 0.1), Plan { threads: 1, ..Plan::default() });
    let mut seen = Vec::new();
    while !job.advance(Duration::from_millis(3)).unwrap().finished {
        // The price may still fall, as it is the least of several runs.
        let unpriced = |outcome| gingerbread::study::Outcome { ms_per_second: 0.0, runs: 0, ..outcome };
        let points = job.curves().into_iter().flat_map(|curve| curve.points);
        let now: Vec<_> = points.map(|point| point.outcome.map(unpriced)).collect();
        if !seen.is_empty() {
            let pairs = seen.iter().zip(&now);
            assert!(pairs.into_iter().all(|(before, now): (&Option<_>, _)| before.is_none() || before == now));
        }
        seen = now;
    }
    assert!(job.curves().iter().all(|curve| curve.points.iter().all(|point| point.outcome.is_some())));
}

/// Unstable runs are marked on it.
#[test]
fn nets_and_toys_have_a_diagram() {
    for name in ["chain", "hanging_net", "spring_pendulum", "circle", "pendulum"] {
        let level = built_in(name);
        let plan = Plan { smallest_error: 1e-3, threads: 2, ..Plan::default() };
        let diagram = diagram(&level, 0.5, plan);
        let curves = diagram.curves();
        let suits = if level.toy.is_some() { 4 } else { IntegratorKind::all().len() };
        assert_eq!(curves.len(), suits, "{name}");
        let current = curves.iter().flat_map(|curve| &curve.points).filter(|point| point.current).count();
        assert_eq!(current, 1, "{name} shows its own setting");
        for curve in &curves {
            let outcomes: Vec<_> = curve.points.iter().map(|point| point.outcome.as_ref().unwrap()).collect();
            let finest = outcomes.last().unwrap();
            assert!(
                finest.status == Status::Ok && finest.error < 0.2,
                "{name}, {}: {finest:?}",
                curve.integrator.name()
            );
        }
    }
}

#[test]
fn choosing_an_integrator_keeps_the_state_and_is_undone_as_one() {
    let mut sandbox = Sandbox::new(released(""), Box::new(NoFiles)).unwrap();
    sandbox.apply(Command::SetRunning(true)).unwrap();
    sandbox.advance(30, &mut || true);
    for kind in IntegratorKind::all().into_iter().rev() {
        let before = sandbox.simulation().state().clone();
        sandbox.apply(Command::SetIntegrator(kind.clone())).unwrap();
        assert_eq!(sandbox.simulation().scene().integrator, kind);
        assert_eq!((&sandbox.simulation().state().x, &sandbox.simulation().state().v), (&before.x, &before.v));
        sandbox.apply(Command::EndGesture).unwrap();
        assert_eq!(sandbox.advance(3, &mut || true), 3, "{}: {:?}", kind.name(), sandbox.simulation().fault());
    }
    // The last chosen is the level's own; what is undone first is the choice of it.
    let mut error_controlled = named("DormandPrince");
    for tolerance in [1e-3, 1e-4, 1e-5] {
        error_controlled.kind_mut().parameters()[0].set(tolerance).unwrap();
        sandbox.apply(Command::SetIntegrator(error_controlled.clone())).unwrap();
    }
    let now = sandbox.simulation().state().clone();
    sandbox.apply(Command::Undo).unwrap();
    assert_eq!(sandbox.simulation().scene().integrator.name(), "SymplecticEuler", "a drag of a slider is one change");
    assert_eq!(sandbox.simulation().state().x, now.x);
    sandbox.apply(Command::Redo).unwrap();
    assert_eq!(sandbox.simulation().scene().integrator, error_controlled);
}

/// A wrong name is answered with the known ones.
#[test]
fn the_study_command_prints_a_table_and_writes_csv() {
    let folder = Folder::new("study");
    let file = folder.with("sheet.ron", &gingerbread::files::write(&released("")).unwrap());
    let csv = folder.file("out.csv");
    let chosen =
        ["study", &file, "--integrators", "SymplecticEuler,rungekutta4", "--steps", "20,40", "--seconds", "0.05"];
    let output = gingerbread(&[&chosen[..], &["--csv", &csv]].concat());
    let text = said(&output.stdout);
    assert!(output.status.success(), "{}", said(&output.stderr));
    assert!(text.contains("reference:") && text.contains("Cheapest under 1 %") && text.contains("<- now"), "{text}");
    let table = fs::read_to_string(&csv).unwrap();
    assert_eq!(table.lines().filter(|line| !line.starts_with('#')).count(), 1 + 4, "{table}");
    let output = gingerbread(&[&chosen[..], &["--drift", "--csv", &csv]].concat());
    let text = said(&output.stdout);
    assert!(text.contains("greatest change of") && text.contains("Runge-Kutta 4, 40 steps a frame"), "{output:?}");
    let table = fs::read_to_string(&csv).unwrap();
    assert_eq!(table.lines().filter(|line| !line.starts_with('#')).count(), 1 + 4 * 4, "{table}");
    let output = gingerbread(&["study", &file, "--meshes", "24,96,384", "--measure", "energy", "--seconds", "0.05"]);
    assert!(said(&output.stdout).contains("triangles"), "{output:?}");
    for (arguments, expected) in [
        (vec!["study", "no_such_level"], "no_such_level"),
        (vec!["study", "gingerbread", "--integrators", "Magic"], "SymplecticEuler"),
        (vec!["study", "gingerbread", "--steps", "0"], "substeps must be at least 1 and at most 100000, got 0"),
        (vec!["study", "gingerbread", "--measure", "mood"], "deflection, energy or stress"),
    ] {
        let output = gingerbread(&arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let told = said(&output.stderr);
        assert!(told.contains(expected), "{arguments:?}: {told}");
    }
}

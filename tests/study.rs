//! Promises about what accuracy costs: errors against better references, diagrams, suggestions, and that all of it repeats.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

mod common;

use common::{level, released, released_of};
use gingerbread::{
    command::Command,
    integrators::{Class, IntegratorKind},
    level::{Level, Substeps},
    meshes::NoFiles,
    sandbox::Sandbox,
    study::{
        Drift, Invariant, Locking, Measure, MeshMoment, MeshPlan, MeshStudy, Plan, Price, ReferenceJob, Run, Setting,
        Source, Status, Trial, WorkPrecision, is_time_column,
    },
};
use std::time::Duration;

const WHOLE: Duration = Duration::MAX;

fn trial(level: &Level, seconds: f64) -> Trial {
    Trial::new(level, &NoFiles, seconds).unwrap()
}

fn substeps(counts: &[u32]) -> Vec<Substeps> {
    counts.iter().map(|count| Substeps::new(*count).unwrap()).collect()
}

fn kind(name: &str) -> IntegratorKind {
    IntegratorKind::all().into_iter().find(|kind| kind.name() == name).unwrap()
}

fn setting(name: &str, count: u32) -> Setting {
    Setting { integrator: kind(name), substeps: Substeps::new(count).unwrap() }
}

fn diagram(level: &Level, seconds: f64, plan: Plan) -> WorkPrecision {
    let mut diagram = WorkPrecision::new(trial(level, seconds), plan);
    assert!(diagram.advance(WHOLE).unwrap().finished);
    diagram
}

#[test]
fn the_automatic_diagram_has_a_line_for_every_integrator_and_keeps_what_blew_up() {
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

#[test]
fn a_reference_is_a_hundred_times_better_than_asked_and_off_by_no_more_than_it_says() {
    let trial = trial(&released(""), 0.1);
    let rough = reference_of(&trial, 1e-4);
    assert!(rough.own_error <= 1e-6 && rough.own_error > 0.0);
    let finer = reference_of(&trial, 1e-10);
    let Source::Fine(setting) = &rough.source else { unreachable!("nothing here is known exactly") };
    let outcome = Run::new(&trial, setting).advance(&trial, &finer, WHOLE).unwrap();
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

#[test]
fn toys_and_a_bouncing_spring_are_measured_against_their_closed_forms() {
    let spring = "(name: \"bounce\", nets: [(name: \"s\", net: Chain(from: (0.5, 0.9), to: (0.5, 0.4), springs: 1, stiffness: 100, rest: 0.4),
        mass: 1, pins: [Vertex(0)])], effects: [(effect: Gravity(down: 9.8)), (effect: MouseSpring(stiffness: 100))])";
    let circle = "(name: \"circle\", integrator: Heun(), toy: Circle(radius: 0.3))";
    let pendulum = "(name: \"pendulum\", integrator: Heun(), toy: Pendulum(length: 0.4, gravity: 9.8, start: 90))";
    for (text, least) in [(spring, 10), (circle, 4), (pendulum, 4)] {
        let plan = Plan { substeps: substeps(&[2, 4, 8, 16]), ..Plan::default() };
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
fn walls_that_are_touched_leave_a_reference_that_says_how_good_it_is() {
    let effects = "effects: [(effect: Gravity(down: 20)), (effect: Boundary(least: (0, 0.28), greatest: (1, 1)))]";
    let reference = reference_of(&trial(&released(effects), 0.2), 1e-2);
    assert!(reference.own_error > 0.0 && reference.own_error < 0.05, "{:e}", reference.own_error);
}

#[test]
fn a_suggestion_applied_and_rerun_from_scratch_keeps_its_promise() {
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
        let outcome = Run::new(&again, &again.current).advance(&again, &reference, WHOLE).unwrap();
        assert_eq!(outcome.error, suggestion.outcome.error, "{suggestion}");
    }
    let sentence = diagram.suggest(0.01, Price::Time).unwrap().to_string();
    assert!(sentence.contains("than now"), "it says what it would save: {sentence}");
    assert!(diagram.suggest(1e-30, Price::Time).is_none(), "nothing is promised that was not measured");
}

/// The table without its measured times.
fn without_times(csv: &str) -> Vec<Vec<String>> {
    let (head, rows): (Vec<_>, Vec<_>) = csv.lines().partition(|line| line.starts_with('#'));
    let columns: Vec<_> = rows[0].split(',').map(|name| !is_time_column(name)).collect();
    assert!(columns.contains(&false), "times are in columns of their own");
    let keep = |row: &&str| {
        let cells = row.split(',').zip(&columns);
        cells.filter(|(_, keep)| **keep).map(|(cell, _)| cell.to_owned()).collect::<Vec<_>>()
    };
    let head = head.iter().map(|line| vec![(*line).to_owned()]);
    head.chain(rows.iter().map(keep)).collect()
}

#[test]
fn two_tables_are_equal_but_for_their_times_whatever_the_budget_and_the_threads() {
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
        let now: Vec<_> = job.curves().into_iter().flat_map(|curve| curve.points).map(|point| point.outcome).collect();
        if !seen.is_empty() {
            let pairs = seen.iter().zip(&now);
            assert!(pairs.into_iter().all(|(before, now): (&Option<_>, _)| before.is_none() || before == now));
        }
        seen = now;
    }
    assert!(job.curves().iter().all(|curve| curve.points.iter().all(|point| point.outcome.is_some())));
}

fn bar(columns: u32, rows: u32) -> Level {
    level(&format!(
        "(name: \"bar\", bodies: [(name: \"bar\", mass: Density(1000), pins: [Left],
            mesh: Rectangle(width: 0.8, height: 0.1, columns: {columns}, rows: {rows}, diagonals: Crossed, corner: (0.1, 0.6)),
            material: (model: NeoHookean, young: 400000, poisson: 0.3, plane: Stress))], effects: [(effect: Gravity(down: 1))])"
    ))
}

#[test]
fn finer_meshes_come_nearer_and_the_order_is_that_of_linear_triangles() {
    for measure in Measure::ALL {
        let plan = MeshPlan { measure, triangles: vec![64, 256, 1024, 4096], threads: 2, ..MeshPlan::default() };
        let mut study = MeshStudy::new(&bar(16, 4), &NoFiles, 1.0, plan).unwrap();
        while !study.advance(Duration::from_millis(50)).finished {}
        let errors: Vec<_> = study.points().map(|point| study.error_of(point).unwrap()).collect();
        let points: Vec<_> = study.points().collect();
        assert!(errors.windows(2).all(|pair| pair[1] < pair[0]), "{measure:?}: {errors:?} {points:?}");
        let order = study.order().unwrap();
        assert!((1.0..2.3).contains(&order), "{measure:?}: order {order}");
        let (_, own) = study.reference().unwrap();
        assert!(own < 0.02, "{measure:?}: {own}");
        assert!(study.csv(&[]).contains("measured_order"));
    }
}

#[test]
fn meshes_are_compared_at_the_end_of_a_time_where_nothing_rests() {
    let plan = |moment| MeshPlan { moment, measure: Measure::ElasticEnergy, triangles: vec![24, 96, 384], threads: 1 };
    let refused = MeshStudy::new(&released(""), &NoFiles, 0.1, plan(MeshMoment::AtRest)).err().unwrap().to_string();
    assert!(refused.contains("does not hold"), "{refused}");
    let mut study = MeshStudy::new(&released(""), &NoFiles, 0.1, plan(MeshMoment::AtTheEnd)).unwrap();
    while !study.advance(Duration::from_millis(50)).finished {}
    assert_eq!(study.points().map(|point| point.triangles).collect::<Vec<_>>(), [24, 96, 384]);
    assert!(study.points().all(|point| point.value.is_some_and(|value| value > 0.0)));
}

#[test]
fn linear_triangles_lock_when_nearly_incompressible_and_the_number_says_how_much() {
    let mut locking = Locking::new(&bar(16, 2), &NoFiles).unwrap();
    while !locking.advance().finished {}
    let numbers = locking.numbers();
    let [ordinary, tight] = numbers.as_slice() else { unreachable!("two Poisson's ratios") };
    assert_eq!(tight.poisson, 0.4999);
    assert!(ordinary.ratio() > 0.5 && ordinary.ratio() < 1.0, "{}", ordinary.ratio());
    assert!(tight.ratio() < 0.3 * ordinary.ratio(), "{} against {}", tight.ratio(), ordinary.ratio());
}

/// Frames of a live simulation with its twin.
#[test]
fn drift_shows_who_keeps_energy_and_that_nobody_loses_momentum() {
    let trial = trial(&released(""), 0.5);
    let settings = vec![setting("ForwardEuler", 400), setting("SymplecticEuler", 50), setting("ImplicitEuler", 20)];
    let mut drift = Drift::new(trial, settings, 2);
    while !drift.advance(Duration::from_millis(20)).finished {}
    let [forward, symplectic, implicit] = drift.runs() else { unreachable!("three settings") };
    let change = |run: &gingerbread::study::DriftRun| run.moments.last().unwrap().energy / run.moments[0].energy - 1.0;
    assert!(forward.fault().is_some() || change(forward) > 0.05, "forward Euler gains");
    let bounded = drift.greatest_change(symplectic, Invariant::Energy);
    assert!(bounded < 0.1, "{bounded}");
    assert!(change(implicit) < -0.05, "implicit Euler loses: {}", change(implicit));
    assert_eq!(symplectic.moments.len(), 31);
    for moment in &symplectic.moments {
        assert!(moment.momentum.iter().all(|p| p.abs() < 1e-12) && moment.angular.abs() < 1e-12, "{moment:?}");
    }
    assert!(drift.csv().lines().count() > 90);
}

/// A drift study of a level, worked on like this to its end.
fn drift(level: &Level, seconds: f64, settings: Vec<Setting>, threads: usize, budget: Duration) -> Drift {
    let mut drift = Drift::new(trial(level, seconds), settings, threads);
    while !drift.advance(budget).finished {}
    drift
}

#[test]
fn symplectic_euler_keeps_its_energy_error_bounded_while_that_of_forward_euler_grows() {
    let settings = vec![setting("SymplecticEuler", 40), setting("ForwardEuler", 4000)];
    let drift = drift(&released_of(100, ""), 4.0, settings, 2, WHOLE);
    let [symplectic, forward] = drift.runs() else { unreachable!("two settings") };
    let halves = |run: &gingerbread::study::DriftRun| {
        [0..121, 121..241].map(|frames| {
            let changes = run.moments[frames].iter().map(|moment| drift.change(run, Invariant::Energy, moment));
            changes.fold(0.0_f64, |greatest, change| greatest.max(change.abs()))
        })
    };
    let ([bounded, later], [small, grown]) = (halves(symplectic), halves(forward));
    assert!(bounded > 1e-4 && later < 1.5 * bounded, "{bounded} then {later}");
    assert!(grown > 1.7 * small, "{small} then {grown}");
    let gains = forward.moments.windows(2).all(|pair| pair[1].energy > pair[0].energy);
    assert!(gains, "it gains in every frame");
}

#[test]
fn drift_and_mesh_tables_repeat_but_for_their_times_whatever_the_budget_and_the_threads() {
    let names = ["ForwardEuler", "VelocityVerlet", "DormandPrince", "ImplicitMidpoint"];
    let settings = || names.map(|name| setting(name, 20)).to_vec();
    let tables = [(1, WHOLE), (3, Duration::from_micros(200))]
        .map(|(threads, budget)| drift(&released(""), 0.2, settings(), threads, budget).csv());
    let rows =
        |csv: &str| csv.lines().filter(|line| !line.starts_with("# threads")).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(rows(&tables[0]), rows(&tables[1]));
    assert!(tables[0].lines().count() > 4 * 12);

    let tables = [(1, WHOLE), (3, Duration::from_micros(200))].map(|(threads, budget)| {
        let plan = MeshPlan { triangles: vec![64, 256, 1024], threads, ..MeshPlan::default() };
        let mut study = MeshStudy::new(&bar(16, 4), &NoFiles, 1.0, plan).unwrap();
        while !study.advance(budget).finished {}
        study.csv(&[])
    });
    let rows =
        |csv: &str| without_times(csv).into_iter().filter(|row| !row[0].starts_with("# threads")).collect::<Vec<_>>();
    assert_eq!(rows(&tables[0]), rows(&tables[1]));
}

#[test]
fn the_head_of_every_table_says_where_its_numbers_come_from() {
    let drift = drift(&released(""), 0.05, vec![setting("RungeKutta4", 20)], 1, WHOLE).csv();
    let plan = MeshPlan { triangles: vec![64, 256, 1024], threads: 1, ..MeshPlan::default() };
    let mut study = MeshStudy::new(&bar(16, 4), &NoFiles, 1.0, plan).unwrap();
    while !study.advance(WHOLE).finished {}
    let mut locking = Locking::new(&bar(16, 2), &NoFiles).unwrap();
    while !locking.advance().finished {}
    let meshes = study.csv(&locking.numbers());
    let general = ["level: ", "start_hash: ", "commit: ", "processor: ", "threads: 1", "simulated_seconds: "];
    let own = [
        (&drift, ["energy_scale_j: ", "energy_is_changed_by: ", "momentum_is_changed_by: "]),
        (&meshes, ["reference: ", "reference_error_at_most: ", "locking_at_nu_0.4999: "]),
    ];
    for (table, own) in own {
        for entry in general.into_iter().chain(own) {
            assert!(
                table.contains(&format!("\n# {entry}")) || table.starts_with(&format!("# {entry}")),
                "{entry}: {table}"
            );
        }
    }
}

#[test]
fn what_takes_energy_and_momentum_by_right_is_named() {
    let settings = || vec![setting("SymplecticEuler", 40)];
    let free = drift(&released(""), 0.1, settings(), 1, WHOLE);
    assert!(Invariant::ALL.into_iter().all(|invariant| free.changed_by(invariant).is_empty()));
    let effects = "effects: [(effect: Gravity(down: 20)), (effect: Boundary(least: (0, 0.28), greatest: (1, 1)))]";
    let fallen = drift(&released(effects), 0.2, settings(), 1, WHOLE);
    assert_eq!(fallen.changed_by(Invariant::Energy), ["walls that are touched"]);
    assert_eq!(fallen.changed_by(Invariant::Momentum), ["walls that are touched", "gravity"]);
    let chain = drift(&built_in("chain"), 0.1, settings(), 1, WHOLE);
    assert_eq!(chain.changed_by(Invariant::Energy), ["damping"]);
    assert_eq!(chain.changed_by(Invariant::AngularMomentum), ["damping", "gravity", "pins"]);
    let strip = drift(&built_in("uniaxial_strip"), 0.05, settings(), 1, WHOLE);
    assert!(strip.changed_by(Invariant::Momentum).contains(&"sides that slide"));
    let circle = drift(&built_in("circle"), 0.5, vec![setting("ForwardEuler", 4)], 1, WHOLE);
    assert_eq!(circle.nothing_of(Invariant::Energy), None);
    assert!(circle.nothing_of(Invariant::Momentum).is_some_and(|words| words.contains("toy")));
    let still = drift(&level(RESTING), 0.1, settings(), 1, WHOLE);
    assert!(still.nothing_of(Invariant::Energy).is_some_and(|words| words.contains("Hardly anything moves")));
}

/// A sheet on which nothing acts.
const RESTING: &str = "(name: \"resting\", substeps: 20, bodies: [(name: \"sheet\", mass: Density(1),
    mesh: Rectangle(width: 0.4, height: 0.3, columns: 8, rows: 6, corner: (0.3, 0.3)),
    material: (model: NeoHookean, young: 100, poisson: 0.3))])";

fn built_in(name: &str) -> Level {
    gingerbread::files::parse(gingerbread::levels::built_in(name).unwrap(), name).unwrap()
}

#[test]
fn nets_and_toys_have_a_diagram_with_what_blew_up_marked_as_such() {
    let mut unstable = 0;
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
            unstable += outcomes.iter().filter(|outcome| outcome.status == Status::Unstable).count();
        }
    }
    assert!(unstable > 0, "some of the long steps are too long");
}

#[test]
fn a_mesh_study_says_in_words_where_it_has_nothing_to_say() {
    for name in ["chain", "hanging_net", "spring_pendulum", "circle", "pendulum"] {
        let plan = MeshPlan { moment: MeshMoment::AtTheEnd, ..MeshPlan::default() };
        let refused = MeshStudy::new(&built_in(name), &NoFiles, 0.1, plan).err().unwrap().to_string();
        assert!(refused.contains("no mesh of this level has a resolution"), "{name}: {refused}");
    }
    let remark = |level: &Level, moment| {
        let plan = MeshPlan { moment, triangles: vec![12, 48, 96], threads: 1, ..MeshPlan::default() };
        let mut study = MeshStudy::new(level, &NoFiles, 0.05, plan).unwrap();
        while !study.advance(WHOLE).finished {}
        assert_eq!((study.reference(), study.order()), (None, None), "there is no error of what tells nothing");
        study.remark().unwrap()
    };
    assert!(remark(&level(RESTING), MeshMoment::AtTheEnd).contains("Nothing moves"));
    assert!(remark(&built_in("stretch_test"), MeshMoment::AtRest).contains("pins prescribe"));
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
    let mut error_controlled = kind("DormandPrince");
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

fn gingerbread(arguments: &[&str]) -> std::process::Output {
    std::process::Command::new(env!("CARGO_BIN_EXE_gingerbread")).args(arguments).output().unwrap()
}

#[test]
fn the_program_prints_a_table_writes_csv_and_names_what_it_knows() {
    let folder = std::env::temp_dir().join(format!("gingerbread-study-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let (file, csv) = (folder.join("sheet.ron"), folder.join("out.csv"));
    std::fs::write(&file, gingerbread::files::write(&released("")).unwrap()).unwrap();
    let (file, csv) = (file.display().to_string(), csv.display().to_string());
    let chosen =
        ["study", &file, "--integrators", "SymplecticEuler,rungekutta4", "--steps", "20,40", "--seconds", "0.05"];
    let output = gingerbread(&[&chosen[..], &["--csv", &csv]].concat());
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(said.contains("reference:") && said.contains("Cheapest under 1 %") && said.contains("<- now"), "{said}");
    let table = std::fs::read_to_string(&csv).unwrap();
    assert_eq!(table.lines().filter(|line| !line.starts_with('#')).count(), 1 + 4, "{table}");
    let output = gingerbread(&[&chosen[..], &["--drift", "--csv", &csv]].concat());
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(said.contains("greatest change of") && said.contains("Runge-Kutta 4, 40 steps a frame"), "{output:?}");
    let table = std::fs::read_to_string(&csv).unwrap();
    assert_eq!(table.lines().filter(|line| !line.starts_with('#')).count(), 1 + 4 * 4, "{table}");
    let output = gingerbread(&["study", &file, "--meshes", "24,96,384", "--measure", "energy", "--seconds", "0.05"]);
    assert!(String::from_utf8_lossy(&output.stdout).contains("triangles"), "{output:?}");
    for (arguments, expected) in [
        (vec!["study", "no_such_level"], "no_such_level"),
        (vec!["study", "gingerbread", "--integrators", "Magic"], "SymplecticEuler"),
        (vec!["study", "gingerbread", "--steps", "0"], "[1, 100000]"),
        (vec!["study", "gingerbread", "--measure", "mood"], "deflection or energy"),
    ] {
        let output = gingerbread(&arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(told.contains(expected), "{arguments:?}: {told}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

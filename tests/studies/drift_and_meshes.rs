//! Promises about studies of drift and of meshes: who keeps what, which order finer meshes have, and that both repeat.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{
    built_in, level, released, released_of,
    studies::{RESTING, WHOLE, setting, trial, without_times},
};
use gingerbread::{
    elements::ElementKind,
    level::Level,
    meshes::NoFiles,
    study::{
        Drift, Invariant, Locking, Measure, MeshMoment, MeshPlan, MeshSeries, MeshStudy, NoMeshReference, NoOrder,
        Setting, Status,
    },
};
use std::time::Duration;

fn bar(columns: u32, rows: u32) -> Level {
    bar_of(columns, rows, "Crossed", 0.3)
}

fn bar_of(columns: u32, rows: u32, diagonals: &str, poisson: f64) -> Level {
    let plane = if poisson > 0.49 { "Strain" } else { "Stress" };
    level(&format!(
        "(name: \"bar\", bodies: [(name: \"bar\", mass: Density(1000), pins: [Left],
            mesh: Rectangle(width: 0.8, height: 0.1, columns: {columns}, rows: {rows}, diagonals: {diagonals}, corner: (0.1, 0.6)),
            material: (model: NeoHookean, young: 400000, poisson: {poisson}, plane: {plane}))], effects: [(effect: Gravity(down: 1))])"
    ))
}

#[test]
fn mesh_errors_have_the_order_of_linear_triangles() {
    // The stress has no limit in the corners of a clamped end.
    for measure in [Measure::TipDeflection, Measure::ElasticEnergy] {
        let plan = MeshPlan { measure, triangles: vec![256, 1024, 4096, 16384], threads: 2, ..MeshPlan::default() };
        let mut study = MeshStudy::new(&bar(16, 4), &NoFiles, 1.0, plan).unwrap();
        while !study.advance(Duration::from_millis(50)).finished {}
        let errors: Vec<_> = study.points().map(|point| study.error_of(point).unwrap()).collect();
        let points: Vec<_> = study.points().collect();
        assert!(errors.windows(2).all(|pair| pair[1] < pair[0]), "{measure:?}: {errors:?} {points:?}");
        let order = study.order(MeshSeries::default()).unwrap();
        assert!((1.0..2.3).contains(&order), "{measure:?}: order {order}");
        let own = study.reference().unwrap().unwrap().own_error;
        assert!(own < 0.02, "{measure:?}: {own}");
        assert!(study.csv(&[]).contains("measured_order"));
    }
}

#[test]
fn meshes_that_never_rest_are_compared_at_a_final_time() {
    let plan = |moment| MeshPlan {
        moment,
        measure: Measure::ElasticEnergy,
        triangles: vec![24, 96, 384],
        threads: 1,
        ..MeshPlan::default()
    };
    let refused = MeshStudy::new(&released(""), &NoFiles, 0.1, plan(MeshMoment::AtRest)).err().unwrap().to_string();
    assert!(refused.contains("does not hold"), "{refused}");
    let mut study = MeshStudy::new(&released(""), &NoFiles, 0.1, plan(MeshMoment::AtTheEnd)).unwrap();
    while !study.advance(Duration::from_millis(50)).finished {}
    assert_eq!(study.points().map(|point| point.triangles).collect::<Vec<_>>(), [24, 96, 384]);
    assert!(study.points().all(|point| point.value.is_some_and(|value| value > 0.0)));
}

#[test]
fn locking_is_that_of_the_levels_own_mesh_and_says_of_which() {
    let numbers = |level: &Level| {
        let mut locking = Locking::new(level, &NoFiles).unwrap();
        while !locking.advance().finished {}
        locking.numbers()
    };
    let grid = bar_of(16, 2, "Grid", 0.3);
    for (level, cut, locks) in [(grid, "Grid", true), (bar(16, 2), "Crossed", false)] {
        let numbers = numbers(&level);
        let [ordinary, tight] = numbers.as_slice() else { unreachable!("two Poisson's ratios") };
        assert_eq!(tight.poisson, 0.4999);
        assert!(ordinary.ratio() > 0.5 && ordinary.ratio() < 1.0, "{}", ordinary.ratio());
        assert_eq!(tight.ratio() < 0.3 * ordinary.ratio(), locks, "{cut}: {} and {}", tight.ratio(), ordinary.ratio());
        let triangles = if locks { 64 } else { 128 };
        let words = tight.words();
        let own = format!("on the level's own mesh ({triangles} triangles, diagonals {cut})");
        assert!(words.contains(&own) && !words.contains("at most"), "{words}");
    }
    let outline = level(
        "(name: \"bar\", bodies: [(name: \"bar\", mass: Density(1000), pins: [Left], mesh: Outline(points: [(0.1, 0.6), (0.9, 0.6),
          (0.9, 0.7), (0.1, 0.7)], resolution: 100),
          material: (model: NeoHookean, young: 400000, poisson: 0.3))], effects: [(effect: Gravity(down: 1))])",
    );
    let words = numbers(&outline)[1].words();
    assert!(words.starts_with("at most ") && words.contains("which may lock too"), "{words}");
}

/// Kinds of elements are compared on meshes of as many triangles, and one that the level cannot have is left out with the reason.
#[test]
fn kinds_of_elements_are_compared() {
    let typed = level(
        "(name: \"bar\", bodies: [(name: \"bar\", mass: Density(1000), pins: [Left],
          mesh: Rectangle(width: 0.8, height: 0.1, columns: 32, rows: 4, diagonals: Crossed, corner: (0.1, 0.6)),
          energy: (formula: \"mu/2*(I1 - 2 - 2*log(J)) + lambda/2*log(J)^2\"),
          material: (model: NeoHookean, young: 400000, poisson: 0.3))], effects: [(effect: Gravity(down: 1))])",
    );
    for (level, kinds) in [(bar(32, 4), 3), (typed, 2)] {
        let elements = ElementKind::ALL.to_vec();
        let plan = MeshPlan { triangles: vec![128, 512, 2048], elements, threads: 1, ..MeshPlan::default() };
        let mut study = MeshStudy::new(&level, &NoFiles, 1.0, plan).unwrap();
        while !study.advance(WHOLE).finished {}
        assert_eq!(study.series().len(), kinds);
        assert!(study.points().all(|point| point.value.is_some() && [128, 512, 2048].contains(&point.triangles)));
        let left_out =
            study.left_out().iter().all(|(kind, why)| *kind == ElementKind::MeanDilatation && why.contains("volume"));
        assert!(left_out && study.left_out().len() == 3 - kinds);
        // Quadratic elements are far more exact with as many triangles, so that a coarser mesh is enough.
        let errors = |kind| {
            study
                .points()
                .filter(move |point| point.series.element == Some(kind))
                .map(|point| study.error_of(point).unwrap())
        };
        assert!(errors(ElementKind::Quadratic).zip(errors(ElementKind::Linear)).all(|(one, other)| one < 0.2 * other));
        let [.., [point, finest]] = *study.as_exact() else { unreachable!("quadratic elements are as exact") };
        assert_eq!(
            [point.series.element, finest.series.element],
            [Some(ElementKind::Quadratic), Some(ElementKind::Linear)]
        );
        assert!(point.triangles <= 512 && finest.triangles == 2048, "{point:?}");
        assert_eq!(study.as_exact_in_words().len(), study.as_exact().len());
    }
}

#[test]
fn meshes_that_lock_have_no_reference_and_no_errors() {
    let plan = MeshPlan { triangles: vec![32, 128, 512], threads: 1, ..MeshPlan::default() };
    let mut study = MeshStudy::new(&bar_of(16, 2, "Grid", 0.4999), &NoFiles, 1.0, plan).unwrap();
    while !study.advance(WHOLE).finished {}
    let refused = study.reference().unwrap().err().unwrap();
    let NoMeshReference::NotShrinking { order, finest, last, .. } = refused else { unreachable!("{refused:?}") };
    assert!(order.unwrap() < 0.5 && last > 0.1 && Some(finest) == study.points().last().unwrap().value);
    assert!(study.points().all(|point| point.value.is_some() && study.error_of(point).is_none()));
    assert_eq!(study.order(MeshSeries::default()), Err(NoOrder::NoReference));
    let csv = study.csv(&[]);
    let told = "# reference: No reference: the meshes' differences do not shrink as h^p with 0.5 <= p <= 2.5";
    assert!(csv.contains(told) && csv.contains("# measured_order: not measurable here: no reference"), "{csv}");
}

#[test]
fn walls_touched_by_unstable_runs_alone_are_ignored() {
    let effects = "effects: [(effect: Boundary(least: (-1, -1), greatest: (2, 2)))]";
    let settings = vec![setting("SymplecticEuler", 40), setting("VelocityVerlet", 40), setting("ForwardEuler", 10)];
    let drift = drift(&released(effects), 1.0, settings, 1, WHOLE);
    let [symplectic, verlet, forward] = drift.runs() else { unreachable!("three settings") };
    assert!(forward.touches() && drift.status(forward) == Status::Unstable, "it flies apart, to the walls");
    assert!([symplectic, verlet].iter().all(|run| !run.touches() && drift.status(run) == Status::Ok));
    assert_eq!(drift.touching().count(), 0);
    assert!(Invariant::ALL.into_iter().all(|invariant| drift.changed_by(invariant).is_empty()));
    let csv = drift.csv();
    let row = |name: &str| csv.lines().find(|line| line.starts_with(name)).unwrap().split(',').collect::<Vec<_>>();
    assert_eq!(row("SymplecticEuler")[3..5], ["ok", "false"]);
    assert_eq!(row("ForwardEuler")[3..5], ["unstable", ""]);
}

#[test]
fn drift_with_several_steps_has_an_order_with_damping_too() {
    let settings = |name| [100, 200, 400].map(|count| setting(name, count)).to_vec();
    let free = drift(&released(""), 0.05, settings("VelocityVerlet"), 1, WHOLE);
    let [(_, order)] = free.orders()[..] else { unreachable!("one scheme") };
    assert!((order.unwrap() - 2.0).abs() < 0.2, "{order:?}");
    for (name, expected, steps) in [
        ("SymplecticEuler", 1.0, [200, 400, 800]),
        ("VelocityVerlet", 2.0, [100, 200, 400]),
        ("RungeKutta4", 4.0, [50, 100, 200]),
    ] {
        let settings = steps.map(|count| setting(name, count)).to_vec();
        let damped = released("effects: [(effect: Rayleigh(mass: 1, stiffness: 0.001))]");
        let damped = drift(&damped, 0.05, settings, 1, WHOLE);
        let order = *damped.orders()[0].1.as_ref().unwrap();
        assert!((order - expected).abs() < 0.25, "{name}: {order}");
    }
    let still = drift(&level(RESTING), 0.1, settings("VelocityVerlet"), 1, WHOLE);
    assert_eq!(still.orders()[0].1, Err(NoOrder::NothingMoves));
    let csv = still.csv();
    assert!(csv.contains("# remark: Almost nothing moves") && !csv.contains("NaN") && !csv.contains("inf"), "{csv}");
}

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
        assert!(moment.momentum.iter().chain(&moment.angular).all(|p| p.abs() < 1e-12), "{moment:?}");
    }
    assert!(drift.csv().lines().count() > 90);
}

/// A drift study of a level, worked on like this to its end.
fn drift(level: &Level, seconds: f64, settings: Vec<Setting>, threads: usize, budget: Duration) -> Drift {
    let mut drift = Drift::new(trial(level, seconds), settings, threads);
    while !drift.advance(budget).finished {}
    drift
}

/// The energy of forward Euler grows in every frame.
#[test]
fn symplectic_euler_bounds_its_energy_error() {
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

/// Budget and number of threads change only the measured times.
#[test]
fn drift_and_mesh_tables_are_reproducible() {
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
        (&meshes, ["reference: ", "reference_error_estimate: ", "locking_at_nu_0.4999: "]),
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
    assert_eq!(fallen.touching().count(), 1, "walls change what they touch");
    assert_eq!(fallen.changed_by(Invariant::Momentum), ["gravity"]);
    let chain = drift(&built_in("chain"), 0.1, settings(), 1, WHOLE);
    assert!(chain.changed_by(Invariant::Energy).is_empty(), "what damping takes is counted");
    assert_eq!(chain.changed_by(Invariant::AngularMomentum), ["damping", "gravity", "pins"]);
    let strip = drift(&built_in("uniaxial_strip"), 0.05, settings(), 1, WHOLE);
    assert!(strip.changed_by(Invariant::Momentum).contains(&"rollers"));
    let circle = drift(&built_in("circle"), 0.5, vec![setting("ForwardEuler", 4)], 1, WHOLE);
    assert_eq!(circle.nothing_of(Invariant::Energy), None);
    assert!(circle.nothing_of(Invariant::Momentum).is_some_and(|words| words.contains("toy")));
    let still = drift(&level(RESTING), 0.1, settings(), 1, WHOLE);
    assert!(still.nothing_of(Invariant::Energy).is_some_and(|words| words.contains("Almost nothing moves")));
}

#[test]
fn a_mesh_study_says_in_words_where_it_has_nothing_to_say() {
    for name in ["chain", "hanging_net", "spring_pendulum", "circle", "pendulum"] {
        let plan = MeshPlan { moment: MeshMoment::AtTheEnd, ..MeshPlan::default() };
        let refused = MeshStudy::new(&built_in(name), &NoFiles, 0.1, plan).err().unwrap().to_string();
        assert!(refused.contains("no mesh of this level has a resolution"), "{name}: {refused}");
    }
    let refused = |level: &Level, moment| {
        let plan = MeshPlan { moment, triangles: vec![12, 48, 96], threads: 1, ..MeshPlan::default() };
        let mut study = MeshStudy::new(level, &NoFiles, 0.05, plan).unwrap();
        while !study.advance(WHOLE).finished {}
        assert!(
            study.order(MeshSeries::default()).is_err() && study.points().all(|point| study.error_of(point).is_none())
        );
        study.reference().unwrap().err().unwrap().to_string()
    };
    assert!(refused(&level(RESTING), MeshMoment::AtTheEnd).contains("Nothing moves"));
    assert!(refused(&built_in("stretch_test"), MeshMoment::AtRest).contains("pins prescribe"));
}

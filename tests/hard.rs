//! The gallery of hard cases: every run is stable, or the file of its case says why it cannot be.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a failing test should panic")]

mod common;

use gingerbread::{
    fault::{Cause, Culprit},
    files,
    guard::Guard,
    hard::{
        Account, COLUMNS, Case, Entry, Expects, Experiment, Failure, Fence, Lasts, Method, Quantity, Run, Sweep, Trial,
        Verdict,
        random::{Outcome, Variation},
        row,
    },
    inversion_recovery::Tangle,
    level::{Level, Substeps},
    levels::HARD,
    materials::{Model, TypedEnergy},
    meshes::NoFiles,
    quantity::Spin,
    report::Energies,
    scene::Scene,
    simulation::Simulation,
    study::threads,
};
use std::{
    fs,
    path::Path,
    sync::{Arc, Mutex},
    thread,
    time::Duration,
};

fn case(name: &str) -> Case {
    Case::read(Path::new(name)).unwrap()
}

fn to_the_end(mut run: Run) -> Verdict {
    run.finish().unwrap()
}

fn verdict(case: &Case, model: Model, method: Method) -> Verdict {
    to_the_end(Run::new(case, model, method).unwrap())
}

/// A typed energy is judged as the model whose formula it is, by every method, in the plane and in space.
#[test]
fn a_typed_energy_is_judged_as_the_model_that_it_copies() {
    let typed = Arc::new(TypedEnergy::new(TypedEnergy::NEO_HOOKEAN, Vec::new()).unwrap());
    for (name, methods) in [("stretch_2", &Method::ALL[..]), ("cloth_needle", &[Method::ImplicitEuler])] {
        for method in methods {
            let own = case(name);
            let level = own.clone().with_energy(Some(Arc::clone(&typed))).level(Case::TYPED, *method);
            let mut energies =
                level.bodies.iter().map(|body| &body.energy).chain(level.membranes.iter().map(|one| &one.energy));
            assert!(energies.all(|energy| energy.as_ref() == Some(&*typed)), "{name}");
            let [built_in, typed] = [None, Some(Arc::clone(&typed))]
                .map(|energy| verdict(&own.clone().with_energy(energy), Case::TYPED, *method));
            assert_eq!(typed.is_stable(), built_in.is_stable(), "{name} {method:?}");
            if !typed.is_stable() {
                continue;
            }
            let strains = [&built_in, &typed].map(|verdict| verdict.numbers.strain.unwrap_or_default());
            assert!((strains[0] - strains[1]).abs() <= 1e-3 * strains[0].abs() + 1e-9, "{name} {method:?} {strains:?}");
        }
    }
}

/// Cell of a line of a table, by its column.
fn cell<'a>(line: &'a str, column: &str) -> &'a str {
    let number = COLUMNS.split(',').position(|name| name == column).unwrap();
    line.split(',').nth(number).unwrap_or_default()
}

/// How good a recorded run is: unstable, stable but far from its reference, held.
fn rank(line: &str) -> u32 {
    u32::from(cell(line, "stable") == "yes") + u32::from(cell(line, "held") == "yes")
}

/// Case, whether it is undamped, model and method of a line of a table.
fn run_of(line: &str) -> String {
    line.split(',').take(4).collect::<Vec<_>>().join(",")
}

/// The lines of a table that are worse than recorded, better, or only other.
fn differences(known: &[String], table: &[String]) -> [String; 3] {
    let mut found = [const { String::new() }; 3];
    for line in table {
        let old = known.iter().find(|old| run_of(old) == run_of(line));
        let kind = match (old.map_or(2, |old| rank(old)), rank(line)) {
            _ if old == Some(line) => continue,
            (before, now) if now < before => 0,
            (before, now) if now > before => 1,
            _ => 2,
        };
        found[kind].extend(["\n  ", line.as_str()]);
    }
    found
}

#[test]
fn worse_better_and_moved_results_are_told_apart() {
    let table = |lines: &[&str]| lines.iter().map(|line| (*line).to_owned()).collect::<Vec<_>>();
    let known = table(&["a,no,M,I,yes,yes,1", "b,no,M,I,yes,yes,1", "c,no,M,I,no,no,1", "d,no,M,I,yes,yes,1"]);
    let now = table(&[
        "a,no,M,I,yes,yes,1",
        "b,no,M,I,no,yes,2",
        "c,no,M,I,no,yes,3",
        "d,no,M,I,yes,yes,4",
        "a,yes,M,I,no,no,5",
    ]);
    let [worse, better, moved] = differences(&known, &now);
    assert_eq!(worse, "\n  b,no,M,I,no,yes,2\n  a,yes,M,I,no,no,5");
    assert_eq!((better.as_str(), moved.as_str()), ("\n  c,no,M,I,no,yes,3", "\n  d,no,M,I,yes,yes,4"));
}

/// Which runs of the product of cases, models and methods are computed.
#[derive(Clone, Copy, PartialEq)]
enum Runs {
    /// One model for each case and for each undamped twin, with every sixth method, or one of two. Every case and
    /// every pair of a model and a method occur.
    Some,
    /// All of them.
    All,
}

impl Runs {
    fn holds(self, case: usize, model: usize, (method, methods): (usize, usize)) -> bool {
        let (models, period) = (Model::ALL.len(), methods.min(6));
        self == Self::All || model == case % models && (case / models + case + method).is_multiple_of(period)
    }
}

/// Runs cases with models and methods, and compares the verdicts with the record. A run that is not stable needs a reason in the
/// file of its case and an experiment that shows it, always; every other change asks for a new record. `GINGERBREAD_RENEW=1`
/// computes all runs and writes it.
fn compare(cases: Vec<(&str, Case)>, methods: &[Method], runs: Runs, record: &str) {
    let renews = std::env::var_os("GINGERBREAD_RENEW").is_some();
    let compares = methods.len() == Method::ALL.len();
    let (mut all, mut chosen) = (Vec::new(), Vec::new());
    for (case_number, (name, case)) in cases.into_iter().enumerate() {
        let case = Arc::new(case);
        for (model_number, &model) in Model::ALL.iter().enumerate() {
            for (method_number, &method) in methods.iter().enumerate() {
                let trial = Trial { name: name.to_owned(), case: Arc::clone(&case), model, method };
                if renews || runs.holds(case_number, model_number, (method_number, methods.len())) {
                    chosen.push(trial.clone());
                }
                all.push(trial);
            }
        }
    }
    let mut sweep = Sweep::new(chosen, threads(), compares);
    while !sweep.advance(Duration::from_hours(1)).finished {}
    let stated = |trial: &Trial| trial.case.cannot(trial.model, trial.method).and_then(|cannot| cannot.shown_by);
    let result = |(trial, entry): (&Trial, &Entry)| row(trial, &entry.verdict.clone().unwrap().unwrap(), None);
    let table: Vec<_> = sweep.entries().map(result).collect();
    if renews {
        fs::write(record, format!("{COLUMNS}\n{}\n", table.join("\n"))).unwrap();
    }
    let known = fs::read_to_string(record).unwrap_or_default();
    let known: Vec<_> = known.lines().skip(1).map(str::to_owned).collect();
    let [worse, better, moved] = differences(&known, &table);
    let unexplained: Vec<_> = known.iter().chain(&table).filter(|line| line.contains("UNEXPLAINED")).collect();
    assert!(
        unexplained.is_empty(),
        "not stable, and the file of the case does not say why it cannot be: {unexplained:#?}"
    );
    assert!(worse.is_empty(), "worse than recorded in {record}:{worse}");
    let names = all.iter().map(|Trial { name, case, model, method }| {
        let undamped = if case.is_undamped_twin() { "yes" } else { "no" };
        format!("{name},{undamped},{},{}", model.name(), method.name())
    });
    assert!(
        better.is_empty() && moved.is_empty() && names.eq(known.iter().map(|line| run_of(line))),
        "renew {record} with GINGERBREAD_RENEW=1; better now:{better}\nother numbers:{moved}"
    );
    for Trial { name, case, .. } in &all {
        for reason in &case.cannot {
            let used = all.iter().zip(&known).any(|(trial, line)| {
                trial.name == *name && rank(line) == 0 && trial.case.cannot(trial.model, trial.method) == Some(reason)
            });
            assert!(
                used || reason.fine || !compares,
                "{name}: take this reason away, as everything it names is stable: {}",
                reason.why
            );
        }
    }
    // Fine meshes share the experiments of the coarse ones.
    let open: Vec<_> = sweep.entries().filter(|(trial, _)| compares && stated(trial).is_some()).collect();
    let shown = open.into_iter().filter_map(|(trial, entry)| Some((trial, failure(entry)?)));
    let mut groups: Vec<Vec<(&Trial, Failure)>> = Vec::new();
    for (trial, failure) in shown {
        match groups
            .last_mut()
            .filter(|group| Arc::ptr_eq(&group[0].0.case, &trial.case) && group[0].0.model == trial.model)
        {
            Some(group) => group.push((trial, failure)),
            None => groups.push(vec![(trial, failure)]),
        }
    }
    let queue = Mutex::new(groups.into_iter());
    let wrong = Mutex::new(Vec::new());
    let next = || queue.lock().unwrap().next();
    thread::scope(|scope| {
        for _ in 0..threads() {
            scope.spawn(|| {
                while let Some(group) = next() {
                    let mut motion = None;
                    for (trial, failure) in group {
                        if !stated(trial).unwrap().shows_with(trial, failure, &mut motion).unwrap() {
                            wrong.lock().unwrap().push(trial);
                        }
                    }
                }
            });
        }
    });
    let wrong = wrong.into_inner().unwrap();
    assert!(wrong.is_empty(), "not shown by the experiment that the file states: {wrong:#?}");
}

fn failure(entry: &Entry) -> Option<Failure> {
    entry.verdict.clone()?.unwrap().failure
}

/// The built-in cases and their undamped twins.
fn all_cases() -> Vec<(&'static str, Case)> {
    let with_twin = |name| {
        let case = case(name);
        let twin = case.undamped_twin().map(|twin| (name, twin));
        std::iter::once((name, case)).chain(twin)
    };
    Case::names().flat_map(with_twin).collect()
}

/// If a run is not stable, the file of its case says why, and an experiment shows it.
#[test]
fn every_hard_case_is_stable_or_explained() {
    compare(all_cases(), &Method::ALL, Runs::Some, "tests/hard_cases.csv");
}

/// The same for the whole product of cases, models and methods.
#[test]
#[ignore = "takes an hour: cargo test --test hard -- --ignored every_run"]
fn every_run_of_every_hard_case_is_stable_or_explained() {
    compare(all_cases(), &Method::ALL, Runs::All, "tests/hard_cases.csv");
}

/// The hardest cases on meshes of 2000 triangles and for twice the time.
fn fine_cases() -> Vec<(&'static str, Case)> {
    let names = [
        "corner",
        "dragged_through",
        "far_drag",
        "incompressible_04999",
        "line",
        "mirror",
        "point",
        "pressed",
        "scramble",
        "stretch_2",
        "stretch_5",
        "thin_wall",
        "twisted",
    ];
    names.map(|name| (name, case(name).with_triangles(2000).unwrap().lasting(2).unwrap())).to_vec()
}

/// Methods with which fine meshes run.
const FINE_METHODS: [Method; 2] = [Method::ImplicitEuler, Method::Bdf2];

#[test]
fn the_hardest_cases_are_stable_on_fine_meshes_or_explained() {
    compare(fine_cases(), &FINE_METHODS, Runs::Some, "tests/hard_cases_fine.csv");
}

/// The same for the whole product of cases, models and methods.
#[test]
#[ignore = "takes ten minutes: cargo test --test hard -- --ignored every_run"]
fn every_run_of_the_hardest_cases_on_fine_meshes_is_stable_or_explained() {
    compare(fine_cases(), &FINE_METHODS, Runs::All, "tests/hard_cases_fine.csv");
}

#[test]
fn every_case_is_described_and_reads_back_as_written() {
    for (file, text) in HARD {
        let case: Case = files::parse_as(text, file).unwrap();
        assert!(!case.level.name.is_empty() && case.level.about.len() > 30, "{file} should say what it tries");
        let level: Level = files::parse(&files::write(&case.level).unwrap(), file).unwrap();
        assert_eq!(level, case.level, "{file}");
    }
    let message = Case::read(Path::new("no_such_case")).unwrap_err().to_string();
    assert!(message.contains("no_such_case"), "{message}");
}

/// The gallery would notice if something went wrong: here it does.
#[test]
fn a_step_above_the_stability_limit_is_judged_unstable() {
    let case = case("stretch_2");
    let stable = Run::new(&case, Model::Corotated, Method::SymplecticEuler).unwrap().unguarded_at(Method::SHARE);
    assert!(to_the_end(stable).held());
    let unstable = Run::new(&case, Model::Corotated, Method::SymplecticEuler).unwrap().unguarded_at(4.0);
    let verdict = to_the_end(unstable);
    assert!(matches!(verdict.failure, Some(Failure::Energy | Failure::Stopped)), "{verdict:?}");
}

/// A bar whose ends are turned in every frame: each turn is a change from outside, but no new beginning.
#[test]
fn turning_pins_forgives_no_energy_from_nowhere() {
    let twin = case("twist_20").undamped_twin().unwrap();
    for method in [Method::PositionVerlet, Method::Heun] {
        let verdict = to_the_end(Run::new(&twin, Model::Hencky, method).unwrap());
        assert!(verdict.numbers.gain > 0.1 && verdict.numbers.gain <= Guard::EXCESS, "{method:?}: {verdict:?}");
    }
}

#[test]
fn energy_from_nowhere_is_noticed_even_after_more_was_dissipated() {
    let scene = |name: &str| common::simulation(&case(name).level).scene().clone();
    let scene: Scene = scene("stretch_2");
    let energies = |kinetic, elastic, potential| Energies { kinetic, elastic, contact: 0.0, potential };
    let mut account = Account::new(&scene, energies(0.0, 10.0, 5.0));
    account.record(energies(10.0, 0.0, 5.0));
    account.record(energies(4.0, 0.0, 5.0));
    assert_eq!(account.gain(), 0.0);
    // A pull from outside puts 6 J in. What was dissipated before is not available any more.
    account.changed(energies(4.0, 0.0, 5.0), energies(4.0, 0.0, 11.0));
    account.record(energies(10.0, 0.0, 5.0));
    assert_eq!((account.gain(), account.put_in()), (0.0, 16.0));
    account.record(energies(11.6, 0.0, 5.0));
    assert!((account.gain() - 0.1).abs() < 1e-9, "{}", account.gain());
    // So does the work of a wall.
    account.supply(4.0);
    account.record(energies(15.6, 0.0, 5.0));
    assert!((account.gain() - 0.1).abs() < 1e-9 && account.put_in() == 20.0, "{account:?}");
    account.record(energies(f64::NAN, 0.0, 5.0));
    assert_eq!(account.gain(), f64::INFINITY);
}

#[test]
fn a_body_that_ends_inside_out_is_not_home() {
    let verdict = verdict(&case("mirror"), Model::StVenantKirchhoff, Method::ImplicitEuler);
    assert_eq!(verdict.failure, Some(Failure::Inverted));
    assert!(verdict.numbers.inverted > 100 && verdict.numbers.gain < 1e-6);
}

/// Five triangles around a vertex, each right way round and nearly in its rest shape, that go twice around it.
#[test]
fn a_vertex_whose_triangles_go_around_it_twice_is_not_home() {
    let star = |turns: f64| {
        let point = |k: u32| {
            let angle = std::f64::consts::TAU * turns * f64::from(k) / 5.0;
            format!("({:.9}, {:.9})", angle.cos(), angle.sin())
        };
        (0..5).map(point).collect::<Vec<_>>().join(", ")
    };
    let still = ["(0, 0)"; 6].join(", ");
    let text = format!(
        "(level: (name: \"star\", bodies: [(name: \"star\", mass: Density(1),
            mesh: Points(points: [(0, 0), {}], triangles: [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5), (0, 5, 1)]),
            material: (model: Corotated, young: 1, poisson: 0.3))],
            state: (steps: 0, time: 0, positions: [(0, 0), {}], velocities: [{still}])),
          lasts: Seconds(0.02), expects: Home)",
        star(1.0),
        star(2.0)
    );
    let case: Case = files::parse_as(&text, "star.ron").unwrap();
    let verdict = verdict(&case, Model::Corotated, Method::ImplicitEuler);
    assert_eq!((verdict.failure, verdict.numbers.inverted), (Some(Failure::Wound), 0), "{verdict:?}");
}

/// A fan of triangles at the boundary whose angles sum to more than a full turn, none inverted.
#[test]
fn a_boundary_vertex_whose_triangles_lie_over_each_other_is_folded() {
    let fan = |turns: f64| {
        let point = |k: u32| {
            let angle = std::f64::consts::TAU * turns * f64::from(k) / 6.0;
            format!("({:.9}, {:.9})", angle.cos(), angle.sin())
        };
        (0..7).map(point).collect::<Vec<_>>().join(", ")
    };
    let case = |turns: f64| {
        let text = format!(
            "(level: (name: \"fan\", bodies: [(name: \"fan\", mass: Density(1), pins: [{}],
                mesh: Points(points: [(0, 0), {}], triangles: [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5), (0, 5, 6), (0, 6, 7)]),
                material: (model: Corotated, young: 1, poisson: 0.3))],
                state: (steps: 0, time: 0, positions: [(0, 0), {}], velocities: [{}])),
              lasts: Seconds(0.02), expects: Bounded)",
            (0..8).map(|vertex| format!("Vertex({vertex})")).collect::<Vec<_>>().join(", "),
            fan(0.7),
            fan(turns),
            ["(0, 0)"; 8].join(", ")
        );
        files::parse_as::<Case>(&text, "fan.ron").unwrap()
    };
    let failure = |turns: f64| verdict(&case(turns), Model::Corotated, Method::ImplicitEuler).failure;
    assert_eq!((failure(0.98), failure(1.1)), (None, Some(Failure::Wound)));
}

/// Twice as wide and half as high: every area is that at rest, and no triangle is inverted.
#[test]
fn a_sheared_body_of_the_right_area_is_not_home() {
    let pins = (0..9).map(|vertex| format!("Vertex({vertex})")).collect::<Vec<_>>().join(", ");
    let text = format!(
        "(level: (name: \"sheet\", bodies: [(name: \"sheet\", mass: Density(1), stretch: (2, 0.5), pins: [{pins}],
            mesh: Rectangle(width: 0.2, height: 0.2, columns: 2, rows: 2, corner: (0.4, 0.4)),
            material: (model: Corotated, young: 1, poisson: 0.3))]), lasts: Seconds(0.02), expects: Home)"
    );
    let mut case: Case = files::parse_as(&text, "sheet.ron").unwrap();
    let held = verdict(&case, Model::Corotated, Method::ImplicitEuler);
    assert_eq!(held.failure, Some(Failure::Strain));
    assert!((held.numbers.strain.unwrap() - 1.0).abs() < 1e-12, "{held:?}");
    case.expects = Expects::Bounded;
    assert!(verdict(&case, Model::Corotated, Method::ImplicitEuler).is_stable());
}

/// In its rest shape, but under way.
#[test]
fn a_body_that_moves_is_not_at_rest() {
    let text = "(level: (name: \"sheet\", bodies: [(name: \"sheet\", mass: Density(1), velocity: (0.1, 0),
            mesh: Rectangle(width: 0.2, height: 0.2, columns: 2, rows: 2, corner: (0.4, 0.4)),
            material: (model: Corotated, young: 1, poisson: 0.3))]), lasts: Seconds(0.1), expects: Home)";
    let case: Case = files::parse_as(text, "sheet.ron").unwrap();
    for method in Method::ALL {
        let verdict = verdict(&case, Model::Corotated, method);
        assert_eq!(verdict.failure, Some(Failure::Motion), "{}: {verdict:?}", method.name());
        // Shear waves of E = 1 Pa, nu = 0.3 and 1 kg/m² run at sqrt(1/2.6) m/s.
        let expected = 0.1 * 2.6_f64.sqrt();
        assert!((verdict.numbers.speed.unwrap() / expected - 1.0).abs() < 1e-6, "{}: {verdict:?}", method.name());
    }
}

/// Implicit Euler keeps a spin stable and dissipates it: both are said. The spin is slow enough for elastic forces to hold the
/// block together.
#[test]
fn a_stable_run_may_be_far_from_its_reference() {
    let mut case = case("fast_spin");
    case.level.bodies[0].spin = Spin::new(4.0).unwrap();
    let case = Arc::new(case);
    let methods = [Method::VelocityVerlet, Method::RungeKutta4, Method::ImplicitEuler];
    let trials = methods.map(|method| Trial {
        name: "fast_spin".to_owned(),
        case: Arc::clone(&case),
        model: Model::StableNeoHookean,
        method,
    });
    let mut sweep = Sweep::new(trials.to_vec(), 1, true);
    while !sweep.advance(Duration::from_hours(1)).finished {}
    let verdicts: Vec<_> = sweep.entries().map(|(_, entry)| entry.verdict.clone().unwrap().unwrap()).collect();
    let distances: Vec<_> = verdicts.iter().map(|verdict| verdict.numbers.distance.unwrap()).collect();
    assert!(verdicts.iter().all(Verdict::is_stable), "{verdicts:#?}");
    assert!(verdicts[0].held() && verdicts[1].held() && !verdicts[2].held(), "{verdicts:#?}");
    assert!(distances[0].share < 0.05 && distances[1].share < 0.01, "{distances:?}");
    assert!(distances[2].share > 0.2 && distances[2].quantity != Quantity::Momentum, "{distances:?}");
    assert!(verdicts[2].accuracy().contains("off in"), "{}", verdicts[2].accuracy());
}

#[test]
fn undamped_twins_have_no_damping_and_need_not_come_to_rest() {
    for (name, case) in Case::names().map(|name| (name, case(name))) {
        let damped = case.level.effects.iter().filter(|listed| listed.effect.kind().is_damping()).count();
        let Some(twin) = case.undamped_twin() else {
            assert_eq!(damped, 0, "{name}");
            continue;
        };
        assert!(damped > 0 && twin.expects == Expects::Bounded && twin.damped() == &case, "{name}");
        assert_eq!(twin.level.effects.len() + damped, case.level.effects.len(), "{name}");
        assert!(twin.undamped_twin().is_none(), "{name}");
    }
}

#[test]
fn what_leaves_the_box_of_its_case_is_outside() {
    let mut case = case("thin_wall");
    (case.lasts, case.level.effects) = (Lasts::Steps(20), Vec::new());
    let verdict = verdict(&case, Model::Corotated, Method::ImplicitEuler);
    assert_eq!(verdict.failure, Some(Failure::Outside), "without its wall it falls through: {verdict:?}");
}

#[test]
fn a_sweep_does_not_depend_on_budget_or_threads() {
    let case = Arc::new(case("stiff"));
    let trials: Vec<_> = Model::ALL
        .iter()
        .map(|&model| Trial {
            name: "stiff".to_owned(),
            case: Arc::clone(&case),
            model,
            method: Method::SymplecticEuler,
        })
        .collect();
    let rows = |threads: usize, budget: Duration| {
        let mut sweep = Sweep::new(trials.clone(), threads, true);
        while !sweep.advance(budget).finished {}
        let verdict = |(_, entry): (&Trial, &Entry)| entry.verdict.clone();
        sweep.entries().map(verdict).collect::<Vec<_>>()
    };
    assert_eq!(rows(1, Duration::ZERO), rows(3, Duration::from_mins(1)));
}

/// The work of walls that press a block and let it go is no energy from nowhere. Forward Euler and Heun's method gain energy at
/// every step, Dormand-Prince feels walls only at the end of a frame, and linearly implicit Euler gains 9 % to 27 % from moving
/// walls.
#[test]
fn work_of_moving_walls_is_supplied_energy() {
    let wall = |y: f64, speed: f64| {
        format!(
            "Moving(obstacle: Cuboid(centre: (0.5, {y}), width: 2, height: 0.2, eps: 0.001),
               motions: [Slide(velocity: (0, {speed}), until: 0.9), Slide(velocity: (0, {}), from: 1.5, until: 2.4)])",
            -speed
        )
    };
    let text = format!(
        "(level: (name: \"pinch\", mode: Collide,
            bodies: [(name: \"block\", mass: Density(100),
              mesh: Rectangle(width: 0.4, height: 0.4, columns: 6, rows: 6, diagonals: Alternating, corner: (0.3, 0.3)),
              material: (model: Corotated, young: 1000, poisson: 0.3))],
            effects: [(effect: Rayleigh(mass: 10)), (effect: Walls(obstacles: [{}, {}]))]),
          lasts: Seconds(5), expects: Home)",
        wall(0.85, -0.15),
        wall(0.15, 0.15)
    );
    let case: Case = files::parse_as(&text, "pinch.ron").unwrap();
    for model in [Model::Corotated, Model::StableNeoHookean, Model::FixedCorotated] {
        for method in Method::ALL {
            // In steps of a frame BDF2 knows the work of a wall to 3 % only.
            let gains = [Method::DormandPrince, Method::LinearlyImplicitEuler, Method::Bdf2].contains(&method);
            if gains || method.is_never_stable() {
                continue;
            }
            let mut run = Run::new(&case, model, method).unwrap();
            let (mut most, mut excess) = (0.0_f64, 0.0_f64);
            let verdict = loop {
                if let Some(verdict) = run.advance().unwrap() {
                    break verdict;
                }
                let (energies, work) = (run.simulation().energies(), run.simulation().work_of_obstacles());
                most = most.max(energies.elastic);
                excess = excess.max(energies.total() - work);
            };
            assert!(verdict.held(), "{} {}: {verdict:?}", model.name(), method.name());
            assert!(most > 1.0 && excess < 0.05 * most, "{}: {excess} J of {most} J", method.name());
            assert_eq!(run.simulation().counts().guarded, 0, "{} {}", model.name(), method.name());
        }
    }
}

/// After each step that a caller sees, also where elastic energy grows and kinetic energy does not, where damping has
/// dissipated most of the energy before it grows again, and just before steps are divided.
#[test]
fn random_variations_keep_the_bound_on_energy_from_nowhere() {
    for number in [2, 26, 33, 441, 518].into_iter().chain((0..66).step_by(5)) {
        let outcome = Variation::new(1, number).unwrap().run();
        assert!(outcome.finite && (outcome.fault.is_some() || outcome.gain <= Guard::EXCESS), "{number}: {outcome:?}");
    }
}

/// A crushed block is inside out and lies against itself, where its contact has no force: its equations have no solution without a
/// crossing.
#[test]
fn unsolved_steps_with_inverted_triangles_stop_time() {
    let case = case("drop_100");
    let level =
        Level { substeps: Substeps::nearest(1.0), ..case.level(Model::StVenantKirchhoff, Method::ImplicitEuler) };
    let scene = Scene::build(&level, level.mode, &NoFiles, None).unwrap();
    let opened = |scene: &Scene, level: &Level| Simulation::open(scene.clone(), level, level.mode).unwrap();
    let mut run = opened(&scene, &level);
    run.advance(60, &mut || true);
    let fault = run.fault().unwrap().clone();
    let Cause::Inverted(count) = fault.cause else { panic!("{fault}") };
    assert_eq!(count, Tangle::of_all(run.scene(), &run.state().x).inverted);
    assert!(matches!(fault.culprit, Culprit::Triangle { volume_ratio, .. } if volume_ratio < 0.0), "{fault}");
    let text = fault.to_string();
    assert!(
        text.contains("equations of the last 8 steps were not solved") && text.contains("opposes inversion"),
        "{text}"
    );
    // One that is saved among these steps stops at the same one.
    let mut saved = opened(&scene, &level);
    saved.advance(fault.step - 4, &mut || true);
    let level = Level { state: saved.saved(), ..level };
    let mut again = opened(&scene, &level);
    again.advance(60, &mut || true);
    assert_eq!(again.fault(), Some(&fault));
    // Without the guard it goes on, unsolved.
    let mut unguarded = opened(&Scene { guard: false, ..scene }, &Level { state: None, ..level });
    assert_eq!(unguarded.advance(40, &mut || true), 40);
    assert!(unguarded.counts().unconverged > u64::from(Guard::UNSOLVED_STEPS));
}

/// A random variation depends on seed and number alone, and so does its run.
#[test]
fn random_variations_can_be_repeated() {
    let variation = |seed, number| Variation::new(seed, number).unwrap();
    assert_eq!(variation(1, 5), variation(1, 5));
    assert_ne!(variation(1, 5).level, variation(2, 5).level);
    let mut seen = Vec::new();
    for number in 0..66 {
        let Variation { model, level, .. } = variation(3, number);
        seen.push((model, level.integrator.name()));
    }
    seen.sort_by_key(|(model, integrator)| (model.name(), *integrator));
    seen.dedup();
    assert_eq!(seen.len(), 66, "every model with every integrator");
    let timeless = |number| Outcome { seconds: 0.0, ..variation(1, number).run() };
    for number in 0..22 {
        let outcome = timeless(number);
        assert_eq!(outcome, timeless(number));
        assert!(outcome.finite, "number {number}: {outcome:?}");
    }
}

/// In the plane and in space, with obstacles that move. In most of them something touches.
#[test]
fn surfaces_do_not_cross_in_random_scenes_of_contact() {
    let (mut touching, mut in_space) = (0, 0);
    let numbers = (0..72).step_by(5);
    for number in numbers.clone() {
        let scene = Variation::contact(1, number).unwrap();
        let outcome = scene.run();
        assert_eq!(
            (outcome.refused.as_ref(), outcome.crossings, outcome.finite),
            (None, 0, true),
            "{number}: {outcome:?}"
        );
        assert!(outcome.fault.is_some() || outcome.gain <= Guard::EXCESS, "{number}: {outcome:?}");
        let level = scene.level;
        let mut simulation =
            Simulation::open(Scene::build(&level, level.mode, &NoFiles, None).unwrap(), &level, level.mode).unwrap();
        let mut touches = |_| simulation.advance(1, &mut || true) == 1 && simulation.energies().contact > 0.0;
        touching += usize::from((0..Variation::STEPS).any(&mut touches));
        in_space += usize::from(!level.membranes.is_empty());
    }
    assert!(2 * touching > numbers.len() && in_space > 1, "{touching} touch, {in_space} in space");
}

#[test]
fn an_experiment_without_steps_is_refused() {
    let read = |times: &str| files::parse_as::<Experiment>(&format!("Shorter({times})"), "case.ron");
    assert_eq!(read("4").unwrap(), Experiment::Shorter(Substeps::nearest(4.0)));
    assert!(read("0").unwrap_err().to_string().contains("at least 1"));
}

/// A ball moves by 0.3 m to the right within half a second.
#[test]
fn moving_obstacles_are_watched_where_they_are() {
    let text =
        "(name: \"\", bodies: [(name: \"\", mesh: Rectangle(corner: (0, 0), width: 1, height: 1, columns: 1, rows: 1),
            material: (model: Corotated, young: 1000, poisson: 0.3, plane: Strain), mass: Density(1))],
        effects: [(effect: Walls(obstacles: [Moving(obstacle: Ball(centre: (0.5, 2), radius: 0.1, eps: 0.01),
            motions: [Swing(way: (0.3, 0), period: 2, phase: 0)])]))])";
    let level: Level = files::parse(text, "ball.ron").unwrap();
    let fence = Fence::new(&level, &Scene::build(&level, level.mode, &NoFiles, None).unwrap(), None);
    for (time, x, depth) in [(0.0, 0.52, 0.08), (0.0, 0.82, 0.0), (0.5, 0.52, 0.0), (0.5, 0.82, 0.08)] {
        let found = fence.beyond(time, &[x, 2.0]);
        assert!((found - depth).abs() < 1e-12, "{time} {x}: {found}");
    }
}

/// A stretched membrane that springs back, with damping: at home with every method that has a stable step. Without its wall the same cloth falls through the box of
/// its case, and what is inside a sphere is outside of where it may be.
#[test]
fn cases_in_space_are_judged() {
    let text = |stretch: &str, rest: &str| {
        format!(
            "(level: (name: \"\", membranes: [(name: \"cloth\", mesh: Rectangle(width: 0.4, height: 0.4, columns: 3, rows: 3, diagonals: Alternating, corner: (0, 0)),
            material: (model: NeoHookean, young: 2000, poisson: 0.3, plane: Stress), thickness: 0.01, mass: Density(100), stretch: ({stretch}), space: (turn: (70, 0, 0)))],
            {rest}"
        )
    };
    let read = |text: String| files::parse_as::<Case>(&text, "space.ron").unwrap();
    let home = read(text("1.5, 1", "effects: [(effect: Rayleigh(mass: 8))]), lasts: Seconds(4), expects: Home)"));
    for method in Method::ALL.into_iter().filter(|method| !method.is_never_stable()) {
        let verdict = verdict(&home, Model::NeoHookean, method);
        assert!(verdict.is_stable(), "{}: {verdict:?}", method.name());
    }
    let falls = "effects: [(effect: Gravity(down: 9.8))]), lasts: Seconds(1), expects: Bounded, within: Some(((-1, -1, -1), (1, 1, 1))))";
    let failure = verdict(&read(text("1, 1", falls)), Model::Corotated, Method::ImplicitEuler).failure;
    assert_eq!(failure, Some(Failure::Outside), "it falls out of its box");
    let ball = "effects: [(effect: Walls(obstacles: [Sphere(centre: (0.2, 0.05, 0.2), radius: 0.1, eps: 0.01)]))]), lasts: Steps(1), expects: Bounded)";
    let inside = verdict(&read(text("1, 1", ball)), Model::Corotated, Method::ImplicitEuler);
    assert!(inside.numbers.outside > 0.01, "{inside:?}");
}

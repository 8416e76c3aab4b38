//! Bodies and nets at their own pace: each moves as it would alone, costs no more than that, and together they are one scene.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{level, simulation};
use gingerbread::{
    command::{Command, Mode},
    effects::Grab,
    files,
    integrators::{Class, IntegratorKind},
    level::{Level, SubstepMode, Substeps, Switch, Toggle},
    meshes::NoFiles,
    report::EffectCost,
    sandbox::Sandbox,
    simulation::Simulation,
    state::State,
};

/// Vertices of the cake and of the pea; the chain has three particles more.
const CAKE: usize = 35;
const PEA: usize = 37;

/// Walls on both sides and a floor, everything that acts, and nothing that depends on time.
const EVERYTHING: &str = "(effect: Gravity(down: 9)), (effect: Rayleigh(mass: 0.3, stiffness: 0.00001)), (effect: Drag(coefficient: 0.001)),
    (effect: MouseSpring(stiffness: 200)), (effect: Boundary(least: (0, 0), greatest: (1, 1))), (effect: Restitution(coefficient: 0.3)),
    (effect: Friction(coefficient: 0.2)), (effect: Compression(strength: 1)),
    (effect: Walls(obstacles: [Plane(point: (0, 0.1), normal: (0.1, 1), eps: 0.01), Ball(centre: (0.85, 0.15), radius: 0.1, eps: 0.01)])),";

const COMPRESSION: &str = "(effect: Compression(strength: 1)),";

/// A soft cake, a stiff pea and a chain in between, by their names, in a scene with these effects.
fn table(names: &[&str], effects: &str) -> Level {
    let cake = "(name: \"cake\", mesh: Rectangle(width: 0.3, height: 0.2, columns: 6, rows: 4, diagonals: Alternating, corner: (0.1, 0.3)),
        material: (model: NeoHookean, young: 2000, poisson: 0.4), mass: Density(100))";
    let pea = "(name: \"pea\", mesh: Disk(centre: (0.8, 0.5), radius: 0.05, rings: 3), velocity: (0, -1), spin: 5,
        material: (model: Corotated, young: 500000, poisson: 0.3), mass: Density(100))";
    let chain = "(name: \"chain\", net: Chain(from: (0.5, 0.9), to: (0.7, 0.9), springs: 2, stiffness: 500), mass: 0.05, pins: [Vertex(0)])";
    let of = |all: &[(&str, &str)]| {
        all.iter().filter(|(name, _)| names.contains(name)).map(|(_, text)| *text).collect::<Vec<_>>().join(",")
    };
    // The compression guard wants triangles.
    let effects = if names == ["chain"] { effects.replace(COMPRESSION, "") } else { effects.to_owned() };
    level(&format!(
        "(name: \"table\", substeps: 20, paces: Own, bodies: [{}], nets: [{}], effects: [{effects}])",
        of(&[("cake", cake), ("pea", pea)]),
        of(&[("chain", chain)])
    ))
}

/// Schemes that stiffness limits, and that are stable at some step.
fn explicit() -> impl Iterator<Item = IntegratorKind> {
    let stable = |kind: &IntegratorKind| kind.kind().stability_limit().is_some_and(|limit| limit > 0.0);
    IntegratorKind::all().into_iter().filter(stable)
}

/// In how many parts each takes a step.
fn parts(run: &Simulation) -> Vec<u32> {
    run.substep_plans().map(|pace| pace.steps).collect()
}

/// The level in which all take as many more steps.
fn finer(level: Level, times: u32) -> Level {
    let substeps = Substeps::new(level.substeps.get() * times).unwrap();
    Level { substeps, paces: SubstepMode::Same, ..level }
}

/// Runs a scene in bunches of steps, and each of its bodies and nets alone in as many steps; pulls the pea on the way.
fn beside_alone(
    integrator: &IntegratorKind,
    effects: &str,
    [bunches, steps]: [u64; 2],
    seen: &mut dyn FnMut(&Simulation, &[Simulation]),
) {
    // The guard of one looks at all energies together.
    let own = |names: &[&str]| Level { integrator: integrator.clone(), guard: Toggle::Off, ..table(names, effects) };
    let mut together = simulation(&own(&["cake", "pea", "chain"]));
    let times = parts(&together);
    let mut alone: Vec<_> = ["cake", "pea", "chain"]
        .iter()
        .zip(&times)
        .map(|(name, times)| simulation(&finer(own(&[name]), *times)))
        .collect();
    for bunch in 0..bunches {
        let grab = (bunch % 30 >= 20).then_some(Grab { vertex: 3, target: [0.6, 0.6, 0.0] });
        alone[1].set_grab(grab);
        together.set_grab(grab.map(|grab| Grab { vertex: CAKE + 3, ..grab }));
        assert_eq!(together.advance(steps, &mut || true), steps, "{}", integrator.name());
        for (run, times) in alone.iter_mut().zip(&times) {
            assert_eq!(run.advance(steps * u64::from(*times), &mut || true), steps * u64::from(*times));
        }
        seen(&together, &alone);
    }
}

fn flat(alone: &[Simulation], of: impl Fn(&Simulation) -> &[f64]) -> Vec<f64> {
    alone.iter().flat_map(|run| of(run).to_vec()).collect()
}

#[test]
fn multirate_bodies_move_bit_equal_as_if_alone() {
    for integrator in IntegratorKind::all().into_iter().filter(|kind| kind.kind().class() == Class::Explicit) {
        // Schemes without a stable step blow up a little later, alone as well.
        let stable = explicit().any(|kind| kind == integrator);
        let mut touched = 0;
        beside_alone(&integrator, EVERYTHING, if stable { [60, 20] } else { [1, 5] }, &mut |together, alone| {
            let state = together.state();
            assert!(state.x == flat(alone, |run| &run.state().x), "{} at {} s", integrator.name(), state.time);
            assert!(state.v == flat(alone, |run| &run.state().v), "{}", integrator.name());
            touched += together.state().anchors.len();
        });
        assert!(touched > 100 || !stable, "{}: everything has to touch something: {touched}", integrator.name());
    }
}

#[test]
fn the_ledger_says_what_each_would_have_cost_alone() {
    for integrator in explicit() {
        beside_alone(&integrator, EVERYTHING, [15, 20], &mut |together, alone| {
            let of = |cost: &EffectCost| [cost.calls, cost.elements];
            let costs = together.costs();
            let own = |number: usize| of(&alone[number].costs()[0]);
            assert_eq!([of(&costs[0]), of(&costs[1]), of(&costs[2])], [own(0), own(1), own(2)], "elements");
            let gravity = alone.iter().map(|run| of(&run.costs()[1]));
            assert_eq!(gravity.reduce(|a, b| [a[0] + b[0], a[1] + b[1]]), Some(of(&costs[3])));
            let evaluations = alone.iter().map(|run| run.counts().force_evaluations).sum::<u64>();
            assert_eq!(together.counts().force_evaluations, evaluations);
            let constrained = alone.iter().map(|run| run.counts().constrained).sum::<u64>();
            assert_eq!(together.counts().constrained, constrained);
        });
    }
}

#[test]
fn a_stiff_pea_does_not_slow_a_soft_cake() {
    let mut run = simulation(&table(&["cake", "pea"], EVERYTHING));
    let [cake, pea] = parts(&run)[..] else { unreachable!() };
    assert!((cake, pea > 8) == (1, true), "{cake} {pea}");
    let limits: Vec<_> = run.substep_plans().map(|pace| pace.step / pace.limit.unwrap()).collect();
    assert!(
        limits.iter().all(|share| *share <= 0.5) && limits[1] > 0.5 * f64::from(pea - 1) / f64::from(pea),
        "{limits:?}"
    );
    for substeps in [7, 11, 20, 23, 49] {
        let substeps = Substeps::new(substeps).unwrap();
        for pace in simulation(&Level { substeps, ..table(&["cake", "pea"], "") }).substep_plans() {
            assert_eq!(pace.step, Substeps::new(substeps.get() * pace.steps).unwrap().step());
        }
    }
    run.advance(100, &mut || true);
    let called: Vec<_> = run.costs().iter().map(|cost| (cost.calls, cost.elements)).collect();
    let triangles = run.scene().bodies.iter().map(|body| body.elements.corners().len() as u64).collect::<Vec<_>>();
    assert_eq!(called[0], (100, 100 * triangles[0]));
    assert_eq!(called[1], (100 * u64::from(pea), 100 * u64::from(pea) * triangles[1]));
    assert_eq!(run.counts().steps, 100);
    let mut same = simulation(&Level { paces: SubstepMode::Same, ..table(&["cake"], "") });
    same.advance(100, &mut || true);
    assert_eq!(run.state().time.to_bits(), same.state().time.to_bits(), "all meet at the end of every step");
}

#[test]
fn only_multirate_stepping_keeps_the_pea_stable() {
    let energy = |paces| {
        let mut run =
            simulation(&Level { paces, guard: Toggle::Off, ..table(&["cake", "pea"], "(effect: Gravity(down: 1))") });
        let before = run.energies().total();
        let taken = run.advance(400, &mut || true);
        (taken, (run.energies().total() / before - 1.0).abs())
    };
    let (taken, change) = energy(SubstepMode::Own);
    assert!(taken == 400 && change < 0.01, "{taken} {change}");
    let (taken, change) = energy(SubstepMode::Same);
    assert!(taken < 400 || change > 1.0 || change.is_nan(), "{taken} {change}");
}

#[test]
fn where_nobody_needs_more_steps_nothing_changes() {
    for integrator in explicit() {
        let own = Level {
            integrator,
            substeps: Substeps::new(1200).unwrap(),
            ..table(&["cake", "pea", "chain"], EVERYTHING)
        };
        let same = Level { paces: SubstepMode::Same, ..own.clone() };
        let (mut own, mut same) = (simulation(&own), simulation(&same));
        assert_eq!(parts(&own), [1, 1, 1]);
        assert_eq!(parts(&same), [0; 0]);
        own.advance(2000, &mut || true);
        same.advance(2000, &mut || true);
        assert_eq!(own.state(), same.state());
        assert_eq!((own.counts(), own.costs()), (same.counts(), same.costs()));
    }
}

#[test]
fn what_stiffness_does_not_limit_takes_the_steps_of_the_level() {
    for integrator in IntegratorKind::all().into_iter().filter(|kind| kind.kind().class() != Class::Explicit) {
        let own = Level { integrator, ..table(&["cake", "pea"], EVERYTHING) };
        let same = Level { paces: SubstepMode::Same, ..own.clone() };
        let (mut own, mut same) = (simulation(&own), simulation(&same));
        own.advance(5, &mut || true);
        same.advance(5, &mut || true);
        assert_eq!((parts(&own), own.state()), (Vec::new(), same.state()));
    }
}

/// Where all walls are forced, they are asked in every part of every step; where they are not, only when they are in reach.
#[test]
fn walls_out_of_reach_cost_nothing_and_change_nothing() {
    let auto = table(&["cake", "pea", "chain"], EVERYTHING);
    let mut forced = auto.clone();
    forced.effects.iter_mut().for_each(|listed| listed.switch = Switch::On);
    let (mut auto, mut forced) = (simulation(&auto), simulation(&forced));
    for _ in 0..120 {
        auto.advance(10, &mut || true);
        forced.advance(10, &mut || true);
        assert!(auto.state() == forced.state(), "at {} s", auto.state().time);
    }
    let walls =
        |run: &Simulation| run.costs().iter().find(|cost| cost.name == "Walls").map(|cost| (cost.calls, cost.skipped));
    let ((called, skipped), (always, never)) = (walls(&auto).unwrap(), walls(&forced).unwrap());
    assert!(called > 0 && skipped > called && never == 0 && always == called + skipped, "{called} {skipped} {always}");
}

/// A particle on a stiff spring swings to a wall and back several times within one step of the scene.
#[test]
fn nobody_passes_a_wall_between_the_ends_of_a_step() {
    let run = |switch: &str| {
        simulation(&level(&format!(
            "(name: \"\", substeps: 1, paces: Own, guard: Off, nets: [(name: \"\", pins: [Vertex(0)], mass: 0.05,
               net: Chain(from: (0.5, 0.5), to: (0.56, 0.5), springs: 1, stiffness: 50000, rest: 0.08))],
             effects: [(effect: Walls(obstacles: [Plane(point: (0.597, 0), normal: (-1, 0), eps: 0.002)]), switch: {switch})])"
        )))
    };
    let (mut auto, mut forced) = (run("Auto"), run("On"));
    assert!(parts(&auto)[0] > 10);
    for _ in 0..50 {
        auto.advance(1, &mut || true);
        forced.advance(1, &mut || true);
        assert_eq!(auto.state(), forced.state());
    }
    assert!(auto.costs()[1].calls > 0 && auto.costs()[1].skipped > 0, "{:?}", auto.costs()[1]);
}

#[test]
fn a_run_saved_at_any_moment_goes_on_bit_for_bit() {
    for integrator in explicit() {
        let everything = table(&["cake", "pea", "chain"], EVERYTHING);
        let begin = || Level { integrator: integrator.clone(), guard: Toggle::Off, ..everything.clone() };
        let mut whole = simulation(&begin());
        whole.advance(300, &mut || true);
        for moment in [1, 10, 137, 200] {
            let mut first = simulation(&begin());
            first.advance(moment, &mut || true);
            let text = files::write(&Level { state: first.saved(), ..begin() }).unwrap();
            assert!(text.contains("paces: Own"));
            let mut second = simulation(&files::parse(&text, "saved.ron").unwrap());
            second.advance(300 - moment, &mut || true);
            assert!(second.state() == whole.state(), "{} saved after {moment} steps", integrator.name());
        }
    }
}

#[test]
fn a_memory_that_is_none_is_forgotten() {
    let verlet = explicit().find(|kind| kind.name() == "PositionVerlet").unwrap();
    let begin = Level { integrator: verlet, guard: Toggle::Off, ..table(&["cake", "pea"], EVERYTHING) };
    let mut good = simulation(&begin);
    let start = good.state().clone();
    good.advance(30, &mut || true);
    assert!(good.state().memory.len() > 2 * (CAKE + PEA));
    let numbers = [0.0, 1.0, -3.0, 0.5, 1e15, 74.0, f64::MAX];
    for length in [1, 2, 3, 75, 200] {
        for first in 0..numbers.len() {
            let memory = (0..length).map(|at| numbers[(first + 3 * at) % numbers.len()]).collect();
            let mut other = simulation(&begin);
            other.set_state(State { memory, ..start.clone() });
            other.advance(30, &mut || true);
            assert_eq!(other.state(), good.state());
        }
    }
}

#[test]
fn time_turned_back_leads_to_the_same_bits_again() {
    for integrator in explicit() {
        let begin = Level { integrator, guard: Toggle::Off, ..table(&["cake", "pea", "chain"], EVERYTHING) };
        let mut sandbox = Sandbox::new(begin, Box::new(NoFiles)).unwrap();
        sandbox.apply(Command::SetMode(Mode::Collide)).unwrap();
        sandbox.advance(500, &mut || true);
        let end = sandbox.simulation().state().clone();
        sandbox.apply(Command::Rewind(0.2)).unwrap();
        sandbox.apply(Command::SetRunning(true)).unwrap();
        let back = end.steps - sandbox.simulation().state().steps;
        assert!((200..500).contains(&back), "{back}");
        sandbox.advance(back, &mut || true);
        assert_eq!(sandbox.simulation().state(), &end);
    }
}

/// The pea of a stuff that stiffens is drawn out far beyond where its step at rest is stable.
fn drawn_out(guard: Toggle) -> Simulation {
    let text = "(name: \"\", substeps: 20, paces: Own, bodies: [(name: \"cake\", mesh: Rectangle(width: 0.3, height: 0.2, columns: 3, rows: 2, corner: (0.1, 0.3)),
          material: (model: NeoHookean, young: 2000, poisson: 0.4), mass: Density(100)),
        (name: \"pea\", mesh: Disk(centre: (0.8, 0.5), radius: 0.05, rings: 3), stretch: (5, 5),
          material: (model: StVenantKirchhoff, young: 200000, poisson: 0.3), mass: Density(100))], effects: [])";
    simulation(&Level { guard, ..level(text) })
}

#[test]
fn beyond_its_pace_the_guard_still_shortens_all_steps() {
    let mut free = drawn_out(Toggle::Off);
    let before = free.energies().total();
    let taken = free.advance(40, &mut || true);
    assert!(taken < 40 || free.energies().total() > 2.0 * before, "its own pace is not enough: {taken}");
    let mut guarded = drawn_out(Toggle::On);
    assert_eq!(guarded.advance(400, &mut || true), 400, "{:?}", guarded.fault());
    assert!(guarded.counts().guarded > 0 && guarded.counts().retaken > 0);
    assert!(guarded.energies().total() < 2.0 * before);
    let mut again = drawn_out(Toggle::On);
    for _ in 0..400 {
        again.advance(1, &mut || true);
    }
    assert_eq!(again.state(), guarded.state());
}

const SETTLING: &str = "(effect: Gravity(down: 2)), (effect: Rayleigh(mass: 6, stiffness: 0.0002)), (effect: MouseSpring(stiffness: 200)),
    (effect: Walls(obstacles: [Plane(point: (0, 0.1), normal: (0, 1), eps: 0.01)])), (effect: Friction(coefficient: 0.5)),";

#[test]
fn each_falls_asleep_when_it_would_alone_and_wakes_by_itself() {
    let names = ["cake", "pea"];
    let mut together = simulation(&table(&names, SETTLING));
    let times = parts(&together);
    let mut moments = [0; 2];
    while moments.contains(&0) && together.state().steps < 20_000 {
        together.advance(10, &mut || true);
        for (moment, asleep) in moments.iter_mut().zip(together.sleeping().collect::<Vec<_>>()) {
            *moment = if asleep && *moment == 0 { together.state().steps } else { *moment };
        }
    }
    for ((name, times), moment) in names.iter().zip(&times).zip(moments) {
        let mut alone = simulation(&finer(table(&[name], SETTLING), *times));
        while !alone.is_asleep() && alone.state().steps < 20_000 * u64::from(*times) {
            alone.advance(10 * u64::from(*times), &mut || true);
        }
        assert_eq!(alone.state().steps, moment * u64::from(*times), "{name}");
    }
    assert!(together.is_asleep() && moments[0] != moments[1], "{moments:?}");
    let (before, calls) =
        (together.state().clone(), together.costs().iter().map(|cost| cost.calls).collect::<Vec<_>>());
    together.set_grab(Some(Grab { vertex: CAKE + 3, target: [0.6, 0.6, 0.0] }));
    assert_eq!(together.sleeping().collect::<Vec<_>>(), [true, false]);
    together.advance(100, &mut || true);
    let called: Vec<_> = together.costs().iter().zip(&calls).map(|(cost, before)| cost.calls - before).collect();
    assert_eq!(called[..3], [0, 100 * u64::from(times[1]), 100 * u64::from(times[1])], "the pea alone is computed");
    let idle: Vec<_> = together.costs().iter().map(|cost| cost.idle).collect();
    assert_eq!(idle[..3], [Some("asleep"), None, None]);
    assert_eq!(together.state().x[..2 * CAKE], before.x[..2 * CAKE]);
    assert_ne!(together.state().x[2 * CAKE..], before.x[2 * CAKE..]);
    together.set_grab(None);
    together.advance(1, &mut || true);
    let hand = together.costs().iter().find(|cost| cost.name == "Mouse spring");
    assert_eq!(hand.unwrap().idle, Some("nothing is dragged"));
}

#[test]
fn an_obstacle_that_moves_meets_each_at_its_own_pace() {
    let blade = "(effect: Boundary(least: (0, 0), greatest: (1, 1))),
        (effect: Walls(obstacles: [Moving(obstacle: Cuboid(centre: (0.5, 0.2), width: 0.8, height: 0.05, eps: 0.01),
          motions: [Swing(way: (0, 0.25), period: 0.4)])])),";
    beside_alone(&IntegratorKind::default(), blade, [15, 20], &mut |together, alone| {
        let apart = together.state().x.iter().zip(flat(alone, |run| &run.state().x));
        let apart = apart.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-6, "{apart} at {} s", together.state().time);
    });
    let mut guarded = simulation(&table(&["pea"], blade));
    let before = guarded.energies().total();
    guarded.advance(900, &mut || true);
    assert!(guarded.energies().total() > 3.0 * before, "{before} {}", guarded.energies().total());
    assert_eq!((guarded.counts().guarded, guarded.counts().retaken), (0, 0), "what the blade supplies is booked");
}

#[test]
fn the_step_counts_follow_edits_and_their_undo() {
    let mut sandbox = Sandbox::new(table(&["cake", "pea"], EVERYTHING), Box::new(NoFiles)).unwrap();
    sandbox.apply(Command::SetMode(Mode::Collide)).unwrap();
    sandbox.advance(20, &mut || true);
    let before = parts(sandbox.simulation());
    let body = table(&["cake"], "").bodies[0].material;
    sandbox.apply(Command::SetMaterial(1, body)).unwrap();
    assert!(parts(sandbox.simulation())[1] < before[1] / 4, "a soft pea");
    sandbox.advance(20, &mut || true);
    sandbox.apply(Command::Undo).unwrap();
    assert_eq!(parts(sandbox.simulation()), before);
    sandbox.apply(Command::SetSubsteps(Substeps::new(40).unwrap())).unwrap();
    assert_eq!(parts(sandbox.simulation()), [1, before[1].div_ceil(2)]);
    sandbox.apply(Command::TogglePin(CAKE + PEA - 1)).unwrap();
    sandbox.apply(Command::SetSubstepMode(SubstepMode::Same)).unwrap();
    assert_eq!(parts(sandbox.simulation()), [0; 0]);
    let fork = sandbox.fork();
    assert_eq!(parts(fork.simulation()), parts(sandbox.simulation()));
}

#[test]
fn levels_take_the_same_steps_for_all_unless_they_say_so() {
    let plain = level("(name: \"\")");
    assert_eq!(plain.paces, SubstepMode::Same);
    assert!(!files::write(&plain).unwrap().contains("paces"));
}

/// The bound is that of a level.
#[test]
fn the_step_count_of_a_stiff_body_is_bounded() {
    let mut hard = table(&["cake", "pea"], "");
    hard.substeps = Substeps::new(7).unwrap();
    hard.bodies[1].material = level("(name: \"\", bodies: [(name: \"\", mesh: Disk(radius: 1, rings: 1), mass: Total(1), material: (model: Corotated, young: 1e15, poisson: 0.3))])").bodies[0].material;
    let run = simulation(&hard);
    assert_eq!(parts(&run)[1], Substeps::MAX / 7);
}

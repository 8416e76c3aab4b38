//! A body stepped many steps at a stretch has the bits it has step by step: by two threads, and by one that has several steps
//! under way at once.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

mod common;

use common::{level, simulation};
use gingerbread::{
    elements::{Bytes, Caches},
    level::Level,
    simulation::Simulation,
};

/// With which as many steps are under way at once as there may be, two of a large body, some, and one.
const NONE: Caches = Caches { own: 0, shared: 1 };
const LITTLE: Caches = Caches { own: 1, shared: usize::MAX };
const SMALL: Caches = Caches { own: 1_200_000, shared: usize::MAX };
const ENDLESS: Caches = Caches { own: usize::MAX, shared: usize::MAX };

/// A sheet of 18,496 triangles, row by row.
fn large(body: &str, rest: &str) -> Level {
    square(68, body, rest)
}

fn square(side: u32, body: &str, rest: &str) -> Level {
    level(&format!(
        "(name: \"large\", {rest}, bodies: [(name: \"large\", mass: Density(1), {body} mesh: Rectangle(width: 1, height: 1, columns: {side}, rows: {side}),
          material: (model: StableNeoHookean, young: 1000, poisson: 0.3, plane: Strain))])"
    ))
}

fn work(simulation: &Simulation) -> impl PartialEq + std::fmt::Debug {
    let costs = simulation.costs().iter().map(|cost| (cost.name, cost.calls, cost.elements, cost.skipped, cost.idle));
    let state = simulation.state();
    (state.hash(), state.time, state.calm.clone(), simulation.counts(), costs.collect::<Vec<_>>())
}

/// Takes steps by so few that there is no stretch: fewer than between two checkpoints.
fn singly(simulation: &mut Simulation, steps: u64) -> u64 {
    let mut taken = 0;
    while taken < steps && simulation.fault().is_none() {
        taken += simulation.advance((steps - taken).min(9), &mut || true);
    }
    taken
}

/// Runs a level step by step, at a stretch with one thread and with two, with one step under way and with many, and compares them every
/// now and then.
fn compare(level: &Level, stretches: u32, steps: u64) -> Simulation {
    let mut single = simulation(level);
    let mut runs = [(1, NONE, 8), (2, NONE, 8), (2, ENDLESS, 1)].map(|(threads, caches, at_once)| {
        let mut run = simulation(level);
        run.set_threads(threads);
        run.set_caches(caches);
        (run, at_once)
    });
    for stretch in 0..stretches {
        let taken = singly(&mut single, steps);
        for (run, at_once) in &mut runs {
            let what = format!("stretch {stretch}, {at_once} steps at once");
            assert_eq!(run.advance(steps, &mut || true), taken, "{what}");
            assert_eq!(work(run), work(&single), "{what}");
            assert_eq!((run.fault(), run.parts()), (single.fault(), single.parts()), "{what}");
            assert!([0, *at_once].contains(&run.steps_at_once()), "{what}: {}", run.steps_at_once());
        }
    }
    assert_eq!([single.steps_at_a_stretch(), single.steps_at_once().into()], [0, 0]);
    let [.., (two, _)] = runs;
    two
}

#[test]
fn as_many_steps_are_under_way_as_half_of_a_cores_own_cache_holds_and_all_there_may_be_where_none_is_large_enough() {
    const KILO: usize = 1 << 10;
    let caches = |own| Caches { own: own * KILO, shared: 32 << 20 };
    let steps = |own, in_all| caches(own).steps_at_once(Bytes { in_all: in_all * KILO, at_once: 100 * KILO });
    assert_eq!([256, 1024, 2048].map(|own| steps(own, own)), [1; 3], "all of it stays there");
    assert_eq!([256, 512, 1024, 2048, 4096].map(|own| steps(own, 8192)), [2, 3, 5, 8, 8]);
    assert_eq!([256, 1024, 2048].map(|own| steps(own, (32 << 10) + 1)), [8; 3], "memory is what they wait for");
    let alone = Caches { own: 512 * KILO, shared: 512 * KILO };
    assert_eq!(alone.steps_at_once(Bytes { in_all: 8192 * KILO, at_once: 100 * KILO }), 3, "there is no third level");
    for caches in [NONE, LITTLE, SMALL, ENDLESS] {
        assert!((1..=8).contains(&caches.steps_at_once(Bytes { in_all: usize::MAX, at_once: usize::MAX })));
        assert!((1..=8).contains(&caches.steps_at_once(Bytes { in_all: 0, at_once: 0 })));
    }
    let Caches { own, shared } = Caches::here();
    assert!((1 << 15..1 << 27).contains(&own) && own <= shared, "{own} {shared}");
}

/// What the numbers in the documentation of the caches are.
#[test]
fn four_steps_of_a_sheet_are_under_way_with_a_megabyte_eight_with_two_and_one_while_all_of_it_stays_there() {
    let sheet = |side: u32| {
        level(&format!(
            "(name: \"sheet\", substeps: {}, bodies: [(name: \"sheet\", mass: Density(1), stretch: (1.1, 1),
              mesh: Rectangle(width: 1, height: 1, columns: {side}, rows: {side}, diagonals: Grid),
              material: (model: StableNeoHookean, young: 1000, poisson: 0.3, plane: Strain))])",
            10 * side
        ))
    };
    for (side, at_once) in [(71, [1, 1]), (158, [4, 8]), (224, [4, 8])] {
        let under_way = [1, 2].map(|megabytes| {
            let mut run = simulation(&sheet(side));
            run.set_caches(Caches { own: megabytes << 20, shared: 32 << 20 });
            run.advance(60, &mut || true);
            run.steps_at_once()
        });
        assert_eq!(under_way, at_once, "{} triangles", 2 * side * side);
    }
}

/// Sheets of 33,856 and of 262,144 triangles.
#[test]
fn a_vast_body_whose_steps_overlap_comes_to_the_bits_and_books_of_single_steps() {
    let damped = "effects: [(effect: Gravity(down: 1)), (effect: Rayleigh(mass: 0.3, stiffness: 1e-5))]";
    let floor = "effects: [(effect: Walls(obstacles: [Plane(point: (0, -0.005), normal: (0, 1), eps: 0.001)]))]";
    let too_long = "guard: Off, effects: []";
    for (side, (substeps, rest, most_threads, at_a_stretch)) in [92, 256]
        .into_iter()
        .flat_map(|side| [(2560, damped, 2, 50), (2560, floor, 2, 5), (30, too_long, 1, 5)].map(|run| (side, run)))
    {
        let level = square(side, "stretch: (1.1, 1), velocity: (0, -10),", &format!("substeps: {substeps}, {rest}"));
        let mut single = simulation(&level);
        singly(&mut single, 81);
        let runs = (1..=most_threads)
            .flat_map(|threads| [(threads, NONE, 8..9), (threads, SMALL, 3..8), (threads, LITTLE, 2..3)]);
        for (threads, caches, at_once) in runs {
            let mut run = simulation(&level);
            run.set_threads(threads);
            run.set_caches(caches);
            // As if somebody had no more time after a while.
            let taken = run.advance(81, &mut enough_after(2));
            assert!(taken < 45, "{rest}: {taken} steps");
            assert!(run.fault().is_some() || run.advance(81 - taken, &mut || true) == 81 - taken);
            assert_eq!(work(&single), work(&run), "{rest}");
            assert_eq!(single.fault(), run.fault(), "{rest}");
            let walked = [run.steps_at_a_stretch(), run.steps_together()];
            assert!(at_once.contains(&run.steps_at_once()), "{side} {rest}: {}", run.steps_at_once());
            assert!(walked[0] >= at_a_stretch && walked[1] == walked[0] * (threads as u64 - 1), "{rest}: {walked:?}");
        }
        assert_eq!(single.steps_at_a_stretch(), 0);
        assert_eq!(single.fault().is_some(), rest == too_long);
        assert_eq!(single.counts().constrained > 0, rest == floor);
    }
}

#[test]
fn damping_and_drag_are_shared_as_well() {
    let damped = "effects: [(effect: Gravity(down: 1)), (effect: Rayleigh(mass: 0.3, stiffness: 0.0001)), (effect: Drag(coefficient: 1e-6))]";
    for (body, at_rest) in [("stretch: (1.1, 1),", false), ("", true)] {
        let run = compare(&large(body, &format!("substeps: 700, sleep: Off, {damped}")), 4, 333);
        assert!(run.steps_together() > 900, "at rest {at_rest}: only {} steps together", run.steps_together());
    }
}

#[test]
fn two_threads_come_to_the_bits_and_books_of_one() {
    let gravity = "effects: [(effect: Gravity(down: 1, right: 2)), (effect: MouseSpring(stiffness: 10))]";
    for (body, rest) in [
        ("stretch: (1.1, 1),", "substeps: 700, effects: []"),
        ("pins: [Top],", &format!("substeps: 700, sleep: Off, {gravity}")),
        ("velocity: (3, 0), spin: 5,", "substeps: 700, guard: Off, effects: []"),
    ] {
        // Steps in odd numbers, so that stretches begin and end anywhere.
        let run = compare(&large(body, rest), 7, 333);
        assert!(run.steps_together() > 1000, "only {} steps were taken together", run.steps_together());
    }
}

/// One of two sheets rests where nothing acts on it, and soon sleeps.
#[test]
fn a_body_beside_one_that_sleeps_is_shared_as_well() {
    let sheet = |name: &str, body: &str| {
        format!(
            "(name: \"{name}\", mass: Density(1), {body} mesh: Rectangle(width: 1, height: 1, columns: 68, rows: 68),
              material: (model: StableNeoHookean, young: 10, poisson: 0.3, plane: Strain)),"
        )
    };
    let (still, moving) = (sheet("still", "place: (offset: (2, 0)),"), sheet("moving", "stretch: (1.1, 1),"));
    for bodies in [still.clone() + &moving, moving + &still] {
        let level = level(&format!("(name: \"two\", substeps: 20, bodies: [{bodies}], effects: [])"));
        let run = compare(&level, 4, 333);
        // Not before the other sleeps.
        let together = run.steps_together();
        assert!((500..1000).contains(&together), "{together} steps together");
    }
}

/// As long as it moves a stretch does not stop where somebody would look whether it is calm; then it does.
#[test]
fn what_comes_to_rest_during_a_stretch_falls_asleep_after_the_step_it_would() {
    let rest = "substeps: 20, effects: [(effect: Rayleigh(mass: 30))]";
    let soft = "(name: \"soft\", mass: Density(1), stretch: (1.02, 1), mesh: Rectangle(width: 1, height: 1, columns: 68, rows: 68),
        material: (model: StableNeoHookean, young: 10, poisson: 0.3, plane: Strain))";
    let run = compare(&level(&format!("(name: \"soft\", {rest}, bodies: [{soft}])")), 3, 1500);
    assert!(run.is_asleep() && run.counts().slept > 0 && run.steps_together() > 1000, "{:?}", run.counts());
}

#[test]
fn what_falls_on_a_floor_while_two_share_the_work_is_stopped_where_it_would_be() {
    let floor = "(effect: Walls(obstacles: [Plane(point: (0, -0.02), normal: (0, 1), eps: 0.001)]))";
    let rest = format!("substeps: 700, effects: [(effect: Gravity(down: 20)), {floor}]");
    let run = compare(&large("stretch: (1.02, 1),", &rest), 5, 700);
    assert!(run.counts().constrained > 0 && run.steps_together() > 300, "{:?} {}", run.counts(), run.steps_together());
}

/// Too long a step: the guard goes back and takes shorter ones, from just the same steps.
#[test]
fn the_guard_steps_in_where_it_would_with_one_thread() {
    let rest = "substeps: 60, effects: [(effect: Gravity(down: 1))]";
    let run = compare(&large("stretch: (1.1, 1),", rest), 12, 200);
    assert!(
        run.counts().retaken > 0 && run.counts().guarded > 0,
        "the step should have been too long: {:?}",
        run.counts()
    );
    let rest = "substeps: 60, guard: Off, effects: [(effect: Gravity(down: 1))]";
    let run = compare(&large("stretch: (1.1, 1),", rest), 12, 200);
    assert!(run.fault().is_some(), "without the guard it should have blown up");
}

/// Says yes so often, and then no; may not be asked again after that.
fn enough_after(mut times: u32) -> impl FnMut() -> bool {
    let mut said = false;
    move || {
        assert!(!said, "was asked again");
        said = times == 0;
        times = times.saturating_sub(1);
        !said
    }
}

#[test]
fn who_has_no_more_time_has_a_stretch_end_soon_and_for_all_after_the_same_step() {
    let level = large("stretch: (1.1, 1),", "substeps: 700, effects: []");
    for (threads, caches) in [(1, NONE), (1, ENDLESS), (2, NONE), (2, LITTLE), (2, ENDLESS)] {
        let [mut single, mut run] = [&level; 2].map(simulation);
        run.set_threads(threads);
        run.set_caches(caches);
        for times in [0, 1, 2, 3, 5, 8, 13, 21, 34, 55] {
            let taken = run.advance(2000, &mut enough_after(times));
            let asked = u64::from(times) + 1;
            // Asked after every ten steps at the latest, and obeyed within twelve.
            assert!((asked..=10 * asked + 12).contains(&taken), "{taken} steps, asked {asked} times");
            singly(&mut single, taken);
            assert_eq!(work(&run), work(&single), "{threads} threads, asked {asked} times");
        }
        assert!(run.steps_at_a_stretch() > 300, "{}", run.steps_at_a_stretch());
    }
}

/// Two plates that are one body and touch nowhere, so that the two halves have nothing to tell each other.
#[test]
fn halves_that_touch_nowhere_stop_after_the_same_step_too() {
    let side = 64;
    let points =
        (0..2).flat_map(|plate| (0..65 * 65).map(move |i| (f64::from(i % 65 + 100 * plate), f64::from(i / 65))));
    let quad = |i: u32| (i / (side * side) * 65 * 65) + i % (side * side) / side * 65 + i % side;
    let triangles = (0..2 * side * side).map(quad).flat_map(|a| [(a, a + 1, a + 65), (a + 1, a + 66, a + 65)]);
    let (points, triangles): (Vec<_>, Vec<_>) = (points.collect(), triangles.collect());
    let level = level(&format!(
        "(name: \"plates\", substeps: 10, bodies: [(name: \"plates\", mass: Density(1), stretch: (1.1, 1), velocity: (1, 0),
          mesh: Points(points: {points:?}, triangles: {triangles:?}), material: (model: Corotated, young: 1000, poisson: 0.3))])"
    ));
    for caches in [NONE, LITTLE, ENDLESS] {
        let [mut single, mut two] = [&level; 2].map(simulation);
        two.set_threads(2);
        two.set_caches(caches);
        for times in 0..30 {
            let taken = two.advance(2000, &mut enough_after(times % 7));
            singly(&mut single, taken);
            assert_eq!(work(&two), work(&single), "after {times} stretches");
        }
        assert!(two.steps_together() > 100, "{}", two.steps_together());
    }
}

/// A wheel whose hub has forces from all triangles, so that those of all of them wait for the last; the steps of both halves overlap.
#[test]
fn a_vertex_that_lies_in_every_triangle_is_shared_as_well() {
    let spokes = 30_000;
    let rim = (0..spokes).map(|i| (f64::from(i) * std::f64::consts::TAU / f64::from(spokes)).sin_cos());
    let points: Vec<_> = [(0.0, 0.0)].into_iter().chain(rim.map(|(sin, cos)| (5000.0 * cos, 5000.0 * sin))).collect();
    let triangles: Vec<_> = (0..spokes).map(|i| (0, i + 1, (i + 1) % spokes + 1)).collect();
    let wheel = level(&format!(
        "(name: \"wheel\", substeps: 2000, guard: Off, bodies: [(name: \"wheel\", mass: Density(1), stretch: (1.001, 1),
          mesh: Points(points: {points:?}, triangles: {triangles:?}), material: (model: Corotated, young: 1000, poisson: 0.3))])"
    ));
    assert!(compare(&wheel, 2, 50).steps_together() > 50);
}

/// Where steps fail again soon after they did, the guard goes back to the checkpoint that it would go back to without stretches.
#[test]
fn what_fails_time_and_again_is_held_or_given_up_with_the_bits_of_single_steps() {
    let man = |seed: u32, rest: &str| {
        level(&format!(
            "(name: \"scrambled\", {rest}, effects: [(effect: Rayleigh(mass: 1))], bodies: [(name: \"man\", mass: Density(100),
              mesh: Gingerbread(resolution: 128), material: (model: NeoHookean, young: 1000, poisson: 0.3, plane: Strain),
              start: Scrambled(seed: {seed}))])"
        ))
    };
    for (substeps, fails) in [(300, true), (1000, false), (3000, false)] {
        let rest = format!("substeps: {substeps}, sleep: Off");
        let runs: Vec<_> = (1..=6).map(|seed| compare(&man(seed, &rest), 6, 777)).collect();
        assert_eq!(runs.iter().any(|run| run.fault().is_some()), fails, "{substeps}");
        let [retaken, walked] = [|run: &Simulation| run.counts().retaken, Simulation::steps_at_a_stretch]
            .map(|of| runs.iter().map(of).sum::<u64>());
        assert!(retaken > 200 && walked > 10, "{substeps}: {retaken} steps taken again, {walked} at a stretch");
    }
}

#[test]
fn a_mesh_in_no_order_is_shared_as_well_but_not_halves_that_lie_in_each_other_nor_small_ones() {
    let side = 68;
    let points: Vec<_> = (0..side * side).map(|i| (f64::from(i % side), f64::from(i / side))).collect();
    let square = |i: u32| {
        let corner = i / (side - 1) * side + i % (side - 1);
        [(corner, corner + 1, corner + side), (corner + 1, corner + side + 1, corner + side)]
    };
    let by_row: Vec<_> = (0..(side - 1) * (side - 1)).flat_map(square).collect();
    let listed = |triangles: Vec<(u32, u32, u32)>| {
        level(&format!(
            "(name: \"listed\", substeps: 10, effects: [(effect: Gravity(down: 1))], bodies: [(name: \"listed\", mass: Density(1),
              stretch: (1.1, 1), mesh: Points(points: {points:?}, triangles: {triangles:?}),
              material: (model: Corotated, young: 1000, poisson: 0.3))])"
        ))
    };
    // 2053 is a prime that does not divide their number: every triangle comes once.
    let shuffled: Vec<_> = (0..by_row.len()).map(|i| by_row[i * 2053 % by_row.len()]).collect();
    // One of them finds no other to be stepped together with.
    let odd = shuffled[..shuffled.len() - 1].to_vec();
    // First every other square, then those between: everywhere, or in the middle alone, where they are near each other.
    let woven = |of: &[(u32, u32, u32)]| {
        [0, 1].into_iter().flat_map(|half| of.chunks(2).skip(half).step_by(2).flatten().copied()).collect::<Vec<_>>()
    };
    for far in [shuffled, odd, woven(&by_row)] {
        assert!(compare(&listed(far), 2, 100).steps_together() > 0);
    }
    let (begin, end) = (3000, by_row.len() - 3000);
    let middle = [&by_row[..begin], &woven(&by_row[begin..end]), &by_row[end..]].concat();
    for level in [listed(middle), common::sheet("Corotated", "", "effects: [(effect: Gravity(down: 1))]")] {
        assert_eq!(compare(&level, 2, 100).steps_together(), 0);
    }
}

//! Regions of a body at rest sleep while the rest of the body moves, within a tolerance.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a failing test should panic")]

use crate::common::{greatest_gap, level, reopened, simulation};
use gingerbread::{
    effects::Grab,
    integrators::IntegratorKind,
    level::{Level, MassLevel, Sleep, SubstepMode, Substeps, Toggle},
    quantity::{Density, SleepTolerance},
    simulation::Simulation,
    state::State,
};

fn regions(tolerance: f64) -> Sleep {
    Sleep::Regions(SleepTolerance::new(tolerance).unwrap())
}

/// Where he is fixed: at his chest, which keeps the pull of a hand from the rest, or at his belly, which does not.
const CHEST: &str = "Disk((0.5, 0.56), 0.17)";
const BELLY: &str = "Disk((0.5, 0.5), 0.15)";

/// A gingerbread man who is fixed by these pins.
fn man(resolution: u32, pins: &str, effects: &str) -> Level {
    level(&format!(
        "(name: \"man\", bodies: [(name: \"man\", mesh: Gingerbread(resolution: {resolution}), mass: Density(25),
            material: (model: NeoHookean, young: 10000, poisson: 0.3, plane: Stress), pins: [{pins}])],
          effects: [(effect: Gravity(down: 2)), (effect: Rayleigh(mass: 4, stiffness: 0.0002)), (effect: MouseSpring(stiffness: 300)){effects}])"
    ))
}

/// The state in which a level comes to rest, and its vertex farthest to the right.
fn rest(level: &Level) -> (State, usize) {
    let mut run = simulation(&Level { sleep: Sleep::On, ..level.clone() });
    while !run.is_asleep() && run.state().time < 20.0 {
        run.advance(100, &mut || true);
    }
    assert!(run.is_asleep(), "still awake after {} s", run.state().time);
    let state = run.state().clone();
    let hand = (0..state.x.len() / 2).max_by(|a, b| state.x[2 * a].total_cmp(&state.x[2 * b])).unwrap();
    (state, hand)
}

/// A run from rest, in which the hand is pulled to the right.
fn pulled(level: &Level, (state, hand): (&State, usize), sleep: Sleep) -> Simulation {
    let mut run = simulation(&Level { sleep, ..level.clone() });
    let mut state = state.clone();
    state.slow_checks.resize(1 + run.sleeping_regions()[1], 0);
    state.memory.clear();
    let target = [state.x[2 * hand] + 1.0, state.x[2 * hand + 1], 0.0];
    run.set_state(state);
    run.set_grab(Some(Grab { vertex: hand, target }));
    run
}

/// Root mean square of the distance of two runs over that of the motion from the start, over all frames; and the share of triangle steps.
fn compared(runs: [&mut Simulation; 2], start: &[f64], frames: u32) -> [f64; 2] {
    let [one, other] = runs;
    let square = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
    let (mut off, mut motion) = (0.0, 0.0);
    for _ in 0..frames {
        for run in [&mut *one, &mut *other] {
            run.advance(run.scene().steps_per_frame(), &mut || true);
            assert_eq!(run.fault(), None);
        }
        off += square(&one.state().x, &other.state().x);
        motion += square(&other.state().x, start);
    }
    let triangles = [&*one, &*other].map(|run| run.counts().triangle_steps as f64);
    [(off / motion).sqrt(), triangles[0] / triangles[1]]
}

#[test]
fn pulling_one_arm_halves_the_triangle_steps_at_one_percent() {
    let level = man(2000, CHEST, "");
    let (start, hand) = rest(&level);
    let mut awake = pulled(&level, (&start, hand), Sleep::Off);
    let mut asleep = pulled(&level, (&start, hand), regions(1e-3));
    let [off, share] = compared([&mut asleep, &mut awake], &start.x, 120);
    println!("off by {:.3} % of the motion with {:.1} % of the triangle steps", 100.0 * off, 100.0 * share);
    assert!(off < 0.01 && share < 0.5, "off by {off} with {share} of the triangle steps");
}

#[test]
fn a_smaller_tolerance_keeps_more_awake_and_is_more_accurate() {
    let level = man(600, BELLY, "");
    let (start, hand) = rest(&level);
    let results = [1e-3, 1e-4, 1e-5].map(|tolerance| {
        let mut awake = pulled(&level, (&start, hand), Sleep::Off);
        compared([&mut pulled(&level, (&start, hand), regions(tolerance)), &mut awake], &start.x, 60)
    });
    for [coarse, fine] in [[0, 1], [1, 2]].map(|pair| pair.map(|number: usize| results[number])) {
        assert!(fine[0] < 0.5 * coarse[0] && fine[1] >= coarse[1], "{results:?}");
    }
}

/// All schemes, with damping and contact; the energy never rises beyond that of the pull.
#[test]
fn every_integrator_lets_regions_sleep_and_continues_bit_for_bit() {
    let floor = ", (effect: Walls(obstacles: [Plane(point: (0, -0.2), normal: (0, 1), eps: 0.01)])), (effect: Contact(speed: 1))";
    let level = man(600, CHEST, floor);
    let (start, hand) = rest(&level);
    for integrator in IntegratorKind::all() {
        let name = integrator.name();
        let level = Level { integrator, substeps: Substeps::new(100).unwrap(), ..level.clone() };
        let mut run = pulled(&level, (&start, hand), regions(4e-3));
        assert!(run.sleeping_regions()[0] > 0, "{name}: only the regions at the hand wake");
        let energy = run.energies().total();
        let mut fewest = usize::MAX;
        for _ in 0..60 {
            run.advance(100, &mut || true);
            assert!(run.fault().is_none() && run.energies().total() < 1.001 * energy, "{name}");
            fewest = fewest.min(run.computed_triangles());
            let still = run.still_vertices();
            assert!(
                run.state().v.chunks(2).zip(still).all(|(v, still)| !still || v == [0.0; 2]),
                "{name}: no velocity"
            );
        }
        assert!(run.sleeping_regions()[0] > 0 && fewest < 500, "{name}: {:?}, {fewest}", run.sleeping_regions());
        for guard in [Toggle::On, Toggle::Off] {
            let level = Level { sleep: regions(4e-3), guard, ..level.clone() };
            let mut run = pulled(&level, (&start, hand), regions(4e-3));
            run.advance(313, &mut || true);
            run.set_grab(None);
            run.advance(1013, &mut || true);
            let mut other = reopened(&run, &level);
            assert_eq!(run.sleeping_regions(), other.sleeping_regions(), "{name}");
            for run in [&mut run, &mut other] {
                run.advance(400, &mut || true);
            }
            let both = [&run, &other].map(|run| (run.state().hash(), run.state().slow_checks.clone()));
            assert!(both[0] == both[1], "{name} continues with the same bits, guard {guard:?}");
        }
    }
}

#[test]
fn a_body_whose_regions_are_all_slow_sleeps_as_a_whole() {
    let level = man(600, BELLY, "");
    let (start, hand) = rest(&level);
    let mut run = pulled(&level, (&start, hand), regions(4e-3));
    run.advance(1000, &mut || true);
    run.set_grab(None);
    while !run.is_asleep() && run.state().time < start.time + 20.0 {
        run.advance(100, &mut || true);
    }
    assert!(run.is_asleep() && run.sleeping_regions()[0] == 0 && run.still_vertices().is_empty());
    let apart = greatest_gap(&run.state().x, &start.x);
    assert!(apart < 1e-3, "comes back to {apart} m");
}

/// What falls on a sleeping region wakes it, and the region gives way.
#[test]
fn a_falling_body_wakes_the_region_that_it_hits() {
    let block = "(name: \"block\", bodies: [
        (name: \"loaf\", mesh: Rectangle(width: 2, height: 0.3, columns: 40, rows: 6, corner: (-1, 0)), mass: Density(25),
          material: (model: NeoHookean, young: 10000, poisson: 0.3, plane: Stress), pins: [Bottom]),
        (name: \"ball\", mesh: Disk(radius: 0.08, rings: 4, centre: (0.6, 3)), mass: Density(100),
          material: (model: NeoHookean, young: 10000, poisson: 0.3, plane: Stress))],
        sleep: Regions(0.001), effects: [(effect: Gravity(down: 2)), (effect: Rayleigh(mass: 0.5, stiffness: 0.002)), (effect: Contact(speed: 4))])";
    let mut run = simulation(&level(block));
    let top = (0..41 * 7).min_by(|a, b| {
        let distance =
            |vertex: usize| libm::hypot(run.scene().rest[2 * vertex] - 0.6, run.scene().rest[2 * vertex + 1] - 0.3);
        distance(*a).total_cmp(&distance(*b))
    });
    let (top, mut partly, mut lowest) = (2 * top.unwrap() + 1, 0, f64::INFINITY);
    for _ in 0..240 {
        run.advance(100, &mut || true);
        let [asleep, all] = run.sleeping_regions();
        if asleep > all / 4 && asleep < all {
            partly += 1;
            lowest = lowest.min(run.state().x[top]);
        }
    }
    assert!(run.fault().is_none());
    assert_eq!(run.count_crossings(), Some(0));
    assert!(partly > 20, "regions slept in {partly} frames");
    assert!(lowest < 0.295, "the loaf gives way to {lowest} m");
}

/// Pulses with pauses, each shorter than the tolerance, add up: what sleeps wakes in time.
#[test]
fn slow_motion_with_pauses_wakes_what_lies_beside() {
    let strip = "(name: \"strip\", bodies: [(name: \"strip\", mesh: Rectangle(width: 2, height: 0.2, columns: 80, rows: 8, corner: (0, 0)), mass: Density(25),
          material: (model: NeoHookean, young: 10000, poisson: 0.3, plane: Stress), pins: [Left])],
        effects: [(effect: Rayleigh(mass: 4, stiffness: 0.0002)), (effect: MouseSpring(stiffness: 10000))])";
    let level = level(strip);
    let end = 81 * 9 - 1;
    let pull = |sleep: Sleep| {
        let mut run = simulation(&Level { sleep, ..level.clone() });
        let (mut target, mut fewest) = ([run.state().x[2 * end], run.state().x[2 * end + 1], 0.0], usize::MAX);
        for _ in 0..30 {
            target[0] += 6e-4;
            run.set_grab(Some(Grab { vertex: end, target }));
            run.advance(9000, &mut || true);
            fewest = fewest.min(run.computed_triangles());
        }
        assert_eq!(run.fault(), None);
        (run.state().x.clone(), fewest)
    };
    let (asleep, fewest) = pull(regions(4e-3));
    let (awake, _) = pull(Sleep::Off);
    let apart = greatest_gap(&asleep, &awake);
    assert!(fewest < 2000 && apart < 4e-3 * 2.0, "{fewest} triangles, {apart} m apart");
}

#[test]
fn other_bodies_sleep_as_a_whole() {
    let level = man(300, CHEST, "");
    let mut quadratic = level.clone();
    quadratic.bodies[0].element = gingerbread::elements::ElementKind::Quadratic;
    let multirate = Level { paces: SubstepMode::Own, ..level.clone() };
    let mut consistent = level.clone();
    consistent.bodies[0].mass = MassLevel::Consistent(Density::new(25.0).unwrap());
    let mut free = level.clone();
    free.bodies[0].pins.clear();
    for level in [quadratic, multirate, consistent, free] {
        assert_eq!(simulation(&Level { sleep: regions(4e-3), ..level }).sleeping_regions(), [0, 0]);
    }
    assert!(simulation(&Level { sleep: regions(4e-3), ..level }).sleeping_regions()[1] > 8);
}

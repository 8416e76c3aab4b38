//! Facts about pinned vertices that move along a path.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a failing test should panic")]

use crate::common::{continues_bit_for_bit, greatest_gap, level, named, running, simulation};
use gingerbread::{
    command::Command,
    integrators::{Class, IntegratorKind},
    level::{Level, Sleep},
    meshes::NoFiles,
    sandbox::Sandbox,
    scene::Scene,
    simulation::Simulation,
};

const BODY: &str = "bodies: [(name: \"it\", mesh: Rectangle(width: 0.4, height: 0.2, columns: 4, rows: 2, diagonals: Alternating, corner: (0.3, 0.4)),
    material: (model: NeoHookean, young: 2000, poisson: 0.3, plane: Stress), mass: Density(10))]";

const MEMBRANE: &str = "membranes: [(name: \"it\", mesh: Rectangle(width: 0.4, height: 0.2, columns: 4, rows: 2, diagonals: Alternating, corner: (0, 0)),
    material: (model: NeoHookean, young: 2000, poisson: 0.3, plane: Stress), thickness: 0.01, mass: Density(100), space: (turn: (20, 40, 5)))]";

const NET: &str = "nets: [(name: \"it\", net: Sheet(width: 0.4, height: 0.2, columns: 4, rows: 2, structural: 40, shear: 20, flexion: 10, corner: (0.3, 0.4)), mass: 0.008)]";

const NET_IN_SPACE: &str = "nets: [(name: \"it\", net: Sheet(width: 0.4, height: 0.2, columns: 4, rows: 2, structural: 40, shear: 20, flexion: 10, corner: (0, 0)),
    mass: 0.008, space: (turn: (20, 40, 5)))]";

const ALL: [&str; 4] = [BODY, MEMBRANE, NET, NET_IN_SPACE];

fn held(parts: &str, pins: &str, motions: &str, effects: &str) -> Level {
    level(&format!(
        "(name: \"\", {parts}, effects: [(effect: MovingPins(of: \"it\", pins: [{pins}], motions: [{motions}])), {effects}])"
    ))
}

fn stepped(level: &Level, kind: &IntegratorKind, step: f64) -> Simulation {
    let mut simulation = simulation(&Level { integrator: kind.clone(), ..level.clone() });
    let scene = Scene { step, sleep: Sleep::Off, ..simulation.scene().clone() };
    simulation.replace_scene(scene);
    simulation
}

const WAVE: &str = "Swing(way: (0.02, 0.03), period: 0.2), Turn(about: (0.3, 0.4), spin: 2)";

/// Every scheme converges to one motion, by its order, and what the pins do is work.
#[test]
fn every_integrator_follows_the_pins() {
    for parts in ALL {
        let level = held(parts, "Left", WAVE, "");
        let end = |kind: &IntegratorKind, step: f64| {
            let mut run = stepped(&level, kind, step);
            run.set_measured(true);
            let start = run.energies().total();
            run.advance((0.2 / step).round() as u64, &mut || true);
            assert!(run.fault().is_none(), "{}: {:?}", kind.name(), run.fault());
            assert_eq!(run.counts().guarded, 0, "{}", kind.name());
            let drift = run.energies().total() + run.heat() - run.work_of_obstacles() - start;
            (run.state().x.clone(), drift.abs(), run.energies().total())
        };
        let (exact, drift, energy) = end(&named("RungeKutta4"), 2.5e-4);
        assert!(drift < 1e-4 * energy, "{drift} J of {energy} J");
        for kind in IntegratorKind::all() {
            let step = match (kind.kind().class(), kind.kind().order()) {
                (Class::Explicit, 1) => 1e-4,
                (Class::Implicit, _) => 1e-3,
                _ => 5e-4,
            };
            let [whole, half] = [step, 0.5 * step].map(|step| greatest_gap(&end(&kind, step).0, &exact));
            let (most, ratio) = match kind.kind().order() {
                1 => (0.03, 0.65),
                2 => (3e-3, 0.35),
                _ => (1e-5, f64::INFINITY),
            };
            assert!(whole < most && half <= ratio * whole, "{}: {whole} m and {half} m", kind.name());
        }
    }
}

/// A part that is held as a whole moves as a rigid body, where it must be at each time.
#[test]
fn held_vertices_are_on_their_path() {
    for parts in ALL {
        let level =
            held(parts, "Top, Bottom, Left, Right", "Slide(velocity: (0.3, -0.2))", "(effect: Gravity(down: 9.81))");
        for kind in IntegratorKind::all() {
            let mut run = stepped(&level, &kind, 1e-3);
            let start = run.scene().start.x.clone();
            run.advance(100, &mut || true);
            let (scene, state) = (run.scene(), run.state());
            for vertex in scene.held() {
                let numbers = scene.numbers(&(vertex as usize..vertex as usize + 1));
                for (axis, number) in numbers.enumerate() {
                    let path = [0.03, -0.02, 0.0][axis];
                    assert!((state.x[number] - start[number] - path).abs() < 1e-12, "{}", kind.name());
                    assert!((state.v[number] - [0.3, -0.2, 0.0][axis]).abs() < 1e-12, "{}", kind.name());
                }
            }
        }
    }
}

/// What begins with the velocity of its pins moves on as a rigid body, with every scheme: nothing pulls at it.
#[test]
fn a_part_goes_along_with_its_pins() {
    for parts in ALL {
        let level = held(parts, "Left", "Slide(velocity: (0.3, -0.2))", "");
        for kind in IntegratorKind::all() {
            let mut run = stepped(&level, &kind, 1e-3);
            let (start, dimension) = (run.scene().start.x.clone(), run.scene().dimension);
            let mut state = run.state().clone();
            state.v.chunks_mut(dimension).for_each(|v| v[..2].copy_from_slice(&[0.3, -0.2]));
            run.set_state(state);
            run.advance(50, &mut || true);
            let exact: Vec<f64> =
                start.iter().enumerate().map(|(n, x)| x + [0.015, -0.01, 0.0][n % dimension]).collect();
            let gap = greatest_gap(&run.state().x, &exact);
            // Linearised where the pins have moved by 0.36 mm already, forces of a step have an error of the second order.
            let most = if kind.name() == "LinearlyImplicitEuler" { 5e-6 } else { 1e-9 };
            assert!(gap < most, "{}: {gap} m", kind.name());
        }
    }
}

#[test]
fn a_held_run_is_saved_and_continued_bit_for_bit() {
    for parts in ALL {
        for kind in IntegratorKind::all() {
            let level = held(parts, "Left", WAVE, "(effect: Rayleigh(mass: 0.5, stiffness: 0.001))");
            let level = Level { integrator: kind.clone(), ..level };
            continues_bit_for_bit(&level);
        }
    }
}

/// With multirate stepping too.
#[test]
fn pins_move_with_multirate_stepping() {
    for parts in ALL {
        let level = held(parts, "Left", WAVE, "(effect: Rayleigh(mass: 0.5, stiffness: 0.0001))");
        let text = gingerbread::files::write(&level).unwrap().replace("name: \"\",", "name: \"\", paces: Own,");
        let own = gingerbread::files::parse(&text, "own.ron").unwrap();
        let [one, other] = [level, own].map(|level| {
            let mut run = stepped(&level, &named("VelocityVerlet"), 5e-4);
            run.advance(400, &mut || true);
            assert!(run.fault().is_none(), "{:?}", run.fault());
            run.state().x.clone()
        });
        assert!(greatest_gap(&one, &other) < 2e-3, "{}", greatest_gap(&one, &other));
    }
}

#[test]
fn wrong_pins_say_why() {
    let refused = |pins: &str, motions: &str, parts: &str| {
        let level = held(parts, pins, motions, "");
        Scene::build(&level, level.mode, &NoFiles, None).err().unwrap().to_string()
    };
    assert!(refused("", WAVE, BODY).contains("names no vertex"));
    let twice = held(BODY, "Left", WAVE, "(effect: MovingPins(pins: [Bottom], motions: []))");
    let error = Scene::build(&twice, twice.mode, &NoFiles, None).err().unwrap().to_string();
    assert!(error.contains("two of them move vertex 0"), "{error}");
    assert!(refused("Vertex(99)", WAVE, BODY).contains("a pin names vertex 99"));
    assert!(refused("Left", "Swing(way: (1, 0, 1), period: 1)", NET).contains("its motion Swing is in space"));
    assert!(refused("Left", "Turn(about: (0, 0), axis: (0, 0, 0), spin: 1)", MEMBRANE).contains("axis of a turn"));
    assert!(refused("Left", WAVE, &NET.replace("\"it\"", "\"other\"")).contains("no body or net is called \"it\""));
}

/// The pin modes of Princeton's cloth.
#[test]
fn corners_and_random_vertices_can_be_pinned() {
    let pinned = |pins: &str| {
        let parts = NET_IN_SPACE.replace("mass: 0.008,", &format!("mass: 0.008, pins: [{pins}],"));
        simulation(&level(&format!("(name: \"\", {parts})"))).scene().pins.to_vec()
    };
    assert_eq!(pinned("Corners"), [0, 4, 10, 14]);
    assert_eq!(pinned("Top, Bottom, Left, Right").len(), 12);
    let random = pinned("Random(count: 5, seed: 3)");
    assert_eq!(random.len(), 5);
    assert_eq!(random, pinned("Random(count: 5, seed: 3)"));
    assert_ne!(random, pinned("Random(count: 5, seed: 4)"));
    assert_eq!(pinned("Random(count: 99, seed: 3)").len(), 15);
}

/// It is where it should be at each time, at rest at both ends, and its velocity does not jump.
#[test]
fn a_spline_passes_smoothly_through_its_points() {
    let spline = "Spline(points: [(0.1, (0, 0)), (0.3, (0.02, 0.01)), (0.4, (0.02, -0.01)), (0.7, (-0.03, 0))])";
    for parts in ALL {
        let run = simulation(&held(parts, "Left", spline, ""));
        let scene = run.scene();
        let pin = scene.held().next().unwrap() as usize;
        let first = scene.dimension * pin;
        let at = |time: f64| {
            let (mut x, mut v) = (scene.start.x.clone(), scene.start.v.clone());
            scene.place_held(time, &mut x, &mut v);
            [0, 1].map(|axis| [x[first + axis] - scene.start.x[first + axis], v[first + axis]])
        };
        let ends = [(0.0, [0.0, 0.0]), (0.1, [0.0, 0.0]), (0.7, [-0.03, 0.0]), (2.0, [-0.03, 0.0])];
        for (time, place) in ends.into_iter().chain([(0.3, [0.02, 0.01]), (0.4, [0.02, -0.01])]) {
            let found = at(time);
            assert!((0..2).all(|axis| (found[axis][0] - place[axis]).abs() < 1e-15), "{time}: {found:?}");
            if !(0.2..0.6).contains(&time) {
                assert!(found.iter().all(|[_, v]| *v == 0.0), "{time}: {found:?}");
            }
        }
        for time in [0.1, 0.3, 0.4, 0.7] {
            let [before, after] = [at(time - 1e-9), at(time + 1e-9)];
            assert!((0..2).all(|axis| (before[axis][1] - after[axis][1]).abs() < 1e-6), "{time}: {before:?} {after:?}");
        }
        // Halfway through the ramp of its first two points, apart from the tangent of the second.
        assert!((at(0.3)[0][1] - 0.02 / 0.3).abs() < 1e-12);
    }
    let refused = |points: &str| {
        let level = held(BODY, "Left", &format!("Spline(points: [{points}])"), "");
        Scene::build(&level, level.mode, &NoFiles, None).err().unwrap().to_string()
    };
    assert!(refused("").contains("at least one point"));
    let unordered = refused("(0, (0, 0)), (1, (1, 0)), (1, (2, 0))");
    assert!(unordered.contains("after 1 s comes 1 s"), "{unordered}");
    assert!(refused("(0, (0, 0)), (1, (1, 0, 0))").contains("two coordinates"));
    assert!(refused("(0, (0, 0, 0)), (1, (1, 0, 0))").contains("in space"));
}

/// A vertex that is dragged along a path follows it from where it is, with every integrator.
#[test]
fn a_drawn_path_is_followed() {
    let path: Vec<_> = (0..=40).map(|i| f64::from(i) * 0.025).map(|t| (t, [0.05 * t, 0.05 * t * t, 0.0])).collect();
    for kind in IntegratorKind::all() {
        let level = level(&format!(
            "(name: \"\", substeps: 40, {BODY}, effects: [(effect: Gravity(down: 1)), (effect: Rayleigh(mass: 0, stiffness: 0.001))])"
        ));
        let mut sandbox = running(Level { integrator: kind.clone(), ..level });
        // The body falls, so that the vertex is no longer where it began; each time another path takes the place of the one before.
        for drawn in 1..=3 {
            sandbox.advance(400, &mut || true);
            let place = |sandbox: &Sandbox| [0, 1].map(|axis| sandbox.simulation().state().x[axis]);
            let (from, began) = (place(&sandbox), sandbox.simulation().state().time);
            sandbox.apply(Command::MoveAlong(0, path.clone())).unwrap();
            let now = place(&sandbox);
            assert!((now[0] - from[0]).abs() + (now[1] - from[1]).abs() < 1e-12, "{}: {from:?} {now:?}", kind.name());
            assert_eq!(sandbox.document().level.effects.len(), 3, "{}", kind.name());
            sandbox.advance(1200, &mut || true);
            assert!(sandbox.simulation().fault().is_none(), "{}: {:?}", kind.name(), sandbox.simulation().fault());
            let (to, t) = (place(&sandbox), sandbox.simulation().state().time - began);
            let gap = (to[0] - from[0] - 0.05 * t).hypot(to[1] - from[1] - 0.05 * t * t);
            assert!(t > 0.4 && t < 0.6 && gap < 1e-3, "{} {drawn}: {gap} m at {t} s", kind.name());
        }
        for effects in [3, 3, 2] {
            sandbox.apply(Command::Undo).unwrap();
            assert_eq!(sandbox.document().level.effects.len(), effects);
        }
    }
}

/// A pinned vertex takes all pins of its part along. What cannot be followed is refused, and nothing changes.
#[test]
fn pins_follow_a_drawn_path_together() {
    let path: Vec<_> = (0..=20).map(|i| 0.05 * f64::from(i)).map(|t| (t, [0.0, 0.1 * t, 0.0])).collect();
    for parts in ALL {
        let pinned = parts.replace("(name: \"it\",", "(name: \"it\", pins: [Left],");
        let mut sandbox = running(level(&format!("(name: \"\", {pinned})")));
        let pins = sandbox.simulation().scene().pins.to_vec();
        let size = sandbox.simulation().scene().dimension;
        let start = sandbox.simulation().state().x.clone();
        sandbox.apply(Command::MoveAlong(pins[1] as usize, path.clone())).unwrap();
        sandbox.apply(Command::SetRunning(true)).unwrap();
        sandbox.advance(60 * u64::from(sandbox.document().level.substeps.get()) + 5, &mut || true);
        let x = &sandbox.simulation().state().x;
        let moved = |pin: u32| x[size * pin as usize + 1] - start[size * pin as usize + 1];
        assert!(pins.iter().all(|pin| (moved(*pin) - 0.1).abs() < 1e-12), "{pins:?}");
        for refused in [Command::MoveAlong(100_000, path.clone()), Command::MoveAlong(0, path[..1].to_vec())] {
            let before = sandbox.document().clone();
            assert!(sandbox.apply(refused).is_err() && *sandbox.document() == before);
        }
    }
}

//! Facts about lengths that are kept by projection of positions.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a failing test should panic")]

use crate::common::{built_in, continues_bit_for_bit, level, named, simulation};
use gingerbread::{
    integrators::IntegratorKind,
    level::{Level, Sleep},
    meshes::NoFiles,
    scene::{Scene, SceneError},
    simulation::Simulation,
};

fn stepped(level: &Level, step: f64) -> Simulation {
    let mut simulation = simulation(level);
    let scene = Scene { step, sleep: Sleep::Off, ..simulation.scene().clone() };
    simulation.replace_scene(scene);
    simulation
}

fn lowest(simulation: &Simulation) -> f64 {
    simulation.state().x.iter().skip(1).step_by(3).copied().fold(f64::INFINITY, f64::min)
}

/// The cloth of Princeton's COS 426, with its step of 0.018 s: 124.555472 is h² g below 125, and an independent program of the course's
/// rules reaches -243.37595 after 60 steps.
#[test]
fn the_princeton_cloth_falls_as_in_its_course() {
    let mut simulation = stepped(&built_in("princeton_cloth"), 0.018);
    assert_eq!(simulation.scene().nets[0].springs.links().len(), 3898);
    simulation.advance(1, &mut || true);
    assert!((lowest(&simulation) - 124.555_472).abs() < 1e-9, "{}", lowest(&simulation));
    simulation.advance(59, &mut || true);
    assert!(simulation.fault().is_none(), "{:?}", simulation.fault());
    assert_eq!(simulation.counts().guarded, 0);
    assert!((lowest(&simulation) + 243.375_950).abs() < 1e-5, "{}", lowest(&simulation));
}

/// A net of 5 x 5 particles without stiffness, in the plane or in space.
fn net(is_in_space: bool, projection: &str, pins: &str, effects: &str) -> Level {
    let space = if is_in_space { ", space: (turn: (-60, 20, 5))" } else { "" };
    level(&format!(
        "(name: \"\", nets: [(name: \"net\", net: Sheet(width: 0.4, height: 0.4, columns: 4, rows: 4, structural: 0, shear: 0, flexion: 0, corner: (0.3, 0.3)),
        mass: 0.02, pins: [{pins}], velocity: (0.3, 0.1){space})], effects: [(effect: Projection({projection})), {effects}])"
    ))
}

/// Greatest change of length of any spring, as a share of its rest length.
fn strain(simulation: &Simulation) -> f64 {
    let springs = &simulation.scene().nets[0].springs;
    let strain = |link| springs.length(link, &simulation.state().x) / link.rest - 1.0;
    springs.links().iter().map(|link| strain(link).abs()).fold(0.0, f64::max)
}

fn projecting() -> impl Iterator<Item = IntegratorKind> {
    IntegratorKind::all().into_iter().filter(|kind| kind.kind().allows_projection())
}

const PULLED: &str = "(effect: Gravity(down: 9.81)), (effect: Drag(coefficient: 0.01))";

/// With every scheme that takes it, in the plane and in space, hung up or free.
#[test]
fn lengths_are_kept_without_stiffness() {
    assert_eq!(projecting().count(), IntegratorKind::all().len() - 2);
    for kind in projecting() {
        for is_in_space in [false, true] {
            for pins in ["", "Vertex(20), Vertex(24)"] {
                let level = Level { integrator: kind.clone(), ..net(is_in_space, "passes: 100", pins, PULLED) };
                let mut simulation = stepped(&level, 2e-3);
                let start = simulation.state().x.clone();
                simulation.advance(250, &mut || true);
                let name = kind.name();
                assert!(simulation.fault().is_none(), "{name}: {:?}", simulation.fault());
                assert!(strain(&simulation) < 2e-3, "{name} {is_in_space} {pins}: {}", strain(&simulation));
                // In the plane a net that is held at two corners cannot move without a strain.
                let moved = simulation.state().x.iter().zip(&start).map(|(x, start)| (x - start).abs());
                assert!(moved.fold(0.0, f64::max) > 0.05 || !is_in_space && !pins.is_empty(), "{name}");
                for pin in simulation.scene().pins.iter() {
                    let numbers = simulation.scene().numbers(&(*pin as usize..*pin as usize + 1));
                    assert_eq!(simulation.state().x[numbers.clone()], start[numbers], "{name}");
                }
            }
        }
    }
}

/// What no family of springs holds gives way: a net without shear springs is sheared by its weight.
#[test]
fn each_family_can_be_released() {
    let hung = |projection: &str| {
        let pins = "Vertex(20), Vertex(21), Vertex(22), Vertex(23), Vertex(24)";
        let mut level = net(
            false,
            &format!("passes: 100, {projection}"),
            pins,
            "(effect: Gravity(down: -9.81)), (effect: Drag(coefficient: 0.1))",
        );
        level.integrator = named("SymplecticEuler");
        let mut simulation = stepped(&level, 2e-3);
        simulation.advance(500, &mut || true);
        strain(&simulation)
    };
    let held = hung("");
    assert!(held < 2e-3, "{held}");
    for family in ["structural: 0, shear: 0", "structural: 0, flexion: 0", "shear: 0"] {
        let released = hung(family);
        assert!(released > 5.0 * held, "{family}: {released} and {held}");
    }
}

/// Projection has no net force, and none on what has its lengths already.
#[test]
fn projection_keeps_momentum_and_what_is_at_rest() {
    for is_in_space in [false, true] {
        let mut simulation = stepped(&net(is_in_space, "passes: 3", "", ""), 2e-3);
        let dimension = simulation.scene().dimension;
        let mut state = simulation.state().clone();
        let momentum = |v: &[f64]| {
            (0..dimension).map(|axis| v.iter().skip(axis).step_by(dimension).sum::<f64>()).collect::<Vec<_>>()
        };
        let before = momentum(&state.v);
        simulation.advance(10, &mut || true);
        let gone: Vec<f64> = simulation.state().x.iter().zip(&state.x).map(|(x, start)| (x - start) / 0.02).collect();
        for (gone, v) in gone.iter().zip(&state.v) {
            assert!((gone - v).abs() < 1e-12, "a moving net at rest lengths moves on: {gone} {v}");
        }
        // Crumpled.
        for (number, x) in state.x.iter_mut().enumerate() {
            *x += 0.03 * libm::sin(number as f64 * 1.7);
        }
        simulation.set_state(state);
        let crumpled = strain(&simulation);
        simulation.advance(50, &mut || true);
        assert!(simulation.fault().is_none(), "{:?}", simulation.fault());
        assert!(strain(&simulation) < 0.5 * crumpled);
        for (before, after) in before.iter().zip(momentum(&simulation.state().v)) {
            assert!((before - after).abs() < 1e-11, "{before} {after}");
        }
    }
}

/// Energy that projection takes or gives is in the ledger.
#[test]
fn energy_of_projection_is_accounted_for() {
    for scheme in ["SymplecticEuler", "VelocityVerlet", "ImplicitMidpoint"] {
        let level = Level {
            integrator: named(scheme),
            ..net(true, "passes: 20", "Vertex(20), Vertex(24)", "(effect: Gravity(down: 9.81))")
        };
        let mut simulation = stepped(&level, 1e-3);
        let start = simulation.energies().total();
        simulation.advance(500, &mut || true);
        assert!(simulation.fault().is_none(), "{:?}", simulation.fault());
        let drift = simulation.energies().total() + simulation.heat() - simulation.work_of_obstacles() - start;
        // Symplectic Euler falls by g h v/2 more in a step than energy allows.
        let allowed = if scheme == "SymplecticEuler" { 0.02 } else { 1e-10 };
        assert!(drift.abs() < allowed, "{scheme}: {drift} J");
    }
}

#[test]
fn a_projected_run_is_saved_and_continued_bit_for_bit() {
    for kind in projecting() {
        for pins in ["Stay", "PutBack"] {
            let level = net(true, &format!("pins: {pins}"), "Vertex(20), Vertex(24)", PULLED);
            let level = Level { integrator: kind.clone(), ..level };
            continues_bit_for_bit(&level);
        }
    }
}

/// Nothing that is projected is left inside an obstacle with a potential.
#[test]
fn projection_does_not_push_through_obstacles() {
    for kind in projecting() {
        let walls = "(effect: Gravity(down: 9.81)), (effect: Walls(obstacles: [HalfSpace(point: (0, -0.5, 0), normal: (0.1, 1, 0.2), eps: 0.01)]))";
        let level = Level { integrator: kind.clone(), ..net(true, "passes: 10", "", walls) };
        let mut simulation = stepped(&level, 1e-3);
        let mut touches = false;
        for _ in 0..20 {
            simulation.advance(40, &mut || true);
            touches |= !simulation.state().anchors.is_empty() || simulation.energies().contact > 0.0;
            assert_eq!(simulation.count_inside(), 0, "{}", kind.name());
        }
        assert!(simulation.fault().is_none(), "{}: {:?}", kind.name(), simulation.fault());
        assert!(touches, "{}", kind.name());
    }
}

/// Pins that are put back are those of nets: a pinned body beside them stays where it is in every step.
#[test]
fn bodies_stay_pinned_beside_a_net_whose_pins_are_put_back() {
    let text = "(name: \"\", bodies: [(name: \"body\", mesh: Rectangle(width: 0.2, height: 0.2, columns: 2, rows: 2, diagonals: Grid, corner: (0.8, 0.5)),
        material: (model: NeoHookean, young: 1000, poisson: 0.3, plane: Stress), mass: Density(1), pins: [Top])],
        nets: [(name: \"net\", net: Sheet(width: 0.4, height: 0.4, columns: 4, rows: 4, structural: 0, shear: 0, flexion: 0, corner: (0.3, 0.3)), mass: 0.02, pins: [Top])],
        effects: [(effect: Gravity(down: 2)), (effect: Projection(pins: PutBack))])";
    let run = simulation(&level(text));
    let scene = run.scene();
    for pin in scene.pins.iter().map(|pin| *pin as usize) {
        let is_free = scene.inverse_mass[2 * pin] > 0.0;
        assert_eq!(is_free, scene.nets[0].vertices.contains(&pin), "{pin}");
    }
}

/// With a separation no two particles end nearer to each other, as long as nothing else presses them together; momentum stays.
#[test]
fn particles_keep_apart() {
    for kind in projecting() {
        for is_in_space in [false, true] {
            // Two rows of particles that are not tied to each other, thrown at each other.
            let space = if is_in_space { ", space: ()" } else { "" };
            let row = |name: &str, y: f64, speed: f64| {
                format!(
                    "(name: \"{name}\", net: Chain(from: (0, {y}), to: (0.4, {y}), springs: 4, stiffness: 0, rest: 0.1), mass: 0.02, velocity: (0, {speed}){space})"
                )
            };
            let text = format!(
                "(name: \"\", nets: [{}, {}], effects: [(effect: Projection(structural: 0, separation: 0.05))])",
                row("upper", 0.5, -1.0),
                row("lower", 0.3, 0.5)
            );
            let level = Level { integrator: kind.clone(), ..level(&text) };
            let mut run = stepped(&level, 1e-2);
            let dimension = run.scene().dimension;
            for _ in 0..40 {
                run.advance(1, &mut || true);
                let x: Vec<&[f64]> = run.state().x.chunks(dimension).collect();
                for (number, one) in x.iter().enumerate() {
                    for other in &x[number + 1..] {
                        let square: f64 = one.iter().zip(*other).map(|(a, b)| (a - b) * (a - b)).sum();
                        assert!(square.sqrt() > 0.05 - 1e-12, "{}: {}", kind.name(), square.sqrt());
                    }
                }
            }
            assert!(run.fault().is_none(), "{}: {:?}", kind.name(), run.fault());
            let momentum: f64 = run.state().v.iter().skip(1).step_by(dimension).sum();
            assert!((momentum + 2.5).abs() < 1e-9, "{}: {momentum}", kind.name());
            // They met: without the separation the upper row would have fallen by 0.4 m.
            assert!(run.state().x[1] > 0.25, "{}: {}", kind.name(), run.state().x[1]);
        }
    }
}

#[test]
fn what_cannot_be_projected_says_why() {
    for scheme in ["Bdf2", "DormandPrince"] {
        let level = Level { integrator: named(scheme), ..net(true, "", "", "") };
        let error = Scene::build(&level, level.mode, &NoFiles, None).err().unwrap();
        assert!(matches!(error, SceneError::Projection(_)), "{error}");
        assert!(error.to_string().contains("such as Symplectic Euler"), "{error}");
    }
    let body = "(name: \"body\", mesh: Rectangle(width: 1, height: 1, columns: 1, rows: 1, diagonals: Grid, corner: (0, 0)), material: (model: NeoHookean, young: 1000, poisson: 0.3, plane: Stress), mass: Density(1))";
    let level = level(&format!("(name: \"\", bodies: [{body}], effects: [(effect: Projection())])"));
    let error = Scene::build(&level, level.mode, &NoFiles, None).err().unwrap().to_string();
    assert!(error.contains("the level has no net"), "{error}");
}

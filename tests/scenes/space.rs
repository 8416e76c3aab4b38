//! Everything that knows no dimension works in space too: a block of springs in three dimensions, made in code.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{
    named,
    physics::Physics,
    systems::{advance, assert_order, without_control},
};
use gingerbread::{
    effects::{Drag, EffectKind, EffectParameters as _, Gravity},
    elements::{Elements, Springs},
    integrators::{IntegratorKind, Workspace},
    level::Sleep,
    nets::{Link, Role},
    quantity::{self, DragCoefficient},
    scene::Scene,
    simulation::Simulation,
    solvers::LinearSolver,
    stability::{StabilityProbe, critical_step},
    state::State,
};
use nalgebra::DMatrix;
use std::sync::Arc;

/// Particles along each edge of the block, and their distance [m].
const SIDES: [u32; 3] = [4, 3, 3];
const DISTANCE: f64 = 0.2;

/// Mass of a particle [kg] and stiffness of a spring [N/m].
const MASS: f64 = 0.1;
const STIFFNESS: f64 = 40.0;

/// A block of particles in space, each tied to all its neighbours in a cube.
fn block() -> Scene {
    let cells = || {
        let [across, up, back] = SIDES;
        (0..back).flat_map(move |k| (0..up).flat_map(move |j| (0..across).map(move |i| [i, j, k])))
    };
    let rest: Vec<f64> = cells().flatten().map(|place| DISTANCE * f64::from(place)).collect();
    let number = |[i, j, k]: [u32; 3]| i + SIDES[0] * (j + SIDES[1] * k);
    let mut links = Vec::new();
    for (first, a) in cells().enumerate() {
        for (second, b) in cells().enumerate().skip(first + 1) {
            assert_eq!(number(a) as usize, first);
            let square: u32 = (0..3).map(|axis| a[axis].abs_diff(b[axis]).pow(2)).sum();
            if (0..3).all(|axis| a[axis].abs_diff(b[axis]) <= 1) {
                let rest = DISTANCE * f64::from(square).sqrt();
                let ends = [first as u32, second as u32];
                links.push(Link { ends, stiffness: STIFFNESS, rest, role: Role::Structural });
            }
        }
    }
    let count = rest.len() / 3;
    let springs = Springs::<3>::of_links(links, 0..count);
    Scene::of_elements(3, rest, &vec![MASS; count], vec![Arc::new(springs)]).unwrap()
}

/// A smooth start out of the rest shape, with the velocities of a spin, a stretch and a bend.
fn moving(scene: &Scene) -> State {
    let mut state = scene.start.clone();
    for (point, v) in state.x.as_chunks_mut::<3>().0.iter_mut().zip(state.v.as_chunks_mut::<3>().0) {
        let [x, y, z] = *point;
        *point = [x + 0.1 * x * y, y - 0.1 * z, z + 0.15 * x * x];
        *v = [0.4 * y - 0.2 * z, 0.3 * z * x - 0.4 * x, 0.2 * x - 0.5 * y * z];
    }
    state
}

fn run(kind: &IntegratorKind, step: f64) -> Simulation {
    let mut scene = block();
    scene.pin(&[0]);
    (scene.integrator, scene.step) = (kind.clone(), step);
    let mut state = moving(&scene);
    state.v[..3].fill(0.0);
    Simulation::new(scene, state)
}

/// Against Dormand-Prince in far shorter steps.
#[test]
fn measured_order_matches_in_space() {
    let time = 0.1;
    let end = |kind: &IntegratorKind, steps: u64| {
        let mut simulation = run(kind, time / steps as f64);
        advance(&mut simulation, steps);
        simulation.state().x.clone()
    };
    let exact = end(&without_control(named("DormandPrince")), 2000);
    for kind in IntegratorKind::all().into_iter().map(without_control) {
        let first = [0, 200, 50, 50, 15, 10][kind.kind().order() as usize];
        assert_order(&kind, "block in space,", |refine| {
            let difference = end(&kind, first * refine).into_iter().zip(&exact).map(|(a, b)| (a - b) * (a - b));
            difference.sum::<f64>().sqrt()
        });
    }
}

/// Three steps of each implicit scheme.
#[test]
fn both_linear_solvers_solve_steps_in_space() {
    let mut scene = block();
    scene.pin(&[0, 5]);
    let start = moving(&scene);
    for name in ["LinearlyImplicitEuler", "ImplicitEuler", "ImplicitMidpoint", "EnergyMomentum", "Bdf2"] {
        let [direct, iterative] = [LinearSolver::Direct, LinearSolver::Iterative].map(|solver| {
            let (mut state, mut workspace) = (start.clone(), Workspace::new(solver));
            let mut iterations = 0;
            for _ in 0..3 {
                let counts = named(name).kind().step(&mut Physics::new(&scene), &mut state, &mut workspace, 0.02);
                assert_eq!((counts.newton.unconverged, counts.newton.abandoned), (0, 0), "{name}");
                iterations += counts.newton.linear_iterations;
            }
            assert_eq!(iterations > 0, solver == LinearSolver::Iterative, "{name}");
            state.x
        });
        let apart = direct.iter().zip(&iterative).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        assert!(apart < 1e-6, "{name}: {apart}");
    }
}

/// Against the greatest eigenvalue of the dense matrix, and against steps on both sides of the limit.
#[test]
fn stability_limit_holds_in_space() {
    let mut scene = block();
    scene.pin(&[0]);
    (scene.guard, scene.sleep) = (false, Sleep::Off);
    let count = scene.rest.len();
    let column = |number: usize| {
        let mut d = vec![0.0; count];
        d[number] = scene.inverse_mass[number].sqrt();
        let mut product = vec![0.0; count];
        for effect in &scene.effects {
            effect.stiffness_times(scene.motion(&scene.start, None), &d, &mut [], &mut product);
        }
        product.iter().zip(&scene.inverse_mass).map(|(value, w)| value * w.sqrt()).collect::<Vec<_>>()
    };
    let entries: Vec<f64> = (0..count).flat_map(column).collect();
    let greatest = DMatrix::from_vec(count, count, entries).symmetric_eigenvalues().max();
    let limit = critical_step(&scene, &scene.start, None).unwrap();
    assert!((limit * greatest.sqrt() / 2.0 - 1.0).abs() < 1e-3, "{limit} s");
    let mut probe = StabilityProbe::default();
    let refined = (0..4).map(|_| probe.refine(&scene, &scene.start, None, 16)).last().flatten().unwrap();
    assert!((refined / limit - 1.0).abs() < 1e-3);
    for (share, is_stable) in [(0.95, true), (1.05, false)] {
        let mut scene = scene.clone();
        scene.step = share * limit;
        let mut start = scene.start.clone();
        start.v.iter_mut().zip(&scene.inverse_mass).enumerate().for_each(|(number, (v, w))| {
            *v = if *w == 0.0 { 0.0 } else { 1e-6 * f64::from(number as u32 % 7) };
        });
        let mut simulation = Simulation::new(scene, start);
        simulation.advance(2000, &mut || true);
        let energies = simulation.energies();
        assert_eq!(energies.total() < 1e-8, is_stable, "{share} of the limit: {energies:?}");
    }
}

#[test]
fn guard_divides_unstable_steps_in_space() {
    let mut scene = block();
    scene.step = 1.3 * critical_step(&scene, &scene.start, None).unwrap();
    let start = moving(&scene);
    let mut simulation = Simulation::new(scene, start);
    let before = simulation.energies().total();
    simulation.advance(500, &mut || true);
    assert!(simulation.fault().is_none() && simulation.counts().guarded > 0, "{:?}", simulation.fault());
    // The guard acts once energy has doubled, and allows 1.5 times the available energy from nowhere.
    assert!(simulation.energies().total() < 2.5 * before);
}

/// It hangs under gravity. At rest the springs of the pins carry its weight.
#[test]
fn block_in_space_falls_asleep_and_wakes() {
    let mut scene = block();
    scene.pin(&[24, 25, 26, 27]);
    let nothing = Elements::default();
    let gravity = Gravity { down: quantity::Gravity::new(2.0).unwrap(), ..Gravity::default() };
    scene.add_effect(gravity.build(&nothing).unwrap().into()).unwrap();
    scene.add_effect(Drag { coefficient: DragCoefficient::new(0.4).unwrap() }.build(&nothing).unwrap().into()).unwrap();
    scene.step = 0.002;
    let start = scene.start.clone();
    let mut simulation = Simulation::new(scene.clone(), start);
    while !simulation.is_asleep() && simulation.state().time < 60.0 {
        simulation.advance(10, &mut || true);
    }
    assert!(simulation.is_asleep());
    let rest = simulation.state().x.clone();
    let evaluations = simulation.counts().force_evaluations;
    simulation.advance(100, &mut || true);
    assert_eq!((&simulation.state().x, simulation.counts().force_evaluations), (&rest, evaluations));
    let mut force = vec![0.0; rest.len()];
    for effect in &scene.effects {
        effect.force(scene.motion(simulation.state(), None), &mut [], &mut force);
    }
    let held: f64 = scene.pins.iter().map(|pin| force[3 * *pin as usize + 1]).sum();
    let weight = 2.0 * MASS * f64::from(SIDES.iter().product::<u32>());
    assert!((held / -weight - 1.0).abs() < 1e-2, "{held} N of {weight} N");
    simulation.replace_scene(Scene { effects: scene.effects[..1].to_vec(), auto: vec![true], ..scene });
    simulation.advance(20, &mut || true);
    assert!(!simulation.is_asleep() && simulation.state().x != rest);
}

/// Every effect acts, or says in words why not.
#[test]
fn effects_of_the_plane_are_refused_in_space() {
    let mut scene = block();
    let (mut refused, mut nothing) = (Vec::new(), Vec::new());
    for kind in EffectKind::all() {
        match kind.kind().build(&Elements::default()) {
            Ok(effect) => {
                if let Err(error) = scene.add_effect(effect.into()) {
                    assert!(error.to_string().contains("2 coordinates"), "{error}");
                    refused.push(kind.name());
                }
            }
            // These say that there is nothing that they act on.
            Err(why) => {
                let words = ["has no", "has none", "names no vertex", "names no edge"];
                assert!(words.iter().any(|words| why.contains(words)), "{}: {why}", kind.name());
                nothing.push(kind.name());
            }
        }
    }
    assert_eq!(refused, ["Boundary", "Walls", "Contact"]);
    let known = [
        "EdgeLoad",
        "Compression",
        "Projection",
        "Wind",
        "Vortex",
        "Rain",
        "Bending",
        "MovingPins",
        "Rods",
        "Wire",
        "AbsoluteDamping",
    ];
    assert_eq!(nothing, known);
    let start = moving(&scene);
    let mut simulation = Simulation::new(scene, start);
    assert_eq!(simulation.advance(20, &mut || true), 20, "{:?}", simulation.fault());
    assert!(Scene::of_elements(3, vec![0.0; 7], &[1.0; 2], Vec::new()).is_err());
}

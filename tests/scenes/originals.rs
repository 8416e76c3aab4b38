//! Facts that the texts and programs of the courses state about their cloths.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a failing test should panic")]

use crate::common::{built_in, level, named, simulation};
use gingerbread::{
    level::{Level, Sleep, SpacePlace, Toggle},
    nets::Role,
    scene::Scene,
    simulation::Simulation,
    stability::critical_step,
};

/// A run without the guard, in steps of this length.
fn plain(level: &Level, scheme: &str, step: f64) -> Simulation {
    let mut simulation = simulation(&Level { integrator: named(scheme), guard: Toggle::Off, ..level.clone() });
    let scene = Scene { step, sleep: Sleep::Off, ..simulation.scene().clone() };
    simulation.replace_scene(scene);
    simulation
}

/// Greatest speed of a vertex after some time; infinite after a fault.
fn speed_after(level: &Level, scheme: &str, step: f64, seconds: f64) -> f64 {
    let mut run = plain(level, scheme, step);
    run.advance((seconds / step).round() as u64, &mut || true);
    if run.fault().is_some() {
        return f64::INFINITY;
    }
    run.state().v.chunks(3).map(|v| v.iter().map(|v| v * v).sum::<f64>().sqrt()).fold(0.0, f64::max)
}

/// MIT's cloth hangs for 10 s: forward Euler fails from 0.2 ms on, the trapezoid rule comes to rest at 1 ms and fails at 2 ms, Runge-Kutta
/// 4 comes to rest at 5 ms.
#[test]
fn the_mit_cloth_tells_the_schemes_apart() {
    let mut level = built_in("mit_cloth");
    // It hangs down from the start on; the level lets it swing.
    level.nets[0].space = Some(SpacePlace::default());
    assert!(speed_after(&level, "ForwardEuler", 2e-4, 10.0) > 10.0);
    assert!(speed_after(&level, "Heun", 1e-3, 10.0) < 0.02);
    assert!(speed_after(&level, "Heun", 2e-3, 10.0) > 10.0);
    assert!(speed_after(&level, "RungeKutta4", 5e-3, 10.0) < 0.02);
}

/// Cornell's cloth with all its 128 x 128 particles: the longest stable step of symplectic Euler is 0.251 ms without damping, 0.170 ms with dampers
/// between the ends of springs, and 0.199 ms with the damping of the text, by the velocity of each end alone. The gauge says so, and so do runs.
#[test]
fn the_cornell_cloth_has_the_steps_of_its_text() {
    let damped = |effects: &str| {
        level(&format!(
            "(name: \"\", nets: [(name: \"cloth\", net: Sheet(width: 1, height: 1, columns: 127, rows: 127, structural: 384, shear: 384, flexion: 384,
            corner: (0, 0)), mass: 0.00006103515625, velocity: (0.001, 0.001), pins: [Vertex(0)], space: (turn: (-90, 0, 0)))], effects: [{effects}])"
        ))
    };
    for (effects, known) in [
        ("", 0.251e-3),
        ("(effect: Rayleigh(mass: 0, stiffness: 0.0001))", 0.170e-3),
        ("(effect: AbsoluteDamping(stiffness: 0.0001))", 0.199e-3),
    ] {
        let level = damped(effects);
        let rest = simulation(&level);
        let limit = critical_step(rest.scene(), &rest.scene().start, None).unwrap();
        assert!((limit / known - 1.0).abs() < 0.02, "{effects}: {limit} s");
        // In the plane of the cloth, where springs are stiff. Just below the limit the energy of symplectic Euler oscillates by a factor of 25.
        let energy = |step: f64| {
            let mut run = plain(&level, "SymplecticEuler", step);
            let mut state = run.state().clone();
            for (number, v) in state.v.iter_mut().enumerate().filter(|(number, _)| number % 3 != 1) {
                *v = 1e-3 * libm::sin(number as f64 * number as f64);
            }
            run.set_state(state);
            let start = run.energies().total();
            run.advance(600, &mut || true);
            if run.fault().is_some() { f64::INFINITY } else { run.energies().total() / start }
        };
        let [below, above] = [energy(0.98 * known), energy(1.02 * known)];
        assert!(below < 30.0 && above > 1e4, "{effects}: {below} {above}");
    }
}

/// Greatest strain of the structural springs of Princeton's cloth after 10 s: with its rule pinned particles stretch the springs next to them for
/// ever, and n substeps keep the lengths as n² passes do.
#[test]
fn the_princeton_cloth_is_as_long_as_its_passes_make_it() {
    let strain = |pins: &str, passes: u32, substeps: u32| {
        let text = gingerbread::levels::built_in("princeton_cloth").unwrap();
        let text = text.replace("Projection(pins: PutBack)", &format!("Projection(pins: {pins}, passes: {passes})"));
        let mut run = simulation(&level(&text.replace("substeps: 1,", &format!("substeps: {substeps},"))));
        run.advance(600 * u64::from(substeps), &mut || true);
        assert!(run.fault().is_none(), "{:?}", run.fault());
        let springs = &run.scene().nets[0].springs;
        let structural = springs.links().iter().filter(|link| link.role == Role::Structural);
        structural.map(|link| springs.length(link, &run.state().x) / link.rest - 1.0).fold(0.0, f64::max)
    };
    for (pins, passes, substeps, percent) in [
        ("PutBack", 1, 1, 406.0),
        ("PutBack", 64, 1, 400.0),
        ("Stay", 1, 1, 103.0),
        ("Stay", 4, 1, 36.0),
        ("Stay", 64, 1, 5.3),
        ("Stay", 1, 2, 36.0),
        ("Stay", 1, 8, 5.3),
    ] {
        let found = 100.0 * strain(pins, passes, substeps);
        assert!((found / percent - 1.0).abs() < 0.02, "{pins} {passes} {substeps}: {found} %");
    }
}

/// A heavy strip without bending stiffness hangs as a catenary: of 1 m between points 0.8 m apart.
#[test]
fn a_hanging_strip_is_a_catenary() {
    let level = level(
        "(name: \"\", integrator: ImplicitEuler(), membranes: [(name: \"strip\", mesh: Rectangle(width: 1, height: 0.05, columns: 60, rows: 2, diagonals: Alternating, corner: (0, 0)),
        material: (model: StVenantKirchhoff, young: 1000000, poisson: 0, plane: Stress), thickness: 0.001, mass: Density(100), pins: [Left, Right],
        stretch: (0.8, 1), space: (turn: (90, 0, 0)))],
        effects: [(effect: Gravity(down: 9.81)), (effect: Rayleigh(mass: 2))])",
    );
    let mut run = plain(&level, "ImplicitEuler", 0.02);
    run.advance(1000, &mut || true);
    assert!(run.fault().is_none(), "{:?}", run.fault());
    let speed = run.state().v.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    assert!(speed < 1e-3, "{speed} m/s");
    let [highest, lowest] = [f64::max, f64::min]
        .map(|pick: fn(f64, f64) -> f64| run.state().x.iter().skip(1).step_by(3).copied().reduce(pick).unwrap());
    // 2 a sinh(d/2a) = L.
    let (mut low, mut high) = (0.1, 10.0);
    for _ in 0..100 {
        let a: f64 = 0.5 * (low + high);
        if 2.0 * a * libm::sinh(0.4 / a) > 1.0 { low = a } else { high = a }
    }
    let sag = low * (libm::cosh(0.4 / low) - 1.0);
    assert!(((highest - lowest) / sag - 1.0).abs() < 0.01, "{} m for {sag} m", highest - lowest);
}

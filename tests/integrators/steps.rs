//! Exact facts about taking steps.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{Random, level, models, reopened, sheet, simulation, systems::built};
use gingerbread::{
    effects::Grab,
    fault::Cause,
    files,
    level::Level,
    levels,
    simulation::Simulation,
    stability::{StabilityProbe, critical_step},
};

/// The body deformed at random and moving at random.
fn shake(simulation: &mut Simulation, seed: u64) {
    let mut random = Random(seed);
    let mut state = simulation.state().clone();
    let free = simulation.scene().inverse_mass.clone();
    for ((x, v), free) in state.x.iter_mut().zip(&mut state.v).zip(free).filter(|(_, free)| *free > 0.0) {
        *x += random.between(-0.01, 0.01) * f64::from(u8::from(free > 0.0));
        *v = random.between(-0.5, 0.5);
    }
    simulation.set_state(state);
}

fn run(simulation: &mut Simulation, steps: u64) {
    assert_eq!(simulation.advance(steps, &mut || true), steps, "{:?}", simulation.fault());
}

/// `v_n = -n g h` and `x_n - x_0 = -g h² (1 + 2 + .. + n)`.
#[test]
fn free_fall_matches_the_discrete_formula() {
    let mut simulation = simulation(&sheet("NeoHookean", "", "effects: [(effect: Gravity(down: 9.8))]"));
    let (start, h) = (simulation.state().x.clone(), simulation.scene().step);
    for n in 1..=1000_u32 {
        run(&mut simulation, 1);
        let fallen = 9.8 * h * h * f64::from(n) * f64::from(n + 1) / 2.0;
        for (now, start) in simulation.state().x.chunks_exact(2).zip(start.chunks_exact(2)) {
            assert!((now[0] - start[0]).abs() < 1e-13 && (now[1] - start[1] + fallen).abs() < 1e-13);
        }
    }
}

#[test]
fn a_free_body_keeps_its_momentum_and_its_angular_momentum() {
    for model in models() {
        let mut simulation = simulation(&sheet(model, "", ""));
        shake(&mut simulation, 1);
        let momenta = |simulation: &Simulation| {
            let (state, mass) = (simulation.state(), &simulation.scene().mass);
            let points = state.x.chunks_exact(2).zip(state.v.chunks_exact(2)).zip(mass.chunks_exact(2));
            points.fold([0.0; 3], |[px, py, l], ((x, v), m)| {
                [px + m[0] * v[0], py + m[0] * v[1], l + m[0] * (x[0] * v[1] - x[1] * v[0])]
            })
        };
        let before = momenta(&simulation);
        run(&mut simulation, 6000);
        for (before, after) in before.iter().zip(momenta(&simulation)) {
            assert!((before - after).abs() < 1e-12, "{model}: {:e}", before - after);
        }
    }
}

#[test]
fn energy_swings_but_does_not_drift() {
    for model in models() {
        let mut simulation = simulation(&sheet(model, "stretch: (1.1, 1)", ""));
        let start = simulation.energies().total();
        for _ in 0..20 {
            run(&mut simulation, 500);
            let now = simulation.energies().total();
            assert!((now - start).abs() < 0.02 * start, "{model}: {now} J from {start} J");
        }
    }
}

#[test]
fn pinned_vertices_keep_every_bit() {
    let effects = "effects: [(effect: Gravity(down: 9.8)), (effect: Rayleigh(mass: 1, stiffness: 0.001)), (effect: Boundary(least: (0.4, 0.4), greatest: (0.6, 0.6)))]";
    let mut simulation = simulation(&sheet("Corotated", "pins: [Top, Nearest(0.3, 0.3)], velocity: (1, 2)", effects));
    let pins = simulation.scene().pins.to_vec();
    assert_eq!(pins.len(), 6);
    let start = simulation.state().clone();
    run(&mut simulation, 3000);
    for pin in pins.iter().flat_map(|pin| [2 * *pin as usize, 2 * *pin as usize + 1]) {
        assert_eq!(simulation.state().x[pin].to_bits(), start.x[pin].to_bits());
        assert_eq!(simulation.state().v[pin], 0.0);
    }
    assert_ne!(simulation.state().x, start.x, "the rest of the body moves");
}

fn falling(model: &str) -> Level {
    sheet(
        model,
        "spin: 2",
        "effects: [(effect: Gravity(down: 3)), (effect: Rayleigh(mass: 0.5, stiffness: 0.001)), (effect: Boundary(least: (0, 0.2), greatest: (1, 1)))]",
    )
}

#[test]
fn steps_are_reproducible_however_they_are_bunched() {
    for model in models() {
        let mut once = simulation(&falling(model));
        run(&mut once, 1000);
        let mut again = simulation(&falling(model));
        for bunch in [1, 7, 100, 892] {
            run(&mut again, bunch);
        }
        assert_eq!(once.state(), again.state());
    }
}

#[test]
fn saving_and_resuming_is_exact() {
    for model in models() {
        let mut straight = simulation(&falling(model));
        run(&mut straight, 1000);
        let mut first = simulation(&falling(model));
        run(&mut first, 437);
        let mut second = reopened(&first, &falling(model));
        assert_eq!(second.scene().rest, first.scene().rest, "saving must not touch the rest shape");
        run(&mut second, 563);
        assert_eq!(second.state(), straight.state());
    }
}

/// Near rest, where the limit is 2/w of the linearised scene, on every model and with damping.
#[test]
fn steps_are_stable_just_below_the_limit_and_not_above() {
    for model in models() {
        for effects in ["", "effects: [(effect: Rayleigh(mass: 2, stiffness: 0.01))]"] {
            let growth = |share: f64, steps: u64| {
                let mut simulation = simulation(&sheet(model, "", &format!("guard: Off, {effects}")));
                let limit = critical_step(simulation.scene(), simulation.state(), None).unwrap();
                let mut level = sheet(model, "", &format!("guard: Off, {effects}"));
                level.substeps = gingerbread::level::Substeps::new(1).unwrap();
                simulation = built(&level, share * limit);
                let mut random = Random(5);
                let mut state = simulation.state().clone();
                state.v.iter_mut().for_each(|v| *v = random.between(-1e-7, 1e-7));
                simulation.set_state(state);
                let before = simulation.energies().total();
                simulation.advance(steps, &mut || true);
                if simulation.fault().is_some() { f64::INFINITY } else { simulation.energies().total() / before }
            };
            assert!(growth(0.97, 4000) < 100.0, "{model} {effects}: {:e}", growth(0.97, 4000));
            assert!(growth(1.05, 200) > 1e6, "{model} {effects}: {:e}", growth(1.05, 200));
        }
    }
}

/// A probe that looks a few rounds at a time ends where the converged answer is, from above.
#[test]
fn a_probe_amortised_over_frames_finds_the_stability_limit() {
    for model in models() {
        let mut simulation = simulation(&sheet(model, "stretch: (1.05, 1)", ""));
        let mut probe = StabilityProbe::default();
        for _ in 0..40 {
            run(&mut simulation, 10);
            probe.refine(simulation.scene(), simulation.state(), None, 3).unwrap();
        }
        let seen = probe.refine(simulation.scene(), simulation.state(), None, 3).unwrap();
        let limit = critical_step(simulation.scene(), simulation.state(), None).unwrap();
        assert!((seen / limit - 1.0).abs() < 0.02, "{model}: {seen} against {limit}");
    }
}

/// A mouse spring much stiffer than the material: the limit is 2/w with w^2 = k/m of the pulled vertex, whose neighbours
/// add less than 1 %.
#[test]
fn a_stiff_pull_lowers_the_stability_limit() {
    let stiffness = 1e9;
    for model in models() {
        let run = simulation(&sheet(model, "", &format!("effects: [(effect: MouseSpring(stiffness: {stiffness:e}))]")));
        let (scene, state) = (run.scene(), run.state());
        let vertex = 7;
        let grab = Some(Grab { vertex, target: [0.0, 0.0, 0.0] });
        let closed_form = 2.0 * (scene.mass[2 * vertex] / stiffness).sqrt();
        let limit = critical_step(scene, state, grab).unwrap();
        assert!((limit / closed_form - 1.0).abs() < 0.01, "{model}: {limit} against {closed_form}");
        assert!(critical_step(scene, state, None).unwrap() > 10.0 * limit, "{model}");
        let probed = StabilityProbe::default().refine(scene, state, grab, 16).unwrap();
        assert!((probed / limit - 1.0).abs() < 0.01, "{model}: {probed} against {limit}");
        // A fault names that limit.
        let text = format!("guard: Off, effects: [(effect: MouseSpring(stiffness: {stiffness:e}))]");
        let mut run = simulation(&sheet(model, "", &text));
        run.set_grab(grab);
        run.advance(1000, &mut || true);
        let cause = &run.fault().unwrap().cause;
        let named = matches!(cause, Cause::StepTooLong { limit, .. } if (limit / closed_form - 1.0).abs() < 0.01);
        assert!(named, "{model}: {cause:?} against {closed_form}");
    }
}

/// The fault says why.
#[test]
fn a_blow_up_stops_on_the_last_finite_state() {
    let text = "substeps: 1, guard: Off";
    for model in models() {
        let mut simulation = simulation(&sheet(model, "stretch: (1.3, 1)", text));
        let taken = simulation.advance(1_000_000, &mut || true);
        let fault = simulation.fault().unwrap().to_string();
        assert!(simulation.state().is_finite() && simulation.energies().kinetic.is_finite());
        assert_eq!(simulation.state().steps, taken);
        assert!(fault.contains("above the stability limit") && fault.contains("Triangle"), "{fault}");
        assert!(fault.contains(&format!("before step {}", taken + 1)), "{fault}");
        assert_eq!(simulation.advance(10, &mut || true), 0, "a fault stays until the state is set anew");
        let start = simulation.scene().start.clone();
        simulation.set_state(start);
        assert!(simulation.fault().is_none());
    }
}

#[test]
fn mass_is_spread_as_the_level_says() {
    let total = simulation(&level(
        "(name: \"\", bodies: [(name: \"\", mesh: Disk(radius: 0.2, rings: 5), material: (model: Corotated, young: 1, poisson: 0), mass: Total(25))])",
    ));
    let masses: Vec<f64> = total.scene().mass.iter().step_by(2).copied().collect();
    assert!(masses.iter().all(|mass| *mass == masses[0]));
    assert!((masses.iter().sum::<f64>() - 25.0).abs() < 1e-12);
    let dense = simulation(&sheet("Corotated", "", ""));
    let masses: Vec<f64> = dense.scene().mass.iter().step_by(2).copied().collect();
    assert!((masses.iter().sum::<f64>() - 0.16).abs() < 1e-15, "area times density");
    assert!(masses.iter().any(|mass| *mass != masses[0]), "a corner carries less than the middle");
}

/// Timed, each effect runs by itself over all vertices; untimed, the vertices are moved while the elements are swept over.
#[test]
fn fused_and_separate_steps_have_the_same_bits() {
    let alone = ["effects: []", "effects: [(effect: Gravity(down: 3, right: 1))]"];
    let more = [
        "effects: [(effect: Gravity(down: 3)), (effect: Gravity(down: 2))]",
        "effects: [(effect: Gravity(down: 3)), (effect: Rayleigh(mass: 0.5, stiffness: 0.0001))]",
        "effects: [(effect: Rayleigh(mass: 0.5, stiffness: 0)), (effect: Drag(coefficient: 0.01))]",
        "effects: [(effect: Gravity(down: 3)), (effect: Rayleigh(mass: 0.5, stiffness: 0.0001)), (effect: Drag(coefficient: 0.01))]",
        "effects: [(effect: Drag(coefficient: 0.01)), (effect: Rayleigh(mass: 0, stiffness: 0.0001)), (effect: Gravity(down: 3))]",
        "effects: [(effect: Rayleigh(mass: 0.5, stiffness: 0.0001)), (effect: Rayleigh(mass: 0, stiffness: 0.0002))]",
        "effects: [(effect: Gravity(down: 3)), (effect: Boundary(least: (-1, -0.2), greatest: (2, 2)))]",
    ];
    let mut levels: Vec<(Level, bool)> = Vec::new();
    for model in models() {
        levels.extend(alone.iter().chain(&more).map(|effects| (sheet(model, "pins: [Top],", effects), true)));
    }
    levels.extend(levels::BUILT_IN.iter().map(|(file, text)| (files::parse(text, file).unwrap(), false)));
    for (level, shaken) in levels.into_iter().filter(|(level, _)| level.toy.is_none()) {
        let [mut one, mut other] = [&level; 2].map(simulation);
        other.set_measured(true);
        if shaken {
            shake(&mut one, 3);
            shake(&mut other, 3);
        }
        for _ in 0..4 {
            run(&mut one, 150);
            run(&mut other, 150);
            assert_eq!(one.state().hash(), other.state().hash(), "{level:?}");
        }
        let work = |simulation: &Simulation| {
            let calls = simulation.costs().iter().map(|cost| (cost.name, cost.calls, cost.elements, cost.skipped));
            (simulation.counts(), calls.collect::<Vec<_>>())
        };
        assert_eq!(work(&one), work(&other), "{level:?}");
    }
}

//! Facts about time stepping: growth, order, what is kept, what is remembered. Every registered kind is walked.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a failing test should panic")]

use crate::common::{
    Random, named, sheet,
    systems::{Oscillator, Rate, advance, built, particle, run, swinging, without_control},
};
use gingerbread::{
    effects::Grab,
    files,
    integrators::{Class, IntegratorKind, Ode, Scheme, Workspace},
    level::Level,
    meshes::NoFiles,
    scene::Scene,
    simulation::Simulation,
    state::State,
};

/// `dx/dt = -y, dy/dt = x`.
struct Circle;

impl Ode for Circle {
    fn rate(&mut self, _: f64, x: &[f64], rate: &mut [f64]) {
        rate.copy_from_slice(&[-x[1], x[0]]);
    }
}

/// `w² |x|² + |v|²`, whose root every one-step linear scheme with complex roots multiplies by its growth.
fn size(state: &State, w: f64) -> f64 {
    (state.x.iter().map(|x| w * w * x * x).sum::<f64>() + state.v.iter().map(|v| v * v).sum::<f64>()).sqrt()
}

#[test]
fn an_oscillation_grows_by_the_factor_of_the_scheme() {
    for z in [0.01_f64, 0.3, 1.0, 2.5] {
        let (w, cases) = (
            3.0,
            [
                ("ForwardEuler", (1.0 + z * z).sqrt()),
                ("Heun", (1.0 + z.powi(4) / 4.0).sqrt()),
                ("RungeKutta4", (1.0 - z.powi(6) / 72.0 + z.powi(8) / 576.0).sqrt()),
                ("ImplicitEuler", 1.0 / (1.0 + z * z).sqrt()),
                ("LinearlyImplicitEuler", 1.0 / (1.0 + z * z).sqrt()),
                ("ImplicitMidpoint", 1.0),
                ("EnergyMomentum", 1.0),
            ],
        );
        for (name, growth) in cases {
            let (kind, mut state) = (named(name), particle());
            for _ in 0..20 {
                let before = size(&state, w);
                run(&kind, &mut Oscillator::linear(w), &mut state, z / w, 1);
                assert!(
                    (size(&state, w) / before - growth).abs() < 1e-10,
                    "{name} at {z}: {} not {growth}",
                    size(&state, w) / before
                );
            }
        }
    }
}

/// These are the schemes that need rates alone.
#[test]
fn first_order_schemes_leave_the_circle_as_predicted() {
    let z = 0.1_f64;
    let growth = [
        ("ForwardEuler", (1.0 + z * z).sqrt()),
        ("Heun", (1.0 + z.powi(4) / 4.0).sqrt()),
        ("RungeKutta4", (1.0 - z.powi(6) / 72.0 + z.powi(8) / 576.0).sqrt()),
    ];
    for (name, growth) in growth {
        let (kind, mut work) = (named(name), Workspace::default());
        let Scheme::First(scheme) = kind.kind().scheme() else { panic!("{name} should serve any system") };
        let mut state = State { x: vec![1.0, 0.0], ..State::default() };
        for _ in 0..50 {
            scheme.step(&mut Circle, &mut state, &mut work, z);
        }
        let radius = state.x[0].hypot(state.x[1]);
        assert!((radius / growth.powi(50) - 1.0).abs() < 1e-10, "{name}: {radius}");
    }
}

/// `v²/2 + w² x²/2 - (h w²/2) x v` for velocity first, position with the new velocity.
#[test]
fn symplectic_euler_keeps_its_modified_energy_exactly() {
    let (w, h) = (3.0, 0.2);
    let kept = |state: &State| {
        let points = state.x.iter().zip(&state.v);
        points.map(|(x, v)| 0.5 * (v * v + w * w * x * x) - 0.5 * h * w * w * x * v).sum::<f64>()
    };
    let mut state = particle();
    let before = kept(&state);
    run(&named("SymplecticEuler"), &mut Oscillator::linear(w), &mut state, h, 10_000);
    assert!((kept(&state) / before - 1.0).abs() < 1e-11, "{} of {before}", kept(&state));
}

/// T/T0 = 2 K(sin(theta0/2))/pi from tables. After the period the angle is back and at rest; a period that were wrong by dT
/// would leave it turning at (g/L) sin(theta0) dT.
#[test]
fn dormand_prince_swings_as_long_as_the_elliptic_integral_says() {
    for (degrees, ratio) in [(10, 1.001_907_19), (45, 1.039_973_4), (90, 1.180_340_60), (120, 1.372_880_5)] {
        let text = format!("(name: \"p\", integrator: Heun(), toy: Pendulum(length: 1, gravity: 1, start: {degrees}))");
        let toy = files::parse(&text, "pendulum").unwrap().toy.unwrap();
        let kind = dormand_prince(1e-10);
        let Scheme::First(scheme) = kind.kind().scheme() else { panic!("it needs rates alone") };
        let (mut state, mut work) =
            (State { x: toy.kind().exact(0.0).to_vec(), ..State::default() }, Workspace::default());
        let (start, period) = (state.x[0], 2.0 * std::f64::consts::PI * ratio);
        for _ in 0..40 {
            scheme.step(&mut Rate(&toy), &mut state, &mut work, period / 40.0);
        }
        let wrong = state.x[1] / (libm::sin(start) * period);
        assert!(wrong.abs() < 1e-7 && (state.x[0] - start).abs() < 1e-8, "{degrees}: {wrong:e}");
    }
}

fn dormand_prince(tolerance: f64) -> IntegratorKind {
    let mut kind = named("DormandPrince");
    kind.kind_mut().parameters().into_iter().for_each(|parameter| parameter.set(tolerance).unwrap());
    kind
}

/// This holds over five decades.
#[test]
fn the_error_is_proportional_to_the_tolerance() {
    let system = || Oscillator { square: 4.0, cubic: 0.8, damping: 0.0, evaluations: 0 };
    let mut exact = particle();
    run(&without_control(named("DormandPrince")), &mut system(), &mut exact, 1e-3, 10_000);
    let errors = [1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9].map(|tolerance| {
        let mut state = particle();
        run(&dormand_prince(tolerance), &mut system(), &mut state, 10.0, 1);
        (state.x[0] - exact.x[0]).hypot(state.x[1] - exact.x[1])
    });
    println!("{errors:?}");
    for pair in errors.windows(2) {
        assert!((3.0..30.0).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
    let slope = (errors[0] / errors[5]).log10() / 5.0;
    assert!((slope - 1.0).abs() < 0.15, "{slope}: {errors:?}");
}

#[test]
fn a_stiff_moment_shortens_the_inner_step_and_it_recovers() {
    let (kind, mut work, mut state) = (dormand_prince(1e-6), Workspace::default(), particle());
    let mut inner = |square: f64, state: &mut State| {
        let mut system = Oscillator { square, cubic: 0.0, damping: 0.0, evaluations: 0 };
        (0..10).map(|_| kind.kind().step(&mut system, state, &mut work, 0.2)).last().unwrap()
    };
    let calm = inner(4.0, &mut state);
    let mut work = Workspace::default();
    let mut stiff = Oscillator { square: 4e6, cubic: 0.0, damping: 0.0, evaluations: 0 };
    let moment = kind.kind().step(&mut stiff, &mut state, &mut work, 0.2);
    assert!(moment.rejected >= 1 && moment.inner_steps > 50 * calm.inner_steps, "{calm:?} {moment:?}");
    let again = inner(4.0, &mut state);
    assert!(again.inner_steps <= 4 * calm.inner_steps, "{calm:?} {again:?}");
}

const ACTING: &str = "effects: [(effect: Gravity(down: 3)), (effect: Rayleigh(mass: 0.5, stiffness: 0.001)), (effect: Boundary(least: (0, 0.25), greatest: (1, 1)))]";

#[test]
fn pinned_vertices_keep_every_bit_under_every_integrator() {
    for kind in IntegratorKind::all() {
        let level = Level {
            integrator: kind,
            ..sheet("Corotated", "pins: [Top, Nearest(0.3, 0.3)], velocity: (0.2, 0.4)", ACTING)
        };
        let mut simulation = built(&level, 1e-3);
        let (start, name) = (simulation.state().clone(), level.integrator.name());
        advance(&mut simulation, 300);
        for pin in simulation.scene().pins.iter().flat_map(|pin| [2 * *pin as usize, 2 * *pin as usize + 1]) {
            assert_eq!(simulation.state().x[pin].to_bits(), start.x[pin].to_bits(), "{name}");
            assert_eq!(simulation.state().v[pin], 0.0, "{name}");
        }
        assert_ne!(simulation.state().x, start.x, "{name}: the rest of the body moves");
    }
}

#[test]
fn saving_and_resuming_is_exact_under_every_integrator() {
    for kind in IntegratorKind::all() {
        let level = Level { integrator: kind, ..sheet("NeoHookean", "spin: 2", ACTING) };
        let name = level.integrator.name();
        let from = |level: &Level| {
            let mut scene = Scene::build(level, level.mode, &NoFiles, None).unwrap();
            scene.step = 1e-3;
            Simulation::open(scene, level, level.mode).unwrap()
        };
        let mut straight = from(&level);
        advance(&mut straight, 400);
        let mut first = from(&level);
        for bunch in [1, 7, 129] {
            advance(&mut first, bunch);
        }
        let saved = Level { state: first.saved(), ..level.clone() };
        let mut second = from(&files::parse(&files::write(&saved).unwrap(), "saved.ron").unwrap());
        advance(&mut second, 263);
        assert_eq!(second.state(), straight.state(), "{name}");
    }
}

#[test]
fn a_free_body_keeps_its_momentum_under_every_integrator() {
    for kind in IntegratorKind::all() {
        let mut simulation = swinging(&kind, 2e-4);
        let momentum = |simulation: &Simulation| {
            let (v, mass) = (simulation.state().v.chunks_exact(2), simulation.scene().mass.chunks_exact(2));
            v.zip(mass).fold([0.0; 2], |[x, y], (v, m)| [x + m[0] * v[0], y + m[0] * v[1]])
        };
        let before = momentum(&simulation);
        advance(&mut simulation, 200);
        for (before, after) in before.into_iter().zip(momentum(&simulation)) {
            // Solved to a tolerance, the implicit ones keep it to that; explicit ones to round-off.
            let slack = if kind.kind().class() == Class::Implicit { 1e-9 } else { 1e-13 };
            assert!((before - after).abs() < slack, "{}: {:e}", kind.name(), before - after);
        }
    }
}

/// About the origin, which the body is not at.
#[test]
fn a_free_body_keeps_its_angular_momentum() {
    for name in ["SymplecticEuler", "VelocityVerlet", "PositionVerlet"] {
        let mut simulation = swinging(&named(name), 2e-4);
        let momentum = |simulation: &Simulation| {
            let State { x, v, .. } = simulation.state();
            let points = x.chunks_exact(2).zip(v.chunks_exact(2)).zip(simulation.scene().mass.chunks_exact(2));
            points.map(|((x, v), m)| m[0] * (x[0] * v[1] - x[1] * v[0])).sum::<f64>()
        };
        let before = momentum(&simulation);
        for _ in 0..20 {
            advance(&mut simulation, 50);
            let change = momentum(&simulation) / before - 1.0;
            assert!(change.abs() < 1e-12, "{name}: {change:e} of {before}");
        }
    }
}

/// `v(t) = (x(t + h) - x(t - h))/(2 h)`, and for D = 0 all of velocity Verlet's numbers.
#[test]
fn position_verlet_reports_the_central_difference() {
    let (h, kind, mut work, mut state) = (0.05, named("PositionVerlet"), Workspace::default(), particle());
    let [mut system, mut same] = [(); 2].map(|()| Oscillator { square: 4.0, cubic: 0.8, damping: 0.0, evaluations: 0 });
    let (mut other, mut others) = (particle(), Workspace::default());
    let mut seen = Vec::new();
    for step in 0..50 {
        kind.kind().step(&mut system, &mut state, &mut work, h);
        named("VelocityVerlet").kind().step(&mut same, &mut other, &mut others, h);
        let both = state.x.iter().chain(&state.v).zip(other.x.iter().chain(&other.v));
        for (one, other) in both {
            assert!((one - other).abs() < 1e-13, "step {step}: {one} {other}");
        }
        seen.push(state.clone());
    }
    for three in seen.windows(3) {
        let difference = (three[2].x[0] - three[0].x[0]) / (2.0 * h);
        assert!((three[1].v[0] - difference).abs() < 1e-13, "{} {difference}", three[1].v[0]);
    }
    assert_eq!(system.evaluations, 51, "one force a step, and one to begin with");
}

/// A force that was kept from the step before must not outlive the pull that made it.
#[test]
fn a_pull_that_begins_or_ends_acts_from_the_next_step_on() {
    let effects = "effects: [(effect: MouseSpring(stiffness: 50))]";
    let level = Level { integrator: named("PositionVerlet"), ..sheet("NeoHookean", "", effects) };
    let mut simulation = built(&level, 1e-3);
    advance(&mut simulation, 3);
    let start = simulation.state().clone();
    simulation.set_grab(Some(Grab { vertex: 0, target: [start.x[0] - 0.1, start.x[1], 0.0] }));
    advance(&mut simulation, 1);
    let mass = simulation.scene().mass[0];
    let expected = -50.0 * 0.1 / mass * 1e-6;
    let moved = simulation.state().x[0] - start.x[0];
    assert!((moved / expected - 1.0).abs() < 1e-3, "{moved} not {expected}");
    let before = simulation.state().clone();
    simulation.set_grab(None);
    advance(&mut simulation, 1);
    // What it moved is kept; nothing but the neighbours holds it back.
    let on = (simulation.state().x[0] - before.x[0]) / moved;
    assert!((0.5..=1.0).contains(&on), "{on}");
}

#[test]
fn the_integrator_can_be_changed_during_motion() {
    let reference = {
        let mut simulation = swinging(&named("RungeKutta4"), 2e-4);
        advance(&mut simulation, 500);
        simulation.state().x.clone()
    };
    let mut state = swinging(&IntegratorKind::default(), 2e-4).state().clone();
    let kinds: Vec<_> = IntegratorKind::all().into_iter().chain(IntegratorKind::all()).collect();
    let mut left = 500;
    for (number, kind) in kinds.iter().enumerate() {
        let steps = if number + 1 == kinds.len() { left } else { 500 / kinds.len() as u64 };
        left -= steps;
        let mut simulation = swinging(kind, 2e-4);
        simulation.set_state(state);
        advance(&mut simulation, steps);
        state = simulation.state().clone();
    }
    let error = state.x.iter().zip(&reference).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs()));
    assert!(error < 1e-3, "{error}");
}

#[test]
fn a_velocity_set_from_outside_overrides_the_memory() {
    for name in ["Bdf2", "PositionVerlet"] {
        let (kind, mut work, mut state) = (named(name), Workspace::default(), particle());
        let mut system = Oscillator::linear(2.0);
        for _ in 0..10 {
            kind.kind().step(&mut system, &mut state, &mut work, 1e-3);
        }
        state.v = vec![5.0, 5.0];
        let before = state.clone();
        kind.kind().step(&mut system, &mut state, &mut work, 1e-3);
        assert!((state.x[0] - before.x[0] - 5e-3).abs() < 1e-4 && (state.v[0] - 5.0).abs() < 0.1, "{name}: {state:?}");
    }
}

#[test]
fn position_verlet_takes_its_share_of_the_velocity() {
    let mut kind = named("PositionVerlet");
    kind.kind_mut().parameters()[0].set(0.1).unwrap();
    let mut state = particle();
    let (x, v) = (state.x[0], state.v[0]);
    run(&kind, &mut Oscillator::linear(0.0), &mut state, 0.01, 3);
    let way = 0.01 * v * (0.9 + 0.81 + 0.729);
    assert!((state.x[0] - x - way).abs() < 1e-15);
}

/// A random step length and start never leave a kind out of step with the time it was asked for.
#[test]
fn dormand_prince_fills_its_step_exactly() {
    let mut random = Random(2);
    for _ in 0..20 {
        let h = random.between(0.01, 3.0);
        let mut state = particle();
        run(&dormand_prince(1e-10), &mut Oscillator::linear(2.0), &mut state, h, 1);
        let exact = 0.6 * (2.0 * h).cos() + 0.25 * (2.0 * h).sin();
        assert!((state.x[0] - exact).abs() < 1e-8, "{h}");
    }
}

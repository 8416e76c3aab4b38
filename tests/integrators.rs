//! Facts about time stepping: growth, order, what is kept, what is remembered. Every registered kind is walked.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a failing test should panic")]

mod common;

use common::{Random, sheet};
use gingerbread::{
    document, files,
    integrators::{Class, Dynamics, IntegratorKind, Ode, Scheme, Work},
    level::Level,
    meshes::NoFiles,
    scene::Scene,
    simulation::Simulation,
    solvers::{BlockMatrix, Weights},
    state::State,
    toys::ToyKind,
};
use nalgebra::Matrix2;

/// One particle in the plane on a spring to the origin, `f = -m w² (1 + cubic |x|²) x - m c v`.
struct Oscillator {
    square: f64,
    cubic: f64,
    damping: f64,
    evaluations: u64,
}

const MASS: f64 = 2.0;

impl Oscillator {
    fn linear(w: f64) -> Self {
        Self { square: w * w, cubic: 0.0, damping: 0.0, evaluations: 0 }
    }

    fn stiffness(&self, x: &[f64]) -> Matrix2<f64> {
        let point = nalgebra::Vector2::new(x[0], x[1]);
        let round = 1.0 + self.cubic * point.norm_squared();
        (Matrix2::identity() * round + point * point.transpose() * (2.0 * self.cubic)) * (MASS * self.square)
    }
}

impl Dynamics for Oscillator {
    fn force(&mut self, x: &[f64], v: &[f64], force: &mut [f64]) {
        self.evaluations += 1;
        let stiffness = self.square * (1.0 + self.cubic * (x[0] * x[0] + x[1] * x[1]));
        for axis in 0..2 {
            force[axis] = -MASS * (stiffness * x[axis] + self.damping * v[axis]);
        }
    }

    fn mass(&self) -> &[f64] {
        &[MASS; 2]
    }

    fn inverse_mass(&self) -> &[f64] {
        &[1.0 / MASS; 2]
    }

    fn stiffness_times(&mut self, x: &[f64], _: &[f64], d: &[f64], product: &mut [f64]) {
        let force = self.stiffness(x) * nalgebra::Vector2::new(d[0], d[1]);
        product[0] += force.x;
        product[1] += force.y;
    }

    fn couples(&self, _: &mut dyn FnMut(u32, u32)) {}

    fn add_stiffness(&mut self, x: &[f64], _: &[f64], weights: Weights, matrix: &mut BlockMatrix) {
        let damping = Matrix2::from_diagonal_element(weights.velocity * MASS * self.damping);
        matrix.diagonal(0, &(self.stiffness(x) * weights.position + damping));
    }
}

/// `dx/dt = -y, dy/dt = x`.
struct Circle;

impl Ode for Circle {
    fn rate(&mut self, x: &[f64], rate: &mut [f64]) {
        rate.copy_from_slice(&[-x[1], x[0]]);
    }
}

/// A toy as a system of rates.
struct Rate<'a>(&'a ToyKind);

impl Ode for Rate<'_> {
    fn rate(&mut self, x: &[f64], rate: &mut [f64]) {
        rate.copy_from_slice(&self.0.kind().rate([x[0], x[1]]));
    }
}

fn named(name: &str) -> IntegratorKind {
    IntegratorKind::all().into_iter().find(|kind| kind.name() == name).unwrap()
}

/// The kind with an error control that never bites, so that its step is h.
fn without_control(mut kind: IntegratorKind) -> IntegratorKind {
    if kind.kind().class() == Class::ErrorControlled {
        kind.kind_mut().parameters().into_iter().for_each(|parameter| parameter.set(1.0).unwrap());
    }
    kind
}

fn particle() -> State {
    State { x: vec![0.6, -0.3], v: vec![0.5, 0.8], ..State::default() }
}

fn run(kind: &IntegratorKind, system: &mut Oscillator, state: &mut State, h: f64, steps: u64) {
    let mut work = Work::default();
    for _ in 0..steps {
        let counts = kind.kind().step(system, state, &mut work, h);
        assert_eq!(counts.newton.unconverged, 0, "{}", kind.name());
    }
}

/// `w² |x|² + |v|²`, whose root every one-step linear scheme with complex roots multiplies by its growth.
fn size(state: &State, w: f64) -> f64 {
    (state.x.iter().map(|x| w * w * x * x).sum::<f64>() + state.v.iter().map(|v| v * v).sum::<f64>()).sqrt()
}

#[test]
fn an_oscillation_grows_by_the_factor_of_the_scheme_in_every_step() {
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

#[test]
fn the_circle_is_left_at_the_same_rates_by_schemes_that_need_rates_alone() {
    let z = 0.1_f64;
    let growth = [
        ("ForwardEuler", (1.0 + z * z).sqrt()),
        ("Heun", (1.0 + z.powi(4) / 4.0).sqrt()),
        ("RungeKutta4", (1.0 - z.powi(6) / 72.0 + z.powi(8) / 576.0).sqrt()),
    ];
    for (name, growth) in growth {
        let (kind, mut work) = (named(name), Work::default());
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

/// Declared order against the slope over four halvings, by position errors at a fixed time.
fn assert_order(kind: &IntegratorKind, what: &str, error: impl Fn(u64) -> f64) {
    let errors: Vec<f64> = (0..5).map(|halvings| error(1 << halvings)).collect();
    let slope = (errors[0] / errors[4]).log2() / 4.0;
    let declared = f64::from(kind.kind().order());
    println!("{what} {}: order {slope:.3}, declared {declared}; {:.1e} to {:.1e}", kind.name(), errors[0], errors[4]);
    assert!((slope - declared).abs() < 0.15, "{what} {}: order {slope}, errors {errors:?}", kind.name());
}

#[test]
fn the_declared_order_is_the_measured_one_on_a_nonlinear_oscillator_with_and_without_damping() {
    for damping in [0.0, 0.7] {
        let system = || Oscillator { square: 4.0, cubic: 0.8, damping, evaluations: 0 };
        let mut exact = particle();
        run(&without_control(named("DormandPrince")), &mut system(), &mut exact, 1e-3, 3000);
        for kind in IntegratorKind::all().into_iter().map(without_control) {
            // Low orders need short steps to be in their asymptotic range, high ones long steps to stay above round-off.
            let first = [0, 600, 150, 150, 40, 45][kind.kind().order() as usize];
            assert_order(&kind, &format!("oscillator, damping {damping},"), |refine| {
                let mut state = particle();
                run(&kind, &mut system(), &mut state, 3.0 / (first * refine) as f64, first * refine);
                (state.x[0] - exact.x[0]).hypot(state.x[1] - exact.x[1])
            });
        }
    }
}

fn built(level: &Level, step: f64) -> Simulation {
    let mut scene = Scene::build(level, level.mode, &NoFiles, None).unwrap();
    scene.step = step;
    let state = scene.start.clone();
    Simulation::new(scene, state)
}

/// A free sheet in a smooth oscillation, with a few of its slowest shapes and none of its fastest.
fn swinging(kind: &IntegratorKind, step: f64) -> Simulation {
    let level = Level { integrator: kind.clone(), ..sheet("NeoHookean", "", "") };
    let mut simulation = built(&level, step);
    let mut state = simulation.state().clone();
    for (point, v) in state.x.chunks_exact_mut(2).zip(state.v.chunks_exact_mut(2)) {
        let (x, y) = (point[0] - 0.5, point[1] - 0.5);
        // Out of its rest shape too: where there is no force at first, symplectic Euler is better than its order.
        point[0] += 0.1 * x + 0.2 * x * y;
        point[1] -= 0.1 * y - 0.1 * x * x;
        v.copy_from_slice(&[1.5 * x - 2.0 * y + 4.0 * x * y, 2.0 * x - 1.2 * y + 3.0 * x * x]);
    }
    simulation.set_state(state);
    simulation
}

fn advance(simulation: &mut Simulation, steps: u64) {
    assert_eq!(simulation.advance(steps, &mut || true), steps, "{:?}", simulation.fault());
    assert_eq!(simulation.counts().unconverged, 0);
}

#[test]
fn the_declared_order_is_the_measured_one_on_a_free_sheet() {
    let time = 0.1;
    let end = |kind: &IntegratorKind, steps: u64| {
        let mut simulation = swinging(kind, time / steps as f64);
        advance(&mut simulation, steps);
        simulation.state().x.clone()
    };
    let exact = end(&without_control(named("DormandPrince")), 3000);
    for kind in IntegratorKind::all().into_iter().map(without_control) {
        let first = [0, 400, 100, 100, 50, 50][kind.kind().order() as usize];
        assert_order(&kind, "sheet,", |refine| {
            let difference = end(&kind, first * refine).into_iter().zip(&exact).map(|(a, b)| (a - b) * (a - b));
            difference.sum::<f64>().sqrt()
        });
    }
}

/// `theta'' = -(g/L) sin theta` with g = L, as a point whose x is the angle.
struct Pendulum;

impl Dynamics for Pendulum {
    fn force(&mut self, x: &[f64], _: &[f64], force: &mut [f64]) {
        force.copy_from_slice(&[-libm::sin(x[0]), 0.0]);
    }

    fn mass(&self) -> &[f64] {
        &[1.0; 2]
    }

    fn inverse_mass(&self) -> &[f64] {
        &[1.0; 2]
    }

    fn stiffness_times(&mut self, x: &[f64], _: &[f64], d: &[f64], product: &mut [f64]) {
        product[0] += libm::cos(x[0]) * d[0];
    }

    fn couples(&self, _: &mut dyn FnMut(u32, u32)) {}

    fn add_stiffness(&mut self, x: &[f64], _: &[f64], weights: Weights, matrix: &mut BlockMatrix) {
        matrix.diagonal(0, &(Matrix2::new(libm::cos(x[0]), 0.0, 0.0, 0.0) * weights.position));
    }
}

/// Against the exact angle in Jacobi's elliptic functions, as the toy knows it.
#[test]
fn the_declared_order_is_the_measured_one_on_the_exact_pendulum() {
    let text = "(name: \"p\", integrator: Heun(), toy: Pendulum(length: 1, gravity: 1, start: 90))";
    let toy = files::parse(text, "pendulum").unwrap().toy.unwrap();
    let time = 3.0;
    let start = toy.kind().exact(0.0);
    let exact = toy.kind().exact(time)[0];
    for kind in IntegratorKind::all().into_iter().map(without_control) {
        let first = [0, 800, 150, 150, 40, 14][kind.kind().order() as usize];
        assert_order(&kind, "pendulum,", |refine| {
            let mut state = State { x: vec![start[0], 0.0], v: vec![start[1], 0.0], ..State::default() };
            let mut work = Work::default();
            let steps = first * refine;
            for _ in 0..steps {
                kind.kind().step(&mut Pendulum, &mut state, &mut work, time / steps as f64);
            }
            (state.x[0] - exact).abs()
        });
        let Scheme::First(scheme) = kind.kind().scheme() else { continue };
        assert_order(&kind, "pendulum as a toy,", |refine| {
            let mut state = State { x: start.to_vec(), ..State::default() };
            let mut work = Work::default();
            let steps = first * refine;
            for _ in 0..steps {
                scheme.step(&mut Rate(&toy), &mut state, &mut work, time / steps as f64);
            }
            (state.x[0] - exact).abs()
        });
    }
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
        let (mut state, mut work) = (State { x: toy.kind().exact(0.0).to_vec(), ..State::default() }, Work::default());
        let (start, period) = (state.x[0], 2.0 * std::f64::consts::PI * ratio);
        for _ in 0..40 {
            scheme.step(&mut Rate(&toy), &mut state, &mut work, period / 40.0);
        }
        let wrong = state.x[1] / (libm::sin(start) * period);
        assert!(wrong.abs() < 1e-7 && (state.x[0] - start).abs() < 1e-8, "{degrees}: {wrong:e}");
    }
}

/// Where a level ends after a time, with steps of one length.
fn end(level: &Level, kind: &IntegratorKind, time: f64, steps: u64) -> Vec<f64> {
    let level = Level { integrator: kind.clone(), ..level.clone() };
    let mut simulation = built(&level, time / steps as f64);
    advance(&mut simulation, steps);
    simulation.state().x.clone()
}

/// The order of every scheme at the end of a time, against a far finer run.
fn assert_orders(what: &str, level: &Level, time: f64, first: [u64; 6], finest: u64) {
    let exact = end(level, &without_control(named("DormandPrince")), time, finest);
    for kind in IntegratorKind::all().into_iter().map(without_control) {
        assert_order(&kind, what, |refine| {
            let steps = first[kind.kind().order() as usize] * refine;
            let difference = end(level, &kind, time, steps).into_iter().zip(&exact).map(|(a, b)| (a - b) * (a - b));
            difference.sum::<f64>().sqrt()
        });
    }
}

#[test]
fn the_declared_order_is_the_measured_one_on_the_chain() {
    let text = gingerbread::levels::built_in("chain").unwrap();
    assert_orders("chain,", &files::parse(text, "chain").unwrap(), 1.0, [0, 3000, 600, 600, 150, 80], 6000);
}

#[test]
fn the_declared_order_is_the_measured_one_on_a_free_gingerbread_man() {
    let text =
        gingerbread::levels::built_in("gingerbread_pulled").unwrap().replace("resolution: 2000", "resolution: 100");
    assert_orders("gingerbread,", &files::parse(&text, "man").unwrap(), 0.1, [0, 400, 100, 100, 60, 20], 1000);
}

fn dormand_prince(tolerance: f64) -> IntegratorKind {
    let mut kind = named("DormandPrince");
    kind.kind_mut().parameters().into_iter().for_each(|parameter| parameter.set(tolerance).unwrap());
    kind
}

#[test]
fn a_tolerance_ten_times_smaller_cuts_the_error_about_ten_times_over_five_decades() {
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
    let (kind, mut work, mut state) = (dormand_prince(1e-6), Work::default(), particle());
    let mut inner = |square: f64, state: &mut State| {
        let mut system = Oscillator { square, cubic: 0.0, damping: 0.0, evaluations: 0 };
        (0..10).map(|_| kind.kind().step(&mut system, state, &mut work, 0.2)).last().unwrap()
    };
    let calm = inner(4.0, &mut state);
    let mut work = Work::default();
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
fn saving_and_going_on_equals_never_having_stopped_under_every_integrator() {
    for kind in IntegratorKind::all() {
        let level = Level { integrator: kind, ..sheet("NeoHookean", "spin: 2", ACTING) };
        let name = level.integrator.name();
        let from = |level: &Level| {
            let mut scene = Scene::build(level, level.mode, &NoFiles, None).unwrap();
            scene.step = 1e-3;
            let state = scene.first_state(level.state.as_ref()).unwrap();
            Simulation::new(scene, state)
        };
        let mut straight = from(&level);
        advance(&mut straight, 400);
        let mut first = from(&level);
        for bunch in [1, 7, 129] {
            advance(&mut first, bunch);
        }
        let saved = Level { state: document::saved(first.state()), ..level.clone() };
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

#[test]
fn the_integrator_can_be_changed_at_any_moment_and_the_motion_goes_on() {
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
fn what_was_pushed_from_outside_is_not_pulled_back_by_what_is_remembered() {
    for name in ["Bdf2", "PositionVerlet"] {
        let (kind, mut work, mut state) = (named(name), Work::default(), particle());
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

//! Small systems to step, and what steps them.

use super::sheet;
use gingerbread::{
    integrators::{Class, Dynamics, IntegratorKind, Ode, Workspace},
    level::Level,
    meshes::NoFiles,
    scene::Scene,
    simulation::Simulation,
    solvers::{SparseMatrix, Weights},
    state::State,
    toys::ToyKind,
};
use nalgebra::Matrix2;

/// One particle in the plane on a spring to the origin, `f = -m w² (1 + cubic |x|²) x - m c v`.
pub struct Oscillator {
    pub square: f64,
    pub cubic: f64,
    pub damping: f64,
    pub evaluations: u64,
}

pub const MASS: f64 = 2.0;

impl Oscillator {
    pub fn linear(w: f64) -> Self {
        Self { square: w * w, cubic: 0.0, damping: 0.0, evaluations: 0 }
    }

    pub fn stiffness(&self, x: &[f64]) -> Matrix2<f64> {
        let point = nalgebra::Vector2::new(x[0], x[1]);
        let round = 1.0 + self.cubic * point.norm_squared();
        (Matrix2::identity() * round + point * point.transpose() * (2.0 * self.cubic)) * (MASS * self.square)
    }
}

impl Dynamics for Oscillator {
    fn force(&mut self, _: f64, x: &[f64], v: &[f64], force: &mut [f64]) {
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

    fn stiffness_times(&mut self, _: f64, x: &[f64], _: &[f64], d: &[f64], product: &mut [f64]) {
        let force = self.stiffness(x) * nalgebra::Vector2::new(d[0], d[1]);
        product[0] += force.x;
        product[1] += force.y;
    }

    fn block_size(&self) -> usize {
        2
    }

    fn sparsity_pattern(&self, _: &mut dyn FnMut(u32, u32)) {}

    fn add_stiffness(&mut self, _: f64, x: &[f64], _: &[f64], weights: Weights, matrix: &mut dyn SparseMatrix) {
        let damping = Matrix2::from_diagonal_element(weights.velocity * MASS * self.damping);
        if let Some(matrix) = matrix.blocks::<2>() {
            matrix.diagonal(0, &(self.stiffness(x) * weights.position + damping));
        }
    }
}

/// A toy as a system of rates.
pub struct Rate<'a>(pub &'a ToyKind);

impl Ode for Rate<'_> {
    fn rate(&mut self, _: f64, x: &[f64], rate: &mut [f64]) {
        rate.copy_from_slice(&self.0.kind().rate([x[0], x[1]]));
    }
}

/// The kind with an error control that never bites, so that its step is h.
pub fn without_control(mut kind: IntegratorKind) -> IntegratorKind {
    if kind.kind().class() == Class::ErrorControlled {
        kind.kind_mut().parameters().into_iter().for_each(|parameter| parameter.set(1.0).unwrap());
    }
    kind
}

pub fn particle() -> State {
    State { x: vec![0.6, -0.3], v: vec![0.5, 0.8], ..State::default() }
}

pub fn run(kind: &IntegratorKind, system: &mut Oscillator, state: &mut State, h: f64, steps: u64) {
    let mut work = Workspace::default();
    for _ in 0..steps {
        let counts = kind.kind().step(system, state, &mut work, h);
        assert_eq!(counts.newton.unconverged, 0, "{}", kind.name());
    }
}

pub fn built(level: &Level, step: f64) -> Simulation {
    let mut scene = Scene::build(level, level.mode, &NoFiles, None).unwrap();
    scene.step = step;
    let state = scene.start.clone();
    Simulation::new(scene, state)
}

/// A free sheet in a smooth oscillation, with a few of its slowest shapes and none of its fastest.
pub fn swinging(kind: &IntegratorKind, step: f64) -> Simulation {
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

pub fn advance(simulation: &mut Simulation, steps: u64) {
    assert_eq!(simulation.advance(steps, &mut || true), steps, "{:?}", simulation.fault());
    assert_eq!(simulation.counts().unconverged, 0);
}

/// Declared order against the slope over four halvings, by position errors at a fixed time.
pub fn assert_order(kind: &IntegratorKind, what: &str, error: impl Fn(u64) -> f64) {
    let errors: Vec<f64> = (0..5).map(|halvings| error(1 << halvings)).collect();
    let slope = (errors[0] / errors[4]).log2() / 4.0;
    let declared = f64::from(kind.kind().order());
    println!("{what} {}: order {slope:.3}, declared {declared}; {:.1e} to {:.1e}", kind.name(), errors[0], errors[4]);
    assert!((slope - declared).abs() < 0.15, "{what} {}: order {slope}, errors {errors:?}", kind.name());
}

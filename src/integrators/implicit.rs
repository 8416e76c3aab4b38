//! Common part of implicit schemes. Positions and velocities of the stage are affine in the unknown accelerations z, `x
//! = x^ + ax z` and `v = v^ + av z`, and z solves `M z = f(x, v)`.

use super::{Dynamics, StepCounts, Workspace, parts};
use crate::{
    solvers::{Equations, SparseMatrix, Tangent, Weights},
    state::State,
};

/// Tolerance of solved positions, as a fraction of the greatest displacement of any vertex in the step. Errors of the
/// scheme itself are hundreds of times larger at any usable step.
pub(super) const RELATIVE: f64 = 1e-8;
/// The same as a fraction of the greatest distance from the origin: round-off of the forces.
const ROUND_OFF: f64 = 1e-13;

/// Factors of z in positions and velocities [s², s]. `end` is the displacement over the step divided by that to the stage:
/// 2 for the midpoint rules, 1 for the others. `relative` is the tolerance of positions, as a fraction of the greatest displacement.
#[derive(Clone, Copy)]
pub(super) struct Affine {
    pub ax: f64,
    pub av: f64,
    pub end: f64,
    pub relative: f64,
}

impl Affine {
    /// Factors of implicit Euler with step length h \[s\].
    pub const fn euler(h: f64) -> Self {
        Self { ax: h * h, av: h, end: 1.0, relative: RELATIVE }
    }

    /// Time of the stage since the start of a step of length h \[s\].
    fn time(self, h: f64) -> f64 {
        h / self.end
    }
}

/// Solves `M z = f(x^ + ax z, v^ + av z)`, where `predicted` gives x^ and v^ for each number, and sets the state to the
/// end of the step of length h. Pinned vertices stay. Returns also whether constraints changed the end of the step.
pub(super) fn step(
    system: &mut dyn Dynamics,
    state: &mut State,
    workspace: &mut Workspace,
    (affine, h): (Affine, f64),
    predicted: impl Fn(&State, usize) -> [f64; 2],
) -> (StepCounts, bool) {
    let Workspace { numbers, newton, .. } = workspace;
    let [predicted_x, predicted_v, x, v, z, end_x, end_v] = parts::<7>(numbers, state.x.len());
    for (number, inverse_mass) in system.inverse_mass().iter().enumerate() {
        let pinned = *inverse_mass == 0.0;
        [predicted_x[number], predicted_v[number]] =
            if pinned { [state.x[number], state.v[number]] } else { predicted(state, number) };
    }
    z.fill(0.0);
    let (origin, velocity) = (&state.x, &state.v);
    let time = affine.time(h);
    let mut stage = Stage { system: &mut *system, origin, velocity, predicted_x, predicted_v, x, v, affine, time };
    let counts = newton.solve(&mut stage, z);
    stage.evaluate(z);
    for (end, (origin, stage)) in end_x.iter_mut().zip(origin.iter().zip(&*x)) {
        *end = along(*origin, *stage, affine.end);
    }
    for (number, end) in end_v.iter_mut().enumerate() {
        *end = if system.inverse_mass()[number] == 0.0 { 0.0 } else { along(velocity[number], v[number], affine.end) };
    }
    let changed = system.constrain(origin, end_x, end_v);
    state.x.copy_from_slice(end_x);
    state.v.copy_from_slice(end_v);
    (StepCounts { newton: counts, ..StepCounts::ONE }, changed)
}

/// A step whose stage is the midpoint, halfway to the end.
pub(super) fn midpoint_step(
    system: &mut dyn Dynamics,
    state: &mut State,
    workspace: &mut Workspace,
    (h, relative): (f64, f64),
) -> StepCounts {
    let affine = Affine { ax: 0.25 * h * h, av: 0.5 * h, end: 2.0, relative };
    let predicted = |state: &State, number: usize| [state.x[number] + 0.5 * h * state.v[number], state.v[number]];
    step(system, state, workspace, (affine, h), predicted).0
}

/// `origin + times (stage - origin)`.
fn along(origin: f64, stage: f64, times: f64) -> f64 {
    if times == 1.0 { stage } else { origin + times * (stage - origin) }
}

/// The equations of one stage, `M z - f(x^ + ax z, v^ + av z) = 0`.
pub(super) struct Stage<'s, 'a> {
    pub system: &'s mut dyn Dynamics,
    /// Positions at the start of the step.
    pub origin: &'s [f64],
    /// Velocities at the start of the step.
    pub velocity: &'s [f64],
    pub predicted_x: &'s [f64],
    pub predicted_v: &'s [f64],
    pub x: &'a mut [f64],
    pub v: &'a mut [f64],
    pub affine: Affine,
    /// Time of the stage since the start of the step \[s\].
    pub time: f64,
}

impl Stage<'_, '_> {
    fn evaluate(&mut self, z: &[f64]) {
        let Self { predicted_x, predicted_v, x, v, affine, .. } = self;
        for (number, z) in z.iter().enumerate() {
            x[number] = predicted_x[number] + affine.ax * z;
            v[number] = predicted_v[number] + affine.av * z;
        }
    }
}

impl Equations for Stage<'_, '_> {
    fn residual(&mut self, z: &[f64], g: &mut [f64]) {
        self.evaluate(z);
        self.system.force(self.time, self.x, self.v, g);
        for (((g, z), mass), inverse) in g.iter_mut().zip(z).zip(self.system.mass()).zip(self.system.inverse_mass()) {
            *g = if *inverse == 0.0 { 0.0 } else { mass * z - *g };
        }
        self.system.add_coupled_mass(z, g);
    }

    fn block_size(&self) -> usize {
        self.system.block_size()
    }

    fn derivative(&mut self, z: &[f64], tangent: Tangent, matrix: &mut dyn SparseMatrix) {
        self.evaluate(z);
        let weights = Weights { position: self.affine.ax, velocity: self.affine.av, tangent };
        self.system.add_stiffness(self.time, self.x, self.v, weights, matrix);
        self.system.add_mass(matrix);
    }

    fn has_derivative(&self) -> bool {
        self.system.has_derivative()
    }

    fn is_constrained(&self) -> bool {
        self.system.is_constrained()
    }

    fn correct_step(&mut self, z: &[f64], step: &mut [f64], invert: &mut dyn FnMut(&mut [f64])) {
        self.evaluate(z);
        let Affine { ax, av, .. } = self.affine;
        self.system.correct_step(self.time, [self.x, self.v], [av, ax], (z, step), invert);
    }

    fn sparsity_pattern(&self, add: &mut dyn FnMut(u32, u32)) {
        self.system.sparsity_pattern(add);
    }

    fn pattern_changes(&mut self, z: &[f64]) -> bool {
        self.evaluate(z);
        self.system.pattern_changes(self.x)
    }

    fn longest_step(&mut self, z: &[f64], step: &[f64]) -> f64 {
        self.evaluate(z);
        // The buffer of velocities is free here.
        self.v.iter_mut().zip(step).for_each(|(displacement, step)| *displacement = self.affine.ax * step);
        self.system.longest_step(self.x, self.v)
    }

    fn inverse_weight(&self) -> &[f64] {
        self.system.inverse_mass()
    }

    /// The positions at the start of the step, where forces are defined if anywhere.
    fn other_start(&self, z: &mut [f64]) {
        for (number, z) in z.iter_mut().enumerate().filter(|(number, _)| self.system.inverse_mass()[*number] != 0.0) {
            *z = (self.origin[number] - self.predicted_x[number]) / self.affine.ax;
        }
    }

    /// Tolerance of positions over `ax`.
    fn tolerance(&self, z: &[f64]) -> f64 {
        let (mut displacement, mut distance) = (0.0_f64, 0.0_f64);
        let size = self.block_size();
        for (vertex, z) in z.chunks_exact(size).enumerate() {
            let (mut moved, mut far) = (0.0, 0.0);
            for (number, z) in (size * vertex..).zip(z) {
                let x = self.predicted_x[number] + self.affine.ax * z;
                moved += (x - self.origin[number]) * (x - self.origin[number]);
                far += x * x;
            }
            (displacement, distance) = (displacement.max(moved), distance.max(far));
        }
        (self.affine.relative * displacement.sqrt() + ROUND_OFF * distance.sqrt()) / self.affine.ax
    }

    /// Local error of positions in this step over `ax`, to leading order. The error is `2/9 h³ v"` for the second backward differentiation
    /// formula (Hairer, Nørsett and Wanner, *Solving Ordinary Differential Equations I*, section III.2), with the
    /// second difference of velocities for h² v". With implicit Euler, whose v^ is the velocity before, the same
    /// expression is two thirds of its `h²/2 a`. For the implicit midpoint rule there is no estimate: one acceleration
    /// has no derivative by time.
    fn error(&self, z: &[f64]) -> f64 {
        let Affine { ax, av, end, .. } = self.affine;
        if end != 1.0 {
            return 0.0;
        }
        let mut greatest = 0.0_f64;
        let size = self.block_size();
        for (vertex, z) in z.chunks_exact(size).enumerate() {
            // v' - 2 v + v_previous, with v_previous = 4 v - 3 v^.
            let difference =
                |(number, z): (usize, &f64)| av * z + 2.0 * (self.velocity[number] - self.predicted_v[number]);
            greatest = greatest.max((size * vertex..).zip(z).map(difference).map(|one| one * one).sum());
        }
        greatest.sqrt() * av / (3.0 * ax)
    }
}

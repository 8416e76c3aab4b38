//! Common part of implicit schemes. Positions and velocities of the stage are affine in the unknown accelerations z, `x
//! = x^ + ax z` and `v = v^ + av z`, and z solves `M z = f(x, v)`.

use super::{
    Dynamics, StepCounts, Workspace,
    active_set::{self, WallReactions},
    axes::{self, Axis, pair, put},
    parts,
    system::{apply_constraints, touched},
};
use crate::{
    solvers::{BlockMatrix, Equations, NewtonCounts, Tangent, Weights},
    state::State,
};
use nalgebra::Matrix2;

/// Tolerance of solved positions, as a fraction of the greatest displacement of any vertex in the step. Errors of the
/// scheme itself are hundreds of times larger at any usable step.
const RELATIVE: f64 = 1e-8;
/// The same as a fraction of the greatest distance from the origin: round-off of the forces.
const ROUND_OFF: f64 = 1e-13;

/// Least distance to a wall as a fraction of the displacement; a vertex below it rests on the wall.
const SHORTEST: f64 = 1e-3;

/// Most solves of a step with added wall constraints.
const PASSES: usize = 8;

/// Most iterations of the active set.
const TRIES: usize = 6;

/// Factors of z in positions and velocities [s², s]; the step ends at `end` times the displacement of the stage.
#[derive(Clone, Copy)]
pub(super) struct Affine {
    pub ax: f64,
    pub av: f64,
    pub end: f64,
}

impl Affine {
    /// Factors of implicit Euler with step length h [s].
    pub const fn euler(h: f64) -> Self {
        Self { ax: h * h, av: h, end: 1.0 }
    }
}

/// Solves `M z = f(x^ + ax z, v^ + av z)`, where `predicted` gives x^ and v^ for each number, and sets the state to the
/// end of the step of length h. Pinned vertices stay.
///
/// Walls are part of the equations: vertices whose end of step constraints change are constrained there, and the rest
/// is solved again. So a body that meets a wall is flattened by its own elasticity and not by moving vertices through
/// their neighbours. A vertex that one smooth wall pushes is constrained along the normal alone. If the scheme does not
/// end at its stage, such a step is one of implicit Euler. [`touched_axes`] tells the constrained axes afterwards.
///
/// Vertices that rest on a smooth wall are constrained from the start, which saves a solve without the wall, and
/// dropped where the wall would have to pull: the active sets of Hintermüller, Ito and Kunisch (*The primal-dual active
/// set strategy as a semismooth Newton method*, SIAM Journal on Optimization 13, 2002). The step is accepted if walls
/// only push in the end.
pub(super) fn step(
    system: &mut dyn Dynamics,
    state: &mut State,
    workspace: &mut Workspace,
    (affine, h): (Affine, f64),
    predicted: impl Fn(&State, usize) -> [f64; 2],
) -> StepCounts {
    let mut counts = NewtonCounts::NONE;
    begin(system, state, workspace, &predicted);
    let mut reactions = active_set::add_resting(system, state, workspace, (affine, h));
    let own = if affine.end == 1.0 { affine } else { Affine::euler(h) };
    for _ in 0..TRIES {
        if reactions != WallReactions::Pull {
            break;
        }
        let (tried, settled) = solve(system, state, workspace, (own, h));
        counts.add(&NewtonCounts { unconverged: 0, ..tried });
        let solved = settled && tried.unconverged == 0;
        reactions = if solved { active_set::drop_pulling(system, workspace) } else { WallReactions::Other };
        // A step without active walls is one of the scheme itself.
        if reactions == WallReactions::Push && affine.end != 1.0 && !active_set::is_any_active(system, workspace) {
            reactions = WallReactions::Other;
        }
    }
    if reactions != WallReactions::Push {
        system.discard_records();
        begin(system, state, workspace, &predicted);
        counts.add(&solve(system, state, workspace, (affine, h)).0);
    }
    let Workspace { numbers, spare, .. } = workspace;
    let [.., inverse, end_x, end_v, _] = parts::<PARTS>(numbers, state.x.len());
    for (number, inverse) in inverse.iter().enumerate() {
        if *inverse == 0.0 && system.inverse_mass()[number] != 0.0 {
            // NaN is equal to nothing, so that the number counts as touched.
            spare[number] = f64::NAN;
        }
    }
    state.x.copy_from_slice(end_x);
    state.v.copy_from_slice(end_v);
    StepCounts { newton: counts, ..StepCounts::ONE }
}

/// Work arrays: x^, v^, x, v, z, 1/mass (zero where constrained), x and v at the end, and wall reactions.
pub(super) const PARTS: usize = 9;

/// Initialises the step with only pinned vertices constrained.
fn begin(
    system: &dyn Dynamics,
    state: &State,
    workspace: &mut Workspace,
    predicted: &impl Fn(&State, usize) -> [f64; 2],
) {
    let [predicted_x, predicted_v, _, _, z, inverse, ..] = parts::<PARTS>(&mut workspace.numbers, state.x.len());
    inverse.copy_from_slice(system.inverse_mass());
    axes::reset_axes(&mut workspace.axes, state.x.len());
    for number in 0..state.x.len() {
        let pinned = inverse[number] == 0.0;
        [predicted_x[number], predicted_v[number]] =
            if pinned { [state.x[number], 0.0] } else { predicted(state, number) };
    }
    z.fill(0.0);
}

/// x^ and v^ of implicit Euler.
pub(super) fn predict(system: &dyn Dynamics, state: &State, [predicted_x, predicted_v]: [&mut [f64]; 2], h: f64) {
    for number in (0..state.x.len()).filter(|number| system.inverse_mass()[*number] != 0.0) {
        predicted_v[number] = state.v[number];
        predicted_x[number] = state.x[number] + h * state.v[number];
    }
}

/// Solves with the present constraints, and again while constraints are added. Returns also whether that ended.
fn solve(
    system: &mut dyn Dynamics,
    state: &State,
    workspace: &mut Workspace,
    (mut affine, h): (Affine, f64),
) -> (NewtonCounts, bool) {
    let Workspace { numbers, spare, newton, axes, .. } = workspace;
    let [predicted_x, predicted_v, x, v, z, inverse, end_x, end_v, _] = parts::<PARTS>(numbers, state.x.len());
    let smooth = !system.has_friction();
    let mut counts = NewtonCounts::NONE;
    // At first only vertices that face a wall are stopped: of a body that would end far beyond the wall, its front. If
    // the front stops, the rest need not get there.
    let mut faces = true;
    for pass in 1..=PASSES {
        let origin = &state.x;
        let velocity = &state.v;
        let mut stage =
            Stage { system: &mut *system, origin, velocity, predicted_x, predicted_v, inverse, axes, x, v, affine };
        counts.add(&newton.solve(&mut stage, z));
        stage.evaluate(z);
        for vertex in 0..origin.len() / 2 {
            let (axis, constrained) =
                (Axis::of(axes, vertex), constrained_axes(inverse, system.inverse_mass(), vertex));
            let reached =
                |from: &[f64], to: &[f64]| [0, 1].map(|k| along(from[2 * vertex + k], to[2 * vertex + k], affine.end));
            put(end_x, vertex, axis.mix(constrained, pair(end_x, vertex), reached(origin, x)));
            put(end_v, vertex, axis.mix(constrained, pair(end_v, vertex), reached(&state.v, v)));
        }
        let mut more = false;
        while !more {
            faces &= pass < PASSES;
            apply_constraints(system, [origin, &state.v], (end_x, end_v), spare, faces);
            for vertex in 0..origin.len() / 2 {
                more |= axes::add_constraint(vertex, (axes, inverse, z), [end_x, end_v], spare, smooth);
            }
            if !faces {
                break;
            }
            faces = more;
        }
        if !more {
            return (counts, true);
        }
        if affine.end != 1.0 {
            // An impact is not smooth; an undamped scheme would excite high frequencies.
            affine = Affine::euler(h);
            predict(system, state, [&mut *predicted_x, &mut *predicted_v], h);
            for number in (0..origin.len()).filter(|number| system.inverse_mass()[*number] != 0.0) {
                z[number] *= 0.5;
            }
        }
        let share = first_touch(origin, end_x, &spare[origin.len()..]);
        for vertex in 0..origin.len() / 2 {
            let (axis, constrained) =
                (Axis::of(axes, vertex), constrained_axes(inverse, system.inverse_mass(), vertex));
            let towards = |x: &dyn Fn(usize) -> f64| {
                axis.into_own([0, 1].map(|k| (x(2 * vertex + k) - predicted_x[2 * vertex + k]) / affine.ax))
            };
            let kept = towards(&|number| end_x[number]);
            let start =
                share.map(|share| towards(&|number| along(origin[number], spare[origin.len() + number], share)));
            for k in (0..2).filter(|k| system.inverse_mass()[2 * vertex + k] != 0.0) {
                let predicted = start.map_or(z[2 * vertex + k], |start| start[k]);
                z[2 * vertex + k] = if constrained[k] { kept[k] } else { predicted };
            }
        }
    }
    (counts, false)
}

/// Which local coordinates of a vertex a wall constrains.
pub(super) fn constrained_axes(inverse: &[f64], inverse_mass: &[f64], vertex: usize) -> [bool; 2] {
    [0, 1].map(|k| inverse[2 * vertex + k] == 0.0 && inverse_mass[2 * vertex + k] != 0.0)
}

/// Local axes of a vertex, and along which of them walls acted in the last [`step`].
pub(super) fn touched_axes(state: &State, workspace: &Workspace, vertex: usize) -> (Axis, [bool; 2]) {
    let axis = Axis::of(&workspace.axes, vertex);
    let touched = |k: usize| touched(&state.x, &state.v, &workspace.spare, 2 * vertex + k);
    (axis, [0, 1].map(|k| if axis.is_world() { touched(k) } else { workspace.spare[2 * vertex + k].is_nan() }))
}

/// Fraction of the displacements from `origin` to `predicted` after which the first vertex reaches a wall, if positive:
/// the positions there are a start for Newton's method without penetration.
fn first_touch(origin: &[f64], end: &[f64], predicted: &[f64]) -> Option<f64> {
    let shares = (0..origin.len() / 2).filter(|vertex| pair(end, *vertex) != pair(predicted, *vertex)).map(|vertex| {
        let [origin, end, predicted] = [origin, end, predicted].map(|values| pair(values, vertex));
        let across = axes::less(predicted, end);
        axes::dot(axes::less(end, origin), across) / axes::dot(axes::less(predicted, origin), across)
    });
    shares.filter(|share| *share > SHORTEST && *share < 1.0).min_by(f64::total_cmp)
}

/// `origin + times (stage - origin)`.
fn along(origin: f64, stage: f64, times: f64) -> f64 {
    if times == 1.0 { stage } else { origin + times * (stage - origin) }
}

/// The equations of one stage, `M z - f(x^ + ax z, v^ + av z) = 0`, with z along the local axes of each vertex.
pub(super) struct Stage<'s, 'a> {
    pub system: &'s mut dyn Dynamics,
    /// Positions at the start of the step.
    pub origin: &'s [f64],
    /// Velocities at the start of the step.
    pub velocity: &'s [f64],
    pub predicted_x: &'s [f64],
    pub predicted_v: &'s [f64],
    /// 1/mass, zero also where a wall constrains.
    pub inverse: &'s [f64],
    /// See [`Axis`].
    pub axes: &'s [f64],
    pub x: &'a mut [f64],
    pub v: &'a mut [f64],
    pub affine: Affine,
}

impl Stage<'_, '_> {
    fn evaluate(&mut self, z: &[f64]) {
        let vertices = self.x.chunks_exact_mut(2).zip(self.v.chunks_exact_mut(2)).zip(z.chunks_exact(2));
        for (vertex, ((x, v), z)) in vertices.enumerate() {
            let z = Axis::of(self.axes, vertex).out_of_own([z[0], z[1]]);
            for k in 0..2 {
                x[k] = self.predicted_x[2 * vertex + k] + self.affine.ax * z[k];
                v[k] = self.predicted_v[2 * vertex + k] + self.affine.av * z[k];
            }
        }
    }
}

impl Equations for Stage<'_, '_> {
    fn residual(&mut self, z: &[f64], g: &mut [f64]) {
        self.evaluate(z);
        self.system.force(self.x, self.v, g);
        axes::turn(self.axes, g);
        for (((g, z), mass), inverse) in g.iter_mut().zip(z).zip(self.system.mass()).zip(self.inverse) {
            *g = if *inverse == 0.0 { 0.0 } else { mass * z - *g };
        }
    }

    fn derivative(&mut self, z: &[f64], tangent: Tangent, matrix: &mut BlockMatrix) {
        self.evaluate(z);
        let weights = Weights { position: self.affine.ax, velocity: self.affine.av, tangent };
        self.system.add_stiffness(self.x, self.v, weights, matrix);
        matrix.turn(self.axes);
        for (vertex, mass) in self.system.mass().chunks_exact(2).enumerate() {
            matrix.diagonal(vertex, &Matrix2::new(mass[0], 0.0, 0.0, mass[1]));
        }
    }

    fn sparsity_pattern(&self, add: &mut dyn FnMut(u32, u32)) {
        self.system.sparsity_pattern(add);
    }

    fn longest_step(&mut self, z: &[f64], step: &[f64]) -> f64 {
        self.evaluate(z);
        // The buffer of velocities is free here.
        for (vertex, displacement) in self.v.chunks_exact_mut(2).enumerate() {
            let own = pair(step, vertex).map(|step| self.affine.ax * step);
            displacement.copy_from_slice(&Axis::of(self.axes, vertex).out_of_own(own));
        }
        self.system.longest_step(self.x, self.v)
    }

    fn inverse_weight(&self) -> &[f64] {
        self.inverse
    }

    /// The positions at the start of the step, where forces are defined if anywhere.
    fn other_start(&self, z: &mut [f64]) {
        for (vertex, z) in z.chunks_exact_mut(2).enumerate() {
            let displacement = axes::less(pair(self.origin, vertex), pair(self.predicted_x, vertex));
            let stay =
                Axis::of(self.axes, vertex).into_own(displacement.map(|displacement| displacement / self.affine.ax));
            for k in (0..2).filter(|k| self.inverse[2 * vertex + k] != 0.0) {
                z[k] = stay[k];
            }
        }
    }

    fn tolerance(&self, z: &[f64]) -> f64 {
        let (mut displacement, mut distance) = (0.0_f64, 0.0_f64);
        for (vertex, z) in z.chunks_exact(2).enumerate() {
            let z = Axis::of(self.axes, vertex).out_of_own([z[0], z[1]]);
            let predicted = pair(self.predicted_x, vertex);
            let x = [0, 1].map(|k| predicted[k] + self.affine.ax * z[k]);
            let moved = axes::less(x, pair(self.origin, vertex));
            displacement = displacement.max(axes::dot(moved, moved));
            distance = distance.max(axes::dot(x, x));
        }
        (RELATIVE * displacement.sqrt() + ROUND_OFF * distance.sqrt()) / self.affine.ax
    }

    /// Local error of positions in this step, to leading order: `2/9 h³ v"` for the second backward differentiation
    /// formula (Hairer, Nørsett and Wanner, *Solving Ordinary Differential Equations I*, section III.2), with the
    /// second difference of velocities for h² v". Under implicit Euler, whose v^ is the velocity before, the same
    /// expression is two thirds of its `h²/2 a`. For implicit midpoint no estimate exists: one acceleration does not
    /// tell how it changes.
    fn error(&self, z: &[f64]) -> f64 {
        let Affine { ax, av, end } = self.affine;
        if end != 1.0 {
            return 0.0;
        }
        let difference = |(vertex, z): (usize, &[f64])| {
            let z = Axis::of(self.axes, vertex).out_of_own([z[0], z[1]]);
            let (predicted, before) = (pair(self.predicted_v, vertex), pair(self.velocity, vertex));
            // v' - 2 v + v_previous, with v_previous = 4 v - 3 v^.
            let difference = [0, 1].map(|k| av * z[k] + 2.0 * (before[k] - predicted[k]));
            axes::dot(difference, difference)
        };
        z.chunks_exact(2).enumerate().map(difference).fold(0.0, f64::max).sqrt() * av / (3.0 * ax)
    }
}

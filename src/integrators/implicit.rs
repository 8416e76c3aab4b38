//! Common part of implicit schemes. Positions and velocities of the stage are affine in the unknown accelerations z, `x
//! = x^ + ax z` and `v = v^ + av z`, and z solves `M z = f(x, v)`.

use super::{Dynamics, StepCounts, Workspace, parts, system::apply_constraints};
use crate::{
    obstacles::{ActiveSet, ActiveSetStatus},
    solvers::{Equations, NewtonCounts, SparseMatrix, Tangent, Weights},
    state::State,
};

/// Tolerance of solved positions, as a fraction of the greatest displacement of any vertex in the step. Errors of the
/// scheme itself are hundreds of times larger at any usable step.
const RELATIVE: f64 = 1e-8;
/// The same as a fraction of the greatest distance from the origin: round-off of the forces.
const ROUND_OFF: f64 = 1e-13;

/// Most solves with added wall constraints.
const MOST_CONTACT_SOLVES: usize = 8;

/// Most solves that do not converge in a step.
const MOST_UNCONVERGED: u64 = 2;

/// Most iterations of the active set.
const MOST_ACTIVE_SETS: usize = 6;

/// Factors of z in positions and velocities [s², s]. `end` is the displacement over the step divided by that to the stage:
/// 2 for the implicit midpoint rule, 1 for the others.
#[derive(Clone, Copy)]
pub(super) struct Affine {
    pub ax: f64,
    pub av: f64,
    pub end: f64,
}

impl Affine {
    /// Factors of implicit Euler with step length h \[s\].
    pub const fn euler(h: f64) -> Self {
        Self { ax: h * h, av: h, end: 1.0 }
    }

    /// Time of the stage since the start of a step of length h \[s\].
    fn time(self, h: f64) -> f64 {
        h / self.end
    }
}

/// Solves `M z = f(x^ + ax z, v^ + av z)`, where `predicted` gives x^ and v^ for each number, and sets the state to the
/// end of the step of length h. Pinned vertices stay.
///
/// Walls are part of the equations: a vertex that the contact projection moves at the end of the step is constrained
/// there, and the rest is solved again. A projection alone could push vertices through their neighbours and invert
/// triangles. A vertex that one smooth wall pushes is constrained along the normal alone. With the implicit midpoint
/// rule, a step with contact is one of implicit Euler. The active set tells afterwards where walls acted.
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
    let mut reactions = add_resting(system, state, workspace, (affine, h));
    let in_contact = if affine.end == 1.0 { affine } else { Affine::euler(h) };
    for _ in 0..MOST_ACTIVE_SETS {
        if reactions != ActiveSetStatus::Changed {
            break;
        }
        let (tried, settled) = solve(system, state, workspace, (in_contact, h));
        counts.add(&NewtonCounts { unconverged: 0, ..tried });
        let solved = settled && tried.unconverged == 0;
        reactions = if solved { drop_pulling(system, workspace, state.x.len(), h) } else { ActiveSetStatus::Abandoned };
        // A step without active walls is one of the scheme itself.
        if reactions == ActiveSetStatus::Accepted
            && affine.end != 1.0
            && !workspace.active.is_any_active(system.inverse_mass())
        {
            reactions = ActiveSetStatus::Abandoned;
        }
    }
    if reactions != ActiveSetStatus::Accepted {
        system.discard_records();
        begin(system, state, workspace, &predicted);
        counts.add(&solve(system, state, workspace, (affine, h)).0);
    }
    let Workspace { numbers, spare, active, .. } = workspace;
    let [impulse, _, displacement, velocity, z, end_x, end_v, force] = parts::<PARTS>(numbers, state.x.len());
    if system.has_moving_obstacles() && active.is_any_active(system.inverse_mass()) {
        // The stage is in `displacement` and `velocity` until here.
        system.force(affine.time(h), displacement, velocity, force);
        displacement.iter_mut().zip(&*end_x).zip(&state.x).for_each(|((d, end), start)| *d = end - start);
        velocity.copy_from_slice(end_v);
        let changes = end_v.iter().zip(&state.v).zip(system.mass()).zip(&*force);
        impulse.iter_mut().zip(changes).for_each(|(impulse, (((end, start), mass), force))| {
            *impulse = mass * (end - start) - h * force;
        });
        for values in [&mut *impulse, &mut *displacement, &mut *velocity, &mut *force] {
            active.to_local(values);
        }
        let masses = [system.mass(), system.inverse_mass()];
        let work = active.work_of_reactions(masses, [z, force, displacement], [impulse, velocity]);
        system.set_work_of_obstacles(work);
    }
    active.mark(system.inverse_mass(), spare);
    state.x.copy_from_slice(end_x);
    state.v.copy_from_slice(end_v);
    StepCounts { newton: counts, ..StepCounts::ONE }
}

/// Work arrays: x^, v^, x, v, z, x and v at the end, and wall reactions.
const PARTS: usize = 8;

/// Initialises the step with only pinned vertices constrained.
fn begin(
    system: &dyn Dynamics,
    state: &State,
    workspace: &mut Workspace,
    predicted: &impl Fn(&State, usize) -> [f64; 2],
) {
    let Workspace { numbers, active, .. } = workspace;
    let [predicted_x, predicted_v, _, _, z, ..] = parts::<PARTS>(numbers, state.x.len());
    active.reset(system.block_size(), system.inverse_mass());
    for (number, inverse_mass) in system.inverse_mass().iter().enumerate() {
        let pinned = *inverse_mass == 0.0;
        [predicted_x[number], predicted_v[number]] =
            if pinned { [state.x[number], 0.0] } else { predicted(state, number) };
    }
    z.fill(0.0);
}

/// x^ and v^ of implicit Euler.
fn predict(system: &dyn Dynamics, state: &State, [predicted_x, predicted_v]: [&mut [f64]; 2], h: f64) {
    for number in (0..state.x.len()).filter(|number| system.inverse_mass()[*number] != 0.0) {
        predicted_v[number] = state.v[number];
        predicted_x[number] = state.x[number] + h * state.v[number];
    }
}

/// Solves with the present constraints, and again while constraints are added. Returns also whether the last solve added
/// none.
fn solve(
    system: &mut dyn Dynamics,
    state: &State,
    workspace: &mut Workspace,
    (mut affine, h): (Affine, f64),
) -> (NewtonCounts, bool) {
    let Workspace { numbers, spare, newton, active, .. } = workspace;
    let [predicted_x, predicted_v, x, v, z, end_x, end_v, _] = parts::<PARTS>(numbers, state.x.len());
    let smooth = !system.has_friction();
    let mut counts = NewtonCounts::NONE;
    // At first only vertices whose outward side faces a wall are projected. With these constrained, the next solve may
    // leave the others in front of the wall.
    let mut facing_only = true;
    for pass in 1..=MOST_CONTACT_SOLVES {
        let (origin, velocity) = (&state.x, &state.v);
        let mut stage = Stage {
            system: &mut *system,
            origin,
            velocity,
            predicted_x,
            predicted_v,
            active,
            x,
            v,
            affine,
            time: affine.time(h),
        };
        counts.add(&newton.solve(&mut stage, z));
        stage.evaluate(z);
        active.set_free(system.inverse_mass(), end_x, |number| along(origin[number], x[number], affine.end));
        active.set_free(system.inverse_mass(), end_v, |number| along(velocity[number], v[number], affine.end));
        let last = pass == MOST_CONTACT_SOLVES || counts.unconverged >= MOST_UNCONVERGED;
        let mut more = false;
        while !more {
            facing_only &= !last;
            apply_constraints(system, [origin, velocity], (end_x, end_v), spare, facing_only);
            more |= active.add(z, [end_x, end_v], spare, smooth);
            if !facing_only {
                break;
            }
            facing_only = more;
        }
        if !more {
            return (counts, true);
        }
        if last {
            break;
        }
        if affine.end != 1.0 {
            // An impact is not smooth; an undamped scheme would excite high frequencies.
            affine = Affine::euler(h);
            predict(system, state, [&mut *predicted_x, &mut *predicted_v], h);
            // The end of the step stays: z moves it by h²/2 with the midpoint rule and by h² with implicit Euler.
            for number in (0..origin.len()).filter(|number| system.inverse_mass()[*number] != 0.0) {
                z[number] *= 0.5;
            }
        }
        let ends = [origin, &*end_x, &spare[origin.len()..]];
        active.start_again(system.inverse_mass(), ends, (predicted_x, affine.ax), z);
    }
    (counts, false)
}

/// Adds vertices to the active set that touch a smooth wall at the start of the step and are pressed to it by the
/// forces there. If there are any, their accelerations keep them in place, the step is one of implicit Euler if the
/// scheme does not end at its stage, and [`drop_pulling`] checks the reactions.
fn add_resting(
    system: &mut dyn Dynamics,
    state: &State,
    workspace: &mut Workspace,
    (affine, h): (Affine, f64),
) -> ActiveSetStatus {
    if system.has_friction() || !system.constrains() {
        return ActiveSetStatus::Abandoned;
    }
    let Workspace { numbers, spare, active, .. } = workspace;
    let [predicted_x, predicted_v, _, v, z, end_x, end_v, _] = parts::<PARTS>(numbers, state.x.len());
    system.force(0.0, &state.x, &state.v, v);
    for (((v, before), inverse), end) in v.iter_mut().zip(&state.v).zip(system.inverse_mass()).zip(&mut *end_v) {
        *v = if *inverse == 0.0 { 0.0 } else { before + h * *v * inverse };
        *end = *v;
    }
    if !system.project_contact_velocity([&state.x, &state.v], end_x, end_v) {
        return ActiveSetStatus::Abandoned;
    }
    // Prediction without walls: velocities, then positions.
    spare.clear();
    spare.extend(v.iter().chain(&state.x));
    if !active.add_resting(system.inverse_mass(), z, &state.x, [end_x, end_v], spare) {
        return ActiveSetStatus::Abandoned;
    }
    let affine = if affine.end == 1.0 {
        affine
    } else {
        predict(system, state, [&mut *predicted_x, &mut *predicted_v], h);
        Affine::euler(h)
    };
    active.keep_resting(system.inverse_mass(), (&state.x, predicted_x, affine.ax), z);
    ActiveSetStatus::Changed
}

/// Drops constraints whose reaction pulls, after a solve of `count` numbers.
fn drop_pulling(system: &mut dyn Dynamics, workspace: &mut Workspace, count: usize, h: f64) -> ActiveSetStatus {
    let Workspace { numbers, active, .. } = workspace;
    let [_, _, x, v, z, _, _, force] = parts::<PARTS>(numbers, count);
    system.force(h, x, v, force);
    active.drop_pulling([system.mass(), system.inverse_mass()], z, force)
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
    pub active: &'s ActiveSet,
    pub x: &'a mut [f64],
    pub v: &'a mut [f64],
    pub affine: Affine,
    /// Time of the stage since the start of the step \[s\].
    pub time: f64,
}

impl Stage<'_, '_> {
    fn evaluate(&mut self, z: &[f64]) {
        let Self { predicted_x, predicted_v, active, x, v, affine, .. } = self;
        active.each(z, |first, z| {
            for (number, z) in (first..).zip(z) {
                x[number] = predicted_x[number] + affine.ax * z;
                v[number] = predicted_v[number] + affine.av * z;
            }
        });
    }
}

impl Equations for Stage<'_, '_> {
    fn residual(&mut self, z: &[f64], g: &mut [f64]) {
        self.evaluate(z);
        self.system.force(self.time, self.x, self.v, g);
        self.active.to_local(g);
        for (((g, z), mass), inverse) in g.iter_mut().zip(z).zip(self.system.mass()).zip(self.active.inverse()) {
            *g = if *inverse == 0.0 { 0.0 } else { mass * z - *g };
        }
    }

    fn block_size(&self) -> usize {
        self.system.block_size()
    }

    fn derivative(&mut self, z: &[f64], tangent: Tangent, matrix: &mut dyn SparseMatrix) {
        self.evaluate(z);
        let weights = Weights { position: self.affine.ax, velocity: self.affine.av, tangent };
        self.system.add_stiffness(self.time, self.x, self.v, weights, matrix);
        self.active.matrix_to_local(matrix);
        let mass = self.system.mass();
        matrix.add_to_diagonal(&|number| mass[number]);
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
        self.active.to_global(self.v);
        self.system.longest_step(self.x, self.v)
    }

    fn inverse_weight(&self) -> &[f64] {
        self.active.inverse()
    }

    /// The positions at the start of the step, where forces are defined if anywhere.
    fn other_start(&self, z: &mut [f64]) {
        let stay = |number: usize| (self.origin[number] - self.predicted_x[number]) / self.affine.ax;
        self.active.assign(z, stay, |number| self.active.inverse()[number] != 0.0);
    }

    /// Tolerance of positions over `ax`.
    fn tolerance(&self, z: &[f64]) -> f64 {
        let (mut displacement, mut distance) = (0.0_f64, 0.0_f64);
        self.active.each(z, |first, z| {
            let (mut moved, mut far) = (0.0, 0.0);
            for (number, z) in (first..).zip(z) {
                let x = self.predicted_x[number] + self.affine.ax * z;
                moved += (x - self.origin[number]) * (x - self.origin[number]);
                far += x * x;
            }
            (displacement, distance) = (displacement.max(moved), distance.max(far));
        });
        (RELATIVE * displacement.sqrt() + ROUND_OFF * distance.sqrt()) / self.affine.ax
    }

    /// Local error of positions in this step over `ax`, to leading order. The error is `2/9 h³ v"` for the second backward differentiation
    /// formula (Hairer, Nørsett and Wanner, *Solving Ordinary Differential Equations I*, section III.2), with the
    /// second difference of velocities for h² v". With implicit Euler, whose v^ is the velocity before, the same
    /// expression is two thirds of its `h²/2 a`. For the implicit midpoint rule there is no estimate: one acceleration
    /// has no derivative by time.
    fn error(&self, z: &[f64]) -> f64 {
        let Affine { ax, av, end } = self.affine;
        if end != 1.0 {
            return 0.0;
        }
        let mut greatest = 0.0_f64;
        self.active.each(z, |first, z| {
            // v' - 2 v + v_previous, with v_previous = 4 v - 3 v^.
            let difference =
                |(number, z): (usize, &f64)| av * z + 2.0 * (self.velocity[number] - self.predicted_v[number]);
            greatest = greatest.max((first..).zip(z).map(difference).map(|one| one * one).sum());
        });
        greatest.sqrt() * av / (3.0 * ax)
    }
}

//! Active set: the vertices that walls constrain in an implicit step, and the axes that they are constrained along.
//!
//! Vertices have local axes, so that a vertex which one smooth wall pushes is constrained along the normal of that wall
//! alone. Walls act on vertices of two coordinates only; others are never constrained, and their local axes are the global
//! ones.

use crate::solvers::SparseMatrix;

/// Result of an iteration of the active set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActiveSetStatus {
    /// The walls that vertices rest on push: the solution is the step.
    Accepted,
    /// The set was changed: solve with it.
    Changed,
    /// Solve again from the start without resting vertices: there are none, or friction, a moving wall, an unsolved
    /// equation or two oblique walls leave the reactions unknown.
    Abandoned,
}

/// Greatest pull of a wall as a fraction of the greatest push: round-off and error of the solution.
const REACTION_TOLERANCE: f64 = 1e-6;
/// Greatest normal velocity of a stopped vertex as a fraction of the change of its velocity.
const STOPPED: f64 = 1e-6;
/// A change of position or velocity below this fraction is round-off and has no direction.
const ROUND_OFF: f64 = 1e-12;
/// Greatest difference of two directions that count as equal.
const SAME: f64 = 1e-6;
/// First contacts after a smaller fraction of the displacement are ignored.
const LEAST_FRACTION: f64 = 1e-3;

/// The constrained vertices of an implicit step.
#[derive(Default)]
pub struct ActiveSet {
    /// Number of coordinates of a vertex.
    size: usize,
    /// First local axis of each vertex, a unit vector; the second is rotated by 90°. Flat; empty if no wall can act.
    axes: Vec<f64>,
    /// 1/mass [1/kg], zero also where a wall constrains, along the local axes.
    inverse: Vec<f64>,
    /// Velocity changes by the walls that vertices rest on [m/s], along the local axes.
    pushes: Vec<f64>,
}

impl ActiveSet {
    /// Empties the set: only pinned coordinates are constrained, and all local axes are the global ones.
    pub fn reset(&mut self, size: usize, inverse_mass: &[f64]) {
        self.size = size;
        self.inverse.clear();
        self.inverse.extend_from_slice(inverse_mass);
        self.axes.clear();
        if size == 2 {
            self.axes.extend(Axis::WORLD.0.into_iter().cycle().take(inverse_mass.len()));
        }
    }

    /// 1/mass [1/kg], zero also where a wall constrains, along the local axes.
    pub fn inverse(&self) -> &[f64] {
        &self.inverse
    }

    /// Whether any wall constrains a vertex.
    pub fn is_any_active(&self, inverse_mass: &[f64]) -> bool {
        self.inverse != inverse_mass
    }

    /// Vertices that walls can constrain.
    fn vertices(&self) -> std::ops::Range<usize> {
        0..self.axes.len() / 2
    }

    fn axis(&self, vertex: usize) -> Axis {
        Axis(pair(&self.axes, vertex))
    }

    /// Which local coordinates of a vertex a wall constrains.
    fn constrained(&self, inverse_mass: &[f64], vertex: usize) -> [bool; 2] {
        [0, 1].map(|k| self.is_constrained(inverse_mass, 2 * vertex + k))
    }

    fn is_constrained(&self, inverse_mass: &[f64], number: usize) -> bool {
        self.inverse[number] == 0.0 && inverse_mass[number] != 0.0
    }

    /// Calls `act` with the first number of every vertex and its part of `local`, a vector along the local axes, turned to
    /// the global axes.
    #[inline]
    pub fn each(&self, local: &[f64], mut act: impl FnMut(usize, &[f64])) {
        for (vertex, local) in local.chunks_exact(self.size).enumerate() {
            match *local {
                [x, y] => act(2 * vertex, &self.axis(vertex).out_of_local([x, y])),
                _ => act(self.size * vertex, local),
            }
        }
    }

    /// Turns a flat vector to the local axes.
    pub fn to_local(&self, values: &mut [f64]) {
        for vertex in self.vertices() {
            put(values, vertex, self.axis(vertex).into_local(pair(values, vertex)));
        }
    }

    /// Turns a flat vector back to the global axes.
    pub fn to_global(&self, values: &mut [f64]) {
        for vertex in self.vertices() {
            put(values, vertex, self.axis(vertex).out_of_local(pair(values, vertex)));
        }
    }

    /// Turns a matrix to the local axes.
    pub fn matrix_to_local(&self, matrix: &mut dyn SparseMatrix) {
        if let Some(matrix) = matrix.blocks::<2>() {
            matrix.turn(&self.axes);
        }
    }

    /// Sets the chosen numbers of z, along the local axes, to a vector that is given along the global axes.
    pub fn assign(&self, z: &mut [f64], world: impl Fn(usize) -> f64, is_chosen: impl Fn(usize) -> bool) {
        for (vertex, z) in z.chunks_exact_mut(self.size).enumerate() {
            let first = self.size * vertex;
            if let [x, y] = z {
                let local = self.axis(vertex).into_local([world(first), world(first + 1)]);
                (*x, *y) =
                    (if is_chosen(first) { local[0] } else { *x }, if is_chosen(first + 1) { local[1] } else { *y });
            } else {
                let chosen = (first..).zip(z).filter(|(number, _)| is_chosen(*number));
                chosen.for_each(|(number, z)| *z = world(number));
            }
        }
    }

    /// Sets the end of a step to `reached` along the free axes, and leaves it along the constrained ones.
    pub fn set_free(&self, inverse_mass: &[f64], end: &mut [f64], reached: impl Fn(usize) -> f64) {
        for (vertex, end) in end.chunks_exact_mut(self.size).enumerate() {
            if let [x, y] = end {
                let (constrained, reached) =
                    (self.constrained(inverse_mass, vertex), [0, 1].map(|k| reached(2 * vertex + k)));
                [*x, *y] = self.axis(vertex).mix(constrained, [*x, *y], reached);
            } else {
                (self.size * vertex..).zip(end).for_each(|(number, end)| *end = reached(number));
            }
        }
    }

    /// Constrains every vertex whose position or velocity at the end of the step the contact projection has changed: along
    /// the normal of a single `smooth` wall, or in both coordinates. `z` are the accelerations, `end` the projected
    /// positions and velocities, `predicted` the velocities and then positions without walls. Returns whether any was
    /// added.
    pub fn add(&mut self, z: &mut [f64], end: [&[f64]; 2], predicted: &[f64], smooth: bool) -> bool {
        self.vertices().filter(|vertex| self.add_vertex(*vertex, z, (end, predicted), smooth)).count() > 0
    }

    fn add_vertex(
        &mut self,
        vertex: usize,
        z: &mut [f64],
        ([x, v], predicted): ([&[f64]; 2], &[f64]),
        smooth: bool,
    ) -> bool {
        let (x, v) = (pair(x, vertex), pair(v, vertex));
        let (predicted_v, predicted_x) = (pair(predicted, vertex), pair(&predicted[predicted.len() / 2..], vertex));
        let touched = [0, 1].map(|k| (x[k] != predicted_x[k] || v[k] != predicted_v[k]) && x[k].is_finite());
        let movable = [0, 1].map(|k| self.inverse[2 * vertex + k] != 0.0);
        let axis = self.axis(vertex);
        let mut added = [0, 1].map(|k| movable[k] && touched[k]);
        if !axis.is_world() {
            // Constrained along one normal already: only a change along the tangent adds a constraint.
            let pushed = |to: [f64; 2], from: [f64; 2]| {
                let change = difference(to, from);
                axis.into_local(change)[1].abs() > SAME * length(change) + ROUND_OFF * length(from)
            };
            added = [false, movable[1] && (pushed(x, predicted_x) || pushed(v, predicted_v))];
        } else if smooth
            && added == [true; 2]
            && let Some(normal) = direction([x, predicted_x], [v, predicted_v])
        {
            put(&mut self.axes, vertex, normal);
            put(z, vertex, Axis(normal).into_local(pair(z, vertex)));
            added = [true, false];
        }
        for k in (0..2).filter(|k| added[*k]) {
            self.inverse[2 * vertex + k] = 0.0;
        }
        added != [false; 2]
    }

    /// Adds the vertices that rest on a smooth wall: those that the wall keeps in place, at positions `x`, against the
    /// velocities that `predicted` begins with. `end` are positions and velocities with walls. Returns whether there are
    /// any.
    pub fn add_resting(
        &mut self,
        inverse_mass: &[f64],
        z: &mut [f64],
        x: &[f64],
        end: [&[f64]; 2],
        predicted: &[f64],
    ) -> bool {
        self.pushes.clear();
        self.pushes.resize(x.len(), 0.0);
        let mut rests = false;
        for vertex in self.vertices() {
            let [stopped, free] = [end[1], predicted].map(|v| pair(v, vertex));
            let stays = pair(end[0], vertex) == pair(x, vertex) && is_stopped(stopped, free);
            if !stays || !self.add_vertex(vertex, z, (end, predicted), true) {
                continue;
            }
            rests = true;
            let push = self.axis(vertex).into_local(difference(stopped, free));
            let constrained = self.constrained(inverse_mass, vertex);
            put(&mut self.pushes, vertex, [0, 1].map(|k| if constrained[k] { push[k] } else { 0.0 }));
        }
        rests
    }

    /// Sets the accelerations z so that `predicted_x + ax z` stays at the positions x where a wall constrains, and zero
    /// elsewhere.
    pub fn keep_resting(&self, inverse_mass: &[f64], (x, predicted_x, ax): (&[f64], &[f64], f64), z: &mut [f64]) {
        z.fill(0.0);
        self.assign(z, |number| x[number] - predicted_x[number], |number| self.is_constrained(inverse_mass, number));
        for z in z {
            *z /= ax;
        }
    }

    /// If the reaction `M z - f` of a wall that a vertex rests on pulls, drops all such constraints, and all that were
    /// added during the solve. `force` is overwritten.
    pub fn drop_pulling(
        &mut self,
        [mass, inverse_mass]: [&[f64]; 2],
        z: &mut [f64],
        force: &mut [f64],
    ) -> ActiveSetStatus {
        self.to_local(force);
        for (((force, mass), z), push) in force.iter_mut().zip(mass).zip(&*z).zip(&self.pushes) {
            *force = if *push == 0.0 { 0.0 } else { (mass * z - *force) * push.signum() };
        }
        let most = force.iter().copied().fold(0.0, f64::max);
        let pulls = |reaction: f64| reaction.is_nan() || reaction < -REACTION_TOLERANCE * most;
        let is_unclear = |vertex| {
            // With two oblique walls the reaction of each cannot be determined.
            !self.axis(vertex).is_world()
                && self.constrained(inverse_mass, vertex) == [true; 2]
                && pair(&self.pushes, vertex) != [0.0; 2]
        };
        if self.vertices().any(is_unclear) {
            return ActiveSetStatus::Abandoned;
        }
        if !force.iter().copied().any(pulls) {
            return ActiveSetStatus::Accepted;
        }
        for vertex in self.vertices() {
            let (constrained, reaction) = (self.constrained(inverse_mass, vertex), pair(force, vertex));
            let push = pair(&self.pushes, vertex);
            let dropped = [0, 1].map(|k| constrained[k] && (push[k] == 0.0 || pulls(reaction[k])));
            if dropped == [false; 2] {
                continue;
            }
            put(z, vertex, self.axis(vertex).out_of_local(pair(z, vertex)));
            put(&mut self.axes, vertex, Axis::WORLD.0);
            for k in (0..2).filter(|k| dropped[*k]) {
                self.inverse[2 * vertex + k] = inverse_mass[2 * vertex + k];
                self.pushes[2 * vertex + k] = 0.0;
            }
        }
        ActiveSetStatus::Changed
    }

    /// Work of walls in a step \[J\], without what they dissipate: the greater of the work of the reaction `M z - f` along
    /// the displacement, and of the impulse `M (v' - v) - h f` at the end velocity v'. Positions and velocities of an impact do
    /// not agree, and a wall may stop in the step. All along the local axes.
    pub fn work_of_reactions(
        &self,
        [mass, inverse_mass]: [&[f64]; 2],
        [z, force, displacement]: [&[f64]; 3],
        [impulse, velocity]: [&[f64]; 2],
    ) -> f64 {
        let work = |number: usize| {
            let reaction = mass[number] * z[number] - force[number];
            (reaction * displacement[number]).max(impulse[number] * velocity[number]).max(0.0)
        };
        (0..z.len()).filter(|number| self.is_constrained(inverse_mass, *number)).map(work).sum()
    }

    /// Marks the constrained coordinates as touched in `before`, the velocities and then positions without walls.
    pub fn mark(&self, inverse_mass: &[f64], before: &mut [f64]) {
        for number in (0..self.inverse.len()).filter(|number| self.is_constrained(inverse_mass, *number)) {
            // NaN is equal to nothing, so that the number counts as touched.
            before[number] = f64::NAN;
        }
    }

    /// Along which local axes of a vertex walls acted in a step, after [`Self::mark`].
    fn touched(&self, [x, v]: [&[f64]; 2], before: &[f64], vertex: usize) -> [bool; 2] {
        let is_world = self.axis(vertex).is_world();
        [0, 1]
            .map(|k| 2 * vertex + k)
            .map(|number| if is_world { is_touched([x, v], before, number) } else { before[number].is_nan() })
    }

    /// Whether walls acted on any vertex in a step, after [`Self::mark`].
    pub fn acted(&self, end: [&[f64]; 2], before: &[f64]) -> bool {
        self.vertices().any(|vertex| self.touched(end, before, vertex) != [false; 2])
    }

    /// Replaces the positions and then velocities of one step before, where walls acted, by those of uniform motion with
    /// the velocity at the end of the step of length h \[s\].
    pub fn set_uniform_motion(&self, [x, v]: [&[f64]; 2], before: &[f64], h: f64, past: &mut [f64]) {
        let (past_x, past_v) = past.split_at_mut(x.len());
        for vertex in self.vertices() {
            let (axis, touched) = (self.axis(vertex), self.touched([x, v], before, vertex));
            let (x, v) = (pair(x, vertex), pair(v, vertex));
            let previous_x = [0, 1].map(|k| x[k] - h * v[k]);
            put(past_x, vertex, axis.mix(touched, previous_x, pair(past_x, vertex)));
            put(past_v, vertex, axis.mix(touched, v, pair(past_v, vertex)));
        }
    }

    /// Sets the accelerations z for the next solve: where a wall constrains, so that `predicted_x + ax z` is the `end` of
    /// the step, and elsewhere at the first touch of a wall on the way from `origin` to `predicted`, if there is one.
    pub fn start_again(
        &self,
        inverse_mass: &[f64],
        [origin, end, predicted]: [&[f64]; 3],
        (predicted_x, ax): (&[f64], f64),
        z: &mut [f64],
    ) {
        if let Some(share) = self.first_touch(origin, end, predicted) {
            let there = |number: usize| origin[number] + share * (predicted[number] - origin[number]);
            let is_free = |number: usize| inverse_mass[number] != 0.0 && !self.is_constrained(inverse_mass, number);
            self.assign(z, |number| (there(number) - predicted_x[number]) / ax, is_free);
        }
        let is_constrained = |number| self.is_constrained(inverse_mass, number);
        self.assign(z, |number| (end[number] - predicted_x[number]) / ax, is_constrained);
    }

    /// Fraction of the displacements from `origin` to `predicted` after which the first vertex reaches a wall, if
    /// positive: the positions there are a start for Newton's method without penetration.
    fn first_touch(&self, origin: &[f64], end: &[f64], predicted: &[f64]) -> Option<f64> {
        let stopped = self.vertices().filter(|vertex| pair(end, *vertex) != pair(predicted, *vertex));
        let shares = stopped.map(|vertex| {
            let [origin, end, predicted] = [origin, end, predicted].map(|values| pair(values, vertex));
            let across = difference(predicted, end);
            dot(difference(end, origin), across) / dot(difference(predicted, origin), across)
        });
        shares.filter(|share| *share > LEAST_FRACTION && *share < 1.0).min_by(f64::total_cmp)
    }
}

/// Whether the contact projection changed a coordinate of the positions or velocities at the end of a step. `before` are
/// the velocities and then positions without walls.
pub fn is_touched([x, v]: [&[f64]; 2], before: &[f64], number: usize) -> bool {
    v[number] != before[number] || x[number] != before[x.len() + number]
}

/// The first local axis of a vertex, a unit vector; the second is rotated by 90°.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Axis([f64; 2]);

impl Axis {
    /// The global axes.
    const WORLD: Self = Self([1.0, 0.0]);

    /// Whether they are the global axes.
    fn is_world(self) -> bool {
        self == Self::WORLD
    }

    /// Components of a vector along the local axes.
    fn into_local(self, [x, y]: [f64; 2]) -> [f64; 2] {
        let Self([c, s]) = self;
        if self.is_world() { [x, y] } else { [c * x + s * y, c * y - s * x] }
    }

    /// Inverse of [`Self::into_local`].
    fn out_of_local(self, [x, y]: [f64; 2]) -> [f64; 2] {
        let Self([c, s]) = self;
        if self.is_world() { [x, y] } else { [c * x - s * y, s * x + c * y] }
    }

    /// `one` along the constrained axes, `other` along the free ones.
    fn mix(self, constrained: [bool; 2], one: [f64; 2], other: [f64; 2]) -> [f64; 2] {
        match constrained {
            [true, true] => one,
            [false, false] => other,
            _ => {
                let (one, other) = (self.into_local(one), self.into_local(other));
                self.out_of_local([0, 1].map(|k| if constrained[k] { one[k] } else { other[k] }))
            }
        }
    }
}

/// The two coordinates of a vertex.
fn pair(values: &[f64], vertex: usize) -> [f64; 2] {
    [values[2 * vertex], values[2 * vertex + 1]]
}

fn put(values: &mut [f64], vertex: usize, value: [f64; 2]) {
    values[2 * vertex..][..2].copy_from_slice(&value);
}

fn difference(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn length(a: [f64; 2]) -> f64 {
    dot(a, a).sqrt()
}

/// Whether a velocity change leaves no normal component: an impact with restitution leaves some, and so do most edge
/// contacts.
fn is_stopped(end: [f64; 2], predicted: [f64; 2]) -> bool {
    let change = difference(end, predicted);
    dot(end, change).abs() <= STOPPED * dot(change, change)
}

/// The common direction of the changes of position and velocity, each given as after and before; `None` if they differ
/// or are round-off.
fn direction([x, predicted_x]: [[f64; 2]; 2], [v, predicted_v]: [[f64; 2]; 2]) -> Option<[f64; 2]> {
    let unit_if_significant = |to: [f64; 2], from: [f64; 2]| {
        let (change, size) = (difference(to, from), length(difference(to, from)));
        (size > 1e3 * ROUND_OFF * length(from)).then(|| change.map(|change| change / size))
    };
    match (unit_if_significant(v, predicted_v), unit_if_significant(x, predicted_x)) {
        (Some(one), Some(other)) => ((one[0] * other[1] - one[1] * other[0]).abs() < SAME).then_some(one),
        (one, other) => one.or(other),
    }
}

//! A scene, or a toy, as a system for integrators, with the scratch and the statistics of its steps.

use super::contacts::{Contacts, contacts, surface_contact};
use crate::clock::Instant;
use crate::{
    contact::ContactProperties,
    effects::{Bounds, Effect, Grab, Motion, NO_OBSTACLE_NEAR},
    elements::{EulerUpdate, MassSolver, UniformForce, reserve_scratch},
    integrators::{Class, Dynamics, MeanForces, Ode, Workspace, symplectic_euler_update},
    report::{Counts, EffectCost},
    scene::Scene,
    solvers::{ConstraintRows, SparseMatrix, Weights},
    state::State,
    toys::Toy,
};
use std::sync::Arc;

/// Reason for skipping elements of sleeping bodies.
pub(super) const ASLEEP: &str = "asleep";

/// Reason for skipping an effect that only sets properties of contacts: it has no force of its own.
const PART_OF_CONTACT: &str = "part of contact";

/// Numbers of the effects of a scene, by their role in a step.
#[derive(Default)]
pub(super) struct Plan {
    /// Elements of awake bodies and nets.
    pub elements: Vec<usize>,
    /// Other forces.
    pub forces: Vec<usize>,
    /// Contacts with obstacles; those by a potential are forces as well.
    pub obstacles: Vec<usize>,
    /// Projections of positions.
    pub projections: Vec<usize>,
    /// Exact constraints, whose reactions come after all forces.
    pub constraints: Vec<usize>,
    /// Whether any vertices have prescribed positions.
    pub holds: bool,
    /// Effects that only set properties of contacts.
    pub properties: Vec<usize>,
    /// Elements of sleeping bodies and nets, which are skipped.
    pub sleeping: Vec<usize>,
    /// Whether any contact has a potential.
    pub has_potential: bool,
    /// Number of triangles of bodies which a step computes.
    pub triangles: usize,
    /// Sleeping regions of bodies.
    pub still: Vec<usize>,
}

impl Plan {
    /// Makes the plan of a scene with these effects; `asleep` tells which of its elements, the first effects, sleep, and `still` which regions.
    fn new(scene: &Scene, effects: &[Arc<dyn Effect>], asleep: impl Iterator<Item = bool>, still: &[usize]) -> Self {
        let mut plan = Self { still: still.to_vec(), ..Self::default() };
        let asleep = asleep.chain(std::iter::repeat(false));
        for ((number, effect), asleep) in effects.iter().enumerate().zip(asleep) {
            let mut properties = ContactProperties::default();
            effect.set_properties(&mut properties);
            if asleep {
                plan.sleeping.push(number);
                continue;
            }
            if number < scene.bodies.len() {
                plan.triangles += effect.elements(Motion::NONE);
            }
            let has_potential = effect.contact().is_some();
            plan.has_potential |= has_potential;
            if effect.obstacle_contact().is_some() {
                plan.obstacles.push(number);
            }
            if effect.projection().is_some() {
                plan.projections.push(number);
            } else if effect.constraints().is_some() {
                plan.constraints.push(number);
            } else if effect.held_vertices().is_some() {
                plan.holds = true;
            } else if number < scene.element_count() {
                plan.elements.push(number);
            } else if has_potential || effect.obstacle_contact().is_none() && properties == ContactProperties::default()
            {
                plan.forces.push(number);
            } else if effect.obstacle_contact().is_none() {
                plan.properties.push(number);
            }
        }
        plan
    }
}

/// Everything that stepping writes beside the state.
#[derive(Default)]
pub(super) struct Scratch {
    /// Buffers of the integrator.
    pub workspace: Workspace,
    /// Scratch of the effects.
    pub effects: Vec<f64>,
    /// Work of moving and of penetrated obstacles in this step \[J\].
    pub supplied: f64,
    /// Whether an initial penetration decreased in this step.
    pub pushes_out: bool,
    /// Anchors of friction between steps.
    pub contacts: Contacts,
    pub plan: Plan,
    /// 1/mass [1/kg] with zero for sleeping vertices; empty while nothing sleeps.
    pub masked_inverse_mass: Vec<f64>,
    /// Box in which nothing touches an obstacle, while all vertices stay in it.
    pub clear_box: Option<Bounds>,
    /// Least distance that a vertex can still move before positions are checked again; negative if unknown \[m\].
    pub displacement_bound: f64,
    /// Kinetic energy after the step \[J\], if the step computed it.
    pub kinetic: Option<f64>,
    /// Least mass of a free coordinate \[kg\].
    pub lightest: f64,
    pub counts: Counts,
    pub costs: Vec<EffectCost>,
    /// Whether time and heat of effects are measured.
    pub measured: bool,
    /// Powers at the end, in the middle and at the start of an inner step \[W\]: that of moving obstacles, then that which each effect dissipates.
    pub powers: [Vec<f64>; 3],
    /// Energy that friction of each effect stores at the end and at the start of an inner step \[J\].
    pub stored: [Vec<f64>; 2],
    /// Forces of one effect \[N\].
    pub forces: Vec<f64>,
    /// Positions and velocities with those of held vertices.
    pub placed: Vec<f64>,
    /// Rows of the constraints.
    pub rows: ConstraintRows,
    /// Solver with the mass matrix of the scene, for explicit schemes.
    pub mass_solver: MassSolver,
}

impl Scratch {
    pub fn fit(&mut self, scene: &Scene) {
        self.workspace.forget();
        // Pairs are of the surfaces of the old scene.
        self.contacts = Contacts::default();
        reserve_scratch(&mut self.effects, scene.scratch());
        self.set_sleeping(scene, &scene.effects, std::iter::empty(), &[]);
        (self.clear_box, self.displacement_bound) = (None, -1.0);
        self.mass_solver.fit(scene.dimension, &scene.coupled_mass, [&scene.mass, &scene.inverse_mass]);
        let movable = scene.mass.iter().zip(&scene.inverse_mass).filter(|(_, inverse)| **inverse != 0.0);
        self.lightest = movable.map(|(mass, _)| *mass).fold(f64::INFINITY, f64::min);
        let named = || scene.effects.iter().map(|effect| effect.name()).zip(scene.auto.iter().copied());
        if !self.costs.iter().map(|cost| cost.name).eq(named().map(|(name, _)| name)) {
            self.costs = named().map(|(name, auto)| EffectCost::none(name, auto)).collect();
        }
        for (cost, (_, auto)) in self.costs.iter_mut().zip(named()) {
            (cost.auto, cost.idle) = (auto, None);
        }
    }

    /// Sets which bodies and nets, and which regions of bodies sleep, and the effects that act; the vertices are not constrained yet.
    pub fn set_sleeping(
        &mut self,
        scene: &Scene,
        effects: &[Arc<dyn Effect>],
        asleep: impl Iterator<Item = bool>,
        still: &[usize],
    ) {
        let plan = Plan::new(scene, effects, asleep, still);
        if plan.sleeping != self.plan.sleeping || plan.still != self.plan.still {
            // The sparsity pattern changes.
            self.workspace.forget();
        }
        self.plan = plan;
        reserve_scratch(&mut self.effects, effects.iter().map(|effect| effect.scratch()).max().unwrap_or(0));
        self.masked_inverse_mass.clear();
        if !self.plan.sleeping.is_empty() || !still.is_empty() {
            self.masked_inverse_mass.extend_from_slice(&scene.inverse_mass);
        }
    }

    /// Constrains what sleeps, whose numbers in the state these are.
    pub fn constrain_sleeping(&mut self, numbers: impl Iterator<Item = usize>) {
        for number in numbers {
            self.masked_inverse_mass[number] = 0.0;
        }
    }

    /// Reduces the displacement bound by the greatest displacement in a step of length h \[s\]: that of the lightest
    /// vertex with all kinetic energy, enlarged for round-off. Negative if the energy is unknown.
    pub fn reduce_displacement_bound(&mut self, h: f64) {
        let speed = (2.0 * self.kinetic.unwrap_or(f64::NAN) / self.lightest).sqrt();
        self.displacement_bound =
            if speed <= State::LIMIT { self.displacement_bound - 1.000_001 * h * speed } else { -1.0 };
    }

    /// The uniform force, if no other force acts beside the elements, all elements have an Euler update, and effects are not
    /// measured.
    pub fn uniform_force(
        &self,
        (scene, effects): (&Scene, &[Arc<dyn Effect>]),
        motion: Motion<'_>,
    ) -> Option<UniformForce> {
        let are_plain = self.plan.elements.iter().all(|number| effects[*number].has_euler_update());
        if !are_plain || !self.plan.constraints.is_empty() || !scene.coupled_mass.is_empty() {
            return None;
        }
        let acts = |number: &&usize| !self.costs[**number].auto || effects[**number].idle(motion).is_none();
        // Those of contact are added afterwards.
        let forces = self.plan.forces.iter().filter(|number| effects[**number].contact().is_none());
        let mut acting = forces.filter(acts).map(|number| effects[*number].uniform_force());
        let all = acting.try_fold(UniformForce::default(), |all, next| all.and(next?));
        all.filter(|_| !self.measured)
    }

    /// Runs one effect and adds its time and, if it is a separate call, its elements to the statistics.
    pub(super) fn call_effect<T>(
        &mut self,
        number: usize,
        elements: Option<usize>,
        run: impl FnOnce(&mut [f64]) -> T,
    ) -> T {
        let start = self.measured.then(Instant::now);
        let result = run(&mut self.effects);
        let cost = &mut self.costs[number];
        if let Some(start) = start {
            cost.time += start.elapsed();
        }
        if let Some(elements) = elements {
            cost.call(elements);
        }
        result
    }

    /// Records that contacts with obstacles by a filter were skipped.
    pub fn pass_over_obstacles(&mut self) {
        for number in self.plan.obstacles.iter().filter(|_| !self.plan.has_potential) {
            self.costs[*number].pass_over(NO_OBSTACLE_NEAR);
        }
    }
}

/// A scene with scratch, pull and time of a step.
pub(super) struct System<'a> {
    pub scene: &'a Scene,
    /// The effects that act: those of the scene, or what sleep leaves of them.
    pub effects: &'a [Arc<dyn Effect>],
    pub scratch: &'a mut Scratch,
    pub grab: Option<Grab>,
    /// Simulated time at the start and at the end of the step \[s\].
    pub time: [f64; 2],
    /// Contacts between steps.
    pub contacts: Contacts,
    /// Whether every inner step was truncated already.
    pub(super) is_truncated: bool,
}

impl<'a> System<'a> {
    /// A scene with the effects that act, in a state whose anchors it takes until [`Self::end`].
    pub fn begin(
        (scene, effects): (&'a Scene, &'a [Arc<dyn Effect>]),
        scratch: &'a mut Scratch,
        grab: Option<Grab>,
        time: [f64; 2],
        state: &mut State,
    ) -> Self {
        let mut taken = std::mem::take(&mut scratch.contacts);
        std::mem::swap(&mut taken.anchors, &mut state.anchors);
        let mut system = Self { scene, effects, scratch, grab, time, contacts: taken, is_truncated: false };
        system.place_held(time[0], &mut state.x, &mut state.v);
        system.contacts.update(scene, &state.x);
        if scene.integrator.kind().class() == Class::Implicit {
            system.contacts.begin_pattern(scene, &state.x);
        }
        system.begin_work(&state.x, &state.v);
        system
    }

    /// Ends the step of length h \[s\] and returns the anchors to the state.
    pub fn end(mut self, h: f64, state: &mut State) {
        self.end_step(h, &state.x, &state.v);
        std::mem::swap(&mut self.contacts.anchors, &mut state.anchors);
        self.scratch.contacts = self.contacts;
    }

    /// A motion with the times over which forces are means.
    pub(super) fn over_step<'m>(&self, motion: Motion<'m>) -> Motion<'m> {
        let ([start, end], means) = (self.time, self.scene.integrator.kind().mean_forces());
        let span_of = |forces| if means >= forces { end - start } else { 0.0 };
        Motion { span: span_of(MeanForces::Contact), elastic_span: span_of(MeanForces::All), ..motion }
    }

    /// A motion at a time since the start of the step \[s\].
    pub(super) fn motion<'m>(&'m self, time: f64, x: &'m [f64], v: &'m [f64]) -> Motion<'m> {
        let time = self.time[0] + time;
        Motion { inverse_mass: self.inverse_mass(), ..motion(self.scene, &self.contacts, self.grab, time, [x, v]) }
    }
}

/// A motion of a scene at a time \[s\], at positions and velocities.
fn motion<'m>(
    scene: &'m Scene,
    contacts: &'m Contacts,
    grab: Option<Grab>,
    time: f64,
    [x, v]: [&'m [f64]; 2],
) -> Motion<'m> {
    let Contacts { anchors, candidates, pattern, .. } = contacts;
    Motion {
        dimension: scene.dimension,
        x,
        v,
        mass: &scene.mass,
        inverse_mass: &scene.inverse_mass,
        grab,
        time,
        anchors,
        candidates: Some(candidates),
        pattern,
        span: 0.0,
        elastic_span: 0.0,
        lag: 0.0,
    }
}

/// Effects without the elements of sleeping bodies.
fn awake<'a>(effects: &'a [Arc<dyn Effect>], plan: &Plan) -> impl Iterator<Item = &'a dyn Effect> {
    let acts = |(number, effect): (usize, &'a Arc<dyn Effect>)| (!plan.sleeping.contains(&number)).then_some(&**effect);
    effects.iter().enumerate().filter_map(acts)
}

impl System<'_> {
    /// Updates the statistics of a step in which elements update the vertices themselves.
    pub fn count_euler_update(&mut self, x: &[f64], v: &[f64]) {
        let motion = motion(self.scene, &self.contacts, self.grab, self.time[0], [x, v]);
        let Scratch { plan, costs, counts, .. } = &mut *self.scratch;
        counts.force_evaluations += 1;
        for number in &plan.sleeping {
            costs[*number].pass_over(ASLEEP);
        }
        for number in plan.elements.iter().chain(&plan.forces) {
            let (effect, cost) = (&self.effects[*number], &mut costs[*number]);
            if effect.contact().is_some() {
                continue;
            }
            match effect.idle(motion).filter(|_| cost.auto) {
                Some(why) => cost.pass_over(why),
                None => cost.call(effect.elements(motion)),
            }
        }
    }
}

impl System<'_> {
    /// Writes the forces \[N\], with or without those of contact.
    fn forces(&mut self, with_contact: bool, time: f64, x: &[f64], v: &[f64], force: &mut [f64]) {
        let scene = self.scene;
        self.contacts.update(scene, x);
        let motion = self.over_step(motion(scene, &self.contacts, self.grab, self.time[0] + time, [x, v]));
        self.scratch.counts.force_evaluations += 1;
        force.fill(0.0);
        for number in &self.scratch.plan.sleeping {
            self.scratch.costs[*number].pass_over(ASLEEP);
        }
        let Plan { elements, forces, .. } = &self.scratch.plan;
        let count = [elements.len(), elements.len() + forces.len()];
        for turn in 0..count[1] {
            let Plan { elements, forces, .. } = &self.scratch.plan;
            let number = if turn < count[0] { elements[turn] } else { forces[turn - count[0]] };
            let (effect, cost) = (&self.effects[number], &mut self.scratch.costs[number]);
            if !with_contact && effect.contact().is_some() {
                continue;
            }
            if cost.auto
                && let Some(why) = effect.idle(motion)
            {
                cost.pass_over(why);
                continue;
            }
            let (size, elements) = (effect.scratch(), Some(effect.elements(motion)));
            self.scratch.call_effect(number, elements, |scratch| effect.force(motion, &mut scratch[..size], force));
        }
        if !self.scratch.plan.constraints.is_empty() {
            let mut rows = self.rows(true, time, x, v);
            rows.add_reactions(self.inverse_mass(), force);
            self.scratch.rows = rows;
        }
        if !scene.coupled_mass.is_empty() && scene.integrator.kind().class() != Class::Implicit {
            let mut solver = std::mem::take(&mut self.scratch.mass_solver);
            solver.accelerate([self.mass(), self.inverse_mass()], force);
            self.scratch.mass_solver = solver;
        }
    }

    /// Takes the rows of all constraints at a time since the start of the step \[s\]; those for forces are counted as calls.
    pub(super) fn rows(&mut self, for_forces: bool, time: f64, x: &[f64], v: &[f64]) -> ConstraintRows {
        let mut rows = std::mem::take(&mut self.scratch.rows);
        rows.clear();
        for turn in 0..self.scratch.plan.constraints.len() {
            let number = self.scratch.plan.constraints[turn];
            let effect = &self.scene.effects[number];
            let Some(term) = effect.constraints() else { continue };
            let motion = motion(self.scene, &self.contacts, self.grab, self.time[0] + time, [x, v]);
            let elements = for_forces.then(|| effect.elements(motion));
            self.scratch.call_effect(number, elements, |_| term.add_rows(motion, &mut rows));
        }
        if self.scratch.plan.holds {
            self.scene.accelerate_held(self.time[0] + time, &mut rows);
        }
        rows
    }

    /// Finds the forces of contact at the start of a step, for [`Self::add_contact_forces`].
    fn find_contact_forces(&mut self, x: &[f64], v: &[f64]) {
        if !self.scratch.plan.has_potential {
            return;
        }
        self.contacts.update(self.scene, x);
        let mut found = std::mem::take(&mut self.contacts.forces);
        found.clear();
        for turn in 0..self.scratch.plan.forces.len() {
            let number = self.scratch.plan.forces[turn];
            let Some(contact) = self.scene.effects[number].contact() else { continue };
            let motion = self.motion(0.0, x, v);
            let is_clear = self.scratch.clear_box.is_some() && self.scene.effects[number].obstacle_contact().is_some();
            let idle = if is_clear { Some(NO_OBSTACLE_NEAR) } else { contact.idle(motion) };
            let idle = idle.filter(|_| self.scratch.costs[number].auto);
            let elements = self.scene.effects[number].elements(motion);
            if let Some(why) = idle {
                self.scratch.costs[number].pass_over(why);
                continue;
            }
            let start = self.scratch.measured.then(Instant::now);
            contact.each_number(motion, &mut |number, force| found.push((number, force)));
            let cost = &mut self.scratch.costs[number];
            cost.time += start.map_or(std::time::Duration::ZERO, |start| start.elapsed());
            cost.call(elements);
        }
        self.contacts.forces = found;
    }

    /// Adds the forces of contact to a step of symplectic Euler of length h \[s\] after it was taken with the others. Few
    /// vertices touch, and the step of all of them stays as it is.
    fn add_contact_forces(&mut self, x: &mut [f64], v: &mut [f64], h: f64) {
        let (mut kinetic, inverse_mass) = (0.0, self.inverse_mass());
        for (number, force) in &self.contacts.forces {
            let change = h * force * inverse_mass[*number];
            kinetic += 0.5 * self.scene.mass[*number] * change * (2.0 * v[*number] + change);
            v[*number] += change;
            x[*number] += h * change;
        }
        if let Some(all) = &mut self.scratch.kinetic {
            *all += kinetic;
        }
    }
}

impl System<'_> {
    /// Writes the positions and velocities of held vertices at a time \[s\].
    fn place_held(&self, time: f64, x: &mut [f64], v: &mut [f64]) {
        if self.scratch.plan.holds {
            self.scene.place_held(time, x, v);
        }
    }

    /// Adds moving pins to the statistics of a step.
    fn count_held(&mut self) {
        for (effect, cost) in self.scene.effects.iter().zip(&mut self.scratch.costs).filter(|_| self.scratch.plan.holds)
        {
            if let Some(held) = effect.held_vertices() {
                cost.call(held.vertices().len());
            }
        }
    }

    /// Calls `act` with the positions and velocities of a stage at a time since the start of the step \[s\], in which held vertices are where
    /// they must be at that time. Schemes leave pinned vertices where they were.
    fn with_held<T>(&mut self, time: f64, x: &[f64], v: &[f64], act: impl FnOnce(&mut Self, &[f64], &[f64]) -> T) -> T {
        if !self.scratch.plan.holds {
            return act(self, x, v);
        }
        let mut placed = std::mem::take(&mut self.scratch.placed);
        placed.clear();
        placed.extend_from_slice(x);
        placed.extend_from_slice(v);
        let (x, v) = placed.split_at_mut(x.len());
        self.place_held(self.time[0] + time, x, v);
        let result = act(self, x, v);
        self.scratch.placed = placed;
        result
    }
}

impl Dynamics for System<'_> {
    fn force(&mut self, time: f64, x: &[f64], v: &[f64], force: &mut [f64]) {
        self.with_held(time, x, v, |system, x, v| system.forces(true, time, x, v, force));
    }

    /// Hash of the pull of the mouse, and of the sleeping bodies, nets and regions, whose elements are skipped.
    fn load_fingerprint(&self) -> u32 {
        let grab = self.grab.map(|Grab { vertex, target: [x, y, _] }| [vertex as u64 + 1, x.to_bits(), y.to_bits()]);
        let third = self.grab.filter(|_| self.scene.dimension > 2).map(|grab| grab.target[2].to_bits());
        let Plan { sleeping, still, .. } = &self.scratch.plan;
        let parts = sleeping.iter().map(|number| *number as u64 + 1);
        let sleeping = parts.chain(still.iter().map(|region| !(*region as u64)));
        let mix = |hash: u64, number: u64| (hash ^ number).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
        let hash = grab.unwrap_or_default().into_iter().chain(third).chain(sleeping).fold(0, mix);
        (hash >> 32) as u32 ^ hash as u32
    }

    /// If only elements and uniform forces act, the vertices are updated during force assembly.
    fn symplectic_euler_update(&mut self, x: &mut [f64], v: &mut [f64], force: &mut [f64], h: f64) {
        if self.is_constrained() || !self.scene.coupled_mass.is_empty() {
            // Reactions, and neighbours by the mass matrix, answer to the forces of contact too.
            self.forces(true, 0.0, x, v, force);
            return symplectic_euler_update(x, v, force, self.inverse_mass(), h);
        }
        self.find_contact_forces(x, v);
        let Some(uniform_force) = self.scratch.uniform_force((self.scene, self.effects), self.motion(0.0, x, v)) else {
            self.forces(false, 0.0, x, v, force);
            symplectic_euler_update(x, v, force, self.inverse_mass(), h);
            return self.add_contact_forces(x, v, h);
        };
        self.count_euler_update(x, v);
        let scene = self.scene;
        let Scratch { plan, masked_inverse_mass, effects, .. } = &mut *self.scratch;
        let inverse_mass = if masked_inverse_mass.is_empty() { &scene.inverse_mass } else { &*masked_inverse_mass };
        let mut vertices =
            EulerUpdate { x, v, mass: &scene.mass, inverse_mass, uniform_force, step: h, twice_kinetic: 0.0 };
        for number in &plan.elements {
            self.effects[*number].euler_update(&mut vertices, effects);
        }
        self.scratch.kinetic = Some(0.5 * vertices.twice_kinetic);
        self.add_contact_forces(x, v, h);
    }

    fn mass(&self) -> &[f64] {
        &self.scene.mass
    }

    fn inverse_mass(&self) -> &[f64] {
        if self.scratch.masked_inverse_mass.is_empty() {
            &self.scene.inverse_mass
        } else {
            &self.scratch.masked_inverse_mass
        }
    }

    fn add_coupled_mass(&self, z: &[f64], product: &mut [f64]) {
        if !self.scene.coupled_mass.is_empty() {
            self.scene.coupled_mass.add_product(self.scene.dimension, z, product);
            let fixed = |(_, inverse): &(&mut f64, &f64)| **inverse == 0.0;
            product.iter_mut().zip(self.inverse_mass()).filter(fixed).for_each(|(product, _)| *product = 0.0);
        }
    }

    fn add_mass(&self, matrix: &mut dyn SparseMatrix) {
        matrix.add_to_diagonal(&|number| self.scene.mass[number]);
        self.scene.coupled_mass.add_to(self.scene.dimension, matrix);
    }

    fn stiffness_times(&mut self, time: f64, x: &[f64], v: &[f64], d: &[f64], product: &mut [f64]) {
        self.with_held(time, x, v, |system, x, v| {
            let scene = system.scene;
            system.contacts.update(scene, x);
            let Motion { span, elastic_span, .. } = system.over_step(Motion::NONE);
            let Scratch { plan, masked_inverse_mass, effects, .. } = &mut *system.scratch;
            let inverse_mass = if masked_inverse_mass.is_empty() { &scene.inverse_mass } else { &*masked_inverse_mass };
            let motion = motion(scene, &system.contacts, system.grab, system.time[0] + time, [x, v]);
            let motion = Motion { inverse_mass, span, elastic_span, ..motion };
            for effect in awake(system.effects, plan) {
                effect.stiffness_times(motion, d, &mut effects[..effect.scratch()], product);
            }
        });
    }

    fn block_size(&self) -> usize {
        self.scene.dimension
    }

    fn sparsity_pattern(&self, add: &mut dyn FnMut(u32, u32)) {
        for effect in awake(self.effects, &self.scratch.plan) {
            effect.sparsity_pattern(add);
            if let Some(contact) = effect.contact() {
                contact.sparsity_pattern(&self.contacts.pattern, add);
            }
        }
        self.scene.coupled_mass.edges().iter().for_each(|[a, b]| add(*a, *b));
    }

    fn pattern_changes(&mut self, x: &[f64]) -> bool {
        self.contacts.update(self.scene, x);
        self.contacts.extend_pattern(self.scene, x)
    }

    fn add_stiffness(&mut self, time: f64, x: &[f64], v: &[f64], weights: Weights, matrix: &mut dyn SparseMatrix) {
        self.with_held(time, x, v, |system, x, v| {
            let motion = system.over_step(system.motion(time, x, v));
            for effect in awake(system.effects, &system.scratch.plan) {
                effect.add_stiffness(motion, weights, matrix);
            }
        });
    }

    fn is_constrained(&self) -> bool {
        !self.scratch.plan.constraints.is_empty()
    }

    fn correct_step(
        &mut self,
        time: f64,
        [x, v]: [&[f64]; 2],
        weights: [f64; 2],
        (z, step): (&[f64], &mut [f64]),
        invert: &mut dyn FnMut(&mut [f64]),
    ) {
        self.with_held(time, x, v, |system, x, v| {
            let mut rows = system.rows(false, time, x, v);
            rows.correct(weights, system.inverse_mass(), z, step, invert);
            system.scratch.rows = rows;
        });
    }

    fn has_derivative(&self) -> bool {
        self.scene.integrator.kind().mean_forces() != MeanForces::All
    }

    fn longest_step(&mut self, x: &[f64], d: &[f64]) -> f64 {
        let apart = self.contacts.longest_step(self.scene, x, d).min(self.longest_step_to_solids(x, d));
        awake(self.effects, &self.scratch.plan).map(|effect| effect.longest_step(x, d)).fold(apart, f64::min)
    }

    fn constrains(&self) -> bool {
        let Plan { obstacles, projections, holds, .. } = &self.scratch.plan;
        let is_plain = obstacles.is_empty() && projections.is_empty() && !holds;
        !is_plain || surface_contact(self.scene).is_some()
    }

    fn touches(&mut self, time: f64, x: &[f64], v: &[f64]) -> bool {
        self.contacts.update(self.scene, x);
        let motion = self.motion(time, x, v);
        contacts(self.scene).any(|contact| contact.touches(motion))
    }

    fn end_step(&mut self, time: f64, x: &[f64], v: &[f64]) {
        self.contacts.update(self.scene, x);
        let before = self.contacts.power_time;
        self.add_work(time, x, v);
        let mut next = self.contacts.take_next();
        let clear = self.scratch.clear_box.is_some();
        let eased = Contacts::next_anchors(self.scene, self.motion(time, x, v), time - before, clear, &mut next);
        next.sort_unstable_by_key(|anchor| anchor.contact);
        self.scratch.supplied += eased;
        self.scratch.pushes_out |= eased != 0.0;
        self.contacts.set_anchors(next);
        for number in &self.scratch.plan.properties {
            let cost = &mut self.scratch.costs[*number];
            if cost.auto { cost.pass_over(PART_OF_CONTACT) } else { cost.call(0) }
        }
    }

    fn constrain(&mut self, before: &[f64], x: &mut [f64], v: &mut [f64]) -> bool {
        self.place_held(self.time[1], x, v);
        self.count_held();
        // What may never cross comes last.
        let projects_first = self.scratch.plan.has_potential;
        let mut changed = projects_first && self.project(before, x, v);
        changed |= !self.is_truncated && self.keep_apart(before, x, v);
        changed | (!projects_first && self.project(before, x, v))
    }

    fn truncate(&mut self, time: f64, before: &[f64], x: &mut [f64], v: &mut [f64]) -> bool {
        self.place_held(self.time[0] + time, x, v);
        // A filter acts at the end of the whole step.
        if !self.scratch.plan.has_potential {
            return self.scratch.plan.holds;
        }
        let (whole, start) = (self.time, self.time[0]);
        self.time = [start + self.contacts.power_time, start + time];
        let changed = self.keep_apart(before, x, v);
        (self.time, self.is_truncated) = (whole, true);
        changed || self.scratch.plan.holds
    }
}

impl Scratch {
    /// Begins a step of several sub-scenes: effects that none of them calls belong to sleeping ones.
    pub fn begin_statistics(&mut self) {
        for cost in &mut self.costs {
            cost.idle = Some(ASLEEP);
        }
    }

    /// Counts steps of the scene; triangles of sleeping bodies were not computed.
    pub fn count_steps(&mut self, steps: u64) {
        self.counts.steps += steps;
        self.counts.triangle_steps += steps * self.plan.triangles as u64;
        for number in &self.plan.sleeping {
            self.costs[*number].slept += steps;
        }
    }

    /// Merges and resets the statistics of a sub-scene; `effects` are the numbers of its effects in the scene.
    pub fn merge(&mut self, one: &mut Self, effects: &[usize]) {
        for (cost, &number) in one.costs.iter_mut().zip(effects) {
            let whole = &mut self.costs[number];
            whole.time += cost.time;
            whole.heat += cost.heat;
            whole.calls += cost.calls;
            whole.elements += cost.elements;
            whole.skipped += cost.skipped;
            // Called if any sub-scene called it.
            whole.idle = whole.idle.and(cost.idle);
            *cost = EffectCost { idle: cost.idle, ..EffectCost::none(cost.name, cost.auto) };
        }
        self.counts.merge(&std::mem::take(&mut one.counts));
    }
}

/// A toy problem; evaluations of its rate count as force evaluations.
pub(super) struct ToySystem<'a> {
    pub toy: &'a dyn Toy,
    pub counts: &'a mut Counts,
}

impl Ode for ToySystem<'_> {
    fn rate(&mut self, _: f64, x: &[f64], rate: &mut [f64]) {
        self.counts.force_evaluations += 1;
        if let &[a, b] = x {
            rate.copy_from_slice(&self.toy.rate([a, b]));
        }
    }
}

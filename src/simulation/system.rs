//! A scene, or a toy, as a system for integrators, with the scratch and the statistics of its steps.

use super::contacts::{Contacts, contacts, surface_contact};
use crate::{
    contact::Means,
    effects::{Bounds, Effect, Grab, Motion, NO_CONTACT, NO_OBSTACLE_NEAR},
    elements::{EulerUpdate, UniformForce, reserve_scratch},
    integrators::{Class, Dynamics, Ode, Workspace, symplectic_euler_update},
    obstacles::{ContactCache, ContactQuery, Inside, Start, Surface, find_penetrations},
    report::{Counts, EffectCost},
    scene::Scene,
    solvers::{SparseMatrix, Weights},
    state::State,
    toys::Toy,
};
use std::{cell::Cell, ops::Range, sync::Arc};
use web_time::Instant;

/// Reason for skipping elements of sleeping bodies.
pub(super) const ASLEEP: &str = "asleep";

/// Reason for skipping an effect that only sets surface properties: it has no force of its own.
const PART_OF_CONTACT: &str = "part of the walls";

/// Most rounds of all constraints in a step.
const TURNS: usize = 4;

/// Numbers of the effects of a scene, by their role in a step.
#[derive(Default)]
pub(super) struct Plan {
    /// Elements of awake bodies and nets.
    pub elements: Vec<usize>,
    /// Other forces.
    pub forces: Vec<usize>,
    /// Constraints.
    pub constraints: Vec<usize>,
    /// Effects that set surface properties.
    pub surface_effects: Vec<usize>,
    /// Elements of sleeping bodies and nets, which are skipped.
    pub sleeping: Vec<usize>,
    /// Surface properties of contacts.
    pub surface: Surface,
    /// Whether contact has a potential, and constraints only keep what the skin cannot hold.
    pub potential: bool,
    /// Number of triangles of awake bodies, which a step computes.
    pub triangles: usize,
}

impl Plan {
    /// Makes the plan of a scene; `asleep` tells which of its elements, the first effects, sleep.
    fn new(scene: &Scene, asleep: impl Iterator<Item = bool>) -> Self {
        let mut plan = Self::default();
        let asleep = asleep.chain(std::iter::repeat(false));
        for ((number, effect), asleep) in scene.effects.iter().enumerate().zip(asleep) {
            let part = match (effect.constrains(), effect.is_surface_effect()) {
                _ if asleep => &mut plan.sleeping,
                _ if number < scene.element_count() => &mut plan.elements,
                (true, _) => &mut plan.constraints,
                (_, true) => &mut plan.surface_effects,
                _ => &mut plan.forces,
            };
            part.push(number);
            if !asleep && let Some(body) = scene.bodies.get(number) {
                plan.triangles += body.mesh.triangles().len();
            }
            effect.set_surface(&mut plan.surface);
            if effect.contact().is_some() && !asleep {
                if effect.constrains() {
                    plan.forces.push(number);
                }
                plan.potential = true;
            }
        }
        if plan.potential {
            // Friction and restitution are those of the potential.
            plan.surface = Surface::default();
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
    /// Outward normals of the vertices.
    pub outward: Vec<f64>,
    /// Work of moving and of penetrated obstacles in this step \[J\].
    pub supplied: f64,
    /// Whether a vertex began deep inside an obstacle.
    pub inside: Inside,
    /// Contacts and penetrations at the start of the step.
    pub contact_cache: ContactCache,
    /// Anchors of friction between steps.
    pub contacts: Contacts,
    pub plan: Plan,
    /// 1/mass [1/kg] with zero for sleeping vertices; empty while nothing sleeps.
    pub masked_inverse_mass: Vec<f64>,
    /// Box in which no constraint acts, while all vertices stay in it.
    pub clear_box: Option<Bounds>,
    /// Least distance that a vertex can still move before positions are checked again; negative if unknown \[m\].
    pub displacement_bound: f64,
    /// Kinetic energy after the step \[J\], if the step computed it.
    pub kinetic: Option<f64>,
    /// Least mass of a free coordinate \[kg\].
    pub lightest: f64,
    pub counts: Counts,
    pub costs: Vec<EffectCost>,
    /// Whether effects are timed.
    pub timed: bool,
}

impl Scratch {
    pub fn fit(&mut self, scene: &Scene) {
        self.workspace.forget();
        // Pairs are of the surfaces of the old scene.
        self.contacts = Contacts::default();
        reserve_scratch(&mut self.effects, scene.scratch());
        self.set_sleeping(scene, std::iter::empty());
        (self.clear_box, self.displacement_bound, self.inside) = (None, -1.0, Inside::Nothing);
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

    /// Sets which bodies and nets sleep; their vertices are not constrained yet.
    pub fn set_sleeping(&mut self, scene: &Scene, asleep: impl Iterator<Item = bool>) {
        let plan = Plan::new(scene, asleep);
        if plan.sleeping != self.plan.sleeping {
            // The sparsity pattern changes.
            self.workspace.forget();
        }
        self.plan = plan;
        self.masked_inverse_mass.clear();
        if !self.plan.sleeping.is_empty() {
            self.masked_inverse_mass.extend_from_slice(&scene.inverse_mass);
        }
    }

    /// Constrains a sleeping body or net, whose numbers in the state these are.
    pub fn constrain_sleeping(&mut self, numbers: &Range<usize>) {
        self.masked_inverse_mass[numbers.clone()].fill(0.0);
    }

    /// Reduces the displacement bound by the greatest displacement in a step of length h \[s\]: that of the lightest
    /// vertex with all kinetic energy, enlarged for round-off. Negative if the energy is unknown.
    pub fn reduce_displacement_bound(&mut self, h: f64) {
        let speed = (2.0 * self.kinetic.unwrap_or(f64::NAN) / self.lightest).sqrt();
        self.displacement_bound =
            if speed <= State::LIMIT { self.displacement_bound - 1.000_001 * h * speed } else { -1.0 };
    }

    /// The uniform force, if no other force acts beside the elements, all elements have an Euler update, and effects are not
    /// timed.
    pub fn uniform_force(&self, scene: &Scene, motion: Motion<'_>) -> Option<UniformForce> {
        if !self.plan.elements.iter().all(|number| scene.effects[*number].has_euler_update()) {
            return None;
        }
        let acts = |number: &&usize| !self.costs[**number].auto || scene.effects[**number].idle(motion).is_none();
        // Those of contact are added afterwards.
        let forces = self.plan.forces.iter().filter(|number| scene.effects[**number].contact().is_none());
        let mut acting = forces.filter(acts).map(|number| scene.effects[*number].uniform_force());
        let all = acting.try_fold(UniformForce::default(), |all, next| all.and(next?));
        all.filter(|_| !self.timed)
    }

    /// Runs one effect and adds its time and, if it is a separate call, its elements to the statistics.
    fn call_effect<T>(&mut self, number: usize, elements: Option<usize>, run: impl FnOnce(&mut [f64]) -> T) -> T {
        let start = self.timed.then(Instant::now);
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

    /// Records that all constraints, and with them the surface effects, were skipped.
    pub fn pass_over_constraints(&mut self) {
        if self.plan.potential {
            return;
        }
        for number in &self.plan.constraints {
            self.costs[*number].pass_over(NO_OBSTACLE_NEAR);
        }
        for number in &self.plan.surface_effects {
            let cost = &mut self.costs[*number];
            if cost.auto { cost.pass_over(NO_CONTACT) } else { cost.call(0) }
        }
    }
}

/// A scene with scratch, pull and time of a step.
pub(super) struct System<'a> {
    pub scene: &'a Scene,
    pub scratch: &'a mut Scratch,
    pub grab: Option<Grab>,
    /// Simulated time at the start and at the end of the step \[s\].
    pub time: [f64; 2],
    /// Contacts between steps.
    pub contacts: Contacts,
    /// Whether constraints were applied to every inner step already.
    is_truncated: bool,
}

impl<'a> System<'a> {
    /// A scene in a state, whose anchors it takes until [`Self::end`].
    pub fn begin(
        scene: &'a Scene,
        scratch: &'a mut Scratch,
        grab: Option<Grab>,
        time: [f64; 2],
        state: &mut State,
    ) -> Self {
        let mut contacts = std::mem::take(&mut scratch.contacts);
        std::mem::swap(&mut contacts.anchors, &mut state.anchors);
        let mut system = Self { scene, scratch, grab, time, contacts, is_truncated: false };
        system.contacts.update(scene, &state.x);
        if scene.integrator.kind().class() == Class::Implicit {
            system.contacts.begin_pattern(scene, &state.x);
        }
        system.contacts.power = (0.0, system.power_of_obstacles(0.0, &state.x, &state.v));
        system
    }

    /// Ends the step of length h \[s\] and returns the anchors to the state.
    pub fn end(mut self, h: f64, state: &mut State) {
        self.end_step(h, &state.x, &state.v);
        std::mem::swap(&mut self.contacts.anchors, &mut state.anchors);
        self.scratch.contacts = self.contacts;
    }

    fn power_of_obstacles(&self, time: f64, x: &[f64], v: &[f64]) -> f64 {
        let motion = self.motion(time, x, v);
        contacts(self.scene).map(|contact| contact.power_of_obstacles(motion)).sum()
    }

    /// A motion at a time since the start of the step \[s\].
    fn motion<'m>(&'m self, time: f64, x: &'m [f64], v: &'m [f64]) -> Motion<'m> {
        let time = self.time[0] + time;
        Motion { inverse_mass: self.inverse_mass(), ..motion(self.scene, &self.contacts, self.grab, time, [x, v]) }
    }
}

impl System<'_> {
    /// Records contacts and penetrations at the start of a step that ends at positions x.
    fn find_contacts(&mut self, start: &Start<'_>, x: &[f64], contact_cache: &mut ContactCache) {
        contact_cache.clear();
        let swept_bounds = Bounds::around(start.x, x);
        for turn in 0..self.scratch.plan.constraints.len() {
            let number = self.scratch.plan.constraints[turn];
            let effect = &self.scene.effects[number];
            if !(self.scratch.costs[number].auto && effect.is_clear(swept_bounds)) {
                let record = &mut |obstacle: ContactQuery<'_>| contact_cache.record(&obstacle, start);
                self.scratch
                    .call_effect(number, None, |_| effect.contact_queries(number, start.time, swept_bounds, record));
            }
        }
        if contact_cache.is_inside() {
            // All obstacles may block depenetration. Penetration is rare, so that an allocation is acceptable.
            let anywhere = Bounds::up_to(State::LIMIT);
            let mut obstacles = Vec::new();
            for number in &self.scratch.plan.constraints {
                let effect = &self.scene.effects[*number];
                effect.contact_queries(*number, start.time, anywhere, &mut |obstacle| obstacles.push(obstacle));
            }
            find_penetrations(&obstacles, start, contact_cache);
        }
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
    }
}

/// The effects of a scene without the elements of sleeping bodies.
fn awake<'a>(scene: &'a Scene, plan: &Plan) -> impl Iterator<Item = &'a dyn Effect> {
    let acts = |(number, effect): (usize, &'a Arc<dyn Effect>)| (!plan.sleeping.contains(&number)).then_some(&**effect);
    scene.effects.iter().enumerate().filter_map(acts)
}

impl System<'_> {
    /// Updates the statistics of a step in which elements update the vertices themselves.
    pub fn count_euler_update(&mut self, x: &[f64], v: &[f64]) {
        let scene = self.scene;
        let motion = motion(scene, &self.contacts, self.grab, self.time[0], [x, v]);
        let Scratch { plan, costs, counts, .. } = &mut *self.scratch;
        counts.force_evaluations += 1;
        for number in &plan.sleeping {
            costs[*number].pass_over(ASLEEP);
        }
        for number in plan.elements.iter().chain(&plan.forces) {
            let (effect, cost) = (&scene.effects[*number], &mut costs[*number]);
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
        let motion = motion(scene, &self.contacts, self.grab, self.time[0] + time, [x, v]);
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
            let (effect, cost) = (&scene.effects[number], &mut self.scratch.costs[number]);
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
    }

    /// Finds the forces of contact at the start of a step, for [`Self::add_contact_forces`].
    fn find_contact_forces(&mut self, x: &[f64], v: &[f64]) {
        if !self.scratch.plan.potential {
            return;
        }
        self.contacts.update(self.scene, x);
        let mut found = std::mem::take(&mut self.contacts.forces);
        found.clear();
        for turn in 0..self.scratch.plan.forces.len() {
            let number = self.scratch.plan.forces[turn];
            let Some(contact) = self.scene.effects[number].contact() else { continue };
            let motion = self.motion(0.0, x, v);
            let idle = contact.idle(motion).filter(|_| self.scratch.costs[number].auto);
            let elements = self.scene.effects[number].elements(motion);
            if let Some(why) = idle {
                self.scratch.costs[number].pass_over(why);
                continue;
            }
            let start = self.scratch.timed.then(Instant::now);
            contact.each_force(motion, |vertex, force| found.push((vertex, force)));
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
        for (vertex, force) in &self.contacts.forces {
            for (number, force) in (2 * vertex..).zip(force) {
                let change = h * force * inverse_mass[number];
                kinetic += 0.5 * self.scene.mass[number] * change * (2.0 * v[number] + change);
                v[number] += change;
                x[number] += h * change;
            }
        }
        if let Some(all) = &mut self.scratch.kinetic {
            *all += kinetic;
        }
    }
}

impl Dynamics for System<'_> {
    fn force(&mut self, time: f64, x: &[f64], v: &[f64], force: &mut [f64]) {
        self.forces(true, time, x, v, force);
    }

    /// Hash of the pull of the mouse, and of the sleeping bodies and nets, whose elements are skipped.
    fn load_fingerprint(&self) -> u32 {
        let grab = self.grab.map(|Grab { vertex, target: [x, y] }| [vertex as u64 + 1, x.to_bits(), y.to_bits()]);
        let sleeping = self.scratch.plan.sleeping.iter().map(|number| *number as u64 + 1);
        let mix = |hash: u64, number: u64| (hash ^ number).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
        let hash = grab.unwrap_or_default().into_iter().chain(sleeping).fold(0, mix);
        (hash >> 32) as u32 ^ hash as u32
    }

    /// If only elements and uniform forces act, the vertices are updated during force assembly.
    fn symplectic_euler_update(&mut self, x: &mut [f64], v: &mut [f64], force: &mut [f64], h: f64) {
        self.find_contact_forces(x, v);
        let Some(uniform_force) = self.scratch.uniform_force(self.scene, self.motion(0.0, x, v)) else {
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
            scene.effects[*number].euler_update(&mut vertices, effects);
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

    fn stiffness_times(&mut self, time: f64, x: &[f64], v: &[f64], d: &[f64], product: &mut [f64]) {
        let scene = self.scene;
        self.contacts.update(scene, x);
        let Scratch { plan, masked_inverse_mass, effects, .. } = &mut *self.scratch;
        let inverse_mass = if masked_inverse_mass.is_empty() { &scene.inverse_mass } else { &*masked_inverse_mass };
        let motion = motion(scene, &self.contacts, self.grab, self.time[0] + time, [x, v]);
        let motion = Motion { inverse_mass, ..motion };
        for effect in awake(scene, plan) {
            effect.stiffness_times(motion, d, &mut effects[..effect.scratch()], product);
        }
    }

    fn block_size(&self) -> usize {
        self.scene.dimension
    }

    fn sparsity_pattern(&self, add: &mut dyn FnMut(u32, u32)) {
        for effect in awake(self.scene, &self.scratch.plan) {
            effect.sparsity_pattern(add);
            if let Some(contact) = effect.surface_contact() {
                contact.sparsity_pattern(&self.contacts.pattern, add);
            }
        }
    }

    fn pattern_changes(&mut self, x: &[f64]) -> bool {
        self.contacts.update(self.scene, x);
        self.contacts.extend_pattern(self.scene, x)
    }

    fn add_stiffness(&mut self, time: f64, x: &[f64], v: &[f64], weights: Weights, matrix: &mut dyn SparseMatrix) {
        let motion = self.motion(time, x, v);
        for effect in awake(self.scene, &self.scratch.plan) {
            effect.add_stiffness(motion, weights, matrix);
        }
    }

    fn longest_step(&mut self, x: &[f64], d: &[f64]) -> f64 {
        let apart = self.contacts.longest_step(self.scene, x, d);
        awake(self.scene, &self.scratch.plan).map(|effect| effect.longest_step(x, d)).fold(apart, f64::min)
    }

    fn constrains(&self) -> bool {
        self.meets_obstacles() || surface_contact(self.scene).is_some()
    }

    fn touches(&mut self, time: f64, x: &[f64], v: &[f64]) -> bool {
        self.contacts.update(self.scene, x);
        let motion = self.motion(time, x, v);
        contacts(self.scene).any(|contact| contact.touches(motion))
    }

    fn has_friction(&self) -> bool {
        self.scratch.plan.surface.friction != 0.0
    }

    fn project_contact_velocity(&mut self, before: [&[f64]; 2], x: &mut [f64], v: &mut [f64]) -> bool {
        let effects = &self.scene.effects;
        if !self.meets_obstacles() || !self.scratch.plan.constraints.iter().all(|number| effects[*number].is_steady()) {
            return false;
        }
        let supplied = std::mem::take(&mut self.scratch.supplied);
        let inside = std::mem::take(&mut self.scratch.inside);
        x.copy_from_slice(before[0]);
        self.constrain(before, x, v, true);
        let rests = (self.scratch.supplied, self.scratch.inside) == (0.0, Inside::Nothing);
        (self.scratch.supplied, self.scratch.inside) = (supplied, inside);
        rests
    }

    fn discard_records(&mut self) {
        (self.scratch.supplied, self.scratch.inside) = (0.0, Inside::Nothing);
    }

    fn end_step(&mut self, time: f64, x: &[f64], v: &[f64]) {
        self.contacts.update(self.scene, x);
        let power = self.power_of_obstacles(time, x, v);
        let (before, was) = std::mem::replace(&mut self.contacts.power, (time, power));
        self.scratch.supplied += 0.5 * (time - before) * (power + was);
        let mut next = self.contacts.take_next();
        let eased = Contacts::next_anchors(self.scene, self.motion(time, x, v), time - before, &mut next);
        self.scratch.supplied += eased;
        self.contacts.set_anchors(next);
        if self.scratch.plan.potential {
            for number in &self.scratch.plan.surface_effects {
                let cost = &mut self.scratch.costs[*number];
                if cost.auto { cost.pass_over(PART_OF_CONTACT) } else { cost.call(0) }
            }
        }
    }

    fn has_moving_obstacles(&self) -> bool {
        self.scratch.plan.constraints.iter().any(|number| !self.scene.effects[*number].is_steady())
    }

    fn set_work_of_obstacles(&mut self, work: f64) {
        self.scratch.supplied = work;
    }

    fn constrain(&mut self, before: [&[f64]; 2], x: &mut [f64], v: &mut [f64], faces: bool) {
        if self.is_truncated {
            return;
        }
        self.keep_out_of_obstacles(before, x, v, faces);
        if faces || !self.cut(Means::All, before[0], x, v) {
            return;
        }
        // What kept bodies apart may have moved vertices into obstacles, and the other way round; cuts do neither.
        self.keep_out_of_obstacles(before, x, v, faces);
        self.cut(Means::Cuts, before[0], x, v);
    }

    /// The skin holds inner steps apart; a filter alone acts at the end of the whole step.
    fn truncate(&mut self, time: f64, before: [&[f64]; 2], x: &mut [f64], v: &mut [f64]) -> bool {
        if !self.scratch.plan.potential {
            return false;
        }
        let constrained = self.scratch.counts.constrained;
        self.is_truncated = false;
        let (whole, start) = (self.time, self.time[0]);
        self.time = [start + self.contacts.power.0, start + time];
        self.constrain(before, x, v, false);
        (self.time, self.is_truncated) = (whole, true);
        self.scratch.counts.constrained > constrained
    }
}

impl System<'_> {
    /// Keeps a step from `start` from crossing surfaces; returns whether any met.
    fn cut(&mut self, means: Means, start: &[f64], x: &mut [f64], v: &mut [f64]) -> bool {
        if !self.contacts.meets(self.scene, start, x) {
            return false;
        }
        let before = self.energy(x, v);
        let Self { scene, scratch, contacts, .. } = self;
        let masked = &scratch.masked_inverse_mass;
        let inverse_mass = if masked.is_empty() { &scene.inverse_mass } else { masked };
        scratch.counts.constrained += contacts.truncate(scene, means, (start, inverse_mass), [x, v]) as u64;
        scratch.kinetic = None;
        let gained = self.energy(x, v) - before;
        if gained > 0.0 {
            let Self { scene, scratch, contacts, .. } = self;
            let masked = &scratch.masked_inverse_mass;
            let inverse_mass = if masked.is_empty() { &scene.inverse_mass } else { masked };
            contacts.dissipate(scene, gained, inverse_mass, v);
        }
        true
    }

    /// Total energy at the end of the step \[J\].
    fn energy(&mut self, x: &[f64], v: &[f64]) -> f64 {
        self.contacts.update(self.scene, x);
        let motion = self.motion(self.time[1] - self.time[0], x, v);
        let kinetic = self.scene.mass.iter().zip(v).map(|(mass, v)| 0.5 * mass * v * v).sum::<f64>();
        kinetic + self.scene.effects.iter().map(|effect| effect.energy(motion)).sum::<f64>()
    }

    /// Whether obstacles may act in this step.
    fn meets_obstacles(&self) -> bool {
        self.scratch.clear_box.is_none() && !self.scratch.plan.constraints.is_empty()
    }

    /// Applies all constraints in rounds until none changes a vertex, because one may move a vertex into another.
    fn keep_out_of_obstacles(&mut self, [before_x, before_v]: [&[f64]; 2], x: &mut [f64], v: &mut [f64], faces: bool) {
        if !self.meets_obstacles() {
            return;
        }
        self.scratch.kinetic = None;
        let scene = self.scene;
        let masked_inverse_mass = std::mem::take(&mut self.scratch.masked_inverse_mass);
        let inverse_mass =
            if masked_inverse_mass.is_empty() { scene.inverse_mass.as_slice() } else { &masked_inverse_mass };
        let mut outward = std::mem::take(&mut self.scratch.outward);
        let mut contact_cache = std::mem::take(&mut self.scratch.contact_cache);
        if faces {
            scene.outward(before_x, &mut outward);
        }
        let (time, supplied, inside) = (self.time, Cell::new(0.0), Cell::new(Inside::Nothing));
        let mut start = Start {
            x: before_x,
            v: before_v,
            inverse_mass,
            surface: self.scratch.plan.surface,
            outward: faces.then_some(outward.as_slice()),
            time,
            supplied: &supplied,
            depenetrations: &scene.depenetrations,
            effect: 0,
            touching: &[],
            penetrations: &[],
            contact_cache: ContactCache::NONE,
            inside: &inside,
        };
        self.find_contacts(&start, x, &mut contact_cache);
        start.contact_cache = &contact_cache;
        let count = self.scratch.plan.constraints.len();
        let (mut quiet, mut all) = (0, 0);
        // Box around the swept vertices, valid until a constraint changes one.
        let mut swept_bounds = None;
        for turn in 0..TURNS * count {
            if turn >= count && quiet + 1 >= count {
                break;
            }
            let number = self.scratch.plan.constraints[turn % count];
            let (effect, cost) = (&scene.effects[number], &mut self.scratch.costs[number]);
            if cost.auto && effect.is_clear(*swept_bounds.get_or_insert_with(|| Bounds::around(before_x, x))) {
                if turn < count && effect.contact().is_none() {
                    cost.pass_over(NO_OBSTACLE_NEAR);
                }
                quiet += 1;
                continue;
            }
            let (dimension, mass) = (scene.dimension, &scene.mass);
            let motion = Motion { dimension, x, v, mass, inverse_mass, grab: self.grab, ..Motion::NONE };
            let elements = (turn < count && effect.contact().is_none()).then(|| effect.elements(motion));
            start.effect = number;
            let touched = self.scratch.call_effect(number, elements, |_| effect.constrain(&start, x, v));
            if touched > 0 {
                swept_bounds = None;
            }
            quiet = if touched == 0 { quiet + 1 } else { 0 };
            all += touched;
        }
        // Implicit schemes call this more than once a step and constrain the changed vertices.
        if contact_cache.is_inside() && scene.integrator.kind().class() == Class::Explicit {
            start.damp(v);
        }
        self.scratch.supplied += supplied.get();
        self.scratch.inside = self.scratch.inside.max(inside.get());
        self.scratch.counts.constrained += all as u64;
        let surface_effects = if self.scratch.plan.potential { &[][..] } else { &self.scratch.plan.surface_effects };
        for number in surface_effects {
            let cost = &mut self.scratch.costs[*number];
            if all > 0 || !cost.auto { cost.call(all) } else { cost.pass_over(NO_CONTACT) }
        }
        (self.scratch.outward, self.scratch.masked_inverse_mass, self.scratch.contact_cache) =
            (outward, masked_inverse_mass, contact_cache);
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

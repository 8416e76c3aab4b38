//! Work in a step: of moving obstacles, moving pins and wind, and of what effects dissipate.

use super::{
    contacts::contacts,
    system::{Scratch, System},
};
use crate::{
    effects::{Effect, Motion},
    integrators::{Class, Dynamics, MeanForces},
    scene::Scene,
};

impl System<'_> {
    /// Whether powers act or are measured.
    pub(super) fn has_powers(&self) -> bool {
        let supplies = || self.scene.effects.iter().any(|effect| effect.supplies() || effect.held_vertices().is_some());
        let constrained = !self.scratch.plan.constraints.is_empty();
        self.scratch.measured || constrained || contacts(self.scene).any(|contact| contact.moves()) || supplies()
    }

    /// Finds the powers at the time since the start of the step, the positions and velocities, and with the lag and spans of a motion.
    pub(super) fn find_powers(&mut self, at: Motion<'_>) {
        let [mut powers, mut stored] = [&mut self.scratch.powers[0], &mut self.scratch.stored[0]].map(std::mem::take);
        let mut forces = std::mem::take(&mut self.scratch.forces);
        let mut effects = std::mem::take(&mut self.scratch.effects);
        let Motion { span, elastic_span, lag, .. } = at;
        let motion = Motion { span, elastic_span, lag, ..self.motion(at.time, at.x, at.v) };
        powers.clear();
        stored.clear();
        let of_obstacles = contacts(self.scene).map(|contact| contact.power_of_obstacles(motion)).sum::<f64>();
        let supplied = self.scene.effects.iter().filter_map(|effect| effect.supplied_power(motion, &mut forces));
        powers
            .push(of_obstacles + supplied.sum::<f64>() + power_of_held(self.scene, motion, &mut effects, &mut forces));
        if self.scratch.measured {
            for effect in &self.scene.effects {
                let [power, energy] = taken_power(&**effect, motion, &mut effects, &mut forces);
                powers.push(power);
                stored.push(energy);
            }
        }
        if !self.scratch.plan.constraints.is_empty() {
            forces.clear();
            forces.resize(at.x.len(), 0.0);
            for effect in &self.scene.effects {
                effect.force(motion, &mut effects[..effect.scratch()], &mut forces);
            }
            let mut rows = self.rows(false, at.time, at.x, at.v);
            powers[0] += rows.power(self.inverse_mass(), &forces, at.v);
            self.scratch.rows = rows;
        }
        (self.scratch.powers[0], self.scratch.stored[0]) = (powers, stored);
        (self.scratch.forces, self.scratch.effects) = (forces, effects);
    }

    /// Begins the work of a step in a state.
    pub(super) fn begin_work(&mut self, x: &[f64], v: &[f64]) {
        self.contacts.power_time = 0.0;
        self.contacts.start.clear();
        if self.has_powers() {
            self.contacts.start.extend_from_slice(x);
            self.contacts.start.extend_from_slice(v);
        }
        self.find_powers(Motion { x, v, ..Motion::NONE });
    }

    /// Adds the work of moving obstacles and the heat of effects in an inner step that ends at a time and in positions and velocities.
    ///
    /// Implicit Euler takes forces at the end of the step: they do their work along the whole displacement of an obstacle. Midpoint rules
    /// take those at the midpoint. To second order the mean power does. Heat under schemes of higher order is that of Simpson's rule with cubic
    /// Hermite interpolation; for work on fast impacts, which the guard relies on, that is not robust.
    pub(super) fn add_work(&mut self, time: f64, x: &[f64], v: &[f64]) {
        let kind = self.scene.integrator.kind();
        let step = time - std::mem::replace(&mut self.contacts.power_time, time);
        let means = kind.mean_forces() != MeanForces::None;
        let takes_end = kind.class() == Class::Implicit && kind.order() == 1;
        self.scratch.powers.swap(0, 2);
        self.scratch.stored.swap(0, 1);
        let is_fine = self.scratch.measured && !means && kind.order() > 2;
        if means || is_fine {
            self.find_powers_between(time, step, means, [x, v]);
            self.scratch.powers.swap(0, 1);
        }
        self.find_powers(Motion { x, v, time, lag: if takes_end { 0.5 * step } else { 0.0 }, ..Motion::NONE });
        let weights = if means {
            [0.0, 1.0, 0.0]
        } else if takes_end {
            [1.0, 0.0, 0.0]
        } else {
            [0.5, 0.0, 0.5]
        };
        let fine_weights = if is_fine { [1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0] } else { weights };
        let Scratch { powers, stored: [stored, was_stored], costs, supplied, .. } = &mut *self.scratch;
        let at = |when: usize, number: usize| powers[when].get(number).copied().unwrap_or(0.0);
        let work = |weights: [f64; 3], number: usize| {
            step * weights.iter().enumerate().map(|(when, weight)| weight * at(when, number)).sum::<f64>()
        };
        *supplied += work(weights, 0) + kinetic_energy_of_held(self.scene, v);
        if let Some((_, start_v)) = self.contacts.start.split_at_checked(x.len()) {
            *supplied -= kinetic_energy_of_held(self.scene, start_v);
        }
        for (number, cost) in costs.iter_mut().enumerate().take(stored.len()) {
            cost.heat += work(fine_weights, 1 + number) - (stored[number] - was_stored.get(number).unwrap_or(&0.0));
        }
        let ends = x.iter().chain(v);
        self.contacts.start.iter_mut().zip(ends).for_each(|(start, end)| *start = *end);
    }

    /// Finds the powers in the middle of an inner step that ends at a time: with mean velocities, or those of the cubic polynomial through both
    /// ends.
    fn find_powers_between(&mut self, time: f64, step: f64, means: bool, [x, v]: [&[f64]; 2]) {
        self.scratch.powers[0].clear();
        if self.contacts.start.is_empty() || step == 0.0 {
            return;
        }
        let mut middle = std::mem::take(&mut self.contacts.end);
        middle.clear();
        let (start_x, start_v) = self.contacts.start.split_at(x.len());
        let ends = || start_x.iter().zip(x).zip(start_v.iter().zip(v));
        let bend = if means { 0.0 } else { 0.125 * step };
        middle.extend(ends().map(|((x, end_x), (v, end_v))| 0.5 * (x + end_x) + bend * (v - end_v)));
        middle.extend(ends().map(|((x, end_x), (v, end_v))| {
            let mean = (end_x - x) / step;
            if means { mean } else { 1.5 * mean - 0.25 * (v + end_v) }
        }));
        let (middle_x, middle_v) = middle.split_at(x.len());
        let at = Motion { x: middle_x, v: middle_v, time: time - 0.5 * step, ..Motion::NONE };
        self.contacts.update(self.scene, middle_x);
        self.find_powers(if means { self.over_step(at) } else { at });
        self.contacts.update(self.scene, x);
        self.contacts.end = middle;
    }
}

/// Power that an effect takes from the motion \[W\], and energy that friction stores of that \[J\].
fn taken_power(effect: &dyn Effect, motion: Motion<'_>, scratch: &mut [f64], force: &mut Vec<f64>) -> [f64; 2] {
    if let Some(contact) = effect.contact() {
        return contact.taken_power(motion);
    }
    if effect.supplies() || effect.damping(motion) == [0.0; 2] {
        return [0.0; 2];
    }
    force.clear();
    force.resize(motion.x.len(), 0.0);
    effect.force(motion, &mut scratch[..effect.scratch()], force);
    [-force.iter().zip(motion.v).map(|(force, v)| force * v).sum::<f64>(), 0.0]
}

/// Power of held vertices on what they are tied to \[W\]: against all forces on them, at their velocity.
fn power_of_held(scene: &Scene, motion: Motion<'_>, scratch: &mut [f64], force: &mut Vec<f64>) -> f64 {
    if scene.held().next().is_none() {
        return 0.0;
    }
    force.clear();
    force.resize(motion.x.len(), 0.0);
    for effect in &scene.effects {
        effect.force(motion, &mut scratch[..effect.scratch()], force);
    }
    let numbers = scene.held().flat_map(|vertex| scene.numbers(&(vertex as usize..vertex as usize + 1)));
    -numbers.map(|number| force[number] * motion.v[number]).sum::<f64>()
}

/// Kinetic energy of held vertices \[J\]: what moves them supplies that too.
fn kinetic_energy_of_held(scene: &Scene, v: &[f64]) -> f64 {
    let numbers = scene.held().flat_map(|vertex| scene.numbers(&(vertex as usize..vertex as usize + 1)));
    numbers.map(|number| 0.5 * scene.mass[number] * v[number] * v[number]).sum()
}

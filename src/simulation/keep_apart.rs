//! Truncation of steps: bodies stay out of obstacles and out of each other.

use super::{
    contacts::Contacts,
    system::{Scratch, System},
};
use crate::{
    contact::{FilteredStep, Means, ObstacleTerm, Path, TruncatedStep, Truncation},
    effects::{Motion, NO_OBSTACLE_NEAR},
};

impl System<'_> {
    /// Contacts with obstacles that may act in this step.
    fn near_obstacles(&self) -> impl Iterator<Item = &dyn ObstacleTerm> + use<'_> {
        let numbers = self.scratch.plan.obstacles.iter().filter(|_| self.scratch.clear_box.is_none());
        numbers.filter_map(|number| self.scene.effects[*number].obstacle_contact())
    }

    /// Keeps a step from `start` from crossing obstacles and surfaces, or filters the velocities at its end; returns whether it
    /// changed anything.
    pub(super) fn keep_apart(&mut self, start: &[f64], x: &mut [f64], v: &mut [f64]) -> bool {
        if !self.scratch.plan.has_potential {
            return self.filter(start, x, v);
        }
        if !self.meets_obstacle(start, x) && !self.contacts.meets(self.scene, start, x) {
            return false;
        }
        self.scratch.kinetic = None;
        let (before, was_supplied) = (self.energy(x, v), self.scratch.supplied);
        self.contacts.truncation.moved.clear();
        // What keeps bodies apart may move vertices into obstacles, and the other way round; cuts do neither.
        let mut is_pushed = false;
        for means in [Means::All, Means::Cuts] {
            is_pushed |= self.stop_at_obstacles(start, x, v);
            self.stop_at_surfaces(means, start, x, v);
        }
        let gained = self.energy(x, v) - before - (self.scratch.supplied - was_supplied);
        self.scratch.counts.truncated_energy += (-gained).max(0.0);
        if gained > 0.0 && is_pushed {
            // Moved vertices deform elements; that is work of the obstacle.
            self.scratch.supplied += gained;
        } else if gained > 0.0 {
            let Self { scene, scratch, contacts, .. } = self;
            contacts.dissipate(scene, gained, inverse_mass(scene, scratch), v);
        }
        true
    }

    /// Whether something meets an obstacle on a straight way from `start` to x \[m\].
    pub(super) fn meets_obstacle(&self, start: &[f64], x: &[f64]) -> bool {
        let path = Path { time: self.time, start, end: x, anchors: Some(&self.contacts.anchors) };
        self.near_obstacles().any(|contact| contact.first_meeting(&path, false).is_some())
    }

    /// Stops a step at obstacles; returns whether a moving one moved a vertex.
    fn stop_at_obstacles(&mut self, start: &[f64], x: &mut [f64], v: &mut [f64]) -> bool {
        let Self { scene, scratch, contacts, time, .. } = self;
        if scratch.clear_box.is_some() {
            return false;
        }
        let Contacts { anchors, truncation, .. } = contacts;
        let inverse_mass = inverse_mass(scene, scratch);
        let (mut met, mut supplied, mut is_pushed) = (0, 0.0, false);
        for number in &scratch.plan.obstacles {
            let Some(contact) = scene.effects[*number].obstacle_contact() else { continue };
            let Truncation { moved, found, before, .. } = &mut *truncation;
            let mut step = TruncatedStep {
                time: *time,
                start,
                inverse_mass,
                anchors,
                x: &mut *x,
                v: &mut *v,
                moved,
                found,
                before,
                supplied: 0.0,
                is_pushed: false,
            };
            met += contact.truncate(&mut step);
            supplied += step.supplied;
            is_pushed |= step.is_pushed;
        }
        scratch.counts.constrained += met as u64;
        scratch.supplied += supplied;
        is_pushed
    }

    fn stop_at_surfaces(&mut self, means: Means, start: &[f64], x: &mut [f64], v: &mut [f64]) {
        let Self { scene, scratch, contacts, .. } = self;
        let met = contacts.truncate(scene, means, (start, inverse_mass(scene, scratch)), [x, v]);
        scratch.counts.constrained += met as u64;
    }

    /// Filters the velocities at the end of the step.
    fn filter(&mut self, start: &[f64], x: &mut [f64], v: &mut [f64]) -> bool {
        let moves = self.near_obstacles().any(ObstacleTerm::filters_positions);
        let before = moves.then(|| self.energy(x, v));
        let Self { scene, scratch, time, .. } = self;
        let mut all = 0;
        for turn in 0..scratch.plan.obstacles.len() {
            let number = scratch.plan.obstacles[turn];
            let effect = &scene.effects[number];
            let Some(contact) = effect.obstacle_contact().filter(|_| scratch.clear_box.is_none()) else { continue };
            if scratch.costs[number].auto && !contact.may_touch(time[1], x) {
                scratch.costs[number].pass_over(NO_OBSTACLE_NEAR);
                continue;
            }
            let masked = std::mem::take(&mut scratch.masked_inverse_mass);
            let inverse_mass = if masked.is_empty() { scene.inverse_mass.as_slice() } else { &masked };
            let elements = contact.count() * x.len() / scene.dimension;
            let (changed, supplied) = scratch.call_effect(number, Some(elements), |_| {
                contact.filter(FilteredStep { time: *time, start, inverse_mass, x: &mut *x, v: &mut *v })
            });
            scratch.masked_inverse_mass = masked;
            scratch.supplied += supplied;
            all += changed;
        }
        self.scratch.counts.constrained += all as u64;
        if all > 0 {
            self.scratch.kinetic = None;
            if let Some(before) = before {
                let gained = self.energy(x, v) - before;
                self.record_gain(gained);
            }
        }
        all > 0
    }

    /// Largest multiple of a displacement d from positions x \[m\] in which nothing meets a bounded obstacle. Beyond a plane
    /// Newton's method finds back.
    pub(super) fn longest_step_to_solids(&mut self, x: &[f64], d: &[f64]) -> f64 {
        if self.near_obstacles().next().is_none() {
            return f64::INFINITY;
        }
        let mut end = std::mem::take(&mut self.contacts.end);
        end.clear();
        end.extend(x.iter().zip(d).map(|(x, d)| x + d));
        let path = Path { time: [self.time[1]; 2], start: x, end: &end, anchors: None };
        let first = self.near_obstacles().filter_map(|contact| contact.first_meeting(&path, true));
        let first = first.fold(f64::INFINITY, f64::min);
        self.contacts.end = end;
        first
    }

    /// Projects the positions at the end of the step from `start`; returns whether there is a projection. Velocities change by the
    /// displacement over the length of the step, so that a scheme that stores displacements in place of velocities continues with
    /// the same ones.
    pub(super) fn project(&mut self, start: &[f64], x: &mut [f64], v: &mut [f64]) -> bool {
        if self.scratch.plan.projections.is_empty() {
            return false;
        }
        let before = self.energy(x, v);
        let mut unprojected = std::mem::take(&mut self.contacts.end);
        unprojected.clear();
        unprojected.extend_from_slice(x);
        for turn in 0..self.scratch.plan.projections.len() {
            let Self { scene, scratch, .. } = self;
            let number = scratch.plan.projections[turn];
            let Some(projection) = scene.effects[number].projection() else { continue };
            if scratch.costs[number].auto
                && let Some(why) = scene.effects[number].idle(Motion::NONE)
            {
                scratch.costs[number].pass_over(why);
                continue;
            }
            let masked = std::mem::take(&mut scratch.masked_inverse_mass);
            let inverse_mass = if masked.is_empty() { scene.inverse_mass.as_slice() } else { &masked };
            let elements = scene.effects[number].elements(Motion::NONE);
            let size = scene.effects[number].scratch();
            scratch.call_effect(number, Some(elements), |scratch| {
                projection.project(inverse_mass, x, &mut scratch[..size]);
            });
            scratch.masked_inverse_mass = masked;
        }
        if self.scene.puts_pins_back() {
            for pin in self.scene.pins.iter() {
                let numbers = self.scene.numbers(&(*pin as usize..*pin as usize + 1));
                x[numbers.clone()].copy_from_slice(&start[numbers]);
            }
        }
        let h = self.time[1] - self.time[0];
        for ((v, x), before) in v.iter_mut().zip(&*x).zip(&unprojected) {
            *v += (x - before) / h;
        }
        self.contacts.end = unprojected;
        self.scratch.kinetic = None;
        let gained = self.energy(x, v) - before;
        self.record_gain(gained);
        true
    }

    /// Records energy \[J\] that a change of positions gave, or took if it is negative.
    fn record_gain(&mut self, gained: f64) {
        self.scratch.supplied += gained.max(0.0);
        self.scratch.counts.truncated_energy += (-gained).max(0.0);
    }

    /// Total energy at the end of the step \[J\].
    fn energy(&mut self, x: &[f64], v: &[f64]) -> f64 {
        self.contacts.update(self.scene, x);
        let motion = self.motion(self.time[1] - self.time[0], x, v);
        let kinetic = self.scene.mass.iter().zip(v).map(|(mass, v)| 0.5 * mass * v * v).sum::<f64>();
        kinetic
            + self.scene.coupled_energy(v)
            + self.scene.effects.iter().map(|effect| effect.energy(motion)).sum::<f64>()
    }
}

/// 1/mass [1/kg] with zero for sleeping vertices.
fn inverse_mass<'a>(scene: &'a crate::scene::Scene, scratch: &'a Scratch) -> &'a [f64] {
    if scratch.masked_inverse_mass.is_empty() { &scene.inverse_mass } else { &scratch.masked_inverse_mass }
}

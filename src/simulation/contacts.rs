//! Contacts of a running scene between its steps.

use crate::{
    contact::{Anchor, AnyContact, Candidates, Means, Pair, SurfaceTerm, Truncation},
    effects::Motion,
    scene::Scene,
};

/// Contacts between two steps or inner steps.
#[derive(Default)]
pub(super) struct Contacts {
    /// Memory of contacts.
    pub anchors: Vec<Anchor>,
    /// Scratch for the next anchors.
    next: Vec<Anchor>,
    /// Forces of contact at the start of the step \[N\], by their places among all coordinates.
    pub forces: Vec<(usize, f64)>,
    /// Time since the start of the step up to which work was added \[s\].
    pub power_time: f64,
    /// Pairs that may be near each other at the positions they were updated for.
    pub candidates: Candidates,
    /// Pairs that have blocks in the stiffness matrix: those near at the start of the step, and those that Newton's method
    /// brought near each other since. They depend on the state at the start alone, as the bits of a solution do on them.
    pub pattern: Vec<Pair>,
    /// Whether the pattern has changed since it was last asked for.
    is_new_pattern: bool,
    /// Scratch for pairs.
    near: Vec<Pair>,
    /// Scratch for truncation.
    pub truncation: Truncation,
    /// Positions \[m\] and velocities [m/s] at the start of an inner step, where they are needed.
    pub start: Vec<f64>,
    /// Scratch for positions and velocities.
    pub end: Vec<f64>,
}

/// The contacts of a scene by a potential.
pub(super) fn contacts(scene: &Scene) -> impl Iterator<Item = AnyContact<'_>> {
    scene.effects.iter().filter_map(|effect| effect.contact())
}

/// Contact of the surfaces of a scene with each other.
pub(super) fn surface_contact(scene: &Scene) -> Option<&dyn SurfaceTerm> {
    scene.effects.iter().find_map(|effect| effect.surface_contact())
}

impl Contacts {
    /// Finds the pairs that may be near at positions x.
    pub fn update(&mut self, scene: &Scene, x: &[f64]) {
        if let Some(contact) = surface_contact(scene) {
            contact.update(&mut self.candidates, x, &self.anchors);
        }
    }

    /// Sets the pattern to the pairs near each other at positions x, for which they were updated.
    pub fn begin_pattern(&mut self, scene: &Scene, x: &[f64]) {
        let Some(contact) = surface_contact(scene) else { return };
        self.near.clear();
        contact.add_near(&self.candidates, x, &mut self.near);
        if self.near != self.pattern {
            std::mem::swap(&mut self.near, &mut self.pattern);
            self.is_new_pattern = true;
        }
    }

    /// Adds the pairs near each other at positions x, for which they were updated, to the pattern. Returns whether it has
    /// changed since the last call.
    pub fn extend_pattern(&mut self, scene: &Scene, x: &[f64]) -> bool {
        let Some(contact) = surface_contact(scene) else { return false };
        self.near.clear();
        contact.add_near(&self.candidates, x, &mut self.near);
        let before = self.pattern.len();
        let missing = self.near.iter().filter(|pair| self.pattern[..before].binary_search(pair).is_err());
        let missing: usize = missing.count();
        if missing > 0 {
            self.pattern.append(&mut self.near);
            self.pattern.sort_unstable();
            self.pattern.dedup();
            self.is_new_pattern = true;
        }
        std::mem::take(&mut self.is_new_pattern)
    }

    /// Cuts a step from `start` so that no vertex crosses an edge; see [`SurfaceTerm::truncate`].
    pub fn truncate(&mut self, scene: &Scene, means: Means, start: (&[f64], &[f64]), end: [&mut [f64]; 2]) -> usize {
        let Self { truncation, candidates, .. } = self;
        surface_contact(scene).map_or(0, |contact| contact.truncate((truncation, candidates), means, start, end))
    }

    /// Whether surfaces meet in a step from `start` to x.
    pub fn meets(&mut self, scene: &Scene, start: &[f64], x: &[f64]) -> bool {
        let Self { truncation, candidates, .. } = self;
        surface_contact(scene).is_some_and(|contact| contact.meets(truncation, candidates, start, x))
    }

    /// Takes kinetic energy \[J\] from what was moved; see [`Truncation::dissipate`].
    pub fn dissipate(&mut self, scene: &Scene, energy: f64, inverse_mass: &[f64], v: &mut [f64]) {
        let parts = scene.parts.iter().map(|part| part.vertices());
        self.truncation.dissipate(energy, [&scene.mass, inverse_mass], (scene.dimension, parts), v);
    }

    /// Largest multiple of the displacement d from positions x \[m\] in which no vertex crosses an edge.
    pub fn longest_step(&mut self, scene: &Scene, x: &[f64], d: &[f64]) -> f64 {
        let Some(contact) = surface_contact(scene) else { return f64::INFINITY };
        let Self { truncation, candidates, end, .. } = self;
        end.clear();
        end.extend(x.iter().zip(d).map(|(x, d)| x + d));
        contact.longest_step(truncation, candidates, x, end)
    }

    /// Writes the memory after a step of length h \[s\], from that at its start, which `motion` contains. Returns the energy that
    /// the decrease of initial penetration supplies \[J\]. With `clear` no obstacle is near.
    pub fn next_anchors(scene: &Scene, motion: Motion<'_>, h: f64, clear: bool, next: &mut Vec<Anchor>) -> f64 {
        next.clear();
        let effects = scene.effects.iter().filter(|effect| !clear || effect.obstacle_contact().is_none());
        effects.filter_map(|effect| effect.contact()).map(|contact| contact.drag_anchors(motion, h, next)).sum()
    }

    /// Takes the scratch for [`Self::next_anchors`].
    pub fn take_next(&mut self) -> Vec<Anchor> {
        std::mem::take(&mut self.next)
    }

    /// Replaces the anchors.
    pub fn set_anchors(&mut self, mut next: Vec<Anchor>) {
        std::mem::swap(&mut self.anchors, &mut next);
        self.next = next;
    }
}

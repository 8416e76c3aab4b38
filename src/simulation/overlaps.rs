//! Bodies that begin inside each other: they are moved apart before they touch.

use super::{
    Simulation,
    contacts::{Contacts, surface_contact},
    system::System,
};
use crate::{contact::Overlap, scene::Scene};

/// Greatest depth of a vertex in another body that its skin lets out, as a multiple of its thickness. Deeper ones would leave by
/// the nearest way each, and these ways may lead apart.
const SHALLOW: f64 = 1.0;

/// Pairs of bodies that overlap, by their numbers. They do not touch each other until they are out of each other and of their skins.
#[derive(Default)]
pub(super) struct Overlaps {
    aside: Vec<[usize; 2]>,
    /// Whether there have been any since the state or the scene was set.
    were_there: bool,
}

impl Simulation {
    /// Sets the bodies aside that overlap deeply in a state that no step led to, or in another scene.
    pub(super) fn begin_overlaps(&mut self) {
        let were = |overlap: &Overlap| self.overlaps.aside.contains(&overlap.bodies);
        let aside = self.overlapping(|overlap| overlap.inside > SHALLOW || were(overlap));
        self.overlaps.were_there = !aside.is_empty();
        self.set_aside(aside);
    }

    /// Sets the bodies aside that were so in a state that steps led to: those that overlap or are within their skin, without a memory of
    /// their contact.
    pub(super) fn resume_overlaps(&mut self) {
        let aside = self.overlapping(|overlap| !self.have_touched(overlap.bodies));
        self.overlaps.were_there = !aside.is_empty();
        self.set_aside(aside);
    }

    /// The same in an earlier state of a run.
    pub(super) fn return_to_overlaps(&mut self) {
        if self.overlaps.were_there {
            let aside = self.overlapping(|overlap| !self.have_touched(overlap.bodies));
            self.set_aside(aside);
        }
    }

    fn overlapping(&self, is_wanted: impl Fn(&Overlap) -> bool) -> Vec<[usize; 2]> {
        // A scene with other vertices gets its state later.
        let contact = surface_contact(&self.scene).filter(|_| self.state.x.len() == self.scene.rest.len());
        let found = contact.map_or_else(Vec::new, |contact| contact.overlaps(&self.state.x));
        found.iter().filter(|overlap| is_wanted(overlap)).map(|overlap| overlap.bodies).collect()
    }

    /// Whether there is a memory of a contact of two bodies.
    fn have_touched(&self, bodies: [usize; 2]) -> bool {
        let [one, other] = bodies;
        let owners = |effect: u32| self.scene.effects.get(effect as usize)?.surface_contact();
        let known = self.state.anchors.iter().map(|anchor| anchor.contact);
        let mut owners = known.filter_map(|contact| owners(contact.effect)?.owners(contact));
        owners.any(|owners| owners == [one, other] || owners == [other, one])
    }

    fn set_aside(&mut self, aside: Vec<[usize; 2]>) {
        for effect in &mut self.scene.effects {
            if let Some(other) = effect.setting_aside(&aside) {
                *effect = other;
                // Pairs are of the old contact.
                self.scratch.contacts = Contacts::default();
                self.scratch.workspace.forget();
            }
        }
        self.overlaps.aside = aside;
        self.regions.renew_effects(&self.scene);
    }

    /// Moves bodies that overlap apart for a time h \[s\], without a change of their velocities: rigidly, in the inverse ratio of
    /// their masses, or one alone where the other is held. The energy that this takes counts as supplied.
    ///
    /// They go the shortest way that no obstacle is in.
    pub(super) fn separate(&mut self, h: f64) {
        if self.overlaps.aside.is_empty() {
            return;
        }
        let Some(contact) = surface_contact(&self.scene) else { return };
        let mut overlaps = contact.overlaps(&self.state.x);
        overlaps.retain(|overlap| self.overlaps.aside.contains(&overlap.bodies));
        let left: Vec<_> = overlaps.iter().map(|overlap| overlap.bodies).collect();
        if left != self.overlaps.aside {
            self.set_aside(left);
        }
        if overlaps.is_empty() {
            return;
        }
        for body in overlaps.iter().flat_map(|overlap| overlap.bodies) {
            self.wake_whole(body);
        }
        (self.scratch.clear_box, self.scratch.displacement_bound) = (None, -1.0);
        self.shape += 1;
        let before = self.energies().total();
        let start = self.state.x.clone();
        let (mut end, mut v) = (start.clone(), self.state.v.clone());
        let time = [self.state.time; 2];
        let acting = (&self.scene, self.regions.effects(&self.scene));
        let mut system = System::begin(acting, &mut self.scratch, self.grab, time, &mut self.state);
        for overlap in &overlaps {
            let shares = shares(&self.scene, overlap.bodies);
            let end_of = |way: [f64; 2], end: &[f64]| moved(&self.scene, (overlap.bodies, shares), way, end);
            let is_free = |way: &&[f64; 2]| !system.meets_obstacle(&start, &end_of(**way, &start));
            let Some([x, y]) = overlap.ways.iter().find(is_free).or(overlap.ways.first()).copied() else { continue };
            let part = (h * overlap.speed / libm::hypot(x, y)).min(1.0);
            end = end_of([part * x, part * y], &end);
        }
        system.keep_apart(&start, &mut end, &mut v);
        system.end(0.0, &mut self.state);
        (self.state.x, self.state.v) = (end, v);
        // What an integrator remembers belongs to the old positions.
        self.state.memory.clear();
        self.shape += 1;
        let supplied = self.energies().total() - before;
        self.guard.supply(supplied);
    }
}

/// Shares of two bodies in a displacement that moves them apart.
fn shares(scene: &Scene, bodies: [usize; 2]) -> [f64; 2] {
    let masses = bodies.map(|body| {
        let numbers = scene.numbers(&scene.bodies[body].vertices);
        let is_held = scene.inverse_mass[numbers.clone()].contains(&0.0);
        if is_held { f64::INFINITY } else { scene.mass[numbers].iter().sum() }
    });
    match masses.map(f64::is_finite) {
        [true, true] => [masses[1], masses[0]].map(|mass| mass / (masses[0] + masses[1])),
        [one, other] => [one, other].map(|moves| if moves { 1.0 } else { 0.0 }),
    }
}

/// Positions \[m\] after two bodies have moved apart by a displacement of the second relative to the first.
fn moved(scene: &Scene, (bodies, shares): ([usize; 2], [f64; 2]), way: [f64; 2], x: &[f64]) -> Vec<f64> {
    let mut x = x.to_vec();
    for ((body, share), sign) in bodies.into_iter().zip(shares).zip([-1.0, 1.0]) {
        for point in x[scene.numbers(&scene.bodies[body].vertices)].as_chunks_mut::<2>().0 {
            *point = [0, 1].map(|axis| point[axis] + sign * share * way[axis]);
        }
    }
    x
}

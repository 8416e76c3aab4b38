//! Sleep of regions of bodies: a part of a body is not computed while the rest of the body moves.
//!
//! The vertices of a body are divided into regions of about equal size by their positions at rest. L is the size of a region, epsilon
//! the [tolerance](crate::level::Sleep::Regions), and tau the time below the threshold before sleep ([`super::sleep`]).
//!
//! - A region falls asleep when for tau no vertex of it, and of the regions beside it, has been faster than epsilon L / tau: within tau none has moved
//!   farther than epsilon L. Its velocities become zero.
//! - It wakes when a vertex of a region beside it has moved farther than epsilon L from where it was when the region fell asleep. Each region in a row may
//!   hide a strain of about epsilon from the next, so that all together are off by about epsilon times the size of the body.
//! - Regions are beside each other if they have a common triangle, or if they press on each other. Bodies, nets and membranes without regions count as
//!   one region each.
//! - The last regions of a body that are awake do not fall asleep in this way, but with the body as a whole, by the stricter rules for that. If
//!   something pulls the body later, only the regions there wake at first.
//!
//! Sleeping vertices stay in place, as pinned ones do, and triangles all of whose vertices sleep are not computed. Their elastic energy is counted.
//!
//! A body has regions if its elements are linear triangles with lumped mass, and if pins or rollers leave it no rigid motion: in a slow rigid motion,
//! regions would fall asleep again and again, and brake the body. With multirate stepping no body has regions.
//!
//! Mercier-Aubin et al. (*Adaptive rigidification of elastic solids*, ACM Transactions on Graphics 41, 2022) let regions that do not deform move as rigid
//! bodies. Here they do not move, so that masses, forces and schemes stay as they are.

use super::{
    Simulation,
    contacts::surface_contact,
    sleep::{ASLEEP, WINDOW},
};
use crate::{
    effects::{Effect, Motion},
    level::Sleep,
    scene::{Body, Scene},
    state::State,
};
use std::sync::Arc;

/// Fewest and most vertices of a region.
const VERTICES: [usize; 2] = [8, 32];

/// Regions of a body, if it has enough vertices for regions of that size.
const WANTED: usize = 32;

/// Mark of a vertex that belongs to no region.
const NONE: u32 = u32::MAX;

/// A region of a body.
struct Region {
    /// Number of its body.
    part: usize,
    /// Its vertices in the scene, ascending.
    vertices: Vec<u32>,
    /// Displacement that does not matter \[m\].
    allowed: f64,
    /// The regions that have a common triangle with it, ascending.
    neighbours: Vec<u32>,
}

/// All regions of a scene.
#[derive(Default)]
pub(super) struct Regions {
    all: Vec<Region>,
    /// Region of each vertex of the scene.
    of_vertex: Vec<u32>,
    /// Number of bodies, nets and membranes, which come first in the list of the state.
    parts: usize,
    /// Numbers of the sleeping regions, ascending.
    asleep: Vec<usize>,
    /// Which vertices of the scene sleep with a region; empty while none does.
    still: Vec<bool>,
    /// For each effect of the scene, what is left of it while these sleep, if that is less. Empty while none does.
    left: Vec<Option<Arc<dyn Effect>>>,
    /// Effects in place of those of the scene while regions sleep; empty otherwise.
    effects: Vec<Arc<dyn Effect>>,
    /// Scratch: which regions may fall asleep.
    drowsy: Vec<bool>,
}

impl Regions {
    /// Makes those of a scene, all awake; none if its regions do not sleep.
    pub fn new(scene: &Scene) -> Self {
        let mut regions = Self { parts: scene.parts.len(), ..Self::default() };
        let (Sleep::Regions(tolerance), 2) = (scene.sleep, scene.dimension) else { return regions };
        // With multirate stepping each body is a scene of its own. The factor of a consistent mass matrix knows no vertices that stay for a while.
        if !scene.sub_scenes.is_empty() || !scene.coupled_mass.is_empty() {
            return regions;
        }
        regions.of_vertex.resize(scene.mass.len() / 2, NONE);
        let is_apt = |body: &Body| body.elements.six_nodes().is_none() && scene.holds(&body.vertices);
        for (part, body) in scene.bodies.iter().enumerate().filter(|(_, body)| is_apt(body)) {
            let most = (body.vertices.len() / WANTED).clamp(VERTICES[0], VERTICES[1]);
            let mut own = Vec::new();
            divide(&scene.rest, body.vertices.clone().map(|vertex| vertex as u32).collect(), most, &mut own);
            for mut vertices in own {
                vertices.sort_unstable();
                for vertex in &vertices {
                    regions.of_vertex[*vertex as usize] = regions.all.len() as u32;
                }
                let allowed = tolerance.get() * diagonal(&scene.rest, &vertices);
                regions.all.push(Region { part, vertices, allowed, neighbours: Vec::new() });
            }
        }
        for corners in scene.triangles.iter() {
            let own = corners.map(|corner| regions.of_vertex[corner as usize]).map(|region| region as usize);
            for (one, other) in [(0, 1), (1, 2), (2, 0), (1, 0), (2, 1), (0, 2)] {
                if own[one] != own[other]
                    && let Some(region) = regions.all.get_mut(own[one])
                {
                    region.neighbours.push(own[other] as u32);
                }
            }
        }
        for region in &mut regions.all {
            region.neighbours.sort_unstable();
            region.neighbours.dedup();
        }
        regions
    }

    /// Number of regions.
    pub const fn count(&self) -> usize {
        self.all.len()
    }

    /// The effects that act: those of the scene, or where regions sleep those without the triangles that are left out.
    pub fn effects<'a>(&'a self, scene: &'a Scene) -> &'a [Arc<dyn Effect>] {
        if self.effects.is_empty() { &scene.effects } else { &self.effects }
    }

    /// Numbers of the sleeping regions, ascending.
    pub fn asleep(&self) -> &[usize] {
        &self.asleep
    }

    /// Finds the sleeping regions of a state, and the effects that act then.
    pub fn update(&mut self, scene: &Scene, state: &mut State) {
        let is_whole = state.slow_checks.len() == self.parts + self.all.len();
        let mut asleep = std::mem::take(&mut self.drowsy);
        asleep.clear();
        for number in 0..if is_whole { self.all.len() } else { 0 } {
            // A state from elsewhere may say that something sleeps which moves.
            if self.sleeps_alone(&state.slow_checks, number)
                && self.numbers(number).any(|number| state.v[number] != 0.0)
            {
                state.slow_checks[self.parts + number] = 0;
            }
            asleep.push(self.sleeps_alone(&state.slow_checks, number));
        }
        let is_new = !self.asleep.iter().copied().eq(numbers_of(&asleep));
        if is_new {
            self.asleep.clear();
            self.asleep.extend(numbers_of(&asleep));
            self.leave_out(scene);
        }
        self.drowsy = asleep;
        if self.asleep.is_empty() {
            state.calm_positions.clear();
        } else if state.calm_positions.len() != state.x.len() {
            state.calm_positions.clone_from(&state.x);
        }
        self.renew_effects(scene);
    }

    /// Finds what is left of the effects without the triangles of sleeping regions.
    fn leave_out(&mut self, scene: &Scene) {
        self.still.clear();
        self.left.clear();
        if self.asleep.is_empty() {
            return;
        }
        self.still.resize(self.of_vertex.len(), false);
        for vertex in self.asleep.iter().flat_map(|number| &self.all[*number].vertices) {
            self.still[*vertex as usize] = true;
        }
        let moves = |vertex: usize| !self.still[vertex];
        self.left.extend(scene.effects.iter().map(|effect| effect.restricted(&moves)));
    }

    /// Takes the other effects from the scene again.
    pub fn renew_effects(&mut self, scene: &Scene) {
        self.effects.clear();
        let both = scene.effects.iter().zip(&self.left);
        self.effects.extend(both.map(|(effect, left)| Arc::clone(left.as_ref().unwrap_or(effect))));
    }

    /// Numbers of the coordinates of a region in the state.
    pub fn numbers(&self, region: usize) -> impl Iterator<Item = usize> + '_ {
        self.all[region].vertices.iter().flat_map(|vertex| [2 * *vertex as usize, 2 * *vertex as usize + 1])
    }

    /// Place of a vertex in the list of the state: that of its region, or of its body, net or membrane.
    fn place(&self, vertex: u32, owner: usize) -> usize {
        match self.of_vertex.get(vertex as usize) {
            Some(region) if *region != NONE => self.parts + *region as usize,
            _ => owner,
        }
    }

    /// Whether what has a place in the list of the state sleeps, alone or with its body.
    fn is_asleep(&self, slow_checks: &[u32], place: usize) -> bool {
        let sleeps = |place: usize| slow_checks.get(place) == Some(&ASLEEP);
        sleeps(place) || place.checked_sub(self.parts).is_some_and(|region| sleeps(self.all[region].part))
    }

    /// Whether all vertices of a contact that belong to the first of two bodies, nets or membranes sleep, and those of the second. A side without
    /// vertices counts as asleep.
    pub fn asleep_sides(&self, scene: &Scene, slow_checks: &[u32], owners: [usize; 2], vertices: &[u32]) -> [bool; 2] {
        let mut sides = owners.map(|owner| self.is_asleep(slow_checks, owner));
        if self.count() > 0 {
            for (side, owner) in owners.into_iter().enumerate() {
                let own = scene.parts[owner].vertices();
                let mut own = vertices.iter().filter(|vertex| own.contains(&(**vertex as usize)));
                sides[side] = own.all(|vertex| self.is_asleep(slow_checks, self.place(*vertex, owner)));
            }
        }
        sides
    }

    /// Whether a region, by its number, sleeps while its body does not.
    fn sleeps_alone(&self, slow_checks: &[u32], region: usize) -> bool {
        slow_checks[self.parts + region] == ASLEEP && slow_checks[self.all[region].part] != ASLEEP
    }

    /// Wakes all regions of a body.
    pub fn wake_all_of(&self, state: &mut State, part: usize) {
        if state.slow_checks.len() == self.parts + self.all.len() {
            let own =
                self.all.iter().zip(&mut state.slow_checks[self.parts..]).filter(|(region, _)| region.part == part);
            own.for_each(|(_, slow_checks)| *slow_checks = 0);
        }
    }

    /// Wakes the regions around a vertex. In a body that slept as a whole, all others go on sleeping.
    pub fn wake_around(&self, state: &mut State, vertex: usize) {
        let region = self.of_vertex.get(vertex).filter(|region| **region != NONE).map(|region| *region as usize);
        let (Some(region), true) = (region, state.slow_checks.len() == self.parts + self.all.len()) else { return };
        let Region { part, neighbours, .. } = &self.all[region];
        if state.slow_checks[*part] == ASLEEP {
            let has_positions = state.calm_positions.len() == state.x.len();
            for (number, _) in self.all.iter().enumerate().filter(|(_, other)| other.part == *part) {
                state.slow_checks[self.parts + number] = ASLEEP;
                for number in self.numbers(number).filter(|_| has_positions) {
                    state.calm_positions[number] = state.x[number];
                }
            }
        }
        for number in neighbours.iter().map(|other| *other as usize).chain([region]) {
            state.slow_checks[self.parts + number] = 0;
        }
    }
}

/// Numbers of the entries that are true.
fn numbers_of(entries: &[bool]) -> impl Iterator<Item = usize> {
    entries.iter().enumerate().filter(|(_, is_true)| **is_true).map(|(number, _)| number)
}

/// Width and height of the box around vertices at rest \[m\].
fn sides(rest: &[f64], vertices: &[u32]) -> [f64; 2] {
    [0, 1].map(|axis| {
        let all = vertices.iter().map(|vertex| rest[2 * *vertex as usize + axis]);
        all.clone().fold(f64::NEG_INFINITY, f64::max) - all.fold(f64::INFINITY, f64::min)
    })
}

/// Diagonal of the box around vertices at rest \[m\].
fn diagonal(rest: &[f64], vertices: &[u32]) -> f64 {
    let [width, height] = sides(rest, vertices);
    libm::hypot(width, height)
}

/// Divides vertices at the middle of the longer side of the box around them until each group has at most so many.
fn divide(rest: &[f64], mut vertices: Vec<u32>, most: usize, groups: &mut Vec<Vec<u32>>) {
    if vertices.len() <= most {
        groups.push(vertices);
        return;
    }
    let along = |vertex: u32, axis: usize| rest[2 * vertex as usize + axis];
    let [width, height] = sides(rest, &vertices);
    let axis = usize::from(height > width);
    vertices.sort_unstable_by(|a, b| along(*a, axis).total_cmp(&along(*b, axis)).then(a.cmp(b)));
    let others = vertices.split_off(vertices.len() / 2);
    divide(rest, vertices, most, groups);
    divide(rest, others, most, groups);
}

impl Simulation {
    /// Number of sleeping regions of bodies that are awake otherwise, and of all regions.
    pub const fn sleeping_regions(&self) -> [usize; 2] {
        [self.regions.asleep.len(), self.regions.all.len()]
    }

    /// Which vertices sleep with regions of bodies that are awake otherwise; empty while none does.
    pub fn still_vertices(&self) -> &[bool] {
        &self.regions.still
    }

    /// Number of triangles of bodies that a step computes now.
    pub const fn computed_triangles(&self) -> usize {
        self.scratch.plan.triangles
    }

    /// Counts the checks in which regions were slow.
    pub(super) fn count_slow_regions(&mut self) {
        let Self { regions, state, grab, .. } = self;
        let pulled = grab.map(|grab| regions.place(grab.vertex as u32, 0));
        for (number, region) in regions.all.iter().enumerate() {
            let place = regions.parts + number;
            if regions.is_asleep(&state.slow_checks, place) {
                continue;
            }
            let mut speeds = regions.numbers(number).map(|number| state.v[number].abs());
            // NaN counts as fast.
            let is_slow = speeds.all(|v| v <= region.allowed / WINDOW);
            let slow_checks = &mut state.slow_checks[place];
            *slow_checks =
                if is_slow && pulled != Some(place) { slow_checks.saturating_add(1).min(ASLEEP - 1) } else { 0 };
        }
    }

    /// Puts regions to sleep that were slow for so many checks, as was everything beside them; to be called after the checkpoint of a
    /// step was set.
    pub(super) fn regions_fall_asleep(&mut self, checks: u32) {
        let Self { regions, checkpoint, scene, scratch, grab, .. } = self;
        let slow_checks = &checkpoint.state.slow_checks;
        if regions.count() == 0 || slow_checks.len() != regions.parts + regions.count() {
            return;
        }
        let mut drowsy = std::mem::take(&mut regions.drowsy);
        regions.find_drowsy(slow_checks, checks, &mut drowsy);
        // Vertices of contacts with something that sleeps, whose displacement counts on; and those of all contacts of regions.
        let (mut beside, mut touching) = (Vec::new(), Vec::new());
        if drowsy.contains(&true)
            && let Some(contact) = surface_contact(scene)
        {
            scratch.contacts.update(scene, &checkpoint.state.x);
            let motion = scene.motion(&checkpoint.state, *grab);
            let motion = Motion { candidates: Some(&scratch.contacts.candidates), ..motion };
            contact.each_pressing(motion, &mut |owners, vertices| {
                let places = || places(regions, scene, owners, vertices);
                if places().any(|place| slow_checks[place] < checks && !regions.is_asleep(slow_checks, place)) {
                    places()
                        .filter_map(|place| place.checked_sub(regions.parts))
                        .for_each(|region| drowsy[region] = false);
                }
                if places().any(|place| regions.is_asleep(slow_checks, place)) {
                    beside.extend_from_slice(vertices);
                }
                let own = places().filter_map(|place| place.checked_sub(regions.parts));
                touching.extend(own.map(|region| (region, vertices.to_vec())));
            });
        }
        regions.keep_last(slow_checks, &mut drowsy);
        let any = drowsy.contains(&true);
        if any {
            touching.retain(|(region, _)| drowsy[*region]);
            let touching: Vec<_> = touching.into_iter().flat_map(|(_, vertices)| vertices).collect();
            regions.put_to_sleep(&drowsy, [&beside, &touching], &mut checkpoint.state);
        }
        regions.drowsy = drowsy;
        if any {
            self.joined = false;
            self.state.clone_from(&self.checkpoint.state);
            self.scratch.displacement_bound = -1.0;
            self.revision += 1;
            self.shape += 1;
            self.apply_sleep();
        }
    }

    /// Before a body is tested for sleep as a whole, its regions wake.
    pub(super) fn wake_regions_of_slow(&mut self, checks: u32) {
        let Self { regions, checkpoint, state, .. } = self;
        let is_slow = |part: usize| state.slow_checks[part] >= checks && state.slow_checks[part] != ASLEEP;
        let mut parts: Vec<_> = regions.asleep.iter().map(|region| regions.all[*region].part).collect();
        parts.retain(|part| is_slow(*part));
        parts.dedup();
        if parts.is_empty() {
            return;
        }
        for part in parts {
            regions.wake_all_of(state, part);
            regions.wake_all_of(&mut checkpoint.state, part);
        }
        self.apply_sleep();
        self.checkpoint.state.calm_positions.clone_from(&self.state.calm_positions);
    }

    /// Wakes sleeping regions beside which something has moved too far.
    pub(super) fn wake_beside(&mut self) {
        let Self { regions, scene, state, scratch, grab, .. } = self;
        if regions.asleep.is_empty() || state.calm_positions.len() != state.x.len() {
            return;
        }
        let mut woken = Vec::new();
        for (number, region) in regions.all.iter().enumerate() {
            let beside = || region.neighbours.iter().map(|other| *other as usize);
            let asleep = || beside().filter(|other| regions.sleeps_alone(&state.slow_checks, *other));
            let is_awake = !regions.is_asleep(&state.slow_checks, regions.parts + number);
            if is_awake && asleep().next().is_some() {
                let moved = moved(state, &region.vertices);
                woken.extend(asleep().filter(|other| moved > regions.all[*other].allowed));
            }
        }
        if let Some(contact) = surface_contact(scene) {
            scratch.contacts.update(scene, &state.x);
            let motion = Motion { candidates: Some(&scratch.contacts.candidates), ..scene.motion(state, *grab) };
            contact.each_pressing(motion, &mut |owners, vertices| {
                let moved = moved(state, vertices);
                let own = places(regions, scene, owners, vertices).filter_map(|place| place.checked_sub(regions.parts));
                let own = own.filter(|region| regions.sleeps_alone(&state.slow_checks, *region));
                woken.extend(own.filter(|region| moved > regions.all[*region].allowed));
            });
        }
        if woken.is_empty() {
            return;
        }
        for region in woken {
            state.slow_checks[regions.parts + region] = 0;
        }
        self.stale = true;
        self.apply_sleep();
    }
}

impl Regions {
    /// Finds the regions that are awake and were slow for so many checks, as was what has common triangles with them. Bodies that are slow as a whole are
    /// left to [`Simulation::fall_asleep`].
    fn find_drowsy(&self, slow_checks: &[u32], checks: u32, drowsy: &mut Vec<bool>) {
        let is_slow = |place: usize| slow_checks[place] >= checks;
        drowsy.clear();
        drowsy.extend(self.all.iter().enumerate().map(|(number, region)| {
            let mut beside = region.neighbours.iter().map(|other| self.parts + *other as usize);
            let is_awake = !self.is_asleep(slow_checks, self.parts + number);
            is_awake && is_slow(self.parts + number) && !is_slow(region.part) && beside.all(is_slow)
        }));
    }

    /// Keeps the last regions of a body awake: they fall asleep with the body as a whole.
    fn keep_last(&self, slow_checks: &[u32], drowsy: &mut [bool]) {
        for part in 0..self.parts {
            let own =
                || self.all.iter().enumerate().filter(|(_, region)| region.part == part).map(|(number, _)| number);
            let mut awake = own().filter(|region| !self.is_asleep(slow_checks, self.parts + region));
            if awake.all(|region| drowsy[region]) {
                own().for_each(|region| drowsy[region] = false);
            }
        }
    }

    /// Puts regions of a state to sleep. The displacement of their vertices, and of those beside them, counts from where they are now; but not of
    /// those that were beside something asleep before. `beside` are vertices of contacts with something asleep, and `touching` those of contacts of these regions.
    fn put_to_sleep(&self, drowsy: &[bool], [beside, touching]: [&[u32]; 2], state: &mut State) {
        let State { x, v, slow_checks, calm_positions, .. } = state;
        if calm_positions.len() == x.len() {
            let sleeps = |other: &u32| self.sleeps_alone(slow_checks, *other as usize);
            let is_beside = |region: &&Region| region.neighbours.iter().any(sleeps);
            let mut counts_on = vec![false; self.of_vertex.len()];
            let of_regions = self.all.iter().filter(is_beside).flat_map(|region| &region.vertices);
            of_regions.chain(beside).for_each(|vertex| counts_on[*vertex as usize] = true);
            let around = numbers_of(drowsy).flat_map(|number| {
                let neighbours = self.all[number].neighbours.iter().map(|other| *other as usize);
                neighbours.chain([number]).flat_map(|region| &self.all[region].vertices)
            });
            for vertex in around.chain(touching).map(|vertex| *vertex as usize).filter(|vertex| !counts_on[*vertex]) {
                calm_positions[2 * vertex..2 * vertex + 2].copy_from_slice(&x[2 * vertex..2 * vertex + 2]);
            }
        } else {
            calm_positions.clone_from(x);
        }
        for number in numbers_of(drowsy) {
            slow_checks[self.parts + number] = ASLEEP;
            self.numbers(number).for_each(|number| v[number] = 0.0);
        }
    }
}

/// Greatest distance along an axis that one of these vertices has moved from where it was when something beside it fell asleep \[m\]; infinite if any is NaN.
fn moved(state: &State, vertices: &[u32]) -> f64 {
    let numbers = vertices.iter().flat_map(|vertex| 2 * *vertex as usize..2 * *vertex as usize + 2);
    let moved = numbers.map(|number| (state.x[number] - state.calm_positions[number]).abs());
    moved.fold(0.0, |most: f64, moved| if moved.is_nan() { f64::INFINITY } else { most.max(moved) })
}

/// Places in the list of the state of the vertices of a contact between two bodies, nets or membranes.
fn places<'a>(
    regions: &'a Regions,
    scene: &'a Scene,
    owners: [usize; 2],
    vertices: &'a [u32],
) -> impl Iterator<Item = usize> + 'a {
    vertices.iter().map(move |vertex| {
        let is_own = |owner: &usize| scene.parts[*owner].vertices().contains(&(*vertex as usize));
        regions.place(*vertex, owners.into_iter().find(is_own).unwrap_or(owners[0]))
    })
}

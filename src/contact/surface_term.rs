//! Contact of surfaces with each other, by the calls that know neither the dimension nor what touches what.

use super::{
    Anchor, AnyContact, Candidates, ContactModel, ContactName, Means, Overlap, Pair, Potential, Surface,
    SurfaceVertices, Truncation,
};
use crate::effects::Motion;

/// Contact of the surfaces of a scene with each other and with themselves.
pub trait SurfaceTerm: Send + Sync {
    /// Contact by a potential.
    fn contact(&self) -> AnyContact<'_>;

    /// Tells it the number of its effect in the scene.
    fn set_number(&mut self, number: usize);

    /// Number of places at positions x \[m\] where surfaces have crossed, by an exact test that is independent of how contact is
    /// computed: zero is a proof.
    fn count_crossings(&self, x: &[f64]) -> usize;

    /// The bodies that should touch and overlap at positions x \[m\], or are nearer to each other than the thickness of their skin.
    fn overlaps(&self, _x: &[f64]) -> Vec<Overlap> {
        Vec::new()
    }

    /// The same contact, in which these pairs of bodies, by their numbers, do not touch, and all others as the level says; `None` if
    /// it is so already.
    fn setting_aside(&self, _bodies: &[[usize; 2]]) -> Option<Box<dyn SurfaceTerm>> {
        None
    }

    /// Numbers of the two bodies or nets of a contact.
    fn owners(&self, _contact: ContactName) -> Option<[usize; 2]> {
        None
    }

    /// Makes the candidates contain all pairs that may touch at positions x \[m\] with this memory of contacts: those that are near
    /// each other, and those with an initial penetration.
    fn update(&self, candidates: &mut Candidates, x: &[f64], anchors: &[Anchor]);

    /// Adds the pairs that are near at positions x \[m\], in their order: a function of the positions alone.
    fn add_near(&self, candidates: &Candidates, x: &[f64], near: &mut Vec<Pair>);

    /// Calls `act` with the numbers of the bodies, nets or membranes of each pair that presses on each other, and with its vertices.
    fn each_pressing(&self, motion: Motion<'_>, act: &mut dyn FnMut([usize; 2], &[u32]));

    /// Largest multiple of the displacement from positions x to `end` \[m\] in which no surfaces meet.
    fn longest_step(&self, scratch: &mut Truncation, candidates: &mut Candidates, x: &[f64], end: &[f64]) -> f64;

    /// Whether a step from `start` to x \[m\] has pairs that meet.
    fn meets(&self, scratch: &mut Truncation, candidates: &mut Candidates, start: &[f64], x: &[f64]) -> bool;

    /// Changes positions and velocities at the end of a step from the positions and with the inverse masses of `start` so that no
    /// surfaces have crossed. Returns the number of pairs that met.
    fn truncate(
        &self,
        scratch: (&mut Truncation, &mut Candidates),
        means: Means,
        start: (&[f64], &[f64]),
        end: [&mut [f64]; 2],
    ) -> usize;
}

/// Calls `act` with the candidates at the positions of a motion: its own, or new ones.
pub(super) fn with_candidates(term: &dyn SurfaceTerm, motion: Motion<'_>, act: impl FnOnce(&Candidates)) {
    if let Some(candidates) = motion.candidates {
        return act(candidates);
    }
    let mut candidates = Candidates::default();
    term.update(&mut candidates, motion.x, motion.anchors);
    act(&candidates);
}

/// What holds between two parts.
#[derive(Clone)]
pub(super) struct Between {
    pub potential: Potential,
    /// mu.
    pub friction: f64,
    /// Whether they do not touch by the level.
    pub is_apart: bool,
    /// Whether they overlap and do not touch until they are out of each other.
    pub is_set_aside: bool,
}

impl Between {
    /// Whether they touch.
    pub const fn touch(&self) -> bool {
        !self.is_apart && !self.is_set_aside
    }

    /// What holds between each two parts, by `first * parts + second`.
    pub fn all(model: &ContactModel, surface: &SurfaceVertices) -> Vec<Self> {
        let parts = surface.parts();
        let between = |at: usize| {
            let pair = [at / parts, at % parts];
            let [one, other] = pair.map(|part| surface.owner(part as u32));
            Self {
                potential: surface.potential_between(model.skin, pair),
                friction: model.friction.between(Surface::Owner(one), Surface::Owner(other)),
                is_apart: model.apart.contains(&[one, other]) || model.apart.contains(&[other, one]),
                is_set_aside: false,
            }
        };
        (0..parts * parts).map(between).collect()
    }
}

//! Vertex numbers of the level, which may differ from those in the scene; see [`Numbering`].

use super::{Owner, Scene};
use crate::{meshes::Numbering, state::State};
use std::{borrow::Cow, ops::Range};

impl Scene {
    /// The body or net that a vertex belongs to, and its number there as a level counts.
    pub fn owner_of(&self, vertex: usize) -> Option<(Owner, usize)> {
        let (owner, vertices, numbering) = self.owners().find(|(_, vertices, _)| vertices.contains(&vertex))?;
        Some((owner, numbering.name((vertex - vertices.start) as u32) as usize))
    }

    /// The place of a vertex where the level lists all of them, as in a saved state.
    pub fn listed_vertex(&self, vertex: usize) -> Option<usize> {
        let (_, vertices, numbering) = self.owners().find(|(_, vertices, _)| vertices.contains(&vertex))?;
        Some(vertices.start + numbering.name((vertex - vertices.start) as u32) as usize)
    }

    /// The vertex at a place where the level lists all of them.
    pub fn unlisted_vertex(&self, place: usize) -> Option<usize> {
        let (_, vertices, numbering) = self.owners().find(|(_, vertices, _)| vertices.contains(&place))?;
        Some(vertices.start + numbering.vertex((place - vertices.start) as u32) as usize)
    }

    /// Positions or velocities of all vertices, flat, as the level lists them.
    pub fn listed<'a>(&self, values: &'a [f64]) -> Cow<'a, [f64]> {
        self.rearranged(values, |[vertex, name]| [vertex, name])
    }

    /// Positions or velocities of all vertices, flat, from how the level lists them.
    pub(super) fn unlisted(&self, values: &[f64]) -> Vec<f64> {
        self.rearranged(values, |[vertex, name]| [name, vertex]).into_owned()
    }

    /// A state with its vertices as the level lists them, for saving. The memory of the integrator keeps the order of
    /// the scene.
    pub fn listed_state<'a>(&self, state: &'a State) -> Cow<'a, State> {
        match (self.listed(&state.x), self.listed(&state.v)) {
            (Cow::Owned(x), Cow::Owned(v)) => Cow::Owned(State { x, v, ..state.clone() }),
            _ => Cow::Borrowed(state),
        }
    }

    /// All bodies and nets.
    fn owners(&self) -> impl Iterator<Item = (Owner, Range<usize>, &Numbering)> {
        let bodies = self.bodies.iter().enumerate();
        let bodies = bodies.map(|(number, body)| (Owner::Body(number), body.vertices.clone(), body.mesh.numbering()));
        let nets = self.nets.iter().enumerate();
        bodies.chain(nets.map(|(number, net)| (Owner::Net(number), net.vertices.clone(), &net.numbering)))
    }

    /// Moves values from the first of two numbers to the second, both computed from a vertex and its name.
    fn rearranged<'a>(&self, values: &'a [f64], way: impl Fn([usize; 2]) -> [usize; 2]) -> Cow<'a, [f64]> {
        let mut values = Cow::Borrowed(values);
        for (_, vertices, numbering) in self.owners().filter(|(_, _, numbering)| !numbering.is_as_listed()) {
            let before = values[self.numbers(&vertices)].to_vec();
            let now = &mut values.to_mut()[self.numbers(&vertices)];
            for vertex in 0..vertices.len() {
                let [from, to] = way([vertex, numbering.name(vertex as u32) as usize]);
                let [from, to] = [from, to].map(|vertex| self.numbers(&(vertex..vertex + 1)));
                now[to].copy_from_slice(&before[from]);
            }
        }
        values
    }
}

//! Refinement of meshes while a scene runs: the state goes over to the new mesh.

use super::{Refused, Sandbox, Then};
use crate::{
    document::Document,
    level::Pin,
    meshes::Refined,
    quantity::Point,
    report::Energies,
    scene::{Correspondence, Owner, Scene, StressErrors},
    state::State,
};
use std::collections::BTreeMap;

/// What a refinement changed: the state before, on the old mesh, and after, on the new one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshChange {
    /// Number of triangles of all bodies and membranes.
    pub triangles: [usize; 2],
    /// Energies \[J\].
    pub energies: [Energies; 2],
    /// Linear momentum [kg m/s].
    pub momentum: [[f64; 3]; 2],
}

impl Sandbox {
    /// Divides triangles, by their numbers in the scene: of the bodies, then of the membranes.
    pub(super) fn refine(&mut self, triangles: &[usize]) -> Result<(), Refused> {
        let scene = self.simulation.scene();
        let mut document = self.document.clone();
        // Bodies that are shown side by side are one body of the level.
        let mut divided: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
        for (part, names) in scene.divided(triangles) {
            divided.entry(document.source(part)).or_default().extend(names);
        }
        if divided.is_empty() {
            return Err(Refused::NotHere("there is no such triangle"));
        }
        for (part, mut names) in divided {
            names.sort_unstable();
            names.dedup();
            self.keep_rules(&mut document, part)?;
            let Some(mesh) = document.mesh_mut(part) else { continue };
            *mesh = Refined::of(mesh.clone(), names).into();
        }
        document.level.state = None;
        // What was recorded ended in another state.
        document.level.recorded = None;
        self.change(document, Then::Carry, None)
    }

    /// Changes rules of a part that would name other vertices of a mesh with more of them.
    fn keep_rules(&self, document: &mut Document, part: usize) -> Result<(), Refused> {
        const EDGES: Refused = Refused::NotHere(
            "an effect names edges of this mesh by single vertices: name them by a side, a box or a disk, so that it still acts on them",
        );
        const RANDOM: Refused =
            Refused::NotHere("an effect acts on vertices of this mesh that are chosen at random: name them");
        let scene = self.simulation.scene();
        let listed = self.flat_points(part);
        // The nodes at the middles of sides have other numbers afterwards.
        let is_renumbered = scene.bodies.get(part).is_some_and(|body| body.elements.kind().has_six_nodes());
        let place = |vertex: usize| listed.get(vertex).map(|point| Pin::Nearest(*point));
        let keep = |pin: &mut Pin| match *pin {
            Pin::Vertex(vertex) if is_renumbered => *pin = place(vertex as usize).unwrap_or(*pin),
            // A new vertex may be nearer to the point.
            Pin::Nearest(point) => *pin = nearest(&listed, point).and_then(place).unwrap_or(*pin),
            _ => {}
        };
        if document.pins_mut(part).is_some_and(|pins| pins.iter().any(|pin| matches!(pin, Pin::Random { .. }))) {
            let owner = match part.checked_sub(scene.bodies.len() + scene.nets.len()) {
                Some(number) => Owner::Membrane(number),
                None => Owner::Body(part),
            };
            document.set_pinned(owner, &self.pins_of(owner));
        }
        document.pins_mut(part).into_iter().flatten().for_each(keep);
        let names: Vec<_> = document.level.part_names().cloned().collect();
        for effect in &mut document.level.effects {
            let Some(rules) = effect.effect.kind_mut().rules_mut() else { continue };
            if rules.of.as_ref().is_some_and(|of| names.get(part).is_none_or(|name| name != of)) {
                continue;
            }
            let is_single = |pin: &Pin| matches!(pin, Pin::Vertex(_) | Pin::Nearest(_) | Pin::Random { .. });
            if rules.are_of_edges && rules.pins.iter().any(is_single) {
                return Err(EDGES);
            }
            if rules.pins.iter().any(|pin| matches!(pin, Pin::Random { .. })) {
                return Err(RANDOM);
            }
            // One point cannot name vertices of several parts.
            if rules.of.is_some() || names.len() == 1 {
                rules.pins.iter_mut().for_each(keep);
            }
        }
        Ok(())
    }

    /// Positions of the vertices of a part in its own plane, in the order of the level \[m\]; of a body, at the place of that of the document.
    pub(super) fn flat_points(&self, part: usize) -> Vec<Point> {
        let scene = self.simulation.scene();
        if part < scene.bodies.len() {
            return self.rest_points(part);
        }
        let Some(shape) = scene.elements.shapes.get(part) else { return Vec::new() };
        let points = shape.points.as_chunks().0;
        let listed = (0..points.len()).map(|name| points[shape.numbering.vertex(name as u32) as usize]);
        listed.map_while(|point| Point::new(point).ok()).collect()
    }

    /// Divides the fewest triangles that have together half of the sum of the squared errors of the stress.
    pub(super) fn refine_worst(&mut self) -> Result<(), Refused> {
        let simulation = &self.simulation;
        let worst = simulation.scene().stress_errors(&simulation.state().x).worst(StressErrors::HALF);
        if worst.is_empty() {
            return Err(Refused::NotHere(
                "the estimated error of the stress is zero in every triangle: deform a body or membrane first",
            ));
        }
        self.refine(&worst)
    }

    /// The present state on the meshes of another scene of the same level. Friction and the memory of the integrator begin anew.
    pub(super) fn carried(&self, scene: &Scene) -> Option<State> {
        let state = self.simulation.state();
        let places = Correspondence::new(scene, self.simulation.scene())?;
        let (mut x, mut v) = (places.seen(&state.x).into_owned(), places.seen(&state.v).into_owned());
        v.iter_mut().zip(&scene.inverse_mass).filter(|(_, inverse)| **inverse == 0.0).for_each(|(v, _)| *v = 0.0);
        scene.place_held(state.time, &mut x, &mut v);
        // Nothing sleeps: the finer mesh has another equilibrium.
        Some(State { x, v, time: state.time, steps: state.steps, ..State::default() })
    }

    /// Number of triangles, energies and momentum now.
    pub(super) fn measured_mesh(&self) -> (usize, Energies, [f64; 3]) {
        let [momentum, _] = self.simulation.momenta();
        let triangles = self.simulation.scene().triangle_parts().map(|(.., mesh)| mesh.triangles().len()).sum();
        (triangles, self.simulation.energies(), momentum)
    }

    /// What the last refinement changed, until another scene is shown.
    pub const fn mesh_change(&self) -> Option<MeshChange> {
        self.mesh_change
    }
}

/// The point that is nearest to another, by its number; the first of equals.
fn nearest(points: &[Point], to: Point) -> Option<usize> {
    let [x, y] = to.get();
    let square = |point: &Point| (point.get()[0] - x).powi(2) + (point.get()[1] - y).powi(2);
    (0..points.len()).min_by(|a, b| square(&points[*a]).total_cmp(&square(&points[*b])))
}

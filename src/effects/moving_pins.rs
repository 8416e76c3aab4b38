//! Effect: pinned vertices that move along a path.

use super::{Effect, EffectParameters, Motion, Rules};
use crate::{
    elements::Elements,
    meshes::Pin,
    obstacles::{MotionKind, Rigid, check, placed},
    quantity::Quantity,
    solvers::ConstraintRows,
};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Vertices of a body, net or membrane that are held, and move as they are told: a hand that waves, the edge of a flag or of a
/// trampoline. Their positions are closed functions of time, as those of [moving obstacles](crate::obstacles::Moving): each stage of a scheme takes them at
/// its own time. They do what work that takes.
///
/// A vertex with the position X at the start is at `R(t) X + r(t)`, and has that velocity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MovingPins {
    /// Name of the body, net or membrane; all, if it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
    /// Which of its vertices.
    pub pins: Vec<Pin>,
    /// How they move: each motion takes along what the ones before it have moved.
    pub motions: Vec<MotionKind>,
}

impl Default for MovingPins {
    fn default() -> Self {
        let motions = vec![MotionKind::Swing(crate::obstacles::Swing::default())];
        Self { of: None, pins: vec![Pin::Left], motions }
    }
}

impl EffectParameters for MovingPins {
    fn title(&self) -> &'static str {
        "Moving pins"
    }

    fn about(&self) -> &'static str {
        "Vertices are held and move along a path, x(t) = R(t) X + r(t), whatever pulls at them."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        self.motions.iter_mut().flat_map(|motion| motion.kind_mut().parameters()).collect()
    }

    fn rules_mut(&mut self) -> Option<Rules<'_>> {
        Some(Rules { of: &mut self.of, pins: &mut self.pins, are_of_edges: false })
    }

    fn build(&self, elements: &Elements) -> Result<Box<dyn Effect>, String> {
        let vertices = elements.pinned(self.of.as_deref(), &self.pins)?;
        if vertices.is_empty() {
            return Err("its list of pins names no vertex".to_owned());
        }
        let dimension = elements.dimension();
        check(&self.motions, dimension)?;
        let (motions, start) = (self.motions.clone(), Arc::clone(&elements.start));
        Ok(Box::new(HeldVertices { vertices, motions, start, dimension }))
    }
}

/// Vertices with prescribed positions, built.
pub struct HeldVertices {
    vertices: Vec<u32>,
    motions: Vec<MotionKind>,
    /// Positions at the start \[m\].
    start: Arc<Vec<f64>>,
    dimension: usize,
}

impl HeldVertices {
    /// The vertices, by their numbers in the scene.
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// Writes their positions \[m\] and velocities [m/s] at a time \[s\].
    pub fn place(&self, time: f64, x: &mut [f64], v: &mut [f64]) {
        match self.dimension {
            2 => self.place_in::<2>(time, x, v),
            _ => self.place_in::<3>(time, x, v),
        }
    }

    /// Tells constraints their accelerations at a time \[s\], by central differences of their velocities.
    pub fn accelerate(&self, time: f64, rows: &mut ConstraintRows) {
        match self.dimension {
            2 => self.accelerate_in::<2>(time, rows),
            _ => self.accelerate_in::<3>(time, rows),
        }
    }

    fn accelerate_in<const D: usize>(&self, time: f64, rows: &mut ConstraintRows) {
        /// Far shorter than any period \[s\], and far longer than round-off of velocities.
        const APART: f64 = 1e-4;
        let [before, after] = [-APART, APART].map(|by| placed::<D>(&self.motions, time + by));
        for vertex in &self.vertices {
            let first = D * *vertex as usize;
            let start = std::array::from_fn(|axis| self.start[first + axis]);
            let [v, next] = [&before, &after].map(|at| at.velocity_at(at.point(start)));
            for axis in 0..D {
                rows.accelerate(first + axis, (next[axis] - v[axis]) / (2.0 * APART));
            }
        }
    }

    fn place_in<const D: usize>(&self, time: f64, x: &mut [f64], v: &mut [f64]) {
        let at: Rigid<D> = placed(&self.motions, time);
        for vertex in &self.vertices {
            let own = D * *vertex as usize..D * (*vertex as usize + 1);
            let point = at.point(std::array::from_fn(|axis| self.start[own.start + axis]));
            x[own.clone()].copy_from_slice(&point);
            v[own].copy_from_slice(&at.velocity_at(point));
        }
    }
}

impl Effect for HeldVertices {
    fn name(&self) -> &'static str {
        "Moving pins"
    }

    fn elements(&self, _: Motion<'_>) -> usize {
        self.vertices.len()
    }

    fn is_steady(&self) -> bool {
        false
    }

    fn held_vertices(&self) -> Option<&HeldVertices> {
        Some(self)
    }
}

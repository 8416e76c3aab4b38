//! Effect: tractions and pressure on edges of bodies.

use super::{Effect, EffectParameters, Motion, Rules, ZERO, power_of_force};
use crate::{
    elements::Elements,
    meshes::{Pin, boundary_edges},
    quantity::{Pressure, Quantity, Time, TractionX, TractionY},
    solvers::{Block, SparseMatrix, Tangent, Weights},
};
use serde::{Deserialize, Serialize};

/// A load on the boundary edges both ends of which some rules name: a traction that keeps its direction, and a pressure that follows the edges.
///
/// With the length L at rest, the edge d from the first to the second end with the body on its left, and the outward normal times the length
/// `N = (d_y, -d_x)`, each end has half of `s(t) (L t - p N)`, for a sheet of 1 m thickness. `s` rises from 0 to 1 within the time `ramp`, evenly, and is 1 from then on.
///
/// The stiffness of the pressure is symmetric along a boundary, where it is the second derivative of `p` times the area inside; at the two ends of a loaded part
/// it has an antisymmetric block, which is omitted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EdgeLoad {
    /// Name of the body; all, if it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
    /// Rules that name the ends of the loaded edges.
    pub edges: Vec<Pin>,
    /// t \[Pa\].
    #[serde(default = "none", skip_serializing_if = "is_none")]
    pub traction: (TractionX, TractionY),
    /// p \[Pa\]: positive from outside.
    #[serde(default = "no_pressure", skip_serializing_if = "is_no_pressure")]
    pub pressure: Pressure,
    /// Time in which the load rises \[s\].
    #[serde(default = "at_once", skip_serializing_if = "is_at_once")]
    pub ramp: Time,
}

const fn none() -> (TractionX, TractionY) {
    (TractionX::literal(0.0), TractionY::literal(0.0))
}

fn is_none(traction: &(TractionX, TractionY)) -> bool {
    *traction == none()
}

const fn no_pressure() -> Pressure {
    Pressure::literal(0.0)
}

fn is_no_pressure(pressure: &Pressure) -> bool {
    *pressure == no_pressure()
}

const fn at_once() -> Time {
    Time::literal(0.0)
}

fn is_at_once(ramp: &Time) -> bool {
    *ramp == at_once()
}

impl Default for EdgeLoad {
    fn default() -> Self {
        let traction = (TractionX::literal(0.0), TractionY::literal(-100.0));
        Self { of: None, edges: vec![Pin::Right], traction, pressure: no_pressure(), ramp: at_once() }
    }
}

impl EffectParameters for EdgeLoad {
    fn title(&self) -> &'static str {
        "Edge load"
    }

    fn about(&self) -> &'static str {
        "Each end of an edge of length L at rest and outward normal N has half of L t - p N: a traction t that keeps its direction, and a pressure p that follows the edge."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        let (x, y) = &mut self.traction;
        vec![x, y, &mut self.pressure, &mut self.ramp]
    }

    fn rules_mut(&mut self) -> Option<Rules<'_>> {
        Some(Rules { of: &mut self.of, pins: &mut self.edges, are_of_edges: true })
    }

    fn build(&self, elements: &Elements) -> Result<Box<dyn Effect>, String> {
        let named = elements.pinned(self.of.as_deref(), &self.edges)?;
        let is_named = |vertex: &u32| named.binary_search(vertex).is_ok();
        let all = elements.triangles.iter().flat_map(|body| boundary_edges(body.corners()));
        let edges: Vec<_> = all.filter(|ends| ends.iter().all(is_named)).collect();
        if edges.is_empty() {
            return Err("its list names no edge of a body in the plane".to_owned());
        }
        let length = |[a, b]: [u32; 2]| {
            let [a, b] = [a, b].map(|end| 2 * end as usize);
            libm::hypot(elements.rest[b] - elements.rest[a], elements.rest[b + 1] - elements.rest[a + 1])
        };
        let (x, y) = self.traction;
        let traction = [x.get(), y.get()];
        let force = |ends: [u32; 2]| traction.map(|traction| 0.5 * length(ends) * traction);
        let edges = edges.into_iter().map(|ends| (ends, force(ends))).collect();
        Ok(Box::new(Load { edges, pressure: self.pressure.get(), ramp: self.ramp.get() }))
    }
}

/// The built effect.
struct Load {
    /// Ends of each edge, with the body on the left, and the force of the traction on each of them \[N\].
    edges: Vec<([u32; 2], [f64; 2])>,
    /// p \[Pa\].
    pressure: f64,
    /// Time in which it rises \[s\].
    ramp: f64,
}

impl Load {
    /// s at a time \[s\].
    fn share(&self, time: f64) -> f64 {
        if time >= self.ramp { 1.0 } else { (time / self.ramp).max(0.0) }
    }

    /// Half of `s p` at a time \[Pa\]: the block of both ends of an edge has it beside its diagonal.
    fn half(&self, time: f64) -> f64 {
        0.5 * self.share(time) * self.pressure
    }
}

impl Effect for Load {
    fn name(&self) -> &'static str {
        "EdgeLoad"
    }

    fn elements(&self, _: Motion<'_>) -> usize {
        self.edges.len()
    }

    fn dimension(&self) -> Option<usize> {
        Some(2)
    }

    fn idle(&self, _: Motion<'_>) -> Option<&'static str> {
        (self.pressure == 0.0 && self.edges.iter().all(|(_, force)| *force == [0.0; 2])).then_some(ZERO)
    }

    fn is_steady(&self) -> bool {
        self.ramp == 0.0
    }

    fn is_load(&self) -> bool {
        true
    }

    fn ramp(&self) -> f64 {
        self.ramp
    }

    fn force(&self, motion: Motion<'_>, _: &mut [f64], force: &mut [f64]) {
        let (share, half) = (self.share(motion.time), self.half(motion.time));
        for (ends, dead) in &self.edges {
            let [a, b] = ends.map(|end| 2 * end as usize);
            let (dx, dy) = (motion.x[b] - motion.x[a], motion.x[b + 1] - motion.x[a + 1]);
            let [x, y] = [share * dead[0] - half * dy, share * dead[1] + half * dx];
            for end in [a, b] {
                force[end] += x;
                force[end + 1] += y;
            }
        }
    }

    fn supplies(&self) -> bool {
        true
    }

    fn supplied_power(&self, motion: Motion<'_>, forces: &mut Vec<f64>) -> Option<f64> {
        Some(power_of_force(self, motion, forces))
    }

    /// `-df_a/dx_b = p/2 J` and `-df_b/dx_a = -p/2 J` with J = ((0, 1), (-1, 0)): symmetric to each other.
    fn stiffness_times(&self, motion: Motion<'_>, d: &[f64], _: &mut [f64], product: &mut [f64]) {
        let half = self.half(motion.time);
        if half == 0.0 {
            return;
        }
        for (ends, _) in &self.edges {
            let [a, b] = ends.map(|end| 2 * end as usize);
            product[a] += half * d[b + 1];
            product[a + 1] -= half * d[b];
            product[b] -= half * d[a + 1];
            product[b + 1] += half * d[a];
        }
    }

    fn sparsity_pattern(&self, add: &mut dyn FnMut(u32, u32)) {
        if self.pressure != 0.0 {
            self.edges.iter().for_each(|([a, b], _)| add(*a, *b));
        }
    }

    fn add_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix) {
        let Some(matrix) = matrix.blocks::<2>() else { return };
        if self.pressure == 0.0 {
            return;
        }
        let half = weights.position * self.half(motion.time);
        let beside = Block::<2>::new(0.0, half, -half, 0.0);
        for (ends, _) in &self.edges {
            // The eigenvalues of the block of both ends are ±p/2.
            if !matches!(weights.tangent, Tangent::Exact) {
                for end in ends {
                    matrix.diagonal(*end as usize, &(Block::<2>::identity() * half.abs()));
                }
            }
            matrix.off_diagonal(&beside);
        }
    }
}

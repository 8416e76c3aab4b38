//! Forces of moving air on the faces of cloth.

use super::{Effect, Motion, ZERO, power_of_force};
use crate::{
    elements::{
        Elements,
        frame::{cross, dot, minus},
    },
    solvers::{Block, SparseMatrix, Weights},
};

/// Moving air.
pub(super) trait Air: Send + Sync {
    /// Its velocity at a point and a time [m/s].
    fn velocity(&self, point: [f64; 3], time: f64) -> [f64; 3];

    /// Whether it is at rest.
    fn is_still(&self) -> bool;

    /// Whether it does not depend on time.
    fn is_steady(&self) -> bool;
}

/// The pressure of moving air on every triangle of membranes, and of sheets of springs, in space: `f = c A (n · (w - s v)) n`, a third at each
/// corner, where A is the area, n the normal, w the velocity of the air at the centre, and v the mean velocity of the corners.
pub(super) struct FacePressure<A> {
    name: &'static str,
    faces: Vec<[u32; 3]>,
    /// Area that belongs to each vertex at rest \[m²\].
    areas: Vec<f64>,
    /// c [Pa s/m].
    resistance: f64,
    /// s.
    own_motion: f64,
    air: A,
}

impl<A: Air> FacePressure<A> {
    /// Air on all faces of a scene, with c [Pa s/m] and s.
    ///
    /// # Errors
    /// A sentence, if there are none.
    pub(super) fn new(
        name: &'static str,
        elements: &Elements,
        [resistance, own_motion]: [f64; 2],
        air: A,
    ) -> Result<Self, String> {
        let faces = faces(elements)?;
        let mut areas = vec![0.0; elements.rest.len() / 3];
        each(&faces, &elements.rest, |face, _, area| {
            for corner in face {
                areas[*corner as usize] += area / 3.0;
            }
        });
        Ok(Self { name, faces, areas, resistance, own_motion, air })
    }
}

/// Triangles of all membranes and sheets in space.
///
/// # Errors
/// A sentence, if there are none.
pub(super) fn faces(elements: &Elements) -> Result<Vec<[u32; 3]>, String> {
    let faces: Vec<_> = elements.cloth_faces().collect();
    if faces.is_empty() {
        return Err("it acts on the triangles of membranes and sheets in space, and the level has none".to_owned());
    }
    Ok(faces)
}

/// Calls `act` with each triangle, its unit normal and its area \[m²\]; one without area is left out.
fn each(faces: &[[u32; 3]], x: &[f64], mut act: impl FnMut(&[u32; 3], [f64; 3], f64)) {
    for face in faces {
        let [a, b, c] = face.map(|corner| coordinates(x, corner));
        let twice = cross(minus(b, a), minus(c, a));
        let length = dot(twice, twice).sqrt();
        if length > 0.0 {
            act(face, twice.map(|along| along / length), 0.5 * length);
        }
    }
}

impl<A: Air> Effect for FacePressure<A> {
    fn name(&self) -> &'static str {
        self.name
    }

    fn dimension(&self) -> Option<usize> {
        Some(3)
    }

    fn elements(&self, _: Motion<'_>) -> usize {
        self.faces.len()
    }

    fn idle(&self, motion: Motion<'_>) -> Option<&'static str> {
        if self.resistance == 0.0 {
            return Some(ZERO);
        }
        let is_still = self.air.is_still();
        if is_still && self.own_motion == 0.0 { Some(ZERO) } else { motion.stillness().filter(|_| is_still) }
    }

    fn is_steady(&self) -> bool {
        self.air.is_steady()
    }

    fn force(&self, motion: Motion<'_>, _: &mut [f64], force: &mut [f64]) {
        each(&self.faces, motion.x, |face, normal, area| {
            let centre = mean(motion.x, face);
            let (air, own) = (self.air.velocity(centre, motion.time), mean(motion.v, face));
            let relative = std::array::from_fn(|axis| air[axis] - self.own_motion * own[axis]);
            let third = self.resistance * area * dot(normal, relative) / 3.0;
            for corner in face {
                for (axis, along) in normal.iter().enumerate() {
                    force[3 * *corner as usize + axis] += third * along;
                }
            }
        });
    }

    fn supplies(&self) -> bool {
        true
    }

    fn supplied_power(&self, motion: Motion<'_>, forces: &mut Vec<f64>) -> Option<f64> {
        Some(power_of_force(self, motion, forces))
    }

    fn sparsity_pattern(&self, add: &mut dyn FnMut(u32, u32)) {
        for &[a, b, c] in &self.faces {
            add(a, b);
            add(a, c);
            add(b, c);
        }
    }

    /// The derivative by velocities: `-df_i/dv_j = s c A n n'/9`. That by positions is not symmetric.
    fn add_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix) {
        let Some(matrix) = matrix.blocks::<3>() else { return };
        for face in &self.faces {
            let [a, b, c] = face.map(|corner| coordinates(motion.x, corner));
            let twice = cross(minus(b, a), minus(c, a));
            let length = dot(twice, twice).sqrt();
            let scale =
                if length > 0.0 { weights.velocity * self.own_motion * self.resistance / (18.0 * length) } else { 0.0 };
            let block = Block::<3>::from_fn(|row, column| scale * twice[row] * twice[column]);
            for corner in face {
                matrix.diagonal(*corner as usize, &block);
                matrix.off_diagonal(&block);
            }
        }
    }

    fn damps_by_shape(&self) -> bool {
        true
    }

    /// Greatest rate of any vertex, with the areas at rest.
    fn damping(&self, motion: Motion<'_>) -> [f64; 2] {
        let rates = self.areas.iter().zip(motion.inverse_mass.chunks_exact(3)).map(|(area, inverse)| area * inverse[0]);
        [self.own_motion * self.resistance * rates.fold(0.0, f64::max), 0.0]
    }
}

pub(super) fn coordinates(x: &[f64], vertex: u32) -> [f64; 3] {
    let at = 3 * vertex as usize;
    [x[at], x[at + 1], x[at + 2]]
}

/// Mean of some values over the corners of a triangle.
fn mean(values: &[f64], face: &[u32; 3]) -> [f64; 3] {
    let [a, b, c] = face.map(|corner| coordinates(values, corner));
    std::array::from_fn(|axis| (a[axis] + b[axis] + c[axis]) / 3.0)
}

/// The vector with length one; along x if it has none.
pub(super) fn unit(vector: [f64; 3]) -> [f64; 3] {
    let length = dot(vector, vector).sqrt();
    if length > 0.0 { vector.map(|along| along / length) } else { [1.0, 0.0, 0.0] }
}

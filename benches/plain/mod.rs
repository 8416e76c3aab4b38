//! What other steps are measured against: the same step as a course would write it, symplectic Euler with forces scattered triangle by
//! triangle, one after another, by the formulas of the library.

use gingerbread::{
    materials::{Lame, Material, Model, Visitor},
    scene::Scene,
    simd::Mat2,
};
use nalgebra::Matrix2;
use std::time::{Duration, Instant};

/// A body without pins, on which nothing else acts.
pub struct Plain {
    model: Model,
    lame: Lame,
    /// Corners, D0⁻¹ and area.
    triangles: Vec<([usize; 3], Mat2<f64>, f64)>,
    x: Vec<[f64; 2]>,
    v: Vec<[f64; 2]>,
    force: Vec<[f64; 2]>,
    inverse_mass: Vec<f64>,
    h: f64,
}

fn edges(x: &[[f64; 2]], [a, b, c]: [usize; 3]) -> Mat2<f64> {
    Mat2::new(x[b][0] - x[a][0], x[c][0] - x[a][0], x[b][1] - x[a][1], x[c][1] - x[a][1])
}

impl Plain {
    pub fn new(scene: &Scene) -> Self {
        let pairs = |flat: &[f64]| flat.as_chunks::<2>().0.to_vec();
        let rest = pairs(&scene.rest);
        let triangle = |corners: &[u32; 3]| {
            let corners = corners.map(|corner| corner as usize);
            let edges = Matrix2::from(edges(&rest, corners));
            (corners, Mat2::from(&edges.try_inverse().unwrap()), 0.5 * edges.determinant())
        };
        Self {
            model: scene.bodies[0].elements.material().model().unwrap(),
            lame: scene.bodies[0].elements.material().lame(),
            triangles: scene.triangles.iter().map(triangle).collect(),
            x: pairs(&scene.start.x),
            v: pairs(&scene.start.v),
            force: rest.clone(),
            inverse_mass: scene.inverse_mass.iter().step_by(2).copied().collect(),
            h: scene.step,
        }
    }

    /// Time of `steps` steps, which go on where the last ones ended.
    pub fn time(&mut self, steps: u64) -> Duration {
        let begin = Instant::now();
        for _ in 0..steps {
            self.model.visit(self.lame, &mut *self);
        }
        let time = begin.elapsed();
        assert!(self.x.as_flattened().iter().all(|x| x.is_finite()), "it has to stay in motion");
        time
    }
}

impl Visitor for &mut Plain {
    type Output = ();
    fn visit<M: Material>(self, material: &M) {
        self.force.fill([0.0; 2]);
        for &(corners, inverse, area) in &self.triangles {
            let stress = material.piola(edges(&self.x, corners).times(inverse));
            let h = stress.times(inverse.transpose()) * -area;
            let forces = [[-h.m11 - h.m12, -h.m21 - h.m22], [h.m11, h.m21], [h.m12, h.m22]];
            for (corner, [x, y]) in corners.into_iter().zip(forces) {
                self.force[corner][0] += x;
                self.force[corner][1] += y;
            }
        }
        let moving = self.x.iter_mut().zip(&mut self.v).zip(self.force.iter().zip(&self.inverse_mass));
        for ((x, v), (force, inverse_mass)) in moving {
            for axis in 0..2 {
                v[axis] += self.h * force[axis] * inverse_mass;
                x[axis] += self.h * v[axis];
            }
        }
    }
}

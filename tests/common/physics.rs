//! A scene as integrators see it, with nothing of a simulation around it: for taking steps with a solver of one's own choice.

use gingerbread::{
    effects::Motion,
    integrators::Dynamics,
    scene::Scene,
    solvers::{SparseMatrix, Weights},
};

/// The effects of a scene.
pub struct Physics<'a> {
    scene: &'a Scene,
    scratch: Vec<f64>,
}

impl<'a> Physics<'a> {
    /// Without constraints.
    pub fn new(scene: &'a Scene) -> Self {
        Self { scene, scratch: vec![0.0; scene.scratch()] }
    }
}

fn motion<'a>(scene: &'a Scene, x: &'a [f64], v: &'a [f64]) -> Motion<'a> {
    Motion { dimension: scene.dimension, x, v, mass: &scene.mass, inverse_mass: &scene.inverse_mass, ..Motion::NONE }
}

impl Dynamics for Physics<'_> {
    fn force(&mut self, _: f64, x: &[f64], v: &[f64], force: &mut [f64]) {
        force.fill(0.0);
        for effect in &self.scene.effects {
            effect.force(motion(self.scene, x, v), &mut self.scratch[..effect.scratch()], force);
        }
    }

    fn mass(&self) -> &[f64] {
        &self.scene.mass
    }

    fn inverse_mass(&self) -> &[f64] {
        &self.scene.inverse_mass
    }

    fn stiffness_times(&mut self, _: f64, x: &[f64], v: &[f64], d: &[f64], product: &mut [f64]) {
        for effect in &self.scene.effects {
            effect.stiffness_times(motion(self.scene, x, v), d, &mut self.scratch[..effect.scratch()], product);
        }
    }

    fn block_size(&self) -> usize {
        self.scene.dimension
    }

    fn sparsity_pattern(&self, add: &mut dyn FnMut(u32, u32)) {
        self.scene.effects.iter().for_each(|effect| effect.sparsity_pattern(add));
    }

    fn add_stiffness(&mut self, _: f64, x: &[f64], v: &[f64], weights: Weights, matrix: &mut dyn SparseMatrix) {
        self.scene.effects.iter().for_each(|effect| effect.add_stiffness(motion(self.scene, x, v), weights, matrix));
    }

    fn longest_step(&mut self, x: &[f64], d: &[f64]) -> f64 {
        self.scene.effects.iter().map(|effect| effect.longest_step(x, d)).fold(f64::INFINITY, f64::min)
    }

    fn constrains(&self) -> bool {
        false
    }
}

//! A scene as integrators see it, with nothing of a simulation around it: for taking steps with a solver of one's own choice.

use gingerbread::{
    effects::Motion,
    integrators::Dynamics,
    scene::Scene,
    solvers::{SparseMatrix, Weights},
};

/// The effects of a scene, and a floor.
pub struct Physics<'a> {
    scene: &'a Scene,
    scratch: Vec<f64>,
    /// Nothing may get below this y [m].
    pub floor: f64,
}

impl<'a> Physics<'a> {
    /// Without a floor.
    pub fn new(scene: &'a Scene) -> Self {
        Self { scene, scratch: vec![0.0; scene.scratch()], floor: f64::NEG_INFINITY }
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
        self.floor.is_finite()
    }

    fn has_friction(&self) -> bool {
        false
    }

    fn constrain(&mut self, _: [&[f64]; 2], x: &mut [f64], v: &mut [f64], _: bool) {
        for (x, v) in x.chunks_exact_mut(2).zip(v.chunks_exact_mut(2)).filter(|(x, _)| x[1] < self.floor) {
            (x[1], v[1]) = (self.floor, v[1].max(0.0));
        }
    }
}

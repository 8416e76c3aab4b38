//! Static equilibrium of a scene.

use crate::{
    effects::Motion,
    scene::Scene,
    solvers::{Equations, Newton, NewtonCounts, SparseMatrix, Tangent, Weights},
    stability::largest_eigenvalue,
};

/// Static equilibrium from the start by Newton's method, and the counts of the solver. Walls are ignored.
///
/// Each round solves `f(x) = w m (x - x_before)` from the result of the previous round. w falls from a stiff value,
/// which is a long implicit step, to zero. Large deflections are thus reached without a jump to another equilibrium.
pub(super) fn rest(scene: &Scene) -> Option<(Vec<f64>, NewtonCounts)> {
    let mut x = scene.start.x.clone();
    let scale = largest_eigenvalue(scene, &scene.start)?;
    let mut newton = Newton::default();
    let mut counts = NewtonCounts::NONE;
    let softer = |holding: &f64| if *holding > 1e-10 { Some(0.2 * holding) } else { None };
    for holding in std::iter::successors(Some(1e-4), softer).chain([0.0]) {
        let mut balance = Balance::new(scene, &x, holding * scale, 1e-6 * scale);
        let mut z = vec![0.0; x.len()];
        let round = newton.solve(&mut balance, &mut z);
        // Only the last round must converge.
        counts.unconverged = 0;
        counts.add(&round);
        if !z.iter().all(|z| z.is_finite()) {
            return None;
        }
        x.iter_mut().zip(&z).for_each(|(x, z)| *x += z);
    }
    Some((x, counts))
}

/// `w m z - f(x + z) = 0`.
struct Balance<'a> {
    scene: &'a Scene,
    from: Vec<f64>,
    x: Vec<f64>,
    still: Vec<f64>,
    scratch: Vec<f64>,
    /// w [1/s²].
    holding: f64,
    inverse_weight: Vec<f64>,
}

impl<'a> Balance<'a> {
    fn new(scene: &'a Scene, from: &[f64], holding: f64, weight: f64) -> Self {
        Self {
            scene,
            from: from.to_vec(),
            x: from.to_vec(),
            still: vec![0.0; from.len()],
            scratch: vec![0.0; scene.scratch()],
            holding,
            inverse_weight: scene.inverse_mass.iter().map(|inverse_mass| inverse_mass / weight).collect(),
        }
    }

    fn move_to(&mut self, z: &[f64]) {
        for ((x, from), z) in self.x.iter_mut().zip(&self.from).zip(z) {
            *x = from + z;
        }
    }

    fn motion(&self) -> Motion<'_> {
        let Scene { dimension, mass, inverse_mass, .. } = self.scene;
        Motion { dimension: *dimension, x: &self.x, v: &self.still, mass, inverse_mass, grab: None }
    }
}

impl Equations for Balance<'_> {
    fn residual(&mut self, z: &[f64], g: &mut [f64]) {
        self.move_to(z);
        g.fill(0.0);
        let mut scratch = std::mem::take(&mut self.scratch);
        for effect in &self.scene.effects {
            effect.force(self.motion(), &mut scratch[..effect.scratch()], g);
        }
        self.scratch = scratch;
        for (((g, z), mass), inverse) in g.iter_mut().zip(z).zip(&self.scene.mass).zip(&self.scene.inverse_mass) {
            *g = if *inverse == 0.0 { 0.0 } else { self.holding * mass * z - *g };
        }
    }

    fn block_size(&self) -> usize {
        self.scene.dimension
    }

    fn derivative(&mut self, z: &[f64], tangent: Tangent, matrix: &mut dyn SparseMatrix) {
        self.move_to(z);
        let weights = Weights { position: 1.0, velocity: 0.0, tangent };
        for effect in &self.scene.effects {
            effect.add_stiffness(self.motion(), weights, matrix);
        }
        matrix.add_to_diagonal(&|number| self.holding * self.scene.mass[number]);
    }

    fn sparsity_pattern(&self, add: &mut dyn FnMut(u32, u32)) {
        for effect in &self.scene.effects {
            effect.sparsity_pattern(add);
        }
    }

    fn inverse_weight(&self) -> &[f64] {
        &self.inverse_weight
    }

    fn other_start(&self, z: &mut [f64]) {
        z.fill(0.0);
    }

    /// 1e-9 of the greatest displacement, plus round-off of the coordinates [m].
    fn tolerance(&self, z: &[f64]) -> f64 {
        let greatest = |values: &[f64]| values.iter().fold(0.0_f64, |greatest, value| greatest.max(value.abs()));
        1e-9 * greatest(z) + 1e-13 * greatest(&self.x)
    }
}

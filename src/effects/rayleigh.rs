use super::{Effect, EffectParameters, Motion};
use crate::{
    elements::{Elements, Springs, Triangles},
    quantity::{DampingRate, DampingTime, Quantity},
    solvers::{BlockMatrix, Weights},
};
use nalgebra::{Matrix2, Matrix4};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Rayleigh damping: one part proportional to mass, one to stiffness.
///
/// The mass part is `f = -alpha m v`. The stiffness part is a viscous second Piola-Kirchhoff stress
/// `S = beta (2 mu dE/dt + lambda tr(dE/dt) I)` with the Green strain rate `dE/dt = sym(Fᵀ dF/dt)`, so `P = F S`
/// (a Kelvin-Voigt solid). At rest this is exactly Rayleigh's `-beta K v`; unlike that, it is objective: a rigid
/// motion has dE/dt = 0 and is not damped however stressed the body is, and the power `-A S : dE/dt` is never positive.
/// A spring of stiffness k gets a damper `beta k` beside it, with the same properties.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rayleigh {
    /// alpha [1/s].
    pub mass: DampingRate,
    /// beta [s].
    #[serde(default = "none")]
    pub stiffness: DampingTime,
}

const fn none() -> DampingTime {
    DampingTime::literal(0.0)
}

impl Default for Rayleigh {
    fn default() -> Self {
        Self { mass: DampingRate::literal(1.0), stiffness: DampingTime::literal(0.001) }
    }
}

impl EffectParameters for Rayleigh {
    fn title(&self) -> &'static str {
        "Damping"
    }

    fn about(&self) -> &'static str {
        "f = −α m v, and a viscous stress β C : dE/dt (in springs a damper β k) that a rigid spin does not feel."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.mass, &mut self.stiffness]
    }

    fn is_damping(&self) -> bool {
        true
    }

    fn build(&self, elements: &Elements) -> Result<Box<dyn Effect>, String> {
        let (alpha, beta) = (self.mass.get(), self.stiffness.get());
        let Elements { triangles: bodies, springs: nets } =
            if beta > 0.0 { elements.clone() } else { Elements::default() };
        Ok(Box::new(Damping { alpha, beta, bodies, nets }))
    }
}

/// Derivative by dF/dt of the viscous stress `F (2 mu E' + lambda tr(E') I)`, `E' = sym(Fᵀ dF/dt)` (4 x 4) [Pa s]:
/// a change G of dF/dt gives `mu (F Fᵀ G + F Gᵀ F) + lambda (F : G) F`.
fn viscous_tangent(f: &Matrix2<f64>, mu: f64, lambda: f64) -> Matrix4<f64> {
    let left = f * f.transpose();
    // Entries column by column: number 2 j + i is row i, column j.
    Matrix4::from_fn(|to, by| {
        let (i, j, k, l) = (to % 2, to / 2, by % 2, by / 2);
        let same = if j == l { left[(i, k)] } else { 0.0 };
        mu * (same + f[(i, l)] * f[(k, j)]) + lambda * f[(i, j)] * f[(k, l)]
    })
}

struct Damping {
    alpha: f64,
    beta: f64,
    bodies: Vec<Arc<Triangles>>,
    nets: Vec<Arc<Springs>>,
}

impl Effect for Damping {
    fn name(&self) -> &'static str {
        "Damping"
    }

    fn elements(&self, motion: Motion<'_>) -> usize {
        let triangles: usize = self.bodies.iter().map(|body| body.corners().len()).sum();
        let springs: usize = self.nets.iter().map(|net| net.links().len()).sum();
        motion.x.len() / 2 + triangles + springs
    }

    fn scratch(&self) -> usize {
        self.bodies.iter().map(|body| body.scratch()).max().unwrap_or(0)
    }

    fn damping(&self, _: Motion<'_>) -> [f64; 2] {
        [self.alpha, self.beta]
    }

    fn force(&self, motion: Motion<'_>, scratch: &mut [f64], force: &mut [f64]) {
        for ((force, v), mass) in force.iter_mut().zip(motion.v).zip(motion.mass) {
            *force -= self.alpha * mass * v;
        }
        for body in &self.bodies {
            let lame = body.lame();
            let (two_mu, lambda) = (2.0 * self.beta * lame.mu, self.beta * lame.lambda);
            body.add_stress(motion.x, &mut scratch[..body.scratch()], force, |number, body, f| {
                let product = f.transpose() * body.gradient_of(motion.v, number);
                let rate = (product + product.transpose()) * 0.5;
                f * (rate * two_mu + Matrix2::identity() * (lambda * rate.trace()))
            });
        }
        for net in &self.nets {
            net.add_damping(motion.x, motion.v, self.beta, force);
        }
    }

    fn couples(&self, add: &mut dyn FnMut(u32, u32)) {
        for body in &self.bodies {
            body.name_couples(add);
        }
        for net in &self.nets {
            net.couples(add);
        }
    }

    /// The part for v is exact. The one for x is left out: it is not symmetric, and smaller than the elastic stiffness
    /// by `beta |dE/dt|`, the strain that builds up within beta.
    fn add_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut BlockMatrix) {
        for (vertex, mass) in motion.mass.chunks_exact(2).enumerate() {
            matrix.diagonal(vertex, &Matrix2::from_diagonal_element(weights.velocity * self.alpha * mass[0]));
        }
        for body in &self.bodies {
            let lame = body.lame();
            let (mu, lambda) = (self.beta * lame.mu, self.beta * lame.lambda);
            body.add_tangent(motion.x, weights.velocity, matrix, |f| viscous_tangent(f, mu, lambda));
        }
        for net in &self.nets {
            net.add_damping_stiffness(motion.x, self.beta, weights.velocity, matrix);
        }
    }
}

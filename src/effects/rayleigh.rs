//! Effect: Rayleigh damping.

use super::{Effect, EffectParameters, Motion, ZERO};
use crate::{
    elements::{ElementKind, Elements, Membranes, NetSprings, StressLaw, Triangles, UniformForce},
    materials::Lame,
    quantity::{DampingRate, DampingTime, Quantity},
    simd::{Mat2, Real},
    solvers::{SparseMatrix, Tangent, Weights},
};
use nalgebra::{Matrix2, Matrix4};
use serde::{Deserialize, Serialize};
use std::{ops::Range, sync::Arc};

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
    /// beta \[s\].
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
        let Elements { triangles: bodies, springs: nets, membranes, .. } =
            if beta > 0.0 { elements.clone() } else { Elements::default() };
        Ok(Box::new(Damping { alpha, beta, bodies, nets, membranes }))
    }
}

/// Derivative of the viscous stress `P = F S`, `S = 2 mu E' + lambda tr(E') I`, `E' = sym(Fᵀ V)` with V = dF/dt, by F and V
/// with their weights (4 x 4) \[Pa\]. A change G of V gives `mu (F Fᵀ G + F Gᵀ F) + lambda (F : G) F`. A change G of F gives
/// `G S`, which is symmetric, and `mu (F Vᵀ G + F Gᵀ V) + lambda (V : G) F`, of which the symmetric half is taken.
fn viscous_tangent(f: &Matrix2<f64>, rate: &Matrix2<f64>, weights: Weights, [mu, lambda]: [f64; 2]) -> Matrix4<f64> {
    let product = f.transpose() * rate;
    let stress = (product + product.transpose()) * mu + Matrix2::identity() * (lambda * product.trace());
    // Half of the change of F enters like V; its transpose is added.
    let moved = f * weights.velocity + rate * weights.position;
    let left = f * moved.transpose();
    let left = (left + left.transpose()) * (0.5 * mu);
    let half = moved * 0.5;
    // Entries column by column: number 2 j + i is row i, column j.
    Matrix4::from_fn(|to, by| {
        let (i, j, k, l) = (to % 2, to / 2, by % 2, by / 2);
        let same = if j == l { left[(i, k)] } else { 0.0 };
        let turned = mu * (f[(i, l)] * half[(k, j)] + half[(i, l)] * f[(k, j)]);
        let volume = lambda * (f[(i, j)] * half[(k, l)] + half[(i, j)] * f[(k, l)]);
        let geometric = if i == k { weights.position * stress[(l, j)] } else { 0.0 };
        same + turned + volume + geometric
    })
}

/// The viscous stress `F (2 mu E' + lambda tr(E') I)`, the parameters times beta [Pa s].
#[derive(Clone, Copy)]
pub struct Viscous {
    two_mu: f64,
    lambda: f64,
}

impl Viscous {
    /// From beta \[s\] and the parameters of the material.
    pub fn new(beta: f64, Lame { mu, lambda }: Lame) -> Self {
        Self { two_mu: 2.0 * beta * mu, lambda: beta * lambda }
    }

    /// lambda times beta [Pa s].
    pub const fn lambda(&self) -> f64 {
        self.lambda
    }
}

impl StressLaw for Viscous {
    const RATE: bool = true;

    #[inline(always)]
    fn stress<R: Real>(&self, f: Mat2<R>, rate: Mat2<R>) -> Mat2<R> {
        let product = f.transpose().times(rate);
        let strain = (product + product.transpose()) * 0.5;
        f.times(strain * self.two_mu + Mat2::identity(f.m11) * (strain.trace() * self.lambda))
    }
}

/// Whether all these vertices are at rest, as those of a sleeping body: their viscous stress is zero.
fn is_still(motion: Motion<'_>, vertices: &Range<usize>) -> bool {
    let dimension = motion.dimension;
    motion.v[dimension * vertices.start..dimension * vertices.end].iter().all(|v| *v == 0.0)
}

struct Damping {
    alpha: f64,
    beta: f64,
    bodies: Vec<Arc<Triangles>>,
    nets: Vec<NetSprings>,
    membranes: Vec<Arc<Membranes>>,
}

impl Damping {
    /// beta mu, and beta lambda [Pa s].
    fn viscosities(&self, Lame { mu, lambda }: Lame) -> [f64; 2] {
        [self.beta * mu, self.beta * lambda]
    }
}

impl Effect for Damping {
    fn name(&self) -> &'static str {
        "Damping"
    }

    fn elements(&self, motion: Motion<'_>) -> usize {
        let triangles: usize = self.bodies.iter().map(|body| body.corners().len()).sum();
        let springs: usize = self.nets.iter().map(|net| net.links().len()).sum();
        let membranes: usize = self.membranes.iter().map(|membrane| membrane.corners().len()).sum();
        motion.vertices() + triangles + springs + membranes
    }

    fn idle(&self, motion: Motion<'_>) -> Option<&'static str> {
        if self.alpha == 0.0 && self.beta == 0.0 { Some(ZERO) } else { motion.stillness() }
    }

    fn restricted(&self, moves: &dyn Fn(usize) -> bool) -> Option<Arc<dyn Effect>> {
        let bodies =
            self.bodies.iter().map(|body| body.restricted_to(moves).map_or_else(|| Arc::clone(body), Arc::new));
        let (nets, membranes) = (self.nets.clone(), self.membranes.clone());
        Some(Arc::new(Self { bodies: bodies.collect(), nets, membranes, ..*self }))
    }

    /// Includes scratch for elastic forces; see [`Self::uniform_force`].
    fn scratch(&self) -> usize {
        2 * self.bodies.iter().map(|body| body.scratch()).max().unwrap_or(0)
    }

    /// Dampers beside springs, and those of membranes, are summed one after another.
    fn uniform_force(&self) -> Option<UniformForce> {
        let uniform_force =
            UniformForce { mass_damping: self.alpha, stiffness_damping: self.beta, ..UniformForce::default() };
        (self.nets.is_empty() && self.membranes.is_empty()).then_some(uniform_force)
    }

    fn damping(&self, _: Motion<'_>) -> [f64; 2] {
        [self.alpha, self.beta]
    }

    fn force(&self, motion: Motion<'_>, scratch: &mut [f64], force: &mut [f64]) {
        for ((force, v), mass) in force.iter_mut().zip(motion.v).zip(motion.mass) {
            *force -= self.alpha * mass * v;
        }
        for body in self.bodies.iter().filter(|body| !is_still(motion, body.vertices())) {
            let viscous = Viscous::new(self.beta, body.material().lame());
            body.add_viscous_force(motion, viscous, &mut scratch[..body.scratch()], force);
        }
        for net in self.nets.iter().filter(|net| !is_still(motion, net.vertices())) {
            net.add_damping(motion.x, motion.v, self.beta, force);
        }
        for membrane in self.membranes.iter().filter(|membrane| !is_still(motion, membrane.vertices())) {
            membrane.add_viscous_force(
                [motion.x, motion.v],
                Viscous::new(self.beta, membrane.material().lame()),
                force,
            );
        }
    }

    fn sparsity_pattern(&self, add: &mut dyn FnMut(u32, u32)) {
        for body in &self.bodies {
            body.add_sparsity(add);
        }
        for net in &self.nets {
            net.elements().sparsity_pattern(add);
        }
        for membrane in &self.membranes {
            membrane.sparsity_pattern(add);
        }
    }

    /// The part for v is exact. The part for x is not symmetric: for triangles its symmetric part is taken, without that of the mean of tr(E') for
    /// elements of mean dilatation; for springs and membranes none.
    fn add_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix) {
        matrix.add_to_diagonal(&|number| weights.velocity * self.alpha * motion.mass[number]);
        // The derivative of damping by x may be indefinite; that by v is not.
        let weights = match weights.tangent {
            Tangent::Exact => weights,
            _ => Weights { position: 0.0, ..weights },
        };
        if let Some(matrix) = matrix.blocks::<2>() {
            for body in &self.bodies {
                let lame = self.viscosities(body.material().lame());
                if let Some(six) = body.six_nodes() {
                    let [mu, lambda] = lame;
                    let is_mean = six.kind() == ElementKind::MeanDilatation;
                    let (own, mean) = if is_mean { ([mu, 0.0], lambda * weights.velocity) } else { (lame, 0.0) };
                    let tangent = |f: &Matrix2<f64>, rate: &Matrix2<f64>| viscous_tangent(f, rate, weights, own);
                    six.add_tangent([motion.x, motion.v], matrix, tangent, mean);
                    continue;
                }
                body.add_tangent(motion.x, 1.0, matrix, |number, f| {
                    viscous_tangent(f, &body.gradient_of(motion.v, number), weights, lame)
                });
            }
        }
        for net in &self.nets {
            net.add_damping_stiffness(motion.x, self.beta, weights.velocity, matrix);
        }
        let Some(matrix) = matrix.blocks::<3>() else { return };
        let weights = Weights { position: 0.0, ..weights };
        for membrane in &self.membranes {
            let lame = self.viscosities(membrane.material().lame());
            membrane.add_tangent(motion.x, matrix, |f| viscous_tangent(f, &Matrix2::zeros(), weights, lame));
        }
    }
}

//! What stepping cost: counts that tests pin, and clocks that are only shown.

use crate::integrators::StepCounts;
use std::time::Duration;

/// Counts of the steps taken since the simulation began, or began anew.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Steps taken.
    pub steps: u64,
    /// Evaluations of all forces together; of a body or net that goes at its own pace, of its forces by themselves.
    pub force_evaluations: u64,
    /// Steps inside the steps; more than `steps` if the integrator controls its error, or if bodies and nets go at their own pace,
    /// whose steps are then added up.
    pub inner_steps: u64,
    /// Steps inside the steps that were taken again, shorter, for their error.
    pub rejected: u64,
    /// Iterations of Newton's method.
    pub newton_iterations: u64,
    /// How often a Newton step was cut short by its line search.
    pub line_search_cuts: u64,
    /// Sparse factorisations.
    pub factorisations: u64,
    /// Factorisations repeated with another matrix, as it was not positive definite.
    pub indefinite: u64,
    /// Steps whose equations were not solved to tolerance.
    pub unconverged: u64,
    /// Iterations of conjugate gradients for linear systems.
    pub linear_iterations: u64,
    /// Linear systems solved with what had been factorised for an earlier one.
    pub reused_factors: u64,
    /// Solves whose linear systems were factorised after all, as iterations were too slow.
    pub abandoned_iterations: u64,
    /// Vertices whose velocity or position an effect changed.
    pub constrained: u64,
    /// Steps that the guard had taken in shorter ones.
    pub guarded: u64,
    /// Steps that brought out what began inside a wall or beyond an edge of the world.
    pub pushed_out: u64,
    /// Steps in which everything slept.
    pub slept: u64,
    /// Triangles of bodies that were awake, summed over the steps.
    pub triangle_steps: u64,
    /// Attempts at a step that the guard threw away.
    pub retaken: u64,
}

impl Counts {
    /// Books what an integrator did.
    pub fn add(&mut self, step: &StepCounts) {
        self.inner_steps += step.inner_steps;
        self.rejected += step.rejected;
        self.newton_iterations += step.newton.iterations;
        self.line_search_cuts += step.newton.cuts;
        self.factorisations += step.newton.factorisations;
        self.indefinite += step.newton.indefinite;
        self.unconverged += step.newton.unconverged;
        self.linear_iterations += step.newton.linear_iterations;
        self.reused_factors += step.newton.reused;
        self.abandoned_iterations += step.newton.abandoned;
    }

    /// Steps that were computed: those in which not everything slept.
    pub const fn computed(&self) -> u64 {
        self.steps - self.slept
    }

    /// Adds what steps of a part of a scene by itself did; they are no steps of the scene.
    pub const fn merge(&mut self, part: &Self) {
        self.force_evaluations += part.force_evaluations;
        self.inner_steps += part.inner_steps;
        self.constrained += part.constrained;
    }
}

/// How a body or net is stepped that goes at its own pace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubstepPlan {
    /// In how many equal parts it takes every step of the scene.
    pub steps: u32,
    /// Length of a part [s].
    pub step: f64,
    /// The longest stable step at rest of symplectic Euler [s], if anything in it is stiff.
    pub limit: Option<f64>,
}

/// What one effect cost.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectCost {
    /// Name of the effect.
    pub name: &'static str,
    /// Time spent in it; zero unless the simulation was asked to measure.
    pub time: Duration,
    /// How often it was called.
    pub calls: u64,
    /// Elements (vertices, triangles, ...) touched, summed over the calls.
    pub elements: u64,
    /// Whether it may be passed over.
    pub auto: bool,
    /// How often it was passed over.
    pub skipped: u64,
    /// Steps of the scene in which what it acts on slept.
    pub slept: u64,
    /// Why it was passed over when it last could have been called; nothing if it was called.
    pub idle: Option<&'static str>,
}

impl EffectCost {
    /// An effect that has cost nothing yet.
    pub const fn none(name: &'static str, auto: bool) -> Self {
        Self { name, time: Duration::ZERO, calls: 0, elements: 0, auto, skipped: 0, slept: 0, idle: None }
    }

    /// Books that it was passed over.
    pub const fn pass_over(&mut self, why: &'static str) {
        self.skipped += 1;
        self.idle = Some(why);
    }

    /// Books a call.
    pub const fn call(&mut self, elements: usize) {
        self.calls += 1;
        self.elements += elements as u64;
        self.idle = None;
    }
}

/// Energies of a scene [J].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energies {
    /// Of motion.
    pub kinetic: f64,
    /// Of deformation.
    pub elastic: f64,
    /// Of everything else that stores: gravity, the mouse spring.
    pub potential: f64,
}

impl Energies {
    /// The sum [J].
    pub fn total(self) -> f64 {
        self.kinetic + self.elastic + self.potential
    }
}

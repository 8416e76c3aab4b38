//! Step statistics: counts, which are reproducible, and times, which are not.
//!
//! ```
//! use gingerbread::{files, levels, meshes::NoFiles, scene::Scene, simulation::Simulation};
//!
//! let level = files::parse(levels::built_in("chain").ok_or("there is no such level")?, "chain.ron")?;
//! let scene = Scene::build(&level, level.mode, &NoFiles, None)?;
//! let mut simulation = Simulation::open(scene, &level, level.mode)?;
//! simulation.advance(20, &mut || true);
//! assert_eq!(simulation.counts().steps, 20);
//! assert!(simulation.costs().iter().any(|cost| cost.name == "Gravity"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::integrators::StepCounts;
use std::time::Duration;

/// Counts since the start of the simulation, or since the last reset.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counts {
    /// Steps taken.
    pub steps: u64,
    /// Evaluations of all forces; with multirate stepping, of the forces of one body or net.
    pub force_evaluations: u64,
    /// Inner steps; more than `steps` if the integrator controls its error, or with multirate stepping, where substeps
    /// are summed.
    pub inner_steps: u64,
    /// Inner steps rejected for their error.
    pub rejected: u64,
    /// Iterations of Newton's method.
    pub newton_iterations: u64,
    /// Newton steps halved by the line search.
    pub line_search_cuts: u64,
    /// Sparse factorisations.
    pub factorisations: u64,
    /// Factorisations repeated with another matrix, because it was not positive definite.
    pub indefinite: u64,
    /// Steps whose equations were not solved to tolerance.
    pub unconverged: u64,
    /// Iterations of conjugate gradients for linear systems.
    pub linear_iterations: u64,
    /// Linear systems solved with an earlier factor.
    pub reused_factors: u64,
    /// Solves that changed from slow iterations to factorisation.
    pub abandoned_iterations: u64,
    /// Vertices whose velocity or position a constraint changed.
    pub constrained: u64,
    /// Steps that the guard divided.
    pub guarded: u64,
    /// Steps with depenetration.
    pub pushed_out: u64,
    /// Steps in which everything slept.
    pub slept: u64,
    /// Triangles of bodies that were awake, summed over the steps.
    pub triangle_steps: u64,
    /// Steps that the guard rejected.
    pub retaken: u64,
    /// Energy that truncation of steps, projection and the filter of positions dissipated \[J\].
    pub truncated_energy: f64,
}

impl Counts {
    /// Adds the counts of an integrator.
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

    /// Steps in which not everything slept.
    pub const fn computed(&self) -> u64 {
        self.steps - self.slept
    }

    /// Adds the counts of a sub-scene; its steps are not steps of the scene.
    pub fn merge(&mut self, part: &Self) {
        self.force_evaluations += part.force_evaluations;
        self.inner_steps += part.inner_steps;
        self.constrained += part.constrained;
        self.truncated_energy += part.truncated_energy;
    }
}

/// Multirate substeps of a body or net.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubstepPlan {
    /// Number of substeps in a step of the scene.
    pub steps: u32,
    /// Length of a substep \[s\].
    pub step: f64,
    /// The longest stable step at rest of symplectic Euler \[s\], if anything in it is stiff.
    pub limit: Option<f64>,
}

/// Cost of one effect.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectCost {
    /// Name of the effect.
    pub name: &'static str,
    /// Time spent in the effect; zero unless effects are measured.
    pub time: Duration,
    /// Dissipated energy \[J\]; zero unless effects are measured.
    pub heat: f64,
    /// Number of calls.
    pub calls: u64,
    /// Elements (vertices, triangles, ...) touched, summed over the calls.
    pub elements: u64,
    /// Whether the effect may be skipped.
    pub auto: bool,
    /// Number of skipped calls.
    pub skipped: u64,
    /// Steps in which the bodies that it acts on slept.
    pub slept: u64,
    /// Reason for the last skip; `None` if it was called.
    pub idle: Option<&'static str>,
}

impl EffectCost {
    /// Cost of an effect before its first call.
    pub const fn none(name: &'static str, auto: bool) -> Self {
        Self { name, time: Duration::ZERO, heat: 0.0, calls: 0, elements: 0, auto, skipped: 0, slept: 0, idle: None }
    }

    /// Records a skipped call.
    pub const fn pass_over(&mut self, why: &'static str) {
        self.skipped += 1;
        self.idle = Some(why);
    }

    /// Records a call.
    pub const fn call(&mut self, elements: usize) {
        self.calls += 1;
        self.elements += elements as u64;
        self.idle = None;
    }
}

/// Energies of a scene \[J\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energies {
    /// Kinetic energy.
    pub kinetic: f64,
    /// Elastic energy.
    pub elastic: f64,
    /// Of the skins of contacts, and of their friction.
    pub contact: f64,
    /// Other potential energy: gravity, the mouse spring.
    pub potential: f64,
}

impl Energies {
    /// Energy outside of bodies \[J\]: of contact, gravity and the mouse spring.
    pub fn external(self) -> f64 {
        self.contact + self.potential
    }

    /// The sum \[J\].
    pub fn total(self) -> f64 {
        self.kinetic + self.elastic + self.external()
    }
}

//! Why stepping stopped, found out and said in a sentence.

use crate::{elements::Field, materials::Model, scene::Scene, stability::critical_step, state::State};

/// A step that could not be taken. The simulation rests on the last finite state.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Number of the step that failed, counted from 1.
    pub step: u64,
    /// Simulated time before it [s].
    pub time: f64,
    /// Name of the body with the worst triangle.
    pub body: String,
    /// Number of that triangle in its body.
    pub triangle: usize,
    /// det F of that triangle before the step.
    pub volume_ratio: f64,
    /// What most likely went wrong.
    pub cause: Cause,
}

/// What most likely went wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// The step was longer than the stability limit.
    StepTooLong {
        /// Length of the step [s].
        step: f64,
        /// Longest stable step [s].
        limit: f64,
    },
    /// A triangle lost its area under a material whose energy is not defined there.
    Crushed(Model),
    /// Positions or speeds grew out of all bounds.
    Overflow,
}

impl Fault {
    /// Looks for the cause: `state` is the last finite state, `before` one a few steps earlier.
    pub fn find(scene: &Scene, state: &State, before: &State) -> Self {
        let (number, triangle, volume_ratio) = worst_triangle(scene, state);
        let body = &scene.bodies[number];
        // The limit h w = 2 scaled to the scheme's; schemes without one cannot fail by it.
        let limit = scene.integrator.kind().stability_limit().and_then(|reach| {
            let limits = [&scene.start, before].map(|state| critical_step(scene, state));
            limits.into_iter().flatten().reduce(f64::min).map(|limit| 0.5 * reach * limit)
        });
        let cause = match limit {
            Some(limit) if scene.step > limit => Cause::StepTooLong { step: scene.step, limit },
            _ if volume_ratio <= 0.0 => Cause::Crushed(body.elements.model()),
            _ => Cause::Overflow,
        };
        Self { step: state.steps + 1, time: state.time, body: body.name.clone(), triangle, volume_ratio, cause }
    }
}

/// Body, triangle and det F of the first triangle without a finite stress; if all have one, of the most deformed.
fn worst_triangle(scene: &Scene, state: &State) -> (usize, usize, f64) {
    let mut worst = (0, 0, 1.0);
    let mut deformation = -1.0;
    for (number, body) in scene.bodies.iter().enumerate() {
        let mut energies = Vec::new();
        body.elements.field(Field::EnergyDensity, &state.x, &mut energies);
        for (triangle, ((f, _), energy)) in body.elements.gradients(&state.x).zip(energies).enumerate() {
            if !energy.is_finite() {
                return (number, triangle, f.determinant());
            }
            if f.norm_squared() > deformation {
                deformation = f.norm_squared();
                worst = (number, triangle, f.determinant());
            }
        }
    }
    worst
}

impl std::fmt::Display for Fault {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { step, time, body, triangle, volume_ratio, cause } = self;
        write!(out, "Paused before step {step} (at {time:.3} s): the step would throw vertices out of all bounds. ")?;
        write!(out, "Triangle {triangle} of {body} went first (J = {volume_ratio:.2e}). ")?;
        match cause {
            Cause::StepTooLong { step, limit } => {
                write!(
                    out,
                    "The time step of {} is above the stability limit of about {}.",
                    Millis(*step),
                    Millis(*limit)
                )
            }
            Cause::Crushed(model) => {
                write!(out, "It was crushed inside out, where {} has no energy.", model.title())
            }
            Cause::Overflow => write!(out, "Its speed grew out of all bounds."),
        }
    }
}

/// A duration in milliseconds, three significant digits.
struct Millis(f64);

impl std::fmt::Display for Millis {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let millis = self.0 * 1e3;
        if millis == 0.0 {
            return write!(out, "0 ms");
        }
        let digits = (2.0 - libm::floor(libm::log10(millis.max(1e-12)))).clamp(0.0, 12.0) as usize;
        write!(out, "{millis:.digits$} ms")
    }
}

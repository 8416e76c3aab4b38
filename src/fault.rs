//! Faults: why stepping stopped, as a message.
//!
//! ```
//! use gingerbread::{files, levels, meshes::NoFiles, scene::Scene, simulation::Simulation};
//!
//! let level = files::parse(levels::built_in("jelly_disk").ok_or("there is no such level")?, "jelly_disk.ron")?;
//! let scene = Scene::build(&level, level.mode, &NoFiles, None)?;
//! let mut state = scene.start.clone();
//! state.v[0] = f64::NAN;
//! let mut simulation = Simulation::new(scene, state);
//! simulation.advance(1, &mut || true);
//! let fault = simulation.fault().ok_or("no step can be taken")?;
//! assert_eq!(fault.step, 1);
//! println!("{fault}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::{
    effects::Grab, elements::Field, guard::Guard, integrators::Class, scene::Scene, stability::critical_step,
    state::State,
};

/// A step that could not be taken. The simulation rests on the last finite state.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Number of the step that failed, counted from 1.
    pub step: u64,
    /// Simulated time before it \[s\].
    pub time: f64,
    /// Where the step failed.
    pub culprit: Culprit,
    /// Most likely cause.
    pub cause: Cause,
}

/// Place of a failure.
#[derive(Clone, Debug, PartialEq)]
pub enum Culprit {
    /// A triangle of a body.
    Triangle {
        /// Name of the body.
        body: String,
        /// Number of the triangle in it.
        number: usize,
        /// det F before the step.
        volume_ratio: f64,
    },
    /// A spring of a net.
    Spring {
        /// Name of the net.
        net: String,
        /// Number of the spring in it.
        number: usize,
        /// Its length before the step \[m\].
        length: f64,
    },
    /// The point of a toy.
    Toy,
}

/// Most likely cause.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// The step was longer than the stability limit.
    StepTooLong {
        /// Length of the step \[s\].
        step: f64,
        /// Longest stable step \[s\].
        limit: f64,
    },
    /// A triangle lost its area under a material of this name, whose energy is not defined there.
    Crushed(&'static str),
    /// Positions or speeds exceeded all bounds.
    Overflow,
    /// Unexplained energy, even in far shorter steps.
    Energy,
    /// The equations of an implicit step were not solved, or an error-controlled one was given up.
    Unsolved,
    /// The equations of several steps in a row were not solved while so many triangles were inverted.
    Inverted(usize),
}

impl Fault {
    /// Determines the cause: `state` is the last valid state, `before` one a few steps earlier; `grab` is the pull. `finite`
    /// is true if the failed step left finite numbers. `step` is the length of the shortest steps of any body or net \[s\].
    pub fn find(scene: &Scene, [state, before]: [&State; 2], grab: Option<Grab>, step: f64, finite: bool) -> Self {
        let (culprit, crushed) = worst_triangle(scene, state)
            .or_else(|| worst_spring(scene, state).map(|spring| (spring, None)))
            .unwrap_or((Culprit::Toy, None));
        // The limit h w = 2 scaled to that of the scheme; schemes without one are excluded.
        let limit = scene.integrator.kind().stability_limit().and_then(|reach| {
            let limits = [&scene.start, before].map(|state| critical_step(scene, state, grab));
            limits.into_iter().flatten().reduce(f64::min).map(|limit| 0.5 * reach * limit)
        });
        let cause = match limit {
            Some(limit) if step > limit => Cause::StepTooLong { step, limit },
            _ if crushed.is_none() && scene.integrator.kind().class() != Class::Explicit => Cause::Unsolved,
            _ if finite => Cause::Energy,
            _ => crushed.map_or(Cause::Overflow, Cause::Crushed),
        };
        Self { step: state.steps + 1, time: state.time, culprit, cause }
    }

    /// Fault after [`Guard::UNSOLVED_STEPS`] steps whose equations were not solved, in a state with inverted triangles.
    pub fn inverted(scene: &Scene, state: &State, count: usize) -> Self {
        let triangles = scene.bodies.iter().flat_map(|body| {
            let gradients = body.elements.gradients(&state.x).enumerate();
            gradients.map(move |(number, (f, _))| (body, number, f.determinant()))
        });
        let culprit =
            triangles.min_by(|(.., a), (.., b)| a.total_cmp(b)).map_or(Culprit::Toy, |(body, number, volume_ratio)| {
                let number = body.mesh.numbering().element_name(number);
                Culprit::Triangle { body: body.name.clone(), number, volume_ratio }
            });
        Self { step: state.steps + 1, time: state.time, culprit, cause: Cause::Inverted(count) }
    }
}

/// The first triangle without a finite stress, else the most deformed one, with its model if that has no energy there.
fn worst_triangle(scene: &Scene, state: &State) -> Option<(Culprit, Option<&'static str>)> {
    let mut worst = None;
    let mut greatest = f64::NEG_INFINITY;
    for body in &scene.bodies {
        let mut energies = Vec::new();
        body.elements.diagnose(Field::EnergyDensity, &state.x, &mut energies);
        for (number, ((f, _), energy)) in body.elements.gradients(&state.x).zip(energies).enumerate() {
            let undefined = !energy.is_finite() && f.norm_squared() < 1e12;
            let deformation = if energy.is_finite() { f.norm_squared() } else { f64::INFINITY };
            if deformation > greatest {
                greatest = deformation;
                worst = Some((body, number, f.determinant(), undefined));
            }
        }
    }
    let Some((body, number, volume_ratio, undefined)) = worst else { return worst_of_membranes(scene, state) };
    let crushed = (undefined && volume_ratio <= 0.0).then(|| body.elements.material().title());
    let number = body.mesh.numbering().element_name(number);
    Some((Culprit::Triangle { body: body.name.clone(), number, volume_ratio }, crushed))
}

/// The most deformed triangle of all membranes.
fn worst_of_membranes(scene: &Scene, state: &State) -> Option<(Culprit, Option<&'static str>)> {
    let all = scene.membranes.iter().flat_map(|membrane| {
        membrane.elements.gradients(&state.x).enumerate().map(move |(number, g)| (membrane, number, g))
    });
    let (membrane, number, g) = all.max_by(|(.., a), (.., b)| a.norm_squared().total_cmp(&b.norm_squared()))?;
    let number = membrane.mesh.numbering().element_name(number);
    Some((Culprit::Triangle { body: membrane.name.clone(), number, volume_ratio: g.determinant() }, None))
}

/// The spring that is farthest from its rest length.
fn worst_spring(scene: &Scene, state: &State) -> Option<Culprit> {
    let springs = scene.nets.iter().flat_map(|net| net.springs.links().iter().enumerate().map(move |link| (net, link)));
    let measured = springs.map(|(net, (number, link))| {
        let (length, number) = (net.springs.length(link, &state.x), net.numbering.element_name(number));
        ((length - link.rest).abs(), Culprit::Spring { net: net.name.clone(), number, length })
    });
    measured.max_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, culprit)| culprit)
}

impl std::fmt::Display for Culprit {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Triangle { body, number, volume_ratio } => {
                write!(out, "Triangle {number} of {body} failed first (J = det F = {volume_ratio:.2e}). ")
            }
            Self::Spring { net, number, length } => {
                write!(out, "Spring {number} of {net} failed first ({length:.2e} m long). ")
            }
            Self::Toy => Ok(()),
        }
    }
}

impl std::fmt::Display for Fault {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { step, time, culprit, cause } = self;
        write!(out, "Paused before step {step} (at {time:.3} s): ")?;
        if let Cause::Inverted(count) = cause {
            let (most, were) = (Guard::UNSOLVED_STEPS, if *count == 1 { " was" } else { "s were" });
            write!(
                out,
                "the equations of the last {most} steps were not solved, while {count} triangle{were} inverted (inside out)"
            )?;
            if let Culprit::Triangle { body, number, volume_ratio } = culprit {
                write!(out, ", most of all triangle {number} of {body} (J = det F = {volume_ratio:.2e})")?;
            }
            write!(out, ". ")?;
        } else {
            write!(
                out,
                "that step would give positions or velocities that are not finite or far too large. {culprit}"
            )?;
        }
        match cause {
            Cause::Inverted(_) => write!(out, "Choose a model that opposes inversion, or take shorter steps."),
            Cause::StepTooLong { limit: 0.0, .. } => {
                write!(
                    out,
                    "This scheme is unstable for every step length: undamped vibrations grow. Choose another integrator."
                )
            }
            Cause::StepTooLong { step, limit } => {
                write!(
                    out,
                    "The time step of {} is above the stability limit of about {}.",
                    Millis(*step),
                    Millis(*limit)
                )
            }
            Cause::Crushed(model) => {
                write!(
                    out,
                    "It was inverted (inside out), where the energy of {model} is not defined. Take shorter steps, or choose a model that is defined there, such as stable neo-Hookean."
                )
            }
            Cause::Unsolved => {
                write!(
                    out,
                    "The equations of a step of this length were not solved. Take shorter steps or a smaller tolerance."
                )
            }
            Cause::Energy => {
                write!(
                    out,
                    "The total energy grew although no work was done, even in steps {} times as short. Take shorter steps, or another integrator.",
                    1 << Guard::MOST
                )
            }
            Cause::Overflow => write!(out, "Positions [m] or velocities [m/s] grew beyond {:e}.", State::LIMIT),
        }
    }
}

/// A duration in milliseconds or microseconds, three significant digits.
struct Millis(f64);

impl std::fmt::Display for Millis {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (value, unit) = if self.0 < 1e-4 { (self.0 * 1e6, "µs") } else { (self.0 * 1e3, "ms") };
        let digits = (2.0 - libm::floor(libm::log10(value.max(1e-12)))).clamp(0.0, 12.0) as usize;
        write!(out, "{value:.digits$} {unit}")
    }
}

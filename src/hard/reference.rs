//! Reference motion of a hard case, and the distance of a run from it.

use super::{Case, Method, Run, run::MOST};
use crate::{materials::Model, scene::Scene, scene::SceneError, simulation::Simulation};

/// Reference motion of a case with a model: velocity Verlet in at least [`Self::STEPS`] steps a frame of 1/60 s, and in steps
/// at most [`Self::FINER`] times as short as those of the explicit schemes, which take up to 16,384 in a frame.
///
/// A second run in twice as long steps shows how far the motion can be known. The reference ends where the two differ by
/// more than [`Self::KNOWN`], as they do at some time if the motion is chaotic, and after [`Self::SECONDS`] at the latest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reference {
    moments: Vec<Moment>,
    /// Energy put in (see [`super::Account`]) \[J\].
    energy: f64,
    chaotic: bool,
}

/// Scene at the end of a frame.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Moment {
    x: Vec<f64>,
    momentum: [f64; 3],
    angular_momentum: [f64; 3],
    mechanical: f64,
}

/// Quantity that differs most from the reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Positions, root mean square over the mass, relative to the size of the bodies.
    Position,
    /// Momentum, relative to that of the bodies if all energy put in moved them together.
    Momentum,
    /// Angular momentum about the centre of the rest positions, relative to that momentum times the size.
    AngularMomentum,
    /// Kinetic and elastic energy, relative to the energy put in.
    Energy,
}

/// Distance of a run from its reference: the greatest difference up to a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// Relative difference.
    pub share: f64,
    /// Quantity that differs so much.
    pub quantity: Quantity,
    /// Time up to which runs are compared \[s\].
    pub until: f64,
}

impl Quantity {
    /// Name in plain words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Position => "positions",
            Self::Momentum => "momentum",
            Self::AngularMomentum => "angular momentum",
            Self::Energy => "energy",
        }
    }
}

/// What the distances are relative to.
#[derive(Clone, Debug)]
pub(super) struct Scale {
    /// Total mass \[kg\], size \[m\], centre of the rest positions \[m\].
    mass: f64,
    size: f64,
    centre: [f64; 3],
}

impl Scale {
    pub fn new(scene: &Scene, size: f64) -> Self {
        let dimension = scene.dimension;
        let mass = scene.mass.iter().step_by(dimension).sum::<f64>();
        let count = (scene.rest.len() / dimension) as f64;
        let mut centre = [0.0; 3];
        for (axis, centre) in centre.iter_mut().enumerate().take(dimension) {
            *centre = scene.rest.iter().skip(axis).step_by(dimension).sum::<f64>() / count;
        }
        Self { mass, size, centre }
    }

    pub fn moment(&self, simulation: &Simulation) -> Moment {
        let (scene, state, energies) = (simulation.scene(), simulation.state(), simulation.energies());
        let dimension = scene.dimension;
        let coupled = scene.coupled_mass.angular_momentum(dimension, &state.x, &state.v);
        let (mut momentum, mut angular_momentum) = ([0.0; 3], coupled);
        let points = state.x.chunks_exact(dimension).zip(state.v.chunks_exact(dimension));
        for ((x, v), mass) in points.zip(scene.mass.iter().step_by(dimension)) {
            let number = |of: &[f64], axis: usize| of.get(axis).copied().unwrap_or(0.0);
            let [x, v] = [x, v].map(|of| [0, 1, 2].map(|axis| number(of, axis)));
            let from: [f64; 3] = std::array::from_fn(|axis| x[axis] - self.centre[axis]);
            for axis in 0..3 {
                let (one, other) = ((axis + 1) % 3, (axis + 2) % 3);
                momentum[axis] += mass * v[axis];
                angular_momentum[axis] += mass * (from[one] * v[other] - from[other] * v[one]);
            }
        }
        Moment { x: state.x.clone(), momentum, angular_momentum, mechanical: energies.kinetic + energies.elastic }
    }

    /// Greatest relative difference of two moments, where so much energy was put in \[J\].
    fn distance(&self, scene: &Scene, [a, b]: [&Moment; 2], energy: f64) -> (f64, Quantity) {
        let speed = (2.0 * energy / self.mass).sqrt();
        let squares = a.x.iter().zip(&b.x).zip(&scene.mass).map(|((a, b), mass)| mass * (a - b) * (a - b));
        let length = |a: [f64; 3], b: [f64; 3]| libm::hypot(libm::hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
        let differences = [
            ((squares.sum::<f64>() / self.mass).sqrt() / self.size, Quantity::Position),
            (length(a.momentum, b.momentum) / (self.mass * speed), Quantity::Momentum),
            (
                length(a.angular_momentum, b.angular_momentum) / (self.mass * speed * self.size),
                Quantity::AngularMomentum,
            ),
            ((a.mechanical - b.mechanical).abs() / energy, Quantity::Energy),
        ];
        differences.into_iter().fold((0.0, Quantity::Position), |most, next| if next.0 <= most.0 { most } else { next })
    }
}

impl Reference {
    /// Least number of steps in a frame of 1/60 s.
    pub const STEPS: u32 = 100;
    /// Steps of the explicit schemes relative to those of the reference.
    pub const FINER: u32 = 10;
    /// Greatest relative difference of two resolutions up to which the motion is known.
    pub const KNOWN: f64 = 0.01;
    /// Longest time that it covers \[s\].
    pub const SECONDS: f64 = 4.0;

    /// Whether it ended early because the motion is chaotic.
    pub const fn is_chaotic(&self) -> bool {
        self.chaotic
    }

    /// Time that it covers \[s\].
    pub fn until(&self) -> f64 {
        self.moments.len() as f64 / 60.0
    }
}

/// Computation of a reference, frame by frame.
pub(super) struct ReferenceRun {
    /// The reference itself and the run in twice as long steps.
    runs: [Run; 2],
    scale: Scale,
    reference: Reference,
    frames: usize,
}

impl ReferenceRun {
    /// # Errors
    /// If the level of the case cannot be built.
    pub fn new(case: &Case, model: Model) -> Result<Self, SceneError> {
        let run = |divide: u32| {
            let run = Run::new(case, model, Method::VelocityVerlet)?;
            Ok(run.finer(Reference::FINER / divide).within(Reference::STEPS / divide, 2 * MOST / divide))
        };
        let runs = [run(1)?, run(2)?];
        let scale = runs[0].scale();
        let frames = (60.0 * Reference::SECONDS) as usize;
        Ok(Self { runs, scale, reference: Reference::default(), frames })
    }

    /// Advances by one frame. Returns whether it is over.
    ///
    /// # Errors
    /// If scripted actions lead to a scene that cannot be built.
    pub fn advance(&mut self) -> Result<bool, SceneError> {
        let mut over = false;
        for run in &mut self.runs {
            over |= run.advance()?.is_some();
            if run.simulation().fault().is_some() {
                return Ok(true);
            }
        }
        let [fine, coarse] = self.runs.each_ref().map(|run| self.scale.moment(run.simulation()));
        let reference = &mut self.reference;
        reference.energy = self.runs[0].put_in();
        let scene = self.runs[0].simulation().scene();
        let (share, _) = self.scale.distance(scene, [&fine, &coarse], reference.energy);
        if share > Reference::KNOWN || share.is_nan() {
            reference.chaotic = true;
            return Ok(true);
        }
        reference.moments.push(fine);
        Ok(over || reference.moments.len() >= self.frames)
    }

    /// Share of the work done.
    pub fn done(&self) -> f64 {
        (self.reference.moments.len() as f64 / self.frames as f64).max(self.runs[0].done())
    }

    /// The reference.
    pub fn finish(self) -> Reference {
        self.reference
    }
}

/// Comparison of a run with its reference, frame by frame.
pub(super) struct Comparison {
    scale: Scale,
    frame: usize,
    most: Option<Distance>,
}

impl Comparison {
    pub const fn new(scale: Scale) -> Self {
        Self { scale, frame: 0, most: None }
    }

    /// Compares the end of the next frame.
    pub fn record(&mut self, simulation: &Simulation, reference: &Reference) {
        let Some(moment) = reference.moments.get(self.frame) else { return };
        self.frame += 1;
        let own = self.scale.moment(simulation);
        let (share, quantity) = self.scale.distance(simulation.scene(), [&own, moment], reference.energy);
        let most = self.most.get_or_insert(Distance { share, quantity, until: 0.0 });
        if share > most.share || share.is_nan() {
            (most.share, most.quantity) = (share, quantity);
        }
        most.until = self.frame as f64 / 60.0;
    }

    /// Greatest distance so far; `None` without a reference.
    pub const fn distance(&self) -> Option<Distance> {
        self.most
    }
}

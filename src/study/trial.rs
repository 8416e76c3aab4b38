//! Run of one setting, which is an integrator and steps per frame: its error and its cost.

use super::{
    Reference, StudyError,
    march::{Deadline, March},
};
use crate::{
    command::Command,
    effects::Grab,
    integrators::{Class, IntegratorKind},
    level::{Level, Substeps},
    meshes::Files,
    report::Counts,
    scene::{Scene, SceneError, check_toy_integrator},
    stability::critical_step,
    state::State,
};
use std::{ops::ControlFlow, time::Duration};

/// Scene, start and simulated time. Positions are compared at the end of every frame of 1/60 s.
#[derive(Clone)]
pub struct Trial {
    /// Title of the level.
    pub name: String,
    /// Scene. Its own integrator and step are not used.
    pub scene: Scene,
    /// Start state.
    pub start: State,
    /// Grab of the mouse during the whole run.
    pub grab: Option<Grab>,
    /// Number of frames of 1/60 s.
    pub frames: u32,
    /// Setting of the level, for comparison.
    pub current: Setting,
}

impl Trial {
    /// Trial of a level from its start or its saved state. The time \[s\] is rounded to frames of 1/60 s.
    ///
    /// # Errors
    /// If the level cannot be built.
    pub fn new(level: &Level, files: &dyn Files, seconds: f64) -> Result<Self, StudyError> {
        let scene = Scene::build(level, level.mode, files, None)?;
        let start = scene.first_state(level.state.as_ref())?;
        let frames = (seconds * 60.0).round().clamp(1.0, f64::from(u32::MAX)) as u32;
        Ok(Self { name: level.name.clone(), scene, start, grab: None, frames, current: Setting::of(level) })
    }

    /// Simulated time \[s\].
    pub fn seconds(&self) -> f64 {
        f64::from(self.frames) / 60.0
    }

    /// Whether a scheme can step this.
    ///
    /// # Errors
    /// [`SceneError::ToyIntegrator`].
    pub fn check(&self, integrator: &IntegratorKind) -> Result<(), SceneError> {
        if self.scene.toy.is_none() { Ok(()) } else { check_toy_integrator(integrator) }
    }

    /// Whether a scheme can step this.
    pub fn suits(&self, integrator: &IntegratorKind) -> bool {
        self.check(integrator).is_ok()
    }

    pub(super) fn march(&self, setting: &Setting) -> March {
        let mut march = March::new(&self.scene, &self.start, setting, self.frames);
        march.simulation.set_grab(self.grab);
        march
    }
}

/// Status of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// The run reached its end.
    Ok,
    /// The run stopped with a fault, or its error was far above 1.
    Unstable,
    /// The run reached its end, but some equations were not solved.
    Unconverged,
}

impl Status {
    /// Word for tables.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Unstable => "unstable",
            Self::Unconverged => "unconverged",
        }
    }
}

/// Outcome of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Relative RMS error of positions, mean over all frames and vertices:
    /// `sqrt(mean |x - x_ref|²) / sqrt(mean |x_ref - x_start|²)`. Infinite if it was stopped by a fault.
    pub error: f64,
    /// Largest error of a frame: RMS over the vertices at that frame, over the same RMS motion.
    pub greatest_error: f64,
    /// Error of a frame that 95 % of the frames are within.
    pub usual_error: f64,
    /// Status of the run.
    pub status: Status,
    /// Work counts, equal on every machine.
    pub counts: Counts,
    /// Processor time per second of simulated time \[ms\], the least of `runs` runs.
    pub ms_per_second: f64,
    /// Number of runs.
    pub runs: u32,
}

/// Ratio of error to motion above which a run is stopped and called unstable.
pub(super) const DIVERGED: f64 = 10.0;
/// Least motion in that ratio, as a share of the greatest coordinate. Without it tiny motions would seem unstable.
const SMALL: f64 = 1e-3;

/// Sums of squares for a relative RMS error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Deviation {
    /// Number of coordinates of a vertex.
    dimension: usize,
    error: f64,
    size: f64,
    /// Greatest sum of squared errors of one moment \[m²\].
    greatest: f64,
    moments: f64,
    /// Number of coordinates at a moment.
    coordinates: f64,
}

impl Deviation {
    /// Sums over no moments yet, in so many dimensions.
    pub const fn new(dimension: usize) -> Self {
        Self { dimension, error: 0.0, size: 0.0, greatest: 0.0, moments: 0.0, coordinates: 0.0 }
    }

    /// Sums over no moments, in the same number of dimensions.
    pub const fn anew(self) -> Self {
        Self::new(self.dimension)
    }

    /// Adds one moment: positions, exact positions and start positions \[m\]. Returns the sum of its squared errors \[m²\].
    pub fn add(&mut self, x: &[f64], exact: &[f64], start: &[f64]) -> f64 {
        let error = x.iter().zip(exact).map(|(x, exact)| (x - exact) * (x - exact)).sum::<f64>();
        self.error += error;
        self.greatest = self.greatest.max(error);
        self.moments += 1.0;
        self.coordinates = x.len().max(1) as f64;
        self.size += exact.iter().zip(start).map(|(exact, start)| (exact - start) * (exact - start)).sum::<f64>();
        error
    }

    /// Error of this single moment over the RMS motion of all moments so far.
    pub fn relative_to(self, all: Self, moments: f64) -> f64 {
        if self.error == 0.0 { 0.0 } else { (self.error * moments / all.size).sqrt() }
    }

    /// Root mean square of the motion over all moments and vertices \[m\].
    pub fn motion(self) -> f64 {
        (self.dimension as f64 * self.size / (self.coordinates * self.moments).max(1.0)).sqrt()
    }

    /// Root mean square of the error over all moments and vertices \[m\].
    fn metres(self) -> f64 {
        (self.dimension as f64 * self.error / (self.coordinates * self.moments).max(1.0)).sqrt()
    }

    /// Largest error of a moment, over the same motion as the [relative](Self::relative) error.
    pub fn greatest(self) -> f64 {
        self.of_moment(self.greatest)
    }

    /// Error of a moment with this sum of squared errors \[m²\], over the same motion.
    fn of_moment(self, squares: f64) -> f64 {
        if squares == 0.0 { 0.0 } else { (squares * self.moments / self.size).sqrt() }
    }

    /// Relative RMS error. Zero if the error is zero, even without motion.
    pub fn relative(self) -> f64 {
        if self.error == 0.0 { 0.0 } else { (self.error / self.size).sqrt() }
    }
}

/// Run of a trial as a job.
pub struct TrialRun {
    march: March,
    deviation: Deviation,
    /// Sum of squared errors of each frame \[m²\].
    frames: Vec<f64>,
    diverged: bool,
}

impl TrialRun {
    /// Prepares a run of a trial with a setting.
    pub fn new(trial: &Trial, setting: &Setting) -> Self {
        let deviation = Deviation::new(trial.scene.dimension);
        Self { march: trial.march(setting), deviation, frames: Vec::new(), diverged: false }
    }

    /// Works for about `budget`. Returns the outcome when the run is over.
    pub fn advance(&mut self, trial: &Trial, reference: &Reference, budget: Duration) -> Option<Outcome> {
        self.until(trial, reference, Deadline::after(budget))
    }

    pub(super) fn until(&mut self, trial: &Trial, reference: &Reference, deadline: Deadline) -> Option<Outcome> {
        let Self { march, deviation, frames, diverged } = self;
        let over = march.advance(deadline, &mut |frame, simulation| {
            frames.push(deviation.add(&simulation.state().x, reference.at(frame), &trial.start.x));
            *diverged = deviation.metres() > DIVERGED * deviation.motion().max(SMALL * reference.extent());
            if *diverged { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        over.then(|| self.outcome())
    }

    /// Share of the run done.
    pub fn done(&self) -> f64 {
        self.march.done()
    }

    /// Processor time of stepping.
    pub(super) const fn spent(&self) -> Duration {
        self.march.spent
    }

    fn outcome(&self) -> Outcome {
        let counts = self.march.simulation.counts();
        let stopped = self.march.simulation.fault().is_some();
        let status = if stopped || self.diverged {
            Status::Unstable
        } else if counts.unconverged > 0 {
            Status::Unconverged
        } else {
            Status::Ok
        };
        let of = |error: f64| if stopped { f64::INFINITY } else { error };
        let (error, greatest_error) = (of(self.deviation.relative()), of(self.deviation.greatest()));
        let usual_error = of(self.deviation.of_moment(quantile(&self.frames)));
        Outcome {
            error,
            greatest_error,
            usual_error,
            status,
            counts,
            ms_per_second: self.march.ms_per_second(),
            runs: 1,
        }
    }
}

/// The least of some numbers that 95 % of them are within; zero if there are none.
fn quantile(numbers: &[f64]) -> f64 {
    /// Part of the numbers that is within.
    const PART: f64 = 0.95;
    let mut sorted = numbers.to_vec();
    sorted.sort_by(f64::total_cmp);
    let within = libm::ceil(PART * sorted.len() as f64) as usize;
    sorted.get(within.saturating_sub(1)).copied().unwrap_or(0.0)
}

/// Integrator with its parameters, and number of steps per frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// Integrator.
    pub integrator: IntegratorKind,
    /// Steps per 1/60 s.
    pub substeps: Substeps,
}

impl Setting {
    /// Setting of a level.
    pub fn of(level: &Level) -> Self {
        Self { integrator: level.integrator.clone(), substeps: level.substeps }
    }

    /// Commands that apply the setting to a sandbox. Positions and velocities stay.
    pub fn commands(&self) -> Vec<Command> {
        vec![Command::EndGesture, Command::SetStepping(self.integrator.clone(), self.substeps), Command::EndGesture]
    }

    /// Relative tolerance, if the scheme controls its error.
    pub fn tolerance(&self) -> Option<f64> {
        let mut integrator = self.integrator.clone();
        let parameters = tolerances(&mut integrator);
        parameters.first().map(|tolerance| tolerance.get())
    }

    /// Label, such as `RK4, 12 steps a frame` or `Dormand-Prince 5(4), tolerance 1e-4`.
    pub fn label(&self) -> String {
        let title = self.integrator.kind().title();
        match (self.tolerance(), self.substeps.get()) {
            (Some(tolerance), 1) => format!("{title}, tolerance {tolerance:e}"),
            (Some(tolerance), substeps) => format!("{title}, tolerance {tolerance:e}, {substeps} steps a frame"),
            (None, 1) => format!("{title}, 1 step a frame"),
            (None, substeps) => format!("{title}, {substeps} steps a frame"),
        }
    }
}

/// Tolerances of a scheme, the relative one first. Empty if it does not control its error.
fn tolerances(integrator: &mut IntegratorKind) -> Vec<&mut dyn crate::quantity::Quantity> {
    if integrator.kind().class() != Class::ErrorControlled {
        return Vec::new();
    }
    let parameters = integrator.kind_mut().parameters();
    let mut tolerances: Vec<_> =
        parameters.into_iter().filter(|parameter| parameter.spec().name.contains("tolerance")).collect();
    tolerances.sort_by_key(|tolerance| !tolerance.spec().name.contains("relative"));
    tolerances
}

/// Scheme with all tolerances set to a value. `None` if it has none, or if the value is out of range.
pub(super) fn with_tolerance(integrator: &IntegratorKind, value: f64) -> Option<IntegratorKind> {
    let mut integrator = integrator.clone();
    let mut tolerances = tolerances(&mut integrator);
    if tolerances.is_empty() || !tolerances.iter_mut().all(|tolerance| tolerance.set(value).is_ok()) {
        return None;
    }
    drop(tolerances);
    Some(integrator)
}

/// Steps per frame at the stability limit of symplectic Euler near a state; 1 if nothing is stiff.
pub(super) fn limit(scene: &Scene, start: &State) -> f64 {
    let steps = [&scene.start, start].into_iter().filter_map(|state| critical_step(scene, state, None));
    steps.reduce(f64::min).map_or(1.0, |step| 1.0 / (60.0 * step))
}

/// Settings to try for a scheme, cheapest first.
/// Explicit schemes: steps from just above the stability limit of symplectic Euler to 1/64 of it (1/16 from order 4
/// on). Implicit schemes: 1 to 32 steps per frame. Error control: tolerances from 1e-3 to 1e-9. With looser ones,
/// which also apply in metres, a step could move vertices across whole triangles.
pub fn ladder(integrator: &IntegratorKind, scene: &Scene, start: &State) -> Vec<Setting> {
    let at = |count: f64| Setting { integrator: integrator.clone(), substeps: Substeps::nearest(count) };
    let mut settings: Vec<Setting> = match integrator.kind().class() {
        Class::Explicit => {
            let limit = limit(scene, start);
            // The first step is too long for symplectic Euler, but not for every scheme.
            let shares = [0.75, 1.1, 1.5, 2.0, 3.0, 4.0, 8.0, 16.0, 32.0, 64.0];
            // A scheme of high order is below all errors of interest long before 1/64.
            let finest = if integrator.kind().order() >= 4 { 16.0 } else { 64.0 };
            shares.into_iter().filter(|share| *share <= finest).map(|share| at(share * limit)).collect()
        }
        Class::Implicit => [1.0, 2.0, 4.0, 8.0, 16.0, 32.0].into_iter().map(at).collect(),
        Class::ErrorControlled => (3..=9)
            .filter_map(|digits| {
                let integrator = with_tolerance(integrator, libm::pow(10.0, -f64::from(digits)))?;
                Some(Setting { integrator, substeps: Substeps::nearest(1.0) })
            })
            .collect(),
    };
    settings.dedup();
    settings
}

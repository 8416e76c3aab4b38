//! Drift study: energy and momentum over time for every integrator.

use super::{
    Limits, MeasuredOrder, NoOrder, Progress, Sample, Setting, Status, Trial,
    march::{Deadline, March, spread},
    measured_order,
    trial::{DIVERGED, limit},
};
use crate::{
    fault::Fault,
    integrators::{Class, IntegratorKind},
    level::Substeps,
    simulation::Simulation,
};
use std::{ops::ControlFlow, time::Duration};

/// Conserved quantity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Invariant {
    /// Sum of all energies and of the heat of effects, less the work of moving obstacles.
    #[default]
    Energy,
    /// Sum of m v.
    Momentum,
    /// Sum of m x × v.
    AngularMomentum,
}

impl Invariant {
    /// All conserved quantities.
    pub const ALL: [Self; 3] = [Self::Energy, Self::Momentum, Self::AngularMomentum];

    /// Name in plain words.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Energy => "energy",
            Self::Momentum => "linear momentum",
            Self::AngularMomentum => "angular momentum",
        }
    }

    /// Unit of its change. Energy has none: its change is divided by [`Drift::scale`].
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Energy => "",
            Self::Momentum => "kg m/s",
            Self::AngularMomentum => "kg m²/s",
        }
    }
}

/// Energy and momentum at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moment {
    /// Time since the start of the trial \[s\].
    pub time: f64,
    /// Sum of all energies and of the heat of effects, less the work of moving obstacles \[J\].
    pub energy: f64,
    /// Kinetic energy \[J\].
    pub kinetic: f64,
    /// Linear momentum [kg m/s].
    pub momentum: [f64; 3],
    /// Angular momentum about the origin of the world [kg m²/s]; in the plane along the third axis alone.
    pub angular: [f64; 3],
}

impl Moment {
    /// Energy and momentum now, at a time \[s\].
    pub fn of(simulation: &Simulation, time: f64) -> Self {
        let [momentum, angular] = simulation.momenta();
        let energies = simulation.energies();
        let energy = energies.total() + simulation.heat() - simulation.work_of_obstacles();
        Self { time, energy, kinetic: energies.kinetic, momentum, angular }
    }
}

/// Length of the difference of two vectors.
fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// Run of one setting.
pub struct DriftRun {
    /// Integrator and steps per frame.
    pub setting: Setting,
    /// Moments at the start and at the end of every frame so far.
    pub moments: Vec<Moment>,
    march: March,
    over: bool,
    /// Whether something touched at one of these moments.
    touched: bool,
}

impl DriftRun {
    /// Fault that stopped the run, if any.
    pub const fn fault(&self) -> Option<&Fault> {
        self.march.simulation.fault()
    }

    /// Whether a wall, the edge of the domain or another surface was touched.
    pub fn touches(&self) -> bool {
        self.touched || self.march.simulation.counts().constrained > 0
    }

    fn greatest_kinetic(&self) -> f64 {
        self.moments.iter().map(|moment| moment.kinetic).fold(0.0, f64::max)
    }

    /// Greatest change of the energy, by magnitude \[J\].
    fn greatest_gain(&self) -> f64 {
        let first = self.moments.first().map_or(0.0, |first| first.energy);
        self.moments.iter().map(|moment| (moment.energy - first).abs()).fold(0.0, f64::max)
    }
}

/// Drift study of several settings as a job.
pub struct Drift {
    trial: Trial,
    runs: Vec<DriftRun>,
    threads: usize,
}

/// Relative rounding error of the energy after many steps.
const ROUND_OFF: f64 = 1e-12;

/// Kinetic energy below this is rounding: absolute \[J\], and as a share of the energy at the start.
const STILL: (f64, f64) = (1e-18, 1e-9);

impl Drift {
    /// Prepares a run for each setting. Settings whose scheme does not suit the trial are left out.
    pub fn new(trial: Trial, settings: Vec<Setting>, threads: usize) -> Self {
        let run = |setting: Setting| {
            let mut march = trial.march(&setting);
            march.simulation.set_measured(true);
            let moments = vec![Moment::of(&march.simulation, 0.0)];
            DriftRun { setting, moments, march, over: false, touched: false }
        };
        let suiting = settings.into_iter().filter(|setting| trial.suits(&setting.integrator));
        Self { runs: suiting.map(run).collect(), trial, threads }
    }

    /// Setting for each scheme. All take `substeps`, if given.
    /// If `substeps` is `None`, schemes of the class of the trial's current setting take the steps of that setting.
    /// Otherwise the step of an explicit scheme is two thirds of the stability limit of symplectic Euler. The step of
    /// an implicit scheme is ten times that of an explicit one, as each implicit step costs more.
    pub fn settings(trial: &Trial, integrators: &[IntegratorKind], substeps: Option<Substeps>) -> Vec<Setting> {
        let now = &trial.current;
        let class = now.integrator.kind().class();
        let own = f64::from(now.substeps.get());
        let explicit = if class == Class::Explicit { own } else { 1.5 * limit(&trial.scene, &trial.start) };
        let implicit = if class == Class::Implicit { own } else { 0.1 * explicit };
        let of = |integrator: &IntegratorKind| {
            if integrator.name() == now.integrator.name() && substeps.is_none() {
                return now.clone();
            }
            let fair = match integrator.kind().class() {
                Class::Explicit => explicit,
                Class::Implicit => implicit,
                Class::ErrorControlled => 1.0,
            };
            Setting { integrator: integrator.clone(), substeps: substeps.unwrap_or_else(|| Substeps::nearest(fair)) }
        };
        integrators.iter().map(of).collect()
    }

    /// Works for about `budget`.
    pub fn advance(&mut self, budget: Duration) -> Progress {
        let deadline = Deadline::after(budget);
        let open = self.runs.iter_mut().filter(|run| !run.over).collect();
        spread(self.threads, open, |run: &mut DriftRun| {
            let (moments, touched) = (&mut run.moments, &mut run.touched);
            run.over = run.march.advance(deadline, &mut |frame, simulation| {
                moments.push(Moment::of(simulation, f64::from(frame) / 60.0));
                *touched |= !simulation.state().anchors.is_empty();
                ControlFlow::Continue(())
            });
            run.over && !deadline.passed()
        });
        let done = self.runs.iter().map(|run| if run.over { 1.0 } else { run.march.done() }).sum::<f64>();
        let finished = self.runs.iter().all(|run| run.over);
        Progress { done: done / self.runs.len().max(1) as f64, finished }
    }

    /// Trial that is run.
    pub const fn trial(&self) -> &Trial {
        &self.trial
    }

    /// Number of threads.
    pub const fn threads(&self) -> usize {
        self.threads
    }

    /// Runs so far, in the order of the settings.
    pub fn runs(&self) -> &[DriftRun] {
        &self.runs
    }

    /// Scale of energy changes: the greatest kinetic energy of a run, median over all runs begun \[J\].
    /// The energy itself is no scale, because its zero is arbitrary.
    pub fn scale(&self) -> f64 {
        self.median(DriftRun::greatest_kinetic)
    }

    fn median(&self, of: fn(&DriftRun) -> f64) -> f64 {
        let begun = self.runs.iter().filter(|run| run.moments.len() > 1);
        let mut values: Vec<f64> = begun.map(of).collect();
        values.sort_by(f64::total_cmp);
        // The lower one of two middle values, so that an unstable run does not set the scale.
        values.get(values.len().saturating_sub(1) / 2).copied().unwrap_or(0.0)
    }

    /// Status of a run so far.
    /// It is unstable if it stopped, or if its energy changed by more than ten times the [scale](Self::scale) and ten
    /// times the median change of all runs. The energy rule is needed because a diverging run between walls may go on
    /// for long.
    pub fn status(&self, run: &DriftRun) -> Status {
        let far = DIVERGED * self.scale().max(self.median(DriftRun::greatest_gain));
        let moves = self.runs.len() > 1 && self.nothing_of(Invariant::Energy).is_none();
        if run.fault().is_some() || moves && run.greatest_gain() > far {
            Status::Unstable
        } else if run.march.simulation.counts().unconverged > 0 {
            Status::Unconverged
        } else {
            Status::Ok
        }
    }

    /// Runs that stayed valid and touched a wall. A wall may change momentum, so these changes are no error.
    pub fn touching(&self) -> impl Iterator<Item = &DriftRun> {
        self.runs.iter().filter(|run| run.touches() && self.status(run) != Status::Unstable)
    }

    /// [Orders](Self::order) of all schemes that were run with several steps.
    pub fn orders(&self) -> Vec<(&IntegratorKind, MeasuredOrder)> {
        let mut kinds: Vec<&IntegratorKind> = Vec::new();
        let of = |run: &DriftRun, integrator: &IntegratorKind| run.setting.integrator == *integrator;
        for (number, run) in self.runs.iter().enumerate() {
            let integrator = &run.setting.integrator;
            let again = self.runs[number + 1..].iter().any(|other| of(other, integrator));
            if again && !kinds.contains(&integrator) {
                kinds.push(integrator);
            }
        }
        kinds.into_iter().map(|integrator| (integrator, self.order(integrator))).collect()
    }

    /// Order in the step at which the greatest energy change of a scheme falls, by [`measured_order`].
    ///
    /// # Errors
    /// [`NoOrder`] if no order can be measured.
    pub fn order(&self, integrator: &IntegratorKind) -> MeasuredOrder {
        if self.nothing_of(Invariant::Energy).is_some() {
            return Err(NoOrder::NothingMoves);
        }
        let own = || self.runs.iter().filter(|run| run.setting.integrator == *integrator);
        let sample = |run: &DriftRun| Sample {
            h: run.setting.substeps.step(),
            error: self.greatest_change(run, Invariant::Energy),
        };
        let valid = own().filter(|run| self.status(run) == Status::Ok);
        let most = self.runs.iter().flat_map(|run| &run.moments).take(1).map(|first| first.energy.abs());
        let round_off = ROUND_OFF * most.fold(self.scale(), f64::max) / self.scale();
        measured_order(valid.map(sample), Limits { round_off, reference: 0.0 })
    }

    /// Change of a conserved quantity of a run since its start.
    /// Energy: `(E(t) - E(0))` over [`Self::scale`], negative for a loss. Momentum: magnitude of the change, in
    /// [`Invariant::unit`].
    pub fn change(&self, run: &DriftRun, invariant: Invariant, moment: &Moment) -> f64 {
        let Some(first) = run.moments.first() else { return 0.0 };
        match invariant {
            Invariant::Energy if moment.energy == first.energy => 0.0,
            Invariant::Energy => (moment.energy - first.energy) / self.scale(),
            Invariant::Momentum => distance(moment.momentum, first.momentum),
            Invariant::AngularMomentum => distance(moment.angular, first.angular),
        }
    }

    /// Greatest change of a run, by magnitude.
    pub fn greatest_change(&self, run: &DriftRun, invariant: Invariant) -> f64 {
        run.moments.iter().map(|moment| self.change(run, invariant, moment).abs()).fold(0.0, f64::max)
    }

    /// Reason why the quantity cannot be studied here, in plain words.
    pub fn nothing_of(&self, invariant: Invariant) -> Option<&'static str> {
        let start = self.runs.iter().find_map(|run| run.moments.first()).map_or(0.0, |first| first.energy.abs());
        if self.trial.scene.toy.is_some() && invariant != Invariant::Energy {
            Some("A toy problem has no momentum: its two numbers are not positions of masses.")
        } else if self.scale() < STILL.0.max(STILL.1 * start) && self.runs.iter().all(|run| run.moments.len() > 1) {
            Some("Almost nothing moves here, so there is no energy or momentum to gain or lose.")
        } else {
            None
        }
    }

    /// Physical causes that change the quantity in every run, so that a change is no error of a scheme.
    /// Walls are not listed: they act only in the runs that touch them, see [`Self::touching`].
    pub fn changed_by(&self, invariant: Invariant) -> Vec<&'static str> {
        let scene = &self.trial.scene;
        let motion = scene.motion(&self.trial.start, self.trial.grab);
        let damping =
            scene.effects.iter().map(|effect| effect.damping(motion)).fold(0.0, |alpha, [more, _]| alpha + more);
        let energy = invariant == Invariant::Energy;
        // What damping takes of the energy is counted. Stiffness-proportional damping acts between vertices: it takes no momentum.
        let damped = !energy && damping > 0.0;
        let has = |name: &str| scene.effects.iter().any(|effect| effect.name() == name);
        let heavy = has("Gravity");
        let reasons = [
            (damped, "damping"),
            (!energy && heavy, "gravity"),
            (!energy && has("BodyForce"), "a typed force"),
            (!energy && has("Beads on a wire"), "a wire"),
            (!energy && !scene.pins.is_empty(), "pins"),
            (!energy && !scene.rollers.is_empty(), "rollers"),
        ];
        reasons.into_iter().filter(|(holds, _)| *holds).map(|(_, name)| name).collect()
    }
}

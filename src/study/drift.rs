//! What schemes do to energy and momentum over time.

use super::{
    Progress, Setting, Trial,
    march::{Deadline, March},
    workers::spread,
};
use crate::{fault::Fault, simulation::Simulation};
use std::{ops::ControlFlow, time::Duration};

/// What should stay, at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moment {
    /// Time since the start of the trial [s].
    pub time: f64,
    /// Kinetic, elastic and potential energy together [J].
    pub energy: f64,
    /// Linear momentum [kg m/s].
    pub momentum: [f64; 2],
    /// Angular momentum about the origin of the world [kg m²/s], counter-clockwise.
    pub angular: f64,
}

impl Moment {
    fn of(simulation: &Simulation, time: f64) -> Self {
        let state = simulation.state();
        let points = state.x.chunks_exact(2).zip(state.v.chunks_exact(2)).zip(simulation.scene().mass.chunks_exact(2));
        let [px, py, angular] = points.fold([0.0; 3], |[px, py, l], ((x, v), m)| {
            [px + m[0] * v[0], py + m[1] * v[1], l + m[0] * (x[0] * v[1] - x[1] * v[0])]
        });
        Self { time, energy: simulation.energies().total(), momentum: [px, py], angular }
    }
}

/// The course of one setting.
pub struct DriftRun {
    /// How it was stepped.
    pub setting: Setting,
    /// The start, and the end of every frame so far.
    pub moments: Vec<Moment>,
    march: March,
    over: bool,
}

impl DriftRun {
    /// Why it stopped early, if it did.
    pub const fn fault(&self) -> Option<&Fault> {
        self.march.simulation.fault()
    }

    /// Greatest change of the energy, over the energy at the start [1].
    pub fn energy_drift(&self) -> f64 {
        let first = self.moments.first().map_or(0.0, |moment| moment.energy);
        let greatest = self.moments.iter().map(|moment| (moment.energy - first).abs()).fold(0.0, f64::max);
        if greatest == 0.0 { 0.0 } else { greatest / first.abs() }
    }
}

/// The courses of several settings as a job.
pub struct Drift {
    runs: Vec<DriftRun>,
    threads: usize,
}

impl Drift {
    /// Prepares the courses of a trial with those of these settings that suit it.
    pub fn new(trial: &Trial, settings: Vec<Setting>, threads: usize) -> Self {
        let run = |setting: Setting| {
            let march = trial.march(&setting);
            let moments = vec![Moment::of(&march.simulation, 0.0)];
            DriftRun { setting, moments, march, over: false }
        };
        Self {
            runs: settings.into_iter().filter(|setting| trial.suits(&setting.integrator)).map(run).collect(),
            threads,
        }
    }

    /// Works for about `budget`.
    pub fn advance(&mut self, budget: Duration) -> Progress {
        let deadline = Deadline::after(budget);
        let open = self.runs.iter_mut().filter(|run| !run.over).collect();
        spread(self.threads, open, |run: &mut DriftRun| {
            let moments = &mut run.moments;
            run.over = run.march.advance(deadline, &mut |frame, simulation| {
                moments.push(Moment::of(simulation, f64::from(frame) / 60.0));
                ControlFlow::Continue(())
            });
            run.over && !deadline.passed()
        });
        let done = self.runs.iter().map(|run| if run.over { 1.0 } else { run.march.done() }).sum::<f64>();
        let finished = self.runs.iter().all(|run| run.over);
        Progress { done: done / self.runs.len().max(1) as f64, finished }
    }

    /// How many run at once.
    pub(super) const fn threads(&self) -> usize {
        self.threads
    }

    /// The courses so far, in the order of the settings.
    pub fn runs(&self) -> &[DriftRun] {
        &self.runs
    }
}

//! Comparison of two panes: the same scene with two settings.
//!
//! Pane A is the window's own sandbox. Pane B is a second sandbox that gets the same commands, except scheme, step, model and mesh.
//! Both panes have the same simulated time whenever they are shown.

mod link;
mod record;
mod rounds;
mod stage;
#[cfg(test)]
mod tests;

pub use record::{Moment, Record};
pub use stage::{Split, Stage};

use super::{jobs::Jobs, panels::History, theme::Theme};
use crate::{
    command::{About, Command},
    sandbox::{Refused, Sandbox},
    simulation::Restart,
    snapshot::{Field, Snapshot},
};
use eframe::egui::Color32;
use rounds::Rounds;

/// One of the two panes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pane {
    /// The first pane: the original scene.
    #[default]
    A,
    /// The second pane: a copy of the scene.
    B,
}

impl Pane {
    /// Both panes, in order.
    pub const BOTH: [Self; 2] = [Self::A, Self::B];

    /// Letter of the pane.
    pub const fn letter(self) -> &'static str {
        match self {
            Self::A => "A",
            Self::B => "B",
        }
    }

    /// The other pane.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::A => Self::B,
            Self::B => Self::A,
        }
    }
}

/// Colour of a pane.
pub const fn color(theme: &Theme, pane: Pane) -> Color32 {
    theme.series[pane as usize]
}

/// Requests for the two panes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PaneRequest {
    /// Splits the stage, or joins it and keeps A.
    Toggle,
    /// Chooses the pane that the panels edit.
    Choose(Pane),
    /// Joins the stage and keeps this pane.
    Keep(Pane),
}

/// The second pane and the state that both panes share. Methods borrow pane A where they need it.
pub struct Comparison {
    pub(super) b: Sandbox,
    pub(super) snapshot: Snapshot,
    pub(super) history: History,
    pub(super) jobs: Jobs,
    pub(super) stage: Stage,
    chosen: Pane,
    past: Vec<Change>,
    future: Vec<Change>,
    rounds: Rounds,
    record: Record,
}

/// A change that is undone in both panes at once.
struct Change {
    /// Number of undo steps of the change in each pane.
    counts: [u64; 2],
    /// State of a pane that did not change itself but started over with the other pane.
    states: [Option<Restart>; 2],
}

/// Maximum number of changes in the undo history.
const DEPTH: usize = 200;

impl Comparison {
    /// Creates two equal panes and chooses B.
    pub fn new(a: &Sandbox) -> Self {
        Self {
            b: a.fork(),
            snapshot: Snapshot::default(),
            history: History::default(),
            jobs: Jobs::default(),
            stage: Stage::default(),
            chosen: Pane::B,
            past: Vec::new(),
            future: Vec::new(),
            rounds: Rounds::default(),
            record: Record::default(),
        }
    }

    /// Sandbox of the second pane.
    pub const fn sandbox(&self) -> &Sandbox {
        &self.b
    }

    /// Snapshot of the second pane.
    pub const fn snapshot(&self) -> &Snapshot {
        &self.snapshot
    }

    /// Pane that the panels show and edit.
    pub const fn chosen(&self) -> Pane {
        self.chosen
    }

    /// Chooses the pane that the panels show and edit.
    pub const fn choose(&mut self, pane: Pane) {
        self.chosen = pane;
    }

    /// Recorded difference of the panes over time.
    pub const fn record(&self) -> &Record {
        &self.record
    }

    /// Whether simulated time runs in both panes.
    pub const fn is_live(&self, a: &Sandbox) -> bool {
        a.is_live() && self.b.is_live()
    }

    /// Whether there is anything to compute in either pane.
    pub const fn is_busy(&self, a: &Sandbox) -> bool {
        self.is_live(a) && (self.is_between() || a.is_busy() || self.b.is_busy())
    }

    /// Whether the panes are at different times, within a round. The snapshots then show their last common time.
    pub const fn is_between(&self) -> bool {
        self.rounds.is_between()
    }

    /// Length of a round: the shortest simulated time after which both panes are at the end of a step [s].
    pub fn round_length(&self, a: &Sandbox) -> f64 {
        Rounds::length(a, &self.b)
    }

    /// Runs both panes for up to `rounds` rounds, as long as `more` returns true. Returns the number of completed rounds. If one pane
    /// stops with a fault, it becomes the chosen pane.
    pub fn advance(&mut self, a: &mut Sandbox, rounds: u64, more: &mut dyn FnMut() -> bool) -> u64 {
        let taken = self.rounds.advance([a, &mut self.b], rounds, more);
        let faulty = [&*a, &self.b].map(|sandbox| sandbox.simulation().fault().is_some());
        if faulty[0] != faulty[1] {
            self.chosen = if faulty[0] { Pane::A } else { Pane::B };
        }
        taken
    }

    /// Returns both panes to their last common time, if they are within a round.
    pub fn go_back(&mut self, a: &mut Sandbox) {
        self.rounds.go_back([a, &mut self.b]);
    }

    /// Updates both snapshots and records the difference.
    pub fn update_snapshots(&mut self, a: &Sandbox, seen: &mut Snapshot, field: Field) {
        let live = self.is_live(a);
        let can = [false, true].map(|forth| self.next(a, forth).is_some());
        for (sandbox, snapshot) in [(a, &mut *seen), (&self.b, &mut self.snapshot)] {
            sandbox.snapshot(field, snapshot);
            snapshot.running = live;
            [snapshot.can_undo, snapshot.can_redo] = can;
        }
        self.history.record(&self.snapshot);
        if (seen.time - self.snapshot.time).abs() < 0.01 * a.step_length().min(self.b.step_length()) {
            self.record.note([a, &self.b], [seen, &self.snapshot], self.rounds.prices());
        }
    }

    /// Applies a command: to both panes if it concerns the experiment, else to the pane `from`. Vertex numbers are those of `from`.
    ///
    /// # Errors
    /// As for a sandbox; neither pane has changed then.
    pub fn apply(&mut self, a: &mut Sandbox, from: Pane, command: Command) -> Result<(), Refused> {
        self.go_back(a);
        match command {
            Command::Undo => return self.travel(a, false),
            Command::Redo => return self.travel(a, true),
            Command::StepOnce => return self.step_once(a),
            _ => {}
        }
        let before = [&*a, &self.b].map(|sandbox| (sandbox.history.count(), sandbox.simulation().restart()));
        let (here, there) = match from {
            Pane::A => (&mut *a, &mut self.b),
            Pane::B => (&mut self.b, &mut *a),
        };
        let known = here.history.count();
        match command.about() {
            About::Method => {
                here.apply(command)?;
                there.apply(Command::EndGesture)?;
                if here.shown.bodies.len() != there.shown.bodies.len() {
                    // A single model replaces all models side by side in both panes, because both show one experiment.
                    there.apply(Command::SetSideBySide(false))?;
                }
            }
            About::Experiment => {
                let twins = link::twins(&command, here, there);
                here.apply(command)?;
                for twin in twins {
                    if let Err(refused) = there.apply(twin) {
                        if here.history.count() > known {
                            here.apply(Command::Undo)?;
                        }
                        return Err(refused);
                    }
                }
            }
        }
        self.record_undo(a, before)
    }

    /// Starts both panes over if only one started over, and records the change for undo.
    fn record_undo(&mut self, a: &mut Sandbox, before: [(u64, Restart); 2]) -> Result<(), Refused> {
        let [a_before, b_before] = before;
        let counts = [a.history.count() - a_before.0, self.b.history.count() - b_before.0];
        let mut states = [None, None];
        if self.parted(a, [a_before.1.state.steps, b_before.1.state.steps]) {
            states = [a_before.1, b_before.1].map(Some);
            self.start_over(a)?;
        }
        for (state, count) in states.iter_mut().zip(counts) {
            state.take_if(|_| count > 0);
        }
        if counts != [0, 0] {
            self.future.clear();
            self.past.push(Change { counts, states });
            if self.past.len() > DEPTH {
                self.past.remove(0);
            }
        }
        Ok(())
    }

    /// Whether exactly one of the panes has another step count than in `steps`.
    const fn parted(&self, a: &Sandbox, steps: [u64; 2]) -> bool {
        (a.simulation().state().steps == steps[0]) != (self.b.simulation().state().steps == steps[1])
    }

    fn start_over(&mut self, a: &mut Sandbox) -> Result<(), Refused> {
        for sandbox in [a, &mut self.b] {
            sandbox.start_over();
            sandbox.apply(Command::Release)?;
        }
        Ok(())
    }

    /// Number of undo or redo steps for each pane. Changes from before the split are common to both panes.
    fn next(&self, a: &Sandbox, forth: bool) -> Option<[u64; 2]> {
        let can = |sandbox: &Sandbox| if forth { sandbox.history.can_redo() } else { sandbox.history.can_undo() };
        let common = || (can(a) && can(&self.b) && (!forth || self.past.is_empty())).then_some([1, 1]);
        let list = if forth { &self.future } else { &self.past };
        list.last().map(|change| change.counts).or_else(common)
    }

    fn travel(&mut self, a: &mut Sandbox, forth: bool) -> Result<(), Refused> {
        let Some(counts) = self.next(a, forth) else { return Ok(()) };
        let (from, to) = if forth { (&mut self.future, &mut self.past) } else { (&mut self.past, &mut self.future) };
        let steps = [&*a, &self.b].map(|sandbox| sandbox.simulation().state().steps);
        let mut states = from.pop().map(|change| change.states).unwrap_or_default();
        for ((sandbox, count), state) in [&mut *a, &mut self.b].into_iter().zip(counts).zip(&mut states) {
            for _ in 0..count {
                sandbox.apply(if forth { Command::Redo } else { Command::Undo })?;
            }
            if let Some(state) = state {
                let now = sandbox.simulation().restart();
                sandbox.resume(&std::mem::replace(state, now));
            }
        }
        to.push(Change { counts, states });
        if self.parted(a, steps) { self.start_over(a) } else { Ok(()) }
    }

    /// Takes one round, paused: one step of the pane with the longer steps, if they are a multiple of the other's.
    fn step_once(&mut self, a: &mut Sandbox) -> Result<(), Refused> {
        let run = |sandbox: &mut Sandbox, on| sandbox.apply(Command::SetRunning(on));
        run(a, true)?;
        run(&mut self.b, true)?;
        if self.is_live(a) {
            self.advance(a, 1, &mut || true);
        }
        run(a, false)?;
        run(&mut self.b, false)
    }
}

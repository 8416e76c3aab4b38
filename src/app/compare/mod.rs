//! Comparison of two panes: the same scene with two settings.
//!
//! Pane A is the window's own sandbox. Pane B is a second sandbox that gets the same commands, except scheme, step, model and mesh.
//! Both panes have the same simulated time whenever they are shown.

mod stage;
#[cfg(test)]
mod tests;

pub use stage::{Split, Stage};

use super::{
    jobs::Jobs,
    panels::{History, WINDOW},
    theme::Theme,
};
use crate::clock::Instant;
use crate::{
    command::{About, Command, Spot},
    inversion_recovery::Tangle,
    sandbox::{Refused, Sandbox},
    simulation::Restart,
    snapshot::{Field, Snapshot},
    study::{Apart, Difference, counterpart, head},
    table::Table,
};
use eframe::egui::Color32;
use std::collections::VecDeque;

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

    /// Length of a round: the shortest simulated time after which both panes are at the end of a step \[s\].
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
            Command::StepOnce => return self.step(a, 1),
            Command::StepFrame => return self.step(a, self.rounds_per_frame(a)),
            Command::Record(true) => {
                return Err(Refused::NotHere("actions are recorded in a single pane: close pane B first"));
            }
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
                let twins = twins(&command, here, there);
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
    /// Number of rounds in a frame of 1/60 s, at least one.
    pub fn rounds_per_frame(&self, a: &Sandbox) -> u64 {
        (1.0 / (60.0 * self.round_length(a))).round().max(1.0) as u64
    }

    fn step(&mut self, a: &mut Sandbox, rounds: u64) -> Result<(), Refused> {
        let run = |sandbox: &mut Sandbox, on| sandbox.apply(Command::SetRunning(on));
        run(a, true)?;
        run(&mut self.b, true)?;
        if self.is_live(a) {
            self.advance(a, rounds, &mut || true);
        }
        run(a, false)?;
        run(&mut self.b, false)
    }
}

/// Commands for `to` that correspond to a command that `from` is about to apply.
fn twins(command: &Command, from: &Sandbox, to: &Sandbox) -> Vec<Command> {
    let (here, there) = (from.simulation().scene(), to.simulation().scene());
    match *command {
        Command::Grab(vertex, target) => {
            counterpart(here, there, vertex).map(|vertex| Command::Grab(vertex, target)).into_iter().collect()
        }
        // A pinned vertex is freed in `to` at every pin whose nearest vertex in `from` is this one. A free vertex is pinned once.
        Command::TogglePin(vertex) if here.pins.contains(&(vertex as u32)) => {
            let pins = there.pins.iter().map(|pin| *pin as usize);
            pins.filter(|pin| counterpart(there, here, *pin) == Some(vertex)).map(Command::TogglePin).collect()
        }
        Command::TogglePin(vertex) => {
            let twin = counterpart(here, there, vertex).filter(|twin| !there.pins.contains(&(*twin as u32)));
            twin.map(Command::TogglePin).into_iter().collect()
        }
        Command::PinAll(ref vertices, true) => {
            let free = |twin: &usize| !there.pins.contains(&(*twin as u32));
            let twins = vertices.iter().filter_map(|vertex| counterpart(here, there, *vertex)).filter(free).collect();
            vec![Command::PinAll(twins, true)]
        }
        Command::PinAll(ref vertices, false) => {
            let is_freed = |pin: &usize| counterpart(there, here, *pin).is_some_and(|own| vertices.contains(&own));
            vec![Command::PinAll(there.pins.iter().map(|pin| *pin as usize).filter(is_freed).collect(), false)]
        }
        Command::MoveAlong(vertex, ref path) => {
            let twin = counterpart(here, there, vertex).map(|twin| Command::MoveAlong(twin, path.clone()));
            twin.into_iter().collect()
        }
        Command::AddNote(Spot::Vertex(vertex)) => {
            counterpart(here, there, vertex).map(|twin| Command::AddNote(Spot::Vertex(twin))).into_iter().collect()
        }
        Command::SetMaterial(body, material) => {
            let model = to.shown.bodies.get(body).map_or(material.model(), |body| body.material.model());
            vec![Command::SetMaterial(body, material.with_model(model))]
        }
        // It is possible that only one of the two panes has inverted triangles or folds.
        Command::Untangle if !Tangle::of_all(there, &to.simulation().state().x).is_some() => Vec::new(),
        ref same => vec![same.clone()],
    }
}

/// Number of steps that a pane takes in one go, if its rounds are short.
const LEAP: u64 = 10;

/// Time constant of the costs [s of simulated time].
const MEMORY: f64 = 0.5;

/// Progress of both panes within a round, and the cost of their steps.
#[derive(Default)]
struct Rounds {
    /// Steps that A and B still take before they have the same time, and the number of rounds that these steps belong to.
    left: [u64; 2],
    bunch: u64,
    /// Whether B is computed first. The panes alternate, because the first one finds cold caches.
    b_first: bool,
    /// States of both panes at their last common time.
    met: [Restart; 2],
    /// Computing time \[s\] and its simulated time \[s\], both fading. Slept steps do not count.
    spent: [f64; 2],
    simulated: [f64; 2],
}

impl Rounds {
    /// Number of steps of A and of B in a round.
    fn steps(a: &Sandbox, b: &Sandbox) -> [u64; 2] {
        let counts = [a, b].map(|sandbox| u64::from(sandbox.shown.substeps.get()));
        counts.map(|count| count / greatest_common_divisor(counts))
    }

    /// Length of a round \[s\].
    pub fn length(a: &Sandbox, b: &Sandbox) -> f64 {
        Self::steps(a, b)[0] as f64 * a.step_length()
    }

    /// Whether a round has begun and not ended.
    pub const fn is_between(&self) -> bool {
        self.left[0] > 0 || self.left[1] > 0
    }

    /// Completes the round that has begun and takes up to `rounds` more, as long as `more` returns true. Returns the number completed.
    pub fn advance(&mut self, mut panes: [&mut Sandbox; 2], rounds: u64, more: &mut dyn FnMut() -> bool) -> u64 {
        let (steps, length) = (Self::steps(panes[0], panes[1]), Self::length(panes[0], panes[1]));
        let mut taken = 0;
        loop {
            if !self.is_between() {
                if taken >= rounds || (taken > 0 && !more()) {
                    return taken;
                }
                self.bunch = (LEAP / steps[0].max(steps[1])).clamp(1, rounds - taken);
                self.left = steps.map(|count| count * self.bunch);
                self.b_first = !self.b_first;
                for (met, pane) in self.met.iter_mut().zip(&panes) {
                    pane.simulation().write_restart(met);
                }
            }
            for number in if self.b_first { [1, 0] } else { [0, 1] } {
                let (begin, pane) = (Instant::now(), &mut panes[number]);
                let computed = pane.simulation().counts().computed();
                if self.left[number] > 0 {
                    self.left[number] -= pane.advance(self.left[number], more);
                }
                let steps = pane.simulation().counts().computed().saturating_sub(computed);
                self.simulated[number] += steps as f64 * pane.step_length();
                self.spent[number] += begin.elapsed().as_secs_f64();
                if !pane.is_live() {
                    let stopped = pane.simulation().state().time;
                    self.catch_up(panes[1 - number], stopped, 1 - number);
                    return taken;
                }
                if self.left[number] > 0 {
                    return taken;
                }
            }
            taken += self.bunch;
            self.record_time(self.bunch as f64 * length);
        }
    }

    /// One pane has stopped: the other one runs from the last common time to the time of the stop, or as near as its steps allow.
    fn catch_up(&mut self, other: &mut Sandbox, stopped: f64, number: usize) {
        other.resume(&self.met[number]);
        self.left = [0, 0];
        // A difference of less than half a millionth of a step is round-off.
        let steps = ((stopped - self.met[number].state.time) / other.step_length() + 5e-7).max(0.0);
        other.advance(steps as u64, &mut || true);
    }

    fn record_time(&mut self, simulated: f64) {
        let fade = libm::exp(-simulated / MEMORY);
        // The newest computing time is already in the sums.
        self.spent.iter_mut().chain(&mut self.simulated).for_each(|known| *known *= fade);
    }

    /// Returns both panes to their last common time.
    pub fn go_back(&mut self, panes: [&mut Sandbox; 2]) {
        if self.is_between() {
            for (pane, met) in panes.into_iter().zip(&self.met) {
                pane.resume(met);
            }
            self.left = [0, 0];
        }
    }

    /// Computing time for a second of simulated time without slept steps \[s\]; `None` before both panes have computed some.
    pub fn prices(&self) -> Option<[f64; 2]> {
        let [a, b] = [0, 1].map(|pane| (self.simulated[pane] > 0.0).then(|| self.spent[pane] / self.simulated[pane]));
        Some([a?, b?])
    }
}

const fn greatest_common_divisor([mut a, mut b]: [u64; 2]) -> u64 {
    while b > 0 {
        (a, b) = (b, a % b);
    }
    a
}

/// Minimum time between two recorded moments \[s\].
const APART: f64 = 1.0 / 120.0;

/// Update interval of the shown costs \[s\].
const REFRESH: f64 = 0.25;

/// Difference of the panes at one simulated time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Simulated time \[s\].
    pub time: f64,
    /// Distance of the positions; `None` if the panes do not show the same things.
    pub positions: Option<Apart>,
    /// Total energy of B minus that of A \[J\].
    pub energy: f64,
    /// Computing time for a second of simulated time, A and B \[s\]; `None` before any was simulated.
    pub prices: Option<[f64; 2]>,
}

/// Moments of the last seconds, oldest first.
#[derive(Default)]
pub struct Record {
    moments: VecDeque<Moment>,
    difference: Option<Difference>,
    /// Time of the last update \[s\] and the costs shown since then.
    shown: Option<(f64, [f64; 2])>,
    /// Generations of the two recorded scenes.
    generations: [u64; 2],
    /// Name of the level, and the settings of each pane.
    level: String,
    settings: [String; 2],
}

impl Record {
    /// Records the present moment. It clears the record if time went backwards or a scene has changed.
    pub fn note(&mut self, panes: [&Sandbox; 2], seen: [&Snapshot; 2], prices: Option<[f64; 2]>) {
        let generations = seen.map(|seen| seen.generation);
        let time = seen[0].time;
        let last = self.moments.back().map(|moment| moment.time);
        if generations != self.generations || last.is_none_or(|last| time < last) {
            *self = Self { generations, ..Self::default() };
        } else if last == Some(time) {
            self.describe(seen);
            return;
        }
        self.describe(seen);
        let [a, b] = panes.map(Sandbox::simulation);
        if self.shown.is_none_or(|(since, _)| time - since >= REFRESH) {
            self.shown = prices.map(|prices| (time, prices));
        }
        let difference = self.difference.get_or_insert_with(|| Difference::new(a, b));
        let positions = difference.measure(a, b);
        let energy = seen[1].energies.total() - seen[0].energies.total();
        let kept = self.moments.len();
        // The newest moment is replaced until it is far enough from the one before.
        if kept >= 2 && time - self.moments[kept - 2].time < APART {
            self.moments.pop_back();
        }
        self.moments.push_back(Moment { time, positions, energy, prices });
        while self.moments.front().is_some_and(|moment| time - moment.time > WINDOW) {
            self.moments.pop_front();
        }
    }

    fn describe(&mut self, seen: [&Snapshot; 2]) {
        self.level.clone_from(&seen[0].level.name);
        self.settings = seen.map(|seen| stage::settings(seen).join(", "));
    }

    /// Recorded moments, oldest first.
    pub fn moments(&self) -> impl Iterator<Item = &Moment> {
        self.moments.iter()
    }

    /// Shown computing time for a second of simulated time, A and B \[s\].
    pub fn prices(&self) -> Option<[f64; 2]> {
        self.shown.map(|(_, prices)| prices)
    }

    /// The newest moment.
    pub fn last(&self) -> Option<&Moment> {
        self.moments.back()
    }

    /// The record as comma-separated values, with a head that states what is compared and measured.
    pub fn csv(&self) -> String {
        let [a, b] = self.settings.clone();
        let positions =
            "RMS distance of material points of B from A; relative: over the farthest that A was from its start (RMS)";
        let about = [
            ("A", a),
            ("B", b),
            ("positions", positions.to_owned()),
            ("energy", "total energy of B less that of A".to_owned()),
            ("ms", "time of computing for a second of simulated time that was not slept through".to_owned()),
            ("reference", "none: neither pane is a reference for the other".to_owned()),
        ];
        let columns = ["time_s", "positions_m", "positions_relative", "energy_j", "ms_a", "ms_b"];
        let mut table = Table::new(head(&self.level, 1, &about), &columns);
        for Moment { time, positions, energy, prices } in &self.moments {
            let share =
                |apart: Apart| if apart.relative.is_finite() { apart.relative.to_string() } else { String::new() };
            let [metres, relative] =
                positions.map_or([const { String::new() }; 2], |apart| [apart.metres.to_string(), share(apart)]);
            let [a, b] = prices.map_or([const { String::new() }; 2], |ms| ms.map(|s| format!("{:.4}", 1e3 * s)));
            table.row([time.to_string(), metres, relative, energy.to_string(), a, b]);
        }
        table.text()
    }
}

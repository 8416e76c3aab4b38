//! Records what the mouse does as scripted actions of the level, so that it can be replayed, saved and shared.
//!
//! A pull or push is not applied at once while it is recorded. It is written into the level, for the next frame of 1/60 s of simulated time, and is performed from
//! there. So the recorded run and its replay are the same computation.

use super::{Refused, Sandbox, Then, without_state};
use crate::{
    command::Command,
    impulse::Impulse,
    level::{Action, RecordedEnd, ScriptedAction, frame},
    quantity::{Position, Radius, Time, Velocity},
};
use std::sync::Arc;

/// Number of frames between two recorded points of a pull.
const PULL_FRAMES: u64 = 2;

/// A recording that goes on.
#[derive(Clone, Copy)]
pub(super) struct Recording {
    /// Frame up to which the last pull lasts.
    until: u64,
    /// Whether the last action holds a vertex.
    holds: bool,
    /// Number of actions of the level before those of the recording.
    first: usize,
}

impl Sandbox {
    /// Whether actions are recorded.
    pub const fn is_recording(&self) -> bool {
        self.recording.is_some()
    }

    /// Starts over, lets time run and records actions, in place of those of an earlier recording.
    pub(super) fn begin_recording(&mut self) -> Result<(), Refused> {
        if self.document.level.toy.is_some() {
            return Err(Refused::NotHere("a toy problem has nothing to pull, so there are no actions to record"));
        }
        let mut document = self.document.clone();
        let level = &mut document.level;
        (level.mode, level.state) = (self.effect_mode(&self.document), None);
        let first = level.actions.len() - level.recorded.take().map_or(0, |end| end.actions.min(level.actions.len()));
        level.actions.truncate(first);
        self.change(document, Then::Restart, None)?;
        self.set_running(true)?;
        self.recording = Some(Recording { until: 0, holds: false, first });
        Ok(())
    }

    /// Ends the recording, if there is one, and pauses. What was recorded stays in the level, with the state that it led to.
    pub(super) fn end_recording(&mut self) {
        let Some(Recording { first, .. }) = self.recording.take() else { return };
        let next = self.simulation.next_frame();
        self.drop_from(next, first, |_| true);
        // A release that was still to come has been dropped too.
        let holds = |scripted: &ScriptedAction| match scripted.action {
            Action::Grab(_) => Some(true),
            Action::Release => Some(false),
            _ => None,
        };
        if self.document.level.actions[first..].iter().rev().find_map(holds) == Some(true) {
            self.write(next, Action::Release);
        }
        let actions = self.document.level.actions.len() - first;
        self.document.level.recorded = Some(RecordedEnd { actions, ..RecordedEnd::new(self.simulation.state()) });
        self.follow_document();
        self.running = false;
    }

    /// Records a pull or push in place of applying it.
    pub(super) fn record(&mut self, command: &Command) -> Result<(), Refused> {
        let next = self.simulation.next_frame();
        let Some(mut recording) = self.recording else { return Ok(()) };
        match *command {
            Command::Grab(vertex, target) => {
                self.check_grab(vertex, target)?;
                self.drop_from(next, recording.first, is_of_a_pull);
                let at = next.max(recording.until);
                let point = self.position(self.expected_place(vertex, at))?;
                self.write(at, Action::Grab(point));
                (recording.until, recording.holds) = (at, true);
                self.write_pull(target, at, &mut recording)?;
            }
            Command::Pull(target) if recording.holds => self.write_pull(target, next, &mut recording)?,
            Command::Release if recording.holds => {
                self.drop_from(next, recording.first, is_of_a_pull);
                self.write(next, Action::Release);
                recording.holds = false;
            }
            Command::Impulse(impulse) => {
                self.check_impulse(&impulse)?;
                let action = action_of(&impulse, self.position(impulse.centre)?).ok_or(Refused::NotHere(TOO_GREAT))?;
                self.write(next, action);
            }
            _ => return Ok(()),
        }
        self.recording = Some(recording);
        self.follow_document();
        Ok(())
    }

    /// Writes the point that the held vertex is pulled to, in place of one that is still to come.
    fn write_pull(&mut self, target: [f64; 3], next: u64, recording: &mut Recording) -> Result<(), Refused> {
        let to = self.position(target)?;
        let recorded = self.document.level.actions.get_mut(recording.first..).and_then(<[_]>::last_mut);
        if let Some(ScriptedAction { at, action: Action::Pull { to: last, .. }, .. }) = recorded {
            if frame(*at) >= next {
                *last = to;
                return Ok(());
            }
            if *last == to {
                return Ok(());
            }
        }
        let begin = next.max(recording.until);
        if let Some(over) = time(PULL_FRAMES) {
            self.write(begin, Action::Pull { to, over });
        }
        recording.until = begin + PULL_FRAMES;
        Ok(())
    }

    fn write(&mut self, at: u64, action: Action) {
        self.document.level.actions.extend(scripted(at, action));
    }

    /// Drops recorded actions of a kind that are still to come: after the first ones of the level.
    fn drop_from(&mut self, next: u64, first: usize, is_dropped: fn(&Action) -> bool) {
        let mut number = 0;
        self.document.level.actions.retain(|scripted| {
            number += 1;
            number <= first || frame(scripted.at) < next || !is_dropped(&scripted.action)
        });
    }

    /// A point with five digits of the size of the scene, so that it is short in a link.
    fn position(&self, point: [f64; 3]) -> Result<Position, Refused> {
        let scene = self.simulation.scene();
        let size = scene.size(&(0..scene.vertices())).max(f64::MIN_POSITIVE);
        let scale = libm::pow(10.0, 5.0 - libm::log10(size).ceil());
        let short =
            point.map(|coordinate| if scale.is_finite() { (coordinate * scale).round() / scale } else { coordinate });
        let position = short.get(..scene.dimension).and_then(Position::new);
        position.ok_or(Refused::NotHere(TOO_GREAT))
    }

    /// Where a vertex will be at the beginning of a frame, if it keeps its velocity \[m\].
    fn expected_place(&self, vertex: usize, at: u64) -> [f64; 3] {
        let (scene, state) = (self.simulation.scene(), self.simulation.state());
        let left = at as f64 / 60.0 - state.time;
        let numbers = scene.numbers(&(vertex..vertex + 1));
        let (x, v) = (&state.x[numbers.clone()], &state.v[numbers]);
        std::array::from_fn(|axis| x.get(axis).map_or(0.0, |x| x + left * v[axis]))
    }

    /// Runs the document as it is now, after its actions have changed.
    fn follow_document(&mut self) {
        self.shown = Arc::new(without_state(&self.document.shown()));
        self.simulation.follow(&self.shown, self.effect_mode(&self.document));
    }
}

const TOO_GREAT: &str = "this point or speed is too great to be recorded";

const fn is_of_a_pull(action: &Action) -> bool {
    matches!(action, Action::Grab(_) | Action::Pull { .. } | Action::Release)
}

/// A number of frames as a time with few digits.
fn time(frames: u64) -> Option<Time> {
    Time::new((frames as f64 / 60.0 * 1e4).round() / 1e4).ok()
}

/// An action at a frame; `None` if the frame is beyond all times.
fn scripted(at: u64, action: Action) -> Option<ScriptedAction> {
    Some(ScriptedAction { at: time(at)?, every: None, action })
}

fn action_of(impulse: &Impulse, centre: Position) -> Option<Action> {
    let [x, y, z] = impulse.push.map(Velocity::new);
    let push = (x.ok()?, y.ok()?, z.ok()?);
    let (radius, burst) = (Radius::new(impulse.radius).ok()?, Velocity::new(impulse.burst).ok()?);
    Some(Action::Impulse { centre, radius, push, burst })
}

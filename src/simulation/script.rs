//! Performs the scripted actions of a level.
//!
//! The effect of all actions up to a time follows from the level alone, except for the pulled vertex. So a run can be
//! saved, continued and rewound at any time.

use super::{PlacedCheck, Simulation, replay::Replay};
use crate::{
    effects::{EffectKind, Grab},
    impulse::Impulse,
    level::{Action, Level, RunMode, ScriptedAction, Side},
    meshes::NoFiles,
    quantity::{Gravity, Position, Velocity},
    report::Energies,
    scene::{Scene, extent, nearest_vertex},
    state::State,
};

/// Frames of scripted actions per second.
const FRAMES: f64 = 60.0;

/// The scripted actions of a level and their progress.
pub(super) struct Script {
    level: Level,
    mode: RunMode,
    /// First frame whose actions have not been performed.
    due: u64,
    /// Whether actions are still to come.
    waits: bool,
    changes: Changes,
}

/// Changes of the level by actions so far.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
struct Changes {
    /// Whether gravity is reversed.
    flipped: bool,
    /// Whether all pins are removed.
    freed: bool,
}

impl Script {
    /// First frame from this one on with an action.
    fn next(&self, from: u64) -> Option<u64> {
        self.level.actions.iter().filter_map(|scripted| scripted.next(from)).min()
    }

    fn set_due(&mut self, frame: u64) {
        (self.due, self.waits) = (frame, self.next(frame).is_some());
    }

    /// Changes by all actions before a frame.
    fn changes_before(&self, frame: u64) -> Changes {
        let Some(last) = frame.checked_sub(1) else { return Changes::default() };
        let count = |scripted: &ScriptedAction| scripted.count(last);
        let flips =
            self.level.actions.iter().filter(|scripted| scripted.action == Action::FlipGravity).map(count).sum::<u64>();
        let freed = self.level.actions.iter().any(|scripted| scripted.action == Action::Free && count(scripted) > 0);
        Changes { flipped: flips % 2 == 1, freed }
    }

    /// Point at which the pulled vertex was grabbed, and the point that it is pulled to \[m\].
    fn scripted_grab(&self) -> Option<(Position, [f64; 3])> {
        let last = self.due.checked_sub(1)?;
        let latest = |scripted: &ScriptedAction| scripted.count(last).checked_sub(1).map(|count| scripted.begin(count));
        let holds =
            self.level.actions.iter().filter(|scripted| matches!(scripted.action, Action::Grab(_) | Action::Release));
        let (begun, scripted) =
            holds.filter_map(|scripted| Some((latest(scripted)?, scripted))).max_by_key(|(begun, _)| *begun)?;
        let Action::Grab(point) = scripted.action else { return None };
        let (mut target, mut frame) = (point.get(), begun);
        while let Some(next) = self.next(frame).filter(|next| *next <= last) {
            for (left, action) in self.continuing_actions(next) {
                if let Action::Pull { to, .. } = action {
                    target = pulled(target, to.get(), left);
                }
            }
            frame = next + 1;
        }
        Some((point, target))
    }

    /// The level with the changes so far.
    fn changed_level(&self) -> Level {
        let mut level = self.level.clone();
        if self.changes.flipped {
            for listed in &mut level.effects {
                if let EffectKind::Gravity(gravity) = &mut listed.effect {
                    let turned = |value: Gravity| Gravity::new(-value.get()).unwrap_or(value);
                    (gravity.down, gravity.right) = (turned(gravity.down), turned(gravity.right));
                }
            }
        }
        if self.changes.freed {
            level.bodies.iter_mut().for_each(|body| body.pins.clear());
            level.nets.iter_mut().for_each(|net| net.pins.clear());
            level.membranes.iter_mut().for_each(|membrane| membrane.pins.clear());
        }
        level
    }

    /// Actions that continue in a frame, sorted by their begin: each with the number of frames left, this one included.
    fn continuing_actions(&self, frame: u64) -> Vec<(u64, &Action)> {
        let mut found = Vec::new();
        for scripted in self
            .level
            .actions
            .iter()
            .filter(|scripted| matches!(scripted.action, Action::Pull { .. } | Action::Turn { .. }))
        {
            let length = scripted.length();
            let begun = scripted.begins(frame.saturating_sub(length - 1)..=frame);
            found.extend(begun.map(|begin| (begin, begin + length - frame, &scripted.action)));
        }
        found.sort_by_key(|(begin, ..)| *begin);
        found.into_iter().map(|(_, left, action)| (left, action)).collect()
    }
}

/// Callback with the energies before and after a change from outside.
type EnergyListener<'a> = &'a mut dyn FnMut(Energies, Energies);

impl Simulation {
    /// Starts to perform the scripted actions of the level that the scene was built from, in the mode that it was built
    /// for, and to measure its known results. Earlier actions count as performed.
    pub fn follow(&mut self, level: &Level, mode: RunMode) {
        self.script = None;
        self.replay = Replay::of(level, mode);
        self.checks = PlacedCheck::all(level, &self.scene).unwrap_or_default();
        if level.actions.is_empty() {
            return;
        }
        let level = Level { state: None, ..level.clone() };
        self.script = Some(Script { level, mode, due: 0, waits: false, changes: Changes::default() });
        if self.state.x.len() == self.scene.start.x.len() {
            self.seek();
        }
    }

    /// Whether there are scripted actions, performed or still to come.
    pub const fn is_scripted(&self) -> bool {
        self.script.is_some()
    }

    /// Stops performing scripted actions.
    pub fn follow_nothing(&mut self) {
        self.script = None;
        self.forget_recording();
    }

    /// Whether scripted actions are still to come.
    pub const fn expects_actions(&self) -> bool {
        match &self.script {
            Some(script) => script.waits,
            None => false,
        }
    }

    /// Pulled vertex as the level lists it, and its target \[m\], if there are scripted actions.
    pub fn scripted_pull(&self) -> Option<(u32, Position)> {
        let Grab { vertex, target } = self.grab.filter(|_| self.script.is_some())?;
        Some((self.scene.listed_vertex(vertex)? as u32, Position::new(target.get(..self.scene.dimension)?)?))
    }

    /// Performs the scripted actions that are due and calls `listener` with the energies before and after each. [`Self::advance`] does so
    /// by itself.
    pub fn perform_due(&mut self, listener: EnergyListener<'_>) {
        let Some(mut script) = self.script.take() else { return };
        let frame = self.frame();
        while let Some(next) = script.next(script.due).filter(|next| *next <= frame) {
            self.perform(&mut script, next, listener);
            script.due = next + 1;
        }
        script.set_due(script.due.max(frame + 1));
        self.script = Some(script);
    }

    /// Steps from now to the next scripted action; none if there is none.
    pub(super) fn steps_to_action(&self) -> Option<u64> {
        let script = self.script.as_ref()?;
        let time = script.next(script.due)? as f64 / FRAMES;
        Some((((time - self.state.time) / self.scene.step - 0.5).ceil() as u64).max(1))
    }

    /// Marks all actions before the present time as performed, and rebuilds the scene with their changes.
    pub(super) fn seek(&mut self) {
        let Some(mut script) = self.script.take() else { return };
        script.set_due(self.next_frame());
        let changes = script.changes_before(script.due);
        if script.changes != changes {
            script.changes = changes;
            // The state belongs to the rebuilt scene, with its memory.
            let state = self.state.clone();
            self.rebuild(&script);
            self.state = state;
        }
        if self.grab.is_none()
            && let Some((point, target)) = script.scripted_grab()
            && let Some(vertex) = self.nearest(point)
        {
            self.set_grab(Some(Grab { vertex, target }));
        }
        self.script = Some(script);
    }

    /// The vertex nearest to a point.
    fn nearest(&self, point: Position) -> Option<usize> {
        nearest_vertex(&self.state.x, point.get().get(..self.scene.dimension)?)
    }

    /// First frame whose actions have not been performed.
    pub(crate) fn next_frame(&self) -> u64 {
        let frame = self.frame();
        // Within a frame the actions at its begin have been performed.
        let begins = (self.state.time * FRAMES - frame as f64).abs() < 0.5 * self.scene.step * FRAMES;
        if begins { frame } else { frame + 1 }
    }

    /// Frame of the present time. A time within half a step of the begin of a frame belongs to it.
    fn frame(&self) -> u64 {
        ((self.state.time + 0.5 * self.scene.step) * FRAMES).floor() as u64
    }

    /// Applies a change from outside and reports the energies.
    fn change(&mut self, listener: EnergyListener<'_>, change: impl FnOnce(&mut Self)) {
        let before = self.energies();
        change(self);
        listener(before, self.energies());
    }

    /// Performs the actions of a frame: instantaneous ones in the order of the level, then continuing ones.
    fn perform(&mut self, script: &mut Script, frame: u64, listener: EnergyListener<'_>) {
        for number in 0..script.level.actions.len() {
            let scripted = &script.level.actions[number];
            if scripted.begins(frame..=frame).next().is_none() {
                continue;
            }
            match scripted.action {
                Action::Grab(point) => {
                    if let Some(vertex) = self.nearest(point) {
                        let own = &self.state.x[self.scene.numbers(&(vertex..vertex + 1))];
                        let target = std::array::from_fn(|axis| own.get(axis).copied().unwrap_or(0.0));
                        self.change(listener, |own| own.set_grab(Some(Grab { vertex, target })));
                    }
                }
                Action::Release => self.change(listener, |own| own.set_grab(None)),
                Action::FlipGravity => {
                    script.changes.flipped ^= true;
                    self.change(listener, |own| own.rebuild(script));
                }
                Action::Free => {
                    script.changes.freed = true;
                    self.change(listener, |own| own.rebuild(script));
                }
                Action::Impulse { centre, radius, push: (x, y, z), burst } => {
                    let push = [x, y, z].map(Velocity::get);
                    let impulse = Impulse { centre: centre.get(), radius: radius.get(), push, burst: burst.get() };
                    self.change(listener, |own| own.give(&impulse));
                }
                Action::Pull { .. } | Action::Turn { .. } => {}
            }
        }
        for (left, action) in script.continuing_actions(frame) {
            match *action {
                Action::Pull { to, .. } => {
                    if let Some(Grab { vertex, target }) = self.grab {
                        let target = pulled(target, to.get(), left);
                        self.change(listener, |own| own.set_grab(Some(Grab { vertex, target })));
                    }
                }
                Action::Turn { side, by, over } => {
                    let angle = by.get().to_radians() / crate::level::frame(over).max(1) as f64;
                    let (state, grab) = (turned(&self.scene, &self.state, side, angle), self.grab);
                    self.change(listener, |own| {
                        // The run goes on, and so does the account of its energy.
                        let (before, guard) = (own.watched(), own.guard.clone());
                        own.set_state(state);
                        if let Some(before) = before {
                            own.guard = guard;
                            own.guard.changed(before, own.energies());
                        }
                        own.set_grab(grab);
                    });
                }
                _ => {}
            }
        }
    }

    /// Rebuilds the scene with the changes by actions. State and stepping options stay.
    fn rebuild(&mut self, script: &Script) {
        // The level was valid before, and reversed gravity or removed pins keep it valid.
        let Ok(scene) = Scene::build(&script.changed_level(), script.mode, &NoFiles, Some(&self.scene)) else { return };
        let Scene { step, guard, sleep, .. } = self.scene;
        self.replace_scene(Scene { step, guard, sleep, integrator: self.scene.integrator.clone(), ..scene });
    }
}

/// Target a frame later, if the vertex reaches another point in the given number of frames \[m\].
fn pulled(target: [f64; 3], to: [f64; 3], left: u64) -> [f64; 3] {
    let share = 1.0 / left as f64;
    [0, 1, 2].map(|axis| target[axis] + share * (to[axis] - target[axis]))
}

/// The state with the pinned vertices on a side of the first body rotated about their mean by an angle \[rad\].
fn turned(scene: &Scene, state: &State, side: Side, angle: f64) -> State {
    let mut state = state.clone();
    let Some(body) = scene.bodies.first() else { return state };
    let (axis, greatest) = side.across();
    let (low, high) = extent(&scene.rest[scene.numbers(&body.vertices)], axis);
    let edge = if greatest { high } else { low };
    let pins = scene.pins.iter().map(|pin| *pin as usize).filter(|pin| body.vertices.contains(pin));
    let on_edge: Vec<_> = pins.filter(|pin| (scene.rest[2 * pin + axis] - edge).abs() <= 1e-9 * (high - low)).collect();
    let count = on_edge.len() as f64;
    let [cx, cy] = [0, 1].map(|axis| on_edge.iter().map(|pin| state.x[2 * pin + axis]).sum::<f64>() / count);
    let (c, s) = (libm::cos(angle), libm::sin(angle));
    for pin in on_edge {
        let (x, y) = (state.x[2 * pin] - cx, state.x[2 * pin + 1] - cy);
        (state.x[2 * pin], state.x[2 * pin + 1]) = (cx + c * x - s * y, cy + s * x + c * y);
    }
    state
}

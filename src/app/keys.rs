//! Table of keys and mouse actions. The dispatcher, the help overlay and the status line read it.

use super::{canvas::Look, clock::Pace, panels::FileRequest};
use crate::{
    command::{Command, Mode, Pose},
    materials::Model,
    snapshot::Snapshot,
};
use eframe::egui::{self, Event, InputState, Key, KeyboardShortcut, Modifiers};

/// One row of the table.
#[derive(Debug)]
pub struct Binding {
    /// Key or mouse action as it is shown.
    pub label: &'static str,
    /// Short description of the action.
    pub words: &'static str,
    /// Condition of the action.
    pub when: When,
    /// Keys that trigger the action; empty for the mouse.
    pub shortcuts: &'static [KeyboardShortcut],
    /// Whether the action repeats while the key is held.
    pub repeats: bool,
    /// Function that returns the action.
    pub action: fn(&Snapshot) -> KeyAction,
}

/// Condition of a row of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// At any time.
    Always,
    /// In edit mode.
    Edit,
    /// In simulate and collide mode.
    Moving,
    /// In levels with bodies or membranes.
    Bodies,
    /// In levels with cloth in space.
    Cloth,
    /// In levels with neither bodies nor membranes.
    Nets,
    /// In a test level.
    Test,
}

/// Action of a key.
#[derive(Clone, Debug)]
pub enum KeyAction {
    /// A change of the sandbox.
    Do(Command),
    /// Shows or hides the list of keys.
    ToggleHelp,
    /// Splits the stage into two panes, or joins them.
    ToggleComparison,
    /// Draws the stage into a picture.
    TakePicture,
    /// Starts or ends a film of the stage.
    Film,
    /// Shows the stage alone, or the panels again.
    Present,
    /// Opens or saves a file.
    File(FileRequest),
    /// Probes what is under the pointer.
    Probe,
    /// Changes the wanted speed of simulated time.
    Pace(fn(Pace) -> Pace),
    /// Changes from where the scene is seen.
    Look(Look),
    /// No action: the stage handles the mouse itself.
    Mouse,
}

impl When {
    /// Whether the row applies now.
    pub fn applies(self, now: &Snapshot) -> bool {
        match self {
            Self::Always => true,
            Self::Edit => now.mode == Mode::Edit,
            Self::Moving => now.mode != Mode::Edit,
            Self::Bodies => now.has_models(),
            Self::Cloth => now.has_cloth(),
            Self::Nets => !now.has_models(),
            Self::Test => now.level.test.is_some(),
        }
    }

    /// Heading of the group in the help overlay.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Always => "Always",
            Self::Edit => "Edit mode",
            Self::Moving => "Simulate and collide mode",
            Self::Bodies => "Bodies and membranes",
            Self::Cloth => "Cloth",
            Self::Nets => "Nets and toys",
            Self::Test => "Test levels",
        }
    }

    /// The groups, in the order of the overlay.
    pub const ALL: [Self; 7] =
        [Self::Edit, Self::Moving, Self::Always, Self::Bodies, Self::Cloth, Self::Nets, Self::Test];
}

const fn key(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::NONE, key)
}

const fn shift(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::SHIFT, key)
}

const fn command(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND, key)
}

const fn binding(
    label: &'static str,
    words: &'static str,
    when: When,
    shortcuts: &'static [KeyboardShortcut],
    action: fn(&Snapshot) -> KeyAction,
) -> Binding {
    Binding { label, words, when, shortcuts, repeats: false, action }
}

/// Time that one press rewinds \[s\]. A held key repeats about 30 times a second.
const BACK: f64 = 0.05;

/// All actions of keys and mouse.
pub static TABLE: &[Binding] = &[
    binding("Click", "pin or free the vertex nearest to the cursor", When::Edit, &[], |_| KeyAction::Mouse),
    binding("R", "remove all pins", When::Edit, &[key(Key::R)], |_| KeyAction::Do(Command::ClearPins)),
    binding("Drag", "pull a vertex", When::Moving, &[], |_| KeyAction::Mouse),
    binding("Arrows", "push what is near the pointer", When::Moving, &[], |_| KeyAction::Mouse),
    binding("X", "burst: blow apart what is near the pointer", When::Moving, &[], |_| KeyAction::Mouse),
    binding("R", "start over: positions and velocities", When::Moving, &[key(Key::R)], |_| {
        KeyAction::Do(Command::Reset)
    }),
    Binding {
        repeats: true,
        ..binding("Backspace", "go back in time; hold to go back further", When::Moving, &[key(Key::Backspace)], |_| {
            KeyAction::Do(Command::Rewind(BACK))
        })
    },
    binding("Space", "run or pause", When::Always, &[key(Key::Space)], |now| {
        KeyAction::Do(Command::SetRunning(now.mode == Mode::Edit || !now.running))
    }),
    Binding {
        repeats: true,
        ..binding(".", "take one step", When::Always, &[key(Key::Period)], |_| KeyAction::Do(Command::StepOnce))
    },
    Binding {
        repeats: true,
        ..binding(",", "take the steps of one frame, 1/60 s", When::Always, &[key(Key::Comma)], |_| {
            KeyAction::Do(Command::StepFrame)
        })
    },
    binding("Page up", "faster: simulated time over real time", When::Always, &[key(Key::PageUp)], |_| {
        KeyAction::Pace(Pace::faster)
    }),
    binding("Page down", "slow motion", When::Always, &[key(Key::PageDown)], |_| KeyAction::Pace(Pace::slower)),
    binding("M", "edit / simulate", When::Always, &[key(Key::M)], |now| toggle(now, Mode::Simulate)),
    binding("T", "edit / collide", When::Always, &[key(Key::T)], |now| toggle(now, Mode::Collide)),
    binding("D", "damping on or off", When::Always, &[key(Key::D)], |now| {
        KeyAction::Do(Command::SetDamping(!now.damping))
    }),
    binding("C", "corotated model, and start over", When::Bodies, &[key(Key::C)], |_| model(Model::Corotated)),
    binding("V", "St. Venant-Kirchhoff model, and start over", When::Bodies, &[key(Key::V)], |_| {
        model(Model::StVenantKirchhoff)
    }),
    binding("N", "neo-Hookean model, and start over", When::Bodies, &[key(Key::N)], |_| model(Model::NeoHookean)),
    binding("S", "stable neo-Hookean model, and start over", When::Bodies, &[key(Key::S)], |_| {
        model(Model::StableNeoHookean)
    }),
    binding("F", "fixed corotated model, and start over", When::Bodies, &[key(Key::F)], |_| {
        model(Model::FixedCorotated)
    }),
    binding("H", "Hencky model, and start over", When::Bodies, &[key(Key::H)], |_| model(Model::Hencky)),
    binding("U", "untangle bodies that overlap themselves", When::Bodies, &[key(Key::U)], |_| {
        KeyAction::Do(Command::Untangle)
    }),
    binding("W", "wind on or off", When::Cloth, &[key(Key::W)], |now| KeyAction::Do(Command::SetWind(!now.wind))),
    binding("V", "record a film, as Shift+V", When::Nets, &[key(Key::V)], |_| KeyAction::Film),
    binding("Up", "stretched start", When::Test, &[key(Key::ArrowUp)], |_| pose(Pose::Stretched)),
    binding("Down", "compressed start", When::Test, &[key(Key::ArrowDown)], |_| pose(Pose::Compressed)),
    Binding {
        repeats: true,
        ..binding("Ctrl+Z", "undo: pins, sliders, model, level", When::Always, &[command(Key::Z)], |_| {
            KeyAction::Do(Command::Undo)
        })
    },
    Binding {
        repeats: true,
        ..binding(
            "Ctrl+Y",
            "redo (also Ctrl+Shift+Z)",
            When::Always,
            &[command(Key::Y), KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z)],
            |_| KeyAction::Do(Command::Redo),
        )
    },
    binding("Ctrl+O", "open a level file", When::Always, &[command(Key::O)], |_| KeyAction::File(FileRequest::Open)),
    binding("Ctrl+S", "save the level in its file", When::Always, &[command(Key::S)], |_| {
        KeyAction::File(FileRequest::SaveAgain)
    }),
    binding("F11", "the stage alone on the whole screen, or the panels", When::Always, &[key(Key::F11)], |_| {
        KeyAction::Present
    }),
    binding("B", "compare: a second pane B beside A, or A alone", When::Always, &[key(Key::B)], |_| {
        KeyAction::ToggleComparison
    }),
    binding("P", "probe the vertex or triangle under the pointer", When::Always, &[key(Key::P)], |_| KeyAction::Probe),
    binding("I", "save a picture of the stage", When::Always, &[key(Key::I)], |_| KeyAction::TakePicture),
    binding("Shift+V", "record a film of the stage, or end it", When::Always, &[shift(Key::V)], |_| KeyAction::Film),
    binding("Shift+R", "record pulls and pushes as actions, or end it", When::Always, &[shift(Key::R)], |now| {
        KeyAction::Do(Command::Record(!now.records))
    }),
    Binding {
        repeats: true,
        ..binding("+", "zoom in (also the wheel)", When::Always, &[key(Key::Plus), key(Key::Equals)], |_| {
            KeyAction::Look(Look::CLOSER)
        })
    },
    Binding {
        repeats: true,
        ..binding("-", "zoom out", When::Always, &[key(Key::Minus)], |_| KeyAction::Look(Look::FARTHER))
    },
    binding("0", "see the whole scene", When::Always, &[key(Key::Num0)], |_| KeyAction::Look(Look::All)),
    binding("Z", "see what is under the pointer as large as possible", When::Always, &[key(Key::Z)], |_| {
        KeyAction::Look(Look::Part)
    }),
    binding("Right drag", "move the scene; in space turn it, and move it with Shift", When::Always, &[], |_| {
        KeyAction::Mouse
    }),
    binding("?", "show or hide this list", When::Always, &[key(Key::Questionmark)], |_| KeyAction::ToggleHelp),
];

const fn model(model: Model) -> KeyAction {
    KeyAction::Do(Command::SetModel(model))
}

const fn pose(pose: Pose) -> KeyAction {
    KeyAction::Do(Command::SetPose(pose))
}

fn toggle(now: &Snapshot, mode: Mode) -> KeyAction {
    KeyAction::Do(Command::SetMode(if now.mode == mode { Mode::Edit } else { mode }))
}

impl Binding {
    fn is_pressed_by(&self, key: Key, modifiers: Modifiers) -> bool {
        // On some keyboards `?` needs Shift, but Ctrl+Shift+Z must not count as Ctrl+Z.
        let shift = |s: &KeyboardShortcut| !s.modifiers.command || s.modifiers.shift == modifiers.shift;
        self.shortcuts.iter().any(|s| s.logical_key == key && modifiers.matches_logically(s.modifiers) && shift(s))
    }
}

impl Binding {
    fn has_shift(&self) -> bool {
        self.shortcuts.iter().any(|shortcut| shortcut.modifiers.shift)
    }
}

/// Row that applies now for the key of `binding`: an earlier key of the same frame may have changed the mode.
pub fn now(binding: &Binding, now: &Snapshot) -> Option<&'static Binding> {
    TABLE.iter().find(|b| b.label == binding.label && b.when.applies(now))
}

/// Removes the keys of the table from the input of this frame, so that Space presses no button and arrows move no focus.
/// While a text field has the focus, it removes nothing.
pub fn pressed(ctx: &egui::Context, now: &Snapshot) -> Vec<&'static Binding> {
    ctx.input_mut(forget_question_mark);
    if ctx.text_edit_focused() {
        return Vec::new();
    }
    let mut found = Vec::new();
    ctx.input_mut(|input| input.events.retain(|event| !take(event, now, &mut found)));
    if found.iter().any(|binding| binding.when == When::Test) {
        // The focus has already reacted to the arrow key.
        ctx.memory_mut(|memory| memory.move_focus(egui::FocusDirection::None));
    }
    found
}

/// Removes `?` from the held keys when any key is released.
///
/// If Shift is released before the key, egui sees a press of `?` and the release of another key. It would then regard `?` as held
/// down forever, and each later press as a repetition.
fn forget_question_mark(input: &mut InputState) {
    if input.events.iter().any(|event| matches!(event, Event::Key { pressed: false, .. })) {
        input.keys_down.remove(&Key::Questionmark);
    }
}

/// Whether the event belongs to a row of the table.
fn take(event: &Event, now: &Snapshot, found: &mut Vec<&'static Binding>) -> bool {
    let Event::Key { key, pressed: true, repeat, modifiers, .. } = event else { return false };
    let pressed = |binding: &&Binding| binding.is_pressed_by(*key, *modifiers) && binding.when.applies(now);
    // Shift+V is not V with a finger on Shift.
    let exact = |binding: &&Binding| pressed(binding) && binding.has_shift() == modifiers.shift;
    let Some(binding) = TABLE.iter().find(exact).or_else(|| TABLE.iter().find(pressed)) else { return false };
    if !repeat || binding.repeats {
        found.push(binding);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_with_two_meanings_never_has_both() {
        let never_both = [(When::Edit, When::Moving), (When::Bodies, When::Nets)];
        for (index, a) in TABLE.iter().enumerate() {
            for b in TABLE[index + 1..].iter().filter(|b| b.label == a.label) {
                assert!(never_both.contains(&(a.when, b.when)), "{} twice", a.label);
            }
        }
    }

    #[test]
    fn redo_is_not_mistaken_for_undo() {
        let found = TABLE.iter().find(|b| b.is_pressed_by(Key::Z, Modifiers::COMMAND | Modifiers::SHIFT));
        assert!(found.is_some_and(|binding| binding.label == "Ctrl+Y"));
    }
}

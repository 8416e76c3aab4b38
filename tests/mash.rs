//! The window under random keys, drags, drops and sizes: nothing may make it panic, draw what is no number, or lose its scene.
//!
//! `GINGERBREAD_MASH=2000 cargo test --test mash` does so many things to every level instead of some to a few.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a failing test should panic")]

#[path = "common/folder.rs"]
mod folder;
#[allow(dead_code, reason = "other tests need the rest")]
#[path = "window/harness.rs"]
mod harness;

use eframe::egui::{Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, PointerButton, Pos2, TouchPhase, Vec2};
use gingerbread::levels;
use harness::Window;
use std::fmt::Write as _;

/// Levels that are quick, of every kind: a body, collisions, a test level, a toy, a net in space, cloth, bodies that touch.
const FEW: [&str; 7] = [
    "gingerbread",
    "gingerbread_house",
    "stretch_test",
    "double_pendulum",
    "princeton_rain",
    "cloth_folding",
    "cradle",
];

/// Pseudo-random numbers (Steele, Lea and Flood, *Fast splittable pseudorandom number generators*, OOPSLA 2014).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    fn between(&mut self, from: f32, to: f32) -> f32 {
        from + (to - from) * (self.next() >> 40) as f32 / (1 << 24) as f32
    }

    fn point(&mut self, size: Vec2) -> Pos2 {
        Pos2::new(self.between(-20.0, size.x + 20.0), self.between(-20.0, size.y + 20.0))
    }
}

/// What was done last, told if the test fails.
struct Done(String);

impl Drop for Done {
    fn drop(&mut self) {
        if std::thread::panicking() {
            let lines: Vec<_> = self.0.lines().collect();
            eprintln!("The last things done:\n{}", lines[lines.len().saturating_sub(12)..].join("\n"));
        }
    }
}

fn modifiers(numbers: &mut Numbers) -> Modifiers {
    match numbers.below(6) {
        0 => Modifiers::COMMAND,
        1 => Modifiers::SHIFT,
        2 => Modifiers::COMMAND | Modifiers::SHIFT,
        _ => Modifiers::NONE,
    }
}

fn pick_button(numbers: &mut Numbers) -> PointerButton {
    [PointerButton::Primary, PointerButton::Primary, PointerButton::Secondary, PointerButton::Middle][numbers.below(4)]
}

/// Does something at random.
fn act(window: &mut Window, numbers: &mut Numbers, files: &[std::path::PathBuf], done: &mut Done) {
    let size = window.ctx.content_rect().size();
    let what = numbers.below(100);
    let _ = write!(done.0, "{what}: ");
    match what {
        0..40 => {
            let (key, modifiers) = (Key::ALL[numbers.below(Key::ALL.len())], modifiers(numbers));
            let _ = writeln!(done.0, "{key:?} with {modifiers:?}");
            window.key_press_modifiers(modifiers, key);
        }
        40..60 => {
            let (from, to, button) = (numbers.point(size), numbers.point(size), pick_button(numbers));
            let _ = writeln!(done.0, "drag with {button:?} from {from:?} to {to:?}");
            let modifiers = modifiers(numbers);
            let press = |pos, pressed| Event::PointerButton { pos, button, pressed, modifiers };
            window.event(Event::PointerMoved(from));
            window.event(press(from, true));
            window.run_steps(1);
            for part in 1..=3 {
                window.event(Event::PointerMoved(from + (to - from) * (part as f32 / 3.0)));
                window.run_steps(1);
            }
            window.event(press(to, false));
        }
        60..75 => {
            let (pos, button) = (numbers.point(size), pick_button(numbers));
            let _ = writeln!(done.0, "click with {button:?} at {pos:?}");
            window.event(Event::PointerMoved(pos));
            for pressed in [true, false] {
                window.event(Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
            }
        }
        75..83 => {
            let delta = Vec2::new(numbers.between(-300.0, 300.0), numbers.between(-300.0, 300.0));
            let modifiers = modifiers(numbers);
            let _ = writeln!(done.0, "wheel {delta:?} with {modifiers:?}");
            window.event(Event::PointerMoved(numbers.point(size)));
            window.event(Event::MouseWheel {
                unit: MouseWheelUnit::Point,
                delta,
                modifiers,
                phase: TouchPhase::Move,
                source: MouseWheelSource::Unknown,
            });
        }
        83..87 => {
            let factor = numbers.between(0.3, 3.0);
            let _ = writeln!(done.0, "zoom {factor}");
            window.event(Event::Zoom(factor));
        }
        87..92 => {
            let text = ["1e9", "-0", "1/0", "man", "nan", "ß", "(((", "0.5"][numbers.below(8)];
            let _ = writeln!(done.0, "text {text}");
            window.event(Event::Text(text.to_owned()));
        }
        92..96 => {
            let size = Vec2::new(numbers.between(320.0, 1920.0).round(), numbers.between(240.0, 1080.0).round());
            let _ = writeln!(done.0, "size {size:?}");
            window.set_size(size);
        }
        96..98 => {
            let file = &files[numbers.below(files.len())];
            let _ = writeln!(done.0, "drop {}", file.display());
            harness::drop_files(window, &[file]);
        }
        _ => {
            let _ = writeln!(done.0, "the pointer leaves");
            window.event(Event::PointerGone);
        }
    }
}

#[test]
fn the_window_outlives_random_hands() {
    let many = std::env::var("GINGERBREAD_MASH").ok().and_then(|count| count.parse::<usize>().ok());
    let names: Vec<_> = match many {
        Some(_) => levels::BUILT_IN.iter().map(|(file, _)| file.trim_end_matches(".ron")).collect(),
        None => FEW.to_vec(),
    };
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    // Random keys also save files.
    let folder = folder::Folder::new("mash");
    std::env::set_current_dir(&folder.0).unwrap();
    let bad = folder.0.join("bad.ron");
    std::fs::write(&bad, "(name: \"bad\", bodys: [])").unwrap();
    // They save over what was dropped, too.
    let copied = |path: &str| {
        let copy = folder.0.join(std::path::Path::new(path).file_name().unwrap());
        std::fs::copy(root.join(path), &copy).unwrap();
        copy
    };
    let [chain, disk, readme] = ["levels/chain.ron", "levels/jelly_disk.ron", "README.md"].map(copied);
    let files = [bad, chain, disk, readme];
    let mut numbers = Numbers(1);
    for name in names {
        let mut done = Done(format!("open {name}\n"));
        let mut window = harness::open(name);
        for _ in 0..many.unwrap_or(150) {
            act(&mut window, &mut numbers, &files, &mut done);
            window.run_steps(1 + numbers.below(3));
            harness::draw(&window);
            let snapshot = window.state().snapshot();
            assert!(snapshot.positions.iter().all(|at| at.is_finite()), "a position is no number");
            assert!(!snapshot.level.name.is_empty(), "the scene is lost");
        }
    }
}

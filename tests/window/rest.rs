//! A window in which everything sleeps rests too.

use crate::harness::*;
use eframe::egui::{Event, Key, Modifiers, PointerButton, ViewportId, vec2};
use gingerbread::command::Mode;
use std::time::Duration;

/// How long the window wants to wait before it draws again.
fn pause(window: &Window) -> Duration {
    window.output().viewport_output[&ViewportId::ROOT].repaint_delay
}

#[test]
fn when_everything_sleeps_nothing_is_stepped_and_no_frame_is_asked_for_until_a_pull() {
    let mut window = in_mode("gingerbread", Mode::Simulate);
    assert_eq!(pause(&window), Duration::ZERO, "while he is awake the next frame follows at once");
    window.run_steps(60);
    let asleep = window.state().snapshot().clone();
    assert_eq!((asleep.asleep, asleep.running), (1, true));
    let evaluations = window.state().sandbox().simulation().counts().force_evaluations;
    for _ in 0..30 {
        window.run_steps(1);
        assert_eq!(pause(&window), Duration::MAX, "no repaint is asked for");
    }
    assert_eq!(window.state().snapshot().steps, asleep.steps);
    assert_eq!(window.state().sandbox().simulation().counts().force_evaluations, evaluations);
    let hand = on_screen(&window, vertex(&window, 0));
    window.hover_at(hand);
    window.run_steps(1);
    window.event(Event::PointerButton {
        pos: hand,
        button: PointerButton::Primary,
        pressed: true,
        modifiers: Modifiers::NONE,
    });
    window.run_steps(1);
    window.event(Event::PointerMoved(hand + vec2(60.0, -40.0)));
    window.run_steps(5);
    let awake = window.state().snapshot();
    assert!(awake.asleep == 0 && awake.steps > asleep.steps && pause(&window) == Duration::ZERO);
    // The clock did not run on meanwhile: waking owes no more than the frames since.
    assert!(awake.steps - asleep.steps <= 700, "{}", awake.steps - asleep.steps);
}

#[test]
fn sleep_can_be_switched_off_in_the_panel() {
    let mut window = in_mode("gingerbread", Mode::Simulate);
    click(&mut window, "Sleep");
    window.run_steps(90);
    assert_eq!((window.state().snapshot().asleep, pause(&window)), (0, Duration::ZERO));
    press(&mut window, Key::Space);
    window.run_steps(5);
    assert_eq!(pause(&window), Duration::MAX);
}

//! A window in which everything sleeps rests too.

use crate::harness::*;
use eframe::egui::{Event, Key, Modifiers, PointerButton, vec2};
use egui_kittest::kittest::Queryable as _;
use gingerbread::command::Mode;
use std::time::Duration;

#[test]
fn a_sleeping_scene_asks_for_no_frame_until_a_pull() {
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
fn the_cost_panel_counts_the_triangles_computed() {
    let mut window = in_mode("gingerbread", Mode::Simulate);
    let all = window.state().snapshot().triangles.len();
    assert_eq!(window.state().snapshot().computed, all);
    assert!(window.query_by_label("Computed").is_none());
    window.run_steps(60);
    assert_eq!((window.state().snapshot().asleep, window.state().snapshot().computed), (1, 0));
    assert!(window.query_by_label("Computed").is_some());
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

/// Its clocks run only while it is open.
#[test]
fn the_ledger_says_what_is_skipped_and_why() {
    let timed = |window: &Window| window.state().sandbox().simulation().costs().iter().any(|cost| !cost.time.is_zero());
    let mut window = in_mode("gingerbread", Mode::Collide);
    window.run_steps(5);
    assert!(!timed(&window), "closed, it costs nothing");
    click(&mut window, "What each effect costs");
    window.run_steps(20);
    assert!(timed(&window));
    assert!(window.query_by_label("Auto – skipped: nothing is dragged").is_some());
    assert!(window.query_by_label_contains("Not active: Damping").is_some());
    assert!(
        window.query_all_by_label_contains("100 calls a frame").count() > 0,
        "elasticity acts in each of 100 steps"
    );
    window.get_by_label("Measure what skipping saves").click_accesskit();
    window.run_steps(3);
    for _ in 0..100_000 {
        window.run_steps(1);
        if window.query_by_label("Measure what skipping saves").is_some() {
            break;
        }
    }
    assert!(window.query_by_label_contains(" without: ").is_some(), "measured, not guessed");
    draw(&window);
}

#[test]
fn an_effect_is_asked_in_every_step_once_auto_is_switched_off() {
    let mut window = in_mode("hammock", Mode::Simulate);
    let spring = |window: &Window| {
        window.state().snapshot().costs.iter().find(|cost| cost.name == "Mouse spring").unwrap().clone()
    };
    assert_eq!(spring(&window).calls, 0);
    let at = window.state().snapshot().level.effects.iter().filter(|listed| listed.switch.is_on());
    let place = at.take_while(|listed| listed.effect.name() != "MouseSpring").count();
    window.get_all_by_label("Auto").nth(place).unwrap().scroll_to_me();
    window.run_steps(30);
    window.get_all_by_label("Auto").nth(place).unwrap().click();
    window.run_steps(5);
    assert!(spring(&window).calls > 0 && !spring(&window).auto);
}

#[test]
fn the_clock_says_why_it_stands_still_while_time_is_to_run() {
    let told = |window: &Window| window.query_all_by_label("at rest: clock paused").count();
    let mut window = in_mode("gingerbread", Mode::Simulate);
    assert_eq!(told(&window), 0, "he is not asleep yet");
    window.run_steps(60);
    assert_eq!(
        (window.state().snapshot().asleep, told(&window)),
        (1, 2),
        "beside the clock and in the line at the bottom"
    );
    press(&mut window, Key::Space);
    assert_eq!(told(&window), 0, "paused is paused");
}

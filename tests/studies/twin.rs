//! The error of a running scene, now: against closed forms, and against a twin with a far finer step.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{
    level, released, released_of, simulation,
    studies::{RESTING, WHOLE},
};
use gingerbread::{
    level::{Level, Sleep, Substeps},
    meshes::NoFiles,
    simulation::Simulation,
    study::Twin,
};

fn frames(live: &mut Simulation, twin: &mut Twin, count: u64) {
    let per_frame = (1.0 / (60.0 * live.scene().step)).round() as u64;
    for _ in 0..count {
        live.advance(per_frame, &mut || true);
        twin.follow(live);
        assert!(twin.advance(live, WHOLE));
    }
}

/// Halving the step halves the error.
#[test]
fn the_twin_measures_an_error_of_first_order() {
    let errors = [100, 200].map(|count| {
        let mut level = released("");
        level.substeps = Substeps::new(count).unwrap();
        let mut live = simulation(&level);
        let mut twin = Twin::new(&live);
        frames(&mut live, &mut twin, 6);
        assert!(twin.own_error() <= 0.01 * twin.error().unwrap(), "it is a hundred times better than what it measures");
        assert!(twin.ms_per_second() > 0.0 && (twin.age() - 0.1).abs() < 1e-9);
        twin.error().unwrap()
    });
    assert!(errors[0] > 1e-3 && errors[0] < 0.5);
    assert!((errors[0] / errors[1] - 2.0).abs() < 0.2, "{errors:?}");
}

#[test]
fn where_nothing_moves_there_is_no_error_now() {
    let mut live = simulation(&Level { sleep: Sleep::Off, ..level(RESTING) });
    let mut twin = Twin::new(&live);
    frames(&mut live, &mut twin, 40);
    assert!(twin.error().is_none() && twin.age() > 0.5 && !twin.is_checking());
}

/// A running level with its error after some frames, which must be against a closed form.
fn error_against_closed_form(text: &str, count: u64) -> (f64, String) {
    let mut live = simulation(&level(text));
    frames(&mut live, &mut Twin::new(&simulation(&level(text))), 1);
    let mut twin = Twin::new(&live);
    frames(&mut live, &mut twin, count);
    assert_eq!(twin.own_error(), 0.0);
    (twin.error().unwrap(), twin.exact().unwrap().words.clone())
}

#[test]
fn the_error_now_is_against_the_closed_form_where_there_is_one() {
    let circle =
        |integrator| format!("(name: \"\", substeps: 1, integrator: {integrator}(), toy: Circle(radius: 0.3))");
    // Forward Euler's radius after n steps of h is (1 + h²)^(n/2), and its angle n atan h.
    let (h, n) = (1.0_f64 / 60.0, 61.0);
    let (radius, angle) = ((1.0 + h * h).powf(0.5 * n), n * (h.atan() - h));
    let error = (radius * radius - 2.0 * radius * angle.cos() + 1.0).sqrt();
    let (forward, words) = error_against_closed_form(&circle("ForwardEuler"), 60);
    let moved = (1..=60).map(|k| 2.0 - 2.0 * (f64::from(k + 1) * h).cos()).sum::<f64>() / 60.0;
    assert!((forward / (error / moved.sqrt()) - 1.0).abs() < 1e-9, "{forward} {error}");
    assert!(words.contains("dx/dt"), "{words}");
    assert!(error_against_closed_form(&circle("Heun"), 60).0 < 0.01 * forward);

    let spring = "(name: \"bounce\", nets: [(name: \"s\", net: Chain(from: (0.5, 0.9), to: (0.5, 0.4), springs: 1, stiffness: 100, rest: 0.4),
        mass: 1, pins: [Vertex(0)])], integrator: VelocityVerlet(), effects: [(effect: Gravity(down: 9.8)), (effect: MouseSpring(stiffness: 100))])";
    let (error, words) = error_against_closed_form(spring, 30);
    assert!(error > 0.0 && error < 1e-4 && words.contains("oscillator"), "{error} {words}");
    let fall = "(name: \"fall\", bodies: [(name: \"sheet\", mass: Density(1), velocity: (0.5, 1),
        mesh: Rectangle(width: 0.4, height: 0.4, columns: 2, rows: 2),
        material: (model: NeoHookean, young: 50, poisson: 0.3))], effects: [(effect: Gravity(down: 2))])";
    let (error, words) = error_against_closed_form(fall, 30);
    assert!(error > 1e-5 && error < 1e-2 && words.contains("free fall"), "{error} {words}");
}

/// This holds for every model.
#[test]
fn a_strip_on_rollers_rests_at_its_closed_form() {
    let text = gingerbread::levels::built_in("uniaxial_strip").unwrap();
    for model in gingerbread::materials::Model::ALL {
        for stretch in ["(1, 1.25)", "(1, 0.8)"] {
            let text = text.replace("model: NeoHookean", &format!("model: {}", model.name()));
            let text = text.replace("stretch: (1, 1.5)", &format!("stretch: {stretch}"));
            let mut live = simulation(&level(&text));
            let mut twin = Twin::new(&live);
            frames(&mut live, &mut twin, 1);
            let early = twin.error().unwrap();
            frames(&mut live, &mut twin, 400);
            let late = twin.error().unwrap();
            assert!(early > 0.1 && late < 1e-6, "{} {stretch}: {early:e} to {late:e}", model.name());
            assert!(twin.exact().unwrap().words.contains("strip"));
        }
    }
}

#[test]
fn a_pull_leaves_the_closed_form_and_a_twin_takes_over() {
    let text = gingerbread::levels::built_in("uniaxial_strip").unwrap();
    let mut live = simulation(&level(text));
    let mut twin = Twin::new(&live);
    assert!(twin.exact().is_some());
    live.set_grab(Some(gingerbread::effects::Grab { vertex: 120, target: [0.8, 0.3, 0.0] }));
    frames(&mut live, &mut twin, 2);
    assert!(twin.exact().is_none() && twin.error().is_some());
}

#[test]
fn the_twin_follows_pulls_and_restarts() {
    let level = released("effects: [(effect: MouseSpring(stiffness: 50))]");
    let mut live = simulation(&level);
    let mut twin = Twin::new(&live);
    live.set_grab(Some(gingerbread::effects::Grab { vertex: 0, target: [0.0, 0.0, 0.0] }));
    frames(&mut live, &mut twin, 6);
    let pulled = twin.error().unwrap();
    assert!(pulled > 0.0 && pulled < 0.2, "the twin feels the mouse: {pulled}");
    let start = live.scene().start.clone();
    live.set_state(start);
    frames(&mut live, &mut twin, 1);
    assert!(twin.age() <= 1.0 / 60.0 + 1e-9, "a step count that went back is a new beginning");
    frames(&mut live, &mut twin, 3);
    twin.seed(&live);
    assert!(twin.error().is_none());
}

#[test]
fn the_twin_takes_over_what_is_changed_while_time_runs() {
    let level = released_of(100, "");
    let mut live = simulation(&level);
    let mut twin = Twin::new(&live);
    frames(&mut live, &mut twin, 2);
    let gravity = released_of(100, "effects: [(effect: Gravity(down: 5))]");
    live.replace_scene(gingerbread::scene::Scene::build(&gravity, gravity.mode, &NoFiles, None).unwrap());
    frames(&mut live, &mut twin, 6);
    assert!(twin.error().unwrap() < 0.1, "both fall: {:?}", twin.error());
}

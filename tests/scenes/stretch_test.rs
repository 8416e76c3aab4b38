//! The test of compression and stretch: its poses, all models side by side, and the force that holds a strip.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{material, opened, seen};
use gingerbread::{
    command::{Command, Pose},
    materials::Model,
    meshes::NoFiles,
    sandbox::Sandbox,
};

#[test]
fn a_stretch_test_has_two_poses_and_all_models() {
    let mut sandbox = opened("stretch_test");
    assert!(opened("jelly_disk").apply(Command::SetPose(Pose::Stretched)).is_err());
    sandbox.apply(Command::SetPose(Pose::Compressed)).unwrap();
    let one = seen(&sandbox);
    assert!((one.bodies[0].height_ratio - 0.6).abs() < 1e-12);
    assert!((one.bodies[0].mid_width - 0.2375).abs() < 1e-12, "not yet bulged");
    sandbox.apply(Command::SetSideBySide(true)).unwrap();
    let all = seen(&sandbox);
    let models: Vec<_> = all.bodies.iter().map(|body| body.material.model().unwrap()).collect();
    assert_eq!(models, Model::ALL);
    let pitch = 1.4 * 0.2375;
    for (number, body) in all.bodies.iter().enumerate() {
        let own = &all.positions[2 * body.vertices.start..2 * body.vertices.end];
        let (left, right) = gingerbread::scene::extent(own, 0);
        assert!((0.5 * (left + right) - 0.5 - pitch * (number as f64 - 2.5)).abs() < 1e-12, "room to bulge");
        assert!(left > 0.5 - 0.5 * all.width - 1e-12 && right < 0.5 + 0.5 * all.width + 1e-12, "in sight");
        assert!(body.energy > 0.0 && body.top_force < 0.0, "a pressed strip is held down");
    }
    let saved = Sandbox::new(sandbox.saved(), Box::new(NoFiles)).unwrap();
    assert_eq!((one.width, seen(&saved).width), (1.0, all.width));
    sandbox.apply(Command::SetMaterial(2, material(50.0))).unwrap();
    assert!(seen(&sandbox).level.bodies.iter().all(|body| body.material.young().get() == 50.0));
    assert_eq!(seen(&sandbox).bodies[2].material.model(), Some(Model::NeoHookean), "the models stay apart");
    sandbox.apply(Command::SetPose(Pose::Stretched)).unwrap();
    assert!(seen(&sandbox).bodies.iter().all(|body| (body.height_ratio - 2.0).abs() < 1e-12 && body.top_force > 0.0));
    sandbox.apply(Command::SetModel(Model::StVenantKirchhoff)).unwrap();
    let now = seen(&sandbox);
    assert!(
        now.bodies.len() == 1 && now.bodies[0].material.model() == Some(Model::StVenantKirchhoff) && !now.side_by_side
    );
}

/// The clamped strip of the test, at its ends: the force on the top edge is what the law of each model says for a strip that is
/// stretched evenly, before its free sides have moved.
#[test]
fn the_force_on_the_top_edge_is_stress_times_width() {
    let mut sandbox = opened("stretch_test");
    sandbox.apply(Command::SetSideBySide(true)).unwrap();
    sandbox.apply(Command::SetPose(Pose::Stretched)).unwrap();
    let (mu, lambda) = (100.0 / 3.0, 100.0 / 1.5);
    let s = 2.0_f64;
    let stresses = [
        (2.0 * mu + lambda) * (s - 1.0),
        (mu + 0.5 * lambda) * s * (s * s - 1.0),
        mu * (s - 1.0 / s) + lambda * s.ln() / s,
        1.5 * mu * s * (s * s + 1.0) / (s * s + 2.0) + (lambda + 2.0 / 3.0 * mu) * (s - 1.0) - mu,
        (2.0 * mu + lambda) * (s - 1.0),
        (2.0 * mu + lambda) * s.ln() / s,
    ];
    assert_eq!(stresses.len(), Model::ALL.len());
    for (body, stress) in seen(&sandbox).bodies.iter().zip(stresses) {
        assert!((body.top_force - stress * 0.2375).abs() < 1e-10 * stress, "{}: {}", body.name, body.top_force);
    }
}

#[test]
fn undo_of_another_level_restores_strips_side_by_side() {
    let mut sandbox = opened("stretch_test");
    sandbox.apply(Command::SetSideBySide(true)).unwrap();
    let before = seen(&sandbox);
    let other = opened("jelly_disk").saved();
    sandbox.apply(Command::Open(Box::new(other))).unwrap();
    sandbox.apply(Command::Undo).unwrap();
    let after = seen(&sandbox);
    assert_eq!((after.positions, after.start), (before.positions, before.start));
}

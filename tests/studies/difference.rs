//! Two runs of one level on two meshes are compared at the same material points.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use gingerbread::{
    files, levels,
    meshes::NoFiles,
    scene::{Correspondence, Scene},
    simulation::Simulation,
    state::State,
    study::{Apart, Difference, counterpart},
};

/// A level with the last number of each mesh, its resolution, scaled.
fn scene(name: &str, share: f64) -> Scene {
    let mut level = files::parse(levels::built_in(name).unwrap(), name).unwrap();
    for body in &mut level.bodies {
        let mut numbers = body.mesh.kind_mut().parameters();
        let resolution = numbers.last_mut().unwrap();
        resolution.set((share * resolution.get()).round()).unwrap();
    }
    Scene::build(&level, level.mode, &NoFiles, None).unwrap()
}

/// An affine map of points, about 0.3 m away.
fn mapped(rest: &[f64]) -> Vec<f64> {
    rest.chunks_exact(2).flat_map(|p| [1.2 * p[0] + 0.3 * p[1] - 0.1, 0.9 * p[1] - 0.2 * p[0] + 0.4]).collect()
}

#[test]
fn an_affine_map_of_both_meshes_is_no_difference() {
    for name in ["gingerbread", "jelly_disk", "cantilever", "three_models"] {
        let (a, b) = (scene(name, 1.0), scene(name, 0.3));
        for (a, b) in [(&a, &b), (&b, &a)] {
            assert_ne!(a.rest.len(), b.rest.len(), "{name}");
            let seen = Correspondence::new(a, b).unwrap();
            let (expected, x) = (mapped(&a.rest), mapped(&b.rest));
            let worst = seen.seen(&x).iter().zip(&expected).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-12, "{name}: {worst}");
        }
    }
}

#[test]
fn a_shift_is_measured_in_metres_and_relative_to_motion() {
    let (a, b) = (scene("gingerbread", 1.0), scene("gingerbread", 0.5));
    let at = |scene: &Scene, shift: f64| {
        let x = scene.rest.iter().enumerate().map(|(i, x)| x + if i % 2 == 0 { shift } else { 0.0 }).collect();
        Simulation::new(scene.clone(), State { x, ..scene.start.clone() })
    };
    let mut difference = Difference::new(&at(&a, 0.0), &at(&b, 0.0));
    let near = |apart: Apart, metres: f64, relative: f64| {
        assert!((apart.metres - metres).abs() < 1e-12 && (apart.relative - relative).abs() < 1e-10, "{apart:?}");
    };
    near(difference.measure(&at(&a, 0.2), &at(&b, 0.23)).unwrap(), 0.03, 0.15);
    near(difference.measure(&at(&a, 0.1), &at(&b, 0.11)).unwrap(), 0.01, 0.05);
    let same = Difference::new(&at(&a, 0.0), &at(&a, 0.0)).measure(&at(&a, 0.7), &at(&a, 0.7));
    assert_eq!(same, Some(Apart::default()), "equal positions are exactly no difference");
}

#[test]
fn scenes_that_show_other_things_are_not_compared() {
    assert!(Correspondence::new(&scene("gingerbread", 1.0), &scene("three_models", 1.0)).is_none());
    assert!(Correspondence::new(&scene("chain", 1.0), &scene("hanging_net", 1.0)).is_none());
}

/// It is in the same body.
#[test]
fn the_counterpart_of_a_vertex_is_the_nearest_at_rest() {
    let (a, b) = (scene("three_models", 1.0), scene("three_models", 0.4));
    let owner = |scene: &Scene, vertex: usize| scene.owner_of(vertex).unwrap().0;
    for vertex in (0..a.rest.len() / 2).step_by(37) {
        let twin = counterpart(&a, &b, vertex).unwrap();
        assert_eq!(owner(&a, vertex), owner(&b, twin));
        let gap = |i: usize| {
            let along = |axis: usize| b.rest[2 * i + axis] - a.rest[2 * vertex + axis];
            along(0) * along(0) + along(1) * along(1)
        };
        let own = (0..b.rest.len() / 2).filter(|i| owner(&b, *i) == owner(&a, vertex));
        assert!(gap(twin) <= own.map(gap).fold(f64::INFINITY, f64::min));
    }
    assert_eq!(counterpart(&a, &a, 11), Some(11));
}

//! Facts about edges of the domain, walls and obstacles, and about the velocity filter.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{Random, level, models, sheet, simulation};
use gingerbread::{
    contact::FilteredStep,
    effects::EffectKind,
    files, levels,
    meshes::NoFiles,
    obstacles::{Obstacle, ObstacleKind, Similarity, Surfaces, placed},
    scene::Scene,
};

fn obstacles(list: &str) -> Vec<Box<dyn Obstacle>> {
    let text = format!("(name: \"\", bodies: [], effects: [(effect: Walls(obstacles: [{list}]))])");
    let EffectKind::Walls(walls) = level(&text).effects.remove(0).effect else { unreachable!("{text}") };
    walls.obstacles.iter().map(|kind| kind.kind().build().unwrap()).collect()
}

const ALL: &str = "Plane(point: (0.1, 0.2), normal: (1, 2), eps: 0.02),
    Ball(centre: (0.5, 0.5), radius: 0.2, eps: 0.02),
    Cuboid(centre: (0.5, 0.5), width: 0.5, height: 0.2, turn: 30, eps: 0.02),
    Polygon(points: [(0.2, 0.2), (0.8, 0.2), (0.8, 0.8), (0.5, 0.4), (0.2, 0.8)], eps: 0.02)";

/// Positions and velocities of many vertices before and after the velocity filter of an obstacle, two by two.
fn filtered(obstacle: &str, random: &mut Random) -> Vec<[[f64; 2]; 4]> {
    let text = sheet(
        "Corotated",
        "velocity: (0, 0)",
        &format!("effects: [(effect: VelocityFilter()), (effect: Walls(obstacles: [{obstacle}]))]"),
    );
    let scene = Scene::build(&text, text.mode, &NoFiles, None).unwrap();
    let contact = scene.effects.iter().find_map(|effect| effect.obstacle_contact()).unwrap();
    let count = scene.rest.len();
    let before: Vec<f64> = (0..count).map(|_| random.between(0.0, 1.0)).collect();
    let speeds: Vec<f64> = (0..count).map(|_| random.between(-1.0, 1.0)).collect();
    let (mut x, mut v) = (before.clone(), speeds.clone());
    let start = x.clone();
    contact.filter(FilteredStep {
        time: [0.0; 2],
        start: &start,
        inverse_mass: &scene.inverse_mass,
        x: &mut x,
        v: &mut v,
    });
    let all = [before, speeds, x, v];
    (0..count / 2).map(|vertex| all.each_ref().map(|values| [values[2 * vertex], values[2 * vertex + 1]])).collect()
}

/// A vertex near a wall loses only its velocity inwards, and one inside is put on the surface; neither gains speed.
#[test]
fn the_filter_takes_only_the_inward_velocity() {
    let mut random = Random(1);
    for (number, obstacle) in obstacles(ALL).iter().enumerate() {
        let text = ALL.lines().nth(number).unwrap().trim().trim_end_matches(',');
        let (mut near, mut inside) = (0, 0);
        for _ in 0..2000 {
            for [x, v, end, after] in filtered(text, &mut random) {
                assert!(after[0].hypot(after[1]) <= v[0].hypot(v[1]) * (1.0 + 1e-15), "a wall never gives speed");
                let Some(contact) = obstacle.contact(x) else {
                    assert!(after == v && end == x);
                    continue;
                };
                let [nx, ny] = contact.normal;
                let inwards = (v[0] * nx + v[1] * ny).min(0.0);
                assert!((after[0] - (v[0] - inwards * nx)).abs() < 1e-12);
                assert!((after[1] - (v[1] - inwards * ny)).abs() < 1e-12);
                near += 1;
                inside += usize::from(contact.distance < 0.0);
                assert!(contact.distance < 0.0 || end == x, "outside nothing is moved");
                let distance = obstacle.contact(end).map_or(f64::INFINITY, |contact| contact.distance);
                assert!(distance > -1e-9, "still {distance:e} inside");
            }
        }
        assert!(near > 100 && inside > 50, "only {near} points were near, {inside} inside");
    }
}

#[test]
fn obstacles_without_a_shape_are_refused_with_a_reason() {
    let refused = |kind: &str| {
        let text = format!("(name: \"\", bodies: [], effects: [(effect: Walls(obstacles: [{kind}]))])");
        let EffectKind::Walls(walls) = level(&text).effects.remove(0).effect else { unreachable!("{text}") };
        let kind: &ObstacleKind = &walls.obstacles[0];
        kind.kind().build().err().unwrap()
    };
    assert!(refused("Plane(point: (0, 0), normal: (0, 0), eps: 0.01)").contains("direction"));
    assert!(refused("Polygon(points: [(0, 0), (1, 0)], eps: 0.01)").contains("three corners"));
    assert!(refused("Polygon(points: [(0, 0), (1, 1), (1, 0), (0, 1)], eps: 0.01)").contains("sides 0 and 2 do"));
    assert!(refused("Polygon(points: [(0, 0), (2, 0), (0.5, 1), (1, -1), (2, 2)], eps: 0.01)").contains("cross"));
}

#[test]
fn domain_edges_stop_vertices_and_outward_velocity() {
    for filter in ["", "(effect: VelocityFilter()), "] {
        let mut simulation = simulation(&sheet(
            "Corotated",
            "velocity: (40, -3)",
            &format!("effects: [{filter}(effect: Boundary(least: (0, 0), greatest: (1, 1)))]"),
        ));
        let mut touched = false;
        for _ in 0..400 {
            simulation.advance(1, &mut || true);
            let state = simulation.state();
            assert!(state.x.iter().all(|x| (0.0..=1.0).contains(x)), "{filter}");
            touched |= !state.anchors.is_empty() || simulation.counts().constrained > 0;
        }
        assert!(touched);
    }
}

/// The drop in the house, from rest, for every model and five seconds: finite, whole, and never more energy than at the start.
#[test]
fn all_models_survive_the_drop_in_the_house() {
    let mut level = files::parse(levels::built_in("gingerbread_house").unwrap(), "gingerbread_house.ron").unwrap();
    for (&model, name) in gingerbread::materials::Model::ALL.iter().zip(models()) {
        level.bodies[0].material = level.bodies[0].material.with_model(model);
        let mut simulation = simulation(&level);
        let start = simulation.energies().total();
        let mut least = f64::INFINITY;
        for _ in 0..1000 {
            simulation.advance(45, &mut || true);
            assert!(simulation.fault().is_none(), "{name}: {:?}", simulation.fault());
            least = least.min(simulation.inversion().0);
            let gain = simulation.energies().total() / start - 1.0;
            assert!(gain <= 0.01, "{name}: {gain}");
        }
        assert!(least > 0.2, "{name}: least J {least}");
        assert!(!simulation.state().anchors.is_empty(), "{name}: he does not lie on the floor");
    }
}

#[test]
fn nobody_leaves_the_house_and_bodies_rest_outside_obstacles() {
    for name in ["gingerbread_house", "jelly_disk"] {
        let level = files::parse(levels::built_in(name).unwrap(), name).unwrap();
        let walls = level.effects.iter().find_map(|listed| match &listed.effect {
            EffectKind::Walls(walls) => Some(walls),
            _ => None,
        });
        let built: Vec<_> = walls.unwrap().obstacles.iter().map(|kind| kind.kind().build().unwrap()).collect();
        let mut simulation = simulation(&level);
        for _ in 0..100 {
            simulation.advance(100, &mut || true);
            for point in simulation.state().x.chunks_exact(2) {
                let deepest = built.iter().filter_map(|wall| wall.contact([point[0], point[1]]));
                assert!(deepest.map(|contact| contact.distance).fold(0.0, f64::min) > -1e-9, "{name}");
            }
        }
    }
}

#[test]
fn distance_and_normal_of_ball_and_plane_match_geometry() {
    let mut random = Random(3);
    let ball = &obstacles("Ball(centre: (0.5, 0.5), radius: 0.2, eps: 0.05)")[0];
    let plane = &obstacles("Plane(point: (0, 0.4), normal: (0, 3), eps: 0.05)")[0];
    for _ in 0..2000 {
        let [x, y] = [random.between(0.0, 1.0), random.between(0.0, 1.0)];
        let (dx, dy) = (x - 0.5, y - 0.5);
        let length = dx.hypot(dy);
        match ball.contact([x, y]) {
            Some(contact) => {
                let [nx, ny] = contact.normal;
                assert!((contact.distance - (length - 0.2)).abs() < 1e-12 && length < 0.25);
                assert!((nx - dx / length).abs() < 1e-9 && (ny - dy / length).abs() < 1e-9);
            }
            None => assert!(length >= 0.25, "a point {length} m from the middle is near"),
        }
        let near = plane.contact([x, y]);
        assert_eq!(near.is_some(), y < 0.45);
        assert!(
            near.is_none_or(|contact| contact.normal == [0.0, 1.0] && (contact.distance - (y - 0.4)).abs() < 1e-15)
        );
    }
}

/// Distances scale, normals turn, and what moves goes on moving as if it had been seen from elsewhere.
#[test]
fn arranged_obstacles_are_similar_ones() {
    const MOVING: &str =
        "Moving(obstacle: Cuboid(centre: (0.5, 0.5), width: 0.5, height: 0.2, turn: 30, eps: 0.02), motions: [
        Turn(about: (0.1, 0.2), spin: 2), Swing(way: (0.3, 0.1), period: 1.5), Slide(velocity: (0.2, -0.1)),
        Spline(points: [(0, (0, 0)), (1, (0.2, 0.1)), (2, (0.3, -0.4))])])";
    let text = format!("(name: \"\", bodies: [], effects: [(effect: Walls(obstacles: [{ALL}, {MOVING}]))])");
    let EffectKind::Walls(walls) = level(&text).effects.remove(0).effect else { unreachable!("{text}") };
    assert_eq!(ObstacleKind::all().iter().filter(|kind| kind.kind().dimension() == 2).count(), walls.obstacles.len());
    let mut random = Random(7);
    for by in [
        Similarity { to: [0.3, -0.2, 0.0], ..Similarity::NONE },
        Similarity { from: [0.4, 0.1, 0.0], to: [0.4, 0.1, 0.0], turn: 77.0, ..Similarity::NONE },
        Similarity { from: [0.4, 0.1, 0.0], to: [1.4, 0.6, 0.0], scale: 2.5, turn: -140.0, ..Similarity::NONE },
    ] {
        for kind in &walls.obstacles {
            let arranged = kind.arranged(&by).unwrap();
            let [before, after] = [kind, &arranged].map(|kind| kind.kind().build().unwrap());
            let map = |[x, y]: [f64; 2]| {
                let [x, y, _] = by.point([x, y, 0.0]);
                [x, y]
            };
            for _ in 0..500 {
                let point = [random.between(-0.5, 1.5), random.between(-0.5, 1.5)];
                let contacts = [before.distance(point, 100.0), after.distance(map(point), 100.0)];
                let [Some(one), Some(other)] = contacts else { unreachable!("{contacts:?}") };
                assert!((other.distance - by.scale * one.distance).abs() < 1e-12, "{}: {contacts:?}", kind.name());
                let [nx, ny, _] = by.direction([one.normal[0], one.normal[1], 0.0]);
                // Between two sides at the same distance, either one is nearest.
                let turned = (nx - other.normal[0]).hypot(ny - other.normal[1]) < 1e-9;
                assert!(turned || one.distance < 0.0, "{}: {contacts:?}", kind.name());
            }
            let [x, y, _] = kind.kind().place();
            let [px, py, _] = arranged.kind().place();
            assert!((map([x, y])[0] - px).hypot(map([x, y])[1] - py) < 1e-12, "{}", kind.name());
            for time in [0.0, 0.3, 1.7] {
                let [at, then] = [kind, &arranged].map(|kind| placed::<2>(&kind.kind().motions(), time));
                let ([x, y], [px, py]) = (map(at.point([0.3, 0.9])), then.point(map([0.3, 0.9])));
                assert!((x - px).hypot(y - py) < 1e-12, "{}: {x} {y} {px} {py}", kind.name());
            }
        }
    }
    let far = Similarity { to: [f64::INFINITY, 0.0, 0.0], ..Similarity::NONE };
    assert!(walls.obstacles.iter().all(|kind| kind.arranged(&far).is_none()), "a number out of range is refused");
}

/// In space obstacles are moved and scaled.
#[test]
fn arranged_obstacles_in_space_are_similar_ones() {
    let by = Similarity { from: [0.1, 0.2, 0.3], to: [0.5, -0.2, 0.4], scale: 1.7, ..Similarity::NONE };
    let mut random = Random(8);
    let kinds = ObstacleKind::all().into_iter();
    for kind in kinds.filter(|kind| kind.kind().dimension() == 3 && kind.kind().path().is_none()) {
        let arranged = kind.arranged(&by).unwrap();
        let [before, after] = [&kind, &arranged].map(|kind| kind.kind().build_in_space(&Surfaces::default()).unwrap());
        for _ in 0..500 {
            let point = [0, 1, 2].map(|_| random.between(-1.0, 1.0));
            let contacts = [before.distance(point, 100.0), after.distance(by.point(point), 100.0)];
            let [Some(one), Some(other)] = contacts else { unreachable!("{contacts:?}") };
            assert!((other.distance - by.scale * one.distance).abs() < 1e-9, "{}: {contacts:?}", kind.name());
        }
    }
}

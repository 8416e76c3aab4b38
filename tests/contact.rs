//! Facts about edges, walls and obstacles.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

mod common;

use common::{Random, level, models, sheet, simulation};
use gingerbread::{
    effects::EffectKind,
    files, levels,
    obstacles::{ContactCache, ContactQuery, Inside, Obstacle, ObstacleKind, Start, Surface, SweptMotion},
};
use std::cell::Cell;

fn obstacles(list: &str) -> Vec<Box<dyn Obstacle>> {
    let text = format!("(name: \"\", bodies: [], effects: [(effect: Walls(obstacles: [{list}]))])");
    let EffectKind::Walls(walls) = level(&text).effects.remove(0).effect else { unreachable!("{text}") };
    walls.obstacles.iter().map(|kind| kind.kind().build().unwrap()).collect()
}

/// A vertex that would end a step at x with velocity v, after an obstacle stopped it.
fn stopped(obstacle: &dyn Obstacle, from: [f64; 2], x: [f64; 2], v: [f64; 2]) -> ([f64; 2], [f64; 2]) {
    let mut start = Start {
        x: &from,
        v: &v,
        inverse_mass: &[1.0; 2],
        surface: Surface::default(),
        outward: None,
        time: [0.0; 2],
        supplied: &Cell::new(0.0),
        depenetrations: &[],
        effect: 0,
        touching: &[],
        penetrations: &[],
        contact_cache: ContactCache::NONE,
        inside: &Cell::new(Inside::Nothing),
    };
    let (mut x, mut after) = (x, v);
    let alone = ContactQuery::new(([0, 0], obstacle), SweptMotion::STILL, [from, x]);
    let mut contact_cache = ContactCache::default();
    contact_cache.record(&alone, &start);
    start.contact_cache = &contact_cache;
    alone.constrain(&start, &mut x, &mut after);
    (x, after)
}

const ALL: &str =
    "Plane(point: (0.1, 0.2), normal: (1, 2), eps: 0.02), Ball(centre: (0.5, 0.5), radius: 0.2, eps: 0.02),
    Cuboid(centre: (0.5, 0.5), width: 0.5, height: 0.2, turn: 30, eps: 0.02),
    Polygon(points: [(0.2, 0.2), (0.8, 0.2), (0.8, 0.8), (0.5, 0.4), (0.2, 0.8)], eps: 0.02)";

#[test]
fn a_wall_removes_only_the_inward_velocity() {
    let mut random = Random(1);
    for obstacle in obstacles(ALL) {
        let mut near = 0;
        for _ in 0..20_000 {
            let x = [random.between(0.0, 1.0), random.between(0.0, 1.0)];
            let v = [random.between(-1.0, 1.0), random.between(-1.0, 1.0)];
            let (end, after) = stopped(obstacle.as_ref(), x, x, v);
            let contact = obstacle.contact(x).filter(|contact| contact.distance > 1e-4);
            let Some(contact) = contact else {
                assert!(obstacle.contact(x).is_some() || (after == v && end == x));
                continue;
            };
            assert_eq!(end, x, "where nothing moved, nothing is moved");
            near += 1;
            let [nx, ny] = contact.normal;
            let inwards = (v[0] * nx + v[1] * ny).min(0.0);
            assert!((nx.hypot(ny) - 1.0).abs() < 1e-12 && contact.distance < 0.02);
            assert!((after[0] - (v[0] - inwards * nx)).abs() < 1e-15);
            assert!((after[1] - (v[1] - inwards * ny)).abs() < 1e-15);
            assert!(after[0].hypot(after[1]) <= v[0].hypot(v[1]) * (1.0 + 1e-15), "a wall never gives speed");
        }
        assert!(near > 100, "only {near} points were near");
    }
}

#[test]
fn a_vertex_inside_is_put_on_the_surface_without_gaining_speed() {
    let mut random = Random(2);
    for obstacle in obstacles(ALL) {
        let mut inside = 0;
        for _ in 0..4000 {
            let start = [random.between(0.0, 1.0), random.between(0.0, 1.0)];
            let v = [random.between(-1.0, 1.0), random.between(-1.0, 1.0)];
            let (x, after) = stopped(obstacle.as_ref(), start, start, v);
            let was_inside = obstacle.contact(start).is_some_and(|contact| contact.distance < 0.0);
            inside += i32::from(was_inside);
            let distance = obstacle.contact(x).map_or(f64::INFINITY, |contact| contact.distance);
            assert!(distance > -1e-12, "still {distance:e} inside");
            assert!(after[0].hypot(after[1]) <= v[0].hypot(v[1]) * (1.0 + 1e-15));
            let was_near = obstacle.contact(start).is_some_and(|contact| contact.distance < 1e-4);
            assert!(was_near || x == start, "outside nothing moves");
        }
        assert!(inside > 100, "only {inside} points were inside");
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
    let mut simulation = simulation(&sheet(
        "Corotated",
        "velocity: (40, -3)",
        "effects: [(effect: Boundary(least: (0, 0), greatest: (1, 1)))]",
    ));
    for _ in 0..400 {
        simulation.advance(1, &mut || true);
        let state = simulation.state();
        assert!(state.x.iter().all(|x| (0.0..=1.0).contains(x)));
        assert!(state.x.iter().zip(&state.v).all(|(x, v)| (*x < 1.0 || *v <= 0.0) && (*x > 0.0 || *v >= 0.0)));
    }
    assert!(simulation.counts().constrained > 0);
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
            simulation.advance(30, &mut || true);
            assert!(simulation.fault().is_none(), "{name}: {:?}", simulation.fault());
            least = least.min(simulation.inversion().0);
            assert!(simulation.energies().total() <= start * (1.0 + 1e-3), "{name}");
        }
        assert!(least > 0.2, "{name}: least J {least}");
        assert!(simulation.counts().constrained > 0, "{name}: he never touched the house");
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

/// The way out of a flat side is known exactly: what slides along it must go on sliding, also right after being pushed out,
/// when the way to the surface is no longer than round-off.
#[test]
fn a_vertex_pushed_out_of_a_flat_side_goes_on_sliding() {
    let side = [
        ("Cuboid(centre: (0.5, 0.2), width: 0.8, height: 0.2, eps: 0.01)", [0.0, 1.0]),
        ("Polygon(points: [(0.1, 0.1), (0.9, 0.1), (0.9, 0.3), (0.1, 0.3)], eps: 0.01)", [0.0, 1.0]),
        ("Cuboid(centre: (0.2, 0.5), width: 0.2, height: 0.8, eps: 0.01)", [1.0, 0.0]),
    ];
    for (kind, [nx, ny]) in side {
        let wall = &obstacles(kind)[0];
        for depth in [2.4e-3, 1e-3, 1e-9, 1e-16, 0.0, -1e-17, -5e-3] {
            let along = 0.37;
            let mut x = [along * ny + (0.3 - depth) * nx, along * nx + (0.3 - depth) * ny];
            let mut v = [0.3 * ny - 0.1 * nx, 0.3 * nx - 0.1 * ny];
            for _ in 0..3 {
                let to = [x[0] + 1e-4 * v[0], x[1] + 1e-4 * v[1]];
                (x, v) = stopped(wall.as_ref(), x, to, v);
            }
            assert!((v[0] - 0.3 * ny).abs() < 1e-8 && (v[1] - 0.3 * nx).abs() < 1e-8, "{kind} at {depth:e}: {v:?}");
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

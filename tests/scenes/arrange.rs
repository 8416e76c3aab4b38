//! Bodies that are moved, turned, scaled and copied in the window keep what names their vertices.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a failing test should panic")]

use crate::common::level;
use gingerbread::{
    command::{Command, Mode},
    level::{EffectLevel, Place, SpacePlace, Switch},
    meshes::NoFiles,
    obstacles::{ObstacleKind, Similarity},
    quantity::{Angle, Factor, Point},
    sandbox::Sandbox,
};

fn opened(body: &str, effects: &str) -> Sandbox {
    let level = level(&format!(
        "(name: \"block\", bodies: [(name: \"block\", mesh: Rectangle(width: 1, height: 0.5, columns: 4, rows: 2, corner: (0, 0)), mass: Density(1),
          material: (model: Corotated, young: 100, poisson: 0.3, plane: Stress), {body})], effects: [{effects}])"
    ));
    Sandbox::new(level, Box::new(NoFiles)).unwrap()
}

fn place(scale: f64, turn: f64, offset: [f64; 2]) -> Place {
    Place { scale: Factor::new(scale).unwrap(), turn: Angle::new(turn).unwrap(), offset: Point::new(offset).unwrap() }
}

#[test]
fn pins_and_prescribed_motion_stay_with_a_body() {
    let mut sandbox = opened(
        "pins: [Disk((0, 0), 0.3), Box((1, 0), (1, 0.1))]",
        "(effect: MovingPins(of: \"block\", pins: [Nearest((1, 0.5))], motions: [Swing(way: (0.1, 0), period: 2)]))",
    );
    let named = |sandbox: &Sandbox| {
        let scene = sandbox.simulation().scene();
        (scene.pins.to_vec(), scene.held().collect::<Vec<_>>())
    };
    let before = named(&sandbox);
    assert!(before.0.len() > 1 && before.1.len() == 1, "{before:?}");
    for place in [place(1.0, 0.0, [0.6, 0.3]), place(0.5, 90.0, [0.9, 0.1]), place(2.0, -30.0, [0.0, 0.0])] {
        sandbox.apply(Command::SetPlace(0, place)).unwrap();
        assert_eq!(named(&sandbox), before, "{place:?}");
        let [x, y] = place.offset.get();
        let rest = &sandbox.simulation().scene().rest;
        let corner = (0..rest.len() / 2).map(|vertex| (rest[2 * vertex] - x).hypot(rest[2 * vertex + 1] - y));
        assert!(corner.fold(f64::INFINITY, f64::min) < 1e-12, "the origin of the mesh is there");
    }
    sandbox.apply(Command::CopyPart(0)).unwrap();
    sandbox.apply(Command::CopyPart(0)).unwrap();
    let scene = sandbox.simulation().scene();
    let ends = |body: usize| {
        let own = scene.rest[scene.numbers(&scene.bodies[body].vertices)].iter().step_by(2).copied();
        [own.clone().fold(f64::INFINITY, f64::min), own.fold(f64::NEG_INFINITY, f64::max)]
    };
    assert!(ends(1)[0] > ends(0)[1] && ends(2)[0] > ends(1)[1], "each copy is to the right of all others");
    assert_eq!(scene.pins.len(), 3 * before.0.len(), "and pinned like the body");
}

#[test]
fn what_cannot_move_with_a_body_is_refused_in_words() {
    let refused = |body: &str, effects: &str| {
        let mut sandbox = opened(body, effects);
        let before = sandbox.simulation().scene().rest.clone();
        let why = sandbox.apply(Command::SetPlace(0, place(1.0, 30.0, [0.1, 0.0]))).unwrap_err().to_string();
        assert_eq!(sandbox.simulation().scene().rest, before, "nothing has changed");
        why
    };
    assert!(refused("slides: [Left]", "").contains("rollers"));
    let load = "(effect: EdgeLoad(of: \"block\", edges: [Box((1, 0), (1, 0.5))], traction: (1, 0)))";
    assert!(refused("pins: [Left]", load).contains("edges"));
}

/// A block of jelly with friction that rests on two obstacles, one of which has corners, with a ball far away in the list before them.
fn resting(integrator: &str) -> Sandbox {
    let level = level(&format!(
        "(name: \"block\", mode: Collide, substeps: 40, integrator: {integrator}(), bodies: [(name: \"block\",
            mesh: Rectangle(width: 0.4, height: 0.2, columns: 8, rows: 4, diagonals: Alternating, corner: (0, 0.02)),
            material: (model: Corotated, young: 20000, poisson: 0.3, plane: Strain), mass: Density(100))],
          effects: [(effect: Gravity(down: 9.81)), (effect: Rayleigh(mass: 2, stiffness: 0.001)), (effect: Friction(coefficient: 0.8)),
            (effect: Walls(obstacles: [Ball(centre: (3, 3), radius: 0.1, eps: 0.01),
                Cuboid(centre: (0.05, -0.1), width: 0.2, height: 0.2, turn: 2, eps: 0.01),
                Polygon(points: [(0.25, -0.1), (0.45, -0.1), (0.35, -0.005)], eps: 0.01)]))])"
    ));
    let mut sandbox = Sandbox::new(level, Box::new(NoFiles)).unwrap();
    sandbox.apply(Command::SetMode(Mode::Collide)).unwrap();
    run(&mut sandbox, 2.0);
    assert!(greatest_speed(&sandbox) < 0.01, "it rests: {}", greatest_speed(&sandbox));
    sandbox
}

fn run(sandbox: &mut Sandbox, seconds: f64) {
    let steps = (seconds / sandbox.step_length()).round() as u64;
    sandbox.advance(steps, &mut || true);
    assert!(sandbox.simulation().fault().is_none(), "{:?}", sandbox.simulation().fault());
}

fn greatest_speed(sandbox: &Sandbox) -> f64 {
    let v = &sandbox.simulation().state().v;
    v.chunks_exact(2).map(|v| v[0].hypot(v[1])).fold(0.0, f64::max)
}

/// Changes the obstacles of the walls.
fn with_obstacles(sandbox: &mut Sandbox, change: impl Fn(&mut Vec<ObstacleKind>)) {
    let number = sandbox.document().level.effects.len() - 1;
    let mut effect: EffectLevel = sandbox.document().level.effects[number].clone();
    change(effect.effect.kind_mut().obstacles_mut().unwrap());
    sandbox.apply(Command::SetEffect(number, effect)).unwrap();
}

/// Switches the damping, which comes before the walls.
fn switch_damping(sandbox: &mut Sandbox, on: bool) {
    let switch = if on { Switch::Auto } else { Switch::Off };
    let damping = EffectLevel { switch, ..sandbox.document().level.effects[1].clone() };
    sandbox.apply(Command::SetEffect(1, damping)).unwrap();
}

/// A moment of the run is what it was after a change that was taken back, and one of other obstacles begins its contacts anew.
#[test]
fn moments_keep_their_contacts_while_the_level_is_theirs() {
    let mut hashes = [false, true].map(|changes| {
        let mut sandbox = resting("SymplecticEuler");
        if changes {
            switch_damping(&mut sandbox, false);
            switch_damping(&mut sandbox, true);
            with_obstacles(&mut sandbox, |obstacles| drop(obstacles.remove(0)));
            sandbox.apply(Command::Undo).unwrap();
        }
        sandbox.apply(Command::Rewind(0.5)).unwrap();
        run(&mut sandbox, 0.3);
        sandbox.simulation().state().hash()
    });
    assert_eq!(hashes[0], hashes[1]);
    let mut sandbox = resting("SymplecticEuler");
    with_obstacles(&mut sandbox, |obstacles| drop(obstacles.remove(0)));
    sandbox.apply(Command::Rewind(0.5)).unwrap();
    run(&mut sandbox, 0.3);
    assert!(greatest_speed(&sandbox) < 0.5, "{}", greatest_speed(&sandbox));
    hashes[0] = sandbox.simulation().state().hash();
    assert!(hashes[0] != hashes[1], "its contacts began anew");
}

/// Contacts keep their memory when obstacles before or behind theirs come and go, and when other effects do.
#[test]
fn a_body_goes_on_resting_while_the_list_of_obstacles_changes() {
    for integrator in ["SymplecticEuler", "ImplicitEuler", "RungeKutta4"] {
        let mut alone = resting(integrator);
        let mut changed = resting(integrator);
        let before = changed.simulation().state().x.clone();
        for change in 0..4 {
            match change {
                0 => with_obstacles(&mut changed, |obstacles| drop(obstacles.remove(0))),
                1 => with_obstacles(&mut changed, |obstacles| {
                    let far = Similarity { to: [5.0, 0.0, 0.0], ..Similarity::NONE };
                    obstacles.push(obstacles[0].arranged(&far).unwrap());
                }),
                2 => {
                    switch_damping(&mut changed, false);
                    let (anchors, contacts) =
                        (&changed.simulation().state().anchors, &alone.simulation().state().anchors);
                    assert_eq!(anchors.len(), contacts.len());
                    switch_damping(&mut changed, true);
                }
                _ => changed.apply(Command::Undo).unwrap(),
            }
            run(&mut changed, 0.1);
            run(&mut alone, 0.1);
            let [one, other] = [&changed, &alone].map(|sandbox| &sandbox.simulation().state().x);
            let apart = one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart < 1e-7, "{integrator}, change {change}: {apart}");
        }
        let [now, then] = [&changed.simulation().state().x, &before];
        let gone = now.iter().zip(then).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(gone < 1e-3, "{integrator}: it did not drop, {gone}");
    }
}

/// Lifts all obstacles by a length \[m\].
fn lift(sandbox: &mut Sandbox, by: f64) {
    let by = Similarity { to: [0.0, by, 0.0], ..Similarity::NONE };
    with_obstacles(sandbox, |obstacles| {
        for obstacle in obstacles {
            *obstacle = obstacle.arranged(&by).unwrap();
        }
    });
}

/// What an obstacle is moved into comes out slowly, also where it touched that before, and at the start as if the level had been so.
#[test]
fn a_body_is_not_shot_away_by_an_obstacle_that_is_moved_into_it() {
    for integrator in ["SymplecticEuler", "ImplicitEuler"] {
        let mut sandbox = resting(integrator);
        let contact = |sandbox: &Sandbox| sandbox.simulation().energies().contact;
        let before = contact(&sandbox);
        lift(&mut sandbox, 0.05);
        let after = contact(&sandbox);
        // What is inside begins without a force, apart from a corner at the edges beside its nearest one. With the forces of the whole depth it would be 377 J.
        assert!(before > 0.0 && after < 10.0, "{integrator}: {before} to {after} J");
        for piece in 0..20 {
            run(&mut sandbox, 0.05);
            // Without another effect the walls have another number.
            switch_damping(&mut sandbox, piece % 2 == 1);
            // Half of the wave speed. It is pushed out at a tenth of that, and a strain of 0.05 / 0.2 gives a quarter.
            assert!(greatest_speed(&sandbox) < 7.0, "{integrator}: {}", greatest_speed(&sandbox));
        }
        // In small steps, as a drag of the number makes them.
        sandbox.apply(Command::Undo).unwrap();
        sandbox.apply(Command::Reset).unwrap();
        for _ in 0..10 {
            lift(&mut sandbox, 0.005);
        }
        assert!(!sandbox.simulation().state().anchors.is_empty());
        run(&mut sandbox, 0.01);
        let dragged = sandbox.simulation().state().hash();
        sandbox.apply(Command::Reset).unwrap();
        run(&mut sandbox, 0.01);
        assert_eq!(sandbox.simulation().state().hash(), dragged, "{integrator}");
    }
}

/// The last obstacle goes as any other, in the plane and in space, and comes back by undo.
#[test]
fn all_obstacles_can_be_removed() {
    for name in ["cornell_sphere", "jelly_disk"] {
        let text = gingerbread::levels::built_in(name).unwrap();
        let mut sandbox = Sandbox::new(gingerbread::files::parse(text, name).unwrap(), Box::new(NoFiles)).unwrap();
        sandbox.apply(Command::SetMode(Mode::Collide)).unwrap();
        let number =
            sandbox.document().level.effects.iter().position(|e| !e.effect.kind().obstacles().is_empty()).unwrap();
        let count = sandbox.document().level.effects[number].effect.kind().obstacles().len();
        for _ in 0..count {
            let mut effect = sandbox.document().level.effects[number].clone();
            drop(effect.effect.kind_mut().obstacles_mut().unwrap().pop());
            sandbox.apply(Command::SetEffect(number, effect)).unwrap();
            sandbox.apply(Command::EndGesture).unwrap();
            sandbox.advance(5, &mut || true);
        }
        for _ in 0..count {
            sandbox.apply(Command::Undo).unwrap();
        }
        assert_eq!(sandbox.document().level.effects[number].effect.kind().obstacles().len(), count, "{name}");
    }
}

/// Nets and membranes in space are moved with their pins, and come back by undo.
#[test]
fn what_is_in_space_is_put_elsewhere() {
    let mut parts = 0;
    for name in ["flag", "princeton_cloth", "gelatin", "tablecloth", "cornell_cloth"] {
        let Some(text) = gingerbread::levels::built_in(name) else { continue };
        let mut sandbox = Sandbox::new(gingerbread::files::parse(text, name).unwrap(), Box::new(NoFiles)).unwrap();
        let level = sandbox.document().level.clone();
        for part in 0..level.nets.len() + level.membranes.len() {
            let seen = |sandbox: &Sandbox| {
                let scene = sandbox.simulation().scene();
                (scene.rest.clone(), scene.pins.to_vec(), scene.parts[part].vertices())
            };
            let (rest, pins, own) = seen(&sandbox);
            let mut place = *sandbox.document().level.clone().space_mut(part).unwrap();
            let [x, y, z] = place.offset.get();
            place.offset = gingerbread::quantity::SpacePoint::new([x + 0.5, y - 0.25, z + 2.0]).unwrap();
            sandbox.apply(Command::SetSpacePlace(part, place)).unwrap();
            sandbox.apply(Command::EndGesture).unwrap();
            let (moved, pinned, _) = seen(&sandbox);
            assert_eq!(pinned, pins, "{name}");
            for (number, (now, before)) in moved.iter().zip(&rest).enumerate() {
                let by = if own.contains(&(number / 3)) { [0.5, -0.25, 2.0][number % 3] } else { 0.0 };
                assert!((now - before - by).abs() <= 1e-14 * before.abs().max(1.0), "{name} {number}");
            }
            sandbox.advance(2, &mut || true);
            sandbox.apply(Command::Undo).unwrap();
            assert_eq!(seen(&sandbox).0, rest, "{name}");
            parts += 1;
        }
        let beyond = level.nets.len() + level.membranes.len();
        assert!(sandbox.apply(Command::SetSpacePlace(beyond, SpacePlace::default())).is_err(), "{name}");
    }
    assert!(parts >= 3);
}

/// A cloth twice as large has twice the lengths at rest, in its springs too; its pins stay, by whatever they are named.
#[test]
fn cloth_is_scaled_with_its_pins_and_without_stress() {
    for (name, pins) in
        [("flag", "Left"), ("mit_cloth", "Disk((0.2, 0), 0.25)"), ("toronto_cloth", "Box((0, 0), (0.3, 0.3))")]
    {
        let mut level = gingerbread::files::parse(gingerbread::levels::built_in(name).unwrap(), name).unwrap();
        let pins: gingerbread::meshes::Pin = gingerbread::files::parse_as(pins, "pin").unwrap();
        level.nets.iter_mut().for_each(|net| net.pins = vec![pins]);
        level.membranes.iter_mut().for_each(|membrane| membrane.pins = vec![pins]);
        let mut sandbox = Sandbox::new(level, Box::new(NoFiles)).unwrap();
        let scene = |sandbox: &Sandbox| {
            let scene = sandbox.simulation().scene();
            (scene.rest.clone(), scene.pins.to_vec(), sandbox.simulation().energies().elastic)
        };
        let (rest, pinned, elastic) = scene(&sandbox);
        assert!(!pinned.is_empty(), "{name}");
        let before = *sandbox.document().level.space(0).unwrap();
        let [x, y, z] = before.offset.get();
        let place = SpacePlace { scale: Factor::new(2.0 * before.scale.get()).unwrap(), ..before };
        sandbox.apply(Command::SetSpacePlace(0, place)).unwrap();
        sandbox.apply(Command::EndGesture).unwrap();
        let (now, still, stored) = scene(&sandbox);
        assert_eq!(still, pinned, "{name}");
        for (vertex, (now, before)) in now.as_chunks::<3>().0.iter().zip(rest.as_chunks::<3>().0).enumerate() {
            let wanted = [0, 1, 2].map(|axis| 2.0 * before[axis] - [x, y, z][axis]);
            assert!((0..3).all(|axis| (now[axis] - wanted[axis]).abs() < 1e-12), "{name} {vertex}: {now:?} {wanted:?}");
        }
        assert!(stored <= 4.0 * elastic + 1e-12, "{name}: {stored} {elastic}");
        sandbox.apply(Command::Undo).unwrap();
        assert_eq!(scene(&sandbox).0, rest, "{name}");
    }
}

/// A similarity transform of a place maps every point of the cloth as it maps points of space, also where two of its angles turn about one axis.
#[test]
fn a_place_in_space_is_transformed_like_its_points() {
    let angle = |degrees: f64| Angle::new(degrees).unwrap();
    for turns in [[0.0, 0.0, 0.0], [-90.0, 0.0, 0.0], [20.0, -35.0, 110.0], [15.0, 90.0, 40.0], [-60.0, -90.0, 10.0]] {
        let [about_x, about_y, about_z] = turns.map(angle);
        let place = SpacePlace {
            scale: Factor::new(0.7).unwrap(),
            turn: (about_x, about_y, about_z),
            offset: gingerbread::quantity::SpacePoint::new([0.3, -0.2, 0.9]).unwrap(),
            ..SpacePlace::default()
        };
        for axis in 0..3 {
            let by = Similarity { from: [0.1, 0.5, -0.3], to: [-0.4, 0.2, 0.6], scale: 1.6, turn: 75.0, axis };
            let arranged = place.arranged(&by).unwrap();
            for point in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.4, -0.7]] {
                let scaled = |place: &SpacePlace| place.placed(point.map(|along| place.scale.get() * along));
                let (wanted, now) = (by.point(scaled(&place)), scaled(&arranged));
                let all = now.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-9);
                assert!(all, "{turns:?} about axis {axis}: {now:?} {wanted:?}");
            }
        }
    }
}

/// Nets and membranes in space are copied beside everything and removed; a net in the plane has no place of its own.
#[test]
fn cloth_is_copied_and_removed() {
    for name in ["tablecloth", "cornell_cloth", "mit_cloth"] {
        let mut sandbox = Sandbox::new(
            gingerbread::files::parse(gingerbread::levels::built_in(name).unwrap(), name).unwrap(),
            Box::new(NoFiles),
        )
        .unwrap();
        let parts = |sandbox: &Sandbox| sandbox.document().level.part_names().cloned().collect::<Vec<_>>();
        let (before, pins) = (parts(&sandbox), sandbox.simulation().scene().pins.len());
        sandbox.apply(Command::CopyPart(0)).unwrap();
        assert_eq!(parts(&sandbox).len(), before.len() + 1, "{name}");
        let scene = sandbox.simulation().scene();
        let ends = |part: usize| {
            let own = scene.rest[scene.numbers(&scene.parts[part].vertices())].iter().step_by(3).copied();
            [own.clone().fold(f64::INFINITY, f64::min), own.fold(f64::NEG_INFINITY, f64::max)]
        };
        let copy = parts(&sandbox).iter().position(|part| !before.contains(part)).unwrap();
        assert!((0..=before.len()).filter(|part| *part != copy).all(|part| ends(copy)[0] > ends(part)[1]), "{name}");
        assert_eq!(scene.pins.len(), 2 * pins, "{name}: it is pinned like it");
        sandbox.apply(Command::RemovePart(0)).unwrap();
        assert_eq!(sandbox.simulation().scene().pins.len(), pins, "{name}");
        sandbox.apply(Command::Undo).unwrap();
        sandbox.apply(Command::Undo).unwrap();
        assert_eq!(parts(&sandbox), before, "{name}");
    }
    // What is flat across x gets a copy beside it, not on it.
    let mut level =
        gingerbread::files::parse(gingerbread::levels::built_in("tablecloth").unwrap(), "tablecloth").unwrap();
    level.membranes[0].space.turn = (Angle::new(0.0).unwrap(), Angle::new(90.0).unwrap(), Angle::new(0.0).unwrap());
    let mut sandbox = Sandbox::new(level, Box::new(NoFiles)).unwrap();
    sandbox.apply(Command::CopyPart(0)).unwrap();
    let offset = |part: usize| sandbox.document().level.space(part).unwrap().offset.get()[0];
    assert!(offset(1) - offset(0) > 0.1, "{}", offset(1) - offset(0));
    let text = gingerbread::levels::built_in("hanging_net").unwrap();
    let mut sandbox = Sandbox::new(gingerbread::files::parse(text, "hanging_net").unwrap(), Box::new(NoFiles)).unwrap();
    let why = sandbox.apply(Command::CopyPart(0)).unwrap_err().to_string();
    assert!(why.contains("net in the plane"), "{why}");
    assert!(sandbox.apply(Command::RemovePart(7)).is_err());
}

#[test]
fn a_cloth_too_small_for_numbers_is_refused_in_words() {
    let text = gingerbread::levels::built_in("flag").unwrap();
    let mut sandbox = Sandbox::new(gingerbread::files::parse(text, "flag").unwrap(), Box::new(NoFiles)).unwrap();
    let before = *sandbox.document().level.space(0).unwrap();
    let place = SpacePlace { scale: Factor::new(1e-200).unwrap(), ..before };
    let why = sandbox.apply(Command::SetSpacePlace(0, place)).unwrap_err().to_string();
    assert!(why.contains("no area"), "{why}");
    assert_eq!(*sandbox.document().level.space(0).unwrap(), before, "the scene stays");
}

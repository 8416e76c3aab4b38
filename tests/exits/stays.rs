//! What a pin keeps inside, or what has no room beyond.

use super::{common::simulation, disk, leave, walls};
use gingerbread::{level::Pin, obstacles::Inside, quantity::Point};

/// Pushed out past its own pin it would be torn: also where the pin is in the very middle of a ball, or beside it.
#[test]
fn what_a_pin_keeps_inside_a_solid_stays_there_unharmed() {
    for [x, y] in [[0.47, 0.49], [0.5, 0.5], [0.62, 0.55]] {
        let ball = walls(&format!("Ball(centre: ({x:?}, {y:?}), radius: 0.1, eps: 0.005)"));
        let mut level = disk([0.5, 0.5], ("SymplecticEuler", 20), "NeoHookean", &ball);
        level.bodies[0].pins = vec![Pin::Nearest(Point::new([0.5, 0.5]).unwrap())];
        let mut simulation = simulation(&level);
        let (least, most) = leave(&mut simulation, 1.0);
        assert!(simulation.count_inside() > 5 && least > 0.5, "ball at ({x}, {y}): least J {least}");
        assert!(most < 0.02 && simulation.fault().is_none(), "ball at ({x}, {y}): {most} J");
        assert_eq!((simulation.inside(), simulation.counts().pushed_out), (Inside::Stays, 0));
    }
}

/// Carried along by what moves it would be torn from its pin.
#[test]
fn what_a_pin_keeps_inside_of_what_moves_is_passed_over() {
    let moving = walls(
        "Moving(obstacle: Ball(centre: (0.5, 0.5), radius: 0.1, eps: 0.005), motions: [Slide(velocity: (20, 0))])",
    );
    let mut level = disk([0.5, 0.5], ("SymplecticEuler", 20), "NeoHookean", &moving);
    level.bodies[0].pins = vec![Pin::Nearest(Point::new([0.5, 0.5]).unwrap())];
    let mut simulation = simulation(&level);
    simulation.advance(4, &mut || true);
    assert_eq!(simulation.inside(), Inside::Stays);
    assert!(simulation.inversion().0 > 0.5, "least J {}", simulation.inversion().0);
}

/// Flattened in a gap of half its size, or between walls that face each other, it would be crushed.
#[test]
fn what_has_no_room_beyond_stays_inside_unharmed() {
    let shelf =
        "effects: [(effect: Walls(obstacles: [Cuboid(centre: (0.475, 0.54), width: 0.6, height: 0.42, eps: 0.003)])),
        (effect: Boundary(least: (0, 0.1), greatest: (1, 0.95)))]";
    let facing = walls(
        "Plane(point: (0.55, 0), normal: (1, 0), eps: 0.003), Plane(point: (0.4, 0), normal: (-1, 0.1), eps: 0.003)",
    );
    let small = "effects: [(effect: Boundary(least: (0.4, 0), greatest: (0.6, 1)))]";
    for scheme in [("SymplecticEuler", 20), ("ImplicitEuler", 4)] {
        for effects in [shelf, facing.as_str(), small] {
            let mut simulation = simulation(&disk([0.5, 0.5], scheme, "NeoHookean", effects));
            let inside = simulation.count_inside();
            let (least, most) = leave(&mut simulation, 1.0);
            let what = format!("{effects} under {}", scheme.0);
            assert!(simulation.fault().is_none() && least > 0.9, "{what}: least J {least}, {:?}", simulation.fault());
            assert!(most < 0.02, "{what}: {most} J");
            assert_eq!((simulation.inside(), simulation.count_inside()), (Inside::Stays, inside), "{what}");
        }
    }
}

#[test]
fn what_is_pinned_inside_stays_there_and_the_rest_comes_out() {
    let text = walls("Plane(point: (0, 0.4), normal: (0, 1), eps: 0.005)");
    let mut level = disk([0.5, 0.5], ("SymplecticEuler", 20), "Corotated", &text);
    level.bodies[0].pins = vec![Pin::Bottom];
    let mut simulation = simulation(&level);
    let pinned = simulation.scene().pins.len();
    leave(&mut simulation, 2.0);
    assert!(simulation.fault().is_none(), "{:?}", simulation.fault());
    assert_eq!(simulation.count_inside(), pinned);
    assert!(!simulation.pushes_out(), "what is pinned is not on its way out");
}

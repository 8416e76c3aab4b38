//! Bodies that are moved, turned, scaled and copied in the window keep what names their vertices.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a failing test should panic")]

use crate::common::level;
use gingerbread::{
    command::Command,
    level::Place,
    meshes::NoFiles,
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
    sandbox.apply(Command::CopyBody(0)).unwrap();
    sandbox.apply(Command::CopyBody(0)).unwrap();
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

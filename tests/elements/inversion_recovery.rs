//! Folds are found, and undone.
#![allow(clippy::unwrap_used, clippy::float_cmp, reason = "a failing test should panic; what stays must be equal")]

use crate::common::{Random, level, models, simulation};
use gingerbread::{
    elements::ElementKind,
    inversion_recovery::{Tangle, untangled},
    simulation::Simulation,
    state::State,
};

const PINNED: &str = "pins: [Left, Right]";

/// A disk and, beside it, a sheet with more fields.
fn scene(model: &str, sheet: &str) -> Simulation {
    simulation(&level(&format!(
        "(name: \"two\", substeps: 20, bodies: [
            (name: \"disk\", mesh: Disk(radius: 0.2, rings: 5), mass: Density(1),
             material: (model: {model}, young: 100, poisson: 0.3, plane: Strain), place: (turn: 30, offset: (0.1, 0.2))),
            (name: \"sheet\", mesh: Rectangle(width: 0.6, height: 0.3, columns: 8, rows: 4), mass: Total(2),
             material: (model: {model}, young: 100, poisson: 0.3, plane: Strain), {sheet})])"
    )))
}

/// Every vertex of a body anywhere in the unit square.
fn scramble(simulation: &Simulation, body: usize, seed: u64) -> State {
    let (mut state, mut random) = (simulation.state().clone(), Random(seed));
    let vertices = &simulation.scene().bodies[body].vertices;
    for number in 2 * vertices.start..2 * vertices.end {
        if simulation.scene().inverse_mass[number] > 0.0 {
            state.x[number] = random.between(0.0, 1.0);
            state.v[number] = random.between(-1.0, 1.0);
        }
    }
    state
}

/// Momentum and angular momentum of the first body.
fn momenta(simulation: &Simulation, state: &State) -> [f64; 3] {
    let vertices = simulation.scene().bodies[0].vertices.clone();
    vertices.fold([0.0; 3], |[px, py, l], vertex| {
        let mass = simulation.scene().mass[2 * vertex];
        let ([x, y], [vx, vy]) =
            ([0, 1].map(|axis| state.x[2 * vertex + axis]), [0, 1].map(|axis| state.v[2 * vertex + axis]));
        [px + mass * vx, py + mass * vy, l + mass * (x * vy - y * vx)]
    })
}

#[test]
fn double_winding_is_told_from_rotation_and_stretch() {
    let simulation = scene("NeoHookean", "");
    let scene = simulation.scene();
    let disk = &scene.bodies[0];
    let centre = [scene.rest[2 * disk.vertices.start], scene.rest[2 * disk.vertices.start + 1]];
    let mapped = |map: &dyn Fn(f64, f64) -> [f64; 2]| {
        let mut x = scene.rest.clone();
        for vertex in disk.vertices.clone() {
            let [dx, dy] = map(x[2 * vertex] - centre[0], x[2 * vertex + 1] - centre[1]);
            (x[2 * vertex], x[2 * vertex + 1]) = (centre[0] + dx, centre[1] + dy);
        }
        Tangle::of(scene, disk, &x)
    };
    for turn in 0..36 {
        let (s, c) = (f64::from(turn) * 10.0).to_radians().sin_cos();
        let turned = mapped(&|x, y| [3.0 * (c * x - s * y), 3.0 * (s * x + c * y)]);
        assert!(!turned.is_some(), "{turn}: {turned:?}");
        let mirrored = mapped(&|x, y| [c * x + s * y, s * x - c * y]);
        assert_eq!(mirrored.inverted, disk.elements.corners().len());
        // Twice the angle at the same distance.
        let twice = mapped(&|x, y| {
            let r = x.hypot(y).max(1e-300);
            let (x, y) = (c * x - s * y, s * x + c * y);
            [(x * x - y * y) / r, 2.0 * x * y / r]
        });
        assert_eq!(twice, Tangle { wound: 1, ..Tangle::default() });
    }
}

/// It has its rest shape, and the other bodies stay.
#[test]
fn an_untangled_free_body_keeps_its_momentum() {
    for model in models() {
        for seed in 0..20 {
            let simulation = scene(model, "");
            let tangled = scramble(&simulation, 0, seed);
            let free = untangled(simulation.scene(), &tangled).unwrap();
            for (before, after) in momenta(&simulation, &tangled).into_iter().zip(momenta(&simulation, &free)) {
                assert!((before - after).abs() < 1e-13, "{model} {seed}: {before} {after}");
            }
            let own = 2 * simulation.scene().bodies[1].vertices.start..;
            assert!(free.x[own.clone()] == tangled.x[own.clone()] && free.v[own.clone()] == tangled.v[own]);
            let mut home = scene(model, "");
            home.set_state(free);
            assert!(home.energies().elastic < 1e-15, "{model} {seed}: {:?}", home.energies());
            assert_eq!(untangled(home.scene(), home.state()), None, "nothing is left to untangle");
        }
    }
}

#[test]
fn an_untangled_held_body_is_spread_between_its_pins() {
    for model in models() {
        for (sheet, seed) in
            [(PINNED, 1), (PINNED, 2), ("pins: [Vertex(7)]", 3), ("slides: [Left, Bottom]", 4), ("slides: [Top]", 5)]
        {
            let simulation = scene(model, sheet);
            let tangled = scramble(&simulation, 1, seed);
            let free = untangled(simulation.scene(), &tangled).unwrap();
            assert_eq!(Tangle::of_all(simulation.scene(), &free.x), Tangle::default(), "{model} {sheet}");
            for (number, inverse_mass) in simulation.scene().inverse_mass.iter().enumerate() {
                assert!(
                    *inverse_mass > 0.0 || free.x[number] == tangled.x[number],
                    "{model} {sheet}: what is held stays"
                );
            }
            let mut home = scene(model, sheet);
            home.set_state(free);
            // Pins where they are at rest ask for the rest shape, to the round-off of the solution.
            assert!(sheet != PINNED || home.energies().elastic < 1e-15, "{model} {sheet}: {:?}", home.energies());
        }
    }
}

#[test]
fn pins_that_are_pulled_apart_stretch_the_body_evenly() {
    for kind in ElementKind::ALL {
        let simulation = scene("StableNeoHookean", &format!("{PINNED}, element: {kind:?}"));
        let (scene, mut state) = (simulation.scene(), scramble(&simulation, 1, 9));
        let body = &scene.bodies[1];
        let right = scene.pins.iter().filter(|pin| scene.rest[2 * **pin as usize] > 0.5);
        right.for_each(|pin| state.x[2 * *pin as usize] += 0.6);
        let free = untangled(scene, &state).unwrap();
        let widest = body.elements.gradients(&free.x).map(|(f, _)| f.m11).fold(0.0, f64::max);
        let least = body.elements.gradients(&free.x).map(|(f, _)| f.m11).fold(f64::INFINITY, f64::min);
        assert!((1.9..=2.0).contains(&least) && (2.0..2.1).contains(&widest), "{kind:?}: {least} {widest}");
    }
}

/// Nearly incompressible, pressed flat and let go: it comes to rest in a crease at the neck, without a fold.
#[test]
fn a_metastable_body_is_counted_and_comes_home() {
    let mut creased = simulation(&level(
        "(name: \"creased\", mode: Collide, substeps: 1, integrator: ImplicitEuler(), sleep: Off, bodies: [
            (name: \"man\", mesh: Gingerbread(resolution: 128), stretch: (1, 0.01), mass: Density(100),
             material: (model: FixedCorotated, young: 1000, poisson: 0.4999, plane: Strain))],
            effects: [(effect: Rayleigh(mass: 10))])",
    ));
    creased.advance(600, &mut || true);
    let (scene, state) = (creased.scene(), creased.state());
    assert!(creased.energies().elastic > 1.0 && creased.energies().kinetic < 1e-9, "{:?}", creased.energies());
    assert_eq!(Tangle::of_all(scene, &state.x), Tangle { metastable: 1, ..Tangle::default() });
    let home = untangled(scene, state).unwrap();
    assert!(scene.bodies[0].elements.elastic_energy(&home.x) < 1e-12);
}

/// Loads, pins, contact and motion hold bodies in deformed shapes too.
#[test]
fn a_body_that_is_held_or_moves_is_not_metastable() {
    let man = "name: \"man\", mesh: Gingerbread(resolution: 128), mass: Density(10)";
    let soft = "(model: StableNeoHookean, young: 300, poisson: 0.3, plane: Strain)";
    for (body, rest) in [
        ("", ""),
        ("pins: [Top]", "effects: [(effect: Gravity(down: 9.81)), (effect: Rayleigh(mass: 5))]"),
        ("pins: [Vertex(3)], slides: [Left]", "effects: [(effect: Gravity(down: 9.81)), (effect: Rayleigh(mass: 5))]"),
        ("stretch: (1.5, 0.5)", ""),
        (
            "stretch: (1.5, 0.5), spin: 5",
            "effects: [(effect: Gravity(down: 9.81)), (effect: Boundary(least: (-1, -1), greatest: (2, 2)))]",
        ),
        (
            "",
            "effects: [(effect: Gravity(down: 9.81)), (effect: Contact()), (effect: Boundary(least: (-1, -1), greatest: (2, 2))), (effect: Rayleigh(mass: 5))]",
        ),
    ] {
        let comma = if body.is_empty() { "" } else { ", " };
        let text = format!(
            "(name: \"held\", mode: Collide, substeps: 1, integrator: ImplicitEuler(), sleep: Off,
              bodies: [({man}, material: {soft}{comma}{body})], {rest})"
        );
        let mut held = simulation(&level(&text));
        for frame in 0..180 {
            assert_eq!(Tangle::of_all(held.scene(), &held.state().x).metastable, 0, "frame {frame} of {body} {rest}");
            held.advance(1, &mut || true);
        }
    }
}

//! What a person does to nets and toys: pins, pulls, sliders, undo, saving.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{level, seen};
use gingerbread::{
    command::{Command, Mode},
    integrators::{IntegratorKind, Scheme},
    level::{Level, Pin},
    meshes::NoFiles,
    nets::NetKind,
    quantity::{ParticleMass, Radius, Spring},
    sandbox::Sandbox,
    toys::{Circle, ToyKind},
};

const TWO: &str = "(name: \"two\",
    bodies: [(name: \"sheet\", mesh: Rectangle(width: 0.2, height: 0.2, columns: 2, rows: 2, diagonals: Grid), mass: Total(1),
        material: (model: Corotated, young: 100, poisson: 0.3))],
    nets: [(name: \"chain\", net: Chain(from: (0.5, 0.9), to: (0.8, 0.9), springs: 3, stiffness: 100, rest: 0.08), mass: 1,
        pins: [Left])],
    effects: [(effect: Gravity(down: 3)), (effect: MouseSpring(stiffness: 50))])";

fn sandbox(text: &str) -> Sandbox {
    Sandbox::new(level(text), Box::new(NoFiles)).unwrap()
}

#[test]
fn particles_are_pinned_freed_and_undone_like_vertices() {
    let mut sandbox = sandbox(TWO);
    assert_eq!(*seen(&sandbox).pins, [9]);
    sandbox.apply(Command::TogglePin(12)).unwrap();
    sandbox.apply(Command::TogglePin(3)).unwrap();
    assert_eq!(*seen(&sandbox).pins, [3, 9, 12]);
    let saved = sandbox.saved();
    assert_eq!(
        (&saved.nets[0].pins[..], &saved.bodies[0].pins[..]),
        (&[Pin::Vertex(0), Pin::Vertex(3)][..], &[Pin::Vertex(3)][..])
    );
    sandbox.apply(Command::TogglePin(9)).unwrap();
    assert_eq!(*seen(&sandbox).pins, [3, 12]);
    sandbox.apply(Command::Undo).unwrap();
    sandbox.apply(Command::Undo).unwrap();
    assert_eq!(*seen(&sandbox).pins, [9, 12]);
    sandbox.apply(Command::ClearPins).unwrap();
    assert!(seen(&sandbox).pins.is_empty());
    assert!(sandbox.apply(Command::TogglePin(13)).is_err());
}

#[test]
fn a_particle_is_pulled_and_a_reset_puts_the_net_back() {
    let mut sandbox = sandbox(TWO);
    let start = seen(&sandbox);
    assert_eq!((start.nets[0].name.as_str(), start.nets[0].vertices.clone()), ("chain", 9..13));
    assert_eq!(start.nets[0].springs.links()[2].ends, [11, 12]);
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    sandbox.apply(Command::Grab(12, [0.9, 0.2, 0.0])).unwrap();
    sandbox.advance(200, &mut || true);
    let pulled = seen(&sandbox);
    assert!(pulled.pull.unwrap().force > 0.0 && pulled.positions[25] < start.positions[25]);
    assert!(pulled.energies.elastic > 0.0 && pulled.nets[0].energy > 0.0);
    sandbox.apply(Command::Reset).unwrap();
    assert_eq!(seen(&sandbox).positions, start.positions);
}

/// One drag of a slider is one step of undo.
#[test]
fn springs_and_mass_can_change_while_time_runs() {
    let mut sandbox = sandbox(TWO);
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    sandbox.advance(100, &mut || true);
    let before = seen(&sandbox);
    for stiffness in [200.0, 300.0] {
        let NetKind::Chain(mut chain) = before.level.nets[0].net.clone() else { unreachable!("the level has a chain") };
        chain.stiffness = Spring::new(stiffness).unwrap();
        sandbox.apply(Command::SetNet(0, NetKind::Chain(chain), ParticleMass::new(2.0).unwrap())).unwrap();
    }
    let after = seen(&sandbox);
    assert_eq!((&after.positions, after.time, after.generation), (&before.positions, before.time, before.generation));
    assert_eq!(after.nets[0].springs.links()[0].stiffness, 300.0);
    assert_eq!(sandbox.simulation().scene().mass[2 * 9], 2.0);
    sandbox.apply(Command::Undo).unwrap();
    assert_eq!(seen(&sandbox).level, before.level);
    assert!(sandbox.apply(Command::SetNet(1, before.level.nets[0].net.clone(), before.level.nets[0].mass)).is_err());
}

/// Its faults can be told.
#[test]
fn a_level_without_triangles_has_none_inverted() {
    let text =
        "(name: \"\", substeps: 1, guard: Off, nets: [(name: \"wire\", net: Chain(from: (0, 0), to: (1, 0), springs: 2,
        stiffness: 1e6, rest: 0.4), mass: 1)])";
    let mut sandbox = sandbox(text);
    let now = seen(&sandbox);
    assert!(now.triangles.is_empty() && now.inverted == 0 && now.bodies.is_empty());
    for command in
        [Command::SetModel(gingerbread::materials::Model::NeoHookean), Command::SetDamping(true), Command::Undo]
    {
        sandbox.apply(command).unwrap();
    }
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    sandbox.advance(100_000, &mut || true);
    assert!(seen(&sandbox).fault.unwrap().to_string().contains("wire"));
}

/// A change of its numbers starts it over.
#[test]
fn a_toy_cannot_be_pinned_pulled_or_damped() {
    let of_rates = |kind: &IntegratorKind| matches!(kind.kind().scheme(), Scheme::First(_));
    let integrator = IntegratorKind::all().into_iter().find(of_rates).unwrap();
    let toy = Level { integrator, ..level("(name: \"toy\", toy: Circle(radius: 0.2))") };
    let mut sandbox = Sandbox::new(toy, Box::new(NoFiles)).unwrap();
    sandbox.apply(Command::SetDamping(true)).unwrap();
    assert!(sandbox.saved().effects.is_empty() && !seen(&sandbox).can_undo);
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    assert!(sandbox.apply(Command::TogglePin(0)).is_err() && sandbox.apply(Command::Grab(0, [0.0; 3])).is_err());
    sandbox.advance(100, &mut || true);
    let now = seen(&sandbox);
    let shown = now.toy.unwrap();
    assert!(now.positions.is_empty() && now.energies.total() > 0.0 && shown.path.1 && shown.at != [0.7, 0.5]);
    sandbox.apply(Command::SetToy(ToyKind::Circle(Circle { radius: Radius::new(0.3).unwrap() }))).unwrap();
    let wider = seen(&sandbox);
    assert_eq!((wider.time, wider.toy.unwrap().at), (0.0, [0.8, 0.5]));
    sandbox.apply(Command::Undo).unwrap();
    let back = seen(&sandbox);
    assert_eq!((back.time, back.toy.unwrap().at), (now.time, shown.at));
}

//! What the window draws from.
#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "a failing test should panic; what is computed once is equal"
)]

mod common;

use common::sheet;
use gingerbread::{
    command::{Command, Mode},
    meshes::NoFiles,
    sandbox::Sandbox,
    snapshot::{Field, Snapshot},
};

#[test]
fn what_is_drawn_of_a_state_is_computed_once_however_often_it_is_drawn() {
    let effects = "effects: [(effect: MouseSpring(stiffness: 50))]";
    let level = sheet("Corotated", "stretch: (1.2, 1)", effects);
    let mut sandbox = Sandbox::new(level, Box::new(NoFiles)).unwrap();
    let mut snapshot = Snapshot::default();
    for _ in 0..5 {
        sandbox.snapshot(Field::VonMises, &mut snapshot);
    }
    assert_eq!(snapshot.sweeps, 2, "one sweep for energies, one for shapes and stress");
    sandbox.snapshot(Field::None, &mut snapshot);
    assert_eq!((snapshot.sweeps, snapshot.values.len()), (4, 0), "stress is not computed where it is not shown");
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    sandbox.advance(7, &mut || true);
    sandbox.snapshot(Field::Volume, &mut snapshot);
    let (energies, (min_j, inverted)) = (sandbox.simulation().energies(), sandbox.simulation().inversion());
    assert_eq!((snapshot.energies, snapshot.min_j, snapshot.inverted), (energies, min_j, inverted));
    assert_eq!(snapshot.values.iter().copied().fold(f64::INFINITY, f64::min), min_j);
    let sweeps = snapshot.sweeps;
    sandbox.apply(Command::Grab(0, [0.5, 0.5])).unwrap();
    sandbox.snapshot(Field::Volume, &mut snapshot);
    assert_eq!(
        (snapshot.sweeps, snapshot.energies),
        (sweeps + 2, sandbox.simulation().energies()),
        "a pull stores energy"
    );
}

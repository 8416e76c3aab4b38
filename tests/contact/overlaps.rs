//! Facts about bodies that begin deep inside each other: they are moved apart as they are, and touch from then on.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{continues_bit_for_bit, level, reopened, simulation};
use gingerbread::{
    hard::Account,
    integrators::{Class, IntegratorKind},
    level::{Level, Substeps},
    simulation::Simulation,
};

const MATERIAL: &str =
    "material: (model: StableNeoHookean, young: 1000, poisson: 0.3, plane: Strain), mass: Density(100)";

/// A block with another body inside it or through it, and more fields.
fn overlapped(scheme: &str, body: &str, more: &str) -> Level {
    level(&format!(
        "(name: \"\", integrator: {scheme}(), substeps: 16, bodies: [
            (name: \"block\", {MATERIAL}, mesh: Rectangle(width: 0.4, height: 0.3, columns: 4, rows: 3, diagonals: Alternating,
                corner: (0.3, 0.3))),
            (name: \"other\", {MATERIAL}, {body})],
        effects: [(effect: Contact()), {more}])"
    ))
}

const DISK: &str = "mesh: Disk(centre: (0.45, 0.43), radius: 0.06, rings: 2)";
const BAR: &str =
    "mesh: Rectangle(width: 0.8, height: 0.1, columns: 8, rows: 1, diagonals: Alternating, corner: (0.1, 0.42))";
const MAN: &str = "mesh: Gingerbread(resolution: 150)";

fn middle(simulation: &Simulation, body: usize) -> [f64; 2] {
    let vertices = &simulation.scene().bodies[body].vertices;
    let count = vertices.len() as f64;
    [0, 1].map(|axis| vertices.clone().map(|vertex| simulation.state().x[2 * vertex + axis]).sum::<f64>() / count)
}

#[test]
fn bodies_inside_each_other_come_apart_as_they_are() {
    for kind in IntegratorKind::all() {
        // It gains energy without damping at every step.
        let damping = if kind.name() == "ForwardEuler" { "(effect: Rayleigh(mass: 20))" } else { "" };
        for body in [DISK, BAR, MAN] {
            let mut run = simulation(&overlapped(kind.name(), body, damping));
            let centre = |run: &Simulation| {
                let masses = [0, 1].map(|body| {
                    run.scene().bodies[body].vertices.clone().map(|v| run.scene().mass[2 * v]).sum::<f64>()
                });
                let [one, other] = [0, 1].map(|body| middle(run, body));
                [0, 1].map(|axis| (masses[0] * one[axis] + masses[1] * other[axis]) / (masses[0] + masses[1]))
            };
            assert!(run.count_crossings().unwrap() > 0, "one is inside the other");
            let before = centre(&run);
            run.advance(16 * 180, &mut || true);
            let what = format!("{} {body}", kind.name());
            assert!(run.fault().is_none(), "{what}: {:?}", run.fault());
            assert_eq!(run.count_crossings(), Some(0), "{what}");
            let energies = run.energies();
            assert!(energies.elastic + energies.kinetic + energies.contact < 1e-9, "{what}: {energies:?}");
            let after = centre(&run);
            let uniform = (0..2).all(|axis| (after[axis] - before[axis]).abs() < 0.05);
            assert!(uniform, "{what}: the mean place moves from {before:?} to {after:?}");
            let apart = [0, 1].map(|axis| middle(&run, 0)[axis] - middle(&run, 1)[axis]);
            assert!(apart[0].hypot(apart[1]) > 0.15, "{what}");
        }
    }
}

/// The work of moving them against gravity is supplied energy, and so is what the floor takes up.
#[test]
fn moving_bodies_apart_leaves_no_energy_from_nowhere() {
    for kind in IntegratorKind::all().into_iter().filter(|kind| kind.kind().class() != Class::ErrorControlled) {
        let more = "(effect: Gravity(down: 9.81)), (effect: Rayleigh(mass: 2, stiffness: 0.001)), (effect: Friction(coefficient: 0.4)),
            (effect: Boundary(least: (-1, 0.28), greatest: (2, 2)))";
        // In short steps, with which every scheme keeps the energy of an impact.
        let level = Level { substeps: Substeps::nearest(64.0), ..overlapped(kind.name(), DISK, more) };
        let mut run = simulation(&level);
        let mut account = Account::new(run.scene(), run.energies());
        for _ in 0..150 {
            let work = run.work_of_obstacles();
            run.advance(64, &mut || true);
            assert!(run.fault().is_none(), "{}: {:?}", kind.name(), run.fault());
            account.supply(run.work_of_obstacles() - work);
            account.record(run.energies());
        }
        assert!(account.gain() < 0.05, "{}: {} of the energy put in came from nowhere", kind.name(), account.gain());
        assert_eq!(run.count_crossings(), Some(0), "{}", kind.name());
    }
}

#[test]
fn what_is_held_stays_and_the_other_body_leaves() {
    let held = "pins: [Left, Right]";
    let mut run = simulation(&overlapped("SymplecticEuler", &format!("{BAR}, {held}"), ""));
    let start = run.state().x.clone();
    run.advance(16 * 120, &mut || true);
    let own = run.scene().numbers(&run.scene().bodies[1].vertices);
    assert_eq!(run.count_crossings(), Some(0));
    assert_eq!(run.state().x[own.clone()], start[own], "the held bar has not moved");
    // Where both are held, they stay and do no harm.
    let text = overlapped("ImplicitEuler", &format!("{BAR}, {held}"), "");
    let mut both = text.clone();
    both.bodies[0].pins.clone_from(&text.bodies[1].pins);
    let mut run = simulation(&both);
    let start = run.state().x.clone();
    run.advance(60, &mut || true);
    assert!(run.count_crossings().unwrap() > 0 && run.fault().is_none());
    assert_eq!(run.state().x, start);
}

#[test]
fn a_separation_saved_half_way_continues_bit_for_bit() {
    for kind in IntegratorKind::all() {
        let more = "(effect: Gravity(down: 1)), (effect: Boundary(least: (-1, 0.2), greatest: (2, 2)))";
        continues_bit_for_bit(&overlapped(kind.name(), DISK, more));
    }
    // Near its end too, where they are within their skins only.
    let level = overlapped("VelocityVerlet", DISK, "");
    let mut run = simulation(&level);
    for _ in 0..200 {
        let mut other = reopened(&run, &level);
        other.advance(8, &mut || true);
        run.advance(8, &mut || true);
        assert_eq!(other.state().hash(), run.state().hash());
    }
    assert_eq!(run.count_crossings(), Some(0));
}

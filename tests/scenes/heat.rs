//! Facts about the balance of energy: what damping, contact, friction and truncation dissipate, and what moving obstacles do, close it
//! to the order of the scheme.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{level, started};
use gingerbread::{
    integrators::{Class, IntegratorKind, MeanForces},
    level::Level,
    quantity::Velocity,
    simulation::Simulation,
};

/// A disk that falls on a slope while a plate moves up into it.
fn scene(effects: &str) -> Level {
    level(&format!(
        "(name: \"\", bodies: [(name: \"disk\", mesh: Disk(centre: (0.5, 0.23), radius: 0.2, rings: 4), velocity: (0.3, -0.5),
            material: (model: NeoHookean, young: 1000, poisson: 0.3, plane: Stress), mass: Total(12.5))],
        effects: [(effect: Gravity(down: 2)), {effects}
            (effect: Walls(obstacles: [Plane(point: (0.5, 0), normal: (-0.2, 1), eps: 0.01),
                Moving(obstacle: Cuboid(centre: (0.8, 0.25), width: 0.1, height: 0.4, eps: 0.01), motions: [Swing(way: (-0.1, 0), period: 2, phase: 0)])]))])"
    ))
}

/// Energy and heat less work, above that at the start [J], and the heat [J].
fn balance(simulation: &mut Simulation, until: f64) -> (f64, f64) {
    simulation.set_measured(true);
    let start = simulation.energies().total();
    simulation.advance((until / simulation.scene().step).round() as u64, &mut || true);
    assert!(simulation.fault().is_none(), "{:?}", simulation.fault());
    let heat = simulation.heat();
    assert!(simulation.work_of_obstacles() != 0.0, "the plate works");
    (simulation.energies().total() + heat - simulation.work_of_obstacles() - start, heat)
}

const SMOOTH: &str = "(effect: Rayleigh(mass: 0.5, stiffness: 0.002)), (effect: Drag(coefficient: 0.02)), (effect: Contact(dissipation: 0.5)),";

/// Asserts that the balance closes with half and a quarter of the step as the order of the scheme says; that of error control by a bound.
fn assert_closes(level: &Level, until: f64, rough: bool) {
    for kind in IntegratorKind::all() {
        let (scheme, order) = (format!("{}()", kind.name()), kind.kind().order());
        let steps = if kind.kind().class() == Class::ErrorControlled { 60.0 } else { 4000.0 };
        let of = |steps: f64| balance(&mut started(level, &scheme, 1.0 / steps), until);
        let ((coarse, _), (fine, heat)) = (of(steps), of(2.0 * steps));
        assert!(heat > 1.0, "{scheme}: {heat} J");
        // Error control bounds it, and mean forces keep the energy on planes.
        let bound = match (kind.kind().class(), kind.kind().mean_forces()) {
            (Class::ErrorControlled, _) => Some(5e-4),
            (_, MeanForces::All) => Some(1e-9),
            _ => None,
        };
        if let Some(bound) = bound {
            assert!(coarse.abs() < bound * heat, "{scheme}: {coarse:e} J of {heat} J");
            continue;
        }
        // The work of the plate is of second order at most.
        let [least, most] = [order.min(2), order].map(f64::from);
        let measured = f64::log2(coarse / fine);
        let tolerance = if rough { 0.5 } else { 0.3 };
        assert!(
            measured > least - tolerance * least.sqrt() && measured < most + tolerance * most.sqrt(),
            "{scheme}: order {measured} of {coarse:e} J of {heat} J"
        );
    }
}

#[test]
fn heat_and_work_close_the_balance_of_energy() {
    assert_closes(&scene(SMOOTH), 0.6, false);
}

/// What sticks and slides stores energy in its spring, as at this moment.
#[test]
fn friction_is_in_the_balance() {
    assert_closes(&scene(&format!("{SMOOTH} (effect: Friction(coefficient: 0.4)),")), 0.3, true);
}

/// A skin that is too soft for the impact: the truncation takes what is left of it.
#[test]
fn truncation_is_in_the_balance() {
    let mut level = scene("(effect: Contact(modulus: 0.01)),");
    level.bodies[0].velocity.1 = Velocity::new(-4.0).unwrap();
    let mut simulation = started(&level, "VelocityVerlet()", 2e-4);
    let (open, heat) = balance(&mut simulation, 0.6);
    assert!(simulation.counts().truncated_energy > 0.05, "{:?}", simulation.counts());
    assert!(open.abs() < 0.02 * heat, "{open} J of {heat} J");
}

/// The ledger is open or not: steps are the same.
#[test]
fn measuring_heat_changes_no_bit() {
    let level = scene(&format!("{SMOOTH} (effect: Friction(coefficient: 0.4)),"));
    for kind in IntegratorKind::all() {
        let [with, without] = [true, false].map(|measured| {
            let mut simulation = started(&level, &format!("{}()", kind.name()), 1e-3);
            simulation.set_measured(measured);
            simulation.advance(400, &mut || true);
            assert_eq!(simulation.costs().iter().any(|cost| cost.heat > 0.0), measured);
            simulation.state().clone()
        });
        assert_eq!(with, without, "{}", kind.name());
    }
}

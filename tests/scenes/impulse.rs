//! Facts about pushes and bursts.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{built_in, level, simulation};
use gingerbread::{
    command::{Command, Mode},
    impulse::Impulse,
    integrators::IntegratorKind,
    level::Level,
    meshes::NoFiles,
    sandbox::Sandbox,
};

fn sheet(scheme: &str) -> Level {
    level(&format!(
        "(name: \"sheet\", integrator: {scheme}(), substeps: 40, bodies: [(name: \"sheet\", pins: [Left], mass: Density(100),
            mesh: Rectangle(width: 1, height: 1, columns: 8, rows: 8, diagonals: Alternating, corner: (0, 0)),
            material: (model: StableNeoHookean, young: 1000, poisson: 0.3, plane: Strain))],
        effects: [(effect: Rayleigh(mass: 1))])"
    ))
}

/// dv = (1 - r²/R²)² (push + burst d/R) at every free vertex, and nothing else changes.
#[test]
fn an_impulse_changes_velocities_by_its_formula() {
    let mut sheet = simulation(&sheet("SymplecticEuler"));
    let before = sheet.state().clone();
    let impulse = Impulse { centre: [0.5, 0.4, 9.0], radius: 0.6, push: [1.0, -2.0, 3.0], burst: 0.7 };
    sheet.give(&impulse);
    let (scene, after) = (sheet.scene(), sheet.state());
    assert_eq!((&after.x, after.steps, after.time.to_bits()), (&before.x, before.steps, before.time.to_bits()));
    let mut reached = 0;
    for vertex in 0..scene.vertices() {
        let d = [after.x[2 * vertex] - 0.5, after.x[2 * vertex + 1] - 0.4];
        let share = (d[0] * d[0] + d[1] * d[1]) / 0.36;
        let weight = if share < 1.0 { (1.0 - share) * (1.0 - share) } else { 0.0 };
        for (axis, d) in d.into_iter().enumerate() {
            let wanted =
                if scene.inverse_mass[2 * vertex] > 0.0 { weight * (impulse.push[axis] + 0.7 * d / 0.6) } else { 0.0 };
            let found = after.v[2 * vertex + axis] - before.v[2 * vertex + axis];
            assert!((found - wanted).abs() < 1e-14, "vertex {vertex}: {found}, not {wanted}");
            reached += usize::from(found != 0.0);
        }
    }
    assert!(reached > 20 && reached < after.v.len(), "{reached}");
}

/// The same change as by hand, at the beginning of the frame of its time.
#[test]
fn a_scripted_impulse_is_one_by_hand() {
    let mut scripted = sheet("SymplecticEuler");
    scripted.actions = ron::from_str(
        "[(at: 0.05, action: Impulse(centre: (0.5, 0.4), radius: 0.6, push: (1, -2, 0), burst: 0.7)),
          (at: 0.05, action: Impulse(centre: (0.5, 0.4), radius: 0.6))]",
    )
    .unwrap();
    let (mut scripted, mut by_hand) = (simulation(&scripted), simulation(&sheet("SymplecticEuler")));
    scripted.advance(200, &mut || true);
    by_hand.advance(120, &mut || true);
    by_hand.give(&Impulse { centre: [0.5, 0.4, 0.0], radius: 0.6, push: [1.0, -2.0, 0.0], burst: 0.7 });
    by_hand.advance(80, &mut || true);
    assert!(scripted.state().v.iter().any(|v| *v != 0.0), "it moves");
    assert_eq!(scripted.state().x, by_hand.state().x);
}

/// The guard counts the energy as supplied from outside.
#[test]
fn every_scheme_goes_on_after_a_burst() {
    for kind in IntegratorKind::all() {
        let mut sheet = simulation(&sheet(kind.name()));
        sheet.advance(80, &mut || true);
        sheet.give(&Impulse::push([1.0, 0.5, 0.0], [0.0, 1.0, 0.0], 1.4));
        sheet.advance(80, &mut || true);
        sheet.give(&Impulse::burst([0.5, 0.5, 0.0], 1.4));
        let given = sheet.energies();
        assert!(given.kinetic > 1.0, "{}: {given:?}", kind.name());
        sheet.advance(800, &mut || true);
        assert!(sheet.fault().is_none(), "{}: {:?}", kind.name(), sheet.fault());
        assert!(sheet.energies().total() < given.total(), "{}", kind.name());
    }
}

#[test]
fn an_impulse_acts_in_space_and_is_refused_elsewhere() {
    let mut sandbox = Sandbox::new(built_in("hanging_net"), Box::new(NoFiles)).unwrap();
    let push = Command::Impulse(Impulse::push([0.5, 0.5, 0.0], [1.0, 0.0, 0.0], 1.0));
    assert!(sandbox.apply(push.clone()).is_err(), "not in edit mode");
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    sandbox.apply(push.clone()).unwrap();
    let empty = Impulse { radius: 0.0, ..Impulse::burst([0.0; 3], 1.0) };
    assert!(sandbox.apply(Command::Impulse(empty)).is_err(), "no radius");
    assert!(sandbox.apply(Command::Impulse(Impulse::burst([f64::NAN; 3], 1.0))).is_err(), "no place");
    let mut toy = Sandbox::new(built_in("circle"), Box::new(NoFiles)).unwrap();
    toy.apply(Command::SetMode(Mode::Simulate)).unwrap();
    assert!(toy.apply(push).is_err(), "a toy has no vertices");

    let mut cloth = simulation(&Level { actions: Vec::new(), ..built_in("cloth_man") });
    let middle = {
        let x = &cloth.state().x;
        [x[0], x[1], x[2]]
    };
    let before = cloth.energies().kinetic;
    cloth.give(&Impulse::burst(middle, 1.0));
    assert!(cloth.energies().kinetic > before, "velocities have three coordinates there");
}

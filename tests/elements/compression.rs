//! What happens to triangles that are squeezed beyond where a model has an honest answer.
#![allow(clippy::unwrap_used, clippy::float_cmp, reason = "a failing test should panic; nothing at all must be zero")]

use crate::common::{models, rotation, sheet, simulation};
use gingerbread::{elements::Field, inversion_recovery::Tangle, simulation::Simulation};
use nalgebra::{Matrix2, Vector2};

/// A sheet of a model with the guard of this strength as its only effect.
fn guarded(model: &str, strength: f64) -> Simulation {
    simulation(&sheet(
        model,
        "",
        &format!("substeps: 1, integrator: ImplicitEuler(), effects: [(effect: Compression(strength: {strength}))]"),
    ))
}

/// Every point moved by F about the middle of the sheet.
fn deform(simulation: &mut Simulation, f: Matrix2<f64>) {
    let mut state = simulation.scene().start.clone();
    for point in state.x.chunks_exact_mut(2) {
        let to = f * Vector2::new(point[0] - 0.5, point[1] - 0.5);
        (point[0], point[1]) = (to.x + 0.5, to.y + 0.5);
    }
    simulation.set_state(state);
}

/// Force along x on the right edge of a sheet pressed to this share of its width, its height held [N].
fn pressed(simulation: &mut Simulation, stretch: f64) -> f64 {
    deform(simulation, Matrix2::new(stretch, 0.0, 0.0, 1.0));
    let scene = simulation.scene();
    let mut force = vec![0.0; scene.rest.len()];
    for effect in &scene.effects {
        effect.force(scene.motion(simulation.state(), None), &mut vec![0.0; effect.scratch()], &mut force);
    }
    scene
        .rest
        .chunks_exact(2)
        .zip(force.chunks_exact(2))
        .filter(|(at, _)| at[0] > 0.69)
        .map(|(_, force)| force[0])
        .sum()
}

/// From a strength of 0.28 on, a St. Venant-Kirchhoff sheet pushes back the harder the flatter it is.
#[test]
fn the_compression_guard_makes_the_force_monotonic() {
    for (strength, gives_way) in [(0.0, true), (0.27, true), (0.28, false), (1.0, false), (4.0, false)] {
        let mut simulation = guarded("StVenantKirchhoff", strength);
        let forces: Vec<_> = (1..=100).map(|part| pressed(&mut simulation, f64::from(part) / 100.0)).collect();
        let softer = forces.windows(2).any(|pair| pair[0] < pair[1]);
        assert_eq!(softer, gives_way, "strength {strength}: {forces:?}");
        assert!(forces[99].abs() < 1e-12, "at rest there is no force");
    }
}

#[test]
fn the_guard_does_nothing_to_what_is_not_squeezed() {
    let mut simulation = guarded("StVenantKirchhoff", 1.0);
    for stretch in [1.0, 1.2, 3.0] {
        deform(&mut simulation, rotation(0.4) * stretch);
        let (scene, state) = (simulation.scene(), simulation.state());
        let guard = &scene.effects[1];
        let mut force = vec![0.0; state.x.len()];
        guard.force(scene.motion(state, None), &mut vec![0.0; guard.scratch()], &mut force);
        let most = force.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
        assert!(most < 1e-12 && guard.energy(scene.motion(state, None)) < 1e-12, "{stretch}: {most} N");
    }
}

/// Without the guard a mirrored St. Venant-Kirchhoff sheet stays mirrored.
#[test]
fn the_compression_guard_turns_a_mirrored_sheet_back() {
    for (strength, inverted) in [(0.0, 32), (1.0, 0)] {
        let mut simulation = guarded("StVenantKirchhoff", strength);
        deform(&mut simulation, Matrix2::new(-0.99, 0.02, 0.01, 1.01));
        assert_eq!(simulation.advance(600, &mut || true), 600);
        let tangle = Tangle::of_all(simulation.scene(), &simulation.state().x);
        assert_eq!(
            tangle,
            Tangle { inverted, wound: if inverted > 0 { 9 } else { 0 }, metastable: 0 },
            "strength {strength}"
        );
    }
}

#[test]
fn a_mirrored_corotated_body_recovers_in_any_orientation() {
    for model in ["Corotated", "FixedCorotated"] {
        for degrees in [0.0_f64, 17.0, 90.0, 123.0, 260.0] {
            let mut simulation = guarded(model, 0.0);
            deform(&mut simulation, rotation(degrees.to_radians()) * Matrix2::new(-1.0, 0.0, 0.0, 1.0));
            let body = &simulation.scene().bodies[0].elements;
            assert_eq!(
                body.diagnose(Field::None, &simulation.state().x, &mut Vec::new()).continued,
                32,
                "{model} {degrees}: all are at the point of 0/0"
            );
            assert_eq!(simulation.advance(600, &mut || true), 600);
            assert!(simulation.energies().elastic < 1e-9, "{model} {degrees}: {:?}", simulation.energies());
            assert!(!Tangle::of_all(simulation.scene(), &simulation.state().x).is_some(), "{model} {degrees}");
        }
    }
}

/// Only neo-Hookean and Hencky continue their formula, below a tenth of the area.
#[test]
fn triangles_on_a_continued_formula_are_counted() {
    for model in models() {
        let mut simulation = guarded(model, 0.0);
        let continued = |simulation: &Simulation| {
            simulation.scene().bodies[0]
                .elements
                .diagnose(Field::None, &simulation.state().x, &mut Vec::new())
                .continued
        };
        assert_eq!(continued(&simulation), 0, "{model} at rest");
        deform(&mut simulation, Matrix2::new(0.11, 0.0, 0.0, 1.0));
        assert_eq!(continued(&simulation), 0, "{model} squeezed to 11 %");
        deform(&mut simulation, Matrix2::new(0.09, 0.0, 0.0, 1.0));
        let expected = if ["NeoHookean", "Hencky"].contains(&model) { 32 } else { 0 };
        assert_eq!(continued(&simulation), expected, "{model} squeezed to 9 %");
    }
}

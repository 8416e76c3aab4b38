//! Facts about what begins inside a wall or beyond an edge of the world: it comes out, slowly and in its own shape.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

#[path = "../common/mod.rs"]
mod common;
mod several;
mod stays;

use common::{greatest_gap, level, models, seen, simulation};
use gingerbread::{
    command::{Command, Mode},
    files,
    integrators::{Class, IntegratorKind},
    level::{Level, SubstepMode},
    levels::built_in,
    meshes::NoFiles,
    obstacles::Inside,
    quantity::Point,
    sandbox::Sandbox,
    simulation::Simulation,
};

/// A disk of radius 0.2 m, 2 kg/m² and shear waves of 4 m/s, with its middle at a point.
fn disk([x, y]: [f64; 2], (integrator, substeps): (&str, u32), model: &str, more: &str) -> Level {
    level(&format!(
        "(name: \"disk\", integrator: {integrator}(), substeps: {substeps}, bodies: [(name: \"disk\",
            mesh: Disk(centre: ({x:?}, {y:?}), radius: 0.2, rings: 6), mass: Density(2),
            material: (model: {model}, young: 83.2, poisson: 0.3, plane: Strain))], {more})"
    ))
}

/// A tenth of the speed of waves [m/s].
const SLOW: f64 = 0.4;

fn walls(obstacle: &str) -> String {
    format!("effects: [(effect: Walls(obstacles: [{obstacle}]))]")
}

/// What the disk overlaps, with its middle at (0.5, 0.5).
fn overlapped() -> Vec<(&'static str, String)> {
    vec![
        ("floor", walls("Plane(point: (0, 0.45), normal: (0, 1), eps: 0.005)")),
        ("ball", walls("Ball(centre: (0.4, 0.25), radius: 0.15, eps: 0.005)")),
        ("box", walls("Cuboid(centre: (0.5, 0.3), width: 0.8, height: 0.2, turn: 10, eps: 0.005)")),
        ("wedge", walls("Polygon(points: [(0.4, 0), (0.8, 0.1), (0.8, 0.6), (0.4, 0.4)], eps: 0.005)")),
        ("edges", "effects: [(effect: Boundary(least: (0, 0.45), greatest: (3, 3)))]".to_owned()),
    ]
}

/// Every scheme with steps a frame, but forward Euler, which needs no wall to fly apart; Heun's takes short ones for the same reason.
fn schemes() -> impl Iterator<Item = (&'static str, u32)> {
    IntegratorKind::all().into_iter().filter(|kind| kind.name() != "ForwardEuler").map(|kind| {
        let substeps = match (kind.kind().class(), kind.kind().stability_limit()) {
            (Class::Implicit, _) => 4,
            (_, Some(0.0)) => 400,
            _ => 20,
        };
        (kind.name(), substeps)
    })
}

fn mass(simulation: &Simulation) -> f64 {
    simulation.scene().mass.iter().step_by(2).sum()
}

/// Runs for a time; the least J and the greatest energy of motion and deformation on the way, looked at 1200 times a second, which is
/// ten times while a wave crosses a triangle.
fn leave(simulation: &mut Simulation, seconds: f64) -> (f64, f64) {
    let steps = (seconds / simulation.scene().step) as u64;
    let bunch = (1.0 / (1200.0 * simulation.scene().step)).round().max(1.0) as u64;
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for _ in 0..steps / bunch {
        simulation.advance(bunch, &mut || true);
        let energies = simulation.energies();
        (least, most) = (least.min(simulation.inversion().0), most.max(energies.kinetic + energies.elastic));
    }
    (least, most)
}

#[test]
fn every_scheme_leads_a_body_out_of_an_obstacle_in_shape() {
    for (number, scheme) in schemes().enumerate() {
        // The way out is found before the first step, whatever the scheme: one explicit and one implicit scheme take all of them.
        let all = ["SymplecticEuler", "ImplicitEuler"].contains(&scheme.0);
        let count = if all { overlapped().len() } else { 2 };
        for (what, effects) in overlapped().into_iter().cycle().skip(number).take(count) {
            let mut simulation = simulation(&disk([0.5, 0.5], scheme, "Corotated", &effects));
            let inside = simulation.count_inside();
            assert!(inside > 10, "{what}: only {inside} vertices begin inside");
            let (least, most) = leave(&mut simulation, 1.5);
            let what = format!("{what} under {}", scheme.0);
            assert!(simulation.fault().is_none(), "{what}: {:?}", simulation.fault());
            assert_eq!(simulation.count_inside(), 0, "{what}");
            assert!(least > 0.6, "{what}: least J {least}");
            let given = 0.5 * mass(&simulation) * SLOW * SLOW;
            // What bounces off a wall that comes at speed u leaves at twice that speed.
            assert!(most < 4.0 * given, "{what}: {most} J of motion and deformation, {given} J as a whole");
            let counts = simulation.counts();
            assert_eq!((counts.guarded, counts.retaken), (0, 0), "{what}: nothing came from nowhere");
            assert!(counts.pushed_out > 5 && !simulation.pushes_out(), "{what}: {counts:?}");
        }
    }
}

#[test]
fn every_model_keeps_its_shape_on_the_way_out() {
    for model in models() {
        for (what, effects) in overlapped() {
            let mut simulation = simulation(&disk([0.5, 0.5], ("SymplecticEuler", 20), model, &effects));
            let (least, _) = leave(&mut simulation, 1.5);
            assert!(simulation.fault().is_none() && simulation.count_inside() == 0, "{model}, {what}");
            assert!(least > 0.6, "{model}, {what}: least J {least}");
        }
    }
}

/// It comes in at a tenth of its wave speed.
/// Put on the edges at once, all of it would be in one point.
#[test]
fn a_body_far_outside_the_domain_comes_in_whole() {
    let effects = "effects: [(effect: Boundary(least: (0, 0), greatest: (1, 1)))]";
    let mut simulation = simulation(&disk([2.0, 0.5], ("SymplecticEuler", 20), "NeoHookean", effects));
    let start = simulation.state().x.clone();
    let (least, _) = leave(&mut simulation, 1.0);
    assert!(least > 0.999_999, "it moves as a whole: least J {least}");
    let state = simulation.state();
    for (x, start) in state.x.chunks_exact(2).zip(start.chunks_exact(2)) {
        assert!((x[0] - (start[0] - SLOW * state.time)).abs() < 1e-9 && (x[1] - start[1]).abs() < 1e-9);
    }
    let (least, _) = leave(&mut simulation, 3.0);
    assert!(simulation.count_inside() == 0 && least > 0.6, "least J {least}");
}

#[test]
fn nothing_bounces_off_a_wall_that_it_comes_out_of() {
    let effects = "effects: [(effect: Walls(obstacles: [Plane(point: (0, 0.45), normal: (0, 1), eps: 0.005)])),
        (effect: Restitution(coefficient: 1)), (effect: Friction(coefficient: 0.5))]";
    let mut simulation = simulation(&disk([0.5, 0.5], ("SymplecticEuler", 20), "Corotated", effects));
    let (least, most) = leave(&mut simulation, 1.0);
    assert!(simulation.count_inside() == 0 && least > 0.6, "least J {least}");
    assert!(most < 1.5 * mass(&simulation) * SLOW * SLOW, "{most} J");
}

/// The sooner steps end the nearer the answers lie: how fast it comes out is a matter of the body, not of the step.
#[test]
fn the_way_out_does_not_depend_on_the_step() {
    let (_, effects) = overlapped().swap_remove(0);
    let middle = |substeps: u32| {
        let mut simulation = simulation(&disk([0.5, 0.5], ("SymplecticEuler", substeps), "Corotated", &effects));
        leave(&mut simulation, 0.7);
        let heights = simulation.state().x.iter().skip(1).step_by(2);
        heights.clone().sum::<f64>() / heights.count() as f64
    };
    let [coarse, fine, finer] = [20, 80, 320].map(middle);
    assert!((finer - 0.5).abs() > 0.1, "it came out: {finer}");
    assert!((coarse - finer).abs() < 0.01 && (fine - finer).abs() < 0.004, "{coarse} {fine} {finer}");
}

#[test]
fn multirate_stepping_leads_out_as_common_steps_do() {
    let (_, effects) = overlapped().swap_remove(1);
    let common = disk([0.5, 0.5], ("SymplecticEuler", 20), "Corotated", &effects);
    let own = Level { paces: SubstepMode::Own, ..common.clone() };
    let [common, own] = [common, own].map(|level| {
        let mut simulation = simulation(&level);
        simulation.advance(400, &mut || true);
        assert!(simulation.counts().pushed_out > 5);
        simulation.state().x.clone()
    });
    let apart = greatest_gap(&common, &own);
    assert!(apart < 1e-12, "{apart:e}");
}

#[test]
fn switching_walls_on_over_a_limb_is_told_and_flattens_nothing() {
    let mut low = files::parse(built_in("gingerbread").unwrap(), "gingerbread.ron").unwrap();
    low.bodies[0].place.offset = Point::new([0.0, -0.12]).unwrap();
    let mut sandbox = Sandbox::new(low, Box::new(NoFiles)).unwrap();
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    sandbox.advance(100, &mut || true);
    assert_eq!(seen(&sandbox).inside, Inside::Nothing);
    let before = sandbox.simulation().energies();
    sandbox.apply(Command::SetMode(Mode::Collide)).unwrap();
    assert!(sandbox.simulation().count_inside() > 20, "his feet are below the floor");
    let mut told = false;
    let mut least = f64::INFINITY;
    for _ in 0..60 {
        sandbox.advance(30, &mut || true);
        let now = seen(&sandbox);
        told |= now.inside == Inside::ComesOut;
        least = least.min(now.min_j);
        let energies = now.energies;
        assert!(energies.kinetic + energies.elastic < 2.0, "{before:?} became {energies:?}");
    }
    assert!(told && least > 0.5, "told: {told}, least J {least}");
    assert_eq!(sandbox.simulation().count_inside(), 0);
    assert_eq!(seen(&sandbox).inside, Inside::Nothing, "nothing is inside any more");
}

/// Towards the nearest surfaces it would be torn to all sides, and hang on the obstacle for ever.
#[test]
fn a_body_put_over_an_obstacle_slips_off_it_whole() {
    let over = [
        ("ball", "Ball(centre: (0.45, 0.5), radius: 0.06, eps: 0.003)"),
        ("plate", "Cuboid(centre: (0.5, 0.46), width: 1, height: 0.04, turn: 3, eps: 0.003)"),
        ("post", "Polygon(points: [(0.4, 0.2), (0.46, 0.2), (0.46, 0.55), (0.4, 0.55)], eps: 0.003)"),
        (
            "moving ball",
            "Moving(obstacle: Ball(centre: (0.45, 0.5), radius: 0.06, eps: 0.003), motions: [Slide(velocity: (0.1, 0))])",
        ),
    ];
    for scheme in [("SymplecticEuler", 20), ("ImplicitEuler", 4)] {
        for (what, obstacle) in over {
            let mut simulation = simulation(&disk([0.5, 0.5], scheme, "NeoHookean", &walls(obstacle)));
            assert!(simulation.count_inside() > 5, "{what}");
            let (least, _) = leave(&mut simulation, 1.5);
            let what = format!("{what} under {}", scheme.0);
            assert!(simulation.fault().is_none() && simulation.count_inside() == 0, "{what}: {:?}", simulation.fault());
            assert!(least > 0.4, "{what}: least J {least}");
            let (low, high) = spread(&simulation);
            assert!(high - low < 0.45, "{what}: it hangs on it, from {low} to {high}");
        }
    }
}

/// Only from behind may the rest follow: the other sides of the same obstacle stop it as ever.
#[test]
fn a_body_leaving_a_wall_stays_above_its_floor() {
    let corner = "Polygon(points: [(-1, -0.2), (2, -0.2), (2, 0), (0, 0), (0, 3), (-1, 3)], eps: 0.003)";
    let mut level = disk([0.18, 0.6], ("SymplecticEuler", 40), "NeoHookean", &walls(corner));
    let velocity = |value: f64| gingerbread::quantity::Velocity::new(value).unwrap();
    level.bodies[0].velocity = (velocity(0.0), velocity(-1.5));
    let mut simulation = simulation(&level);
    assert!(simulation.count_inside() > 3);
    for _ in 0..100 {
        simulation.advance(24, &mut || true);
        let (low, _) = spread(&simulation);
        assert!(low > -0.01, "its lowest vertex is at {low} m");
    }
    assert!(simulation.fault().is_none() && simulation.count_inside() == 0);
}

/// The least and the greatest y.
fn spread(simulation: &Simulation) -> (f64, f64) {
    let heights = simulation.state().x.iter().skip(1).step_by(2);
    heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(*y), high.max(*y)))
}

/// What holds vertices while it solves for the rest does not know how hard it pushes: that is no energy from nowhere.
#[test]
fn no_implicit_scheme_stops_on_its_way_out_of_a_floor() {
    let floor = walls("Plane(point: (0, 0.4), normal: (0, 1), eps: 0.005)");
    let implicit = IntegratorKind::all().into_iter().filter(|kind| matches!(kind.kind().class(), Class::Implicit));
    for kind in implicit {
        for substeps in [1_u32, 4] {
            for young in [4e3, 6e4, 1e6] {
                let mut simulation = simulation(&level(&format!(
                    "(name: \"stiff\", integrator: {}(), substeps: {substeps}, bodies: [(name: \"disk\", mass: Density(100),
                        mesh: Disk(centre: (0.5, 0.55), radius: 0.2, rings: 6),
                        material: (model: NeoHookean, young: {young}, poisson: 0.4, plane: Strain))], {floor})",
                    kind.name()
                )));
                // The softest is out after 0.15 s.
                simulation.advance(45 * u64::from(substeps), &mut || true);
                let what = format!("{} with {substeps} steps a frame, {young} Pa", kind.name());
                assert!(simulation.fault().is_none(), "{what}: {:?}", simulation.fault());
                assert!(simulation.count_inside() == 0 && simulation.counts().guarded == 0, "{what}");
                assert!(simulation.inversion().0 > 0.5, "{what}");
            }
        }
    }
}

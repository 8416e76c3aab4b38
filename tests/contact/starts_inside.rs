//! Facts about what begins inside a wall or beyond an edge of the world: it comes out slowly, and nothing explodes.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{greatest_gap, level, models, seen, simulation};
use gingerbread::{
    command::{Command, Mode},
    files,
    integrators::{Class, IntegratorKind},
    level::{Level, Pin, SubstepMode},
    levels::built_in,
    meshes::NoFiles,
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

/// Bounds on a body that comes out: its least J, and its greatest energy \[J\]. A disk pressed to half of its height has some 2 J.
fn assert_comes_out(simulation: &mut Simulation, obstacle: &str, what: &str) {
    let begins = simulation.count_inside();
    assert!(begins > 10, "{what}: only {begins} vertices begin inside");
    let (least, most) = leave(simulation, 2.0);
    assert!(simulation.fault().is_none(), "{what}: {:?}", simulation.fault());
    assert!(simulation.counts().pushed_out > 5, "{what}: {:?}", simulation.counts());
    // Vertices on both sides of the middle of a solid leave it to both sides, where its surface is nearest.
    let (left, deform, energy) = if obstacle == "box" { (begins / 2, f64::NEG_INFINITY, 6.0) } else { (1, 0.5, 0.4) };
    assert!(simulation.count_inside() <= left, "{what}: {} of {begins} are still inside", simulation.count_inside());
    // Nothing dissipates the vibrations under the energy-momentum method, and its longer steps meet other ones.
    let deform = if what.contains("EnergyMomentum") { deform - 0.15 } else { deform };
    assert!(least > deform && most < energy, "{what}: least J {least}, {most} J");
}

#[test]
fn every_scheme_leads_a_body_out_of_an_obstacle() {
    for (number, scheme) in schemes().enumerate() {
        // One explicit and one implicit scheme take all of them.
        let all = ["SymplecticEuler", "ImplicitEuler"].contains(&scheme.0);
        let count = if all { overlapped().len() } else { 2 };
        for (what, effects) in overlapped().into_iter().cycle().skip(number).take(count) {
            let mut simulation = simulation(&disk([0.5, 0.5], scheme, "Corotated", &effects));
            assert_comes_out(&mut simulation, what, &format!("{what} under {}", scheme.0));
        }
    }
}

#[test]
fn every_model_comes_out_of_an_obstacle() {
    for model in models() {
        for (what, effects) in overlapped() {
            let mut simulation = simulation(&disk([0.5, 0.5], ("SymplecticEuler", 20), model, &effects));
            assert_comes_out(&mut simulation, what, &format!("{what}, {model}"));
        }
    }
}

/// Put on the edges at once, all of it would be in one point.
#[test]
fn a_body_far_outside_the_domain_comes_in() {
    let effects = "effects: [(effect: Boundary(least: (0, 0), greatest: (1, 1)))]";
    let mut simulation = simulation(&disk([2.0, 0.5], ("SymplecticEuler", 20), "NeoHookean", effects));
    let (least, most) = leave(&mut simulation, 6.0);
    assert!(simulation.count_inside() == 0 && least > 0.5 && most < 0.4, "least J {least}, {most} J");
}

/// Its parts leave a thin obstacle to both sides, and it hangs on it: that is told, and nothing explodes.
#[test]
fn a_body_over_a_thin_obstacle_does_not_explode() {
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
            let (least, most) = leave(&mut simulation, 2.0);
            let what = format!("{what} under {}", scheme.0);
            assert!(simulation.fault().is_none() && simulation.count_inside() <= 3, "{what}: {:?}", simulation.fault());
            assert!(least > 0.3 && most < 1.5, "{what}: least J {least}, {most} J");
        }
    }
}

#[test]
fn what_is_pinned_inside_stays_and_the_rest_comes_out() {
    let text = walls("Plane(point: (0, 0.4), normal: (0, 1), eps: 0.005)");
    let mut level = disk([0.5, 0.5], ("SymplecticEuler", 20), "Corotated", &text);
    level.bodies[0].pins = vec![Pin::Bottom];
    let mut simulation = simulation(&level);
    let pinned = simulation.scene().pins.len();
    leave(&mut simulation, 2.0);
    assert!(simulation.fault().is_none(), "{:?}", simulation.fault());
    assert!((pinned..=pinned + 2).contains(&simulation.count_inside()), "{} of {pinned}", simulation.count_inside());
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
    assert!(apart < 5e-3, "{apart:e}");
}

/// What a body overlaps at rest does not shorten its substeps, however strongly contact is damped.
#[test]
fn substeps_of_a_body_do_not_depend_on_what_it_begins_in() {
    let substeps = |centre: [f64; 2]| {
        let effects = "effects: [(effect: Walls(obstacles: [Ball(centre: (0.5, 0.5), radius: 0.15, eps: 0.005)])), (effect: Restitution(coefficient: 0.1))]";
        let level = disk(centre, ("SymplecticEuler", 1), "Corotated", effects);
        let simulation = simulation(&Level { paces: SubstepMode::Own, ..level });
        simulation.substep_plans().next().unwrap().steps
    };
    let (apart, inside) = (substeps([0.5, 2.0]), substeps([0.5, 0.55]));
    assert_eq!(apart, inside);
}

#[test]
fn walls_switched_on_over_a_limb_are_told_and_flatten_nothing() {
    let mut low = files::parse(built_in("gingerbread").unwrap(), "gingerbread.ron").unwrap();
    low.bodies[0].place.offset = Point::new([0.0, -0.12]).unwrap();
    let mut sandbox = Sandbox::new(low, Box::new(NoFiles)).unwrap();
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    sandbox.advance(100, &mut || true);
    assert_eq!(seen(&sandbox).inside, 0);
    let before = sandbox.simulation().energies();
    sandbox.apply(Command::SetMode(Mode::Collide)).unwrap();
    assert!(seen(&sandbox).inside > 20, "his feet are below the floor");
    let mut least = f64::INFINITY;
    for _ in 0..60 {
        sandbox.advance(60, &mut || true);
        let now = seen(&sandbox);
        least = least.min(now.min_j);
        let energies = now.energies;
        assert!(energies.kinetic + energies.elastic < 2.0, "{before:?} became {energies:?}");
    }
    assert!(least > 0.4, "least J {least}");
    assert_eq!(seen(&sandbox).inside, 0, "nothing is inside any more");
}

/// It is in the block by less than its skin, which lets it out. Vertices come nearer to other edges than those that they began at; these
/// new contacts begin without a force.
#[test]
fn a_disk_slightly_inside_a_block_gains_no_energy() {
    let level = level(
        "(name: \"\", substeps: 200, guard: Off, bodies: [
            (name: \"block\", mesh: Rectangle(width: 0.4, height: 0.4, columns: 5, rows: 5, diagonals: Alternating, corner: (0.3, 0.3)),
                material: (model: Corotated, young: 2000, poisson: 0.3, plane: Strain), mass: Density(100)),
            (name: \"disk\", mesh: Disk(centre: (0.79, 0.53), radius: 0.1, rings: 3),
                material: (model: Corotated, young: 2000, poisson: 0.3, plane: Strain), mass: Density(100))],
        effects: [(effect: Rayleigh(mass: 2)), (effect: Contact())])",
    );
    let mut simulation = simulation(&level);
    assert!(simulation.count_crossings().unwrap() > 0, "they begin inside each other");
    let mut least = simulation.energies().total();
    for _ in 0..180 {
        simulation.advance(200, &mut || true);
        assert!(simulation.fault().is_none(), "{:?}", simulation.fault());
        // What parts them is counted as work of obstacles.
        let balance = simulation.energies().total() - simulation.work_of_obstacles();
        assert!(balance - least < 0.02 * simulation.work_of_obstacles(), "{balance} J, from {least} J");
        least = least.min(balance);
    }
    assert_eq!(simulation.count_crossings(), Some(0), "they part");
}

/// A block that begins exactly on a floor is held there until its skin bears it.
#[test]
fn what_begins_on_a_floor_does_not_sink() {
    for (scheme, substeps) in schemes() {
        for floor in [
            "Boundary(least: (-1, 0), greatest: (1, 1))",
            "Walls(obstacles: [Plane(point: (0, 0), normal: (0, 1), eps: 0)])",
        ] {
            let level = level(&format!(
                "(name: \"\", integrator: {scheme}(), substeps: {substeps}, bodies: [(name: \"block\",
                    mesh: Rectangle(width: 0.4, height: 0.4, columns: 4, rows: 4, diagonals: Alternating, corner: (0, 0)),
                    material: (model: Corotated, young: 2000, poisson: 0.3, plane: Strain), mass: Density(100))],
                effects: [(effect: Gravity(down: 9.8)), (effect: Rayleigh(mass: 2)), (effect: {floor})])"
            ));
            let mut simulation = simulation(&level);
            for _ in 0..60 {
                simulation.advance(substeps.into(), &mut || true);
                assert!(simulation.fault().is_none(), "{scheme}: {:?}", simulation.fault());
                let lowest = simulation.state().x.iter().skip(1).step_by(2).copied().fold(f64::INFINITY, f64::min);
                assert!(lowest > -1e-12, "{scheme}: {lowest} m at {floor}");
            }
        }
    }
}

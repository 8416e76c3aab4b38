//! Facts about contact by a potential: energy, orders, friction, restitution and the work of obstacles.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{Random, SLOPE, integrator, level, reopened, started};
use gingerbread::{
    contact::{Anchor, AnyContact, Potential, restitution},
    effects::Motion,
    integrators::Class,
    level::{Level, RunMode, SubstepMode},
    levels,
    materials::Model,
    meshes::NoFiles,
    quantity::Velocity,
    scene::Scene,
    simulation::Simulation,
    solvers::{BlockMatrix, Tangent, Weights},
    stability::critical_step,
};

const SCHEMES: [&str; 13] = [
    "SymplecticEuler()",
    "ForwardEuler()",
    "VelocityVerlet()",
    "PositionVerlet()",
    "Heun()",
    "RungeKutta4()",
    "DormandPrince(relative: 1e-4, absolute: 1e-4)",
    "DormandPrince(relative: 1e-6, absolute: 1e-6)",
    "LinearlyImplicitEuler()",
    "ImplicitEuler()",
    "ImplicitMidpoint()",
    "EnergyMomentum()",
    "Bdf2()",
];

/// A disk of 216 triangles and 12.5 kg, whose lowest point is 0.3 m above a floor.
fn disk(gravity: f64, effects: &str) -> Level {
    level(&format!(
        "(name: \"\", bodies: [(name: \"disk\", mesh: Disk(centre: (0.5, 0.5), radius: 0.2, rings: 6),
            material: (model: Corotated, young: 1000, poisson: 0.3, plane: Stress), mass: Total(12.5))],
        effects: [(effect: Gravity(down: {gravity})), {effects}
            (effect: Walls(obstacles: [Plane(point: (0, 0), normal: (0, 1), eps: 0.01)]))])"
    ))
}

fn advance(simulation: &mut Simulation, time: f64) {
    simulation.advance((time / simulation.scene().step).round() as u64, &mut || true);
    assert!(simulation.fault().is_none(), "{:?}", simulation.fault());
}

/// Greatest total energy above the start, less the work of obstacles, up to a time [J].
fn gain(simulation: &mut Simulation, until: f64) -> f64 {
    let start = simulation.energies().total();
    let mut most = 0.0_f64;
    while simulation.state().time < until {
        simulation.advance(1, &mut || true);
        assert!(simulation.fault().is_none(), "{:?}", simulation.fault());
        most = most.max(simulation.energies().total() - start - simulation.work_of_obstacles());
    }
    most
}

#[test]
fn the_pressure_is_smooth_and_its_stiffness_bounded() {
    let skin = Potential { modulus: 3000.0, thickness: 0.01 };
    let mut random = Random(1);
    for _ in 0..1000 {
        let (gap, step) = (random.between(-0.01, 0.012), 1e-7);
        let slope = |of: &dyn Fn(f64) -> f64| (of(gap + step) - of(gap - step)) / (2.0 * step);
        let (p, k) = (skin.pressure(gap), skin.stiffness(gap));
        assert!((p + slope(&|gap| skin.energy(gap))).abs() < 1e-4, "{gap}");
        assert!((k + slope(&|gap| skin.pressure(gap))).abs() < 10.0, "{gap}");
        assert!((0.0..=skin.greatest_stiffness()).contains(&k));
        assert!((slope(&|gap| skin.stiffness(gap))).abs() <= 1.5 * skin.greatest_stiffness() / (0.5 * 0.01) * 1.001);
    }
}

/// A sheet among obstacles of all kinds, one of which moves; its lower edge is in contact.
const AMONG: &str = "(name: \"\", bodies: [(name: \"sheet\", mesh: Rectangle(corner: (0.2, 0.2), width: 0.6, height: 0.3, columns: 12, rows: 6),
        material: (model: Corotated, young: 1000, poisson: 0.3, plane: Stress), mass: Density(100))],
    nets: [(name: \"net\", net: Sheet(corner: (0.2, 0.196), width: 0.4, height: 0.1, columns: 8, rows: 2, structural: 100, shear: 50, flexion: 20), mass: 0.01)],
    effects: [(effect: Contact(dissipation: 0.3)), (effect: Friction(coefficient: 0.5)),
        (effect: Boundary(least: (0.19, 0.19), greatest: (1, 1))),
        (effect: Walls(obstacles: [Plane(point: (0, 0.195), normal: (0.1, 1), eps: 0.01), Ball(centre: (0.5, 0.09), radius: 0.1, eps: 0.01),
            Cuboid(centre: (0.805, 0.35), width: 0.05, height: 0.1, turn: 20, eps: 0.01), Polygon(points: [(0.25, 0.1), (0.35, 0.1), (0.3, 0.195)], eps: 0.01),
            Moving(obstacle: Ball(centre: (0.7, 0.1), radius: 0.097, eps: 0.01), motions: [Turn(about: (0.5, 0.1), spin: 2)])]))])";

fn motion<'a>(scene: &'a Scene, x: &'a [f64], v: &'a [f64], anchors: &'a [Anchor]) -> Motion<'a> {
    Motion { dimension: 2, x, v, mass: &scene.mass, inverse_mass: &scene.inverse_mass, anchors, ..Motion::NONE }
}

#[test]
fn forces_and_stiffness_are_derivatives() {
    let level = level(AMONG);
    let scene = Scene::build(&level, RunMode::Collide, &NoFiles, None).unwrap();
    let mut random = Random(2);
    let count = scene.rest.len();
    let x: Vec<_> = scene.rest.iter().map(|x| x + random.between(-1e-3, 1e-3)).collect();
    let still = vec![0.0; count];
    // Slow, so that what sticks keeps sticking.
    let v: Vec<_> = (0..count).map(|_| random.between(-1e-2, 1e-2)).collect();
    let with_obstacles = scene.effects.iter().filter(|effect| effect.surface_contact().is_none());
    let contacts: Vec<_> = with_obstacles.filter_map(|effect| effect.contact()).collect();
    assert_eq!(contacts.len(), 2);
    for effect in contacts {
        let at = |x, v, anchors| motion(&scene, x, v, anchors);
        let mut anchors = Vec::new();
        effect.drag_anchors(at(&x, &still, &[]), 1e-4, &mut anchors);
        assert!(anchors.len() >= 8, "{}", anchors.len());
        // Displaced by a hair: a part of them sticks.
        for anchor in &mut anchors {
            anchor.point[0] += random.between(-1e-6, 1e-6);
        }
        let force = |x: &[f64], v: &[f64]| {
            let mut force = vec![0.0; count];
            effect.force(motion(&scene, x, v, &anchors), &mut force);
            force
        };
        let energy = |x: &[f64]| effect.energy(motion(&scene, x, &still, &[]));
        // Without friction and at rest relative to obstacles at rest the force is the slope of the energy.
        let mut bare = vec![0.0; count];
        effect.force(at(&x, &still, &[]), &mut bare);
        let mut touched = 0;
        for number in 0..count {
            let change = |by: f64| {
                let mut x = x.clone();
                x[number] += by;
                energy(&x)
            };
            let slope = (change(1e-7) - change(-1e-7)) / 2e-7;
            if x[2 * (number / 2)] > 0.6 {
                continue; // The moving ball dissipates.
            }
            touched += usize::from(slope != 0.0);
            assert!(
                (bare[number] + slope).abs() < 1e-5 * (1.0 + slope.abs()),
                "{number}: {} and {slope}",
                bare[number]
            );
        }
        assert!(touched > 8, "{touched}");
        // The matrix and the product agree, and the damping is the slope of the force by velocity.
        let mut pairs = Vec::new();
        effect.sparsity_pattern(&[], &mut |a, b| pairs.push([a, b]));
        let mut matrix = BlockMatrix::<2>::new(count / 2, &pairs);
        let weights = Weights { position: 0.0, velocity: 1.0, tangent: Tangent::Exact };
        effect.add_stiffness(at(&x, &v, &anchors), weights, &mut matrix);
        let d: Vec<_> = (0..count).map(|_| random.between(-1.0, 1.0)).collect();
        let mut product = vec![0.0; count];
        matrix.add_product(&d, &mut product);
        let moved = |by: f64| force(&x, &v.iter().zip(&d).map(|(v, d)| v + by * d).collect::<Vec<_>>());
        let (ahead, behind) = (moved(1e-6), moved(-1e-6));
        let greatest = product.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let mut matched = 0;
        for number in 0..count {
            let slope = (behind[number] - ahead[number]) / 2e-6;
            // Sliding limits friction by the pressure, which is damped: an unsymmetric part that is omitted.
            matched += usize::from((product[number] - slope).abs() < 1e-3 * greatest);
        }
        assert!(matched >= count - 8, "{matched} of {count}");
        let mut times = vec![0.0; count];
        effect.stiffness_times(at(&x, &v, &anchors), &d, &mut times);
        let mut matrix = BlockMatrix::<2>::new(count / 2, &pairs);
        effect.add_stiffness(at(&x, &v, &anchors), Weights { position: 1.0, velocity: 0.0, ..weights }, &mut matrix);
        let mut product = vec![0.0; count];
        matrix.add_product(&d, &mut product);
        assert!(times.iter().zip(&product).all(|(a, b)| (a - b).abs() <= 1e-9 * (1.0 + a.abs())));
    }
}

/// Energy gain in 20 s of bouncing, 3 s where a scheme controls its error or is implicit, as a share of that of the drop, by scheme and step [ms]; the bounds are those of the scheme
/// without contact, or a few times the figure measured.
#[test]
fn bouncing_gains_no_energy() {
    let level = disk(2.0, "(effect: Contact()),");
    let drop = 12.5 * 2.0 * 0.3;
    let limit = {
        let scene = Scene::build(&level, level.mode, &NoFiles, None).unwrap();
        critical_step(&scene, &scene.start, None).unwrap()
    };
    assert!(1.9e-3 < 0.5 * limit, "steps are at most 1/w: {limit}");
    for (scheme, step, most) in [
        ("SymplecticEuler()", 1.9, 0.1),
        ("VelocityVerlet()", 1.9, 0.01),
        ("PositionVerlet()", 1.9, 0.01),
        ("RungeKutta4()", 1.9, 1e-4),
        ("DormandPrince(relative: 1e-4, absolute: 1e-4)", 1000.0 / 60.0, 5e-4),
        ("DormandPrince(relative: 1e-6, absolute: 1e-6)", 1000.0 / 60.0, 1e-5),
        ("ImplicitEuler()", 1000.0 / 60.0, 1e-11),
        ("LinearlyImplicitEuler()", 1000.0 / 60.0, 1e-11),
        ("Bdf2()", 1000.0 / 60.0, 1e-11),
        ("ImplicitMidpoint()", 1.0, 0.01),
        ("EnergyMomentum()", 1.0, 0.01),
        ("EnergyMomentum()", 1.0, 1e-8),
        ("EnergyMomentum()", 4.0, 1e-8),
        ("EnergyMomentum()", 1000.0 / 60.0, 1e-8),
    ] {
        let mut simulation = started(&level, scheme, 1e-3 * step);
        let explicit = integrator(scheme).kind().class() == Class::Explicit;
        let gain = gain(&mut simulation, if explicit { 20.0 } else { 3.0 }) / drop;
        assert!(gain <= most, "{scheme} at {step} ms: {gain:e}");
        let counts = simulation.counts();
        assert!(counts.rejected * 20 <= counts.inner_steps, "{scheme}: {} rejected", counts.rejected);
        assert_eq!(counts.unconverged, 0, "{scheme}");
    }
}

/// Heun's method and forward Euler gain energy in any motion. From the rebound of an impact on, they gain at most twice as much with
/// further impacts as in free flight without weight.
#[test]
fn unstable_schemes_gain_as_without_contact() {
    let level = disk(2.0, "(effect: Contact()),");
    let mut precise = started(&level, "RungeKutta4()", 5e-4);
    advance(&mut precise, 1.0);
    let free = Level { effects: Vec::new(), ..level.clone() };
    for (scheme, step) in [("Heun()", 1e-3), ("Heun()", 5e-4), ("ForwardEuler()", 2e-5), ("ForwardEuler()", 1e-5)] {
        let [with, without] = [&level, &free].map(|level| {
            let scene = started(level, scheme, step).scene().clone();
            let mut simulation = Simulation::new(scene, precise.state().clone());
            let start = simulation.energies().total();
            advance(&mut simulation, 1.5);
            simulation.energies().total() - start
        });
        assert!(with > 0.0 && with < 2.0 * without, "{scheme} {step}: {with} {without}");
    }
}

/// Error control works through impacts: few steps are rejected, also in hard ones. Under 9.8 m/s² corotated triangles are crushed
/// inside out, and the outsides of their boundary with them: there the disk touches the floor alone.
#[test]
fn dormand_prince_rejects_few_steps_in_impacts() {
    let with_self = "(effect: Contact()),";
    let of_model = |level: Level, model: Model| {
        let mut level = level;
        level.bodies[0].material = level.bodies[0].material.with_model(model);
        level
    };
    for (level, share) in
        [(disk(2.0, with_self), 0.05), (of_model(disk(9.8, with_self), Model::NeoHookean), 0.2), (disk(9.8, ""), 0.2)]
    {
        for tolerance in ["1e-4", "1e-6"] {
            let scheme = format!("DormandPrince(relative: {tolerance}, absolute: {tolerance})");
            let mut simulation = started(&level, &scheme, 1.0 / 60.0);
            advance(&mut simulation, 3.0);
            let counts = simulation.counts();
            let rejected = counts.rejected as f64 / counts.inner_steps as f64;
            assert!(rejected <= share, "{share}, {tolerance}: {} of {}", counts.rejected, counts.inner_steps);
        }
    }
}

#[test]
fn every_scheme_keeps_its_order_through_an_impact() {
    let mut level = disk(2.0, "(effect: Rayleigh(mass: 1, stiffness: 0.02)), (effect: Contact(dissipation: 1)),");
    level.bodies[0].velocity.1 = Velocity::new(-1.0).unwrap();
    let positions = |scheme: &str, steps: u32| {
        let mut simulation = started(&level, scheme, 1.0 / f64::from(steps));
        advance(&mut simulation, 0.5);
        let lowest = simulation.state().x.iter().skip(1).step_by(2).copied().fold(1.0, f64::min);
        assert!(lowest < 0.01, "in contact");
        simulation.state().x.clone()
    };
    let fine = positions("RungeKutta4()", 16384);
    for (scheme, steps, order, tolerance) in [
        ("SymplecticEuler()", 2048, 1.0, 0.05),
        ("LinearlyImplicitEuler()", 2048, 1.0, 0.05),
        ("ImplicitEuler()", 2048, 1.0, 0.05),
        ("VelocityVerlet()", 2048, 2.0, 0.15),
        ("PositionVerlet()", 2048, 2.0, 0.15),
        ("Heun()", 2048, 2.0, 0.15),
        ("ImplicitMidpoint()", 512, 2.0, 0.15),
        ("EnergyMomentum()", 512, 2.0, 0.15),
        ("Bdf2()", 512, 2.0, 0.15),
        ("RungeKutta4()", 2048, 4.0, 0.6),
    ] {
        let error = |steps: u32| {
            let x = positions(scheme, steps);
            x.iter().zip(&fine).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
        };
        let measured = f64::log2(error(steps) / error(2 * steps));
        assert!((measured - order).abs() <= tolerance, "{scheme}: {measured}");
    }
}

/// A stiff damped block on that slope.
fn on_slope(friction: f64) -> Level {
    let [s, c] = SLOPE;
    level(&format!(
        "(name: \"\", bodies: [(name: \"block\", mesh: Rectangle(corner: (0, 0), width: 0.2, height: 0.1, columns: 8, rows: 4),
            place: (turn: 26.565051177077990),
            material: (model: Corotated, young: 20000, poisson: 0.3, plane: Stress), mass: Density(100))],
        effects: [(effect: Gravity(down: 9.81)), (effect: Rayleigh(mass: 0, stiffness: 0.001)), (effect: Friction(coefficient: {friction})),
            (effect: Contact(modulus: 1, dissipation: 10)),
            (effect: Walls(obstacles: [Plane(point: (0.00413, -0.00826), normal: (-{s}, {c}), eps: 0.01)]))])"
    ))
}

/// Distance of the centre of mass down the slope from its rest position [m].
fn slid(simulation: &Simulation) -> f64 {
    let (scene, x) = (simulation.scene(), &simulation.state().x);
    let along = |number: usize| if number.is_multiple_of(2) { SLOPE[1] } else { SLOPE[0] };
    let moved = |number: usize| scene.mass[number] * along(number) * (scene.rest[number] - x[number]);
    2.0 * (0..x.len()).map(moved).sum::<f64>() / scene.mass.iter().sum::<f64>()
}

/// A block that came to rest with friction 1 is released with less. It slides with `g cos (tan - mu)`, or stays. The acceleration is
/// taken from three places, as the release of the elastic tractions leaves a small velocity.
#[test]
fn friction_on_a_slope_is_that_of_coulomb() {
    for (scheme, step) in [
        ("SymplecticEuler()", 0.2),
        ("ForwardEuler()", 0.1),
        ("VelocityVerlet()", 0.1),
        ("PositionVerlet()", 0.1),
        ("Heun()", 0.2),
        ("RungeKutta4()", 0.2),
        ("DormandPrince(relative: 1e-6, absolute: 1e-6)", 12.5),
        ("LinearlyImplicitEuler()", 12.5),
        ("ImplicitEuler()", 12.5),
        ("ImplicitMidpoint()", 1.0),
        ("EnergyMomentum()", 1.0),
        ("Bdf2()", 12.5),
    ] {
        let step = 1e-3 * step;
        for friction in [0.4, 0.49, 0.51, 1.0] {
            let mut simulation = started(&on_slope(1.0), scheme, step);
            advance(&mut simulation, 1.0);
            simulation.replace_scene(started(&on_slope(friction), scheme, step).scene().clone());
            let places = [0.5, 1.0, 1.0].map(|time| {
                advance(&mut simulation, time);
                slid(&simulation)
            });
            if friction > 0.5 {
                let crept = places[2] - places[0];
                assert!(crept.abs() < 1e-5, "{scheme}, {friction}: crept {crept:e} m in 2 s");
                continue;
            }
            let acceleration = places[2] - 2.0 * places[1] + places[0];
            let expected = 9.81 * SLOPE[1] * (0.5 - friction);
            let error = acceleration / expected - 1.0;
            let tolerance = if friction == 0.4 { 0.001 } else { 0.005 };
            assert!(error.abs() < tolerance, "{scheme}, {friction}: {error:e}");
        }
    }
}

/// The work of the mean pressure is the change of the energy, for changes of any size, and its derivatives are those of it.
#[test]
fn the_mean_pressure_does_the_work_of_the_energy() {
    let skin = Potential { modulus: 3000.0, thickness: 0.01 };
    for gap in [-0.004, 0.0, 0.0031, 0.007, 0.0099, 0.0101] {
        for change in [1e-7, 9e-6, 1.1e-5, -1e-3, 4e-3, -0.02] {
            let [mean, by_gap, by_change] = skin.mean_pressure(gap, change);
            let energy = skin.energy(gap + 0.5 * change) - skin.energy(gap - 0.5 * change);
            assert!((mean * change + energy).abs() < 1e-11 * skin.energy(0.0), "{gap} {change}: {mean}");
            let slope =
                |h: f64| (skin.mean_pressure(gap + h, change)[0] - skin.mean_pressure(gap - h, change)[0]) / (2.0 * h);
            assert!((by_gap - slope(1e-7)).abs() < 1e-4 * 3e5, "{gap} {change}: {by_gap} {}", slope(1e-7));
            if change.abs() > 1e-4 {
                let turn = |h: f64| {
                    (skin.mean_pressure(gap, change + h)[0] - skin.mean_pressure(gap, change - h)[0]) / (2.0 * h)
                };
                assert!((by_change - turn(1e-7)).abs() < 1e-4 * 3e5, "{gap} {change}: {by_change} {}", turn(1e-7));
            }
        }
    }
}

/// A block that falls on the tip of a wedge, between two of its vertices, is thrown back by the skin of its edge: nothing is
/// truncated, and no energy is lost, with every scheme that loses none by itself.
#[test]
fn a_sharp_corner_carries_an_edge_by_its_potential() {
    let text = "(name: \"\", bodies: [(name: \"block\", mesh: Rectangle(corner: (0.37, 0.25), width: 0.2, height: 0.1, columns: 4, rows: 2),
            material: (model: NeoHookean, young: 20000, poisson: 0.3, plane: Strain), mass: Density(100))],
        effects: [(effect: Gravity(down: 9.8)), (effect: Contact(modulus: 10)),
            (effect: Walls(obstacles: [Polygon(points: [(0.3, 0), (0.65, 0), (0.48, 0.2)], eps: 0.001)]))])";
    for (scheme, step, most) in [
        ("SymplecticEuler()", 0.1, 0.02),
        ("VelocityVerlet()", 0.1, 1e-3),
        ("PositionVerlet()", 0.1, 1e-3),
        ("RungeKutta4()", 0.1, 1e-4),
        ("DormandPrince(relative: 1e-6, absolute: 1e-6)", 1.0, 1e-4),
        ("ImplicitMidpoint()", 0.5, 0.02),
        ("EnergyMomentum()", 0.5, 0.02),
    ] {
        let mut simulation = started(&level(text), scheme, 1e-3 * step);
        let start = simulation.energies();
        let (mut touched, mut change) = (false, 0.0_f64);
        while simulation.state().time < 0.3 {
            simulation.advance(1, &mut || true);
            touched |= !simulation.state().anchors.is_empty();
            change = change.max((simulation.energies().total() - start.total()).abs());
        }
        assert!(touched && simulation.counts().constrained == 0, "{scheme}: {:?}", simulation.counts());
        // The energy of a fall of 5 cm.
        let fall = 2.0 * 9.8 * 0.05;
        assert!(change < most * fall, "{scheme}: {change} J of {fall} J");
    }
}

#[test]
fn a_rigid_mass_bounces_with_the_stated_restitution() {
    for (dissipation, speed, known) in
        [(0.2_f64, 1.0_f64, 0.882), (1.0, 1.0, 0.594), (5.0, 1.0, 0.197), (1.0, 0.2, 0.882)]
    {
        let skin = Potential { modulus: 3000.0, thickness: 0.01 };
        // 1 kg on 1 m² of skin is slow enough to turn within it; symplectic Euler in short steps.
        let (mut gap, mut v, h) = (0.01_f64, -speed, 1e-7_f64);
        let mut turned = false;
        while !turned || gap < 0.01 {
            v += h * skin.pressure(gap) * (1.0 - dissipation * v).max(0.0) / 0.05;
            gap += h * v;
            turned |= v > 0.0;
        }
        let e = restitution(dissipation, speed);
        assert!((v / speed - e).abs() < 1e-4, "{} and {e}", v / speed);
        assert!((e - known).abs() < 5e-4);
    }
    assert_eq!(restitution(0.0, 1.0), 1.0);
}

/// Two walls press a disk to 70 % of its height and open again: the energy that they supply is their work.
#[test]
fn moving_walls_do_work() {
    let text = "(name: \"\", bodies: [(name: \"disk\", mesh: Disk(centre: (0.5, 0.5), radius: 0.2, rings: 6),
            material: (model: StableNeoHookean, young: 1000, poisson: 0.3, plane: Stress), mass: Total(12.5))],
        effects: [(effect: Contact()), (effect: Walls(obstacles: [
            Moving(obstacle: Plane(point: (0, 0.28), normal: (0, 1), eps: 0.01), motions: [Swing(way: (0, 0.07), period: 1)]),
            Moving(obstacle: Plane(point: (0, 0.72), normal: (0, -1), eps: 0.01), motions: [Swing(way: (0, -0.07), period: 1)])]))])";
    for (scheme, step, share) in [
        ("SymplecticEuler()", 1.0, 0.02),
        ("VelocityVerlet()", 1.0, 1e-3),
        ("PositionVerlet()", 1.0, 1e-3),
        ("RungeKutta4()", 1.0, 1e-3),
        ("Heun()", 0.2, 1e-3),
        ("ImplicitMidpoint()", 1.0, 0.01),
        ("EnergyMomentum()", 1.0, 0.01),
        ("DormandPrince(relative: 1e-6, absolute: 1e-6)", 1.0, 1e-3),
        ("ImplicitEuler()", 1.0, 1e-9),
        ("LinearlyImplicitEuler()", 1.0, 1e-9),
        ("Bdf2()", 1.0, 1e-3),
    ] {
        let mut simulation = started(&level(text), scheme, 1e-3 * step);
        let excess = gain(&mut simulation, 0.25);
        let energy = simulation.energies().total();
        assert!(energy > 3.0, "{scheme}: pressed, {energy} J");
        assert!(excess <= share * energy, "{scheme}: {excess:e} of {energy} J");
        let dissipates =
            simulation.scene().integrator.kind().class() == Class::Implicit && !scheme.contains("Midpoint");
        let missing = simulation.work_of_obstacles() - energy;
        assert!(missing.abs() <= if dissipates { 0.2 } else { share } * energy, "{scheme}: {missing:e} of {energy} J");
    }
}

/// Saved within an impact, with anchors of friction, and continued: every bit is the same; also with multirate stepping.
#[test]
fn a_saved_impact_continues_bit_for_bit() {
    let text = "(name: \"\", bodies: [
            (name: \"one\", mesh: Rectangle(corner: (0.1, 0.02), width: 0.2, height: 0.1, columns: 8, rows: 4), velocity: (1, -0.5),
                material: (model: Corotated, young: 1000, poisson: 0.3, plane: Stress), mass: Density(100)),
            (name: \"stiff\", mesh: Rectangle(corner: (0.6, 0.02), width: 0.2, height: 0.1, columns: 8, rows: 4), velocity: (-1, -0.5),
                material: (model: NeoHookean, young: 50000, poisson: 0.3, plane: Stress), mass: Density(100))],
        effects: [(effect: Gravity(down: 5)), (effect: Friction(coefficient: 0.5)), (effect: Contact(dissipation: 0.5)),
            (effect: Boundary(least: (0, 0), greatest: (1, 1)))])";
    for scheme in SCHEMES {
        for paces in [SubstepMode::Same, SubstepMode::Own] {
            let level = Level { integrator: integrator(scheme), paces, ..level(text) };
            let mut simulation = crate::common::simulation(&level);
            simulation.advance(7, &mut || true);
            assert!(simulation.state().anchors.is_empty(), "{scheme}");
            while simulation.state().anchors.len() <= 4 {
                assert!(
                    simulation.state().time < 1.0 && simulation.fault().is_none(),
                    "{scheme}: {:?}",
                    simulation.fault()
                );
                simulation.advance(1, &mut || true);
            }
            simulation.advance(3, &mut || true);
            let mut continued = reopened(&simulation, &level);
            assert_eq!(continued.state(), simulation.state(), "{scheme}");
            for simulation in [&mut simulation, &mut continued] {
                simulation.advance(53, &mut || true);
            }
            assert_eq!(continued.state(), simulation.state(), "{scheme}");
        }
    }
}

/// The house with each scheme: a stable one gains less energy than without contact, at a step of 1/w or a frame.
#[test]
fn the_house_gains_no_energy_with_any_scheme() {
    let text = levels::built_in("gingerbread_house").unwrap().replace("resolution: 2000", "resolution: 600");
    let base = Level { mode: RunMode::Collide, ..level(&text) };
    let scene = Scene::build(&base, base.mode, &NoFiles, None).unwrap();
    let step = 0.5 * critical_step(&scene, &scene.start, None).unwrap();
    for scheme in SCHEMES {
        let kind = integrator(scheme);
        if kind.kind().stability_limit() == Some(0.0) {
            // Forward Euler and Heun are unstable without damping, with and without contact.
            continue;
        }
        let explicit = kind.kind().class() == Class::Explicit;
        let mut simulation = started(
            &base,
            scheme,
            if explicit {
                step
            } else if scheme.contains("Midpoint") {
                1e-3
            } else {
                1.0 / 60.0
            },
        );
        let start = simulation.energies().total();
        let gain = gain(&mut simulation, 1.5) / start;
        let most =
            if ["Symplectic", "1e-4", "Midpoint"].iter().any(|name| scheme.contains(name)) { 0.01 } else { 0.001 };
        assert!(gain <= most, "{scheme}: {gain:e}");
        assert!(simulation.scene().effects.iter().any(|effect| effect.contact().is_some()));
    }
}

/// A disk that begins half inside the floor, the boundary and a ball comes out without a jump, with every scheme.
#[test]
fn what_begins_inside_is_parted_gently() {
    let text = "(name: \"\", substeps: 40, sleep: Off, bodies: [(name: \"disk\", mesh: Disk(centre: (0.15, 0.1), radius: 0.2, rings: 4),
            material: (model: StableNeoHookean, young: 1000, poisson: 0.3, plane: Stress), mass: Total(12.5))],
        effects: [(effect: Rayleigh(mass: 1, stiffness: 0.002)), (effect: Contact(dissipation: 1)), (effect: Friction(coefficient: 0.3)),
            (effect: Boundary(least: (0, -1), greatest: (1, 1))),
            (effect: Walls(obstacles: [Plane(point: (0, 0), normal: (0, 1), eps: 0.01), Ball(centre: (0.3, 0), radius: 0.05, eps: 0.01)]))])";
    for scheme in SCHEMES {
        let level = Level { integrator: integrator(scheme), ..level(text) };
        let mut simulation = crate::common::simulation(&level);
        let mut fastest = 0.0_f64;
        assert!(simulation.energies().total().abs() < 1e-12, "an initial penetration has no energy");
        for _ in 0..120 {
            simulation.advance(simulation.scene().steps_per_frame(), &mut || true);
            assert!(simulation.fault().is_none(), "{scheme}: {:?}", simulation.fault());
            fastest = simulation.state().v.iter().fold(fastest, |most, v| most.max(v.abs()));
        }
        // The waves in it travel at 3 m/s.
        assert!(fastest < 3.0, "{scheme}: {fastest} m/s");
        assert_eq!(simulation.inversion().1, 0, "{scheme}");
        assert!(simulation.state().anchors.iter().all(|anchor| anchor.penetration == 0.0), "{scheme}");
        let out =
            simulation.state().x.chunks_exact(2).all(|x| x[0] > 0.0 && x[1] > 0.0 && (x[0] - 0.3).hypot(x[1]) > 0.05);
        assert!(out, "{scheme}");
    }
}

/// A block that was pushed comes to rest after `v²/(2 mu g)`.
#[test]
fn a_sliding_block_stops_where_coulomb_says() {
    let base = level(
        "(name: \"\", bodies: [(name: \"block\", mesh: Rectangle(corner: (0, 0.0073), width: 0.2, height: 0.05, columns: 8, rows: 2),
            material: (model: Corotated, young: 20000, poisson: 0.3, plane: Stress), mass: Density(100))],
        effects: [(effect: Gravity(down: 9.81)), (effect: Rayleigh(mass: 0, stiffness: 0.001)), (effect: Friction(coefficient: 0.3)),
            (effect: Contact(modulus: 1, dissipation: 20)),
            (effect: Walls(obstacles: [Plane(point: (0, 0), normal: (0, 1), eps: 0)]))])",
    );
    for (scheme, step) in [
        ("SymplecticEuler()", 0.1),
        ("VelocityVerlet()", 0.1),
        ("RungeKutta4()", 0.1),
        ("DormandPrince(relative: 1e-6, absolute: 1e-6)", 12.5),
        ("ImplicitEuler()", 1.0),
        ("LinearlyImplicitEuler()", 1.0),
        ("ImplicitMidpoint()", 1.0),
        ("EnergyMomentum()", 1.0),
        ("Bdf2()", 1.0),
    ] {
        let mut simulation = started(&base, scheme, 1e-3 * step);
        advance(&mut simulation, 0.5);
        let mut state = simulation.state().clone();
        let middle = |x: &[f64]| x.iter().step_by(2).sum::<f64>() / (x.len() / 2) as f64;
        let from = middle(&state.x);
        state.v.iter_mut().step_by(2).for_each(|v| *v += 1.0);
        simulation.set_state(state);
        advance(&mut simulation, 1.0);
        let way = middle(&simulation.state().x) - from;
        let error = way / (1.0 / (2.0 * 0.3 * 9.81)) - 1.0;
        assert!(error.abs() < 0.005, "{scheme}: {error:e}");
    }
}

/// A stiff undamped disk rolls down a slope of 1 in 5 with `2/3 g sin`: gravity is turned in place of the floor. Damping and a
/// coarse boundary would slow it.
#[test]
fn a_disk_rolls_without_sliding() {
    let base = level(
        "(name: \"\", bodies: [(name: \"disk\", mesh: Disk(centre: (0, 0.1075), radius: 0.1, rings: 16),
            material: (model: Corotated, young: 200000, poisson: 0.3, plane: Stress), mass: Density(100))],
        effects: [(effect: Gravity(down: 9.617, right: 1.9234)), (effect: Friction(coefficient: 0.8)), (effect: Contact(modulus: 1)),
            (effect: Walls(obstacles: [Plane(point: (0, 0), normal: (0, 1), eps: 0)]))])",
    );
    for (scheme, step) in [("VelocityVerlet()", 0.05), ("ImplicitMidpoint()", 0.5), ("Bdf2()", 1.0)] {
        let mut simulation = started(&base, scheme, 1e-3 * step);
        let places = [0.2, 0.4, 0.4].map(|time| {
            advance(&mut simulation, time);
            let (x, mass) = (&simulation.state().x, &simulation.scene().mass);
            let moment: f64 = x.iter().zip(mass).step_by(2).map(|(x, mass)| x * mass).sum();
            moment / mass.iter().step_by(2).sum::<f64>()
        });
        let acceleration = (places[2] - 2.0 * places[1] + places[0]) / 0.16;
        let error = acceleration / (2.0 / 3.0 * 1.9234) - 1.0;
        assert!(error.abs() < 0.01, "{scheme}: {error:e}");
    }
}

/// A disk is pressed slowly between two plates: the force against the approach is that of Hertz and Johnson (*Contact Mechanics*,
/// section 5.6), `2 P/(pi E*) (2 ln(4 R/a) - 1)` for both sides with `a² = 4 P R/(pi E*)`, and nearer to it on a finer mesh.
#[test]
fn a_pressed_disk_follows_hertz() {
    let (radius, young, poisson) = (0.2_f64, 1e5_f64, 0.3_f64);
    let error = |rings: u32| {
        let level = level(&format!(
            "(name: \"\", bodies: [(name: \"disk\", mesh: Disk(centre: (0.5, 0.5), radius: {radius}, rings: {rings}),
                material: (model: Corotated, young: {young}, poisson: {poisson}, plane: Strain), mass: Density(100))],
            effects: [(effect: Rayleigh(mass: 20)), (effect: Contact()),
                (effect: Walls(obstacles: [
                    Moving(obstacle: Cuboid(centre: (0.5, 0.2), width: 0.8, height: 0.16, eps: 0.01), motions: [Slide(velocity: (0, 0.01), until: 1.4)]),
                    Moving(obstacle: Cuboid(centre: (0.5, 0.8), width: 0.8, height: 0.16, eps: 0.01), motions: [Slide(velocity: (0, -0.01), until: 1.4)])]))])"
        ));
        let mut simulation = started(&level, "ImplicitEuler()", 0.02);
        advance(&mut simulation, 2.4);
        let (scene, state) = (simulation.scene(), simulation.state());
        let mut force = 0.0;
        for contact in scene.effects.iter().filter_map(|effect| effect.contact()) {
            let AnyContact::Plane(contact) = contact else { unreachable!("in the plane") };
            contact.each(scene.motion(state, None), &mut |touch| {
                force += touch.forces().map(|(_, [_, y])| y.max(0.0)).sum::<f64>();
            });
        }
        let heights = state.x.iter().skip(1).step_by(2);
        let [least, greatest] = heights.fold([1.0_f64, 0.0_f64], |[a, b], y| [a.min(*y), b.max(*y)]);
        let approach = 2.0 * radius - (greatest - least);
        let modulus = young / (1.0 - poisson * poisson);
        let half_width = (4.0 * force * radius / (std::f64::consts::PI * modulus)).sqrt();
        let expected = 2.0 * force / (std::f64::consts::PI * modulus) * (2.0 * (4.0 * radius / half_width).ln() - 1.0);
        approach / expected - 1.0
    };
    let errors = [8, 16, 32].map(error);
    assert!(errors[2].abs() < 0.03 && errors[2].abs() < errors[0].abs(), "{errors:?}");
}

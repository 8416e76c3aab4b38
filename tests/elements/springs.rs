//! Facts about springs, nets, drag and toys.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a failing test should panic")]

use crate::common::{
    Random, assert_balanced, assert_minus_derivative, difference_error, level, norm, reopened, simulation,
};
use gingerbread::{
    effects::{Effect, Motion},
    elements::Springs,
    files,
    integrators::{IntegratorKind, Scheme},
    level::Level,
    meshes::NoFiles,
    nets::{Link, Net, NetKind, Role},
    scene::Scene,
    toys::{ToyKind, period_ratio},
};
use std::f64::consts::PI;

/// The springs of a net of every kind, at places moved at random.
fn nets() -> impl Iterator<Item = (&'static str, Springs, Vec<f64>)> {
    let flat = NetKind::all().into_iter().map(|kind| (kind.kind().build().unwrap(), kind));
    flat.filter(|(net, _)| net.is_flat()).map(|(net, kind)| {
        let mut random = Random(3);
        let x = net.points().as_flattened().iter().map(|x| x + random.between(-0.05, 0.05)).collect();
        (kind.name(), Springs::new(&net, 0..net.points().len()), x)
    })
}

fn at<'a>(x: &'a [f64], v: &'a [f64]) -> Motion<'a> {
    Motion { dimension: 2, x, v, mass: v, inverse_mass: v, ..Motion::NONE }
}

fn forces(springs: &Springs, x: &[f64]) -> Vec<f64> {
    let mut force = vec![0.0; x.len()];
    springs.force(at(x, x), &mut vec![0.0; springs.scratch()], &mut force);
    force
}

#[test]
fn force_is_minus_the_derivative_of_energy() {
    for (name, springs, x) in nets() {
        let force = forces(&springs, &x);
        assert_minus_derivative(&x, &force, |x| springs.elastic_energy(x), name);
    }
}

#[test]
fn spring_stiffness_matches_differences_and_is_symmetric() {
    for (name, springs, x) in nets() {
        let mut random = Random(4);
        let mut shaken = || x.iter().map(|_| random.between(-1.0, 1.0)).collect::<Vec<_>>();
        let (d, other) = (shaken(), shaken());
        let times = |d: &[f64]| {
            let mut product = vec![0.0; x.len()];
            springs.stiffness_times(at(&x, &x), d, &mut [], &mut product);
            product
        };
        let product = times(&d);
        let best = difference_error(&x, &d, &product, |x| forces(&springs, x));
        assert!(best < 1e-8, "{name}: {best:e}");
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (one, two) = (dot(&other, &product), dot(&d, &times(&other)));
        assert!((one - two).abs() < 1e-13 * norm(&product), "{name}: {one} {two}");
    }
}

#[test]
fn forces_of_springs_have_no_sum_and_no_torque() {
    for (name, springs, x) in nets() {
        let force = forces(&springs, &x);
        assert_balanced(&x, &force, name);
    }
}

/// All numbers stay finite.
#[test]
fn a_spring_of_length_zero_gives_no_force() {
    for rest in [0.0, 0.3] {
        let link = Link { ends: [0, 1], stiffness: 7.0, rest, role: Role::Structural };
        let net = Net::new(vec![[0.5, 0.5]; 2], vec![link]).unwrap();
        let (springs, x, d) = (Springs::new(&net, 0..2), net.points().as_flattened(), [0.0, 0.0, 1.0, 2.0]);
        assert_eq!(forces(&springs, x), [0.0; 4]);
        assert_eq!(springs.elastic_energy(x), 0.5 * 7.0 * rest * rest);
        let mut product = [0.0; 4];
        springs.stiffness_times(at(x, x), &d, &mut [], &mut product);
        assert_eq!(product, [-7.0, -14.0, 7.0, 14.0]);
    }
    let text = "(name: \"\", nets: [(name: \"point\", net: Chain(from: (0.5, 0.5), to: (0.5, 0.5), springs: 4, stiffness: 10, rest: 0.1), mass: 1)],
        effects: [(effect: Rayleigh(mass: 1, stiffness: 0.1)), (effect: Gravity(down: 1))])";
    let mut simulation = simulation(&level(text));
    assert_eq!(simulation.advance(500, &mut || true), 500, "{:?}", simulation.fault());
}

/// At rest it is `-beta K v`; a rigid motion of a stretched net is not damped at all; it never gives power.
#[test]
fn rayleigh_damping_of_springs_is_a_damper_beside_each() {
    let text = "(name: \"\", nets: [(name: \"net\", net: Sheet(width: 0.4, height: 0.4, columns: 4, rows: 4, structural: 100,
        shear: 30, flexion: 10, corner: (0.3, 0.3)), mass: 0.1)], effects: [(effect: Rayleigh(mass: 0, stiffness: 0.02))])";
    let simulation = simulation(&level(text));
    let scene = simulation.scene();
    let [springs, damping] = scene.effects.as_slice() else { panic!("the net and its damping") };
    let damped = |x: &[f64], v: &[f64]| {
        let mut force = vec![0.0; x.len()];
        damping.force(Motion { mass: &scene.mass, ..at(x, v) }, &mut [], &mut force);
        force
    };
    let mut random = Random(8);
    let v: Vec<f64> = scene.rest.iter().map(|_| random.between(-1.0, 1.0)).collect();
    let mut expected = vec![0.0; v.len()];
    springs.stiffness_times(at(&scene.rest, &v), &v, &mut [], &mut expected);
    let force = damped(&scene.rest, &v);
    let gap: Vec<_> = force.iter().zip(&expected).map(|(force, product)| force + 0.02 * product).collect();
    assert!(norm(&gap) < 1e-13 * norm(&expected));
    let stretched: Vec<f64> = scene.rest.iter().map(|x| 1.4 * x).collect();
    let spinning: Vec<f64> = stretched.chunks_exact(2).flat_map(|p| [1.0 - 5.0 * p[1], 2.0 + 5.0 * p[0]]).collect();
    assert!(norm(&damped(&stretched, &spinning)) < 1e-13);
    let power: f64 = damped(&stretched, &v).iter().zip(&v).map(|(f, v)| f * v).sum();
    assert!(power < -1e-3, "{power}");
}

/// With drag alone symplectic Euler multiplies every velocity by `1 - h k/m` in a step.
#[test]
fn drag_slows_a_free_particle_by_its_coefficient_over_its_mass() {
    let text =
        "(name: \"\", nets: [(name: \"two\", net: Chain(from: (0, 0), to: (1, 0), springs: 1, stiffness: 5), mass: 0.5,
        velocity: (2, 0))], effects: [(effect: Drag(coefficient: 3))])";
    let mut simulation = simulation(&level(text));
    let h = simulation.scene().step;
    simulation.advance(1000, &mut || true);
    let expected = 2.0 * (1.0 - h * 3.0 / 0.5).powi(1000);
    assert!((simulation.state().v[0] - expected).abs() < 1e-12);
    assert!(
        gingerbread::effects::EffectKind::all().iter().any(|kind| kind.name() == "Drag" && kind.kind().is_damping())
    );
}

fn refused(net: &str) -> String {
    let text = format!("(name: \"\", nets: [(name: \"web\", net: {net}, mass: 1)])");
    let level = level(&text);
    let built = Scene::build(&level, level.mode, &NoFiles, None);
    built.err().map(|error| error.to_string()).unwrap_or_default()
}

#[test]
fn a_net_that_cannot_be_is_refused_with_a_sentence() {
    for (net, expected) in [
        (
            "Links(points: [(0, 0), (1, 0)], springs: [(0, 2, 1, 1)])",
            "spring 0 names particle 2, but the last particle is 1",
        ),
        (
            "Links(points: [(0, 0), (1, 0)], springs: [(0, 1, 1, 1), (1, 1, 1, 1)])",
            "spring 1 goes from particle 1 to itself",
        ),
        ("Links(points: [(0, 0), (1, 0), (2, 0)], springs: [(0, 1, 1, 1)])", "no spring holds particle 2"),
        ("Links(points: [(0, 0)], springs: [])", "no springs"),
        (
            "Sheet(width: 1, height: 1, columns: 1000000, rows: 1000000, structural: 1, shear: 1, flexion: 1, corner: (0, 0))",
            "at most",
        ),
    ] {
        let told = refused(net);
        assert!(told.contains(expected) && told.contains("\"web\""), "{net}: {told}");
    }
    for (mistake, expected) in [
        ("mass: 0", "particle mass must be greater than 0 and at most 1e12 kg, got 0"),
        ("mass: 1, pins: [Vertex(x)]", "integer"),
        ("mass: 1, colour: 2", "colour"),
    ] {
        let text = format!(
            "(name: \"\", nets: [(name: \"\", net: Chain(from: (0, 0), to: (1, 0), springs: 1, stiffness: 1), {mistake})])"
        );
        let told = files::parse(&text, "bad.ron").unwrap_err().to_string();
        assert!(told.contains(expected), "{mistake}: {told}");
    }
    let fraction =
        "(name: \"\", nets: [(name: \"\", net: Chain(from: (0, 0), to: (1, 0), springs: 1.5, stiffness: 1), mass: 1)])";
    assert!(files::parse(fraction, "bad.ron").unwrap_err().to_string().contains("whole number"));
}

const SWINGING: &str = "(name: \"both\",
    bodies: [(name: \"sheet\", mesh: Rectangle(width: 0.2, height: 0.2, columns: 2, rows: 2), mass: Total(1),
        material: (model: Corotated, young: 100, poisson: 0.3))],
    nets: [
        (name: \"chain\", net: Chain(from: (0.5, 0.9), to: (0.9, 0.9), springs: 3, stiffness: 500), mass: 0.2, pins: [Left]),
        (name: \"net\", net: Sheet(width: 0.3, height: 0.3, columns: 3, rows: 3, structural: 50, shear: 20, flexion: 10,
            corner: (0.1, 0.6)), mass: 0.05, velocity: (1, 0), pins: [Top, Vertex(0)]),
    ],
    effects: [(effect: Gravity(down: 3)), (effect: Drag(coefficient: 0.02)), (effect: Rayleigh(mass: 0, stiffness: 0.0005))])";

#[test]
fn pinned_particles_keep_every_bit() {
    let mut simulation = simulation(&level(SWINGING));
    assert_eq!(simulation.scene().pins.len(), 1 + 4 + 1);
    let start = simulation.state().clone();
    simulation.advance(2000, &mut || true);
    for &pin in simulation.scene().pins.iter() {
        for number in [2 * pin as usize, 2 * pin as usize + 1] {
            assert_eq!(simulation.state().x[number].to_bits(), start.x[number].to_bits());
            assert_eq!(simulation.state().v[number], 0.0);
        }
    }
    assert_ne!(simulation.state().x, start.x);
}

#[test]
fn saving_and_resuming_is_exact() {
    let mut straight = simulation(&level(SWINGING));
    straight.advance(900, &mut || true);
    let mut first = simulation(&level(SWINGING));
    first.advance(311, &mut || true);
    let mut second = reopened(&first, &level(SWINGING));
    second.advance(589, &mut || true);
    assert_eq!(second.state(), straight.state());
}

#[test]
fn a_spring_that_is_too_stiff_for_the_step_is_named() {
    let text = "(name: \"\", substeps: 1, guard: Off, nets: [(name: \"wire\", net: Chain(from: (0, 0), to: (1, 0), springs: 2, stiffness: 1e6, rest: 0.4), mass: 1)])";
    let mut simulation = simulation(&level(text));
    simulation.advance(100_000, &mut || true);
    let fault = simulation.fault().unwrap().to_string();
    assert!(fault.contains("of wire failed first") && fault.contains("above the stability limit"), "{fault}");
}

/// They come back after a period.
#[test]
fn exact_solutions_of_toys_satisfy_their_equations() {
    for kind in ToyKind::all() {
        let (toy, name) = (kind.kind(), kind.name());
        for time in [0.0, 0.3, 0.77, 2.0, 5.1] {
            let (state, epsilon) = (toy.exact(time), 1e-5);
            let (ahead, behind) = (toy.exact(time + epsilon), toy.exact(time - epsilon));
            let (later, rate) = (toy.exact(time + toy.period()), toy.rate(state));
            for number in 0..2 {
                let slope = (ahead[number] - behind[number]) / (2.0 * epsilon);
                assert!((slope - rate[number]).abs() < 1e-7, "{name} at {time}: {slope} {}", rate[number]);
                assert!((later[number] - state[number]).abs() < 1e-12, "{name} at {time}");
            }
            let energy = |state| toy.energies(state).iter().sum::<f64>();
            assert!((energy(state) / energy(toy.exact(0.0)) - 1.0).abs() < 1e-12, "{name} at {time}");
        }
        let later = toy.exact(1000.0 * toy.period());
        assert!(later.iter().zip(toy.exact(0.0)).all(|(a, b)| (a - b).abs() < 1e-9), "{name}");
    }
}

/// 2 K(sin(theta0/2))/pi from tables of the complete elliptic integral.
#[test]
fn a_wide_swing_takes_longer() {
    for (degrees, ratio) in [(10.0, 1.001_907_19), (45.0, 1.039_973_4), (90.0, 1.180_340_60), (120.0, 1.372_880_5)] {
        let computed = period_ratio(f64::to_radians(degrees));
        assert!((computed - ratio).abs() < 1e-7, "{degrees}: {computed}");
    }
    assert!((period_ratio(1e-4) - 1.0).abs() < 1e-9);
    // K(sin 45°) = Γ(1/4)² / (4 sqrt(pi)).
    let quarter = 3.625_609_908_221_908_f64;
    assert!((period_ratio(PI / 2.0) - quarter * quarter / (4.0 * PI.sqrt()) * 2.0 / PI).abs() < 1e-14);
    assert!(period_ratio(f64::to_radians(179.9)).is_finite());
}

#[test]
fn a_stiff_spring_pendulum_approaches_the_rigid_one() {
    let gap = |stiffness: f64| {
        let text = format!(
            "(name: \"\", substeps: 500, nets: [(name: \"p\", net: Chain(from: (0.5, 0.5), to: (0.9, 0.5), springs: 1,
             stiffness: {stiffness}), mass: 1, pins: [Left])], effects: [(effect: Gravity(down: 9.8))])"
        );
        let mut simulation = simulation(&level(&text));
        let h = simulation.scene().step;
        let mut crossings = Vec::new();
        while crossings.len() < 2 {
            let before = simulation.state().x[2] - 0.5;
            assert_eq!(simulation.advance(1, &mut || true), 1);
            let after = simulation.state().x[2] - 0.5;
            if before > 0.0 && after <= 0.0 {
                crossings.push(simulation.state().time - h * after / (after - before));
            }
        }
        let exact = ToyKind::all().into_iter().find(|toy| toy.name() == "Pendulum").unwrap().kind().period();
        ((crossings[1] - crossings[0]) / exact - 1.0).abs()
    };
    let gaps = [1e3, 1e4, 1e5].map(gap);
    assert!(gaps[1] < 0.3 * gaps[0] && gaps[2] < 0.3 * gaps[1] && gaps[2] < 1e-3, "{gaps:?}");
}

/// A level about a toy, with an integrator.
fn toy(kind: &ToyKind, integrator: &IntegratorKind) -> Level {
    let empty = level("(name: \"toy\", toy: Circle(radius: 0.2))");
    Level { toy: Some(kind.clone()), integrator: integrator.clone(), ..empty }
}

/// What treats positions and velocities differently is refused in a sentence; all else goes around once, nearly.
#[test]
fn first_order_schemes_advance_toys_others_are_refused() {
    for integrator in IntegratorKind::all() {
        for kind in ToyKind::all() {
            let level = toy(&kind, &integrator);
            let built = Scene::build(&level, level.mode, &NoFiles, None);
            if matches!(integrator.kind().scheme(), Scheme::Second(_)) {
                let told = built.err().unwrap().to_string();
                assert!(told.contains(integrator.kind().title()) && told.contains("choose another"), "{told}");
                continue;
            }
            let mut simulation = simulation(&level);
            let steps = (kind.kind().period() / simulation.scene().step).round() as u64;
            assert_eq!(simulation.advance(steps, &mut || true), steps);
            let (state, exact) = (simulation.state(), kind.kind().exact(simulation.state().time));
            let gap = [state.x[0] - exact[0], state.x[1] - exact[1]];
            assert!(norm(&gap) < 0.02 * norm(&exact), "{} {}: {gap:?}", integrator.name(), kind.name());
            assert!(state.v.is_empty() && simulation.counts().force_evaluations >= steps);
            let mut again = reopened(&simulation, &level);
            assert_eq!(again.state(), state);
            again.advance(10, &mut || true);
            simulation.advance(10, &mut || true);
            assert_eq!(again.state(), simulation.state());
        }
    }
}

#[test]
fn a_toy_stands_alone() {
    let with = "(name: \"\", toy: Circle(radius: 0.2), nets: [(name: \"\", net: Chain(from: (0, 0), to: (1, 0), springs: 1, stiffness: 1), mass: 1)])";
    let level = level(with);
    let built = Scene::build(&level, level.mode, &NoFiles, None);
    assert!(built.err().unwrap().to_string().contains("toy problem has nothing else"));
}

/// In a net after another; with ends that 16 bits do not reach; and with so many particles that no copy is made of them.
#[test]
fn spring_forces_are_summed_in_the_order_of_the_springs() {
    let sheet = |columns: u32, rows: u32| {
        format!(
            "(name: \"net\", mass: 0.001, net: Sheet(width: 1, height: 1, columns: {columns}, rows: {rows}, structural: 100, shear: 50,
              flexion: 20, corner: (0, 0)))"
        )
    };
    let points: Vec<_> = (0..40_000).map(|i| (f64::from(i % 200), f64::from(i / 200))).collect();
    let far: Vec<_> = (1..40_000_u32).map(|i| (0, i, 10.0, 1.0 + f64::from(i % 100))).collect();
    let links = format!("(name: \"far\", mass: 1, net: Links(points: {points:?}, springs: {far:?}))");
    for nets in [[sheet(37, 41), sheet(5, 3)], [sheet(3, 2), links], [sheet(2, 1), sheet(260, 260)]] {
        let scene = simulation(&level(&format!("(name: \"nets\", nets: [{}])", nets.join(", "))));
        let (mut random, scene) = (Random(11), scene.scene());
        let mut x: Vec<_> = scene.rest.iter().map(|x| x + random.between(-0.02, 0.02)).collect();
        // The ends of a spring in the last net are in one place.
        let [a, b] = scene.nets[1].springs.links()[1].ends.map(|end| 2 * end as usize);
        (x[a], x[a + 1]) = (x[b], x[b + 1]);
        let motion = Motion { dimension: 2, x: &x, v: &x, mass: &scene.mass, inverse_mass: &[], ..Motion::NONE };
        for springs in scene.nets.iter().filter_map(|net| net.springs.plane()) {
            let mut expected = vec![0.0; x.len()];
            for link in springs.links() {
                let [a, b] = link.ends.map(|end| 2 * end as usize);
                let [dx, dy] = [x[b] - x[a], x[b + 1] - x[a + 1]];
                let length = (dx * dx + dy * dy).sqrt();
                let pull = link.stiffness * (length - link.rest) / if length > 0.0 { length } else { 1.0 };
                for (end, pull) in [(a, pull), (b, -pull)] {
                    expected[end] += pull * dx;
                    expected[end + 1] += pull * dy;
                }
            }
            let (mut scratch, mut force) = (vec![f64::NAN; springs.scratch()], vec![0.0; x.len()]);
            springs.force(motion, &mut scratch, &mut force);
            assert!(
                force.iter().zip(&expected).all(|(force, expected)| force == expected),
                "{} springs",
                springs.links().len()
            );
        }
    }
}

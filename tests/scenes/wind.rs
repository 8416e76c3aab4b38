//! Facts about wind on cloth.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a failing test should panic")]

use crate::common::{continues_bit_for_bit, greatest_gap, level, named, simulation};
use gingerbread::{
    effects::{Effect, Motion},
    integrators::{Class, IntegratorKind},
    level::{Level, Sleep},
    meshes::NoFiles,
    scene::Scene,
    simulation::Simulation,
    solvers::{BlockMatrix, Tangent, Weights},
};
use std::sync::Arc;

const MEMBRANE: &str = "membranes: [(name: \"cloth\", mesh: Rectangle(width: 0.4, height: 0.2, columns: 4, rows: 2, diagonals: Alternating, corner: (0, 0)),
    material: (model: NeoHookean, young: 2000, poisson: 0.3, plane: Stress), thickness: 0.01, mass: Density(100), pins: [PINS], space: (turn: (20, 40, 5)))]";

const NET: &str = "nets: [(name: \"net\", net: Sheet(width: 0.4, height: 0.2, columns: 4, rows: 2, structural: 40, shear: 20, flexion: 10, corner: (0, 0)),
    mass: 0.008, pins: [PINS], space: (turn: (20, 40, 5)))]";

fn blown(parts: &str, pins: &str, wind: &str) -> Level {
    level(&format!("(name: \"\", {}, effects: [(effect: Wind({wind}))])", parts.replace("PINS", pins)))
}

fn stepped(level: &Level, kind: IntegratorKind, step: f64) -> Simulation {
    let mut simulation = simulation(&Level { integrator: kind, ..level.clone() });
    let scene = Scene { step, sleep: Sleep::Off, ..simulation.scene().clone() };
    simulation.replace_scene(scene);
    simulation
}

fn wind(simulation: &Simulation) -> Arc<dyn Effect> {
    simulation.scene().effects.iter().find(|effect| effect.name() == "Wind").cloned().unwrap()
}

fn force(wind: &dyn Effect, scene: &Scene, time: f64, x: &[f64], v: &[f64]) -> Vec<f64> {
    let mut force = vec![0.0; x.len()];
    let motion =
        Motion { dimension: 3, x, v, mass: &scene.mass, inverse_mass: &scene.inverse_mass, time, ..Motion::NONE };
    wind.force(motion, &mut [], &mut force);
    force
}

fn total(force: &[f64]) -> [f64; 3] {
    [0, 1, 2].map(|axis| force.iter().skip(axis).step_by(3).sum())
}

/// `f = c A (n·w) n` on a flat cloth of area 0.08 m², whatever its place; only its own velocity along n counts.
#[test]
fn a_flat_cloth_feels_the_wind_along_its_normal() {
    for parts in [MEMBRANE, NET] {
        for own in [1.0, 0.25, 0.0] {
            let simulation = simulation(&blown(
                parts,
                "",
                &format!("speed: 3, direction: (2, 0, 4), resistance: 5, own_motion: {own}"),
            ));
            let scene = simulation.scene();
            let (x, count) = (&scene.rest, scene.rest.len() / 3);
            let corner = |vertex: usize| nalgebra::Vector3::from_column_slice(&x[3 * vertex..3 * vertex + 3]);
            let normal = (corner(4) - corner(0)).cross(&(corner(count - 1) - corner(4))).normalize();
            let air = nalgebra::Vector3::new(1.0, 0.0, 2.0) * (3.0 / 5.0_f64.sqrt());
            let cloth = nalgebra::Vector3::new(0.3, -0.4, 0.9);
            let v: Vec<f64> = (0..count).flat_map(|_| [0.3, -0.4, 0.9]).collect();
            let found = total(&force(&*wind(&simulation), scene, 0.0, x, &v));
            let expected = normal * (5.0 * 0.08 * normal.dot(&(air - own * cloth)));
            for axis in 0..3 {
                assert!((found[axis] - expected[axis]).abs() < 1e-14, "{found:?} {expected}");
            }
        }
    }
}

/// As in Princeton's cloth: each corner of each triangle gets `n (n·w)`, if c is 3 over the area of a triangle.
#[test]
fn wind_of_princeton_is_a_choice_of_numbers() {
    let simulation = simulation(&blown(NET, "", "speed: 30, direction: (1, 1, 1), resistance: 600, own_motion: 0"));
    let scene = simulation.scene();
    let x: Vec<f64> = scene.rest.iter().enumerate().map(|(number, x)| x + 1e-5 * libm::sin(number as f64)).collect();
    let found = force(&*wind(&simulation), scene, 0.0, &x, &scene.start.v);
    let mut expected = vec![0.0; x.len()];
    let corner = |vertex: u32| nalgebra::Vector3::from_column_slice(&x[3 * vertex as usize..3 * vertex as usize + 3]);
    for face in scene.nets[0].faces.iter() {
        let [a, b, c] = face.map(corner);
        let normal = (b - a).cross(&(c - a)).normalize();
        let push = normal * normal.dot(&nalgebra::Vector3::repeat(30.0 / 3.0_f64.sqrt()));
        for vertex in face {
            (0..3).for_each(|axis| expected[3 * *vertex as usize + axis] += push[axis]);
        }
    }
    let gap = greatest_gap(&found, &expected);
    // The area of triangles that are bent by 1e-5 m differs by a part in a thousand.
    assert!(gap < 0.1 && gap > 0.0, "{gap} N");
}

/// Free in a steady wind across it, a cloth reaches its speed as `w (1 - exp(-c A t/m))`, with every scheme.
#[test]
fn a_free_cloth_goes_with_the_wind() {
    for parts in [MEMBRANE, NET] {
        let level = level(&format!(
            "(name: \"\", {}, effects: [(effect: Wind(speed: 3, direction: (0, 0, 1), resistance: 5))])",
            parts.replace("PINS", "").replace("(20, 40, 5)", "(0, 0, 0)")
        ));
        for kind in IntegratorKind::all() {
            let mut run = stepped(&level, kind.clone(), 1e-3);
            let mass: f64 = run.scene().mass.iter().step_by(3).sum();
            // Particles of a net have one mass, but those at its edges have less area: a net does not stay flat for long.
            let (steps, most) = if parts == MEMBRANE { (200, 5e-3) } else { (10, 2e-2) };
            run.advance(steps, &mut || true);
            let name = kind.name();
            assert!(run.fault().is_none(), "{name}: {:?}", run.fault());
            let momentum: f64 =
                run.state().v.iter().zip(&run.scene().mass).skip(2).step_by(3).map(|(v, m)| m * v).sum();
            let exact = 3.0 * (1.0 - libm::exp(-5.0 * 0.08 * run.state().time / mass));
            let error = (momentum / mass / exact - 1.0).abs();
            assert!(error < most, "{name}: {} m/s for {exact}", momentum / mass);
        }
    }
}

/// Every scheme converges to one motion, by its order, in gusts and turbulence; the guard lets it, and what the wind supplies is known.
#[test]
fn every_integrator_moves_in_wind() {
    for parts in [MEMBRANE, NET] {
        let gale = "speed: 4, direction: (0, 1, 3), resistance: 2, gusts: 0.5, period: 0.3, turbulence: 0.5, eddies: 0.3, seed: 7";
        let level = blown(parts, "Left", gale);
        let end = |kind: IntegratorKind, step: f64| {
            let mut run = stepped(&level, kind.clone(), step);
            run.set_measured(true);
            let start = run.energies().total();
            run.advance((0.2 / step).round() as u64, &mut || true);
            assert!(run.fault().is_none(), "{:?}", run.fault());
            assert_eq!(run.counts().guarded, 0, "{}", kind.name());
            let drift = run.energies().total() + run.heat() - run.work_of_obstacles() - start;
            (run.state().x.clone(), drift.abs(), run.work_of_obstacles())
        };
        let (exact, drift, work) = end(named("RungeKutta4"), 2.5e-4);
        assert!(drift < 1e-5 * work && work > 0.01, "{drift} J of {work} J");
        for kind in IntegratorKind::all() {
            let step = match (kind.kind().class(), kind.kind().order()) {
                (Class::Explicit, 1) => 1e-4,
                (Class::Implicit, _) => 1e-3,
                _ => 5e-4,
            };
            let [whole, half] = [step, 0.5 * step].map(|step| greatest_gap(&end(kind.clone(), step).0, &exact));
            let (most, ratio) = match kind.kind().order() {
                1 => (0.03, 0.65),
                2 => (3e-3, 0.3),
                _ => (1e-6, f64::INFINITY),
            };
            assert!(whole < most && half <= ratio * whole, "{}: {whole} m and {half} m", kind.name());
        }
    }
}

/// The matrix of implicit schemes has the slope of the force by velocities.
#[test]
fn the_derivative_by_velocities_is_exact() {
    for parts in [MEMBRANE, NET] {
        let run = simulation(&blown(parts, "", "speed: 3, direction: (1, 2, 3), resistance: 2, own_motion: 0.7"));
        let (scene, wind) = (run.scene(), wind(&run));
        let x: Vec<f64> =
            scene.rest.iter().enumerate().map(|(number, x)| x + 0.02 * libm::sin(1.3 * number as f64)).collect();
        let v: Vec<f64> = (0..x.len()).map(|number| libm::cos(0.7 * number as f64)).collect();
        let mut pattern = Vec::new();
        wind.sparsity_pattern(&mut |a, b| pattern.push([a, b]));
        let mut matrix = BlockMatrix::<3>::new(x.len() / 3, &pattern);
        let motion =
            Motion { dimension: 3, x: &x, v: &v, mass: &scene.mass, inverse_mass: &scene.inverse_mass, ..Motion::NONE };
        wind.add_stiffness(motion, Weights { position: 0.0, velocity: 1.0, tangent: Tangent::Exact }, &mut matrix);
        assert!(matrix.is_full());
        let d: Vec<f64> = (0..x.len()).map(|number| libm::sin(0.3 * number as f64)).collect();
        let mut product = vec![0.0; x.len()];
        matrix.add_product(&d, &mut product);
        let at = |sign: f64| {
            let v: Vec<f64> = v.iter().zip(&d).map(|(v, d)| v + sign * d).collect();
            force(&*wind, scene, 0.0, &x, &v)
        };
        let slope: Vec<f64> = at(1.0).iter().zip(at(-1.0)).map(|(more, less)| -0.5 * (more - less)).collect();
        let gap = greatest_gap(&product, &slope);
        assert!(gap < 1e-14, "{gap}");
    }
}

/// Turbulence has the stated root mean square, differs by seed, and the same seed gives the same wind.
#[test]
fn turbulence_has_its_strength_and_its_seed() {
    let sample = |seed: u32, time: f64| {
        let run = simulation(&blown(
            NET,
            "",
            &format!("speed: 3, direction: (1, 0, 0), resistance: 1, turbulence: 0.5, eddies: 0.05, seed: {seed}"),
        ));
        let steady = simulation(&blown(NET, "", "speed: 3, direction: (1, 0, 0), resistance: 1"));
        let at =
            |run: &Simulation, time| force(&*wind(run), run.scene(), time, &run.scene().rest, &run.scene().start.v);
        let (gust, mean) = (at(&run, time), at(&steady, time));
        gust.iter().zip(mean).map(|(gust, mean)| gust - mean).collect::<Vec<_>>()
    };
    assert_eq!(sample(3, 0.4), sample(3, 0.4));
    assert_ne!(sample(3, 0.4), sample(4, 0.4));
    assert_ne!(sample(3, 0.4), sample(3, 0.5));
    // A corner of one triangle only: a third of `A u·n` with A = 5e-3 m².
    let square = |seed: u32| {
        let force = sample(seed, 10.0 * f64::from(seed));
        let lone = &force[3 * 4..3 * 5];
        lone.iter().map(|f| f * f).sum::<f64>()
    };
    let count = 2000;
    let mean = (0..count).map(square).sum::<f64>() / f64::from(count);
    let along_normal = (mean.sqrt() * 3.0 / 5e-3) / (0.5 * 3.0);
    assert!((along_normal * 3.0_f64.sqrt() - 1.0).abs() < 0.05, "{along_normal}");
}

#[test]
fn a_run_in_wind_is_saved_and_continued_bit_for_bit() {
    for parts in [MEMBRANE, NET] {
        for kind in IntegratorKind::all() {
            let wind = "speed: 3, direction: (0, 1, 3), resistance: 1, gusts: 0.5, turbulence: 0.5, seed: 2";
            let level = Level { integrator: kind.clone(), ..blown(parts, "Left", wind) };
            continues_bit_for_bit(&level);
        }
    }
}

#[test]
fn wind_needs_faces_and_a_direction() {
    let refused = |level: &Level| Scene::build(level, level.mode, &NoFiles, None).err().unwrap().to_string();
    let error = refused(&blown(NET, "", "speed: 1, direction: (0, 0, 0), resistance: 1"));
    assert!(error.contains("its direction must not be zero"), "{error}");
    for flat in [
        "nets: [(name: \"flat\", net: Sheet(width: 0.4, height: 0.2, columns: 4, rows: 2, structural: 40, shear: 20, flexion: 10, corner: (0, 0)), mass: 0.01)]",
        "nets: [(name: \"chain\", net: Chain(from: (0, 0), to: (1, 0), springs: 2, stiffness: 10, rest: 0.4), mass: 1, space: ())]",
    ] {
        let error = refused(&blown(flat, "", "speed: 1, resistance: 1"));
        assert!(error.contains("the level has none"), "{error}");
    }
}

/// A vortex turns and lifts: its velocity at single faces is that of Lamb and Oseen.
#[test]
fn a_vortex_turns_about_its_axis() {
    let run = simulation(&blown(NET, "", "speed: 0, resistance: 1"));
    let text = |vortex: &str| {
        level(&format!("(name: \"\", {}, effects: [(effect: Vortex({vortex}))])", NET.replace("PINS", "")))
    };
    let vortex =
        simulation(&text("centre: (1, 0, 0), axis: (0, 2, 0), circulation: 5, core: 0.3, updraft: 2, resistance: 3"));
    let effect = vortex.scene().effects.iter().find(|effect| effect.name() == "Vortex").cloned().unwrap();
    let scene = run.scene();
    let found = force(&*effect, scene, 0.0, &scene.rest, &scene.start.v);
    let mut expected = vec![0.0; found.len()];
    let corner =
        |vertex: u32| nalgebra::Vector3::from_column_slice(&scene.rest[3 * vertex as usize..3 * vertex as usize + 3]);
    for face in scene.nets[0].faces.iter() {
        let [a, b, c] = face.map(corner);
        let (middle, twice) = ((a + b + c) / 3.0, (b - a).cross(&(c - a)));
        let from = middle - nalgebra::Vector3::new(1.0, 0.0, 0.0);
        let r = libm::hypot(from.x, from.z);
        let speed = 5.0 / (std::f64::consts::TAU * r) * (1.0 - libm::exp(-r * r / 0.09));
        let air = nalgebra::Vector3::new(speed * from.z / r, 2.0 * libm::exp(-r * r / 0.09), -speed * from.x / r);
        let push = twice.normalize() * (3.0 * 0.5 * twice.norm() / 3.0 * twice.normalize().dot(&air));
        for vertex in face {
            (0..3).for_each(|axis| expected[3 * *vertex as usize + axis] += push[axis]);
        }
    }
    assert!(greatest_gap(&found, &expected) < 1e-14);
    let level = text("centre: (0, 0, 0), axis: (0, 0, 0), circulation: 5, core: 0.3, resistance: 3");
    let error = Scene::build(&level, level.mode, &NoFiles, None).err().unwrap().to_string();
    assert!(error.contains("its axis must have a direction"), "{error}");
}

fn rained(parts: &str, rain: &str) -> Level {
    level(&format!("(name: \"\", {}, effects: [(effect: Rain({rain}))])", parts.replace("PINS", "")))
}

/// Rain gives the momentum of its drops: r t of them, each J, whatever the scheme.
#[test]
fn rain_gives_the_momentum_of_its_drops() {
    for parts in [MEMBRANE, NET] {
        for kind in IntegratorKind::all() {
            let mut run =
                stepped(&rained(parts, "rate: 200, impulse: 0.0001, duration: 0.02, seed: 5"), kind.clone(), 2e-4);
            run.advance(2500, &mut || true);
            assert!(run.fault().is_none(), "{}: {:?}", kind.name(), run.fault());
            let momentum = |axis: usize| {
                run.state().v.iter().zip(&run.scene().mass).skip(axis).step_by(3).map(|(v, m)| v * m).sum::<f64>()
            };
            // 100 drops in 0.5 s; some of the last have not ended.
            assert!((-momentum(1) - 0.01).abs() < 4e-4, "{}: {} N s", kind.name(), momentum(1));
            assert!(momentum(0).abs() < 1e-12 && momentum(2).abs() < 1e-12);
        }
    }
}

/// The drops are a function of time and seed: a saved run continues bit for bit, and another seed rains elsewhere.
#[test]
fn rain_is_saved_and_continued_bit_for_bit() {
    for parts in [MEMBRANE, NET] {
        for kind in IntegratorKind::all() {
            let level = Level { integrator: kind.clone(), ..rained(parts, "rate: 500, impulse: 0.0001, seed: 5") };
            continues_bit_for_bit(&level);
            let mut run = simulation(&level);
            run.advance(40, &mut || true);
            let mut elsewhere = simulation(&rained(parts, "rate: 500, impulse: 0.0001, seed: 6"));
            elsewhere.advance(40, &mut || true);
            assert_ne!(run.state().x, elsewhere.state().x);
        }
    }
}

/// At any time that a file may name, the number of drops at work is bounded.
#[test]
fn rain_at_a_late_time_ends() {
    let run = simulation(&rained(NET, "rate: 1000000, impulse: 0.0001, duration: 0.001"));
    let scene = run.scene();
    let rain = scene.effects.iter().find(|effect| effect.name() == "Rain").cloned().unwrap();
    for time in [0.0, 1.0, 1e6, 1e12] {
        assert!(
            force(&*rain, scene, time, &scene.rest, &scene.start.v).iter().all(|force| force.is_finite()),
            "{time}"
        );
    }
}

/// Two cloths share the drops, with multirate stepping too, and particles of two nets keep apart: parts take the same steps then.
#[test]
fn what_acts_on_several_parts_is_not_divided() {
    let net = |name: &str| NET.replace("\"net\"", &format!("\"{name}\"")).replace("PINS", "");
    let two = format!("nets: [{}, {}]", &net("one")[7..net("one").len() - 1], &net("two")[7..net("two").len() - 1]);
    for effect in ["Rain(rate: 200, impulse: 0.0001)", "Projection(separation: 0.01)"] {
        let scene = simulation(&level(&format!("(name: \"\", paces: Own, {two}, effects: [(effect: {effect})])")))
            .scene()
            .clone();
        assert!(scene.sub_scenes.is_empty() && scene.couples_parts(), "{effect}");
        assert!(scene.messages.iter().any(|message| message.contains("an effect acts on them together")), "{effect}");
    }
}

/// Numbers within their ranges that cannot be computed with are refused in words.
#[test]
fn numbers_beyond_computing_are_refused() {
    for (effect, words) in [
        ("Vortex(centre: (0, 0, 0), circulation: 5, core: 1e-200, resistance: 3)", "too small or too large"),
        (
            "Vortex(centre: (0, 0, 0), axis: (1e-170, 0, 0), circulation: 5, core: 1, resistance: 3)",
            "must have a direction",
        ),
        ("Wind(speed: 1, resistance: 1, gusts: 1, period: 1e-310)", "too short"),
        ("Rain(rate: 1, impulse: 1, duration: 1e-310)", "for long enough"),
        ("Rain(rate: 1000000, impulse: 1, duration: 100)", "at most 100000 drops"),
    ] {
        let level = level(&format!("(name: \"\", {}, effects: [(effect: {effect})])", NET.replace("PINS", "")));
        let error = Scene::build(&level, level.mode, &NoFiles, None).err().unwrap().to_string();
        assert!(error.contains(words), "{effect}: {error}");
    }
}

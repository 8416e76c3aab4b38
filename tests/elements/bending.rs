//! Facts about bending of membranes.
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

/// A strip of 0.4 m by 0.1 m and 2 mm, of 1e6 Pa: its rigidity is 0.73e-3 N m with the ratio 0.3 of Poisson, and 0.67e-3 N m with 0.
fn strip(mesh: &str, poisson: f64, effects: &str) -> Level {
    level(&format!(
        "(name: \"\", membranes: [(name: \"strip\", mesh: Rectangle(width: 0.4, height: 0.1, {mesh}, corner: (0, 0)),
        material: (model: StVenantKirchhoff, young: 1000000, poisson: {poisson}, plane: Stress), thickness: 0.002, mass: Density(1000))],
        effects: [(effect: Bending()), {effects}])"
    ))
}

const MESHES: [&str; 3] = [
    "columns: 8, rows: 2, diagonals: Grid",
    "columns: 8, rows: 2, diagonals: Alternating",
    "columns: 8, rows: 2, diagonals: Crossed",
];

fn bending(simulation: &Simulation) -> Arc<dyn Effect> {
    simulation.scene().effects.iter().find(|effect| effect.name() == "Bending").cloned().unwrap()
}

fn motion<'a>(scene: &'a Scene, x: &'a [f64]) -> Motion<'a> {
    Motion { dimension: 3, x, v: &scene.start.v, mass: &scene.mass, inverse_mass: &scene.inverse_mass, ..Motion::NONE }
}

fn force(bending: &dyn Effect, scene: &Scene, x: &[f64]) -> Vec<f64> {
    let mut force = vec![0.0; x.len()];
    bending.force(motion(scene, x), &mut vec![f64::NAN; bending.scratch()], &mut force);
    force
}

/// Positions with bends of all sizes.
fn crumpled(scene: &Scene, by: f64) -> Vec<f64> {
    scene
        .rest
        .iter()
        .enumerate()
        .map(|(number, x)| x + by * libm::sin(1.7 * number as f64 * (1.0 + 0.1 * number as f64)))
        .collect()
}

/// Force and stiffness are slopes of the energy, in steps over six orders; the matrix is their part without the curvature of angles.
#[test]
fn forces_are_slopes_of_the_energy() {
    for mesh in MESHES {
        let simulation = simulation(&strip(mesh, 0.3, ""));
        let (scene, bending) = (simulation.scene(), bending(&simulation));
        let x = crumpled(scene, 0.02);
        let d: Vec<f64> = (0..x.len()).map(|number| libm::cos(0.9 * number as f64)).collect();
        let moved = |by: f64| x.iter().zip(&d).map(|(x, d)| x + by * d).collect::<Vec<_>>();
        let exact = -force(&*bending, scene, &x).iter().zip(&d).map(|(f, d)| f * d).sum::<f64>();
        let mut product = vec![0.0; x.len()];
        bending.stiffness_times(motion(scene, &x), &d, &mut vec![f64::NAN; bending.scratch()], &mut product);
        let size = product.iter().map(|p| p.abs()).fold(0.0, f64::max);
        let mut least = [f64::INFINITY; 2];
        for exponent in 3..9 {
            let h = libm::pow(10.0, -f64::from(exponent));
            let energy = |by: f64| bending.energy(motion(scene, &moved(by)));
            let slope = (energy(h) - energy(-h)) / (2.0 * h);
            least[0] = least[0].min((slope / exact - 1.0).abs());
            let [more, less] = [h, -h].map(|by| force(&*bending, scene, &moved(by)));
            let change: Vec<f64> = more.iter().zip(&less).map(|(more, less)| -(more - less) / (2.0 * h)).collect();
            least[1] = least[1].min(greatest_gap(&change, &product) / size);
        }
        assert!(least[0] < 1e-8 && least[1] < 1e-7, "{mesh}: {least:?}");
    }
}

/// Flat, where angles are zero, the matrix is the whole stiffness; bent it stays positive semidefinite.
#[test]
fn the_matrix_is_the_stiffness_of_what_is_flat() {
    for mesh in MESHES {
        let simulation = simulation(&strip(mesh, 0.3, ""));
        let (scene, bending) = (simulation.scene(), bending(&simulation));
        let mut pattern = Vec::new();
        bending.sparsity_pattern(&mut |a, b| pattern.push([a, b]));
        let product_of = |x: &[f64], d: &[f64]| {
            let mut matrix = BlockMatrix::<3>::new(x.len() / 3, &pattern);
            bending.add_stiffness(
                motion(scene, x),
                Weights { position: 1.0, velocity: 0.0, tangent: Tangent::Exact },
                &mut matrix,
            );
            assert!(matrix.is_full());
            let mut product = vec![0.0; x.len()];
            matrix.add_product(d, &mut product);
            product
        };
        for seed in 0..20 {
            let d: Vec<f64> =
                (0..scene.rest.len()).map(|number| libm::cos(f64::from(seed) + 0.9 * number as f64)).collect();
            let mut exact = vec![0.0; d.len()];
            bending.stiffness_times(motion(scene, &scene.rest), &d, &mut vec![f64::NAN; bending.scratch()], &mut exact);
            let size = exact.iter().map(|p| p.abs()).fold(0.0, f64::max);
            assert!(greatest_gap(&product_of(&scene.rest, &d), &exact) < 1e-12 * size, "{mesh}");
            let bent = product_of(&crumpled(scene, 0.02), &d);
            assert!(bent.iter().zip(&d).map(|(p, d)| p * d).sum::<f64>() >= 0.0);
        }
    }
}

/// Nothing bends in a rigid motion or a stretch in the plane; the force has no sum and no moment.
#[test]
fn rigid_motions_do_not_bend() {
    let simulation = simulation(&strip(MESHES[2], 0.3, ""));
    let (scene, bending) = (simulation.scene(), bending(&simulation));
    let turn = nalgebra::Rotation3::from_euler_angles(0.4, -1.1, 2.0);
    let moved: Vec<f64> = scene
        .rest
        .chunks(3)
        .flat_map(|point| {
            let point = turn * nalgebra::Vector3::new(1.2 * point[0], 0.9 * point[1], point[2])
                + nalgebra::Vector3::new(1.0, 2.0, 3.0);
            [point.x, point.y, point.z]
        })
        .collect();
    assert!(bending.energy(motion(scene, &moved)) < 1e-26);
    let x = crumpled(scene, 0.02);
    let force = force(&*bending, scene, &x);
    let size = force.iter().map(|f| f.abs()).fold(0.0, f64::max);
    let (mut sum, mut moment) = (nalgebra::Vector3::zeros(), nalgebra::Vector3::zeros());
    for (x, f) in x.chunks(3).zip(force.chunks(3)) {
        let (x, f) = (nalgebra::Vector3::from_column_slice(x), nalgebra::Vector3::from_column_slice(f));
        sum += f;
        moment += x.cross(&f);
    }
    assert!(sum.norm() < 1e-12 * size && moment.norm() < 1e-12 * size, "{sum} {moment}");
}

/// Rolled up to a cylinder of radius R along its length or its width, a strip without lateral contraction stores `D/(2 R²)` for each unit of area, but
/// for triangles at the two straight edges, which lack a neighbour.
#[test]
fn a_cylinder_has_the_energy_of_a_plate() {
    for (mesh, along) in [("Grid", 0), ("Alternating", 0), ("Grid", 1), ("Alternating", 1)] {
        let cells = [64, 16];
        let simulation =
            simulation(&strip(&format!("columns: {}, rows: {}, diagonals: {mesh}", cells[0], cells[1]), 0.0, ""));
        let (scene, bending) = (simulation.scene(), bending(&simulation));
        let radius = 0.5;
        let rolled: Vec<f64> = scene
            .rest
            .chunks(3)
            .flat_map(|point| {
                let mut point = [point[0], point[1], point[2]];
                let angle = point[along] / radius;
                (point[along], point[2]) = (radius * libm::sin(angle), radius * (1.0 - libm::cos(angle)));
                point
            })
            .collect();
        let energy = bending.energy(motion(scene, &rolled));
        let inner = 1.0 - 1.0 / f64::from(cells[along]);
        let exact = 1e6 * 8e-9 / 12.0 / (2.0 * radius * radius) * 0.04 * inner;
        assert!((energy / exact - 1.0).abs() < 1e-3, "{mesh} {along}: {energy} J for {exact} J");
    }
}

/// Shallow quadratic surfaces store the energy of a plate on a regular mesh, but for the triangles at its boundary: a cylinder along each axis and across
/// both, a cap, a saddle and a twist.
#[test]
fn quadratic_surfaces_have_the_energy_of_a_plate() {
    for poisson in [0.0, 0.3] {
        let simulation = simulation(&strip("columns: 128, rows: 32, diagonals: Grid", poisson, ""));
        let (scene, bending) = (simulation.scene(), bending(&simulation));
        for k in [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.5, 0.5, 0.5], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [0.0, 1.0, 0.0]]
        {
            let [xx, xy, yy] = k.map(|k| 0.01 * k);
            let mut bent = scene.rest.clone();
            for point in bent.chunks_mut(3) {
                point[2] = 0.5 * (xx * point[0] * point[0] + 2.0 * xy * point[0] * point[1] + yy * point[1] * point[1]);
            }
            let rigidity = 1e6 * 8e-9 / (12.0 * (1.0 - poisson * poisson));
            let density =
                0.5 * ((1.0 - poisson) * (xx * xx + 2.0 * xy * xy + yy * yy) + poisson * (xx + yy) * (xx + yy));
            let ratio = bending.energy(motion(scene, &bent)) / (rigidity * density * 0.04);
            // 8 % of the triangles are at the boundary.
            assert!(ratio < 1.0 + 1e-4 && ratio > 0.92, "{poisson} {k:?}: {ratio}");
        }
    }
}

/// A plate bends with free faces, whether its stretch is one of plane stress or of plane strain.
#[test]
fn the_rigidity_is_that_of_the_material_and_the_thickness() {
    let energy = |plane: &str| {
        let text = gingerbread::files::write(&strip(MESHES[1], 0.3, ""))
            .unwrap()
            .replace("plane: Stress", &format!("plane: {plane}"));
        let simulation = simulation(&gingerbread::files::parse(&text, "strip.ron").unwrap());
        let (scene, bending) = (simulation.scene(), bending(&simulation));
        bending.energy(motion(scene, &crumpled(scene, 0.02)))
    };
    assert!((energy("Strain") / energy("Stress") - 1.0).abs() < 1e-12);
}

/// A cantilever under a small weight sinks by `q L⁴/(8 E I)` (Euler and Bernoulli). Between the two clamped rows of vertices the clamp is in the
/// middle of the first cell. With Poisson's ratio the strip must be narrow, or the clamp holds its width and stiffens it.
#[test]
fn a_cantilever_bends_like_a_beam() {
    for (mesh, columns, width, poisson) in [
        ("Grid", 32, 0.1, 0.0),
        ("Alternating", 32, 0.1, 0.0),
        ("Crossed", 32, 0.1, 0.0),
        ("Alternating", 64, 0.02, 0.3),
    ] {
        let membrane = strip(
            &format!("columns: {columns}, rows: 4, diagonals: {mesh}"),
            poisson,
            "(effect: Gravity(down: 0.0001)), (effect: Rayleigh(mass: 0.5, stiffness: 0))",
        );
        let text = gingerbread::files::write(&Level { integrator: named("ImplicitEuler"), ..membrane }).unwrap();
        // Weight along z: the strip lies in the plane of x and z.
        let text = text
            .replace("height: 0.1,", &format!("height: {width},"))
            .replace("thickness:", "space: (turn: (90, 0, 0)), thickness:");
        let mut scene = simulation(&gingerbread::files::parse(&text, "strip.ron").unwrap()).scene().clone();
        let cell = 0.4 / f64::from(columns);
        let clamped = (0..scene.rest.len() / 3).filter(|vertex| scene.rest[3 * vertex] < 1.01 * cell);
        let clamped: Vec<u32> = clamped.map(|vertex| vertex as u32).collect();
        scene.pin(&clamped);
        (scene.step, scene.sleep, scene.guard) = (0.5, Sleep::Off, false);
        let start = scene.start.clone();
        let mut simulation = Simulation::new(scene, start);
        simulation.advance(400, &mut || true);
        assert!(simulation.fault().is_none(), "{:?}", simulation.fault());
        let tip = simulation.state().x.chunks(3).filter(|point| point[0] > 0.3999).map(|point| point[1]);
        let tip: Vec<f64> = tip.collect();
        let sunk = -tip.iter().sum::<f64>() / tip.len() as f64;
        let length = 0.4 - 0.5 * cell;
        let exact = 1000.0 * 0.002 * 0.0001 * length.powi(4) / (8.0 * 1e6 * 8e-9 / 12.0);
        let (known, most) = if mesh == "Crossed" { (0.925, 0.01) } else { (1.0, 0.02) };
        assert!((sunk / exact - known).abs() < most, "{mesh} {poisson}: {sunk} m for {exact} m");
        assert!(sunk < 0.01 * length, "{sunk} m is small");
    }
}

/// A square of 1 m that is held along one edge bends far down under its weight. The middle of the clamp is at x = 0 on every mesh.
#[test]
fn the_drape_of_a_square_converges_with_the_mesh() {
    let lowest = |cells: u32| {
        let cell = 1.0 / (f64::from(cells) - 0.5);
        let (width, left) = (cell * f64::from(cells), -0.5 * cell);
        let mut scene = simulation(&level(&format!(
            "(name: \"\", integrator: ImplicitEuler(), membranes: [(name: \"cloth\", mesh: Rectangle(width: {width}, height: 1, columns: {cells}, rows: {cells},
               diagonals: Alternating, corner: ({left}, 0)), material: (model: StVenantKirchhoff, young: 1000000, poisson: 0.3, plane: Stress),
               thickness: 0.002, mass: Density(1000), space: (turn: (90, 0, 0)))],
            effects: [(effect: Bending()), (effect: Gravity(down: 0.002)), (effect: Rayleigh(mass: 0.5, stiffness: 0))])"
        )))
        .scene()
        .clone();
        let clamped = (0..scene.rest.len() / 3).filter(|vertex| scene.rest[3 * vertex] < 0.51 * cell);
        scene.pin(&clamped.map(|vertex| vertex as u32).collect::<Vec<_>>());
        (scene.step, scene.sleep, scene.guard) = (2.0, Sleep::Off, false);
        let start = scene.start.clone();
        let mut simulation = Simulation::new(scene, start);
        simulation.advance(150, &mut || true);
        assert!(simulation.fault().is_none(), "{:?}", simulation.fault());
        simulation.state().x.chunks(3).map(|point| point[1]).fold(0.0, f64::min)
    };
    let [coarse, middle, fine] = [6, 12, 24].map(lowest);
    assert!(fine < -0.3, "it hangs far down: {fine} m");
    let [first, second] = [(middle - coarse).abs(), (fine - middle).abs()];
    assert!(second < 0.5 * first, "{coarse} m, {middle} m, {fine} m");
}

/// Every scheme converges to one motion, by its order, with the stiffness of bending.
#[test]
fn every_integrator_bends() {
    let level = strip("columns: 4, rows: 2, diagonals: Alternating", 0.3, "(effect: Gravity(down: 2))");
    let end = |kind: &IntegratorKind, step: f64| {
        let mut scene = simulation(&Level { integrator: kind.clone(), ..level.clone() }).scene().clone();
        (scene.step, scene.sleep) = (step, Sleep::Off);
        scene.start.x = crumpled(&scene, 1e-4);
        for point in scene.start.x.chunks_mut(3) {
            point[2] += 0.5 * point[0] * point[0];
        }
        let start = scene.start.clone();
        let mut simulation = Simulation::new(scene, start);
        simulation.advance((0.05 / step).round() as u64, &mut || true);
        assert!(simulation.fault().is_none(), "{}: {:?}", kind.name(), simulation.fault());
        simulation.state().x.clone()
    };
    let exact = end(&named("RungeKutta4"), 2.5e-5);
    for kind in IntegratorKind::all() {
        let step = match (kind.kind().class(), kind.kind().order()) {
            (Class::Explicit, 1) => 2.5e-5,
            _ => 1e-4,
        };
        let [whole, half] = [step, 0.5 * step].map(|step| greatest_gap(&end(&kind, step), &exact));
        let ratio = match kind.kind().order() {
            1 => 0.65,
            2 => 0.35,
            _ => f64::INFINITY,
        };
        assert!(whole < 3e-3 && half <= ratio * whole, "{}: {whole} m and {half} m", kind.name());
    }
}

#[test]
fn a_bent_run_is_saved_and_continued_bit_for_bit() {
    for kind in IntegratorKind::all() {
        let level = strip(MESHES[1], 0.3, "(effect: Gravity(down: 2))");
        let level = Level { integrator: kind.clone(), ..level };
        continues_bit_for_bit(&level);
    }
}

#[test]
fn bending_needs_a_membrane() {
    let net = "nets: [(name: \"net\", net: Sheet(width: 0.4, height: 0.2, columns: 4, rows: 2, structural: 40, shear: 20, flexion: 10, corner: (0, 0)), mass: 0.01, space: ())]";
    let level = level(&format!("(name: \"\", {net}, effects: [(effect: Bending())])"));
    let error = Scene::build(&level, level.mode, &NoFiles, None).err().unwrap().to_string();
    assert!(error.contains("it acts on membranes, and the level has none"), "{error}");
}

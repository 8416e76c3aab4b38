//! Elements of six nodes: what they are exact for, how fast they converge, and that they do not lock.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{Random, difference_error, greatest_gap, level, norm, reopened, sheet, sheets, simulation};
use gingerbread::{
    effects::{Effect, Motion},
    elements::{ElementKind, Triangles},
    integrators::IntegratorKind,
    level::{Level, RunMode},
    materials::Model,
    meshes::NoFiles,
    scene::Scene,
    solvers::{BlockMatrix, Tangent, Weights},
    study::{MeshPlan, MeshStudy},
};
use pulp::Arch;
use std::time::Duration;

const CUTS: [&str; 3] = ["Grid", "Alternating", "Crossed"];

fn shaken(x: &[f64], by: f64, seed: u64) -> Vec<f64> {
    let mut random = Random(seed);
    x.iter().map(|x| x + random.between(-by, by)).collect()
}

fn motion<'a>(x: &'a [f64], v: &'a [f64]) -> Motion<'a> {
    Motion { dimension: 2, x, v, ..Motion::NONE }
}

fn stiffness_times(effect: &dyn Effect, x: &[f64], d: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; x.len()];
    effect.stiffness_times(motion(x, d), d, &mut vec![0.0; effect.scratch()], &mut product);
    product
}

/// The matrix of an effect times a displacement.
fn assembled_times(effect: &dyn Effect, motion: Motion<'_>, weights: Weights, d: &[f64]) -> Vec<f64> {
    let mut pairs = Vec::new();
    effect.sparsity_pattern(&mut |a, b| pairs.push([a, b]));
    let mut matrix = BlockMatrix::<2>::new(d.len() / 2, &pairs);
    matrix.clear();
    effect.add_stiffness(motion, weights, &mut matrix);
    let mut product = vec![0.0; d.len()];
    matrix.add_product(d, &mut product);
    product
}

#[test]
fn the_assembled_stiffness_is_the_matrix_free_one() {
    for (what, level) in sheets("") {
        let run = simulation(&level);
        let body = &*run.scene().bodies[0].elements;
        let x = shaken(&run.scene().rest, 0.015, 1);
        let d = shaken(&vec![0.0; x.len()], 1.0, 2);
        let weights = Weights { position: 1.0, velocity: 0.0, tangent: Tangent::Exact };
        let (expected, found) = (stiffness_times(body, &x, &d), assembled_times(body, motion(&x, &d), weights, &d));
        assert!(greatest_gap(&expected, &found) < 1e-12 * norm(&expected), "{what}");
        // Projected, no displacement has negative energy.
        let weights = Weights { tangent: Tangent::Definite, ..weights };
        let crushed = shaken(&run.scene().rest, 0.06, 5);
        for seed in 0..20 {
            let d = shaken(&vec![0.0; x.len()], 1.0, seed);
            let product = assembled_times(body, motion(&crushed, &d), weights, &d);
            let energy: f64 = product.iter().zip(&d).map(|(product, d)| product * d).sum();
            assert!(energy >= 0.0, "{what}: {energy:e}");
        }
    }
}

/// At rest the part for velocities is that for positions times beta, and a changed velocity changes the force by it.
#[test]
fn the_stiffness_of_damping_is_the_change_of_its_force() {
    for kind in ElementKind::ALL {
        let text = sheet(
            "NeoHookean",
            &format!("element: {kind:?}"),
            "effects: [(effect: Rayleigh(mass: 0, stiffness: 0.1))]",
        );
        let run = simulation(&text);
        let scene = run.scene();
        let damping = scene.effects.iter().find(|effect| effect.name() == "Damping").unwrap();
        let (x, v) = (shaken(&scene.rest, 0.01, 1), shaken(&vec![0.0; scene.rest.len()], 1.0, 2));
        let d = shaken(&vec![0.0; x.len()], 1.0, 3);
        let whole = |v: &[f64]| {
            let mut force = vec![0.0; x.len()];
            let motion = Motion { mass: &scene.mass, inverse_mass: &scene.inverse_mass, ..motion(&x, v) };
            damping.force(motion, &mut vec![0.0; damping.scratch()], &mut force);
            force
        };
        let weights = Weights { position: 0.0, velocity: 1.0, tangent: Tangent::Exact };
        let at = Motion { mass: &scene.mass, inverse_mass: &scene.inverse_mass, ..motion(&x, &v) };
        let product = assembled_times(&**damping, at, weights, &d);
        let error = difference_error(&v, &d, &product, whole);
        assert!(error < 1e-8, "{kind:?}: {error:e}");
    }
}

/// Without resistance to changes of volume the mean of them makes no difference.
#[test]
fn mean_dilatation_without_lambda_is_linear_triangles() {
    let of = |kind: &str, mesh: &str, model: &str| {
        level(&format!(
            "(name: \"\", bodies: [(name: \"\", mesh: Rectangle(width: 0.4, height: 0.4, columns: {mesh}, rows: {mesh}, diagonals: Grid),
               element: {kind}, material: (model: {model}, young: 100, poisson: 0), mass: Density(1))])"
        ))
    };
    for model in Model::ALL.iter().map(|model| model.name()).filter(|name| *name != "StableNeoHookean") {
        let run = simulation(&of("MeanDilatation", "3", model));
        let body = &run.scene().bodies[0];
        let plain =
            Triangles::new(&run.scene().rest, body.vertices.clone(), &body.mesh, body.elements.material().clone());
        assert_eq!(plain.kind(), ElementKind::Linear);
        let x = shaken(&run.scene().rest, 0.02, 4);
        let (mut one, mut other) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        plain.elastic_force(&x, &mut vec![0.0; plain.scratch()], &mut one);
        body.elements.elastic_force(&x, &mut vec![0.0; plain.scratch()], &mut other);
        assert!(greatest_gap(&one, &other) < 1e-12 * norm(&one), "{model}");
        let (energy, same) = (plain.elastic_energy(&x), body.elements.elastic_energy(&x));
        assert!((energy - same).abs() < 1e-12 * energy, "{model}: {energy} {same}");
    }
}

/// The energy of a motion that is quadratic in space is exact: twice as fine triangles of six nodes have the same.
#[test]
fn quadratic_elements_are_exact_in_bending() {
    let energy = |columns: usize| {
        let run = simulation(&level(&format!(
            "(name: \"\", bodies: [(name: \"\", mesh: Rectangle(width: 1, height: 1, columns: {columns}, rows: {columns}, diagonals: Crossed),
               element: Quadratic, material: (model: Corotated, young: 1e3, poisson: 0.3), mass: Density(1))])"
        )));
        let rest = &run.scene().rest;
        let bent: Vec<_> = rest.chunks(2).flat_map(|p| [-p[0] * p[1], 0.5 * p[0] * p[0]]).collect();
        let product = stiffness_times(&*run.scene().bodies[0].elements, rest, &bent);
        0.5 * product.iter().zip(&bent).map(|(product, d)| product * d).sum::<f64>()
    };
    let (coarse, fine) = (energy(1), energy(4));
    assert!((coarse / fine - 1.0).abs() < 1e-12, "{coarse} {fine}");
}

/// A solution of the equations of equilibrium without body force, for any material: the gradient of Re z⁵, which is harmonic. Its
/// divergence is zero.
fn harmonic([x, y]: [f64; 2]) -> [f64; 2] {
    [x.powi(4) - 6.0 * x * x * y * y + y.powi(4), -4.0 * x.powi(3) * y + 4.0 * x * y.powi(3)]
}

/// Root mean square of the error of small displacements in a unit square, whose boundary is moved as that solution says; and the size of the
/// triangles.
fn error_of(kind: ElementKind, cells: usize, cut: &str, poisson: f64) -> f64 {
    let run = simulation(&level(&format!(
        "(name: \"\", bodies: [(name: \"\", mesh: Rectangle(width: 1, height: 1, columns: {cells}, rows: {cells}, diagonals: {cut}),
           element: {kind:?}, material: (model: Corotated, young: 1, poisson: {poisson}), mass: Density(1))])"
    )));
    let body = &run.scene().bodies[0];
    let rest = &run.scene().rest;
    let exact: Vec<_> = rest.chunks(2).flat_map(|p| harmonic([p[0], p[1]])).collect();
    let mut is_free = vec![true; rest.len()];
    for vertex in body.boundary.iter().flatten() {
        is_free[2 * *vertex as usize..][..2].fill(false);
    }
    let product = |d: &[f64]| {
        let mut product = stiffness_times(&*body.elements, rest, d);
        product.iter_mut().zip(&is_free).for_each(|(value, free)| *value *= f64::from(u8::from(*free)));
        product
    };
    // Conjugate gradients from the prescribed displacements of the boundary.
    let mut u: Vec<_> = exact.iter().zip(&is_free).map(|(exact, free)| if *free { 0.0 } else { *exact }).collect();
    let mut residual: Vec<_> = product(&u).iter().map(|value| -value).collect();
    let mut direction = residual.clone();
    let start = norm(&residual);
    let mut square = start * start;
    for _ in 0..20_000 {
        if square.sqrt() < 1e-11 * start {
            break;
        }
        let along = product(&direction);
        let step = square / along.iter().zip(&direction).map(|(a, b)| a * b).sum::<f64>();
        for number in 0..u.len() {
            u[number] += step * direction[number];
            residual[number] -= step * along[number];
        }
        let next = residual.iter().map(|value| value * value).sum::<f64>();
        direction.iter_mut().zip(&residual).for_each(|(d, residual)| *d = residual + next / square * *d);
        square = next;
    }
    assert!(square.sqrt() < 1e-11 * start, "{kind:?} {cells}: the equations are solved");
    error_at_centroids(kind, body.mesh.triangles(), rest, &u)
}

/// The error at the centroids of all triangles.
fn error_at_centroids(kind: ElementKind, triangles: &[[u32; 3]], rest: &[f64], u: &[f64]) -> f64 {
    let at = |field: &[f64], vertex: u32| [field[2 * vertex as usize], field[2 * vertex as usize + 1]];
    let mean = |field: &[f64], vertices: &[u32], weights: &[f64]| {
        let sum = |axis: usize| {
            vertices.iter().zip(weights).map(|(vertex, weight)| weight * at(field, *vertex)[axis]).sum::<f64>()
        };
        [sum(0), sum(1)]
    };
    let mut sum = 0.0;
    for (number, corners) in triangles.iter().enumerate() {
        let found = if kind == ElementKind::Quadratic {
            let four = &triangles[number / 4 * 4..][..4];
            let nodes = [four[0][0], four[1][1], four[2][2], four[0][1], four[1][2], four[2][0]];
            let mut l = [1.0 / 6.0; 3];
            match number % 4 {
                3 => l = [1.0 / 3.0; 3],
                corner => l[corner] = 4.0 / 6.0,
            }
            let [a, b, c] = l.map(|l| l * (2.0 * l - 1.0));
            mean(u, &nodes, &[a, b, c, 4.0 * l[0] * l[1], 4.0 * l[1] * l[2], 4.0 * l[2] * l[0]])
        } else {
            mean(u, corners, &[1.0 / 3.0; 3])
        };
        let expected = harmonic(mean(rest, corners, &[1.0 / 3.0; 3]));
        sum += (0..2).map(|axis| (found[axis] - expected[axis]).powi(2)).sum::<f64>();
    }
    (sum / triangles.len() as f64).sqrt()
}

/// Displacements converge with order 2 and 3, also where the volume hardly changes; linear triangles lock there.
#[test]
fn displacements_converge_with_their_order() {
    for (kind, order) in [(ElementKind::Linear, 2.0), (ElementKind::MeanDilatation, 2.0), (ElementKind::Quadratic, 3.0)]
    {
        for (cut, poisson) in [("Grid", 0.3), ("Crossed", 0.3), ("Grid", 0.4999), ("Alternating", 0.4999)] {
            let [coarse, fine] = [6, 12].map(|cells| error_of(kind, cells, cut, poisson));
            let found = (coarse / fine).log2();
            // Near incompressibility linear triangles lock, and quadratic ones lose up to one order.
            let order = if poisson > 0.4 { 2.0 } else { order };
            if kind != ElementKind::Linear || poisson < 0.4 {
                assert!(found > order - 0.1, "{kind:?} {cut} {poisson}: {coarse:e} {fine:e}, order {found}");
            }
        }
    }
}

/// The scene of a cantilever, ten times as long as high, that is pulled down at its end, of about so many elements.
fn cantilever(kind: ElementKind, cut: &str, rows: usize) -> Level {
    level(&format!(
        "(name: \"\", integrator: ImplicitEuler(), bodies: [(name: \"bar\", element: {kind:?}, pins: [Left], mass: Density(1),
            mesh: Rectangle(width: 5, height: 1, columns: {columns}, rows: {rows}, diagonals: {cut}),
            material: (model: NeoHookean, young: 1e4, poisson: 0.4999))],
         effects: [(effect: EdgeLoad(of: \"bar\", edges: [Right], traction: (0, -1)))])",
        columns = 5 * rows
    ))
}

/// How far the end of a cantilever goes down \[m\].
fn deflection(kind: ElementKind, cut: &str, rows: usize) -> f64 {
    let level = cantilever(kind, cut, rows);
    let scene = Scene::build(&level, RunMode::Simulate, &NoFiles, None).unwrap();
    let own = scene.triangles.len() as u32;
    let plan = MeshPlan { triangles: vec![own], ..MeshPlan::default() };
    let mut study = MeshStudy::new(&level, &NoFiles, 0.1, plan).unwrap();
    while !study.advance(Duration::from_secs(1)).finished {}
    let point = study.points().next().unwrap();
    assert_eq!(point.triangles, own as usize, "{:?}", point.status);
    point.value.unwrap()
}

/// Meshes of at most a thousand triangles, each divided into four, at Poisson's ratio 0.4999. Those of linear triangles are twice as fine in both
/// directions, so that all have as many vertices.
#[test]
fn elements_of_six_nodes_do_not_lock() {
    let converged = deflection(ElementKind::Quadratic, "Alternating", 16);
    for cut in CUTS {
        let rows = if cut == "Crossed" { 7 } else { 10 };
        for kind in [ElementKind::MeanDilatation, ElementKind::Quadratic] {
            let found = deflection(kind, cut, rows);
            assert!((found / converged - 1.0).abs() < 0.02, "{kind:?} {cut}: {found} for {converged}");
        }
    }
    let locked = deflection(ElementKind::Linear, "Grid", 20);
    assert!(locked / converged < 0.2, "{locked} for {converged}");
}

/// Every scheme runs every model with every kind, and continues bit for bit where it was saved.
#[test]
fn every_scheme_steps_elements_of_six_nodes() {
    for scheme in IntegratorKind::all() {
        for (what, level) in sheets("stretch: (1.1, 0.95), ") {
            let level = Level { integrator: scheme.clone(), ..level };
            let mut run = simulation(&level);
            let before = run.scene().bodies[0].elements.elastic_energy(&run.state().x);
            run.advance(20, &mut || true);
            assert!(run.fault().is_none(), "{what} {}: {:?}", scheme.name(), run.fault());
            assert!(run.state().x.iter().all(|x| x.is_finite()) && before > 0.0, "{what} {}", scheme.name());
            let mut again = reopened(&run, &level);
            for both in [&mut run, &mut again] {
                both.advance(10, &mut || true);
            }
            assert!(run.state().x == again.state().x && run.state().v == again.state().v, "{what} {}", scheme.name());
        }
    }
}

/// The same bits with any instruction set.
#[test]
fn every_instruction_set_gives_the_same_forces() {
    for (what, level) in sheets("") {
        let run = simulation(&level);
        let body = &run.scene().bodies[0].elements;
        let x = shaken(&run.scene().rest, 0.02, 6);
        let forces = |of: &Triangles| {
            let mut force = vec![0.0; x.len()];
            of.elastic_force(&x, &mut vec![0.0; of.scratch()], &mut force);
            force.push(of.elastic_energy(&x));
            force
        };
        assert!(forces(body) == forces(&body.in_set(Arch::Scalar)), "{what}");
    }
}

/// A typed energy does not say which part of it resists changes of volume.
#[test]
fn mean_dilatation_of_a_typed_energy_is_refused_in_words() {
    let energy = "energy: (formula: \"mu/2*(I1 - 2 - 2*log(J)) + lambda/2*log(J)^2\")";
    let build = |kind: &str| {
        let level = sheet("NeoHookean", &format!("element: {kind}, {energy}"), "");
        Scene::build(&level, RunMode::Simulate, &NoFiles, None).map(|scene| scene.triangles.len())
    };
    assert_eq!(build("Quadratic").unwrap(), 4 * build("Linear").unwrap());
    let why = build("MeanDilatation").unwrap_err().to_string();
    assert!(why.contains("which part of its energy resists changes of volume"), "{why}");
}

//! Facts about membranes: triangles in space of any material.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a failing test should panic")]

use crate::common::{Random, assert_minus_derivative, difference_error, greatest_gap, named, norm};
use gingerbread::{
    effects::{Effect as _, EffectParameters as _, Gravity, Motion},
    elements::{BodyMaterial, Elements, Membranes, Triangles},
    integrators::IntegratorKind,
    level::Sleep,
    materials::{Lame, MaterialParameters, Model, Plane, PlaneStress},
    meshes::Mesh,
    quantity::{self, Poisson, Young},
    scene::Scene,
    simulation::Simulation,
    solvers::{BlockMatrix, Tangent, Weights},
    state::State,
};
use nalgebra::{DMatrix, Matrix2, Rotation3, Vector3};
use std::sync::Arc;

const THICKNESS: f64 = 0.1;

fn material(model: Model, young: f64, poisson: f64, plane: Plane) -> MaterialParameters {
    MaterialParameters::new(model, Young::new(young).unwrap(), Poisson::new(poisson).unwrap(), plane).unwrap()
}

/// A square from (-0.5, -0.5) to (0.5, 0.5) with this many cells along a side.
fn square(cells: u32) -> Mesh {
    let side = f64::from(cells);
    let place = |number: u32| f64::from(number) / side - 0.5;
    let points = (0..=cells).flat_map(|row| (0..=cells).map(move |column| [place(column), place(row)])).collect();
    let corner = |row: u32, column: u32| row * (cells + 1) + column;
    let cell = |row: u32, column: u32| {
        let [a, b, c, d] =
            [corner(row, column), corner(row, column + 1), corner(row + 1, column + 1), corner(row + 1, column)];
        [[a, b, c], [a, c, d]]
    };
    let triangles = (0..cells).flat_map(|row| (0..cells).flat_map(move |column| cell(row, column))).collect();
    Mesh::new(points, triangles).unwrap()
}

/// Points of a mesh in the plane z = 0.
fn in_space(mesh: &Mesh) -> Vec<f64> {
    mesh.points().iter().flat_map(|[x, y]| [*x, *y, 0.0]).collect()
}

fn membranes(mesh: &Mesh, material: MaterialParameters) -> Membranes {
    Membranes::new(0..mesh.points().len(), mesh, material.into(), THICKNESS)
}

/// A scene of one membrane.
fn scene(mesh: &Mesh, material: MaterialParameters, density: f64) -> Scene {
    let membranes = membranes(mesh, material);
    Scene::of_elements(3, in_space(mesh), &membranes.lumped_mass(density), vec![Arc::new(membranes)]).unwrap()
}

/// Positions of a mesh in space with random displacements of this size.
fn crumpled(mesh: &Mesh, size: f64, random: &mut Random) -> Vec<f64> {
    in_space(mesh).into_iter().map(|x| x + random.between(-size, size)).collect()
}

fn force(of: &Membranes, x: &[f64]) -> Vec<f64> {
    let mut force = vec![0.0; x.len()];
    of.force(Motion { dimension: 3, x, ..Motion::NONE }, &mut [], &mut force);
    force
}

/// A uniform deformation in the plane, turned and moved in space: forces are those of the plane, turned.
#[test]
fn stress_in_space_is_that_of_the_plane() {
    let (mesh, mut random) = (square(3), Random(7));
    for &model in Model::ALL {
        let material = material(model, 1e4, 0.3, Plane::Stress);
        let plane = Triangles::new(mesh.points().as_flattened(), 0..16, &mesh, material.into());
        for _ in 0..10 {
            let f: Matrix2<f64> = random.gradient(0.6, 1.7);
            let f = if f.determinant() < 0.0 { Matrix2::new(f.m12, f.m11, f.m22, f.m21) } else { f };
            let turn = Rotation3::from_euler_angles(
                random.between(-3.0, 3.0),
                random.between(-1.5, 1.5),
                random.between(-3.0, 3.0),
            );
            let flat: Vec<f64> =
                mesh.points().iter().flat_map(|[x, y]| [f.m11 * x + f.m12 * y, f.m21 * x + f.m22 * y]).collect();
            let space: Vec<f64> = flat
                .chunks(2)
                .flat_map(|point| {
                    let [x, y, z]: [f64; 3] = (turn * Vector3::new(point[0], point[1], 0.0)).into();
                    [x + 0.3, y - 0.2, z + 0.7]
                })
                .collect();
            let mut expected = vec![0.0; flat.len()];
            plane.elastic_force(&flat, &mut vec![0.0; plane.scratch()], &mut expected);
            let expected: Vec<f64> = expected
                .chunks(2)
                .flat_map(|of| -> [f64; 3] { (turn * Vector3::new(of[0], of[1], 0.0) * THICKNESS).into() })
                .collect();
            let membranes = membranes(&mesh, material);
            let found = force(&membranes, &space);
            let apart = greatest_gap(&found, &expected) / norm(&expected);
            assert!(apart < 1e-12, "{model:?} at {f}: {apart:e}");
            let (energy, flat) = (membranes.elastic_energy(&space), THICKNESS * plane.elastic_energy(&flat));
            assert!((energy / flat - 1.0).abs() < 1e-12, "{model:?}: {energy} J, {flat} J");
        }
    }
}

#[test]
fn a_flat_membrane_moves_as_its_body_in_the_plane() {
    let mesh = square(6);
    for model in [Model::Corotated, Model::StVenantKirchhoff, Model::NeoHookean] {
        for name in ["SymplecticEuler", "RungeKutta4", "ImplicitEuler"] {
            let material = material(model, 1e4, 0.3, Plane::Strain);
            let mut space = scene(&mesh, material, 1000.0);
            let mass: Vec<f64> = space.mass.iter().step_by(3).copied().collect();
            let triangles =
                Triangles::new(mesh.points().as_flattened(), 0..mesh.points().len(), &mesh, material.into());
            let mut plane = Scene::of_elements(
                2,
                mesh.points().concat(),
                &mass.iter().map(|mass| mass / THICKNESS).collect::<Vec<_>>(),
                vec![Arc::new(triangles)],
            )
            .unwrap();
            for scene in [&mut space, &mut plane] {
                (scene.integrator, scene.step, scene.sleep) = (named(name), 2e-3, Sleep::Off);
                scene.pin(&[0, 6]);
            }
            let run = |scene: Scene, dimension: usize| {
                let mut start = scene.start.clone();
                for (point, v) in start.x.chunks(dimension).zip(start.v.chunks_mut(dimension)) {
                    (v[0], v[1]) = (0.3 * point[1] + 0.2, -0.8 * point[0] * point[1]);
                }
                start.v.iter_mut().zip(&scene.inverse_mass).for_each(|(v, w)| *v = if *w == 0.0 { 0.0 } else { *v });
                let mut simulation = Simulation::new(scene, start);
                simulation.advance(200, &mut || true);
                simulation.state().x.clone()
            };
            let (space, plane) = (run(space, 3), run(plane, 2));
            let seen: Vec<f64> = space.chunks(3).flat_map(|point| [point[0], point[1]]).collect();
            let apart = greatest_gap(&seen, &plane);
            assert!(greatest_gap(&plane, mesh.points().as_flattened()) > 0.02, "it moves");
            assert!(
                apart < 1e-12 && space.iter().skip(2).step_by(3).all(|z| *z == 0.0),
                "{model:?}, {name}: {apart:e}"
            );
        }
    }
}

#[test]
fn rigid_motion_gives_no_force() {
    let mesh = square(4);
    for &model in Model::ALL {
        let membranes = membranes(&mesh, material(model, 1e4, 0.3, Plane::Stress));
        let turn = Rotation3::from_euler_angles(2.0, -0.7, 1.1);
        let x: Vec<f64> = in_space(&mesh)
            .chunks(3)
            .flat_map(|point| -> [f64; 3] {
                (turn * Vector3::from_column_slice(point) + Vector3::new(5.0, 0.1, -2.0)).into()
            })
            .collect();
        // A strain of one gives some 200 N.
        assert!(norm(&force(&membranes, &x)) < 1e-11, "{model:?}");
    }
}

#[test]
fn force_and_stiffness_are_derivatives() {
    let (mesh, mut random) = (square(3), Random(3));
    for &model in Model::ALL {
        for plane in [Plane::Strain, Plane::Stress, Plane::StressExact] {
            if plane == Plane::StressExact && model.plane_stress() == PlaneStress::Approximate {
                continue;
            }
            let membranes = membranes(&mesh, material(model, 1e3, 0.3, plane));
            let x = crumpled(&mesh, 0.12, &mut random);
            let what = format!("{model:?}, {plane:?}");
            assert_minus_derivative(&x, &force(&membranes, &x), |x| membranes.elastic_energy(x), &what);
            let d: Vec<f64> = x.iter().map(|_| random.between(-1.0, 1.0)).collect();
            let mut product = vec![0.0; x.len()];
            let motion = Motion { dimension: 3, x: &x, ..Motion::NONE };
            membranes.stiffness_times(motion, &d, &mut [], &mut product);
            let error = difference_error(&x, &d, &product, |x| force(&membranes, x));
            assert!(error < 1e-7, "{what}: {error:e}");
            let mut by_matrix = vec![0.0; x.len()];
            matrix(&membranes, &x, Tangent::Exact).add_product(&d, &mut by_matrix);
            assert!(greatest_gap(&product, &by_matrix) < 1e-12 * norm(&product), "{what}");
        }
    }
}

fn matrix(of: &Membranes, x: &[f64], tangent: Tangent) -> BlockMatrix<3> {
    let mut pairs = Vec::new();
    of.sparsity_pattern(&mut |a, b| pairs.push([a, b]));
    let mut matrix = BlockMatrix::<3>::new(x.len() / 3, &pairs);
    let weights = Weights { position: 1.0, velocity: 0.0, tangent };
    of.add_stiffness(Motion { dimension: 3, x, ..Motion::NONE }, weights, &mut matrix);
    assert!(matrix.is_full());
    matrix
}

/// Pressed membranes buckle: their true stiffness is indefinite, the projected one is not, and a pulled one is not changed.
#[test]
fn projected_stiffness_is_positive() {
    let (mesh, mut random) = (square(2), Random(11));
    let dense = |of: &Membranes, x: &[f64], tangent| {
        let matrix = matrix(of, x, tangent);
        let columns = (0..x.len()).flat_map(|number| {
            let (mut unit, mut column) = (vec![0.0; x.len()], vec![0.0; x.len()]);
            unit[number] = 1.0;
            matrix.add_product(&unit, &mut column);
            column
        });
        DMatrix::from_vec(x.len(), x.len(), columns.collect())
    };
    for &model in Model::ALL {
        let membranes = membranes(&mesh, material(model, 1e3, 0.3, Plane::Stress));
        let pressed: Vec<f64> = crumpled(&mesh, 0.02, &mut random).iter().map(|x| 0.8 * x).collect();
        let eigenvalues = |tangent| dense(&membranes, &pressed, tangent).symmetric_eigenvalues();
        assert!(eigenvalues(Tangent::Exact).min() < -1.0, "{model:?}");
        let greatest = eigenvalues(Tangent::Exact).max();
        for tangent in [Tangent::Definite, Tangent::Absolute] {
            assert!(eigenvalues(tangent).min() > -1e-12 * greatest, "{model:?}, {tangent:?}");
        }
        let pulled: Vec<f64> = in_space(&mesh).iter().map(|x| 1.1 * x).collect();
        let [exact, definite] = [Tangent::Exact, Tangent::Definite].map(|tangent| dense(&membranes, &pulled, tangent));
        assert!((exact - definite).amax() < 1e-11 * greatest, "{model:?}");
    }
}

/// Where a triangle has become a line or a point.
#[test]
fn collapsed_triangles_have_finite_forces_that_open_them() {
    let mesh = Mesh::new(vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], vec![[0, 1, 2]]).unwrap();
    for &model in Model::ALL {
        let membranes = membranes(&mesh, material(model, 1e3, 0.3, Plane::Stress));
        let line = [0.0, 0.0, 0.0, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0];
        let near: Vec<f64> =
            line.iter().enumerate().map(|(number, x)| x + 1e-9 * f64::from(number as u32 % 4)).collect();
        for x in [&line[..], &[0.2; 9], &near] {
            let force = force(&membranes, x);
            assert!(force.iter().all(|force| force.is_finite()), "{model:?} at {x:?}: {force:?}");
            for tangent in [Tangent::Definite, Tangent::Absolute] {
                let matrix = matrix(&membranes, x, tangent);
                assert!(matrix.diagonals().iter().flatten().all(|entry| entry.is_finite()), "{model:?} at {x:?}");
            }
        }
        let energies = [&line[..], &near].map(|x| membranes.elastic_energy(x));
        assert!((energies[0] / energies[1] - 1.0).abs() < 1e-6, "{model:?}: {energies:?}");
    }
}

#[test]
fn every_instruction_set_has_the_same_bits() {
    let (mesh, mut random) = (square(5), Random(5));
    let x = crumpled(&mesh, 0.05, &mut random);
    for &model in Model::ALL {
        let material = material(model, 1e3, 0.3, Plane::Stress);
        let all: Vec<_> = gingerbread::simd::sets()
            .into_iter()
            .map(|set| {
                let membranes = Membranes::in_set(0..36, &mesh, material.into(), THICKNESS, set);
                let matrix = matrix(&membranes, &x, Tangent::Definite);
                (force(&membranes, &x), membranes.elastic_energy(&x).to_bits(), matrix.blocks().to_vec())
            })
            .collect();
        assert!(all.windows(2).all(|pair| pair[0] == pair[1]), "{model:?}");
    }
}

/// A turning, stretched membrane with waves, and what its schemes keep.
#[test]
fn the_energy_momentum_method_keeps_both() {
    let mesh = square(4);
    for &model in Model::ALL {
        let mut scene = scene(&mesh, material(model, 1e4, 0.3, Plane::Stress), 1000.0);
        (scene.integrator, scene.step) = (named("EnergyMomentum"), 5e-3);
        let start = moving(&scene);
        let mut simulation = Simulation::new(scene, start);
        let (energy, momentum) = (simulation.energies().total(), angular_momentum(&simulation));
        for _ in 0..50 {
            simulation.advance(1, &mut || true);
            let (now, turned) = (simulation.energies().total(), angular_momentum(&simulation));
            assert!((now / energy - 1.0).abs() < 1e-9, "{model:?}: {now} J of {energy} J");
            assert!((turned - momentum).norm() < 1e-8 * momentum.norm(), "{model:?}: {turned}");
        }
        assert_eq!(simulation.counts().unconverged, 0, "{model:?}");
    }
}

fn moving(scene: &Scene) -> State {
    let mut start = scene.start.clone();
    for (point, v) in start.x.chunks_mut(3).zip(start.v.chunks_mut(3)) {
        let (x, y) = (point[0], point[1]);
        (point[0], point[1], point[2]) = (1.1 * x, 1.05 * y + 0.05 * x, 0.1 * (3.0 * x).sin() * y);
        (v[0], v[1], v[2]) = (-0.5 * y, 0.5 * x, 0.4 * x * y + 0.2 * x);
    }
    start
}

fn angular_momentum(of: &Simulation) -> Vector3<f64> {
    let (state, mass) = (of.state(), &of.scene().mass);
    let all = state.x.chunks(3).zip(state.v.chunks(3)).zip(mass.chunks(3));
    all.map(|((x, v), mass)| Vector3::from_column_slice(x).cross(&Vector3::from_column_slice(v)) * mass[0]).sum()
}

/// All schemes agree on a membrane that moves in space, in steps of a tenth of the stability limit.
#[test]
fn every_integrator_moves_a_membrane() {
    let mesh = square(3);
    for &model in Model::ALL {
        let end = |kind: IntegratorKind, step: f64| {
            let mut scene = scene(&mesh, material(model, 1e4, 0.3, Plane::Stress), 1000.0);
            (scene.integrator, scene.step, scene.sleep) = (kind, step, Sleep::Off);
            scene.pin(&[12, 15]);
            let mut start = moving(&scene);
            start.v.iter_mut().zip(&scene.inverse_mass).for_each(|(v, w)| *v = if *w == 0.0 { 0.0 } else { *v });
            let mut simulation = Simulation::new(scene, start);
            simulation.advance((0.2 / step).round() as u64, &mut || true);
            assert!(simulation.fault().is_none() && simulation.counts().unconverged == 0, "{model:?}");
            simulation.state().x.clone()
        };
        let exact = end(named("RungeKutta4"), 1e-3);
        for kind in IntegratorKind::all() {
            let allowed = if kind.kind().order() == 1 { 0.05 } else { 2e-3 };
            let apart = greatest_gap(&end(kind.clone(), 2e-3), &exact);
            assert!(apart < allowed, "{model:?}, {}: {apart}", kind.name());
        }
    }
}

/// The cloth of the University of Toronto's course: 400 vertices, 722 triangles, and its energy of principal stretches, which is that
/// of the corotated model. The course passes the weights in the other order than it names them; both are known.
#[test]
fn the_toronto_cloth_hangs_as_in_its_course() {
    for (mu, lambda, known) in [(142_857.0, 35_714.0, -0.502_84), (35_714.0, 142_857.0, -0.507_38)] {
        let mesh = square(19);
        let material = BodyMaterial::new(Model::Corotated, Lame { mu, lambda }, Plane::Stress);
        let membranes = Membranes::new(0..400, &mesh, material, 1.0);
        assert_eq!(membranes.corners().len(), 722);
        let mut scene =
            Scene::of_elements(3, in_space(&mesh), &membranes.lumped_mass(1.0), vec![Arc::new(membranes)]).unwrap();
        scene.pin(&(380..400).collect::<Vec<_>>());
        let gravity = Gravity { down: quantity::Gravity::new(1800.8).unwrap(), ..Gravity::default() };
        scene.add_effect(gravity.build(&Elements::default()).unwrap().into()).unwrap();
        (scene.integrator, scene.step, scene.guard, scene.sleep) =
            (named("LinearlyImplicitEuler"), 1e-3, false, Sleep::Off);
        let start = scene.start.clone();
        let mut simulation = Simulation::new(scene, start);
        simulation.advance(20, &mut || true);
        let lowest = simulation.state().x.iter().skip(1).step_by(3).copied().fold(f64::INFINITY, f64::min);
        assert!((lowest - known).abs() < 2e-5, "{lowest} m");
    }
}

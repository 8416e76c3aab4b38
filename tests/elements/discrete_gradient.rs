//! Facts about the mean forces of the energy-momentum method: work, balance, and what a step keeps.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a failing test should panic")]

use crate::common::{Random, assert_balanced, level, norm, sheet, started};
use gingerbread::{
    effects::{Effect, Motion},
    elements::{ElementKind, Springs},
    files,
    level::{Level, RunMode},
    materials::{MaterialParameters, Model, Plane},
    meshes::NoFiles,
    nets::{Link, Role},
    scene::Scene,
};

const SPAN: f64 = 0.02;

/// A step of a scene: its middle and its mean velocity.
struct Step {
    middle: Vec<f64>,
    velocity: Vec<f64>,
}

impl Step {
    /// Positions before the step, or after it.
    fn end(&self, sign: f64) -> Vec<f64> {
        self.middle.iter().zip(&self.velocity).map(|(x, v)| x + sign * 0.5 * SPAN * v).collect()
    }

    fn motion(&self, dimension: usize) -> Motion<'_> {
        Motion { dimension, x: &self.middle, v: &self.velocity, elastic_span: SPAN, ..Motion::NONE }
    }

    fn force(&self, effect: &dyn Effect, dimension: usize) -> Vec<f64> {
        let mut force = vec![0.0; self.middle.len()];
        effect.force(self.motion(dimension), &mut vec![0.0; effect.scratch()], &mut force);
        force
    }

    /// Asserts that the force of an effect does the work of its energy, and that it has neither sum nor torque about the middle.
    fn assert_conserves(&self, effect: &dyn Effect, dimension: usize, what: &str) {
        let force = self.force(effect, dimension);
        let energy = |sign: f64| {
            let x = self.end(sign);
            effect.energy(Motion { x: &x, ..self.motion(dimension) })
        };
        let (before, after) = (energy(-1.0), energy(1.0));
        let work: f64 = force.iter().zip(&self.velocity).map(|(force, v)| SPAN * force * v).sum();
        let scale = before.abs().max(after.abs()) + norm(&force) * SPAN * norm(&self.velocity);
        // A strain of one stores some 10 J.
        assert!((work + after - before).abs() <= 1e-12 * scale + 1e-14, "{what}: {work} of {before} to {after}");
        if dimension == 2 {
            assert_balanced(&self.middle, &force, what);
        }
    }
}

/// A random step with changes of this size from rest, and of the shape within the step.
fn step(random: &mut Random, rest: &[f64], size: f64) -> Step {
    let middle = rest.iter().map(|x| x + random.between(-size, size)).collect();
    let velocity = rest.iter().map(|_| random.between(-size, size) / SPAN).collect();
    Step { middle, velocity }
}

/// A sheet that turns by a large angle in the step, beside random changes: all models, planes, and the compression guard.
#[test]
fn mean_forces_do_the_work_of_the_energy() {
    let mut random = Random(3);
    for (model, kind) in Model::ALL.iter().flat_map(|model| ElementKind::ALL.map(|kind| (model, kind))) {
        for plane in [Plane::Strain, Plane::Stress] {
            let element = format!("element: {kind:?}");
            let mut level = sheet(model.name(), &element, "effects: [(effect: Compression(strength: 2))]");
            let material = level.bodies[0].material;
            level.bodies[0].material =
                MaterialParameters::new(*model, material.young(), material.poisson(), plane).unwrap();
            let scene = Scene::build(&level, RunMode::Simulate, &NoFiles, None).unwrap();
            for size in [1e-4, 1e-3, 0.04] {
                let mut one = step(&mut random, &scene.rest, size);
                let turned = one.middle.chunks(2).flat_map(|x| [-30.0 * x[1], 30.0 * x[0]]);
                if size > 1e-4 {
                    one.velocity.iter_mut().zip(turned).for_each(|(v, turned)| *v += turned);
                }
                for effect in &scene.effects {
                    let what = format!("{} {} {kind:?} {plane:?} {size}", effect.name(), model.name());
                    one.assert_conserves(&**effect, 2, &what);
                }
            }
        }
    }
}

#[test]
fn mean_forces_of_springs_do_the_work_of_their_energy() {
    let mut random = Random(5);
    let rest: Vec<_> = (0..18).map(|_| random.between(-1.0, 1.0)).collect();
    let links = |count: u32| {
        let link = |from: u32, to: u32| Link {
            ends: [from, to],
            stiffness: 50.0 + f64::from(to),
            rest: 0.7,
            role: Role::Structural,
        };
        (0..count).flat_map(|from| (from + 1..count).map(move |to| link(from, to))).collect::<Vec<_>>()
    };
    let (plane, space) = (Springs::<2>::of_links(links(9), 0..9), Springs::<3>::of_links(links(6), 0..6));
    for size in [1e-3, 0.5] {
        let one = step(&mut random, &rest, size);
        one.assert_conserves(&plane, 2, "plane");
        one.assert_conserves(&space, 3, "space");
    }
}

/// A disk that bounces on a floor, for 3 s at 1/60 s, and a net that swings.
#[test]
fn steps_of_any_length_keep_the_energy() {
    let disk = |model: Model| {
        level(&format!(
            "(name: \"\", bodies: [(name: \"disk\", mesh: Disk(centre: (0.5, 0.5), radius: 0.2, rings: 6),
                material: (model: {}, young: 1000, poisson: 0.3, plane: Stress), mass: Total(12.5))],
            effects: [(effect: Gravity(down: 2)), (effect: Contact()),
                (effect: Walls(obstacles: [Plane(point: (0, 0), normal: (0, 1), eps: 0.01)]))])",
            model.name()
        ))
    };
    // Energy that the drop sets free [J].
    let levels = [Model::Corotated, Model::FixedCorotated, Model::StableNeoHookean, Model::NeoHookean, Model::Hencky]
        .map(|model| (disk(model), 12.5 * 2.0 * 0.3));
    let net: Level = files::parse(
        "(name: \"\", nets: [(name: \"net\", net: Sheet(corner: (0, 0), width: 1, height: 1, columns: 6, rows: 6,
            structural: 300, shear: 100, flexion: 30), mass: 0.05, pins: [Nearest(0, 1)])], effects: [(effect: Gravity(down: 9.81))])",
        "net",
    )
    .unwrap();
    for (level, scale) in levels.into_iter().chain([(net, 0.05 * 49.0 * 9.81)]) {
        let mut simulation = started(&level, "EnergyMomentum()", 1.0 / 60.0);
        let start = simulation.energies().total();
        for _ in 0..180 {
            simulation.advance(1, &mut || true);
            assert!(simulation.fault().is_none(), "{:?}", simulation.fault());
            let error = (simulation.energies().total() - start) / scale;
            assert!(error.abs() < 1e-8, "{}: {error:e}", simulation.state().time);
        }
        assert_eq!((simulation.counts().unconverged, simulation.counts().constrained), (0, 0));
    }
}

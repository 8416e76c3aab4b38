//! Facts about contact of cloth in space with itself and with other cloth.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a failing test should panic")]

use crate::common::{Random, continues_bit_for_bit, level, named, norm, simulation};
use gingerbread::{
    contact::{Anchor, AnyContact, Candidates, ContactTerm, SurfaceTerm, Touch},
    effects::Motion,
    integrators::IntegratorKind,
    level::{Level, Sleep, Substeps},
    meshes::NoFiles,
    scene::Scene,
    simulation::Simulation,
    solvers::{BlockMatrix, Tangent, Weights},
};

fn built(text: &str) -> Scene {
    let level = level(text);
    Scene::build(&level, level.mode, &NoFiles, None).unwrap()
}

fn surface_contact(scene: &Scene) -> &dyn SurfaceTerm {
    scene.effects.iter().find_map(|effect| effect.surface_contact()).unwrap()
}

fn contact(scene: &Scene) -> &(dyn ContactTerm<3, 2, 4> + '_) {
    match surface_contact(scene).contact() {
        AnyContact::Space(contact) => contact,
        AnyContact::Plane(_) => unreachable!(),
    }
}

/// A square membrane of 0.4 m with this name, number of cells along a side, and place.
fn sheet(name: &str, cells: u32, place: &str) -> String {
    format!(
        "(name: \"{name}\", mesh: Rectangle(width: 0.4, height: 0.4, columns: {cells}, rows: {cells}, diagonals: Alternating, corner: (-0.2, -0.2)),
        material: (model: NeoHookean, young: 20000, poisson: 0.3, plane: Stress), thickness: 0.01, mass: Density(100), space: ({place}))"
    )
}

/// What a candidate list and a pattern are for.
struct Near<'a> {
    scene: &'a Scene,
    candidates: Candidates,
    pattern: Vec<[u32; 2]>,
}

impl<'a> Near<'a> {
    fn at(scene: &'a Scene, x: &[f64]) -> Self {
        let (mut candidates, mut pattern) = (Candidates::default(), Vec::new());
        surface_contact(scene).update(&mut candidates, x, &[]);
        surface_contact(scene).add_near(&candidates, x, &mut pattern);
        Self { scene, candidates, pattern }
    }

    fn motion<'b>(&'b self, [x, v]: [&'b [f64]; 2], anchors: &'b [Anchor]) -> Motion<'b> {
        let Scene { mass, inverse_mass, .. } = self.scene;
        let (candidates, pattern) = (Some(&self.candidates), self.pattern.as_slice());
        Motion { dimension: 3, x, v, mass, inverse_mass, anchors, candidates, pattern, ..Motion::NONE }
    }

    fn force(&self, x: &[f64], v: &[f64], anchors: &[Anchor]) -> Vec<f64> {
        let mut force = vec![0.0; x.len()];
        contact(self.scene).force(self.motion([x, v], anchors), &mut force);
        force
    }

    fn energy(&self, x: &[f64]) -> f64 {
        contact(self.scene).energy(self.motion([x, &vec![0.0; x.len()]], &[]))
    }
}

/// Sums of forces, and of their torques, about the axes.
fn sums(x: &[f64], force: &[f64]) -> [f64; 6] {
    x.chunks_exact(3).zip(force.chunks_exact(3)).fold([0.0; 6], |sums, (x, f)| {
        let torque = [x[1] * f[2] - x[2] * f[1], x[2] * f[0] - x[0] * f[2], x[0] * f[1] - x[1] * f[0]];
        let all = [f[0], f[1], f[2], torque[0], torque[1], torque[2]];
        std::array::from_fn(|number| sums[number] + all[number])
    })
}

/// What a contact is of.
fn kind(touch: &Touch<3, 2, 4>) -> usize {
    let parts = touch.weights.iter().filter(|weight| **weight != 0.0).count();
    match (touch.area_gradient, touch.area < 0.0, parts) {
        (Some(_), ..) => 0,
        (None, true, _) => 1,
        (None, false, parts) => parts,
    }
}

/// Two sheets that lie on each other, one of them folded over, displaced irregularly, with the particles of a chain on top.
fn crumpled(random: &mut Random) -> (Scene, Vec<f64>) {
    let chain = "nets: [(name: \"chain\", net: Chain(from: (-0.1, 0), to: (0.1, 0), springs: 5, stiffness: 20), mass: 0.01, space: (turn: (90, 0, 0), offset: (0, 0.03, 0.01)))]";
    let scene = built(&format!(
        "(name: \"\", membranes: [{}, {}], {chain}, effects: [(effect: Contact(dissipation: 0.3, thickness: 0.4)), (effect: Friction(coefficient: 0.5))])",
        sheet("low", 6, "turn: (90, 0, 0)"),
        sheet("high", 5, "turn: (90, 25, 0), offset: (0.01, 0.015, 0.02)"),
    ));
    let mut x = scene.start.x.clone();
    for point in x.chunks_exact_mut(3) {
        // Folded about a line across the sheets.
        let beyond = point[0] - 0.02;
        if beyond > 0.0 {
            (point[0], point[1]) = (0.02 - beyond, point[1] + 0.05 + 0.2 * beyond);
        }
        for number in point {
            *number += random.between(-6e-3, 6e-3);
        }
    }
    (scene, x)
}

/// Contacts of all kinds: crossing edges, what is subtracted, corners, edges and triangles.
#[test]
fn forces_are_slopes_of_an_energy_and_keep_momentum() {
    let mut kinds = [0; 5];
    for seed in 0..12 {
        let mut random = Random(seed);
        let (scene, x) = crumpled(&mut random);
        let near = Near::at(&scene, &x);
        let count = x.len();
        let still = vec![0.0; count];
        contact(&scene).each(near.motion([&x, &still], &[]), &mut |touch| kinds[kind(touch)] += 1);
        let force = near.force(&x, &still, &[]);
        let greatest = force.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
        let moved = |number: usize, by: f64| {
            let mut x = x.clone();
            x[number] += by;
            x
        };
        for (number, force) in force.iter().enumerate() {
            let slope = (near.energy(&moved(number, 1e-8)) - near.energy(&moved(number, -1e-8))) / 2e-8;
            assert!((force + slope).abs() < 2e-6 * greatest, "{seed} {number}: {force} {slope}");
        }
        // With velocities and friction too.
        let v: Vec<_> = (0..count).map(|_| random.between(-1.0, 1.0)).collect();
        let mut anchors = Vec::new();
        contact(&scene).drag_anchors(near.motion([&x, &v], &[]), 1e-4, &mut anchors);
        anchors.sort_unstable_by_key(|anchor| anchor.contact);
        for anchor in &mut anchors {
            anchor.point.iter_mut().for_each(|number| *number += random.between(-1e-3, 1e-3));
        }
        let rubbed = near.force(&x, &v, &anchors);
        let friction: Vec<_> = rubbed.iter().zip(near.force(&x, &v, &[])).map(|(one, other)| one - other).collect();
        assert!(norm(&friction) > 0.01 * norm(&force), "the anchors pull");
        for force in [&force, &rubbed] {
            let sums = sums(&x, force);
            assert!(sums.iter().all(|sum| sum.abs() < 1e-12 * norm(force)), "{seed}: {sums:?}");
        }
    }
    assert!(kinds.iter().all(|count| *count >= 5), "{kinds:?}");
}

/// The slip over a triangle, and of crossing edges, is the place of the contact along the surface: its derivative is what friction acts along.
#[test]
fn slips_are_derivatives() {
    let (scene, x) = crumpled(&mut Random(5));
    let near = Near::at(&scene, &x);
    let still = vec![0.0; x.len()];
    let mut touches = Vec::new();
    contact(&scene).each(near.motion([&x, &still], &[]), &mut |touch| touches.push(*touch));
    // Anchors of all contacts where they are now; what the slip is when a vertex has moved.
    let mut anchors: Vec<_> = touches.iter().map(|touch| touch.dragged(0.0).0).collect();
    anchors.sort_unstable_by_key(|anchor| anchor.contact);
    let mut compared = [0; 2];
    let slips = |x: &[f64]| {
        let mut slips = Vec::new();
        contact(&scene).each(near.motion([x, &still], &anchors), &mut |touch| {
            let along = |way: usize| touch.memory.map_or(0.0, |(slip, _)| slip[way]);
            let vectors = [0, 1].map(|way| touch.slips.map(|slips| slips[way]));
            slips.push((touch.name, std::array::from_fn::<_, 2, _>(along), vectors, kind(touch)));
        });
        slips
    };
    for (number, touch) in touches.iter().enumerate() {
        for i in 0..4 {
            for axis in 0..3 {
                let moved = |by: f64| {
                    let mut x = x.clone();
                    x[3 * touch.vertices[i] as usize + axis] += by;
                    slips(&x)
                };
                let (ahead, behind) = (moved(1e-7), moved(-1e-7));
                let (Some(ahead), Some(behind)) = (ahead.get(number), behind.get(number)) else { continue };
                if ahead.0 != touch.name
                    || behind.0 != touch.name
                    || ![0, 4].contains(&kind(touch))
                    || touch.vertices[..i].contains(&touch.vertices[i])
                {
                    continue;
                }
                for way in 0..2 {
                    let slope = (ahead.1[way] - behind.1[way]) / 2e-7;
                    assert!(
                        (slope - touch.slips[i][way][axis]).abs() < 1e-4,
                        "{:?} {i} {axis} {way}: {slope} {:?}",
                        kind(touch),
                        touch.slips[i][way]
                    );
                    compared[usize::from(touch.area_gradient.is_some())] += 1;
                }
            }
        }
    }
    assert!(compared.iter().all(|count| *count > 200), "{compared:?}");
}

/// The matrix is the product of the stiffness, and what Newton's method takes is positive semidefinite.
#[test]
fn the_matrix_is_that_of_the_contacts() {
    let mut random = Random(2);
    let (scene, x) = crumpled(&mut random);
    let (near, count) = (Near::at(&scene, &x), x.len());
    let v: Vec<_> = (0..count).map(|_| random.between(-0.01, 0.01)).collect();
    let d: Vec<_> = (0..count).map(|_| random.between(-1.0, 1.0)).collect();
    let motion = near.motion([&x, &v], &[]);
    let mut pairs = Vec::new();
    contact(&scene).sparsity_pattern(&near.pattern, &mut |a, b| pairs.push([a, b]));
    let mut matrix = BlockMatrix::<3>::new(count / 3, &pairs);
    let weights = Weights { position: 1.0, velocity: 0.0, tangent: Tangent::Exact };
    let (mut product, mut times) = (vec![0.0; count], vec![0.0; count]);
    contact(&scene).add_stiffness(motion, weights, &mut matrix);
    matrix.add_product(&d, &mut product);
    contact(&scene).stiffness_times(motion, &d, &mut times);
    assert!(norm(&times) > 0.0);
    assert!(times.iter().zip(&product).all(|(a, b)| (a - b).abs() <= 1e-12 * norm(&times)));
    for tangent in [Tangent::Definite, Tangent::Absolute] {
        matrix.clear();
        product.fill(0.0);
        contact(&scene).add_stiffness(motion, Weights { tangent, ..weights }, &mut matrix);
        matrix.add_product(&d, &mut product);
        assert!(d.iter().zip(&product).map(|(a, b)| a * b).sum::<f64>() >= 0.0);
    }
}

/// Of two equal sheets the energy is the area times that of the skin at their gap, and its slope the pressure, however they lie in space: round-off
/// decides what each vertex is nearest to.
#[test]
fn flat_sheets_press_on_each_other_by_their_area() {
    for turn in ["90, 0, 0", "50, 20, 33", "-17, 81, 5"] {
        for gap in [0.002, 0.008, 0.015] {
            let [low, high] = ["low", "high"].map(|name| sheet(name, 6, &format!("turn: ({turn})")));
            let scene = built(&format!("(name: \"\", membranes: [{low}, {high}], effects: [(effect: Contact())])"));
            let mut x = scene.start.x.clone();
            let corner = |number: usize| [0, 1, 2].map(|axis| x[3 * number + axis]);
            let [u, w] = [corner(1), corner(7)].map(|to| [0, 1, 2].map(|axis| to[axis] - corner(0)[axis]));
            let normal = [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]];
            let normal = normal.map(|n| n / norm(&normal));
            let half = x.len() / 2;
            for point in x[half..].chunks_exact_mut(3) {
                (0..3).for_each(|axis| point[axis] += gap * normal[axis]);
            }
            let still = vec![0.0; x.len()];
            let near = Near::at(&scene, &x);
            let mut potential = None;
            contact(&scene).each(near.motion([&x, &still], &[]), &mut |touch| {
                potential = Some(touch.parameters.potential);
            });
            let (potential, energy) = (potential.unwrap(), near.energy(&x));
            let expected = 0.16 * potential.energy(gap);
            assert!((energy - expected).abs() < 1e-9 * expected, "{turn} {gap}: {energy} {expected}");
            let force = near.force(&x, &still, &[]);
            let along = |axis: usize| force[half..].iter().skip(axis).step_by(3).sum::<f64>() * normal[axis];
            let (upward, pressure) = (along(0) + along(1) + along(2), 0.16 * potential.pressure(gap));
            assert!((upward - pressure).abs() < 1e-9 * pressure, "{turn} {gap}: {upward} {pressure}");
        }
    }
}

/// Sheets that begin in one plane, where no direction leads apart, do no harm: every number stays finite, and the state can be saved.
#[test]
fn sheets_may_begin_in_one_plane() {
    for turn in ["90, 0, 0", "0, 0, 0", "50, 20, 33"] {
        let text = format!(
            "(name: \"\", membranes: [{}, {}], effects: [(effect: Gravity(down: 9.81)), (effect: Contact()), (effect: Friction(coefficient: 0.5))])",
            sheet("low", 6, &format!("turn: ({turn})")),
            sheet("high", 5, &format!("turn: ({turn})")),
        );
        for scheme in ["VelocityVerlet", "ImplicitEuler"] {
            let mut simulation = stepped(&Level { integrator: named(scheme), ..level(&text) }, 1e-3);
            simulation.advance(20, &mut || true);
            assert!(simulation.fault().is_none(), "{turn} {scheme}: {:?}", simulation.fault());
            assert!(simulation.state().is_finite() && simulation.saved().is_some(), "{turn} {scheme}");
        }
    }
}

/// A particle that is moved over crumpled cloth: its force is the slope of a continuous energy on the whole way over triangles, ridges,
/// valleys and corners, and does not jump. Over flat cloth it is the same everywhere.
#[test]
fn a_particle_feels_no_edges() {
    for rough in [0.0, 0.006] {
        let scene = built(&format!(
            "(name: \"\", membranes: [{}], nets: [(name: \"chain\", net: Chain(from: (0, 0), to: (0, 10), springs: 1, stiffness: 20), mass: 0.01, space: ())],
            effects: [(effect: Contact(thickness: 0.5))])",
            sheet("cloth", 6, "turn: (90, 0, 0)"),
        ));
        let mut random = Random(7);
        let net = scene.nets[0].vertices.clone();
        let mut x = scene.start.x.clone();
        let membrane = scene.membranes[0].vertices.clone();
        for vertex in membrane {
            x[3 * vertex + 1] += random.between(-rough, rough.max(1e-300));
        }
        let still = vec![0.0; x.len()];
        let (mut work, mut before, mut jump, mut greatest) = (0.0, None::<([f64; 3], Vec<f64>)>, 0.0_f64, 0.0_f64);
        let mut energies = Vec::new();
        let steps = 1000;
        for step in 0..=steps {
            let t = f64::from(step) / f64::from(steps);
            let point = [-0.15 + 0.3 * t, 0.012, -0.13 + 0.21 * t + 0.02 * (9.0 * t).sin()];
            x[3 * net.start..3 * net.start + 3].copy_from_slice(&point);
            let near = Near::at(&scene, &x);
            let force = near.force(&x, &still, &[])[3 * net.start..3 * net.start + 3].to_vec();
            greatest = greatest.max(norm(&force));
            if let Some((old, old_force)) = &before {
                for axis in 0..3 {
                    work -= 0.5 * (force[axis] + old_force[axis]) * (point[axis] - old[axis]);
                    jump = jump.max((force[axis] - old_force[axis]).abs());
                }
            }
            energies.push(near.energy(&x));
            before = Some((point, force));
        }
        let change = energies[steps as usize] - energies[0];
        let most = energies.iter().fold(0.0_f64, |most, energy| most.max(*energy));
        assert!((change - work).abs() < 1e-3 * most, "{rough}: {change} {work} of {most}");
        assert!(jump < 0.06 * greatest, "{rough}: {jump} of {greatest}");
        if rough == 0.0 {
            let spread = energies.iter().fold(0.0_f64, |most, energy| most.max((energy - energies[0]).abs()));
            assert!(spread < 1e-12 * most, "{spread} of {most}");
        }
    }
}

/// Friction that sticks does not jump either where a particle passes from one triangle over a ridge, a valley or a corner to the next: the
/// spring goes on from its anchor.
#[test]
fn friction_passes_over_edges() {
    let scene = built(&format!(
        "(name: \"\", membranes: [{}], nets: [(name: \"chain\", net: Chain(from: (0, 0), to: (0, 10), springs: 1, stiffness: 20), mass: 0.01, space: ())],
        effects: [(effect: Contact(thickness: 0.5)), (effect: Friction(coefficient: 10))])",
        sheet("cloth", 6, "turn: (90, 0, 0)"),
    ));
    let mut random = Random(11);
    let net = scene.nets[0].vertices.start;
    let (mut x, still) = (scene.start.x.clone(), vec![0.0; scene.start.x.len()]);
    for vertex in scene.membranes[0].vertices.clone() {
        x[3 * vertex + 1] += random.between(-4e-3, 4e-3);
    }
    let (mut jumps, mut passed) = (Vec::new(), 0);
    for _ in 0..25 {
        let from = [random.between(-0.15, 0.15), 0.012, random.between(-0.15, 0.15)];
        let angle = random.between(0.0, 7.0);
        let way = [0.03 * angle.cos(), 0.0, 0.03 * angle.sin()];
        let (mut anchors, mut old, mut names) = (Vec::new(), None::<Vec<f64>>, Vec::new());
        for step in 0..=150 {
            let t = f64::from(step) / 150.0;
            let point: Vec<_> = (0..3).map(|axis| from[axis] + t * way[axis]).collect();
            x[3 * net..3 * net + 3].copy_from_slice(&point);
            let near = Near::at(&scene, &x);
            if step == 0 {
                contact(&scene).drag_anchors(near.motion([&x, &still], &[]), 0.0, &mut anchors);
                anchors.sort_unstable_by_key(|anchor| anchor.contact);
            }
            contact(&scene).each(near.motion([&x, &still], &anchors), &mut |touch| {
                if !names.contains(&touch.name) {
                    names.push(touch.name);
                }
            });
            let along = |anchors: &[Anchor]| near.force(&x, &still, anchors)[3 * net..3 * net + 3].to_vec();
            let friction: Vec<_> = along(&anchors).iter().zip(along(&[])).map(|(a, b)| a - b).collect();
            if let Some(old) = &old {
                let change: Vec<_> = friction.iter().zip(old).map(|(a, b)| a - b).collect();
                jumps.push(norm(&change));
            }
            old = Some(friction);
        }
        passed += names.len();
    }
    jumps.sort_unstable_by(f64::total_cmp);
    // Of a spring that is drawn out evenly, every change is the same.
    let [median, most] = [0.5, 1.0].map(|share| jumps[(share * (jumps.len() - 1) as f64) as usize]);
    assert!(passed > 80 && most < 8.0 * median, "{passed} contacts, {median} N, {most} N");
}

fn stepped(level: &Level, step: f64) -> Simulation {
    let mut simulation = simulation(level);
    let scene = Scene { step, sleep: Sleep::Off, ..simulation.scene().clone() };
    simulation.replace_scene(scene);
    simulation
}

/// Two sheets in free flight that hit each other askew keep their momenta, and without damping their energy.
#[test]
fn sheets_that_collide_keep_momentum_and_energy() {
    let text = format!(
        "(name: \"\", membranes: [{}, {}], effects: [(effect: Contact())])",
        sheet("low", 4, "turn: (90, 0, 0)"),
        sheet("high", 5, "turn: (80, 25, 10), offset: (0.01, 0.09, 0.02)"),
    );
    let level = Level { integrator: named("VelocityVerlet"), ..level(&text) };
    let mut simulation = stepped(&level, 1e-4);
    let half = simulation.scene().membranes[1].vertices.clone();
    let mut state = simulation.state().clone();
    for vertex in half {
        state.v[3 * vertex + 1] = -1.5;
        state.v[3 * vertex] = 0.4;
    }
    simulation.set_state(state);
    let momenta = |simulation: &Simulation| {
        let momentum: Vec<_> = simulation.state().v.iter().zip(&*simulation.scene().mass).map(|(v, m)| m * v).collect();
        sums(&simulation.state().x, &momentum)
    };
    let (start, energy) = (momenta(&simulation), simulation.energies().total());
    let mut most = 0.0_f64;
    for _ in 0..120 {
        simulation.advance(20, &mut || true);
        most = most.max(simulation.energies().contact);
        assert_eq!(simulation.count_crossings(), Some(0));
    }
    assert!(simulation.fault().is_none() && most > 0.03 * energy, "{most} of {energy}");
    let end = momenta(&simulation);
    let scale = start.iter().fold(0.0_f64, |most, sum| most.max(sum.abs()));
    assert!(start.iter().zip(end).all(|(a, b)| (a - b).abs() < 1e-12 * scale), "{start:?} {end:?}");
    let drift = (simulation.energies().total() - energy).abs();
    assert!(drift < 2e-3 * energy, "{drift} of {energy}");
}

/// A strip that falls on its end and folds on itself, over a floor.
fn folding(model: &str, kind: IntegratorKind, effects: &str) -> Level {
    let level = level(&format!(
        "(name: \"\", membranes: [(name: \"strip\", mesh: Rectangle(width: 0.1, height: 0.5, columns: 2, rows: 10, diagonals: Alternating, corner: (0, 0)),
        material: (model: {model}, young: 20000, poisson: 0.3, plane: Stress), thickness: 0.005, mass: Density(200), space: (turn: (4, 0, 1), offset: (0, 0.02, 0)))],
        effects: [(effect: Gravity(down: 9.81)), (effect: Contact()), (effect: Walls(obstacles: [HalfSpace(point: (0, 0, 0), normal: (0, 1, 0), eps: 0.01)])), {effects}])"
    ));
    Level { integrator: kind, ..level }
}

/// Damping and friction.
const DAMPED: &str = "(effect: Rayleigh(mass: 0.5, stiffness: 0.002)), (effect: Friction(coefficient: 0.4)), (effect: Restitution(coefficient: 0.3))";

/// With every scheme and material cloth folds on itself without crossing or gaining energy, and touches itself.
#[test]
fn every_integrator_folds_cloth_without_crossing() {
    for (number, kind) in IntegratorKind::all().into_iter().enumerate() {
        let model = ["Corotated", "StVenantKirchhoff", "NeoHookean"][number % 3];
        let step = if kind.name() == "ForwardEuler" { 1e-4 } else { 1e-3 };
        let mut simulation = stepped(&folding(model, kind.clone(), DAMPED), step);
        let (start, name) = (simulation.energies().total(), kind.name());
        let mut touches = false;
        for _ in 0..70 {
            simulation.advance((0.01 / step).round() as u64, &mut || true);
            let surfaces = surface_contact(simulation.scene());
            surfaces.each_pressing(simulation.scene().motion(simulation.state(), None), &mut |_, _| touches = true);
            assert!(simulation.fault().is_none(), "{name} {model}: {:?}", simulation.fault());
            assert_eq!(simulation.count_crossings(), Some(0), "{name} {model} at {} s", simulation.state().time);
        }
        assert!(touches, "{name} {model}");
        let gain = simulation.energies().total() - start;
        assert!(gain < 1e-3 * start.abs(), "{name} {model}: {gain} J");
    }
}

/// Saved while it lies on itself, and continued: every bit is the same.
#[test]
fn folded_cloth_is_saved() {
    for kind in IntegratorKind::all() {
        let mut level = folding("NeoHookean", kind.clone(), DAMPED);
        level.substeps = Substeps::new(if kind.name() == "ForwardEuler" { 167 } else { 17 }).unwrap();
        continues_bit_for_bit(&level);
    }
}

/// Coulomb's law for a sheet on a held one whose slope no axis is along: `a = g (sin - mu cos)` beyond the angle of friction, and rest
/// below it.
#[test]
fn friction_of_cloth_on_cloth_is_that_of_coulomb() {
    let slide = |mu: f64, kind: IntegratorKind| {
        let small = "(name: \"small\", mesh: Rectangle(width: 0.1, height: 0.1, columns: 2, rows: 2, diagonals: Alternating, corner: (-0.05, -0.05)),
            material: (model: StVenantKirchhoff, young: 20000, poisson: 0.3, plane: Stress), thickness: 0.01, mass: Density(100), space: (turn: (-90, 30, 26.565051177077990), offset: (-0.0139, 0.0278, 0)))";
        let pins: Vec<_> = (0..100).map(|vertex| format!("Vertex({vertex})")).collect();
        let large = format!("(name: \"large\", mesh: Rectangle(width: 0.8, height: 0.8, columns: 9, rows: 9, diagonals: Alternating, corner: (-0.4, -0.4)),
            material: (model: StVenantKirchhoff, young: 20000, poisson: 0.3, plane: Stress), thickness: 0.01, mass: Density(100), pins: [{}], space: (turn: (-90, 10, 26.565051177077990)))", pins.join(", "));
        let level = level(&format!(
            "(name: \"\", membranes: [{small}, {large}], effects: [(effect: Gravity(down: 9.81)), (effect: Contact()), (effect: Restitution(coefficient: 0.1)),
            (effect: Friction(coefficient: {mu})), (effect: Rayleigh(mass: 0, stiffness: 0.001))])"
        ));
        let mut simulation = stepped(&Level { integrator: kind, ..level }, 5e-4);
        let own = simulation.scene().membranes[0].vertices.clone();
        let mean = |values: &[f64]| {
            let own = &values[3 * own.start..3 * own.end];
            [0, 1, 2].map(|axis| own.iter().skip(axis).step_by(3).sum::<f64>() / (own.len() / 3) as f64)
        };
        simulation.advance(400, &mut || true);
        let (from, speed) = (mean(&simulation.state().x), mean(&simulation.state().v));
        simulation.advance(400, &mut || true);
        assert!(simulation.fault().is_none(), "{:?}", simulation.fault());
        let to = mean(&simulation.state().x);
        let (c, s) = (2.0 / 5.0_f64.sqrt(), 1.0 / 5.0_f64.sqrt());
        let along = |vector: [f64; 3]| c * vector[0] + s * vector[1];
        (along([0, 1, 2].map(|axis| to[axis] - from[axis])).abs(), along(speed).abs())
    };
    for scheme in ["VelocityVerlet", "ImplicitMidpoint"] {
        let (gone, speed) = slide(0.2, named(scheme));
        let a = 9.81 * (0.5 - 0.2) * 2.0 / 5.0_f64.sqrt();
        let expected = speed * 0.2 + 0.02 * a;
        assert!((gone - expected).abs() < 0.02 * expected, "{scheme}: {gone} m, {expected} m by Coulomb's law");
        let (gone, _) = slide(0.6, named(scheme));
        assert!(gone < 1e-4, "{scheme}: {gone} m");
    }
}

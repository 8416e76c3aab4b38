//! Facts about contact of bodies with each other and with themselves.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{Random, SLOPE, level, reopened, simulation, started};
use gingerbread::{
    contact::{Anchor, AnyContact, Candidates, ContactTerm, Means, SurfaceTerm, Truncation},
    effects::Motion,
    level::Level,
    meshes::NoFiles,
    scene::Scene,
    simulation::Simulation,
    solvers::{BlockMatrix, Tangent, Weights},
};

fn surface_contact(scene: &Scene) -> &dyn SurfaceTerm {
    scene.effects.iter().find_map(|effect| effect.surface_contact()).unwrap()
}

fn potential(scene: &Scene) -> &dyn ContactTerm {
    match surface_contact(scene).contact() {
        AnyContact::Plane(contact) => contact,
        AnyContact::Space(_) => unreachable!(),
    }
}

/// A man under a box, with the particles of a net on top.
const NEAR: &str = "(name: \"\", bodies: [
        (name: \"man\", mesh: Gingerbread(), material: (model: Corotated, young: 1000, poisson: 0.3, plane: Stress), mass: Density(100)),
        (name: \"box\", mesh: Rectangle(corner: (0.4, 0.828), width: 0.2, height: 0.1, columns: 6, rows: 3), material: (model: Corotated, young: 3000, poisson: 0.3, plane: Stress), mass: Density(100))],
    nets: [(name: \"net\", net: Sheet(corner: (0.4, 0.931), width: 0.2, height: 0.1, columns: 8, rows: 2, structural: 100, shear: 50, flexion: 20), mass: 0.01)],
    effects: [(effect: Contact(dissipation: 0.3)), (effect: Friction(coefficient: 0.5))])";

/// The man, squeezed so that his limbs touch each other, and all others, displaced irregularly.
fn squeezed(scene: &Scene, random: &mut Random) -> Vec<f64> {
    let man = scene.bodies[0].vertices.len();
    let mut x = scene.rest.clone();
    for vertex in 0..man {
        x[2 * vertex] = 0.5 + 0.35 * (x[2 * vertex] - 0.5);
    }
    for x in &mut x {
        *x += random.between(-1e-3, 1e-3);
    }
    x
}

fn motion<'a>(
    (scene, candidates, pattern): (&'a Scene, &'a Candidates, &'a [[u32; 2]]),
    [x, v]: [&'a [f64]; 2],
    anchors: &'a [Anchor],
) -> Motion<'a> {
    let (mass, inverse_mass) = (&scene.mass, &scene.inverse_mass);
    Motion { dimension: 2, x, v, mass, inverse_mass, anchors, candidates: Some(candidates), pattern, ..Motion::NONE }
}

#[test]
fn forces_and_stiffness_are_derivatives() {
    let level = level(NEAR);
    let scene = Scene::build(&level, level.mode, &NoFiles, None).unwrap();
    let (surfaces, contact, count) = (surface_contact(&scene), potential(&scene), scene.rest.len());
    let (mut kinds, mut corners) = ([0; 3], [0; 2]);
    for seed in 0..40 {
        let mut random = Random(seed);
        let x = squeezed(&scene, &mut random);
        let still = vec![0.0; count];
        let v: Vec<_> = (0..count).map(|_| random.between(-1e-2, 1e-2)).collect();
        let mut candidates = Candidates::default();
        surfaces.update(&mut candidates, &x, &[]);
        let mut pattern = Vec::new();
        surfaces.add_near(&candidates, &x, &mut pattern);
        let near = (&scene, &candidates, pattern.as_slice());
        let owner = |vertex: u32| {
            scene.bodies.iter().filter(|body| body.vertices.start <= vertex as usize).count()
                + usize::from(vertex as usize >= scene.bodies[1].vertices.end)
        };
        contact.each(motion(near, [&x, &still], &[]), &mut |touch| {
            kinds[match [owner(touch.vertices[0]), owner(touch.vertices[1])] {
                [a, b] if a == b => 0,
                [3, _] => 2,
                _ => 1,
            }] += 1;
            if touch.weights.contains(&0.0) {
                corners[usize::from(touch.area < 0.0)] += 1;
            }
        });
        let force = |x: &[f64], v: &[f64], anchors: &[Anchor]| {
            let mut force = vec![0.0; count];
            contact.force(motion(near, [x, v], anchors), &mut force);
            force
        };
        let difference = |of: &dyn Fn(&[f64]) -> f64, at: &[f64], number: usize, by: f64| {
            let mut moved = at.to_vec();
            moved[number] = at[number] + by;
            let ahead = of(&moved);
            moved[number] = at[number] - by;
            (ahead - of(&moved)) / (2.0 * by)
        };
        let bare = force(&x, &still, &[]);
        let greatest = bare.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
        for number in (0..count).filter(|number| bare[*number] != 0.0) {
            let slope = difference(&|x| contact.energy(motion(near, [x, &still], &[])), &x, number, 1e-8);
            assert!((bare[number] + slope).abs() < 1e-5 * greatest, "{number}: {} and {slope}", bare[number]);
        }
        // Each contact adds nothing to the momenta.
        let sums = (0..count)
            .step_by(2)
            .fold([0.0; 3], |[a, b, c], i| [a + bare[i], b + bare[i + 1], c + x[i] * bare[i + 1] - x[i + 1] * bare[i]]);
        assert!(sums.iter().all(|sum| sum.abs() < 1e-13 * greatest * count as f64), "{sums:?}");
        // The product with the stiffness is the change of the force, and that with the matrix the same.
        let d: Vec<_> = (0..count).map(|_| random.between(-1.0, 1.0)).collect();
        let along = |by: f64| x.iter().zip(&d).map(|(x, d)| x + by * d).collect::<Vec<_>>();
        let (ahead, behind) = (force(&along(1e-8), &still, &[]), force(&along(-1e-8), &still, &[]));
        let mut times = vec![0.0; count];
        contact.stiffness_times(motion(near, [&x, &still], &[]), &d, &mut times);
        let stiffest = times.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        for number in 0..count {
            let slope = (behind[number] - ahead[number]) / 2e-8;
            assert!((times[number] - slope).abs() < 1e-5 * stiffest, "{number}: {} and {slope}", times[number]);
        }
        let mut pairs = Vec::new();
        contact.sparsity_pattern(&pattern, &mut |a, b| pairs.push([a, b]));
        let mut matrix = BlockMatrix::<2>::new(count / 2, &pairs);
        let mut anchors = Vec::new();
        contact.drag_anchors(motion(near, [&x, &still], &[]), 1e-4, &mut anchors);
        for anchor in &mut anchors {
            anchor.point[0] += random.between(-1e-6, 1e-6);
        }
        let weights = Weights { position: 1.0, velocity: 0.0, tangent: Tangent::Exact };
        let mut product = vec![0.0; count];
        contact.add_stiffness(motion(near, [&x, &v], &anchors), weights, &mut matrix);
        matrix.add_product(&d, &mut product);
        times.fill(0.0);
        contact.stiffness_times(motion(near, [&x, &v], &anchors), &d, &mut times);
        let greatest = times.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        assert!(times.iter().zip(&product).all(|(a, b)| (a - b).abs() <= 1e-12 * greatest));
        // What Newton's method takes instead is positive semidefinite.
        for tangent in [Tangent::Definite, Tangent::Absolute] {
            matrix.clear();
            product.fill(0.0);
            contact.add_stiffness(motion(near, [&x, &v], &anchors), Weights { tangent, ..weights }, &mut matrix);
            matrix.add_product(&d, &mut product);
            assert!(d.iter().zip(&product).map(|(a, b)| a * b).sum::<f64>() >= 0.0);
        }
    }
    // Self-contact, bodies, nets; corners, and corners subtracted.
    assert!(kinds.iter().chain(&corners).all(|count| *count >= 4), "{kinds:?} {corners:?}");
}

const DISKS: &str = "(name: \"\", bodies: [
        (name: \"left\", mesh: Disk(centre: (0.2, 0.5), radius: 0.1, rings: 5), velocity: (1, 0.02), material: (model: Corotated, young: 1000, poisson: 0.3, plane: Stress), mass: Density(100)),
        (name: \"right\", mesh: Disk(centre: (0.45, 0.53), radius: 0.12, rings: 6), material: (model: NeoHookean, young: 2000, poisson: 0.3, plane: Stress), mass: Density(100))],
    effects: [EFFECTS])";

/// Linear and angular momentum [kg m/s, kg m²/s].
fn momenta(simulation: &Simulation) -> [f64; 3] {
    let (mass, x, v) = (&simulation.scene().mass, &simulation.state().x, &simulation.state().v);
    let mut sums = [0.0; 3];
    for i in (0..x.len()).step_by(2) {
        sums[0] += mass[i] * v[i];
        sums[1] += mass[i] * v[i + 1];
        sums[2] += mass[i] * (x[i] * v[i + 1] - x[i + 1] * v[i]);
    }
    sums
}

/// Schemes with steps that resolve a contact of the disks [ms].
const STEPS: [(&str, f64); 12] = [
    ("SymplecticEuler()", 0.5),
    ("VelocityVerlet()", 0.5),
    ("PositionVerlet()", 0.5),
    ("Heun()", 0.1),
    ("RungeKutta4()", 0.5),
    ("DormandPrince(relative: 1e-4, absolute: 1e-4)", 10.0),
    ("DormandPrince(relative: 1e-6, absolute: 1e-6)", 10.0),
    ("LinearlyImplicitEuler()", 10.0),
    ("ImplicitEuler()", 10.0),
    ("ImplicitMidpoint()", 2.0),
    ("EnergyMomentum()", 2.0),
    ("Bdf2()", 10.0),
];

/// The disks meet a little off their centres, with and without friction: energy is at most gained as without contact, and momenta
/// stay, where the scheme keeps them.
#[test]
fn two_disks_keep_momentum_and_energy() {
    for effects in ["(effect: Contact())", "(effect: Contact(dissipation: 1)), (effect: Friction(coefficient: 0.5))"] {
        for (scheme, step) in STEPS {
            let mut simulation = started(&level(&DISKS.replace("EFFECTS", effects)), scheme, 1e-3 * step);
            let (before, start) = (momenta(&simulation), simulation.energies().total());
            let mut most = 0.0_f64;
            while simulation.state().time < 0.5 {
                simulation.advance(1, &mut || true);
                assert!(simulation.fault().is_none(), "{:?}", simulation.fault());
                most = most.max(simulation.energies().total() / start - 1.0);
            }
            let after = momenta(&simulation);
            let change = [0, 1, 2].map(|i| ((after[i] - before[i]) / before[0]).abs());
            let speed = simulation.state().v[2 * simulation.scene().bodies[1].vertices.start];
            assert!(speed > 0.1, "{scheme}: they met");
            assert!(change[0] <= 1e-12 && change[1] <= 1e-12, "{scheme}: {change:?}");
            // Angular momentum: in kg m²/s over that of the velocity at 1 m.
            let turned = match scheme {
                "SymplecticEuler()" | "VelocityVerlet()" | "PositionVerlet()" => 1e-12,
                "ImplicitMidpoint()" | "EnergyMomentum()" => 1e-9,
                "LinearlyImplicitEuler()" | "ImplicitEuler()" | "Bdf2()" => 2e-3,
                _ => 1e-6,
            };
            assert!(change[2] <= turned, "{scheme}: {change:?}");
            let gain = match scheme {
                "SymplecticEuler()" | "Heun()" | "ImplicitMidpoint()" => 0.01,
                "DormandPrince(relative: 1e-4, absolute: 1e-4)" => 0.003,
                "VelocityVerlet()" | "PositionVerlet()" => 1e-3,
                "RungeKutta4()" | "DormandPrince(relative: 1e-6, absolute: 1e-6)" => 1e-5,
                // Gaps between surfaces are not linear in the positions.
                "EnergyMomentum()" => 0.002,
                _ => 1e-12,
            };
            assert!(most <= gain, "{scheme}: {most:e}");
            let counts = simulation.counts();
            assert_eq!((counts.unconverged, counts.constrained), (0, 0), "{scheme}");
            assert_eq!(simulation.count_crossings(), Some(0));
        }
    }
}

/// A block that begins exactly on another may leave it, and may not enter it.
#[test]
fn what_begins_on_an_edge_may_leave_it() {
    for (velocity, rises) in [(0.5, true), (-0.5, false)] {
        let level = level(&format!(
            "(name: \"\", substeps: 20, bodies: [
                (name: \"lower\", mesh: Rectangle(width: 0.4, height: 0.2, columns: 4, rows: 2, diagonals: Alternating, corner: (0, 0)),
                    material: (model: Corotated, young: 2000, poisson: 0.3, plane: Strain), mass: Density(100)),
                (name: \"upper\", velocity: (0, {velocity}),
                    mesh: Rectangle(width: 0.15, height: 0.2, columns: 2, rows: 2, diagonals: Alternating, corner: (0.125, 0.2)),
                    material: (model: Corotated, young: 2000, poisson: 0.3, plane: Strain), mass: Density(100))],
            effects: [(effect: Contact())])"
        ));
        let mut simulation = simulation(&level);
        let momentum = momenta(&simulation)[1];
        for _ in 0..200 {
            simulation.advance(1, &mut || true);
            assert!(simulation.fault().is_none(), "{:?}", simulation.fault());
            let upper = 2 * simulation.scene().bodies[1].vertices.start;
            let risen = simulation.state().x[upper + 1] - 0.2;
            assert!(!rises || risen > 0.9 * velocity * simulation.state().time, "{risen} m");
        }
        assert_eq!(simulation.count_crossings(), Some(0), "at {velocity} m/s");
        assert!((momenta(&simulation)[1] / momentum - 1.0).abs() < 1e-12, "at {velocity} m/s");
    }
}

/// At a speed that no skin holds, at which a step is longer than several triangles, surfaces do not cross in any step, and energy is
/// not above the bound of the guard.
#[test]
fn surfaces_never_cross() {
    for (scheme, step) in STEPS {
        for (speed, steps) in [(5.0, 60.0), (100.0, 10.0)] {
            let text = DISKS
                .replace("EFFECTS", "(effect: Contact())")
                .replace("velocity: (1,", &format!("velocity: ({speed},"));
            let mut simulation = started(&level(&text), scheme, 1e-3 * step);
            if speed > 50.0 {
                simulation.replace_scene(Scene { guard: true, ..simulation.scene().clone() });
            }
            let before = momenta(&simulation);
            while simulation.state().time < 1e-3 * steps {
                simulation.advance(1, &mut || true);
                assert!(simulation.fault().is_none(), "{scheme} at {speed}: {:?}", simulation.fault());
                assert_eq!(simulation.count_crossings(), Some(0), "{scheme} at {speed} m/s");
            }
            let counts = simulation.counts();
            assert!(counts.constrained > 0 || speed < 50.0, "{scheme}: the skin held");
            let after = momenta(&simulation);
            if speed < 50.0 && counts.newton_iterations == 0 {
                assert!((after[0] / before[0] - 1.0).abs() < 1e-12, "{scheme}: {after:?}");
            }
        }
    }
}

/// A fork moves as a whole, farther than its prongs are apart, past a post that stops one of them: the other prong does not cross that one,
/// although nothing of the fork came nearer to itself before the post cut its displacement.
#[test]
fn cuts_of_a_body_do_not_let_it_cross_itself() {
    let text = "(name: \"\", bodies: [
        (name: \"fork\", mesh: Outline(points: [(0.3, 0.5), (0.2, 0.5), (0.2, 0), (0.1, 0), (0.1, 0.5), (0, 0.5), (0, -0.1), (0.3, -0.1)], resolution: 200),
            material: (model: Corotated, young: 1000, poisson: 0.3, plane: Stress), mass: Density(100)),
        (name: \"post\", mesh: Rectangle(corner: (0.32, 0.3), width: 0.1, height: 0.1, columns: 2, rows: 2),
            material: (model: Corotated, young: 1000, poisson: 0.3, plane: Stress), mass: Density(100))],
        effects: [(effect: Contact())])";
    let level = level(text);
    let scene = Scene::build(&level, level.mode, &NoFiles, None).unwrap();
    let contact = surface_contact(&scene);
    let start = &scene.rest;
    let (mut x, mut v) = (start.clone(), vec![0.0; start.len()]);
    for vertex in scene.bodies[0].vertices.clone() {
        (x[2 * vertex], v[2 * vertex]) = (start[2 * vertex] + 0.5, 30.0);
    }
    let (mut truncation, mut candidates) = (Truncation::default(), Candidates::default());
    let scratch = (&mut truncation, &mut candidates);
    assert!(contact.truncate(scratch, Means::Cuts, (start, &scene.inverse_mass), [&mut x, &mut v]) > 0);
    assert_eq!(contact.count_crossings(&x), 0);
    assert!(!contact.meets(&mut truncation, &mut candidates, start, &x));
}

/// The certificate finds a crossing of two edges, a vertex that touches an edge, and a particle of a net in a body; shared corners
/// are none.
#[test]
fn the_certificate_finds_crossings() {
    let level = level(NEAR);
    let scene = Scene::build(&level, level.mode, &NoFiles, None).unwrap();
    let contact = surface_contact(&scene);
    assert_eq!(contact.count_crossings(&scene.rest), 0);
    let mut x = scene.rest.clone();
    let other = scene.bodies[1].vertices.clone();
    // The box sinks into the head.
    (other.start..other.end).for_each(|vertex| x[2 * vertex + 1] -= 0.05);
    assert!(contact.count_crossings(&x) >= 2);
    // Of the net a particle, which is placed within the man.
    x.copy_from_slice(&scene.rest);
    let net = scene.nets[0].vertices.start;
    (x[2 * net], x[2 * net + 1]) = (0.5, 0.5);
    assert_eq!(contact.count_crossings(&x), 1);
    // A corner of the box exactly on the middle of an edge.
    x.copy_from_slice(&scene.rest);
    let edge = scene.bodies[0].boundary[0];
    let corner = other.clone().find(|vertex| scene.rest[2 * vertex..2 * vertex + 2] == [0.4, 0.828]).unwrap();
    let [a, b] = edge.map(|vertex| vertex as usize);
    x[2 * a] = 0.125;
    x[2 * b] = 0.25;
    (x[2 * a + 1], x[2 * b + 1]) = (-1.0, -1.0);
    (x[2 * corner], x[2 * corner + 1]) = (0.1875, -1.0);
    assert!(contact.count_crossings(&x) > 0);
    x[0] = f64::NAN;
    assert_eq!(contact.count_crossings(&[f64::NAN].repeat(x.len())), 1);
}

/// A disk that begins half in another is let out, with no more energy than it takes to part them slowly, and momentum stays. Two that
/// are almost in the same place find no way out, but do not explode.
#[test]
fn what_begins_in_another_body_is_let_out() {
    for (scheme, step) in STEPS {
        for (distance, time) in [(0.12, 1.0), (0.02, 0.05)] {
            if distance < 0.1 && !["SymplecticEuler()", "RungeKutta4()", "ImplicitEuler()"].contains(&scheme) {
                continue;
            }
            let place = format!("centre: ({}, 0.53)", 0.2 + distance);
            let text = DISKS.replace("EFFECTS", "(effect: Contact()), (effect: Rayleigh(mass: 1))");
            let text = text.replace("velocity: (1, 0.02), ", "").replace("centre: (0.45, 0.53)", &place);
            let mut simulation = started(&level(&text), scheme, 1e-3 * step);
            assert_eq!(simulation.count_crossings(), Some(2), "their outlines cross twice");
            assert!(
                simulation.energies().total() < 1e-12,
                "nothing pushes at first: {}",
                simulation.energies().total()
            );
            let mut most = 0.0_f64;
            while simulation.state().time < time {
                simulation.advance(1, &mut || true);
                assert!(simulation.fault().is_none(), "{scheme}: {:?}", simulation.fault());
                most = most.max(simulation.energies().total());
            }
            // The elastic energy of a disk squeezed to half its size is some 6 J.
            assert!(most < 6.0, "{scheme}: {most}");
            if distance == 0.12 {
                assert_eq!(simulation.count_crossings(), Some(0), "{scheme}");
                assert_eq!(simulation.inversion().1, 0, "{scheme}");
                // Implicit schemes hold vertices that meet, with forces that have no counterpart.
                let implicit = simulation.counts().newton_iterations > 0;
                let moved = momenta(&simulation)[0].abs();
                assert!(moved < if implicit { 1e-3 } else { 1e-12 }, "{scheme}: {moved:e}");
            }
        }
    }
}

/// A pile saved in the middle of an impact continues with the same bits, for every scheme and with friction.
#[test]
fn a_saved_impact_continues_bit_for_bit() {
    for (scheme, step) in STEPS {
        let text = DISKS.replace("EFFECTS", "(effect: Contact(dissipation: 1)), (effect: Friction(coefficient: 0.5))");
        // In steps of a whole number a frame, as a level has.
        let steps = (1000.0 / (60.0 * step)).ceil();
        let text = text.replace("effects:", &format!("integrator: {scheme}, substeps: {steps}, effects:"));
        let listed = level(&text);
        let scene = Scene::build(&listed, listed.mode, &NoFiles, None).unwrap();
        let mut straight = Simulation::open(scene, &listed, listed.mode).unwrap();
        while straight.state().anchors.is_empty() {
            straight.advance(1, &mut || true);
        }
        let mut again = reopened(&straight, &listed);
        for _ in 0..20 {
            straight.advance(1, &mut || true);
            again.advance(1, &mut || true);
            assert_eq!(straight.state().hash(), again.state().hash(), "{scheme}");
        }
        assert!(straight.fault().is_none(), "{scheme}");
    }
}

/// A box at rest on a box sleeps with it, and a blow wakes both.
#[test]
fn bodies_that_press_on_each_other_sleep_together() {
    let text = "(name: \"\", bodies: [
            (name: \"lower\", mesh: Rectangle(corner: (0.4, 0.1), width: 0.2, height: 0.1, columns: 6, rows: 3), material: (model: Corotated, young: 3000, poisson: 0.3, plane: Stress), mass: Density(100)),
            (name: \"upper\", mesh: Rectangle(corner: (0.42, 0.203), width: 0.15, height: 0.1, columns: 5, rows: 3), material: (model: Corotated, young: 3000, poisson: 0.3, plane: Stress), mass: Density(100)),
            (name: \"far\", mesh: Rectangle(corner: (0.45, 0.8), width: 0.1, height: 0.1, columns: 4, rows: 4), material: (model: Corotated, young: 3000, poisson: 0.3, plane: Stress), mass: Density(100), pins: [Top])],
        effects: [(effect: Gravity(down: 0.3)), (effect: Contact(dissipation: 5)), (effect: Friction(coefficient: 0.5)), (effect: Rayleigh(mass: 4, stiffness: 0.002)),
            (effect: Boundary(least: (0, 0.1), greatest: (1, 1)))])";
    let listed = level(text);
    let scene = Scene::build(&listed, listed.mode, &NoFiles, None).unwrap();
    let mut simulation = Simulation::open(scene, &listed, listed.mode).unwrap();
    let asleep = |simulation: &Simulation| simulation.sleeping().collect::<Vec<_>>();
    while simulation.state().time < 20.0 && !simulation.is_asleep() {
        simulation.advance(1, &mut || true);
        let sleeping = asleep(&simulation);
        assert!(sleeping.is_empty() || sleeping[0] == sleeping[1], "they sleep together");
    }
    let fast = simulation.state().v.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    assert!(
        simulation.is_asleep(),
        "{:?} {fast} {:?} {:?}",
        asleep(&simulation),
        simulation.state().slow_checks,
        simulation.state().anchors
    );
    // The pins of the third are removed: it falls on the two, which sleep until then.
    let free = level(&text.replace(", pins: [Top]", ""));
    simulation.replace_scene(Scene::build(&free, free.mode, &NoFiles, None).unwrap());
    let mut slept = false;
    while simulation.state().time < 40.0 && (!slept || asleep(&simulation).contains(&true)) {
        simulation.advance(1, &mut || true);
        slept |= asleep(&simulation).starts_with(&[true, true, false]);
    }
    assert!(slept && !asleep(&simulation).contains(&true), "the blow woke both");
    assert_eq!(simulation.count_crossings(), Some(0));
}

/// A stiff damped block on a body of that slope, whose vertices are all pinned.
fn on_slope(friction: f64) -> Level {
    let pins = (0..82).map(|vertex| format!("Vertex({vertex})")).collect::<Vec<_>>().join(", ");
    level(&format!(
        "(name: \"\", bodies: [
            (name: \"slope\", mesh: Rectangle(corner: (-0.8, -0.06), width: 1.1, height: 0.05, columns: 40, rows: 1),
                place: (turn: 26.565051177077990),
                material: (model: Corotated, young: 20000, poisson: 0.3, plane: Stress), mass: Density(100), pins: [{pins}]),
            (name: \"block\", mesh: Rectangle(corner: (0, 0), width: 0.2, height: 0.1, columns: 8, rows: 4),
                place: (turn: 26.565051177077990),
                material: (model: Corotated, young: 20000, poisson: 0.3, plane: Stress), mass: Density(100))],
        effects: [(effect: Gravity(down: 9.81)), (effect: Rayleigh(mass: 0, stiffness: 0.001)), (effect: Friction(coefficient: {friction})),
            (effect: Contact(modulus: 1, dissipation: 10))])"
    ))
}

/// Friction between bodies is that of Coulomb as on an obstacle, although contacts pass from edge to edge of the slope.
#[test]
fn a_block_slides_on_a_body_as_coulomb_says() {
    let slid = |simulation: &Simulation| {
        let (scene, x) = (simulation.scene(), &simulation.state().x);
        let block = scene.numbers(&scene.bodies[1].vertices);
        let along = |number: usize| if number.is_multiple_of(2) { SLOPE[1] } else { SLOPE[0] };
        let moved = |number: usize| scene.mass[number] * along(number) * (scene.rest[number] - x[number]);
        2.0 * block.clone().map(moved).sum::<f64>() / scene.mass[block].iter().sum::<f64>()
    };
    let advance = |simulation: &mut Simulation, time: f64| {
        simulation.advance((time / simulation.scene().step).round() as u64, &mut || true);
        assert!(simulation.fault().is_none(), "{:?}", simulation.fault());
    };
    for (scheme, step) in [
        ("SymplecticEuler()", 0.1),
        ("VelocityVerlet()", 0.1),
        ("RungeKutta4()", 0.2),
        ("DormandPrince(relative: 1e-6, absolute: 1e-6)", 12.5),
        ("ImplicitEuler()", 12.5),
        ("ImplicitMidpoint()", 1.0),
        ("EnergyMomentum()", 1.0),
        ("Bdf2()", 12.5),
    ] {
        for friction in [0.4, 0.51] {
            let mut simulation = started(&on_slope(1.0), scheme, 1e-3 * step);
            advance(&mut simulation, 1.0);
            simulation.replace_scene(started(&on_slope(friction), scheme, 1e-3 * step).scene().clone());
            let places = [0.3, 0.3, 0.3].map(|time| {
                advance(&mut simulation, time);
                slid(&simulation)
            });
            if friction > 0.5 {
                let crept = places[2] - places[0];
                assert!(crept.abs() < 1e-5, "{scheme}: crept {crept:e} m in 0.6 s");
                continue;
            }
            let acceleration = (places[2] - 2.0 * places[1] + places[0]) / (0.3 * 0.3);
            let error = acceleration / (9.81 * SLOPE[1] * (0.5 - friction)) - 1.0;
            // 2 % of the acceleration are 0.5 % of the friction, from which it is a small difference.
            assert!(error.abs() < 0.02, "{scheme}: {error:e}");
        }
    }
}

//! Facts about tractions and pressure on edges of bodies, and about known results of levels.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a failing test should panic")]

use crate::common::{continues_bit_for_bit, level, simulation};
use gingerbread::{
    effects::Motion,
    integrators::IntegratorKind,
    level::Level,
    meshes::NoFiles,
    scene::Scene,
    simulation::Simulation,
    solvers::{BlockMatrix, Tangent, Weights},
};

/// A bar of 0.5 m and 0.1 m, held at the left, with effects.
fn bar(effects: &str) -> Level {
    level(&format!(
        "(name: \"\", substeps: 40, sleep: Off, bodies: [(name: \"bar\", mesh: Rectangle(width: 0.5, height: 0.1, columns: 10, rows: 2, diagonals: Alternating, corner: (0, 0)),
            material: (model: NeoHookean, young: 10000, poisson: 0, plane: Stress), mass: Density(100), pins: [Left])], effects: [{effects}])"
    ))
}

/// The forces of the load of a scene at some positions and a time \[s\].
fn forces(scene: &Scene, x: &[f64], time: f64) -> Vec<f64> {
    let effect = scene.effects.iter().find(|effect| effect.name() == "EdgeLoad").unwrap();
    let (v, mut force) = (vec![0.0; x.len()], vec![0.0; x.len()]);
    let motion =
        Motion { dimension: 2, x, v: &v, mass: &scene.mass, inverse_mass: &scene.inverse_mass, time, ..Motion::NONE };
    effect.force(motion, &mut [], &mut force);
    force
}

/// Area of all triangles of a scene \[m²\].
fn area(scene: &Scene, x: &[f64]) -> f64 {
    let at = |vertex: u32| [x[2 * vertex as usize], x[2 * vertex as usize + 1]];
    let twice = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(at);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    0.5 * scene.triangles.iter().map(twice).sum::<f64>()
}

/// Positions that are all moved a little.
fn shaken(x: &[f64]) -> Vec<f64> {
    x.iter().zip(1..).map(|(x, number)| x + 0.005 * f64::sin(f64::from(number) * 1.7)).collect()
}

/// A traction has the force of its stress times the length of the edges at rest, however they move, and rises with its ramp.
#[test]
fn a_traction_keeps_its_force() {
    let run = simulation(&bar("(effect: EdgeLoad(edges: [Right], traction: (300, -200), ramp: 2))"));
    let scene = run.scene();
    for (time, share) in [(0.0, 0.0), (0.5, 0.25), (2.0, 1.0), (9.0, 1.0)] {
        let force = forces(scene, &shaken(&scene.rest), time);
        let sum = |axis: usize| force.iter().skip(axis).step_by(2).sum::<f64>();
        assert!(
            (sum(0) - share * 30.0).abs() < 1e-12 && (sum(1) + share * 20.0).abs() < 1e-12,
            "{} {}",
            sum(0),
            sum(1)
        );
    }
}

/// A pressure on a whole boundary is the slope of itself times the area inside. It has neither a resultant nor a moment, and its stiffness, applied and in blocks, is
/// the slope of its force.
#[test]
fn a_pressure_is_the_slope_of_an_area() {
    let run = simulation(&bar("(effect: EdgeLoad(edges: [Box((-1, -1), (1, 1))], pressure: 50))"));
    let (scene, x) = (run.scene(), shaken(&run.scene().rest));
    let force = forces(scene, &x, 0.0);
    let (mut resultant, mut moment) = ([0.0; 2], 0.0);
    for (at, force) in x.chunks(2).zip(force.chunks(2)) {
        resultant = [resultant[0] + force[0], resultant[1] + force[1]];
        moment += at[0] * force[1] - at[1] * force[0];
    }
    assert!(resultant[0].hypot(resultant[1]) < 1e-12 && moment.abs() < 1e-12, "{resultant:?} {moment}");
    let effect = scene.effects.iter().find(|effect| effect.name() == "EdgeLoad").unwrap();
    let v = vec![0.0; x.len()];
    let motion =
        Motion { dimension: 2, x: &x, v: &v, mass: &scene.mass, inverse_mass: &scene.inverse_mass, ..Motion::NONE };
    let mut pattern = Vec::new();
    effect.sparsity_pattern(&mut |a, b| pattern.push([a, b]));
    let mut matrix = BlockMatrix::<2>::new(scene.vertices(), &pattern);
    let weights = Weights { position: 1.0, velocity: 0.0, tangent: Tangent::Exact };
    effect.add_stiffness(motion, weights, &mut matrix);
    for number in 0..x.len() {
        let moved = |by: f64| {
            let mut x = x.clone();
            x[number] += by;
            x
        };
        let slope = (area(scene, &moved(1e-6)) - area(scene, &moved(-1e-6))) / 2e-6;
        assert!((force[number] + 50.0 * slope).abs() < 1e-8, "{number}: {} {slope}", force[number]);
        let (mut unit, mut product, mut by_blocks) = (vec![0.0; x.len()], vec![0.0; x.len()], vec![0.0; x.len()]);
        unit[number] = 1.0;
        effect.stiffness_times(motion, &unit, &mut [], &mut product);
        matrix.add_product(&unit, &mut by_blocks);
        let (more, less) = (forces(scene, &moved(1e-6), 0.0), forces(scene, &moved(-1e-6), 0.0));
        for other in 0..x.len() {
            let slope = -(more[other] - less[other]) / 2e-6;
            assert!((product[other] - slope).abs() < 1e-7, "{number} {other}: {} {slope}", product[other]);
            assert!((by_blocks[other] - slope).abs() < 1e-7, "{number} {other}: {} {slope}", by_blocks[other]);
        }
    }
}

/// A traction draws a bar to where its stress is in balance, under every scheme: at a small strain its length grows by `t L/E`. The energy balance has its work.
#[test]
fn every_scheme_comes_to_the_same_length() {
    for kind in IntegratorKind::all() {
        let load = "(effect: EdgeLoad(edges: [Right], traction: (10, 0), ramp: 0.5)), (effect: Rayleigh(mass: 20))";
        let mut run = simulation(&Level { integrator: kind.clone(), ..bar(load) });
        run.advance(40 * 120, &mut || true);
        let name = kind.name();
        assert!(run.fault().is_none(), "{name}: {:?}", run.fault());
        let right = run.state().x.chunks(2).zip(run.scene().rest.chunks(2)).filter(|(_, rest)| rest[0] > 0.4999);
        for (x, rest) in right {
            let gone = x[0] - rest[0];
            assert!((gone - 5e-4).abs() < 5e-6, "{name}: {gone} m");
        }
    }
}

/// Saved while a load rises and continued: every bit is the same.
#[test]
fn a_loaded_body_is_saved() {
    for kind in IntegratorKind::all() {
        let load = "(effect: EdgeLoad(edges: [Right], traction: (0, -50), pressure: 30, ramp: 1))";
        continues_bit_for_bit(&Level { integrator: kind, ..bar(load) });
    }
}

/// What names no edge of a body in the plane is refused in words.
#[test]
fn a_load_needs_edges() {
    let refused = |effects: &str| {
        let level = bar(effects);
        Scene::build(&level, level.mode, &NoFiles, None).err().map(|why| why.to_string()).unwrap_or_default()
    };
    let error = refused("(effect: EdgeLoad(edges: [Nearest((0.5, 0))], pressure: 30))");
    assert!(error.contains("EdgeLoad") && error.contains("names no edge of a body"), "{error}");
    let error = refused("(effect: EdgeLoad(of: \"bra\", edges: [Right], pressure: 30))");
    assert!(error.contains("bra") && error.contains("bar"), "{error}");
}

/// A check of the right end of the bar.
fn check(column: &str, at: f64, value: f64, place: &str) -> String {
    format!(
        "(name: \"end\", place: {place}, column: \"{column}\", at: {at}, value: {value}, tolerance: 0.00001, source: \"statics\")"
    )
}

/// The bar with checks.
fn checked(checks: &str) -> Level {
    let load = "(effect: EdgeLoad(edges: [Right], traction: (10, 0), ramp: 0.5)), (effect: Rayleigh(mass: 20))";
    let mut text = gingerbread::files::text_at("bar.ron".as_ref(), &bar(load)).unwrap();
    text.truncate(text.trim_end().len() - 1);
    level(&format!("{text} checks: [{checks}])"))
}

/// A known result is measured when its time comes, in steps of any number at once, and not by a run that begins later.
#[test]
fn known_results_are_measured_at_their_time() {
    let place = "Vertex((0.5, 0.1))";
    let all = [check("ux", 2.0, 5e-4, place), check("ux", 1.0, 1.0, place), check("reaction_x", 2.0, -1.0, "Reaction")];
    let level = checked(&all.join(", "));
    let results = |run: &Simulation| {
        run.checks().map(|(check, measured)| measured.map(|value| check.is_met(value))).collect::<Vec<_>>()
    };
    for batch in [1, 7, 40, 100_000] {
        let mut run = simulation(&level);
        assert_eq!(run.steps_to_last_check(), Some(4800));
        while run.state().steps < 4790 {
            run.advance(batch.min(4790 - run.state().steps), &mut || true);
        }
        assert_eq!(results(&run), [None, Some(false), None]);
        run.advance(batch.min(10), &mut || true);
        run.advance(10, &mut || true);
        assert_eq!(results(&run), [Some(true), Some(false), Some(true)], "in batches of {batch}");
        assert_eq!(run.steps_to_last_check(), None);
        // A state of an earlier time forgets what comes later.
        let state = gingerbread::state::State { time: 1.5, steps: 3600, ..run.state().clone() };
        run.set_state(state);
        assert_eq!(results(&run), [None, Some(false), None]);
    }
}

/// A check that the scene cannot measure is refused, and names what there is.
#[test]
fn checks_that_cannot_be_measured_are_refused() {
    let refused = |check: String| {
        let level = checked(&check);
        let scene = Scene::build(&level, level.mode, &NoFiles, None).unwrap();
        Simulation::open(scene, &level, level.mode).err().map(|why| why.to_string()).unwrap_or_default()
    };
    let error = refused(check("uz", 1.0, 0.0, "Vertex((0, 0))"));
    assert!(error.contains("check \"end\"") && error.contains("x, y, vx, vy, ux, uy"), "{error}");
    let error = refused(check("ux", 1.0, 0.0, "Vertex((0, 0, 0))"));
    assert!(error.contains("3 coordinates"), "{error}");
    let error = refused(check("x", 1.0, 0.0, "Numbers"));
    assert!(error.contains("it is no toy"), "{error}");
    assert_eq!(refused(check("s11", 1.0, 0.0, "Triangle((0.2, 0.05))")), "");
}

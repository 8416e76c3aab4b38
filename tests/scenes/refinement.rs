//! The estimated error of the stress, and meshes that are refined while a scene runs.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{level, models, opened, running, seen, sheet, sheets, simulation};
use gingerbread::{
    command::Command,
    elements::{ElementKind, Field},
    files,
    integrators::IntegratorKind,
    level::{Level, Pin},
    meshes::NoFiles,
    quantity::Point,
    sandbox::Sandbox,
    scene::Scene,
    snapshot::Snapshot,
};
use nalgebra::{Matrix2, Vector2};

/// A homogeneous deformation has the same stress everywhere, and so no error.
#[test]
fn a_homogeneous_deformation_has_no_stress_error() {
    for (what, level) in sheets("stretch: (1.2, 0.9), ") {
        let errors = simulation(&level).scene().stress_errors(&simulation(&level).scene().start.x);
        assert!(errors.stress_squared > 0.0 && errors.relative() < 1e-7, "{what}: {}", errors.relative());
    }
    let rest = simulation(&sheet("Corotated", "", "")).scene().clone();
    let errors = rest.stress_errors(&rest.start.x);
    assert_eq!((errors.relative(), errors.worst(0.5)), (0.0, Vec::new()));
}

/// A smooth deformation of the unit square, and its gradient.
fn smooth([x, y]: [f64; 2]) -> ([f64; 2], Matrix2<f64>) {
    let place = [x + 0.05 * (2.0 * x + y).sin(), y + 0.08 * (x * y).cos()];
    let along = 0.05 * (2.0 * x + y).cos();
    let across = -0.08 * (x * y).sin();
    (place, Matrix2::new(1.0 + 2.0 * along, along, across * y, 1.0 + across * x))
}

/// Estimated and true error of the stress of the smooth deformation, of its values at the vertices of linear triangles.
fn errors(model: &str, cells: usize) -> [f64; 2] {
    let scene = simulation(&level(&format!(
        "(name: \"\", bodies: [(name: \"\", mesh: Rectangle(width: 1, height: 1, columns: {cells}, rows: {cells}, diagonals: Alternating),
            material: (model: {model}, young: 100, poisson: 0.3, plane: Strain), mass: Density(1))])"
    )))
    .scene()
    .clone();
    let points = |flat: &[f64]| flat.as_chunks().0.to_vec();
    let x: Vec<f64> = points(&scene.rest).into_iter().flat_map(|point| smooth(point).0).collect();
    let estimate = scene.stress_errors(&x);
    let (elements, rest) = (&scene.bodies[0].elements, points(&scene.rest));
    let mut sum = 0.0;
    for (triangle, (corners, area)) in elements.corners().iter().zip(elements.rest_areas()).enumerate() {
        let stress = elements.point_stress(&x, triangle).piola;
        let corners = corners.map(|corner| Vector2::from(rest[corner as usize]));
        // The middles of the sides are exact for squares of linear functions.
        for side in 0..3 {
            let middle = 0.5 * (corners[side] + corners[(side + 1) % 3]);
            let exact = elements.material().at(&smooth(middle.into()).1).piola;
            sum += area / 3.0 * (exact - stress).norm_squared();
        }
    }
    [estimate.squares.iter().sum::<f64>().sqrt(), f64::sqrt(sum)]
}

/// The estimate comes near the true error, which has the first order in the size of the triangles.
#[test]
fn the_estimated_stress_error_is_nearly_the_true_one() {
    for model in models() {
        let [coarse, fine] = [errors(model, 8), errors(model, 32)];
        let ratio = |[estimate, exact]: [f64; 2]| estimate / exact;
        assert!((0.8..1.25).contains(&ratio(coarse)), "{model}: {coarse:?}");
        assert!((ratio(fine) - 1.0).abs() < 0.06, "{model}: {fine:?}");
        assert!((coarse[1] / fine[1] - 4.0).abs() < 0.2, "{model}: {coarse:?} {fine:?}");
    }
}

/// A membrane that is turned in space has the errors of the same body, times its thickness.
#[test]
fn membranes_have_the_stress_errors_of_bodies() {
    let mesh = "mesh: Rectangle(width: 1, height: 1, columns: 6, rows: 5, diagonals: Alternating)";
    let material = "material: (model: NeoHookean, young: 100, poisson: 0.3, plane: Stress)";
    let plane =
        simulation(&level(&format!("(name: \"\", bodies: [(name: \"\", {mesh}, {material}, mass: Density(1))])")));
    let space = "(name: \"\", membranes: [(name: \"\", mesh, material, thickness: 0.01, mass: Density(1), space: (turn: (30, 50, 70), offset: (1, 2, 3)))])";
    let space = level(&space.replace("mesh, material", &format!("{mesh}, {material}")));
    let turned = simulation(&space);
    let points = plane.scene().rest.as_chunks::<2>().0;
    let x: Vec<f64> = points.iter().flat_map(|point| smooth(*point).0).collect();
    let placed = |point: &[f64; 2]| space.membranes[0].space.placed(smooth(*point).0);
    let in_space: Vec<f64> = points.iter().flat_map(placed).collect();
    let [plane, turned] = [plane.scene().stress_errors(&x), turned.scene().stress_errors(&in_space)];
    let largest = plane.squares.iter().fold(0.0_f64, |largest, square| largest.max(*square));
    assert_eq!(plane.squares.len(), turned.squares.len());
    for (one, other) in plane.squares.iter().zip(&turned.squares) {
        assert!((0.01 * one - other).abs() < 1e-12 * largest, "{one} {other}");
    }
    assert!((plane.relative() - turned.relative()).abs() < 1e-12);
}

/// Shares add up to the whole, and the worst triangles are the fewest with half of it.
#[test]
fn the_worst_triangles_have_half_of_the_error() {
    let mut sandbox = running(sheet("Corotated", "stretch: (1.3, 1), pins: [Left]", ""));
    sandbox.advance(40, &mut || true);
    let mut snapshot = Snapshot::default();
    sandbox.snapshot(Field::StressError, &mut snapshot);
    let sum: f64 = snapshot.values.iter().sum();
    assert!((sum - 100.0).abs() < 1e-9 && snapshot.values.len() == 32, "{sum}");
    let relative = snapshot.stress_error.unwrap();
    assert!(relative > 0.01 && relative < 1.0, "{relative}");
    let simulation = sandbox.simulation();
    let errors = simulation.scene().stress_errors(&simulation.state().x);
    let worst = errors.worst(0.5);
    let shares: Vec<_> = errors.shares().collect();
    let sum: f64 = worst.iter().map(|triangle| shares[*triangle]).sum();
    let least = worst.iter().map(|triangle| shares[*triangle]).fold(1.0, f64::min);
    assert!(sum >= 0.5 && sum - least < 0.5 && worst.len() < 16, "{worst:?}");
    let others = (0..32).filter(|triangle| !worst.contains(triangle));
    assert!(others.map(|triangle| shares[triangle]).all(|share| share <= least));
}

/// What a small level is at half a second, before and after a refinement.
fn refined(level: Level) -> Sandbox {
    let mut sandbox = running(level);
    sandbox.advance(30, &mut || true);
    assert!(sandbox.simulation().fault().is_none());
    let before = seen(&sandbox);
    sandbox.apply(Command::RefineWorst).unwrap();
    let after = seen(&sandbox);
    assert_eq!((before.time, before.steps), (after.time, after.steps));
    assert!(after.vertex_count() > before.vertex_count());
    sandbox
}

/// With each scheme and kind of element the scene goes on. A half of a linear triangle has its deformation gradient, so that the elastic energy
/// and the momentum stay.
#[test]
fn a_scene_goes_on_after_its_mesh_was_refined() {
    let body = "stretch: (1.15, 0.95), velocity: (0.3, 0.1), spin: 2, element: ";
    for (kind, scheme) in ElementKind::ALL
        .into_iter()
        .flat_map(|kind| IntegratorKind::all().into_iter().map(move |scheme| (kind, scheme)))
    {
        let what = format!("{kind:?} {}", scheme.name());
        let rest = "substeps: 8, effects: [(effect: Rayleigh(mass: 0, stiffness: 0.004))]";
        let level = Level { integrator: scheme, ..sheet("NeoHookean", &format!("{body}{kind:?}"), rest) };
        let mut sandbox = refined(level);
        let change = sandbox.mesh_change().unwrap();
        let [before, after] = change.energies;
        assert!(change.triangles[1] > change.triangles[0]);
        let near = if kind == ElementKind::Linear { 1e-12 } else { 0.05 };
        assert!((after.elastic / before.elastic - 1.0).abs() < near, "{what}: {before:?} {after:?}");
        // The sum over the vertices is above the integral of v², and comes nearer to it.
        assert!((0.8..1.0 + 1e-12).contains(&(after.kinetic / before.kinetic)), "{what}: {before:?} {after:?}");
        let apart = (0..2).map(|axis| (change.momentum[0][axis] - change.momentum[1][axis]).abs()).fold(0.0, f64::max);
        // New elements of six nodes have other triangles, over whose sides the velocity of the old ones bends.
        let near = if kind == ElementKind::Linear { 1e-12 } else { 1e-3 };
        assert!(apart < near * change.momentum[0][0].abs(), "{what}: {:?}", change.momentum);
        sandbox.advance(60, &mut || true);
        assert!(sandbox.simulation().fault().is_none(), "{what}: {:?}", sandbox.simulation().fault());
        let energy = sandbox.simulation().energies().total();
        assert!(energy < 1.2 * after.total(), "{what}: {energy} J of {after:?}");
    }
}

#[test]
fn membranes_are_refined_too() {
    let mut sandbox = opened("toronto_cloth");
    sandbox.apply(Command::SetRunning(true)).unwrap();
    sandbox.advance(20, &mut || true);
    sandbox.apply(Command::Refine(vec![0, 40, 41])).unwrap();
    let change = sandbox.mesh_change().unwrap();
    let [before, after] = change.energies;
    assert!(change.triangles[1] >= change.triangles[0] + 9);
    assert!((after.elastic / before.elastic - 1.0).abs() < 1e-9, "{before:?} {after:?}");
    sandbox.advance(20, &mut || true);
    assert!(sandbox.simulation().fault().is_none());
}

/// The numbers of the vertices stay, and so do pins that name them; those of an edge hold new vertices too. The guard allows for the change.
#[test]
fn pins_stay_where_the_mesh_is_refined() {
    let pins = [Pin::Vertex(0), Pin::Vertex(12)];
    let mut level = sheet("Corotated", "stretch: (1.2, 1), pins: [Vertex(0), Vertex(12)]", "");
    let sandbox = refined(level.clone());
    assert_eq!(*sandbox.document().level.bodies[0].pins, pins);
    assert_eq!(seen(&sandbox).pins.len(), 2);
    level.bodies[0].pins = vec![Pin::Left];
    let mut sandbox = running(level.clone());
    sandbox.advance(30, &mut || true);
    sandbox.apply(Command::Refine((0..32).collect())).unwrap();
    let held = seen(&sandbox);
    assert_eq!(held.pins.len(), 9, "the left side had five vertices");
    let at = |vertex: u32| held.position(vertex as usize).unwrap()[0];
    assert!(held.pins.iter().all(|pin| (at(*pin) - at(held.pins[0])).abs() < 1e-12));
    // The same vertex is held where a new one is nearer to the point of a rule.
    level.bodies[0].pins = vec![Pin::Nearest(Point::new([0.36, 0.35]).unwrap())];
    let mut sandbox = running(level.clone());
    let before = seen(&sandbox).pins.to_vec();
    sandbox.apply(Command::Refine((0..32).collect())).unwrap();
    assert_eq!(*seen(&sandbox).pins, before);
    // Vertices that were chosen at random stay those.
    level.bodies[0].pins = vec![Pin::Random { count: 6, seed: 3 }];
    let before = simulation(&level).scene().pins.to_vec();
    assert_eq!(*seen(&refined(level)).pins, before);
}

/// What sleeps wakes: the finer mesh has another equilibrium. Paths of vertices stay theirs, and loads that would lose their edges are told.
#[test]
fn a_scene_at_rest_wakes_and_effects_keep_their_vertices() {
    let effects = "effects: [(effect: Gravity(down: 2)), (effect: Rayleigh(mass: 20))]";
    let mut sandbox = running(sheet("Corotated", "pins: [Left]", effects));
    for _ in 0..200 {
        sandbox.advance(60, &mut || true);
        if sandbox.simulation().is_asleep() {
            break;
        }
    }
    assert!(sandbox.simulation().is_asleep());
    sandbox.apply(Command::RefineWorst).unwrap();
    assert!(!sandbox.simulation().is_asleep());
    let before = sandbox.simulation().state().x.clone();
    sandbox.advance(60, &mut || true);
    assert_ne!(sandbox.simulation().state().x, before, "it moves to its new rest");
    for (kind, pins) in [
        ("Linear", "Vertex(24)"),
        ("Quadratic", "Vertex(24)"),
        ("Quadratic", "Vertex(40)"),
        ("Linear", "Nearest((0.66, 0.67))"),
    ] {
        let held = format!(
            "effects: [(effect: MovingPins(of: \"sheet\", pins: [{pins}], motions: [Swing(way: (0.01, 0), period: 1)]))]"
        );
        let mut sandbox = running(sheet("Corotated", &format!("element: {kind}"), &held));
        let place = |sandbox: &Sandbox| {
            let scene = sandbox.simulation().scene();
            let held: Vec<_> = scene.held().collect();
            assert_eq!(held.len(), 1, "{kind} {pins}");
            let numbers = scene.numbers(&(held[0] as usize..held[0] as usize + 1));
            [0, 1].map(|axis| scene.rest[numbers.start + axis])
        };
        let before = place(&sandbox);
        sandbox.apply(Command::Refine((0..20).collect())).unwrap();
        assert_eq!(place(&sandbox), before, "{kind} {pins}");
    }
    let loaded = "effects: [(effect: EdgeLoad(edges: [Vertex(0), Vertex(1)], traction: (1, 0)))]";
    let mut sandbox = running(sheet("Corotated", "", loaded));
    let refused = sandbox.apply(Command::Refine(vec![0])).unwrap_err().to_string();
    assert!(refused.contains("by single vertices"), "{refused}");
}

/// One change to undo, which brings the run back; what is saved afterwards opens again and goes on bit for bit.
#[test]
fn refinement_is_undone_and_saved() {
    let mut sandbox = running(sheet("NeoHookean", "stretch: (1.2, 1), pins: [Left]", ""));
    sandbox.advance(30, &mut || true);
    let before = sandbox.simulation().state().hash();
    sandbox.apply(Command::RefineWorst).unwrap();
    let refined = sandbox.simulation().state().hash();
    sandbox.apply(Command::RefineWorst).unwrap();
    let MeshSizes(two, _) = sizes(&sandbox);
    sandbox.apply(Command::Undo).unwrap();
    assert_eq!(sandbox.simulation().state().hash(), refined);
    sandbox.apply(Command::Undo).unwrap();
    assert_eq!(sandbox.simulation().state().hash(), before);
    sandbox.apply(Command::Redo).unwrap();
    sandbox.apply(Command::Redo).unwrap();
    assert_eq!(sizes(&sandbox).0, two);
    sandbox.advance(10, &mut || true);
    let saved = files::write(&sandbox.saved()).unwrap();
    let mut other = running(files::parse(&saved, "saved.ron").unwrap());
    for run in [&mut sandbox, &mut other] {
        run.apply(Command::SetRunning(true)).unwrap();
        run.advance(20, &mut || true);
    }
    assert_eq!(sandbox.simulation().state().hash(), other.simulation().state().hash());
}

/// Numbers of triangles and vertices.
struct MeshSizes(usize, usize);

fn sizes(sandbox: &Sandbox) -> MeshSizes {
    let Scene { triangles, .. } = sandbox.simulation().scene();
    MeshSizes(triangles.len(), sandbox.simulation().scene().vertices())
}

#[test]
fn refinement_of_nothing_is_refused() {
    let mut toy = opened("pendulum");
    let mut rest = Sandbox::new(sheet("Corotated", "", ""), Box::new(NoFiles)).unwrap();
    for sandbox in [&mut toy, &mut rest] {
        let before = sandbox.document().clone();
        assert!(sandbox.apply(Command::RefineWorst).is_err());
        assert!(sandbox.apply(Command::Refine(vec![100_000])).is_err());
        assert_eq!(*sandbox.document(), before);
    }
    assert_eq!(sizes(&rest).0, 32);
    // Triangles of a body are chosen in edit mode too, and all bodies of a stretch test are one.
    rest.apply(Command::Refine(vec![7])).unwrap();
    let MeshSizes(triangles, vertices) = sizes(&rest);
    assert!(triangles >= 35 && vertices >= 28, "{triangles} {vertices}");
    let mut test = opened("stretch_test");
    test.apply(Command::SetSideBySide(true)).unwrap();
    let before = sizes(&test).0;
    test.apply(Command::Refine(vec![before - 1])).unwrap();
    assert_eq!((sizes(&test).0 - before) % 6, 0, "each of the six models has the same mesh");
}

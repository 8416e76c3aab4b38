//! Facts about levels in space: nets and membranes from files.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a failing test should panic")]

use crate::common::{built_in, continues_bit_for_bit, greatest_gap, level, named, simulation};
use gingerbread::{
    effects::Grab,
    files,
    integrators::{Class, IntegratorKind},
    level::{Level, Sleep},
    meshes::NoFiles,
    scene::{Scene, SceneError},
    simulation::Simulation,
};
use nalgebra::Vector3;

/// A membrane or a net on its side, with pins, gravity and both kinds of damping.
fn hanging(parts: &str, effects: &str) -> Level {
    level(&format!(
        "(name: \"\", {parts},
        effects: [(effect: Gravity(down: 2)), (effect: Rayleigh(mass: 0.5, stiffness: 0.002)), (effect: MouseSpring(stiffness: 20)), {effects}])"
    ))
}

const MEMBRANE: &str = "membranes: [(name: \"cloth\", mesh: Rectangle(width: 0.4, height: 0.4, columns: 3, rows: 3, diagonals: Alternating, corner: (0, 0)),
    material: (model: NeoHookean, young: 1000, poisson: 0.3, plane: Stress), thickness: 0.01, mass: Density(100), pins: [Top],
    stretch: (1.05, 1.1), space: (turn: (-60, 20, 5), offset: (0.1, 0.2, 0.3), velocity: (0, 0, 0.2)))]";

const NET: &str = "nets: [(name: \"net\", net: Sheet(width: 0.4, height: 0.4, columns: 3, rows: 3, structural: 40, shear: 20, flexion: 10, corner: (0, 0)),
    mass: 0.02, pins: [Top], velocity: (0.1, 0), space: (turn: (-60, 20, 5), velocity: (0, 0, 0.2)))]";

const LATTICE: &str = "nets: [(name: \"block\", net: Lattice(width: 0.4, height: 0.3, depth: 0.2, columns: 2, rows: 3, layers: 1, structural: 40, shear: 20, flexion: 10,
    corner: (0, 0)), mass: 0.02, pins: [Top], velocity: (0.1, 0), space: (turn: (-60, 20, 5), velocity: (0, 0, 0.2)))]";

fn pulled(level: &Level, kind: IntegratorKind, step: f64) -> Simulation {
    let mut simulation = simulation(&Level { integrator: kind, ..level.clone() });
    let scene = Scene { step, sleep: Sleep::Off, ..simulation.scene().clone() };
    simulation.replace_scene(scene);
    simulation.set_grab(Some(Grab { vertex: 0, target: [0.2, -0.1, 0.4] }));
    simulation
}

/// With gravity, both kinds of damping and the mouse, all schemes converge to one motion, by their order.
#[test]
fn every_integrator_moves_what_hangs_in_space() {
    for parts in [MEMBRANE, NET] {
        let level = hanging(parts, "");
        let end = |kind: IntegratorKind, step: f64| {
            let mut simulation = pulled(&level, kind, step);
            simulation.advance((0.3 / step).round() as u64, &mut || true);
            assert!(simulation.fault().is_none(), "{:?}", simulation.fault());
            assert_eq!(simulation.counts().unconverged, 0);
            simulation.state().x.clone()
        };
        let exact = end(named("RungeKutta4"), 5e-4);
        for kind in IntegratorKind::all() {
            // Forward Euler gains energy in longer steps.
            let step = match (kind.kind().class(), kind.kind().order()) {
                (Class::Explicit, 1) => 2e-4,
                (Class::Implicit, _) => 2e-3,
                _ => 1e-3,
            };
            let [whole, half] = [step, 0.5 * step].map(|step| greatest_gap(&end(kind.clone(), step), &exact));
            let (most, ratio) = match kind.kind().order() {
                1 => (0.04, 0.65),
                2 => (3e-3, 0.3),
                _ => (1e-7, f64::INFINITY),
            };
            assert!(whole < most && half <= ratio * whole, "{}: {whole} m and {half} m", kind.name());
        }
    }
}

#[test]
fn a_run_in_space_is_saved_and_continued_bit_for_bit() {
    for parts in [MEMBRANE, NET, LATTICE] {
        for kind in IntegratorKind::all() {
            let level = Level { integrator: kind.clone(), ..hanging(parts, "") };
            continues_bit_for_bit(&level);
        }
    }
}

/// A flat membrane with viscous stress moves as its body in the plane.
#[test]
fn damping_of_a_flat_membrane_is_that_of_the_plane() {
    let of = |list: &str, more: &str, material: &str| {
        format!(
            "{list}: [(name: \"sheet\", mesh: Rectangle(width: 0.4, height: 0.4, columns: 3, rows: 3, diagonals: Alternating, corner: (0, 0)),
            material: (model: {material}, young: 1000, poisson: 0.3, plane: Stress), mass: Density(100), pins: [Top], stretch: (1.1, 0.95){more})]"
        )
    };
    for material in ["Corotated", "NeoHookean"] {
        for scheme in ["SymplecticEuler", "RungeKutta4", "ImplicitEuler", "Bdf2"] {
            let run = |parts: &str| {
                let level = Level { integrator: named(scheme), ..hanging(parts, "") };
                let mut simulation = simulation(&level);
                let scene = Scene { step: 1e-3, sleep: Sleep::Off, ..simulation.scene().clone() };
                simulation.replace_scene(scene);
                simulation.advance(100, &mut || true);
                simulation.state().x.clone()
            };
            let plane = run(&of("bodies", "", material));
            let space = run(&of("membranes", ", thickness: 1", material));
            let seen: Vec<f64> = space.chunks(3).flat_map(|point| [point[0], point[1]]).collect();
            let apart = greatest_gap(&seen, &plane);
            // Newton's method solves both to a part of its tolerance.
            let allowed = if ["ImplicitEuler", "Bdf2"].contains(&scheme) { 1e-9 } else { 1e-13 };
            assert!(apart < allowed, "{material}, {scheme}: {apart:e} m");
        }
    }
}

#[test]
fn the_plane_and_space_are_not_mixed() {
    let net = "(name: \"flat\", net: Chain(from: (0, 0), to: (1, 0), springs: 2, stiffness: 10, rest: 0.4), mass: 1)";
    let mixed = level(&format!("(name: \"\", nets: [{net}], {MEMBRANE})"));
    let error = Scene::build(&mixed, mixed.mode, &NoFiles, None).err().unwrap();
    assert!(matches!(error, SceneError::Mixed { .. }), "{error}");
    assert!(error.to_string().contains("\"flat\" is in the plane, but \"cloth\" is in space"), "{error}");
    for effect in
        ["Boundary(least: (0, 0), greatest: (1, 1))", "Walls(obstacles: [Ball(centre: (0, 0), radius: 1, eps: 0.01)])"]
    {
        let walled = hanging(MEMBRANE, &format!("(effect: {effect})"));
        let error = Scene::build(&walled, walled.mode, &NoFiles, None).err().unwrap();
        assert!(error.to_string().contains("2 coordinates"), "{effect}: {error}");
    }
}

#[test]
fn a_state_of_another_dimension_is_refused() {
    let saved = simulation(&hanging(MEMBRANE, "")).saved().unwrap();
    let flat = saved.positions.iter().map(|point| {
        let [x, y, _] = point.get();
        gingerbread::quantity::Position::new(&[x, y]).unwrap()
    });
    let state = gingerbread::level::SavedState { positions: flat.collect(), ..saved };
    let level = Level { state: Some(state), ..hanging(MEMBRANE, "") };
    let scene = Scene::build(&level, level.mode, &NoFiles, None).unwrap();
    let error = Simulation::open(scene, &level, level.mode).err().unwrap();
    assert!(error.to_string().contains("3 coordinates"), "{error}");
    let short = "(name: \"\", bodies: [], actions: [(at: 0, action: Grab((1)))])";
    let error = files::parse(short, "short.ron").unwrap_err().to_string();
    assert!(error.contains("(x, y) or (x, y, z)"), "{error}");
}

/// With the mass and the springs of 32 x 32 particles, the longest stable step of the Cornell cloth; with 128 x 128 it is 0.251 ms.
#[test]
fn the_cornell_cloth_has_the_step_of_its_course() {
    let text = "(name: \"\", nets: [(name: \"cloth\", net: Sheet(width: 1, height: 1, columns: 127, rows: 127, structural: 384, shear: 384,
        flexion: 384, corner: (0, 0)), mass: 0.00006103515625, space: (turn: (-90, 0, 0), offset: (0, 0.6, 0)))])";
    let scene = simulation(&level(text)).scene().clone();
    assert_eq!(scene.nets[0].springs.links().len(), 97_026);
    let limit = gingerbread::stability::critical_step(&scene, &scene.start, None).unwrap();
    assert!((limit / 0.251e-3 - 1.0).abs() < 0.02, "{limit} s");
    // The shipped level has a quarter of the particles along a side.
    let shipped = simulation(&built_in("cornell_cloth"));
    let limit = gingerbread::stability::critical_step(shipped.scene(), &shipped.scene().start, None).unwrap();
    assert!(shipped.scene().step < limit, "{limit} s");
}

/// Far beyond the stability limit, without the guard: time stops before garbage, and the fault names the part of the scene.
#[test]
fn a_step_that_is_too_long_in_space_is_told() {
    for (parts, name, element) in [(MEMBRANE, "cloth", "Triangle"), (NET, "net", "Spring")] {
        let level = Level { guard: gingerbread::level::Toggle::Off, ..hanging(parts, "") };
        let mut simulation = simulation(&level);
        let limit = gingerbread::stability::critical_step(simulation.scene(), simulation.state(), None).unwrap();
        let scene = Scene { step: 20.0 * limit, ..simulation.scene().clone() };
        simulation.replace_scene(scene);
        simulation.advance(10_000, &mut || true);
        let fault = simulation.fault().unwrap().to_string();
        assert!(fault.contains(name) && fault.contains(element), "{fault}");
        assert!(simulation.state().x.iter().all(|x| x.is_finite()), "{name}");
    }
}

/// A flat membrane of 1 m thickness has the values of its body in the plane: energy density, von Mises stress and J.
#[test]
fn values_of_a_flat_membrane_are_those_of_the_plane() {
    use gingerbread::{elements::Field, sandbox::Sandbox, snapshot::Snapshot};
    let of = |list: &str, more: &str, material: &str| {
        let level = level(&format!(
            "(name: \"\", {list}: [(name: \"sheet\", mesh: Rectangle(width: 0.4, height: 0.4, columns: 3, rows: 3, diagonals: Alternating, corner: (0, 0)),
            material: (model: {material}, young: 1000, poisson: 0.3, plane: Stress), mass: Density(100), stretch: (1.2, 0.9){more})])"
        ));
        Sandbox::new(level, Box::new(NoFiles)).unwrap()
    };
    for material in ["Corotated", "StVenantKirchhoff", "NeoHookean"] {
        for field in Field::ALL.into_iter().filter(|field| field.is_of_triangles()) {
            let [mut plane, mut space] = [Snapshot::default(), Snapshot::default()];
            of("bodies", "", material).snapshot(field, &mut plane);
            of("membranes", ", thickness: 1, space: (turn: (30, 40, 50))", material).snapshot(field, &mut space);
            assert_eq!(plane.values.len(), 18);
            for (plane, space) in plane.values.iter().zip(&space.values) {
                assert!((plane - space).abs() < 1e-10 * plane.abs(), "{material} {field:?}: {plane} {space}");
            }
        }
    }
}

/// Its springs are at rest, its sides enclose its volume, and every particle has a spring to its neighbours.
#[test]
fn a_lattice_is_a_block_at_rest_in_space() {
    let simulation = simulation(&hanging(LATTICE, ""));
    let (net, x) = (&simulation.scene().nets[0], &simulation.scene().rest);
    assert_eq!(net.vertices.len(), 3 * 4 * 2);
    // 2 x 4 x 2 + 3 x 3 x 2 + 3 x 4 x 1 edges, 2 (2 x 3 x 2 + 2 x 4 x 1 + 3 x 3 x 1) diagonals, 1 x 4 x 2 + 3 x 2 x 2 over two cells.
    assert_eq!(net.springs.links().len(), 46 + 58 + 20);
    let point = |vertex: u32| Vector3::from_column_slice(&x[3 * vertex as usize..3 * vertex as usize + 3]);
    for link in net.springs.links() {
        let length = (point(link.ends[0]) - point(link.ends[1])).norm();
        assert!((length - link.rest).abs() < 1e-14, "{link:?}: {length}");
    }
    let volume: f64 = net.faces.iter().map(|face| face.map(point)).map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0).sum();
    assert!((volume - 0.4 * 0.3 * 0.2).abs() < 1e-15, "{volume}");
    let flat = hanging(&LATTICE.replace("space: (turn: (-60, 20, 5), velocity: (0, 0, 0.2))", ""), "");
    let error = Scene::build(&flat, flat.mode, &NoFiles, None).err().unwrap().to_string();
    assert!(error.contains("\"block\"") && error.contains("`space: ()`"), "{error}");
}

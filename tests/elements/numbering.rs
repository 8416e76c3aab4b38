//! Meshes and nets that are listed in no order are stepped in a better one, and nobody can tell: everything is called what the file
//! calls it.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{Random, level, reopened, simulation};
use gingerbread::{
    command::Command,
    files,
    level::{Level, Pin},
    levels::BUILT_IN,
    meshes::{MeshKind, NoFiles},
    sandbox::Sandbox,
    scene::Scene,
    simulation::Simulation,
};

/// Quads along a side: too many vertices to be near each other anyhow.
const SIDE: u32 = 50;

fn shuffled(count: usize, seed: u64) -> Vec<u32> {
    let mut random = Random(seed);
    let mut order: Vec<_> = (0..count as u32).map(|number| (random.between(0.0, 1.0), number)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    order.into_iter().map(|(_, number)| number).collect()
}

/// A list as a level writes it.
fn list<T>(items: &[T], write: impl Fn(&T) -> String) -> String {
    items.iter().map(write).collect::<Vec<_>>().join(", ")
}

/// A sheet with its vertices and triangles listed in order, and shuffled; and the name of each vertex in the second.
fn meshes() -> ([String; 2], Vec<u32>) {
    let row = SIDE + 1;
    let points: Vec<_> = (0..row * row).map(|i| [i % row, i / row].map(|k| f64::from(k) / f64::from(SIDE))).collect();
    let corners = |i: u32| i / SIDE * row + i % SIDE;
    let quads = (0..SIDE * SIDE).map(corners);
    let triangles: Vec<_> = quads.flat_map(|a| [[a, a + 1, a + row + 1], [a, a + row + 1, a + row]]).collect();
    let names = shuffled(points.len(), 1);
    let mut mixed = points.clone();
    names.iter().zip(&points).for_each(|(name, point)| mixed[*name as usize] = *point);
    let order = shuffled(triangles.len(), 2);
    let renamed = order.iter().map(|i| triangles[*i as usize].map(|vertex| names[vertex as usize])).collect::<Vec<_>>();
    let text = |points: &[[f64; 2]], triangles: &[[u32; 3]]| {
        let mut text = String::from("Points(points: [");
        text += &list(points, |[x, y]| format!("({x:?}, {y:?})"));
        text += "], triangles: [";
        text += &list(triangles, |[a, b, c]| format!("({a}, {b}, {c})"));
        text + "])"
    };
    ([text(&points, &triangles), text(&mixed, &renamed)], names)
}

fn with(mesh: &str, body: &str, rest: &str) -> Level {
    level(&format!(
        "(name: \"sheet\", guard: Off, {rest} bodies: [(name: \"sheet\", mesh: {mesh}, mass: Density(1), {body}
          material: (model: Corotated, young: 1000, poisson: 0.3))])"
    ))
}

/// Positions and velocities by name.
fn listed(run: &Simulation) -> [Vec<f64>; 2] {
    [&run.state().x, &run.state().v].map(|values| run.scene().listed(values).into_owned())
}

fn greatest_difference(one: &[f64], names: &[u32], other: &[f64]) -> f64 {
    let apart = |(vertex, name): (usize, &u32)| {
        (0..2).map(|axis| (one[2 * vertex + axis] - other[2 * *name as usize + axis]).abs()).fold(0.0, f64::max)
    };
    names.iter().enumerate().map(apart).fold(0.0, f64::max)
}

fn scene(mesh: &str) -> Scene {
    let level = with(mesh, "", "");
    Scene::build(&level, level.mode, &NoFiles, None).unwrap()
}

/// Whether a mesh is stepped in the order in which it is listed.
fn as_listed(mesh: &str) -> bool {
    scene(mesh).bodies[0].mesh.numbering().is_as_listed()
}

/// The same, or it is so large that another order lets several cores share it.
fn as_listed_or_shared(mesh: &str) -> bool {
    let body = &scene(mesh).bodies[0];
    body.mesh.numbering().is_as_listed() || body.elements.partitions() > 1
}

#[test]
fn only_shuffled_meshes_are_renumbered() {
    for size in [2, 20, 71, 150, 400] {
        for diagonals in ["Grid", "Alternating", "Crossed"] {
            let shape = format!("columns: {size}, rows: {}, diagonals: {diagonals}", size / 2 + 1);
            assert!(as_listed_or_shared(&format!("Rectangle(width: 1, height: 1, {shape})")), "{shape}");
        }
        assert!(as_listed_or_shared(&format!("Disk(radius: 1, rings: {})", size / 3 + 1)), "{size} / 3 rings");
        assert!(as_listed_or_shared(&format!("Gingerbread(resolution: {})", 100 + 7 * size)), "man {size}");
    }
    for (file, text) in BUILT_IN {
        let scene = Scene::build(&files::parse(text, file).unwrap(), crate::common::MODES[0], &NoFiles, None).unwrap();
        assert!(scene.bodies.iter().all(|body| body.mesh.numbering().is_as_listed()), "{file}");
        assert!(scene.nets.iter().all(|net| net.numbering.is_as_listed()), "{file}");
    }
    for size in [10, 127, 300] {
        let sheet = format!(
            "Sheet(width: 1, height: 1, columns: {size}, rows: {size}, structural: 1, shear: 1, flexion: 1, corner: (0, 0))"
        );
        let net = level(&format!("(name: \"net\", nets: [(name: \"net\", mass: 1, net: {sheet})])"));
        assert!(simulation(&net).scene().nets[0].numbering.is_as_listed(), "{size}");
    }
    let ([ordered, mixed], _) = meshes();
    assert_eq!((as_listed(&ordered), as_listed(&mixed)), (true, false));
    // All triangles meet at one vertex: no order is better.
    let rim: Vec<_> = (0..6000).map(|i| f64::from(i) / 6000.0 * std::f64::consts::PI).collect();
    let points = list(&rim, |angle| format!("({:?}, {:?})", angle.cos(), angle.sin()));
    let fan = list(&(1..6000).collect::<Vec<_>>(), |i| format!("(0, {i}, {})", i + 1));
    assert!(as_listed(&format!("Points(points: [(0, 0), {points}], triangles: [{fan}])")));
}

/// Forces wait in a buffer until all at their vertex are known: it has to stay small on meshes of any size.
#[test]
fn triangles_of_a_vertex_are_near_in_large_meshes() {
    let man = |resolution: u32| format!("Gingerbread(resolution: {resolution})");
    let disk = "Disk(radius: 1, rings: 400)".to_owned();
    let square = |columns: u32, rows: u32| format!("Rectangle(width: 1, height: 1, columns: {columns}, rows: {rows})");
    for mesh in [man(10_000), man(50_000), square(30_000, 2), square(2, 30_000), square(300, 300), disk] {
        let level = with(&mesh, "", "");
        let scene = Scene::build(&level, level.mode, &NoFiles, None).unwrap();
        let triangles = scene.bodies[0].elements.corners();
        let mut first = vec![None; scene.rest.len() / 2];
        let mut apart = 0;
        for (number, triangle) in triangles.iter().enumerate() {
            for vertex in triangle {
                apart = apart.max(number - *first[*vertex as usize].get_or_insert(number));
            }
        }
        let row = 2.0 * (triangles.len() as f64).sqrt();
        assert!((apart as f64) < 4.0 * row, "{mesh}: {apart} triangles apart, of {}", triangles.len());
    }
}

#[test]
fn a_large_mesh_is_saved_as_listed_and_resumes_exactly() {
    let level = with("Gingerbread(resolution: 12000)", "pins: [Vertex(17)], stretch: (1.1, 1),", "substeps: 100,");
    let [mut whole, mut half] = [simulation(&level), simulation(&level)];
    assert!(!whole.scene().bodies[0].mesh.numbering().is_as_listed());
    assert_eq!(whole.scene().owner_of(whole.scene().pins[0] as usize).unwrap().1, 17);
    whole.advance(30, &mut || true);
    half.advance(10, &mut || true);
    let mut rest = reopened(&half, &level);
    assert_eq!(rest.state(), half.state());
    rest.advance(20, &mut || true);
    assert_eq!(rest.state(), whole.state());
}

#[test]
fn a_shuffled_mesh_moves_as_the_ordered_one_does_to_round_off() {
    let ([ordered, mixed], names) = meshes();
    let body = "stretch: (1.2, 1), pins: [Top, Nearest(0.5, 0.5)], spin: 0.3,";
    let gravity = "effects: [(effect: Gravity(down: 1))],";
    for (rest, steps) in [("substeps: 100,", 300), ("substeps: 1, integrator: ImplicitEuler(),", 3)] {
        let [mut one, mut other] =
            [&ordered, &mixed].map(|mesh| simulation(&with(mesh, body, &format!("{rest} {gravity}"))));
        for run in [&mut one, &mut other] {
            assert_eq!(run.advance(steps, &mut || true), steps);
        }
        let [[x, v], [other_x, other_v]] = [listed(&one), listed(&other)];
        let apart = [greatest_difference(&x, &names, &other_x), greatest_difference(&v, &names, &other_v)];
        assert!(apart[0] < 1e-9 && apart[1] < 1e-6, "{rest} {apart:?}");
        let [one, other] = [one.energies(), other.energies()];
        assert!((one.total() - other.total()).abs() < 1e-9 * one.total().abs(), "{one:?} {other:?}");
    }
}

/// Pins, places and starts are those of the file.
#[test]
fn a_shuffled_mesh_uses_the_numbers_of_its_file() {
    let ([_, mixed], names) = meshes();
    let run = simulation(&with(&mixed, "pins: [Vertex(17), Vertex(1234)], start: Scrambled(seed: 3),", ""));
    let scene = run.scene();
    assert!(!scene.bodies[0].mesh.numbering().is_as_listed());
    let MeshKind::Points(points) = &with(&mixed, "", "").bodies[0].mesh else { unreachable!() };
    let rest: Vec<_> = points.points.iter().flat_map(|point| point.get()).collect();
    assert_eq!(scene.listed(&scene.rest), rest.as_slice());
    let mut called: Vec<_> = scene.pins.iter().map(|pin| scene.owner_of(*pin as usize).unwrap().1).collect();
    called.sort_unstable();
    assert_eq!(called, [17, 1234]);
    for name in called {
        assert_eq!(
            listed(&run)[0][2 * name..2 * name + 2],
            rest[2 * name..2 * name + 2],
            "what is pinned starts at rest"
        );
    }
    // Chance goes through the vertices as they are listed, whatever their places are.
    let grid = "Rectangle(width: 1, height: 1, columns: 50, rows: 50)";
    let other = simulation(&with(grid, "pins: [Vertex(17), Vertex(1234)], start: Scrambled(seed: 3),", ""));
    let same = |name: &usize| listed(&run)[0][2 * name..2 * name + 2] == listed(&other)[0][2 * name..2 * name + 2];
    assert_eq!((0..names.len()).filter(same).count(), names.len() - 2);
    // Of two that are equally near the one listed first is pinned.
    let run = simulation(&with(&mixed, "pins: [Nearest(0.51, 0.5)],", ""));
    let first = (0..names.len()).find(|name| (rest[2 * name] - 0.51).abs() < 0.011 && rest[2 * name + 1] == 0.5);
    assert_eq!(run.scene().owner_of(run.scene().pins[0] as usize).map(|(_, name)| name), first);
}

#[test]
fn a_shuffled_mesh_is_saved_as_listed_and_resumes_exactly() {
    let ([_, mixed], _) = meshes();
    let level = with(&mixed, "stretch: (1.1, 1),", "substeps: 2, integrator: Bdf2(),");
    let [mut whole, mut half] = [simulation(&level), simulation(&level)];
    whole.advance(5, &mut || true);
    half.advance(3, &mut || true);
    let positions: Vec<_> = half.saved().unwrap().positions.iter().flat_map(|point| point.coordinates()).collect();
    assert_eq!(positions, listed(&half)[0]);
    let mut rest = reopened(&half, &level);
    assert_eq!(rest.state(), half.state());
    rest.advance(2, &mut || true);
    assert_eq!(rest.state(), whole.state());
}

#[test]
fn a_pin_set_by_hand_is_written_with_the_number_of_the_file() {
    let ([_, mixed], _) = meshes();
    let mut sandbox = Sandbox::new(with(&mixed, "pins: [Vertex(40)],", ""), Box::new(NoFiles)).unwrap();
    let scene = sandbox.simulation().scene();
    let vertex = (0..scene.rest.len() / 2).find(|vertex| scene.owner_of(*vertex).unwrap().1 == 7).unwrap();
    assert_ne!(vertex, 7);
    sandbox.apply(Command::TogglePin(vertex)).unwrap();
    assert_eq!(sandbox.saved().bodies[0].pins, [Pin::Vertex(7), Pin::Vertex(40)]);
    let scene = sandbox.simulation().scene();
    assert!(scene.pins.contains(&(vertex as u32)), "and it is the one that was meant");
    // Another mesh: what was pinned by number is pinned by place.
    let other = MeshKind::all().swap_remove(1);
    let place = |name: usize| scene.listed(&scene.rest)[2 * name..2 * name + 2].to_vec();
    let places = [place(7), place(40)];
    sandbox.apply(Command::SetMesh(0, other)).unwrap();
    let pins = sandbox.saved().bodies[0].pins.clone();
    let now = pins.iter().map(|pin| match pin {
        Pin::Nearest(point) => point.get().to_vec(),
        _ => Vec::new(),
    });
    assert_eq!(now.collect::<Vec<_>>(), places);
}

#[test]
fn a_fault_names_the_triangle_as_the_file_does() {
    let ([_, mixed], _) = meshes();
    let mut run = simulation(&with(&mixed, "stretch: (1.2, 1),", "substeps: 1,"));
    run.advance(1000, &mut || true);
    let gingerbread::fault::Culprit::Triangle { number, volume_ratio, .. } = run.fault().unwrap().culprit else {
        unreachable!()
    };
    let MeshKind::Points(points) = &with(&mixed, "", "").bodies[0].mesh else { unreachable!() };
    let (a, b, c) = points.triangles[number];
    let [x, _] = listed(&run);
    let rest: Vec<_> = points.points.iter().flat_map(|point| point.get()).collect();
    let area = |x: &[f64]| {
        let [a, b, c] = [a, b, c].map(|vertex| [x[2 * vertex as usize], x[2 * vertex as usize + 1]]);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    assert!((area(&x) / area(&rest) - volume_ratio).abs() < 1e-9 * volume_ratio.abs(), "{volume_ratio}");
}

/// Its particles keep their numbers.
#[test]
fn a_shuffled_net_moves_as_the_ordered_one_does() {
    let row = SIDE + 1;
    let points: Vec<_> = (0..row * row).map(|i| [i % row, i / row].map(|k| f64::from(k) / f64::from(SIDE))).collect();
    let along = |i: u32| (i % row < SIDE).then_some([i, i + 1]);
    let up = |i: u32| (i / row < SIDE).then_some([i, i + row]);
    let links: Vec<_> = (0..row * row).flat_map(|i| along(i).into_iter().chain(up(i))).collect();
    let (names, order) = (shuffled(points.len(), 5), shuffled(links.len(), 6));
    let mut mixed = points.clone();
    names.iter().zip(&points).for_each(|(name, point)| mixed[*name as usize] = *point);
    let renamed: Vec<_> = order.iter().map(|i| links[*i as usize].map(|end| names[end as usize])).collect();
    let net = |points: &[[f64; 2]], links: &[[u32; 2]], pin: u32| {
        let mut text = String::from(
            "(name: \"net\", substeps: 20, effects: [(effect: Gravity(down: 1))], nets: [(name: \"net\", mass: 0.001, net: Links(points: [",
        );
        text += &list(points, |[x, y]| format!("({x:?}, {y:?})"));
        text += "], springs: [";
        text += &list(links, |[a, b]| format!("({a}, {b}, 10, 0.019)"));
        simulation(&level(&format!("{text}]), pins: [Vertex({pin})])])")))
    };
    let [mut one, mut other] = [net(&points, &links, 3), net(&mixed, &renamed, names[3])];
    assert!(one.scene().nets[0].numbering.is_as_listed() && !other.scene().nets[0].numbering.is_as_listed());
    for run in [&mut one, &mut other] {
        assert_eq!(run.advance(200, &mut || true), 200);
    }
    let apart = greatest_difference(&listed(&one)[0], &names, &listed(&other)[0]);
    assert!(apart < 1e-9, "{apart}");
    let pin = other.scene().pins[0] as usize;
    assert_eq!(other.scene().owner_of(pin).map(|(_, name)| name as u32), Some(names[3]));
}

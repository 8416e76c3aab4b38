//! Facts about obstacles whose surface a file holds.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{greatest_gap, level};
use gingerbread::{
    effects::EffectKind,
    files,
    integrators::IntegratorKind,
    level::{Level, Sleep},
    meshes::{Files, MeshKind, Obj, SurfaceMesh},
    obstacles::Surfaces,
    scene::Scene,
    simulation::Simulation,
};
use std::path::Path;

/// A box of 0.3 m x 0.2 m x 0.25 m about the origin.
const BOX: &str = "v -0.15 -0.1 -0.125\nv 0.15 -0.1 -0.125\nv 0.15 0.1 -0.125\nv -0.15 0.1 -0.125
v -0.15 -0.1 0.125\nv 0.15 -0.1 0.125\nv 0.15 0.1 0.125\nv -0.15 0.1 0.125
f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

struct Memory(String);

impl Files for Memory {
    fn read(&self, _: &Path) -> Result<String, String> {
        Ok(self.0.clone())
    }
}

const SURFACE: &str = "Surface(path: \"box.obj\", offset: (0.2, -0.11, 0.2), eps: 0.01)";
const BLOCK: &str = "Block(centre: (0.2, -0.11, 0.2), width: 0.3, height: 0.2, depth: 0.25, eps: 0.01)";

/// A flat membrane of 0.4 m over an obstacle.
fn over(obstacle: &str) -> Level {
    level(&format!(
        "(name: \"\", membranes: [(name: \"cloth\", mesh: Rectangle(width: 0.4, height: 0.4, columns: 6, rows: 6, diagonals: Alternating, corner: (0, 0)),
        material: (model: NeoHookean, young: 20000, poisson: 0.3, plane: Stress), thickness: 0.01, mass: Density(100), space: (turn: (90, 0, 0), offset: (0, 0.03, 0)))],
        effects: [(effect: Gravity(down: 2)), (effect: Friction(coefficient: 0.5)), (effect: Walls(obstacles: [{obstacle}]))])"
    ))
}

/// Positions after some steps of 1 ms, and whether anything touched.
fn run(obstacle: &str, kind: &IntegratorKind, steps: u64) -> (Vec<f64>, bool) {
    let level = Level { integrator: kind.clone(), ..over(obstacle) };
    let scene = Scene::build(&level, level.mode, &Memory(BOX.to_owned()), None).unwrap();
    let mut run = Simulation::open(Scene { step: 1e-3, sleep: Sleep::Off, ..scene }, &level, level.mode).unwrap();
    let mut touched = false;
    for _ in 0..steps {
        run.advance(1, &mut || true);
        touched |= run.energies().contact > 0.0;
    }
    assert!(run.fault().is_none(), "{}: {:?}", kind.name(), run.fault());
    (run.state().x.clone(), touched)
}

/// A box from a file has the distances and the normals of a block, inside and outside.
#[test]
fn a_box_from_a_file_is_a_block() {
    let surfaces = Surfaces::read([Path::new("box.obj")], &Memory(BOX.to_owned()), None);
    let of = |text: &str| match over(text).effects.pop().unwrap().effect {
        EffectKind::Walls(walls) => walls.obstacles[0].clone(),
        other => unreachable!("{other:?}"),
    };
    let [one, other] = [SURFACE, BLOCK].map(|text| of(text).kind().build_in_space(&surfaces).unwrap());
    let mut found = 0;
    for number in 0..4000 {
        let place = |axis: usize, size: f64| size * (f64::from(number * 7919 % [997, 991, 983][axis]) / 500.0 - 1.0);
        let point = [0.2 + place(0, 0.2), -0.11 + place(1, 0.15), 0.2 + place(2, 0.18)];
        let [a, b] = [&one, &other].map(|obstacle| obstacle.distance(point, 0.1));
        assert_eq!(a.is_some(), b.is_some(), "{point:?}");
        let (Some(a), Some(b)) = (a, b) else { continue };
        assert!((a.distance - b.distance).abs() < 1e-12, "{point:?}: {} {}", a.distance, b.distance);
        // Where several faces are as near, any of their normals will do.
        let along: f64 = (0..3).map(|axis| a.normal[axis] * b.normal[axis]).sum();
        found += usize::from((along - 1.0).abs() < 1e-9);
    }
    assert!(found > 1500, "{found}");
    let mesh = surfaces.get(Path::new("box.obj")).unwrap();
    assert!((mesh.volume() - 0.3 * 0.2 * 0.25).abs() < 1e-15);
}

#[test]
fn cloth_falls_on_it_as_on_a_block_under_every_scheme() {
    for kind in IntegratorKind::all() {
        let [(one, touched), (other, _)] = [SURFACE, BLOCK].map(|obstacle| run(obstacle, &kind, 250));
        let gap = greatest_gap(&one, &other);
        // The linearly implicit scheme solves a step again above a bound of its error, and round-off decides near that.
        let most = if kind.name() == "LinearlyImplicitEuler" { 1e-4 } else { 1e-7 };
        assert!(touched && gap < most, "{}: {touched}, {gap} m", kind.name());
    }
}

/// A box whose faces run the other way is turned; one that is open, has a face turned, or names a vertex that is not there, is refused with
/// the line.
#[test]
fn wrong_surfaces_are_refused_with_their_line() {
    let read = |text: &str| SurfaceMesh::read(Path::new("box.obj"), &Memory(text.to_owned()));
    let turned: String = BOX
        .lines()
        .map(|line| match line.strip_prefix("f ") {
            Some(corners) => format!("f {}\n", corners.split(' ').rev().collect::<Vec<_>>().join(" ")),
            None => format!("{line}\n"),
        })
        .collect();
    assert!(read(&turned).unwrap().volume() > 0.0);
    for (text, words) in [
        (BOX.replace("f 4 1 5 8\n", ""), "box.obj, line 9: the side between the vertices"),
        (BOX.replace("f 4 1 5 8", "f 8 5 1 4"), "box.obj, line 14: the side from vertex"),
        (BOX.replace("f 4 1 5 8", "f 4 1 5 9"), "vertex 9 is not there; expected 1 to 8"),
        (BOX.replace("f 4 1 5 8", "f 4 1"), "at least 3 corners"),
        (BOX.replace("v 0.15 0.1 0.125", "v 0.15 nan 0.125"), "expected `v x y z` with finite numbers"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 3 2\n".to_owned(), "it lies on itself"),
        (String::new(), "the file has no face"),
    ] {
        let error = read(&text).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    let level = over(SURFACE);
    let error = Scene::build(&level, level.mode, &Memory("f 1 2 3".to_owned()), None).err().unwrap().to_string();
    assert!(error.contains("obstacle 0 (Surface)") && error.contains("box.obj, line 1"), "{error}");
}

/// A saved level names the files of obstacles and membranes as seen from where it is saved.
#[test]
fn paths_of_surfaces_and_membranes_follow_the_level() {
    let folder = std::env::temp_dir();
    let mut level = over(SURFACE);
    level.membranes[0].mesh = MeshKind::Obj(Obj { path: "cloth.obj".into() });
    for path in level.mesh_paths_mut() {
        *path = folder.join("meshes").join(&*path);
    }
    let text = files::text_at(&folder.join("level.ron"), &level).unwrap();
    for name in ["meshes/box.obj", "meshes/cloth.obj"] {
        assert!(text.contains(&format!("\"{name}\"")), "{text}");
    }
    assert_eq!(files::mesh_paths(&level).len(), 2);
}

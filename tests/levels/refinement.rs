//! Meshes that are refined by bisection.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a failing test should panic")]

use crate::common::Random;
use gingerbread::meshes::{Disk, Mesh, MeshKind, NoFiles, Refined};
use std::f64::consts::TAU;

fn kind(text: &str) -> MeshKind {
    let options = ron::Options::default().with_default_extension(ron::extensions::Extensions::UNWRAP_VARIANT_NEWTYPES);
    options.from_str(text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn build(kind: &MeshKind) -> Mesh {
    kind.kind().build(&NoFiles).unwrap()
}

fn perimeter(mesh: &Mesh) -> f64 {
    let length = |[a, b]: [u32; 2]| {
        let [a, b] = [a, b].map(|vertex| mesh.points()[vertex as usize]);
        (a[0] - b[0]).hypot(a[1] - b[1])
    };
    mesh.boundary_edges().into_iter().map(length).sum()
}

/// Four rounds of a fifth of all triangles, chosen at random.
fn divided(source: &MeshKind, random: &mut Random) -> Vec<MeshKind> {
    let mut all = vec![source.clone()];
    for _ in 0..4 {
        let last = all[all.len() - 1].clone();
        let count = build(&last).triangles().len() as u32;
        let chosen = (0..count).filter(|_| random.between(0.0, 1.0) < 0.2).collect();
        all.push(Refined::of(last, chosen).into());
    }
    all
}

/// No vertex lies on the side of a triangle: the boundary is as long as that of the rectangle. Angles stay at least half as large.
#[test]
fn a_mesh_stays_whole_wherever_it_is_refined() {
    let mut random = Random(1);
    let cuts = ["Grid", "Alternating", "Crossed"].map(|cut| {
        format!("Rectangle(width: 0.6, height: 0.35, columns: 7, rows: 3, diagonals: {cut}, corner: (0.1, 0.2))")
    });
    let hole = "Outline(points: [(0, 0), (1, 0), (1, 1), (0, 1)], holes: [[(0.4, 0.4), (0.6, 0.4), (0.5, 0.6)]], resolution: 150)";
    for text in cuts.iter().map(String::as_str).chain([hole]) {
        let all = divided(&kind(text), &mut random);
        let first = build(&all[0]);
        for pair in all.windows(2) {
            let [before, mesh] = [build(&pair[0]), build(&pair[1])];
            let MeshKind::Refined(recipe) = &pair[1] else { unreachable!("it is refined") };
            let chosen = recipe.rounds[recipe.rounds.len() - 1].len();
            assert!(mesh.triangles().len() >= before.triangles().len() + 3 * chosen, "{text}");
            assert_eq!(&mesh.points()[..before.points().len()], before.points(), "vertices keep their numbers");
            assert!((mesh.area() / first.area() - 1.0).abs() < 1e-12, "{text}: {}", mesh.area());
            assert!((perimeter(&mesh) / perimeter(&first) - 1.0).abs() < 1e-12, "{text}");
            assert_eq!(mesh.boundary_loops().len(), first.boundary_loops().len());
            assert!(mesh.min_angle() > 0.49 * first.min_angle(), "{text}: {}°", mesh.min_angle());
            assert_eq!(mesh.messages(), first.messages());
        }
    }
}

/// Each triangle of the list is gone; its parts are a quarter as large.
#[test]
fn listed_triangles_are_divided_into_four() {
    let source = kind("Gingerbread(resolution: 200)");
    let before = build(&source);
    let chosen = vec![3, 77, 130];
    let after = build(&Refined::of(source, chosen.clone()).into());
    let area = |mesh: &Mesh, triangle: usize| {
        let [a, b, c] = mesh.corners(triangle);
        0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
    };
    for triangle in chosen {
        let [a, b, c] = before.corners(triangle as usize);
        let middle = [0, 1].map(|axis| (a[axis] + b[axis] + c[axis]) / 3.0 + 1e-5);
        let (part, _) = after.locate(middle).unwrap();
        let ratio = area(&after, part) / area(&before, triangle as usize);
        assert!((ratio - 0.25).abs() < 0.02, "{triangle}: {ratio}");
        assert!(!after.triangles().contains(&before.triangles()[triangle as usize]));
    }
    // Icing stays where it was.
    let flat = |mesh: &Mesh| mesh.points().iter().flatten().copied().collect::<Vec<_>>();
    let [old_points, new_points] = [flat(&before), flat(&after)];
    for (old, new) in before.icing().iter().zip(after.icing()) {
        let old = old.positions(before.triangles(), &old_points);
        let new = new.positions(after.triangles(), &new_points);
        assert!(old.zip(new).all(|([x, y], [u, v])| (x - u).hypot(y - v) < 1e-12));
    }
}

/// The area of a coarse disk comes nearer to that of the circle, as new vertices of its boundary are on it.
#[test]
fn new_vertices_lie_on_the_true_outline() {
    let disk = Disk { rings: ron::from_str("2").unwrap(), ..Disk::default() };
    let (radius, [x, y]) = (disk.radius.get(), disk.centre.get());
    let mut mesh = build(&disk.clone().into());
    let mut refined = MeshKind::from(disk);
    for _ in 0..3 {
        refined = Refined::of(refined, (0..mesh.triangles().len() as u32).collect()).into();
        mesh = build(&refined);
    }
    let outer: Vec<_> = mesh.boundary_loops()[0].iter().map(|vertex| mesh.points()[*vertex as usize]).collect();
    assert_eq!(outer.len(), 8 * 12);
    assert!(outer.iter().all(|point| ((point[0] - x).hypot(point[1] - y) - radius).abs() < 1e-15));
    let polygon = 0.5 * 96.0 * radius * radius * (TAU / 96.0).sin();
    assert!((mesh.area() / polygon - 1.0).abs() < 1e-3, "{} {polygon}", mesh.area());
    // Triangles that are larger than the sides of a hole cut its corners; finer ones follow it again.
    let sides = 48_u8;
    let corner = |i: u8| TAU * f64::from(i) / f64::from(sides);
    let hole: Vec<_> =
        (0..sides).map(|i| format!("({}, {})", 0.5 + 0.2 * corner(i).cos(), 0.5 + 0.2 * corner(i).sin())).collect();
    let holed = kind(&format!(
        "Outline(points: [(0, 0), (1, 0), (1, 1), (0, 1)], holes: [[{}]], resolution: 120)",
        hole.join(", ")
    ));
    let exact = 1.0 - 0.5 * f64::from(sides) * 0.04 * corner(1).sin();
    let coarse = build(&holed);
    let mut finer = holed;
    for _ in 0..3 {
        finer = Refined::of(finer.clone(), (0..build(&finer).triangles().len() as u32).collect()).into();
    }
    let [before, after] = [coarse.area(), build(&finer).area()].map(|area| (area / exact - 1.0).abs());
    assert!(before > 1e-3 && after < 0.1 * before, "{before} {after}");
    // Vertices that cannot reach the outline in one round, as triangles are too flat, stay on their edges, and no triangle turns over.
    for resolution in [100, 300, 600] {
        let mut man = kind(&format!("Gingerbread(resolution: {resolution})"));
        let first = build(&man).min_angle();
        for _ in 0..4 {
            man = Refined::of(man.clone(), (0..build(&man).triangles().len() as u32).collect()).into();
            let mesh = build(&man);
            assert!(mesh.min_angle() > 0.03 * first, "{resolution}: {}°", mesh.min_angle());
            // What is turned over would be counted twice in the sum of the areas.
            let outline: Vec<_> =
                mesh.boundary_loops()[0].iter().map(|vertex| mesh.points()[*vertex as usize]).collect();
            let pairs = outline.iter().zip(outline.iter().cycle().skip(1));
            let within: f64 = pairs.map(|([x, y], [u, v])| 0.5 * (x * v - u * y)).sum();
            assert!((mesh.area() / within - 1.0).abs() < 1e-12, "{resolution}: {} {within}", mesh.area());
        }
    }
    // The man's outline is a smooth curve.
    let man = kind("Gingerbread(resolution: 1000)");
    let fine = build(&kind("Gingerbread(resolution: 20000)")).area();
    let coarse = build(&man);
    let all = (0..coarse.triangles().len() as u32).collect();
    let error = |mesh: &Mesh| (mesh.area() / fine - 1.0).abs();
    let finer = build(&Refined::of(man, all).into());
    assert!(error(&finer) < 0.5 * error(&coarse), "{} {}", error(&finer), error(&coarse));
}

#[test]
fn refinement_that_cannot_be_is_refused_in_words() {
    let refused = |text: &str| kind(text).kind().build(&NoFiles).unwrap_err().to_string();
    let square = "Rectangle(width: 1, height: 1, columns: 1, rows: 1, diagonals: Grid)";
    let missing = refused(&format!("Refined(mesh: {square}, rounds: [[0], [17]])"));
    assert!(missing.contains("round 1") && missing.contains("triangle 17") && missing.contains("0 to "), "{missing}");
    let twice = refused(&format!("Refined(mesh: Refined(mesh: {square}, rounds: [[0]]), rounds: [[0]])"));
    assert!(twice.contains("one list"), "{twice}");
    let many = refused(&format!("Refined(mesh: {square}, rounds: [{}])", "[],".repeat(201)));
    assert!(many.contains("201 rounds"), "{many}");
}

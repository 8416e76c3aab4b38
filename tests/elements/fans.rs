//! Triangles are stepped two by two, and nobody can tell.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{Random, greatest_gap, level, models, one_by_one, simulation};
use gingerbread::{
    effects::Effect,
    elements::{Field, Triangles},
    level::Level,
    meshes::{Fan, Mesh},
};
use pulp::Arch;
use std::{collections::BTreeSet, sync::Arc};

const GRID: &str = "Rectangle(width: 2, height: 1, columns: 9, rows: 7, diagonals: Grid)";

/// One triangle; one without a neighbour between three others; one more than two; and meshes of all kinds.
const MESHES: [&str; 8] = [
    "Points(points: [(0, 0), (1, 0.1), (0.3, 0.8)], triangles: [(0, 1, 2)])",
    "Points(points: [(0, 0), (2, 0), (1, 2), (1, -1), (2, 1.5), (0, 1.5)], triangles: [(0, 1, 2), (0, 3, 1), (1, 4, 2), (2, 5, 0)])",
    "Points(points: [(0, 0), (1, 0), (0, 1), (1, 1), (0, 2)], triangles: [(0, 1, 2), (1, 3, 2), (2, 3, 4)])",
    GRID,
    "Rectangle(width: 1, height: 1, columns: 8, rows: 5, diagonals: Alternating)",
    "Rectangle(width: 1, height: 1, columns: 6, rows: 5, diagonals: Crossed)",
    "Disk(radius: 1, rings: 9)",
    "Gingerbread(resolution: 800)",
];

/// An odd number of triangles in no order: they and their vertices are numbered anew.
fn shuffled() -> String {
    let side = 60_u32;
    // These primes do not divide the numbers of vertices and of squares: everything comes once.
    let (vertices, name) = (side * side, |vertex: u32| vertex * 2053 % (side * side));
    let mut points = vec![(0, 0); vertices as usize];
    (0..vertices).for_each(|vertex| points[name(vertex) as usize] = (vertex % side, vertex / side));
    let squares = (side - 1) * (side - 1);
    let square = |number: u32| {
        let (row, column) = (number * 1999 % squares / (side - 1), number * 1999 % squares % (side - 1));
        let corner = row * side + column;
        let [a, b, c, d] = [corner, corner + 1, corner + side + 1, corner + side].map(name);
        [(a, b, c), (a, c, d)]
    };
    let mut triangles: Vec<_> = (0..squares).flat_map(square).collect();
    triangles.pop();
    format!("Points(points: {points:?}, triangles: {triangles:?})")
}

fn meshes() -> impl Iterator<Item = String> {
    MESHES.into_iter().map(str::to_owned).chain([shuffled()])
}

fn with(mesh: &str, model: &str) -> Level {
    level(&format!(
        "(name: \"\", bodies: [(name: \"\", mesh: {mesh}, mass: Density(1), material: (model: {model}, young: 100, poisson: 0.3))])"
    ))
}

fn mesh(text: &str) -> Arc<Mesh> {
    Arc::clone(&simulation(&with(text, "Corotated")).scene().bodies[0].mesh)
}

fn is_alone(fan: &&Fan) -> bool {
    fan.triangles().count() == 1
}

/// The two triangles of a fan share its second spoke.
#[test]
fn every_triangle_is_in_exactly_one_fan() {
    let turned = |[a, b, c]: [u32; 3]| BTreeSet::from([[a, b, c], [b, c, a], [c, a, b]]);
    for text in meshes() {
        let mesh = mesh(&text);
        let mut all: Vec<_> = mesh.fans().iter().flat_map(|fan| fan.triangles()).collect();
        all.sort_unstable();
        assert!(all.into_iter().eq(0..mesh.triangles().len() as u32), "{text}");
        assert!(mesh.fans().is_sorted_by_key(|fan| fan.0[0]), "{text}");
        for fan in mesh.fans() {
            let [middle, from, across, to] = fan.corners(mesh.triangles());
            let both = [[middle, from, across], [middle, across, to]];
            for (triangle, corners) in fan.triangles().zip(both) {
                assert_eq!(turned(mesh.triangles()[triangle as usize]), turned(corners), "{text} {fan:?}");
            }
        }
    }
}

#[test]
fn few_triangles_are_alone_and_none_beside_another() {
    for text in meshes() {
        let mesh = mesh(&text);
        let alone: Vec<_> = mesh.fans().iter().filter(is_alone).flat_map(|fan| fan.triangles()).collect();
        for one in &alone {
            for other in alone.iter().filter(|other| *other != one) {
                let [one, other] = [one, other].map(|triangle| mesh.triangles()[*triangle as usize]);
                assert!(one.iter().filter(|corner| other.contains(corner)).count() < 2, "{text}: {one:?} {other:?}");
            }
        }
        let all = mesh.triangles().len();
        assert!(all < 5 || 200 * alone.len() <= all, "{text}: {} of {all}", alone.len());
    }
}

#[test]
fn meshes_in_no_order_are_put_in_order_with_their_fans() {
    let mesh = mesh(&shuffled());
    assert!(!mesh.numbering().is_as_listed() && mesh.fans().iter().filter(is_alone).count() == 1);
    let of_fans: Vec<_> = mesh.fans().iter().flat_map(|fan| fan.triangles()).collect();
    assert!(of_fans.is_sorted(), "those of a fan follow each other");
}

#[test]
fn the_fans_of_a_grid_are_its_cells() {
    let mesh = mesh(GRID);
    assert_eq!(mesh.fans().len(), 9 * 7);
    for (cell, fan) in mesh.fans().iter().enumerate() {
        let corner = (cell / 9 * 10 + cell % 9) as u32;
        let corners = BTreeSet::from(fan.corners(mesh.triangles()));
        assert_eq!(corners, BTreeSet::from([corner, corner + 1, corner + 10, corner + 11]), "{cell}");
    }
}

#[test]
fn fan_forces_and_energy_match_single_triangles() {
    for (text, model) in meshes().flat_map(|text| models().map(move |model| (text.clone(), model))) {
        let simulation = simulation(&with(&text, model));
        let elements = &simulation.scene().bodies[0].elements;
        let mut random = Random(1);
        let x: Vec<_> = simulation.scene().rest.iter().map(|x| 1.1 * x + random.between(-1e-3, 1e-3)).collect();
        let (energy, expected) = one_by_one(&simulation, &x);
        let forces_of = |elements: &Triangles| {
            let (mut scratch, mut force) = (vec![f64::NAN; elements.scratch()], vec![0.0; x.len()]);
            elements.elastic_force(&x, &mut scratch, &mut force);
            force
        };
        let force = forces_of(elements);
        assert!(force.iter().all(|force| force.is_finite()), "{model} {text}: what was in scratch is of no matter");
        assert!(forces_of(&elements.in_set(Arch::Scalar)) == force, "{model} {text}: one at a time");
        let error = greatest_gap(&force, &expected);
        let scale = expected.iter().fold(0.0, |most: f64, force| most.max(force.abs()));
        assert!(error < 1e-13 * scale, "{model} {text}: {error:e} of {scale:e}");
        let found = elements.elastic_energy(&x);
        assert!((found - energy).abs() < 1e-13 * energy, "{model} {text}: {found} against {energy}");
        let mut values = vec![0.5];
        let surveyed = [Field::None, Field::Volume].map(|field| elements.diagnose(field, &x, &mut values).energy);
        assert_eq!(surveyed, [found; 2], "{model} {text}: what is drawn knows the same energy");
        assert!(values.len() == 1 + elements.corners().len() && values[0] == 0.5, "{model} {text}");
    }
}

//! Facts about the exact test of cloth that has passed through itself.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a failing test should panic")]

use crate::common::{Random, level, simulation};
use gingerbread::contact::{ClothSurface, segment_meets_triangle};

/// Six times the volume of a tetrahedron with whole numbers as coordinates.
fn volume([a, b, c, d]: [[i64; 3]; 4]) -> i64 {
    let [u, v, w] = [b, c, d].map(|point| [0, 1, 2].map(|axis| point[axis] - a[axis]));
    u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0])
}

/// Against whole-number arithmetic, on a small grid where points often lie in the planes and on the edges of others.
#[test]
fn segments_and_triangles_meet_as_whole_numbers_say() {
    let mut random = Random(3);
    let (mut meeting, mut apart) = (0, 0);
    for _ in 0..20_000 {
        let [p, q, a, b, c] = [(); 5].map(|()| [(); 3].map(|()| random.between(-4.0, 4.0).round() as i64));
        let (above, below) = (volume([a, b, c, p]), volume([a, b, c, q]));
        if above == 0 && below == 0 {
            continue;
        }
        let sides = [volume([p, q, a, b]), volume([p, q, b, c]), volume([p, q, c, a])];
        let passes = sides.iter().all(|side| *side >= 0) || sides.iter().all(|side| *side <= 0);
        let expected = above.signum() * below.signum() <= 0 && passes;
        // Quarters are exact too.
        let [p, q, a, b, c] = [p, q, a, b, c].map(|point| point.map(|number| number as f64 * 0.25));
        assert_eq!(segment_meets_triangle([p, q], [a, b, c]), expected, "{p:?} {q:?} {a:?} {b:?} {c:?}");
        if expected { meeting += 1 } else { apart += 1 }
    }
    assert!(meeting > 500 && apart > 500, "{meeting} {apart}");
}

#[test]
fn segments_in_the_plane_of_a_triangle_are_told_apart() {
    let triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 1.0], [0.0, 1.0, 0.0]];
    let on = |x: f64, y: f64| [x, y, x];
    for (segment, expected) in [
        ([on(0.2, 0.2), on(0.3, 0.3)], true),
        ([on(-1.0, 0.5), on(2.0, 0.5)], true),
        ([on(0.6, 0.6), on(2.0, 2.0)], false),
        ([on(0.5, 0.5), on(2.0, 2.0)], true),
        ([on(-1.0, -0.1), on(2.0, -0.1)], false),
        ([on(1.0, 0.0), on(3.0, 0.0)], true),
    ] {
        assert_eq!(segment_meets_triangle(segment, triangle), expected, "{segment:?}");
    }
}

/// Two square sheets of n x n cells: one flat, one upright through it or beside it. An edge of one passes a triangle of the other.
#[test]
fn sheets_that_cross_are_counted_and_others_not() {
    let two = |x: f64, y: f64| {
        let sheet = |name: &str, place: &str| {
            format!(
                "(name: \"{name}\", mesh: Rectangle(width: 1, height: 1, columns: 9, rows: 9, diagonals: Alternating, corner: (-0.5, -0.5)),
                material: (model: NeoHookean, young: 1000, poisson: 0.3, plane: Stress), thickness: 0.01, mass: Density(100), space: ({place}))"
            )
        };
        let upright = format!("turn: (0, 90, 0), offset: ({x}, {y}, 0.013)");
        let text =
            format!("(name: \"\", membranes: [{}, {}])", sheet("flat", "turn: (90, 0, 0)"), sheet("upright", &upright));
        simulation(&level(&text)).count_cloth_crossings().unwrap()
    };
    assert_eq!(two(0.01, 0.6), 0, "above it");
    assert_eq!(two(0.7, 0.01), 0, "beside it");
    let crossing = two(0.01, 0.01);
    assert!(crossing > 15, "{crossing}");
    // Cloth that hangs and bends has no crossing.
    for name in ["toronto_cloth", "cornell_cloth", "mit_cloth"] {
        let mut run = simulation(&crate::common::built_in(name));
        run.advance(100, &mut || true);
        assert_eq!(run.count_cloth_crossings(), Some(0), "{name}");
    }
    assert_eq!(simulation(&crate::common::built_in("gingerbread")).count_cloth_crossings(), None);
}

/// The sweep finds what a comparison of all pairs finds.
#[test]
fn the_sweep_misses_nothing() {
    let mut random = Random(9);
    for count in [2, 10, 60] {
        let x: Vec<f64> = (0..9 * count).map(|_| random.between(0.0, 1.0)).collect();
        let triangles: Vec<[u32; 3]> =
            (0..count as u32).map(|first| [3 * first, 3 * first + 1, 3 * first + 2]).collect();
        let point = |vertex: u32| [0, 1, 2].map(|axis| x[3 * vertex as usize + axis]);
        let mut all = 0;
        for one in &triangles {
            for other in triangles.iter().filter(|other| *other != one) {
                let [a, b, c] = *other;
                let sides = [[a, b], [b, c], [c, a]];
                all += sides.iter().filter(|side| segment_meets_triangle(side.map(point), one.map(point))).count();
            }
        }
        assert_eq!(ClothSurface::new(triangles).count_crossings(&x), all);
        assert!(count < 60 || all > 100, "{all}");
    }
    assert_eq!(ClothSurface::new(vec![[0, 1, 2]]).count_crossings(&[f64::NAN; 9]), 1);
}

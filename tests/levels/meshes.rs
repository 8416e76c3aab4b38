//! What a user may rely on about meshes.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a failing test should panic")]

use crate::common::Random;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
    sync::LazyLock,
};

use gingerbread::meshes::{
    Diagonals, Disk, Files, Gingerbread, Mesh, MeshError, MeshKind, MeshSource, NoFiles, Numbering, Obj, Outline,
    Rectangle,
};
use proptest::{prelude::*, test_runner::RngSeed};

/// Files held in memory.
struct Memory(BTreeMap<&'static str, String>);

impl Files for Memory {
    fn read(&self, path: &Path) -> Result<String, String> {
        self.0.get(path.to_str().unwrap()).cloned().ok_or_else(|| "no such file".to_owned())
    }
}

fn kind(text: &str) -> MeshKind {
    parse(text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn parse(text: &str) -> Result<MeshKind, ron::error::SpannedError> {
    let options = ron::Options::default().with_default_extension(ron::extensions::Extensions::UNWRAP_VARIANT_NEWTYPES);
    options.from_str(text)
}

fn build(text: &str) -> Result<Mesh, MeshError> {
    kind(text).kind().build(&NoFiles)
}

fn refusal(text: &str) -> String {
    build(text).unwrap_err().to_string()
}

fn obj(text: &str) -> Result<Mesh, MeshError> {
    Obj { path: "a.obj".into() }.build(&Memory([("a.obj", text.to_owned())].into()))
}

fn gingerbread(resolution: u32) -> Mesh {
    build(&format!("Gingerbread(resolution: {resolution})")).unwrap()
}

fn flat(mesh: &Mesh) -> Vec<f64> {
    mesh.points().iter().flatten().copied().collect()
}

fn assert_counter_clockwise(mesh: &Mesh) {
    for triangle in 0..mesh.triangles().len() {
        let [a, b, c] = mesh.corners(triangle);
        assert!((b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0]), "triangle {triangle}");
    }
}

#[test]
fn every_kind_round_trips_and_is_counter_clockwise() {
    let files = Memory([("woody.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_owned())].into());
    for kind in MeshKind::all() {
        let text = ron::to_string(&kind).unwrap();
        assert_eq!(ron::from_str::<MeshKind>(&text).unwrap(), kind, "{text}");
        let mesh = kind.kind().build(&files).unwrap_or_else(|error| panic!("{}: {error}", kind.name()));
        assert_counter_clockwise(&mesh);
        assert_eq!(mesh.messages(), [""; 0], "{}", kind.name());
        assert_eq!(mesh, kind.kind().build(&files).unwrap(), "{} differs from run to run", kind.name());
    }
}

/// The number of triangles is within a tenth of the resolution, and no angle is below 25 degrees.
#[test]
fn gingerbread_meshes_meet_their_size_and_angle() {
    for resolution in [100, 137, 200, 500, 583, 1000, 2000, 2677, 5000, 8000, 20_000] {
        let mesh = gingerbread(resolution);
        let ratio = mesh.triangles().len() as f64 / f64::from(resolution);
        assert!((0.9..1.1).contains(&ratio), "{resolution}: {} triangles", mesh.triangles().len());
        assert!(mesh.min_angle() >= 25.0, "{resolution}: {}°", mesh.min_angle());
        assert_eq!(mesh.boundary_loops().len(), 1);
        assert_counter_clockwise(&mesh);
    }
}

#[test]
fn the_gingerbread_man_is_centred_and_symmetric() {
    let mesh = gingerbread(2000);
    let [low, high] = mesh.bounds();
    for (side, expected) in low.into_iter().chain(high).zip([0.22, 0.175, 0.78, 0.825]) {
        assert!((side - expected).abs() < 2e-3, "{low:?} {high:?}");
    }
    let outline: Vec<_> = mesh.boundary_loops()[0].iter().map(|&vertex| mesh.points()[vertex as usize]).collect();
    for [x, y] in &outline {
        assert!(outline.iter().any(|[u, v]| (1.0 - u - x).abs() < 1e-12 && (v - y).abs() < 1e-12), "({x}, {y})");
    }
}

#[test]
fn the_gingerbread_area_does_not_depend_on_resolution() {
    let areas = [500, 2000, 8000].map(|resolution| gingerbread(resolution).area());
    for area in areas {
        assert!((area / areas[2] - 1.0).abs() < 0.005, "{areas:?}");
    }
}

#[test]
fn icing_lies_on_the_body_and_follows_it() {
    let mesh = gingerbread(500);
    let rest = flat(&mesh);
    let turned: Vec<f64> = mesh.points().iter().flat_map(|[x, y]| [3.0 - 2.0 * y, 2.0 * x + 1.0]).collect();
    assert!(mesh.icing().len() >= 7);
    for stroke in mesh.icing() {
        assert!(stroke.points.iter().flat_map(|point| point.weights).all(|weight| weight > -1e-6));
        for ([x, y], [u, v]) in
            stroke.positions(mesh.triangles(), &rest).zip(stroke.positions(mesh.triangles(), &turned))
        {
            assert!((u - 3.0 + 2.0 * y).abs() < 1e-12 && (v - 2.0 * x - 1.0).abs() < 1e-12);
        }
    }
}

/// Divided into four, a mesh has the same vertices first and the same shape, and its icing lies where it was. Vertices have the same names in
/// whatever order the triangles are.
#[test]
fn a_refined_mesh_is_the_same_shape() {
    let mesh = gingerbread(500);
    let fine = mesh.refined().unwrap();
    assert_eq!(fine.triangles().len(), 4 * mesh.triangles().len());
    assert_eq!(&fine.points()[..mesh.points().len()], mesh.points());
    assert!((fine.area() / mesh.area() - 1.0).abs() < 1e-12);
    for (coarse, fine_stroke) in mesh.icing().iter().zip(fine.icing()) {
        assert!(fine_stroke.points.iter().flat_map(|point| point.weights).all(|weight| weight > -1e-6));
        let before = coarse.positions(mesh.triangles(), &flat(&mesh)).collect::<Vec<_>>();
        let after = fine_stroke.positions(fine.triangles(), &flat(&fine)).collect::<Vec<_>>();
        assert_eq!(before.len(), after.len());
        for ([x, y], [u, v]) in before.into_iter().zip(after) {
            assert!((x - u).abs() < 1e-14 && (y - v).abs() < 1e-14);
        }
    }
    let triangles = mesh.triangles().len() as u32;
    let names = (0..mesh.points().len() as u32).rev().collect();
    let turned = mesh.renumbered(Numbering::new(names, (0..triangles).rev().collect())).refined().unwrap();
    for (vertex, point) in turned.points().iter().enumerate() {
        assert_eq!(*point, fine.points()[turned.numbering().name(vertex as u32) as usize]);
    }
    for (triangle, corners) in turned.triangles().iter().enumerate() {
        let named = corners.map(|corner| turned.numbering().name(corner));
        assert_eq!(named, fine.triangles()[turned.numbering().element_name(triangle)]);
    }
}

#[test]
fn neighbours_in_the_plane_are_near_in_memory() {
    let mesh = gingerbread(8000);
    let spread = |corners: &[u32; 3]| f64::from(corners.iter().max().unwrap() - corners.iter().min().unwrap());
    let mut spreads: Vec<f64> = mesh.triangles().iter().map(spread).collect();
    spreads.sort_by(f64::total_cmp);
    assert!(spreads[spreads.len() / 2] < 32.0, "median {}", spreads[spreads.len() / 2]);
}

#[test]
fn crossed_cells_add_a_vertex_in_each_middle() {
    let strip =
        "Rectangle(width: 0.2375, height: 0.4875, columns: 19, rows: 39, diagonals: Crossed, corner: (0.375, 0))";
    let mesh = build(strip).unwrap();
    assert_eq!((mesh.points().len(), mesh.triangles().len()), (20 * 40 + 19 * 39, 4 * 19 * 39));
    assert_eq!(mesh.points()[19], [0.6125, 0.0]);
    assert_eq!(mesh.points()[799], [0.6125, 0.4875]);
    assert!((mesh.area() - 0.2375 * 0.4875).abs() < 1e-13);
    assert!((mesh.min_angle() - 45.0).abs() < 1e-9);
}

#[test]
fn the_corner_of_a_rectangle_is_the_origin_unless_it_is_given() {
    let mesh = build("Rectangle(width: 2, height: 1, columns: 2, rows: 1, diagonals: Grid)").unwrap();
    assert_eq!(mesh.bounds(), [[0.0, 0.0], [2.0, 1.0]]);
    assert_eq!(mesh.triangles(), [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]]);
    let alternating = Rectangle { diagonals: Diagonals::Alternating, ..Rectangle::default() };
    assert_eq!(alternating.build(&NoFiles).unwrap().triangles().len(), 400);
}

#[test]
fn a_disk_of_n_rings_has_six_n_squared_good_triangles() {
    for rings in [1, 2, 7, 40] {
        let mesh = build(&format!("Disk(radius: 0.3, rings: {rings})")).unwrap();
        assert_eq!(mesh.triangles().len(), 6 * rings * rings);
        assert_eq!(mesh.boundary_loops()[0].len(), 6 * rings);
        assert!(mesh.min_angle() > 35.0, "{rings}: {}", mesh.min_angle());
    }
    let area = std::f64::consts::PI * 0.25 * 0.25;
    let fine = Disk { rings: 100.0.try_into().unwrap(), ..Disk::default() }.build(&NoFiles).unwrap();
    assert!((fine.area() / area - 1.0).abs() < 1e-4);
}

#[test]
fn an_outline_keeps_corners_and_area_in_either_direction() {
    let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let mut backwards = square;
    backwards.reverse();
    for corners in [square, backwards] {
        let mesh = build(&format!("Outline(points: {}, resolution: 700)", ron::to_string(&corners.to_vec()).unwrap()))
            .unwrap();
        assert!((mesh.area() - 1.0).abs() < 1e-12);
        assert!(corners.iter().all(|&(x, y)| mesh.points().contains(&[x, y])));
        assert!(mesh.min_angle() >= 25.0 && (630..770).contains(&mesh.triangles().len()));
    }
}

/// A small angle is told.
#[test]
fn a_sharp_or_thin_outline_is_filled() {
    let spike = build("Outline(points: [(0, 0), (1, 0), (1, 0.2)], resolution: 300)").unwrap();
    assert!(spike.messages()[0].contains("11.3°"), "{:?} {}", spike.messages(), spike.min_angle());
    assert!((spike.area() - 0.1).abs() < 1e-12);
    let comb = "Outline(points: [(0, 0), (1, 0), (1, 1), (0.6, 1), (0.6, 0.02), (0.59, 0.02), (0.59, 1), (0, 1)], resolution: 100)";
    let comb = build(comb).unwrap();
    assert!(comb.min_angle() >= 25.0, "{}", comb.min_angle());
}

#[test]
fn an_outline_that_crosses_itself_is_refused_with_its_sides() {
    let bow = refusal("Outline(points: [(0, 0), (1, 1), (1, 0), (0, 1)])");
    assert!(bow.starts_with("sides 0 and 2 of the outline cross"), "{bow}");
    assert!(refusal("Outline(points: [(0, 0), (1, 1)])").contains("at least 3 points, got 2"));
    assert!(refusal("Outline(points: [(0, 0), (1, 0), (2, 0)])").contains("cross or touch"));
}

#[test]
fn what_cannot_be_a_body_is_refused_with_the_number_to_mend() {
    let cases = [
        ("[(0, 0), (1, 0), (0, 1)], triangles: []", "has no triangles"),
        ("[(0, 0), (1, 0), (0, 1)], triangles: [(0, 1, 3)]", "triangle 0 names vertex 3, but the last vertex is 2"),
        ("[], triangles: [(0, 0, 0)]", "triangle 0 names vertex 0"),
        ("[(0, 0), (1, 0), (0, 1)], triangles: [(0, 1, 2), (0, 1, 1)]", "triangle 1 (0, 1, 1) has no area"),
        ("[(0, 0), (1, 0), (2, 0)], triangles: [(0, 1, 2)]", "triangle 0 (0, 1, 2) has no area"),
        ("[(0, 0), (1, 0), (0, 1), (5, 5)], triangles: [(0, 1, 2)]", "no triangle uses vertex 3 (1 such in all)"),
        (
            "[(0, 0), (1, 0), (0, 1)], triangles: [(0, 1, 2), (0, 1, 2)]",
            "same side of the edge from vertex 0 to vertex 1",
        ),
        ("[(0, 0), (1, 0), (0, 1), (0, 2)], triangles: [(0, 1, 2), (1, 0, 3)]", "same side of the edge from vertex 0"),
        (
            "[(0, 0), (1, 0), (0, 1), (0, -1), (1, -1)], triangles: [(0, 1, 2), (1, 0, 3), (1, 0, 4)]",
            "3 triangles share the edge from vertex 0 to vertex 1",
        ),
        (
            "[(0, 0), (1, 0), (1, 1), (-1, 0), (-1, -1)], triangles: [(0, 1, 2), (0, 3, 4)]",
            "parts of the mesh touch only at vertex 0",
        ),
    ];
    for (text, expected) in cases {
        let message = refusal(&format!("Points(points: {text})"));
        assert!(message.contains(expected), "{text}: {message}");
    }
}

#[test]
fn what_is_mended_or_odd_is_told() {
    let turned = build("Points(points: [(0, 0), (1, 0), (1, 1), (0, 1)], triangles: [(0, 2, 1), (0, 2, 3)])").unwrap();
    assert_eq!(turned.messages(), ["1 triangle was clockwise and has been turned over"]);
    assert_eq!(turned.triangles(), [[0, 1, 2], [0, 2, 3]]);
    let crack =
        build("Points(points: [(0, 0), (1, 0), (1, 1), (0, 0), (1, 1), (0, 1)], triangles: [(0, 1, 2), (3, 4, 5)])");
    let crack = crack.unwrap();
    assert_eq!(crack.messages()[0], "the mesh is 2 separate pieces");
    assert!(crack.messages()[1].starts_with("vertices 0 and 3 lie at the same place (2 such in all)"), "{crack:?}");
}

#[test]
fn a_hole_makes_a_second_loop_that_runs_clockwise() {
    let ring = "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 0 3 0\nv 1 1 0\nv 2 1 0\nv 2 2 0\nv 1 2 0\n\
                f 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    assert_eq!(obj(ring).unwrap().boundary_loops(), [vec![0, 1, 2, 3], vec![4, 7, 6, 5]]);
}

#[test]
fn counts_outside_their_range_are_refused_with_the_range() {
    for (text, expected) in [
        ("Gingerbread(resolution: 99)", "number of triangles must be at least 100 and at most 2e5, got 99"),
        ("Gingerbread(resolution: 300.5)", "number of triangles must be a whole number, got 300.5"),
        ("Gingerbread(resolution: 300, colour: 3)", "colour"),
        ("Disk(radius: -1, rings: 3)", "radius must be greater than 0 and at most 1e9 m, got -1"),
        (
            "Rectangle(width: 1, height: 1, columns: 0, rows: 1)",
            "number of cells must be at least 1 and at most 1e6, got 0",
        ),
    ] {
        let message = parse(text).unwrap_err().to_string();
        assert!(message.contains(expected), "{text}: {message}");
    }
    let huge = refusal("Rectangle(width: 1, height: 1, columns: 1000000, rows: 1000000)");
    assert_eq!(huge, "the mesh would have 4000000000000 triangles; ask for at most 2000000");
}

#[test]
fn obj_files_are_read_in_all_their_spellings() {
    let text = "# a square\r\nmtllib none.mtl\r\no body\r\nv 0 0 0\r\nv 1.0 0 0 # corner\r\nv 1 1e0 0\r\nv 0 1 0 1.0\r\n\
                vn 0 0 1\r\nvt 0 0\r\ns off\r\nf 1/1/1 2//1 -2/1 4\r\n";
    let mesh = obj(text).unwrap();
    assert_eq!(mesh.points(), [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    assert_eq!((mesh.triangles().len(), mesh.area()), (2, 1.0));
    let arrow = "v 0 0 0\nv 2 -1 0\nv 1 0 0\nv 2 1 0\nf 1 2 3 4\n";
    assert_eq!(obj(arrow).unwrap().area(), 1.0, "a face with a dent is cut inside it");
    let clockwise = obj("v 0 0 7\nv 1 0 7\nv 0 1 7\nf 1 3 2\n").unwrap();
    assert_eq!(clockwise.messages(), ["1 triangle was clockwise and has been turned over"]);
}

#[test]
fn obj_errors_name_the_file_and_line_and_what_was_expected() {
    for (text, expected) in [
        ("v 0 zero 0\n", "a.obj, line 1: expected `v x y z` with finite numbers, got `zero`"),
        ("v 0 inf 0\n", "a.obj, line 1: expected `v x y z` with finite numbers, got `inf`"),
        ("\nv 0\n", "a.obj, line 2: expected `v x y z`, got 1 of the numbers"),
        ("v 0 0 0\nv 1 0 0\nf 1 2\n", "a.obj, line 3: expected `f a b c` with at least 3 corners, got 2"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "a.obj, line 4: vertex 4 is not there; expected 1 to 3"),
        ("v 0 0 0\nf 0 1 1\n", "a.obj, line 2: vertex 0 is not there"),
        ("v 0 0 0\nf 1 1 x\n", "a.obj, line 2: expected a vertex number such as `7`, `7/1` or `-1`, got `x`"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0.5\nf 1 2 3\n", "a.obj, line 3: z is 0.5, but 0 before; expected a flat mesh"),
        ("v 0 0 0\nv 1 0 0\nv 9 9 0\nv 0 1 0\nf 1 2 4\n", "a.obj, line 3: no triangle uses vertex 3"),
        ("v 0 0 0\nv 1 0 0\nv 2 0 0\n\nf 1 2 3\n", "a.obj, line 5: triangle 0 (1, 2, 3) has no area"),
        ("v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n", "a.obj, line 5: expected a face whose sides do not cross"),
        ("hello\n", "a.obj: the mesh has no triangles"),
    ] {
        let message = obj(text).unwrap_err().to_string();
        assert!(message.starts_with(expected), "{text}: {message}");
    }
    let missing = Obj { path: "b.obj".into() }.build(&NoFiles).unwrap_err().to_string();
    assert_eq!(missing, "b.obj: files cannot be read here");
}

proptest! {
    #![proptest_config(ProptestConfig {
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(1),
        ..ProptestConfig::default()
    })]

    /// A refusal names the file.
    #[test]
    fn no_text_makes_the_obj_reader_panic(
        lines in prop::collection::vec("(v|f|vt|#|)( (-?[0-9]{1,2}(\\.[0-9]|e[0-9]{1,3})?(/[0-9]?){0,2}|nan|inf|\\PC)){0,6}", 0..20),
        noise in "\\PC{0,80}",
    ) {
        for text in [lines.join("\n"), noise] {
            if let Err(error) = obj(&text) {
                prop_assert!(error.to_string().starts_with("a.obj"), "{error}");
            }
        }
    }

    /// Only an outline that crosses itself and a needle may be refused.
    #[test]
    fn any_simple_outline_is_filled(
        corners in prop::collection::vec((0.0..1.0, 0.0..1.0), 3..8),
    ) {
        let sides: Vec<_> = corners.iter().copied().zip(corners.iter().copied().cycle().skip(1)).collect();
        let area: f64 = sides.iter().map(|((ax, ay), (bx, by))| 0.5 * (ax * by - ay * bx)).sum::<f64>().abs();
        let perimeter: f64 = sides.iter().map(|((ax, ay), (bx, by))| f64::hypot(bx - ax, by - ay)).sum();
        match build(&format!("Outline(points: {}, resolution: 100)", ron::to_string(&corners).unwrap())) {
            Ok(mesh) => {
                prop_assert!((mesh.area() - area).abs() < 1e-9);
                prop_assert_eq!(mesh.boundary_loops().len(), 1);
            }
            Err(MeshError::Crossing { .. }) => {}
            Err(error) => prop_assert!(perimeter * perimeter > 200.0 * area, "{error}"),
        }
    }

    /// The weights of the nearest triangle give back a point outside, too.
    #[test]
    fn a_point_is_found_in_the_triangle_that_holds_it(x in 0.2..0.8, y in 0.1..0.9) {
        static FIR: LazyLock<Mesh> = LazyLock::new(|| Outline::default().build(&NoFiles).unwrap());
        let [exact, nearest] = [FIR.locate([x, y]), FIR.locate_nearest([x, y])];
        let holds = |triangle: &usize| {
            let corners = FIR.corners(*triangle);
            (0..3).all(|side| {
                let ([ax, ay], [bx, by]) = (corners[side], corners[(side + 1) % 3]);
                (bx - ax) * (y - ay) - (by - ay) * (x - ax) >= 0.0
            })
        };
        prop_assert_eq!(exact.map(|(triangle, _)| triangle), (0..FIR.triangles().len()).find(holds));
        if let Some((_, weights)) = exact {
            prop_assert!(weights.iter().all(|weight| *weight > -1e-8), "{weights:?}");
            prop_assert_eq!(exact, nearest);
        }
        let (triangle, weights) = nearest.unwrap();
        prop_assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-9);
        let corners = FIR.corners(triangle);
        for axis in 0..2 {
            let found: f64 = (0..3).map(|corner| weights[corner] * corners[corner][axis]).sum();
            prop_assert!((found - [x, y][axis]).abs() < 1e-9);
        }
    }
}

/// Vertices of no triangle are refused, so the same triangles are also tried with the vertices that they have.
#[test]
fn any_points_and_triangles_are_a_sound_mesh_or_an_error() {
    let (mut random, mut sound) = (Random(9), 0);
    let mut check = |points: Vec<[f64; 2]>, triangles: Vec<[u32; 3]>| match Mesh::new(points, triangles) {
        Ok(mesh) => {
            assert_counter_clockwise(&mesh);
            let on_loops: usize = mesh.boundary_loops().iter().map(Vec::len).sum();
            assert_eq!(on_loops, mesh.boundary_edges().len());
            sound += 1;
        }
        Err(error) => assert!(error.to_string().len() > 20, "{error}"),
    };
    for number in 0..2000 {
        let count = 3 + number % 4;
        let points: Vec<_> = (0..count).map(|_| [0; 2].map(|_| random.between(-2.0, 2.0))).collect();
        let triangles: Vec<_> = (0..=number % 3).map(|_| [0; 3].map(|_| random.between(0.0, 7.0) as usize)).collect();
        let listed = triangles.iter().map(|corners| corners.map(|corner| corner as u32)).collect();
        check(points.clone(), listed);
        let used: BTreeSet<_> = triangles.iter().flatten().map(|corner| corner % count).collect();
        let place = |corner: usize| used.iter().position(|vertex| *vertex == corner % count).unwrap() as u32;
        check(
            used.iter().map(|vertex| points[*vertex]).collect(),
            triangles.iter().map(|corners| corners.map(place)).collect(),
        );
    }
    assert!(sound > 100, "only {sound} were meshes");
}

#[test]
fn a_gingerbread_man_without_fields_has_about_2000_triangles() {
    assert_eq!(kind("Gingerbread()"), MeshKind::Gingerbread(Gingerbread::default()));
    let triangles = build("Gingerbread()").unwrap().triangles().len();
    assert!((1800..2200).contains(&triangles), "{triangles}");
}

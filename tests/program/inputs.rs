//! Input as people have it: it is read whatever program wrote it, or refused with its place and the remedy.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a failing test should panic")]

use crate::program::{Folder, gingerbread, said};
use gingerbread::{
    files::{self, Disk},
    level::{Level, RunMode},
    meshes::{Mesh, MeshSource, Outline, Points},
    quantity::Point,
    scene::Scene,
    simulation::Simulation,
};
use std::{fs, path::Path};

/// A square of two triangles, one after another.
const SQUARE: &str = "# ünit\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";

/// A level with a mesh.
fn level(mesh: &str) -> String {
    format!(
        "(name: \"Pfännchen\", bodies: [(name: \"b\", mesh: {mesh}, mass: Total(1), spin: 1,
            material: (model: Corotated, young: 1000, poisson: 0.3))], effects: [(effect: Gravity(down: 5))])"
    )
}

fn parsed(text: &str) -> Level {
    files::parse(text, "level.ron").unwrap()
}

/// The mesh of the first body of a level.
fn built(text: &str) -> Result<Mesh, String> {
    parsed(text).bodies[0].mesh.kind().build(&Disk).map_err(|error| error.to_string())
}

/// The mesh of an OBJ file with this text.
fn obj(folder: &Folder, text: &str) -> Result<Mesh, String> {
    let path = folder.file("mesh.obj");
    fs::write(&path, text).unwrap();
    built(&level(&format!("Obj(path: {path:?})")))
}

/// What a level's text is refused with.
fn refusal(text: &str) -> String {
    files::parse(text, "level.ron").unwrap_err().to_string()
}

fn utf16(text: &str, unit: fn(u16) -> [u8; 2]) -> Vec<u8> {
    text.encode_utf16().flat_map(unit).collect()
}

/// The same text as other programs write it; `latin` also as Latin-1.
fn spellings(text: &str, latin: bool) -> Vec<(&'static str, Vec<u8>)> {
    let marked = format!("\u{feff}{text}");
    let mut all = vec![
        ("UTF-8 with a byte-order mark", marked.clone().into_bytes()),
        ("CR LF", text.replace('\n', "\r\n").into_bytes()),
        ("CR", text.replace('\n', "\r").into_bytes()),
        ("UTF-16 LE with a mark", utf16(&marked, u16::to_le_bytes)),
        ("UTF-16 BE with a mark", utf16(&marked, u16::to_be_bytes)),
        ("UTF-16 LE", utf16(text, u16::to_le_bytes)),
        ("UTF-16 BE", utf16(text, u16::to_be_bytes)),
    ];
    if latin {
        all.push(("Latin-1", text.chars().map(|letter| u8::try_from(u32::from(letter)).unwrap()).collect()));
    }
    all
}

#[test]
fn byte_order_marks_line_ends_and_encodings_do_not_matter() {
    let folder = Folder::new("spellings");
    let text = level("Disk(radius: 0.2, rings: 3)").replace(", spin", ", // Pfännchen\n spin");
    for (name, bytes) in spellings(&text, true) {
        let path = folder.file("level.ron");
        fs::write(&path, bytes).unwrap();
        assert_eq!(files::read(Path::new(&path)).unwrap(), parsed(&text), "{name}");
    }
    let square = obj(&folder, SQUARE).unwrap();
    assert_eq!((square.points().len(), square.triangles().len()), (4, 2));
    for (name, bytes) in spellings(SQUARE, true) {
        let path = folder.file("mesh.obj");
        fs::write(&path, bytes).unwrap();
        assert_eq!(built(&level(&format!("Obj(path: {path:?})"))).unwrap(), square, "{name}");
    }
    // Text that never was in a file, such as what is pasted in a browser.
    for mark in ["\u{feff}", ""] {
        for end in ["\r\n", "\r"] {
            assert_eq!(parsed(&(mark.to_owned() + &text.replace('\n', end))), parsed(&text));
        }
    }
}

#[test]
fn obj_faces_may_continue_and_precede_their_vertices() {
    let folder = Folder::new("faces");
    let square = obj(&folder, SQUARE).unwrap();
    let vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    for text in [
        format!("{vertices}f 1 2 \\\n3\nf 1 \\\n 3 \\\n 4\n"),
        format!("f 1 2 3\nf 1 3 4\n{vertices}"),
        format!("f 1 2 3\n{vertices}f 1 3 4\n"),
        format!("{vertices}f -4 -3 -2\nf -4 -2 -1\n"),
        SQUARE.replace("v 1 0 0", "v 1 \\\n 0 0"),
        format!("f 1 2 \\ # a remark\n3\nf 1 3 4\n{vertices}").replace(" # a remark", ""),
    ] {
        assert_eq!(obj(&folder, &text).unwrap(), square, "{text}");
    }
    let missing = obj(&folder, "f 1 2 5\nv 0 0\nv 1 0\nv 0 1\n").unwrap_err();
    assert!(
        missing.contains("mesh.obj, line 1:")
            && missing.ends_with("expected 1 to 3")
            && missing.contains('5')
            && missing.contains('3'),
        "{missing}"
    );
    let before = obj(&folder, "f -1 -2 -3\nv 0 0\nv 1 0\nv 0 1\n").unwrap_err();
    assert!(before.contains("mesh.obj, line 1:"), "a number from the end counts from here: {before}");
}

/// An OBJ file of a rectangle with sides 2 and 1, each point put into space; faces turn as `reverse` says.
fn rectangle_in_space(place: impl Fn(f64, f64) -> [f64; 3], reverse: bool) -> String {
    let points = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)].map(|(x, y)| place(x, y));
    let vertices: Vec<_> = points.iter().map(|[x, y, z]| format!("v {x} {y} {z}")).collect();
    format!("{}\n{}\n", vertices.join("\n"), if reverse { "f 1 4 3 2" } else { "f 1 2 3 4" })
}

/// Puts a point of the plane into space.
type Plane = fn(f64, f64) -> [f64; 3];

#[test]
fn a_flat_mesh_in_any_plane_is_read_and_a_solid_refused() {
    let folder = Folder::new("planes");
    let planes: [(&str, Plane); 3] =
        [("x-y", |x, y| [x, y, 7.0]), ("x-z", |x, y| [x, -3.0, y]), ("y-z", |x, y| [0.5, x, y])];
    for (name, place) in planes {
        for reverse in [false, true] {
            let mesh = obj(&folder, &rectangle_in_space(place, reverse)).unwrap();
            let [low, high] = mesh.bounds();
            assert_eq!(([high[0] - low[0], high[1] - low[1]], mesh.area()), ([2.0, 1.0], 2.0), "{name}");
            let told = mesh.messages().iter().any(|message| message.contains(&format!("in its {name} plane")));
            assert_eq!(told, name != "x-y", "{name}: {:?}", mesh.messages());
        }
    }
    // The last printed digit of z is no thickness; a hundredth of the size is.
    let noisy = |size: f64| rectangle_in_space(move |x, y| [x, y, size * (x - y).signum()], false);
    let mesh = obj(&folder, &noisy(1e-6)).unwrap();
    assert!(mesh.messages().iter().any(|message| message.contains("z varies by")), "{:?}", mesh.messages());
    let solid = obj(&folder, &noisy(0.01)).unwrap_err();
    assert!(solid.contains("mesh.obj, line 4:") && solid.contains("expected a flat mesh"), "{solid}");
}

fn outline(points: &[[f64; 2]]) -> Outline {
    let points = points.iter().map(|point| Point::new(*point).unwrap()).collect();
    Outline { points, ..Outline::default() }
}

#[test]
fn a_closed_ring_and_repeated_points_are_the_same_outline() {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let plain = outline(&corners).build(&Disk).unwrap();
    let closed = outline(&[&corners[..], &corners[..1]].concat()).build(&Disk).unwrap();
    assert_eq!(closed, plain);
    let twice: Vec<_> = corners.iter().flat_map(|corner| [*corner; 2]).collect();
    let repeated = outline(&twice).build(&Disk).unwrap();
    assert_eq!((repeated.points(), repeated.triangles()), (plain.points(), plain.triangles()));
    assert!(repeated.messages().iter().any(|message| message.contains("merged")), "{:?}", repeated.messages());
    // The same for obstacles.
    let wall = |points: &str| {
        let walls = format!("effects: [(effect: Walls(obstacles: [Polygon(points: [{points}], eps: 0.01)]))]");
        let text = level("Disk(radius: 0.2, rings: 3)").replace("effects: [(effect: Gravity(down: 5))]", &walls);
        Scene::build(&parsed(&text), RunMode::Simulate, &Disk, None).map(|_| ()).map_err(|error| error.to_string())
    };
    assert_eq!(wall("(5, 5), (6, 5), (6, 6)"), Ok(()));
    assert_eq!(wall("(5, 5), (6, 5), (6, 6), (5, 5)"), Ok(()));
    assert_eq!(wall("(5, 5), (5, 5), (6, 5), (6, 6)"), Ok(()));
}

/// Steps a level for a while.
fn run(text: &str) -> Simulation {
    let level = parsed(text);
    let scene = Scene::build(&level, level.mode, &Disk, None).unwrap();
    let mut simulation = Simulation::open(scene, &level, level.mode).unwrap();
    simulation.advance(300, &mut || true);
    simulation
}

/// The body then runs.
#[test]
fn outline_points_far_below_the_mesh_size_are_merged() {
    for gap in [1e-15, 1e-12, 1e-9, 1e-7, 1e-6, 1e-5] {
        for near in [[gap, 0.0], [gap, 0.5 * gap], [-0.5 * gap, gap]] {
            let points = [[0.0, 0.0], near, [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
            let mesh = outline(&points).build(&Disk).unwrap();
            assert!(mesh.messages().iter().any(|message| message.contains("merged")), "{near:?}");
            assert!(mesh.min_angle() > 20.0, "{near:?}: {}", mesh.min_angle());
        }
    }
    let text = level("Outline(points: [(0, 0), (1e-12, 0), (1, 0), (1, 1), (0, 1)], resolution: 500)");
    let simulation = run(&text);
    assert_eq!(simulation.fault(), None);
    assert!((simulation.state().time - 300.0 * simulation.scene().step).abs() < 1e-9);
}

#[test]
fn an_outline_with_a_very_sharp_corner_is_filled() {
    let corners = [
        [0.756_304_796_750_995, 0.0],
        [0.598_664_134_486_062_6, 0.903_502_464_774_371_5],
        [0.0, 0.664_698_063_041_535_8],
    ];
    let mesh =
        outline(&[&corners[..], &[[0.264_790_369_032_814_33, 0.770_058_829_878_999_4]]].concat()).build(&Disk).unwrap();
    assert!(mesh.messages().iter().any(|message| message.contains("sharp corners")), "{:?}", mesh.messages());
}

#[test]
fn mesh_vertices_far_below_the_mesh_size_are_named() {
    let folder = Folder::new("near");
    for gap in [1e-12, 1e-9, 1e-7, 1e-6, 1e-5] {
        // A square with a needle along its lower side.
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [gap, -gap]];
        let points = points.map(|point| Point::new(point).unwrap()).to_vec();
        let mesh = Points { points, triangles: vec![(0, 1, 2), (0, 2, 3), (0, 4, 1)] };
        let told = mesh.build(&Disk).unwrap_err().to_string();
        assert!(told.contains("vertices 0 and 4 of triangle 2") && told.contains("apart"), "{told}");
        let told = obj(&folder, &format!("{SQUARE}v {gap} -{gap} 0\nf 1 5 2\n")).unwrap_err();
        assert!(told.contains("mesh.obj, line 9: vertices 1 and 5"), "{told}");
    }
    // Two vertices at about the same place without a triangle between them leave a crack, which is told.
    let crack = "v 0 0\nv 1 0\nv 0 1\nv 1.0000001 0\nv 1 1\nv 0.0000001 1\nf 1 2 3\nf 4 5 6\n";
    let mesh = obj(&folder, crack).unwrap();
    assert!(
        mesh.messages()
            .iter()
            .any(|message| message.contains("vertices 2 and 4 lie at the same place (2 such in all)"))
    );
}

#[test]
fn ron_brackets_around_a_single_value_are_optional() {
    let plain = parsed(&level("Disk(radius: 0.2, rings: 5)"));
    for mesh in ["Disk((radius: 0.2, rings: 5))", "Disk(Disk(radius: 0.2, rings: 5))", "Disk((radius: 0.2, rings: 5),)"]
    {
        assert_eq!(parsed(&level(mesh)), plain, "{mesh}");
    }
    // Elsewhere too, and in every built-in level.
    let both = level("Disk((radius: 0.2, rings: 5))").replace("Gravity(down: 5)", "Gravity((down: 5))");
    assert_eq!(parsed(&both.replace("mass: Total(1)", "mass: Total((1))")), plain);
    // A mistake within is told at its place.
    let wrong = refusal(&level("Disk((radius: -1, rings: 5))"));
    assert!(wrong.contains("radius") && wrong.starts_with("level.ron:1:"), "{wrong}");
}

#[test]
fn paths_may_have_backslashes_and_folders_no_utf_8() {
    let folder = Folder::new("paths");
    fs::create_dir(folder.file("meshes")).unwrap();
    fs::write(folder.file("meshes/new.obj"), SQUARE).unwrap();
    for path in ["meshes\\new.obj", "meshes\\\\new.obj", ".\\meshes\\new.obj", "meshes/new.obj"] {
        let file = folder.with("level.ron", &level(&format!("Obj(path: \"{path}\")")));
        let read = files::read(Path::new(&file)).unwrap();
        assert_eq!(read.bodies[0].mesh.kind().build(&Disk).unwrap().triangles().len(), 2, "{path}");
    }
    #[cfg(target_os = "linux")]
    {
        use std::os::unix::ffi::OsStrExt as _;
        let odd = Path::new(&folder.file("")).join(std::ffi::OsStr::from_bytes(b"f\xfcr"));
        fs::create_dir(&odd).unwrap();
        fs::write(odd.join("square.obj"), SQUARE).unwrap();
        fs::write(odd.join("level.ron"), level("Obj(path: \"square.obj\")")).unwrap();
        let read = files::read(&odd.join("level.ron")).unwrap();
        assert_eq!(read.bodies[0].mesh.kind().build(&Disk).unwrap().triangles().len(), 2);
        files::save(&odd.join("again.ron"), &read).unwrap();
        assert_eq!(files::read(&odd.join("again.ron")).unwrap(), read);
    }
}

#[test]
fn a_traced_outline_suggests_a_simplification_that_works() {
    const COUNT: i32 = 2400;
    // A staircase around a disk of radius 0.5, as tracing a picture of 256 pixels gives it.
    let corner = |number: i32| {
        let angle = std::f64::consts::TAU * f64::from(number % COUNT) / f64::from(COUNT);
        [angle.cos(), angle.sin()].map(|share| (128.0 * share).round() / 256.0)
    };
    let mut stairs: Vec<_> = (0..COUNT).flat_map(|k| [corner(k), [corner(k + 1)[0], corner(k)[1]]]).collect();
    stairs.dedup();
    let mesh = outline(&stairs).build(&Disk).unwrap();
    assert!(mesh.triangles().len() > 1250, "{}", mesh.triangles().len());
    let told = mesh.messages().iter().find(|message| message.contains("simplify: ")).unwrap();
    assert!(told.contains(&format!("{} triangles where 1000 were asked for", mesh.triangles().len())), "{told}");
    let tolerance = told.split("`simplify: ").nth(1).unwrap().split('`').next().unwrap();
    let points: Vec<_> = stairs.iter().map(|[x, y]| format!("({x}, {y})")).collect();
    let simple = built(&level(&format!("Outline(points: [{}], simplify: {tolerance})", points.join(", ")))).unwrap();
    assert!(simple.triangles().len() <= 1300, "{} triangles are left", simple.triangles().len());
    assert!((simple.area() - mesh.area()).abs() < 0.02 * mesh.area());
    assert!(!simple.messages().iter().any(|message| message.contains("simplify: ")), "{:?}", simple.messages());
}

#[test]
fn common_mistakes_are_told_with_place_and_remedy() {
    let good = level("Disk(radius: 0.2, rings: 5)");
    assert!(files::parse(&good, "level.ron").is_ok());
    let cases: &[(&str, &str, &str)] = &[
        ("young: 1000", "young: 1000,5", "write `1000.5`"),
        ("radius: 0.2", "radius: 0,2", "write `0.2`"),
        ("young: 1000", "young: 1 000", "`1000` if it is one"),
        ("young: 1000", "young: 1kPa", "write `1000`"),
        ("radius: 0.2", "radius: 20 cm", "write `0.2`"),
        ("spin: 1,", "spin: 1", "expected `,`"),
        ("name: \"b\"", "name: b", "write it in double quotes"),
        ("name: \"b\"", "name: 'b'", "write it in double quotes"),
        ("name: \"b\"", "name: “b”", "straight double quotes"),
        ("young: 1000", "young = 1000", "write `:`"),
        ("young: 1000", "young: \"1000\"", "without quotes"),
        ("young: 1000", "youngs: 1000", "write `young`"),
        ("Corotated", "corotated", "write `Corotated`"),
        ("Corotated", "NeoHookian", "write `NeoHookean`"),
        ("young: 1000", "young: −1000", "plain hyphen"),
        ("poisson: 0.3", "poisson: 30%", "no units"),
        ("spin: 1,", "spin: 1;", "write `,`"),
        ("spin: 1,", "# spin\nspin: 1,", "`//` before a comment"),
        ("bodies: [", "bodies: (", "`]`"),
        ("young: 1000", "young: 10*100", "does not compute"),
        (", poisson: 0.3", "", "the field `poisson` is missing"),
    ];
    for (right, wrong, remedy) in cases {
        let text = good.replacen(right, wrong, 1);
        assert_ne!(text, good, "{right}");
        let told = refusal(&text);
        assert!(told.contains(remedy), "{wrong}: {told}");
        assert!(!told.contains("r#"), "{wrong}: {told}");
        let mut place = told.strip_prefix("level.ron:").unwrap().split(':');
        let line: usize = place.next().unwrap().parse().unwrap();
        assert!((1..=3).contains(&line) && place.next().unwrap().parse::<usize>().is_ok(), "{told}");
    }
    for (text, remedy) in [
        ("", "the file is empty"),
        ("{\"name\": \"a\"}", "looks like JSON"),
        ("<level/>", "looks like XML"),
        ("---\nname: a\n", "YAML"),
        ("name = \"a\"\n", "TOML"),
        ("(name: \"a\", bodies: [(name: \"b\"", "add `"),
        ("(name: \"a", "has no end"),
    ] {
        assert!(refusal(text).contains(remedy), "{text}: {}", refusal(text));
    }
}

#[test]
fn earlier_keys_of_scripted_actions_are_still_read() {
    for (file, text) in gingerbread::levels::HARD {
        let earlier = text.replace("actions: [", "acts: [").replace("action: ", "act: ");
        assert_eq!(files::parse(&earlier, file).unwrap(), files::parse(text, file).unwrap(), "{file}");
        assert!(files::parse_as::<gingerbread::hard::Case>(&earlier, file).is_ok(), "{file}");
    }
}

/// The state at the end is that of the level.
#[test]
fn a_printed_link_is_taken_in_place_of_the_level() {
    let page = "https://page.example/";
    let link = said(&gingerbread(&["link", "chain", "--page", page]).stdout).trim().to_owned();
    assert!(link.starts_with("https://page.example/#level=") && link.len() < 2000, "{link}");
    let folder = Folder::new("link");
    let states = ["chain", &link].map(|level| {
        let state = folder.file("state.csv");
        let run = gingerbread(&["run", level, "--seconds", "0.5", "--state", &state]);
        assert!(run.status.success(), "{}", said(&run.stderr));
        fs::read_to_string(state).unwrap()
    });
    assert_eq!(states[0], states[1]);
    let cut = gingerbread(&["run", &link[..link.len() - 9]]);
    assert!(!cut.status.success() && said(&cut.stderr).contains("not complete"), "{}", said(&cut.stderr));
    let dense = gingerbread(&["link", "pile", "--page", page]);
    assert!(dense.status.success(), "{}", said(&dense.stderr));
}

/// A unit square as Gmsh writes it, in both versions: one triangle and one quadrangle of it, a line, a point, and nodes that no triangle has.
const GMSH: [&str; 2] = [
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n1 7 \"edge\"\n$EndPhysicalNames\n$Nodes\n7\n10 0 0 0\n20 1 0 0\n30 1 1 0\n40 0 1 0\n50 0.5 0 0\n\
     60 0.5 1 0\n70 0.25 0 0\n$EndNodes\n$Elements\n4\n1 15 2 0 1 10\n2 1 2 7 1 10 70\n3 3 2 0 1 10 50 60 40\n4 9 2 0 1 50 20 60 50 20 60\n$EndElements\n",
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n1 0 1 0\n1 0 0 0 0\n1 0 0 0 1 1 0 0 0\n$EndEntities\n$Nodes\n2 7 10 70\n2 1 0 6\n10\n20\n30\n40\n50\n60\n0 0 0\n\
     1 0 0\n1 1 0\n0 1 0\n0.5 0 0\n0.5 1 0\n1 1 0 1\n70\n0.25 0 0\n$EndNodes\n$Elements\n3 3 1 3\n1 1 1 1\n1 10 70\n2 1 3 1\n2 10 50 60 40\n2 1 2 1\n3 50 20 60\n$EndElements\n",
];

#[test]
fn meshes_of_gmsh_are_read_with_triangles_and_quadrangles() {
    let folder = Folder::new("gmsh");
    for text in GMSH {
        let mesh = obj(&folder, text).unwrap();
        assert_eq!(
            (mesh.points().len(), mesh.triangles().len()),
            (5, 3),
            "nodes without a triangle are dropped: {text}"
        );
        assert!((mesh.area() - 0.75).abs() < 1e-15);
        assert_eq!(obj(&folder, &text.replace('\n', "\r\n")).unwrap(), mesh);
    }
}

#[test]
fn other_files_of_gmsh_are_refused_with_line_and_reason() {
    let folder = Folder::new("gmsh-refused");
    let [old, new] = GMSH;
    let cases = [
        (old.replace("2.2 0 8", "2.2 1 8"), "line 2", "binary"),
        (old.replace("2.2 0 8", "4.0 0 8"), "line 2", "version 2 or 4.1, got 4"),
        (old.replace("4 9 2 0 1 50 20 60 50 20 60", "4 4 2 0 1 10 20 30 40"), "line 23", "solid"),
        (old.replace("3 3 2 0 1 10 50 60 40", "3 3 2 0 1 10 50 60 99"), "line 22", "node 99 is not in the file"),
        (old.replace("3 3 2 0 1 10 50 60 40", "3 3 2 0 1 10 50 60"), "line 22", "expected 4 nodes"),
        (old.replace("20 1 0 0", "20 1 x 0"), "line 11", "expected the number of a node, x, y and z"),
        (old.replace("20 1 0 0", "10 1 0 0"), "line 11", "node 10 is there twice"),
        (old.replace("20 1 0 0", "20 1 0 5"), "line 11", "expected a flat mesh"),
        (old.replace("$EndElements\n", ""), "line 23", "the file ends here"),
        (old.split("$Elements").next().unwrap().to_owned(), "line 17", "no triangle or quadrangle"),
        (new.replace("3 50 20 60", "3 50 20"), "line 35", "and its nodes"),
        (new.replace("2 1 2 1", "2 1 99 1"), "line 34", "type 1 to 31, got 99"),
    ];
    for (text, place, reason) in cases {
        let told = obj(&folder, &text).unwrap_err();
        assert!(told.contains(place) && told.contains(reason), "{reason}: {told}");
    }
}

fn with_holes(holes: &[&[[f64; 2]]]) -> Outline {
    let corners = |line: &&[[f64; 2]]| line.iter().map(|point| Point::new(*point).unwrap()).collect();
    Outline { holes: holes.iter().map(corners).collect(), ..outline(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]) }
}

#[test]
fn an_outline_is_filled_around_its_holes() {
    let square = |x: f64, y: f64, side: f64| [[x, y], [x + side, y], [x + side, y + side], [x, y + side]];
    let round: Vec<[f64; 2]> = (0..40)
        .map(|at| f64::from(at) * std::f64::consts::TAU / 40.0)
        .map(|at| [0.3 + 0.1 * at.cos(), 0.7 + 0.1 * at.sin()])
        .collect();
    let reversed: Vec<_> = square(0.6, 0.2, 0.25).into_iter().rev().collect();
    let mesh = with_holes(&[&round, &reversed]).build(&Disk).unwrap();
    assert_eq!(mesh.boundary_loops().len(), 3);
    let area = 1.0 - 0.0625 - 0.5 * 40.0 * 0.01 * (std::f64::consts::TAU / 40.0).sin();
    assert!((mesh.area() - area).abs() < 2e-3, "{} for {area}", mesh.area());
    assert!(mesh.min_angle() > 25.0 && (900..1100).contains(&mesh.triangles().len()), "{}", mesh.triangles().len());
    let text = level(&format!(
        "Outline(points: [(0, 0), (1, 0), (1, 1), (0, 1)], holes: [{:?}])",
        [(0.4, 0.4), (0.6, 0.4), (0.5, 0.6)]
    ));
    assert_eq!(run(&text).fault(), None, "it runs, with contact on the edge of its hole");

    let inner = square(0.3, 0.3, 0.3);
    let cases: [(&[&[[f64; 2]]], &str); 7] = [
        (&[&square(0.9, 0.4, 0.3)], "hole 0 touches or crosses the outline"),
        (&[&square(0.0, 0.4, 0.3)], "hole 0 touches or crosses the outline"),
        (&[&square(2.0, 0.4, 0.3)], "hole 0 lies outside of the outline"),
        (&[&inner, &square(0.4, 0.4, 0.3)], "hole 1 touches or crosses hole 0"),
        (&[&inner, &square(0.4, 0.4, 0.1)], "hole 1 lies in hole 0"),
        (&[&inner[..2]], "hole 0 needs at least 3 points"),
        (&[&[[0.3, 0.3], [0.6, 0.6], [0.6, 0.3], [0.3, 0.5]]], "the sides of hole 0 after its points"),
    ];
    for (holes, reason) in cases {
        let told = with_holes(holes).build(&Disk).unwrap_err().to_string();
        assert!(told.contains(reason), "{reason}: {told}");
    }
}

//! The program as it is run in a terminal or a script.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::{
    arrays::array_of,
    program::{Folder, gingerbread, said},
};
use gingerbread::{
    files,
    level::{Level, RecordedEnd},
    link,
};
use std::{fs, process::Command};

/// The names in the report are stable.
#[test]
fn run_writes_an_exact_state_and_a_report() {
    let folder = Folder::new("run");
    let (state, report) = (folder.file("state.csv"), folder.file("report.json"));
    let output = gingerbread(&["run", "jelly_disk", "--steps", "50", "--state", &state, "--report", &report]);
    assert!(output.status.success(), "{}", said(&output.stderr));
    let csv = fs::read_to_string(state).unwrap();
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("vertex,x,y,vx,vy"));
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    for (number, row) in rows.iter().enumerate() {
        assert!(row.len() == 5 && row[0] == number.to_string());
        for cell in &row[1..] {
            assert_eq!(format!("{:.16e}", cell.parse::<f64>().unwrap()), *cell);
        }
    }
    let report: serde_json::Value = serde_json::from_str(&fs::read_to_string(report).unwrap()).unwrap();
    assert_eq!(rows.len() as u64, report["vertices"].as_u64().unwrap());
    assert_eq!(report["steps"], 50);
    assert_eq!(report["force_evaluations"], 50);
    assert_eq!(report["inverted"], 0);
    for number in ["min_j", "wall_seconds", "ns_per_triangle_step"] {
        assert!(report[number].as_f64().unwrap() > 0.0, "{number}");
    }
    let energy = |name: &str| report["energy"][name].as_f64().unwrap();
    let sum = energy("kinetic") + energy("elastic") + energy("potential");
    assert!((energy("total") - sum).abs() < 1e-12);
    let effects = report["effects"].as_array().unwrap();
    let elasticity = effects.iter().find(|effect| effect["name"] == "Elasticity").unwrap();
    assert_eq!(elasticity["calls"], 50);
    assert_eq!(elasticity["elements"].as_u64().unwrap(), 50 * report["triangles"].as_u64().unwrap());
    assert!(elasticity["seconds"].as_f64().unwrap() > 0.0);
    assert_eq!((&elasticity["switch"], elasticity["reason"].is_null()), (&"Auto".into(), true));
    let shares: f64 = effects.iter().map(|effect| effect["share"].as_f64().unwrap()).sum();
    assert!((shares - 1.0).abs() < 1e-9, "{shares}");
    let of = |name: &str| effects.iter().find(|effect| effect["name"] == name).unwrap();
    let hand = of("Mouse spring");
    assert_eq!(
        (&hand["calls"], &hand["skipped"], &hand["reason"]),
        (&0.into(), &50.into(), &"nothing is dragged".into())
    );
    assert!(hand["saved_ms_per_frame"].is_f64() && of("Elasticity")["ms_per_frame"].as_f64().unwrap() > 0.0);
    // What is switched off is listed, and cost nothing.
    let off = of("Damping");
    assert_eq!((&off["switch"], &off["calls"], off["saved_ms_per_frame"].is_null()), (&"Off".into(), &0.into(), true));
}

/// The effects are timed in a run of their own.
/// Clocks in the effects would send every step another, slower way.
#[test]
fn a_report_times_a_run_without_effect_clocks() {
    let folder = Folder::new("clocks");
    let (level, report) = (folder.file("sheet.ron"), folder.file("report.json"));
    let text = "(name: \"sheet\", substeps: 1000, bodies: [(name: \"sheet\", mass: Density(1), stretch: (1.2, 1), mesh: Rectangle(width: 1,
        height: 1, columns: 71, rows: 71, diagonals: Grid), material: (model: Corotated, young: 1000, poisson: 0.3))])";
    fs::write(&level, text).unwrap();
    let run = |more: &[&str]| {
        let output = gingerbread(&[&["run", &level, "--steps", "300", "--threads", "2"][..], more].concat());
        assert!(output.status.success(), "{}", said(&output.stderr));
        said(&output.stdout).rsplit(' ').next().unwrap().trim().to_owned()
    };
    assert_eq!(run(&["--report", &report]), run(&[]), "the same bits come of both");
    let report: serde_json::Value = serde_json::from_str(&fs::read_to_string(&report).unwrap()).unwrap();
    let seconds = |name: &str| report[name].as_f64().unwrap();
    let each = seconds("wall_seconds") * 1e9 / (300.0 * 10_082.0);
    assert!((seconds("ns_per_triangle_step") / each - 1.0).abs() < 1e-9);
    let elasticity = &report["effects"][0];
    assert_eq!((&elasticity["name"], &elasticity["calls"]), (&"Elasticity".into(), &300.into()));
    assert!(elasticity["seconds"].as_f64().unwrap() > 0.0);
}

#[test]
fn a_report_lists_the_steps_of_each_multirate_body() {
    let folder = Folder::new("paces");
    let report = folder.file("report.json");
    let read = |level: &str| -> serde_json::Value {
        let output = gingerbread(&["run", level, "--steps", "20", "--report", &report]);
        assert!(output.status.success(), "{}", said(&output.stderr));
        serde_json::from_str(&fs::read_to_string(&report).unwrap()).unwrap()
    };
    let own = read("pea_and_cake");
    let [cake, pea] = [&own["paces"][0], &own["paces"][1]];
    assert_eq!((&cake["name"], &pea["name"]), (&"cake".into(), &"pea".into()));
    let [parts, step] = [&pea["steps"], &pea["step_seconds"]].map(|number| number.as_f64().unwrap());
    let cakes = cake["steps"].as_f64().unwrap();
    assert!(parts > 4.0 * cakes && (parts * step - own["step_seconds"].as_f64().unwrap()).abs() < 1e-12);
    assert!(step <= 0.5 * pea["critical_step_seconds"].as_f64().unwrap());
    assert_eq!(own["force_evaluations"].as_f64().unwrap(), 20.0 * (cakes + parts));
    assert_eq!(read("three_models")["paces"], serde_json::json!([]));
}

#[test]
fn a_report_without_triangles_has_null_for_their_numbers() {
    let folder = Folder::new("net");
    let report = folder.file("report.json");
    let output = gingerbread(&["run", "chain", "--steps", "50", "--report", &report]);
    assert!(output.status.success() && !said(&output.stdout).contains("least J"), "{}", said(&output.stderr));
    let report: serde_json::Value = serde_json::from_str(&fs::read_to_string(report).unwrap()).unwrap();
    assert!(report["min_j"].is_null() && report["ns_per_triangle_step"].is_null());
    assert_eq!((&report["triangles"], &report["vertices"]), (&0.into(), &4.into()));
    assert!(said(&gingerbread(&["check", "chain"]).stdout).contains("3 springs, 4 vertices, 1 pinned"));
}

#[test]
fn a_run_that_is_saved_and_continued_equals_one_that_was_not() {
    let folder = Folder::new("continue");
    let (saved, ends) = (folder.file("half.ron"), [folder.file("one.csv"), folder.file("two.csv")]);
    assert!(gingerbread(&["run", "jelly_disk", "--steps", "80", "--save", &saved]).status.success());
    assert!(gingerbread(&["run", &saved, "--steps", "70", "--state", &ends[0]]).status.success());
    assert!(gingerbread(&["run", "jelly_disk", "--steps", "150", "--state", &ends[1]]).status.success());
    assert_eq!(fs::read(&ends[0]).unwrap(), fs::read(&ends[1]).unwrap());
}

#[test]
fn check_says_what_a_level_is_and_what_is_wrong_with_a_bad_one() {
    let folder = Folder::new("check");
    let bad = folder.file("bad.ron");
    fs::write(&bad, "(\n  name: \"bad\",\n  bodis: [],\n)").unwrap();
    let output = gingerbread(&["check", "gingerbread", &bad, "stretch_test"]);
    assert_eq!(output.status.code(), Some(2));
    let (good, wrong) = (said(&output.stdout), said(&output.stderr));
    assert!(
        good.contains("2010 triangles") && good.contains("stretch_test"),
        "a bad file does not stop the rest: {good}"
    );
    assert!(wrong.contains("bad.ron:3:") && wrong.contains("bodis") && wrong.lines().count() == 1, "{wrong}");
}

#[test]
fn check_and_report_tell_what_begins_inside_a_wall() {
    let folder = Folder::new("inside");
    let (file, report) = (folder.file("inside.ron"), folder.file("report.json"));
    let jelly = gingerbread::levels::built_in("jelly_disk").unwrap();
    fs::write(&file, jelly.replace("centre: (0.28, 0.8)", "centre: (5, 5)")).unwrap();
    let told = said(&gingerbread(&["check", &file]).stdout);
    assert!(
        told.contains(
            "vertices begin inside walls, other bodies or outside the domain: they are pushed out slowly, if there is a way"
        ),
        "{told}"
    );
    assert!(!said(&gingerbread(&["check", "jelly_disk"]).stdout).contains("inside"));
    let output = gingerbread(&["run", &file, "--seconds", "0.1", "--report", &report]);
    assert!(output.status.success(), "{}", said(&output.stderr));
    let report: serde_json::Value = serde_json::from_str(&fs::read_to_string(&report).unwrap()).unwrap();
    assert!(report["pushed_out_steps"].as_u64().unwrap() > 0);
    assert_eq!(report["guarded_steps"], 0);
}

#[test]
fn wrong_arguments_and_missing_files_exit_with_2() {
    for (arguments, expected) in [
        (vec!["run", "no_such_level"], "no_such_level"),
        (vec!["check", "no_such_level.ron"], "no_such_level.ron"),
        (vec!["run", "gingerbread", "--seconds", "-1"], "at least 0 and at most 1e9 seconds"),
        (vec!["run", "gingerbread", "--seconds", "soon"], "number of seconds"),
        (vec!["run", "gingerbread", "--model", "jelly"], "NeoHookean"),
        (vec!["run", "gingerbread", "--integrator", "x"], "SymplecticEuler"),
        (vec!["run", "gingerbread", "--step", "0.1"], "1/60"),
        (vec!["run", "gingerbread", "--step", "-1"], "1/60"),
    ] {
        let output = gingerbread(&arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(said(&output.stderr).contains(expected), "{arguments:?}: {}", said(&output.stderr));
    }
}

/// Cells of a CSV, row by row; the first row are the names of the columns.
fn cells(path: &str) -> Vec<Vec<String>> {
    let text = fs::read_to_string(path).unwrap();
    text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

/// Numbers of an array of a VTK file.
fn array(text: &str, name: &str) -> Vec<f64> {
    let (_, rest) = text.split_once(&format!("Name=\"{name}\"")).unwrap();
    let (numbers, _) = rest.split_once('\n').unwrap().1.split_once("</DataArray>").unwrap();
    numbers.split_whitespace().map(|number| number.parse().unwrap()).collect()
}

/// In the order of the state file, and with the same digits.
#[test]
fn states_over_time_are_those_of_the_run() {
    let folder = Folder::new("vtk");
    let [vtk, state, csv] = ["a & b.pvd", "state.csv", "series.csv"].map(|name| folder.file(name));
    for (level, dimension) in [("gingerbread_house", 2), ("cloth_folding", 3), ("hanging_net", 2)] {
        let probe = if level == "hanging_net" { "energy" } else { "triangle:12" };
        let arguments = ["run", level, "--seconds", "0.1", "--every", "0.05", "--vtk", &vtk, "--state", &state];
        let output = gingerbread(&[&arguments[..], &["--csv", &csv, "--probe", probe]].concat());
        assert!(output.status.success(), "{level}: {}", said(&output.stderr));
        let collection = fs::read_to_string(&vtk).unwrap();
        assert_eq!(collection.matches("<DataSet").count(), 3, "{level}: at 0, 0.05 and 0.1 s");
        assert!(collection.contains("file=\"a &amp; b_0002.vtu\""), "{collection}");
        let text = fs::read_to_string(folder.file("a & b_0002.vtu")).unwrap();
        let (points, velocities) = (array(&text, "points"), array(&text, "velocity"));
        let vertices = cells(&state);
        assert_eq!(points.len(), 3 * (vertices.len() - 1));
        for (row, (point, velocity)) in vertices[1..].iter().zip(points.chunks(3).zip(velocities.chunks(3))) {
            let own: Vec<f64> = row[1..].iter().map(|cell| cell.parse().unwrap()).collect();
            assert_eq!(
                (&own[..dimension], &own[dimension..]),
                (&point[..dimension], &velocity[..dimension]),
                "{level}"
            );
        }
        let (corners, ends, kinds) = (array(&text, "connectivity"), array(&text, "offsets"), array(&text, "types"));
        let springs = kinds.iter().filter(|kind| **kind == 3.0).count();
        assert_eq!(corners.len(), 3 * (kinds.len() - springs) + 2 * springs);
        assert_eq!((ends.len(), ends.last()), (kinds.len(), Some(&(corners.len() as f64))));
        assert_eq!(springs > 0, level == "hanging_net");
        if springs == 0 {
            let rows = cells(&csv);
            for (column, name) in [
                ("j", "area_ratio_j"),
                ("psi", "energy_density"),
                ("stretch1", "principal_stretch"),
                ("von_mises", "von_mises_stress"),
            ] {
                let place = rows[0].iter().position(|own| *own == format!("triangle_12_{column}"));
                let (probe, own) = (rows[3][place.unwrap()].parse::<f64>().unwrap(), array(&text, name)[12]);
                assert!((probe - own).abs() <= 1e-9 * probe.abs().max(1e-9), "{level}: {name} {probe} {own}");
            }
        }
    }
    for (level, path, why) in
        [("cantilever", "a.vtu", "must end in .pvd"), ("circle", "a.pvd", "a toy has no vertices")]
    {
        let output = gingerbread(&["run", level, "--vtk", &folder.file(path)]);
        assert!(!output.status.success() && said(&output.stderr).contains(why), "{}", said(&output.stderr));
    }
}

#[test]
fn arrays_over_time_are_those_of_the_run() {
    let folder = Folder::new("npz");
    let [npz, state, report] = ["a.npz", "state.csv", "report.json"].map(|name| folder.file(name));
    for (level, dimension) in [("gingerbread_house", 2), ("cloth_folding", 3), ("hanging_net", 2)] {
        let arguments = ["run", level, "--seconds", "0.1", "--every", "0.05", "--npz", &npz, "--state", &state];
        let output = gingerbread(&[&arguments[..], &["--report", &report]].concat());
        assert!(output.status.success(), "{level}: {}", said(&output.stderr));
        let (archive, rows) = (fs::read(&npz).unwrap(), cells(&state));
        let vertices = rows.len() - 1;
        let (shape, times) = array_of(&archive, "time");
        assert_eq!((shape, f64::from_le_bytes(times[0])), (vec![3], 0.0), "{level}");
        let moving = ["positions", "velocities"].map(|name| array_of(&archive, name));
        for (offset, (shape, numbers)) in [1, 1 + dimension].into_iter().zip(&moving) {
            assert_eq!(*shape, [3, vertices, dimension], "{level}");
            let last = numbers[2 * vertices * dimension..].chunks(dimension);
            for (row, own) in rows[1..].iter().zip(last) {
                let wanted = row[offset..offset + dimension].iter().map(|cell| cell.parse::<f64>().unwrap());
                assert!(wanted.eq(own.iter().map(|bytes| f64::from_le_bytes(*bytes))), "{level}: {row:?}");
            }
        }
        let (shape, energies) = array_of(&archive, "energies");
        let report: serde_json::Value = serde_json::from_str(&fs::read_to_string(&report).unwrap()).unwrap();
        let names = ["kinetic", "elastic", "contact", "potential"].map(|name| report["energy"][name].as_f64().unwrap());
        assert_eq!((shape, [8, 9, 10, 11].map(|place| f64::from_le_bytes(energies[place]))), (vec![3, 4], names));
        let [(triangles, corners), (springs, ends)] = ["triangles", "springs"].map(|name| array_of(&archive, name));
        assert_eq!((triangles[0] == 0, springs[0] > 0), (level == "hanging_net", level == "hanging_net"), "{level}");
        let numbers = corners.iter().chain(&ends).map(|bytes| u64::from_le_bytes(*bytes));
        assert_eq!(numbers.max(), Some(vertices as u64 - 1), "{level}");
    }
    for (level, path, why) in
        [("cantilever", "a.npy", "must end in .npz"), ("circle", "a.npz", "a toy has no vertices")]
    {
        let output = gingerbread(&["run", level, "--npz", &folder.file(path)]);
        assert!(!output.status.success() && said(&output.stderr).contains(why), "{}", said(&output.stderr));
    }
}

#[test]
fn quantities_over_time_are_those_of_the_run() {
    let folder = Folder::new("series");
    let [csv, state, report] = ["series.csv", "state.csv", "report.json"].map(|name| folder.file(name));
    for (level, dimension, probes) in [
        ("gingerbread_house", 2, "energy,momentum,min_j,reaction,forces:5,triangle:12,vertex:3"),
        ("cloth_folding", 3, "energy,momentum,forces:5,triangle:12,vertex:3"),
        ("hanging_net", 2, "energy,vertex:3"),
    ] {
        let arguments = ["run", level, "--seconds", "0.1", "--every", "0.02", "--probe", probes, "--csv", &csv];
        let output = gingerbread(&[&arguments[..], &["--state", &state, "--report", &report]].concat());
        assert!(output.status.success(), "{level}: {}", said(&output.stderr));
        let (rows, last) = (cells(&csv), cells(&state));
        assert_eq!(rows.len(), 7, "{level}: names, and 0 to 0.1 s");
        for (row, time) in rows[1..].iter().zip([0.0, 0.02, 0.04, 0.06, 0.08, 0.1]) {
            assert_eq!(row.len(), rows[0].len());
            assert!((row[0].parse::<f64>().unwrap() - time).abs() < 1e-3, "{level}: {} at {time} s", row[0]);
        }
        let number = |name: &str| &rows[6][rows[0].iter().position(|column| column == name).unwrap()];
        let end = rows[0].len() - dimension;
        assert_eq!(rows[6][end - 2 * dimension..end], last[4][1..], "{level}: the same digits");
        let report: serde_json::Value = serde_json::from_str(&fs::read_to_string(&report).unwrap()).unwrap();
        let near = |name: &str, other: &serde_json::Value| {
            let (one, other) = (number(name).parse::<f64>().unwrap(), other.as_f64().unwrap());
            assert!((one - other).abs() <= 1e-12 * other.abs(), "{level}: {name} {one} {other}");
        };
        near("energy", &report["energy"]["total"]);
        if level == "gingerbread_house" {
            near("min_j", &report["min_j"]);
            assert!(number("momentum_y").parse::<f64>().unwrap() < 0.0, "he falls");
        }
    }
    // A toy has its numbers and the exact ones.
    assert!(gingerbread(&["run", "circle", "--seconds", "0.1", "--csv", &csv]).status.success());
    let rows = cells(&csv);
    assert_eq!((rows.len(), rows[0].len()), (8, 5), "{rows:?}");
    for (arguments, why) in [
        (&["cantilever", "--probe", "vertex:99999"][..], "its vertices are 0 to "),
        (&["cantilever", "--probe", "forces:99999"], "its vertices are 0 to "),
        (&["cantilever", "--probe", "triangle:99999"], "its triangles are 0 to "),
        (&["hanging_net", "--probe", "triangle:0"], "it has neither bodies nor membranes"),
        (&["cantilever", "--probe", "numbers"], "it is no toy"),
        (&["hanging_net", "--probe", "energy,min_j"], "it has no bodies"),
        (&["circle", "--probe", "vertex:0"], "a toy has numbers alone"),
        (&["cantilever", "--probe", "heat"], "min_j"),
        (&["cantilever", "--every", "0"], "more than 0"),
    ] {
        let output = gingerbread(&[&["run", "--csv", &csv], arguments].concat());
        let told = said(&output.stderr);
        assert_eq!((output.status.code(), told.contains(why)), (Some(2), true), "{arguments:?}: {told}");
    }
}

#[test]
fn model_integrator_and_step_replace_those_of_the_level() {
    let folder = Folder::new("overrides");
    let (report, saved, again) = (folder.file("report.json"), folder.file("saved.ron"), folder.file("again.ron"));
    let run = |level: &str, saved: &str, arguments: &[&str]| -> (serde_json::Value, String) {
        let all = [&["run", level, "--steps", "3", "--report", &report, "--save", saved], arguments].concat();
        let output = gingerbread(&all);
        assert!(output.status.success(), "{all:?}: {}", said(&output.stderr));
        let read = |path: &str| fs::read_to_string(path).unwrap();
        (serde_json::from_str(&read(&report)).unwrap(), read(saved))
    };
    let schemes =
        [("e", "ForwardEuler"), ("t", "Heun"), ("r", "RungeKutta4"), ("i", "ImplicitEuler"), ("bdf2", "Bdf2")];
    for (short, name) in schemes {
        let settings = ["--integrator", short, "--step", "0.001", "--model", "NeoHookean"];
        let (told, level) = run("cantilever", &saved, &settings);
        assert_eq!((&told["integrator"], told["step_seconds"].as_f64()), (&name.into(), Some(1.0 / 1020.0)), "{short}");
        assert!(
            level.contains(name) && level.contains("model: NeoHookean") && level.contains("substeps: 17"),
            "{level}"
        );
    }
    // Cloth has models too, and what a scheme remembers is of no use to another one.
    let (_, level) = run("cloth_folding", &saved, &["--model", "Corotated", "--integrator", "Bdf2"]);
    assert!(level.contains("model: Corotated") && level.contains("memory"), "{level}");
    let (_, level) = run(&saved, &again, &["--integrator", "Heun"]);
    assert!(!level.contains("memory"), "{level}");
}

#[test]
fn a_link_with_an_end_is_replayed_and_compared() {
    let link = |more: &[&str]| {
        let output = gingerbread(&[&["link", "gingerbread_house"], more].concat());
        said(&output.stdout).trim().to_owned()
    };
    let sent = link(&["--seconds", "0.3"]);
    let output = gingerbread(&["run", &sent]);
    let text = said(&output.stdout);
    assert!(
        output.status.success() && text.contains("to 0.3000 s") && text.contains("replay: the recorded state"),
        "{text}"
    );
    let text = said(&gingerbread(&["run", &sent, "--seconds", "0.1"]).stdout);
    assert!(!text.contains("replay"), "the end is not reached: {text}");
    let text = said(&gingerbread(&["run", &sent, "--integrator", "Heun"]).stdout);
    assert!(!text.contains("replay"), "another scheme has no such end: {text}");

    let level = link::level(&sent).unwrap().unwrap();
    let end = level.recorded.clone().unwrap();
    let wrong = RecordedEnd { hash: "00000000000000ff".to_owned(), ..end };
    let folder = Folder::new("wrong-end");
    let path = folder.with("wrong.ron", &files::write(&Level { recorded: Some(wrong), ..level }).unwrap());
    let output = gingerbread(&["run", &path]);
    let text = said(&output.stdout);
    assert!(output.status.code() == Some(4) && text.contains("not the recorded state"), "{text}");
    let bad = fs::read_to_string(&path).unwrap().replace("00000000000000ff", "xyz");
    let output = gingerbread(&["run", &folder.with("bad.ron", &bad)]);
    let text = said(&output.stderr);
    assert!(output.status.code() == Some(2) && text.contains("16 digits"), "{text}");
}

#[test]
fn a_run_that_blows_up_says_why_and_ends_with_1() {
    let folder = Folder::new("fault");
    let (level, report) = (folder.file("stiff.ron"), folder.file("report.json"));
    let text = "(name: \"stiff\", substeps: 1, bodies: [(name: \"sheet\", mesh: Rectangle(width: 1, height: 1, columns: 9, rows: 9),
        mass: Total(1), stretch: (1.2, 1), material: (model: NeoHookean, young: 1e6, poisson: 0.3))])";
    fs::write(&level, text).unwrap();
    let output = gingerbread(&["run", &level, "--report", &report]);
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output.stderr).contains("stability limit"), "{}", said(&output.stderr));
    let report: serde_json::Value = serde_json::from_str(&fs::read_to_string(report).unwrap()).unwrap();
    assert!(report["fault"].as_str().unwrap().contains("stability limit"));
}

/// Where there is no display the window cannot open; that must be said in one line, with the way out.
#[test]
#[cfg(target_os = "linux")]
fn without_a_display_the_window_says_so_and_names_run() {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gingerbread"));
    let output =
        command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET").output().unwrap();
    let message = said(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.lines().count() == 1 && message.contains("gingerbread run"), "{message}");
}

#[test]
fn what_would_come_to_nothing_is_refused_with_the_way_out() {
    let scheme = "Symplectic Euler";
    let refused: [(&[&str], &str); 9] = [
        (&["study", "circle", "--integrators", "Heun,SymplecticEuler", "--seconds", "0.1"], scheme),
        (&["study", "pendulum", "--drift", "--integrators", "SymplecticEuler", "--seconds", "0.1"], scheme),
        (&["study", "cantilever", "--meshes", "0"], "2..=1000000"),
        (&["study", "cantilever", "--threads", "0"], "[1, 1024]"),
        (&["hard", "stretch_2", "--seeds", "3"], "leave --seeds out"),
        (&["hard", "stretch_2", "--threads", "many"], "[1, 1024]"),
        (&["run", "circle", "--model", "NeoHookean"], "no body"),
        (&["run", "circle", "--untangle"], "no body"),
        (&["run", "cantilever", "--threads", "0"], "[1, 1024]"),
    ];
    for (arguments, reason) in refused {
        let output = gingerbread(arguments);
        let why = said(&output.stderr);
        assert!(output.status.code() == Some(2) && why.contains(reason), "{arguments:?}: {why}");
    }
}

#[test]
fn a_run_of_no_steps_has_no_cost_of_a_step() {
    let output = gingerbread(&["run", "cantilever", "--steps", "0"]);
    let line = said(&output.stdout);
    assert!(output.status.success() && line.contains("0 steps") && !line.contains("ns per"), "{line}");
}

/// Its table says which cases are held.
#[test]
fn hard_exits_with_1_on_an_unexplained_failure() {
    let folder = Folder::new("hard");
    let (csv, unexplained) = (folder.file("table.csv"), folder.file("unexplained.ron"));
    let output = gingerbread(&["hard", "stretch_2", "--integrator", "ImplicitEuler", "--csv", &csv]);
    let table = said(&output.stdout);
    assert!(output.status.success(), "{}", said(&output.stderr));
    assert!(
        table.contains("StVenantKirchhoff ImplicitEuler") && table.contains("not stable, as expected: "),
        "{table}"
    );
    assert!(table.contains("stretch_2 undamped") && table.contains(" off in "), "{table}");
    let lines = fs::read_to_string(csv).unwrap();
    assert!(lines.starts_with("case,undamped,model,method,held,stable,off,"), "{lines}");
    let stable =
        lines.lines().any(|line| line.starts_with("stretch_2,no,Corotated,ImplicitEuler,") && line.contains(",yes,"));
    assert!(stable, "{lines}");

    let text = fs::read_to_string("levels/hard/mirror.ron").unwrap();
    let at = text.find("    cannot:").unwrap();
    fs::write(&unexplained, format!("{})\n", &text[..at])).unwrap();
    let one = ["--model", "StVenantKirchhoff", "--integrator", "bdf2", "--twins", "none", "--no-reference"];
    let output = gingerbread(&[&["hard", unexplained.as_str()][..], &one].concat());
    assert_eq!(output.status.code(), Some(1));
    assert!(
        said(&output.stdout).contains("NOT STABLE (130 triangles inverted, opened by Untangle)"),
        "{}",
        said(&output.stdout)
    );
    assert_eq!(gingerbread(&[&["hard", "mirror"][..], &one].concat()).status.code(), Some(0), "it is listed there");
    // An experiment shows the cause.
    let output = gingerbread(&[&["hard", "mirror", "--experiments"][..], &one].concat());
    assert!(said(&output.stdout).contains("[not with the compression effect]"), "{}", said(&output.stdout));
    let output = gingerbread(&["hard", "no_such_case"]);
    assert!(output.status.code() == Some(2) && said(&output.stderr).contains("no_such_case"));
}

#[test]
fn hard_counts_how_many_of_many_irregular_starts_come_home() {
    let request = ["hard", "line", "stretch_2", "--seeds", "3", "--triangles", "100", "--integrator", "Bdf2"];
    let output = gingerbread(&[&request[..], &["--model", "FixedCorotated"]].concat());
    let table = said(&output.stdout);
    let rows: Vec<_> = table.lines().skip(1).collect();
    assert!(output.status.success(), "no file promises anything about other seeds");
    assert!(rows.len() == 2 && rows.iter().all(|row| row.starts_with("line") && row.contains(" of 3")), "{table}");
    assert!(!rows[0].contains("undamped") && rows[1].contains("line, undamped"), "{table}");
}

#[test]
fn hard_may_go_on_for_longer_than_a_case_asks_for() {
    let time = |more: &[&str]| {
        let one = ["hard", "corner", "--model", "Corotated", "--integrator", "ImplicitEuler", "--no-reference"];
        gingerbread(&[&one[..], more].concat())
    };
    assert!(time(&["--times", "2"]).status.success());
    let text = fs::read_to_string("levels/hard/corner.ron").unwrap().replace("Seconds(4)", "Seconds(1e11)");
    let folder = Folder::new("times");
    let file = folder.file("endless.ron");
    fs::write(&file, text).unwrap();
    let output = gingerbread(&["hard", &file, "--times", "100"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output.stderr).contains("endless.ron: it would go on for longer"), "{}", said(&output.stderr));
}

/// A run goes on to the last known result of its level, tells whether each is met, and ends with 5 if one is missed.
#[test]
fn known_results_are_told() {
    let output = gingerbread(&["run", "bar_vibration"]);
    let text = said(&output.stdout);
    assert!(output.status.success() && text.matches(": met").count() == 3, "{text}");
    let folder = Folder::new("known");
    let report = folder.file("report.json");
    let output = gingerbread(&["run", "bar_vibration", "--seconds", "0.1", "--report", &report]);
    let text = said(&output.stdout);
    assert!(text.matches(": met").count() == 2 && text.contains("which this run did not pass"), "{text}");
    let read: serde_json::Value = serde_json::from_str(&fs::read_to_string(&report).unwrap()).unwrap();
    assert_eq!((&read["checks"][0]["met"], &read["checks"][2]["met"]), (&true.into(), &serde_json::Value::Null));
    let wrong = gingerbread::levels::built_in("bar_vibration").unwrap().replace("value: -0.01,", "value: -0.02,");
    let output = gingerbread(&["run", &folder.with("wrong.ron", &wrong)]);
    let text = said(&output.stdout);
    assert!(output.status.code() == Some(5) && text.matches(": missed").count() == 1, "{text}");
    let bad = wrong.replace("column: \"ux\"", "column: \"uz\"");
    let output = gingerbread(&["check", &folder.with("bad.ron", &bad)]);
    let text = said(&output.stderr);
    assert!(output.status.code() == Some(2) && text.contains("those are: x, y, vx, vy, ux, uy"), "{text}");
}

/// A search finds what is wrong, makes its level as small as it can, and saves it; without a find it ends with 0.
#[test]
fn a_search_tells_what_goes_wrong_and_saves_the_least_level() {
    let found = |arguments: &[&str]| {
        let output = gingerbread(&[&["break", "hanging_strip", "--progress", "0"], arguments].concat());
        (output.status.code(), said(&output.stdout))
    };
    let (code, text) = found(&["--minutes", "0.02"]);
    assert!(code == Some(0) && text.contains("      0 wrong"), "{text}");
    let output = gingerbread(&["break", "circle"]);
    assert!(output.status.code() == Some(2) && said(&output.stderr).contains("toy"), "{}", said(&output.stderr));
    let output = gingerbread(&["break", "circle", "--minutes", "-1"]);
    assert_eq!(output.status.code(), Some(2));
}

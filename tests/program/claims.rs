//! What the program says in a terminal about cost and accuracy is what was computed.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::program::{Folder, gingerbread};
use serde_json::Value;
use std::fs;

/// What the program prints if all goes well.
fn said(arguments: &[&str]) -> String {
    let output = gingerbread(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", crate::program::said(&output.stderr));
    crate::program::said(&output.stdout)
}

fn sheet(name: &str, left: f64, stretch: f64) -> String {
    format!(
        "(name: \"{name}\", mass: Density(1), stretch: ({stretch}, 1), material: (model: NeoHookean, young: 100, poisson: 0.3),
          mesh: Rectangle(width: 0.2, height: 0.2, columns: 4, rows: 4, diagonals: Grid, corner: ({left}, 0.3)))"
    )
}

fn report(folder: &Folder, level: &str, more: &[&str]) -> (String, Value) {
    let path = folder.file("report.json");
    let line = said(&[&["run", level, "--report", &path][..], more].concat());
    (line, serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap())
}

#[test]
fn the_cost_of_a_step_is_that_of_steps_that_were_computed() {
    let folder = Folder::new("claims-asleep");
    let (level, saved) = (folder.file("level.ron"), folder.file("saved.ron"));
    fs::write(&level, format!("(name: \"rest\", substeps: 20, bodies: [{}])", sheet("a", 0.1, 1.0))).unwrap();
    let (line, first) = report(&folder, &level, &["--steps", "5000", "--save", &saved]);
    let [steps, slept, computed, wall] =
        ["steps", "slept_steps", "triangle_steps", "wall_seconds"].map(|name| first[name].as_f64().unwrap());
    assert!(steps == 5000.0 && slept > 3000.0 && slept < 5000.0, "{first}");
    assert_eq!(computed, 32.0 * (steps - slept));
    let near = |name: &str, value: f64| (first[name].as_f64().unwrap() / value - 1.0).abs() < 1e-9;
    assert!(near("ns_per_triangle_step", 1e9 * wall / computed) && near("seconds_per_step", wall / (steps - slept)));
    assert!(near("slept_share", slept / steps) && near("slept_triangle_share", slept / steps));
    assert!(line.contains(&format!("{slept} of 5000 steps slept")), "{line}");
    let elasticity = &first["effects"][0];
    assert_eq!(elasticity["slept_steps"].as_f64().unwrap(), slept);
    let frames = (steps - slept) / 20.0;
    let each = 1e3 * elasticity["seconds"].as_f64().unwrap() / frames;
    assert!((elasticity["ms_per_frame"].as_f64().unwrap() / each - 1.0).abs() < 1e-9);

    let (line, second) = report(&folder, &saved, &["--steps", "1000"]);
    assert_eq!(second["slept_steps"], 1000);
    assert!(second["ns_per_triangle_step"].is_null() && second["seconds_per_step"].is_null());
    assert!(second["effects"][0]["ms_per_frame"].is_null());
    assert!(line.contains("no step computed") && !line.contains("ns per"), "{line}");
}

#[test]
fn triangles_of_bodies_that_sleep_are_not_counted() {
    let folder = Folder::new("claims-half");
    let level = folder.file("level.ron");
    let bodies = [sheet("still", 0.1, 1.0), sheet("swinging", 0.6, 1.2)].join(", ");
    fs::write(&level, format!("(name: \"half\", substeps: 40, bodies: [{bodies}])")).unwrap();
    let (line, report) = report(&folder, &level, &["--steps", "4000"]);
    assert_eq!((&report["slept_steps"], &report["triangles"]), (&0.into(), &64.into()));
    let computed = report["triangle_steps"].as_u64().unwrap();
    let [still, swinging] = [0, 1].map(|body| report["effects"][body]["slept_steps"].as_u64().unwrap());
    assert!(still > 1000 && swinging == 0, "{report}");
    assert_eq!(computed, 32 * 4000 + 32 * (4000 - still));
    assert!(line.contains("% of triangles times steps slept"), "{line}");
}

#[test]
fn a_study_of_a_scene_at_rest_says_so_and_recommends_nothing() {
    let folder = Folder::new("claims-rest");
    let csv = folder.file("out.csv");
    let table = said(&["study", "gingerbread", "--seconds", "0.1", "--csv", &csv]);
    let csv = fs::read_to_string(csv).unwrap();
    for text in [&table, &csv] {
        assert!(text.contains("Nothing moves here") && text.contains("nothing is recommended"), "{text}");
        for wrong in ["inf", "NaN", "unstable", "Cheapest"] {
            assert!(!text.contains(wrong), "{wrong}: {text}");
        }
    }
    let table = said(&["study", "gingerbread", "--seconds", "0.1", "--drift"]);
    assert!(table.contains("Almost nothing moves here") && !table.contains('%') && !table.contains("inf"), "{table}");
}

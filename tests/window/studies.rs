//! Studies in the background, and plots that can be taken away.

use crate::{folder::Folder, harness::*};
use eframe::egui::{ColorImage, Key, ViewportCommand};
use egui_kittest::kittest::Queryable as _;
use gingerbread::command::Mode;
use std::{fs, sync::Arc};

/// Saves the numbers of a plot and returns them.
fn table(window: &mut Window, button: &str) -> String {
    let folder = Folder::new(&button.to_lowercase().replace(' ', "-"));
    let path = folder.0.join("out.csv");
    click(window, button);
    type_path(window, &path, "Save");
    assert!(
        window.state().notice().is_some_and(|notice| notice.starts_with("Saved as")),
        "{:?}",
        window.state().notice()
    );
    fs::read_to_string(&path).unwrap()
}

fn has_head(table: &str, more: &[&str]) {
    for entry in ["# level: ", "# commit: ", "# processor: ", "# threads: "].iter().chain(more) {
        assert!(table.lines().any(|line| line.starts_with(entry)), "{entry} is missing in\n{table}");
    }
}

/// Opens a study, begins it, and goes on drawing until it is done.
fn measure(window: &mut Window, study: &str) {
    click_in_panel(window, study);
    click(window, "Measure");
    wait_until_gone(window, "Cancel");
}

#[test]
fn saved_energies_have_a_head_that_tells_their_origin() {
    let mut window = in_mode("chain", Mode::Simulate);
    press(&mut window, Key::Space);
    let table = table(&mut window, "Energies as CSV");
    has_head(&table, &["# level: Chain", "# reference: none"]);
    let rows = table.lines().filter(|line| !line.starts_with('#'));
    assert!(
        rows.clone().next() == Some("time_s,kinetic_j,elastic_j,contact_j,potential_j,total_j") && rows.count() > 3,
        "{table}"
    );
}

/// A plot that is not wanted is forgotten.
#[test]
fn a_plot_that_cannot_be_saved_says_why() {
    let mut window = open("chain");
    click(&mut window, "Energies as CSV");
    type_path(&mut window, &std::env::temp_dir().join("gingerbread-no-such-folder").join("out.csv"), "Save");
    assert!(window.state().notice().is_some_and(|notice| notice.contains("no-such-folder")));
    click(&mut window, "Energies as CSV");
    click(&mut window, "Cancel");
    window.run_steps(5);
    assert!(window.query_by_label("Save").is_none());
}

#[test]
fn a_picture_of_a_plot_is_cut_from_the_pixels_of_the_window() {
    let folder = Folder::new("picture");
    let path = folder.0.join("out.png");
    let mut window = open("chain");
    click(&mut window, "Energies as PNG");
    let mut asked = None;
    for _ in 0..10 {
        let mut commands = window.output().viewport_output.values().flat_map(|viewport| &viewport.commands);
        asked = commands.find_map(|command| match command {
            ViewportCommand::Screenshot(callback) => Some(callback.clone()),
            _ => None,
        });
        if asked.is_some() {
            break;
        }
        window.run_steps(1);
    }
    // The harness paints nothing; what a window would give is one colour everywhere.
    let grey = ColorImage::filled([1280, 800], eframe::egui::Color32::from_gray(90));
    asked.expect("the window is asked for its pixels").complete(Arc::new(grey));
    window.run_steps(3);
    type_path(&mut window, &path, "Save");
    let bytes = fs::read(&path).unwrap();
    let size = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
    assert_eq!(&bytes[1..4], b"PNG");
    assert!((250..330).contains(&size(16)) && (120..330).contains(&size(20)), "{} x {}", size(16), size(20));
    assert!(bytes.windows(13).any(|text| text == b"level: Chain\n".as_slice()), "it says what it shows");
}

#[test]
fn a_window_that_gives_no_picture_says_so_and_goes_on() {
    let mut window = open("chain");
    click(&mut window, "Energies as PNG");
    window.run_steps(120);
    assert!(
        window.state().notice().is_some_and(|notice| notice.contains("no picture")),
        "{:?}",
        window.state().notice()
    );
}

/// Accuracy and drift can be saved.
#[test]
fn nets_and_toys_are_studied_while_the_scene_goes_on() {
    for (level, entry) in [("hanging_net", "# reference: Runge-Kutta 4"), ("pendulum", "# reference: exact: ")] {
        let mut window = open(level);
        measure(&mut window, "Work-precision diagram");
        draw(&window);
        has_head(&table(&mut window, "Accuracy as CSV"), &[entry, "# reference_error_at_most: "]);
        click(&mut window, "Close");
        press(&mut window, Key::M);
        let time = window.state().snapshot().time;
        measure(&mut window, "Drift study");
        assert!(window.state().snapshot().time > time, "time goes on");
        draw(&window);
        let drift = table(&mut window, "Drift as CSV");
        has_head(&drift, &["# energy_scale_j: "]);
        assert!(drift.contains("RungeKutta4"), "{drift}");
    }
}

/// Where there is no mesh it says so.
#[test]
fn the_mesh_study_tells_how_much_triangles_lock() {
    let mut window = open("cantilever");
    measure(&mut window, "Mesh study");
    draw(&window);
    assert!(window.query_by_label_contains("at ν = 0.4999 the tip moves").is_some());
    assert!(window.query_by_label_contains("The error falls like: linear h^1.").is_some());
    // Each other kind is compared with the finest mesh of linear triangles.
    assert!(window.query_all_by_label_contains("triangles is at least as exact as linear with").count() == 2);
    has_head(
        &table(&mut window, "Meshes as CSV"),
        &["# reference: ", "# reference_error_estimate: ", "# locking_at_nu_0.4999: "],
    );
    let mut window = open("chain");
    measure(&mut window, "Mesh study");
    assert!(window.query_by_label_contains("No mesh of this level has a resolution to vary.").is_some());
    assert!(window.query_by_label("Meshes as CSV").is_none(), "there is nothing to save");
}

#[test]
fn the_error_budget_is_drawn_and_saved() {
    let mut window = open("hanging_net");
    measure(&mut window, "Error budget");
    draw(&window);
    for label in ["Moves by", "half of it", "left out"] {
        assert!(window.query_all_by_label(label).next().is_some(), "{label}");
    }
    let table = table(&mut window, "Budget as CSV");
    has_head(&table, &["# ms_per_simulated_s: "]);
    assert!(table.contains("\ntime step,half of it,") && table.contains("\ngravity,left out,"), "{table}");
    let mut window = open("gingerbread");
    measure(&mut window, "Error budget");
    assert!(window.query_by_label_contains("Nothing moves in this level").is_some());
}

#[test]
fn a_study_of_a_scene_at_rest_says_so_and_suggests_nothing() {
    let mut window = open("gingerbread");
    measure(&mut window, "Work-precision diagram");
    draw(&window);
    assert!(window.query_by_label_contains("Nothing moves here").is_some());
    assert!(window.query_by_label("Use it").is_none() && window.query_by_label_contains("Cheapest under").is_none());
    let table = table(&mut window, "Accuracy as CSV");
    has_head(&table, &["# remark: Nothing moves here"]);
    assert!(!table.contains("inf") && !table.contains("unstable"), "{table}");
}

/// It can be begun anew.
#[test]
fn a_cancelled_study_keeps_its_results() {
    let mut window = open("gingerbread_pulled");
    click(&mut window, "Drift study");
    click(&mut window, "Measure");
    for _ in 0..100_000 {
        if window.query_by_label("Drift as CSV").is_some() {
            break;
        }
        window.run_steps(1);
    }
    click(&mut window, "Cancel");
    window.run_steps(10);
    assert!(window.query_by_label("Cancel").is_none() && window.query_by_label("Measure").is_some());
    has_head(&table(&mut window, "Drift as CSV"), &["# level: Gingerbread, pulled and released"]);
}

#[test]
fn studies_fit_into_a_small_window_with_a_name_on_every_widget() {
    for size in [(1280.0, 800.0), (600.0, 600.0)] {
        let mut window = open_level(level("circle"), size.0, size.1);
        if size.0 < 900.0 {
            click(&mut window, "Cost panel");
        }
        measure(&mut window, "Work-precision diagram");
        for topic in ["Meshes", "Drift", "Budget", "Accuracy"] {
            if size.0 < 900.0 {
                click(&mut window, topic);
            } else {
                window.get_all_by_label(topic).last().unwrap().click();
                window.run_steps(3);
            }
            window.check_accessibility();
            draw(&window);
        }
        let button = window.get_by_label("Accuracy as PNG").rect();
        assert!(button.right() < size.0 && button.bottom() < size.1, "{button:?}");
    }
}

#[test]
fn escape_closes_a_study_and_the_hard_cases() {
    let mut window = open("gingerbread");
    let windows: [(&[&str], &str); 2] =
        [(&["Work-precision diagram"], "Measure"), (&["Level", "Hard cases…"], "All materials")];
    for (ways, inside) in windows {
        for way in ways {
            click_in_panel(&mut window, way);
        }
        assert!(window.query_by_label(inside).is_some(), "{inside}");
        press(&mut window, Key::Escape);
        assert!(window.query_by_label(inside).is_none(), "{inside}");
    }
}

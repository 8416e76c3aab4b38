//! Promises about level files: what ships runs and repeats, and a bad file is told exactly what is wrong with it.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a failing test should panic")]

use crate::common::{MODES, folder::Folder, level, sheet, simulation};
use gingerbread::{
    files::{self, Disk, FileError},
    integrators::Class,
    level::{Check, Level, RunMode, SubstepMode, Switch},
    levels::BUILT_IN,
    materials::Model,
    scene::{Net, Scene, SceneError},
    simulation::Simulation,
    stability::critical_step,
    state::State,
};
use std::{fmt::Write as _, fs, path::PathBuf};

/// Every level that ships runs 2 s in every bit as recorded. After a deliberate change of physics or of a level, renew the record
/// with `GINGERBREAD_RENEW=1 cargo test --test levels` and say in the commit why it changed.
#[test]
fn every_level_runs_two_seconds_to_its_recorded_bits() {
    let record = PathBuf::from("tests/level_hashes.txt");
    let mut lines = String::new();
    for (file, text) in BUILT_IN {
        for mode in MODES {
            let level = Level { mode, ..files::parse(text, file).unwrap() };
            let mut simulation = simulation(&level);
            let steps = (2.0 / simulation.scene().step).round() as u64;
            assert_eq!(simulation.advance(steps, &mut || true), steps, "{file}: {:?}", simulation.fault());
            assert!(simulation.state().is_finite(), "{file}");
            writeln!(lines, "{file} {mode:?} {:016x}", simulation.state().hash()).unwrap();
        }
    }
    if std::env::var_os("GINGERBREAD_RENEW").is_some() {
        fs::write(&record, &lines).unwrap();
    }
    assert_eq!(fs::read_to_string(&record).unwrap(), lines, "left: recorded, right: now");
}

/// Whatever a person switches on in a level that ships, its step stays below the stability limit at rest, damping included.
#[test]
fn every_level_is_stable_at_its_step_with_and_without_damping() {
    let mut near = Vec::new();
    for (file, text) in BUILT_IN {
        for switch in [Switch::On, Switch::Off] {
            let mut level = files::parse(text, file).unwrap();
            level.mode = RunMode::Collide;
            if level.integrator.kind().class() == Class::Implicit {
                continue; // It has no such limit.
            }
            level.effects.iter_mut().for_each(|listed| listed.switch = switch);
            for &model in Model::ALL {
                level.bodies.iter_mut().for_each(|body| body.material = body.material.with_model(model));
                let simulation = simulation(&level);
                let share =
                    if level.paces == SubstepMode::Own { greatest_share(&simulation) } else { share(&simulation) };
                // A toy has no stiffness that would limit the step, nor has a net whose lengths are kept by projection.
                let is_slack = |net: &Net| net.springs.links().iter().all(|link| link.stiffness == 0.0);
                let Some(share) = share else {
                    assert!(level.toy.is_some() || simulation.scene().nets.iter().all(is_slack), "{file}");
                    continue;
                };
                if share > 0.8 {
                    near.push(format!("{file} {} {switch:?}: {share:.2}", model.name()));
                }
            }
        }
    }
    assert!(near.is_empty(), "over 0.8 of the stability limit: {near:#?}");
}

/// The step over the longest stable one.
fn share(simulation: &Simulation) -> Option<f64> {
    let limit = critical_step(simulation.scene(), &rest(simulation), None)?;
    Some(simulation.scene().step / limit)
}

/// The same of the body or net that is nearest to its own limit, where each goes at its own pace.
fn greatest_share(simulation: &Simulation) -> Option<f64> {
    let shares = simulation.scene().sub_scenes.iter().zip(simulation.substep_plans()).filter_map(|(alone, pace)| {
        let rest = State { x: alone.scene.rest.clone(), ..alone.scene.start.clone() };
        Some(pace.step / critical_step(&alone.scene, &rest, None)?)
    });
    shares.reduce(f64::max)
}

fn rest(simulation: &Simulation) -> State {
    State { x: simulation.scene().rest.clone(), ..simulation.state().clone() }
}

#[test]
fn every_level_survives_being_written_and_read_back() {
    for (file, text) in BUILT_IN {
        let level = files::parse(text, file).unwrap();
        assert_eq!(files::parse(&files::write(&level).unwrap(), file).unwrap(), level);
        assert!(!level.name.is_empty() && !level.about.is_empty(), "{file} should say what there is to see");
    }
    let names: Vec<_> = BUILT_IN.iter().map(|(file, _)| *file).collect();
    for needed in ["gingerbread.ron", "gingerbread_house.ron", "stretch_test.ron"] {
        assert!(names.contains(&needed));
    }
}

/// The place and the message for a mistake in a level; `mistake` replaces `part` of a good one.
fn told(part: &str, mistake: &str) -> (usize, usize, String) {
    let good = "(\n  name: \"a\",\n  bodies: [(\n    name: \"b\",\n    mesh: Disk(radius: 0.2, rings: 5),\n    mass: Total(25),\n    material: (model: Corotated, young: 10, poisson: 0.3, plane: Strain),\n  )],\n)\n";
    assert!(files::parse(good, "good.ron").is_ok() && good.contains(part));
    match files::parse(&good.replace(part, mistake), "bad.ron") {
        Err(FileError::Text { file, line, column, what }) if file == "bad.ron" => (line, column, what),
        other => panic!("{mistake}: {other:?}"),
    }
}

#[test]
fn a_mistake_is_told_with_place_and_expectation() {
    let cases = [
        ("name: \"a\"", "nme: \"a\"", (2, 3), "nme"),
        ("mass: Total(25)", "mass: Total(25), colour: 3", (6, 22), "colour"),
        ("mass: Total(25)", "mass: Total(\"heavy\")", (6, 17), "float"),
        ("mass: Total(25)", "mass: Heavy(25)", (6, 11), "Density"),
        (
            "mass: Total(25)",
            "mass: Total(-25)",
            (6, 17),
            "total mass must be greater than 0 and at most 1e12 kg, got -25",
        ),
        ("mass: Total(25)", "mass: Total(NaN)", (6, 17), "got NaN"),
        ("mass: Total(25)", "mass: Total(1e999)", (6, 17), "got inf"),
        ("young: 10", "young: 0", (7, 41), "Young's modulus must be greater than 0 and at most 1e15 Pa, got 0"),
        (
            "poisson: 0.3",
            "poisson: 0.7",
            (7, 72),
            "less than 0.5 for plane strain (at most 0.5 for plane stress), got 0.7",
        ),
        ("poisson: 0.3", "poisson: 0.5", (7, 72), "greater than -1 and less than 0.5 for plane strain"),
        ("model: Corotated", "model: Jelly", (7, 23), "Corotated"),
        ("rings: 5", "rings: 0", (5, 36), "rings"),
        ("mesh: Disk(radius: 0.2, rings: 5)", "mesh: Disk(radius: 0.2", (6, 5), ""),
        ("name: \"b\"", "name: 5", (4, 10), "string"),
        ("bodies: [(", "substeps: 0, bodies: [(", (3, 13), "substeps must be at least 1 and at most 100000, got 0"),
        (
            "bodies: [(",
            "substeps: -1, bodies: [(",
            (3, 13),
            "substeps must be a whole number, at least 1 and at most 100000, got -1",
        ),
        (
            "name: \"b\"",
            "pins: [Vertex(-1)], name: \"b\"",
            (4, 20),
            "expected a whole number, at least 0 and at most 4294967295, got -1",
        ),
        (
            "name: \"b\"",
            "start: Point(seed: 5000000000), name: \"b\"",
            (4, 24),
            "expected a whole number, at least 0 and at most 4294967295, got 5000000000",
        ),
        (
            "bodies: [(",
            "substeps: 1.5, bodies: [(",
            (3, 13),
            "substeps must be a whole number, at least 1 and at most 100000, got 1.5",
        ),
    ];
    for (part, mistake, place, expected) in cases {
        let (line, column, what) = told(part, mistake);
        assert_eq!((line, column), place, "{mistake}: {what}");
        assert!(what.contains(expected), "{mistake}: {what}");
    }
    let message = files::parse("(name: 5)", "five.ron").unwrap_err().to_string();
    assert!(message.starts_with("five.ron:1:"), "{message}");
}

#[test]
fn broken_text_is_refused_without_a_panic() {
    for (_, text) in BUILT_IN {
        for end in (0..text.trim_end().len()).step_by(7).filter(|end| text.is_char_boundary(*end)) {
            assert!(files::parse(&text[..end], "cut.ron").is_err());
        }
    }
    assert!(files::parse(&"[".repeat(100_000), "deep.ron").is_err());
    assert!(files::parse(&"(".repeat(100_000), "deep.ron").is_err());
}

fn refused(level: &Level) -> String {
    Scene::build(level, level.mode, &Disk, None).err().map(|error| error.to_string()).unwrap_or_default()
}

#[test]
fn a_level_that_cannot_be_built_names_the_wrong_part() {
    let empty = Level { bodies: Vec::new(), ..sheet("Corotated", "", "") };
    assert_eq!(refused(&empty), SceneError::Nothing.to_string());
    let pinned = refused(&sheet("Corotated", "pins: [Vertex(25)]", ""));
    assert!(pinned.contains("sheet") && pinned.contains("from 0 to 24"), "{pinned}");
    let edges = "effects: [(effect: Boundary(least: (1, 0), greatest: (0, 1)))]";
    assert!(refused(&sheet("Corotated", "", edges)).contains("lower left corner"));
    let off = "effects: [(effect: Boundary(least: (1, 0), greatest: (0, 1)), switch: Off)]";
    assert!(
        refused(&sheet("Corotated", "", off)).contains("lower left corner"),
        "a mistake counts also when switched off"
    );
    let far = refused(&sheet("Corotated", "place: (offset: (1e15, 0), scale: 1e9)", ""));
    assert!(far.contains("beyond 1e15 m"), "{far}");
    let lost = level(
        "(name: \"\", bodies: [(name: \"man\", mesh: Obj(path: \"nowhere.obj\"), mass: Total(1), material: (model: Corotated, young: 1, poisson: 0))])",
    );
    assert!(refused(&lost).contains("nowhere.obj"));
}

#[test]
fn a_saved_state_of_another_mesh_is_refused() {
    let simulation = simulation(&sheet("Corotated", "", ""));
    let mut saved = simulation.saved().unwrap();
    saved.positions.pop();
    let error = simulation.scene().first_state(Some(&saved)).unwrap_err().to_string();
    assert!(error.contains("24 positions") && error.contains("25 vertices"), "{error}");
}

#[test]
fn what_would_never_end_is_refused_at_once() {
    let state = "state: (steps: 18446744073709551615, time: 0, positions: [], velocities: [])";
    let text = format!("(name: \"\", bodies: [], {state})");
    assert!(files::parse(&text, "steps.ron").unwrap_err().to_string().contains("steps must be at least 0 and at most"));
    let body = "(name: \"big\", mesh: Disk(radius: 1, rings: 500), mass: Total(1), material: (model: Corotated, young: 1, poisson: 0))";
    let many = level(&format!("(name: \"\", bodies: [{}])", [body; 3].join(",")));
    assert!(refused(&many).contains("more than 2000000"), "{}", refused(&many));
    let corners: Vec<_> = (0..2000).map(|i| format!("({i}, {})", i * i)).collect();
    let effect =
        format!("effects: [(effect: Walls(obstacles: [Polygon(points: [{}], eps: 0.01)]))]", corners.join(","));
    assert!(refused(&sheet("Corotated", "", &effect)).contains("1000 corners"));
    assert!(files::read(std::path::Path::new("/dev/zero")).is_err() || cfg!(not(unix)));
}

#[test]
fn saving_replaces_the_whole_file_and_paths_of_meshes_follow() {
    let whole = Folder::new("levels");
    let folder = &whole.0;
    fs::create_dir(folder.join("meshes")).unwrap();
    fs::write(folder.join("meshes/two.obj"), "v 0 0\nv 1 0\nv 1 1\nv 0 1\nf 1 2 3 4\n").unwrap();
    let path = folder.join("level.ron");
    let text = "(name: \"two\", bodies: [(name: \"two\", mesh: Obj(path: \"meshes/two.obj\"), mass: Total(1), material: (model: Corotated, young: 1, poisson: 0))])";
    fs::write(&path, text).unwrap();
    let read = files::read(&path).unwrap();
    assert_eq!(simulation_of(&read).scene().triangles.len(), 2, "the mesh is found next to the level");
    files::save(&path, &read).unwrap();
    assert!(fs::read_to_string(&path).unwrap().contains("\"meshes/two.obj\""), "a saved path stays relative");
    assert_eq!(files::read(&path).unwrap(), read);
    let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert!(names.into_iter().all(|name| !name.contains("part")), "nothing half-written is left");
    fs::create_dir_all(folder.join("elsewhere")).unwrap();
    let elsewhere = folder.join("elsewhere/level.ron");
    files::save(&elsewhere, &read).unwrap();
    assert_eq!(simulation_of(&files::read(&elsewhere).unwrap()).scene().triangles.len(), 2, "from anywhere");
    let error = files::save(&folder.join("no/such/folder.ron"), &read).unwrap_err().to_string();
    assert!(error.contains("folder.ron"), "{error}");
}

fn simulation_of(level: &Level) -> Simulation {
    let scene = Scene::build(level, level.mode, &Disk, None).unwrap();
    let state = scene.start.clone();
    Simulation::new(scene, state)
}

/// Every known result of a level that ships is met, and docs/accuracy.md tells what was measured. Renew its table with
/// `GINGERBREAD_RENEW=1 cargo test --test levels`.
#[test]
fn known_results_are_met() {
    let mut table = "| level | what | known | measured | tolerance | source |\n|---|---|---|---|---|---|\n".to_owned();
    let mut count = 0;
    for (file, text) in BUILT_IN {
        let level = files::parse(text, file).unwrap();
        let mut simulation = simulation(&level);
        let Some(steps) = simulation.steps_to_last_check() else { continue };
        assert_eq!(simulation.advance(steps, &mut || true), steps, "{file}: {:?}", simulation.fault());
        for (placed, measured) in simulation.checks() {
            let (check, unit) = (&placed.check, placed.unit);
            let measured = measured.unwrap();
            assert!(placed.is_met(measured), "{file}, {}: {measured} {unit}", check.name);
            let (level, known, tolerance) = (file.trim_end_matches(".ron"), check.value.get(), check.tolerance.get());
            let Check { name, source, .. } = check;
            let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
            writeln!(
                table,
                "| `{level}` | {name} | {known}{unit} | {measured:.5e}{unit} | {tolerance}{unit} | {source} |"
            )
            .unwrap();
            count += 1;
        }
    }
    assert!(count > 5, "{count}");
    let page = PathBuf::from("docs/accuracy.md");
    let text = fs::read_to_string(&page).unwrap();
    let begin = text.find("| level | what | known |").unwrap();
    let end = begin + text[begin..].find("\n\n").unwrap() + 1;
    if std::env::var_os("GINGERBREAD_RENEW").is_some() {
        fs::write(&page, format!("{}{table}{}", &text[..begin], &text[end..])).unwrap();
    } else {
        assert_eq!(&text[begin..end], table, "left: docs/accuracy.md, right: now");
    }
}

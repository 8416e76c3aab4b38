//! What every command promises about its inputs, its outputs, its messages and its exit code.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::program::{Folder, command, gingerbread, said};
use std::{fs, process::Stdio};

/// Two triangles that share nothing.
const PIECES: &str = "(name: \"pieces\", bodies: [(name: \"glass\", mass: Total(1), place: (offset: (0.2, 0.2)),
    mesh: Points(points: [(0, 0), (0.1, 0), (0, 0.1), (0.3, 0), (0.4, 0), (0.3, 0.1)], triangles: [(0, 1, 2), (3, 4, 5)]),
    material: (model: Corotated, young: 1000, poisson: 0.3))])";

/// A soft triangle whose tip moves at a velocity.
fn tip(model: &str, velocity: &str) -> String {
    format!(
        "(name: \"tip\", substeps: 10, bodies: [(name: \"flag\", mass: Total(1),
            mesh: Points(points: [(0, 0), (1, 0), (0.5, 1)], triangles: [(0, 1, 2)]),
            material: (model: {model}, young: 0.01, poisson: 0.3))],
          state: (steps: 0, time: 0, positions: [(0, 0), (1, 0), (0.5, 1)], velocities: [(0, 0), (0, 0), {velocity}]))"
    )
}

fn json(path: &str) -> serde_json::Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

/// A quick study.
fn study<'a>(level: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let quick = ["study", level, "--integrators", "SymplecticEuler", "--steps", "4", "--seconds", "0.05"];
    [&quick[..], more].concat()
}

/// A quick hard case.
fn hard<'a>(case: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["hard", case, "--model", "Corotated", "--integrator", "ImplicitEuler"][..], more].concat()
}

/// A hard case of a level that lasts two steps.
fn case(level: &str) -> String {
    format!("(level: {level}, lasts: Steps(2), expects: Bounded)")
}

#[test]
fn every_command_tells_the_warnings_of_check() {
    let folder = Folder::new("warnings");
    let level = folder.with("pieces.ron", PIECES);
    let (report, csv) = (folder.file("report.json"), folder.file("study.csv"));
    let warning = "glass: the mesh is 2 separate pieces";
    assert!(said(&gingerbread(&["check", &level]).stdout).contains(warning));
    let outside = PIECES
        .replace("(0.2, 0.2)", "(9, 9)")
        .replace("))])", "))], effects: [(effect: Boundary(least: (0, 0), greatest: (1, 1)))])");
    let outside = folder.with("outside.ron", &outside);
    for (level, told) in
        [(&level, warning), (&outside, "6 vertices begin inside walls, other bodies or outside the domain")]
    {
        let output = gingerbread(&["run", level, "--steps", "2", "--report", &report]);
        assert!(output.status.success() && said(&output.stderr).contains(told), "{}", said(&output.stderr));
        let warnings = json(&report)["warnings"].to_string();
        assert!(warnings.contains(told) && warnings.contains(warning), "{warnings}");
        let output = gingerbread(&study(level, &["--csv", &csv]));
        assert!(said(&output.stderr).contains(told), "{}", said(&output.stderr));
        let head = fs::read_to_string(&csv).unwrap();
        assert!(head.lines().any(|line| line.starts_with("# warning: ") && line.contains(told)), "{head}");
        let case = folder.with("case.ron", &case(&fs::read_to_string(level).unwrap()));
        let output = gingerbread(&hard(&case, &[]));
        assert!(said(&output.stderr).contains(told), "{}", said(&output.stderr));
    }
    gingerbread(&["run", "jelly_disk", "--steps", "2", "--report", &report]);
    assert_eq!(json(&report)["warnings"], serde_json::json!([]));
}

#[test]
fn a_run_that_ends_inverted_says_where_and_ends_with_3() {
    let folder = Folder::new("inverted");
    let (level, report, saved) = (folder.with("tip.ron", ""), folder.file("report.json"), folder.file("saved.ron"));
    for model in ["StVenantKirchhoff", "Corotated", "StableNeoHookean"] {
        fs::write(&level, tip(model, "(0, -20)")).unwrap();
        let output = gingerbread(&["run", &level, "--steps", "60", "--report", &report, "--save", &saved]);
        let told = said(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{model}: {told}");
        assert!(told.contains("not physical: triangle 0 of flag is inverted (J = -"), "{told}");
        let state = &json(&report)["end_state"];
        assert_eq!((&state["physical"], &state["newly_inverted"]), (&false.into(), &1.into()));
        assert!(said(&output.stdout).contains("60 steps"), "the summary is printed all the same");
        // What begins inside out and stays so is told, and no failure.
        let output = gingerbread(&["run", &saved, "--steps", "1", "--report", &report]);
        assert!(output.status.success() && said(&output.stderr).contains("inverted at the start already"));
        let state = &json(&report)["end_state"];
        assert_eq!((&state["physical"], &state["still_inverted"]), (&true.into(), &1.into()));
    }
}

#[test]
fn a_run_that_ends_in_an_absurd_state_ends_with_3() {
    let folder = Folder::new("absurd");
    let level = folder.with("tip.ron", &tip("Corotated", "(0, 1e6)"));
    let output = gingerbread(&["run", &level, "--steps", "60"]);
    let told = said(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{told}");
    assert!(told.contains("triangle 0 of flag has J = ") && told.contains("an absurd size"), "{told}");
    let output = gingerbread(&["run", "jelly_disk", "--steps", "2"]);
    assert!(output.status.success() && output.stderr.is_empty(), "{}", said(&output.stderr));
    assert!(said(&gingerbread(&["run", "--help"]).stdout).contains("3 `run` came to its end, but"));
}

#[test]
fn outputs_are_tried_before_the_work_and_left_as_they_are() {
    let folder = Folder::new("probe");
    let (kept, new, bad) = (folder.with("kept", "precious"), folder.file("new"), folder.file("no/such/folder.csv"));
    // These would go on for days.
    let long = [
        vec!["run", "jelly_disk", "--seconds", "1e9", "--state", &kept, "--save", &new, "--report", &bad],
        vec!["run", "jelly_disk", "--seconds", "1e9", "--state", folder.0.to_str().unwrap()],
        vec!["study", "jelly_disk", "--seconds", "1e6", "--csv", &bad],
        vec!["hard", "--times", "10000", "--csv", &bad],
    ];
    for arguments in long {
        let output = gingerbread(&arguments);
        let told = said(&output.stderr);
        assert!(output.status.code() == Some(2) && output.stdout.is_empty(), "{arguments:?}: {told}");
        assert!(told.contains("--") && (told.contains("folder is not there") || told.contains("directory")), "{told}");
    }
    assert_eq!(fs::read_to_string(&kept).unwrap(), "precious");
    assert_eq!(fs::read_dir(&folder.0).unwrap().count(), 1, "nothing is left over");
}

#[test]
#[cfg(target_os = "linux")]
fn one_output_that_fails_loses_no_other_result() {
    let folder = Folder::new("full");
    let (report, saved) = (folder.file("report.json"), folder.file("saved.ron"));
    let runs = [
        (
            vec!["run", "circle", "--steps", "9", "--state", "/dev/full", "--report", &report, "--save", &saved],
            "9 steps",
        ),
        (study("jelly_disk", &["--csv", "/dev/full"]), "Cheapest under"),
        (hard("stretch_2", &["--csv", "/dev/full"]), "stretch_2"),
    ];
    for (arguments, printed) in runs {
        let arguments = if arguments[0] == "study" { study("jelly_disk", &["--csv", "/dev/full"]) } else { arguments };
        let output = gingerbread(&arguments);
        let told = said(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {told}");
        assert!(said(&output.stdout).contains(printed), "{arguments:?}");
        assert!(told.contains("/dev/full: No space left"), "{told}");
    }
    assert_eq!(json(&report)["steps"], 9);
    assert!(fs::read_to_string(saved).unwrap().contains("steps: 9"));
}

#[test]
fn a_hard_case_that_cannot_be_built_loses_no_other() {
    let folder = Folder::new("unbuilt");
    let empty = folder.with("empty.ron", "(level: (name: \"empty\"), lasts: Steps(2), expects: Bounded)");
    let csv = folder.file("table.csv");
    let output = gingerbread(&hard(&empty, &["stretch_2", "--csv", &csv]));
    let told = said(&output.stderr);
    assert!(output.status.code() == Some(2) && told.contains("empty: a level needs"), "{told}");
    assert!(said(&output.stdout).contains("stretch_2") && fs::read_to_string(csv).unwrap().contains("stretch_2,"));
}

#[test]
#[cfg(unix)]
fn data_on_standard_output_sends_the_summary_elsewhere() {
    let folder = Folder::new("stdout");
    let names: &[&str] = if cfg!(target_os = "linux") { &["-", "/dev/stdout", "/dev/fd/1"] } else { &["-"] };
    let run = |name| ["run", "circle", "--steps", "2", "--state", name].map(str::to_owned);
    for name in names {
        let output = command(&[]).args(run(name)).output().unwrap();
        let (data, told) = (said(&output.stdout), said(&output.stderr));
        assert!(output.status.success() && data.starts_with("time_s,") && data.lines().count() == 2, "{data}{told}");
        assert!(told.contains("2 steps"), "{told}");
    }
    // Also where standard output is a file, even the very file that is named.
    let file = folder.file("data.csv");
    for name in names.iter().copied().chain([file.as_str()]) {
        let out = fs::File::create(&file).unwrap();
        let output = command(&[]).args(run(name)).stdout(out).stderr(Stdio::piped()).output().unwrap();
        let data = fs::read_to_string(&file).unwrap();
        assert!(output.status.success() && data.starts_with("time_s,") && data.lines().count() == 2, "{name}: {data}");
        assert!(said(&output.stderr).contains("2 steps"), "{name}");
    }
    let output = gingerbread(&study("jelly_disk", &["--csv", "-"]));
    assert!(said(&output.stdout).starts_with("# level: ") && said(&output.stderr).contains("Cheapest under"));
    let output = gingerbread(&hard("stretch_2", &["--csv", "-"]));
    assert!(said(&output.stdout).starts_with("case,undamped,model,") && said(&output.stderr).contains("stable ("));
}

#[test]
#[cfg(unix)]
fn outputs_go_through_pipes_links_and_long_names() {
    use std::os::unix::fs::symlink;
    let folder = Folder::new("places");
    let run = |path: &str| {
        let output = gingerbread(&["run", "circle", "--steps", "2", "--state", path]);
        assert!(output.status.success(), "{path}: {}", said(&output.stderr));
    };
    let pipe = folder.file("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    std::thread::scope(|scope| {
        let reader = scope.spawn(|| fs::read_to_string(&pipe).unwrap());
        run(&pipe);
        assert!(reader.join().unwrap().starts_with("time_s,"));
    });
    let (link, target) = (folder.file("link"), folder.file("target"));
    symlink("target", &link).unwrap();
    run(&link);
    assert!(
        fs::symlink_metadata(&link).unwrap().is_symlink() && fs::read_to_string(&target).unwrap().lines().count() == 2
    );
    let long = folder.file(&"n".repeat(252));
    for _ in 0..2 {
        run(&long);
        assert_eq!(fs::read_to_string(&long).unwrap().lines().count(), 2);
    }
    let (one, other) = (folder.with("one", "old"), folder.file("other"));
    fs::hard_link(&one, &other).unwrap();
    run(&one);
    assert_eq!(fs::read(&one).unwrap(), fs::read(&other).unwrap(), "both names are still one file");
    assert_eq!(fs::read_dir(&folder.0).unwrap().count(), 6, "nothing is left over");
}

#[test]
#[cfg(unix)]
fn a_writable_file_in_a_read_only_folder_is_written() {
    use std::os::unix::{
        fs::{MetadataExt, PermissionsExt, chown},
        process::CommandExt,
    };
    const NOBODY: u32 = 65534;
    let folder = Folder::new("readonly");
    let (file, program) = (folder.with("state.csv", "old"), folder.file("program"));
    // Nothing is read-only for root, so another user runs the program then, from where he can reach it.
    // Copied by another process: a program that this one has open for writing while another test starts a process cannot be run.
    let copied = std::process::Command::new("cp").args([env!("CARGO_BIN_EXE_gingerbread"), &program]).status().unwrap();
    assert!(copied.success());
    let root = fs::metadata(&file).unwrap().uid() == 0;
    if root {
        chown(&file, Some(NOBODY), Some(NOBODY)).unwrap();
    }
    fs::set_permissions(&folder.0, fs::Permissions::from_mode(0o555)).unwrap();
    let mut command = std::process::Command::new(&program);
    command.args(["run", "circle", "--steps", "2", "--state", &file]);
    if root {
        command.uid(NOBODY).gid(NOBODY);
    }
    let output = command.output().unwrap();
    fs::set_permissions(&folder.0, fs::Permissions::from_mode(0o755)).unwrap();
    assert!(output.status.success(), "{}", said(&output.stderr));
    assert_eq!(fs::read_to_string(&file).unwrap().lines().count(), 2);
}

#[test]
#[cfg(unix)]
fn an_output_that_is_an_input_or_another_output_is_refused() {
    let folder = Folder::new("same");
    let mesh = folder.with("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let text = "(name: \"mesh\", bodies: [(name: \"b\", mass: Total(1), mesh: Obj(path: \"mesh.obj\"),
        material: (model: Corotated, young: 1000, poisson: 0.3))])";
    let level = folder.with("level.ron", text);
    let hard_case = folder.with("case.ron", &case(PIECES));
    let (link, new) = (folder.file("link"), folder.file("new"));
    std::os::unix::fs::symlink("level.ron", &link).unwrap();
    let (around, new_again) = (folder.file("./mesh.obj"), folder.file("./new"));
    let refused = [
        vec!["run", &level, "--save", &link],
        vec!["run", &level, "--state", &around],
        vec!["run", &level, "--state", &new, "--report", &new_again],
        vec!["run", &level, "--state", "-", "--report", "/dev/stdout"],
        study(&level, &["--csv", &level]),
        hard(&hard_case, &["--csv", &hard_case]),
    ];
    for arguments in refused {
        let output = gingerbread(&arguments);
        let told = said(&output.stderr);
        assert!(output.status.code() == Some(2) && told.contains("is the same file as"), "{arguments:?}: {told}");
    }
    assert_eq!((fs::read_to_string(&level).unwrap(), fs::metadata(&mesh).unwrap().len()), (text.to_owned(), 32));
    assert!(!fs::exists(&new).unwrap());
    let output = gingerbread(&["run", &level, "--steps", "2", "--state", "/dev/null", "--report", "/dev/null"]);
    assert!(output.status.success(), "a device is no file: {}", said(&output.stderr));
}

#[test]
fn a_closed_pipe_never_causes_a_panic() {
    let every = [
        vec!["check", "circle", "pendulum"],
        vec!["run", "circle", "--steps", "2"],
        vec!["run", "circle", "--steps", "2", "--state", "-"],
        study("jelly_disk", &[]),
        hard("stretch_2", &[]),
        vec!["--help"],
        vec!["run", "--help"],
    ];
    for arguments in every {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = command(&arguments).stdout(writer).stderr(Stdio::piped()).output().unwrap();
        let told = said(&output.stderr);
        assert!(output.status.success() && !told.contains("panicked"), "{arguments:?}: {told}");
        #[cfg(target_os = "linux")]
        {
            let full = || fs::File::options().write(true).open("/dev/full").unwrap();
            let output = command(&arguments).stdout(full()).stderr(Stdio::piped()).output().unwrap();
            let told = said(&output.stderr);
            assert!(output.status.code() == Some(2) && told.contains("No space left"), "{arguments:?}: {told}");
            let output = command(&["run", "no_such"]).stderr(full()).output().unwrap();
            assert_eq!(output.status.code(), Some(2));
        }
    }
}

#[test]
fn tables_keep_their_columns_whatever_a_name_holds() {
    let folder = Folder::new("quoting");
    let name = "case, with \"comma\"";
    let case = folder.with(&format!("{name}.ron"), &case(PIECES));
    let output = gingerbread(&hard(&case, &["--csv", "-"]));
    let mut reader = csv::Reader::from_reader(output.stdout.as_slice());
    let rows: Vec<_> = reader.records().map(Result::unwrap).collect();
    assert!(rows.len() == 1 && rows[0].len() == 19 && &rows[0][0] == name, "{rows:?}");
    let level = folder.with(
        "level.ron",
        &PIECES.replace("\"pieces\"", "\"a, \\\"b\\\"\\n#c\\u{1b}[31m\"").replace("mass:", "spin: 3, mass:"),
    );
    let output = gingerbread(&study(&level, &["--csv", "-"]));
    let text = said(&output.stdout);
    assert!(text.starts_with("# level: a, \"b\" #c\\u{1b}[31m\n"), "{text}");
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
    assert!(reader.records().map(Result::unwrap).count() > 0);
}

#[test]
fn a_toy_exports_its_state_and_goes_on_from_a_saved_one() {
    let folder = Folder::new("toy");
    let (saved, csv) = (folder.file("saved.ron"), folder.file("state.csv"));
    for (toy, head) in
        [("circle", "time_s,x_m,y_m,exact_x_m,exact_y_m"), ("pendulum", "time_s,angle_rad,rate_rad_per_s,")]
    {
        let state = |level: &str, steps: &str, more: &[&str]| {
            let arguments = [&["run", level, "--steps", steps, "--state", &csv][..], more].concat();
            let output = gingerbread(&arguments);
            assert!(output.status.success(), "{}", said(&output.stderr));
            fs::read_to_string(&csv).unwrap()
        };
        let whole = state(toy, "50", &[]);
        let (first, row) = whole.trim_end().split_once('\n').unwrap();
        assert!(first.starts_with(head), "{first}");
        let numbers: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
        assert!(numbers.len() == 5 && numbers[0] > 0.0 && (numbers[1] - numbers[3]).abs() < 0.1, "{row}");
        state(toy, "30", &["--save", &saved]);
        assert_eq!(state(&saved, "20", &[]), whole);
    }
}

#[test]
fn control_characters_never_reach_the_terminal() {
    let folder = Folder::new("control");
    let evil = "\\u{1b}[31mred\\u{7}\\u{9b}2J\\u{202e}\\nlines";
    let level =
        folder.with("level\u{1b}[2J.ron", &PIECES.replace("pieces\"", &format!("{evil}\"")).replace("glass", evil));
    let case = folder.with("case\u{1b}[2J.ron", &case(&PIECES.replace("glass", evil)));
    let every = [
        vec!["check", &level],
        vec!["run", &level, "--steps", "2"],
        study(&level, &[]),
        hard(&case, &[]),
        vec!["run", "no\u{1b}[2Jsuch"],
        vec!["run", "circle", "--model", "\u{1b}[31m"],
        vec!["run", "circle", "\u{1b}[31m"],
    ];
    for arguments in every {
        let output = gingerbread(&arguments);
        let text = said(&output.stdout) + &said(&output.stderr);
        let harmful = |c: char| (c.is_control() && c != '\n') || c == '\u{202e}';
        assert!(!text.contains(harmful), "{arguments:?}: {text:?}");
        // The parser of arguments leaves such sequences out.
        assert!(text.contains("\\u{1b}[") || arguments[1] == "circle", "{arguments:?}: {text:?}");
        assert!(!text.lines().any(|line| line.starts_with("lines")), "{text}");
    }
}

#[test]
fn a_missing_level_is_told_with_the_names_there_are() {
    for arguments in [vec!["nosuch"], vec!["run", "nosuch"], vec!["check", "nosuch"], vec!["study", "nosuch"]] {
        let output = gingerbread(&arguments);
        let told = said(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{told}");
        assert!(told.contains("nosuch: there is no such file, and no built-in level of that name"), "{told}");
        let names = gingerbread::levels::BUILT_IN.iter().map(|(file, _)| file.trim_end_matches(".ron"));
        assert!(names.into_iter().all(|name| told.contains(name)) && told.lines().count() == 1, "{told}");
    }
    let told = said(&gingerbread(&["hard", "nosuch"]).stderr);
    assert!(told.contains("no built-in hard case of that name") && told.contains("thin_wall"), "{told}");
    let told = said(&gingerbread(&["run", "circle.ron"]).stderr);
    assert!(told.contains("circle.ron: there is no such file; the built-in level is called circle"), "{told}");
}

/// Hard cases run by name or from a file, with their scripted actions.
#[test]
fn levels_are_read_from_standard_input_and_pipes() {
    let folder = Folder::new("sources");
    let fed = |arguments: &[&str], text: &str| {
        let mut child =
            command(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        std::io::Write::write_all(&mut child.stdin.take().unwrap(), text.as_bytes()).unwrap();
        child.wait_with_output().unwrap()
    };
    let state = folder.file("state.csv");
    for arguments in [&["check", "-"][..], &["run", "-", "--steps", "2", "--state", &state], &study("-", &[])] {
        let output = fed(arguments, PIECES);
        assert!(output.status.success(), "{arguments:?}: {}", said(&output.stderr));
    }
    assert_eq!(fs::read_to_string(&state).unwrap().lines().count(), 7);
    let wrong = fed(&["check", "-"], "(name: 3)");
    assert!(!wrong.status.success() && said(&wrong.stderr).contains("-:1:"), "{}", said(&wrong.stderr));
    #[cfg(unix)]
    {
        let pipe = folder.file("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let writer = std::thread::spawn({
            let pipe = pipe.clone();
            move || fs::write(pipe, PIECES).unwrap()
        });
        let output = gingerbread(&["run", &pipe, "--steps", "2"]);
        writer.join().unwrap();
        assert!(output.status.success(), "{}", said(&output.stderr));
    }
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/levels/hard/gravity_flips.ron");
    let mut states = Vec::new();
    for name in ["gravity_flips", file] {
        assert!(gingerbread(&["check", name]).status.success());
        let output = gingerbread(&["run", name, "--seconds", "0.3", "--state", &state]);
        assert!(output.status.success(), "{}", said(&output.stderr));
        states.push(fs::read_to_string(&state).unwrap());
        let output = gingerbread(&study(name, &[]));
        assert!(said(&output.stdout).contains("scripted actions of this level are not performed"), "{name}");
    }
    assert_eq!(states[0], states[1]);
    // Without its actions it ends elsewhere.
    let text = fs::read_to_string(file).unwrap();
    let still = folder.with("still.ron", &text.replace("action: FlipGravity", "action: Release"));
    gingerbread(&["run", &still, "--seconds", "0.3", "--state", &state]);
    assert_ne!(fs::read_to_string(&state).unwrap(), states[0]);
    // What decides about a hard case is checked too.
    let odd = folder.with("odd.ron", &text.replace("expects: Bounded", "expects: Luck"));
    let output = gingerbread(&["check", &odd]);
    assert!(!output.status.success() && said(&output.stderr).contains("Luck"), "{}", said(&output.stderr));
    let output = gingerbread(&["check", "gravity_flip"]);
    assert!(said(&output.stderr).contains("gravity_flips"), "{}", said(&output.stderr));
}

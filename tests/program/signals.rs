//! SIGINT and SIGTERM: a long command writes what there is, marked as partial.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]
#![cfg(unix)]

use crate::program::{Folder, command, said};
use std::{
    fs,
    io::{BufRead, BufReader},
    process::{Child, ChildStderr, Command, Stdio},
};

/// The program at work, once it has told that it is.
struct Work {
    child: Child,
    told: BufReader<ChildStderr>,
}

impl Work {
    fn begin(arguments: &[&str]) -> Self {
        let arguments = [arguments, &["--progress", "0.01"]].concat();
        let mut child = command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let told = BufReader::new(child.stderr.take().unwrap());
        let mut work = Self { child, told };
        work.wait_for("done after");
        work
    }

    /// Reads until a line holds this.
    fn wait_for(&mut self, text: &str) {
        let mut line = String::new();
        while !line.contains(text) {
            line.clear();
            assert!(self.told.read_line(&mut line).unwrap() > 0, "it ended without {text:?}");
        }
    }

    fn send(&self, signal: &str) {
        let sent = Command::new("kill").args([signal, &self.child.id().to_string()]).status().unwrap();
        assert!(sent.success());
    }

    /// The exit code, and what was printed since.
    fn end(mut self) -> (Option<i32>, String, String) {
        let drain = std::thread::spawn(move || {
            let rest: Vec<_> = self.told.lines().map(Result::unwrap).collect();
            rest.join("\n")
        });
        let mut out = Vec::new();
        std::io::Read::read_to_end(&mut self.child.stdout.take().unwrap(), &mut out).unwrap();
        (self.child.wait().unwrap().code(), said(&out), drain.join().unwrap())
    }
}

#[test]
fn a_run_that_is_interrupted_writes_what_there_is() {
    let folder = Folder::new("interrupted");
    let [state, report, saved] = ["state.csv", "report.json", "saved.ron"].map(|name| folder.file(name));
    for (signal, code, name) in [("-INT", 130, "SIGINT"), ("-TERM", 143, "SIGTERM")] {
        let run = ["run", "jelly_disk", "--seconds", "1e6"];
        let work = Work::begin(&[&run[..], &["--state", &state, "--report", &report, "--save", &saved]].concat());
        work.send(signal);
        let (ended, printed, told) = work.end();
        assert_eq!(ended, Some(code), "{told}");
        let partial = format!("stopped by {name} after ");
        assert!(told.contains("the results are partial") && told.contains(&partial), "{told}");
        assert!(printed.contains(" steps to "), "{printed}");
        let report: serde_json::Value = serde_json::from_str(&fs::read_to_string(&report).unwrap()).unwrap();
        assert!(report["partial"].as_str().unwrap().contains(&partial) && report["steps"].as_u64().unwrap() > 0);
        let state = fs::read_to_string(&state).unwrap();
        assert!(state.starts_with(&format!("# partial: {partial}")) && state.lines().count() > 100, "{}", &state[..80]);
        assert!(fs::read_to_string(&saved).unwrap().contains("positions"));
    }
}

#[test]
fn an_interrupted_film_is_whole_and_shorter() {
    let folder = Folder::new("interrupted-film");
    let path = folder.with("man.gif", "old");
    let work = Work::begin(&["render", "gingerbread", "--seconds", "300", "--out", &path, "--size", "64x64"]);
    work.send("-INT");
    let (ended, printed, told) = work.end();
    assert_eq!((ended, printed.contains("Partial: stopped by SIGINT")), (Some(130), true), "{printed}{told}");
    let mut film = gif::DecodeOptions::new().read_info(fs::File::open(&path).unwrap()).unwrap();
    let mut frames = 0;
    while film.next_frame_info().unwrap().is_some() {
        frames += 1;
    }
    assert!(printed.contains(&format!("\n{frames} frame")), "{frames} frames: {printed}");
    assert_eq!(fs::read_dir(std::path::Path::new(&path).parent().unwrap()).unwrap().count(), 1, "no half file is left");
}

#[test]
fn an_interrupted_study_or_gallery_writes_what_there_is() {
    let folder = Folder::new("interrupted-study");
    let csv = folder.file("table.csv");
    let works = [
        vec!["study", "jelly_disk", "--seconds", "1000"],
        vec!["study", "jelly_disk", "--seconds", "1000", "--drift"],
        vec!["study", "jelly_disk", "--seconds", "1000", "--meshes", "50,200"],
        vec!["hard", "--times", "10000"],
    ];
    for arguments in works {
        let work = Work::begin(&[&arguments[..], &["--csv", &csv]].concat());
        work.send("-INT");
        let (ended, printed, told) = work.end();
        assert_eq!(ended, Some(130), "{arguments:?}: {told}");
        assert!(printed.contains("Partial: stopped by SIGINT") && told.contains("partial"), "{printed}{told}");
        let table = fs::read_to_string(&csv).unwrap();
        assert!(table.starts_with("# partial: stopped by SIGINT at about "), "{table}");
        assert!(table.contains("case,undamped,model") || table.contains("# level: "), "{table}");
    }
}

/// Nobody reads the pipe, so the program waits for ever with what it has to write.
#[test]
fn a_second_signal_ends_the_program_at_once() {
    let folder = Folder::new("second");
    let pipe = folder.file("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let mut work = Work::begin(&["run", "jelly_disk", "--seconds", "1e6", "--state", &pipe]);
    work.send("-INT");
    work.wait_for("SIGINT");
    work.send("-TERM");
    assert_eq!(work.end().0, Some(143));
}

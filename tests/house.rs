//! The rules of the house, kept mechanically: which room may know what.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a failing test should panic")]

use std::{fs, path::Path};

/// The rooms in reading order; each may use itself and what stands before it. Elements are effects, so those two are one.
const ROOMS: &[&[&str]] = &[
    &["text"],
    &["quantity"],
    &["registry"],
    &["clock"],
    &["terminal"],
    &["table"],
    &["random"],
    &["simd"],
    &["formula"],
    &["materials"],
    &["meshes"],
    &["picture"],
    &["outlines"],
    &["nets"],
    &["solvers"],
    &["obstacles"],
    &["contact", "effects", "elements"],
    &["state"],
    &["integrators"],
    &["toys"],
    &["finish"],
    &["level"],
    &["scene"],
    &["stability"],
    &["inversion_recovery"],
    &["impulse"],
    &["report"],
    &["guard"],
    &["fault"],
    &["simulation", "probe"],
    &["rewind"],
    &["archive"],
    &["command"],
    &["document"],
    &["sandbox"],
    &["snapshot"],
    &["study"],
    &["levels", "files"],
    &["link"],
    &["hard"],
    &["headless"],
    &["app"],
    &["render"],
];

/// Path below `src` and text of every source file.
fn sources() -> Vec<(String, String)> {
    fn walk(folder: &Path, found: &mut Vec<(String, String)>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                walk(&path, found);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let name = path.strip_prefix("src").unwrap().display().to_string();
                found.push((name, fs::read_to_string(&path).unwrap()));
            }
        }
    }
    let mut found = Vec::new();
    walk(Path::new("src"), &mut found);
    assert!(found.len() > 40, "the walk must find the sources");
    found
}

fn room_of(file: &str) -> &str {
    file.split(['/', '.']).next().unwrap()
}

/// Text without comments.
fn code(text: &str) -> String {
    text.lines().map(|line| line.split("//").next().unwrap()).collect::<Vec<_>>().join("\n")
}

#[test]
fn every_room_uses_only_rooms_before_it() {
    let rank = |room: &str| ROOMS.iter().position(|rooms| rooms.contains(&room));
    for (file, text) in sources().iter().filter(|(file, _)| file != "lib.rs" && file != "main.rs") {
        let own = rank(room_of(file)).unwrap_or_else(|| panic!("{file} is in no room: add it to the map"));
        let code = code(text);
        for used in code.match_indices("crate::").flat_map(|(at, _)| names_after(&code[at + 7..])) {
            let other = rank(&used).unwrap_or(0);
            assert!(other <= own, "{file} uses {used}, which comes after it");
        }
    }
}

/// The first names of a path or of a braced list of paths: `a::b` gives a, `{a::{b, c}, d}` gives a and d.
fn names_after(text: &str) -> Vec<String> {
    let name = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let Some(list) = text.strip_prefix('{') else { return vec![name(text)] };
    let mut depth = 0;
    let mut names = vec![name(list.trim_start())];
    for (at, c) in list.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => names.push(name(list[at + 1..].trim_start())),
            _ => {}
        }
    }
    names.retain(|name| !name.is_empty());
    names
}

/// Words that users had to guess at, which the field has plain words for.
const RIDDLES: &[&str] = &[
    "Own paces",
    "Least J",
    "Whole frame",
    "rice of the twin",
    "Its own error",
    "its own error",
    "blurred",
    "A toy has",
    "Not there:",
    "dges of the world",
    "beyond the world",
    "no small motion",
    "too seldom",
    "annot be held",
    "not held, as",
    "NOT HELD",
    "did not work",
    "Got it",
    "went first",
    "blew up",
    "blow up",
    "blind to",
    "cannot afford",
    "came from nowhere",
    "comes from nowhere",
    "must be in [",
    "must be in (",
    "Allowed: [",
];

#[test]
fn messages_say_plainly_what_they_mean() {
    for (file, text) in sources() {
        let shown = code(&text).split("#[cfg(test)]").next().unwrap().to_owned();
        for riddle in RIDDLES {
            assert!(!shown.contains(riddle), "{file} says \"{riddle}\"");
        }
    }
}

#[test]
fn only_the_app_knows_the_window_and_only_obstacles_know_parry() {
    for (file, text) in sources() {
        let code = code(&text);
        assert!(!code.contains("egui") || room_of(&file) == "app", "{file} says egui");
        assert!(!code.contains("parry2d") || room_of(&file) == "obstacles", "{file} says parry2d");
        assert!(!code.contains("spade") || file.starts_with("meshes/"), "{file} says spade");
    }
}

#[test]
fn stepping_is_deterministic_by_construction() {
    for (file, text) in sources().iter().filter(|(file, _)| room_of(file) != "app" && room_of(file) != "headless") {
        let code = code(text);
        assert!(!code.contains("HashMap") && !code.contains("HashSet"), "{file}: order would differ from run to run");
        assert!(!code.contains("mul_add"), "{file}: contraction differs from machine to machine");
        for function in [".sin()", ".cos()", ".sin_cos()", ".ln()", ".exp()", ".powf(", ".atan2(", ".tan()", ".hypot("]
        {
            assert!(!code.contains(function), "{file}: {function} differs between systems; use libm");
        }
    }
}

#[test]
fn files_speak_of_nothing_outside() {
    for (file, text) in sources() {
        assert!(
            !text.contains("/home/") && !text.contains("/root/") && !text.contains("/tmp/"),
            "{file} names a machine"
        );
    }
}

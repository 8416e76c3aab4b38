//! Promises of the documentation: its links lead somewhere, its lists are complete, and the reference of level files is that of the code.
//!
//! `GINGERBREAD_RENEW=1 cargo test --test docs` writes `docs/level-format.md` anew.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a failing test should panic")]

#[path = "docs/level_format.rs"]
mod level_format;

use clap::{Arg, Args as _, Command};
use gingerbread::{
    app::keys::TABLE,
    headless::{Hard, RunRequest, Study},
    levels::{BUILT_IN, HARD, built_in},
};
use level_format::{anchor, declared};
use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    sync::Once,
};

/// The generated page.
const LEVEL_FORMAT: &str = "docs/level-format.md";

/// Most words of the README.
const README_WORDS: usize = 700;

/// Writes the generated page, once and before any page is read, if that is asked for.
fn renew() {
    static RENEWED: Once = Once::new();
    RENEWED.call_once(|| {
        if std::env::var_os("GINGERBREAD_RENEW").is_some() {
            fs::write(LEVEL_FORMAT, level_format::page()).unwrap();
        }
    });
}

/// The text of a page.
fn read(page: impl AsRef<Path>) -> String {
    renew();
    let page = page.as_ref();
    fs::read_to_string(page).unwrap_or_else(|error| panic!("{}: {error}", page.display()))
}

/// All pages.
fn pages() -> Vec<PathBuf> {
    renew();
    let docs = fs::read_dir("docs").unwrap().map(|entry| entry.unwrap().path());
    let docs = docs.filter(|path| path.extension().is_some_and(|extension| extension == "md"));
    let mut pages = Vec::from(["README.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(PathBuf::from));
    pages.extend(docs);
    pages.sort();
    pages
}

/// The lines of a page outside of fenced blocks.
fn lines(text: &str) -> impl Iterator<Item = &str> {
    let mut fenced = false;
    text.lines().filter(move |line| {
        let fence = line.trim_start().starts_with("```");
        fenced ^= fence;
        !fenced && !fence
    })
}

/// The targets of all links and pictures of a page.
fn targets(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for line in lines(text) {
        // Every second piece between backticks is code.
        let words: String = line.split('`').step_by(2).collect();
        let ends = words.match_indices("](").map(|(at, _)| &words[at + 2..]);
        found.extend(ends.filter_map(|rest| Some(rest.split_once(')')?.0.to_owned())));
    }
    found
}

/// The anchors of the headings of a page; a repeated heading gets a number.
fn anchors(text: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for heading in lines(text).filter(|line| line.starts_with('#')) {
        let plain = anchor(heading.trim_start_matches('#').trim());
        let numbered = |count: usize| if count == 0 { plain.clone() } else { format!("{plain}-{count}") };
        let free = (0..=found.len()).map(numbered).find(|name| !found.contains(name));
        found.extend(free);
    }
    found
}

#[test]
fn the_reference_of_level_files_is_that_of_the_code() {
    renew();
    assert_eq!(level_format::unlisted_quantities(), Vec::<String>::new(), "name them in tests/docs/level_format.rs");
    let current = fs::read_to_string(LEVEL_FORMAT).unwrap_or_default() == level_format::page();
    assert!(current, "{LEVEL_FORMAT} is out of date: renew it with GINGERBREAD_RENEW=1 cargo test --test docs");
}

#[test]
fn every_link_leads_to_a_file_or_a_heading() {
    let mut headings = 0;
    for page in pages() {
        for target in targets(&read(&page)).iter().filter(|target| !target.contains("://")) {
            let (file, heading) = target.split_once('#').unwrap_or((target.as_str(), ""));
            let path = if file.is_empty() { page.clone() } else { page.with_file_name(file) };
            assert!(path.exists(), "{}: there is no {target}", page.display());
            if !heading.is_empty() {
                headings += 1;
                let known = anchors(&read(&path));
                assert!(known.iter().any(|name| name == heading), "{}: no heading for {target}", page.display());
            }
        }
    }
    assert!(headings > 10, "only {headings} links to a heading were found");
}

#[test]
fn every_page_is_reached_from_the_index() {
    let (mut reached, mut next) = (BTreeSet::new(), vec![PathBuf::from("docs/README.md")]);
    while let Some(page) = next.pop() {
        if !reached.insert(page.clone()) {
            continue;
        }
        let targets = targets(&read(&page));
        let files = targets.iter().filter_map(|target| target.split('#').next());
        let files = files.filter(|file| !file.is_empty() && !file.contains('/'));
        next.extend(files.map(|file| page.with_file_name(file)));
    }
    for page in pages().iter().filter(|page| page.starts_with("docs")) {
        assert!(reached.contains(page), "no page leads from docs/README.md to {}", page.display());
    }
}

#[test]
fn the_readme_is_short() {
    let words = read("README.md").split_whitespace().count();
    assert!(words <= README_WORDS, "README.md has {words} words; at most {README_WORDS}");
}

#[test]
fn every_level_and_every_hard_case_is_described() {
    for (list, page) in [(BUILT_IN, "docs/levels.md"), (HARD, "docs/hard-cases.md")] {
        let text = read(page);
        for (file, _) in list {
            let name = format!("`{}`", file.trim_end_matches(".ron"));
            assert!(text.contains(&name), "{page} lacks {name}");
        }
    }
}

#[test]
fn the_level_that_is_explained_is_the_one_that_ships() {
    let level = built_in("cantilever").unwrap().trim_end();
    assert!(read("docs/levels.md").contains(level), "docs/levels.md should contain levels/cantilever.ron as it is");
}

/// Each line has the key, its mode and its words.
#[test]
fn the_page_of_keys_lists_every_key() {
    let page = read("docs/keys.md");
    for binding in TABLE {
        let row = format!("| {} | {} | {} |", binding.label, binding.when.title(), binding.words);
        assert!(page.lines().any(|line| line == row), "docs/keys.md lacks the line\n{row}");
    }
}

#[test]
fn the_command_line_page_names_options_and_report_fields() {
    let page = read("docs/command-line.md");
    let options = |command: &Command| {
        let longs = command.get_arguments().filter_map(Arg::get_long);
        longs.map(|long| format!("--{long}")).collect::<Vec<_>>()
    };
    let commands = [
        RunRequest::augment_args(Command::new("run")),
        Study::augment_args(Command::new("study")),
        Hard::augment_args(Command::new("hard")),
    ];
    let mut names: Vec<String> = commands.iter().flat_map(options).collect();
    for report in ["RunReport", "EffectReport", "EnergyReport"] {
        let (_, fields) = declared("headless/report.rs", &format!("pub struct {report} {{"));
        names.extend(fields.into_iter().map(|field| field.name));
    }
    for name in names {
        assert!(page.contains(&format!("`{name}")), "docs/command-line.md lacks `{name}`");
    }
}

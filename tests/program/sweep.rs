//! Sweeps of parameters: the same bytes however they are shared.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::program::{Folder, gingerbread, said};
use std::fs;

const VARY: [&str; 8] =
    ["gingerbread", "--vary", "model=c,n", "--vary", "young=500,2e3,1e9", "--vary", "triangles=60", "--seconds"];

/// The table of a sweep with more options.
fn table(folder: &Folder, name: &str, more: &[&str]) -> String {
    let path = folder.file(name);
    let all = [&["sweep"], &VARY[..], &["0.1", "--probe", "energy,min_j", "--csv", &path], more].concat();
    let output = gingerbread(&all);
    assert!(output.status.success(), "{}", said(&output.stderr));
    path
}

#[test]
fn a_shared_sweep_merges_to_the_same_bytes() {
    let folder = Folder::new("sweep");
    let whole = fs::read_to_string(table(&folder, "whole.csv", &["--threads", "2"])).unwrap();
    let rows: Vec<_> = whole.lines().filter(|line| !line.starts_with('#')).collect();
    assert!(rows[0].starts_with("run,model,young,triangles,kinetic,") && rows.len() == 7, "{whole}");
    assert!(
        rows[1].starts_with("0,c,500,60,") && rows[2].starts_with("1,c,2e3,60,"),
        "the last one changes first: {whole}"
    );
    assert!(rows[3].contains(",done") || rows[3].contains("step"), "a run that stops has a row: {}", rows[3]);
    for count in [2, 7] {
        let shard =
            |own: usize| table(&folder, &format!("{own}-of-{count}.csv"), &["--shard", &format!("{own}/{count}")]);
        let mut tables: Vec<_> = (1..=count).map(shard).collect();
        // The order does not matter, and a share may have been computed twice.
        tables.reverse();
        tables.push(shard(1));
        let merged = folder.file("merged.csv");
        let mut all = vec!["merge"];
        all.extend(tables.iter().map(String::as_str));
        let output = gingerbread(&[&all[..], &["--csv", &merged]].concat());
        assert!(output.status.success(), "{}", said(&output.stderr));
        assert_eq!(fs::read_to_string(&merged).unwrap(), whole, "{count} shares");
        let output = gingerbread(&[&all[..2], &["--csv", &folder.file("part.csv")]].concat());
        assert_eq!(output.status.code(), Some(2));
        assert!(said(&output.stderr).contains("are in no table"), "{}", said(&output.stderr));
    }
}

#[test]
fn tables_that_do_not_belong_together_are_refused() {
    let folder = Folder::new("merge");
    let (one, two) = (table(&folder, "1.csv", &["--shard", "1/2"]), table(&folder, "2.csv", &["--shard", "2/2"]));
    let told = |tables: &[&str]| {
        let output = gingerbread(&[&["merge"], tables, &["--csv", &folder.file("out.csv")]].concat());
        assert_eq!(output.status.code(), Some(2), "{tables:?}");
        said(&output.stderr)
    };
    let changed = folder.with("changed.csv", &fs::read_to_string(&one).unwrap().replace(",done", ",gone"));
    assert!(told(&[&one, &two, &changed]).contains("run 0 differs from that in"));
    let other = folder.with("other.csv", &fs::read_to_string(&two).unwrap().replace("# runs: 6", "# runs: 8"));
    assert!(told(&[&one, &other]).contains("another sweep"));
    let cut = folder.with("cut.csv", &fs::read_to_string(&one).unwrap().replace("\n0,", "\nx,"));
    assert!(told(&[&cut, &two]).contains("expected a row of a run"));
    assert!(told(&[&folder.with("none.csv", "a,b\n1,2\n")]).contains("no table of a sweep"));
    assert!(!std::path::Path::new(&folder.file("out.csv")).exists());
}

#[test]
fn wrong_parameters_are_told_before_the_work() {
    let told = |arguments: &[&str]| {
        let output = gingerbread(&[&["sweep", "gingerbread"], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        said(&output.stderr)
    };
    assert!(told(&["--vary", "yung=1"]).contains("there is no parameter yung"));
    assert!(told(&["--vary", "young=1e3,-1"]).contains("got \"-1\""));
    assert!(told(&["--vary", "young"]).contains("young=1e3,1e4"));
    assert!(told(&["--vary", "young=1", "--shard", "3/2"]).contains("I from 1 to N"));
    assert!(told(&["--vary", "embed=true"]).contains("there is no parameter embed"));
    assert!(told(&["--vary", "young=1", "--probe", "triangle:99999"]).contains("triangle"));
    assert!(told(&[]).contains("--vary"));
}

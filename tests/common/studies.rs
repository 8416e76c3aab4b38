//! What tests of studies share.

use gingerbread::{
    integrators::IntegratorKind,
    level::{Level, Substeps},
    meshes::NoFiles,
    study::{Setting, Trial, is_time_column},
};
use std::time::Duration;

/// As long as it takes.
pub const WHOLE: Duration = Duration::MAX;

/// A level made ready for study.
pub fn trial(level: &Level, seconds: f64) -> Trial {
    Trial::new(level, &NoFiles, seconds).unwrap()
}

/// An integrator by its name.
pub fn kind(name: &str) -> IntegratorKind {
    IntegratorKind::all().into_iter().find(|kind| kind.name() == name).unwrap()
}

/// An integrator and so many steps in 1/60 s.
pub fn setting(name: &str, count: u32) -> Setting {
    Setting { integrator: kind(name), substeps: Substeps::new(count).unwrap() }
}

/// The table without its measured times.
pub fn without_times(csv: &str) -> Vec<Vec<String>> {
    let (head, rows): (Vec<_>, Vec<_>) = csv.lines().partition(|line| line.starts_with('#'));
    let columns: Vec<_> = rows[0].split(',').map(|name| !is_time_column(name)).collect();
    assert!(columns.contains(&false), "times are in columns of their own");
    let keep = |row: &&str| {
        let cells = row.split(',').zip(&columns);
        cells.filter(|(_, keep)| **keep).map(|(cell, _)| cell.to_owned()).collect::<Vec<_>>()
    };
    let head = head.iter().map(|line| vec![(*line).to_owned()]);
    head.chain(rows.iter().map(keep)).collect()
}

/// A level that ships.
pub fn built_in(name: &str) -> Level {
    gingerbread::files::parse(gingerbread::levels::built_in(name).unwrap(), name).unwrap()
}

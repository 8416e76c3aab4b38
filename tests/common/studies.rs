//! What tests of studies share.

use super::named;
use gingerbread::{
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

/// A sheet on which nothing acts.
pub const RESTING: &str = "(name: \"resting\", substeps: 20, bodies: [(name: \"sheet\", mass: Density(1),
    mesh: Rectangle(width: 0.4, height: 0.3, columns: 8, rows: 6, corner: (0.3, 0.3)),
    material: (model: NeoHookean, young: 100, poisson: 0.3))])";

/// An integrator and so many steps in 1/60 s.
pub fn setting(name: &str, count: u32) -> Setting {
    Setting { integrator: named(name), substeps: Substeps::new(count).unwrap() }
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

//! Error against cost of four integrators on a short chain, as CSV: `cargo run --release --example work_precision`.

use gingerbread::{
    files,
    integrators::{Heun, IntegratorKind, RungeKutta4, SymplecticEuler, VelocityVerlet},
    levels,
    meshes::NoFiles,
    study::{Plan, Trial, WorkPrecision},
};
use std::time::Duration;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let text = levels::built_in("chain").ok_or("there is no such level")?;
    let trial = Trial::new(&files::parse(text, "chain.ron")?, &NoFiles, 0.5)?;
    let integrators: Vec<IntegratorKind> = vec![
        SymplecticEuler::default().into(),
        VelocityVerlet::default().into(),
        Heun::default().into(),
        RungeKutta4::default().into(),
    ];
    let mut diagram = WorkPrecision::new(trial, Plan { integrators, ..Plan::default() });
    while !diagram.advance(Duration::from_millis(100))?.finished {}
    print!("{}", diagram.csv());
    Ok(())
}

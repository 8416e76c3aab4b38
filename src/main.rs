//! Opens the window, or runs a headless subcommand.

use clap::{Parser, Subcommand};
use gingerbread::{files, headless};
use std::{path::PathBuf, process::ExitCode};

/// A 2D deformable-body sandbox. Without a subcommand it opens the window.
#[derive(Parser)]
#[command(version, about)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    /// Level to open the window with: a file, or the name of a built-in level.
    level: Option<PathBuf>,
}

#[derive(Subcommand)]
enum Command {
    /// Steps a level without a window.
    Run(headless::Run),
    /// Reads level files and says what is wrong with them.
    Check {
        /// Level files, or names of built-in levels.
        #[arg(required = true)]
        files: Vec<PathBuf>,
    },
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match arguments.command {
        Some(Command::Run(run)) => match headless::run(&run) {
            Ok(report) => {
                println!("{}: {} steps to {:.4} s in {:.3} s, {:.1} ns per triangle and step, total energy {:.6} J, least J {:.4}, state {}",
                    report.level, report.steps, report.time, report.wall_seconds, report.ns_per_triangle_step,
                    report.energy.total, report.min_j, report.state_hash);
                ExitCode::SUCCESS
            }
            Err(error) => fail(&error, error.exit_code()),
        },
        Some(Command::Check { files }) => check(&files),
        None => ExitCode::SUCCESS,
    }
}

/// Checks every file, also after a bad one.
fn check(files: &[PathBuf]) -> ExitCode {
    let mut code = ExitCode::SUCCESS;
    for file in files {
        match headless::check(file) {
            Ok(line) => println!("{line}"),
            Err(error) => code = fail(&error, error.exit_code()),
        }
    }
    code
}

fn fail(error: &dyn std::error::Error, code: u8) -> ExitCode {
    eprintln!("gingerbread: {error}");
    ExitCode::from(code)
}

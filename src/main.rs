//! Opens the window, or runs a headless subcommand.

use clap::{Parser, Subcommand};
use gingerbread::{app, headless};
use std::{path::PathBuf, process::ExitCode};

/// A 2D deformable-body sandbox. Without a subcommand it opens the window.
#[derive(Parser)]
#[command(version, about, args_conflicts_with_subcommands = true)]
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
    /// Tells what accuracy costs: errors against times for many integrators and steps, or for many meshes.
    Study(headless::Study),
    /// Runs the gallery of hard cases and tells which are held; ends with 1 if one is not that should be.
    Hard(headless::Hard),
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
                println!("{report}");
                ExitCode::SUCCESS
            }
            Err(error) => fail(&error, error.exit_code()),
        },
        Some(Command::Study(study)) => match headless::study(&study) {
            Ok(table) => {
                println!("{table}");
                ExitCode::SUCCESS
            }
            Err(error) => fail(&error, error.exit_code()),
        },
        Some(Command::Hard(hard)) => match headless::hard(&hard) {
            Ok(hardness) => {
                println!("{}", hardness.table);
                if hardness.unexplained == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
            }
            Err(error) => fail(&error, error.exit_code()),
        },
        Some(Command::Check { files }) => check(&files),
        None => window(arguments.level.as_deref()),
    }
}

/// Opens the window; where that cannot be, says so and what to do instead.
fn window(level: Option<&std::path::Path>) -> ExitCode {
    // Built once before the window, so that a mistake in a level is told as such.
    let level = match level.map(headless::open).transpose() {
        Ok(level) => level,
        Err(error) => return fail(&error, error.exit_code()),
    };
    let Err(error) = app::run(level) else { return ExitCode::SUCCESS };
    // What went before the last colon are places in the source of libraries.
    let error = error.to_string();
    let cause = error.rsplit(": ").next().unwrap_or(&error).trim_end_matches('.');
    eprintln!(
        "gingerbread: no window can be opened here, as there is no display or no OpenGL on it ({cause}); \
         `gingerbread run LEVEL` works without one."
    );
    ExitCode::from(2)
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

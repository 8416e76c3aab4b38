//! Opens the window, or runs a headless subcommand.
#![warn(clippy::print_stdout, clippy::print_stderr)]

use clap::{Parser, Subcommand};
use gingerbread::{app, headless, link, render, terminal};
use std::{
    path::{Path, PathBuf},
    process::ExitCode,
};

/// A deformable-body sandbox. Without a subcommand it opens the window.
#[derive(Parser)]
#[command(version, about, bin_name = "gingerbread", args_conflicts_with_subcommands = true)]
#[command(after_help = headless::EXIT_CODES)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    /// Level to open the window with: a file, or the name of a built-in level.
    level: Option<PathBuf>,
}

#[derive(Subcommand)]
enum Command {
    /// Steps a level without a window.
    #[command(after_help = headless::EXIT_CODES)]
    Run(headless::RunRequest),
    /// Tells what accuracy costs: errors against times for many integrators and steps, or for many meshes.
    #[command(after_help = headless::EXIT_CODES)]
    Study(headless::Study),
    /// Runs the gallery of hard cases and tells which are held; ends with 1 if one is not that should be.
    #[command(after_help = headless::EXIT_CODES)]
    Hard(headless::Hard),
    /// Searches for random runs of a level that go wrong, and saves the least levels that do; ends with 1 if there are any.
    #[command(after_help = headless::EXIT_CODES)]
    Break(headless::BreakRequest),
    /// Draws a level while it runs into a picture (PNG) or a moving picture (GIF), without a window.
    #[command(after_help = headless::EXIT_CODES)]
    Render(render::Render),
    /// Runs every combination of some parameters of a level into one table, which several computers can share.
    #[command(after_help = headless::EXIT_CODES)]
    Sweep(headless::SweepRequest),
    /// Joins the tables of the shares of a sweep.
    Merge(headless::MergeRequest),
    /// Prints a link that opens a level in the page in a browser; it is also taken in place of a level file.
    Link {
        /// Level file, or name of a built-in level.
        level: PathBuf,
        /// Address of the page; without it only what follows there is printed, from `#` on.
        #[arg(long, default_value = "")]
        page: String,
        /// Put the state after so much simulated time \[s\] into the link: anyone who opens it sees the same run, and whether it comes to the same state.
        #[arg(long, value_parser = headless::seconds, allow_negative_numbers = true)]
        seconds: Option<f64>,
    },
    /// Reads level files and says what is wrong with them.
    Check {
        /// Level files, or names of built-in levels.
        #[arg(required = true)]
        files: Vec<PathBuf>,
    },
}

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return usage(&error),
    };
    let ending = match arguments.command {
        Some(Command::Run(run)) => headless::run(&run),
        Some(Command::Study(study)) => headless::study(&study),
        Some(Command::Hard(hard)) => headless::hard(&hard),
        Some(Command::Break(request)) => headless::search(&request),
        Some(Command::Sweep(request)) => headless::sweep(&request),
        Some(Command::Merge(request)) => headless::merge(&request),
        Some(Command::Render(request)) => render::render(&request),
        Some(Command::Link { level, page, seconds }) => return link(&level, &page, seconds),
        Some(Command::Check { files }) => return check(&files),
        None => return window(arguments.level.as_deref()),
    };
    ending.map_or_else(|error| fail(&error, error.exit_code()), |ending| ExitCode::from(ending.tell()))
}

/// Prints the help that was asked for, or what is wrong with the arguments.
fn usage(error: &clap::Error) -> ExitCode {
    let code = u8::try_from(error.exit_code()).unwrap_or(2);
    if error.use_stderr() {
        terminal::report(error.render().to_string().trim_end());
        return ExitCode::from(code);
    }
    terminal::print(error.render().to_string().trim_end()).map_or_else(|error| unwritten(&error), |()| code.into())
}

/// Opens the window; where that cannot be, says so and what to do instead.
fn window(level: Option<&Path>) -> ExitCode {
    // Built once before the window, so that a mistake in a level is told as such.
    let link = level.and_then(Path::to_str).filter(|address| link::is_link(address));
    let level = match level.map(headless::open).transpose() {
        Ok(level) => level,
        Err(error) => return fail(&error, error.exit_code()),
    };
    let Err(error) = app::run(level, link) else { return ExitCode::SUCCESS };
    // What went before the last colon are places in the source of libraries.
    let error = error.to_string();
    let cause = error.rsplit(": ").next().unwrap_or(&error).trim_end_matches('.');
    let text = format!(
        "gingerbread: no window can be opened here, as there is no display or no OpenGL on it ({cause}); \
         `gingerbread run LEVEL` works without one."
    );
    terminal::report(&text);
    ExitCode::from(2)
}

/// Prints a link.
fn link(level: &Path, page: &str, seconds: Option<f64>) -> ExitCode {
    let read = match seconds {
        Some(seconds) => headless::recorded(level, seconds),
        None => headless::open(level),
    };
    // That of a link stays.
    let camera = level.to_str().and_then(|address| link::view(address).camera);
    let fragment = |level| match camera {
        Some(camera) => link::fragment_seen_from(&level, camera),
        None => link::fragment(&level),
    };
    let fragment = match read.map(fragment) {
        Ok(Ok(fragment)) => fragment,
        Ok(Err(error)) => return fail(&error, 2),
        Err(error) => return fail(&error, error.exit_code()),
    };
    terminal::print(&format!("{page}{fragment}")).map_or_else(|error| unwritten(&error), |()| ExitCode::SUCCESS)
}

/// Checks every file, also after a bad one.
fn check(files: &[PathBuf]) -> ExitCode {
    let mut code = ExitCode::SUCCESS;
    for file in files {
        match headless::check(file) {
            Ok(text) => {
                if let Err(error) = terminal::print(&text) {
                    return unwritten(&error);
                }
            }
            Err(error) => code = fail(&error, error.exit_code()),
        }
    }
    code
}

fn unwritten(error: &std::io::Error) -> ExitCode {
    terminal::report(&format!("gingerbread: standard output: {error}"));
    ExitCode::from(2)
}

fn fail(error: &dyn std::error::Error, code: u8) -> ExitCode {
    terminal::report(&format!("gingerbread: {}", terminal::line(&error.to_string())));
    ExitCode::from(code)
}

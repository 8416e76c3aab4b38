//! The built program, run as in a terminal or a script, and a folder for its files.
#![allow(dead_code, clippy::unwrap_used, reason = "each test file uses its own part, and a failing test should panic")]

#[allow(clippy::duplicate_mod, reason = "a test of the program may share the helpers of the library's tests")]
#[path = "folder.rs"]
mod folder;

pub use folder::Folder;
use std::process::{Command, Output};

/// The program with arguments, to be run.
pub fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gingerbread"));
    command.args(arguments);
    command
}

/// Runs the program to its end.
pub fn gingerbread(arguments: &[&str]) -> Output {
    command(arguments).output().unwrap()
}

/// What was printed.
pub fn said(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

//! Promises of the program in a terminal.

#[path = "../common/arrays.rs"]
mod arrays;
mod claims;
mod command_line;
#[path = "../common/film.rs"]
mod film;
mod headless;
mod inputs;
#[path = "../common/program.rs"]
mod program;
mod render;
mod signals;
mod sweep;

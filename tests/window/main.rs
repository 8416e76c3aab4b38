//! What the window promises, kept without a display: real clicks, drags and keys against the real simulation. Time is the
//! test's own (1/60 s a frame) and every step that is owed is taken, so nothing depends on the machine.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a failing test should panic")]

mod accuracy;
mod advice;
#[path = "../common/arrays.rs"]
mod arrays;
mod compare;
#[path = "../common/film.rs"]
mod film;
mod films;
mod finish;
#[path = "../common/folder.rs"]
mod folder;
mod hard;
mod harness;
mod keys;
mod language;
mod making;
mod measure;
mod panels;
mod picture;
mod recording;
mod rest;
mod stage;
mod studies;
mod tools;
mod trouble;
mod unsaved;

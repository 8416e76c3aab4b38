//! Promises about what accuracy costs: errors against better references, diagrams, suggestions, and that all of it repeats.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

mod common;

#[test]
fn placeholder() {
    assert!(common::models().count() > 2);
}

//! The levels that come with the program: every file of `levels/`, found when the program is built.

include!(concat!(env!("OUT_DIR"), "/levels.rs"));

/// The name of the built-in level the program starts with.
pub const FIRST: &str = "gingerbread";

/// The text of a built-in level, by its file name without `.ron`.
pub fn built_in(name: &str) -> Option<&'static str> {
    BUILT_IN.iter().find(|(file, _)| file.strip_suffix(".ron") == Some(name)).map(|(_, text)| *text)
}

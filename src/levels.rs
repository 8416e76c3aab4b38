//! The levels that come with the program: every file of `levels/`, found when the program is built.

include!(concat!(env!("OUT_DIR"), "/levels.rs"));

/// The text of a built-in level, by its file name with or without `.ron`.
pub fn built_in(name: &str) -> Option<&'static str> {
    let name = name.strip_suffix(".ron").unwrap_or(name);
    BUILT_IN.iter().find(|(file, _)| file.strip_suffix(".ron") == Some(name)).map(|(_, text)| *text)
}

//! The levels and the hard cases that come with the program: every file of `levels/` and `levels/hard/`, found when the program is built.
//!
//! ```
//! use gingerbread::{files, levels};
//!
//! for name in [levels::FIRST, "chain"] {
//!     let text = levels::built_in(name).ok_or("there is no such level")?;
//!     files::parse(text, name)?;
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

include!(concat!(env!("OUT_DIR"), "/levels.rs"));

/// The name of the built-in level the program starts with.
pub const FIRST: &str = "gingerbread";

/// The text of a built-in hard case, by its file name without `.ron`.
pub fn hard_case(name: &str) -> Option<&'static str> {
    find(HARD, name)
}

/// The text of a built-in level, by its file name without `.ron`.
pub fn built_in(name: &str) -> Option<&'static str> {
    find(BUILT_IN, name)
}

fn find(list: &[(&str, &'static str)], name: &str) -> Option<&'static str> {
    list.iter().find(|(file, _)| file.strip_suffix(".ron") == Some(name)).map(|(_, text)| *text)
}

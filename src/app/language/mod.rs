//! Texts of the window in other languages. English stands in the code and is what a text is looked up by; a text that a language lacks stays
//! English.

use fluent_bundle::{FluentArgs, FluentResource, concurrent::FluentBundle};
use serde::{Deserialize, Serialize};
use std::{cell::Cell, collections::HashMap, sync::LazyLock};

/// A language of the window.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq, Serialize)]
#[serde(from = "String", into = "String")]
pub enum Language {
    /// That of the code.
    #[default]
    English,
    /// German.
    German,
}

/// Texts of a language, in the format of Fluent. A text without arguments is formatted once.
struct Texts {
    bundle: FluentBundle<FluentResource>,
    fixed: HashMap<String, String>,
}

/// Texts in German.
static GERMAN: LazyLock<Texts> = LazyLock::new(|| Texts::new(Language::German, include_str!("german.ftl")));

thread_local! {
    /// The language of what this thread draws.
    static CHOSEN: Cell<Language> = const { Cell::new(Language::English) };
}

impl Language {
    /// All languages.
    pub const ALL: [Self; 2] = [Self::English, Self::German];

    /// Its own name.
    pub const fn title(self) -> &'static str {
        match self {
            Self::English => "English",
            Self::German => "Deutsch",
        }
    }

    /// Its code (ISO 639-1).
    const fn code(self) -> &'static str {
        match self {
            Self::English => "en",
            Self::German => "de",
        }
    }

    /// The language of what this thread draws.
    pub fn chosen() -> Self {
        CHOSEN.get()
    }

    /// Sets the language of what this thread draws.
    pub fn choose(self) {
        CHOSEN.set(self);
    }

    /// Its texts; none where it is that of the code.
    fn texts(self) -> Option<&'static Texts> {
        match self {
            Self::English => None,
            Self::German => Some(&GERMAN),
        }
    }
}

impl From<Language> for String {
    fn from(language: Language) -> Self {
        language.code().to_owned()
    }
}

impl From<String> for Language {
    /// The language of a code; English, if there is no such language.
    fn from(code: String) -> Self {
        Self::ALL.into_iter().find(|language| language.code() == code).unwrap_or_default()
    }
}

impl Texts {
    /// Reads texts of a language. What cannot be read stays English.
    fn new(language: Language, source: &str) -> Self {
        let resource = FluentResource::try_new(source.to_owned()).unwrap_or_else(|(resource, _)| resource);
        let mut bundle = FluentBundle::new_concurrent(language.code().parse().into_iter().collect());
        // Marks around arguments would be shown by fonts that lack them.
        bundle.set_use_isolating(false);
        let ids: Vec<String> = source.lines().filter_map(|line| Some(line.split_once(" =")?.0.to_owned())).collect();
        bundle.add_resource_overriding(resource);
        let mut texts = Self { bundle, fixed: HashMap::new() };
        texts.fixed = ids.into_iter().filter_map(|id| Some((id.clone(), texts.format(&id, None)?))).collect();
        texts
    }

    /// A text with its arguments; `None` if there is none, or if it has others.
    fn format(&self, id: &str, arguments: Option<&FluentArgs<'_>>) -> Option<String> {
        let mut errors = Vec::new();
        let pattern = self.bundle.get_message(id)?.value()?;
        let text = self.bundle.format_pattern(pattern, arguments, &mut errors).into_owned();
        errors.is_empty().then_some(text)
    }
}

/// What an English text is looked up by: its letters and digits, in words with hyphens between them. `…` counts as `-more`, a letter outside ASCII
/// as `u` and its code, as in `Energy-u3c8` for `Energy ψ`, and what does not begin with a letter gets `t-` before it.
fn id(english: &str) -> String {
    let mut id = String::with_capacity(english.len() + 2);
    for letter in english.chars() {
        match letter {
            '…' => id.push_str("-more"),
            _ if letter.is_ascii_alphanumeric() => id.push(letter),
            _ if letter.is_alphanumeric() => id.extend(format!("u{:x}", u32::from(letter)).chars()),
            _ if id.is_empty() || id.ends_with('-') => {}
            _ => id.push('-'),
        }
    }
    let id = id.trim_end_matches('-');
    if id.starts_with(|letter: char| letter.is_ascii_alphabetic()) { id.to_owned() } else { format!("t-{id}") }
}

/// A text in the chosen language.
pub fn tr(english: &str) -> &str {
    let texts = Language::chosen().texts();
    texts.and_then(|texts| texts.fixed.get(&id(english))).map_or(english, String::as_str)
}

/// A text with arguments, which stand as `{name}` in it, in the chosen language.
pub fn tr_with(english: &str, arguments: &[(&str, &str)]) -> String {
    let translated = Language::chosen().texts().and_then(|texts| {
        let arguments: FluentArgs<'_> = arguments.iter().map(|(name, value)| (*name, *value)).collect();
        texts.format(&id(english), Some(&arguments))
    });
    translated.unwrap_or_else(|| {
        arguments.iter().fold(english.to_owned(), |text, (name, value)| text.replace(&format!("{{{name}}}"), value))
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a failing test should panic")]
mod tests {
    use super::*;
    use std::{collections::HashSet, fs, path::Path};

    /// Adds what the string literals of all sources in a folder are looked up by.
    fn add_literals(folder: &Path, ids: &mut HashSet<String>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                add_literals(&path, ids);
            } else if path.extension().is_some_and(|ending| ending == "rs") {
                let source = fs::read_to_string(path).unwrap();
                ids.extend(source.split('"').map(id));
            }
        }
    }

    #[test]
    fn every_translation_belongs_to_a_text_of_the_code() {
        let mut ids = HashSet::new();
        add_literals(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut ids);
        let resource = FluentResource::try_new(include_str!("german.ftl").to_owned());
        let resource = resource.map_err(|(_, errors)| errors).unwrap();
        let mut count = 0;
        for line in resource.source().lines().filter(|line| line.contains(" =")) {
            let name = line.split(" =").next().unwrap();
            assert!(GERMAN.bundle.has_message(name), "{line}");
            assert!(ids.contains(name), "no text of the code is looked up by {name}");
            count += 1;
        }
        assert!(count > 300, "{count}");
    }

    #[test]
    fn what_a_language_lacks_stays_english() {
        assert_eq!(tr("Friction"), "Friction");
        Language::German.choose();
        assert_eq!(
            [tr("Friction"), tr("Save…"), tr("Save"), tr("Jerk")],
            ["Reibung", "Speichern …", "Speichern", "Jerk"]
        );
        let (counts, text) = ([("drawn", "3"), ("taken", "7")], "Drawing the film: {drawn} of {taken} frames");
        assert_eq!(tr_with(text, &counts), "Zeichnet den Film: 3 von 7 Bildern");
        assert_eq!(tr_with("{drawn} of {taken} jerks", &counts), "3 of 7 jerks");
        // Without one of its arguments a translation would have a hole.
        assert_eq!(tr_with(text, &counts[..1]), "Drawing the film: 3 of {taken} frames");
    }
}

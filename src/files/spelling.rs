//! Alternative spellings in level files. A replacement has the same number of characters, so places in messages stay
//! valid.

use super::tokens::{Kind, Tokens};

/// Greatest length of text that is searched [bytes].
const LONGEST: usize = 16 << 20;

/// Text without the second brackets of RON's own spelling, `Disk((radius: 1))` or `Disk(Disk(radius: 1))`.
/// Levels omit them. `None` if the text has none of them.
pub(super) fn unwrapped(text: &str) -> Option<String> {
    if text.len() > LONGEST {
        return None;
    }
    let tokens: Vec<_> = Tokens::new(text).collect();
    let mut partners = vec![usize::MAX; tokens.len()];
    let mut open = Vec::new();
    for (number, token) in tokens.iter().enumerate() {
        if token.opens() {
            open.push(number);
        } else if token.closes() {
            partners[open.pop()?] = number;
        }
    }
    let is = |number: usize, mark: char| tokens.get(number).is_some_and(|token| token.is(mark));
    let mut bytes = text.as_bytes().to_vec();
    let mut changed = false;
    for (number, name) in tokens.iter().enumerate().filter(|(_, token)| token.kind == Kind::Word) {
        let repeated =
            tokens.get(number + 2).is_some_and(|second| second.kind == Kind::Word && second.text == name.text);
        let (outer, inner) = (number + 1, number + 2 + usize::from(repeated));
        if !is(outer, '(') || !is(inner, '(') || partners[inner] == usize::MAX {
            continue;
        }
        let last = partners[inner] + usize::from(is(partners[inner] + 1, ','));
        if last + 1 != partners[outer] {
            continue;
        }
        for token in tokens[outer + 1..=inner].iter().chain(&tokens[partners[inner]..=last]) {
            bytes[token.start..token.end()].fill(b' ');
        }
        changed = true;
    }
    if changed { String::from_utf8(bytes).ok() } else { None }
}

/// Text with `/` for every single `\` in the string after `path:`, as in `path: "meshes\man.obj"`. `None` if there is
/// none.
pub(super) fn with_slashes(text: &str) -> Option<String> {
    if !text.contains('\\') {
        return None;
    }
    let mut bytes = text.as_bytes().to_vec();
    let tokens: Vec<_> = Tokens::new(text).collect();
    let mut changed = false;
    for triple in tokens.windows(3) {
        let [name, colon, path] = triple else { continue };
        if !(name.text == "path" && colon.is(':') && path.kind == Kind::Text) {
            continue;
        }
        let mut letters = path.text.bytes().enumerate().peekable();
        while let Some((at, letter)) = letters.next() {
            if letter != b'\\' {
                continue;
            }
            if letters.next_if(|(_, next)| matches!(next, b'\\' | b'"')).is_none() {
                bytes[path.start + at] = b'/';
                changed = true;
            }
        }
    }
    if changed { String::from_utf8(bytes).ok() } else { None }
}

//! Tokens of level files for error messages.

/// Kind of a token.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A name, such as `mesh` or `Disk`.
    Word,
    /// Text that begins like a number, such as `1e-3` or `3kPa`.
    Number,
    /// A string in double quotes.
    Text,
    /// A raw string, such as `r"a\b"`.
    Raw,
    /// A string in single quotes.
    Quoted,
    /// A string or a block comment without an end.
    Open,
    /// Any other single character.
    Mark,
}

/// Token: text with its offset [bytes].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Token<'a> {
    pub kind: Kind,
    pub text: &'a str,
    pub start: usize,
}

impl Token<'_> {
    /// End offset [bytes].
    pub const fn end(&self) -> usize {
        self.start + self.text.len()
    }

    /// Whether it is this character.
    pub fn is(&self, mark: char) -> bool {
        self.kind == Kind::Mark && self.text.chars().eq([mark])
    }

    /// Whether it opens a bracket.
    pub fn opens(&self) -> bool {
        self.kind == Kind::Mark && matches!(self.text, "(" | "[" | "{")
    }

    /// Whether it closes a bracket.
    pub fn closes(&self) -> bool {
        self.kind == Kind::Mark && matches!(self.text, ")" | "]" | "}")
    }
}

/// Tokens of a text, without white space and comments.
pub(super) struct Tokens<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Tokens<'a> {
    pub const fn new(text: &'a str) -> Self {
        Self { text, at: 0 }
    }

    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn token(&mut self, kind: Kind, length: usize) -> Token<'a> {
        let start = self.at;
        self.at += length;
        Token { kind, text: &self.text[start..self.at], start }
    }

    /// Skips white space and comments. A block comment without an end is a token.
    fn skip(&mut self) -> Option<Token<'a>> {
        loop {
            let rest = self.rest().trim_start_matches([' ', '\t', '\n', '\r', '\u{b}', '\u{c}']);
            self.at = self.text.len() - rest.len();
            if rest.starts_with("//") {
                self.at += rest.find('\n').unwrap_or(rest.len());
            } else if rest.starts_with("/*") {
                match comment(rest) {
                    Some(length) => self.at += length,
                    None => return Some(self.token(Kind::Open, rest.len())),
                }
            } else {
                return None;
            }
        }
    }
}

impl<'a> Iterator for Tokens<'a> {
    type Item = Token<'a>;

    fn next(&mut self) -> Option<Token<'a>> {
        if let Some(open) = self.skip() {
            return Some(open);
        }
        let rest = self.rest();
        let first = rest.chars().next()?;
        if first == '"' || first == '\'' {
            let kind = if first == '"' { Kind::Text } else { Kind::Quoted };
            // Single quotes do not span lines. A lone apostrophe is a character by itself.
            let length = string(rest, first).filter(|length| first == '"' || !rest[..*length].contains('\n'));
            return Some(match length {
                Some(length) => self.token(kind, length),
                None if first == '"' => self.token(Kind::Open, rest.len()),
                None => self.token(Kind::Mark, 1),
            });
        }
        if let Some(hashes) = raw(rest) {
            let end = format!("\"{}", "#".repeat(hashes));
            let body = hashes + 2;
            return Some(match rest[body..].find(&end) {
                Some(length) => self.token(Kind::Raw, body + length + end.len()),
                None => self.token(Kind::Open, rest.len()),
            });
        }
        let signed = rest.trim_start_matches(['+', '-']);
        let begins_number = |text: &str| text.trim_start_matches('.').starts_with(|c: char| c.is_ascii_digit());
        if begins_number(rest) || (rest.len() - signed.len() == 1 && begins_number(signed)) {
            return Some(self.token(Kind::Number, rest.len() - signed.len() + number(signed)));
        }
        if first.is_alphabetic() || first == '_' {
            let length = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
            return Some(self.token(Kind::Word, length));
        }
        Some(self.token(Kind::Mark, first.len_utf8()))
    }
}

/// Length of a block comment, which may be nested. `None` if it has no end.
fn comment(text: &str) -> Option<usize> {
    let (mut depth, mut at) = (0, 0);
    while let Some(found) = text[at..].find(['/', '*']) {
        at += found;
        match text.get(at..at + 2) {
            Some("/*") => depth += 1,
            Some("*/") => depth -= 1,
            _ => {
                at += 1;
                continue;
            }
        }
        at += 2;
        if depth == 0 {
            return Some(at);
        }
    }
    None
}

/// Length of a string in the given quotes. `None` if it has no end.
fn string(text: &str, quote: char) -> Option<usize> {
    let mut escaped = false;
    let end = text.char_indices().skip(1).find(|&(_, letter)| {
        let ends = letter == quote && !escaped;
        escaped = letter == '\\' && !escaped;
        ends
    });
    end.map(|(at, _)| at + 1)
}

/// Number of `#` before the quote of a raw string, if one begins here.
fn raw(text: &str) -> Option<usize> {
    let after = text.strip_prefix('r')?;
    let hashes = after.len() - after.trim_start_matches('#').len();
    after[hashes..].starts_with('"').then_some(hashes)
}

/// Length of text that begins like a number, with letters that follow directly.
fn number(text: &str) -> usize {
    let mut before = ' ';
    let end = text.find(|letter: char| {
        let sign = matches!(letter, '+' | '-') && matches!(before, 'e' | 'E');
        let part = letter.is_alphanumeric() || matches!(letter, '.' | '_') || sign;
        before = letter;
        !part
    });
    end.unwrap_or(text.len())
}

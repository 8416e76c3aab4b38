//! Explanations of parse errors of level files.

use super::tokens::{Kind, Token, Tokens};
use ron::error::{Error, SpannedError};

/// Greatest length of text that is searched for mistakes [bytes].
const LONGEST: usize = 4 << 20;

/// Mistake with its place: line and column from 1.
pub(super) struct Slip {
    pub line: usize,
    pub column: usize,
    pub what: String,
}

/// Explains the parser's error.
pub(super) fn explain(text: &str, error: &SpannedError) -> Slip {
    let (line, column) = (error.span.start.line, error.span.start.col);
    if text.len() > LONGEST {
        return Slip { line, column, what: error.code.to_string() };
    }
    let view = View::new(text, offset(text, line, column));
    let brackets = view.brackets();
    let found = view.whole().or_else(|| view.odd_mark()).or_else(|| view.number(&error.code));
    if let Some((at, what)) = found {
        let (line, column) = place(text, at);
        return Slip { line, column, what };
    }
    let mut what = view.expected(&error.code);
    let (mut line, mut column) = (line, column);
    if let Some((at, bracket)) = brackets {
        if at <= view.at || matches!(error.code, Error::Eof | Error::ExpectedStringEnd) {
            (line, column) = place(text, at);
            what = bracket;
        } else {
            what = format!("{what}; perhaps because {bracket}");
        }
    }
    Slip { line, column, what }
}

/// Offset of a line and column [bytes].
fn offset(text: &str, line: usize, column: usize) -> usize {
    let start: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    let along = text[start..].char_indices().nth(column.saturating_sub(1));
    along.map_or(text.len(), |(at, _)| start + at)
}

/// Line and column of an offset [bytes].
fn place(text: &str, at: usize) -> (usize, usize) {
    let before = &text[..at.min(text.len())];
    let line = before.rsplit('\n').next().unwrap_or_default();
    (1 + before.matches('\n').count(), 1 + line.chars().count())
}

/// Start of a token, in back quotes.
fn short(token: &Token<'_>) -> String {
    let mut letters = token.text.lines().next().unwrap_or_default().chars();
    let text: String = letters.by_ref().take(24).collect();
    format!("`{text}{}`", if letters.next().is_some() { "…" } else { "" })
}

/// Text with the place of its error.
struct View<'a> {
    text: &'a str,
    tokens: Vec<Token<'a>>,
    /// Offset of the error [bytes].
    at: usize,
    /// Index of the first token that ends behind the error; the number of tokens at the end of the text.
    here: usize,
}

/// Explanation with its offset [bytes], if found.
type Found = Option<(usize, String)>;

impl<'a> View<'a> {
    fn new(text: &'a str, at: usize) -> Self {
        let tokens: Vec<_> = Tokens::new(text).collect();
        let here = tokens.partition_point(|token| token.end() <= at);
        Self { text, tokens, at, here }
    }

    fn token(&self, number: usize) -> Option<&Token<'a>> {
        self.tokens.get(number)
    }

    fn before(&self, back: usize) -> Option<&Token<'a>> {
        self.tokens.get(self.here.checked_sub(back)?)
    }

    /// Content at the error, for messages.
    fn there(&self) -> String {
        self.token(self.here).map_or_else(|| "the end of the file".to_owned(), short)
    }

    /// Checks for text that is not a level at all.
    fn whole(&self) -> Found {
        const BEGINS: &str = "a level begins with `(name: \"...\",` and ends with `)`";
        let Some(first) = self.token(0) else {
            return Some((0, format!("the file is empty; {BEGINS}")));
        };
        let second = self.token(1);
        let what = if first.is('{') || (first.kind == Kind::Text && second.is_some_and(|mark| mark.is(':'))) {
            format!(
                "this looks like JSON; a level is RON: {BEGINS}, names stand without quotes, and `( )` takes the place of `{{ }}`"
            )
        } else if first.is('<') {
            format!("this looks like XML; a level is RON: {BEGINS}")
        } else if self.text.trim_start().starts_with("---") {
            format!("this looks like YAML; a level is RON: {BEGINS}")
        } else if first.kind == Kind::Word && second.is_some_and(|mark| mark.is(':')) {
            format!(
                "the bracket around the level is missing, or this is YAML; {BEGINS}, with a comma after every entry"
            )
        } else if (first.kind == Kind::Word && second.is_some_and(|mark| mark.is('=')))
            || (first.is('[') && second.is_some_and(|word| word.kind == Kind::Word))
        {
            format!("this looks like TOML; a level is RON: {BEGINS}, with `:` after a name")
        } else {
            return None;
        };
        Some((first.start, what))
    }

    /// First character at or before the error that has no meaning outside strings.
    fn odd_mark(&self) -> Found {
        let until = self.tokens[..(self.here + 1).min(self.tokens.len())].iter();
        let mut inner = None;
        for (number, token) in until.enumerate() {
            if token.kind == Kind::Quoted {
                return Some((
                    token.start,
                    format!("{} stands in single quotes; write it in double quotes: `\"`", short(token)),
                ));
            }
            if token.kind != Kind::Mark
                || "()[],:".contains(token.text)
                || (token.is('#') && self.token(number + 1).is_some_and(|next| next.is('!')))
            {
                continue;
            }
            // The brackets and mark of `#![enable(...)]` at the beginning.
            if token.is('!') && number > 0 && self.tokens[number - 1].is('#') {
                continue;
            }
            inner = Some((number, token));
            break;
        }
        let (number, token) = inner?;
        let mark = token.text.chars().next()?;
        let remedy = match mark {
            '“' | '”' | '„' | '«' | '»' | '‘' | '’' | '‚' | '\'' | '`' => {
                "write text in straight double quotes: `\"`"
            }
            ';' => "write `,` between entries",
            '=' => "write `:` between a name and its value",
            '#' => "write `//` before a comment",
            '−' | '–' | '—' => "write a plain hyphen `-` before a negative number",
            '-' if self.token(number + 1).is_some_and(|next| next.text == "inf") => return None,
            '{' => "write `(`",
            '}' => "write `)`",
            '%' | '°' => "write the number alone, as numbers carry no units",
            '*' | '/' | '^' | '+' | '√' => "write the result, as a level does not compute",
            '，' | '；' | '：' | '（' | '）' => "write the plain ASCII character",
            _ if mark.is_whitespace() || mark == '\u{feff}' || mark == '\u{200b}' => {
                let what = format!("a special space (U+{:04X}) is here; write a plain space", u32::from(mark));
                return Some((token.start, what));
            }
            _ => "take it out, or put the text that it belongs to in double quotes",
        };
        Some((token.start, format!("`{mark}` is here, which has no meaning in a level; {remedy}")))
    }

    /// Numbers with a decimal comma, a unit, or a gap.
    fn number(&self, code: &Error) -> Found {
        let is_number = |token: Option<&Token<'a>>| token.filter(|token| token.kind == Kind::Number).copied();
        // A unit: the letters of the number itself, or a word after it.
        for number in self.here.saturating_sub(2)..=self.here {
            let Some(token) = is_number(self.token(number)) else { continue };
            let after =
                self.token(number + 1).filter(|next| next.kind == Kind::Word && next.start >= self.at.min(token.end()));
            let digits = value(token.text);
            let unit =
                if digits < token.text.len() { Some(&token.text[digits..]) } else { after.map(|next| next.text) };
            let Some(unit) = unit.filter(|unit| unit.chars().all(char::is_alphabetic)) else { continue };
            let colon = usize::from(digits == token.text.len()) + 1;
            if self.token(number + colon).is_some_and(|next| next.is(':')) {
                // It is the name of the next entry: the comma is missing.
                continue;
            }
            return Some((token.start, with_unit(&token.text[..digits], unit)));
        }
        let (here, last) = (is_number(self.token(self.here)), is_number(self.before(1)));
        if let (Some(here), Some(last)) = (here, last)
            && self.text[last.end()..here.start].chars().all(char::is_whitespace)
        {
            let (a, b) = (last.text, here.text);
            return Some((
                here.start,
                format!("`{a}` and `{b}` stand side by side; write `,` between two numbers, or `{a}{b}` if it is one"),
            ));
        }
        self.decimal_comma(code)
    }

    /// `3,5` in place of `3.5`, where a name was expected or where a group has too many numbers.
    fn decimal_comma(&self, code: &Error) -> Found {
        let pair = |number: usize| {
            let [Some(whole), Some(comma), Some(part)] =
                [number, number + 1, number + 2].map(|number| self.token(number))
            else {
                return None;
            };
            let numbers = whole.kind == Kind::Number && part.kind == Kind::Number;
            let close = whole.end() == comma.start && comma.end() == part.start;
            (numbers && comma.is(',') && close && part.text.bytes().all(|digit| digit.is_ascii_digit()))
                .then_some((whole, part))
        };
        let told = |(whole, part): (&Token<'_>, &Token<'_>)| {
            let (a, b) = (whole.text, part.text);
            Some((
                whole.start,
                format!("`{a},{b}` is two numbers; write `{a}.{b}`, with a decimal point, if it is one"),
            ))
        };
        if matches!(
            code,
            Error::ExpectedIdentifier
                | Error::SuggestRawIdentifier(_)
                | Error::InvalidIdentifier(_)
                | Error::UnderscoreAtBeginning
        ) && let Some(found) = (self.here.saturating_sub(3)..=self.here).find_map(pair)
        {
            return told(found);
        }
        // A named value is a single value, even if the error is about its range.
        let named = |number: &usize| {
            number.checked_sub(1).and_then(|before| self.token(before)).is_some_and(|mark| mark.is(':'))
        };
        if matches!(code, Error::Message(_))
            && let Some(found) = (self.here.saturating_sub(3)..=self.here).filter(named).find_map(pair)
        {
            return told(found);
        }
        let too_many = matches!(
            code,
            Error::ExpectedStructLikeEnd
                | Error::ExpectedDifferentLength { .. }
                | Error::ExpectedOptionEnd
                | Error::InvalidValueForType { .. }
                | Error::ExpectedComma
        );
        if too_many {
            // The group that contains the error or ends before it.
            let first = (0..self.here.min(self.tokens.len())).rev().find(|number| self.tokens[*number].opens())?;
            let last = (first + 1..self.tokens.len())
                .find(|number| self.tokens[*number].closes() || self.tokens[*number].opens())?;
            let commas = (first..last).filter(|number| self.tokens[*number].is(',')).count();
            let found = (first..last).find_map(pair)?;
            if commas > 1
                || matches!(code, Error::ExpectedOptionEnd)
                || self.token(first.wrapping_sub(1)).is_some_and(|name| name.kind == Kind::Word)
            {
                return told(found);
            }
        }
        None
    }

    /// Bracket that is not closed, or closed by a bracket of another kind.
    fn brackets(&self) -> Found {
        let mut open: Vec<&Token<'_>> = Vec::new();
        let spot = |token: &Token<'_>| {
            let (line, column) = place(self.text, token.start);
            format!("`{}` of line {line}, column {column}", token.text)
        };
        let partner = |token: &Token<'_>| match token.text {
            "(" => ")",
            "[" => "]",
            _ => "}",
        };
        for token in &self.tokens {
            if token.kind == Kind::Open {
                let (line, column) = place(self.text, token.start);
                let what = if token.text.starts_with("/*") { "the comment" } else { "the text in quotes" };
                return Some((token.start, format!("{what} that begins in line {line}, column {column} has no end")));
            }
            if token.opens() {
                open.push(token);
            } else if token.closes() {
                match open.pop() {
                    Some(opened) if partner(opened) == token.text => {}
                    Some(opened) => {
                        let (line, column) = place(self.text, token.start);
                        let what = format!(
                            "`{}` in line {line}, column {column} meets the {}, which needs `{}` first",
                            token.text,
                            spot(opened),
                            partner(opened)
                        );
                        return Some((token.start, what));
                    }
                    None => return None,
                }
            }
        }
        let opened = open.last()?;
        Some((
            self.text.trim_end().len(),
            format!("the file ends while the {} is open; add `{}`", spot(opened), partner(opened)),
        ))
    }

    /// Expectation of the parser, with the content found.
    fn expected(&self, code: &Error) -> String {
        let there = self.there();
        let here = self.token(self.here);
        let is = |kind: Kind| here.is_some_and(|token| token.kind == kind);
        let entry = is(Kind::Word) || is(Kind::Number) || is(Kind::Text) || here.is_some_and(Token::opens);
        let after_entry = self.before(1).is_some_and(|last| !last.is(',') && !last.is(':') && !last.opens());
        match code {
            Error::ExpectedComma
            | Error::ExpectedArrayEnd
            | Error::ExpectedStructLikeEnd
            | Error::ExpectedOptionEnd
            | Error::ExpectedMapEnd
                if entry && after_entry =>
            {
                format!("expected `,` before {there}: write a comma between two entries")
            }
            Error::ExpectedComma => format!("expected `,` or a closing bracket, found {there}"),
            Error::ExpectedArrayEnd => format!("expected closing `]`, found {there}"),
            Error::ExpectedStructLikeEnd | Error::ExpectedOptionEnd => {
                format!("expected closing `)`, found {there}: this has more entries than it can have")
            }
            Error::ExpectedMapColon => {
                format!("expected `:` after the name {}, found {there}", self.before(1).map_or_else(String::new, short))
            }
            Error::ExpectedString if is(Kind::Word) => {
                format!("expected a string, found {there}: write it in double quotes: `\"`")
            }
            Error::ExpectedString => format!("expected a string in double quotes, found {there}"),
            Error::ExpectedIdentifier | Error::SuggestRawIdentifier(_) if is(Kind::Text) => {
                format!("expected a name, found {there}: write it without quotes")
            }
            Error::ExpectedIdentifier | Error::SuggestRawIdentifier(_) if here.is_some_and(Token::opens) => {
                format!("expected a name, found {there}: write a name before the bracket, or take it out")
            }
            Error::ExpectedIdentifier | Error::SuggestRawIdentifier(_) | Error::InvalidIdentifier(_) => {
                format!("expected a name, found {there}")
            }
            Error::ExpectedFloat | Error::ExpectedInteger => {
                let kind =
                    if matches!(code, Error::ExpectedFloat) { "a number (float)" } else { "a whole number (integer)" };
                let remedy = if is(Kind::Text) { ": write the number without quotes" } else { "" };
                format!("expected {kind}, found {there}{remedy}")
            }
            Error::ExpectedArray => format!("expected a list `[ ]`, found {there}"),
            Error::ExpectedStructLike | Error::ExpectedNamedStructLike(_)
                if here.is_some_and(|token| token.is('[')) =>
            {
                "expected `(`, found `[`: write `( )` around what belongs together; `[ ]` is for lists".to_owned()
            }
            Error::ExpectedStructLike | Error::ExpectedNamedStructLike(_) => format!("expected `(`, found {there}"),
            Error::NoSuchEnumVariant { expected, found, .. } => {
                format!("`{found}` is not known here; expected {}{}", listed(expected), meant(expected, found))
            }
            Error::NoSuchStructField { expected, found, .. } => {
                format!("there is no field `{found}` here; expected {}{}", listed(expected), meant(expected, found))
            }
            Error::MissingStructField { field, .. } => format!("the field `{field}` is missing: add it"),
            Error::DuplicateStructField { field, .. } => format!("the field `{field}` is given twice: take one out"),
            Error::InvalidEscape(_) => {
                "a `\\` in text begins a sign such as `\\n`: write `/` between folders, or `\\\\` for a backslash"
                    .to_owned()
            }
            Error::TrailingCharacters => format!(
                "found {there} after the closing bracket of the level: take it out, or take a bracket out before it"
            ),
            Error::ExceededRecursionLimit => "brackets are nested too deep: take some out".to_owned(),
            Error::Eof => "the file ends too early".to_owned(),
            Error::ExpectedStringEnd => "a text in quotes has no end: add `\"`".to_owned(),
            other => other.to_string(),
        }
    }
}

/// Length of the number at the start of a token.
fn value(text: &str) -> usize {
    let good =
        |length: &usize| text.is_char_boundary(*length) && text[..*length].replace('_', "").parse::<f64>().is_ok();
    if text.starts_with("0x") || text.starts_with("0b") || text.starts_with("0o") {
        return text.len();
    }
    (1..=text.len()).rev().find(good).unwrap_or(text.len())
}

/// Replacement for a number with a unit.
fn with_unit(number: &str, unit: &str) -> String {
    const UNITS: [(&str, f64); 16] = [
        ("Pa", 1.0),
        ("kPa", 1e3),
        ("MPa", 1e6),
        ("GPa", 1e9),
        ("N", 1.0),
        ("kN", 1e3),
        ("m", 1.0),
        ("km", 1e3),
        ("cm", 1e-2),
        ("mm", 1e-3),
        ("s", 1.0),
        ("ms", 1e-3),
        ("kg", 1.0),
        ("g", 1e-3),
        ("t", 1e3),
        ("deg", 1.0),
    ];
    let known =
        UNITS.iter().find(|(name, _)| *name == unit).and_then(|(_, factor)| Some(factor * number.parse::<f64>().ok()?));
    let remedy = known.map_or_else(|| "write the number alone".to_owned(), |value| format!("write `{value}`"));
    format!("`{number} {unit}` has a unit; numbers carry none, they are in m, kg, s, N, Pa and degrees: {remedy}")
}

/// List of names for messages.
fn listed(names: &[&str]) -> String {
    match names {
        [] => "nothing".to_owned(),
        [one] => format!("`{one}`"),
        [others @ .., last] => {
            let others: Vec<_> = others.iter().map(|name| format!("`{name}`")).collect();
            format!("{} or `{last}`", others.join(", "))
        }
    }
}

/// Likely intended name, as an addition to a message.
fn meant(names: &[&str], found: &str) -> String {
    let switch = match found.to_lowercase().as_str() {
        "true" | "yes" => Some("On"),
        "false" | "no" => Some("Off"),
        _ => None,
    };
    let known = |name: &str| names.contains(&name).then(|| name.to_owned());
    let plain = |name: &str| name.to_lowercase().replace(['_', '-'], "");
    let near =
        names.iter().map(|name| (distance(&plain(name), &plain(found)), name)).min_by_key(|(distance, _)| *distance);
    let near = near.filter(|(distance, name)| *distance <= 2.min(name.len() / 3)).map(|(_, name)| (*name).to_owned());
    switch.and_then(known).or(near).map_or_else(String::new, |name| format!("; write `{name}`"))
}

/// Levenshtein distance: the least number of letters to insert, delete or replace.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (line, letter) in a.chars().enumerate() {
        let mut corner = std::mem::replace(&mut row[0], line + 1);
        for (column, other) in b.iter().enumerate() {
            let replaced = corner + usize::from(letter != *other);
            let least = replaced.min(row[column] + 1).min(row[column + 1] + 1);
            corner = std::mem::replace(&mut row[column + 1], least);
        }
    }
    row[b.len()]
}

//! Text of files: decoding of bytes, and line ends.
//!
//! ```
//! use gingerbread::text::decode;
//!
//! assert_eq!(decode(vec![0xEF, 0xBB, 0xBF, b'a', b'\r', b'\n']), "a\n");
//! ```

use std::borrow::Cow;

/// Text of a file, with every line ended by `\n` and no byte-order mark.
///
/// UTF-8 is read as such. UTF-16 is read if a byte-order mark or a zero byte in the first character shows it. All
/// other bytes are read as Latin-1, in which every byte is a character. Older programs write comments and names in
/// it.
pub fn decode(bytes: Vec<u8>) -> String {
    let text = match bytes[..] {
        [0xFF, 0xFE, ref rest @ ..] => utf16(rest, u16::from_le_bytes),
        [0xFE, 0xFF, ref rest @ ..] => utf16(rest, u16::from_be_bytes),
        [1..=0xFF, 0, 1..=0xFF, 0, ..] => utf16(&bytes, u16::from_le_bytes),
        [0, 1..=0xFF, 0, 1..=0xFF, ..] => utf16(&bytes, u16::from_be_bytes),
        _ => String::from_utf8(bytes)
            .unwrap_or_else(|error| error.into_bytes().into_iter().map(char::from).collect::<String>()),
    };
    match normalised(&text) {
        Cow::Borrowed(all) if all.len() == text.len() => text,
        changed => changed.into_owned(),
    }
}

/// Text with every line ended by `\n` (not `\r\n` or `\r`) and no byte-order mark.
pub fn normalised(text: &str) -> Cow<'_, str> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if text.contains('\r') { Cow::Owned(text.replace("\r\n", "\n").replace('\r', "\n")) } else { Cow::Borrowed(text) }
}

fn utf16(bytes: &[u8], unit: impl Fn([u8; 2]) -> u16) -> String {
    let units = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]]));
    char::decode_utf16(units).map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
}

//! Films as a player sees them.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use openh264::{decoder::Decoder, formats::YUVSource as _};

/// A decoded film.
pub struct Film {
    /// Width and height \[pixels\].
    pub size: [usize; 2],
    /// Time between frames \[s\], if it is the same for all.
    pub interval: Option<f64>,
    /// Red, green, blue and alpha of each pixel of each frame.
    pub frames: Vec<Vec<u8>>,
}

fn number(bytes: &[u8], at: usize) -> usize {
    u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()) as usize
}

/// Contents of nested boxes of an MP4 file, by their names from the outermost one.
fn boxed<'a>(mut bytes: &'a [u8], names: &[&str]) -> &'a [u8] {
    for name in names {
        loop {
            let length = number(bytes, 0);
            if &bytes[4..8] == name.as_bytes() {
                bytes = &bytes[8..length];
                break;
            }
            bytes = &bytes[length..];
        }
        // Sample descriptions have a count before them, and those of video their numbers.
        bytes = &bytes[match *name {
            "stsd" => 8,
            "avc1" => 78,
            _ => 0,
        }..];
    }
    bytes
}

/// Parts of a film that stand after their lengths, each with a start code before it instead.
fn with_start_codes(mut units: &[u8]) -> Vec<u8> {
    let mut stream = Vec::new();
    while !units.is_empty() {
        let end = 4 + number(units, 0);
        stream.extend([0, 0, 0, 1]);
        stream.extend(&units[4..end]);
        units = &units[end..];
    }
    stream
}

/// Decodes a film in an MP4 file.
pub fn mp4(file: &[u8]) -> Film {
    let media = boxed(file, &["moov", "trak", "mdia"]);
    let head = boxed(media, &["mdhd"]);
    let scale = number(head, if head[0] == 0 { 12 } else { 20 }) as f64;
    let table = boxed(media, &["minf", "stbl"]);
    let description = boxed(table, &["stsd", "avc1", "avcC"]);
    let mut parameters = Vec::new();
    let mut at = 6;
    for _ in 0..2 {
        let length = usize::from(u16::from_be_bytes([description[at], description[at + 1]]));
        parameters.extend([0, 0, 0, 1]);
        parameters.extend(&description[at + 2..at + 2 + length]);
        at += 3 + length;
    }
    let mut decoder = Decoder::new().unwrap();
    decoder.decode(&parameters).unwrap();
    let (sizes, times) = (boxed(table, &["stsz"]), boxed(table, &["stts"]));
    let mut at = number(boxed(table, &["stco"]), 8);
    let (mut frames, mut size) = (Vec::new(), [0, 0]);
    for sample in 0..number(sizes, 8) {
        let length = number(sizes, 12 + 4 * sample);
        let stream = with_start_codes(&file[at..at + length]);
        at += length;
        let picture = decoder.decode(&stream).unwrap().unwrap();
        let (width, height) = picture.dimensions();
        size = [width, height];
        let mut pixels = vec![0; 4 * width * height];
        picture.write_rgba8(&mut pixels);
        frames.push(pixels);
    }
    let interval = (number(times, 4) == 1).then(|| number(times, 12) as f64 / scale);
    Film { size, interval, frames }
}

//! Levels in the address of a page: a link whose part after `#` is the level itself, or whose part after `?` names one and changes it.
//!
//! The level after `#` is compact RON, compressed (DEFLATE, RFC 1951) and written with the letters of addresses (base64url, RFC 4648). No server sees it, as a
//! browser does not send this part.
//!
//! ```
//! use gingerbread::{level::Level, link};
//!
//! let level = Level::new("Empty");
//! let address = format!("https://page.example/{}", link::fragment(&level)?);
//! assert_eq!(link::level(&address).ok_or("it is a link")??, level);
//! let named = link::level("https://page.example/?level=chain&integrator=Heun").ok_or("it is a link")??;
//! assert_eq!(named.integrator.name(), "Heun");
//! assert!(link::level("https://page.example/#level=%%").ok_or("it is a link")?.is_err());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod query;

pub use query::{Camera, View, set_parameter, view};

use crate::{
    files::{self, FileError},
    level::Level,
};
use base64::{Engine as _, prelude::BASE64_URL_SAFE_NO_PAD};
use flate2::{Compression, read::DeflateDecoder, write::DeflateEncoder};
use percent_encoding::percent_decode_str;
use std::{
    borrow::Cow,
    io::{Read as _, Write as _},
};

/// Name of a link in messages.
const NAME: &str = "link";

/// What stands before the level.
const START: &str = "#level=";

/// What stands between the level and the camera, if there is one.
const CAMERA: &str = "&camera=";

/// Longest part of an address that holds a level \[bytes\].
pub const LONGEST: usize = 8 << 10;

/// Longest text of a level in a link \[bytes\]. Compressed repetitions could be far longer.
const LONGEST_TEXT: u64 = 1 << 20;

/// The part of an address that holds a level, from `#` on. Its running state is left out: the opened level begins at its start.
///
/// # Errors
/// [`FileError::Access`] if the level names a file, or is too long for an address; save it as a file then.
pub fn fragment(level: &Level) -> Result<String, FileError> {
    let level = Level { state: None, ..level.clone() };
    refuse_files(&level)?;
    let text = files::write_compact(&level)?;
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::best());
    let packed = encoder.write_all(text.as_bytes()).and_then(|()| encoder.finish());
    let packed = packed.map_err(|error| refused(error.to_string()))?;
    let fragment = START.to_owned() + &BASE64_URL_SAFE_NO_PAD.encode(packed);
    if fragment.len() > LONGEST {
        let (length, most) = (fragment.len().div_ceil(1024), LONGEST >> 10);
        return Err(refused(format!("this level takes {length} kB, and a link {most} kB at most: save it as a file")));
    }
    Ok(fragment)
}

/// The same, and from where the scene is seen, unless that is beyond all that a link can say.
///
/// # Errors
/// As [`fragment`].
pub fn fragment_seen_from(level: &Level, camera: Camera) -> Result<String, FileError> {
    let (fragment, camera) = (fragment(level)?, camera.to_string());
    // A scene that has exploded may be seen from where no link leads.
    Ok(if camera.parse::<Camera>().is_ok() { fragment + CAMERA + &camera } else { fragment })
}

/// The text of the camera behind the level in an address, if there is one.
fn camera_text(address: &str) -> Option<Cow<'_, str>> {
    let text = address.split_once(START)?.1.split_once(CAMERA)?.1;
    Some(percent_decode_str(text.trim()).decode_utf8_lossy())
}

/// Whether an address holds or names a level.
pub fn is_link(address: &str) -> bool {
    address.contains(START) || query::names_level(address)
}

/// The level in an address, or the one that it names; `None` if there is none.
pub fn level(address: &str) -> Option<Result<Level, FileError>> {
    match address.split_once(START) {
        Some((_, packed)) => {
            Some(read(packed.split_once(CAMERA).map_or(packed, |(packed, _)| packed)).and_then(|level| {
                let is_sound = camera_text(address).is_none_or(|text| text.parse::<Camera>().is_ok());
                if is_sound { Ok(level) } else { Err(refused("its camera is not complete, or was changed".to_owned())) }
            }))
        }
        None => query::names_level(address).then(|| query::level(address)),
    }
}

fn read(packed: &str) -> Result<Level, FileError> {
    if packed.len() > LONGEST {
        return Err(refused(format!("a link has {} kB at most", LONGEST >> 10)));
    }
    let broken = || refused("it is not complete, or was changed".to_owned());
    let packed = BASE64_URL_SAFE_NO_PAD.decode(packed.trim()).map_err(|_| broken())?;
    let mut text = String::new();
    let read = DeflateDecoder::new(&packed[..]).take(LONGEST_TEXT + 1).read_to_string(&mut text);
    if read.map_err(|_| broken())? as u64 > LONGEST_TEXT {
        return Err(refused(format!("its level has more than {} MB", LONGEST_TEXT >> 20)));
    }
    let level = files::parse(&text, NAME)?;
    refuse_files(&level)?;
    Ok(level)
}

/// A link has no folder whose files it could mean.
fn refuse_files(level: &Level) -> Result<(), FileError> {
    match files::mesh_paths(level).first() {
        Some(path) => Err(refused(format!("a level with the file {} does not fit into a link", path.display()))),
        None => Ok(()),
    }
}

fn refused(why: String) -> FileError {
    FileError::Access { file: NAME.to_owned(), why }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a failing test should panic")]
mod tests {
    use super::*;
    use crate::{levels, random};

    fn pack(text: &[u8]) -> String {
        let mut encoder = DeflateEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(text).unwrap();
        START.to_owned() + &BASE64_URL_SAFE_NO_PAD.encode(encoder.finish().unwrap())
    }

    #[test]
    fn every_built_in_level_goes_through_a_link() {
        for (file, text) in levels::BUILT_IN {
            let level = files::parse(text, file).unwrap();
            assert_eq!(super::level(&fragment(&level).unwrap()).unwrap().unwrap(), level, "{file}");
        }
    }

    /// Fewer bytes than the level that they claim to hold: it is not unpacked to its end.
    #[test]
    fn a_link_that_unpacks_to_too_much_is_refused() {
        let link = pack(&vec![b' '; 4 << 20]);
        assert!(link.len() < LONGEST, "{}", link.len());
        assert!(super::level(&link).unwrap().unwrap_err().to_string().contains("more than 1 MB"));
    }

    #[test]
    fn a_link_cannot_name_files_of_this_computer() {
        let text = "(name: \"a\", bodies: [(name: \"b\", mesh: Obj(path: \"/etc/passwd\"), material: (model: Corotated, young: 1, \
                    poisson: 0.3), mass: Total(1))])";
        let error = super::level(&pack(text.as_bytes())).unwrap().unwrap_err().to_string();
        assert!(error.contains("/etc/passwd") && error.contains("does not fit"), "{error}");
    }

    #[test]
    fn a_link_says_from_where_its_level_is_seen() {
        let level = files::parse(levels::built_in("gingerbread_house").unwrap(), "a").unwrap();
        for camera in [Camera::Plane([0.5, -0.25], 3.0), Camera::Space([1.0, 2.0, -3e-6], 0.5, [0.5, -0.125])] {
            let link = fragment_seen_from(&level, camera).unwrap();
            assert_eq!(super::level(&link).unwrap().unwrap(), level);
            assert_eq!(view(&link).camera, Some(camera));
            assert_eq!(view(&(link.replace(',', "%2C") + "\n")).camera, Some(camera));
            assert_eq!(view(&format!("page?level=chain&camera={camera}")).camera, Some(camera));
        }
        let nowhere = Camera::Space([f64::INFINITY; 3], f64::INFINITY, [0.0; 2]);
        assert_eq!(fragment_seen_from(&level, nowhere).unwrap(), fragment(&level).unwrap());
        for wrong in ["", "1,2", "1,2,0", "1,2,NaN", "1,2,1e99", "1,2,3,-4,5,6", "1,2,3,4,5,6,7", "a,b,c"] {
            let link = format!("{}{CAMERA}{wrong}", fragment(&level).unwrap());
            assert!(super::level(&link).unwrap().unwrap_err().to_string().contains("camera"), "{wrong}");
            let named = format!("page?level=chain&camera={wrong}");
            assert!(super::level(&named).unwrap().unwrap_err().to_string().contains("camera"), "{wrong}");
        }
    }

    #[test]
    fn changed_links_are_read_or_refused() {
        let sound = fragment(&files::parse(levels::built_in("gingerbread_house").unwrap(), "a").unwrap()).unwrap();
        let mut read = 0;
        let mut numbers = random::stream(1).map(|number| 0.5 * (number + 1.0));
        let mut pick = |count: usize| (numbers.next().unwrap() * count as f64) as usize;
        for _ in 0..2000 {
            let mut link = sound.clone().into_bytes();
            for _ in 0..=pick(3) {
                let at = START.len() + pick(link.len() - START.len());
                match pick(3) {
                    0 => link[at] = b"ABCDEFabcdef0123456789-_%"[pick(25)],
                    1 => link.truncate(at.max(START.len() + 1)),
                    _ => link.insert(at, b'A'),
                }
            }
            read += usize::from(super::level(&String::from_utf8(link).unwrap()).unwrap().is_ok());
        }
        assert!(read < 200, "{read} of 2000 changed links were read");
    }
}

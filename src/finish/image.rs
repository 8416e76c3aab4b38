//! Images on cloth: PNG files in the text of a level.

use serde::{Deserialize, Serialize};
use std::{fmt, sync::Arc};

/// A PNG file, written in base64 (RFC 4648).
///
/// It is kept as text, so that a level needs no other file.
#[derive(Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Image(Arc<str>);

impl Image {
    /// Most pixels a side.
    pub const MOST_PIXELS: u32 = 1024;

    /// Most letters of its text.
    pub const MOST_LETTERS: usize = 1 << 20;

    /// The first bytes of every PNG file, in base64.
    const HEAD: &str = "iVBORw0KGgo";

    /// Its text.
    pub fn text(&self) -> &str {
        &self.0
    }

    /// Whether both are the same text in memory, or equal.
    pub fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0) || self == other
    }
}

#[cfg(feature = "window")]
mod pixels {
    use super::Image;
    use crate::picture::Picture;
    use base64::{Engine as _, prelude::BASE64_STANDARD};

    impl Image {
        /// Pixels a side of an image that is made from a larger picture.
        pub const USUAL_PIXELS: usize = 256;

        /// An image of a PNG file, which is made smaller if it has more than [`Self::USUAL_PIXELS`] a side.
        ///
        /// # Errors
        /// Why the file is no such picture.
        pub fn of_file(bytes: &[u8]) -> Result<Self, String> {
            /// Most pixels a side of the file.
            const MOST: u32 = 8192;
            let picture = Picture::of_png(bytes, MOST)?.within(Self::USUAL_PIXELS);
            Self::try_from(BASE64_STANDARD.encode(picture.png()?))
        }

        /// Its pixels.
        ///
        /// # Errors
        /// Why the text is no PNG picture.
        pub fn picture(&self) -> Result<Picture, String> {
            let bytes = BASE64_STANDARD.decode(self.text());
            let bytes = bytes.map_err(|error| format!("this is no picture in base64: {error}"))?;
            Picture::of_png(&bytes, Self::MOST_PIXELS)
        }
    }
}

impl fmt::Debug for Image {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Image({} letters)", self.0.len())
    }
}

impl From<Image> for String {
    fn from(image: Image) -> Self {
        image.0.as_ref().to_owned()
    }
}

impl TryFrom<String> for Image {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        if text.len() > Self::MOST_LETTERS {
            return Err(format!(
                "An image may have {} letters at most, but it has {}.",
                Self::MOST_LETTERS,
                text.len()
            ));
        }
        if !text.starts_with(Self::HEAD) {
            return Err("This is no image. Write a PNG file in base64, as the command `base64` gives it.".to_owned());
        }
        let image = Self(text.into());
        #[cfg(feature = "window")]
        image.picture().map_err(|why| format!("This is no image: {why}."))?;
        Ok(image)
    }
}

#[cfg(all(test, feature = "window"))]
#[allow(clippy::unwrap_used, reason = "a failing test should panic")]
mod tests {
    use super::*;
    use crate::picture::Picture;

    #[test]
    fn images_are_read_as_they_are_written_and_others_refused() {
        let large = Picture { size: [600, 300], rgba: [200, 100, 0, 255].repeat(600 * 300) };
        let image = Image::of_file(&large.png().unwrap()).unwrap();
        let picture = image.picture().unwrap();
        assert_eq!((picture.size, &picture.rgba[..4]), ([256, 128], &[200, 100, 0, 255][..]));
        let text = String::from(image.clone());
        assert_eq!(Image::try_from(text.clone()), Ok(image));
        let cut = text[..text.len() / 2].to_owned();
        for wrong in
            [String::new(), "cat.png".to_owned(), cut, text.replace('A', "!"), "i".repeat(Image::MOST_LETTERS + 1)]
        {
            let why = Image::try_from(wrong.clone()).unwrap_err();
            assert!(why.contains("image"), "{why}");
        }
        assert!(Image::of_file(b"GIF89a").is_err());
    }
}

//! Pictures as pixels, and as PNG files.
//!
//! ```
//! use gingerbread::picture::Picture;
//!
//! let checks = Picture { size: [2, 1], rgba: vec![255, 0, 0, 255, 0, 0, 255, 255] };
//! let file = checks.png()?;
//! assert_eq!(Picture::of_png(&file, 100)?, checks);
//! assert!(Picture::of_png(b"GIF89a", 100).is_err());
//! # Ok::<(), String>(())
//! ```

use std::io::Cursor;

/// A picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Width and height \[pixels\].
    pub size: [usize; 2],
    /// Rows from the top, four bytes a pixel: red, green, blue and opacity.
    pub rgba: Vec<u8>,
}

impl Picture {
    /// The picture as a PNG file.
    ///
    /// # Errors
    /// The encoder's own words.
    pub fn png(&self) -> Result<Vec<u8>, String> {
        let mut bytes = Vec::new();
        let [width, height] = self.size.map(|pixels| pixels as u32);
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        let said = |error: png::EncodingError| error.to_string();
        let mut writer = encoder.write_header().map_err(said)?;
        writer.write_image_data(&self.rgba).map_err(said)?;
        writer.finish().map_err(said)?;
        Ok(bytes)
    }

    /// Reads a PNG file with at most so many pixels a side.
    ///
    /// # Errors
    /// Why it is no such picture.
    pub fn of_png(bytes: &[u8], most: u32) -> Result<Self, String> {
        let broken = |error: png::DecodingError| format!("this is no PNG picture: {error}");
        let mut decoder = png::Decoder::new(Cursor::new(bytes));
        decoder.set_transformations(png::Transformations::normalize_to_color8() | png::Transformations::ALPHA);
        let mut reader = decoder.read_info().map_err(broken)?;
        let (width, height) = (reader.info().width, reader.info().height);
        if width > most || height > most {
            return Err(format!("it has {width} x {height} pixels, and {most} a side at most can be read"));
        }
        let mut pixels = vec![0; reader.output_buffer_size().unwrap_or(0)];
        let info = reader.next_frame(&mut pixels).map_err(broken)?;
        let pixels = pixels.chunks_exact(info.color_type.samples()).take(width as usize * height as usize);
        let rgba = pixels.flat_map(|pixel| match *pixel {
            [grey, alpha] => [grey, grey, grey, alpha],
            [red, green, blue, alpha] => [red, green, blue, alpha],
            _ => [255, 255, 255, 0],
        });
        Ok(Self { size: [width as usize, height as usize], rgba: rgba.collect() })
    }

    /// The picture with at most so many pixels a side: each is the mean of the pixels that it covers.
    #[must_use]
    pub fn within(self, most: usize) -> Self {
        let greatest = self.size[0].max(self.size[1]);
        if greatest <= most {
            return self;
        }
        let size = self.size.map(|pixels| (pixels * most / greatest).max(1));
        let range = |number: usize, axis: usize| {
            let at = |number: usize| number * self.size[axis] / size[axis];
            at(number)..at(number + 1).max(at(number) + 1)
        };
        let mut rgba = Vec::with_capacity(4 * size[0] * size[1]);
        for (row, column) in (0..size[1]).flat_map(|row| (0..size[0]).map(move |column| (row, column))) {
            let (rows, columns) = (range(row, 1), range(column, 0));
            let count = rows.len() * columns.len();
            let places = rows.flat_map(|y| columns.clone().map(move |x| 4 * (self.size[0] * y + x)));
            let sum = places.fold([0; 4], |sum: [usize; 4], at| {
                std::array::from_fn(|channel| sum[channel] + usize::from(self.rgba[at + channel]))
            });
            rgba.extend(sum.map(|sum| ((sum + count / 2) / count) as u8));
        }
        Self { size, rgba }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smaller_picture_has_the_means_of_the_pixels() {
        let pixel = |x: usize, y: usize| [(10 * x) as u8, (20 * y) as u8, 7, 255];
        let rgba = (0..4).flat_map(|y| (0..6).flat_map(move |x| pixel(x, y))).collect();
        let small = Picture { size: [6, 4], rgba }.within(3);
        assert_eq!(small.size, [3, 2]);
        assert_eq!(small.rgba[..8], [5, 10, 7, 255, 25, 10, 7, 255]);
        assert_eq!(small.rgba[20..], [45, 50, 7, 255]);
        // Two halves of which one pixel is larger.
        let odd = Picture { size: [3, 1], rgba: vec![0, 0, 0, 255, 9, 9, 9, 255, 11, 11, 11, 255] }.within(2);
        assert_eq!((odd.size, odd.rgba), ([2, 1], vec![0, 0, 0, 255, 10, 10, 10, 255]));
    }
}

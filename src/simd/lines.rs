//! Memory aligned to cache lines.

/// Bytes in a cache line.
const LINE: usize = 64;

/// Additional numbers that a buffer for [`lined`] needs.
pub const SPARE: usize = LINE / size_of::<f64>();

/// Part of a buffer from the first aligned number on. A SIMD load then lies in one cache line instead of two.
pub fn lined(values: &mut [f64]) -> &mut [f64] {
    let skip = values.as_ptr().align_offset(LINE).min(SPARE).min(values.len());
    &mut values[skip..]
}

/// Array that 16-bit indices address without a bounds check.
pub type Indexed16 = [f64; INDEXED16];

/// Length of [`Indexed16`]. A vector can begin at the greatest index.
pub const INDEXED16: usize = u16::MAX as usize + 2;

/// Vector at an index.
#[inline(always)]
pub fn vector(numbers: &Indexed16, place: u16) -> [f64; 2] {
    let place = usize::from(place);
    [numbers[place], numbers[place + 1]]
}

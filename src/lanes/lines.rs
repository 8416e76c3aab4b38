//! Numbers from where a line of memory begins: what the processor moves at a time lies in one line then, not in two.

/// Bytes in a line.
const LINE: usize = 64;

/// How many numbers a buffer needs beside those that [`lined`] is to give.
pub const SPARE: usize = LINE / size_of::<f64>();

/// What follows the first number that begins a line of memory.
pub fn lined(values: &mut [f64]) -> &mut [f64] {
    let skip = values.as_ptr().align_offset(LINE).min(SPARE);
    &mut values[skip..]
}

//! Memory aligned to cache lines.

/// Bytes in a line.
const LINE: usize = 64;

/// How many numbers a buffer needs beside those that [`lined`] is to give.
pub const SPARE: usize = LINE / size_of::<f64>();

/// What follows the first number that begins a line of memory: what the processor moves at a time lies in one line then, not in two.
pub fn lined(values: &mut [f64]) -> &mut [f64] {
    let skip = skip(values);
    &mut values[skip..]
}

fn skip(values: &[f64]) -> usize {
    values.as_ptr().align_offset(LINE).min(SPARE).min(values.len())
}

/// Numbers of one's own: the first begins a line of memory, and so many follow the last that from any of them on there are [`Indexed16`] ones.
#[derive(Debug, Default)]
pub struct Lined {
    values: Vec<f64>,
    count: usize,
}

impl Lined {
    /// Makes them so many.
    pub fn fit(&mut self, count: usize) -> &mut [f64] {
        if self.count != count {
            // Zeros are asked for, not written: what is never touched takes no memory.
            *self = Self { values: vec![0.0; count + INDEXED16 + SPARE], count };
        }
        &mut lined(&mut self.values)[..count]
    }

    /// All of them.
    pub fn numbers(&self) -> &[f64] {
        &self.values[skip(&self.values)..][..self.count]
    }

    /// All of them, and what follows.
    pub fn and_more(&mut self) -> &mut [f64] {
        lined(&mut self.values)
    }
}

/// As many numbers as places of 16 bits reach: where so many are there, nobody has to check a place.
pub type Indexed16 = [f64; INDEXED16];

/// A vector begins at the last of these places at most.
pub const INDEXED16: usize = u16::MAX as usize + 2;

/// The vector at a place.
#[inline(always)]
pub fn vector(numbers: &Indexed16, place: u16) -> [f64; 2] {
    let place = usize::from(place);
    [numbers[place], numbers[place + 1]]
}

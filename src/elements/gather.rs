//! From forces at the corners of elements to forces on vertices.

use super::Target;
use crate::lanes::{LANES, Order, Pairs};
use std::ops::Range;
use wide::f64x2;

/// After how many blocks of elements the vertices are summed that have all their forces by then: enough for long runs of
/// vertices with as many corners as each other, and little enough for the forces to be still near the processor.
pub const STAGE: usize = 128;

/// For each vertex the corners that meet there.
///
/// Forces go to a buffer of corners first and are then summed vertex by vertex, always in the order of the elements: the
/// sum is the same on every run, and no two elements write to the same place. Vertices with as many corners as each other
/// are summed one after another, so that the processor never has to guess how many there are.
#[derive(Debug)]
pub struct Gather {
    /// Runs of vertices with as many corners as each other: the stage, how many corners, and how many vertices.
    runs: Vec<[u32; 3]>,
    /// The vertices, counted from the first of the body or net.
    vertices: Vec<u32>,
    /// The places of their corners' forces in the buffer, one vertex after another.
    places: Vec<u32>,
    /// The first vertex of the body or net.
    first: usize,
}

impl Gather {
    /// `corners` holds the scene vertex numbers of each element's corners.
    pub fn new<const N: usize>(corners: &[[u32; N]], vertices: &Range<usize>) -> Self {
        let mut meeting = vec![Vec::new(); vertices.len()];
        let order = Order::new();
        for (element, corners) in corners.iter().enumerate() {
            for (number, &corner) in corners.iter().enumerate() {
                let place = (element / LANES * N + number) * LANES + order.place[element % LANES];
                meeting[corner as usize - vertices.start].push(place as u32);
            }
        }
        // The last place of a vertex is in its last block.
        let key = |vertex: &u32| {
            let meeting = &meeting[*vertex as usize];
            (meeting.last().map_or(0, |last| *last as usize / (N * LANES * STAGE)) as u32, meeting.len() as u32)
        };
        let mut ordered: Vec<_> = (0..vertices.len() as u32).collect();
        ordered.sort_by_key(key);
        let runs = ordered.chunk_by(|one, other| key(one) == key(other)).map(|run| {
            let (stage, degree) = key(&run[0]);
            [stage, degree, run.len() as u32]
        });
        let runs = runs.collect();
        let places = ordered.iter().flat_map(|&vertex| &meeting[vertex as usize]).copied().collect();
        Self { runs, vertices: ordered, places, first: vertices.start }
    }

    /// The sums of each stage, in order.
    pub const fn stages(&self) -> Stages<'_> {
        Stages {
            runs: self.runs.as_slice(),
            vertices: self.vertices.as_slice(),
            places: self.places.as_slice(),
            first: self.first,
            stage: 0,
        }
    }
}

/// What is left to be summed.
pub struct Stages<'a> {
    runs: &'a [[u32; 3]],
    vertices: &'a [u32],
    places: &'a [u32],
    first: usize,
    stage: u32,
}

impl Stages<'_> {
    /// Sums what is at the corners of the vertices of the next stage, and hands each its force.
    pub fn add(&mut self, corners: &[Pairs], to: &mut impl Target) {
        let corners = corners.as_flattened();
        while let Some((&[stage, degree, count], runs)) = self.runs.split_first()
            && stage == self.stage
        {
            let (now, vertices) = self.vertices.split_at(count as usize);
            let (of_now, places) = self.places.split_at((degree * count) as usize);
            /// One loop for each of these numbers of corners, with nothing to count inside; one for all others.
            macro_rules! loops {
                ($($DEGREE:literal)+) => {
                    match degree {
                        $($DEGREE => sum(now, of_now.as_chunks::<$DEGREE>().0.iter().map(<[u32; $DEGREE]>::as_slice), corners, self.first, to),)+
                        _ => sum(now, of_now.chunks((degree as usize).max(1)), corners, self.first, to),
                    }
                };
            }
            loops!(1 2 3 4 5 6 7 8 9 10 11 12);
            (self.runs, self.vertices, self.places) = (runs, vertices, places);
        }
        self.stage += 1;
    }
}

/// Hands out the sums over the places of these vertices.
#[inline(always)]
fn sum<'a>(
    vertices: &[u32],
    places: impl Iterator<Item = &'a [u32]>,
    corners: &[[f64; 2]],
    first: usize,
    to: &mut impl Target,
) {
    to.take(vertices.iter().zip(places).map(|(&vertex, places)| {
        let force = places.iter().fold(f64x2::ZERO, |sum, &place| sum + f64x2::new(corners[place as usize]));
        (first + vertex as usize, force)
    }));
}

/// Bytes that the processor moves at a time.
const LINE: usize = 64;

/// How many numbers of scratch hold so many [`Pairs`].
pub const fn room(pairs: usize) -> usize {
    2 * LANES * pairs + LINE / size_of::<f64>()
}

/// [`Pairs`] in scratch, from where a line of memory begins.
pub fn pairs(scratch: &mut [f64]) -> &mut [Pairs] {
    let skip = scratch.as_ptr().align_offset(LINE).min(LINE / size_of::<f64>());
    scratch[skip..].as_chunks_mut().0.as_chunks_mut().0
}

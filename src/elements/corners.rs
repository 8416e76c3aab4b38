//! Vertex indices of fans of triangles and springs, compressed to 16 bits where possible.

use crate::simd::{Indexed16, LANES, Pairs, vector};
use std::array;

/// Number of blocks whose edge vectors are gathered ahead: enough for scalar stores to complete before they are read as
/// SIMD vectors, and few enough to stay in the cache.
pub const RUN_BLOCKS: usize = 8;

/// The N corners of each element, run by run. Vertices are counted from the first of a body, partition or net, like the
/// positions or velocities that are read.
#[derive(Debug)]
pub struct Corners<const N: usize> {
    starts: Vec<Start>,
    /// 16-bit offsets of the corners' numbers from those of the run's first vertex; invalid in a run whose vertices are
    /// too far apart. The last run is padded with elements of one vertex.
    indices16: Vec<[u16; N]>,
    /// 32-bit vertex indices of such runs.
    indices32: Vec<[u32; N]>,
}

/// Start of a run.
#[derive(Clone, Copy, Debug)]
enum Start {
    /// 16-bit indices: the least of its vertices.
    Index16(u32),
    /// 32-bit indices: its first element among them.
    Index32(u32),
}

impl<const N: usize> Corners<N> {
    /// Packs the vertices of each element's corners; `start` is subtracted from vertex numbers.
    pub fn new(corners: &[[u32; N]], start: usize) -> Self {
        let count = corners.len().next_multiple_of(RUN_BLOCKS * LANES);
        let (mut indices16, mut indices32) = (Vec::with_capacity(count), Vec::new());
        let pack = |run: &[[u32; N]]| {
            let first = run.as_flattened().iter().min().copied().unwrap_or(0);
            let places = run.iter().map(|corners| corners.map(|corner| 2 * (corner - first)));
            indices16.extend(places.clone().map(|places| places.map(|place| place as u16)));
            if places.flatten().all(|place| u16::try_from(place).is_ok()) {
                return Start::Index16(first - start as u32);
            }
            let begin = Start::Index32(indices32.len() as u32);
            indices32.extend(run.iter().map(|corners| corners.map(|corner| corner - start as u32)));
            begin
        };
        let starts = corners.chunks(RUN_BLOCKS * LANES).map(pack).collect();
        indices16.resize(count, [0; N]);
        Self { starts, indices16, indices32 }
    }

    /// Unchecked access to a run, if it has 16-bit indices and enough numbers follow.
    #[inline(always)]
    pub fn ahead<'a>(&'a self, run: usize, values: &'a [f64]) -> Option<Ahead<'a, N>> {
        let Some(Start::Index16(first)) = self.starts.get(run) else { return None };
        let blocks = self.indices16.get(run * RUN_BLOCKS * LANES..)?.as_chunks().0.first_chunk()?;
        Some(Ahead { numbers: values.get(2 * *first as usize..)?.first_chunk()?, blocks })
    }

    /// Gathers M vectors between the corners of each element of a run.
    pub fn collect<const M: usize>(
        &self,
        run: usize,
        values: &[f64],
        between: impl Fn([[f64; 2]; N]) -> [[f64; 2]; M],
        out: &mut [[Pairs; M]; RUN_BLOCKS],
    ) {
        if let Some(ahead) = self.ahead(run, values) {
            out.iter_mut().enumerate().for_each(|(block, out)| ahead.collect(block, &between, out));
            return;
        }
        let values = values.as_chunks().0;
        let mut put = |element: usize, vertices: [u32; N]| {
            let vectors = between(vertices.map(|vertex| values[vertex as usize]));
            for (to, vector) in out[element / LANES].iter_mut().zip(vectors) {
                to[element % LANES] = vector;
            }
        };
        match self.starts[run] {
            Start::Index16(first) => {
                let indices16 = &self.indices16[run * RUN_BLOCKS * LANES..][..RUN_BLOCKS * LANES];
                let vertices = |places: &[u16; N]| places.map(|place| first + u32::from(place) / 2);
                indices16.iter().enumerate().for_each(|(element, places)| put(element, vertices(places)));
            }
            Start::Index32(first) => {
                let indices32 = self.indices32[first as usize..].iter().take(RUN_BLOCKS * LANES);
                indices32.enumerate().for_each(|(element, corners)| put(element, *corners));
            }
        }
    }
}

/// A run with unchecked access, block by block.
#[derive(Clone, Copy)]
pub struct Ahead<'a, const N: usize> {
    numbers: &'a Indexed16,
    blocks: &'a [[[u16; N]; LANES]; RUN_BLOCKS],
}

impl<const N: usize> Ahead<'_, N> {
    /// Gathers the vectors of each element of a block.
    #[inline(always)]
    pub fn collect<const M: usize>(
        self,
        block: usize,
        between: impl Fn([[f64; 2]; N]) -> [[f64; 2]; M],
        out: &mut [Pairs; M],
    ) {
        for (element, places) in self.blocks[block].iter().enumerate() {
            let vectors = between(array::from_fn(|corner| vector(self.numbers, places[corner])));
            for (to, vector) in out.iter_mut().zip(vectors) {
                to[element] = vector;
            }
        }
    }
}

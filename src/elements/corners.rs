//! Which vertices lie at the corners of triangles, in as few bytes as sweeps can read them from.

use super::triangle::{edges, edges_between};
use crate::lanes::{LANES, Near, Quads, vector};

/// For how many blocks of triangles the matrices D are collected ahead: enough for what is stored number by number to have arrived
/// when it is read lane by lane, and little enough to stay near the processor.
pub const RUN: usize = 8;

/// The corners of triangles, run by run. Vertices are counted from the first of a body or of a part of it, and so are the positions or
/// velocities that are read.
#[derive(Debug)]
pub struct Corners {
    starts: Vec<Start>,
    /// Where the numbers of the corners are, counted from where those of the run's first vertex are; of no use in a run whose vertices
    /// lie too far apart. The last run is filled up with triangles of one vertex.
    near: Vec<[u16; 3]>,
    /// The vertices at the corners in such runs, one after another.
    far: Vec<[u32; 3]>,
}

/// What a run starts with.
#[derive(Clone, Copy, Debug)]
enum Start {
    /// The least of its vertices.
    Near(u32),
    /// Its first triangle among the far ones.
    Far(u32),
}

impl Corners {
    /// Packs the vertices of each triangle's corners; numbers are counted from a first one.
    pub fn new(corners: &[[u32; 3]], start: usize) -> Self {
        let count = corners.len().next_multiple_of(RUN * LANES);
        let (mut near, mut far) = (Vec::with_capacity(count), Vec::new());
        let pack = |run: &[[u32; 3]]| {
            let first = run.as_flattened().iter().min().copied().unwrap_or(0);
            let places = run.iter().map(|corners| corners.map(|corner| 2 * (corner - first)));
            near.extend(places.clone().map(|places| places.map(|place| place as u16)));
            if places.flatten().all(|place| u16::try_from(place).is_ok()) {
                return Start::Near(first - start as u32);
            }
            let begin = Start::Far(far.len() as u32);
            far.extend(run.iter().map(|corners| corners.map(|corner| corner - start as u32)));
            begin
        };
        let starts = corners.chunks(RUN * LANES).map(pack).collect();
        near.resize(count, [0; 3]);
        Self { starts, near, far }
    }

    /// What D is to be collected from in a run, with nothing to check, if its vertices lie near each other and enough numbers follow.
    #[inline(always)]
    pub fn ahead<'a>(&'a self, run: usize, values: &'a [f64]) -> Option<Ahead<'a>> {
        let Some(Start::Near(first)) = self.starts.get(run) else { return None };
        let blocks = self.near.get(run * RUN * LANES..)?.as_chunks().0.first_chunk()?;
        Some(Ahead { numbers: values.get(2 * *first as usize..)?.first_chunk()?, blocks })
    }

    /// D of each triangle of a run.
    pub fn collect(&self, run: usize, values: &[f64], out: &mut [Quads; RUN]) {
        if let Some(ahead) = self.ahead(run, values) {
            out.iter_mut().enumerate().for_each(|(block, out)| ahead.collect(block, out));
            return;
        }
        let (values, out) = (values.as_chunks().0, out.as_flattened_mut());
        match self.starts[run] {
            Start::Near(first) => {
                let vertices = |places: &[u16; 3]| places.map(|place| first + u32::from(place) / 2);
                let near = &self.near[run * RUN * LANES..];
                out.iter_mut().zip(near).for_each(|(to, places)| *to = edges(values, vertices(places)));
            }
            Start::Far(first) => {
                let far = &self.far[first as usize..];
                out.iter_mut().zip(far).for_each(|(to, corners)| *to = edges(values, *corners));
            }
        }
    }
}

/// A run to be collected block by block.
#[derive(Clone, Copy)]
pub struct Ahead<'a> {
    numbers: &'a Near,
    blocks: &'a [[[u16; 3]; LANES]; RUN],
}

impl Ahead<'_> {
    /// D of each triangle of a block.
    #[inline(always)]
    pub fn collect(self, block: usize, out: &mut Quads) {
        for (to, places) in out.iter_mut().zip(&self.blocks[block]) {
            *to = edges_between(places.map(|place| vector(self.numbers, place)));
        }
    }
}

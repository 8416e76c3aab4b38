//! Which vertices lie at the corners of triangles, in as few bytes as sweeps can read them from.

use super::triangle::edges;
use crate::lanes::{LANES, Quads};

/// For how many blocks of triangles the matrices D are collected at a time: enough for what is stored number by number to have arrived
/// when it is read lane by lane, and little enough to stay near the processor.
pub const RUN: usize = 8;

/// The corners of triangles, run by run.
#[derive(Debug)]
pub struct Corners {
    starts: Vec<Start>,
    /// Counted from where the run starts; of no use in a run whose vertices lie too far apart.
    near: Vec<[u16; 3]>,
    /// Those of such runs, one after another.
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
    /// Packs the vertices of each triangle's corners.
    pub fn new(corners: &[[u32; 3]]) -> Self {
        let (mut near, mut far) = (Vec::with_capacity(corners.len()), Vec::new());
        let start = |run: &[[u32; 3]]| {
            let first = run.as_flattened().iter().min().copied().unwrap_or(0);
            let of_run = run.iter().map(|corners| corners.map(|corner| corner - first));
            near.extend(of_run.clone().map(|corners| corners.map(|corner| corner as u16)));
            if of_run.flatten().all(|corner| u16::try_from(corner).is_ok()) {
                return Start::Near(first);
            }
            let start = Start::Far(far.len() as u32);
            far.extend_from_slice(run);
            start
        };
        Self { starts: corners.chunks(RUN * LANES).map(start).collect(), near, far }
    }

    /// D of each triangle of a run.
    #[inline(always)]
    pub fn collect(&self, run: usize, x: &[[f64; 2]], out: &mut [Quads; RUN]) {
        let begin = run * RUN * LANES;
        let near = &self.near[begin..self.near.len().min(begin + RUN * LANES)];
        match self.starts[run] {
            Start::Near(first) => collect(&x[first as usize..], near, out),
            Start::Far(first) => collect(x, &self.far[first as usize..][..near.len()], out),
        }
    }
}

/// D of each triangle, from the vertices of its corners.
#[inline(always)]
fn collect<V: Copy + Into<u32>>(x: &[[f64; 2]], corners: &[[V; 3]], out: &mut [Quads]) {
    let (whole, rest) = corners.as_chunks::<LANES>();
    let (of_whole, of_rest) = out.split_at_mut(whole.len());
    for (to, triangles) in of_whole.iter_mut().zip(whole) {
        for (to, &triangle) in to.iter_mut().zip(triangles) {
            *to = edges(x, triangle.map(Into::into));
        }
    }
    for (to, &triangle) in of_rest.as_flattened_mut().iter_mut().zip(rest) {
        *to = edges(x, triangle.map(Into::into));
    }
}

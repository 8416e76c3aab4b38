//! Gather-based force assembly: sums of corner forces at vertices.

use super::stages::Stages;
use crate::simd::{INDEXED16, LANES, Order, Pairs, SPARE, lined};
use pulp::Arch;
use std::{iter::repeat_n, ops::Range};

/// Blocks of a stage, after which the vertices with complete forces are summed: enough for long runs of consecutive
/// vertices, and few enough for the forces to stay in the cache.
pub const STAGE: usize = 32;

/// Elements of a stage.
pub const STAGE_ELEMENTS: usize = LANES * STAGE;

/// For each vertex, the element corners at it.
///
/// Forces are written to a buffer of corners and then summed vertex by vertex, in the order of all elements: the sum is
/// the same in every run, and no two elements write to the same place. Vertices of equal degree are summed in one loop
/// without branch misprediction; where nearly all have the same degree, the others are padded.
#[derive(Debug)]
pub struct Gather {
    /// Runs of vertices with equal number of places.
    runs: Vec<VertexRun>,
    /// Vertices, counted from the first of the body, net or partition.
    vertices: Vec<u32>,
    /// 16-bit places of their corners' forces in the buffer, in numbers, vertex by vertex, if the buffer is small
    /// enough.
    indices16: Vec<u16>,
    /// 32-bit places otherwise.
    indices32: Vec<u32>,
    /// Number of stages in the buffer of corners.
    window: usize,
    /// Number of blocks of elements.
    blocks: usize,
    /// Instruction set of the forces.
    set: Arch,
}

/// Runs of vertices with equal number of places.
#[derive(Clone, Copy, Debug)]
pub struct VertexRun {
    /// Stage after which their forces are complete.
    pub stage: u32,
    /// Number of places of each vertex: one for each corner, and padding.
    pub degree: u32,
    /// Number of vertices.
    pub count: u32,
    /// Whether their numbers are consecutive.
    pub dense: bool,
}

/// Place without a force, for padding: at the end of [`Indexed16`](crate::simd::Indexed16) numbers, where no corner is.
const NOTHING: u16 = u16::MAX;

/// Greatest cost of padding: the vertices of a stage are padded to the greatest degree if that makes at most this many
/// times the sums. Padding adds zero.
const WASTE: f64 = 1.25;

/// Consecutive vertices form runs of their own if runs have this average length.
const LONG: usize = 8;

impl Gather {
    /// `corners` are the vertices of each element's corners, whose forces are stored in an order; only the vertices in
    /// `summed`, ascending, get sums. `first` is the scene number of the first vertex, for alignment to cache lines.
    pub fn new<const N: usize>(corners: &[[u32; N]], summed: Vec<u32>, first: usize, order: &Order) -> Self {
        let blocks = corners.len().div_ceil(LANES);
        let count = corners.as_flattened().iter().chain(&summed).max().map_or(0, |most| *most as usize + 1);
        let mut meeting = vec![Vec::new(); count];
        for (element, corners) in corners.iter().enumerate() {
            for (number, &corner) in corners.iter().enumerate() {
                meeting[corner as usize].push((element, number));
            }
        }
        let ends = |all: &[(usize, usize)]| {
            let stage = |corner: Option<&(usize, usize)>| corner.map_or(0, |(element, _)| element / STAGE_ELEMENTS);
            (stage(all.first()), stage(all.last()))
        };
        // Forces stay in the buffer until the vertex is complete.
        let stays = |all: &Vec<(usize, usize)>| ends(all).1 - ends(all).0;
        let window = 1 + meeting.iter().map(stays).max().unwrap_or(0);
        let place = |&(element, number): &(usize, usize)| {
            let block = element / LANES % (window * STAGE);
            2 * ((block * N + number) * LANES + order.place[element % LANES])
        };
        let is_narrow = window * STAGE * LANES * 2 * N <= NOTHING.into();
        // A vertex is summed in the stage of its last corner.
        let stage = |vertex: u32| ends(&meeting[vertex as usize]).1;
        let met = |vertex: &&u32| is_narrow && !meeting[**vertex as usize].is_empty();
        let of_met = summed.iter().filter(met).map(|vertex| (stage(*vertex), meeting[*vertex as usize].len()));
        let degrees = degrees(blocks.div_ceil(STAGE), of_met);
        let degree = |vertex: u32| {
            let alike = if met(&&vertex) { degrees[stage(vertex)] } else { None };
            alike.unwrap_or(meeting[vertex as usize].len())
        };
        let key = |vertex: &u32| (stage(*vertex) as u32, degree(*vertex) as u32);
        let mut ordered = summed;
        ordered.sort_by_cached_key(key);
        let runs = ordered.chunk_by(|one, other| key(one) == key(other)).flat_map(|alike| {
            let (stage, degree) = key(&alike[0]);
            let follows = |one: &u32, other: &u32| one + 1 == *other;
            let dense = LONG * alike.chunk_by(follows).count() <= alike.len();
            let joins = move |one: &u32, other: &u32| !dense || follows(one, other);
            let run = move |run: &[u32]| VertexRun { stage, degree, count: run.len() as u32, dense };
            alike.chunk_by(joins).flat_map(move |all| {
                // Groups of four vertices are aligned to cache lines.
                let head = (4 - (first + all[0] as usize) % 4) % 4;
                let (head, all) = all.split_at(if dense { head.min(all.len()) } else { 0 });
                [head, all].into_iter().filter(|run| !run.is_empty()).map(run)
            })
        });
        let runs = runs.collect();
        let places = ordered.iter().flat_map(|&vertex| {
            let all = &meeting[vertex as usize];
            all.iter().map(place).chain(repeat_n(NOTHING.into(), degree(vertex) - all.len()))
        });
        let (mut of_indices16, mut indices32) = (Vec::new(), Vec::new());
        if is_narrow {
            of_indices16.extend(places.map(|place| place as u16));
        } else {
            indices32.extend(places.map(|place| place as u32));
        }
        Self { runs, vertices: ordered, indices16: of_indices16, indices32, window, blocks, set: order.set }
    }

    /// The instruction set.
    pub const fn set(&self) -> Arch {
        self.set
    }

    /// Number of blocks in the buffer of corners.
    pub const fn buffer(&self) -> usize {
        self.window * STAGE
    }

    /// Number of stages.
    pub const fn count(&self) -> usize {
        self.blocks.div_ceil(STAGE)
    }

    /// The blocks of a stage.
    pub fn span(&self, stage: usize) -> Range<usize> {
        stage * STAGE..((stage + 1) * STAGE).min(self.blocks)
    }

    /// First block in the buffer for a stage; what it overwrites was summed before.
    pub const fn slot(&self, stage: usize) -> usize {
        stage % self.window * STAGE
    }

    /// The sums of each stage, in order.
    pub const fn stages(&self) -> Stages<'_> {
        Stages {
            runs: self.runs.as_slice(),
            vertices: self.vertices.as_slice(),
            indices16: self.indices16.as_slice(),
            indices32: self.indices32.as_slice(),
            stage: 0,
            set: self.set,
        }
    }
}

/// Common degree of all vertices in each stage, if padding to it is cheap; from the stage and the degree of each
/// vertex.
fn degrees(stages: usize, of_vertices: impl Iterator<Item = (usize, usize)>) -> Vec<Option<usize>> {
    let mut of_stages = vec![(0, 0, 0); stages];
    for (stage, degree) in of_vertices {
        let (most, sum, count): (usize, usize, usize) = of_stages[stage];
        of_stages[stage] = (most.max(degree), sum + degree, count + 1);
    }
    let alike = |(most, sum, count): (usize, usize, usize)| (most * count) as f64 <= WASTE * sum as f64;
    of_stages.into_iter().map(|of| alike(of).then_some(of.0)).collect()
}

/// Size of scratch for a number of [`Pairs`] that can be read as [`Indexed16`](crate::simd::Indexed16).
pub const fn scratch_size(pairs: usize) -> usize {
    let numbers = 2 * LANES * pairs;
    (if numbers < INDEXED16 { INDEXED16.next_multiple_of(2 * LANES) } else { numbers }) + SPARE
}

/// Enlarges scratch. The allocator provides zeros, so that untouched pages take no memory.
pub fn reserve_scratch(scratch: &mut Vec<f64>, numbers: usize) {
    if scratch.len() < numbers {
        *scratch = vec![0.0; numbers];
    }
}

/// [`Pairs`] in scratch, aligned to a cache line, with zero at the place [`NOTHING`].
pub fn pairs(scratch: &mut [f64]) -> &mut [Pairs] {
    let numbers = lined(scratch);
    if let Some(nothing) = numbers.get_mut(NOTHING.into()..INDEXED16) {
        nothing.fill(0.0);
    }
    numbers.as_chunks_mut().0.as_chunks_mut().0
}

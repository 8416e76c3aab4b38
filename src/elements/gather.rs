//! From forces at the corners of elements to forces on vertices.

use super::stages::Stages;
use crate::simd::{INDEXED16, LANES, Order, Pairs, SPARE, lined};
use pulp::Arch;
use std::{iter::repeat_n, ops::Range};

/// After how many blocks of elements the vertices are summed that have all their forces by then: enough for long runs of
/// vertices in a row, and little enough for the forces to be still near the processor.
pub const STAGE: usize = 32;

/// The same in elements.
pub const STAGE_ELEMENTS: usize = LANES * STAGE;

/// For each vertex the corners that meet there.
///
/// Forces go to a buffer of corners first and are then summed vertex by vertex, always in the order of the elements of the whole: the
/// sum is the same on every run, and no two elements write to the same place. Vertices with as many corners as each other
/// are summed one after another, so that the processor never has to guess how many there are; where nearly all have as many, the others
/// are summed as if they had.
#[derive(Debug)]
pub struct Gather {
    /// Vertices that are summed over as many places as each other.
    runs: Vec<VertexRun>,
    /// The vertices, counted from the first of the body, net or partition.
    vertices: Vec<u32>,
    /// Where their corners' forces are in the buffer, counted in numbers, one vertex after another: in a buffer so small that 16 bits reach
    /// everywhere,
    indices16: Vec<u16>,
    /// or else.
    indices32: Vec<u32>,
    /// How many stages the buffer of corners holds.
    window: usize,
    /// How many blocks of elements there are.
    blocks: usize,
    /// What the forces are computed with.
    set: Arch,
}

/// Vertices that are summed over as many places as each other.
#[derive(Clone, Copy, Debug)]
pub struct VertexRun {
    /// When they have all their forces.
    pub stage: u32,
    /// How many places each is summed over: one for each corner, and maybe some where there is nothing.
    pub degree: u32,
    /// How many vertices there are.
    pub count: u32,
    /// Whether their numbers follow each other.
    pub dense: bool,
}

/// A place among [`Indexed16`](crate::lanes::Near) numbers where there is no force: at the end, where no corner is.
const NOTHING: u16 = u16::MAX;

/// The vertices of a stage are summed as if they all had as many corners as the one with the most, if that makes no more than so many
/// times the sums: nothing is added where they have fewer.
const WASTE: f64 = 1.25;

/// Vertices in a row are a run of their own if runs are so long on average.
const LONG: usize = 8;

impl Gather {
    /// `corners` holds the numbers of each element's corners, whose forces are stored in an order; only the vertices that are `summed`,
    /// ascending, are given their sums. In the scene the first of them is a vertex of its own number, by which lines of memory begin.
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
        // Until a vertex has all its forces they have to stay in the buffer.
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
                // Fours begin where a line of memory may.
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

    /// How many blocks of elements the buffer of corners has to hold.
    pub const fn buffer(&self) -> usize {
        self.window * STAGE
    }

    /// How many stages there are.
    pub const fn count(&self) -> usize {
        self.blocks.div_ceil(STAGE)
    }

    /// The blocks of a stage.
    pub fn span(&self, stage: usize) -> Range<usize> {
        stage * STAGE..((stage + 1) * STAGE).min(self.blocks)
    }

    /// The first block in the buffer that the elements of a stage write to: what they overwrite was summed before.
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

/// How many corners all vertices of each of so many stages are to be summed over, where they may have fewer: for each vertex, its stage
/// and how many it has.
fn degrees(stages: usize, of_vertices: impl Iterator<Item = (usize, usize)>) -> Vec<Option<usize>> {
    let mut of_stages = vec![(0, 0, 0); stages];
    for (stage, degree) in of_vertices {
        let (most, sum, count): (usize, usize, usize) = of_stages[stage];
        of_stages[stage] = (most.max(degree), sum + degree, count + 1);
    }
    let alike = |(most, sum, count): (usize, usize, usize)| (most * count) as f64 <= WASTE * sum as f64;
    of_stages.into_iter().map(|of| alike(of).then_some(of.0)).collect()
}

/// How many numbers of scratch hold so many [`Pairs`], and can be read as [`Indexed16`].
pub const fn scratch_size(pairs: usize) -> usize {
    let numbers = 2 * LANES * pairs;
    (if numbers < INDEXED16 { INDEXED16.next_multiple_of(2 * LANES) } else { numbers }) + SPARE
}

/// Makes room in scratch. Zeros are asked for, not written: what is never touched takes no memory.
pub fn reserve_scratch(scratch: &mut Vec<f64>, numbers: usize) {
    if scratch.len() < numbers {
        *scratch = vec![0.0; numbers];
    }
}

/// [`Pairs`] in scratch, from where a line of memory begins, with nothing at the place [`NOTHING`].
pub fn pairs(scratch: &mut [f64]) -> &mut [Pairs] {
    let numbers = lined(scratch);
    if let Some(nothing) = numbers.get_mut(NOTHING.into()..INDEXED16) {
        nothing.fill(0.0);
    }
    numbers.as_chunks_mut().0.as_chunks_mut().0
}

//! From forces at the corners of elements to forces on vertices.

use super::stages::Stages;
use crate::simd::{LANES, NEAR, Order, Pairs, SPARE, lined};
use pulp::Arch;
use std::{iter::repeat_n, ops::Range};

/// After how many blocks of elements the vertices are summed that have all their forces by then: enough for long runs of
/// vertices in a row, and little enough for the forces to be still near the processor.
pub const STAGE: usize = 32;

/// The same in elements.
pub const STRETCH: usize = LANES * STAGE;

/// For each vertex the corners that meet there.
///
/// Forces go to a buffer of corners first and are then summed vertex by vertex, always in the order of the elements of the whole: the
/// sum is the same on every run, and no two elements write to the same place. Vertices with as many corners as each other
/// are summed one after another, so that the processor never has to guess how many there are; where nearly all have as many, the others
/// are summed as if they had.
#[derive(Debug)]
pub struct Gather {
    /// Vertices that are summed over as many places as each other.
    runs: Vec<Run>,
    /// The vertices, counted from the first of the body or net.
    vertices: Vec<u32>,
    /// Where their corners' forces are in the buffer, counted in numbers, one vertex after another: in a buffer so small that 16 bits reach
    /// everywhere,
    near: Vec<u16>,
    /// or else.
    far: Vec<u32>,
    /// The first vertex of the body or net.
    first: usize,
    /// How many stages the buffer of corners holds.
    window: usize,
    /// How many corners each vertex that lies in several parts has in each of them, one vertex after another.
    shares: Vec<u32>,
    /// How many blocks of elements there are.
    blocks: usize,
    /// What the forces are computed with.
    set: Arch,
}

/// Vertices that are summed over as many places as each other; one vertex, if that lies in several parts.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// When they have all their forces.
    pub stage: u32,
    /// How many places each is summed over: one for each corner, and maybe some where there is nothing.
    pub degree: u32,
    /// How many vertices there are.
    pub count: u32,
    /// Whether their numbers follow each other.
    pub dense: bool,
    /// In how many parts they lie.
    pub parts: u32,
}

/// A place among [`Near`](crate::lanes::Near) numbers where there is no force: at the end, where no corner is.
const NOTHING: u16 = u16::MAX;

/// The vertices of a stage are summed as if they all had as many corners as the one with the most, if that makes no more than so many
/// times the sums: nothing is added where they have fewer.
const WASTE: f64 = 1.25;

/// Vertices in a row are a run of their own if runs are so long on average.
const LONG: usize = 8;

impl Gather {
    /// `corners` holds the scene vertex numbers of each element's corners, whose forces are stored in an order. The sum at a vertex
    /// that lies in several parts is one of sums over the parts; the elements at which parts begin are the `cuts`. Sums begin with
    /// the first element that meets there or, where elements are in reverse and sums are to be as if they were not, with the last.
    pub fn new<const N: usize>(
        corners: &[[u32; N]],
        vertices: &Range<usize>,
        (cuts, last_first): (&[usize], bool),
        order: &Order,
    ) -> Self {
        let blocks = corners.len().div_ceil(LANES);
        let mut meeting = vec![Vec::new(); vertices.len()];
        for (element, corners) in corners.iter().enumerate() {
            for (number, &corner) in corners.iter().enumerate() {
                meeting[corner as usize - vertices.start].push((element, number));
            }
        }
        let ends = |all: &[(usize, usize)]| {
            let stage = |corner: Option<&(usize, usize)>| corner.map_or(0, |(element, _)| element / STRETCH);
            (stage(all.first()), stage(all.last()))
        };
        // Until a vertex has all its forces they have to stay in the buffer.
        let stays = |all: &Vec<(usize, usize)>| ends(all).1 - ends(all).0;
        let window = 1 + meeting.iter().map(stays).max().unwrap_or(0);
        let place = |&(element, number): &(usize, usize)| {
            let block = element / LANES % (window * STAGE);
            2 * ((block * N + number) * LANES + order.place[element % LANES])
        };
        let part = |element: usize| cuts.partition_point(|cut| *cut <= element);
        let same_part = |one: &(usize, usize), other: &(usize, usize)| part(one.0) == part(other.0);
        let parts = |vertex: u32| meeting[vertex as usize].chunk_by(same_part);
        let near = window * STAGE * LANES * 2 * N <= NOTHING.into();
        // A vertex is summed in the stage of its last corner.
        let stage = |vertex: u32| ends(&meeting[vertex as usize]).1;
        let alone = |vertex: &u32| near && parts(*vertex).count() == 1;
        let all_alone = (0..vertices.len() as u32).filter(alone);
        let degrees =
            degrees(blocks.div_ceil(STAGE), all_alone.map(|vertex| (stage(vertex), meeting[vertex as usize].len())));
        let degree = |vertex: u32| {
            let alike = if alone(&vertex) { degrees[stage(vertex)] } else { None };
            alike.unwrap_or(meeting[vertex as usize].len())
        };
        let key = |vertex: &u32| (stage(*vertex) as u32, parts(*vertex).count() as u32, degree(*vertex) as u32);
        let mut ordered: Vec<_> = (0..vertices.len() as u32).collect();
        ordered.sort_by_cached_key(key);
        let runs = ordered.chunk_by(|one, other| key(one) == key(other)).flat_map(|alike| {
            let (stage, parts, degree) = key(&alike[0]);
            let follows = |one: &u32, other: &u32| one + 1 == *other;
            let dense = LONG * alike.chunk_by(follows).count() <= alike.len();
            let joins = move |one: &u32, other: &u32| parts <= 1 && (!dense || follows(one, other));
            let run = move |run: &[u32]| Run { stage, degree, count: run.len() as u32, dense, parts };
            let first = vertices.start;
            alike.chunk_by(joins).flat_map(move |all| {
                // Fours begin where a line of memory may.
                let head = (4 - (first + all[0] as usize) % 4) % 4;
                let (head, all) = all.split_at(if dense { head.min(all.len()) } else { 0 });
                [head, all].into_iter().filter(|run| !run.is_empty()).map(run)
            })
        });
        let runs = runs.collect();
        let shared = ordered.iter().filter(|vertex| parts(**vertex).count() > 1);
        let shares = shared.flat_map(|vertex| parts(*vertex).map(|corners| corners.len() as u32)).collect();
        let places = ordered.iter().flat_map(|&vertex| {
            let all = &meeting[vertex as usize];
            let number = |at: usize| if last_first { all.len() - 1 - at } else { at };
            let of_corners = (0..all.len()).map(move |at| place(&all[number(at)]));
            of_corners.chain(repeat_n(NOTHING.into(), degree(vertex) - all.len()))
        });
        let (mut of_near, mut far) = (Vec::new(), Vec::new());
        if near {
            of_near.extend(places.map(|place| place as u16));
        } else {
            far.extend(places.map(|place| place as u32));
        }
        Self {
            runs,
            vertices: ordered,
            near: of_near,
            far,
            first: vertices.start,
            window,
            shares,
            blocks,
            set: order.set,
        }
    }

    /// The instruction set.
    pub const fn set(&self) -> Arch {
        self.set
    }

    /// How many bytes tell what is summed where.
    pub const fn bytes(&self) -> usize {
        size_of_val(self.vertices.as_slice()) + size_of_val(self.near.as_slice()) + size_of_val(self.far.as_slice())
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

    /// After how many stages more than these all their vertices have their forces.
    pub const fn lag(&self) -> usize {
        self.window - 1
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
            near: self.near.as_slice(),
            far: self.far.as_slice(),
            shares: self.shares.as_slice(),
            first: self.first,
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

/// How many numbers of scratch hold so many [`Pairs`], and can be read as [`Near`].
pub const fn room(pairs: usize) -> usize {
    let numbers = 2 * LANES * pairs;
    (if numbers < NEAR { NEAR.next_multiple_of(2 * LANES) } else { numbers }) + SPARE
}

/// Makes room in scratch. Zeros are asked for, not written: what is never touched takes no memory.
pub fn make_room(scratch: &mut Vec<f64>, numbers: usize) {
    if scratch.len() < numbers {
        *scratch = vec![0.0; numbers];
    }
}

/// [`Pairs`] in scratch, from where a line of memory begins, with nothing at the place [`NOTHING`].
pub fn pairs(scratch: &mut [f64]) -> &mut [Pairs] {
    let numbers = lined(scratch);
    if let Some(nothing) = numbers.get_mut(NOTHING.into()..NEAR) {
        nothing.fill(0.0);
    }
    numbers.as_chunks_mut().0.as_chunks_mut().0
}

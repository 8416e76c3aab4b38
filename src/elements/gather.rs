//! Gather-based force assembly: positions at the corners of elements, and sums of corner forces at vertices.

use super::Scatter;
use crate::simd::{INDEXED16, Indexed16, LANES, Order, Pairs, SPARE, lined, vector};
use pulp::{Arch, Simd, WithSimd};
use std::{array, iter::repeat_n, ops::Range};
use wide::f64x2;

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

/// The stages that are still to be summed.
pub struct Stages<'a> {
    pub runs: &'a [VertexRun],
    pub vertices: &'a [u32],
    pub indices16: &'a [u16],
    pub indices32: &'a [u32],
    pub stage: u32,
    pub set: Arch,
}

impl<'a> Stages<'a> {
    /// Sums the corner forces of the vertices of the next stage, and scatters them.
    #[inline(always)]
    pub fn add<const N: usize>(&mut self, corners: [&[Pairs]; N], to: &mut impl Scatter<N>) {
        /// A closure might not be inlined and lose the instruction set.
        struct Next<'a, 'b, T, const N: usize>(&'a mut Stages<'b>, [&'a [Pairs]; N], &'a mut T);
        impl<T: Scatter<N>, const N: usize> WithSimd for Next<'_, '_, T, N> {
            type Output = ();

            #[inline(always)]
            fn with_simd<S: Simd>(self, set: S) {
                let Self(stages, corners, to) = self;
                match as_indexed16(&corners) {
                    Some(corners) if stages.indices32.is_empty() => stages.add_next(set, corners, to),
                    _ => stages.add_next(set, corners.map(<[Pairs]>::as_flattened), to),
                }
            }
        }
        self.set.dispatch(Next(self, corners, to));
    }

    #[inline(always)]
    fn add_next<S: Simd, C: Buffer<'a, N>, const N: usize>(&mut self, set: S, corners: C, to: &mut impl Scatter<N>) {
        while let Some((&VertexRun { stage, degree, count, dense }, runs)) = self.runs.split_first()
            && stage == self.stage
        {
            let (now, vertices) = self.vertices.split_at(count as usize);
            (self.runs, self.vertices) = (runs, vertices);
            let places = C::places(self);
            let (of_now, others) = places.split_at((degree * count) as usize);
            *places = others;
            /// One unrolled loop for each of these degrees, without checks; one for all others.
            macro_rules! loops {
                ($($DEGREE:literal)+) => {
                    match degree {
                        $($DEGREE if C::IS_NARROW && dense => {
                            let (fours, rest) = of_now.as_chunks::<$DEGREE>().0.as_chunks();
                            let first = now[0] as usize;
                            to.take_run(set, first, fours.iter().map(|four| sum_at_four(four, corners)), rest.iter().map(|places| sum_at(places, corners)));
                        })+
                        $($DEGREE if C::IS_NARROW => scatter(now, of_now.as_chunks::<$DEGREE>().0.iter().map(|places| sum_at(places, corners)), to),)+
                        0 => scatter(now, repeat_n([f64x2::ZERO; N], now.len()), to),
                        _ => scatter(now, of_now.chunks(degree as usize).map(|places| sum_at(places, corners)), to),
                    }
                };
            }
            loops!(2 3 4 5 6 7 8 12);
        }
        self.stage += 1;
    }
}

/// Corner forces of several stresses.
trait Buffer<'a, const N: usize>: Copy {
    /// Index type of a place.
    type Place: Copy + 'a;

    /// Whether places are 16-bit and need no check.
    const IS_NARROW: bool;

    /// The remaining places.
    fn places<'b>(stages: &'b mut Stages<'a>) -> &'b mut &'a [Self::Place];

    /// Force of a stress at a place.
    fn at(self, stress: usize, place: Self::Place) -> f64x2;
}

impl<'a, const N: usize> Buffer<'a, N> for [&[[f64; 2]]; N] {
    type Place = u32;

    const IS_NARROW: bool = false;

    #[inline(always)]
    fn places<'b>(stages: &'b mut Stages<'a>) -> &'b mut &'a [u32] {
        &mut stages.indices32
    }

    #[inline(always)]
    fn at(self, stress: usize, place: u32) -> f64x2 {
        f64x2::new(self[stress][place as usize / 2])
    }
}

impl<'a, const N: usize> Buffer<'a, N> for [&Indexed16; N] {
    type Place = u16;

    const IS_NARROW: bool = true;

    #[inline(always)]
    fn places<'b>(stages: &'b mut Stages<'a>) -> &'b mut &'a [u16] {
        &mut stages.indices16
    }

    #[inline(always)]
    fn at(self, stress: usize, place: u16) -> f64x2 {
        f64x2::new(vector(self[stress], place))
    }
}

/// The buffers as [`Indexed16`], if they are long enough.
#[inline(always)]
fn as_indexed16<'a, const N: usize>(corners: &[&'a [Pairs]; N]) -> Option<[&'a Indexed16; N]> {
    let indices16 = |corners: &'a [Pairs]| corners.as_flattened().as_flattened().first_chunk();
    let mut all = [indices16(corners.first()?)?; N];
    for (all, corners) in all.iter_mut().zip(corners) {
        *all = indices16(corners)?;
    }
    Some(all)
}

/// The sums over these places.
#[inline(always)]
fn sum_at<'a, C: Buffer<'a, N>, const N: usize>(places: &[C::Place], corners: C) -> [f64x2; N] {
    let mut sums = [f64x2::ZERO; N];
    for &place in places {
        for (stress, sum) in sums.iter_mut().enumerate() {
            *sum += corners.at(stress, place);
        }
    }
    sums
}

/// The sums of four vertices.
#[inline(always)]
fn sum_at_four<'a, C: Buffer<'a, N>, const D: usize, const N: usize>(
    places: &[[C::Place; D]; 4],
    corners: C,
) -> [[f64x2; N]; 4] {
    let [a, b, c, d] = places;
    [sum_at(a, corners), sum_at(b, corners), sum_at(c, corners), sum_at(d, corners)]
}

/// Scatters forces on these vertices.
#[inline(always)]
fn scatter<const N: usize>(vertices: &[u32], forces: impl Iterator<Item = [f64x2; N]>, to: &mut impl Scatter<N>) {
    to.take(vertices.iter().map(|vertex| *vertex as usize).zip(forces));
}

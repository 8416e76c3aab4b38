//! From forces at the corners of elements to forces on vertices.

use super::Target;
use crate::lanes::{LANES, Order, Pairs, SPARE, lined};
use pulp::{Arch, Simd, WithSimd};
use std::{iter::repeat_n, ops::Range};
use wide::f64x2;

/// After how many blocks of elements the vertices are summed that have all their forces by then: enough for long runs of
/// vertices with as many corners as each other, and little enough for the forces to be still near the processor.
pub const STAGE: usize = 128;

/// The same in elements.
pub const STRETCH: usize = LANES * STAGE;

/// For each vertex the corners that meet there.
///
/// Forces go to a buffer of corners first and are then summed vertex by vertex, always in the order of the elements: the
/// sum is the same on every run, and no two elements write to the same place. Vertices with as many corners as each other
/// are summed one after another, so that the processor never has to guess how many there are.
#[derive(Debug)]
pub struct Gather {
    /// Vertices with as many corners as each other.
    runs: Vec<Run>,
    /// The vertices, counted from the first of the body or net.
    vertices: Vec<u32>,
    /// Where their corners' forces are in the buffer, counted in numbers, one vertex after another: if all are [`Near`],
    near: Vec<u16>,
    /// or else.
    far: Vec<u32>,
    /// The first vertex of the body or net.
    first: usize,
    /// How many stages the buffer of corners holds.
    window: usize,
    /// How many corners each vertex that lies in several parts has in each of them, one vertex after another.
    shares: Vec<u32>,
    plan: Plan,
    /// What the forces are computed with.
    set: Arch,
}

/// Which elements belong to which stage.
#[derive(Clone, Copy, Debug)]
struct Plan {
    /// How many blocks of elements there are.
    blocks: usize,
    /// Whether the last ones come first.
    backwards: bool,
}

impl Plan {
    /// The stage of an element.
    const fn stage(self, element: usize) -> usize {
        self.turned(element / LANES / STAGE)
    }

    /// The blocks of a stage.
    fn span(self, stage: usize) -> Range<usize> {
        let begin = self.turned(stage) * STAGE;
        begin..(begin + STAGE).min(self.blocks)
    }

    /// How many stages there are.
    const fn count(self) -> usize {
        self.blocks.div_ceil(STAGE)
    }

    /// The number of a stage counted the other way, if the last ones come first.
    const fn turned(self, stage: usize) -> usize {
        if self.backwards { self.count() - 1 - stage } else { stage }
    }
}

/// Vertices with as many corners as each other; one vertex, if that lies in several parts.
#[derive(Clone, Copy, Debug)]
struct Run {
    /// When they have all their forces.
    stage: u32,
    /// How many corners each has.
    degree: u32,
    /// How many vertices there are.
    count: u32,
    /// Whether their numbers follow each other.
    dense: bool,
    /// In how many parts they lie.
    parts: u32,
}

/// Vertices in a row are a run of their own if runs are so long on average.
const LONG: usize = 8;

impl Gather {
    /// `corners` holds the scene vertex numbers of each element's corners, whose forces are computed with an instruction set. The
    /// sum at a vertex that lies in several parts is one of sums over the parts; the elements at which parts begin are the `cuts`.
    /// Stages may begin with the last elements: what is summed at a vertex, and in which order, is the same.
    pub fn new<const N: usize>(
        corners: &[[u32; N]],
        vertices: &Range<usize>,
        (cuts, backwards): (&[usize], bool),
        set: Arch,
    ) -> Self {
        let plan = Plan { blocks: corners.len().div_ceil(LANES), backwards };
        let mut meeting = vec![Vec::new(); vertices.len()];
        for (element, corners) in corners.iter().enumerate() {
            for (number, &corner) in corners.iter().enumerate() {
                meeting[corner as usize - vertices.start].push((element, number));
            }
        }
        let ends = |all: &[(usize, usize)]| {
            let stage = |corner: Option<&(usize, usize)>| corner.map_or(0, |(element, _)| plan.stage(*element));
            let (one, other) = (stage(all.first()), stage(all.last()));
            (one.min(other), one.max(other))
        };
        // Until a vertex has all its forces they have to stay in the buffer.
        let stays = |all: &Vec<(usize, usize)>| ends(all).1 - ends(all).0;
        let window = 1 + meeting.iter().map(stays).max().unwrap_or(0);
        let order = Order::new(set);
        let place = |&(element, number): &(usize, usize)| {
            let stage = plan.stage(element);
            let block = stage % window * STAGE + element / LANES - plan.span(stage).start;
            2 * ((block * N + number) * LANES + order.place[element % LANES])
        };
        let part = |element: usize| cuts.partition_point(|cut| *cut <= element);
        let same_part = |one: &(usize, usize), other: &(usize, usize)| part(one.0) == part(other.0);
        let parts = |vertex: u32| meeting[vertex as usize].chunk_by(same_part);
        // A vertex is summed in the stage of its last corner.
        let key = |vertex: &u32| {
            let meeting = &meeting[*vertex as usize];
            (ends(meeting).1 as u32, parts(*vertex).count() as u32, meeting.len() as u32)
        };
        let mut ordered: Vec<_> = (0..vertices.len() as u32).collect();
        ordered.sort_by_key(key);
        let runs = ordered.chunk_by(|one, other| key(one) == key(other)).flat_map(|alike| {
            let (stage, parts, degree) = key(&alike[0]);
            let follows = |one: &u32, other: &u32| one + 1 == *other;
            let dense = LONG * alike.chunk_by(follows).count() <= alike.len();
            let joins = move |one: &u32, other: &u32| parts <= 1 && (!dense || follows(one, other));
            alike.chunk_by(joins).map(move |run| Run { stage, degree, count: run.len() as u32, dense, parts })
        });
        let runs = runs.collect();
        let shared = ordered.iter().filter(|vertex| parts(**vertex).count() > 1);
        let shares = shared.flat_map(|vertex| parts(*vertex).map(|corners| corners.len() as u32)).collect();
        let places = ordered.iter().flat_map(|&vertex| &meeting[vertex as usize]).map(place);
        let near: Option<_> = places.clone().map(|place| u16::try_from(place).ok()).collect();
        let far = if near.is_none() { places.map(|place| place as u32).collect() } else { Vec::new() };
        let near = near.unwrap_or_default();
        Self { runs, vertices: ordered, near, far, first: vertices.start, window, shares, plan, set }
    }

    /// The instruction set.
    pub const fn set(&self) -> Arch {
        self.set
    }

    /// How many blocks of elements the buffer of corners has to hold.
    pub const fn blocks(&self) -> usize {
        self.window * STAGE
    }

    /// How many stages there are.
    pub const fn count(&self) -> usize {
        self.plan.count()
    }

    /// The stage of an element.
    pub const fn stage(&self, element: usize) -> usize {
        self.plan.stage(element)
    }

    /// The blocks of a stage.
    pub fn span(&self, stage: usize) -> Range<usize> {
        self.plan.span(stage)
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

/// What is left to be summed.
pub struct Stages<'a> {
    runs: &'a [Run],
    vertices: &'a [u32],
    near: &'a [u16],
    far: &'a [u32],
    shares: &'a [u32],
    first: usize,
    stage: u32,
    set: Arch,
}

impl<'a> Stages<'a> {
    /// Sums what is at the corners of the vertices of the next stage, and hands each its forces.
    #[inline(always)]
    pub fn add<const N: usize>(&mut self, corners: [&[Pairs]; N], to: &mut impl Target<N>) {
        /// A closure might stay a call, without the instruction set.
        struct Next<'a, 'b, T, const N: usize>(&'a mut Stages<'b>, [&'a [Pairs]; N], &'a mut T);
        impl<T: Target<N>, const N: usize> WithSimd for Next<'_, '_, T, N> {
            type Output = ();

            #[inline(always)]
            fn with_simd<S: Simd>(self, set: S) {
                let Self(stages, corners, to) = self;
                match near(&corners) {
                    Some(corners) if stages.far.is_empty() => stages.add_next(set, corners, to),
                    _ => stages.add_next(set, corners.map(<[Pairs]>::as_flattened), to),
                }
            }
        }
        self.set.dispatch(Next(self, corners, to));
    }

    #[inline(always)]
    fn add_next<S: Simd, C: Corners<'a, N>, const N: usize>(&mut self, set: S, corners: C, to: &mut impl Target<N>) {
        while let Some((&Run { stage, degree, count, dense, parts }, runs)) = self.runs.split_first()
            && stage == self.stage
        {
            let (now, vertices) = self.vertices.split_at(count as usize);
            (self.runs, self.vertices) = (runs, vertices);
            let places = C::places(self);
            let (of_now, others) = places.split_at((degree * count) as usize);
            *places = others;
            if parts > 1 {
                let (shares, others) = self.shares.split_at(parts as usize);
                self.shares = others;
                let forces = sum_by_parts(of_now, shares, corners);
                to.take(now.iter().map(|vertex| (self.first + *vertex as usize, forces)));
                continue;
            }
            /// One loop for each of these numbers of corners, with nothing to count or check inside; one for all others.
            macro_rules! loops {
                ($($DEGREE:literal)+) => {
                    match degree {
                        $($DEGREE if C::NEAR && dense => {
                            let (fours, rest) = of_now.as_chunks::<$DEGREE>().0.as_chunks();
                            let first = self.first + now[0] as usize;
                            to.take_run(set, first, fours.iter().map(|four| sum_at_four(four, corners)), rest.iter().map(|places| sum_at(places, corners)));
                        })+
                        $($DEGREE if C::NEAR => hand_out(self.first, now, of_now.as_chunks::<$DEGREE>().0.iter().map(|places| sum_at(places, corners)), to),)+
                        0 => hand_out(self.first, now, repeat_n([f64x2::ZERO; N], now.len()), to),
                        _ => hand_out(self.first, now, of_now.chunks(degree as usize).map(|places| sum_at(places, corners)), to),
                    }
                };
            }
            loops!(2 3 4 5 6 7 8 12);
        }
        self.stage += 1;
    }
}

/// The forces at the corners, of each of several stresses.
trait Corners<'a, const N: usize>: Copy {
    /// What a place is.
    type Place: Copy + 'a;

    /// Whether places need no check.
    const NEAR: bool;

    /// The places that are left.
    fn places<'b>(stages: &'b mut Stages<'a>) -> &'b mut &'a [Self::Place];

    /// One of a stress at a place.
    fn at(self, law: usize, place: Self::Place) -> f64x2;
}

impl<'a, const N: usize> Corners<'a, N> for [&[[f64; 2]]; N] {
    type Place = u32;

    const NEAR: bool = false;

    #[inline(always)]
    fn places<'b>(stages: &'b mut Stages<'a>) -> &'b mut &'a [u32] {
        &mut stages.far
    }

    #[inline(always)]
    fn at(self, law: usize, place: u32) -> f64x2 {
        f64x2::new(self[law][place as usize / 2])
    }
}

/// The buffer of corners up to where places of 16 bits reach: where that is all there is, nobody has to check them.
type Near = [f64; NEAR];

/// A force begins at the last of these places at most.
const NEAR: usize = u16::MAX as usize + 2;

impl<'a, const N: usize> Corners<'a, N> for [&Near; N] {
    type Place = u16;

    const NEAR: bool = true;

    #[inline(always)]
    fn places<'b>(stages: &'b mut Stages<'a>) -> &'b mut &'a [u16] {
        &mut stages.near
    }

    #[inline(always)]
    fn at(self, law: usize, place: u16) -> f64x2 {
        let place = usize::from(place);
        f64x2::new([self[law][place], self[law][place + 1]])
    }
}

/// All of them up to there, if they are as long as that.
#[inline(always)]
fn near<'a, const N: usize>(corners: &[&'a [Pairs]; N]) -> Option<[&'a Near; N]> {
    let near = |corners: &'a [Pairs]| corners.as_flattened().as_flattened().first_chunk();
    let mut all = [near(corners.first()?)?; N];
    for (all, corners) in all.iter_mut().zip(corners) {
        *all = near(corners)?;
    }
    Some(all)
}

/// The sums of the sums over the places in each part.
fn sum_by_parts<'a, C: Corners<'a, N>, const N: usize>(
    mut places: &[C::Place],
    shares: &[u32],
    corners: C,
) -> [f64x2; N] {
    let mut sums = [f64x2::ZERO; N];
    for &share in shares {
        let (now, others) = places.split_at(share as usize);
        for (sum, of_part) in sums.iter_mut().zip(sum_at(now, corners)) {
            *sum += of_part;
        }
        places = others;
    }
    sums
}

/// The sums over these places.
#[inline(always)]
fn sum_at<'a, C: Corners<'a, N>, const N: usize>(places: &[C::Place], corners: C) -> [f64x2; N] {
    let mut sums = [f64x2::ZERO; N];
    for &place in places {
        for (law, sum) in sums.iter_mut().enumerate() {
            *sum += corners.at(law, place);
        }
    }
    sums
}

/// The sums of four vertices.
#[inline(always)]
fn sum_at_four<'a, C: Corners<'a, N>, const D: usize, const N: usize>(
    places: &[[C::Place; D]; 4],
    corners: C,
) -> [[f64x2; N]; 4] {
    let [a, b, c, d] = places;
    [sum_at(a, corners), sum_at(b, corners), sum_at(c, corners), sum_at(d, corners)]
}

/// Hands out forces on these vertices, counted from the first of the body or net.
#[inline(always)]
fn hand_out<const N: usize>(
    first: usize,
    vertices: &[u32],
    forces: impl Iterator<Item = [f64x2; N]>,
    to: &mut impl Target<N>,
) {
    to.take(vertices.iter().map(|vertex| first + *vertex as usize).zip(forces));
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

/// [`Pairs`] in scratch, from where a line of memory begins.
pub fn pairs(scratch: &mut [f64]) -> &mut [Pairs] {
    lined(scratch).as_chunks_mut().0.as_chunks_mut().0
}

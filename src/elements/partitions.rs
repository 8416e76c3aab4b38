//! Partitions of a body: ranges of fans whose forces are assembled independently, in parallel. A fan is two triangles
//! with a common edge (see [`Fan`](crate::meshes::Fan)).
//!
//! The partitions depend on the mesh alone. Each owns a range of vertices. A vertex is an interface vertex if several
//! partitions use it, or if one uses it that does not own it; all others are interior. A partition computes the forces
//! on its fans from its own copy of the positions, and sums them at its interior vertices. At an interface vertex the
//! partial sums are added in the order of the partitions afterwards. So any number of threads gives the same bits.

use super::{
    Accumulator, Scatter,
    blocks::{Block, Blocks, Collected, Forces, StressModel},
    gather::{Corners, Gather, RUN_BLOCKS, STAGE, STAGE_ELEMENTS, pairs, scratch_size},
};
use crate::simd::{INDEXED16, LANES, Order, Pairs};
use pulp::Simd;
use std::{array::from_fn, ops::Range};
use wide::f64x2;

/// A stage is a number of whole runs.
const _: () = assert!(STAGE.is_multiple_of(RUN_BLOCKS));

/// Fewest fans of a partition; fewer take less time than a transfer to another core.
const LEAST_FANS: usize = 2048;

/// Greatest fraction of vertices on interfaces, which one core sums; else there are fewer partitions.
const MOST_INTERFACE: f64 = 0.05;

/// All partitions of a body. Vertices are counted from the first of the body.
#[derive(Debug)]
pub struct Partitions {
    all: Vec<Partition>,
    vertices: usize,
    /// The vertices of all fans, where there are several partitions.
    whole: Option<Corners<4>>,
    /// The interface vertices, each with the end of its slots.
    interface: Vec<(u32, u32)>,
    /// Where the partial sums of each interface vertex are, in the order of the partitions.
    slots: Vec<u32>,
}

/// A range of fans and the range of vertices that it owns.
#[derive(Debug)]
struct Partition {
    owned: Range<usize>,
    blocks: Range<usize>,
    /// The interface vertices that its fans have, ascending. In the partition's numbering they come after the owned ones.
    shared: Vec<u32>,
    corners: Corners<4>,
    gather: Gather,
}

/// Whether a body has fans enough for several partitions, but its vertices are numbered in an order that allows only one.
pub fn is_unpartitioned(fans: &[[u32; 4]], vertices: usize) -> bool {
    fans.len() >= 2 * LEAST_FANS && Cut::best(fans, vertices).fans.len() == 1
}

/// The first fan of each partition, the vertices that each owns, and the interface vertices.
struct Cut {
    fans: Vec<usize>,
    owned: Vec<Range<usize>>,
    interface: Vec<u32>,
}

impl Cut {
    /// As many partitions as fans are enough for, and fewer as long as too many vertices lie on interfaces.
    fn best(fans: &[[u32; 4]], vertices: usize) -> Self {
        let mut cut = Self::new(fans, vertices, (fans.len() / LEAST_FANS).max(1));
        while cut.fans.len() > 1 && cut.interface.len() as f64 > MOST_INTERFACE * vertices as f64 {
            cut = Self::new(fans, vertices, cut.fans.len() - cut.fans.len().div_ceil(4));
        }
        cut
    }

    /// Cuts fans into equal parts, and vertices where the fewest are on the wrong side.
    fn new(fans: &[[u32; 4]], vertices: usize, count: usize) -> Self {
        let begin = |part: usize| fans.len() * part / count / STAGE_ELEMENTS * STAGE_ELEMENTS;
        let begins: Vec<_> = (0..count).map(begin).collect();
        let mut touching = vec![None; vertices];
        for (fan, corners) in fans.iter().enumerate() {
            let part = begins.partition_point(|begin| *begin <= fan) - 1;
            for &corner in corners {
                let (_, last) = touching[corner as usize].get_or_insert((part, part));
                *last = part;
            }
        }
        let mut bounds = vec![0];
        for part in 1..count {
            // Of the vertices below a boundary, those that later partitions use less those that earlier ones use: least
            // at the best boundary.
            let (mut balance, mut best) = (0_i64, (0, 0));
            for (vertex, parts) in touching.iter().enumerate() {
                if vertex % 4 == 0 && balance < best.0 {
                    best = (balance, vertex);
                }
                balance += parts.map_or(0, |(first, last)| i64::from(first >= part) - i64::from(last < part));
            }
            bounds.push(best.1.max(bounds[part - 1]));
        }
        bounds.push(vertices);
        let owned: Vec<_> = bounds.windows(2).map(|ends| ends[0]..ends[1]).collect();
        let is_shared = |&vertex: &u32| {
            touching[vertex as usize]
                .is_some_and(|(first, last)| first != last || !owned[first].contains(&(vertex as usize)))
        };
        let interface = (0..vertices as u32).filter(is_shared).collect();
        Self { fans: begins, owned, interface }
    }
}

impl Partitions {
    /// The partitions of a body with these fans and a number of vertices. `first` is the number of its first vertex in
    /// the scene.
    pub fn new(fans: &[[u32; 4]], (first, vertices): (usize, usize), order: &Order) -> Self {
        let Cut { fans: begins, owned, interface } = Cut::best(fans, vertices);
        let ends = begins.iter().skip(1).copied().chain([fans.len()]);
        let all: Vec<_> = begins
            .iter()
            .zip(ends)
            .zip(owned)
            .map(|((begin, end), owned)| Partition::new(&fans[*begin..end], *begin, owned, (first, &interface), order))
            .collect();
        let mut places = vec![Vec::new(); interface.len()];
        let shared = all.iter().flat_map(|partition| &partition.shared);
        for (slot, vertex) in shared.enumerate() {
            places[interface.partition_point(|other| other < vertex)].push(slot as u32);
        }
        let slots = places.concat();
        let ends = places.iter().scan(0, |end, places| {
            *end += places.len() as u32;
            Some(*end)
        });
        let interface = interface.into_iter().zip(ends).collect();
        Self { whole: (all.len() > 1).then(|| Corners::new(fans, 0)), all, vertices, interface, slots }
    }

    /// The vertices of all fans.
    pub fn corners(&self) -> &Corners<4> {
        self.whole.as_ref().unwrap_or_else(|| &self.all[0].corners)
    }

    /// Number of partitions.
    pub const fn count(&self) -> usize {
        self.all.len()
    }

    /// Size of scratch of the assembly for each stress.
    pub fn scratch(&self) -> usize {
        2 * self.slots.len() + self.all.iter().map(|partition| partition.scratch(1)).sum::<usize>()
    }

    /// Assembles the forces of stresses on all fans into an accumulator. Returns the [sum](Accumulator::sum) of the
    /// accumulator.
    pub fn assemble<L: StressModel<N>, T: Accumulator<N>, const N: usize>(
        &self,
        model: L,
        blocks: &Blocks,
        accumulator: &mut T,
        scratch: &mut [f64],
    ) -> f64 {
        let (partial, copies) = scratch.split_at_mut(2 * N * self.slots.len());
        let partial = partial.as_chunks_mut().0;
        if self.all.len() > 1 {
            let [x, v] = accumulator.motion();
            let mut left = &mut *copies;
            for partition in &self.all {
                let own = left.split_off_mut(..partition.scratch(N)).unwrap_or_default();
                partition.copy_shared([x, if L::RATE { v } else { &[] }], own);
            }
        }
        let job = Job { model, blocks: blocks.all() };
        let sum = job.run(&self.all, accumulator.view(0..self.vertices), copies, partial);
        let mut begin = 0;
        accumulator.take(self.interface.iter().map(|&(vertex, end)| {
            let slots = &self.slots[begin..end as usize];
            begin = end as usize;
            let mut forces = [f64x2::ZERO; N];
            for &slot in slots {
                for (stress, force) in forces.iter_mut().enumerate() {
                    *force += f64x2::new(partial[slot as usize * N + stress]);
                }
            }
            (vertex as usize, forces)
        }));
        sum + accumulator.sum()
    }
}

/// Stress model and blocks, common to all partitions.
#[derive(Clone, Copy)]
struct Job<'a, L> {
    model: L,
    blocks: &'a [Block],
}

impl<L> Job<'_, L> {
    /// Assembles the forces of some partitions; the accumulator holds the vertices that they own. The sums of halves of
    /// the list are added as a tree, independent of threads.
    fn run<T: Accumulator<N>, const N: usize>(
        self,
        partitions: &[Partition],
        accumulator: T,
        scratch: &mut [f64],
        partial: &mut [[f64; 2]],
    ) -> f64
    where
        L: StressModel<N>,
    {
        let (first, second) = match partitions {
            [] => return 0.0,
            [partition] => return partition.assemble(self, accumulator, scratch, partial),
            _ => partitions.split_at(partitions.len() / 2),
        };
        let sizes = |partition: &Partition| [partition.owned.len(), partition.scratch(N), N * partition.shared.len()];
        let [vertices, numbers, slots] =
            first.iter().map(sizes).fold([0; 3], |sums, sizes| from_fn(|which| sums[which] + sizes[which]));
        let (one, other) = accumulator.split(vertices);
        let (scratch, other_scratch) = scratch.split_at_mut(numbers);
        let (partial, other_partial) = partial.split_at_mut(slots);
        let sums =
            join(|| self.run(first, one, scratch, partial), || self.run(second, other, other_scratch, other_partial));
        sums.0 + sums.1
    }
}

/// Runs both, in parallel if this thread belongs to a thread pool.
fn join(one: impl FnOnce() -> f64 + Send, other: impl FnOnce() -> f64 + Send) -> (f64, f64) {
    if rayon::current_thread_index().is_some() { rayon::join(one, other) } else { (one(), other()) }
}

impl Partition {
    fn new(
        fans: &[[u32; 4]],
        begin: usize,
        owned: Range<usize>,
        (first, interface): (usize, &[u32]),
        order: &Order,
    ) -> Self {
        let is_shared = |vertex: &u32| interface.binary_search(vertex).is_ok();
        let mut shared: Vec<_> = fans.as_flattened().iter().copied().filter(is_shared).collect();
        shared.sort_unstable();
        shared.dedup();
        let renumbered = |vertex: u32| match shared.binary_search(&vertex) {
            Ok(at) => owned.len() + at,
            Err(_) => vertex as usize - owned.start,
        };
        let corners: Vec<_> = fans.iter().map(|fan| fan.map(|vertex| renumbered(vertex) as u32)).collect();
        let is_summed = |vertex: u32| vertex as usize >= owned.len() || !is_shared(&(vertex + owned.start as u32));
        let summed = (0..(owned.len() + shared.len()) as u32).filter(|vertex| is_summed(*vertex)).collect();
        let gather = Gather::new(&corners, summed, first + owned.start, order);
        let begin = begin / LANES;
        let blocks = begin..begin + fans.len().div_ceil(LANES);
        Self { owned, blocks, shared, corners: Corners::new(&corners, 0), gather }
    }

    /// Size of a copy of the positions, padded so that [`Indexed16`](crate::simd::Indexed16) numbers follow each one.
    fn copy(&self) -> usize {
        2 * (self.owned.len() + self.shared.len()) + INDEXED16
    }

    /// Size of scratch for a number of stresses.
    fn scratch(&self, stresses: usize) -> usize {
        2 * self.copy() + stresses * scratch_size(4 * self.gather.buffer())
    }

    /// Copies the positions and velocities of its interface vertices.
    fn copy_shared(&self, motion: [&[f64]; 2], scratch: &mut [f64]) {
        for (values, copy) in motion.into_iter().zip(scratch.chunks_mut(self.copy())) {
            let values: &[[f64; 2]] = values.as_chunks().0;
            let copy: &mut [[f64; 2]] = &mut copy.as_chunks_mut().0[self.owned.len()..];
            for (to, vertex) in copy.iter_mut().zip(&self.shared) {
                if let Some(value) = values.get(*vertex as usize) {
                    *to = *value;
                }
            }
        }
    }

    /// Assembles the forces on its fans. The accumulator holds the vertices that it owns; `partial` receives the forces at
    /// the interface.
    fn assemble<L: StressModel<N>, T: Accumulator<N>, const N: usize>(
        &self,
        Job { model, blocks }: Job<'_, L>,
        accumulator: T,
        scratch: &mut [f64],
        partial: &mut [[f64; 2]],
    ) -> f64 {
        let (x, scratch) = scratch.split_at_mut(self.copy());
        let (v, mut scratch) = scratch.split_at_mut(self.copy());
        let own = 2 * self.owned.len();
        let [from_x, from_v] = accumulator.motion();
        x[..own].copy_from_slice(&from_x[..own]);
        if L::RATE {
            v[..own].copy_from_slice(&from_v[..own]);
        }
        let each = scratch_size(4 * self.gather.buffer());
        let mut forces: [&mut [Pairs]; N] = from_fn(|_| pairs(scratch.split_off_mut(..each).unwrap_or_default()));
        let mut collected = Collected::default();
        let mut accumulator = Local { accumulator, owned: self.owned.len(), partial };
        let mut stages = self.gather.stages();
        for stage in 0..self.gather.count() {
            let span = self.gather.span(stage);
            let slot = 4 * self.gather.slot(stage);
            let out = forces.each_mut().map(|forces| forces[slot..].as_chunks_mut().0.as_chunks_mut().0);
            self.gather.set().dispatch(Forces {
                model,
                corners: &self.corners,
                first: span.start / RUN_BLOCKS,
                blocks: &blocks[self.blocks.clone()][span],
                x,
                v,
                collected: &mut collected,
                out,
            });
            stages.add(forces.each_ref().map(|forces| &**forces), &mut accumulator);
        }
        accumulator.accumulator.sum()
    }
}

/// Accumulator of a partition, and the partial sums at the interface.
struct Local<'a, T> {
    accumulator: T,
    /// Number of owned vertices, which precede those of the interface.
    owned: usize,
    partial: &'a mut [[f64; 2]],
}

impl<T: Scatter<N>, const N: usize> Scatter<N> for Local<'_, T> {
    #[inline(always)]
    fn take(&mut self, forces: impl Iterator<Item = (usize, [f64x2; N])>) {
        let Self { accumulator, owned, partial } = self;
        accumulator.take(forces.filter(|&(vertex, forces)| {
            let Some(at) = vertex.checked_sub(*owned) else { return true };
            for (stress, force) in forces.iter().enumerate() {
                partial[at * N + stress] = force.to_array();
            }
            false
        }));
    }

    #[inline(always)]
    fn take_run<S: Simd>(
        &mut self,
        set: S,
        first: usize,
        fours: impl ExactSizeIterator<Item = [[f64x2; N]; 4]>,
        rest: impl ExactSizeIterator<Item = [f64x2; N]>,
    ) {
        if first + 4 * fours.len() + rest.len() > self.owned {
            return self.take((first..).zip(fours.flatten().chain(rest)));
        }
        self.accumulator.take_run(set, first, fours, rest);
    }
}

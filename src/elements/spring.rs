//! Spring elements.

use super::{
    Accumulator, Adding, EulerUpdate,
    corners::{Corners, RUN_BLOCKS},
    gather::{Gather, pairs, scratch_size},
};
use crate::{
    effects::{Effect, Motion},
    nets::{Link, Net},
    simd::{INDEXED16, LANES, Lanes, Order, Pairs, Real, Wide},
    solvers::{BlockMatrix, Tangent, Weights},
};
use nalgebra::Matrix2;
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// The springs of one net: linear in their length.
///
/// With d from one end to the other, a spring of stiffness k and rest length r stores `k/2 (|d| - r)²` and pulls its first
/// end by `k (|d| - r) d/|d|`, its other end by the opposite. Its stiffness is `k (u uᵀ + (1 - r/|d|) (I - u uᵀ))` for
/// u = d/|d|: across a compressed spring it is negative, which is why it buckles.
///
/// A spring whose ends coincide has no direction: it gives no force. Springs are summed at each particle in the order of
/// the net.
#[derive(Debug)]
pub struct Springs {
    vertices: Range<usize>,
    links: Vec<Link>,
    ends: Corners<2>,
    blocks: Vec<Block>,
    gather: Gather,
}

/// Eight springs side by side, in the lanes that [`Order::of_pairs`] gives them.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
struct Block {
    /// [N/m].
    stiffness: Lanes,
    /// Length at rest [m].
    rest: Lanes,
}

impl Springs {
    /// The springs of a net whose particles are the scene's `vertices`.
    pub fn new(net: &Net, vertices: Range<usize>) -> Self {
        let first = vertices.start as u32;
        let links = net.links().iter().map(|link| Link { ends: link.ends.map(|end| end + first), ..*link });
        Self::of_links(links.collect(), vertices, Arch::new())
    }

    fn of_links(links: Vec<Link>, vertices: Range<usize>, set: Arch) -> Self {
        let ends: Vec<_> = links.iter().map(|link| link.ends.map(|end| end - vertices.start as u32)).collect();
        let order = Order::of_pairs(set);
        let pack = |links: &[Link]| {
            let mut block = Block::default();
            for (link, lane) in links.iter().zip(order.lane) {
                (block.stiffness[lane], block.rest[lane]) = (link.stiffness, link.rest);
            }
            block
        };
        Self {
            ends: Corners::new(&ends, 0),
            blocks: links.chunks(LANES).map(pack).collect(),
            gather: Gather::new(&ends, (0..vertices.len() as u32).collect(), vertices.start, &order),
            links,
            vertices,
        }
    }

    /// The same with another instruction set: the same bits in more time.
    #[must_use]
    pub fn in_set(&self, set: Arch) -> Self {
        Self::of_links(self.links.clone(), self.vertices.clone(), set)
    }

    /// Scene numbers of the net's particles.
    pub const fn vertices(&self) -> &Range<usize> {
        &self.vertices
    }

    /// The springs; their ends are scene vertex numbers.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// Stored energy at these positions [J].
    pub fn elastic_energy(&self, x: &[f64]) -> f64 {
        let stored = |link: &Link| {
            let longer = link.length(x) - link.rest;
            0.5 * link.stiffness * longer * longer
        };
        self.links.iter().map(stored).sum()
    }

    /// Assembles the forces on the particles into an accumulator. Returns the [sum](Accumulator::sum) of the
    /// accumulator.
    fn assemble(&self, accumulator: &mut impl Accumulator, scratch: &mut [f64]) -> f64 {
        let mut accumulator = accumulator.view(self.vertices.clone());
        let (copy, scratch) = scratch.split_at_mut(self.copy());
        copy[..2 * self.vertices.len()].copy_from_slice(accumulator.motion()[0]);
        let (gather, pairs) = (&self.gather, pairs(scratch));
        let mut stages = gather.stages();
        for stage in 0..gather.count() {
            let span = gather.span(stage);
            let out = pairs[2 * gather.slot(stage)..].as_chunks_mut().0.as_chunks_mut().0;
            gather.set().dispatch(Pulls {
                ends: &self.ends,
                first: span.start / RUN_BLOCKS,
                blocks: &self.blocks[span],
                x: copy,
                out,
            });
            stages.add([&*pairs], &mut accumulator);
        }
        accumulator.sum()
    }

    /// Size of a copy of the positions, with enough numbers after them to be read as
    /// [`Indexed16`](crate::simd::Indexed16).
    fn copy(&self) -> usize {
        2 * self.vertices.len() + INDEXED16
    }

    /// Adds dampers beside the springs, `c = beta k` [N s/m]: each damps only the rate of length of its spring, so that
    /// a rigid motion is not damped. At rest it is Rayleigh's `-beta K v`.
    pub(crate) fn add_damping(&self, x: &[f64], v: &[f64], beta: f64, force: &mut [f64]) {
        for link in &self.links {
            let Some(([ux, uy], _)) = direction(x, link) else { continue };
            let [vx, vy] = between(v, link);
            let pull = beta * link.stiffness * (vx * ux + vy * uy);
            add_pair(force, link, [pull * ux, pull * uy]);
        }
    }

    /// Adds `factor (-d force/dv)` of the dampers, one couple for each spring.
    pub(crate) fn add_damping_stiffness(&self, x: &[f64], beta: f64, factor: f64, matrix: &mut BlockMatrix) {
        for link in &self.links {
            let [ux, uy] = direction(x, link).map_or([0.0; 2], |(along, _)| along);
            add_block(matrix, link, [ux * ux, ux * uy, uy * uy].map(|entry| factor * beta * link.stiffness * entry));
        }
    }
}

/// Adds the stiffness between the two ends of the next spring of the list, xx, xy, yy.
#[inline]
fn add_block(matrix: &mut BlockMatrix, link: &Link, [xx, xy, yy]: [f64; 3]) {
    let block = Matrix2::new(xx, xy, xy, yy);
    for end in link.ends {
        matrix.diagonal(end as usize, &block);
    }
    matrix.off_diagonal(&-block);
}

/// From the first end to the second.
#[inline]
fn between(values: &[f64], link: &Link) -> [f64; 2] {
    let [a, b] = link.ends.map(|end| 2 * end as usize);
    [values[b] - values[a], values[b + 1] - values[a + 1]]
}

/// The unit vector from the first end to the second, and their distance [m]; none if they coincide.
#[inline]
fn direction(x: &[f64], link: &Link) -> Option<([f64; 2], f64)> {
    let [dx, dy] = between(x, link);
    let length = (dx * dx + dy * dy).sqrt();
    (length > 0.0).then(|| ([dx / length, dy / length], length))
}

/// Adds a vector at the first end and its opposite at the second.
#[inline]
fn add_pair(values: &mut [f64], link: &Link, [fx, fy]: [f64; 2]) {
    let [a, b] = link.ends.map(|end| 2 * end as usize);
    values[a] += fx;
    values[a + 1] += fy;
    values[b] -= fx;
    values[b + 1] -= fy;
}

/// The stiffness between the ends [N/m], symmetric: xx, xy, yy.
///
/// Where the ends coincide it is k in every direction: the limit for a spring without a rest length, and for others a
/// finite stand-in that holds the ends together.
#[inline]
fn block(x: &[f64], link: &Link, tangent: Tangent) -> [f64; 3] {
    let Some(([ux, uy], length)) = direction(x, link) else { return [link.stiffness, 0.0, link.stiffness] };
    let mut across = 1.0 - link.rest / length;
    match tangent {
        Tangent::Exact => {}
        Tangent::Definite => across = across.max(0.0),
        Tangent::Absolute => across = across.abs(),
    }
    let along = 1.0 - across;
    [across + along * ux * ux, along * ux * uy, across + along * uy * uy].map(|entry| link.stiffness * entry)
}

/// Vectors between the ends of the springs of a run.
#[derive(Default)]
#[repr(align(64))]
struct EdgeVectorBuffer([[Pairs; 1]; RUN_BLOCKS]);

/// Computes the forces at both ends of all springs.
struct Pulls<'a> {
    ends: &'a Corners<2>,
    /// The run with which `blocks` begins.
    first: usize,
    blocks: &'a [Block],
    x: &'a [f64],
    /// The forces, run by run.
    out: &'a mut [[[Pairs; 2]; RUN_BLOCKS]],
}

impl WithSimd for Pulls<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) {
        let Self { ends, first, blocks, x, out } = self;
        let between = |[a, b]: [[f64; 2]; 2]| [[b[0] - a[0], b[1] - a[1]]];
        let (mut now, mut ahead) = (EdgeVectorBuffer::default(), None);
        let runs = blocks.chunks(RUN_BLOCKS);
        let last = first + runs.len();
        for ((run, blocks), out) in (first..last).zip(runs).zip(out) {
            if ahead.is_none() {
                ends.collect(run, x, between, &mut now.0);
            }
            ahead = if run + 1 < last { ends.ahead(run + 1, x) } else { None };
            for (number, ((block, now), [one, other])) in blocks.iter().zip(&mut now.0).zip(out).enumerate() {
                for part in 0..Wide::<S>::PARTS {
                    let [dx, dy] = Wide::load_pairs(set, &now[0], part);
                    let stiffness = Wide::load(set, &block.stiffness, part);
                    let rest = Wide::load(set, &block.rest, part);
                    let length = (dx * dx + dy * dy).sqrt();
                    let (zero, unit) = (length.of(0.0), length.of(1.0));
                    let pull = stiffness * (length - rest) / zero.if_less(length, length, unit);
                    let (fx, fy) = (pull * dx, pull * dy);
                    Wide::store_pairs(fx, fy, one, part);
                    Wide::store_pairs(-fx, -fy, other, part);
                }
                // The next run is gathered in parallel to the arithmetic, as with triangles.
                if let Some(ahead) = ahead {
                    ahead.collect(number, between, now);
                }
            }
        }
    }
}

impl Effect for Springs {
    fn name(&self) -> &'static str {
        "Springs"
    }

    fn elements(&self, _: Motion<'_>) -> usize {
        self.links.len()
    }

    fn energy(&self, motion: Motion<'_>) -> f64 {
        self.elastic_energy(motion.x)
    }

    fn scratch(&self) -> usize {
        self.copy() + scratch_size(2 * self.gather.buffer())
    }

    fn force(&self, motion: Motion<'_>, scratch: &mut [f64], force: &mut [f64]) {
        self.assemble(&mut Adding { x: motion.x, v: &[], force }, scratch);
    }

    fn euler_update(&self, vertices: &mut EulerUpdate<'_>, scratch: &mut [f64]) {
        vertices.twice_kinetic += self.assemble(vertices, &mut scratch[..self.scratch()]);
    }

    fn stiffness_times(&self, motion: Motion<'_>, d: &[f64], _: &mut [f64], product: &mut [f64]) {
        for link in &self.links {
            let ([xx, xy, yy], [dx, dy]) = (block(motion.x, link, Tangent::Exact), between(d, link));
            add_pair(product, link, [-xx * dx - xy * dy, -xy * dx - yy * dy]);
        }
    }

    fn sparsity_pattern(&self, add: &mut dyn FnMut(u32, u32)) {
        for link in &self.links {
            add(link.ends[0], link.ends[1]);
        }
    }

    fn add_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut BlockMatrix) {
        for link in &self.links {
            add_block(matrix, link, block(motion.x, link, weights.tangent).map(|entry| weights.position * entry));
        }
    }
}

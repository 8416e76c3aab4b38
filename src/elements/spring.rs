//! Spring elements.

use super::{
    Accumulator, Adding, ElasticElements, EulerUpdate, SpaceSprings,
    gather::{Corners, RUN_BLOCKS},
    gather::{Gather, pairs, scratch_size},
};
use crate::{
    effects::{Effect, Motion, ZERO},
    nets::{Link, Net},
    simd::{INDEXED16, LANES, Lanes, Order, Pairs, Real, Wide},
    solvers::{Block as MatrixBlock, BlockMatrix, SparseMatrix, Tangent, Weights},
};
use nalgebra::SVector;
use pulp::{Arch, Simd, WithSimd};
use std::{ops::Range, sync::Arc};

/// The springs of one net, in the plane or in space: linear in their length.
///
/// With d from one end to the other, a spring of stiffness k and rest length r stores `k/2 (|d| - r)²` and pulls its first
/// end by `k (|d| - r) d/|d|`, its other end by the opposite. Its stiffness is `k (u uᵀ + (1 - r/|d|) (I - u uᵀ))` for
/// u = d/|d|: across a compressed spring it is negative, which is why it buckles.
///
/// A spring whose ends coincide has no direction: it gives no force. Springs are summed at each particle in the order of
/// the net.
#[derive(Debug)]
pub struct Springs<const D: usize = 2> {
    vertices: Range<usize>,
    links: Vec<Link>,
    /// Whether no spring has any stiffness.
    is_slack: bool,
    /// Force assembly by SIMD, for springs in the plane.
    packed: Option<Packed>,
    /// The same for springs in space.
    in_space: Option<SpaceSprings>,
}

/// Springs in SIMD vectors, in the plane.
#[derive(Debug)]
struct Packed {
    vertices: Range<usize>,
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
    /// Length at rest \[m\].
    rest: Lanes,
}

impl Springs {
    /// The springs of a net whose particles are the scene's `vertices`.
    pub fn new(net: &Net, vertices: Range<usize>) -> Self {
        let first = vertices.start as u32;
        let links = net.links().iter().map(|link| Link { ends: link.ends.map(|end| end + first), ..*link });
        Self::packed(links.collect(), vertices, Arch::new())
    }

    fn packed(links: Vec<Link>, vertices: Range<usize>, set: Arch) -> Self {
        Self { packed: Some(Packed::new(&links, vertices.clone(), set)), ..Self::of_links(links, vertices) }
    }

    /// The same with another instruction set: the same bits in more time.
    #[must_use]
    pub fn in_set(&self, set: Arch) -> Self {
        Self::packed(self.links.clone(), self.vertices.clone(), set)
    }
}

impl<const D: usize> Springs<D> {
    /// Springs between the scene's `vertices`, by their numbers in the scene.
    pub fn of_links(links: Vec<Link>, vertices: Range<usize>) -> Self {
        let is_slack = links.iter().all(|link| link.stiffness == 0.0);
        let in_space = (D == 3).then(|| SpaceSprings::new(&links, Arch::new()));
        Self { vertices, links, is_slack, packed: None, in_space }
    }

    /// Scene numbers of the net's particles.
    pub const fn vertices(&self) -> &Range<usize> {
        &self.vertices
    }

    /// The springs; their ends are scene vertex numbers.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// Stored energy at these positions \[J\].
    pub fn elastic_energy(&self, x: &[f64]) -> f64 {
        let stored = |link: &Link| {
            let longer = between::<D>(x, link).norm() - link.rest;
            0.5 * link.stiffness * longer * longer
        };
        self.links.iter().map(stored).sum()
    }

    /// Adds dampers beside the springs, `c = beta k` [N s/m]: each damps only the rate of length of its spring, so that
    /// a rigid motion is not damped. At rest it is Rayleigh's `-beta K v`.
    pub(crate) fn add_damping(&self, x: &[f64], v: &[f64], beta: f64, force: &mut [f64]) {
        for link in &self.links {
            let Some((along, _)) = direction::<D>(x, link) else { continue };
            let pull = beta * link.stiffness * between::<D>(v, link).dot(&along);
            add_pair(force, link, along * pull);
        }
    }

    /// Adds `factor (-d force/dv)` of the dampers, one couple for each spring.
    pub(crate) fn add_damping_stiffness(&self, x: &[f64], beta: f64, factor: f64, matrix: &mut BlockMatrix<D>) {
        self.add_blocks(matrix, |link| {
            let along = direction::<D>(x, link).map_or_else(SVector::zeros, |(along, _)| along);
            (along * along.transpose()).map(|entry| factor * beta * link.stiffness * entry)
        });
    }

    /// Adds the stiffness between the two ends of each spring.
    fn add_blocks(&self, matrix: &mut BlockMatrix<D>, block: impl Fn(&Link) -> MatrixBlock<D> + Sync) {
        matrix.add_by_rows(self.links.len(), self.vertices.clone(), |mut rows| {
            for (number, link) in self.links.iter().enumerate() {
                if rows.have_any(&link.ends) {
                    let block = block(link);
                    link.ends.iter().for_each(|end| rows.diagonal(*end, &block));
                    rows.off_diagonal(number, &-block);
                }
            }
        });
    }
}

/// The springs of a net of a level: in the plane or in space.
#[derive(Clone, Debug)]
pub enum NetSprings {
    /// In the plane.
    Plane(Arc<Springs>),
    /// In space.
    Space(Arc<Springs<3>>),
}

impl NetSprings {
    /// The springs; their ends are scene vertex numbers.
    pub fn links(&self) -> &[Link] {
        match self {
            Self::Plane(springs) => springs.links(),
            Self::Space(springs) => springs.links(),
        }
    }

    /// Scene numbers of the net's particles.
    pub fn vertices(&self) -> &Range<usize> {
        match self {
            Self::Plane(springs) => springs.vertices(),
            Self::Space(springs) => springs.vertices(),
        }
    }

    /// Stored energy at these positions \[J\].
    pub fn elastic_energy(&self, x: &[f64]) -> f64 {
        match self {
            Self::Plane(springs) => springs.elastic_energy(x),
            Self::Space(springs) => springs.elastic_energy(x),
        }
    }

    /// Number of coordinates of a particle.
    pub const fn dimension(&self) -> usize {
        match self {
            Self::Plane(_) => 2,
            Self::Space(_) => 3,
        }
    }

    /// The springs of a net in the plane.
    pub const fn plane(&self) -> Option<&Arc<Springs>> {
        match self {
            Self::Plane(springs) => Some(springs),
            Self::Space(_) => None,
        }
    }

    /// Length of a spring at these positions \[m\].
    pub fn length(&self, link: &Link, x: &[f64]) -> f64 {
        match self {
            Self::Plane(_) => between::<2>(x, link).norm(),
            Self::Space(_) => between::<3>(x, link).norm(),
        }
    }

    /// The elements.
    pub fn elements(&self) -> Arc<dyn ElasticElements> {
        match self {
            Self::Plane(springs) => Arc::clone(springs) as Arc<dyn ElasticElements>,
            Self::Space(springs) => Arc::clone(springs) as Arc<dyn ElasticElements>,
        }
    }

    /// See [`Springs::add_damping`].
    pub(crate) fn add_damping(&self, x: &[f64], v: &[f64], beta: f64, force: &mut [f64]) {
        match self {
            Self::Plane(springs) => springs.add_damping(x, v, beta, force),
            Self::Space(springs) => springs.add_damping(x, v, beta, force),
        }
    }

    /// See [`Springs::add_damping_stiffness`].
    pub(crate) fn add_damping_stiffness(&self, x: &[f64], beta: f64, factor: f64, matrix: &mut dyn SparseMatrix) {
        match self {
            Self::Plane(springs) => {
                if let Some(matrix) = matrix.blocks() {
                    springs.add_damping_stiffness(x, beta, factor, matrix);
                }
            }
            Self::Space(springs) => {
                if let Some(matrix) = matrix.blocks() {
                    springs.add_damping_stiffness(x, beta, factor, matrix);
                }
            }
        }
    }
}

impl Packed {
    fn new(links: &[Link], vertices: Range<usize>, set: Arch) -> Self {
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
            vertices,
        }
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

    fn scratch(&self) -> usize {
        self.copy() + scratch_size(2 * self.gather.buffer())
    }
}

/// From the first end to the second.
#[inline]
pub(super) fn between<const D: usize>(values: &[f64], link: &Link) -> SVector<f64, D> {
    let points = values.as_chunks::<D>().0;
    let [a, b] = link.ends.map(|end| SVector::from(points[end as usize]));
    b - a
}

/// The unit vector from the first end to the second, and their distance \[m\]; none if they coincide.
#[inline]
pub(crate) fn direction<const D: usize>(x: &[f64], link: &Link) -> Option<(SVector<f64, D>, f64)> {
    let between = between::<D>(x, link);
    let length = between.norm();
    (length > 0.0).then(|| (between / length, length))
}

/// Adds a vector at the first end and its opposite at the second.
#[inline]
pub(super) fn add_pair<const D: usize>(values: &mut [f64], link: &Link, vector: SVector<f64, D>) {
    let points = values.as_chunks_mut::<D>().0;
    let [a, b] = link.ends.map(|end| end as usize);
    points[a].iter_mut().zip(&vector).for_each(|(into, value)| *into += value);
    points[b].iter_mut().zip(&vector).for_each(|(into, value)| *into -= value);
}

/// The stiffness between the ends [N/m], symmetric.
///
/// Where the ends coincide it is k in every direction: the limit for a spring without a rest length, and for others a
/// finite stand-in that holds the ends together.
#[inline]
fn stiffness<const D: usize>(x: &[f64], link: &Link, tangent: Tangent) -> MatrixBlock<D> {
    let Some((along, length)) = direction::<D>(x, link) else {
        return MatrixBlock::from_diagonal_element(link.stiffness);
    };
    let mut across = 1.0 - link.rest / length;
    match tangent {
        Tangent::Exact => {}
        Tangent::Definite => across = across.max(0.0),
        Tangent::Absolute => across = across.abs(),
    }
    let mut block = MatrixBlock::zeros();
    for (row, column) in (0..D).flat_map(|row| (0..D).map(move |column| (row, column))) {
        let [one, other] = [row.min(column), row.max(column)];
        let rotated = (1.0 - across) * along[one] * along[other];
        block[(row, column)] = link.stiffness * if row == column { across + rotated } else { rotated };
    }
    block
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

impl<const D: usize> ElasticElements for Springs<D> {
    fn vertices(&self) -> Range<usize> {
        self.vertices.clone()
    }

    /// Both are the sum of k L² over all springs of length L at rest.
    fn energy_scales(&self) -> [f64; 2] {
        [self.links.iter().map(|link| link.stiffness * link.rest * link.rest).sum(); 2]
    }
}

impl<const D: usize> Effect for Springs<D> {
    fn name(&self) -> &'static str {
        "Springs"
    }

    fn elements(&self, _: Motion<'_>) -> usize {
        self.links.len()
    }

    fn idle(&self, _: Motion<'_>) -> Option<&'static str> {
        self.is_slack.then_some(ZERO)
    }

    fn energy(&self, motion: Motion<'_>) -> f64 {
        self.elastic_energy(motion.x)
    }

    fn scratch(&self) -> usize {
        self.packed.as_ref().map_or(0, Packed::scratch)
    }

    fn force(&self, motion: Motion<'_>, scratch: &mut [f64], force: &mut [f64]) {
        if motion.elastic_span != 0.0 {
            return self.add_mean_force(motion, force);
        }
        if let Some(packed) = &self.packed {
            packed.assemble(&mut Adding { x: motion.x, v: &[], force }, scratch);
            return;
        }
        if let Some(springs) = &self.in_space {
            return springs.add_force(motion.x, force);
        }
        for link in &self.links {
            if let Some((along, length)) = direction::<D>(motion.x, link) {
                add_pair(force, link, along * (link.stiffness * (length - link.rest)));
            }
        }
    }

    fn has_euler_update(&self) -> bool {
        self.packed.is_some()
    }

    fn euler_update(&self, vertices: &mut EulerUpdate<'_>, scratch: &mut [f64]) {
        if let Some(packed) = &self.packed {
            vertices.twice_kinetic += packed.assemble(vertices, &mut scratch[..packed.scratch()]);
        }
    }

    fn stiffness_times(&self, motion: Motion<'_>, d: &[f64], _: &mut [f64], product: &mut [f64]) {
        for link in &self.links {
            let block = stiffness::<D>(motion.x, link, Tangent::Exact);
            add_pair(product, link, block * -between(d, link));
        }
    }

    fn sparsity_pattern(&self, add: &mut dyn FnMut(u32, u32)) {
        for link in &self.links {
            add(link.ends[0], link.ends[1]);
        }
    }

    fn add_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix) {
        let Some(matrix) = matrix.blocks::<D>() else { return };
        self.add_blocks(matrix, |link| stiffness(motion.x, link, weights.tangent) * weights.position);
    }
}

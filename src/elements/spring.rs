use super::{
    Adding, Kicking, Target,
    gather::{Gather, STAGE, pairs, room},
};
use crate::{
    effects::{Effect, Motion},
    lanes::{LANES, Pairs, Quads, Real, Wide},
    nets::{Link, Net},
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
    gather: Gather,
}

impl Springs {
    /// The springs of a net whose particles are the scene's `vertices`.
    pub fn new(net: &Net, vertices: Range<usize>) -> Self {
        let first = vertices.start as u32;
        let links = net.links().iter().map(|link| Link { ends: link.ends.map(|end| end + first), ..*link });
        let links: Vec<_> = links.collect();
        let ends: Vec<_> = links.iter().map(|link| link.ends).collect();
        Self { gather: Gather::new(&ends, &vertices, (&[], false), Arch::new()), links, vertices }
    }

    /// The same for another instruction set than the best: with the same bits, in more time.
    #[must_use]
    pub fn in_set(&self, set: Arch) -> Self {
        let ends: Vec<_> = self.links.iter().map(|link| link.ends).collect();
        let gather = Gather::new(&ends, &self.vertices, (&[], false), set);
        Self { gather, links: self.links.clone(), vertices: self.vertices.clone() }
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

    /// Computes the forces on the particles and hands them out.
    fn sweep(&self, target: &mut impl Target, scratch: &mut [f64]) {
        let pairs = pairs(scratch);
        let (mut stages, set) = (self.gather.stages(), self.gather.set());
        for (stage, links) in self.links.chunks(STAGE * LANES).enumerate() {
            let out = pairs[2 * self.gather.slot(stage)..].as_chunks_mut().0;
            set.dispatch(Pulls { links, x: target.motion()[0].as_chunks().0, out });
            stages.add([&*pairs], target);
        }
    }

    /// Adds dampers beside the springs, `c = beta k` [N s/m]: each slows the change of its spring's length and nothing
    /// else, so that a rigid motion is not damped. At rest it is Rayleigh's `-beta K v`.
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
    matrix.couple(&-block);
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

/// How many springs have their ends collected at a time.
const RUN: usize = 8 * LANES;

/// Computes the forces at both ends of all springs.
struct Pulls<'a> {
    links: &'a [Link],
    x: &'a [[f64; 2]],
    out: &'a mut [[Pairs; 2]],
}

impl WithSimd for Pulls<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) {
        // From the first end to the second, stiffness and rest length.
        let mut now = [Quads::default(); RUN / LANES];
        for (links, out) in self.links.chunks(RUN).zip(self.out.chunks_mut(RUN / LANES)) {
            for (to, link) in now.as_flattened_mut().iter_mut().zip(links) {
                let [a, b] = link.ends.map(|end| self.x[end as usize]);
                *to = [b[0] - a[0], b[1] - a[1], link.stiffness, link.rest];
            }
            for (now, [first, second]) in now.iter().zip(out) {
                for part in 0..Wide::<S>::PARTS {
                    let [dx, dy, stiffness, rest] = Wide::load_quads(set, now, part);
                    let length = (dx * dx + dy * dy).sqrt();
                    let (zero, one) = (length.of(0.0), length.of(1.0));
                    let pull = stiffness * (length - rest) / zero.if_less(length, length, one);
                    let (fx, fy) = (pull * dx, pull * dy);
                    Wide::store_pairs(fx, fy, first, part);
                    Wide::store_pairs(-fx, -fy, second, part);
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
        room(2 * self.gather.blocks())
    }

    fn force(&self, motion: Motion<'_>, scratch: &mut [f64], force: &mut [f64]) {
        self.sweep(&mut Adding { x: motion.x, v: motion.v, force }, scratch);
    }

    fn kick(&self, vertices: &mut Kicking<'_>, scratch: &mut [f64]) {
        self.sweep(vertices, &mut scratch[..self.scratch()]);
    }

    fn stiffness_times(&self, motion: Motion<'_>, d: &[f64], product: &mut [f64]) {
        for link in &self.links {
            let ([xx, xy, yy], [dx, dy]) = (block(motion.x, link, Tangent::Exact), between(d, link));
            add_pair(product, link, [-xx * dx - xy * dy, -xy * dx - yy * dy]);
        }
    }

    fn couples(&self, add: &mut dyn FnMut(u32, u32)) {
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

//! Forces of springs in space by SIMD.

use crate::{
    nets::Link,
    simd::{LANES, Lanes, Real as _, Wide},
};
use pulp::{Arch, Simd, WithSimd};

/// Number of blocks gathered at a time: enough for scalar stores to complete before they are read as SIMD vectors.
const RUN_BLOCKS: usize = 4;

/// Springs in space, eight side by side.
#[derive(Debug)]
pub struct SpaceSprings {
    ends: Vec<[u32; 2]>,
    blocks: Vec<Block>,
    set: Arch,
}

/// Eight springs side by side; unused lanes have no stiffness.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
struct Block {
    /// [N/m].
    stiffness: Lanes,
    /// Length at rest \[m\].
    rest: Lanes,
}

/// Vectors of eight springs, one array for each axis.
type Vectors = [Lanes; 3];

impl SpaceSprings {
    /// Packs springs for an instruction set: every set gives the same bits.
    pub fn new(links: &[Link], set: Arch) -> Self {
        let pack = |links: &[Link]| {
            let mut block = Block::default();
            for (lane, link) in links.iter().enumerate() {
                (block.stiffness[lane], block.rest[lane]) = (link.stiffness, link.rest);
            }
            block
        };
        Self {
            ends: links.iter().map(|link| link.ends).collect(),
            blocks: links.chunks(LANES).map(pack).collect(),
            set,
        }
    }

    /// Adds the forces of all springs, in their order.
    pub fn add_force(&self, x: &[f64], force: &mut [f64]) {
        self.set.dispatch(Pulls { springs: self, x: x.as_chunks().0, force: force.as_chunks_mut().0 });
    }
}

struct Pulls<'a> {
    springs: &'a SpaceSprings,
    x: &'a [[f64; 3]],
    force: &'a mut [[f64; 3]],
}

impl WithSimd for Pulls<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) {
        let Self { springs, x, force } = self;
        let mut now = [Vectors::default(); RUN_BLOCKS];
        let runs = springs.ends.chunks(RUN_BLOCKS * LANES).zip(springs.blocks.chunks(RUN_BLOCKS));
        for (ends, blocks) in runs {
            for (number, [a, b]) in ends.iter().enumerate() {
                let (block, lane) = (&mut now[number / LANES], number % LANES);
                let (a, b) = (x[*a as usize], x[*b as usize]);
                for axis in 0..3 {
                    block[axis][lane] = b[axis] - a[axis];
                }
            }
            for (vectors, block) in now.iter_mut().zip(blocks) {
                for part in 0..Wide::<S>::PARTS {
                    let [dx, dy, dz] = [0, 1, 2].map(|axis: usize| Wide::load(set, &vectors[axis], part));
                    let stiffness = Wide::load(set, &block.stiffness, part);
                    let rest = Wide::load(set, &block.rest, part);
                    let length = (dx * dx + dy * dy + dz * dz).sqrt();
                    let (zero, unit) = (length.of(0.0), length.of(1.0));
                    let pull = stiffness * (length - rest) / zero.if_less(length, length, unit);
                    for (axis, along) in [dx, dy, dz].into_iter().enumerate() {
                        (pull * along).store(&mut vectors[axis], part);
                    }
                }
            }
            for (number, ends) in ends.iter().enumerate() {
                let (block, lane) = (&now[number / LANES], number % LANES);
                let [a, b] = ends.map(|end| end as usize);
                for axis in 0..3 {
                    let pull = block[axis][lane];
                    force[a][axis] += pull;
                    force[b][axis] -= pull;
                }
            }
        }
    }
}

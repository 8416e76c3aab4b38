//! Fans of triangles swept over stage by stage: the forces on each, and what becomes of them at the vertices.

use super::{
    Target,
    blocks::{Block, Collected, CornerForces, Forces, StressModel},
    caches::Bytes,
    corners::{Corners, RUN},
    gather::{Gather, STAGE, pairs, room},
    stages::Stages,
};
use crate::simd::{LANES, NEAR, Pairs};
use std::ops::Range;

/// A stage begins with a run.
const _: () = assert!(STAGE.is_multiple_of(RUN));

/// The fans of a body or of a part of it.
#[derive(Clone)]
pub struct Piece<'a> {
    /// The numbers of its vertices.
    pub vertices: Range<usize>,
    /// Which of them each fan has.
    pub corners: &'a Corners<4>,
    /// Their rest shapes.
    pub blocks: &'a [Block],
    pub gather: &'a Gather,
}

impl Piece<'_> {
    /// How many numbers of scratch a sweep needs for each stress.
    pub fn scratch(&self) -> usize {
        2 * copy(&self.vertices) + self.buffer()
    }

    /// How many of them are for the forces on fans.
    pub fn buffer(&self) -> usize {
        room(4 * self.gather.buffer())
    }

    /// What a step with one stress has to do with: rest shapes, numbers of corners, vertices, what is summed at them, and the forces on
    /// the fans of some stages.
    pub fn bytes(&self) -> Bytes {
        let (blocks, stages) = (self.blocks.len(), self.gather.lag() + 1);
        let fans = size_of_val(self.blocks) + blocks * LANES * size_of::<[u16; 4]>();
        // Place, velocity, mass and its reciprocal.
        let vertices = self.vertices.len() * 4 * size_of::<[f64; 2]>() + self.gather.bytes();
        let forces = self.gather.buffer() * size_of::<CornerForces>();
        let of_stages = (fans + vertices) / blocks.max(1) * (stages * STAGE).min(blocks);
        Bytes { in_all: fans + vertices + forces, at_once: of_stages + forces }
    }

    /// Computes the forces of stresses on all fans, sums them at their vertices and hands them out.
    pub fn sweep<L: StressModel<N>, const N: usize>(&self, laws: L, target: &mut impl Target<N>, scratch: &mut [f64]) {
        let copy = copy(&self.vertices);
        let (copies, scratch) = scratch.split_at_mut(2 * copy);
        let (x, v) = copies.split_at_mut(copy);
        let values = 2 * self.vertices.start..2 * self.vertices.end;
        if !x.is_empty() {
            let [from_x, from_v] = target.motion();
            x[..values.len()].copy_from_slice(&from_x[values.clone()]);
            if L::RATE {
                v[..values.len()].copy_from_slice(&from_v[values]);
            }
        }
        let from = if x.is_empty() { None } else { Some([&*x, &*v]) };
        let mut desk = Desk::new(scratch);
        let mut stages = self.gather.stages();
        for stage in 0..self.gather.count() {
            self.stage(stage, laws, from, (&mut desk, &mut stages), target);
        }
    }

    /// One stage of a sweep; positions and velocities may be read from elsewhere than from where they are to be changed.
    #[inline(always)]
    pub fn stage<const N: usize>(
        &self,
        stage: usize,
        laws: impl StressModel<N>,
        from: Option<[&[f64]; 2]>,
        (desk, stages): (&mut Desk<'_, N>, &mut Stages<'_>),
        target: &mut impl Target<N>,
    ) {
        let (gather, span) = (self.gather, self.gather.span(stage));
        let Desk { forces, collected } = desk;
        let out = forces.each_mut().map(|buffer| buffer[4 * gather.slot(stage)..].as_chunks_mut().0.as_chunks_mut().0);
        let [x, v] = match from {
            Some(from) => from,
            None => target.motion().map(|values| values.get(2 * self.vertices.start..).unwrap_or_default()),
        };
        gather.set().dispatch(Forces {
            laws,
            corners: self.corners,
            first: span.start / RUN,
            blocks: &self.blocks[span],
            x,
            v,
            collected,
            out,
        });
        stages.add(forces.each_ref().map(|buffer| &**buffer), target);
    }
}

/// How many numbers a copy of the positions of vertices takes, with so many after them that from any of them on there are
/// [`Near`](crate::lanes::Near) ones; zero if there are so many positions that this is of little use.
pub fn copy(vertices: &Range<usize>) -> usize {
    if vertices.len() < NEAR { 2 * vertices.len() + NEAR } else { 0 }
}

/// What a sweep has at hand.
pub struct Desk<'a, const N: usize> {
    /// The forces of each stress at the corners.
    forces: [&'a mut [Pairs]; N],
    collected: Collected,
}

impl<'a, const N: usize> Desk<'a, N> {
    /// In scratch for the forces of all stresses.
    pub fn new(mut scratch: &'a mut [f64]) -> Self {
        let each = scratch.len() / N;
        let forces = [(); N].map(|()| pairs(scratch.split_off_mut(..each).unwrap_or_default()));
        Self { forces, collected: Collected::default() }
    }
}

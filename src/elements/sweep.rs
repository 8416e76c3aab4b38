//! Triangles swept over stage by stage: forces at corners, and what becomes of them at the vertices.

use super::{
    Target,
    blocks::{Block, Forces, Laws},
    corners::{Corners, RUN},
    gather::{Gather, STAGE, Stages, pairs, room},
};
use crate::lanes::Pairs;

/// A stage begins with a run.
const _: () = assert!(STAGE.is_multiple_of(RUN));

/// The triangles of a body or of a part of it.
#[derive(Clone, Copy)]
pub struct Piece<'a> {
    pub corners: &'a Corners,
    /// Their rest shapes, and maybe some after them.
    pub blocks: &'a [Block],
    pub gather: &'a Gather,
}

impl Piece<'_> {
    /// How many numbers of scratch a sweep needs for each stress.
    pub fn scratch(&self) -> usize {
        room(3 * self.gather.blocks())
    }

    /// Computes the forces of stresses on the corners of all triangles, sums them at their vertices and hands them out.
    pub fn sweep<const N: usize>(&self, laws: impl Laws<N>, target: &mut impl Target<N>, scratch: &mut [f64]) {
        let mut buffers = buffers(scratch);
        let mut stages = self.gather.stages();
        for stage in 0..self.gather.count() {
            self.stage(stage, laws, (&mut buffers, &mut stages), target);
        }
    }

    /// One stage of a sweep.
    #[inline(always)]
    pub fn stage<const N: usize>(
        &self,
        stage: usize,
        laws: impl Laws<N>,
        (buffers, stages): (&mut [&mut [Pairs]; N], &mut Stages<'_>),
        target: &mut impl Target<N>,
    ) {
        let (gather, span) = (self.gather, self.gather.span(stage));
        let out = buffers.each_mut().map(|buffer| buffer[3 * gather.slot(stage)..].as_chunks_mut().0);
        let [x, v] = target.motion();
        gather.set().dispatch(Forces {
            laws,
            corners: self.corners,
            first: span.start / RUN,
            blocks: &self.blocks[span],
            x,
            v,
            out,
        });
        stages.add(buffers.each_ref().map(|buffer| &**buffer), target);
    }
}

/// Buffers for the forces of each stress at the corners, in scratch for all of them.
pub fn buffers<const N: usize>(mut scratch: &mut [f64]) -> [&mut [Pairs]; N] {
    let each = scratch.len() / N;
    [(); N].map(|()| pairs(scratch.split_off_mut(..each).unwrap_or_default()))
}

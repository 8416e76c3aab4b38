//! Continuation of an energy below a threshold of its variable.

use crate::simd::Real;

/// An energy of one variable x below the threshold x0 from which its formula is used.
///
/// The quadratic extrapolation of Stomakhin, Howes, Schroeder and Teran (*Energetically consistent invertible elasticity*,
/// Symposium on Computer Animation 2012) keeps the second derivative of the threshold. For a logarithm that is some hundred
/// times the one at rest. Here it falls to a given `floor` at x = 0 and keeps it below. With r = x/x0, 0 for x < 0:
///
/// `E'' = floor + (c - floor) r⁶`,
/// `E' = E'(x0) + floor (x - x0) - (c - floor) x0/7 (1 - r⁷)`,
/// `E = E(x0) + E'(x0) (x - x0) + floor/2 (x - x0)² + (c - floor) x0/7 (x0 - x - x0/8 (1 - r⁸))`, c = E''(x0).
///
/// The second derivative has no jump. Where E'(x0) < 0, c >= 0 and floor >= 0, the energy is convex below x0 and E' < 0 there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Continuation {
    /// x0.
    pub threshold: f64,
    /// E, E' and E'' at the threshold.
    pub there: [f64; 3],
    /// E'' for x <= 0.
    pub floor: f64,
}

impl Continuation {
    /// E, E' and E'' of an x that is at most the threshold.
    #[inline(always)]
    pub fn derivatives<R: Real>(&self, x: R) -> [R; 3] {
        let Self { threshold, there: [value, slope, bend], floor } = *self;
        let zero = x.of(0.0);
        let r = zero.if_less(x, x * (1.0 / threshold), zero);
        let (square, excess) = (r * r, bend - floor);
        let (sixth, below, share) = (square * square * square, x - threshold, excess * threshold / 7.0);
        let energy = below * (below * (0.5 * floor) + slope) + value
            - (below + (-(sixth * square) + 1.0) * (threshold / 8.0)) * share;
        let force = below * floor + slope + (sixth * r - 1.0) * share;
        [energy, force, sixth * excess + floor]
    }
}

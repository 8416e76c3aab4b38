//! Continuation of an energy below a threshold of its variable.

use crate::simd::Real;
use std::f64::consts::LN_10;

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

/// Where ln² x is continued.
pub(super) const FLAT: f64 = 0.1;

/// l below [`FLAT`]: ln² x has the derivatives 2 ln(x)/x and 2 (1 - ln x)/x².
pub(super) const SQUARED_LOGARITHM: Continuation = Continuation {
    threshold: FLAT,
    there: [LN_10 * LN_10, -2.0 * LN_10 / FLAT, 2.0 * (1.0 + LN_10) / (FLAT * FLAT)],
    floor: 2.0,
};

/// `l = ln² x`, continued below [`FLAT`], and its first two derivatives.
#[inline(always)]
pub(super) fn squared_logarithm<R: Real>(x: R) -> [R; 3] {
    let (flat, log, inverse) = (x.of(FLAT), x.logarithm(), x.of(1.0) / x);
    let exact = [log * log, log * inverse * 2.0, (-log + 1.0) * inverse * inverse * 2.0];
    let [energy, force, bend] = SQUARED_LOGARITHM.derivatives(x);
    [x.if_less(flat, energy, exact[0]), x.if_less(flat, force, exact[1]), x.if_less(flat, bend, exact[2])]
}

//! Natural logarithm without branches.

use super::Split;

/// ln 2 in two parts. The high part has few digits, so that small multiples of it are exact.
const LN2: [f64; 2] = [f64::from_bits(0x3fe6_2e42_fee0_0000), f64::from_bits(0x3dea_39ef_3579_3c76)];

/// Coefficients of `ln((1 + s)/(1 - s)) = 2 s + s R(s²)`, `R(z) = z (L1 + z (L2 + ...))`.
const L: [f64; 7] = [
    f64::from_bits(0x3fe5_5555_5555_5593),
    f64::from_bits(0x3fd9_9999_9997_fa04),
    f64::from_bits(0x3fd2_4924_9422_9359),
    f64::from_bits(0x3fcc_71c5_1d8e_78af),
    f64::from_bits(0x3fc7_4664_96cb_03de),
    f64::from_bits(0x3fc3_9a09_d078_c69f),
    f64::from_bits(0x3fc2_f112_df3e_5244),
];

/// Bias of the second number of [`split`]: 2^52, and the bias of exponents.
pub const BIAS: f64 = 4_503_599_627_370_496.0 + 1023.0;

/// Splits the bits of a positive normal number m 2^k, m from sqrt(1/2) to sqrt(2), into those of m and of k + [`BIAS`].
#[inline(always)]
pub const fn split(bits: u64) -> [u64; 2] {
    /// The upper half of the bits of sqrt(1/2).
    const LOW: u64 = 0x3fe6_a09e << 32;
    let moved = bits.wrapping_add((0x3ff0_0000 << 32) - LOW);
    // 2^52 with an integer below 2^52 in its last bits is 2^52 plus that integer.
    [(moved & 0x000f_ffff_ffff_ffff) + LOW, (moved >> 52) | 0x4330_0000_0000_0000]
}

/// ln x for every number: NaN below 0, -inf at 0.
#[inline(always)]
pub fn log<R: Split>(x: R) -> R {
    let zero = x.of(0.0);
    // Subnormal numbers are scaled up.
    let least = x.of(f64::MIN_POSITIVE);
    let (m, k) = x.if_less(least, x * 18_014_398_509_481_984.0, x).split();
    let log = of_split(m, x.if_less(least, k - 54.0, k));
    let positive = x.if_less(x.of(f64::INFINITY), log, x);
    let limit = x.if_less(zero, x.of(f64::NAN), x.of(f64::NEG_INFINITY));
    // For NaN both comparisons are false, so NaN stays NaN.
    zero.if_less(x, positive, x.if_less(least, limit, x))
}

/// ln x for positive normal numbers, with the same bits as [`log`]; undefined for others.
#[inline(always)]
pub fn of_normal<R: Split>(x: R) -> R {
    let (m, k) = x.split();
    of_split(m, k)
}

/// ln(m 2^k) as in `e_log.c` of fdlibm (Sun Microsystems, 1993), with the operations in the same order.
///
/// With f = m - 1, `s = f/(2 + f)` gives `ln m = ln((1 + s)/(1 - s)) = f - f²/2 + s (f²/2 + R(s²))`.
#[inline(always)]
fn of_split<R: Split>(m: R, k: R) -> R {
    let f = m - 1.0;
    let half_square = f * 0.5 * f;
    let s = f / (f + 2.0);
    let z = s * s;
    let w = z * z;
    let even = w * (w * (w * L[5] + L[3]) + L[1]);
    let odd = z * (w * (w * (w * L[6] + L[4]) + L[2]) + L[0]);
    let series = odd + even;
    s * (half_square + series) + k * LN2[1] - half_square + f + k * LN2[0]
}

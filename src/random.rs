//! Pseudo-random numbers with a fixed seed, the same on every machine.

/// 64-bit mix in which every input bit affects every bit of the result
/// (Steele, Lea and Flood, *Fast splittable pseudorandom number generators*, 2014).
const fn mix(number: u64) -> u64 {
    let mut z = number.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Number of a fixed pseudo-random sequence in [-1, 1).
pub fn irregular(number: u64) -> f64 {
    (mix(number) >> 32) as f64 / f64::from(1_u32 << 31) - 1.0
}

/// Pseudo-random sequence in [-1, 1) for a seed.
pub fn stream(seed: u32) -> impl Iterator<Item = f64> {
    let first = mix(u64::from(seed));
    (0_u64..).map(move |number| irregular(first.wrapping_add(number)))
}

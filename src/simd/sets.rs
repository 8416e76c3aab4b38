//! Instruction sets, chosen at run time.

use pulp::{Arch, Simd, WithSimd};

/// Instruction sets of this processor, the narrowest first and the best, [`Arch::new`], last. All give the same bits.
pub fn sets() -> Vec<Arch> {
    let mut sets = vec![Arch::Scalar];
    #[cfg(target_arch = "x86_64")]
    {
        sets.extend(pulp::x86::V3::try_new().map(Arch::V3));
        sets.extend(pulp::x86::V4::try_new().map(Arch::V4));
    }
    let best = Arch::new();
    if sets.iter().all(|set| width(*set) != width(best)) {
        sets.push(best);
    }
    sets
}

/// Number of lanes of a vector register.
pub fn width(set: Arch) -> usize {
    struct Count;
    impl WithSimd for Count {
        type Output = usize;
        fn with_simd<S: Simd>(self, _: S) -> usize {
            S::F64_LANES
        }
    }
    set.dispatch(Count)
}

//! The caches of the processor, and how many steps of a body are best under way at once with them.
//!
//! Where a body is larger than a core's own cache, each of several steps follows some stages behind the one before: what the first has
//! brought from further away is still near when the others want it, as long as all that lies between them stays near. So it is many
//! steps with a large cache and few with a small one. The bits are the same with any.

use std::sync::OnceLock;

/// Capacities of caches [bytes].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Caches {
    /// Of the largest that a core has to itself: as a rule the second level.
    pub own: usize,
    /// Of the largest of all, which cores share.
    pub shared: usize,
}

/// Where nothing is told of them: what is usual.
impl Default for Caches {
    fn default() -> Self {
        Self { own: 1 << 20, shared: 32 << 20 }
    }
}

/// How many bytes a step has to do with.
#[derive(Clone, Copy, Debug)]
pub struct Bytes {
    /// From its start to its end.
    pub in_all: usize,
    /// Until the next may follow behind it.
    pub at_once: usize,
}

impl Caches {
    /// How many steps are under way at once at most.
    pub const MOST_STEPS: u32 = 8;

    /// Those of this processor. It is asked once: where it is only pretended to be one, asking takes a while.
    pub fn here() -> Self {
        static HERE: OnceLock<Caches> = OnceLock::new();
        *HERE.get_or_init(|| Self::told().unwrap_or_default())
    }

    #[cfg(target_arch = "x86_64")]
    fn told() -> Option<Self> {
        use raw_cpuid::{CacheType, CpuId};
        let size = |level| {
            let caches = CpuId::new().get_cache_parameters()?;
            let for_data = |kind| matches!(kind, CacheType::Data | CacheType::Unified);
            let mut of_level = caches.filter(|cache| cache.level() == level && for_data(cache.cache_type()));
            of_level
                .next()
                .map(|cache| {
                    cache.sets()
                        * cache.associativity()
                        * cache.physical_line_partitions()
                        * cache.coherency_line_size()
                })
                .filter(|size| *size > 0)
        };
        let own = size(2)?;
        Some(Self { own, shared: size(3).unwrap_or(own) })
    }

    #[cfg(not(target_arch = "x86_64"))]
    const fn told() -> Option<Self> {
        None
    }

    /// How many steps are best under way at once.
    ///
    /// One, while all of a body stays in a core's own cache. If it is larger, as many as half of that cache holds (the other half is for
    /// what comes and goes), and two at least. On sheets of some 25,000 to 100,000 triangles that makes 4 with 1 MB and 8 with 2 MB, which
    /// were measured to be the fastest on processors with so much. If a body does not stay in the shared cache either, memory is what all
    /// wait for, and it is as many as there may be.
    pub fn steps_at_once(self, bytes: Bytes) -> u32 {
        let Self { own, shared } = self;
        let Bytes { in_all, at_once } = bytes;
        if in_all <= own {
            1
        } else if in_all > shared {
            Self::MOST_STEPS
        } else {
            let fitting = (own + at_once) / (2 * at_once).max(1);
            fitting.clamp(2, Self::MOST_STEPS as usize) as u32
        }
    }
}

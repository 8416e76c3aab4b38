//! The caches of the processor, and how many steps of a body are best under way at once with them.
//!
//! Where a body is larger than a core's own cache, each of several steps follows some stages behind the one before: what the first has
//! brought from further away is still near when the others want it, as long as all that lies between them stays near. So it is many
//! steps with a large cache and few with a small one. The bits are the same with any.

use std::sync::OnceLock;

/// Capacities of caches [bytes].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Caches {
    /// Of the second level, which as a rule a core has to itself.
    pub own: usize,
    /// Of the third, which cores share; where there is none, that of the second.
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
    /// Until the next may follow behind it: each step under way wants so many to stay near.
    pub at_once: usize,
}

impl Caches {
    /// How many steps are under way at once at most.
    pub const MOST_STEPS: u32 = 8;

    /// Those of this processor: of the core that asks first. It is asked once, as in a virtual machine every answer takes a while.
    pub fn here() -> Self {
        static HERE: OnceLock<Caches> = OnceLock::new();
        *HERE.get_or_init(|| Self::told().unwrap_or_default())
    }

    /// What the processor tells, if it is credible.
    #[cfg(target_arch = "x86_64")]
    fn told() -> Option<Self> {
        use raw_cpuid::{CacheParameter, CacheType, CpuId};
        let size = |cache: &CacheParameter| {
            let ways = cache.associativity().checked_mul(cache.physical_line_partitions())?;
            cache.sets().checked_mul(ways)?.checked_mul(cache.coherency_line_size())
        };
        let of_data = |cache: &CacheParameter| matches!(cache.cache_type(), CacheType::Data | CacheType::Unified);
        let caches: Vec<_> = CpuId::new().get_cache_parameters()?.filter(of_data).collect();
        let of_level = |level| caches.iter().find(|cache| cache.level() == level).and_then(size);
        let own = of_level(2).filter(|own| (1 << 15..1 << 27).contains(own))?;
        Some(Self { own, shared: of_level(3).unwrap_or(own).max(own) })
    }

    #[cfg(not(target_arch = "x86_64"))]
    const fn told() -> Option<Self> {
        None
    }

    /// How many steps are best under way at once.
    ///
    /// One, while all of a body stays in a core's own cache. If it is larger, about as many as half of that cache holds (the other half is
    /// for what comes and goes), but two at least. On sheets of 50,000 to 100,000 triangles that makes 4 with 1 MB, where 8 were measured to
    /// be slower while others used the processor too, and 8 with 2 MB. If a body does not stay in the shared cache either, memory is what all
    /// wait for, and it is as many as there may be.
    pub fn steps_at_once(self, bytes: Bytes) -> u32 {
        let Self { own, shared } = self;
        let Bytes { in_all, at_once } = bytes;
        if in_all <= own {
            1
        } else if in_all > shared && shared > own {
            Self::MOST_STEPS
        } else {
            let fitting = own.saturating_add(at_once) / at_once.saturating_mul(2).max(1);
            fitting.clamp(2, Self::MOST_STEPS as usize) as u32
        }
    }
}

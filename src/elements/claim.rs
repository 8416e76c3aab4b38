//! Asking for memory that is soon to be written to.

/// Asks for the line of memory that a value begins in, to write to it: another processor that has read it loses it, which takes long, and
/// whoever writes without having asked keeps all that he writes after it waiting. Where this is not known how to do it does nothing.
#[inline]
#[cfg_attr(
    target_arch = "x86_64",
    expect(unsafe_code, reason = "no library has this instruction; it does nothing but ask")
)]
pub fn claim<T>(place: &T) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: PREFETCHW is a hint. It changes neither memory nor registers nor flags, and no address makes it fail. All AMD64 processors have
    // it (AMD64 Architecture Programmer's Manual, volume 3), and Intel's that lack it take its code, 0F 0D, for one that does nothing.
    unsafe {
        std::arch::asm!("prefetchw [{}]", in(reg) place, options(nostack, preserves_flags, readonly));
    };
    let _ = place;
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

    #[test]
    fn what_is_claimed_stays_as_it_is_while_another_writes_to_it() {
        let values: Vec<_> = (0..4096).map(AtomicU64::new).collect();
        std::thread::scope(|scope| {
            scope.spawn(|| values.iter().for_each(|value| _ = value.fetch_add(1, Relaxed)));
            (0..100).for_each(|_| values.iter().for_each(claim));
        });
        assert!((1..).zip(&values).all(|(expected, value)| value.load(Relaxed) == expected));
    }

    #[test]
    fn any_place_can_be_claimed() {
        let bytes = [7u8; 130];
        bytes.iter().for_each(claim);
        claim(&());
        claim::<[u64; 0]>(&[]);
        assert_eq!(bytes, [7; 130]);
    }
}

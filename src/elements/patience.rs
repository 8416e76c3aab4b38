//! How those who step together wait for each other.

use std::{
    hint::spin_loop,
    thread::{sleep, yield_now},
    time::Duration,
};
use web_time::Instant;

/// Looks before the processor is offered to others; and if somebody else lately wanted it.
const LOOKS: [u32; 2] = [200, 20];

/// An offer that took so long was taken.
const TAKEN: Duration = Duration::from_micros(2);

/// Offers that have to be taken before the first nap, and at most before a later one; and after how many waits without one all is as
/// in the beginning.
const OFFERS: [u32; 2] = [4, 4096];
const CALM: u32 = 256;

/// Shorter than anyone can sleep.
const NAP: Duration = Duration::from_nanos(1);

/// What somebody knows of those he shares his processor with.
///
/// Who waits looks for a while, and then offers the processor to others. If they are not the ones he waits for he does not lose
/// much, and if they are he wins: a thread that kept looking would keep them from ever coming. But two who step together may be put on
/// one processor while another is idle, and as both of them are always ready to go on the system may leave them there for many steps.
/// Who lies down for a moment is put where there is nothing to do when he wakes. If that did not help he takes his time before he lies
/// down again.
#[derive(Debug)]
pub struct Patience {
    /// Offers taken since the last nap, less the waits without one.
    taken: u32,
    /// How many there are to be before the next nap.
    nap_at: u32,
    /// Waits since the last offer that was taken.
    calm: u32,
}

impl Default for Patience {
    fn default() -> Self {
        Self { taken: 0, nap_at: OFFERS[0], calm: 0 }
    }
}

impl Patience {
    /// Waits until something is so.
    #[inline]
    pub fn wait(&mut self, mut is_so: impl FnMut() -> bool) {
        if is_so() { self.learn(false) } else { self.wait_long(is_so) }
    }

    #[cold]
    fn wait_long(&mut self, mut is_so: impl FnMut() -> bool) {
        for _ in 0..LOOKS[usize::from(self.taken > 0)] {
            spin_loop();
            if is_so() {
                return self.learn(false);
            }
        }
        let mut taken = false;
        while !is_so() {
            let before = Instant::now();
            yield_now();
            taken |= before.elapsed() > TAKEN;
        }
        self.learn(taken);
        if self.is_tired() {
            sleep(NAP);
        }
    }

    /// Takes note of a wait, with an offer that was taken or without.
    const fn learn(&mut self, taken: bool) {
        if taken {
            (self.taken, self.calm) = (self.taken + 2, 0);
        } else {
            (self.taken, self.calm) = (self.taken.saturating_sub(1), self.calm.saturating_add(1));
            if self.calm >= CALM {
                self.nap_at = OFFERS[0];
            }
        }
    }

    /// Whether it is time for a nap, which is then taken.
    fn is_tired(&mut self) -> bool {
        let tired = self.taken >= 2 * self.nap_at;
        if tired {
            (self.taken, self.nap_at) = (0, OFFERS[1].min(2 * self.nap_at));
        }
        tired
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// After how many offers in a row that are taken there is a nap.
    fn offers_to_nap(patience: &mut Patience) -> u32 {
        let offer = |_: &u32| {
            patience.learn(true);
            patience.is_tired()
        };
        (1..=OFFERS[1]).find(offer).unwrap_or(u32::MAX)
    }

    #[test]
    fn naps_that_do_not_help_become_rare_and_come_soon_again_when_it_has_been_calm() {
        let mut patience = Patience::default();
        let naps: Vec<_> = (0..14).map(|_| offers_to_nap(&mut patience)).collect();
        assert_eq!(naps[..4], [4, 8, 16, 32]);
        assert_eq!(naps[10..], [4096; 4]);
        (0..CALM).for_each(|_| patience.learn(false));
        assert_eq!(offers_to_nap(&mut patience), 4);
    }

    #[test]
    fn an_offer_that_is_taken_now_and_then_is_no_reason_for_a_nap() {
        let mut patience = Patience::default();
        for wait in 0..10_000 {
            patience.learn(wait % 4 == 0);
            assert!(!patience.is_tired());
        }
    }

    #[test]
    fn nobody_goes_on_before_who_he_waits_for_even_with_more_threads_than_processors() {
        use std::sync::atomic::{AtomicU32, Ordering::SeqCst};
        let count = AtomicU32::new(0);
        // More than there are processors, each waiting for the one before.
        let many = std::thread::available_parallelism().map_or(2, usize::from) as u32 + 1;
        std::thread::scope(|scope| {
            for number in 0..many {
                let count = &count;
                scope.spawn(move || {
                    let mut patience = Patience::default();
                    for round in 0..200 {
                        let turn = round * many + number;
                        patience.wait(|| count.load(SeqCst) == turn);
                        assert_eq!(count.fetch_add(1, SeqCst), turn);
                    }
                });
            }
        });
        assert_eq!(count.into_inner(), 200 * many);
    }
}

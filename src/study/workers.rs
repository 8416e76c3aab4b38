//! Runs independent tasks on several threads.

#[cfg(not(target_arch = "wasm32"))]
use std::sync::{Mutex, PoisonError};

/// Number of threads that this machine runs at once; 1 in a browser.
pub fn threads() -> usize {
    #[cfg(target_arch = "wasm32")]
    return 1;
    #[cfg(not(target_arch = "wasm32"))]
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// Shares the partitions of large bodies among several cores, wherever this thread steps them.
/// This thread becomes the first of a pool of `threads` threads. The bits do not depend on their number. Call it once
/// per process; further calls change nothing. Elsewhere, step inside of [`rayon::ThreadPool::install`].
pub fn share_partitions(threads: usize) {
    if threads > 1 {
        // If no threads are available, or in a second call, the existing threads are used.
        let _as_it_is = rayon::ThreadPoolBuilder::new().num_threads(threads).use_current_thread().build_global();
    }
}

/// Runs tasks in order, each on the next free thread. `work` returns false to start no further task.
/// Tasks are independent, so the result does not depend on the number of threads.
#[cfg(not(target_arch = "wasm32"))]
pub fn spread<T: Send>(threads: usize, tasks: Vec<T>, work: impl Fn(T) -> bool + Sync) {
    if threads <= 1 || tasks.len() <= 1 {
        tasks.into_iter().all(work);
        return;
    }
    let helpers = threads.min(tasks.len());
    let queue = Mutex::new(tasks.into_iter());
    let next = || queue.lock().unwrap_or_else(PoisonError::into_inner).next();
    std::thread::scope(|scope| {
        for _ in 0..helpers {
            scope.spawn(|| while next().is_some_and(&work) {});
        }
    });
}

/// Runs tasks in order. `work` returns false to stop.
#[cfg(target_arch = "wasm32")]
pub fn spread<T: Send>(_: usize, tasks: Vec<T>, work: impl Fn(T) -> bool + Sync) {
    tasks.into_iter().all(work);
}

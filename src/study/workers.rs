//! Runs independent tasks on several threads.

#[cfg(not(target_arch = "wasm32"))]
use std::sync::{Mutex, PoisonError};

/// How many threads this machine runs at once; 1 in a browser.
pub fn threads() -> usize {
    #[cfg(target_arch = "wasm32")]
    return 1;
    #[cfg(not(target_arch = "wasm32"))]
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// Lets large bodies be stepped on several cores wherever this thread steps them: it becomes the first of a pool of so many threads, which
/// share the partitions of a body. The same bits come of any number. Call it once in a process; further calls change nothing. Elsewhere,
/// step inside of [`rayon::ThreadPool::install`].
pub fn share_partitions(threads: usize) {
    if threads > 1 {
        // Where there are no threads to be had, and in a second call, all goes on with those that there are.
        let _as_it_is = rayon::ThreadPoolBuilder::new().num_threads(threads).use_current_thread().build_global();
    }
}

/// Hands out tasks in their order, each to the next thread that is free. `work` returns false to hand out no more.
/// Tasks know nothing of each other, so what comes out does not depend on the number of threads.
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

/// Works through tasks in their order. `work` returns false to stop.
#[cfg(target_arch = "wasm32")]
pub fn spread<T: Send>(_: usize, tasks: Vec<T>, work: impl Fn(T) -> bool + Sync) {
    tasks.into_iter().all(work);
}

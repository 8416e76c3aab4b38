//! A thread that walks for a part of a large body.

use crate::elements::{Triangles, Walker, Way};
use std::{
    io,
    panic::resume_unwind,
    sync::{
        Arc,
        mpsc::{Receiver, RecvError, Sender, TryRecvError, channel},
    },
    thread::{self, JoinHandle},
};

/// Looks for what is to come before the processor is offered to others, and before the thread lies down: it takes longer to wake it
/// than to take a step, and often the next stretch begins soon after the last.
const LOOKS: [u32; 2] = [200, 1200];

/// A thread that walks when it is asked to, as long as this lives.
pub(super) struct Companion {
    /// Nothing once it is to go.
    errands: Option<Sender<Errand>>,
    back: Receiver<Walker>,
    thread: Option<JoinHandle<()>>,
}

/// What is to be walked, and by whom.
type Errand = (Walker, Arc<Triangles>, Way);

impl Companion {
    /// # Errors
    ///
    /// There are no more threads to be had.
    pub fn new() -> io::Result<Self> {
        let (errands, asked) = channel::<Errand>();
        let (done, back) = channel();
        let thread = thread::Builder::new().name("companion".to_owned()).spawn(move || {
            while let Ok((mut walker, body, way)) = next(&asked) {
                body.walk(&mut walker, body.parts(), &way, &mut || true);
                if done.send(walker).is_err() {
                    return;
                }
            }
        })?;
        Ok(Self { errands: Some(errands), back, thread: Some(thread) })
    }

    /// Sends a walker on its way.
    pub fn send(&self, walker: &mut Walker, body: &Arc<Triangles>, way: &Way) {
        if let Some(errands) = &self.errands {
            // One that is gone is missed when it should come back.
            let _gone = errands.send((std::mem::take(walker), Arc::clone(body), way.clone()));
        }
    }

    /// Waits for the walker to come back. What made the thread panic goes on here.
    pub fn receive(&mut self) -> Walker {
        next(&self.back).unwrap_or_else(|_| match self.thread.take().map(JoinHandle::join) {
            Some(Err(panic)) => resume_unwind(panic),
            _ => Walker::default(),
        })
    }
}

impl Drop for Companion {
    fn drop(&mut self) {
        self.errands = None;
        let _panic = self.thread.take().map(JoinHandle::join);
    }
}

/// What comes next, if anything will.
fn next<T>(from: &Receiver<T>) -> Result<T, RecvError> {
    for look in 0..LOOKS[1] {
        match from.try_recv() {
            Ok(came) => return Ok(came),
            Err(TryRecvError::Disconnected) => return Err(RecvError),
            Err(TryRecvError::Empty) if look < LOOKS[0] => std::hint::spin_loop(),
            Err(TryRecvError::Empty) => thread::yield_now(),
        }
    }
    from.recv()
}

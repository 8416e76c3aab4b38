//! What those who step the parts of a body tell each other.

use super::{claim::claim, patience::Patience};
use prefetch_index::prefetch_index;
use std::{
    slice,
    sync::atomic::{AtomicU32, AtomicU64, Ordering},
};
use wide::f64x2;

/// Where they meet, for a stretch of steps. Steps are counted from one.
pub struct Board {
    posts: Vec<Post>,
    /// After which step all stop.
    last: AtomicU32,
}

/// What one of them has posted.
struct Post {
    /// Sums at the seams: one page for each other step. Others may still be reading the last, but no earlier one.
    pages: [Page; 2],
    /// After how many steps it has posted its energy of motion.
    ended: Count,
    /// Twice the energy of motion of the vertices of its own after each step [J].
    kinetic: Vec<AtomicU64>,
}

/// Sums at the seams.
struct Page {
    /// After how many steps they were posted. Who is a little ahead does not touch what others are about to read.
    met: Count,
    forces: Vec<Line>,
}

/// Forces that fill a line of memory [N].
#[derive(Default)]
#[repr(align(64))]
struct Line([[AtomicU64; 2]; IN_LINE]);

/// How many they are.
const IN_LINE: usize = 4;

/// A number of steps in lines of memory of its own; the greatest number once who counts has left.
#[repr(align(128))]
struct Count(AtomicU32);

impl Count {
    const fn new() -> Self {
        Self(AtomicU32::new(0))
    }

    /// Waits until so many steps are counted.
    #[inline]
    fn wait(&self, steps: u32, patience: &mut Patience) {
        patience.wait(|| self.0.load(Ordering::Acquire) >= steps);
    }
}

fn read(number: &AtomicU64) -> f64 {
    f64::from_bits(number.load(Ordering::Relaxed))
}

impl Board {
    /// For so many parts, with up to so many forces at the seams, and so many steps.
    pub fn new(parts: usize, seam: usize, steps: u32) -> Self {
        let forces = || (0..seam.div_ceil(IN_LINE)).map(|_| Line::default()).collect();
        let page = || Page { met: Count::new(), forces: forces() };
        let kinetic = || (0..steps).map(|_| AtomicU64::new(0)).collect();
        let post = |_| Post { pages: [page(), page()], ended: Count::new(), kinetic: kinetic() };
        Self { posts: (0..parts).map(post).collect(), last: AtomicU32::new(steps) }
    }

    /// Whether there is nobody else.
    pub const fn is_alone(&self) -> bool {
        self.posts.len() == 1
    }

    /// Who keeps this leaves the board with it.
    pub fn presence(&self, part: usize) -> Presence<'_> {
        Presence(&self.posts[part])
    }

    /// After which step all stop, as far as it is known: whoever has seen what was posted in a step knows what was decided before it.
    pub fn last(&self) -> u32 {
        self.last.load(Ordering::Relaxed)
    }

    /// Decides that all stop after a step at the latest: one that nobody can pass before this is known to them. Only one may decide.
    pub fn stop_after(&self, step: u32) {
        self.last.store(step.min(self.last()), Ordering::Relaxed);
    }

    /// Posts the forces of a part at the seams [N] in a step.
    pub fn post_seam(&self, part: usize, step: u32, forces: &[f64x2]) {
        let page = self.posts[part].page(step);
        for ([x, y], force) in page.forces.iter().flat_map(|line| &line.0).zip(forces) {
            let [fx, fy] = force.to_array().map(f64::to_bits);
            x.store(fx, Ordering::Relaxed);
            y.store(fy, Ordering::Relaxed);
        }
        page.met.0.store(step, Ordering::Release);
    }

    /// Asks for what the others have posted at the seams in a step, that it may be near when it is read. Who is ahead of them does
    /// not: he would take away from them what they are writing.
    pub fn fetch_seam(&self, part: usize, step: u32) {
        for page in self.pages_of_others(part, step).filter(|page| page.met.0.load(Ordering::Relaxed) >= step) {
            (0..page.forces.len()).for_each(|line| prefetch_index(page.forces.as_slice(), line));
        }
    }

    /// Asks whether they have, some time before that.
    pub fn fetch_counts(&self, part: usize, step: u32) {
        self.pages_of_others(part, step).for_each(|page| prefetch_index(slice::from_ref(&page.met), 0));
    }

    /// Asks for what a part is to write at the seams in a step, which others have read two steps ago.
    pub fn claim_seam(&self, part: usize, step: u32) {
        let page = self.posts[part].page(step);
        claim(&page.met);
        page.forces.iter().for_each(claim);
    }

    /// Adds to the forces of a part at the seams [N] in a step those of all others, in the order of the parts: it waits for them.
    pub fn sum_seam(&self, part: usize, step: u32, forces: &mut [f64x2], patience: &mut Patience) {
        let (before, after) = self.others(part);
        before.iter().chain(after).for_each(|post| post.page(step).met.wait(step, patience));
        for (at, own) in forces.iter_mut().enumerate() {
            let with = |sum: f64x2, post: &Post| {
                let [x, y] = &post.page(step).forces[at / IN_LINE].0[at % IN_LINE];
                sum + f64x2::new([read(x), read(y)])
            };
            *own = after.iter().fold(before.iter().fold(f64x2::ZERO, with) + *own, with);
        }
    }

    /// Posts twice the energy of motion of a part's own vertices after a step [J].
    pub fn post_kinetic(&self, part: usize, step: u32, kinetic: f64) {
        let post = &self.posts[part];
        post.kinetic[step as usize - 1].store(kinetic.to_bits(), Ordering::Relaxed);
        post.ended.0.store(step, Ordering::Release);
    }

    /// Waits for all parts' energies of motion after a step, and sums them: twice that of all vertices but those on the seams [J].
    pub fn kinetic(&self, step: u32, patience: &mut Patience) -> f64 {
        let of = |post: &Post| {
            post.ended.wait(step, patience);
            read(&post.kinetic[step as usize - 1])
        };
        self.posts.iter().map(of).sum()
    }

    fn pages_of_others(&self, part: usize, step: u32) -> impl Iterator<Item = &Page> {
        let (before, after) = self.others(part);
        before.iter().chain(after).map(move |post| post.page(step))
    }

    /// What those before a part and those after it have posted.
    fn others(&self, part: usize) -> (&[Post], &[Post]) {
        (&self.posts[..part], &self.posts[part + 1..])
    }
}

impl Post {
    /// What is posted at the seams in a step.
    const fn page(&self, step: u32) -> &Page {
        &self.pages[step as usize % 2]
    }
}

/// Leaves the board in the end, so that nobody waits for who will not come any more.
pub struct Presence<'a>(&'a Post);

impl Drop for Presence<'_> {
    fn drop(&mut self) {
        let [even, odd] = &self.0.pages;
        for count in [&even.met, &odd.met, &self.0.ended] {
            count.0.store(u32::MAX, Ordering::Release);
        }
    }
}

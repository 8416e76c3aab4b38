//! What those who step the parts of a body tell each other.

use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use wide::f64x2;

/// Where they meet, for a stretch of steps. Steps are counted from one.
pub struct Board {
    posts: Vec<Post>,
    /// After which step all stop.
    last: AtomicU32,
}

/// What one of them has posted.
struct Post {
    /// After how many steps it has posted its sums at the seams.
    met: Count,
    /// After how many steps it has posted its energy of motion.
    ended: Count,
    /// One of two pages for each other step: others may still be reading the last, but no earlier one.
    pages: [Vec<[AtomicU64; 2]>; 2],
    /// Twice the energy of motion of the vertices of its own after each step [J].
    kinetic: Vec<AtomicU64>,
}

/// A number of steps in lines of memory of its own; the greatest number once who counts has left.
#[repr(align(128))]
struct Count(AtomicU32);

/// Looks at a post before the processor is offered to others.
const PATIENCE: u32 = 200;

impl Count {
    /// Waits until so many steps are counted.
    fn wait(&self, steps: u32) {
        let mut looks = 0;
        while self.0.load(Ordering::Acquire) < steps {
            looks += 1;
            if looks < PATIENCE { std::hint::spin_loop() } else { std::thread::yield_now() }
        }
    }
}

fn read(number: &AtomicU64) -> f64 {
    f64::from_bits(number.load(Ordering::Relaxed))
}

impl Board {
    /// For so many parts, with up to so many forces at the seams, and so many steps.
    pub fn new(parts: usize, seam: usize, steps: u32) -> Self {
        let zeros = |count: usize| (0..count).map(|_| AtomicU64::new(0));
        let page = || zeros(seam).zip(zeros(seam)).map(|(x, y)| [x, y]).collect();
        let count = || Count(AtomicU32::new(0));
        let kinetic = || zeros(steps as usize).collect();
        let post = |_| Post { met: count(), ended: count(), pages: [page(), page()], kinetic: kinetic() };
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
        let post = &self.posts[part];
        for ([x, y], force) in post.pages[step as usize % 2].iter().zip(forces) {
            let [fx, fy] = force.to_array().map(f64::to_bits);
            x.store(fx, Ordering::Relaxed);
            y.store(fy, Ordering::Relaxed);
        }
        post.met.0.store(step, Ordering::Release);
    }

    /// Adds to the forces of a part at the seams [N] in a step those of all others, in the order of the parts: it waits for them.
    pub fn sum_seam(&self, part: usize, step: u32, forces: &mut [f64x2]) {
        let (before, after) = (&self.posts[..part], &self.posts[part + 1..]);
        before.iter().chain(after).for_each(|post| post.met.wait(step));
        for (at, own) in forces.iter_mut().enumerate() {
            let with = |sum: f64x2, post: &Post| {
                let [x, y] = &post.pages[step as usize % 2][at];
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
    pub fn kinetic(&self, step: u32) -> f64 {
        let of = |post: &Post| {
            post.ended.wait(step);
            read(&post.kinetic[step as usize - 1])
        };
        self.posts.iter().map(of).sum()
    }
}

/// Leaves the board in the end, so that nobody waits for who will not come any more.
pub struct Presence<'a>(&'a Post);

impl Drop for Presence<'_> {
    fn drop(&mut self) {
        for count in [&self.0.met, &self.0.ended] {
            count.0.store(u32::MAX, Ordering::Release);
        }
    }
}

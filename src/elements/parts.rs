//! A large body in parts that several threads step together.
//!
//! Each part has its own copy of its vertices, and of those on the seams between parts, which all of them keep. In every step each
//! sums the forces of its own triangles, moves the vertices that are its alone, posts its sums at the seams and waits for those of
//! the others; then all move the seams in the same way. Sums at the seams are sums over the parts whoever steps
//! ([`super::gather`]), so that any number of threads comes to the same bits. Nobody is told what to do while steps go on: all
//! know the same, and stop after the same step.

use super::{
    Everywhere, Law, Target,
    blocks::Block,
    gather::{Gather, room},
    target::Kick,
    triangle::sweep,
};
use crate::lanes::LANES;
use pulp::Arch;
use std::{
    ops::Range,
    sync::atomic::{AtomicU32, AtomicU64, Ordering},
};
use wide::f64x2;

/// Bodies of so many triangles are cut in two: a part has to be worth a thread.
const LARGE: usize = 8192;

/// A mesh in whose seams more than this share of its vertices would lie is left whole.
const SEAM: f64 = 0.1;

/// The triangles at which the second and further parts begin, for a mesh that is worth being cut.
pub fn cuts(corners: &[[u32; 3]]) -> Vec<usize> {
    if corners.len() < LARGE {
        return Vec::new();
    }
    let cuts = vec![corners.len() / 2 / LANES * LANES];
    let vertices = corners.as_flattened().iter().max().map_or(0, |most| *most as usize + 1);
    let first = corners.as_flattened().iter().min().map_or(0, |least| *least as usize);
    let seam = seam(corners, &cuts, &(first..vertices)).len();
    if seam as f64 > SEAM * (vertices - first) as f64 { Vec::new() } else { cuts }
}

/// The vertices that lie in several parts, ascending.
fn seam(corners: &[[u32; 3]], cuts: &[usize], vertices: &Range<usize>) -> Vec<u32> {
    let mut part_of = vec![None; vertices.len()];
    let mut found = Vec::new();
    for (triangle, corners) in corners.iter().enumerate() {
        let part = cuts.partition_point(|cut| *cut <= triangle);
        for &corner in corners {
            if *part_of[corner as usize - vertices.start].get_or_insert(part) != part {
                found.push(corner);
            }
        }
    }
    found.sort_unstable();
    found.dedup();
    found
}

/// A body in parts.
#[derive(Debug)]
pub struct Parts {
    parts: Vec<Part>,
    /// Scene numbers of the vertices on the seams.
    seam: Vec<u32>,
}

/// A part of a body.
#[derive(Debug)]
struct Part {
    /// Scene numbers of the vertices that are its alone; in its own numbers those on the seams come after them.
    own: Vec<u32>,
    /// Corners of its triangles, in its own numbers.
    corners: Vec<[u32; 3]>,
    /// The first block of triangles.
    block: usize,
    gather: Gather,
}

impl Part {
    /// The numbers of the vertices that are its alone, if they follow each other.
    fn in_a_row(&self) -> Option<Range<usize>> {
        let (first, last) = (*self.own.first()? as usize, *self.own.last()? as usize);
        (last - first < self.own.len()).then_some(first..last + 1)
    }
}

impl Parts {
    /// The parts of a mesh, for an instruction set.
    pub fn new(corners: &[[u32; 3]], vertices: &Range<usize>, set: Arch) -> Self {
        let cuts = cuts(corners);
        let seam = seam(corners, &cuts, vertices);
        let ends = cuts.iter().copied().chain([corners.len()]);
        let begins = [0].into_iter().chain(cuts.iter().copied());
        let part = |(begin, end): (usize, usize)| {
            let corners = &corners[begin..end];
            let mut own: Vec<_> =
                corners.as_flattened().iter().copied().filter(|vertex| seam.binary_search(vertex).is_err()).collect();
            own.sort_unstable();
            own.dedup();
            let number = |vertex: u32| match own.binary_search(&vertex) {
                Ok(number) => number,
                Err(_) => own.len() + seam.partition_point(|other| *other < vertex),
            };
            let corners: Vec<_> = corners.iter().map(|corners| corners.map(|vertex| number(vertex) as u32)).collect();
            let gather = Gather::new(&corners, &(0..own.len() + seam.len()), &[], set);
            Part { own, corners, block: begin / LANES, gather }
        };
        Self { parts: begins.zip(ends).map(part).collect(), seam }
    }

    /// How many parts there are; one is the whole body.
    pub const fn count(&self) -> usize {
        self.parts.len()
    }

    /// A board for all who walk.
    pub fn board(&self) -> Board {
        Board(self.parts.iter().map(|_| Post::new(self.seam.len())).collect())
    }
}

/// What the walkers tell each other.
pub struct Board(Vec<Post>);

/// What one of them has posted: lines of memory of its own, and one of two pages for each other step, as others may still be
/// reading the last.
#[repr(align(128))]
struct Post {
    /// After how many steps; the greatest number once it has left.
    steps: AtomicU32,
    pages: [Page; 2],
}

/// The bits of what is posted after a step.
struct Page {
    /// The sum of forces at each vertex of the seams [N].
    forces: Vec<[AtomicU64; 2]>,
    /// Twice the energy of motion of the vertices of its own [J].
    kinetic: AtomicU64,
}

/// Looks at a post before the processor is offered to others.
const PATIENCE: u32 = 200;

impl Post {
    fn new(seam: usize) -> Self {
        let zero = || AtomicU64::new(0);
        let page = || Page { forces: (0..seam).map(|_| [zero(), zero()]).collect(), kinetic: zero() };
        Self { steps: AtomicU32::new(0), pages: [page(), page()] }
    }

    /// Waits until so many steps are posted, and returns the page of the last.
    fn page(&self, steps: u32) -> &Page {
        let mut looks = 0;
        while self.steps.load(Ordering::Acquire) < steps {
            looks += 1;
            if looks < PATIENCE { std::hint::spin_loop() } else { std::thread::yield_now() }
        }
        &self.pages[steps as usize % 2]
    }
}

/// Leaves the board in the end, so that nobody waits for who will not come any more.
struct Presence<'a>(&'a Post);

impl Drop for Presence<'_> {
    fn drop(&mut self) {
        self.0.steps.store(u32::MAX, Ordering::Release);
    }
}

/// What all walkers of a body have in common.
pub struct Way<'a> {
    /// Where they meet.
    pub board: &'a Board,
    /// How many steps they take at most.
    pub steps: u32,
    /// Length of a step [s].
    pub step: f64,
    /// An acceleration that every vertex is given [m/s²].
    pub field: [f64; 2],
    /// They stop after a step with a greater energy of motion than this [J].
    pub most_kinetic: f64,
    /// How far a vertex may go before they stop [m], and the least mass of what can move [kg].
    pub room: f64,
    /// Takes off from the room what the fastest vertex may have gone in a step with this energy of motion.
    pub shrink: &'a (dyn Fn(f64, f64) -> f64 + Sync),
}

/// Who walks for a part, with its own copy of what it moves.
#[derive(Debug, Default)]
pub struct Walker {
    part: usize,
    x: Vec<[f64; 2]>,
    v: Vec<[f64; 2]>,
    mass: Vec<[f64; 2]>,
    inverse_mass: Vec<[f64; 2]>,
    /// Sums of forces at the seams [N].
    seam: Vec<f64x2>,
    scratch: Vec<f64>,
    /// How many steps were taken.
    pub steps: u32,
    /// Energy of motion of all after the last of them [J].
    pub kinetic: f64,
    /// The room left after it [m].
    pub room: f64,
}

impl Walker {
    /// For one part.
    pub fn new(part: usize) -> Self {
        Self { part, ..Self::default() }
    }

    /// Takes positions, velocities, masses and their reciprocals from the whole scene; all flat.
    pub fn set_out(&mut self, parts: &Parts, whole: [&[f64]; 4]) {
        let part = &parts.parts[self.part];
        let own = [&mut self.x, &mut self.v, &mut self.mass, &mut self.inverse_mass];
        for (own, whole) in own.into_iter().zip(whole) {
            let whole: &[[f64; 2]] = whole.as_chunks().0;
            own.clear();
            match part.in_a_row() {
                Some(run) => own.extend_from_slice(&whole[run]),
                None => own.extend(part.own.iter().map(|vertex| whole[*vertex as usize])),
            }
            own.extend(parts.seam.iter().map(|vertex| whole[*vertex as usize]));
        }
        self.seam.clear();
        self.seam.resize(parts.seam.len(), f64x2::ZERO);
        self.scratch.resize(room(3 * part.gather.blocks(part.corners.len().div_ceil(LANES))), 0.0);
    }

    /// Writes positions and velocities to the whole scene; the first part also those on the seams.
    pub fn arrive(&self, parts: &Parts, x: &mut [f64], v: &mut [f64]) {
        let part = &parts.parts[self.part];
        let seam = if self.part == 0 { parts.seam.as_slice() } else { &[] };
        for (whole, own) in [(x, &self.x), (v, &self.v)] {
            let whole: &mut [[f64; 2]] = whole.as_chunks_mut().0;
            let (own, of_seam) = own.split_at(part.own.len());
            match part.in_a_row() {
                Some(run) => whole[run].copy_from_slice(own),
                None => part.own.iter().zip(own).for_each(|(vertex, own)| whole[*vertex as usize] = *own),
            }
            seam.iter().zip(of_seam).for_each(|(vertex, own)| whole[*vertex as usize] = *own);
        }
    }

    /// Takes steps of symplectic Euler together with the walkers of the other parts.
    pub fn walk(&mut self, law: impl Law, parts: &Parts, blocks: &[Block], way: &Way<'_>) {
        let part = &parts.parts[self.part];
        let own = part.own.len();
        let kick = Kick::new(Everywhere { field: way.field, ..Everywhere::default() }, way.step);
        let post = &way.board.0[self.part];
        let _presence = Presence(post);
        (self.steps, self.room) = (0, way.room);
        while self.steps < way.steps {
            self.steps += 1;
            let Self { x, v, mass, inverse_mass, seam, scratch, .. } = self;
            let mut target = Shared { x, v, masses: [&*mass, &*inverse_mass], seam, own, kick, squares: f64x2::ZERO };
            sweep(law, (&part.corners, &blocks[part.block..]), &part.gather, &mut target, scratch);
            let squares = target.squares.to_array();
            let page = &post.pages[self.steps as usize % 2];
            page.kinetic.store((squares[0] + squares[1]).to_bits(), Ordering::Relaxed);
            for ([x, y], force) in page.forces.iter().zip(&*seam) {
                let [fx, fy] = force.to_array().map(f64::to_bits);
                x.store(fx, Ordering::Relaxed);
                y.store(fy, Ordering::Relaxed);
            }
            post.steps.store(self.steps, Ordering::Release);
            let twice_kinetic = self.move_seam(kick, own, way.board);
            self.kinetic = 0.5 * twice_kinetic;
            self.room = (way.shrink)(self.room, self.kinetic);
            // Nothing that is not a number is below a limit.
            if !(self.kinetic <= way.most_kinetic && self.room >= 0.0) {
                return;
            }
        }
    }

    /// Moves the vertices on the seams, as everyone does. Returns twice the energy of motion of all [J].
    fn move_seam(&mut self, kick: Kick, own: usize, board: &Board) -> f64 {
        self.seam.fill(f64x2::ZERO);
        let mut twice_kinetic = 0.0;
        for post in &board.0 {
            let page = post.page(self.steps);
            let read = |number: &AtomicU64| f64::from_bits(number.load(Ordering::Relaxed));
            for ([x, y], sum) in page.forces.iter().zip(&mut self.seam) {
                *sum += f64x2::new([read(x), read(y)]);
            }
            twice_kinetic += read(&page.kinetic);
        }
        let moving = self.x[own..].iter_mut().zip(&mut self.v[own..]);
        let masses = self.mass[own..].iter().zip(&self.inverse_mass[own..]);
        let mut squares = f64x2::ZERO;
        for (((x, v), (mass, inverse_mass)), force) in moving.zip(masses).zip(&mut self.seam) {
            squares += kick.of([x, v], [*mass, *inverse_mass], [*force]);
            // What is not in a part gets no force from it.
            *force = f64x2::ZERO;
        }
        let [along_x, along_y] = squares.to_array();
        twice_kinetic + along_x + along_y
    }
}

/// Moves the vertices of one part, and keeps the forces on those of the seams.
struct Shared<'a> {
    x: &'a mut [[f64; 2]],
    v: &'a mut [[f64; 2]],
    masses: [&'a [[f64; 2]]; 2],
    seam: &'a mut [f64x2],
    /// How many vertices come before those of the seams.
    own: usize,
    kick: Kick,
    squares: f64x2,
}

impl Shared<'_> {
    #[inline(always)]
    fn one(&mut self, vertex: usize, force: f64x2) {
        let [mass, inverse_mass] = self.masses;
        let masses = [mass[vertex], inverse_mass[vertex]];
        self.squares += self.kick.of([&mut self.x[vertex], &mut self.v[vertex]], masses, [force]);
    }
}

impl Target for Shared<'_> {
    #[inline(always)]
    fn motion(&self) -> [&[f64]; 2] {
        [self.x.as_flattened(), &[]]
    }

    #[inline(always)]
    fn take(&mut self, forces: impl Iterator<Item = (usize, [f64x2; 1])>) {
        for (vertex, [force]) in forces {
            match vertex.checked_sub(self.own) {
                Some(at) => self.seam[at] = force,
                None => self.one(vertex, force),
            }
        }
    }

    #[inline(always)]
    fn take_run(&mut self, first: usize, mut forces: impl ExactSizeIterator<Item = [f64x2; 1]>) {
        let end = first + forces.len();
        let run = first.min(self.own)..end.min(self.own);
        let [mass, inverse_mass] = self.masses;
        let moving = self.x[run.clone()].iter_mut().zip(&mut self.v[run.clone()]);
        let masses = mass[run.clone()].iter().zip(&inverse_mass[run.clone()]);
        let (kick, mut squares) = (self.kick, self.squares);
        for (((x, v), (mass, inverse_mass)), force) in moving.zip(masses).zip(&mut forces) {
            squares += kick.of([x, v], [*mass, *inverse_mass], force);
        }
        self.squares = squares;
        self.take((first + run.len()..end).zip(forces));
    }
}

//! Many steps of a body without a look at the whole on the way.
//!
//! Two things make that faster than one step after another. Where a body is larger than a core's own cache, several steps are under way
//! at once, each some stages behind the one before ([`Caches`]). And where parts of a body are walked by several threads, each sweeps
//! from the seam inwards: it posts its sums at the seam early in a step, and by the end of it those of the others have long arrived. All
//! know the same, and stop after the same step; who is asked whether to go on tells the others early enough.

use super::{
    Target, UniformForce,
    blocks::StressModel,
    board::Board,
    caches::Caches,
    gather::make_room,
    kick::{Kick, Masses, Moving},
    patience::Patience,
    stages::Stages,
    sweep::{Desk, Piece},
};
use pulp::{Simd, WithSimd};
use std::{array::from_fn, sync::Arc};
use wide::f64x2;

/// How many steps are under way at once at most.
const WAVE: usize = Caches::MOST_STEPS as usize;

/// How many of the last steps may not have been looked at yet, as each look is at so many at most: so far a walker may be ahead of what
/// it has seen of the others.
const RECENT: usize = 2 * WAVE;

/// Whether to go on.
pub type More<'a> = &'a mut dyn FnMut() -> bool;

/// What all walkers of a body have in common.
#[derive(Clone)]
pub struct Way {
    /// Where they meet.
    pub board: Arc<Board>,
    /// How many steps they take at most.
    pub steps: u32,
    /// How many of them are under way at once: [`Caches::steps_at_once`].
    pub wave: u32,
    /// Length of a step [s].
    pub step: f64,
    /// What acts beside the elements.
    pub uniform_force: UniformForce,
    /// They stop after a step with a greater energy of motion than this [J].
    pub most_kinetic: f64,
    /// When somebody looks whether it is calm.
    pub looks: Looks,
    /// What is known at the start; they stop when the room is used up.
    pub start: Outcome,
    /// The least mass of a vertex [kg].
    pub lightest: f64,
    /// What is left of the room [m] after a step with an energy of motion [J], with that mass and length of a step.
    pub shrink: fn(f64, f64, f64, f64) -> f64,
}

/// After which steps somebody looks whether a body is calm: they stop there, unless it moves so much that it is not.
#[derive(Clone, Copy, Debug)]
pub struct Looks {
    /// The first of them, and how many lie between two.
    pub first: u32,
    pub every: u32,
    /// With more energy of motion than this it is not calm [J].
    pub calm: f64,
}

impl Looks {
    /// How many steps there are from one to the next look, or to one just after it.
    const fn until(&self, step: u32) -> u32 {
        match self.first.checked_sub(step) {
            Some(left) => left,
            None => (self.every - (step - self.first) % self.every) % self.every,
        }
    }
}

/// What came of a walk, and what is known on the way.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// How many steps were taken.
    pub steps: u32,
    /// Energy of motion of all after the last of them [J].
    pub kinetic: f64,
    /// By how much it grew in that step [J].
    pub growth: f64,
    /// How far a vertex may still go [m].
    pub room: f64,
    /// How far the fastest may have gone in that step [m].
    pub travel: f64,
    /// Whether it went beyond the step at which it should have stopped.
    pub late: bool,
}

impl Default for Outcome {
    /// Nothing is known.
    fn default() -> Self {
        Self { steps: 0, kinetic: f64::NAN, growth: f64::NAN, room: -1.0, travel: f64::NAN, late: false }
    }
}

impl Outcome {
    /// Whether they may have to stop within the steps of a few waves, if it goes on as in the last step; or that is not known.
    fn is_close(&self, way: &Way) -> bool {
        const AHEAD: f64 = 4.0 * WAVE as f64;
        let soon = self.kinetic + AHEAD * self.growth;
        let far = [self.kinetic, soon].iter().all(|kinetic| *kinetic <= way.most_kinetic);
        let lively = [self.kinetic, soon].iter().all(|kinetic| *kinetic > 2.0 * way.looks.calm);
        let unseen = lively || f64::from(way.looks.until(self.steps + 1)) > AHEAD;
        !(far && unseen && AHEAD * self.travel <= self.room)
    }
}

/// Walks with the stresses of some laws, as long as there is more to do; of several who walk one at most may be told that there is not.
pub fn walk<L: StressModel<N>, const N: usize>(
    laws: L,
    ground: Ground<'_>,
    (way, more): (&Way, More<'_>),
    (scratch, patience): (&mut Vec<f64>, &mut Patience),
) -> Outcome {
    let _presence = way.board.presence(ground.number);
    let start = Walk {
        seam: vec![[f64x2::ZERO; N]; ground.masses[0].len() - ground.own],
        kick: Kick::new(way.uniform_force, way.step),
        turn: 0,
        squares: [f64x2::ZERO; WAVE],
        of_seam: [0.0; RECENT],
        known: way.start,
        patience,
        ground,
        way,
    };
    start.go(laws, more, scratch)
}

/// What is walked over: a body, or a part of it with the vertices on its seams after its own.
pub struct Ground<'a> {
    pub piece: Piece<'a>,
    /// Of the part.
    pub number: usize,
    /// Positions [m], and what follows in memory.
    pub x: &'a mut [[f64; 2]],
    /// Velocities [m/s], and what follows in memory.
    pub v: &'a mut [[f64; 2]],
    /// Masses [kg] and their reciprocals.
    pub masses: [&'a [[f64; 2]]; 2],
    /// How many vertices come before those of the seams.
    pub own: usize,
    /// The stage after which it has all its forces at the seams.
    pub met: usize,
}

/// A part, or a whole body, under way.
struct Walk<'a, 'b, const N: usize> {
    ground: Ground<'a>,
    way: &'b Way,
    kick: Kick,
    /// Forces at the seams, of each stress [N].
    seam: Vec<[f64x2; N]>,
    /// Which of the steps under way it is that vertices are moved for.
    turn: usize,
    /// Twice the energy of motion of its own vertices in each of them.
    squares: [f64x2; WAVE],
    /// The same at the seams after the last steps.
    of_seam: [f64; RECENT],
    /// What is known of all so far.
    known: Outcome,
    /// With the others.
    patience: &'b mut Patience,
}

impl<const N: usize> Walk<'_, '_, N> {
    fn go(mut self, laws: impl StressModel<N>, more: More<'_>, scratch: &mut Vec<f64>) -> Outcome {
        let each = N * self.ground.piece.buffer();
        make_room(scratch, self.way.wave as usize * each);
        let mut desks: Vec<_> = scratch.chunks_exact_mut(each).map(Desk::new).collect();
        let alone = self.way.board.is_alone();
        let (mut taken, mut on, mut asks) = (0, true, false);
        // No wave is cut short by a look.
        let most = WAVE as u32 / self.way.wave * self.way.wave;
        while on {
            if asks && !more() {
                // Nobody goes beyond so many steps from here before having seen what is posted in the next one, and with it this.
                self.way.board.stop_after(taken + if alone { 0 } else { RECENT as u32 });
            }
            let last = self.way.board.last();
            if taken >= last {
                break;
            }
            asks = last == self.way.steps;
            let close = self.known.is_close(self.way);
            let end = last.min(taken + if close { 1 } else { most });
            // What the others posted some steps ago has arrived already.
            let sure = if alone || close { end } else { taken };
            while taken < end {
                let count = self.way.wave.min(end - taken);
                self.surge(laws, taken + 1, &mut desks[..count as usize]);
                taken += count;
            }
            on = self.look(sure);
        }
        if on {
            self.look(taken);
        }
        Outcome { steps: taken, late: self.known.steps < taken, ..self.known }
    }

    /// Takes some steps at once, from a first one on, each at a desk of its own.
    fn surge(&mut self, laws: impl StressModel<N>, first: u32, desks: &mut [Desk<'_, N>]) {
        let (piece, count) = (self.ground.piece.clone(), desks.len());
        let mut stages: [Stages<'_>; WAVE] = from_fn(|_| piece.gather.stages());
        // A stage collects what the next begins with: that has to be moved by then.
        let (ends, lag) = (piece.gather.count(), (piece.gather.lag() + 1).max(self.ground.met));
        for tick in 0..ends + (count - 1) * lag {
            for turn in 0..count {
                let Some(stage) = tick.checked_sub(turn * lag).filter(|stage| *stage < ends) else { continue };
                let step = first + turn as u32;
                if stage == 0 {
                    if turn > 0 {
                        self.move_seam(step - 1);
                    }
                    self.squares[turn] = f64x2::ZERO;
                }
                self.ask(stage, step, if turn + 1 == count { ends } else { lag });
                self.turn = turn;
                piece.stage(stage, laws, None, (&mut desks[turn], &mut stages[turn]), self);
                if stage == self.ground.met {
                    self.way.board.post_seam(self.ground.number, step, self.seam.as_flattened());
                }
                if stage + 1 == ends {
                    let [along_x, along_y] = self.squares[turn].to_array();
                    self.way.board.post_kinetic(self.ground.number, step, along_x + along_y);
                }
            }
        }
        self.move_seam(first + count as u32 - 1);
    }

    /// Asks, before a stage, for the memory that goes to and fro between those who walk: it may take as long as some hundred triangles. What
    /// the others posted in this step is read before a stage `read`.
    fn ask(&self, stage: usize, step: u32, read: usize) {
        let Ground { number, met, .. } = self.ground;
        if stage == met {
            self.way.board.claim_seam(number, step);
        } else if stage > met && stage + 2 == read {
            self.way.board.fetch_counts(number, step);
        } else if stage > met && stage + 1 == read {
            self.way.board.fetch_seam(number, step);
        }
    }

    /// Moves the vertices on the seams, as everyone does.
    fn move_seam(&mut self, step: u32) {
        /// A closure might stay a call, without the instruction set.
        struct Move<'a, const N: usize>(Kick, Moving<'a>, Masses<'a>, &'a [[f64x2; N]]);
        impl<const N: usize> WithSimd for Move<'_, N> {
            type Output = f64x2;

            #[inline(always)]
            fn with_simd<S: Simd>(self, set: S) -> f64x2 {
                let Self(kick, moving, masses, forces) = self;
                let (fours, rest) = forces.as_chunks();
                kick.of_run(set, 0, moving, masses, fours.iter().copied(), rest.iter().copied())
            }
        }
        let Ground { piece, number, x, v, masses, own, .. } = &mut self.ground;
        if self.seam.is_empty() {
            return;
        }
        self.way.board.sum_seam(*number, step, self.seam.as_flattened_mut(), self.patience);
        let masses = masses.map(|masses| &masses[*own..]);
        let seam = Move(self.kick, [&mut x[*own..], &mut v[*own..]], masses, &self.seam);
        let [along_x, along_y] = piece.gather.set().dispatch(seam).to_array();
        self.of_seam[step as usize % RECENT] = along_x + along_y;
        // What is not in a part gets no force from it.
        self.seam.fill([f64x2::ZERO; N]);
    }

    /// Looks at the energy of motion after each step up to one. Returns whether they may go on.
    fn look(&mut self, last: u32) -> bool {
        while self.known.steps < last {
            let (before, step) = (self.known, self.known.steps + 1);
            let kinetic = 0.5 * (self.way.board.kinetic(step, self.patience) + self.of_seam[step as usize % RECENT]);
            let room = (self.way.shrink)(before.room, kinetic, self.way.lightest, self.way.step);
            let (growth, travel) = (kinetic - before.kinetic, before.room - room);
            self.known = Outcome { steps: step, kinetic, growth, room, travel, late: false };
            // Nothing that is not a number is below a limit.
            if !(kinetic <= self.way.most_kinetic && room >= 0.0) {
                return false;
            }
            if kinetic <= self.way.looks.calm && self.way.looks.until(step) == 0 {
                return false;
            }
        }
        true
    }
}

impl<const N: usize> Target<N> for Walk<'_, '_, N> {
    #[inline(always)]
    fn motion(&self) -> [&[f64]; 2] {
        [self.ground.x.as_flattened(), self.ground.v.as_flattened()]
    }

    #[inline(always)]
    fn take(&mut self, forces: impl Iterator<Item = (usize, [f64x2; N])>) {
        let Ground { x, v, masses: [mass, inverse_mass], own, .. } = &mut self.ground;
        let mut squares = self.squares[self.turn];
        for (vertex, forces) in forces {
            if let Some(at) = vertex.checked_sub(*own) {
                self.seam[at] = forces;
            } else {
                let masses = [mass[vertex], inverse_mass[vertex]];
                squares += self.kick.of([&mut x[vertex], &mut v[vertex]], masses, forces);
            }
        }
        self.squares[self.turn] = squares;
    }

    #[inline(always)]
    fn take_run<S: Simd>(
        &mut self,
        set: S,
        first: usize,
        fours: impl ExactSizeIterator<Item = [[f64x2; N]; 4]>,
        rest: impl ExactSizeIterator<Item = [f64x2; N]>,
    ) {
        let Ground { x, v, masses, own, .. } = &mut self.ground;
        if first + 4 * fours.len() + rest.len() > *own {
            return self.take((first..).zip(fours.flatten().chain(rest)));
        }
        self.squares[self.turn] += self.kick.of_run(set, first, [x, v], *masses, fours, rest);
    }
}

//! Search for random runs of a level that go wrong, and for the least level that still does.

use super::random::{Outcome, Variation, Wrong};
use crate::{
    elements::ElementKind,
    level::{BodyLevel, Level, StartShape},
    quantity::{Factor, Spin, Velocity},
    study::{Deadline, spread, with_triangles},
};
use std::time::Duration;

/// A run that went wrong.
#[derive(Clone, Debug)]
pub struct Found {
    /// The run.
    pub variation: Variation,
    /// What was wrong.
    pub wrong: Wrong,
    /// The level with everything left out that it goes wrong without.
    pub least: Level,
}

/// Random variations of a level, one after another.
pub struct Search {
    name: String,
    level: Level,
    seed: u32,
    next: u32,
    threads: usize,
    found: Vec<Found>,
    /// Numbers of runs that went to the end, that stopped with a cause, and that were refused before the first step.
    counts: [usize; 3],
}

/// Greatest time in which one level is made smaller \[s\].
const SHRINKING: f64 = 60.0;

impl Search {
    /// A search from a number in the sequence of a seed on.
    pub fn new(name: &str, level: &Level, (seed, first): (u32, u32), threads: usize) -> Self {
        let (name, level) = (name.to_owned(), level.clone());
        Self { name, level, seed, next: first, threads, found: Vec::new(), counts: [0; 3] }
    }

    /// What was found.
    pub fn found(&self) -> &[Found] {
        &self.found
    }

    /// Numbers of runs that went to the end, that stopped with a cause, and that were refused before the first step.
    pub const fn counts(&self) -> [usize; 3] {
        self.counts
    }

    /// Runs variations for about `budget`; whatever goes wrong is made smaller, which may take longer.
    pub fn advance(&mut self, budget: Duration) {
        let deadline = Deadline::after(budget);
        while !deadline.passed() {
            let numbers = self.next..self.next.saturating_add(self.threads.max(1) as u32);
            self.next = numbers.end;
            let mut runs: Vec<_> = numbers
                .map(|number| (Variation::of(&self.name, &self.level, self.seed, number), None::<Outcome>))
                .collect();
            spread(self.threads, runs.iter_mut().collect(), |(variation, outcome)| {
                *outcome = Some(variation.run());
                true
            });
            for (variation, outcome) in runs {
                let Some(outcome) = outcome else { continue };
                let end = if outcome.refused.is_some() { 2 } else { usize::from(outcome.fault.is_some()) };
                self.counts[end] += 1;
                if let Some(wrong) = outcome.wrong() {
                    let is_wrong = |level: &Level| Outcome::of(level).wrong().is_some_and(|other| other.is_like(wrong));
                    let least = least(&variation.level, &is_wrong);
                    self.found.push(Found { variation, wrong, least });
                }
            }
        }
    }
}

/// The level without what can be left out one after another so that it is still wrong.
fn least(level: &Level, is_wrong: &dyn Fn(&Level) -> bool) -> Level {
    let deadline = Deadline::after(Duration::from_secs_f64(SHRINKING));
    let mut level = level.clone();
    while let Some(smaller) = smaller(&level).into_iter().find(|smaller| !deadline.passed() && is_wrong(smaller)) {
        level = smaller;
    }
    level
}

/// Levels that have less than one in one point, those that leave out most first.
fn smaller(level: &Level) -> Vec<Level> {
    let mut all = Vec::new();
    if level.bodies.len() + level.nets.len() + level.membranes.len() > 1 {
        let without = |change: &dyn Fn(&mut Level)| changed(level, change);
        all.extend((0..level.bodies.len()).map(|number| without(&|level| drop(level.bodies.remove(number)))));
        all.extend((0..level.nets.len()).map(|number| without(&|level| drop(level.nets.remove(number)))));
        all.extend((0..level.membranes.len()).map(|number| without(&|level| drop(level.membranes.remove(number)))));
    }
    all.extend(with_triangles(level, 0.5));
    all.extend((0..level.effects.len()).map(|number| changed(level, &|level| drop(level.effects.remove(number)))));
    all.push(changed(level, &|level| level.actions.clear()));
    all.push(changed(level, &|level| level.checks.clear()));
    for number in 0..level.bodies.len() {
        let plain: [fn(&mut BodyLevel); 7] = [
            |body| body.element = ElementKind::Linear,
            |body| body.stretch = (Factor::literal(1.0), Factor::literal(1.0)),
            |body| body.velocity = (Velocity::literal(0.0), Velocity::literal(0.0)),
            |body| body.spin = Spin::literal(0.0),
            |body| body.start = StartShape::Rest,
            |body| body.pins.clear(),
            |body| body.slides.clear(),
        ];
        all.extend(plain.into_iter().map(|plain| changed(level, &|level| plain(&mut level.bodies[number]))));
    }
    all.retain(|smaller| smaller != level);
    all
}

/// A changed level.
fn changed(level: &Level, change: &dyn Fn(&mut Level)) -> Level {
    let mut changed = level.clone();
    change(&mut changed);
    changed
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failing test should panic")]

    use super::*;
    use crate::{files, levels};

    /// Of a level that is wrong with a body and an effect, these are left, and of the body as few triangles as it is wrong with.
    #[test]
    fn what_is_not_needed_is_left_out() {
        let level = files::parse(levels::built_in("two_men").unwrap(), "two_men").unwrap();
        let pulled = Search::new("two_men", &level, (1, 0), 1);
        let level = pulled.level;
        let name = level.bodies.last().unwrap().name.clone();
        let triangles =
            |body: &BodyLevel| body.mesh.kind().build(&crate::meshes::NoFiles).map_or(0, |mesh| mesh.triangles().len());
        let is_wrong = |level: &Level| {
            level.effects.iter().any(|listed| listed.effect.name() == "Gravity")
                && level.bodies.iter().any(|body| body.name == name && triangles(body) > 150)
        };
        let least = least(&level, &is_wrong);
        assert!(is_wrong(&least));
        assert_eq!((least.bodies.len(), least.effects.len(), least.actions.len()), (1, 1, 0));
        let [before, after] = [&level, &least].map(|level| level.bodies.last().map_or(0, triangles));
        assert!(after > 150 && after < before, "{after} of {before}");
    }
}

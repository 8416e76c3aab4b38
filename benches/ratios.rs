//! What size and a second thread do to the price of a step, and what the same step costs when it is written plainly:
//! `cargo bench --bench ratios`, some four minutes; or of some materials alone, `cargo bench --bench ratios -- Corotated NeoHookean`.
//!
//! All that is compared is measured in turn, for a hundredth of a second each, round after round, and the ratio of two is the median over
//! the rounds: a machine that is now fast, now slow, as most that are shared are, slows down both. Least times stand beside them, and
//! before the median of how many times as fast something is stands that of the least times: whoever else is about holds up one of two that wait for each other more
//! than one alone.
#![allow(missing_docs, clippy::panic, clippy::unwrap_used, reason = "a benchmark is not a library")]

mod plain;
mod sheet;

use gingerbread::{materials::Model, simulation::Simulation};
use plain::Plain;
use rayon::{ThreadPool, ThreadPoolBuilder};
use sheet::{Lap, simulation, strip};

/// Quads along a side: the second is what the others are compared with.
const SIDES: [u32; 5] = [22, 71, 112, 158, 224];
const USUAL: usize = 1;

/// Time for a measurement [s], and how often each is made.
const SLICE: f64 = 0.01;
const ROUNDS: usize = 100;

/// Times of a step, per triangle [ns], one for each round.
type Times = Vec<f64>;

/// A sheet with one thread and with two, and two halves of it, stepped at once, that have nothing to tell each other: what a second
/// thread can come to on this machine; and the sheet stepped plainly.
struct Case {
    triangles: f64,
    lap: Lap,
    whole: [Simulation; 2],
    halves: [Simulation; 2],
    plain: Plain,
    times: [Times; 4],
}

impl Case {
    fn new(n: u32, model: Model) -> Self {
        let whole = [(); 2].map(|()| sheet::sheet(n, model));
        let plain = Plain::new(whole[0].scene());
        // The guard looks often until all have once been as fast as they get; the time for that grows with their number.
        let lead = 10 * u64::from(n);
        Self {
            triangles: f64::from(2 * n * n),
            lap: Lap { lead, end: 5 * lead },
            whole,
            halves: [n / 2, n - n / 2].map(|rows| simulation(strip([n, rows], model))),
            plain,
            times: Default::default(),
        }
    }

    fn measure(&mut self, pool: &ThreadPool) {
        let Self { triangles, lap, whole: [one, two], halves, plain, times } = self;
        // From one checkpoint to another.
        let steps = |each: f64| ((SLICE / (each * *triangles)) as u64).next_multiple_of(10).max(20);
        let per_step = |steps: u64, run: &mut dyn FnMut(u64) -> f64| {
            // What the others have left in the caches is not theirs; a state and the two to go back to take turns.
            (0..3).for_each(|_| _ = run(10));
            1e9 * run(steps) / steps as f64 / *triangles
        };
        times[0].push(per_step(steps(3.5e-9), &mut |steps| lap.time(one, steps).as_secs_f64()));
        times[1].push(per_step(steps(1.8e-9), &mut |steps| pool.install(|| lap.time(two, steps)).as_secs_f64()));
        times[2].push(per_step(steps(1.8e-9), &mut |steps| lap.time_apart(halves, steps).as_secs_f64()));
        times[3].push(per_step(steps(12e-9), &mut |steps| plain.time(steps).as_secs_f64()));
    }
}

/// The quarters of these numbers.
fn quarters(numbers: impl Iterator<Item = f64>) -> [f64; 3] {
    let mut sorted: Vec<_> = numbers.collect();
    sorted.sort_by(f64::total_cmp);
    [1, 2, 3].map(|quarter| sorted[quarter * (sorted.len() - 1) / 4])
}

/// The least of these times, as if nobody else had been about.
fn least(times: &Times) -> f64 {
    times.iter().copied().fold(f64::INFINITY, f64::min)
}

/// The median of the ratios in each round, and those that half of them lie between.
fn ratio(of: &Times, to: &Times) -> String {
    let [low, median, high] = quarters(of.iter().zip(to).map(|(of, to)| of / to));
    format!("{median:.3} ({low:.2} to {high:.2})")
}

fn main() {
    let names: Vec<_> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    if let Some(name) = names.iter().find(|name| Model::ALL.iter().all(|model| model.name() != *name)) {
        let known: Vec<_> = Model::ALL.iter().map(|model| model.name()).collect();
        panic!("there is no model {name}; there are {}", known.join(", "));
    }
    let wanted = |model: &&Model| names.is_empty() || names.iter().any(|name| name == model.name());
    let pool = ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    println!(
        "| model | triangles | ns, least | ns, median | of {}'s | two threads | two halves apart | plain, ns | than plain |",
        { 2 * SIDES[USUAL].pow(2) }
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for model in Model::ALL.iter().filter(wanted) {
        let mut cases = SIDES.map(|n| Case::new(n, *model));
        for _ in 0..ROUNDS {
            for case in &mut cases {
                case.measure(&pool);
            }
        }
        for case in &cases {
            let [one, two, apart, plain] = &case.times;
            let [_, median, _] = quarters(one.iter().copied());
            let to_usual = ratio(one, &cases[USUAL].times[0]);
            let faster =
                |one: &Times, other: &Times| format!("{:.3}; {}", least(one) / least(other), ratio(one, other));
            let shared = if case.whole[1].scene().bodies[0].elements.partitions() > 1 {
                faster(one, two)
            } else {
                "-".to_owned()
            };
            println!(
                "| {} | {} | {:.2} | {median:.2} | {to_usual} | {shared} | {} | {:.2} | {} |",
                model.name(),
                case.triangles,
                least(one),
                faster(one, apart),
                least(plain),
                faster(plain, one)
            );
        }
    }
}

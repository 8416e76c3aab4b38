//! The accuracy dial: what it chooses keeps the error that was wanted, and hardly more.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{built_in, named, simulation};
use gingerbread::{
    integrators::{Class, IntegratorKind, RungeKutta4},
    level::{Level, Sleep, Substeps, Toggle},
    meshes::NoFiles,
    study::{Dial, DialPlan, NoErrors, Reached, Setting, Trial},
};
use std::time::Duration;

fn dial(level: &Level, seconds: f64, plan: DialPlan) -> Dial {
    let mut dial = Dial::new(Trial::new(level, &NoFiles, seconds).unwrap(), plan);
    while !dial.advance(Duration::from_millis(20)).unwrap().finished {}
    dial
}

fn frames(level: &Level, setting: &Setting, count: usize) -> Vec<Vec<f64>> {
    let Setting { integrator, substeps } = setting.clone();
    let mut run = simulation(&Level { integrator, substeps, guard: Toggle::Off, sleep: Sleep::Off, ..level.clone() });
    let frame = |_| {
        run.advance(u64::from(substeps.get()), &mut || true);
        run.state().x.clone()
    };
    (0..count).map(frame).collect()
}

/// Error that 95 % of the frames are within, against a run with far shorter steps.
fn true_error(level: &Level, setting: &Setting, count: usize) -> f64 {
    let fine = Setting { integrator: RungeKutta4::default().into(), substeps: Substeps::new(4000).unwrap() };
    let start = simulation(level).state().x.clone();
    let square = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
    let exact = frames(level, &fine, count);
    let motion = exact.iter().map(|x| square(x, &start)).sum::<f64>() / count as f64;
    let mut errors: Vec<_> =
        frames(level, setting, count).iter().zip(&exact).map(|(x, exact)| (square(x, exact) / motion).sqrt()).collect();
    errors.sort_by(f64::total_cmp);
    errors[(0.95 * count as f64).ceil() as usize - 1]
}

/// Every scheme alone finds a step that keeps the error, and no step of much more than it needs.
#[test]
fn every_scheme_keeps_the_wanted_error_and_hardly_more() {
    let level = Level { substeps: Substeps::new(10).unwrap(), ..built_in("hanging_net") };
    for kind in IntegratorKind::all() {
        let wanted = vec![0.05, 0.01];
        let plan = DialPlan { integrators: vec![kind.clone()], wanted: wanted.clone(), threads: 1 };
        let dial = dial(&level, 0.25, plan);
        for error in wanted {
            let (_, reached) = dial.reached(error).next().unwrap();
            assert!(reached.is_some(), "{} reaches no {error}", kind.name());
            let Reached { setting, outcome } = reached.unwrap();
            let found = true_error(&level, setting, 15);
            let name = setting.label();
            assert!(found <= error, "{name}: {found} of {error}");
            assert!((found / outcome.usual_error - 1.0).abs() < 0.02, "{name}: {found} for {}", outcome.usual_error);
            // Explicit schemes begin at their stability limit, implicit ones at one step a frame, and all of them may be better there.
            let is_first = match kind.kind().class() {
                Class::ErrorControlled => setting.tolerance() == Some(0.01),
                _ => found < 0.1 * error && outcome.counts.steps <= 15 * 60,
            };
            assert!(is_first || found > 0.1 * error, "{name}: {found} of {error}");
        }
    }
}

#[test]
fn of_all_schemes_it_takes_the_cheapest() {
    let schemes = ["SymplecticEuler", "VelocityVerlet", "ImplicitMidpoint"].map(named).to_vec();
    let plan = DialPlan { integrators: schemes, wanted: vec![0.001, 0.02], threads: 2 };
    let dial = dial(&built_in("hanging_net"), 0.3, plan);
    assert_eq!(dial.plan().wanted, [0.02, 0.001], "the greatest first");
    for wanted in [0.02, 0.001] {
        let cheapest = dial.cheapest(wanted).unwrap();
        for reached in dial.reached(wanted).filter_map(|(_, reached)| reached) {
            assert!(reached.outcome.usual_error <= wanted);
            assert!(reached.outcome.ms_per_second >= cheapest.outcome.ms_per_second);
        }
    }
    let [loose, strict] = [0.02, 0.001].map(|wanted| dial.cheapest(wanted).unwrap().outcome.usual_error);
    assert!(strict < loose);
}

#[test]
fn where_nothing_moves_or_no_reference_is_exact_enough_it_says_so() {
    let still = dial(&built_in("gingerbread"), 0.2, DialPlan { threads: 1, ..DialPlan::default() });
    assert!(matches!(still.no_errors(), Some(NoErrors::NothingMoves(_))), "{:?}", still.no_errors());
    // Round-off is more than a fifth of the wanted error.
    let plan = DialPlan { integrators: vec![named("RungeKutta4")], wanted: vec![1e-13], threads: 1 };
    let strict = dial(&built_in("hanging_net"), 0.1, plan);
    assert!(matches!(strict.no_errors(), Some(NoErrors::CoarseReference(_))), "{:?}", strict.no_errors());
    assert!(strict.cheapest(1e-13).is_none() && !strict.tells(1e-13) && strict.tells(0.01));
}

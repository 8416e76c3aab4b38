//! When errors show an order of convergence, and what is said where they do not.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use gingerbread::study::{Limits, MeasuredOrder, NoOrder, Sample, measured_order, order_in_words};

const LIMITS: Limits = Limits { round_off: 1e-12, reference: 1e-8 };

fn order(samples: &[(f64, f64)]) -> MeasuredOrder {
    measured_order(samples.iter().map(|&(h, error)| Sample { h, error }), LIMITS)
}

#[test]
fn three_points_that_agree_over_a_factor_four_have_an_order() {
    let second = [(4.0, 0.16), (1.0, 0.01), (2.0, 0.04)];
    assert!((order(&second).unwrap() - 2.0).abs() < 1e-12);
    // Coarser points that bend are left out; finer ones below the reference too.
    let bent = [(0.01, 1e-10), (0.25, 0.000_625), (0.5, 0.0025), (1.0, 0.01), (2.0, 0.2)];
    assert!((order(&bent).unwrap() - 2.0).abs() < 1e-12);
    assert_eq!(order_in_words(&order(&second)), "2.00");
}

#[test]
fn every_reason_for_no_order_is_told() {
    let cases: [(&[(f64, f64)], NoOrder); 9] = [
        (&[], NoOrder::TooFewPoints),
        (&[(1.0, 1e-3), (2.0, 2e-3)], NoOrder::TooFewPoints),
        (&[(1.0, 1e-3), (1.0, 1e-3), (8.0, 8e-3)], NoOrder::TooFewPoints),
        (&[(1.0, 1e-3), (1.5, 1.5e-3), (3.9, 3.9e-3)], NoOrder::ShortSpan),
        (&[(1.0, 1e-3), (2.0, 9e-4), (4.0, 2e-3)], NoOrder::NotMonotone),
        (&[(1.0, 1e-3), (2.0, 2e-3), (4.0, 32e-3)], NoOrder::SlopesDiffer),
        (&[(1.0, 1e-15), (2.0, 3e-15), (4.0, 2e-15)], NoOrder::RoundOff),
        (&[(1.0, 1e-9), (2.0, 2e-9), (4.0, 4e-9)], NoOrder::CoarseReference),
        (&[(1.0, 0.4), (2.0, 0.8), (4.0, f64::INFINITY)], NoOrder::SizeOfMotion),
    ];
    for (samples, reason) in cases {
        assert_eq!(order(samples), Err(reason), "{samples:?}");
        let words = order_in_words(&Err(reason));
        assert!(words.starts_with("not measurable here: ") && words.len() > 25, "{words}");
    }
}

/// Two points beside each other whose errors differ for another reason gave 396.9.
#[test]
fn points_that_are_near_to_each_other_give_no_order() {
    let samples = [(1.0, 1e-6), (1.001, 1.5e-6), (1.002, 2e-6)];
    assert!(order(&samples).is_err());
}

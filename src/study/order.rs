//! Estimates the order of convergence, or says why there is none.

/// What an error must exceed, and what it must not, to tell something about an order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Relative error that rounding makes.
    pub round_off: f64,
    /// Relative error that the reference may have.
    pub reference: f64,
}

/// A step or a size of triangles, and the relative error with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Step [s] or size [m]; only ratios count.
    pub h: f64,
    /// Relative error.
    pub error: f64,
}

/// Why no order is stated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoOrder {
    /// Nothing moves, so that there are no relative errors.
    #[error("nothing moves")]
    NothingMoves,
    /// There is nothing to measure errors against.
    #[error("no reference")]
    NoReference,
    /// Fewer than three sizes were measured.
    #[error("too few points")]
    TooFewPoints,
    /// Errors are those of rounding.
    #[error("errors are round-off")]
    RoundOff,
    /// Errors are above a quarter of the motion.
    #[error("errors at the size of the motion")]
    SizeOfMotion,
    /// Errors are not far enough above that of the reference.
    #[error("reference not fine enough")]
    CoarseReference,
    /// The error does not fall with every refinement.
    #[error("errors not monotone")]
    NotMonotone,
    /// The local slopes of the finest points differ.
    #[error("slopes do not agree")]
    SlopesDiffer,
    /// The points that agree are too near to each other.
    #[error("sizes span less than a factor 4")]
    ShortSpan,
    /// Something that changes the energy by right acts.
    #[error("energy is changed by right")]
    ChangedByRight,
}

/// An order that was measured, or why there is none.
pub type MeasuredOrder = Result<f64, NoOrder>;

/// Greatest error that tells something: above it errors are of the size of the motion.
const GREATEST: f64 = 0.25;
/// Fewest points of an order.
const FEWEST: usize = 3;
/// How far local slopes may be from that of the two finest points.
const TOLERANCE: f64 = 0.2;
/// Least ratio of the greatest to the least size, but for rounding.
const SPAN: f64 = 4.0 * (1.0 - 1e-6);

/// Slope of log error over log h by least squares, of at least three points that agree: beginning with the finest one and going
/// on to coarser ones while the error grows and the local slope stays within 0.2 of that of the two finest. They must span at least a
/// factor 4 in h, and have errors of at most 25 %, above round-off and above what the reference is good for.
///
/// # Errors
/// [`NoOrder`] says why there is none.
pub fn measured_order(samples: impl IntoIterator<Item = Sample>, limits: Limits) -> MeasuredOrder {
    let mut finest_first: Vec<_> = samples.into_iter().filter(|sample| sample.h > 0.0).collect();
    finest_first.sort_by(|a, b| a.h.total_cmp(&b.h));
    finest_first.dedup_by(|a, b| a.h == b.h);
    if finest_first.len() < FEWEST {
        return Err(NoOrder::TooFewPoints);
    }
    let judge = |sample: &Sample| {
        if sample.error <= limits.round_off {
            Some(NoOrder::RoundOff)
        } else if sample.error <= limits.reference {
            Some(NoOrder::CoarseReference)
        } else if sample.error <= GREATEST {
            None
        } else {
            Some(NoOrder::SizeOfMotion)
        }
    };
    let usable: Vec<_> = finest_first
        .iter()
        .skip_while(|sample| matches!(judge(sample), Some(NoOrder::RoundOff | NoOrder::CoarseReference)))
        .take_while(|sample| judge(sample).is_none())
        .map(|sample| [libm::log(sample.h), libm::log(sample.error)])
        .collect();
    if usable.len() < FEWEST {
        let reasons = || finest_first.iter().filter_map(judge);
        let count = |reason: &NoOrder| reasons().filter(|other| other == reason).count();
        return Err(reasons().max_by_key(count).unwrap_or(NoOrder::TooFewPoints));
    }
    let slope = |a: &[f64; 2], b: &[f64; 2]| (a[1] - b[1]) / (a[0] - b[0]);
    let finest = slope(&usable[0], &usable[1]);
    let agrees = |slope: f64| slope > 0.0 && (slope - finest).abs() <= TOLERANCE;
    let steady = usable.windows(2).take_while(|pair| agrees(slope(&pair[0], &pair[1]))).count();
    let fitted = &usable[..=steady];
    if fitted.len() < FEWEST {
        let falls = usable.windows(2).take(FEWEST - 1).all(|pair| slope(&pair[0], &pair[1]) > 0.0);
        return Err(if falls { NoOrder::SlopesDiffer } else { NoOrder::NotMonotone });
    }
    if fitted.last().map_or(0.0, |last| last[0] - fitted[0][0]) < libm::log(SPAN) {
        return Err(NoOrder::ShortSpan);
    }
    let mean = |axis: usize| fitted.iter().map(|point| point[axis]).sum::<f64>() / fitted.len() as f64;
    let [x, y] = [mean(0), mean(1)];
    let covariance: f64 = fitted.iter().map(|point| (point[0] - x) * (point[1] - y)).sum();
    let variance: f64 = fitted.iter().map(|point| (point[0] - x) * (point[0] - x)).sum();
    Ok(covariance / variance)
}

/// An order for a table: a number, or `not measurable here` and the reason.
pub fn order_in_words(order: &MeasuredOrder) -> String {
    match order {
        Ok(order) => format!("{order:.2}"),
        Err(reason) => format!("not measurable here: {reason}"),
    }
}

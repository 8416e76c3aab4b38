//! Estimate of the order of convergence.

/// Lower limits of errors that can be used to measure an order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Relative error by rounding.
    pub round_off: f64,
    /// Upper limit of the relative error of the reference.
    pub reference: f64,
}

/// Step or triangle size, and the relative error for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Step [s] or size [m]. Only ratios matter.
    pub h: f64,
    /// Relative error.
    pub error: f64,
}

/// Reason why no order can be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoOrder {
    /// Nothing moves, so there are no relative errors.
    #[error("nothing moves")]
    NothingMoves,
    /// There is no reference for errors.
    #[error("no reference")]
    NoReference,
    /// Fewer than three sizes were measured.
    #[error("too few points")]
    TooFewPoints,
    /// Errors are round-off.
    #[error("errors are round-off")]
    RoundOff,
    /// Errors are above a quarter of the motion.
    #[error("errors at the size of the motion")]
    SizeOfMotion,
    /// Errors are not far enough above the error of the reference.
    #[error("reference not fine enough")]
    CoarseReference,
    /// The error does not fall with every refinement.
    #[error("errors not monotone")]
    NotMonotone,
    /// The local slopes of the finest points differ.
    #[error("slopes do not agree")]
    SlopesDiffer,
    /// The agreeing points span less than a factor of 4.
    #[error("sizes span less than a factor 4")]
    ShortSpan,
    /// A physical cause, such as damping or a wall, changes the energy.
    #[error("energy is changed by right")]
    ChangedByRight,
}

/// Measured order, or the reason why there is none.
pub type MeasuredOrder = Result<f64, NoOrder>;

/// Greatest error that is used. Larger errors have the size of the motion.
const GREATEST: f64 = 0.25;
/// Least number of points of an order.
const FEWEST: usize = 3;
/// Greatest difference of a local slope from the slope of the two finest points.
const TOLERANCE: f64 = 0.2;
/// Least ratio of the greatest to the least size, with a margin for rounding.
const SPAN: f64 = 4.0 * (1.0 - 1e-6);

/// Measured order: the slope of log error over log h by least squares.
/// The fit begins with the finest point. It goes on to coarser points while the error grows and the local slope is
/// within 0.2 of the slope of the two finest points. It needs at least three points that span at least a factor of 4
/// in h. Their errors are at most 25 %, above round-off and above the limit of the reference.
///
/// # Errors
/// [`NoOrder`] if no order can be measured.
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

/// Order for a table: the number, or `not measurable here` and the reason.
pub fn order_in_words(order: &MeasuredOrder) -> String {
    match order {
        Ok(order) => format!("{order:.2}"),
        Err(reason) => format!("not measurable here: {reason}"),
    }
}

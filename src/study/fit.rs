//! Slopes of lines on logarithmic paper.

/// Slope by least squares of points from the fine end of a curve on, as far as the curve is straight: beginning with the two
/// finest and going on to coarser ones while the local slope stays within 0.15 of theirs. `None` if there are fewer than two.
pub(super) fn steady_slope(finest_first: &[[f64; 2]]) -> Option<f64> {
    let slope = |a: &[f64; 2], b: &[f64; 2]| (a[1] - b[1]) / (a[0] - b[0]);
    let [a, b, ..] = finest_first else { return None };
    let finest = slope(a, b);
    let steady = finest_first.windows(2).take_while(|pair| (slope(&pair[0], &pair[1]) - finest).abs() <= 0.15).count();
    let fitted = finest_first.get(..=steady)?;
    let mean = |axis: usize| fitted.iter().map(|point| point[axis]).sum::<f64>() / fitted.len() as f64;
    let [x, y] = [mean(0), mean(1)];
    let covariance: f64 = fitted.iter().map(|point| (point[0] - x) * (point[1] - y)).sum();
    let variance: f64 = fitted.iter().map(|point| (point[0] - x) * (point[0] - x)).sum();
    (variance > 0.0).then(|| covariance / variance)
}

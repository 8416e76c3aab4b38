//! Dormand-Prince method of order 5(4) with error control.

use super::{Class, FirstOrder, Integrator, Ode, Scheme, StepCounts, Workspace, memory};
use crate::{
    quantity::{AbsoluteTolerance, Quantity, RelativeTolerance},
    state::State,
};
use serde::{Deserialize, Serialize};

/// The Runge-Kutta pair 5(4) of Dormand and Prince with error control.
///
/// Seven rates give a result of fifth order and an estimate of its error; the seventh is the first of the next inner
/// step. Inner steps of its own length fill the step h exactly; where the estimate is above tolerance an inner step is
/// taken again, shorter. So h hardly matters, and stability never shows but in the number of inner steps.
/// (Hairer, Nørsett and Wanner, *Solving Ordinary Differential Equations I*, table II.5.2 and section II.4; PI control after
/// Gustafsson with the constants of their DOPRI5: Hairer and Wanner II, section IV.2.)
///
/// The length of the inner step and the error before are remembered. No inner step is longer than h.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DormandPrince {
    /// As a share of each position and velocity.
    pub relative: RelativeTolerance,
    /// In metres and metres per second.
    pub absolute: AbsoluteTolerance,
}

impl Default for DormandPrince {
    fn default() -> Self {
        Self { relative: RelativeTolerance::literal(1e-6), absolute: AbsoluteTolerance::literal(1e-6) }
    }
}

impl Integrator for DormandPrince {
    fn title(&self) -> &'static str {
        "Dormand-Prince 5(4)"
    }

    fn about(&self) -> &'static str {
        "Fifth order, with an estimate of its error: takes inner steps as long as the tolerance allows."
    }

    fn order(&self) -> u32 {
        5
    }

    fn class(&self) -> Class {
        Class::ErrorControlled
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.relative, &mut self.absolute]
    }

    /// Its steps have lengths of their own, and its estimate of the error knows nothing of the projection.
    fn allows_projection(&self) -> bool {
        false
    }

    fn scheme(&self) -> Scheme<'_> {
        Scheme::First(self)
    }
}

/// Tag of this kind's memory: length of the inner step \[s\], and error of the last one as a fraction of the tolerance.
const TAG: f64 = 3.0;

/// Weights of the rates before in each stage; the last row is the result as well.
const STAGES: [&[f64]; 6] = [
    &[1.0 / 5.0],
    &[3.0 / 40.0, 9.0 / 40.0],
    &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
    &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
    &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
    &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
/// Place of each stage in the inner step.
const NODES: [f64; 6] = [1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0];
/// Weights of the rates in the estimate of the error: fifth order less fourth.
const ERROR: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339_200.0, 22.0 / 525.0, -1.0 / 40.0];

/// Numbers whose shares of the error are computed together.
const CHUNK: usize = 64;

/// Safety factor of the controller.
const SAFETY: f64 = 0.9;
/// Exponent of the error before (beta of the PI controller).
const BETA: f64 = 0.04;
/// Exponent of the error now.
const ALPHA: f64 = 0.2 - 0.75 * BETA;
/// Least inner step as a fraction of h; below, no step length helps.
const LEAST: f64 = 1e-9;
/// Most inner steps, taken or rejected, of one step. A body that is tangled by too long a step could keep the
/// controller busy without end; beyond the limit the result is NaN, and the simulation stops with a fault.
const MOST: u64 = 10_000;

impl FirstOrder for DormandPrince {
    fn step(&self, system: &mut dyn Ode, state: &mut State, workspace: &mut Workspace, h: f64) -> StepCounts {
        let [start, x, next, mut rates @ ..]: [&mut [f64]; 10] = workspace.vectors(state.x.len() + state.v.len());
        state.copy_to(start);
        x.copy_from_slice(start);
        let known = memory::is_known(state, TAG, 2);
        let past = memory::open(state, TAG, 0.0, 2);
        let [mut length, mut before] = if known { [past[0].min(h), past[1]] } else { [h, 1e-4] };
        let mut counts = StepCounts { inner_steps: 0, ..StepCounts::ONE };
        let (mut done, mut retry) = (0.0, false);
        system.rate(0.0, x, rates[0]);
        while done < h {
            if counts.inner_steps + counts.rejected >= MOST {
                counts.newton.unconverged += 1;
                x.fill(f64::NAN);
                break;
            }
            // A remainder of round-off size is added to the last inner step.
            let last = done + 1.0001 * length >= h;
            let inner = if last { h - done } else { length };
            stages(system, x, next, &mut rates, [done, inner]);
            let error = self.error(x, next, &rates, inner);
            // The comparison is false for NaN.
            let good = error <= 1.0;
            if !good && inner > LEAST * h {
                counts.rejected += 1;
                let factor = if error.is_finite() { SAFETY / libm::pow(error, ALPHA) } else { 0.0 };
                length = inner * factor.clamp(0.2, 1.0);
                retry = true;
                continue;
            }
            counts.newton.unconverged += u64::from(!good);
            counts.inner_steps += 1;
            done = if last { h } else { done + inner };
            let factor = SAFETY * libm::pow(before, BETA) / libm::pow(error.max(1e-10), ALPHA);
            let proposed = inner * factor.clamp(0.2, if retry { 1.0 } else { 10.0 });
            // A short last inner step says little about the length; it may lengthen but not shorten it.
            length = if last && good { proposed.max(length) } else { proposed }.min(h).max(LEAST * h);
            before = error.clamp(1e-4, 1e4);
            retry = false;
            let cut = system.truncate(done, x, next);
            x.copy_from_slice(next);
            system.end_step(done, x);
            let [first, .., seventh] = rates.each_mut();
            if cut {
                system.rate(done, x, first);
            } else {
                first.swap_with_slice(seventh);
            }
        }
        memory::own(&mut state.memory).copy_from_slice(&[length, before]);
        system.constrain(start, x);
        state.copy_from(x);
        counts
    }
}

impl DormandPrince {
    /// The estimated error as a share of the tolerance: root mean square over all numbers.
    fn error(&self, x: &[f64], next: &[f64], rates: &[&mut [f64]; 7], h: f64) -> f64 {
        let (absolute, relative) = (self.absolute.get(), self.relative.get());
        let mut sum = 0.0;
        let mut shares = [0.0; CHUNK];
        for start in (0..x.len()).step_by(CHUNK) {
            let range = start..(start + CHUNK).min(x.len());
            let shares = &mut shares[..range.len()];
            let ([x, next], rates) =
                ([x, next].map(|all| &all[range.clone()]), rates.each_ref().map(|rate| &rate[range.clone()]));
            weighted_sums(&ERROR, rates, shares, |number, error| {
                h * error / (absolute + relative * x[number].abs().max(next[number].abs()))
            });
            sum = shares.iter().fold(sum, |sum, share| sum + share * share);
        }
        (sum / x.len().max(1) as f64).sqrt()
    }
}

/// Writes what a function makes of each number and the weighted sum of its rates. The number of rates is known to the
/// compiler, so that it makes vectors of the sums.
#[inline(always)]
fn weighted_sums<const N: usize>(
    weights: &[f64; N],
    rates: [&[f64]; N],
    out: &mut [f64],
    result: impl Fn(usize, f64) -> f64,
) {
    let rates = rates.map(|rate| &rate[..out.len()]);
    for (number, out) in out.iter_mut().enumerate() {
        let mut sum = weights[0] * rates[0][number];
        for (weight, rate) in weights.iter().zip(rates).skip(1) {
            sum += weight * rate[number];
        }
        *out = result(number, sum);
    }
}

/// The positions and velocities of a stage: `x + h` times the weighted sum of the N rates before.
fn stage<const N: usize>(x: &[f64], next: &mut [f64], rates: &[&mut [f64]; 7], h: f64) {
    let weights: [f64; N] = std::array::from_fn(|before| STAGES[N - 1][before]);
    let x = &x[..next.len()];
    weighted_sums(&weights, std::array::from_fn(|before| &*rates[before]), next, |number, along| x[number] + h * along);
}

/// The result of one inner step from a time since the start of the step and with a length \[s\], and its rates; the last is
/// that at the result.
fn stages(system: &mut dyn Ode, x: &[f64], next: &mut [f64], rates: &mut [&mut [f64]; 7], [start, h]: [f64; 2]) {
    let stages = [stage::<1>, stage::<2>, stage::<3>, stage::<4>, stage::<5>, stage::<6>];
    for (before, stage) in stages.into_iter().enumerate() {
        stage(x, next, rates, h);
        system.rate(start + NODES[before] * h, next, rates[before + 1]);
    }
}

//! Effect: rigid rods in place of springs.

use super::{ConstraintTerm, Effect, EffectParameters, MOST_CONDITIONS, Motion};
use crate::{
    elements::Elements,
    nets::{Link, Role},
    quantity::{Quantity, RecoveryRate},
    solvers::ConstraintRows,
};
use serde::{Deserialize, Serialize};

/// The structural springs of nets keep their rest lengths, as exactly as the scheme is, by constraint forces (see [`ConstraintRows`]):
/// `|x_a - x_b| = r`. A chain of rods is a pendulum with as many links.
///
/// The springs exert no force while the rods hold; their stiffness still counts for the stability limit, so that zero is best. A rod that is longer or shorter than r, as after a step whose length is not short,
/// returns to it like a critically damped oscillator of the recovery rate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rods {
    /// Name of the net; all, if it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
    /// Rate at which lengths return [1/s]. Explicit schemes need steps shorter than 0.8 of its inverse.
    #[serde(default = "ten_a_second")]
    pub recovery: RecoveryRate,
}

pub(super) const fn ten_a_second() -> RecoveryRate {
    RecoveryRate::literal(10.0)
}

impl Default for Rods {
    fn default() -> Self {
        Self { of: None, recovery: ten_a_second() }
    }
}

impl EffectParameters for Rods {
    fn title(&self) -> &'static str {
        "Rigid rods"
    }

    fn about(&self) -> &'static str {
        "Structural springs of nets keep their rest lengths, |x_a − x_b| = r, by constraint forces: the chain becomes a pendulum."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.recovery]
    }

    fn build(&self, elements: &Elements) -> Result<Box<dyn Effect>, String> {
        let wanted = self.of.as_deref().map(|name| elements.named(name)).transpose()?;
        let first = elements.triangles.len();
        let nets = elements.springs.iter().enumerate();
        let nets = nets.filter(|(number, _)| wanted.as_ref().is_none_or(|wanted| wanted.contains(&(first + number))));
        let links = nets.flat_map(|(_, springs)| springs.links().iter().copied());
        let links: Vec<_> = links.filter(|link| link.role == Role::Structural && link.rest > 0.0).collect();
        if links.is_empty() {
            return Err("it acts on structural springs of nets, and what it names has none of any length".to_owned());
        }
        if links.len() > MOST_CONDITIONS {
            return Err(format!("expected at most {MOST_CONDITIONS} rods, got {}; springs cost less", links.len()));
        }
        Ok(Box::new(Lengths { links, rate: self.recovery.get() }))
    }
}

/// Lengths that are kept.
struct Lengths {
    links: Vec<Link>,
    /// [1/s].
    rate: f64,
}

impl Effect for Lengths {
    fn name(&self) -> &'static str {
        "Rigid rods"
    }

    fn elements(&self, _: Motion<'_>) -> usize {
        self.links.len()
    }

    fn constraints(&self) -> Option<&dyn ConstraintTerm> {
        Some(self)
    }
}

impl ConstraintTerm for Lengths {
    /// With the unit vector u from b to a and the relative velocity w, `J v = u·w` and `J̇v = (w² - (u·w)²)/|x_a - x_b|`. Ends in one place have no
    /// direction; they get no constraint.
    fn add_rows(&self, motion: Motion<'_>, rows: &mut ConstraintRows) {
        let size = motion.dimension;
        for link in &self.links {
            let [a, b] = link.ends.map(|end| size * end as usize);
            let between = |values: &[f64], axis: usize| values[a + axis] - values[b + axis];
            let length = (0..size).map(|axis| between(motion.x, axis) * between(motion.x, axis)).sum::<f64>().sqrt();
            if length == 0.0 {
                continue;
            }
            let along = |axis: usize| between(motion.x, axis) / length;
            let rate: f64 = (0..size).map(|axis| along(axis) * between(motion.v, axis)).sum();
            let square: f64 = (0..size).map(|axis| between(motion.v, axis) * between(motion.v, axis)).sum();
            let recovery = [2.0 * self.rate, self.rate * self.rate];
            let bias = (square - rate * rate) / length + recovery[0] * rate + recovery[1] * (length - link.rest);
            let entries = (0..size).flat_map(|axis| [(a + axis, along(axis)), (b + axis, -along(axis))]);
            rows.push(entries, bias, recovery);
        }
    }
}

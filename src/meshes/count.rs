//! Whole numbers in level files and panels.

use crate::quantity::{OutOfRange, Quantity, Spec};
use serde::{Deserialize, Deserializer, de::Error as _};

/// A quantity whose value is a whole number.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(try_from = "f64", into = "u32")]
#[serde(bound = "Q: TryFrom<f64, Error = OutOfRange> + Quantity + Copy")]
pub struct Whole<Q>(Q);

/// Reason why a number is not a valid count.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CountError {
    /// It is outside the range.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// It has a fraction.
    #[error("{name} must be a whole number, got {value}")]
    Fraction {
        /// Name of the quantity in plain words.
        name: &'static str,
        /// The number.
        value: f64,
    },
}

impl<Q: Quantity> Whole<Q> {
    /// Constant count. It must be a whole number.
    pub(crate) const fn literal(quantity: Q) -> Self {
        Self(quantity)
    }

    /// The count.
    pub fn count(&self) -> u32 {
        self.0.get() as u32
    }
}

impl<Q: Quantity + TryFrom<f64, Error = OutOfRange>> TryFrom<f64> for Whole<Q> {
    type Error = CountError;
    fn try_from(value: f64) -> Result<Self, CountError> {
        let quantity = Q::try_from(value)?;
        let name = quantity.spec().name;
        if value.fract() == 0.0 { Ok(Self(quantity)) } else { Err(CountError::Fraction { name, value }) }
    }
}

impl<Q: Quantity> From<Whole<Q>> for u32 {
    fn from(whole: Whole<Q>) -> Self {
        whole.count()
    }
}

impl<Q: Quantity> Quantity for Whole<Q> {
    fn spec(&self) -> &'static Spec {
        self.0.spec()
    }

    fn get(&self) -> f64 {
        self.0.get()
    }

    /// Sets the nearest whole number, because a slider passes through fractions.
    fn set(&mut self, value: f64) -> Result<(), OutOfRange> {
        self.0.set(value.round())
    }
}

/// A whole number from 0 on: the number of a vertex, or a seed.
pub(crate) fn natural<'de, D: Deserializer<'de>>(file: D) -> Result<u32, D::Error> {
    let number = i64::deserialize(file)?;
    number.try_into().map_err(|_| {
        D::Error::custom(format!("expected a whole number, at least 0 and at most {}, got {number}", u32::MAX))
    })
}

//! Effect: beads on a wire.

use super::{
    ConstraintTerm, Effect, EffectParameters, MOST_CONDITIONS, Motion, Rules, Shape, air::unit, rods::ten_a_second,
};
use crate::{
    elements::{
        Elements,
        frame::{cross, dot, minus},
    },
    meshes::Pin,
    obstacles::Surfaces,
    quantity::{Coordinate, Point, Position, Quantity, Radius, RecoveryRate, SpacePoint},
    solvers::ConstraintRows,
};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Vertices slide without friction on a wire, a circle or a straight line, which constraint forces keep them on (see [`ConstraintRows`]).
/// What does not start on its wire goes there like a critically damped oscillator of the recovery rate, unless it is exactly on the axis of a
/// circle, from which there is no way.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wire {
    /// Name of the body, net or membrane; all, if it is not said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
    /// Which of its vertices.
    pub beads: Vec<Pin>,
    /// The wire.
    pub wire: WireShape,
    /// Rate at which beads return to it [1/s].
    #[serde(default = "ten_a_second")]
    pub recovery: RecoveryRate,
}

/// Shape of a wire.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum WireShape {
    /// Circle. In space it lies in the plane across its axis, of any length but zero, which is z if it is not said.
    Circle {
        /// Middle \[m\].
        centre: Position,
        /// Radius \[m\].
        radius: Radius,
        /// Axis in space.
        #[serde(default = "along_z", skip_serializing_if = "is_along_z")]
        axis: SpacePoint,
    },
    /// Straight line through a point along a direction, of any length but zero.
    Line {
        /// A point of it \[m\].
        through: Position,
        /// Its direction.
        along: Position,
    },
}

const fn along_z() -> SpacePoint {
    SpacePoint(Coordinate::literal(0.0), Coordinate::literal(0.0), Coordinate::literal(1.0))
}

fn is_along_z(axis: &SpacePoint) -> bool {
    *axis == along_z()
}

impl Default for Wire {
    fn default() -> Self {
        let middle = Coordinate::literal(0.5);
        let centre = Position::Plane(Point(middle, middle));
        Self {
            of: None,
            beads: vec![Pin::Vertex(0)],
            wire: WireShape::Circle { centre, radius: Radius::literal(0.3), axis: along_z() },
            recovery: ten_a_second(),
        }
    }
}

impl EffectParameters for Wire {
    fn title(&self) -> &'static str {
        "Beads on a wire"
    }

    fn about(&self) -> &'static str {
        "Vertices slide without friction on a circle or a straight line, kept there by constraint forces."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        let radius: Option<&mut dyn Quantity> = match &mut self.wire {
            WireShape::Circle { radius, .. } => Some(radius),
            WireShape::Line { .. } => None,
        };
        radius.into_iter().chain([&mut self.recovery as &mut dyn Quantity]).collect()
    }

    fn shapes(&self, _: f64, _: &Surfaces) -> Vec<Shape> {
        let (points, closed) = match self.wire {
            WireShape::Circle { centre, radius, axis } if centre.dimension() == 2 || axis.get() != [0.0; 3] => {
                let [one, other] = across(unit(axis.get()));
                let point = |number: u32| {
                    let angle = TAU * f64::from(number) / f64::from(SIDES);
                    let (along, aside) = (radius.get() * libm::cos(angle), radius.get() * libm::sin(angle));
                    std::array::from_fn(|axis| centre.get()[axis] + along * one[axis] + aside * other[axis])
                };
                ((0..SIDES).map(point).collect(), true)
            }
            WireShape::Circle { .. } => return Vec::new(),
            WireShape::Line { through, along } => {
                let direction = unit(along.get());
                let end = |by: f64| std::array::from_fn(|axis| through.get()[axis] + by * direction[axis]);
                (vec![end(-LONG), end(LONG)], false)
            }
        };
        vec![Shape::Wire { points, closed }]
    }

    fn rules_mut(&mut self) -> Option<Rules<'_>> {
        Some(Rules { of: &mut self.of, pins: &mut self.beads, are_of_edges: false })
    }

    fn build(&self, elements: &Elements) -> Result<Box<dyn Effect>, String> {
        let beads = elements.pinned(self.of.as_deref(), &self.beads)?;
        if beads.is_empty() {
            return Err("its list of beads names no vertex".to_owned());
        }
        let dimension = elements.dimension();
        let (place, direction) = match self.wire {
            WireShape::Circle { centre, axis, .. } => (centre, axis.get()),
            WireShape::Line { through, along } if through.dimension() == along.dimension() => (through, along.get()),
            WireShape::Line { .. } => {
                return Err("the point and the direction of its line have different dimensions".to_owned());
            }
        };
        if place.dimension() != dimension {
            return Err(format!("its wire needs {dimension} coordinates, got {}", place.dimension()));
        }
        if dot(direction, direction) == 0.0 {
            return Err("the direction of its wire must not be zero".to_owned());
        }
        let (place, direction) = (place.get(), unit(direction));
        if dimension == 2 && matches!(self.wire, WireShape::Circle { .. }) && direction != along_z().get() {
            return Err("a circle in the plane has the axis z".to_owned());
        }
        if (dimension - 1) * beads.len() > MOST_CONDITIONS {
            return Err(format!(
                "expected at most {MOST_CONDITIONS} conditions, got {}",
                (dimension - 1) * beads.len()
            ));
        }
        // In the plane the second condition, along z, is left out.
        let kept = match self.wire {
            WireShape::Circle { radius, .. } => {
                vec![
                    Kept::Radius { centre: place, axis: direction, radius: radius.get() },
                    Kept::plane(direction, place),
                ]
            }
            WireShape::Line { .. } => across(direction).map(|normal| Kept::plane(normal, place)).to_vec(),
        };
        let each = |bead: u32| kept[..dimension - 1].iter().map(move |kept| Held { bead, kept: *kept });
        let held = beads.into_iter().flat_map(each).collect();
        Ok(Box::new(Beads { held, rate: self.recovery.get() }))
    }
}

/// Sides of a circle, and half of the length of a line \[m\], as they are drawn.
const SIDES: u32 = 96;
const LONG: f64 = 10.0;

/// Two unit vectors across a unit vector and each other; the second one is z where that is across.
fn across(direction: [f64; 3]) -> [[f64; 3]; 2] {
    let aside = if direction[2].abs() < 0.9 { [0.0, 0.0, 1.0] } else { [1.0, 0.0, 0.0] };
    let one = unit(cross(direction, aside));
    [one, unit(cross(one, direction))]
}

/// A bead and one condition on its place.
struct Held {
    bead: u32,
    kept: Kept,
}

#[derive(Clone, Copy)]
enum Kept {
    /// The distance from an axis \[m\].
    Radius { centre: [f64; 3], axis: [f64; 3], radius: f64 },
    /// The place along a normal \[m\].
    Plane { normal: [f64; 3], place: f64 },
}

impl Kept {
    /// The plane across a normal through a point.
    fn plane(normal: [f64; 3], through: [f64; 3]) -> Self {
        Self::Plane { normal, place: dot(normal, through) }
    }
}

/// The built effect.
struct Beads {
    held: Vec<Held>,
    /// [1/s].
    rate: f64,
}

impl Effect for Beads {
    fn name(&self) -> &'static str {
        "Beads on a wire"
    }

    fn elements(&self, _: Motion<'_>) -> usize {
        self.held.len()
    }

    fn constraints(&self) -> Option<&dyn ConstraintTerm> {
        Some(self)
    }
}

impl ConstraintTerm for Beads {
    /// As for a rod; the distance from the axis is the length of the part of `x - centre` across it.
    fn add_rows(&self, motion: Motion<'_>, rows: &mut ConstraintRows) {
        let size = motion.dimension;
        let recovery = [2.0 * self.rate, self.rate * self.rate];
        for Held { bead, kept } in &self.held {
            let at = size * *bead as usize;
            let of = |values: &[f64]| std::array::from_fn(|axis| if axis < size { values[at + axis] } else { 0.0 });
            let (x, v): ([f64; 3], [f64; 3]) = (of(motion.x), of(motion.v));
            let (normal, value, curvature) = match *kept {
                Kept::Plane { normal, place } => (normal, dot(normal, x) - place, 0.0),
                Kept::Radius { centre, axis, radius } => {
                    let across = |vector: [f64; 3]| -> [f64; 3] {
                        let along = dot(vector, axis);
                        std::array::from_fn(|number| vector[number] - along * axis[number])
                    };
                    let (out, moving) = (across(minus(x, centre)), across(v));
                    let length = dot(out, out).sqrt();
                    if length == 0.0 {
                        continue;
                    }
                    let normal = out.map(|along| along / length);
                    let rate = dot(normal, moving);
                    (normal, length - radius, (dot(moving, moving) - rate * rate) / length)
                }
            };
            let bias = curvature + recovery[0] * dot(normal, v) + recovery[1] * value;
            rows.push((0..size).map(|axis| (at + axis, normal[axis])), bias, recovery);
        }
    }
}

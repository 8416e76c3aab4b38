//! Displacement bounds: steps far from all walls skip contact, and a bound on the displacement replaces checks of all
//! vertices.

use super::{BATCH, Simulation};
use crate::{effects::Bounds, integrators::Class, obstacles::Inside, state::State};

/// Enlargement of the clear box in powers of two of the size of the bodies: greatest and least exponent.
const POWERS: (i32, i32) = (4, -8);

impl Simulation {
    /// Finds a box around all vertices in which no constraint acts, if it is large enough for some steps. Constraints
    /// are skipped until a vertex leaves the box: as it is convex, the displacements of all vertices lie in it as well,
    /// and the check of every step finds whether they do. So a distant wall costs nothing.
    ///
    /// Only for explicit schemes, which apply constraints once at the end of a step: a step that leaves the box is
    /// repeated in full.
    pub(super) fn find_clear_box(&mut self) {
        let plan = &self.scratch.plan;
        if self.scratch.clear_box.is_some() || plan.constraints.is_empty() || self.guard.level() > 0 {
            return;
        }
        let explicit = self.scene.integrator.kind().class() == Class::Explicit;
        let auto = plan.constraints.iter().all(|number| self.scratch.costs[*number].auto);
        if !explicit || !auto || !self.state.is_finite() {
            return;
        }
        let clear = |ways: Bounds| {
            ways.as_flattened().iter().all(|corner| corner.abs() <= State::LIMIT)
                && plan.constraints.iter().all(|number| self.scene.effects[*number].is_clear(ways))
        };
        let (bounds, fastest) = (extents(&self.state.x), extents(&self.state.v));
        let speed = fastest.as_flattened().iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let mut clear_box = grown(bounds, [true; 4], 2.0 * BATCH as f64 * self.scene.step * speed);
        if !clear(clear_box) {
            return;
        }
        let size = (0..2).map(|axis| bounds[1][axis] - bounds[0][axis]).fold(f64::MIN_POSITIVE, f64::max);
        let sides = [[true; 4], [true, false, false, false], [false, true, false, false], [false, false, true, false]];
        for sides in sides.into_iter().chain([[false, false, false, true]]) {
            for power in (POWERS.1..=POWERS.0).rev() {
                let larger = grown(clear_box, sides, libm::ldexp(size, power));
                if clear(larger) {
                    clear_box = larger;
                }
            }
        }
        (self.scratch.clear_box, self.scratch.displacement_bound, self.scratch.inside) =
            (Some(clear_box), -1.0, Inside::Nothing);
    }

    /// Whether the last step left finite numbers. A step that was taken without constraints, but left the clear box, is
    /// repeated with them.
    ///
    /// Where the step gives the kinetic energy, a bound replaces the check of all vertices: none moves farther than
    /// with all of that energy.
    pub(super) fn validates(&mut self) -> bool {
        if self.scratch.displacement_bound >= 0.0 {
            return true;
        }
        if self.state.is_within(self.scratch.clear_box.unwrap_or(WORLD)) {
            if self.scratch.kinetic.is_some() {
                self.update_displacement_bound();
            }
            return true;
        }
        if self.scratch.clear_box.take().is_none() {
            return false;
        }
        self.go_back_to(self.state.steps - 1);
        self.step();
        self.state.is_finite()
    }

    /// Whether a vertex was inside a wall in the last step.
    pub const fn inside(&self) -> Inside {
        self.scratch.inside
    }

    /// Whether the last step pushed a vertex out of a wall.
    pub fn pushes_out(&self) -> bool {
        self.inside() == Inside::ComesOut
    }

    /// Number of vertices deep inside walls or outside the domain.
    pub fn count_inside(&self) -> usize {
        self.scene.count_inside(&self.state)
    }

    /// Computes the displacement bound from the positions.
    pub(super) fn update_displacement_bound(&mut self) {
        let inner = extents(&self.state.x);
        let outer = self.scratch.clear_box.unwrap_or_else(|| surroundings(inner));
        self.scratch.displacement_bound = displacement_bound(inner, outer);
    }
}

/// Box of valid positions.
const WORLD: Bounds = [[-State::LIMIT; 2], [State::LIMIT; 2]];

/// A box much larger than the inner one, so that nothing leaves it soon, whose corners are still exact to a small
/// fraction of the inner one.
fn surroundings(inner: Bounds) -> Bounds {
    let size = (0..2).map(|axis| inner[1][axis] - inner[0][axis]).fold(0.0, f64::max);
    let outer = grown(inner, [true; 4], libm::ldexp(size, 20) + libm::ldexp(greatest(inner), -16));
    outer.map(|corner| corner.map(|along| along.clamp(-State::LIMIT, State::LIMIT)))
}

/// Greatest coordinate magnitude of the corners.
fn greatest(bounds: Bounds) -> f64 {
    bounds.as_flattened().iter().fold(0.0, |most, along| most.max(along.abs()))
}

/// Least distance that a point of the inner box can move without leaving the outer one, less a fraction for round-off
/// in many steps.
fn displacement_bound(inner: Bounds, outer: Bounds) -> f64 {
    let sides = [0, 1].map(|axis| (inner[0][axis] - outer[0][axis]).min(outer[1][axis] - inner[1][axis]));
    sides[0].min(sides[1]) - 1e-6 * greatest(outer)
}

/// Bounding box of flat points.
fn extents(values: &[f64]) -> Bounds {
    let mut bounds = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    for pair in values.as_chunks::<2>().0 {
        for axis in 0..2 {
            bounds[0][axis] = if pair[axis] < bounds[0][axis] { pair[axis] } else { bounds[0][axis] };
            bounds[1][axis] = if pair[axis] > bounds[1][axis] { pair[axis] } else { bounds[1][axis] };
        }
    }
    bounds
}

/// The box with some of its sides (left, bottom, right, top) moved outwards by a length.
fn grown([least, greatest]: Bounds, [left, bottom, right, top]: [bool; 4], by: f64) -> Bounds {
    let moved = |side: bool| if side { by } else { 0.0 };
    [[least[0] - moved(left), least[1] - moved(bottom)], [greatest[0] + moved(right), greatest[1] + moved(top)]]
}

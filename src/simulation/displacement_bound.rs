//! Displacement bounds: steps far from all walls skip contact, and a bound on the displacement replaces checks of all
//! vertices.

use super::{BATCH, Simulation};
use crate::{effects::Bounds, integrators::Class, state::State};

impl Simulation {
    /// Finds a box around all vertices in which nothing touches an obstacle, if it is large enough for some steps. Obstacles
    /// are skipped until a vertex leaves the box: as it is convex, the displacements of all vertices lie in it as well,
    /// and the check of every step finds whether they do. So a distant wall costs nothing.
    ///
    /// Only for explicit schemes: a step that leaves the box is
    /// repeated in full.
    pub(super) fn find_clear_box(&mut self) {
        let plan = &self.scratch.plan;
        if self.scratch.clear_box.is_some() || plan.obstacles.is_empty() || self.guard.level() > 0 {
            return;
        }
        if self.scene.dimension != 2 {
            return;
        }
        let explicit = self.scene.integrator.kind().class() == Class::Explicit;
        let auto = plan.obstacles.iter().all(|number| self.scratch.costs[*number].auto);
        if !explicit || !auto || !self.state.is_finite() {
            return;
        }
        let clear = |bounds: Bounds| {
            bounds.farthest() <= State::LIMIT
                && plan.obstacles.iter().all(|number| self.scene.effects[*number].is_clear(bounds))
        };
        let bounds = Bounds::of(&self.state.x);
        let speed = Bounds::<2>::of(&self.state.v).farthest();
        let clear_box = bounds.grown(2.0 * BATCH as f64 * self.scene.step * speed);
        if !clear(clear_box) {
            return;
        }
        let clear_box = clear_box.enlarged(bounds, clear);
        (self.scratch.clear_box, self.scratch.displacement_bound) = (Some(clear_box), -1.0);
    }

    /// Whether the last step left finite numbers. A step that was taken without obstacles, but left the clear box, is
    /// repeated with them.
    ///
    /// Where the step gives the kinetic energy, a bound replaces the check of all vertices: none moves farther than
    /// with all of that energy.
    pub(super) fn validates(&mut self) -> bool {
        if self.scratch.displacement_bound >= 0.0 {
            return true;
        }
        if self.state.is_within(self.scratch.clear_box) {
            if self.scratch.kinetic.is_some() {
                self.update_displacement_bound();
            }
            return true;
        }
        if self.scratch.clear_box.take().is_none() {
            return false;
        }
        let guard = self.guard.clone();
        self.go_back_to(self.state.steps - 1);
        self.step();
        self.guard.keep_least(&guard);
        self.state.is_finite()
    }

    /// Whether the last step pushed a vertex out of a wall or another body.
    pub const fn pushes_out(&self) -> bool {
        self.scratch.pushes_out
    }

    /// Number of vertices inside walls, other bodies or outside the domain.
    pub fn count_inside(&self) -> usize {
        self.scene.count_inside(&self.state)
    }

    /// Computes the displacement bound from the positions.
    pub(super) fn update_displacement_bound(&mut self) {
        let inner = Bounds::of(&self.state.x);
        let outer = self.scratch.clear_box.unwrap_or_else(|| inner.surroundings(State::LIMIT));
        self.scratch.displacement_bound = inner.displacement_bound(outer);
    }
}

//! Response of a vertex to a contact, with the friction and restitution of the surface.

use super::{Contact, DepenetrationStep, Inside, Obstacle, Penetration, Start};

/// Most projections of a vertex at the end of a step.
const NOOK: usize = 3;

/// Resolves contact of one vertex, with its contact at the start of the step: first within the margin, then at the
/// first touch within the step, last at the end point. A deep vertex is pushed out, and vertices of the same body may
/// enter from behind. Returns whether anything changed.
pub(super) fn resolve_contact<O: Obstacle + ?Sized>(
    obstacle: &O,
    start: &Start<'_>,
    (vertex, begun): (usize, Option<Contact>),
    x: &mut [f64],
    v: &mut [f64],
) -> bool {
    let from = [start.x[2 * vertex], start.x[2 * vertex + 1]];
    let mut moved = Moved::new(start, vertex, x, v);
    let before = [start.v[2 * vertex], start.v[2 * vertex + 1]];
    let step = begun.and_then(|contact| {
        start
            .depenetration_step(vertex, contact.distance, contact.along(before), obstacle.offset())
            .map(|step| (contact, step))
    });
    match step {
        Some((contact, step)) => moved.push_out(step, contact.normal, from),
        None => moved.stop(obstacle, begun, from),
    }
    moved.write(x, v)
}

/// Pushes out one vertex that begins deep inside, with the normal of the nearest surface; returns whether anything
/// changed.
pub fn push_out_vertex(
    start: &Start<'_>,
    (vertex, step): (usize, DepenetrationStep),
    nearest: [f64; 2],
    x: &mut [f64],
    v: &mut [f64],
) -> bool {
    let mut moved = Moved::new(start, vertex, x, v);
    moved.push_out(step, nearest, [start.x[2 * vertex], start.x[2 * vertex + 1]]);
    moved.write(x, v)
}

/// A vertex during contact resolution.
struct Moved<'a> {
    start: &'a Start<'a>,
    vertex: usize,
    surface: Surface,
    to: [f64; 2],
    v: [f64; 2],
}

impl<'a> Moved<'a> {
    fn new(start: &'a Start<'a>, vertex: usize, x: &[f64], v: &[f64]) -> Self {
        Self { start, vertex, surface: start.surface_at(vertex), to: [x[0], x[1]], v: [v[0], v[1]] }
    }

    /// Writes position and velocity back; returns whether anything changed.
    fn write(self, x: &mut [f64], v: &mut [f64]) -> bool {
        let touched = self.to != [x[0], x[1]] || self.v != [v[0], v[1]];
        x.copy_from_slice(&self.to);
        v.copy_from_slice(&self.v);
        touched
    }

    /// Whether a surface with this normal stops the vertex.
    fn is_stopped_by(&self, normal: [f64; 2]) -> bool {
        let lets_in = || self.start.penetration(self.vertex).is_some_and(|penetration| penetration.lets_in(normal));
        self.start.faces(self.vertex, normal) && !lets_in()
    }

    /// Applies a depenetration step, along the direction of its body or along the surface normal.
    fn push_out(&mut self, step: DepenetrationStep, nearest: [f64; 2], from: [f64; 2]) {
        let penetration = self.start.penetration(self.vertex);
        let normal = penetration.map_or(nearest, |penetration| penetration.direction);
        if normal != nearest && self.is_stopped_by(nearest) {
            self.press(nearest, from);
        }
        if penetration.is_some_and(Penetration::stays) {
            self.start.record_inside(Inside::Stays);
            return;
        }
        let movable = self.start.movable(self.vertex, normal);
        let Some([nx, ny]) = movable.filter(|_| self.start.faces(self.vertex, normal)) else { return };
        // A vertex on rollers moves no faster along them than the body moves in that direction.
        let share = normal[0] * nx + normal[1] * ny;
        let kept = self.start.lift(self.vertex, [nx, ny], share * step.speed, &mut self.v);
        let displacement = [self.to[0] - from[0], self.to[1] - from[1]];
        let across = displacement[0] * nx + displacement[1] * ny;
        let short = (share * step.length - across).max(0.0);
        self.to = [self.to[0] + short * nx, self.to[1] + short * ny];
        if let Some(lost) = kept.map(|kept| 1.0 - kept) {
            self.to[0] -= lost * (displacement[0] - across * nx);
            self.to[1] -= lost * (displacement[1] - across * ny);
        }
    }

    /// Resolves contact within the margin, within the step and at the end point.
    fn stop<O: Obstacle + ?Sized>(&mut self, obstacle: &O, begun: Option<Contact>, from: [f64; 2]) {
        if let Some(contact) = begun.filter(|contact| self.is_stopped_by(contact.normal)) {
            self.press(contact.normal, from);
        }
        let clearance = begun.map_or(obstacle.margin(), |contact| contact.distance) - obstacle.offset();
        let displacement = [self.to[0] - from[0], self.to[1] - from[1]];
        if clearance <= 0.0
            || displacement[0] * displacement[0] + displacement[1] * displacement[1] > clearance * clearance
        {
            if begun.is_none_or(|contact| contact.distance >= 0.0) {
                self.travel(obstacle, from);
            }
            self.project_out(obstacle);
        }
    }

    /// Removes inward velocity and the inward part of the displacement from a point.
    fn press(&mut self, normal: [f64; 2], from: [f64; 2]) {
        let Some([nx, ny]) = self.start.movable(self.vertex, normal) else { return };
        let before = [self.start.v[2 * self.vertex], self.start.v[2 * self.vertex + 1]];
        let kept = self.surface.impact_response([nx, ny], before, &mut self.v);
        let displacement = [self.to[0] - from[0], self.to[1] - from[1]];
        let across = displacement[0] * nx + displacement[1] * ny;
        let inwards = across.min(0.0);
        match kept {
            Some(kept) if kept < 1.0 => {
                let along = [displacement[0] - across * nx, displacement[1] - across * ny];
                let outwards = across - inwards;
                self.to = [from[0] + kept * along[0] + outwards * nx, from[1] + kept * along[1] + outwards * ny];
            }
            _ => self.to = [self.to[0] - inwards * nx, self.to[1] - inwards * ny],
        }
    }

    /// Stops at the first touch; the rest of the displacement continues along the surface until the next touch.
    fn travel<O: Obstacle + ?Sized>(&mut self, obstacle: &O, mut from: [f64; 2]) {
        for may_slide in [true, false] {
            let displacement = [self.to[0] - from[0], self.to[1] - from[1]];
            let Some((share, normal)) = obstacle.cast(from, displacement) else { return };
            if !self.is_stopped_by(normal) {
                return;
            }
            from = [from[0] + share * displacement[0], from[1] + share * displacement[1]];
            self.press(normal, from);
            if !may_slide {
                self.to = from;
            }
        }
    }

    /// Projects an end point inside the obstacle on the surface, repeatedly in a concave corner.
    fn project_out<O: Obstacle + ?Sized>(&mut self, obstacle: &O) {
        for _ in 0..NOOK {
            let Some(Contact { distance, normal }) = obstacle.contact(self.to) else { return };
            if distance >= 0.5 * obstacle.offset() || !self.is_stopped_by(normal) {
                return;
            }
            let Some([nx, ny]) = self.start.movable(self.vertex, normal) else { return };
            let depth = obstacle.offset() - distance;
            self.to = [self.to[0] + depth * nx, self.to[1] + depth * ny];
            self.press(normal, self.to);
        }
    }
}

/// Restitution and friction of contacts; zero unless effects set them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surface {
    /// e: coefficient of restitution, from 0 to 1.
    pub restitution: f64,
    /// mu: coefficient of Coulomb friction.
    pub friction: f64,
}

impl Surface {
    /// Velocity after an impact on a surface with a unit normal: Newton's law of impact along the normal, `v'.n = -e
    /// v.n`, and Coulomb's law along the tangent, `|m dv_t| <= mu m dv_n`. Returns the fraction of the tangential
    /// velocity that is left, or `None` if the vertex does not move inwards.
    ///
    /// Restitution applies to the velocity at the start of the step, if that is smaller: velocity that forces add
    /// within the step is not returned. So resting contact stays at rest, and no impact adds energy.
    #[inline]
    pub fn impact_response(self, [nx, ny]: [f64; 2], before: [f64; 2], v: &mut [f64; 2]) -> Option<f64> {
        let across = v[0] * nx + v[1] * ny;
        if across >= 0.0 || across.is_nan() {
            return None;
        }
        let push = -across - self.restitution * (before[0] * nx + before[1] * ny).clamp(across, 0.0);
        let kept = if self.friction == 0.0 {
            1.0
        } else {
            let (tx, ty) = (v[0] - across * nx, v[1] - across * ny);
            let sliding = (tx * tx + ty * ty).sqrt();
            let kept = if sliding > self.friction * push { 1.0 - self.friction * push / sliding } else { 0.0 };
            *v = [across * nx + kept * tx, across * ny + kept * ty];
            kept
        };
        v[0] += push * nx;
        v[1] += push * ny;
        Some(kept)
    }
}

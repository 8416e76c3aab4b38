//! Effect: contact with the domain boundary.

use super::{Bounds, Effect, EffectParameters, Motion, Shape};
use crate::{
    contact::{ContactTerm, ObstacleContact, PlacedObstacle},
    elements::Elements,
    obstacles::{
        Contact, ContactQuery, Depenetration, Obstacle, STEEP, Start, SweptMotion, depenetration_of, push_out_vertex,
    },
    quantity::{Coordinate, Point, Quantity},
};
use serde::{Deserialize, Serialize};

/// The four edges of the world: a vertex that gets beyond one is put back on it and loses its velocity outwards.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Boundary {
    /// Corner with the least coordinates \[m\].
    pub least: Point,
    /// Corner with the greatest coordinates \[m\].
    pub greatest: Point,
}

impl Default for Boundary {
    fn default() -> Self {
        let (zero, one) = (Coordinate::literal(0.0), Coordinate::literal(1.0));
        Self { least: Point(zero, zero), greatest: Point(one, one) }
    }
}

impl EffectParameters for Boundary {
    fn title(&self) -> &'static str {
        "Domain boundary"
    }

    fn about(&self) -> &'static str {
        "A rectangle that vertices cannot leave: a vertex outside is put back on the nearest side, and its outward velocity is removed. What begins outside comes in slowly."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        Vec::new()
    }

    fn shapes(&self, _: f64) -> Vec<Shape> {
        vec![Shape::Edges(self.least.get(), self.greatest.get())]
    }

    fn build(&self, elements: &Elements) -> Result<Box<dyn Effect>, String> {
        let (least, greatest) = (self.least.get(), self.greatest.get());
        if least[0] < greatest[0] && least[1] < greatest[1] {
            let edge = |axis: usize, inwards: f64| Edge {
                axis,
                at: if inwards > 0.0 { least } else { greatest }[axis],
                inwards,
            };
            let all = [edge(0, 1.0), edge(0, -1.0), edge(1, 1.0), edge(1, -1.0)];
            let contact = elements.skin.map(|skin| {
                let place = |edge: &Edge| PlacedObstacle { obstacle: Box::new(edge.clone()), motions: Vec::new() };
                ObstacleContact::new(skin, &elements.skinned, all.iter().map(place).collect())
            });
            Ok(Box::new(Edges { least, greatest, all, contact }))
        } else {
            Err(format!(
                "the lower left corner {least:?} of the domain must lie below and left of its upper right corner {greatest:?}"
            ))
        }
    }
}

/// One edge of the domain.
#[derive(Clone)]
struct Edge {
    axis: usize,
    at: f64,
    /// 1 if the domain lies on the side of greater coordinates, otherwise -1.
    inwards: f64,
}

impl Edge {
    fn normal(&self) -> [f64; 2] {
        let mut normal = [0.0; 2];
        normal[self.axis] = self.inwards;
        normal
    }

    /// Distance of a point from the edge \[m\]; negative beyond it.
    fn signed_distance(&self, point: [f64; 2]) -> f64 {
        self.inwards * (point[self.axis] - self.at)
    }
}

/// An edge as an obstacle, for depenetration.
impl Obstacle for Edge {
    fn distance(&self, point: [f64; 2], reach: f64) -> Option<Contact> {
        let distance = self.signed_distance(point);
        (distance < reach).then(|| Contact { distance, normal: self.normal() })
    }

    fn is_near(&self, least: [f64; 2], greatest: [f64; 2]) -> bool {
        self.signed_distance(least).min(self.signed_distance(greatest)) < 0.0
    }

    fn may_touch(&self, least: [f64; 2], greatest: [f64; 2]) -> bool {
        self.is_near(least, greatest)
    }

    fn margin(&self) -> f64 {
        0.0
    }

    fn depenetration_distance(&self, point: [f64; 2], direction: [f64; 2]) -> Option<f64> {
        let depth = -self.signed_distance(point);
        let along = self.inwards * direction[self.axis];
        (depth > 0.0).then(|| if along > STEEP { depth / along } else { f64::INFINITY })
    }

    fn each_direction(&self, act: &mut dyn FnMut([f64; 2])) {
        act(self.normal());
    }
}

struct Edges {
    least: [f64; 2],
    greatest: [f64; 2],
    /// Two edges for each axis, in the order of the axes.
    all: [Edge; 4],
    contact: Option<ObstacleContact>,
}

impl Effect for Edges {
    fn name(&self) -> &'static str {
        "Domain boundary"
    }

    fn dimension(&self) -> Option<usize> {
        Some(2)
    }

    fn elements(&self, motion: Motion<'_>) -> usize {
        motion.x.len() / 2
    }

    fn set_number(&mut self, number: usize) {
        self.contact.iter_mut().for_each(|contact| contact.set_number(number));
    }

    fn contact(&self) -> Option<&dyn ContactTerm> {
        self.contact.as_ref().map(|contact| contact as &dyn ContactTerm)
    }

    fn is_clear(&self, Bounds([least, greatest]): Bounds) -> bool {
        (0..2).all(|axis| least[axis] > self.least[axis] && greatest[axis] < self.greatest[axis])
    }

    fn constrains(&self) -> bool {
        true
    }

    fn count_inside(&self, x: &[f64], _: f64, depenetrations: &[Depenetration]) -> usize {
        let is_inside = |(vertex, point): &(usize, &[f64; 2])| {
            let shallow = depenetration_of(depenetrations, *vertex).map_or(0.0, |depenetration| depenetration.shallow);
            let beyond = |axis: usize| (self.least[axis] - point[axis]).max(point[axis] - self.greatest[axis]);
            beyond(0).max(beyond(1)) > shallow
        };
        x.as_chunks().0.iter().enumerate().filter(is_inside).count()
    }

    fn contact_queries<'a>(
        &'a self,
        number: usize,
        _: [f64; 2],
        swept_bounds: Bounds,
        act: &mut dyn FnMut(ContactQuery<'a>),
    ) {
        let edges = self.all.iter().enumerate();
        let contact_query = |(edge, obstacle): (usize, &'a Edge)| {
            ContactQuery::new(([number, edge], obstacle), SweptMotion::STILL, swept_bounds.0)
        };
        edges.map(contact_query).filter(ContactQuery::is_near).for_each(act);
    }

    fn constrain(&self, start: &Start<'_>, x: &mut [f64], v: &mut [f64]) -> usize {
        let ([left, bottom], [right, top]) = (self.least, self.greatest);
        let beyond = |p: &[f64]| p[0] <= left || p[0] >= right || p[1] <= bottom || p[1] >= top;
        if !x.chunks_exact(2).any(beyond) {
            return 0;
        }
        let mut touched = 0;
        for (vertex, (x, v)) in x.chunks_exact_mut(2).zip(v.chunks_exact_mut(2)).enumerate() {
            for axis in (0..2).filter(|axis| start.inverse_mass[2 * vertex + axis] != 0.0) {
                touched += usize::from(self.put_back(start, (vertex, axis), x, v));
            }
        }
        touched
    }
}

impl Edges {
    /// Projects one vertex on the edges across one axis; returns whether anything changed.
    #[inline]
    fn put_back(&self, start: &Start<'_>, (vertex, axis): (usize, usize), x: &mut [f64], v: &mut [f64]) -> bool {
        let side = if x[axis] < self.least[axis] || (x[axis] == self.least[axis] && v[axis] < 0.0) {
            2 * axis
        } else if x[axis] > self.greatest[axis] || (x[axis] == self.greatest[axis] && v[axis] > 0.0) {
            2 * axis + 1
        } else {
            return false;
        };
        let (edge, normal) = (&self.all[side], self.all[side].normal());
        if !start.faces(vertex, normal) {
            return false;
        }
        let from = [start.x[2 * vertex], start.x[2 * vertex + 1]];
        let before = [start.v[2 * vertex], start.v[2 * vertex + 1]];
        let seen =
            ContactQuery::new(([start.effect, side], edge), SweptMotion::STILL, [from, from]).for_obstacle(start);
        if let Some(step) =
            seen.depenetration_step(vertex, edge.signed_distance(from), edge.inwards * before[axis], 0.0)
        {
            return push_out_vertex(&seen, (vertex, step), normal, x, v);
        }
        let mut after = [v[0], v[1]];
        let kept = start.surface_at(vertex).impact_response(normal, before, &mut after);
        let changed = after != [v[0], v[1]] || x[axis] != edge.at;
        v.copy_from_slice(&after);
        x[axis] = edge.at;
        if let Some(kept) = kept.filter(|kept| *kept < 1.0) {
            x[1 - axis] = from[1 - axis] + kept * (x[1 - axis] - from[1 - axis]);
        }
        changed
    }
}

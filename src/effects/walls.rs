//! Effect: contact with obstacles.

use super::{Bounds, Effect, EffectParameters, Group, Motion, Shape};
use crate::{
    contact::{ContactTerm, ObstacleContact, PlacedObstacle},
    elements::Elements,
    obstacles::{
        Ball, ContactQuery, Depenetration, ObstacleKind, Rigid, Start, SweptMotion, depenetration_of, free_region,
        placed,
    },
    quantity::{Quantity, Reach},
};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Obstacles that vertices bump into: planes that make a room, and solids inside it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Walls {
    /// The obstacles.
    pub obstacles: Vec<ObstacleKind>,
}

impl Default for Walls {
    fn default() -> Self {
        Self { obstacles: vec![ObstacleKind::Ball(Ball::default())] }
    }
}

impl EffectParameters for Walls {
    fn title(&self) -> &'static str {
        "Walls"
    }

    fn about(&self) -> &'static str {
        "A vertex within ε of a wall that moves inwards: v := v − min(0, v·n) n, relative to the wall if that moves. At any speed it stops where it first touches, and so does an edge at a corner. What begins inside comes out slowly."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        self.groups().into_iter().flat_map(|group| group.numbers).collect()
    }

    fn groups(&mut self) -> Vec<Group<'_>> {
        let names: Vec<_> = self.obstacles.iter().map(ObstacleKind::title).collect();
        let mut solids = 0..;
        let groups = self.obstacles.iter_mut().enumerate().map(|(number, kind)| {
            let same = |upto: usize| names[..upto].iter().filter(|name| **name == names[number]).count();
            let title = if same(names.len()) > 1 {
                format!("{} {}", names[number], same(number) + 1)
            } else {
                names[number].clone()
            };
            let solid = if kind.kind().outline().is_empty() { None } else { solids.next() };
            let numbers =
                if matches!(kind, ObstacleKind::Plane(_)) { Vec::new() } else { kind.kind_mut().parameters() };
            Group { title: Some(title), solid, numbers }
        });
        groups.filter(|group| !group.numbers.is_empty()).collect()
    }

    fn shapes(&self, time: f64) -> Vec<Shape> {
        let (mut planes, mut shapes) = (Vec::new(), Vec::new());
        for kind in self.obstacles.iter().map(ObstacleKind::kind) {
            let at = placed(&kind.motions(), time);
            let moves = at != Rigid::STILL;
            planes.extend(kind.plane().map(|plane| if moves { plane.moved(&at) } else { plane.clone() }));
            let mut outline = kind.outline();
            if moves {
                outline = outline.into_iter().map(|point| at.point(point)).collect();
            }
            if !outline.is_empty() {
                shapes.push(Shape::Solid(outline));
            }
        }
        if !planes.is_empty() {
            shapes.insert(0, Shape::Room(free_region(planes.iter(), [0.0, 0.0], [1.0, 1.0])));
        }
        shapes
    }

    fn ineffective(&self) -> Option<&'static str> {
        self.obstacles.is_empty().then_some("there are no obstacles in it")
    }

    fn notes(&self) -> Vec<String> {
        let note = |(number, kind): (usize, &ObstacleKind)| {
            kind.kind().notes().map(|note| format!("obstacle {number} ({}): {note}", kind.name()))
        };
        self.obstacles.iter().enumerate().filter_map(note).collect()
    }

    fn build(&self, elements: &Elements) -> Result<Box<dyn Effect>, String> {
        let build = |kinds: &[ObstacleKind]| {
            let build = |(number, kind): (usize, &ObstacleKind)| {
                let obstacle =
                    kind.kind().build().map_err(|why| format!("obstacle {number} ({}): {why}", kind.name()))?;
                Ok::<_, String>(PlacedObstacle { obstacle, motions: kind.kind().motions() })
            };
            kinds.iter().enumerate().map(build).collect::<Result<Vec<_>, _>>()
        };
        let (mut obstacles, mut contact) = (build(&self.obstacles)?, None);
        if let Some((skin, friction)) = elements.skin {
            // A vertex stops only where its skin is used up.
            let mut kinds = self.obstacles.clone();
            for (kind, placed) in kinds.iter_mut().zip(&obstacles) {
                let distance = elements.skinned.least_distance(skin, placed.obstacle.margin());
                kind.kind_mut().set_margin(Reach::new(distance).map_err(|error| error.to_string())?);
            }
            let stops = build(&kinds)?;
            contact = Some(ObstacleContact::new((skin, friction), &elements.skinned, obstacles));
            obstacles = stops;
        }
        Ok(Box::new(Contacts { obstacles, boundary: Arc::clone(&elements.boundary), contact }))
    }
}

impl PlacedObstacle {
    /// Its motion in a step.
    fn swept_motion(&self, [start, end]: [f64; 2]) -> SweptMotion {
        if self.motions.is_empty() {
            return SweptMotion::STILL;
        }
        SweptMotion::new(placed(&self.motions, start), placed(&self.motions, end))
    }
}

struct Contacts {
    obstacles: Vec<PlacedObstacle>,
    /// Edges of the bodies' boundaries, with the body on their left.
    boundary: Arc<Vec<[u32; 2]>>,
    contact: Option<ObstacleContact>,
}

/// Most passes over stopped edges, because stopping one may make others touch; after them an edge stays at its start.
const ROUNDS: usize = 8;

impl Contacts {
    /// Queries for the obstacles that are near a box around the swept vertices.
    fn near(&self, effect: usize, time: [f64; 2], bounds: Bounds) -> impl Iterator<Item = ContactQuery<'_>> + Clone {
        let walls = self.obstacles.iter().enumerate();
        let contact_queries = walls.map(move |(number, wall)| {
            ContactQuery::new(([effect, number], wall.obstacle.as_ref()), wall.swept_motion(time), bounds.0)
        });
        contact_queries.filter(ContactQuery::is_near)
    }

    /// Stops edges at corners and, after that, vertices at obstacles, until nothing touches; vertices that would still
    /// touch stay at their start, mapped with the obstacle.
    fn stop_edges(&self, bounds: Bounds, start: &Start<'_>, x: &mut [f64], v: &mut [f64]) -> usize {
        let near = self.near(start.effect, start.time, bounds);
        let mut touched = 0;
        for _ in 0..ROUNDS {
            let stopped = near.clone().map(|wall| wall.stop_edges(&self.boundary, start, x, v)).sum::<usize>();
            if stopped == 0 {
                return touched;
            }
            touched += stopped;
            near.clone().for_each(|wall| touched += wall.constrain(start, x, v));
        }
        let mut checked = x.to_vec();
        for _ in 0..self.boundary.len() {
            let stopped = near.clone().map(|wall| {
                let stopped = wall.stop_edges(&self.boundary, start, x, v);
                return_to_start(wall.swept_motion(), start, &mut checked, x, v);
                stopped
            });
            if stopped.sum::<usize>() == 0 {
                break;
            }
        }
        touched
    }
}

/// Resets stopped vertices to the start of the step, mapped with the motion of the obstacle.
fn return_to_start(swept_motion: &SweptMotion, start: &Start<'_>, checked: &mut [f64], x: &mut [f64], v: &mut [f64]) {
    let changed = x.chunks_exact_mut(2).zip(checked.chunks_exact_mut(2)).zip(v.chunks_exact_mut(2)).enumerate();
    for (vertex, ((x, checked), v)) in changed.filter(|(_, ((x, checked), _))| x != checked) {
        let from = swept_motion.place([start.x[2 * vertex], start.x[2 * vertex + 1]]);
        let wall = swept_motion.velocity_at(from);
        for axis in (0..2).filter(|axis| start.inverse_mass[2 * vertex + axis] != 0.0) {
            (x[axis], v[axis]) = (from[axis], wall[axis]);
        }
        checked.copy_from_slice(x);
    }
}

impl Effect for Contacts {
    fn name(&self) -> &'static str {
        "Walls"
    }

    fn dimension(&self) -> Option<usize> {
        Some(2)
    }

    fn elements(&self, motion: Motion<'_>) -> usize {
        self.obstacles.len() * motion.x.len() / 2
    }

    fn set_number(&mut self, number: usize) {
        self.contact.iter_mut().for_each(|contact| contact.set_number(number));
    }

    fn contact(&self) -> Option<&dyn ContactTerm> {
        self.contact.as_ref().map(|contact| contact as &dyn ContactTerm)
    }

    fn is_clear(&self, Bounds([least, greatest]): Bounds) -> bool {
        self.obstacles.iter().all(|wall| wall.motions.is_empty() && !wall.obstacle.may_touch(least, greatest))
    }

    fn is_steady(&self) -> bool {
        self.obstacles.iter().all(|wall| wall.motions.is_empty())
    }

    fn constrains(&self) -> bool {
        true
    }

    fn count_inside(&self, x: &[f64], time: f64, depenetrations: &[Depenetration]) -> usize {
        let is_inside = |(vertex, point): &(usize, &[f64; 2])| {
            let shallow = depenetration_of(depenetrations, *vertex).map_or(0.0, |depenetration| depenetration.shallow);
            self.obstacles.iter().any(|wall| {
                let contact = wall.obstacle.contact(wall.swept_motion([time; 2]).place_built(**point));
                contact.is_some_and(|contact| contact.distance < wall.obstacle.offset() - shallow)
            })
        };
        x.as_chunks().0.iter().enumerate().filter(is_inside).count()
    }

    fn contact_queries<'a>(
        &'a self,
        number: usize,
        time: [f64; 2],
        swept_bounds: Bounds,
        act: &mut dyn FnMut(ContactQuery<'a>),
    ) {
        self.near(number, time, swept_bounds).for_each(act);
    }

    fn constrain(&self, start: &Start<'_>, x: &mut [f64], v: &mut [f64]) -> usize {
        let bounds = Bounds::around(start.x, x);
        let mut touched = 0;
        let near = self.near(start.effect, start.time, bounds);
        for wall in near.clone() {
            touched += wall.press_edges(&self.boundary, start, x, v);
        }
        for wall in near {
            touched += wall.constrain(start, x, v);
        }
        touched + self.stop_edges(bounds, start, x, v)
    }
}

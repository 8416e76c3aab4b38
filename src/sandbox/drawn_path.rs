//! Vertices whose path is prescribed by a drag.

use super::{Refused, Sandbox};
use crate::{
    document::Document,
    effects::{EffectKind, MovingPins},
    level::{EffectLevel, Pin, Switch, When},
    obstacles::Spline,
    quantity::{Position, Time},
    scene::Owner,
};

/// Least time between two points of a path \[s\].
const APART: f64 = 0.1;

/// Most points of a path.
const MOST: f64 = 60.0;

impl Sandbox {
    /// Adds the effect that moves a vertex along a path from now on, and all pinned vertices of its part with it if it is one of them. `path` are times
    /// from now \[s\] and displacements from the present place of the vertex \[m\]. A path that the same vertices had before is replaced.
    pub(super) fn move_along(
        &self,
        document: &mut Document,
        vertex: usize,
        path: &[(f64, [f64; 3])],
    ) -> Result<(), Refused> {
        let scene = self.simulation.scene();
        let (owner, number) = scene.owner_of(vertex).ok_or(Refused::NotHere("there is no such vertex"))?;
        let part = match owner {
            Owner::Body(body) => body,
            Owner::Net(net) => scene.bodies.len() + net,
            Owner::Membrane(membrane) => scene.bodies.len() + scene.nets.len() + membrane,
        };
        let is_pinned = scene.pins.binary_search(&(vertex as u32)).is_ok();
        let pins = document.pins_mut(part).filter(|_| is_pinned).map(|pins| pins.clone());
        // By its place, which other meshes have too.
        let place = self.flat_points(part).get(number).map(|point| Pin::Nearest(*point));
        let pins = pins.unwrap_or_else(|| vec![place.unwrap_or(Pin::Vertex(number as u32))]);
        // Bodies that are shown side by side have other names than in the level.
        let of = scene.part_names().nth(part).filter(|_| document.side_by_side.is_none()).cloned();
        let motions = vec![Spline { points: self.spline_points(vertex, path)? }.into()];
        let is_same = |moving: &MovingPins| moving.of == of && moving.pins == pins;
        let before = document.level.effects.iter_mut().find(|listed| match &listed.effect {
            EffectKind::MovingPins(moving) => is_same(moving),
            _ => false,
        });
        let effect = MovingPins { of: of.clone(), pins: pins.clone(), motions }.into();
        let listed = EffectLevel { effect, switch: Switch::default(), when: When::Always };
        match before {
            Some(before) => *before = listed,
            None => document.level.effects.push(listed),
        }
        Ok(())
    }

    /// Points of the spline for the path of a vertex. The effect counts displacements from the start.
    fn spline_points(&self, vertex: usize, path: &[(f64, [f64; 3])]) -> Result<Vec<(Time, Position)>, Refused> {
        let (scene, state) = (self.simulation.scene(), self.simulation.state());
        let own = scene.numbers(&(vertex..vertex + 1));
        let from: Vec<_> =
            state.x[own.clone()].iter().zip(&scene.elements.start[own]).map(|(now, start)| now - start).collect();
        let end = path.last().map_or(0.0, |(time, _)| *time);
        let apart = APART.max(end / MOST);
        let mut points = Vec::new();
        let mut next = 0.0;
        for (time, moved) in path.iter().filter(|(time, _)| time.is_finite()) {
            // The last point ends the path where the drag ended.
            if (*time < next || *time > end - 0.5 * apart) && *time < end {
                continue;
            }
            next = time + apart;
            let moved: Vec<_> = from.iter().zip(moved).map(|(from, moved)| from + moved).collect();
            let point = Time::new(state.time + time).ok().zip(Position::new(&moved));
            points.push(point.ok_or(Refused::NotHere("the path leaves the allowed range of coordinates"))?);
        }
        if points.len() < 2 {
            return Err(Refused::NotHere("a path needs a drag of at least a tenth of a second"));
        }
        Ok(points)
    }
}

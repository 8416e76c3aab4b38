//! Effect: contact with obstacles.

use super::{Effect, EffectParameters, Group, ObstacleEffect, Shape};
use crate::{
    contact::PlacedObstacle,
    elements::Elements,
    obstacles::{Ball, ObstacleKind, Rigid, Surfaces, free_region, placed},
    quantity::Quantity,
};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

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
        "Obstacles push vertices away that come nearer than ε, or than the thickness of their skin if that is more, and their corners push edges away. Nothing passes through at any speed. What begins inside comes out slowly."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        self.groups().into_iter().flat_map(|group| group.numbers).collect()
    }

    fn groups(&mut self) -> Vec<Group<'_>> {
        let titles = ObstacleKind::titles(&self.obstacles);
        let mut solids = 0..;
        let groups = self.obstacles.iter_mut().zip(titles).map(|(kind, title)| {
            let solid = if kind.kind().outline().is_empty() { None } else { solids.next() };
            let numbers =
                if matches!(kind, ObstacleKind::Plane(_)) { Vec::new() } else { kind.kind_mut().parameters() };
            Group { title: Some(title), solid, numbers }
        });
        groups.filter(|group| !group.numbers.is_empty()).collect()
    }

    fn obstacles(&self) -> &[ObstacleKind] {
        &self.obstacles
    }

    fn obstacles_mut(&mut self) -> Option<&mut Vec<ObstacleKind>> {
        Some(&mut self.obstacles)
    }

    fn shapes(&self, time: f64, surfaces: &Surfaces) -> Vec<Shape> {
        let (mut planes, mut shapes) = (Vec::new(), Vec::new());
        let (in_space, in_plane): (Vec<_>, Vec<_>) =
            self.obstacles.iter().map(ObstacleKind::kind).partition(|kind| kind.dimension() == 3);
        shapes.extend(
            in_space
                .iter()
                .map(|kind| Shape::Surface(kind.triangulation(surfaces).moved(&placed(&kind.motions(), time)))),
        );
        for kind in in_plane {
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

    fn surface_paths(&self) -> Vec<&Path> {
        self.obstacles.iter().filter_map(|kind| kind.kind().path()).collect()
    }

    fn surface_paths_mut(&mut self) -> Vec<&mut PathBuf> {
        self.obstacles.iter_mut().filter_map(|kind| kind.kind_mut().path_mut()).collect()
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
        let is_empty_in_space = self.obstacles.is_empty() && elements.dimension() == 3;
        if is_empty_in_space || self.obstacles.iter().any(|kind| kind.kind().dimension() == 3) {
            let build = |(number, kind): (usize, &ObstacleKind)| {
                let built = kind.kind().build_in_space(&elements.surfaces);
                let obstacle = built.map_err(|why| format!("obstacle {number} ({}): {why}", kind.name()))?;
                Ok::<_, String>(PlacedObstacle { obstacle, motions: kind.kind().motions() })
            };
            let obstacles = self.obstacles.iter().enumerate().map(build).collect::<Result<Vec<_>, _>>()?;
            return Ok(Box::new(ObstacleEffect::in_space("Walls", elements, obstacles)));
        }
        let build = |(number, kind): (usize, &ObstacleKind)| {
            let obstacle = kind.kind().build().map_err(|why| format!("obstacle {number} ({}): {why}", kind.name()))?;
            Ok::<_, String>(PlacedObstacle { obstacle, motions: kind.kind().motions() })
        };
        let obstacles = self.obstacles.iter().enumerate().map(build).collect::<Result<Vec<_>, _>>()?;
        Ok(Box::new(ObstacleEffect::new("Walls", elements, obstacles)))
    }
}

//! Rigid obstacles, represented by shapes of parry2d and in space of parry3d. Only this module uses these libraries; its interface
//! takes points as arrays. Each kind is one file; [`ObstacleKind`] lists them all.
//!
//! An obstacle gives distances and normals, and its convex corners; [`crate::contact`] is what it does to bodies.
//!
//! ```
//! use gingerbread::obstacles::{Ball, ObstacleParameters as _};
//!
//! // A ball at (0.5, 0.2) of radius 0.1, with a margin of 0.01.
//! let ball = Ball::default().build()?;
//! let contact = ball.contact([0.5, 0.305]).ok_or("it is within the margin")?;
//! assert!((contact.distance - 0.005).abs() < 1e-12 && contact.normal == [0.0, 1.0]);
//! assert!(ball.contact([0.5, 0.32]).is_none());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod ball;
mod block;
mod corner;
mod cuboid;
mod cylinder;
mod half_space;
mod motions;
mod moving;
mod plane;
mod polygon;
mod rigid;
mod segments;
mod similarity;
mod solid;
mod sphere;
mod surface;
mod triangulation;

pub use ball::Ball;
pub use block::Block;
pub use corner::Corner;
pub use cuboid::Cuboid;
pub use cylinder::Cylinder;
pub use half_space::HalfSpace;
pub use motions::{Motion, MotionKind, Slide, Spline, Swing, Turn, check, placed};
pub use moving::Moving;
pub use plane::{HalfPlane, Plane, free_region};
pub use polygon::Polygon;
pub use rigid::{Rigid, SweptMotion};
pub use segments::{segments_cross, segments_meet, side_of};
pub use similarity::Similarity;
pub use sphere::Sphere;
pub use surface::Surface;
pub use triangulation::Triangulation;

use crate::{
    meshes::{Files, SurfaceMesh},
    quantity::Quantity,
    registry::registry,
};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::Arc,
};

registry! {
    /// Kinds of obstacles.
    pub enum ObstacleKind: dyn ObstacleParameters {
        Plane(Plane),
        Ball(Ball),
        Cuboid(Cuboid),
        Polygon(Polygon),
        Sphere(Sphere),
        HalfSpace(HalfSpace),
        Block(Block),
        Cylinder(Cylinder),
        Surface(Surface),
        Moving(Moving),
    }
}

impl ObstacleKind {
    /// Name in a list of obstacles.
    pub fn title(&self) -> String {
        match self {
            Self::Moving(moving) => format!("{}, moving", moving.obstacle.title()),
            still => still.name().to_owned(),
        }
    }

    /// Whether it goes on without end, as a plane does.
    pub fn is_endless(&self) -> bool {
        match self {
            Self::Plane(_) | Self::HalfSpace(_) => true,
            Self::Moving(moving) => moving.obstacle.is_endless(),
            _ => false,
        }
    }

    /// Its outline in the plane at a time \[s\], after its motions \[m\].
    pub fn outline_at(&self, time: f64) -> Vec<[f64; 2]> {
        let moved = placed::<2>(&self.kind().motions(), time);
        self.kind().outline().into_iter().map(|corner| moved.point(corner)).collect()
    }

    /// Names of all obstacles of a list: those with the same name are numbered.
    pub fn titles(obstacles: &[Self]) -> Vec<String> {
        let names: Vec<_> = obstacles.iter().map(Self::title).collect();
        let title = |number: usize| {
            let same = |upto: usize| names[..upto].iter().filter(|name| **name == names[number]).count();
            let name = &names[number];
            if same(names.len()) > 1 { format!("{name} {}", same(number) + 1) } else { name.clone() }
        };
        (0..names.len()).map(title).collect()
    }
}

/// The parameters of an obstacle.
pub trait ObstacleParameters {
    /// Number of coordinates of its points.
    fn dimension(&self) -> usize {
        2
    }

    /// Builds an obstacle of the plane for stepping.
    ///
    /// # Errors
    /// A sentence, if the parameters do not define a shape, or one in space.
    fn build(&self) -> Result<Box<dyn Obstacle>, String> {
        Err("it is in space, but the scene is in the plane".to_owned())
    }

    /// Builds an obstacle in space for stepping.
    ///
    /// # Errors
    /// A sentence, if the parameters do not define a shape, or one of the plane.
    fn build_in_space(&self, _surfaces: &Surfaces) -> Result<Box<dyn Obstacle<3>>, String> {
        Err("it is in the plane, but other obstacles are in space".to_owned())
    }

    /// A note for the user on the shape.
    fn notes(&self) -> Option<String> {
        None
    }

    /// A point of the shape that shows where it is \[m\]: its middle, if it has one. In the plane z is zero.
    fn place(&self) -> [f64; 3];

    /// Moves, scales and turns the shape with its motions; the contact margin stays. Shapes in space are not turned. `None` if a number
    /// would leave its range.
    fn arrange(&mut self, by: &Similarity) -> Option<()>;

    /// The numbers a panel may change.
    fn parameters(&mut self) -> Vec<&mut dyn Quantity>;

    /// The surface at which vertices stop (eps outside the shape), counter-clockwise \[m\]; empty for planes, which have no
    /// outline of their own, and in space.
    fn outline(&self) -> Vec<[f64; 2]> {
        Vec::new()
    }

    /// The surface of an obstacle in space, to be drawn.
    fn triangulation(&self, _surfaces: &Surfaces) -> Triangulation {
        Triangulation::default()
    }

    /// The file of its surface, if it has one.
    fn path(&self) -> Option<&Path> {
        None
    }

    /// The same, to be changed.
    fn path_mut(&mut self) -> Option<&mut PathBuf> {
        None
    }

    /// Its motions, applied one after another; empty for an obstacle at rest.
    fn motions(&self) -> Vec<MotionKind> {
        Vec::new()
    }

    /// The plane, if the obstacle is one. Several planes bound a free region.
    fn plane(&self) -> Option<&Plane> {
        None
    }
}

/// Surfaces of triangles that obstacles of a level name, by their files.
#[derive(Clone, Debug, Default)]
pub struct Surfaces(BTreeMap<PathBuf, Result<Arc<SurfaceMesh>, String>>);

impl Surfaces {
    /// Reads some files, apart from those that are known.
    pub fn read<'a>(paths: impl IntoIterator<Item = &'a Path>, files: &dyn Files, known: Option<&Self>) -> Self {
        let read = |path: &Path| {
            let before = known.and_then(|known| known.0.get(path)).filter(|read| read.is_ok()).cloned();
            before.unwrap_or_else(|| SurfaceMesh::read(path, files).map(Arc::new).map_err(|error| error.to_string()))
        };
        Self(paths.into_iter().map(|path| (path.to_path_buf(), read(path))).collect())
    }

    /// The surface of a file.
    ///
    /// # Errors
    /// A sentence, if it could not be read.
    pub fn get(&self, path: &Path) -> Result<&Arc<SurfaceMesh>, String> {
        let read = self.0.get(path).ok_or_else(|| format!("{} has not been read", path.display()))?;
        read.as_ref().map_err(Clone::clone)
    }
}

/// Distance and normal of the surface nearest to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<const D: usize = 2> {
    /// Distance to the surface \[m\]; negative inside.
    pub distance: f64,
    /// Unit vector from the obstacle outwards.
    pub normal: [f64; D],
}

impl<const D: usize> Contact<D> {
    /// Component of a vector along the normal.
    pub fn along(&self, vector: [f64; D]) -> f64 {
        (1..D).fold(self.normal[0] * vector[0], |sum, axis| sum + self.normal[axis] * vector[axis])
    }
}

/// An obstacle ready for stepping, in the plane or in space.
pub trait Obstacle<const D: usize = 2>: Send + Sync {
    /// The nearest surface, if the point is nearer to it than `reach` \[m\] or inside.
    fn distance(&self, point: [f64; D], reach: f64) -> Option<Contact<D>>;

    /// The nearest surface, if the point is within eps of it or inside.
    fn contact(&self, point: [f64; D]) -> Option<Contact<D>> {
        self.distance(point, self.margin())
    }

    /// Whether any point of a box could be within eps; conservative.
    fn is_near(&self, least: [f64; D], greatest: [f64; D]) -> bool;

    /// Contact margin eps \[m\].
    fn margin(&self) -> f64;

    /// Whether it is bounded.
    fn is_solid(&self) -> bool {
        false
    }

    /// Whether it is convex.
    fn is_convex(&self) -> bool {
        true
    }

    /// Greatest distance between points of cloth that stay farther than `reach` from it \[m\], so that it does not pass between them
    /// through the cloth; infinite if it never does.
    fn spacing(&self, _reach: f64) -> f64 {
        f64::INFINITY
    }

    /// Its convex corners, which can touch an edge of a body between two vertices.
    fn corners(&self) -> &[Corner<D>] {
        &[]
    }
}

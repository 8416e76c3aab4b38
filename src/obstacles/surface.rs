//! Obstacle in space: a closed surface of triangles from a file.

use super::{Obstacle, ObstacleParameters, Similarity, Surfaces, Triangulation, solid::Solid};
use crate::{
    meshes::SurfaceMesh,
    quantity::{Coordinate, Factor, Quantity, Reach, SpacePoint},
};
use parry3d::{
    math::{Pose, Vector},
    shape::{TriMesh, TriMeshFlags},
};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// A solid whose closed surface of triangles is in a Wavefront OBJ file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Surface {
    /// Where the file is, as seen from the level.
    pub path: PathBuf,
    /// Factor of its lengths.
    #[serde(default = "same_size", skip_serializing_if = "is_same_size")]
    pub scale: Factor,
    /// Displacement after scaling \[m\].
    #[serde(default = "origin", skip_serializing_if = "is_origin")]
    pub offset: SpacePoint,
    /// How near a vertex feels it \[m\].
    pub eps: Reach,
}

const fn same_size() -> Factor {
    Factor::literal(1.0)
}

fn is_same_size(scale: &Factor) -> bool {
    *scale == same_size()
}

const fn origin() -> SpacePoint {
    SpacePoint(Coordinate::literal(0.0), Coordinate::literal(0.0), Coordinate::literal(0.0))
}

fn is_origin(offset: &SpacePoint) -> bool {
    *offset == origin()
}

impl Default for Surface {
    fn default() -> Self {
        Self { path: "rock.obj".into(), scale: same_size(), offset: origin(), eps: Reach::literal(0.01) }
    }
}

impl Surface {
    /// The points of the file where they are in the scene.
    fn placed(&self, mesh: &SurfaceMesh) -> Vec<[f64; 3]> {
        let (scale, offset) = (self.scale.get(), self.offset.get());
        let place = |point: &[f64; 3]| std::array::from_fn(|axis| scale * point[axis] + offset[axis]);
        mesh.points.iter().map(place).collect()
    }
}

impl ObstacleParameters for Surface {
    fn dimension(&self) -> usize {
        3
    }

    fn build_in_space(&self, surfaces: &Surfaces) -> Result<Box<dyn Obstacle<3>>, String> {
        let mesh = surfaces.get(&self.path)?;
        let points = self.placed(mesh).into_iter().map(|[x, y, z]| Vector::new(x, y, z)).collect();
        let shape = TriMesh::with_flags(points, mesh.triangles.clone(), TriMeshFlags::ORIENTED)
            .map_err(|error| format!("{}: {error}", self.path.display()))?;
        Ok(Box::new(Solid::in_space(shape, Pose::IDENTITY, self.eps.get()).with_corners(0.0, &[], false)))
    }

    /// Where the origin of the file is.
    fn place(&self) -> [f64; 3] {
        self.offset.get()
    }

    fn arrange(&mut self, by: &Similarity) -> Option<()> {
        self.offset = by.of_space_point(self.offset)?;
        by.scale([&mut self.scale])
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.scale, &mut self.eps]
    }

    fn triangulation(&self, surfaces: &Surfaces) -> Triangulation {
        let Ok(mesh) = surfaces.get(&self.path) else { return Triangulation::default() };
        Triangulation { points: self.placed(mesh), triangles: mesh.triangles.clone(), endless_about: None }
    }

    fn path(&self) -> Option<&Path> {
        Some(&self.path)
    }

    fn path_mut(&mut self) -> Option<&mut PathBuf> {
        Some(&mut self.path)
    }
}

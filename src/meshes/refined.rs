//! Another mesh with some of its triangles divided.

use super::{Files, Mesh, MeshError, MeshKind, MeshSource, Rectangle, bisection::Bisection, error::MOST_TRIANGLES};
use std::path::PathBuf;

/// Greatest number of rounds.
const MOST_ROUNDS: usize = 200;

/// Greatest sum of the numbers of triangles over all rounds, which bounds the work.
const MOST_WORK: usize = 10_000_000;

/// Another mesh with some of its triangles divided. Each round lists triangles of the mesh after the round before, counted from 0. Each of them is
/// divided into four by the bisection of its edges, and neighbours as far as needed, so that the mesh stays conforming. The smallest angle stays at least about half of
/// that of the original mesh, and new vertices on the boundary lie on its exact outline, such as the circle of a disk, if its triangles are smaller than the curves of the outline.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Refined {
    /// The original mesh.
    pub mesh: Box<MeshKind>,
    /// Triangles that are divided in each round.
    pub rounds: Vec<Vec<u32>>,
}

impl Default for Refined {
    /// A rectangle with smaller triangles near its lower left corner.
    fn default() -> Self {
        Self { mesh: Box::new(Rectangle::default().into()), rounds: vec![vec![0], vec![0]] }
    }
}

impl Refined {
    /// A recipe with one more round, which divides these triangles of its mesh, by their numbers in increasing order.
    pub fn of(mesh: MeshKind, triangles: Vec<u32>) -> Self {
        match mesh {
            MeshKind::Refined(mut refined) => {
                refined.rounds.push(triangles);
                refined
            }
            other => Self { mesh: Box::new(other), rounds: vec![triangles] },
        }
    }
}

impl MeshSource for Refined {
    fn build(&self, files: &dyn Files) -> Result<Mesh, MeshError> {
        if self.rounds.len() > MOST_ROUNDS {
            let reason =
                format!("it has {} rounds of refinement, and at most {MOST_ROUNDS} are allowed", self.rounds.len());
            return Err(MeshError::Recipe(reason));
        }
        if matches!(*self.mesh, MeshKind::Refined(_)) {
            let reason = "its original mesh is a refined one: put all rounds into one list";
            return Err(MeshError::Recipe(reason.to_owned()));
        }
        let source = self.mesh.kind();
        let mesh = source.build(files)?;
        let mut bisection = Bisection::new(mesh.points(), mesh.triangles());
        let mut work = 0;
        for (round, triangles) in self.rounds.iter().enumerate() {
            let count = bisection.triangles.len();
            work += if triangles.is_empty() { 0 } else { count };
            if work > MOST_WORK {
                return Err(MeshError::Recipe(format!("it has too many rounds of refinement for {count} triangles")));
            }
            if let Some(missing) = triangles.iter().find(|triangle| **triangle as usize >= count) {
                return Err(MeshError::Recipe(format!(
                    "round {round} (counted from 0) divides triangle {missing}, but the mesh has triangles 0 to {} then",
                    count - 1
                )));
            }
            bisection.refine(triangles, &|point| source.onto_outline(point));
            if bisection.triangles.len() > MOST_TRIANGLES {
                return Err(MeshError::TooMany(bisection.triangles.len()));
            }
        }
        mesh.divided(bisection.points, bisection.triangles)
    }

    fn path_mut(&mut self) -> Option<&mut PathBuf> {
        self.mesh.kind_mut().path_mut()
    }

    fn onto_outline(&self, point: [f64; 2]) -> [f64; 2] {
        self.mesh.kind().onto_outline(point)
    }
}

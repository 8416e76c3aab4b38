//! How much too stiff linear triangles are when the area can hardly change.

use super::{Measure, Progress, StudyError, refine::with_triangles, statics};
use crate::{
    level::Level,
    materials::{MaterialParameters, Plane},
    meshes::{Diagonals, Files, MeshKind},
    quantity::Poisson,
    scene::Scene,
};

/// Tip deflection on the mesh in question over that on a far better one, in plane strain: 1 is right, near 0 is locked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LockingNumber {
    /// Poisson's ratio.
    pub poisson: f64,
    /// Tip deflection on the level's mesh; of rectangles, with one diagonal a cell [m].
    pub value: f64,
    /// Tip deflection on a mesh of four times as many triangles; of rectangles, crossed ones, which lock least [m].
    pub better: f64,
}

impl LockingNumber {
    /// The number.
    pub fn ratio(self) -> f64 {
        self.value / self.better
    }

    /// Whether the area can hardly change.
    pub fn is_tight(self) -> bool {
        self.poisson > 0.49
    }
}

/// The numbers of a level for an ordinary material and for one that is nearly incompressible, as a job of four rests.
pub struct Locking {
    /// In pairs: the mesh in question, a better one; for each Poisson's ratio.
    scenes: Vec<Scene>,
    tips: Vec<Option<f64>>,
}

/// Compressible, for comparison, and nearly incompressible.
const POISSON: [f64; 2] = [0.3, 0.4999];

impl Locking {
    /// Prepares the numbers of a level.
    ///
    /// # Errors
    /// If it cannot be built, has no mesh with a resolution, or does not hold its bodies.
    pub fn new(level: &Level, files: &dyn Files) -> Result<Self, StudyError> {
        let mut scenes: Vec<Scene> = Vec::new();
        for poisson in POISSON {
            let mut level = Level { state: None, ..level.clone() };
            for body in &mut level.bodies {
                let material = body.material;
                if let Ok(poisson) = Poisson::new(poisson)
                    && let Ok(strained) =
                        MaterialParameters::new(material.model(), material.young(), poisson, Plane::Strain)
                {
                    body.material = strained;
                }
            }
            let better = cut(with_triangles(&level, 4.0)?, Diagonals::Crossed);
            for level in [cut(level, Diagonals::Grid), better] {
                let scene = Scene::build(&level, level.mode, files, scenes.last())?;
                if scene.pins.len() < 2 {
                    return Err(StudyError::NotHere(
                        "this level does not hold its bodies, so they do not come to rest",
                    ));
                }
                scenes.push(scene);
            }
        }
        Ok(Self { scenes, tips: Vec::new() })
    }

    /// Finds the next rest.
    pub fn advance(&mut self) -> Progress {
        if let Some(scene) = self.scenes.get(self.tips.len()) {
            let rest = statics::rest(scene).filter(|(_, counts)| counts.unconverged == 0);
            self.tips.push(rest.map(|(x, _)| Measure::TipDeflection.of(scene, &x)));
        }
        let (done, all) = (self.tips.len(), self.scenes.len());
        Progress { done: done as f64 / all as f64, finished: done == all }
    }

    /// The numbers found so far.
    pub fn numbers(&self) -> Vec<LockingNumber> {
        let pairs = self.tips.chunks_exact(2).zip(POISSON);
        let number = |(tips, poisson): (&[Option<f64>], f64)| {
            Some(LockingNumber { poisson, value: (*tips.first()?)?, better: (*tips.get(1)?)? })
        };
        pairs.filter_map(number).collect()
    }
}

/// The level with the cells of all rectangles cut like this.
fn cut(mut level: Level, diagonals: Diagonals) -> Level {
    for body in &mut level.bodies {
        if let MeshKind::Rectangle(rectangle) = &mut body.mesh {
            rectangle.diagonals = diagonals;
        }
    }
    level
}

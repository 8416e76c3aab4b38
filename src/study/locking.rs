//! Measures volumetric locking of linear triangles.

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
    /// Tip deflection on the level's own mesh [m].
    pub value: f64,
    /// Tip deflection on a mesh of at least four times as many triangles; of rectangles, crossed ones, which lock least [m].
    pub better: f64,
    /// The level's own mesh, and the better one.
    pub meshes: [MeshKindOf; 2],
}

/// What mesh a number was measured on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeshKindOf {
    /// Number of triangles.
    pub triangles: usize,
    /// How the cells are cut, where all bodies are rectangles that are cut alike.
    pub diagonals: Option<Diagonals>,
}

impl MeshKindOf {
    fn new(level: &Level, scene: &Scene) -> Self {
        let mut cuts = level.bodies.iter().map(|body| match &body.mesh {
            MeshKind::Rectangle(rectangle) => Some(rectangle.diagonals),
            _ => None,
        });
        let first = cuts.next().flatten();
        Self { triangles: scene.triangles.len(), diagonals: first.filter(|_| cuts.all(|cut| cut == first)) }
    }
}

impl std::fmt::Display for MeshKindOf {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "{} triangles", self.triangles)?;
        self.diagonals.map_or(Ok(()), |diagonals| write!(out, ", diagonals {diagonals:?}"))
    }
}

impl LockingNumber {
    /// The number.
    pub fn ratio(self) -> f64 {
        self.value / self.better
    }

    /// Whether the better mesh may lock too: then the ratio to what is right is smaller still.
    pub fn is_bound(self) -> bool {
        self.meshes[1].diagonals != Some(Diagonals::Crossed)
    }

    /// In words: the number, and which meshes it is of.
    pub fn words(self) -> String {
        let (at_most, ratio, [own, better]) =
            (if self.is_bound() { "at most " } else { "" }, self.ratio(), self.meshes);
        let too = if self.is_bound() { ", which may lock too" } else { "" };
        format!(
            "{at_most}{ratio:.3} of the deflection of a better mesh ({better}{too}), on the level's own mesh ({own})"
        )
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
    meshes: Vec<MeshKindOf>,
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
        let (mut scenes, mut meshes): (Vec<Scene>, Vec<MeshKindOf>) = Default::default();
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
            let better = crossed(with_triangles(&level, 4.0)?);
            for level in [level, better] {
                let scene = Scene::build(&level, level.mode, files, scenes.last())?;
                if scene.pins.len() < 2 {
                    return Err(StudyError::NotHere(
                        "this level does not hold its bodies, so they do not come to rest",
                    ));
                }
                meshes.push(MeshKindOf::new(&level, &scene));
                scenes.push(scene);
            }
        }
        Ok(Self { scenes, meshes, tips: Vec::new() })
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
        let pairs = self.tips.as_chunks().0.iter().zip(self.meshes.as_chunks().0).zip(POISSON);
        let number = |((&[value, better], &meshes), poisson): ((&[Option<f64>; 2], &[MeshKindOf; 2]), f64)| {
            Some(LockingNumber { poisson, value: value?, better: better?, meshes })
        };
        pairs.filter_map(number).collect()
    }
}

/// The level with the cells of all rectangles cut by both diagonals.
fn crossed(mut level: Level) -> Level {
    for body in &mut level.bodies {
        if let MeshKind::Rectangle(rectangle) = &mut body.mesh {
            rectangle.diagonals = Diagonals::Crossed;
        }
    }
    level
}

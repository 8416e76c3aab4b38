//! Measures volumetric locking, which linear triangles are subject to.

use super::{Measure, Progress, StudyError, other_meshes::with_triangles, solutions};
use crate::{
    elements::ElementKind,
    level::Level,
    materials::{MaterialParameters, Plane},
    meshes::{Diagonals, Files, MeshKind},
    quantity::Poisson,
    scene::Scene,
};

/// Locking number: tip deflection on the level's mesh over that on a much finer mesh, in plane strain.
/// 1 means no locking, near 0 means locked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LockingNumber {
    /// Poisson's ratio.
    pub poisson: f64,
    /// Tip deflection on the level's own mesh \[m\].
    pub value: f64,
    /// Tip deflection on a mesh with at least four times as many triangles \[m\]. Rectangles are crossed there, which
    /// lock least.
    pub better: f64,
    /// The level's own mesh and the finer mesh.
    pub meshes: [MeshKindOf; 2],
}

/// Mesh on which a number was measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeshKindOf {
    /// Number of triangles.
    pub triangles: usize,
    /// Diagonals of the cells, if all bodies are rectangles with the same diagonals.
    pub diagonals: Option<Diagonals>,
    /// Whether a body has linear triangles.
    pub is_linear: bool,
}

impl MeshKindOf {
    fn new(level: &Level, scene: &Scene) -> Self {
        let mut cuts = level.bodies.iter().map(|body| match &body.mesh {
            MeshKind::Rectangle(rectangle) => Some(rectangle.diagonals),
            _ => None,
        });
        let first = cuts.next().flatten();
        let diagonals = first.filter(|_| cuts.all(|cut| cut == first));
        let is_linear = level.bodies.iter().any(|body| body.element == ElementKind::Linear);
        Self { triangles: scene.triangles.len(), diagonals, is_linear }
    }
}

impl std::fmt::Display for MeshKindOf {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "{} triangles", self.triangles)?;
        self.diagonals.map_or(Ok(()), |diagonals| write!(out, ", diagonals {diagonals:?}"))
    }
}

impl LockingNumber {
    /// Locking number.
    pub fn ratio(self) -> f64 {
        self.value / self.better
    }

    /// Whether the finer mesh may lock too. The true ratio is then smaller.
    pub fn is_bound(self) -> bool {
        self.meshes[1].is_linear && self.meshes[1].diagonals != Some(Diagonals::Crossed)
    }

    /// Locking number and its meshes in plain words.
    pub fn words(self) -> String {
        let (at_most, ratio, [own, better]) =
            (if self.is_bound() { "at most " } else { "" }, self.ratio(), self.meshes);
        let too = if self.is_bound() { ", which may lock too" } else { "" };
        format!(
            "{at_most}{ratio:.3} of the deflection of a better mesh ({better}{too}), on the level's own mesh ({own})"
        )
    }

    /// Whether the material is nearly incompressible: Poisson's ratio is above 0.49.
    pub fn is_tight(self) -> bool {
        self.poisson > 0.49
    }
}

/// Locking numbers of a level for a compressible and a nearly incompressible material, as a job of four equilibria.
pub struct Locking {
    /// Pairs of the level's mesh and a finer one, one pair per Poisson's ratio.
    scenes: Vec<Scene>,
    meshes: Vec<MeshKindOf>,
    tips: Vec<Option<f64>>,
}

/// Poisson's ratios: compressible, for comparison, and nearly incompressible.
const POISSON: [f64; 2] = [0.3, 0.4999];

impl Locking {
    /// Prepares the numbers of a level.
    ///
    /// # Errors
    /// If the level cannot be built, has no mesh with a resolution, or does not hold its bodies.
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
                if !scene.is_held() {
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

    /// Solves the next equilibrium.
    pub fn advance(&mut self) -> Progress {
        if let Some(scene) = self.scenes.get(self.tips.len()) {
            let rest = solutions::rest(scene).filter(|(_, counts)| counts.unconverged == 0);
            self.tips.push(rest.map(|(x, _)| Measure::TipDeflection.of(scene, &x)));
        }
        let (done, all) = (self.tips.len(), self.scenes.len());
        Progress { done: done as f64 / all as f64, finished: done == all }
    }

    /// Numbers found so far.
    pub fn numbers(&self) -> Vec<LockingNumber> {
        let pairs = self.tips.as_chunks().0.iter().zip(self.meshes.as_chunks().0).zip(POISSON);
        let number = |((&[value, better], &meshes), poisson): ((&[Option<f64>; 2], &[MeshKindOf; 2]), f64)| {
            Some(LockingNumber { poisson, value: value?, better: better?, meshes })
        };
        pairs.filter_map(number).collect()
    }
}

/// Level whose rectangles have crossed diagonals.
fn crossed(mut level: Level) -> Level {
    for body in &mut level.bodies {
        if let MeshKind::Rectangle(rectangle) = &mut body.mesh {
            rectangle.diagonals = Diagonals::Crossed;
        }
    }
    level
}

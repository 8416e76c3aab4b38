//! Known results of a level, with the vertices and triangles that they are measured at.

use super::Simulation;
use crate::{
    level::{Check, CheckPlace, Level},
    meshes::nearest,
    probe::Probe,
    quantity::Position,
    scene::{Scene, SceneError},
};

/// A known result, ready to be measured.
#[derive(Clone, Debug)]
pub struct PlacedCheck {
    /// What is known.
    pub check: Check,
    /// What measures it.
    pub probe: Probe,
    /// Unit of the value.
    pub unit: &'static str,
    /// Number of its column.
    column: usize,
}

impl PlacedCheck {
    /// Those of a level, in the scene that was built from it.
    ///
    /// # Errors
    /// [`SceneError::Check`] for one that the scene does not have.
    pub fn all(level: &Level, scene: &Scene) -> Result<Vec<Self>, SceneError> {
        let why = |check: &Check, why| SceneError::Check { name: check.name.clone(), why };
        level.checks.iter().map(|check| Self::new(check, scene).map_err(|error| why(check, error))).collect()
    }

    /// Finds what a check names in a scene.
    ///
    /// # Errors
    /// A sentence, if the scene does not have it.
    fn new(check: &Check, scene: &Scene) -> Result<Self, String> {
        let probe = match check.place {
            CheckPlace::Vertex(at) => Probe::Vertex(listed_vertex(scene, at)?),
            CheckPlace::Triangle(at) => Probe::Triangle(listed_triangle(scene, at)?),
            CheckPlace::Reaction => Probe::Reaction,
            CheckPlace::Energy => Probe::Energy,
            CheckPlace::Momentum => Probe::Momentum,
            CheckPlace::Numbers => Probe::Numbers,
        };
        probe.check(scene)?;
        let columns = probe.columns(scene);
        let prefix = match probe {
            Probe::Vertex(place) => format!("vertex_{place}_"),
            Probe::Triangle(place) => format!("triangle_{place}_"),
            _ => String::new(),
        };
        let own = |name: &str| name.strip_prefix(&prefix).unwrap_or(name).to_owned();
        let Some(column) = columns.iter().position(|column| own(&column.name) == check.column) else {
            let names: Vec<_> = columns.iter().map(|column| own(&column.name)).collect();
            return Err(format!("there is no column {:?}; those are: {}", check.column, names.join(", ")));
        };
        Ok(Self { check: check.clone(), probe, unit: columns[column].unit, column })
    }

    /// Number of steps of a length \[s\] from a time \[s\] to that at which it is measured; negative behind it.
    pub fn steps_from(&self, time: f64, step: f64) -> i64 {
        ((self.check.at.get() - time) / step).round() as i64
    }

    /// Its value now; `None` where it is not a number.
    pub fn value(&self, simulation: &Simulation) -> Option<f64> {
        self.probe.numbers(simulation).get(self.column).copied().filter(|value| value.is_finite())
    }

    /// Whether a measured value is within the tolerance.
    pub fn is_met(&self, measured: f64) -> bool {
        (measured - self.check.value.get()).abs() <= self.check.tolerance.get()
    }
}

/// Place in the list of the level of the vertex that is nearest to a point at rest \[m\].
fn listed_vertex(scene: &Scene, at: Position) -> Result<usize, String> {
    let point = fitting(scene, at)?;
    let vertex = nearest(0..scene.vertices(), &scene.rest, &point[..scene.dimension]);
    vertex.and_then(|vertex| scene.listed_vertex(vertex)).ok_or_else(|| "there are no vertices".to_owned())
}

/// Place in the list of the level of the triangle of a body whose middle is nearest to a point at rest \[m\].
fn listed_triangle(scene: &Scene, at: Position) -> Result<usize, String> {
    let point = fitting(scene, at)?;
    let middle = |corners: &[u32; 3]| {
        [0, 1].map(|axis| corners.iter().map(|corner| scene.rest[2 * *corner as usize + axis]).sum::<f64>() / 3.0)
    };
    let middles: Vec<f64> = scene.triangles.iter().flat_map(middle).collect();
    let triangle = nearest(0..scene.triangles.len(), &middles, &point[..2]);
    triangle
        .and_then(|triangle| scene.listed_triangle(triangle))
        .ok_or_else(|| "there are no triangles of bodies".to_owned())
}

/// The coordinates of a point in the space of a scene.
fn fitting(scene: &Scene, at: Position) -> Result<[f64; 3], String> {
    if at.dimension() != scene.dimension {
        return Err(format!("its point has {} coordinates, but the scene has {}", at.dimension(), scene.dimension));
    }
    Ok(at.get())
}

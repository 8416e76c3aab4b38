//! Closed triangle surfaces in space, from Wavefront OBJ files.

use super::{Files, MeshError, error::MOST_TRIANGLES, obj::Reader, polygon};
use std::{collections::BTreeMap, path::Path};

/// A closed surface of triangles in space, counter-clockwise seen from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceMesh {
    /// Corners \[m\].
    pub points: Vec<[f64; 3]>,
    /// Triangles, by the numbers of their corners.
    pub triangles: Vec<[u32; 3]>,
}

impl SurfaceMesh {
    /// Reads a Wavefront OBJ file. Faces with more than three corners are cut into triangles. A surface that is inside out is turned, as a whole: all its parts must have the
    /// same sense.
    ///
    /// # Errors
    /// [`MeshError`] with the line, if the file cannot be read, or the surface is not closed.
    pub fn read(path: &Path, files: &dyn Files) -> Result<Self, MeshError> {
        let reader = Reader::read(path, files)?;
        let fail = |line: usize, reason: String| MeshError::Line { path: path.display().to_string(), line, reason };
        let (mut triangles, mut lines) = (Vec::new(), Vec::new());
        for (line, corners) in reader.faces(path)? {
            let flat = seen_along_normal(&corners, &reader.points);
            let cut = polygon::cut(&flat).ok_or_else(|| {
                fail(
                    line,
                    "expected a face whose sides do not cross, with at most 200 corners; cut it into triangles"
                        .to_owned(),
                )
            })?;
            if triangles.len() + cut.len() > MOST_TRIANGLES {
                return Err(fail(
                    line,
                    format!("expected at most {MOST_TRIANGLES} triangles in all; use a coarser mesh"),
                ));
            }
            lines.extend(cut.iter().map(|_| line));
            triangles.extend(cut.iter().map(|triangle| triangle.map(|index| corners[index])));
        }
        if triangles.is_empty() {
            let reason = "expected a surface, but the file has no face".to_owned();
            return Err(MeshError::File { path: path.display().to_string(), reason });
        }
        let mut sides = BTreeMap::new();
        for (triangle, line) in triangles.iter().zip(&lines) {
            for side in sides_of(*triangle) {
                if sides.insert(side, *line).is_some() {
                    let [a, b] = side.map(|corner| corner + 1);
                    let reason = format!(
                        "the side from vertex {a} to {b} belongs to another face in the same direction; expected faces that all run counter-clockwise seen from outside"
                    );
                    return Err(fail(*line, reason));
                }
            }
        }
        for ([a, b], line) in &sides {
            if !sides.contains_key(&[*b, *a]) {
                let (a, b) = (a + 1, b + 1);
                let reason = format!(
                    "the side between the vertices {a} and {b} belongs to one face alone; expected a closed surface"
                );
                return Err(fail(*line, reason));
            }
        }
        let mut mesh = Self { points: reader.points, triangles };
        let [least, greatest] = mesh.bounds();
        let around: f64 = (0..3).map(|axis| greatest[axis] - least[axis]).product();
        if mesh.volume().abs() <= 1e-9 * around {
            let reason = "expected a surface around a volume, but it lies on itself".to_owned();
            return Err(MeshError::File { path: path.display().to_string(), reason });
        }
        if mesh.volume() < 0.0 {
            mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        Ok(mesh)
    }

    /// Least and greatest coordinates \[m\].
    fn bounds(&self) -> [[f64; 3]; 2] {
        let start = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        self.points.iter().fold(start, |[least, greatest], point| {
            [
                std::array::from_fn(|axis| least[axis].min(point[axis])),
                std::array::from_fn(|axis| greatest[axis].max(point[axis])),
            ]
        })
    }

    /// Volume inside \[m³\]; negative if the surface is inside out.
    pub fn volume(&self) -> f64 {
        let of = |triangle: &[u32; 3]| {
            let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = triangle.map(|corner| self.points[corner as usize]);
            (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6.0
        };
        self.triangles.iter().map(of).sum()
    }
}

fn sides_of([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// Corners of a face as seen along the axis nearest to its normal, counter-clockwise if it points to the eye.
fn seen_along_normal(corners: &[u32], points: &[[f64; 3]]) -> Vec<[f64; 2]> {
    let at = |index: usize| points[corners[index % corners.len()] as usize];
    // Newell's normal.
    let mut normal = [0.0_f64; 3];
    for index in 0..corners.len() {
        let (here, next) = (at(index), at(index + 1));
        for (axis, along) in normal.iter_mut().enumerate() {
            let (one, two) = ((axis + 1) % 3, (axis + 2) % 3);
            *along += (here[one] - next[one]) * (here[two] + next[two]);
        }
    }
    let axis = (1..3).fold(0, |most, axis| if normal[axis].abs() > normal[most].abs() { axis } else { most });
    let (mut one, mut two) = ((axis + 1) % 3, (axis + 2) % 3);
    if normal[axis] < 0.0 {
        std::mem::swap(&mut one, &mut two);
    }
    (0..corners.len()).map(|index| [at(index)[one], at(index)[two]]).collect()
}

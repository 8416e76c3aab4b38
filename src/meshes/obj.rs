//! Wavefront OBJ files: the lines `v x y z` and `f a b c ...`; everything else in them is passed over.
//! Format: "Object Files (.obj)", Wavefront Technologies, appendix B1 of the Advanced Visualizer manual.

use super::{Files, Mesh, MeshError, MeshSource, error::MOST_TRIANGLES, polygon};

/// How far z may vary in a flat file, as a share of the size of the mesh.
const FLATNESS: f64 = 1e-9;

/// A mesh from a Wavefront OBJ file that lies in the plane. Faces with more than three corners are cut into triangles.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Obj {
    /// Where the file is, as seen from the level.
    pub path: String,
}

impl Default for Obj {
    fn default() -> Self {
        Self { path: "woody.obj".to_owned() }
    }
}

impl MeshSource for Obj {
    fn build(&self, files: &dyn Files) -> Result<Mesh, MeshError> {
        let text = files.read(&self.path).map_err(|reason| MeshError::File { path: self.path.clone(), reason })?;
        let mut reader = Reader::default();
        for (index, line) in text.lines().enumerate() {
            reader.line(index + 1, line).map_err(|reason| MeshError::Line {
                path: self.path.clone(),
                line: index + 1,
                reason,
            })?;
        }
        reader.finish(&self.path)
    }

    fn path_mut(&mut self) -> Option<&mut String> {
        Some(&mut self.path)
    }
}

/// What has been read so far. Line numbers count from 1.
#[derive(Default)]
struct Reader {
    points: Vec<[f64; 2]>,
    point_lines: Vec<usize>,
    heights: Vec<f64>,
    triangles: Vec<[u32; 3]>,
    triangle_lines: Vec<usize>,
}

impl Reader {
    /// Reads one line; an error is its reason.
    fn line(&mut self, number: usize, line: &str) -> Result<(), String> {
        let mut words = line.split('#').next().unwrap_or_default().split_whitespace();
        match words.next() {
            Some("v") => self.vertex(number, words),
            Some("f") => self.face(number, words),
            _ => Ok(()),
        }
    }

    /// `v x y [z [w]]`, lengths in metres; colours after them are passed over.
    fn vertex<'a>(&mut self, number: usize, words: impl Iterator<Item = &'a str>) -> Result<(), String> {
        let mut place = [0.0; 3];
        let mut given = 0;
        for (coordinate, word) in place.iter_mut().zip(words) {
            *coordinate = word
                .parse()
                .ok()
                .filter(|value: &f64| value.is_finite())
                .ok_or_else(|| format!("expected `v x y z` with finite numbers, got `{}`", short(word)))?;
            given += 1;
        }
        if given < 2 {
            return Err(format!("expected `v x y z`, got {given} of the numbers"));
        }
        self.points.push([place[0], place[1]]);
        self.heights.push(place[2]);
        self.point_lines.push(number);
        Ok(())
    }

    /// `f a b c ...`, each corner `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn face<'a>(&mut self, number: usize, words: impl Iterator<Item = &'a str>) -> Result<(), String> {
        let corners = words.map(|word| self.corner(word)).collect::<Result<Vec<u32>, String>>()?;
        if corners.len() < 3 {
            return Err(format!("expected `f a b c` with at least 3 corners, got {}", corners.len()));
        }
        let places: Vec<_> = corners.iter().map(|&corner| self.points[corner as usize]).collect();
        let triangles = polygon::cut(&places)
            .ok_or("expected a face whose sides do not cross, with at most 200 corners; cut it into triangles")?;
        if self.triangles.len() + triangles.len() > MOST_TRIANGLES {
            return Err(format!("expected at most {MOST_TRIANGLES} triangles in all; use a coarser mesh"));
        }
        self.triangle_lines.extend(triangles.iter().map(|_| number));
        self.triangles.extend(triangles.iter().map(|triangle| triangle.map(|index| corners[index])));
        Ok(())
    }

    /// The vertex a corner names: counted from 1, or backwards from -1, the latest.
    fn corner(&self, word: &str) -> Result<u32, String> {
        let number: i64 = word
            .split('/')
            .next()
            .unwrap_or_default()
            .parse()
            .map_err(|_| format!("expected a vertex number such as `7`, `7/1` or `-1`, got `{}`", short(word)))?;
        let count = self.points.len();
        let steps = usize::try_from(number.unsigned_abs()).unwrap_or(usize::MAX);
        let index = if number < 0 { count.checked_sub(steps) } else { steps.checked_sub(1) };
        index.filter(|&index| index < count).and_then(|index| u32::try_from(index).ok()).ok_or_else(|| {
            format!("vertex {number} is not there; expected 1 to {count}, or -1 to -{count}, of the `v` lines above")
        })
    }

    /// Checks the whole.
    fn finish(self, path: &str) -> Result<Mesh, MeshError> {
        let size = super::mesh::bounds(&self.points);
        let limit = FLATNESS * (size[1][0] - size[0][0]).max(size[1][1] - size[0][1]);
        if let Some(index) = self.heights.iter().position(|z| (z - self.heights[0]).abs() > limit) {
            let (z, first) = (self.heights[index], self.heights[0]);
            let reason = format!("z is {z}, but {first} before; expected a flat mesh with the same z everywhere");
            return Err(MeshError::Line { path: path.to_owned(), line: self.point_lines[index], reason });
        }
        let (point_lines, triangle_lines) = (self.point_lines, self.triangle_lines);
        Mesh::counted_from(1, self.points, self.triangles).map_err(|error| {
            let line = match error {
                MeshError::Unused { vertex, .. } | MeshError::BowTie { vertex } => point_lines.get(vertex - 1),
                MeshError::NoArea { triangle, .. } => triangle_lines.get(triangle),
                _ => None,
            };
            let (path, reason) = (path.to_owned(), error.to_string());
            match line {
                Some(&line) => MeshError::Line { path, line, reason },
                None => MeshError::File { path, reason },
            }
        })
    }
}

/// The start of a word, for messages about files that hold no text.
fn short(word: &str) -> String {
    word.chars().take(24).collect()
}

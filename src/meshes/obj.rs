//! Reader of Wavefront OBJ files: the lines `v x y z` and `f a b c ...`; other lines are skipped.
//! Format: "Object Files (.obj)", Wavefront Technologies, appendix B1 of the Advanced Visualizer manual.
//!
//! The project has its own reader for three reasons: errors name the line, concave faces are cut inside, and a face
//! may precede its vertices. The crate tobj 4.0 keeps no line numbers and cuts faces into fans.

use super::{Files, Mesh, MeshError, MeshSource, NEAR, error::MOST_TRIANGLES, mesh::area, msh, polygon};
use crate::text;
use std::path::{Path, PathBuf};

/// A mesh from a Wavefront OBJ file, or from a text file of Gmsh (MSH), that lies in a plane: x-y, x-z or y-z. Faces with more than three corners are cut into triangles.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Obj {
    /// Where the file is, as seen from the level.
    pub path: PathBuf,
}

impl Default for Obj {
    fn default() -> Self {
        Self { path: "woody.obj".into() }
    }
}

impl MeshSource for Obj {
    fn build(&self, files: &dyn Files) -> Result<Mesh, MeshError> {
        Reader::read(&self.path, files)?.finish(&self.path)
    }

    fn path_mut(&mut self) -> Option<&mut PathBuf> {
        Some(&mut self.path)
    }
}

/// Lines of a file without comments, each with its number from 1. A `\` at the end of a line joins the next line.
fn joined(text: &str) -> impl Iterator<Item = (usize, String)> {
    let mut lines = text.lines().zip(1..);
    std::iter::from_fn(move || {
        let (line, number) = lines.next()?;
        let mut whole = uncommented(line).to_owned();
        while whole.trim_end().ends_with('\\') {
            whole.truncate(whole.trim_end().len() - 1);
            let Some((next, _)) = lines.next() else { break };
            whole.push(' ');
            whole += uncommented(next);
        }
        Some((number, whole))
    })
}

fn uncommented(line: &str) -> &str {
    line.split('#').next().unwrap_or_default()
}

/// Content read so far. Line numbers count from 1.
#[derive(Default)]
pub(super) struct Reader {
    pub points: Vec<[f64; 3]>,
    point_lines: Vec<usize>,
    faces: Vec<Face>,
}

/// Face: its line, and its corner numbers. They count from 1, or backwards from -1, the last vertex before its line.
struct Face {
    line: usize,
    corners: Vec<i64>,
    points_before: usize,
}

impl Reader {
    /// Reads a file.
    pub fn read(path: &Path, files: &dyn Files) -> Result<Self, MeshError> {
        let name = || path.display().to_string();
        let text = files.read(path).map_err(|reason| MeshError::File { path: name(), reason })?;
        let text = text::normalised(&text);
        if text.trim_start().starts_with(msh::HEAD) {
            return msh::read(&text).map_err(|(line, reason)| MeshError::Line { path: name(), line, reason });
        }
        let mut reader = Self::default();
        for (number, line) in joined(&text) {
            reader.line(number, &line).map_err(|reason| MeshError::Line { path: name(), line: number, reason })?;
        }
        Ok(reader)
    }

    /// Adds a vertex from a line of the file.
    pub fn add_point(&mut self, line: usize, point: [f64; 3]) {
        self.points.push(point);
        self.point_lines.push(line);
    }

    /// Adds a face from a line of the file, by vertices from 1.
    pub fn add_face(&mut self, line: usize, corners: Vec<i64>) {
        self.faces.push(Face { line, corners, points_before: self.points.len() });
    }

    /// Whether there is no face.
    pub const fn is_without_faces(&self) -> bool {
        self.faces.is_empty()
    }

    /// Drops vertices that no face has; all its numbers are from 1.
    pub fn drop_unused(&mut self) {
        let mut new = vec![0; self.points.len() + 1];
        self.faces.iter().flat_map(|face| &face.corners).for_each(|corner| new[*corner as usize] = 1);
        let mut count = 0;
        for number in new.iter_mut().skip(1).filter(|number| **number == 1) {
            count += 1;
            *number = count;
        }
        let is_used = |place: usize| new[place + 1] > 0;
        let mut place = 0..;
        self.points.retain(|_| place.next().is_some_and(is_used));
        let mut place = 0..;
        self.point_lines.retain(|_| place.next().is_some_and(is_used));
        self.faces.iter_mut().flat_map(|face| &mut face.corners).for_each(|corner| *corner = new[*corner as usize]);
    }

    /// The faces with their lines, as vertices from 0.
    pub fn faces(&self, path: &Path) -> Result<Vec<(usize, Vec<u32>)>, MeshError> {
        let fail = |line: usize, reason: String| MeshError::Line { path: path.display().to_string(), line, reason };
        let face = |face: &Face| Ok((face.line, self.corners(face).map_err(|why| fail(face.line, why))?));
        self.faces.iter().map(face).collect()
    }

    /// Reads one line. An error is its reason.
    fn line(&mut self, number: usize, line: &str) -> Result<(), String> {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => self.vertex(number, words),
            Some("f" | "fo") => self.face(number, words),
            _ => Ok(()),
        }
    }

    /// Reads `v x y [z [w]]`, lengths in metres. Colours after them are skipped.
    fn vertex<'a>(&mut self, number: usize, words: impl Iterator<Item = &'a str>) -> Result<(), String> {
        let mut place = [0.0; 3];
        let mut given = 0;
        for (coordinate, word) in place.iter_mut().zip(words) {
            *coordinate = word.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| {
                let point = word.replace(',', ".");
                let remedy = match point.parse::<f64>() {
                    Ok(_) if word.contains(',') => format!("; write `{point}`, with a decimal point"),
                    _ => String::new(),
                };
                format!("expected `v x y z` with finite numbers, got `{}`{remedy}", short(word))
            })?;
            given += 1;
        }
        if given < 2 {
            return Err(format!("expected `v x y z`, got {given} of the numbers"));
        }
        self.points.push(place);
        self.point_lines.push(number);
        Ok(())
    }

    /// Reads `f a b c ...`, each corner `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn face<'a>(&mut self, line: usize, words: impl Iterator<Item = &'a str>) -> Result<(), String> {
        let corner = |word: &str| {
            let number = word.split('/').next().unwrap_or_default().parse();
            number.map_err(|_| format!("expected a vertex number such as `7`, `7/1` or `-1`, got `{}`", short(word)))
        };
        let corners = words.map(corner).collect::<Result<Vec<i64>, String>>()?;
        if corners.len() < 3 {
            return Err(format!("expected `f a b c` with at least 3 corners, got {}", corners.len()));
        }
        self.faces.push(Face { line, corners, points_before: self.points.len() });
        Ok(())
    }

    /// Vertices of a face, from 0. A vertex that is repeated at once, as at the end of a closed ring, counts once.
    fn corners(&self, face: &Face) -> Result<Vec<u32>, String> {
        let count = self.points.len();
        let vertex = |&number: &i64| {
            let steps = usize::try_from(number.unsigned_abs()).unwrap_or(usize::MAX);
            let index = if number < 0 { face.points_before.checked_sub(steps) } else { steps.checked_sub(1) };
            index.filter(|&index| index < count).and_then(|index| u32::try_from(index).ok()).ok_or_else(|| {
                let back = match face.points_before {
                    0 => String::new(),
                    before => format!(", or -1 to -{before} for the `v` lines above"),
                };
                format!("vertex {number} is not there; expected 1 to {count}{back}")
            })
        };
        let mut corners = face.corners.iter().map(vertex).collect::<Result<Vec<u32>, String>>()?;
        if corners.len() > 3 {
            corners.dedup();
            if corners.len() > 3 && corners.first() == corners.last() {
                corners.pop();
            }
        }
        Ok(corners)
    }

    /// Checks the file as a whole and builds the mesh.
    fn finish(self, path: &Path) -> Result<Mesh, MeshError> {
        let name = || path.display().to_string();
        let fail = |line: usize, reason: String| MeshError::Line { path: name(), line, reason };
        let faces = self.faces(path)?;
        let flat = flat(&self.points, faces.iter().map(|(_, corners)| &corners[..]));
        let flat = flat.map_err(|(vertex, reason)| fail(self.point_lines[vertex], reason))?;
        let (mut triangles, mut triangle_lines) = (Vec::new(), Vec::new());
        for (line, corners) in faces {
            let places: Vec<_> = corners.iter().map(|&corner| flat.points[corner as usize]).collect();
            let cut = polygon::cut(&places).ok_or_else(|| {
                let reason =
                    "expected a face whose sides do not cross, with at most 200 corners; cut it into triangles";
                fail(line, reason.to_owned())
            })?;
            if triangles.len() + cut.len() > MOST_TRIANGLES {
                let reason = format!("expected at most {MOST_TRIANGLES} triangles in all; use a coarser mesh");
                return Err(fail(line, reason));
            }
            triangle_lines.extend(cut.iter().map(|_| line));
            triangles.extend(cut.iter().map(|triangle| triangle.map(|index| corners[index])));
        }
        let point_lines = self.point_lines;
        let mesh = Mesh::counted_from((1, NEAR), flat.points, triangles).map_err(|error| {
            let line = match error {
                MeshError::Unused { vertex, .. } | MeshError::BowTie { vertex } => point_lines.get(vertex - 1),
                MeshError::NoArea { triangle, .. } | MeshError::Near { triangle, .. } => triangle_lines.get(triangle),
                _ => None,
            };
            let reason = error.to_string();
            match line {
                Some(&line) => fail(line, reason),
                None => MeshError::File { path: name(), reason },
            }
        })?;
        Ok(flat.messages.into_iter().fold(mesh, Mesh::with_message))
    }
}

/// Start of a word, for messages about files without text.
fn short(word: &str) -> String {
    word.chars().take(24).collect()
}

/// Greatest variation of the coordinate across the plane, as a share of the size of the mesh.
/// It is above the last printed digit of a file, and far below the thickness of a solid.
const FLATNESS: f64 = 1e-4;

/// Variations below this share of the size give no message.
const ROUND_OFF: f64 = 1e-9;

/// Names of the coordinates.
const NAMES: [char; 3] = ['x', 'y', 'z'];

/// Points in their plane.
struct Flat {
    pub points: Vec<[f64; 2]>,
    /// Messages for the user.
    pub messages: Vec<String>,
}

/// Points in their plane: x-y is tried before x-z, and x-z before y-z.
/// The planes x-z and y-z are seen from the side on which the faces run counter-clockwise. z points up or down in
/// x-z, and up in y-z. Points of the x-y plane stay unchanged.
///
/// # Errors
/// The first vertex outside every plane, and the reason.
fn flat<'a>(points: &[[f64; 3]], faces: impl Iterator<Item = &'a [u32]> + Clone) -> Result<Flat, (usize, String)> {
    let extent = |axis: usize| {
        let along = points.iter().map(|point| point[axis]);
        along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (value.min(low), value.max(high)))
    };
    let spans = [0, 1, 2].map(|axis| (extent(axis).1 - extent(axis).0).max(0.0));
    let size = spans.into_iter().fold(0.0, f64::max);
    let Some(across) = [2, 1, 0].into_iter().find(|&axis| spans[axis] <= FLATNESS * size || points.is_empty()) else {
        let [x, y, z] = spans;
        let first = points[0][2];
        let vertex = points.iter().position(|point| (point[2] - first).abs() > FLATNESS * size).unwrap_or(0);
        let reason = format!(
            "z is {}, but {first} before; expected a flat mesh, but the file spans {x} in x, {y} in y and {z} in z: make one of them the \
             same everywhere",
            points[vertex][2]
        );
        return Err((vertex, reason));
    };
    let axes = match across {
        2 => [0, 1],
        1 => [0, 2],
        _ => [1, 2],
    };
    let mut flat: Vec<_> = points.iter().map(|point| axes.map(|axis| point[axis])).collect();
    let mut messages = Vec::new();
    if across != 2 {
        let turns = |face: &[u32]| -> f64 {
            let at = |corner: u32| flat[corner as usize];
            face.windows(2).map(|side| area([at(face[0]), at(side[0]), at(side[1])])).sum()
        };
        let turned: f64 = faces.map(turns).sum();
        // Seen from the other side, the second axis of x-z points up and the first axis of y-z to the right.
        let mirrored = turned < 0.0;
        let axis = usize::from(across == 1);
        if mirrored {
            for point in &mut flat {
                point[axis] = -point[axis];
            }
        }
        let name = |number: usize| {
            let sign = if mirrored && number == axis { "-" } else { "" };
            format!("{sign}{}", NAMES[axes[number]])
        };
        let [a, b] = axes.map(|axis| NAMES[axis]);
        messages.push(format!(
            "the file's mesh lies in its {a}-{b} plane: its {} is x here, and its {} is y",
            name(0),
            name(1)
        ));
    }
    if spans[across] > ROUND_OFF * size {
        messages.push(format!("{} varies by {:.1e} m in the file, which is passed over", NAMES[across], spans[across]));
    }
    Ok(Flat { points: flat, messages })
}

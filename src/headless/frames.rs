//! States of a run over time for `ParaView` and other programs that read VTK: one file of an unstructured grid (`.vtu`) for each, and a
//! collection (`.pvd`) that says at which times they are. The format is that of *VTK File Formats*, with numbers as text.

use crate::{archive::Listed, elements::Field, files, scene::Scene, simulation::Simulation};
use std::{
    fmt::{Display, Write as _},
    path::{Path, PathBuf},
};

/// Fields of triangles that are written.
const FIELDS: [(Field, &str); 6] = [
    (Field::Volume, "area_ratio_j"),
    (Field::EnergyDensity, "energy_density"),
    (Field::Stretch, "principal_stretch"),
    (Field::PrincipalStress, "principal_stress"),
    (Field::VonMises, "von_mises_stress"),
    (Field::Pressure, "pressure"),
];

/// Kinds of VTK cells: a line between two points, and a triangle.
const LINE: u8 = 3;
const TRIANGLE: u8 = 5;

/// Frames that are written beside their collection.
pub struct Frames {
    collection: PathBuf,
    times: Vec<f64>,
    listed: Listed,
    failure: Option<String>,
}

impl Frames {
    /// Frames beside a collection, whose name ends in `.pvd`.
    ///
    /// # Errors
    /// If the name has another ending, or the scene is a toy.
    pub fn new(collection: &Path, scene: &Scene) -> Result<Self, String> {
        if collection.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("pvd")) {
            return Err("the name of the collection must end in .pvd".to_owned());
        }
        Ok(Self { collection: collection.to_path_buf(), times: Vec::new(), listed: Listed::new(scene)?, failure: None })
    }

    /// Writes a frame. After one that cannot be written no others are.
    pub fn record(&mut self, simulation: &Simulation) {
        if self.failure.is_some() {
            return;
        }
        let name = self.name(self.times.len());
        let written = files::write_text(&self.collection.with_file_name(name), &self.grid(simulation));
        self.failure = written.err().map(|error| error.to_string());
        self.times.push(simulation.state().time);
    }

    /// Text of the collection.
    ///
    /// # Errors
    /// If a frame could not be written.
    pub fn text(&self) -> Result<String, String> {
        if let Some(failure) = &self.failure {
            return Err(failure.clone());
        }
        let mut text =
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n".to_owned();
        for (number, time) in self.times.iter().enumerate() {
            let name = self.name(number).replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
            // Writing to a string cannot fail.
            let _ = writeln!(text, "<DataSet timestep=\"{time}\" file=\"{name}\"/>");
        }
        Ok(text + "</Collection>\n</VTKFile>\n")
    }

    fn name(&self, number: usize) -> String {
        format!("{}_{number:04}.vtu", self.collection.file_stem().unwrap_or_default().to_string_lossy())
    }

    fn grid(&self, simulation: &Simulation) -> String {
        let (scene, state) = (simulation.scene(), simulation.state());
        let Listed { vertices, triangles, springs } = &self.listed;
        let (points, cells) = (vertices.len(), triangles.len() + springs.len());
        let moved: Vec<_> = state.x.iter().zip(&scene.start.x).map(|(now, start)| now - start).collect();
        let mut text = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n\
             <UnstructuredGrid>\n<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">\n<PointData>\n"
        );
        for (name, values) in [("velocity", &state.v), ("displacement", &moved)] {
            array(&mut text, ["Float64", name, "3"], self.in_space(scene, values));
        }
        text += "</PointData>\n<CellData>\n";
        let mut values = Vec::new();
        for (field, name) in FIELDS {
            values.clear();
            for body in &scene.bodies {
                body.elements.diagnose(field, &state.x, &mut values);
            }
            for membrane in &scene.membranes {
                membrane.elements.add_values(field, &state.x, &mut values);
            }
            // Springs have none of these fields.
            let mut all = vec![0.0; cells];
            triangles.iter().zip(&values).for_each(|((place, _), value)| all[*place] = *value);
            array(&mut text, ["Float64", name, "1"], all);
        }
        text += "</CellData>\n<Points>\n";
        array(&mut text, ["Float64", "points", "3"], self.in_space(scene, &state.x));
        text += "</Points>\n<Cells>\n";
        let corners = self.listed.corners();
        array(&mut text, ["Int64", "connectivity", "1"], corners.iter().flatten().chain(springs.iter().flatten()));
        let counts = corners.iter().map(|_| 3).chain(springs.iter().map(|_| 2));
        array(
            &mut text,
            ["Int64", "offsets", "1"],
            counts.scan(0, |end, count| {
                *end += count;
                Some(*end)
            }),
        );
        let kinds = corners.iter().map(|_| TRIANGLE).chain(springs.iter().map(|_| LINE));
        array(&mut text, ["UInt8", "types", "1"], kinds);
        text + "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"
    }

    /// Three numbers for each vertex, as the level lists them.
    fn in_space(&self, scene: &Scene, values: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; 3 * self.listed.vertices.len()];
        for (place, own) in self.listed.vertices.iter().zip(values.chunks_exact(scene.dimension)) {
            all[3 * place..3 * place + own.len()].copy_from_slice(own);
        }
        all
    }
}

/// Appends an array of a type and a name, with so many numbers to a row.
fn array<T: Display>(text: &mut String, [kind, name, count]: [&str; 3], values: impl IntoIterator<Item = T>) {
    // Writing to a string cannot fail. As many digits are written as restore the same bits.
    let _ =
        writeln!(text, "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{count}\" format=\"ascii\">");
    for value in values {
        let _ = write!(text, "{value} ");
    }
    *text += "\n</DataArray>\n";
}

//! Bodies that are made in the window: drawn by hand, or from a mesh file that is opened or dropped.

use super::{App, canvas::Tool, panels::Notice};
use crate::{
    command::Command,
    files::{Disk, read_bytes},
    level::{BodyLevel, MassLevel, Place},
    materials::MaterialParameters,
    meshes::{MeshKind, Obj, Outline, Whole},
    outlines,
    quantity::{Angle, Coordinate, Density, Factor, Point},
};
use std::path::Path;

/// Ends of the names of files that bodies can be made of: meshes, then drawings and pictures with outlines.
pub const ENDINGS: [&str; 4] = ["obj", "msh", "svg", "png"];

/// Whether a file has the name of a mesh, or of a drawing or picture with outlines.
pub fn holds_body(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ENDINGS.iter().any(|known| ending.eq_ignore_ascii_case(known)))
}

/// Largest distance of a drawn line from its outline [points].
const SMOOTHING: f64 = 1.5;

/// Smallest width and height of a drawn body [points].
const SMALLEST: f64 = 12.0;

/// Numbers of triangles of a drawn body: the least, that where there is no other body, and the most.
const TRIANGLES: [f64; 3] = [40.0, 400.0, 2000.0];

/// Density of a body where there is no other [kg/m²].
const DENSITY: f64 = 100.0;

/// Size of a body from a file, as a share of the world.
const SIZE: f64 = 0.5;

/// The place that centres points in the world and scales them to [`SIZE`] of it.
fn fitted(points: &[[f64; 2]]) -> Place {
    let along = |axis: usize| {
        let numbers = || points.iter().map(move |point| point[axis]);
        [numbers().fold(f64::INFINITY, f64::min), numbers().fold(f64::NEG_INFINITY, f64::max)]
    };
    let [[left, right], [bottom, top]] = [along(0), along(1)];
    let scale = SIZE / (right - left).max(top - bottom);
    let number = |number: f64| Coordinate::new(number).unwrap_or(Coordinate::literal(0.0));
    Place {
        scale: Factor::new(scale).unwrap_or(Factor::literal(1.0)),
        turn: Angle::literal(0.0),
        offset: Point(number(0.5 - 0.5 * scale * (left + right)), number(0.5 - 0.5 * scale * (bottom + top))),
    }
}

impl App {
    /// Makes the bodies that were asked for since the last frame.
    pub(super) fn make(&mut self) {
        let of_b = self.comparison.as_mut().and_then(|panes| panes.stage.canvas_mut().take_tool());
        self.view.stage.tool = self.canvas.take_tool().or(of_b).unwrap_or(self.view.stage.tool);
        let of_b = self.comparison.as_mut().and_then(|panes| panes.stage.canvas_mut().take_part());
        self.view.body = self.canvas.take_part().or(of_b).unwrap_or(self.view.body);
        let of_b = self.comparison.as_mut().and_then(|panes| panes.stage.canvas_mut().take_outline());
        if let Some(outline) = self.canvas.take_outline().or(of_b) {
            self.view.stage.tool = Tool::Hand;
            self.add_drawn(outline);
        }
        if let Some(mesh) = self.view.new_body.take() {
            let name = mesh.name().to_lowercase();
            self.add_bodies(&name, vec![mesh], Place::default());
        }
    }

    /// Makes a body of an outline that was drawn \[m\], with a length on the screen of one point \[m\].
    pub(super) fn add_drawn(&mut self, (points, point): (Vec<[f64; 2]>, f64)) {
        let extent = |axis: usize| {
            let numbers = || points.iter().map(move |corner| corner[axis]);
            numbers().fold(f64::NEG_INFINITY, f64::max) - numbers().fold(f64::INFINITY, f64::min)
        };
        let is_large = extent(0).min(extent(1)) >= SMALLEST * point;
        let Some(mut outline) = Outline::of_line(&points, SMOOTHING * point).filter(|_| is_large) else {
            let text = "This outline is too small: draw a closed line, or click three corners or more.";
            self.view.notice = Some(Notice::Trouble(text.to_owned()));
            return;
        };
        let [least, usual, most] = TRIANGLES;
        let like_others = self.triangle_area().map_or(usual, |size| outline.area() / size).clamp(least, most);
        outline.resolution = Whole::try_from(like_others.round()).unwrap_or(outline.resolution);
        self.add_bodies("drawn body", vec![outline.into()], Place::default());
    }

    /// Adds the bodies of a file to the scene, or opens a level with them where the scene can have none. A mesh file is one body; a drawing or picture has one for each
    /// shape.
    pub(super) fn add_from_file(&mut self, path: &Path) {
        let path = crate::files::whole_path(path);
        let added = if outlines::is_picture(&path.to_string_lossy()) {
            read_bytes(&path).and_then(|bytes| self.outlines_of(&path, &bytes))
        } else {
            let kind = MeshKind::from(Obj { path: path.clone() });
            kind.kind().build(&Disk).map_err(|why| why.to_string()).map(|mesh| (vec![kind], mesh.points().to_vec()))
        };
        let (kinds, points) = match added {
            Ok(added) => added,
            Err(why) => {
                self.view.notice = Some(Notice::Trouble(format!("{}: {why}", path.display())));
                return;
            }
        };
        let place = fitted(&points);
        let name = path.file_stem().map_or_else(|| "body".to_owned(), |stem| stem.display().to_string());
        let now = &self.snapshot;
        if now.toy.is_none() && now.level.test.is_none() && now.dimension == 2 {
            self.add_bodies(&name, kinds, place);
            return;
        }
        let mut level = match self.gallery.first() {
            Ok(level) => level,
            Err(why) => {
                self.view.notice = Some(Notice::Trouble(why));
                return;
            }
        };
        let before = level.bodies.first().map_or_else(MaterialParameters::default, |body| body.material);
        let density = MassLevel::Density(Density::new(DENSITY).unwrap_or(Density::literal(DENSITY)));
        let number = |own: usize| if own == 0 { name.clone() } else { format!("{name} {}", own + 1) };
        let body = |(own, kind)| BodyLevel { place, ..BodyLevel::new(number(own), kind, before, density) };
        level.bodies = kinds.into_iter().enumerate().map(body).collect();
        (level.name, level.about) = (name, String::new());
        self.start(level);
    }

    /// Meshes of the shapes in a drawing or picture, which keep their places to each other, and all their points. Each can be built.
    fn outlines_of(&self, path: &Path, bytes: &[u8]) -> Result<(Vec<MeshKind>, Vec<[f64; 2]>), String> {
        let shapes = outlines::read(&path.to_string_lossy(), bytes).map_err(|why| why.to_string())?;
        let points: Vec<_> = shapes.iter().flat_map(|shape| shape.outer.iter().copied()).collect();
        let scale = fitted(&points).scale.get();
        let [least, usual, most] = TRIANGLES;
        let mut kinds = Vec::new();
        for (number, shape) in shapes.iter().enumerate() {
            let mut outline = Outline::of_shape(&shape.outer, &shape.holes).ok_or("its coordinates are too great")?;
            let count = self.triangle_area().map_or(usual, |size| outline.area() * scale * scale / size);
            outline.resolution = Whole::try_from(count.clamp(least, most).round()).unwrap_or(outline.resolution);
            let kind = MeshKind::from(outline);
            kind.kind().build(&Disk).map_err(|why| match shapes.len() {
                1 => why.to_string(),
                _ => format!("shape {}: {why}", number + 1),
            })?;
            kinds.push(kind);
        }
        Ok((kinds, points))
    }

    /// Adds bodies of the material and the density of the chosen body as one change, and chooses the last one.
    fn add_bodies(&mut self, name: &str, meshes: Vec<MeshKind>, place: Place) {
        let (density, chosen) = (self.density(), self.view.body);
        let density = Density::new(density).unwrap_or(Density::literal(DENSITY));
        let bodies = &self.settled().document().level.bodies;
        let (chosen, number) = (bodies.get(chosen).or(bodies.first()).cloned(), bodies.len());
        let material = chosen.as_ref().map_or_else(MaterialParameters::default, |body| body.material);
        let energy = chosen.and_then(|body| body.energy);
        let last = number + meshes.len().saturating_sub(1);
        let body = |mesh| BodyLevel {
            place,
            energy: energy.clone(),
            ..BodyLevel::new(name, mesh, material, MassLevel::Density(density))
        };
        if self.apply(None, Command::AddBodies(meshes.into_iter().map(body).collect())) {
            self.view.body = last;
        }
    }

    /// Density of the chosen body [kg/m²].
    fn density(&mut self) -> f64 {
        let chosen = self.view.body;
        let document = &self.settled().document().level;
        let place = if chosen < document.bodies.len() { chosen } else { 0 };
        let Some(listed) = document.bodies.get(place) else { return DENSITY };
        let (mass, scale) = (listed.mass, listed.place.scale.get());
        let shown = self.snapshot.bodies.get(place).map(|body| body.mesh.area() * scale * scale);
        match (mass, shown) {
            (MassLevel::Density(density) | MassLevel::Consistent(density), _) => density.get(),
            (MassLevel::Total(mass), Some(area)) if area > 0.0 => mass.get() / area,
            _ => DENSITY,
        }
    }

    /// Mean area of the triangles of all bodies at rest \[m²\].
    fn triangle_area(&self) -> Option<f64> {
        let scene = self.sandbox.simulation().scene();
        let areas = scene.bodies.iter().flat_map(|body| body.elements.rest_areas());
        let (sum, count) = areas.fold((0.0, 0_u32), |(sum, count), area| (sum + area, count + 1));
        (count > 0).then(|| sum / f64::from(count))
    }
}

//! Bodies that are made in the window: drawn by hand, or from a mesh file that is opened or dropped.

use super::{App, panels::Notice};
use crate::{
    command::Command,
    files::Disk,
    level::{BodyLevel, MassLevel, Place},
    materials::MaterialParameters,
    meshes::{MeshKind, Obj, Outline, Whole},
    quantity::{Angle, Coordinate, Density, Factor, Point},
};
use std::path::Path;

/// Ends of the names of mesh files.
const ENDINGS: [&str; 1] = ["obj"];

/// Whether a file has the name of a mesh.
pub fn is_mesh(path: &Path) -> bool {
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

impl App {
    /// Makes the bodies that were asked for since the last frame.
    pub(super) fn make(&mut self) {
        let of_b = self.comparison.as_mut().and_then(|panes| panes.stage.canvas_mut().take_outline());
        if let Some(outline) = self.canvas.take_outline().or(of_b) {
            self.view.stage.draws = false;
            self.add_drawn(outline);
        }
        if let Some(mesh) = self.view.new_body.take() {
            let name = mesh.name().to_lowercase();
            self.add_body(&name, mesh, Place::default());
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
        self.add_body("drawn body", outline.into(), Place::default());
    }

    /// Adds a body whose mesh is in a file to the scene, or opens a level with it where the scene can have none.
    pub(super) fn add_from_file(&mut self, path: &Path) {
        let path = crate::files::whole_path(path);
        let mesh = match MeshKind::from(Obj { path: path.clone() }).kind().build(&Disk) {
            Ok(mesh) => mesh,
            Err(why) => {
                self.view.notice = Some(Notice::Trouble(format!("{}: {why}", path.display())));
                return;
            }
        };
        let along = |axis: usize| {
            let numbers = || mesh.points().iter().map(move |point| point[axis]);
            [numbers().fold(f64::INFINITY, f64::min), numbers().fold(f64::NEG_INFINITY, f64::max)]
        };
        let [[left, right], [bottom, top]] = [along(0), along(1)];
        let scale = SIZE / (right - left).max(top - bottom);
        let number = |number: f64| Coordinate::new(number).unwrap_or(Coordinate::literal(0.0));
        let place = Place {
            scale: Factor::new(scale).unwrap_or(Factor::literal(1.0)),
            turn: Angle::literal(0.0),
            offset: Point(number(0.5 - 0.5 * scale * (left + right)), number(0.5 - 0.5 * scale * (bottom + top))),
        };
        let name = path.file_stem().map_or_else(|| "body".to_owned(), |stem| stem.display().to_string());
        let kind = MeshKind::from(Obj { path });
        let now = &self.snapshot;
        if now.toy.is_none() && now.level.test.is_none() && now.dimension == 2 {
            self.add_body(&name, kind, place);
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
        level.bodies = vec![BodyLevel { place, ..BodyLevel::new(name.clone(), kind, before, density) }];
        (level.name, level.about) = (name, String::new());
        self.start(level);
    }

    /// Adds a body of the material and the density of the chosen body, and chooses it.
    pub(super) fn add_body(&mut self, name: &str, mesh: MeshKind, place: Place) {
        let (density, chosen) = (self.density(), self.view.body);
        let density = Density::new(density).unwrap_or(Density::literal(DENSITY));
        let bodies = &self.settled().document().level.bodies;
        let (chosen, number) = (bodies.get(chosen).or(bodies.first()).cloned(), bodies.len());
        let material = chosen.as_ref().map_or_else(MaterialParameters::default, |body| body.material);
        let energy = chosen.and_then(|body| body.energy);
        let body = BodyLevel { place, energy, ..BodyLevel::new(name, mesh, material, MassLevel::Density(density)) };
        if self.apply(None, Command::AddBody(Box::new(body))) {
            self.view.body = number;
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
            (MassLevel::Density(density), _) => density.get(),
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

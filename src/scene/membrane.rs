//! Builds the membranes of a scene.

use super::{Scene, check_areas, material_of, numbering, start::reshape, stretched};
use crate::{
    elements::Membranes,
    level::MembraneLevel,
    meshes::{Files, MOST_TRIANGLES, Mesh, MeshKind, pinned},
    state::State,
};
use std::{ops::Range, sync::Arc};

/// One membrane of a scene.
#[derive(Clone)]
pub struct Membrane {
    /// Name from the level.
    pub name: String,
    /// Parameters of the mesh.
    recipe: MeshKind,
    /// The mesh of that recipe, and the factor of its lengths.
    unscaled: (Arc<Mesh>, f64),
    /// The mesh, which is flat, in its own coordinates.
    pub mesh: Arc<Mesh>,
    /// Its vertices in the scene.
    pub vertices: Range<usize>,
    /// Its elements.
    pub elements: Arc<Membranes>,
}

impl Membrane {
    /// Parameters of its mesh.
    pub const fn recipe(&self) -> &MeshKind {
        &self.recipe
    }
}

impl Scene {
    pub(super) fn add_membrane(
        &mut self,
        level: &MembraneLevel,
        files: &dyn Files,
        previous: Option<&Self>,
    ) -> Result<(), String> {
        let scale = level.space.scale.get();
        let before = previous.into_iter().flat_map(|scene| &scene.membranes);
        let known = || self.membranes.iter().chain(before.clone()).filter(|membrane| membrane.recipe == level.mesh);
        let unscaled = match known().next() {
            Some(membrane) => Arc::clone(&membrane.unscaled.0),
            None => Arc::new(numbering::mesh(level.mesh.kind().build(files).map_err(|error| error.to_string())?)),
        };
        let same = known().find(|membrane| membrane.unscaled.1 == scale).map(|membrane| Arc::clone(&membrane.mesh));
        let mesh = match same {
            Some(mesh) => mesh,
            None if scale == 1.0 => Arc::clone(&unscaled),
            None => Arc::new(unscaled.scaled(scale)),
        };
        let others = self.membranes.iter().map(|membrane| membrane.elements.corners().len());
        let total = mesh.triangles().len() + others.sum::<usize>();
        if total > MOST_TRIANGLES {
            return Err(format!("with it the level has {total} triangles, more than {MOST_TRIANGLES}"));
        }
        let first = self.vertices();
        let vertices = first..first + mesh.points().len();
        let flat = mesh.points().as_flattened();
        let in_space =
            |flat: &[f64]| flat.as_chunks().0.iter().flat_map(|point| level.space.placed(*point)).collect::<Vec<_>>();
        let rest = in_space(flat);
        if !rest.iter().all(|coordinate| coordinate.abs() <= State::LIMIT) {
            return Err(format!("its place puts it beyond {:e} m", State::LIMIT));
        }
        let material = material_of(level.energy.as_ref(), level.material)?;
        let elements = Arc::new(Membranes::new(vertices.clone(), &mesh, material, level.thickness.get()));
        check_areas(elements.rest_areas(), mesh.numbering())?;
        let areas = || elements.corners().iter().copied().zip(elements.rest_areas());
        self.add_masses(level.mass, &vertices, elements.thickness(), areas);
        let pins = pinned(&level.pins, flat, mesh.numbering())?;
        let (vx, vy, vz) = level.space.velocity;
        let at_start = stretched(level.stretch, flat);
        let mut local: Vec<_> = at_start.as_chunks().0.iter().flat_map(|[x, y]| [*x, *y, 0.0]).collect();
        reshape::<3>(level.start, (&pins, &[]), mesh.numbering(), &mut local);
        self.start.x.extend(local.as_chunks().0.iter().flat_map(|point| level.space.placed_from_plane(*point)));
        self.start.v.extend(vertices.clone().flat_map(|_| [vx.get(), vy.get(), vz.get()]));
        self.rest.extend(rest);
        Arc::make_mut(&mut self.pins).extend(pins.iter().map(|pin| pin + first as u32));
        self.messages.extend(mesh.messages().iter().map(|message| format!("{}: {message}", level.name)));
        let (name, recipe) = (level.name.clone(), level.mesh.clone());
        let unscaled = (unscaled, scale);
        self.membranes.push(Membrane { name, recipe, unscaled, mesh, vertices, elements });
        Ok(())
    }
}

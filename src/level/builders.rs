//! Levels built in code.

use super::{
    BodyLevel, EffectLevel, Level, MassLevel, MembraneLevel, NetLevel, SpacePlace, no_spin, no_velocity, unstretched,
};
use crate::{
    effects::EffectKind,
    elements::ElementKind,
    finish::Finish,
    materials::{BadMaterial, MaterialParameters, Model, TypedEnergy},
    meshes::MeshKind,
    nets::NetKind,
    quantity::ParticleMass,
};

use std::path::PathBuf;

impl Level {
    /// The files of meshes and surfaces that it names.
    pub fn mesh_paths_mut(&mut self) -> Vec<&mut PathBuf> {
        let bodies = self.bodies.iter_mut().map(|body| &mut body.mesh);
        let meshes = bodies.chain(self.membranes.iter_mut().map(|membrane| &mut membrane.mesh));
        let meshes = meshes.filter_map(|mesh| mesh.kind_mut().path_mut());
        let surfaces = self.effects.iter_mut().flat_map(|listed| listed.effect.kind_mut().surface_paths_mut());
        meshes.chain(surfaces).collect()
    }

    /// How a net or membrane looks (by number: nets first, then membranes); `None` if there is no such.
    pub fn finish_mut(&mut self, number: usize) -> Option<&mut Finish> {
        let nets = self.nets.iter_mut().map(|net| &mut net.finish);
        nets.chain(self.membranes.iter_mut().map(|membrane| &mut membrane.finish)).nth(number)
    }

    /// Where a net or membrane is put in space (by number: nets first, then membranes); `None` if there is no such in space.
    pub fn space(&self, number: usize) -> Option<&SpacePlace> {
        let nets = self.nets.iter().map(|net| net.space.as_ref());
        nets.chain(self.membranes.iter().map(|membrane| Some(&membrane.space))).nth(number)?
    }

    /// The same, to be changed.
    pub fn space_mut(&mut self, number: usize) -> Option<&mut SpacePlace> {
        let nets = self.nets.iter_mut().map(|net| net.space.as_mut());
        nets.chain(self.membranes.iter_mut().map(|membrane| Some(&mut membrane.space))).nth(number)?
    }

    /// A level without bodies and effects, with the defaults of a level file.
    ///
    /// ```
    /// use gingerbread::{
    ///     effects::Gravity,
    ///     integrators::ImplicitEuler,
    ///     level::{BodyLevel, Level, MassLevel, Pin},
    ///     materials::MaterialParameters,
    ///     meshes::{Disk, NoFiles},
    ///     quantity::Density,
    ///     scene::Scene,
    ///     simulation::Simulation,
    /// };
    ///
    /// let jelly = MaterialParameters::default();
    /// let density = MassLevel::Density(Density::new(100.0)?);
    /// let disk = BodyLevel { pins: vec![Pin::Top], ..BodyLevel::new("disk", Disk::default(), jelly, density) };
    /// let level = Level::new("Hanging disk").with_body(disk).with_effect(Gravity::default());
    /// let level = Level { integrator: ImplicitEuler::default().into(), ..level };
    ///
    /// let scene = Scene::build(&level, level.mode, &NoFiles, None)?;
    /// let mut simulation = Simulation::open(scene, &level, level.mode)?;
    /// simulation.advance(10, &mut || true);
    /// assert!(simulation.energies().elastic > 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), ..Self::default() }
    }

    /// The level with one more body.
    #[must_use]
    pub fn with_body(mut self, body: BodyLevel) -> Self {
        self.bodies.push(body);
        self
    }

    /// The level with one more net.
    #[must_use]
    pub fn with_net(mut self, net: NetLevel) -> Self {
        self.nets.push(net);
        self
    }

    /// Names of its bodies, nets and membranes, in their order in a scene.
    pub fn part_names(&self) -> impl Iterator<Item = &String> {
        let nets = self.nets.iter().map(|net| &net.name);
        let membranes = self.membranes.iter().map(|membrane| &membrane.name);
        self.bodies.iter().map(|body| &body.name).chain(nets).chain(membranes)
    }

    /// Gives all bodies and membranes a constitutive model, in place of typed energies and own materials too.
    ///
    /// # Errors
    /// If one cannot have it; those before it have it then.
    pub fn set_model(&mut self, model: Model) -> Result<(), BadMaterial> {
        for body in &mut self.bodies {
            body.material = body.material.try_with_model(model)?;
            (body.own_material, body.energy) = (None, None);
        }
        for membrane in &mut self.membranes {
            membrane.material = membrane.material.try_with_model(model)?;
            membrane.energy = None;
        }
        Ok(())
    }

    /// The typed energy of a body or membrane, by the number of the part, if it has one.
    pub fn energy(&self, part: usize) -> Option<&TypedEnergy> {
        let bodies = self.bodies.iter().map(|body| body.energy.as_ref()).chain(self.nets.iter().map(|_| None));
        bodies.chain(self.membranes.iter().map(|membrane| membrane.energy.as_ref())).nth(part)?
    }

    /// The same, to be changed; nets have none.
    pub fn energy_mut(&mut self, part: usize) -> Option<&mut Option<TypedEnergy>> {
        let Self { bodies, nets, membranes, .. } = self;
        let (count, others) = (bodies.len(), bodies.len() + nets.len());
        if part < count {
            return Some(&mut bodies[part].energy);
        }
        membranes.get_mut(part.checked_sub(others)?).map(|membrane| &mut membrane.energy)
    }

    /// The level with one more membrane.
    #[must_use]
    pub fn with_membrane(mut self, membrane: MembraneLevel) -> Self {
        self.membranes.push(membrane);
        self
    }

    /// The level with one more effect, which acts in every mode.
    #[must_use]
    pub fn with_effect(mut self, effect: impl Into<EffectKind>) -> Self {
        self.effects.push(EffectLevel {
            effect: effect.into(),
            switch: super::Switch::Auto,
            when: super::When::Always,
        });
        self
    }
}

impl BodyLevel {
    /// A body at rest, free and in its rest shape.
    pub fn new(
        name: impl Into<String>,
        mesh: impl Into<MeshKind>,
        material: MaterialParameters,
        mass: MassLevel,
    ) -> Self {
        Self {
            name: name.into(),
            mesh: mesh.into(),
            element: ElementKind::default(),
            place: super::Place::default(),
            material,
            own_material: None,
            energy: None,
            mass,
            stretch: unstretched(),
            start: super::StartShape::default(),
            velocity: no_velocity(),
            spin: no_spin(),
            pins: Vec::new(),
            slides: Vec::new(),
        }
    }
}

impl NetLevel {
    /// A net at rest and free, each of whose particles has a mass.
    pub fn new(name: impl Into<String>, net: impl Into<NetKind>, mass: ParticleMass) -> Self {
        let (velocity, pins, finish) = (no_velocity(), Vec::new(), Finish::default());
        Self { name: name.into(), net: net.into(), mass, velocity, pins, space: None, finish }
    }
}

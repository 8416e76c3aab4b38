//! Sub-scenes: scenes of single bodies and nets.

use super::{Scene, SceneError};
use crate::{
    elements::Elements,
    integrators::Class,
    level::{EffectLevel, Level, RunMode, SubstepMode, When},
    meshes::Files,
};
use std::{
    ops::Range,
    sync::{Arc, OnceLock},
};

/// A scene with one body or net and the effects that act on it.
pub struct SubScene {
    /// Level that it was built from.
    level: Level,
    /// The scene of this body or net alone.
    pub scene: Scene,
    /// Its vertices in the whole scene.
    pub vertices: Range<usize>,
    /// The number of each of its effects in the whole scene.
    pub effects: Vec<usize>,
    /// Its critical step at rest, computed on first use.
    limit: OnceLock<Option<f64>>,
}

impl SubScene {
    /// Its critical step at rest \[s\], if it has stiffness; computed by `measure` on first use.
    pub fn limit(&self, measure: impl FnOnce(&Scene) -> Option<f64>) -> Option<f64> {
        *self.limit.get_or_init(|| measure(&self.scene))
    }
}

impl Scene {
    /// Builds the sub-scenes for multirate stepping. Unchanged ones of `previous` are reused.
    pub(super) fn build_sub_scenes(
        &mut self,
        level: &Level,
        mode: RunMode,
        files: &dyn Files,
        previous: Option<&Self>,
    ) -> Result<(), SceneError> {
        if level.paces == SubstepMode::Same || self.integrator.kind().class() != Class::Explicit {
            return Ok(());
        }
        if self.parts.len() > 1 && self.effects.iter().any(|effect| effect.surface_contact().is_some()) {
            let message = "All bodies take the same steps, because they may touch each other";
            self.messages.push(message.to_owned());
            return Ok(());
        }
        if self.couples_parts() {
            let message = "All bodies take the same steps, because an effect acts on them together";
            self.messages.push(message.to_owned());
            return Ok(());
        }
        let (rest, start) = (Arc::new(self.rest.clone()), Arc::new(self.start.x.clone()));
        let surfaces = self.elements.surfaces.clone();
        let all = Elements { rest, start, surfaces, ..Elements::default() };
        let bodies = level.bodies.iter().zip(&self.bodies).map(|(listed, body)| {
            let elements = Elements { triangles: vec![Arc::clone(&body.elements)], ..all.clone() };
            (Level { bodies: vec![listed.clone()], ..Level::default() }, body.vertices.clone(), elements)
        });
        let nets = level.nets.iter().zip(&self.nets).map(|(listed, net)| {
            let elements = Elements {
                springs: vec![net.springs.clone()],
                faces: vec![Arc::clone(&net.faces)],
                spring_numbers: vec![net.numbering.clone()],
                ..all.clone()
            };
            (Level { nets: vec![listed.clone()], ..Level::default() }, net.vertices.clone(), elements)
        });
        let membranes = level.membranes.iter().zip(&self.membranes).map(|(listed, membrane)| {
            let elements = Elements { membranes: vec![Arc::clone(&membrane.elements)], ..all.clone() };
            (Level { membranes: vec![listed.clone()], ..Level::default() }, membrane.vertices.clone(), elements)
        });
        let there =
            |listed: &&EffectLevel| listed.switch.is_on() && (listed.when == When::Always || mode == RunMode::Collide);
        let mut sub_scenes = Vec::new();
        let parts = bodies.chain(nets).chain(membranes).zip(self.flat_shapes());
        for (number, ((own, vertices, elements), shape)) in parts.enumerate() {
            let names = own.part_names().cloned().collect();
            let elements = Elements { names, shapes: vec![shape], ..elements };
            // Effects that cannot act on it, as the compression guard on a net, are omitted.
            let acting = level.effects.iter().filter(there).zip(self.element_count()..);
            let acting = acting.filter(|(listed, _)| listed.effect.kind().build(&elements).is_ok());
            let (listed, numbers): (Vec<_>, Vec<_>) = acting.map(|(listed, number)| (listed.clone(), number)).unzip();
            let effects = std::iter::once(number).chain(numbers).collect::<Vec<_>>();
            let own = Level { mode, effects: listed, ..own };
            let known = previous.and_then(|scene| scene.sub_scenes.get(number));
            let same =
                |known: &&Arc<SubScene>| (&known.level, &known.vertices, &known.effects) == (&own, &vertices, &effects);
            if let Some(known) = known.filter(same) {
                sub_scenes.push(Arc::clone(known));
                continue;
            }
            let scene = Self::build(&own, mode, files, Some(self))?;
            sub_scenes.push(Arc::new(SubScene { level: own, scene, vertices, effects, limit: OnceLock::new() }));
        }
        self.sub_scenes = sub_scenes;
        Ok(())
    }
}

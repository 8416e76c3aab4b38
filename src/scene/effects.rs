//! Effects of a scene: building, outward normals, and checks of their combination.

use super::{Scene, SceneError};
use crate::{
    contact::{ContactModel, ContactProperties, SurfaceVertices},
    effects::{DuplicatePolicy, Effect},
    elements::{ElasticElements, Elements, FlatShape, NetSprings},
    level::{EffectLevel, Level, RunMode, Switch},
    meshes::Files,
    obstacles::{ObstacleKind, Surfaces},
};
use std::sync::Arc;

/// An effect of the level that acts, by which contacts are known again in another scene.
#[derive(Clone, Debug, PartialEq)]
pub struct ActingEffect {
    /// Its place in the level.
    pub place: usize,
    /// Name of its kind.
    pub name: &'static str,
    /// Its obstacles.
    pub obstacles: Vec<ObstacleKind>,
}

impl ActingEffect {
    fn new(place: usize, listed: &EffectLevel) -> Self {
        Self { place, name: listed.effect.name(), obstacles: listed.effect.kind().obstacles().to_vec() }
    }
}

impl Scene {
    /// Builds the effects of a level: elasticity first, then what is switched on for a mode, in the order of the list.
    pub(super) fn add_effects(
        &mut self,
        level: &Level,
        mode: RunMode,
        files: &dyn Files,
        previous: Option<&Self>,
    ) -> Result<(), SceneError> {
        let paths = level.effects.iter().flat_map(|listed| listed.effect.kind().surface_paths());
        let known = previous.map(|scene| &scene.elements.surfaces);
        let mut elements = Elements {
            triangles: self.bodies.iter().map(|body| Arc::clone(&body.elements)).collect(),
            springs: self.nets.iter().map(|net| net.springs.clone()).collect(),
            faces: self.nets.iter().map(|net| Arc::clone(&net.faces)).collect(),
            spring_numbers: self.nets.iter().map(|net| net.numbering.clone()).collect(),
            membranes: self.membranes.iter().map(|membrane| Arc::clone(&membrane.elements)).collect(),
            names: level.part_names().cloned().collect(),
            shapes: self.flat_shapes(),
            rest: Arc::new(self.rest.clone()),
            start: Arc::new(self.start.x.clone()),
            surface: Arc::new(self.surface_vertices()),
            contact: ContactModel::default(),
            surfaces: Surfaces::read(paths, files, known),
        };
        let bodies = elements.triangles.iter().map(|body| Arc::clone(body) as Arc<dyn ElasticElements>);
        let nets = elements.springs.iter().map(NetSprings::elements);
        let membranes = elements.membranes.iter().map(|membrane| Arc::clone(membrane) as Arc<dyn ElasticElements>);
        self.set_parts(bodies.chain(nets).chain(membranes).collect());
        self.messages.extend(examined(&level.effects)?);
        let mut touching = Touching::default();
        let build = |listed: &EffectLevel, elements: &Elements| {
            let name = listed.effect.name();
            listed.effect.kind().build(elements).map_err(|why| SceneError::Effect { name, why })
        };
        let acts = |listed: &&EffectLevel| listed.acts_in(mode);
        // An effect that is off is built too, so that its errors are found.
        for listed in &level.effects {
            touching.add(build(listed, &elements)?.as_ref());
        }
        let mut properties = ContactProperties::default();
        for listed in level.effects.iter().filter(acts) {
            build(listed, &elements)?.set_properties(&mut properties);
        }
        let (is_filter, has_skin) = (properties.filter.is_some(), properties.skin.is_some());
        elements.contact = properties.into();
        let acting = level.effects.iter().enumerate().filter(|(_, listed)| acts(listed));
        self.acting = Arc::new(acting.map(|(place, listed)| ActingEffect::new(place, listed)).collect());
        for listed in level.effects.iter().filter(acts) {
            let mut effect = build(listed, &elements)?;
            if let Some(dimension) = effect.dimension().filter(|dimension| *dimension != self.dimension) {
                return Err(SceneError::Dimension { effect: listed.effect.name(), dimension, scene: self.dimension });
            }
            effect.set_number(self.effects.len());
            self.effects.push(Arc::from(effect));
            self.auto.push(listed.switch == Switch::Auto);
        }
        self.check_projection()?;
        self.check_held()?;
        self.check_masses()?;
        if is_filter && has_skin {
            self.messages.push("The contact potential does nothing: a filter takes its place".to_owned());
        }
        self.messages.extend(touching.messages());
        self.elements = Arc::new(elements);
        Ok(())
    }

    /// # Errors
    /// [`SceneError::Projection`] if the scheme cannot continue from positions that a projection changed.
    pub(super) fn check_projection(&self) -> Result<(), SceneError> {
        let integrator = self.integrator.kind();
        let projects = self.effects.iter().any(|effect| effect.projection().is_some());
        if projects && !integrator.allows_projection() {
            return Err(SceneError::Projection(integrator.title()));
        }
        Ok(())
    }

    /// # Errors
    /// [`SceneError::Effect`] if two effects move one vertex.
    pub(super) fn check_held(&self) -> Result<(), SceneError> {
        let mut held: Vec<_> = self.held().collect();
        held.sort_unstable();
        let Some(vertex) = held.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0]) else { return Ok(()) };
        let listed = self.owner_of(vertex as usize).map_or(vertex as usize, |(_, number)| number);
        let why = format!("two of them move vertex {listed}; take it out of the pins of one");
        Err(SceneError::Effect { name: "MovingPins", why })
    }

    /// # Errors
    /// [`SceneError::Effect`] if an effect needs lumped masses, and they are not.
    pub(super) fn check_masses(&self) -> Result<(), SceneError> {
        let is_lumped = self.coupled_mass.is_empty();
        let needs = |effect: &&Arc<dyn Effect>| effect.constraints().is_some() || effect.held_vertices().is_some();
        let Some(effect) = self.effects.iter().find(needs).filter(|_| !is_lumped) else { return Ok(()) };
        let why =
            "it needs lumped masses: give the bodies and membranes a Density or a Total in place of a Consistent mass";
        Err(SceneError::Effect { name: effect.name(), why: why.to_owned() })
    }

    pub(super) fn flat_shapes(&self) -> Vec<FlatShape> {
        let bodies = self.bodies.iter().map(|body| FlatShape {
            first: body.vertices.start as u32,
            points: self.rest[self.numbers(&body.vertices)].to_vec(),
            numbering: body.mesh.numbering().clone(),
        });
        let nets = self.nets.iter().map(|net| FlatShape {
            first: net.vertices.start as u32,
            points: net.points.as_flattened().to_vec(),
            numbering: net.numbering.clone(),
        });
        let membranes = self.membranes.iter().map(|membrane| FlatShape {
            first: membrane.vertices.start as u32,
            points: membrane.mesh.points().as_flattened().to_vec(),
            numbering: membrane.mesh.numbering().clone(),
        });
        bodies.chain(nets).chain(membranes).collect()
    }

    /// Vertices that can have a skin: the boundaries of bodies, the particles of nets, and the vertices of membranes.
    fn surface_vertices(&self) -> SurfaceVertices {
        let mut surface = SurfaceVertices::default();
        for body in &self.bodies {
            let edges: Vec<_> =
                body.boundary.iter().map(|edge| edge.map(|vertex| vertex + body.vertices.start as u32)).collect();
            surface.add_body(&body.elements, &edges, &self.rest, &self.mass);
        }
        for net in &self.nets {
            surface.add_net(&net.springs, &self.mass);
        }
        for membrane in &self.membranes {
            surface.add_membrane(&membrane.elements, &self.mass);
        }
        surface
    }
}

/// Messages about effects that are listed more than once or have no effect, on or off. Places count from 1.
///
/// # Errors
/// If only one of several equal effects can act.
fn examined(listed: &[EffectLevel]) -> Result<Vec<String>, SceneError> {
    let mut messages = Vec::new();
    for (number, EffectLevel { effect, .. }) in listed.iter().enumerate() {
        messages.extend(effect.kind().notes());
        messages.extend(
            effect
                .kind()
                .ineffective()
                .map(|why| format!("{} (effect {}) does nothing: {why}", effect.kind().title(), number + 1)),
        );
        let earlier = listed[..number].iter().position(|other| other.effect.name() == effect.name());
        let Some(place) = earlier.map(|earlier| format!("listed twice, as effects {} and {}", earlier + 1, number + 1))
        else {
            continue;
        };
        let (name, title) = (effect.name(), effect.kind().title());
        match effect.kind().duplicate_policy() {
            DuplicatePolicy::Both => {}
            DuplicatePolicy::Odd(why) => messages.push(format!("{title} is {place}: {why}")),
            DuplicatePolicy::Ambiguous(why) => {
                return Err(SceneError::Effect { name, why: format!("{place}, but {why}; take one of them out") });
            }
        }
    }
    Ok(messages)
}

/// Effects of a level that set properties of contacts, and whether anything can touch.
#[derive(Default)]
struct Touching {
    property_effects: Vec<&'static str>,
    can_touch: bool,
}

impl Touching {
    /// Adds an effect, on or off.
    fn add(&mut self, effect: &dyn Effect) {
        let mut properties = ContactProperties::default();
        effect.set_properties(&mut properties);
        if properties != ContactProperties::default() && properties.skin.is_none() {
            self.property_effects.push(effect.name());
        }
        self.can_touch |= effect.obstacle_contact().is_some() || properties.skin.is_some();
    }

    /// Messages for the user.
    fn messages(self) -> impl Iterator<Item = String> {
        let idle = if self.can_touch { Vec::new() } else { self.property_effects };
        idle.into_iter().map(|name| format!("{name} needs walls or a domain boundary: without them nothing touches"))
    }
}

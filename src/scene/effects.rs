//! Effects of a scene: building, outward normals, and checks of their combination.

use super::{Scene, SceneError};
use crate::{
    contact::SurfaceVertices,
    effects::{DuplicatePolicy, Effect},
    elements::{ElasticElements, Elements},
    level::{EffectLevel, Level, RunMode, Switch, When},
    obstacles::Surface,
};
use std::sync::Arc;

impl Scene {
    /// Builds the effects of a level: elasticity first, then what is switched on for a mode, in the order of the list.
    pub(super) fn add_effects(&mut self, level: &Level, mode: RunMode) -> Result<(), SceneError> {
        let mut elements = Elements {
            triangles: self.bodies.iter().map(|body| Arc::clone(&body.elements)).collect(),
            springs: self.nets.iter().map(|net| Arc::clone(&net.springs)).collect(),
            boundary: Arc::clone(&self.boundary),
            rest: Arc::new(self.rest.clone()),
            skinned: Arc::new(self.surface_vertices()),
            skin: None,
        };
        let bodies = elements.triangles.iter().map(|body| Arc::clone(body) as Arc<dyn ElasticElements>);
        let nets = elements.springs.iter().map(|net| Arc::clone(net) as Arc<dyn ElasticElements>);
        self.set_parts(bodies.chain(nets).collect());
        self.messages.extend(examined(&level.effects)?);
        let mut touching = Touching::default();
        let build = |listed: &EffectLevel, elements: &Elements| {
            let name = listed.effect.name();
            listed.effect.kind().build(elements).map_err(|why| SceneError::Effect { name, why })
        };
        let acts =
            |listed: &&EffectLevel| listed.switch.is_on() && (listed.when == When::Always || mode == RunMode::Collide);
        // An effect that is off is built too, so that its errors are found.
        for listed in &level.effects {
            touching.add(build(listed, &elements)?.as_ref());
        }
        let (mut surface, mut skin) = (Surface::default(), None);
        for listed in level.effects.iter().filter(acts) {
            let effect = build(listed, &elements)?;
            effect.set_surface(&mut surface);
            skin = skin.or(effect.skin());
        }
        elements.skin = skin.map(|skin| (skin, surface.friction));
        for listed in level.effects.iter().filter(acts) {
            let mut effect = build(listed, &elements)?;
            effect.set_number(self.effects.len());
            self.effects.push(Arc::from(effect));
            self.auto.push(listed.switch == Switch::Auto);
        }
        if skin.is_some() && surface.restitution != 0.0 {
            let message =
                "Restitution does nothing: with a contact potential the dissipation of the skin says how much returns";
            self.messages.push(message.to_owned());
        }
        self.messages.extend(touching.messages());
        Ok(())
    }

    /// Vertices that can have a skin: the boundaries of bodies, and the particles of nets.
    fn surface_vertices(&self) -> SurfaceVertices {
        let mut surface = SurfaceVertices::default();
        for body in &self.bodies {
            let edges: Vec<_> =
                body.boundary.iter().map(|edge| edge.map(|vertex| vertex + body.vertices.start as u32)).collect();
            surface.add_body(&body.elements, &edges, &self.rest, &self.mass);
        }
        self.nets.iter().for_each(|net| surface.add_net(&net.springs, &self.mass));
        surface
    }

    /// Writes an outward vector at each boundary vertex, the sum of the normals of its two edges with the lengths of
    /// the edges: zero inside bodies, and NaN for the particles of nets, which have no inside.
    pub fn outward(&self, x: &[f64], outward: &mut Vec<f64>) {
        outward.clear();
        outward.resize(self.dimension * self.bodies.last().map_or(0, |body| body.vertices.end), 0.0);
        outward.resize(x.len(), f64::NAN);
        for [a, b] in self.boundary.iter().map(|edge| edge.map(|vertex| 2 * vertex as usize)) {
            let right = [x[b + 1] - x[a + 1], x[a] - x[b]];
            for at in [a, b] {
                outward[at] += right[0];
                outward[at + 1] += right[1];
            }
        }
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

/// Surface effects of a level, and whether it has constraints.
#[derive(Default)]
struct Touching {
    surface_effects: Vec<&'static str>,
    constraints: bool,
}

impl Touching {
    /// Adds an effect, on or off.
    fn add(&mut self, effect: &dyn Effect) {
        let mut surface = Surface::default();
        effect.set_surface(&mut surface);
        if surface != Surface::default() {
            self.surface_effects.push(effect.name());
        }
        self.constraints |= effect.constrains() || effect.skin().is_some();
    }

    /// Messages for the user.
    fn messages(self) -> impl Iterator<Item = String> {
        let idle = if self.constraints { Vec::new() } else { self.surface_effects };
        idle.into_iter().map(|name| format!("{name} needs walls or a domain boundary: without them nothing touches"))
    }
}

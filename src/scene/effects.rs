//! The effects of a scene, what it tells those that constrain, and whether they fit together: there are constraints for those
//! that need one, and nothing is listed twice that can count but once.

use super::{Scene, SceneError};
use crate::{
    effects::{DuplicatePolicy, Effect},
    elements::Elements,
    level::{EffectLevel, Level, RunMode, Switch, When},
    obstacles::Surface,
};
use std::sync::Arc;

impl Scene {
    /// Builds the effects of a level: elasticity first, then what is switched on for a mode, in the order of the list.
    pub(super) fn add_effects(&mut self, level: &Level, mode: RunMode) -> Result<(), SceneError> {
        let elements = Elements {
            triangles: self.bodies.iter().map(|body| Arc::clone(&body.elements)).collect(),
            springs: self.nets.iter().map(|net| Arc::clone(&net.springs)).collect(),
            boundary: Arc::clone(&self.boundary),
        };
        self.effects.extend(elements.triangles.iter().map(|body| Arc::clone(body) as Arc<dyn Effect>));
        self.effects.extend(elements.springs.iter().map(|net| Arc::clone(net) as Arc<dyn Effect>));
        self.auto = vec![true; self.effects.len()];
        self.messages.extend(examined(&level.effects)?);
        let mut touching = Touching::default();
        for listed in &level.effects {
            let name = listed.effect.name();
            // Built even when it is off, so that a level with a mistake in it is never half accepted.
            let effect = listed.effect.kind().build(&elements).map_err(|why| SceneError::Effect { name, why })?;
            touching.add(effect.as_ref());
            if listed.switch.is_on() && (listed.when == When::Always || mode == RunMode::Collide) {
                self.effects.push(Arc::from(effect));
                self.auto.push(listed.switch == Switch::Auto);
            }
        }
        self.messages.extend(touching.messages());
        Ok(())
    }

    /// Writes a vector outwards from the body at each vertex of a boundary, as long as the edges beside it: zero inside bodies,
    /// and not a number for the particles of nets, which have no inside.
    pub fn outward(&self, x: &[f64], outward: &mut Vec<f64>) {
        outward.clear();
        outward.resize(2 * self.bodies.last().map_or(0, |body| body.vertices.end), 0.0);
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

/// What a person should know of effects that are listed more than once or without effect, switched on or not. Places count from 1.
///
/// # Errors
/// If only one of them can count.
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

/// Which effects of a level say what touching does, and whether there is anything to touch.
#[derive(Default)]
struct Touching {
    surface_effects: Vec<&'static str>,
    constraints: bool,
}

impl Touching {
    /// Looks at an effect, whether it is switched on or not.
    fn add(&mut self, effect: &dyn Effect) {
        let mut surface = Surface::default();
        effect.set_surface(&mut surface);
        if surface != Surface::default() {
            self.surface_effects.push(effect.name());
        }
        self.constraints |= effect.constrains();
    }

    /// What a person should know.
    fn messages(self) -> impl Iterator<Item = String> {
        let idle = if self.constraints { Vec::new() } else { self.surface_effects };
        idle.into_iter().map(|name| format!("{name} needs walls or a domain boundary: without them nothing touches"))
    }
}

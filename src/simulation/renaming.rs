//! Memory of contacts in a scene that replaces another. Contacts are named by the numbers of effects and obstacles, which may be others there.

use super::Simulation;
use crate::{
    contact::{Anchor, ContactName, ObstacleTerm},
    obstacles::ObstacleKind,
    scene::{ActingEffect, Scene},
};

/// The numbers in a new scene of the effects and obstacles of the one that it replaces.
struct Renaming<'a> {
    scenes: [&'a Scene; 2],
    /// Of each effect that acted.
    effects: Vec<Option<Renamed>>,
}

struct Renamed {
    /// Number of the effect.
    effect: usize,
    /// Numbers of its obstacles, and whether each is what it was; `None` where all are.
    obstacles: Option<Vec<Option<(usize, bool)>>>,
}

impl<'a> Renaming<'a> {
    /// From one scene to another with the same parts. Effects keep their places in the level.
    fn new([old, new]: [&'a Scene; 2]) -> Self {
        let renamed = |before: &ActingEffect| {
            let is_it = |now: &ActingEffect| (now.place, now.name) == (before.place, before.name);
            let effect = new.acting.iter().position(is_it)?;
            let obstacles = [&before.obstacles, &new.acting[effect].obstacles];
            Some(Renamed { effect, obstacles: (obstacles[0] != obstacles[1]).then(|| matched(obstacles)) })
        };
        Self { scenes: [old, new], effects: old.acting.iter().map(renamed).collect() }
    }

    /// The new name of a contact; `None` where it was with what is no longer there.
    fn renamed(&self, name: ContactName) -> Option<ContactName> {
        let [old, new] = self.scenes;
        let number = (name.effect as usize).checked_sub(old.element_count())?;
        let Renamed { effect, obstacles } = self.effects.get(number)?.as_ref()?;
        let effect = new.element_count() + effect;
        let Some(obstacles) = obstacles else { return Some(ContactName { effect: effect as u32, ..name }) };
        let (obstacle, part) = obstacle_contact(old, name.effect as usize)?.split(name.surface)?;
        let (obstacle, is_same) = (*obstacles.get(obstacle)?)?;
        // Of an obstacle that has another size in space, triangles may touch other points.
        if part > 0 && !is_same && old.dimension == 3 {
            return None;
        }
        let surface = obstacle_contact(new, effect)?.surface_of(obstacle, part)?;
        Some(ContactName { effect: effect as u32, surface, ..name })
    }
}

fn obstacle_contact(scene: &Scene, effect: usize) -> Option<&dyn ObstacleTerm> {
    scene.effects.get(effect)?.obstacle_contact()
}

/// The numbers of obstacles in another list, and whether they are what they were. What is equal at the beginning and at the end of both lists is the same. Between
/// them, as many obstacles are the same ones, changed; of more or fewer, those that are equal in turn are.
fn matched([old, new]: [&Vec<ObstacleKind>; 2]) -> Vec<Option<(usize, bool)>> {
    let most = old.len().min(new.len());
    let begin = (0..most).take_while(|number| old[*number] == new[*number]).count();
    let end = (1..=most - begin).take_while(|back| old[old.len() - back] == new[new.len() - back]).count();
    let (between, others) = (begin..old.len() - end, &new[begin..new.len() - end]);
    let mut first = 0;
    let mut next = |number: usize| {
        if between.len() == others.len() {
            return Some((number, old[number] == new[number]));
        }
        let found = first + others.get(first..)?.iter().position(|other| *other == old[number])?;
        first = found + 1;
        Some((begin + found, true))
    };
    let middle: Vec<_> = between.clone().map(&mut next).collect();
    let last = (between.end..old.len()).map(|number| Some((number + new.len() - old.len(), true)));
    (0..begin).map(|number| Some((number, true))).chain(middle).chain(last).collect()
}

impl Simulation {
    /// Renames the contacts in the memory of the state for a scene that replaces this one.
    pub(super) fn rename_contacts(&mut self, scene: &Scene) {
        if self.scene.acting == scene.acting {
            return;
        }
        let renaming = Renaming::new([&self.scene, scene]);
        let rename = |anchor: Anchor| Some(Anchor { contact: renaming.renamed(anchor.contact)?, ..anchor });
        self.state.anchors = std::mem::take(&mut self.state.anchors).into_iter().filter_map(rename).collect();
        self.state.anchors.sort_unstable_by_key(|anchor| anchor.contact);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::obstacles::{Ball, Cuboid, Polygon};

    #[test]
    fn obstacles_are_known_again_in_another_list() {
        let [a, b, c] = [
            ObstacleKind::Ball(Ball::default()),
            ObstacleKind::Cuboid(Cuboid::default()),
            ObstacleKind::Polygon(Polygon::default()),
        ];
        let changed = ObstacleKind::Ball(Ball { radius: crate::quantity::Radius::literal(0.3), ..Ball::default() });
        let all = |list: &[&ObstacleKind]| -> Vec<ObstacleKind> { list.iter().map(|kind| (*kind).clone()).collect() };
        let same = |number: usize| Some((number, true));
        for (old, new, wanted) in [
            (vec![&a, &b, &c], vec![&b, &c], vec![None, same(0), same(1)]),
            (vec![&b, &c], vec![&a, &b, &c], vec![same(1), same(2)]),
            (vec![&a, &b], vec![&a, &b, &b], vec![same(0), same(1)]),
            (vec![&a, &b, &a], vec![&b, &a], vec![None, same(0), same(1)]),
            (vec![&a, &b, &c], vec![&changed, &b, &c], vec![Some((0, false)), same(1), same(2)]),
            (vec![&b, &a, &c], vec![&b, &changed, &c], vec![same(0), Some((1, false)), same(2)]),
            (vec![&a, &b], vec![], vec![None, None]),
            (vec![&a, &b, &c, &a], vec![&c, &b], vec![None, same(1), None, None]),
        ] {
            assert_eq!(matched([&all(&old), &all(&new)]), wanted);
        }
    }
}

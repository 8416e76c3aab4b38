//! Bodies at other places: moved, turned, scaled and copied.

use super::{
    Refused, Sandbox, Then,
    edit::{TEST_BODIES, add_body},
};
use crate::{
    document::{Document, Gesture},
    level::{BodyLevel, Place},
    meshes::Pin,
    quantity::Point,
    scene::Owner,
};

const NO_BODY: Refused = Refused::NotHere("there is no such body");
const ROLLERS: Refused =
    Refused::NotHere("a body on rollers cannot be turned here: its rollers are along one of its sides");
const EDGES: Refused = Refused::NotHere(
    "a load names edges of this body by their place: name them by a side, such as Left, before the body is moved",
);

impl Sandbox {
    /// Sets the place of a body. Pins stay with it, and so do the vertices that effects name in it: rules that would name others there are replaced by
    /// the vertices that they name now.
    pub(super) fn set_place(
        &self,
        document: &mut Document,
        body: usize,
        place: Place,
    ) -> Result<(Then, Option<Gesture>), Refused> {
        if document.level.test.is_some() {
            return Err(TEST_BODIES);
        }
        let parts = document.level.part_names().count();
        let listed = document.level.bodies.get_mut(body).ok_or(NO_BODY)?;
        let gesture = Some(Gesture::Place(body));
        if listed.place == place {
            return Ok((Then::Keep, gesture));
        }
        let is_turned = listed.place.turn != place.turn;
        if is_turned && !listed.slides.is_empty() {
            return Err(ROLLERS);
        }
        let keeps = |pin: &Pin| match pin {
            Pin::Vertex(_) | Pin::Random { .. } => true,
            Pin::Nearest(_) | Pin::Disk(..) | Pin::Box(..) => false,
            Pin::Top | Pin::Bottom | Pin::Left | Pin::Right | Pin::Corners => !is_turned,
        };
        if !listed.pins.iter().all(keeps) {
            listed.pins = self.pins_of(Owner::Body(body)).into_iter().map(Pin::Vertex).collect();
        }
        listed.place = place;
        let name = listed.name.clone();
        for effect in &mut document.level.effects {
            let Some(rules) = effect.effect.kind_mut().rules_mut() else { continue };
            let is_own = rules.of.as_ref().map_or(parts == 1, |of| *of == name);
            if !is_own || rules.pins.iter().all(keeps) {
                continue;
            }
            if rules.are_of_edges {
                return Err(EDGES);
            }
            let shape = self.simulation.scene().elements.shapes.get(body).ok_or(NO_BODY)?;
            let named = shape.pinned(rules.pins).map_err(|_| NO_BODY)?;
            let mut named: Vec<_> = named.iter().map(|vertex| shape.numbering.name(vertex - shape.first)).collect();
            named.sort_unstable();
            *rules.pins = named.into_iter().map(Pin::Vertex).collect();
        }
        document.level.state = None;
        Ok((Then::Restart, gesture))
    }

    /// Adds a copy of a body to the right of all bodies, with its pins.
    pub(super) fn copy_body(&self, document: &mut Document, body: usize) -> Result<(Then, Option<Gesture>), Refused> {
        let (scene, listed) = (self.simulation.scene(), self.document.level.bodies.get(body).ok_or(NO_BODY)?);
        let along = |vertices: std::ops::Range<usize>| scene.rest[scene.numbers(&vertices)].iter().step_by(2).copied();
        let own = || along(scene.bodies[body].vertices.clone());
        let end = |all: &mut dyn Iterator<Item = f64>| all.fold(f64::NEG_INFINITY, f64::max);
        let begin = own().fold(f64::INFINITY, f64::min);
        let (width, right) = (end(&mut own()) - begin, end(&mut along(0..scene.vertices())));
        let [x, y] = listed.place.offset.get();
        let offset = Point::new([x + right - begin + 0.1 * width, y])
            .map_err(|_| Refused::NotHere("there is no room for a copy"))?;
        let pins = self.pins_of(Owner::Body(body)).into_iter().map(Pin::Vertex).collect();
        add_body(document, BodyLevel { place: Place { offset, ..listed.place }, pins, ..listed.clone() })?;
        Ok((Then::Restart, None))
    }
}

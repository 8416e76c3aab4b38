//! Bodies, nets and membranes at other places: moved, turned, scaled and copied.

use super::{
    Refused, Sandbox, Then,
    edit::{NO_CLOTH, NO_PART, TEST_BODIES, add_body, edit_parts, free_name},
};
use crate::{
    command::Command,
    document::{Document, Gesture},
    level::{BodyLevel, MembraneLevel, NetLevel, Place, SpacePlace},
    meshes::Pin,
    quantity::{Point, SpacePoint},
    scene::Owner,
};

const NO_BODY: Refused = Refused::NotHere("there is no such body");
const ROLLERS: Refused =
    Refused::NotHere("a body on rollers cannot be turned here: its rollers are along one of its sides");
const EDGES: Refused = Refused::NotHere(
    "a load names edges by their place: name them by a side, such as Left, before what it acts on is moved or scaled",
);

impl Sandbox {
    /// Puts a part elsewhere or copies it. Other commands are those of [`edit_parts`].
    pub(super) fn arrange(
        &self,
        document: &mut Document,
        command: Command,
    ) -> Result<(Then, Option<Gesture>), Refused> {
        match command {
            Command::SetPlace(body, place) => self.set_place(document, body, place),
            Command::SetSpacePlace(number, place) => self.set_space_place(document, number, place),
            Command::CopyPart(part) => self.copy_part(document, part),
            other => edit_parts(document, other),
        }
    }

    /// Sets the place of a body. Pins stay with it, and so do the vertices that effects name in it: rules that would name others there are replaced by
    /// the vertices that they name now.
    fn set_place(
        &self,
        document: &mut Document,
        body: usize,
        place: Place,
    ) -> Result<(Then, Option<Gesture>), Refused> {
        if document.level.test.is_some() {
            return Err(TEST_BODIES);
        }
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
        self.keep_names(document, body, &keeps)?;
        document.level.state = None;
        Ok((Then::Restart, gesture))
    }

    /// Sets the place of a net or membrane in space (by number: nets first). Pins and the vertices that effects name stay with it.
    fn set_space_place(
        &self,
        document: &mut Document,
        number: usize,
        place: SpacePlace,
    ) -> Result<(Then, Option<Gesture>), Refused> {
        let gesture = Some(Gesture::SpacePlace(number));
        let now = document.level.space_mut(number).ok_or(NO_CLOTH)?;
        let before = std::mem::replace(now, place);
        if before == place {
            return Ok((Then::Keep, gesture));
        }
        if before.scale != place.scale {
            let keeps = |pin: &Pin| !matches!(pin, Pin::Nearest(_) | Pin::Disk(..) | Pin::Box(..));
            let part = document.level.bodies.len() + number;
            let pins = document.pins_mut(part).ok_or(NO_PART)?;
            if !pins.iter().all(keeps) {
                let nets = self.document.level.nets.len();
                let owner = if number < nets { Owner::Net(number) } else { Owner::Membrane(number - nets) };
                *pins = self.pins_of(owner).into_iter().map(Pin::Vertex).collect();
            }
            self.keep_names(document, part, &keeps)?;
        }
        document.level.state = None;
        Ok((Then::Restart, gesture))
    }

    /// Replaces rules of effects that would name other vertices of a part at its new place by the vertices that they name now.
    fn keep_names(&self, document: &mut Document, part: usize, keeps: &dyn Fn(&Pin) -> bool) -> Result<(), Refused> {
        let parts = document.level.part_names().count();
        let name = document.level.part_names().nth(part).ok_or(NO_PART)?.clone();
        for effect in &mut document.level.effects {
            let Some(rules) = effect.effect.kind_mut().rules_mut() else { continue };
            let is_own = rules.of.as_ref().map_or(parts == 1, |of| *of == name);
            if !is_own || rules.pins.iter().all(keeps) {
                continue;
            }
            if rules.are_of_edges {
                return Err(EDGES);
            }
            let shape = self.simulation.scene().elements.shapes.get(part).ok_or(NO_PART)?;
            let named = shape.pinned(rules.pins).map_err(|_| NO_PART)?;
            let mut named: Vec<_> = named.iter().map(|vertex| shape.numbering.name(vertex - shape.first)).collect();
            named.sort_unstable();
            *rules.pins = named.into_iter().map(Pin::Vertex).collect();
        }
        Ok(())
    }

    /// Adds a copy of a body, net or membrane (by number, in this order) to the right of all others, with its pins.
    fn copy_part(&self, document: &mut Document, part: usize) -> Result<(Then, Option<Gesture>), Refused> {
        const NO_ROOM: Refused = Refused::NotHere("there is no room for a copy");
        if document.level.test.is_some() {
            return Err(TEST_BODIES);
        }
        let (scene, level) = (self.simulation.scene(), &self.document.level);
        let vertices = scene.parts.get(part).ok_or(NO_PART)?.vertices();
        let step = scene.dimension;
        let along = |own: std::ops::Range<usize>| scene.rest[scene.numbers(&own)].iter().step_by(step).copied();
        let own = || along(vertices.clone());
        let end = |all: &mut dyn Iterator<Item = f64>| all.fold(f64::NEG_INFINITY, f64::max);
        let begin = own().fold(f64::INFINITY, f64::min);
        let right = end(&mut along(0..scene.vertices()));
        // What is flat across x is as far apart as it is large.
        let extent = |axis: usize| {
            let all = || scene.rest[scene.numbers(&vertices)].iter().skip(axis).step_by(step).copied();
            end(&mut all()) - all().fold(f64::INFINITY, f64::min)
        };
        let to_right = right - begin + 0.1 * (0..step).map(extent).fold(0.0, f64::max);
        let beside = |place: SpacePlace| {
            let [x, y, z] = place.offset.get();
            let offset = SpacePoint::new([x + to_right, y, z]).map_err(|_| NO_ROOM)?;
            Ok::<_, Refused>(SpacePlace { offset, ..place })
        };
        let pins = |owner| self.pins_of(owner).into_iter().map(Pin::Vertex).collect();
        let (bodies, nets) = (level.bodies.len(), level.nets.len());
        if let Some(listed) = level.bodies.get(part) {
            let [x, y] = listed.place.offset.get();
            let offset = Point::new([x + to_right, y]).map_err(|_| NO_ROOM)?;
            let (place, pins) = (Place { offset, ..listed.place }, pins(Owner::Body(part)));
            add_body(document, BodyLevel { place, pins, ..listed.clone() })?;
        } else if let Some(listed) = level.nets.get(part - bodies) {
            const IN_PLANE: Refused =
                Refused::NotHere("a net in the plane has no place of its own, so a copy would lie on it");
            let (space, pins) = (beside(listed.space.ok_or(IN_PLANE)?)?, pins(Owner::Net(part - bodies)));
            let name = free_name(&document.level, &listed.name);
            document.level.nets.push(NetLevel { name, space: Some(space), pins, ..listed.clone() });
        } else {
            let number = part - bodies - nets;
            let listed = level.membranes.get(number).ok_or(NO_PART)?;
            let (space, pins) = (beside(listed.space)?, pins(Owner::Membrane(number)));
            let name = free_name(&document.level, &listed.name);
            document.level.membranes.push(MembraneLevel { name, space, pins, ..listed.clone() });
        }
        document.level.state = None;
        Ok((Then::Restart, None))
    }
}

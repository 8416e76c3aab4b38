//! Commands that edit the document and can be undone.

use super::{Refused, Sandbox, Then, wind::set_wind};
use crate::{
    command::Command,
    document::{Document, Gesture},
    elements::ElementKind,
    level::{BodyLevel, EffectLevel, Level, Switch, When},
    materials::Model,
    meshes::MeshKind,
    scene::Owner,
};

pub(super) const NO_CLOTH: Refused = Refused::NotHere("there is no such net or membrane");

impl Sandbox {
    /// Changes to the document that can be undone.
    pub(super) fn edit(&mut self, command: Command) -> Result<(), Refused> {
        const NO_TEST: Refused = Refused::NotHere("this level is not a stretch test");
        let is_note = matches!(command, Command::AddNote(_) | Command::SetNotes(_));
        let mut document = self.document.clone();
        let mut then = Then::Keep;
        let mut gesture = None;
        match command {
            Command::SetModel(model) => {
                set_model(&mut document, model)?;
                then = Then::Restart;
            }
            Command::SetMaterial(body, material) => {
                let body = document.source(body);
                let model = if document.side_by_side.is_some() {
                    document.level.bodies[0].material.model()
                } else {
                    material.model()
                };
                get(&mut document.level.bodies, body)?.material = material.with_model(model);
                gesture = Some(Gesture::Material(body));
            }
            Command::SetMesh(body, mesh) => (then, gesture) = self.set_mesh(&mut document, body, mesh)?,
            Command::SetElement(body, element) => then = self.set_element(&mut document, body, element)?,
            Command::SetMass(body, mass) => {
                let body = document.source(body);
                get(&mut document.level.bodies, body)?.mass = mass;
                gesture = Some(Gesture::Mass(body));
            }
            Command::SetMembrane(number, material, thickness, mass) => {
                let listed = get(&mut document.level.membranes, number)?;
                (listed.material, listed.thickness, listed.mass) = (material, thickness, mass);
                gesture = Some(Gesture::Membrane(number));
            }
            Command::SetNet(number, net, mass) => {
                let listed = get(&mut document.level.nets, number)?;
                (listed.net, listed.mass) = (net, mass);
                gesture = Some(Gesture::Net(number));
            }
            Command::SetFinish(number, finish) => {
                *document.level.finish_mut(number).ok_or(NO_CLOTH)? = finish;
                gesture = Some(Gesture::Finish(number));
            }
            Command::SetToy(toy) => {
                document.level.toy.as_ref().ok_or(Refused::NotHere("this level has no toy problem"))?;
                document.level.state = None;
                document.level.toy = Some(toy);
                gesture = Some(Gesture::Toy);
                then = Then::Restart;
            }
            Command::SetSubsteps(substeps) => {
                document.level.substeps = substeps;
                gesture = Some(Gesture::Substeps);
            }
            Command::SetIntegrator(integrator) => {
                gesture = Some(Gesture::Integrator(integrator.name()));
                document.level.integrator = integrator;
            }
            Command::SetEffect(number, effect) => {
                *get(&mut document.level.effects, number)? = effect;
                gesture = Some(Gesture::Effect(number));
            }
            Command::AddEffect(effect) => {
                if document.level.toy.is_some() {
                    return Err(Refused::NotHere("no effect can be added to a toy problem"));
                }
                let listed = EffectLevel { effect, switch: Switch::default(), when: When::Always };
                document.level.effects.push(listed);
            }
            Command::SetWind(on) => set_wind(&mut document, self.simulation.scene(), on)?,
            Command::SetPins(part, pins) => *document.pins_mut(part).ok_or(NO_PART)? = pins,
            Command::TogglePin(vertex) => {
                let is_pinned = self.simulation.scene().pins.binary_search(&(vertex as u32)).is_ok();
                self.pin(&mut document, &[vertex], !is_pinned)?;
            }
            Command::PinAll(vertices, pins) => self.pin(&mut document, &vertices, pins)?,
            Command::MoveAlong(vertex, path) => self.move_along(&mut document, vertex, &path)?,
            Command::AddNote(spot) => self.add_note(&mut document, spot)?,
            Command::SetPose(pose) => {
                let test = document.level.test.ok_or(NO_TEST)?;
                document.set_pose(pose, test);
                then = Then::Restart;
            }
            Command::SetSideBySide(on) => {
                document.level.test.ok_or(NO_TEST)?;
                document.level.state = None;
                document.side_by_side = on.then(|| document.side_by_side.unwrap_or_else(|| self.sides()));
                then = Then::Restart;
            }
            other => (then, gesture) = self.arrange(&mut document, other)?,
        }
        if document == self.document {
            return if then == Then::Restart { self.apply(Command::Reset) } else { Ok(()) };
        }
        // A changed level leads elsewhere.
        if !is_note {
            document.level.recorded = None;
        }
        self.change(document, then, gesture)
    }

    /// Pins vertices of the scene, or frees them.
    fn pin(&self, document: &mut Document, vertices: &[usize], pins: bool) -> Result<(), Refused> {
        let scene = self.simulation.scene();
        let mut owners: Vec<(Owner, Vec<u32>)> = Vec::new();
        for vertex in vertices {
            let (owner, local) = scene.owner_of(*vertex).ok_or(Refused::NotHere("there is no such vertex"))?;
            // Bodies that are shown side by side are one body of the level.
            let is_same = |other: Owner| match (other, owner) {
                (Owner::Body(a), Owner::Body(b)) => document.source(a) == document.source(b),
                (a, b) => a == b,
            };
            match owners.iter_mut().find(|(other, _)| is_same(*other)) {
                Some((_, own)) => own.push(local as u32),
                None => owners.push((owner, vec![local as u32])),
            }
        }
        for (owner, mut own) in owners {
            own.sort_unstable();
            own.dedup();
            let mut all = self.pins_of(owner);
            all.retain(|pin| own.binary_search(pin).is_err());
            if pins {
                all.append(&mut own);
                all.sort_unstable();
            }
            document.set_pinned(owner, &all);
        }
        Ok(())
    }

    /// Sets the mesh of a shown body.
    fn set_mesh(
        &self,
        document: &mut Document,
        shown: usize,
        mesh: MeshKind,
    ) -> Result<(Then, Option<Gesture>), Refused> {
        let body = document.source(shown);
        let gesture = Some(Gesture::Mesh(body));
        if get(&mut document.level.bodies, body)?.mesh == mesh {
            return Ok((Then::Keep, gesture));
        }
        document.set_mesh(body, mesh, &self.rest_points(shown));
        Ok((Then::Restart, gesture))
    }

    fn set_element(&self, document: &mut Document, shown: usize, element: ElementKind) -> Result<Then, Refused> {
        let body = document.source(shown);
        let listed = get(&mut document.level.bodies, body)?;
        if listed.element == element {
            return Ok(Then::Keep);
        }
        listed.element = element;
        let mesh = listed.mesh.clone();
        document.set_mesh(body, mesh, &self.rest_points(shown));
        Ok(Then::Restart)
    }
}

fn get<T>(list: &mut [T], number: usize) -> Result<&mut T, Refused> {
    list.get_mut(number).ok_or(Refused::NotHere("there is no such body or effect"))
}

pub(super) const NO_PART: Refused = Refused::NotHere("there is no such body, net or membrane");

/// Changes that need the document alone; other commands change nothing here.
pub(super) fn edit_parts(document: &mut Document, command: Command) -> Result<(Then, Option<Gesture>), Refused> {
    match command {
        Command::SetEnergy(part, energy) => {
            let part = document.source(part);
            *document.level.energy_mut(part).ok_or(NO_PART)? = energy;
            Ok((Then::Keep, Some(Gesture::Energy(part))))
        }
        Command::AddBodies(bodies) => {
            bodies.into_iter().try_for_each(|body| add_body(document, body))?;
            Ok((Then::Restart, None))
        }
        Command::RemovePart(part) => {
            if document.level.test.is_some() {
                return Err(TEST_BODIES);
            }
            let Level { bodies, nets, membranes, state, .. } = &mut document.level;
            let counts = [bodies.len(), bodies.len() + nets.len(), bodies.len() + nets.len() + membranes.len()];
            match part {
                body if body < counts[0] => drop(bodies.remove(body)),
                net if net < counts[1] => drop(nets.remove(net - counts[0])),
                membrane if membrane < counts[2] => drop(membranes.remove(membrane - counts[1])),
                _ => return Err(NO_PART),
            }
            *state = None;
            Ok((Then::Restart, None))
        }
        Command::SetSubstepMode(paces) => {
            document.level.paces = paces;
            Ok((Then::Keep, None))
        }
        Command::SetGuard(guard) => {
            document.level.guard = guard;
            Ok((Then::Keep, None))
        }
        Command::SetSleep(sleep) => {
            document.level.sleep = sleep;
            Ok((Then::Keep, None))
        }
        Command::SetDamping(on) => {
            document.set_damping(on);
            Ok((Then::Keep, None))
        }
        Command::ClearPins => {
            document.clear_pins();
            Ok((Then::Keep, None))
        }
        Command::SetNotes(notes) => {
            document.level.notes = notes;
            Ok((Then::Keep, Some(Gesture::Notes)))
        }
        Command::SetStepping(integrator, substeps) => {
            (document.level.integrator, document.level.substeps) = (integrator, substeps);
            Ok((Then::Keep, None))
        }
        _ => Ok((Then::Keep, None)),
    }
}

pub(super) const TEST_BODIES: Refused = Refused::NotHere("a stretch test has its own strips alone");

/// Adds a body under a name of its own.
pub(super) fn add_body(document: &mut Document, mut body: BodyLevel) -> Result<(), Refused> {
    if document.level.test.is_some() {
        return Err(TEST_BODIES);
    }
    body.name = free_name(&document.level, &body.name);
    document.level.state = None;
    document.level.bodies.push(body);
    Ok(())
}

/// A name like this one that no body, net or membrane has.
pub(super) fn free_name(level: &Level, name: &str) -> String {
    let is_free = |name: &String| level.part_names().all(|other| other != name);
    let numbered = (2..=level.part_names().count() + 2).map(|number| format!("{name} {number}"));
    std::iter::once(name.to_owned()).chain(numbered).find(is_free).unwrap_or_default()
}

/// Sets the constitutive model of all bodies and membranes.
fn set_model(document: &mut Document, model: Model) -> Result<(), Refused> {
    document.side_by_side = None;
    document.level.state = None;
    document.level.set_model(model)?;
    Ok(())
}

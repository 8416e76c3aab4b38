//! Panels of the parts of a level: a body with material, mass and mesh; a net; a toy; and the controls of test levels.

use super::{
    Export, FileRequest, Notice, View, apply_response, count, finish, fixed, heading, row,
    scheme::percent,
    sliders, typed_energy,
    widgets::{self, Segment, SliderOptions, SliderResponse, segmented},
};
use crate::{
    app::{
        canvas::Tool,
        files::stem,
        language::{tr, tr_with},
        numbers,
    },
    command::{Command, Pose},
    elements::ElementKind,
    level::{Level, MassLevel, MembraneLevel, NetLevel, Pin, Place, SpacePlace},
    materials::{MaterialParameters, Plane, PlaneStress},
    meshes::MeshKind,
    outlines::{Shape, to_svg},
    quantity::{Cells, Density, Mass, OutOfRange, Point, Quantity, Rings, SpacePoint, Tolerance, Triangles},
    snapshot::Snapshot,
};
use eframe::egui::{ComboBox, RichText, Ui};

pub fn show(ui: &mut Ui, now: &Snapshot, view: &mut View, commands: &mut Vec<Command>) {
    let level = &now.level;
    let names: Vec<&str> = level.part_names().map(String::as_str).collect();
    view.body = view.body.min(names.len().saturating_sub(1));
    let Some(name) = names.get(view.body) else { return };
    let number = view.body.checked_sub(level.bodies.len());
    let membrane = number.and_then(|number| number.checked_sub(level.nets.len()));
    heading(ui, if membrane.is_some() { "Membrane" } else { number.map_or("Body", |_| "Net") });
    if names.len() > 1 {
        let pick = ComboBox::from_id_salt("body").width(ui.available_width()).selected_text(*name);
        let response = pick.show_ui(ui, |ui| {
            for (index, name) in names.iter().enumerate() {
                ui.selectable_value(&mut view.body, index, *name);
            }
        });
        response.response.on_hover_text(tr("Which body the sliders below belong to")).accessible_name(tr("Body"));
    }
    ui.push_id(("body", view.body), |ui| {
        if let Some(body) = level.bodies.get(view.body) {
            let number = view.body;
            let set = |material| Command::SetMaterial(number, material);
            material(ui, body.material, &set, view, commands);
            typed_energy::show(ui, (number, body.energy.as_ref()), body.material, view, commands);
            let shown = now.bodies.get(view.body);
            let area = || shown.map_or(0.0, |shown| shown.mesh.area() * body.place.scale.get().powi(2));
            mass(ui, body.mass, area, &|mass| Command::SetMass(number, mass), view, commands);
            let coming =
                view.meshing.as_ref().filter(|coming| coming.body == view.body).map(|coming| coming.mesh.clone());
            mesh(ui, &original(coming.unwrap_or_else(|| body.mesh.clone())), view, commands);
            element(ui, number, body.element, commands);
            pins(ui, view.body, &body.pins, view, commands);
            refinement(ui, now, &body.mesh, Some(number), commands);
            if level.test.is_none() {
                place(ui, number, body.place, view, commands);
                copy_and_remove(
                    ui,
                    ["Copy this body", "Remove this body"],
                    (level, Some(level.bodies.len())),
                    view,
                    commands,
                );
            }
        } else if let Some((number, listed)) = number.and_then(|number| Some((number, level.nets.get(number)?))) {
            show_net(ui, number, listed, view, commands);
            if let Some(place) = listed.space {
                space_place(ui, number, place, view, commands);
            }
            let copy = listed.space.map(|_| level.bodies.len() + level.nets.len());
            copy_and_remove(ui, ["Copy this net", "Remove this net"], (level, copy), view, commands);
            pins(ui, view.body, &listed.pins, view, commands);
            if now.nets.get(number).is_some_and(|net| !net.faces.is_empty()) {
                finish::show(ui, number, &listed.finish, number + level.membranes.len(), view, commands);
            }
        } else if let Some((number, listed)) = membrane.and_then(|number| Some((number, level.membranes.get(number)?)))
        {
            let area = || now.membranes.get(number).map_or(0.0, |shown| shown.mesh.area());
            show_membrane(ui, (number, view.body), listed, area, view, commands);
            space_place(ui, number + level.nets.len(), listed.space, view, commands);
            copy_and_remove(
                ui,
                ["Copy this membrane", "Remove this membrane"],
                (level, Some(names.len())),
                view,
                commands,
            );
            pins(ui, view.body, &listed.pins, view, commands);
            refinement(ui, now, &listed.mesh, None, commands);
            finish::show(ui, number + level.nets.len(), &listed.finish, number, view, commands);
        }
    });
}

/// Draws the buttons that copy and remove the chosen body, net or membrane; `copy` is the number of its copy, if it can have one.
fn copy_and_remove(
    ui: &mut Ui,
    [copies, removes]: [&str; 2],
    (level, copy): (&Level, Option<usize>),
    view: &mut View,
    commands: &mut Vec<Command>,
) {
    ui.horizontal_wrapped(|ui| {
        let help = "Adds a copy to the right of everything, with the same pins.";
        if let Some(copy) = copy
            && ui.button(tr(copies)).on_hover_text(tr(help)).clicked()
        {
            commands.push(Command::CopyPart(view.body));
            view.body = copy;
        }
        if level.part_names().count() > 1 && ui.button(tr(removes)).clicked() {
            commands.push(Command::RemovePart(view.body));
        }
    });
}

/// Draws the menu that adds a body, where the scene can have one.
pub fn add(ui: &mut Ui, now: &Snapshot, view: &mut View) {
    if now.toy.is_some() || now.level.test.is_some() || now.dimension == 3 {
        return;
    }
    if view.stage.tool == Tool::Outline {
        if ui.button(tr("Cancel the outline")).clicked() {
            view.stage.tool = Tool::Hand;
        }
        return;
    }
    ui.menu_button(tr("Add a body"), |ui| {
        if ui.button(tr("Draw its outline…")).on_hover_text(tr("By one drag, or corner after corner by clicks.")).clicked() {
            (view.stage.tool, view.drawer) = (Tool::Outline, None);
        }
        let help = "A mesh of triangles (OBJ, Gmsh MSH), or the outlines in a drawing (SVG) or a black-and-white picture (PNG). It is scaled to half of the stage.";
        if ui.button(tr("From a file…")).on_hover_text(tr(help)).clicked() {
            view.file = Some(FileRequest::OpenMesh);
        }
        for mesh in MeshKind::all() {
            // A file has its own button, and a refined mesh begins with another.
            let is_whole = !matches!(mesh, MeshKind::Obj(_) | MeshKind::Refined(_));
            if is_whole && ui.button(tr(mesh.name())).clicked() {
                view.new_body = Some(mesh);
            }
        }
    });
}

/// Draws the button that exports the outline of the chosen body.
pub fn export(ui: &mut Ui, now: &Snapshot, view: &mut View) {
    let Some(body) = now.bodies.get(view.body) else { return };
    let help = "Saves the outline of the chosen body at rest as a drawing, in its true size.";
    if ui.button(tr("Outline (SVG)…")).on_hover_text(tr(help)).clicked() {
        let bytes = to_svg(&Shape::of_mesh(&body.mesh)).into_bytes();
        view.file = Some(FileRequest::Export(Export { name: stem(&body.name) + ".svg", bytes }));
    }
}

/// Draws a menu of the pins of a body, net or membrane (by number).
fn pins(ui: &mut Ui, part: usize, now: &[Pin], view: &mut View, commands: &mut Vec<Command>) {
    const TOOLS: [(&str, Tool, &str); 2] = [
        (
            "In a box…",
            Tool::PinBox,
            "Drag a box on the stage: all vertices in it are pinned, of every body, or freed if all are pinned. [Shift+drag in edit mode]",
        ),
        (
            "Inside a line…",
            Tool::PinLine,
            "Draw a line on the stage: all vertices inside are pinned, of every body, or freed if all are pinned.",
        ),
    ];
    // Random pins that are chosen again are others.
    let seed =
        now.iter().find_map(|pin| if let Pin::Random { seed, .. } = pin { Some(seed.wrapping_add(1)) } else { None });
    let modes: [(&str, &[Pin]); 6] = [
        ("None", &[]),
        ("Corners", &[Pin::Corners]),
        ("One edge", &[Pin::Top]),
        ("Two edges", &[Pin::Left, Pin::Right]),
        ("Four edges", &[Pin::Top, Pin::Bottom, Pin::Left, Pin::Right]),
        ("Random", &[Pin::Random { count: 10, seed: seed.unwrap_or(0) }]),
    ];
    let chosen = modes.iter().find(|(_, pins)| *pins == now).map(|(name, _)| (*name).to_owned());
    let chosen = chosen.or_else(|| seed.filter(|_| now.len() == 1).map(|_| "Random".to_owned()));
    let chosen = chosen.unwrap_or_else(|| "Other".to_owned());
    ui.horizontal(|ui| {
        ui.label(tr("Pins"));
        // As high as all entries.
        let menu = ComboBox::from_id_salt("pins").height(400.0).width(ui.available_width());
        let menu = menu.selected_text(tr(&chosen));
        let response = menu.show_ui(ui, |ui| {
            for (name, pins) in modes {
                if ui.selectable_label(name == chosen, tr(name)).clicked() {
                    commands.extend([Command::SetPins(part, pins.to_vec()), Command::EndGesture]);
                }
            }
            ui.separator();
            for (name, tool, about) in TOOLS {
                if ui.button(tr(name)).on_hover_text(tr(about)).clicked() {
                    (view.stage.tool, view.drawer) = (tool, None);
                }
            }
        });
        response
            .response
            .on_hover_text(tr("Which vertices are held. A click on a vertex in edit mode pins or frees it, a drag with Shift all in a box."))
            .accessible_name(tr("Pins"));
    });
}

fn material(
    ui: &mut Ui,
    material: MaterialParameters,
    set: &dyn Fn(MaterialParameters) -> Command,
    view: &mut View,
    commands: &mut Vec<Command>,
) {
    let (mut young, mut poisson, mut plane) = (material.young(), material.poisson(), material.plane());
    let outcomes = [widgets::quantity(ui, &mut young), widgets::quantity(ui, &mut poisson)];
    let mut changed = outcomes.iter().any(|outcome| outcome.changed);
    let part = |on, text, about| Segment { text, name: text, about, on };
    let stress = plane.is_stress();
    let parts = [
        part(!stress, "Plane strain", "The thickness is held: λ = E ν / ((1 + ν)(1 − 2ν)) [Pa]."),
        part(stress, "Plane stress", "The faces are free of stress: λ = E ν / ((1 + ν)(1 − ν)) [Pa]."),
    ];
    if let Some(clicked) = segmented(ui, "plane", &parts, true).filter(|clicked| (*clicked == 1) != stress) {
        plane = if clicked == 0 { Plane::Strain } else { Plane::Stress };
    }
    if stress && material.model().plane_stress() != PlaneStress::Exact {
        let mut exact = plane == Plane::StressExact;
        let help = "Off: λ of Hooke's law is put into the formula of plane strain. The faces are free of stress at small strain; at \
                    large strain this model keeps some stress through the thickness.\n\
                    On: the thickness of each triangle solves P₃₃ = 0, so the faces are free of stress at every strain. Takes \
                    more computing time.";
        if ui.checkbox(&mut exact, tr("Exact at large strain")).on_hover_text(tr(help)).changed() {
            plane = if exact { Plane::StressExact } else { Plane::Stress };
        }
    }
    changed |= plane != material.plane();
    ui.add_space(5.0);
    let switched = plane != material.plane();
    let command = match MaterialParameters::new(material.model(), young, poisson, plane) {
        Ok(new) => Some(set(new)),
        Err(error) => {
            view.notice = Some(Notice::trouble(&error));
            None
        }
    };
    let sum = SliderResponse {
        changed,
        ended: switched || outcomes.iter().any(|outcome| outcome.ended),
        refused: outcomes.into_iter().find_map(|outcome| outcome.refused),
    };
    apply_response(sum, command, view, commands);
}

/// Draws the mass of a body or membrane of an area \[m²\], or of a volume \[m³\].
fn mass(
    ui: &mut Ui,
    mass: MassLevel,
    area: impl Fn() -> f64,
    set: &dyn Fn(MassLevel) -> Command,
    view: &mut View,
    commands: &mut Vec<Command>,
) {
    let part = |text, name, about, on| Segment { text, name, about, on };
    let lumped = "Lumped: a third of density x area of every triangle goes to each of its corners.";
    let consistent = "Consistent mass matrix: a triangle of mass m has m/6 at each corner, and m/12 between each two. Waves travel more exactly; explicit steps must be shorter, and each solves equations.";
    let parts = [
        part("Density", "Density", lumped, matches!(mass, MassLevel::Density(_))),
        part(
            "Total mass",
            "Total mass",
            "Every vertex carries the same share of a total.",
            matches!(mass, MassLevel::Total(_)),
        ),
        part("Consistent", "Consistent mass", consistent, matches!(mass, MassLevel::Consistent(_))),
    ];
    if let Some(clicked) = segmented(ui, "mass", &parts, true).filter(|clicked| !parts[*clicked].on) {
        match converted(mass, area(), clicked) {
            Ok(new) => commands.extend([set(new), Command::EndGesture]),
            Err(error) => view.notice = Some(Notice::trouble(&error)),
        }
    }
    let (outcome, new) = match mass {
        MassLevel::Density(mut density) => (widgets::quantity(ui, &mut density), MassLevel::Density(density)),
        MassLevel::Consistent(mut density) => (widgets::quantity(ui, &mut density), MassLevel::Consistent(density)),
        MassLevel::Total(mut total) => (widgets::quantity(ui, &mut total), MassLevel::Total(total)),
    };
    apply_response(outcome, Some(set(new)), view, commands);
}

/// Draws the parameters of the mesh. Another mesh starts the scene over.
fn mesh(ui: &mut Ui, mesh: &MeshKind, view: &mut View, commands: &mut Vec<Command>) {
    const SIDES: [&str; 2] = ["columns of cells", "rows of cells"];
    let mut mesh = mesh.clone();
    let mut sum = SliderResponse::default();
    let names = [Triangles::SPEC.name, Tolerance::SPEC.name, Cells::SPEC.name, Rings::SPEC.name];
    let mut finer = mesh.kind_mut().parameters();
    finer.retain(|number| names.contains(&number.spec().name));
    for (number, side) in finer.into_iter().zip(SIDES) {
        let spec = number.spec();
        let help = format!("{}\nAnother mesh starts over.\nAllowed: {}.", spec.help.trim(), spec.range());
        let name = if spec.name == Cells::SPEC.name { side } else { spec.name };
        let look =
            SliderOptions { name, unit: spec.unit, range: spec.slider, logarithmic: spec.logarithmic, help: &help };
        let value = number.get();
        let outcome = widgets::number(ui, &look, value, &mut |new| number.set(new).map_err(|error| error.to_string()));
        sum.changed |= outcome.changed;
        sum.ended |= outcome.ended;
        sum.refused = outcome.refused.or(sum.refused.take());
    }
    apply_response(sum, Some(Command::SetMesh(view.body, mesh)), view, commands);
}

/// Draws where a body is, how far it is turned and how large it is.
fn place(ui: &mut Ui, number: usize, mut place: Place, view: &mut View, commands: &mut Vec<Command>) {
    ui.collapsing(tr("Place"), |ui| {
        let Place { scale, turn, offset: Point(x, y) } = &mut place;
        let numbers: [(&str, &mut dyn Quantity); 4] =
            [("place x", x), ("place y", y), ("turn", turn), ("scale", scale)];
        let sum = widgets::named_quantities(ui, numbers);
        apply_response(sum, Some(Command::SetPlace(number, place)), view, commands);
    })
    .header_response
    .on_hover_text(tr("Where the origin of its mesh is at the start, and how the body is turned and scaled about that. The tool Arrange does the same by hand."));
}

/// Draws where a net or membrane (by number: nets first) is in space, and how it is turned.
fn space_place(ui: &mut Ui, number: usize, mut place: SpacePlace, view: &mut View, commands: &mut Vec<Command>) {
    ui.collapsing(tr("Place"), |ui| {
        let SpacePlace { scale, turn: (about_x, about_y, about_z), offset: SpacePoint(x, y, z), .. } = &mut place;
        let numbers: [(&str, &mut dyn Quantity); 7] = [
            ("place x", x),
            ("place y", y),
            ("place z", z),
            ("turn about x", about_x),
            ("turn about y", about_y),
            ("turn about z", about_z),
            ("scale", scale),
        ];
        let sum = widgets::named_quantities(ui, numbers);
        apply_response(sum, Some(Command::SetSpacePlace(number, place)), view, commands);
    })
    .header_response
    .on_hover_text(tr("Where the origin of its flat shape is at the start, and how that is scaled and turned: about x first, then y, then z. Another place starts over. The tool Arrange does the same by hand."));
}

/// The mesh before all refinements, whose numbers can be changed.
fn original(mesh: MeshKind) -> MeshKind {
    match mesh {
        MeshKind::Refined(refined) => *refined.mesh,
        other => other,
    }
}

/// Draws the button that refines meshes where the stress has its error, and what the last refinement changed. A body (by number) can take the mesh
/// from before again.
fn refinement(ui: &mut Ui, now: &Snapshot, mesh: &MeshKind, body: Option<usize>, commands: &mut Vec<Command>) {
    ui.horizontal_wrapped(|ui| {
        let help = "Divides the fewest triangles that have together half of the sum of the squared errors of the stress, over all bodies and membranes. The scene goes on from its present state. Colour by *Stress error* to see the estimate. The tool *Refine* on the stage divides the triangles under the pointer.";
        if ui.button(tr("Refine by error")).on_hover_text(tr(help)).clicked() {
            commands.push(Command::RefineWorst);
        }
        let MeshKind::Refined(refined) = mesh else { return };
        if let Some(body) = body {
            let rounds = refined.rounds.len().to_string();
            let help = tr_with("Takes the original mesh, without its {count} rounds of refinement. The scene starts over.", &[("count", &rounds)]);
            if ui.button(tr("Remove refinement")).on_hover_text(help).clicked() {
                commands.extend([Command::SetMesh(body, (*refined.mesh).clone()), Command::EndGesture]);
            }
        }
    });
    if let Some(error) = now.stress_error {
        row(
            ui,
            tr("Stress error, estimated"),
            &percent(error),
            "Estimated relative error of the stress: sqrt(e/(s + e)) with e = Σ ∫ |P* − P|² dV and s = Σ ∫ |P|² dV over all triangles. P: first Piola-Kirchhoff stress. P*: its mean at the vertices, linear in between.",
        );
    }
    if let Some(change) = now.mesh_change {
        let [before, after] = change.triangles.map(count);
        let [energy_before, energy] = change.energies.map(|energies| numbers::si(energies.total(), "J"));
        let [old, new] = change.momentum;
        let moved = (0..3).map(|axis| (new[axis] - old[axis]).powi(2)).sum::<f64>().sqrt();
        let words = format!(
            "{before} triangles became {after}. Energy: {energy_before} before, {energy} after. Momentum changed by {}.",
            numbers::si(moved, "kg m/s")
        );
        ui.label(RichText::new(words).small().weak());
    }
}

/// Draws a menu of the kinds of elements of a body (by number).
fn element(ui: &mut Ui, body: usize, now: ElementKind, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        ui.label(tr("Element"));
        let menu = ComboBox::from_id_salt("element").width(ui.available_width()).selected_text(tr(now.title()));
        let response = menu.show_ui(ui, |ui| {
            for kind in ElementKind::ALL {
                if ui.selectable_label(kind == now, tr(kind.title())).on_hover_text(tr(kind.about())).clicked() {
                    commands.extend([Command::SetElement(body, kind), Command::EndGesture]);
                }
            }
        });
        let help = format!("{}\n{}", tr(now.about()), tr("Another kind starts over."));
        response.response.on_hover_text(help).accessible_name(tr("Element"));
    });
}

/// Converts a mass \[kg\] or a density to one of the three ways of giving it, by number, for an area \[m²\].
fn converted(mass: MassLevel, area: f64, to: usize) -> Result<MassLevel, OutOfRange> {
    let density = || match mass {
        MassLevel::Total(total) => Density::new(total.get() / area),
        MassLevel::Density(density) | MassLevel::Consistent(density) => Ok(density),
    };
    Ok(match to {
        0 => MassLevel::Density(density()?),
        1 => MassLevel::Total(Mass::new(density()?.get() * area)?),
        _ => MassLevel::Consistent(density()?),
    })
}

/// Draws the sliders of a net: the mass of its particles and its parameters.
fn show_net(ui: &mut Ui, number: usize, listed: &NetLevel, view: &mut View, commands: &mut Vec<Command>) {
    let (mut net, mut mass) = (listed.net.clone(), listed.mass);
    let springs = net.kind_mut().parameters();
    let outcome = sliders(ui, std::iter::once(&mut mass as &mut dyn Quantity).chain(springs));
    apply_response(outcome, Some(Command::SetNet(number, net, mass)), view, commands);
}

/// Draws the sliders of a membrane of an area \[m²\]: material, thickness and mass.
fn show_membrane(
    ui: &mut Ui,
    (number, part): (usize, usize),
    listed: &MembraneLevel,
    area: impl Fn() -> f64,
    view: &mut View,
    commands: &mut Vec<Command>,
) {
    let MembraneLevel { material: now, thickness, mass: heavy, .. } = listed;
    material(ui, *now, &|new| Command::SetMembrane(number, new, *thickness, *heavy), view, commands);
    typed_energy::show(ui, (part, listed.energy.as_ref()), *now, view, commands);
    let mut new = *thickness;
    let outcome = sliders(ui, [&mut new as &mut dyn Quantity]);
    apply_response(outcome, Some(Command::SetMembrane(number, *now, new, *heavy)), view, commands);
    let volume = || area() * thickness.get();
    mass(ui, *heavy, volume, &|new| Command::SetMembrane(number, *now, *thickness, new), view, commands);
}

pub fn show_toy(ui: &mut Ui, now: &Snapshot, view: &mut View, commands: &mut Vec<Command>) {
    let (Some(listed), Some(shown)) = (&now.level.toy, &now.toy) else { return };
    heading(ui, listed.kind().title());
    ui.label(RichText::new(listed.kind().about()).small().weak());
    ui.add_space(4.0);
    let mut toy = listed.clone();
    let outcome = sliders(ui, toy.kind_mut().parameters());
    apply_response(outcome, Some(Command::SetToy(toy)), view, commands);
    for reading in &shown.readings {
        row(ui, reading.name, &fixed(reading.value, reading.unit), reading.help);
    }
}

pub fn show_test_pose(ui: &mut Ui, now: &Snapshot, commands: &mut Vec<Command>) {
    let Some(test) = now.level.test else { return };
    heading(ui, "Stretch test");
    let about = |key: &str, factor: f64| format!("Starts at {factor} x the rest height. [{key}]");
    let (up, down) = (about("Up", test.stretched.get()), about("Down", test.compressed.get()));
    let is_at = |pose, factor| match now.pose {
        Some(now) => now == pose,
        None => now.level.bodies.first().is_some_and(|body| body.stretch.1 == factor),
    };
    let part = |pose, factor, text, about| Segment { text, name: text, about, on: is_at(pose, factor) };
    let parts = [
        part(Pose::Stretched, test.stretched, "Stretched", &up),
        part(Pose::Compressed, test.compressed, "Compressed", &down),
    ];
    if let Some(clicked) = segmented(ui, "pose", &parts, true) {
        commands.push(Command::SetPose(if clicked == 0 { Pose::Stretched } else { Pose::Compressed }));
    }
    let mut together = now.side_by_side;
    let help = "One body for each constitutive model, so that their answers can be compared.";
    if ui.checkbox(&mut together, tr("All models side by side")).on_hover_text(tr(help)).changed() {
        commands.push(Command::SetSideBySide(together));
    }
}

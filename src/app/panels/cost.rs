//! Panel of display options and costs.

use super::{
    Notice, PanelContext, View, apply_response, count, fixed, heading, heading_here, row,
    status::AT_REST,
    widgets::{self, Segment, SliderOptions, SliderResponse, segmented},
};
use crate::{
    app::{
        arrows::ArrowKind,
        draw::ghost::EarlierShape,
        language::{tr, tr_with},
        numbers,
    },
    command::Command,
    integrators::Class,
    level::{SubstepMode, Substeps},
    nets::Role,
    snapshot::{Field, Snapshot},
};
use eframe::egui::{self, Button, Label, Popup, Rect, RichText, Sense, Ui, vec2};
use std::{collections::BTreeSet, sync::Arc};

/// Frame time at 60 Hz \[s\].
const FRAME: f64 = 1.0 / 60.0;

pub fn show(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View, commands: &mut Vec<Command>) {
    if !context.now.triangles.is_empty() || !context.now.membranes.is_empty() {
        looks(ui, context.now, view);
    } else if context.now.dimension == 3 {
        let help = "The edges of all triangles, and the structural springs";
        ui.horizontal(|ui| {
            close(ui);
            ui.checkbox(&mut view.stage.wireframe, tr("Wireframe")).on_hover_text(tr(help));
            normals(ui, view);
            earlier(ui, context.now, view);
        });
    } else if context.now.toy.is_none() {
        ui.horizontal(|ui| {
            if has_hidden_springs(context.now) {
                let help = "Draws the flexion springs too, which lie over the others";
                ui.checkbox(&mut view.stage.wireframe, tr("All springs")).on_hover_text(tr(help));
            }
            earlier(ui, context.now, view);
        });
    }
    heading(ui, "What it costs");
    speed(ui, context, view);
    substeps(ui, context.now, view, commands);
    substep_mode(ui, context.now, commands);
    size(ui, context.now);
}

/// Whether some springs are drawn only on request.
fn has_hidden_springs(now: &Snapshot) -> bool {
    now.nets.iter().any(|net| net.springs.links().iter().any(|link| link.role == Role::Flexion))
}

/// Draws the display options: colours, edges and vertices.
fn looks(ui: &mut Ui, now: &Snapshot, view: &mut View) {
    /// Number of the fields that have a button of their own.
    const BUTTONS: usize = 4;
    let (first, others) = Field::ALL.split_at(BUTTONS);
    ui.add_space(6.0);
    ui.horizontal(|ui| {
        heading_here(ui, "Colour by");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let chosen = others.iter().find(|field| **field == view.stage.field);
            let button = Button::new(RichText::new(tr(chosen.map_or("More…", |field| field.title()))).small()).small();
            let button = ui.add(button.selected(chosen.is_some()).min_size(vec2(34.0, 20.0)));
            Popup::menu(&button.accessible_name(tr("More colours"))).show(|ui| {
                for field in others {
                    let button = Button::selectable(view.stage.field == *field, tr(field.title()));
                    if ui.add(button).on_hover_text(about(*field)).clicked() {
                        view.stage.field = *field;
                    }
                }
            });
            arrows(ui, now, view);
        });
    });
    let parts = first.iter().map(|field| Segment {
        text: short(*field),
        name: field.title(),
        about: about(*field),
        on: view.stage.field == *field,
    });
    let clicked = segmented(ui, "field", &parts.collect::<Vec<_>>(), true);
    view.stage.field = clicked.and_then(|clicked| first.get(clicked)).copied().unwrap_or(view.stage.field);
    ui.horizontal(|ui| {
        close(ui);
        ui.checkbox(&mut view.stage.wireframe, tr("Wireframe")).on_hover_text(tr("The edges of all triangles"));
        if now.dimension == 3 {
            normals(ui, view);
        } else {
            ui.checkbox(&mut view.stage.vertices, tr("Vertices")).on_hover_text(tr("A dot at every vertex"));
        }
        earlier(ui, now, view);
    });
    if view.stage.field != Field::None && view.stage.field == now.field {
        held_range(ui, view);
    }
}

/// Draws the menu of arrows.
fn arrows(ui: &mut Ui, now: &Snapshot, view: &mut View) {
    let chosen = view.stage.arrows;
    let is_on = chosen != ArrowKind::None;
    let title = if is_on { chosen.title() } else { "Arrows…" };
    let button = Button::new(RichText::new(tr(title)).small()).small().selected(is_on).min_size(vec2(34.0, 20.0));
    Popup::menu(&ui.add(button).accessible_name(tr("Arrows"))).show(|ui| {
        for kind in ArrowKind::ALL {
            let button = Button::selectable(chosen == kind, tr(kind.title()));
            if ui.add_enabled(kind.suits(now), button).on_hover_text(kind.about()).clicked() {
                view.stage.arrows = kind;
            }
        }
    });
}

/// Draws the switch that holds the range of the colours, and the held end.
fn held_range(ui: &mut Ui, view: &mut View) {
    let field = view.stage.field;
    let held = view.stage.held.filter(|(of, _)| *of == field).map(|(_, end)| end);
    let mut on = held.is_some();
    let help = "The ends of the colour scale stay, whatever the values are, so that pictures can be compared.";
    if ui.checkbox(&mut on, tr("Hold range")).on_hover_text(tr(help)).changed() {
        view.stage.held = on.then_some((field, view.scale_end));
    }
    if let Some(end) = held.filter(|_| on) {
        let name = if field.is_signed() { "range on both sides" } else { "end of range" };
        let options = SliderOptions {
            name,
            unit: field.unit(),
            range: (0.0, 2.0 * end),
            logarithmic: true,
            help: "Distance of the ends of the colour scale from the value at rest, above zero.",
        };
        let mut response = SliderResponse::default();
        match widgets::typed(ui, &options, end, &mut response) {
            Some(end) if end > 0.0 => view.stage.held = Some((field, end)),
            Some(end) => response.refused = Some(format!("{name}: expected a number above zero, got {end}")),
            None => {}
        }
        if let Some(why) = response.refused {
            view.notice = Some(Notice::Trouble(why));
        }
    }
}

/// Makes the switches of a row stand close together, so that they do not widen the panel.
fn close(ui: &mut Ui) {
    ui.spacing_mut().item_spacing.x = 3.0;
    ui.spacing_mut().icon_spacing = 3.0;
}

/// Draws the switch of the earlier shape, and the button that takes that of now.
fn earlier(ui: &mut Ui, now: &Snapshot, view: &mut View) {
    let generation = now.generation;
    let mut on = view.earlier.is_some();
    let help = "Draws the outline at the start too, or at the moment that was marked with *Now*.";
    if ui.checkbox(&mut on, tr("Before")).on_hover_text(tr(help)).changed() {
        view.earlier = on.then(|| EarlierShape { generation, positions: Arc::clone(&now.start) });
    }
    // Another mesh has another start.
    if let Some(moment) = view.earlier.as_mut().filter(|moment| moment.generation != generation) {
        *moment = EarlierShape { generation, positions: Arc::clone(&now.start) };
    }
    if on && ui.small_button(tr("Now")).on_hover_text(tr("Marks this moment as the earlier one.")).clicked() {
        view.earlier = Some(EarlierShape { generation, positions: Arc::new(now.positions.clone()) });
    }
}

/// Draws the switch of colours by normals.
fn normals(ui: &mut Ui, view: &mut View) {
    let help = "Colours by the directions of the normals: red for x, green for y and blue for z";
    ui.checkbox(&mut view.stage.normals, tr("Normals")).on_hover_text(tr(help));
}

/// Text of the button of a field.
const fn short(field: Field) -> &'static str {
    match field {
        Field::None => "Plain",
        Field::EnergyDensity => "Energy",
        Field::VonMises => "Von Mises",
        Field::Volume => "J",
        other => other.title(),
    }
}

const fn about(field: Field) -> &'static str {
    match field {
        Field::None => "Gingerbread with icing.",
        Field::EnergyDensity => "ψ(F): elastic energy per rest area [J/m²].",
        Field::VonMises => "Von Mises equivalent of the Cauchy stress σ = P Fᵗ / J [Pa]: the size of its shear part.",
        Field::Volume => "J = det F: area over rest area; below 0 a triangle is inverted (inside out).",
        Field::Stretch => "λ₁: the greater principal stretch, that is singular value of F.",
        Field::PrincipalStress => {
            "σ₁: the greater principal value of the Cauchy stress in the plane [Pa]; positive pulls."
        }
        Field::Pressure => "Minus the mean of the three principal Cauchy stresses [Pa].",
        Field::Speed => "Mean speed of the corners [m/s].",
        Field::Displacement => "Mean distance of the corners from where they started [m].",
        Field::StressError => {
            "Each triangle's share of the squared error of the stress, estimated [%]: of the sum of ∫ |P* − P|² dV over all, with the first Piola-Kirchhoff stress P and its mean P* at the vertices (Zienkiewicz and Zhu)."
        }
    }
}

/// Simulated time over real time, to two digits after the point or, in slow motion, to two digits.
fn speed_text(factor: f64) -> String {
    if factor >= 0.1 || factor == 0.0 {
        format!("{factor:.2} × real time")
    } else {
        let digits = (1.0 - libm::floor(libm::log10(factor))).clamp(2.0, 12.0) as usize;
        format!("{factor:.digits$} × real time")
    }
}

/// Draws the speed of simulated time and the frame time.
fn speed(ui: &mut Ui, context: &PanelContext<'_>, view: &View) {
    let rates = context.rates;
    let or_dash = |number: Option<String>| number.unwrap_or_else(|| "–".to_owned());
    let factor = if context.now.rests() {
        AT_REST.to_owned()
    } else {
        or_dash(rates.map(|rates| speed_text(rates.factor * view.pace.factor())))
    };
    row(
        ui,
        tr("Speed"),
        &factor,
        "Simulated time over real time. Steps are never skipped: if the computer is too slow for them, simulated time runs slower.",
    );
    row(ui, tr("Simulated time"), &fixed(context.now.time, "s"), "Time since the start [s]");
    let physics = or_dash(rates.map(|rates| fixed(rates.physics, "s")));
    row(ui, tr("Physics per frame"), &physics, "Time spent on stepping in a frame [s]");
    let frame = or_dash(rates.map(|rates| format!("{}, {:.1} per second", fixed(rates.frame, "s"), rates.frames)));
    let help = "Time for stepping, panels and the list of what is painted in a frame [s]; 60 frames per second leave 16.7 ms. \
                Then how many frames are presented in a second, painting included [1/s].";
    row(ui, tr("Frame time"), &frame, help);
    let share = rates.map_or(0.0, |rates| rates.physics / FRAME);
    let whole = rates.map_or(0.0, |rates| rates.frame / FRAME);
    gauge(ui, share as f32, whole as f32);
}

/// Draws the used share of a 60 Hz frame: stepping in the strong colour, the rest in the pale one.
fn gauge(ui: &mut Ui, physics: f32, whole: f32) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 8.0), Sense::hover());
    response
        .on_hover_text(tr("Frame time as a share of 1/60 s: stepping in the strong colour, drawing in the pale one"));
    let visuals = ui.visuals();
    ui.painter().rect_filled(rect, 4.0, visuals.extreme_bg_color);
    let part = |share: f32| Rect::from_min_size(rect.min, vec2(rect.width() * share.clamp(0.0, 1.0), rect.height()));
    let color = if whole > 1.0 { visuals.warn_fg_color } else { visuals.selection.bg_fill };
    ui.painter().rect_filled(part(whole), 4.0, color.gamma_multiply(0.45));
    ui.painter().rect_filled(part(physics), 4.0, color);
    ui.add_space(4.0);
}

fn substeps(ui: &mut Ui, now: &Snapshot, view: &mut View, commands: &mut Vec<Command>) {
    let look = SliderOptions {
        name: "substeps",
        unit: "",
        range: (1.0, 2000.0),
        logarithmic: true,
        help: "Steps in 1/60 s of simulated time: h = 1/(60 n). More steps take more computing time and are more stable.\nAllowed: at least 1 and at most 100000.",
    };
    let mut chosen = now.level.substeps;
    let outcome = widgets::number(ui, &look, f64::from(chosen.get()), &mut |new| {
        let whole = if new.is_finite() { new.round().clamp(0.0, f64::from(u32::MAX)) } else { 0.0 };
        chosen = Substeps::new(whole as u32)?;
        Ok(())
    });
    let command = (chosen != now.level.substeps).then_some(Command::SetSubsteps(chosen));
    apply_response(outcome, command, view, commands);
    row(ui, tr("Step"), &fixed(chosen.step(), "s"), "h = 1/(60 n): the length of a step [s]");
}

/// Draws the switch for substeps per body, and their present numbers.
fn substep_mode(ui: &mut Ui, now: &Snapshot, commands: &mut Vec<Command>) {
    if now.toy.is_some() || now.level.integrator.kind().class() != Class::Explicit {
        return;
    }
    let help = "Each body and net divides every step into as many equal parts as its own stability needs: no part is longer than \
                half of its longest stable step at rest. So a stiff body does not make a soft one take short steps too. This is \
                exact, as bodies do not touch each other; with a contact potential all take the same steps.";
    let mut own = now.level.paces == SubstepMode::Own;
    if ui.checkbox(&mut own, tr("Multirate stepping")).on_hover_text(tr(help)).changed() {
        let mode = if own { SubstepMode::Own } else { SubstepMode::Same };
        commands.extend([Command::SetSubstepMode(mode), Command::EndGesture]);
    }
    let each: Vec<_> = now
        .part_names()
        .zip(&now.substep_plans)
        .map(|(name, plan)| format!("{name} {}", count(plan.steps as usize)))
        .collect();
    if !each.is_empty() {
        let help = "Into how many equal parts each body or net divides a step";
        ui.add(Label::new(RichText::new(each.join(", ")).small()).wrap()).on_hover_text(tr(help));
    }
}

fn size(ui: &mut Ui, now: &Snapshot) {
    let springs: usize = now.nets.iter().map(|net| net.springs.links().len()).sum();
    if springs > 0 {
        row(ui, tr("Springs"), &count(springs), "In all nets");
    }
    if !now.positions.is_empty() {
        row(ui, tr("Vertices"), &count(now.vertex_count()), "Of all bodies and membranes, and particles of all nets");
    }
    let membranes: usize = now.membranes.iter().map(|membrane| membrane.elements.corners().len()).sum();
    if membranes > 0 {
        row(ui, tr("Triangles"), &count(membranes), "In all membranes");
    }
    if let Some((crossings, time)) = now.crossings {
        let words = match crossings {
            0 => tr_with("none: proven in {time}", &[("time", &numbers::si(time.as_secs_f64(), "s"))]),
            _ => count(crossings),
        };
        let help = "Edges of boundaries that cross each other, and edges of cloth that pass through triangles of cloth, by a test with exact arithmetic";
        row(ui, tr("Crossings"), &words, help);
    }
    if !now.triangles.is_empty() {
        row(ui, tr("Triangles"), &count(now.triangles.len()), "In all bodies");
        if now.asleep > 0 || now.regions[0] > 0 {
            let help = "Triangles of bodies, and of regions of bodies, that are awake. The times above are for these: what sleeps is not computed.";
            row(ui, tr("Computed"), &count(now.computed), help);
        }
        row(ui, tr("Inverted"), &count(now.inverted), "Triangles that are inside out: J = det F ≤ 0");
        let continued: usize = now.bodies.iter().map(|body| body.continued).sum();
        if continued > 0 {
            let rules = now.bodies.iter().filter(|body| body.continued > 0);
            let rules: BTreeSet<_> =
                rules.map(|body| format!("\n{}: {}.", body.material.title(), body.material.continuation())).collect();
            let help = "Triangles so compressed, or inverted, that the formula of their model is replaced by its continuation.".to_owned();
            row(ui, tr("Outside model range"), &count(continued), &rules.iter().fold(help, |help, rule| help + rule));
        }
        row(
            ui,
            tr("Smallest J = det F"),
            &fixed(now.min_j, ""),
            "Area over rest area of the most compressed triangle; 1 at rest, ≤ 0 if it is inverted",
        );
    }
}

//! Status line: keys of the present mode, or one warning with its remedies.

use super::{PanelContext, View};
use crate::{
    app::{
        advice::{Advice, Cause, Facts, Load, Remedy, Trouble},
        clock::{Pace, Rates},
        keys::{Binding, TABLE, When},
        language::tr,
        numbers,
    },
    command::{Command, Mode},
    materials::Model,
    snapshot::Snapshot,
};
use eframe::egui::{self, Align, Button, Frame, Layout, Margin, Panel, RichText, TextStyle, Ui, vec2};

/// A warning and its remedies.
struct Warning {
    /// Warnings of one kind are hidden together, because their numbers change.
    kind: &'static str,
    text: String,
    details: String,
    advice: Option<Advice>,
}

/// Maximum number of buttons beside a warning.
const MOST_REMEDIES: usize = 3;

/// Rates of simulated time: below the first one a warning appears, above the second one it disappears.
const SLOW: (f64, f64) = (0.85, 0.95);

/// Width that the keys keep beside a warning [points].
const KEYS: f32 = 440.0;

pub fn show(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View, commands: &mut Vec<Command>) {
    let frame = Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(8, 4));
    let warning = warning(context, view);
    Panel::bottom("status").frame(frame).exact_size(34.0).show(ui, |ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if let Some(warning) = &warning {
                complain(ui, warning, context.now, view, commands);
                ui.add_space(12.0);
            } else if context.now.rests() {
                ui.label(RichText::new(tr(AT_REST)).small().weak()).on_hover_text(tr(AT_REST_HELP));
                ui.add_space(12.0);
            }
            let width = ui.available_width();
            ui.allocate_ui_with_layout(vec2(width, 26.0), Layout::left_to_right(Align::Center), |ui| {
                hints(ui, context.now, view);
            });
        });
    });
}

/// Draws the keys of the present mode as far as there is room. A click on a key acts like pressing it.
fn hints(ui: &mut Ui, now: &Snapshot, view: &mut View) {
    ui.spacing_mut().item_spacing.x = 5.0;
    let places = [When::Edit, When::Moving, When::Test];
    let special = TABLE.iter().filter(|binding| places.contains(&binding.when) && binding.when.applies(now));
    let general =
        TABLE.iter().filter(|binding| ["Space", "M", "T", "D", "B", "I", "Shift+V", "?"].contains(&binding.label));
    // A toy has no vertices to pin, pull or push, and no damping.
    let of_vertices = |binding: &Binding| ["Click", "Drag", "Arrows", "X"].contains(&binding.label);
    let special = special.filter(|binding| now.toy.is_none() || !of_vertices(binding));
    let general = general.filter(|binding| now.toy.is_none() || binding.label != "D");
    for binding in special.chain(general) {
        let words = tr(brief(binding, now, view));
        let font = TextStyle::Small.resolve(ui.style());
        let color = ui.visuals().text_color();
        let width = |text: &str| ui.painter().layout_no_wrap(text.to_owned(), font.clone(), color).size().x;
        if width(binding.label) + width(words) + 40.0 > ui.available_width() {
            break;
        }
        let cap = Button::new(RichText::new(binding.label).small().strong()).small().min_size(vec2(20.0, 18.0));
        let cap = ui.add_enabled(!binding.shortcuts.is_empty(), cap);
        if cap
            .on_hover_text(tr(binding.words))
            .accessible_name(format!("{}: {}", binding.label, tr(binding.words)))
            .clicked()
        {
            view.pressed.push(binding);
        }
        ui.label(RichText::new(words).small());
        ui.add_space(6.0);
    }
}

/// Short text of a key binding.
fn brief(binding: &Binding, now: &Snapshot, view: &View) -> &'static str {
    match (binding.label, binding.when) {
        ("Click", _) => "pin / free",
        ("R", When::Edit) => "remove pins",
        ("R", _) => "start over",
        ("Drag", _) => "pull",
        ("Arrows", _) => "push",
        ("X", _) => "burst",
        ("Backspace", _) => "go back in time",
        ("Up", _) => "stretched",
        ("Down", _) => "compressed",
        ("Space", _) if now.running && now.mode != Mode::Edit => "pause",
        ("Space", _) => "run",
        ("M", _) if now.mode == Mode::Simulate => "edit",
        ("M", _) => "simulate",
        ("T", _) if now.mode == Mode::Collide => "edit",
        ("T", _) => "collide",
        ("D", _) if now.damping => "damping off",
        ("D", _) => "damping on",
        ("B", _) => "compare",
        ("I", _) => "picture",
        ("Shift+V", _) if view.film.is_some() => "end film",
        ("Shift+V", _) => "film",
        ("?", _) => "all keys",
        _ => binding.words,
    }
}

/// Draws the warning. Text that does not fit is shown in its tooltip.
fn complain(ui: &mut Ui, warning: &Warning, now: &Snapshot, view: &mut View, commands: &mut Vec<Command>) {
    if ui.button(tr("Hide")).on_hover_text(tr("Hides this warning.")).clicked() {
        view.dismissed.push(warning.kind);
    }
    if let Some(advice) = &warning.advice {
        for (number, remedy) in advice.remedies.iter().enumerate().take(MOST_REMEDIES).rev() {
            if ui.button(remedy.label()).on_hover_text(tr(remedy.help())).clicked() {
                commands.extend(advice.apply(number, now, view));
            }
        }
    }
    let text = RichText::new(&warning.text).color(ui.visuals().warn_fg_color);
    // In a wide window the keys keep their width; in a narrow one the warning takes all of it.
    let width = ui.available_width();
    let room = if width > 1.4 * KEYS { width - KEYS } else { width };
    ui.scope(|ui| {
        ui.set_max_width(room);
        ui.add(egui::Label::new(text).truncate()).on_hover_text(&warning.details);
    });
}

/// Status while everything is at rest.
pub const AT_REST: &str = "at rest: clock paused";

/// Explanation of [`AT_REST`].
pub const AT_REST_HELP: &str = "All bodies and nets are at rest, so nothing would change. Time goes on with the next pull or change. \
                                Switch Sleep off to let it run.";

/// The most important warning that is not hidden. A kind whose cause has ended becomes visible again.
fn warning(context: &PanelContext<'_>, view: &mut View) -> Option<Warning> {
    let now = context.now;
    if now.fault.is_some() {
        return None;
    }
    // Simulated time may wait for the frames of a film.
    let factor = if view.film.is_some() { 1.0 } else { context.rates.map_or(1.0, |rates| rates.factor) };
    view.slow = factor < if view.slow { SLOW.1 } else { SLOW.0 };
    let facts = Facts::of(now, context.jobs.limit_at_rest(), view);
    let mut all = Vec::new();
    all.extend(exploded(now, &facts));
    all.extend(inside(now.inside));
    all.extend(crossed(now));
    all.extend(inside_out(now, &facts).or_else(|| folded(now)));
    all.extend(strip_warning(now));
    if view.slow {
        all.extend(context.rates.map(|rates| slow(now, &rates, (view.pace, &facts))));
    }
    let message = |text: &String| Warning { kind: "message", text: text.clone(), details: text.clone(), advice: None };
    all.extend(now.messages.first().map(message));
    view.dismissed.retain(|kind| all.iter().any(|warning| warning.kind == *kind));
    all.into_iter().find(|warning| !view.dismissed.contains(&warning.kind))
}

/// Sentence with its cause, if the cause is known.
fn because(text: &str, advice: &Advice) -> String {
    advice.cause.words().map_or_else(|| text.to_owned(), |cause| format!("{text}: {cause}"))
}

fn exploded(now: &Snapshot, facts: &Facts) -> Option<Warning> {
    let (name, energy) = now.exploded.as_ref()?;
    let advice = facts.advise(Trouble::Exploded);
    let text = because(&format!("{name} has exploded"), &advice);
    let details = format!(
        "{text}. It stores {} of elastic energy, far more than any shape at rest. Where it would fill the stage many times over, it \
         is drawn as an outline or as points.",
        numbers::si(*energy, "J")
    );
    Some(Warning { kind: "exploded", text, details, advice: Some(advice) })
}

fn inside_out(now: &Snapshot, facts: &Facts) -> Option<Warning> {
    let text = match now.inverted {
        0 => return None,
        1 => "1 triangle is inside out".to_owned(),
        many => format!("{many} triangles are inside out"),
    };
    let advice = facts.advise(Trouble::Inverted);
    let text = because(&text, &advice);
    let details = format!(
        "{text}. The smallest J = det F is {}: below 0 a triangle is inverted (inside out).",
        numbers::si(now.min_j, "")
    );
    Some(Warning { kind: "inside out", text, details, advice: Some(advice) })
}

/// Warning about folds: no triangle is inverted, but vertices are folded over.
fn folded(now: &Snapshot) -> Option<Warning> {
    let text = match now.tangle.wound {
        0 => return metastable(now),
        1 => "Folded at 1 vertex: elastic forces do not unfold it".to_owned(),
        many => format!("Folded at {many} vertices: elastic forces do not unfold it"),
    };
    let details =
        "The triangles around such a vertex go around it twice (winding number 2), although none of them is inverted. A body \
                   at rest like this is in a local minimum of its elastic energy and stays there."
            .to_owned();
    Some(Warning { kind: "folded", text, details, advice: Some(Advice::just(Cause::Forces, Remedy::Untangle)) })
}

/// Warning about bodies at rest in another shape than their rest shape.
fn metastable(now: &Snapshot) -> Option<Warning> {
    let text = match now.tangle.metastable {
        0 => return None,
        1 => "1 body rests in a deformed shape: elastic forces balance in it".to_owned(),
        many => format!("{many} bodies rest in deformed shapes: elastic forces balance in them"),
    };
    let details = format!(
        "{text}. Nothing else holds them there: it is a local minimum of the elastic energy. Nearly incompressible triangles have \
         such minima. A pull gets a body out of it, or Untangle."
    );
    Some(Warning { kind: "metastable", text, details, advice: Some(Advice::just(Cause::Forces, Remedy::Untangle)) })
}

/// Warning about surfaces that cross each other.
fn crossed(now: &Snapshot) -> Option<Warning> {
    let text = match now.crossings {
        None | Some((0, _)) => return None,
        Some((1, _)) => "Surfaces cross each other in 1 place".to_owned(),
        Some((many, _)) => format!("Surfaces cross each other in {many} places"),
    };
    let details = format!(
        "{text}. Without the effect Contact cloth passes through itself. With it, they began like this: bodies inside each \
         other are moved apart at a tenth of the wave speed, unless both are held; what is apart stays apart."
    );
    Some(Warning { kind: "crossing", text, details, advice: None })
}

/// Warning about vertices inside a wall or another body.
fn inside(count: usize) -> Option<Warning> {
    let text = match count {
        0 => return None,
        1 => "1 vertex is inside a wall, another body or outside the domain".to_owned(),
        many => format!("{many} vertices are inside walls, other bodies or outside the domain"),
    };
    let details = "They began there. They are pushed out at a tenth of the wave speed in the body, so that it keeps its shape. The work of \
                   that push counts as energy supplied from outside. A pinned vertex stays."
        .to_owned();
    Some(Warning { kind: "inside a wall", text, details, advice: None })
}

/// Warning about a model without a valid result at this stretch. The stage shows the full text.
fn strip_warning(now: &Snapshot) -> Option<Warning> {
    let (body, details) = now.bodies.iter().find_map(|body| Some((body, body.strip_warning.clone()?)))?;
    let text = details.split([':', '.', ';']).next().unwrap_or_default().to_owned();
    let text = if text.len() < 12 { details.clone() } else { text };
    let possible = body.material.model().is_some_and(|model| model != Model::NeoHookean) && !now.side_by_side;
    let advice = possible.then(|| Advice::just(Cause::Crushed, Remedy::Model(Model::NeoHookean)));
    Some(Warning { kind: "caution", text, details, advice })
}

/// Warning about simulated time that runs slower than it should, because of the guard, the number of steps, or painting.
fn slow(now: &Snapshot, rates: &Rates, (pace, facts): (Pace, &Facts)) -> Warning {
    let wanted = if pace == Pace::default() { "in real time" } else { "at the chosen speed" };
    let advice = facts.advise(Trouble::Slow(Load { physics: rates.physics, effort: rates.effort }));
    let text = match advice.cause {
        Cause::Painting => format!("Painting slows the window down: {:.1} frames per second", rates.frames),
        Cause::Cost => {
            let (substeps, is) = match now.level.substeps.get() {
                1 => ("1 step".to_owned(), "is too much"),
                many => (format!("{many} substeps"), "are too many"),
            };
            format!("{substeps} per frame {is} for this computer to run {wanted}")
        }
        Cause::Guard => "The guard divides the steps, which slows time down".to_owned(),
        _ => because("The guard divides the steps, which slows time down", &advice),
    };
    let details = format!(
        "{text}. Simulated time runs slower than that: no step is skipped or lengthened. Stepping takes {} in a frame, {:.1} times \
         what undivided steps take.",
        numbers::si(rates.physics, "s"),
        rates.effort
    );
    Warning { kind: "slow", text, details, advice: Some(advice) }
}

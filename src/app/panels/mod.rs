//! Panels around the stage. A panel reads the snapshot, changes only the display settings ([`View`]), and returns commands.

mod banner;
mod body;
mod budget;
mod checks;
mod compare;
mod cost;
mod dial;
mod effects;
mod energy;
mod finish;
mod hard;
mod ledger;
mod measure;
mod notes;
mod obstacles;
mod overlays;
mod plotting;
mod scheme;
mod status;
mod strip;
mod studies;
mod study_plots;
mod typed_energy;
mod widgets;

pub use compare::apart;
pub use energy::{History, WINDOW};
pub use ledger::Meter;
pub use overlays::{Choice, Prompt, Unsaved};
pub use plotting::Export;

use super::{
    canvas::{self, Tool},
    clock::{Pace, Rates},
    compare::{self as panes, Comparison},
    draw::ghost::EarlierShape,
    film::{self, FilmFormat},
    gallery::Gallery,
    jobs::{JobRequest, Jobs},
    keys::{Binding, KeyAction},
    making,
    meshing::Progress,
    numbers,
    probes::{ProbeRequest, Probes},
    theme::Theme,
};
use crate::{
    app::language::{Language, tr},
    command::Command,
    hard::Method,
    materials::{Model, TypedEnergy},
    meshes::MeshKind,
    quantity::Quantity,
    snapshot::Snapshot,
};
use eframe::egui::{self, Align2, Area, Frame, Id, Order, Panel, Rect, RichText, ScrollArea, Ui, WidgetText, vec2};
use std::{path::PathBuf, sync::Arc};

/// Display settings; nothing in them changes the simulation.
#[derive(Default)]
pub struct View {
    /// Display options of the stage: colours, edges and vertices.
    pub stage: canvas::Options,
    /// Distance of the ends of the colour scale from the value at rest, as it is shown.
    pub scale_end: f64,
    /// Solid whose sliders the pointer was over in this frame. The stage highlights it in the next frame.
    pub meant: Option<[usize; 2]>,
    /// Body whose parameters the sliders show; numbers after the bodies are nets.
    pub body: usize,
    /// Whether the left and the right panel are hidden in a wide window.
    pub hidden: [bool; 2],
    /// Language of the texts.
    pub language: Language,
    /// Words that the level picker searches for.
    pub search: String,
    /// Panel that covers the stage in a narrow window.
    pub drawer: Option<Side>,
    /// Height of the toolbar in the last frame [points].
    pub strip_height: f32,
    /// Zoom of the interface before the presentation, while the stage is shown alone.
    pub presents: Option<f32>,
    /// Whether the presentation begins or ends.
    pub toggles_presentation: bool,
    /// Whether the list of keys is shown.
    pub help: bool,
    /// Notice that waits to be closed.
    pub notice: Option<Notice>,
    /// Kinds of warnings that were hidden.
    pub dismissed: Vec<&'static str>,
    /// Whether simulated time was recently too slow. It keeps the warning from flickering.
    pub slow: bool,
    /// Keys that were pressed, or clicked in the status line.
    pub pressed: Vec<&'static Binding>,
    /// Request for a file.
    pub file: Option<FileRequest>,
    /// Display settings of the hard cases.
    pub hard: hard::HardSettings,
    /// Requests for the studies.
    pub requests: Vec<JobRequest>,
    /// State of the accuracy dial.
    pub dial: dial::DialSettings,
    /// Display settings of the studies.
    pub studies: studies::StudiesSettings,
    /// The plot whose picture is being taken.
    pub sitting: Option<plotting::Sitting>,
    /// Wanted speed of simulated time.
    pub pace: Pace,
    /// Whether the stage is to be drawn into a picture.
    pub takes_picture: bool,
    /// Requests for a film of the stage.
    pub film_requests: Vec<FilmRequest>,
    /// How far the film is that is being recorded.
    pub film: Option<film::Progress>,
    /// Earlier shape that is drawn too.
    pub earlier: Option<EarlierShape>,
    /// Whether what is under the pointer is probed.
    pub picks_now: bool,
    /// Whether the panel scrolls to the probes, because one was added.
    pub shows_probes: bool,
    /// Whether the ruler is removed.
    pub removes_ruler: bool,
    /// Whether a note was placed, whose text takes the keyboard.
    pub has_new_note: bool,
    /// Changes of the probes.
    pub probe_requests: Vec<ProbeRequest>,
    /// A body that is added.
    pub new_body: Option<MeshKind>,
    /// Changes of the view of the stage.
    pub looks: Vec<canvas::Look>,
    /// Requests for the two panes.
    pub panes: Vec<panes::PaneRequest>,
    /// Whether the ledger of effects is open. Effects are timed only then.
    pub ledger: bool,
    /// Text input, where there are no native dialogs.
    pub prompt: Option<Prompt>,
    /// Dialog about unsaved changes.
    pub unsaved: Option<Unsaved>,
    /// Progress of a mesh that is generated in the background.
    pub meshing: Option<Progress>,
    /// Whether that mesh is cancelled.
    pub cancel_mesh: bool,
}

/// A message in a banner over the stage.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Notice {
    /// A refused value, or a file that cannot be read; nothing has changed.
    Trouble(String),
    /// Success of an action without a visible result.
    Done(String),
}

impl Notice {
    /// Notice of an error.
    pub fn trouble(why: &dyn std::fmt::Display) -> Self {
        Self::Trouble(why.to_string())
    }

    /// Text of the message.
    pub fn text(&self) -> &str {
        let (Self::Trouble(text) | Self::Done(text)) = self;
        text
    }
}

/// A side of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The panel of bodies and effects.
    Left,
    /// The panel of display options and costs.
    Right,
}

/// Requests for a film of the stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilmRequest {
    /// Start to record one in this format.
    Start(FilmFormat),
    /// End the recording, and ask where to save the film.
    Stop,
    /// Drop the film.
    Discard,
}

/// Requests for files.
#[derive(Clone, Debug, PartialEq)]
pub enum FileRequest {
    /// Open a level of the gallery, by number.
    BuiltIn(usize),
    /// Open a hard case, by its name, with a model and a method.
    Hard {
        /// Name of the case.
        name: &'static str,
        /// Whether its undamped twin is opened.
        undamped: bool,
        /// Constitutive model of every body.
        model: Model,
        /// Typed energy in its place.
        energy: Option<Arc<TypedEnergy>>,
        /// Integrator and step.
        method: Method,
    },
    /// Ask for a level file and open it.
    Open,
    /// Ask for a mesh file and add a body of it.
    OpenMesh,
    /// Ask for a picture and put it on a net or membrane, by number: nets first.
    OpenImage(usize),
    /// Ask for a file name and save the level.
    Save,
    /// Save the level in its own file; ask for a name where it has none.
    SaveAgain,
    /// Ask for a file name and save the data of a plot.
    Export(Export),
    /// Ask for a file name and save the states of the last seconds as arrays.
    RecordedStates,
    /// Open this file. Other files that were dropped together with it are ignored.
    File(PathBuf, Vec<PathBuf>),
    /// Close the window.
    Close,
}

impl FileRequest {
    /// Whether the request replaces the shown level.
    pub fn replaces_level(&self) -> bool {
        let adds = matches!(self, Self::File(path, _) if making::holds_body(path));
        !adds && matches!(self, Self::BuiltIn(_) | Self::Hard { .. } | Self::Open | Self::File(..) | Self::Close)
    }
}

/// Data that the panels read.
pub struct PanelContext<'a> {
    /// Snapshot of the chosen pane.
    pub now: &'a Snapshot,
    /// Rates of simulated time and of frames.
    pub rates: Option<Rates>,
    /// Built-in levels and hard cases.
    pub gallery: &'a Gallery,
    /// Energies of the last seconds.
    pub history: &'a History,
    /// Probes and what they measured.
    pub probes: &'a Probes,
    /// From where the scene is seen.
    pub viewpoint: canvas::Viewpoint,
    /// What the ruler measures.
    pub measured: Option<canvas::Measured>,
    /// Study jobs.
    pub jobs: &'a Jobs,
    /// Cost of effects in a frame, while the ledger is open.
    pub meter: &'a Meter,
    /// The two panes, if there are two. All other fields concern the chosen pane.
    pub comparison: Option<&'a Comparison>,
    /// Level files that were opened or saved last, the newest first.
    pub recent: &'a [PathBuf],
    /// Whether there are changes that are not saved.
    pub is_unsaved: bool,
    /// Snapshot of pane A.
    pub first: &'a Snapshot,
}

/// Draws the stage and appends the commands of the pointer.
pub type DrawStage<'a> = dyn FnMut(&mut Ui, &mut View, &mut Vec<Command>) + 'a;

/// Width of a window below which the panels cover the stage [points].
const NARROW: f32 = 900.0;

/// Draws the window: panels, stage and dialogs.
pub fn show(
    ui: &mut Ui,
    context: &PanelContext<'_>,
    view: &mut View,
    draw: &mut DrawStage<'_>,
    commands: &mut Vec<Command>,
) {
    present(ui.ctx(), view);
    let narrow = ui.available_width() < NARROW;
    view.stage.pointed = view.meant.take();
    if view.presents.is_none() {
        strip::show(ui, context, view, commands, narrow);
        status::show(ui, context, view, commands);
        if !narrow {
            view.drawer = None;
            docked(ui, context, view, commands);
        }
    }
    let stage = egui::CentralPanel::no_frame().show(ui, |ui| {
        let stage = ui.max_rect();
        draw(ui, view, commands);
        stage
    });
    let stage = stage.inner;
    if view.presents.is_some() {
        overlays::show_way_back(ui.ctx(), stage, view);
    } else if let Some(side) = view.drawer {
        drawer(ui, stage, side, context, view, commands);
    }
    studies::show(ui.ctx(), context, view, commands);
    hard::show(ui.ctx(), context, view);
    close_by_key(ui.ctx(), view);
    // Nothing may cover a plot while its picture is taken.
    if !view.is_posing() {
        banner::show(ui.ctx(), stage, context, view, commands);
        overlays::show_help(ui.ctx(), context.now, view);
        overlays::show_meshing(ui.ctx(), stage, view);
        overlays::show_film(ui.ctx(), stage, context.now, view);
        overlays::show_recording(ui.ctx(), stage, context.now, view, commands);
        overlays::show_prompt(ui.ctx(), view);
        overlays::show_unsaved(ui.ctx(), &context.now.level.name, view);
    }
    if view.meant != view.stage.pointed {
        ui.ctx().request_repaint();
    }
}

/// Shows the stage alone on the whole screen, with larger text, or the panels again.
fn present(ctx: &egui::Context, view: &mut View) {
    /// Larger than otherwise by this factor.
    const LARGER: f32 = 1.5;
    if !std::mem::take(&mut view.toggles_presentation) {
        return;
    }
    let before = view.presents.take();
    if let Some(zoom) = before {
        ctx.set_zoom_factor(zoom);
    } else {
        view.presents = Some(ctx.zoom_factor());
        ctx.set_zoom_factor(LARGER * ctx.zoom_factor());
    }
    ctx.send_viewport_cmd(egui::ViewportCommand::Fullscreen(before.is_none()));
}

/// Closes the windows over the stage when Escape is pressed, unless the key has another meaning at the moment.
fn close_by_key(ctx: &egui::Context, view: &mut View) {
    let means_else = view.help
        || view.prompt.is_some()
        || view.unsaved.is_some()
        || view.notice.is_some()
        || ctx.egui_wants_keyboard_input()
        || egui::Popup::is_any_open(ctx);
    if !means_else && ctx.input(|input| input.key_pressed(egui::Key::Escape)) {
        view.toggles_presentation |= view.presents.is_some();
        (view.studies.open, view.hard.open, view.stage.tool) = (false, false, Tool::Hand);
    }
}

/// Draws both panels beside the stage.
fn docked(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View, commands: &mut Vec<Command>) {
    let [mut left, mut right] = view.hidden.map(|hidden| !hidden);
    Panel::left("left").resizable(false).exact_size(256.0).show_collapsible(ui, &mut left, |ui| {
        side(ui, Side::Left, context, view, commands);
    });
    Panel::right("right").resizable(false).exact_size(320.0).show_collapsible(ui, &mut right, |ui| {
        side(ui, Side::Right, context, view, commands);
    });
}

/// Draws one panel over the stage.
fn drawer(ui: &Ui, stage: Rect, which: Side, context: &PanelContext<'_>, view: &mut View, commands: &mut Vec<Command>) {
    let align = if which == Side::Left { Align2::LEFT_TOP } else { Align2::RIGHT_TOP };
    let width = (if which == Side::Left { 240.0_f32 } else { 304.0 }).min(stage.width() - 28.0);
    let corner = align.pos_in_rect(&stage.shrink(6.0));
    let area =
        Area::new(Id::unique(("drawer", which == Side::Left))).order(Order::Middle).pivot(align).fixed_pos(corner);
    area.constrain_to(stage).show(ui.ctx(), |ui| {
        Frame::window(ui.style()).inner_margin(10).show(ui, |ui| {
            ui.set_width(width - 20.0);
            ui.set_max_height(stage.height() - 36.0);
            side(ui, which, context, view, commands);
        });
    });
}

fn side(ui: &mut Ui, side: Side, context: &PanelContext<'_>, view: &mut View, commands: &mut Vec<Command>) {
    let salt = if side == Side::Left { "left scroll" } else { "right scroll" };
    ScrollArea::vertical().id_salt(salt).auto_shrink([false, true]).show(ui, |ui| {
        // The bar of the scroll area lies over the panel and must not cover the last digit.
        ui.set_max_width(ui.available_width() - 8.0);
        ui.spacing_mut().item_spacing = vec2(6.0, 4.0);
        ui.add_space(4.0);
        compare::caption(ui, context, side);
        if side == Side::Left {
            if !context.now.level.about.is_empty() {
                ui.label(RichText::new(&context.now.level.about).small().weak());
            }
            body::show_test_pose(ui, context.now, commands);
            body::show(ui, context.now, view, commands);
            ui.horizontal_wrapped(|ui| {
                body::add(ui, context.now, view);
                body::export(ui, context.now, view);
            });
            body::show_toy(ui, context.now, view, commands);
            effects::show(ui, context.now, view, commands);
        } else {
            compare::show(ui, context, view);
            cost::show(ui, context, view, commands);
            ledger::show(ui, context, view);
            scheme::show(ui, context, view, commands);
            studies::buttons(ui, view);
            checks::show(ui, context);
            measure::show(ui, context, view);
            notes::show(ui, context, view, commands);
            energy::show(ui, context, view);
        }
        ui.add_space(8.0);
    });
}

/// Carries out the action of a key binding, or of the button for it.
pub fn press(binding: &Binding, now: &Snapshot, view: &mut View) -> Option<Command> {
    match (binding.action)(now) {
        KeyAction::Do(command) => Some(command),
        KeyAction::ToggleHelp => {
            view.help = !view.help;
            None
        }
        KeyAction::ToggleComparison => {
            view.panes.push(panes::PaneRequest::Toggle);
            None
        }
        KeyAction::TakePicture => {
            view.takes_picture = true;
            None
        }
        KeyAction::Film => {
            let request = FilmFormat::offered().next().map(FilmRequest::Start);
            view.film_requests.extend(if view.film.is_some() { Some(FilmRequest::Stop) } else { request });
            None
        }
        KeyAction::Present => {
            view.toggles_presentation = true;
            None
        }
        KeyAction::File(request) => {
            view.file = Some(request);
            None
        }
        KeyAction::Probe => {
            view.picks_now = true;
            None
        }
        KeyAction::Pace(change) => {
            view.pace = change(view.pace);
            None
        }
        KeyAction::Look(look) => {
            view.looks.push(look);
            None
        }
        KeyAction::Mouse => None,
    }
}

/// Draws a heading between the groups of a panel.
fn heading(ui: &mut Ui, text: &str) {
    ui.add_space(6.0);
    heading_here(ui, text);
    ui.add_space(2.0);
}

/// Draws a heading without space around it.
fn heading_here(ui: &mut Ui, text: &str) {
    ui.label(RichText::new(tr(text)).size(15.5).color(Theme::of(ui.ctx()).accent_line));
}

/// Draws a row with a name on the left and a number of constant width on the right.
fn row(ui: &mut Ui, name: impl Into<WidgetText>, value: &str, help: &str) {
    ui.horizontal(|ui| {
        ui.spacing_mut().interact_size.y = 18.0;
        ui.set_height(18.0);
        ui.label(name).on_hover_text(tr(help));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.monospace(value).on_hover_text(tr(help));
        });
    });
}

/// Applies the response of a slider: pushes its command, shows a refusal, and passes on the end of a gesture.
fn apply_response(
    response: widgets::SliderResponse,
    command: Option<Command>,
    view: &mut View,
    commands: &mut Vec<Command>,
) {
    if response.refused.is_some() || response.changed {
        view.notice = response.refused.map(Notice::Trouble);
    }
    if response.changed {
        commands.extend(command);
    }
    if response.ended {
        commands.push(Command::EndGesture);
    }
}

/// Draws sliders for quantities and returns their combined response.
fn sliders<'a>(ui: &mut Ui, numbers: impl IntoIterator<Item = &'a mut dyn Quantity>) -> widgets::SliderResponse {
    let mut sum = widgets::SliderResponse::default();
    for (index, number) in numbers.into_iter().enumerate() {
        sum.add(ui.push_id(index, |ui| widgets::quantity(ui, number)).inner);
    }
    sum
}

/// Formats a count with a gap between thousands: `12 480`.
pub fn count(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// Formats a number and its unit with constant width.
fn fixed(value: f64, unit: &str) -> String {
    numbers::si_fixed(value, unit)
}

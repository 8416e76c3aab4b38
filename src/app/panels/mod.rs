//! Everything around the stage. A panel reads the snapshot, changes only how things are looked at ([`View`]), and
//! answers with commands.

mod axes;
mod banner;
mod body;
mod compare;
mod cost;
mod diagram;
mod drift_plot;
mod effects;
mod energy;
mod export;
mod hard;
mod help;
mod history;
mod icons;
mod ledger;
mod mesh_plot;
mod meshing;
mod net;
mod prompt;
mod scheme;
mod segmented;
mod slider;
mod status;
mod strip;
mod studies;
mod test_pose;
mod toy;
mod unsaved;

pub use compare::apart;
pub use export::Export;
pub use history::{History, WINDOW};
pub use prompt::Prompt;
pub use unsaved::{Choice, Unsaved};

use super::{
    canvas,
    clock::Rates,
    compare::{self as panes, Comparison},
    gallery::Gallery,
    jobs::{JobRequest, Jobs},
    keys::{Binding, KeyAction},
    meshing::Progress,
    meter::Meter,
    numbers,
    theme::Theme,
};
use crate::{command::Command, hard::Method, materials::Model, quantity::Quantity, snapshot::Snapshot};
use eframe::egui::{self, Align2, Area, Frame, Id, Order, Panel, Rect, RichText, ScrollArea, Ui, WidgetText, vec2};
use std::path::PathBuf;

/// How things are looked at: nothing in here changes the simulation.
#[derive(Default)]
pub struct View {
    /// Colours, edges and vertices.
    pub stage: canvas::Options,
    /// The solid whose numbers the pointer was over in this frame: it stands out on the stage in the next.
    pub meant: Option<[usize; 2]>,
    /// The body, or after the bodies the net, whose numbers the sliders show.
    pub body: usize,
    /// Whether the panels on the left and on the right are hidden, in a wide window.
    pub hidden: [bool; 2],
    /// The panel that lies over the stage, in a narrow window.
    pub drawer: Option<Side>,
    /// Height of the strip at the top in the last frame [points].
    pub strip_height: f32,
    /// Whether the list of keys is shown.
    pub help: bool,
    /// A message that waits to be read.
    pub notice: Option<Notice>,
    /// Kinds of warnings that were read and put away.
    pub dismissed: Vec<&'static str>,
    /// Whether time was too slow of late; keeps the warning from flickering.
    pub slow: bool,
    /// Keys that were pressed, or clicked in the line at the bottom.
    pub pressed: Vec<&'static Binding>,
    /// What is wanted of the file system.
    pub file: Option<FileRequest>,
    /// How the hard cases are looked at.
    pub hard: hard::HardSettings,
    /// What is wanted of the studies.
    pub requests: Vec<JobRequest>,
    /// How the studies are looked at.
    pub studies: studies::StudiesSettings,
    /// The plot whose picture is being taken.
    pub sitting: Option<export::Sitting>,
    /// What is wanted of the two panes.
    pub panes: Vec<panes::PaneRequest>,
    /// Whether the ledger of effects is open: only then they are timed.
    pub ledger: bool,
    /// A question that waits for text, where there are no native dialogs.
    pub prompt: Option<Prompt>,
    /// The question about changes that are not saved.
    pub unsaved: Option<Unsaved>,
    /// A mesh that is being made in the background.
    pub meshing: Option<Progress>,
    /// Whether that mesh is no longer wanted.
    pub cancel_mesh: bool,
}

/// A message that waits to be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Notice {
    /// A refused value, a file that cannot be read: nothing has changed.
    Trouble(String),
    /// Something that cannot be seen was done.
    Done(String),
}

impl Notice {
    /// What is wrong.
    pub fn trouble(why: &dyn std::fmt::Display) -> Self {
        Self::Trouble(why.to_string())
    }

    /// What it says.
    pub fn text(&self) -> &str {
        let (Self::Trouble(text) | Self::Done(text)) = self;
        text
    }
}

/// A side of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The body and what acts on it.
    Left,
    /// What it costs.
    Right,
}

/// What is wanted of the file system.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FileRequest {
    /// A level of the gallery, by number.
    BuiltIn(usize),
    /// A hard case, by its name, with a model and a method.
    Hard(&'static str, Model, Method),
    /// Choose a level file and open it.
    Open,
    /// Choose a name and save.
    Save,
    /// Choose a name for what a plot shows, and save it.
    Export(Export),
    /// Open this file; others that were dropped together with it are ignored.
    File(PathBuf, Vec<PathBuf>),
    /// Close the window.
    Close,
}

impl FileRequest {
    /// Whether the level that is shown goes away.
    pub const fn replaces_level(&self) -> bool {
        matches!(self, Self::BuiltIn(_) | Self::Hard(..) | Self::Open | Self::File(..) | Self::Close)
    }
}

/// What the panels read.
pub struct PanelContext<'a> {
    /// The state of everything.
    pub now: &'a Snapshot,
    /// How fast time runs and what it costs.
    pub rates: Option<Rates>,
    /// The levels that come with the program.
    pub gallery: &'a Gallery,
    /// Energies of the last seconds.
    pub history: &'a History,
    /// What is measured beside the scene.
    pub jobs: &'a Jobs,
    /// What effects cost in a frame, while the ledger is open.
    pub meter: &'a Meter,
    /// The two panes, if there are two; all the rest is about the one that is chosen.
    pub comparison: Option<&'a Comparison>,
    /// What pane A shows.
    pub first: &'a Snapshot,
}

/// Draws the stage and appends what the pointer asked for.
pub type DrawStage<'a> = dyn FnMut(&mut Ui, &mut View, &mut Vec<Command>) + 'a;

/// Below this width the sides fold away [points].
const NARROW: f32 = 900.0;

/// Draws the window.
pub fn show(
    ui: &mut Ui,
    context: &PanelContext<'_>,
    view: &mut View,
    draw: &mut DrawStage<'_>,
    commands: &mut Vec<Command>,
) {
    let narrow = ui.available_width() < NARROW;
    view.stage.pointed = view.meant.take();
    strip::show(ui, context, view, commands, narrow);
    status::show(ui, context, view, commands);
    if !narrow {
        view.drawer = None;
        docked(ui, context, view, commands);
    }
    let stage = egui::CentralPanel::no_frame().show(ui, |ui| {
        let stage = ui.max_rect();
        draw(ui, view, commands);
        stage
    });
    let stage = stage.inner;
    if let Some(side) = view.drawer {
        drawer(ui, stage, side, context, view, commands);
    }
    studies::show(ui.ctx(), context, view, commands);
    hard::show(ui.ctx(), context, view);
    close_by_key(ui.ctx(), view);
    // Nothing may lie over a plot while its picture is taken.
    if !view.is_posing() {
        banner::show(ui.ctx(), stage, context, view, commands);
        help::show(ui.ctx(), context.now, view);
        meshing::show(ui.ctx(), stage, view);
        prompt::show(ui.ctx(), view);
        unsaved::show(ui.ctx(), &context.now.level.name, view);
    }
    if view.meant != view.stage.pointed {
        ui.ctx().request_repaint();
    }
}

/// Escape closes the windows over the stage, if it means nothing else.
fn close_by_key(ctx: &egui::Context, view: &mut View) {
    let means_else = view.help
        || view.prompt.is_some()
        || view.unsaved.is_some()
        || view.notice.is_some()
        || ctx.egui_wants_keyboard_input()
        || egui::Popup::is_any_open(ctx);
    if !means_else && ctx.input(|input| input.key_pressed(egui::Key::Escape)) {
        (view.studies.open, view.hard.open) = (false, false);
    }
}

/// Both sides beside the stage.
fn docked(ui: &mut Ui, context: &PanelContext<'_>, view: &mut View, commands: &mut Vec<Command>) {
    let [mut left, mut right] = view.hidden.map(|hidden| !hidden);
    Panel::left("left").resizable(false).exact_size(256.0).show_collapsible(ui, &mut left, |ui| {
        side(ui, Side::Left, context, view, commands);
    });
    Panel::right("right").resizable(false).exact_size(320.0).show_collapsible(ui, &mut right, |ui| {
        side(ui, Side::Right, context, view, commands);
    });
}

/// One side over the stage.
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
        // The bar of the scroll area lies over the panel: it must not cover the last digit.
        ui.set_max_width(ui.available_width() - 8.0);
        ui.spacing_mut().item_spacing = vec2(6.0, 4.0);
        ui.add_space(4.0);
        compare::caption(ui, context, side);
        if side == Side::Left {
            if !context.now.level.about.is_empty() {
                ui.label(RichText::new(&context.now.level.about).small().weak());
            }
            test_pose::show(ui, context.now, commands);
            body::show(ui, context.now, view, commands);
            toy::show(ui, context.now, view, commands);
            effects::show(ui, context.now, view, commands);
        } else {
            compare::show(ui, context, view);
            cost::show(ui, context, view, commands);
            ledger::show(ui, context, view);
            scheme::show(ui, context, view, commands);
            studies::buttons(ui, view);
            energy::show(ui, context, view);
        }
        ui.add_space(8.0);
    });
}

/// Does what a line of the key table, or the button that stands for it, asks for.
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
        KeyAction::Mouse => None,
    }
}

/// A heading between the groups of a panel.
fn heading(ui: &mut Ui, text: &str) {
    ui.add_space(6.0);
    heading_here(ui, text);
    ui.add_space(2.0);
}

/// A heading without space around it.
fn heading_here(ui: &mut Ui, text: &str) {
    ui.label(RichText::new(text).size(15.5).color(Theme::of(ui.ctx()).accent_line));
}

/// A row with a name on the left and a number on the right that does not move when it changes.
fn row(ui: &mut Ui, name: impl Into<WidgetText>, value: &str, help: &str) {
    ui.horizontal(|ui| {
        ui.spacing_mut().interact_size.y = 18.0;
        ui.set_height(18.0);
        ui.label(name).on_hover_text(help);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.monospace(value).on_hover_text(help);
        });
    });
}

/// Takes what a slider did into the view: a refusal is shown, the end of a gesture is passed on.
fn apply_response(
    response: slider::SliderResponse,
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

/// Sliders for numbers that describe themselves; what they did, all together.
fn sliders<'a>(ui: &mut Ui, numbers: impl IntoIterator<Item = &'a mut dyn Quantity>) -> slider::SliderResponse {
    let mut sum = slider::SliderResponse::default();
    for (index, number) in numbers.into_iter().enumerate() {
        sum.add(ui.push_id(index, |ui| slider::quantity(ui, number)).inner);
    }
    sum
}

/// A count with thousands apart: `12 480`.
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

/// A number with a unit, always of the same width.
fn fixed(value: f64, unit: &str) -> String {
    numbers::si_fixed(value, unit)
}

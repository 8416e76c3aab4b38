//! The window. `logic` applies what was asked for in the last frame and lets time run; `ui` draws a snapshot and gathers
//! what is asked for next. Nothing drawn holds a reference into the simulation.

mod camera;
mod canvas;
mod clock;
mod colour;
mod dialogs;
mod draw;
mod file_work;
mod gallery;
pub mod keys;
mod lab;
mod numbers;
mod panels;
mod theme;

use crate::{
    command::Command,
    files::Disk,
    level::Level,
    meshes::Files,
    sandbox::{Refused, Sandbox},
    snapshot::Snapshot,
};
use canvas::Canvas;
use clock::{Clock, Spent};
use dialogs::Dialogs;
use eframe::egui;
use egui::{Context, Ui, ViewportBuilder};
use gallery::Gallery;
use lab::Lab;
use panels::{Desk, History, Notice, View};
use web_time::Instant;

/// Time for stepping in a frame [s]: it leaves some of 1/60 s for drawing.
const BUDGET: f64 = 0.012;

/// Smallest window that is still usable [points].
const SMALLEST: [f32; 2] = [400.0, 400.0];

/// The window's state.
pub struct App {
    sandbox: Sandbox,
    snapshot: Snapshot,
    clock: Clock,
    canvas: Canvas,
    view: View,
    gallery: Gallery,
    history: History,
    dialogs: Dialogs,
    lab: Lab,
    commands: Vec<Command>,
    /// When the last frame was drawn, while time runs [s].
    last: Option<f64>,
    /// Time for stepping in a frame [s].
    budget: f64,
}

impl App {
    /// Starts with a level, or with the gingerbread man.
    ///
    /// # Errors
    /// If the level cannot be built.
    pub fn new(cc: &eframe::CreationContext<'_>, level: Option<Level>) -> Result<Self, Refused> {
        let level = match level {
            Some(level) => level,
            None => Gallery::default().first().unwrap_or_default(),
        };
        Self::with_level(&cc.egui_ctx, level, Box::new(Disk))
    }

    /// Starts with a level whose meshes are read from `files`.
    ///
    /// # Errors
    /// If the level cannot be built.
    pub fn with_level(ctx: &Context, level: Level, files: Box<dyn Files>) -> Result<Self, Refused> {
        theme::install(ctx);
        let sandbox = Sandbox::new(level, files)?;
        let mut snapshot = Snapshot::default();
        sandbox.snapshot(crate::snapshot::Field::None, &mut snapshot);
        Ok(Self {
            sandbox,
            snapshot,
            clock: Clock::default(),
            canvas: Canvas::default(),
            view: View::default(),
            gallery: Gallery::default(),
            history: History::default(),
            dialogs: Dialogs::default(),
            lab: Lab::default(),
            commands: Vec::new(),
            last: None,
            budget: BUDGET,
        })
    }

    /// Takes every step it owes, however long that takes, so that what happens does not depend on the machine.
    #[must_use]
    pub fn unhurried(self) -> Self {
        Self { budget: f64::INFINITY, ..self }
    }

    /// Opens no native dialogs: where to open and save is asked in the window itself.
    #[must_use]
    pub fn without_dialogs(self) -> Self {
        Self { dialogs: Dialogs::silent(), ..self }
    }

    /// What is shown now.
    pub const fn snapshot(&self) -> &Snapshot {
        &self.snapshot
    }

    /// What is edited and run.
    pub const fn sandbox(&self) -> &Sandbox {
        &self.sandbox
    }

    /// Where a point of the world [m] is on the screen, if the stage fills `stage`.
    pub fn on_screen(&self, stage: egui::Rect, point: [f64; 2]) -> egui::Pos2 {
        camera::Camera::new(stage, draw::strip_numbers::height(&self.snapshot, stage)).screen_from_world(point)
    }

    /// The message that waits to be read, if there is one.
    pub fn notice(&self) -> Option<&str> {
        self.view.notice.as_ref().map(Notice::text)
    }

    /// Applies a command; one that is refused is shown, and nothing changes.
    fn apply(&mut self, command: Command) {
        if let Err(refused) = self.sandbox.apply(command) {
            self.view.notice = Some(Notice::trouble(&refused));
        }
    }

    /// Does what was asked for: first what was clicked and dragged, then the keys, each judged after the one before.
    fn apply_wishes(&mut self) {
        for command in std::mem::take(&mut self.commands) {
            self.apply(command);
        }
        for pressed in std::mem::take(&mut self.view.pressed) {
            self.sandbox.snapshot(self.view.stage.field, &mut self.snapshot);
            let command = keys::now(pressed, &self.snapshot)
                .and_then(|binding| panels::press(binding, &self.snapshot, &mut self.view));
            if let Some(command) = command {
                self.apply(command);
            }
        }
    }

    /// Lets time run for as long as the last frame took.
    fn advance(&mut self, now: f64, frame: f64) {
        if !self.sandbox.is_live() {
            self.clock.stop();
            self.last = None;
            return;
        }
        let elapsed = now - self.last.replace(now).unwrap_or(now);
        let step = self.sandbox.step_length();
        let owed = self.clock.owe(elapsed, step);
        let (start, budget) = (Instant::now(), self.budget);
        let taken = self.sandbox.advance(owed, &mut || start.elapsed().as_secs_f64() < budget);
        let physics = start.elapsed().as_secs_f64();
        if elapsed > 0.0 {
            self.clock.pay(Spent { elapsed, step, owed, taken, physics, frame });
        }
    }
}

impl eframe::App for App {
    fn logic(&mut self, ctx: &Context, frame: &mut eframe::Frame) {
        self.lab.follow(&self.sandbox);
        self.file_work(ctx);
        self.apply_wishes();
        let time_of_frame = frame.info().cpu_usage.map_or(0.0, f64::from);
        self.advance(ctx.input(|input| input.time), time_of_frame);
        for wish in std::mem::take(&mut self.view.wishes) {
            self.lab.grant(wish, &self.sandbox);
        }
        if self.lab.work(&self.sandbox) {
            ctx.request_repaint();
        }
        self.sandbox.snapshot(self.view.stage.field, &mut self.snapshot);
        self.history.record(&self.snapshot);
    }

    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        self.view.pressed.extend(keys::pressed(ui.ctx(), &self.snapshot));
        #[cfg(not(target_arch = "wasm32"))]
        self.take_dropped_files(ui.ctx());
        let desk = Desk {
            now: &self.snapshot,
            rates: self.clock.rates(),
            gallery: &self.gallery,
            history: &self.history,
            lab: &self.lab,
        };
        panels::show(ui, &desk, &mut self.view, &mut self.canvas, &mut self.commands);
        let asked = !self.commands.is_empty()
            || !self.view.wishes.is_empty()
            || !self.view.pressed.is_empty()
            || self.view.wants_files();
        if asked || self.view.stage.field != self.snapshot.field || self.sandbox.is_live() {
            ui.ctx().request_repaint();
        }
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }
}

/// Opens the window and stays until it is closed.
///
/// # Errors
/// If the level cannot be built, or there is no display to open a window on.
#[cfg(not(target_arch = "wasm32"))]
pub fn run(level: Option<Level>) -> Result<(), eframe::Error> {
    let viewport = ViewportBuilder::default()
        .with_title("Gingerbread")
        .with_app_id("gingerbread")
        .with_inner_size([1280.0, 800.0])
        .with_min_inner_size(SMALLEST);
    let options = eframe::NativeOptions { viewport, ..Default::default() };
    eframe::run_native(
        "Gingerbread",
        options,
        Box::new(|cc| {
            cc.egui_ctx.set_theme(egui::Theme::Dark);
            Ok(Box::new(App::new(cc, level)?))
        }),
    )
}

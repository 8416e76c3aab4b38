//! The window. `logic` applies the requests of the last frame and advances simulated time. `ui` draws a snapshot and collects
//! the requests for the next frame. Nothing drawn holds a reference into the simulation.

mod advice;
mod arrows;
mod canvas;
mod clock;
mod colour;
pub mod compare;
mod dialogs;
mod draw;
mod files;
mod film;
mod gallery;
mod jobs;
pub mod keys;
mod language;
mod making;
mod meshing;
mod numbers;
mod panels;
mod probes;
mod raster;
mod settings;
mod stage;
mod theme;

use crate::{
    command::Command,
    document::Document,
    files::{Disk, FileError},
    integrators::Class,
    level::{BodyLevel, Level},
    meshes::Files,
    sandbox::{Refused, Sandbox},
    snapshot::Snapshot,
};
pub use canvas::Options;
pub use film::{FilmEncoder, FilmFormat};
pub use stage::Stage;

use crate::clock::Instant;
use arrows::Arrows;
use canvas::{Canvas, Tool};
use clock::{Clock, Spent};
use compare::{Comparison, Pane, PaneRequest, Split, Stage as SplitStage};
use dialogs::Dialogs;
use eframe::egui;
use egui::{Context, Ui};
use film::Recorder;
use gallery::Gallery;
use jobs::Jobs;
use meshing::Meshing;
use panels::{FileRequest, History, Meter, Notice, PanelContext, View};
use probes::{ProbeRequest, Probes};
use std::path::PathBuf;

/// Time budget for steps in a frame \[s\]. The rest of 1/60 s is for drawing.
const BUDGET: f64 = 0.012;

/// Minimum size of the window [points].
#[cfg(not(target_arch = "wasm32"))]
const SMALLEST: [f32; 2] = [400.0, 400.0];

/// State of the window.
pub struct App {
    sandbox: Sandbox,
    snapshot: Snapshot,
    clock: Clock,
    canvas: Canvas,
    view: View,
    gallery: Gallery,
    history: History,
    dialogs: Dialogs,
    jobs: Jobs,
    /// Probes of the chosen pane.
    probes: Probes,
    /// Arrows in both panes.
    arrows: [Arrows; 2],
    /// Cost of effects in the chosen pane. It is measured only while the ledger is shown.
    meter: Meter,
    /// The second pane, while two panes are compared.
    comparison: Option<Box<Comparison>>,
    commands: Vec<Command>,
    /// A mesh that is generated in the background.
    meshing: Meshing,
    /// A film that is being recorded.
    recorder: Option<Recorder>,
    /// Whether actions were recorded, and whether a replay came to the recorded state, at the last frame.
    records: bool,
    replayed: Option<bool>,
    /// The document as it was last opened or saved.
    kept: Document,
    /// File of the level, if it has one, and the level files that were used last.
    path: Option<PathBuf>,
    recent: Vec<PathBuf>,
    /// Title of the window.
    title: String,
    /// File request that waits until the changes are saved.
    after_saving: Option<FileRequest>,
    /// Whether the window closes even if changes are unsaved.
    leaves: bool,
    /// Time of the last frame, while simulated time runs \[s\].
    last: Option<f64>,
    /// Time budget for steps in a frame \[s\].
    budget: f64,
}

impl App {
    /// Creates the window with a level, with the last scene of a page in a browser, or with the first level of the gallery.
    ///
    /// # Errors
    /// If the level cannot be built.
    pub fn new(cc: &eframe::CreationContext<'_>, level: Option<Level>) -> Result<Self, Refused> {
        let level = match level.or_else(|| cc.storage.and_then(settings::last_scene)) {
            Some(level) => level,
            None => Gallery::default().first().unwrap_or_default(),
        };
        let mut app = Self::with_level(&cc.egui_ctx, level, Box::new(Disk))?;
        // The first call asks a browser what it can code; the answer comes a moment later.
        let _ = FilmFormat::offered().count();
        if let Some(storage) = cc.storage {
            app.recall(storage);
        }
        Ok(app)
    }

    /// Creates the window with a level whose mesh files are read from `files`.
    ///
    /// # Errors
    /// If the level cannot be built.
    pub fn with_level(ctx: &Context, level: Level, files: Box<dyn Files>) -> Result<Self, Refused> {
        theme::install(ctx);
        keep_freed_memory();
        let sandbox = Sandbox::new(level, files)?;
        let mut snapshot = Snapshot::default();
        sandbox.snapshot(crate::snapshot::Field::None, &mut snapshot);
        let kept = sandbox.document().clone();
        Ok(Self {
            sandbox,
            snapshot,
            clock: Clock::default(),
            canvas: Canvas::default(),
            view: View::default(),
            gallery: Gallery::default(),
            history: History::default(),
            dialogs: Dialogs::default(),
            jobs: Jobs::default(),
            probes: Probes::default(),
            arrows: Default::default(),
            meter: Meter::default(),
            comparison: None,
            commands: Vec::new(),
            meshing: Meshing::default(),
            recorder: None,
            records: false,
            replayed: None,
            kept,
            path: None,
            recent: Vec::new(),
            title: String::new(),
            after_saving: None,
            leaves: false,
            last: None,
            budget: BUDGET,
        })
    }

    /// Removes the time budget: every owed step is taken. The result does not depend on the speed of the machine.
    #[must_use]
    pub fn unhurried(self) -> Self {
        Self { budget: f64::INFINITY, ..self }
    }

    /// Disables native dialogs: the window itself asks for file names.
    #[must_use]
    pub fn without_dialogs(self) -> Self {
        Self { dialogs: Dialogs::silent(), ..self }
    }

    /// Snapshot on the screen, of pane A if there are two.
    pub const fn snapshot(&self) -> &Snapshot {
        &self.snapshot
    }

    /// Sandbox that is edited and run, of pane A if there are two.
    pub const fn sandbox(&self) -> &Sandbox {
        &self.sandbox
    }

    /// The second pane, while two panes are compared.
    pub fn comparison(&self) -> Option<&Comparison> {
        self.comparison.as_deref()
    }

    /// Position on the screen of a point of the world \[m\], if the stage fills `stage`.
    pub fn on_screen(&self, stage: egui::Rect, point: [f64; 2]) -> egui::Pos2 {
        self.canvas.camera(&self.snapshot, stage).screen_from_world(point)
    }

    /// Text of the current notice, if there is one.
    pub fn notice(&self) -> Option<&str> {
        self.view.notice.as_ref().map(Notice::text)
    }

    /// Applies a command and returns whether it was done.
    ///
    /// With two panes the command comes from `pane`, or else from the chosen pane. A refused command shows a notice and changes nothing.
    /// A large mesh is only requested: it is generated in the background.
    fn apply(&mut self, pane: Option<Pane>, command: Command) -> bool {
        if let Command::SetMesh(body, mesh) = &command {
            let pane = pane.or(self.comparison.as_ref().map(|panes| panes.chosen())).unwrap_or_default();
            let before = self.listed_body(pane, *body).cloned();
            if before.is_some_and(|before| self.meshing.takes(pane, *body, mesh, &before)) {
                return true;
            }
        }
        self.apply_now(pane, command)
    }

    /// Body of the document for a body number of the shown level.
    fn listed_body(&self, pane: Pane, number: usize) -> Option<&BodyLevel> {
        let document = match &self.comparison {
            Some(panes) if pane == Pane::B => panes.sandbox().document(),
            _ => self.sandbox.document(),
        };
        document.level.bodies.get(document.source(number))
    }

    /// Takes a mesh that is finished.
    fn take_mesh(&mut self, ctx: &Context) {
        if std::mem::take(&mut self.view.cancel_mesh) {
            self.meshing.cancel();
        }
        let mut meshing = std::mem::take(&mut self.meshing);
        let released = !ctx.input(|input| input.pointer.any_down());
        let ready = meshing.poll(released, |pane, body| self.listed_body(pane, body));
        self.meshing = meshing;
        match ready {
            Some((wanted, Ok(body))) => {
                self.settled();
                match &mut self.comparison {
                    Some(panes) if wanted.pane == Pane::B => panes.b.prepare(body),
                    _ => self.sandbox.prepare(body),
                }
                let pane = self.comparison.is_some().then_some(wanted.pane);
                self.apply_now(pane, Command::SetMesh(wanted.body, wanted.mesh));
                self.apply_now(pane, Command::EndGesture);
            }
            Some((_, Err(why))) => self.view.notice = Some(Notice::Trouble(why)),
            None => {}
        }
        self.view.meshing = self.meshing.progress();
        if self.view.meshing.is_some() {
            ctx.request_repaint_after(std::time::Duration::from_millis(50));
        }
    }

    /// Applies a command in the same frame, even if it takes long.
    fn apply_now(&mut self, pane: Option<Pane>, command: Command) -> bool {
        let steps = match (&command, &self.comparison) {
            (Command::StepOnce, _) => 1,
            (Command::StepFrame, Some(panes)) => panes.rounds_per_frame(&self.sandbox),
            (Command::StepFrame, None) => self.sandbox.simulation().scene().steps_per_frame(),
            _ => 0,
        };
        let places_note = matches!(command, Command::AddNote(_));
        let result = match &mut self.comparison {
            Some(panes) => panes.apply(&mut self.sandbox, pane.unwrap_or(panes.chosen()), command),
            None => self.sandbox.apply(command),
        };
        if let Err(refused) = &result {
            self.view.notice = Some(Notice::trouble(refused));
        }
        if places_note && result.is_ok() {
            // Its text is shown, also where the panel was closed.
            (self.view.stage.tool, self.view.has_new_note) = (Tool::Hand, true);
            (self.view.hidden[1], self.view.drawer) = (false, Some(panels::Side::Right));
        }
        if steps > 0 && result.is_ok() {
            let panes = self.comparison.as_ref();
            let step = panes.map_or(self.sandbox.step_length(), |panes| panes.round_length(&self.sandbox));
            self.film_steps(steps, step);
        }
        result.is_ok()
    }

    /// Applies the requests of the last frame: first those of the mouse, then those of the keys. Each key is
    /// evaluated in the state after the one before.
    fn apply_requests(&mut self) {
        for request in std::mem::take(&mut self.view.panes) {
            self.compare(request);
        }
        if let Some(panes) = &mut self.comparison {
            let idle = self.commands.is_empty() && self.view.pressed.is_empty();
            if idle && panes.is_between() && panes.stage.only_pulls() {
                // Mouse commands on a vertex wait until both panes have the same time.
                // Other commands return the panes to their last common time.
                return;
            }
            for (pane, command) in std::mem::take(&mut panes.stage.asked) {
                self.apply(Some(pane), command);
            }
        }
        for command in std::mem::take(&mut self.commands) {
            self.apply(None, command);
        }
        for pressed in std::mem::take(&mut self.view.pressed) {
            self.settled();
            self.sandbox.snapshot(self.view.stage.field, &mut self.snapshot);
            let command = keys::now(pressed, &self.snapshot)
                .and_then(|binding| panels::press(binding, &self.snapshot, &mut self.view));
            if let Some(command) = command {
                self.apply(None, command);
            }
        }
        for request in std::mem::take(&mut self.view.panes) {
            self.compare(request);
        }
    }

    /// Sandbox that the panels edit, at a common time of both panes.
    fn settled(&mut self) -> &Sandbox {
        match &mut self.comparison {
            Some(panes) => {
                panes.go_back(&mut self.sandbox);
                if panes.chosen() == Pane::B { panes.sandbox() } else { &self.sandbox }
            }
            None => &self.sandbox,
        }
    }

    /// Distance of the ends of the colour scale from the value at rest.
    pub const fn colour_scale_end(&self) -> f64 {
        self.view.scale_end
    }

    /// The level with its present state, as a file of it has it.
    ///
    /// # Errors
    /// If it cannot be written as RON.
    pub fn level_text(&mut self) -> Result<String, FileError> {
        crate::files::write(&self.settled().saved())
    }

    /// Splits the stage, joins it, or chooses the pane of the panels.
    fn compare(&mut self, request: PaneRequest) {
        let keep = match (request, &mut self.comparison) {
            (PaneRequest::Choose(pane), Some(panes)) => return panes.choose(pane),
            (PaneRequest::Toggle, None) => {
                self.apply(None, Command::Record(false));
                self.comparison = Some(Box::new(Comparison::new(&self.sandbox)));
                self.clock.stop();
                return;
            }
            (_, None) => return,
            (PaneRequest::Keep(pane), Some(_)) => pane,
            (PaneRequest::Toggle, Some(_)) => Pane::A,
        };
        self.settled();
        let Some(panes) = self.comparison.take() else { return };
        if keep == Pane::B {
            let Comparison { b, snapshot, history, jobs, stage, .. } = *panes;
            (self.sandbox, self.snapshot, self.history, self.jobs) = (b, snapshot, history, jobs);
            self.canvas = stage.into_canvas();
        }
        self.canvas.unshare_scale();
        // The mouse may have held a vertex of the pane that was removed.
        self.apply(None, Command::Release);
        self.clock.stop();
    }

    /// Advances simulated time by the length of the last frame, at the chosen pace. The clock stops while everything sleeps: nothing would change.
    fn advance(&mut self, now: f64, frame: f64) {
        let panes = self.comparison.as_mut();
        if !panes.as_ref().map_or(self.sandbox.is_busy(), |panes| panes.is_busy(&self.sandbox)) {
            self.clock.stop();
            self.last = None;
            return;
        }
        let elapsed = now - self.last.replace(now).unwrap_or(now);
        let step = panes.as_ref().map_or(self.sandbox.step_length(), |panes| panes.round_length(&self.sandbox));
        // How long a step takes on the clock at the chosen pace.
        let real = step / self.view.pace.factor();
        let owed = self.clock.owe(clock::steadied(elapsed, real), real);
        let before = self.step_counts();
        let (start, budget) = (Instant::now(), self.budget);
        let more = &mut || start.elapsed().as_secs_f64() < budget;
        let taken = self.take_steps(owed, step, more);
        let physics = start.elapsed().as_secs_f64();
        if elapsed > 0.0 {
            let after = self.step_counts();
            let work = [0, 1].map(|number| after[number].saturating_sub(before[number]));
            self.clock.pay(Spent { elapsed, step: real, owed, taken, physics, frame, work });
        }
    }

    /// Number of computed steps, with those that the guard rejected, and their number if the guard divided none.
    fn step_counts(&self) -> [u64; 2] {
        let mut sum = [0, 0];
        for sandbox in [&self.sandbox].into_iter().chain(self.comparison.as_ref().map(|panes| &panes.b)) {
            let simulation = sandbox.simulation();
            let counts = simulation.counts();
            // An error-controlled scheme divides its steps itself.
            let each = simulation.substep_plans().map(|plan| u64::from(plan.steps)).sum::<u64>().max(1);
            let undivided = if simulation.scene().integrator.kind().class() == Class::ErrorControlled {
                counts.inner_steps
            } else {
                (counts.steps - counts.slept) * each
            };
            sum = [sum[0] + counts.inner_steps + counts.retaken * each, sum[1] + undivided];
        }
        sum
    }

    /// Advances the studies of the chosen pane, and those of the other pane that were already started.
    fn study(&mut self, ctx: &Context) {
        let gauge = !self.view.hidden[1] || self.view.drawer == Some(panels::Side::Right);
        let doubtful =
            |seen: &Snapshot| seen.inverted > 0 || seen.exploded.is_some() || seen.fault.is_some() || self.view.slow;
        let other = self.comparison.as_ref().is_some_and(|panes| doubtful(panes.snapshot()));
        let doubts = [doubtful(&self.snapshot), other];
        let mut all_jobs = vec![(&mut self.jobs, &self.sandbox)];
        let mut chosen = 0;
        if let Some(panes) = &mut self.comparison {
            chosen = panes.chosen() as usize;
            all_jobs.push((&mut panes.jobs, &panes.b));
        }
        for (number, (jobs, sandbox)) in all_jobs.into_iter().enumerate() {
            if number == chosen {
                for request in std::mem::take(&mut self.view.requests) {
                    jobs.grant(request, sandbox);
                }
            }
            if (number == chosen || jobs.twin().is_some() || jobs.is_busy()) && jobs.advance(sandbox, gauge) {
                ctx.request_repaint();
            }
            if doubts[number] && jobs.measure_rest_limit(sandbox) {
                ctx.request_repaint();
            }
        }
    }

    /// Updates the snapshots. While the panes are between two common times, the last snapshots stay.
    fn update_snapshot(&mut self) {
        let field = self.view.stage.field;
        match &mut self.comparison {
            Some(panes) if panes.is_between() => return,
            Some(panes) => panes.update_snapshots(&self.sandbox, &mut self.snapshot, field),
            None => self.sandbox.snapshot(field, &mut self.snapshot),
        }
        let kind = self.view.stage.arrows;
        self.arrows[0].follow(kind, &self.sandbox);
        if let Some(panes) = &self.comparison {
            self.arrows[1].follow(kind, &panes.b);
        }
        self.history.record(&self.snapshot);
        self.tell_replay();
        self.measure();
        if self.view.ledger {
            let b = self.comparison.as_ref().filter(|panes| panes.chosen() == Pane::B);
            self.meter.read(b.map_or(&self.snapshot, |panes| panes.snapshot()));
        }
    }

    /// Tells once what was recorded, and whether a replay came to the recorded state.
    fn tell_replay(&mut self) {
        let records = self.snapshot.records;
        let ended = std::mem::replace(&mut self.records, records) && !records;
        if let Some(end) = self.snapshot.level.recorded.as_ref().filter(|_| ended) {
            let seconds = end.steps as f64 * self.sandbox.step_length();
            self.view.notice = Some(Notice::Done(format!(
                "Recorded {seconds:.2} s and {} actions. Start over and run to replay them; save the level or copy a link to pass them on.",
                end.actions
            )));
        }
        let same = self.snapshot.replayed;
        if std::mem::replace(&mut self.replayed, same) == same || self.comparison.is_some() {
            return;
        }
        let time = self.snapshot.time;
        self.view.notice = match same {
            None => return,
            Some(true) => {
                Some(Notice::Done(format!("Replayed {time:.2} s: the state is the recorded one, bit for bit.")))
            }
            Some(false) => Some(Notice::Trouble(format!(
                "Replayed {time:.2} s: the state is not the recorded one. Another version of Gingerbread recorded it, or the file was changed."
            ))),
        };
    }

    /// Carries out the changes of probes, and measures.
    fn measure(&mut self) {
        let pane = self.comparison.as_ref().map(|panes| panes.chosen()).unwrap_or_default();
        let mut targets = vec![self.canvas.take_target()];
        let (sandbox, seen) = match &mut self.comparison {
            Some(panes) => {
                targets.push(panes.stage.canvas_mut().take_target());
                if panes.chosen() == Pane::B { (&panes.b, panes.snapshot()) } else { (&self.sandbox, &self.snapshot) }
            }
            None => (&self.sandbox, &self.snapshot),
        };
        let simulation = sandbox.simulation();
        self.probes.follow(simulation, (pane, seen.generation, &seen.level.name));
        let picked = targets.into_iter().flatten();
        let picked = picked.filter_map(|target| target.probe(simulation.scene())).map(ProbeRequest::Add);
        let picked: Vec<_> = picked.collect();
        if !picked.is_empty() {
            // What was picked is shown, also where the panel was closed.
            if self.view.stage.tool == Tool::Probe {
                self.view.stage.tool = Tool::Hand;
            }
            self.view.shows_probes = true;
            (self.view.hidden[1], self.view.drawer) = (false, Some(panels::Side::Right));
        }
        for request in std::mem::take(&mut self.view.probe_requests).into_iter().chain(picked) {
            if let Err(why) = self.probes.carry_out(request, simulation) {
                self.view.notice = Some(Notice::Trouble(why));
            }
        }
    }

    /// Measures effects only while the ledger is shown.
    fn measure_effects(&mut self) {
        let measured = self.view.ledger;
        for sandbox in [&mut self.sandbox].into_iter().chain(self.comparison.as_mut().map(|panes| &mut panes.b)) {
            sandbox.set_measured(measured);
        }
        if !measured {
            self.meter.stop();
        }
    }
}

impl eframe::App for App {
    fn logic(&mut self, ctx: &Context, frame: &mut eframe::Frame) {
        self.view.language.choose();
        self.jobs.follow(&self.sandbox);
        if let Some(panes) = &mut self.comparison {
            panes.jobs.follow(&panes.b);
        }
        self.handle_files(ctx);
        self.apply_requests();
        if std::mem::take(&mut self.view.takes_picture) {
            self.take_picture(ctx);
        }
        self.record(ctx);
        self.make();
        self.take_mesh(ctx);
        let time_of_frame = frame.info().cpu_usage.map_or(0.0, f64::from);
        self.measure_effects();
        self.advance(ctx.input(|input| input.time), time_of_frame);
        self.study(ctx);
        self.update_snapshot();
        self.show_title(ctx);
    }

    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        if self.view.unsaved.is_none() {
            self.view.pressed.extend(keys::pressed(ui.ctx(), &self.snapshot));
        }
        self.take_dropped_files(ui.ctx());
        let mut stage = self.comparison.as_mut().map(|panes| std::mem::take(&mut panes.stage));
        let panes = self.comparison.as_deref();
        let (now, history, jobs) = match panes.filter(|panes| panes.chosen() == Pane::B) {
            Some(panes) => (panes.snapshot(), &panes.history, &panes.jobs),
            None => (&self.snapshot, &self.history, &self.jobs),
        };
        let (rates, gallery, first) = (self.clock.rates(), &self.gallery, &self.snapshot);
        let (probes, meter) = (&self.probes, &self.meter);
        let measured = match (&mut stage, panes.filter(|panes| panes.chosen() == Pane::B)) {
            (Some(stage), Some(panes)) => stage.canvas_mut().measured(panes.snapshot()),
            _ => None,
        };
        // Where there is no ruler in the chosen pane, the one in the other is told.
        let measured = measured.or_else(|| self.canvas.measured(&self.snapshot));
        let (recent, is_unsaved) = (&self.recent[..], self.is_unsaved());
        let context = PanelContext {
            now,
            rates,
            gallery,
            history,
            probes,
            viewpoint: self.canvas.viewpoint(),
            measured,
            jobs,
            meter,
            comparison: panes,
            recent,
            is_unsaved,
            first,
        };
        let canvas = &mut self.canvas;
        for look in std::mem::take(&mut self.view.looks) {
            // With two panes both are seen from the same viewpoint.
            canvas.look(look);
        }
        let picks_now = std::mem::take(&mut self.view.picks_now);
        let removes_ruler = std::mem::take(&mut self.view.removes_ruler);
        let marks: Vec<_> = self.probes.marks().collect();
        for canvas in stage.iter_mut().map(SplitStage::canvas_mut).chain([&mut *canvas]) {
            canvas.set_probes(marks.clone(), picks_now);
            canvas.set_earlier(self.view.earlier.clone());
            if removes_ruler {
                canvas.clear_ruler();
            }
        }
        canvas.set_arrows(&self.arrows[0]);
        if let Some(stage) = &mut stage {
            stage.canvas_mut().set_arrows(&self.arrows[1]);
        }
        let mut draw = |ui: &mut Ui, view: &mut View, commands: &mut Vec<Command>| match (&mut stage, panes) {
            (Some(stage), Some(panes)) => {
                let split =
                    Split { seen: [first, panes.snapshot()], chosen: panes.chosen(), apart: panels::apart(panes) };
                view.panes.extend(stage.show(ui, canvas, &split, &view.stage));
            }
            _ => canvas.show(ui, first, &view.stage, commands),
        };
        panels::show(ui, &context, &mut self.view, &mut draw, &mut self.commands);
        self.view.scale_end = self.canvas.scale_end();
        if let (Some(panes), Some(stage)) = (&mut self.comparison, stage) {
            panes.stage = stage;
        }
        let asked = !self.commands.is_empty()
            || !self.view.requests.is_empty()
            || !self.view.pressed.is_empty()
            || !self.view.panes.is_empty()
            || !self.view.looks.is_empty()
            || !self.view.probe_requests.is_empty()
            || self.view.picks_now
            || self.view.removes_ruler
            || self.comparison.as_ref().is_some_and(|panes| !panes.stage.asked.is_empty())
            || self.view.cancel_mesh
            || !self.view.film_requests.is_empty()
            || self.view.wants_files();
        let busy = self.comparison.as_ref().map_or(self.sandbox.is_busy(), |panes| panes.is_busy(&self.sandbox));
        if asked || self.view.stage.field != self.snapshot.field || busy {
            ui.ctx().request_repaint();
        }
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        self.keep(storage);
    }

    #[cfg(target_arch = "wasm32")]
    fn as_any_mut(&mut self) -> Option<&mut dyn std::any::Any> {
        Some(self)
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }
}

/// Size of the block that the allocator keeps from frame to frame [bytes].
const KEPT: usize = 24 << 20;

/// Makes the allocator of glibc keep freed memory from frame to frame.
///
/// egui allocates some megabytes of triangles for the graphics card in every frame and frees them again. glibc returns such large
/// blocks to the system and gets them again page by page, which takes longer than filling them. It keeps blocks up to twice the
/// largest block that was ever freed. So one large block is allocated and freed here, without being written.
fn keep_freed_memory() {
    drop(std::hint::black_box(Vec::<u8>::with_capacity(KEPT)));
}

/// Opens the window and returns when it is closed. With a link its level is shown as the link says.
///
/// # Errors
/// If the level cannot be built, or there is no display to open a window on.
#[cfg(not(target_arch = "wasm32"))]
pub fn run(level: Option<Level>, link: Option<&str>) -> Result<(), eframe::Error> {
    crate::study::share_partitions(crate::study::threads());
    let viewport = egui::ViewportBuilder::default()
        .with_title("Gingerbread")
        .with_app_id("gingerbread")
        .with_icon(icon().unwrap_or_default())
        .with_inner_size([1280.0, 800.0])
        .with_min_inner_size(SMALLEST);
    let options = eframe::NativeOptions { viewport, ..Default::default() };
    let create = |cc: &eframe::CreationContext<'_>| {
        let mut app = App::new(cc, level)?;
        if let Some(address) = link {
            app.open_link(address);
        }
        Ok::<Box<dyn eframe::App>, Box<dyn std::error::Error + Send + Sync>>(Box::new(app))
    };
    eframe::run_native("Gingerbread", options, Box::new(create))
}

/// The icon of the window, where the system shows one.
#[cfg(not(target_arch = "wasm32"))]
fn icon() -> Option<egui::IconData> {
    let crate::picture::Picture { size: [width, height], rgba } =
        crate::picture::Picture::of_png(include_bytes!("../../assets/icon.png"), 1024).ok()?;
    Some(egui::IconData { rgba, width: width as u32, height: height as u32 })
}

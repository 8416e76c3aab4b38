//! Pictures and films as the window takes them: when a frame is due, and where what is finished is saved.

use super::{LARGEST, Recorder, Shot};
use crate::{
    app::{
        App,
        compare::Pane,
        files,
        panels::{Export, FileRequest, FilmRequest, Notice},
        stage::Stage,
    },
    command::Command,
    snapshot::Snapshot,
};
use eframe::egui::{Context, Theme};

impl App {
    /// What the stage of the chosen pane shows now, and its size \[points\].
    fn shot(&mut self) -> (Shot, [usize; 2]) {
        let options = self.view.stage;
        let mut snapshot = Snapshot::default();
        self.settled().snapshot(options.field, &mut snapshot);
        let canvas = match &self.comparison {
            Some(panes) if panes.chosen() == Pane::B => panes.stage.canvas(),
            _ => &self.canvas,
        };
        let size = [canvas.size().x, canvas.size().y].map(|points| (points.round() as usize).clamp(16, 4096));
        (Shot { snapshot, options, viewpoint: canvas.viewpoint() }, size)
    }

    /// Draws the stage of the chosen pane into a picture, without panels and buttons, and asks where to save it.
    pub(in crate::app) fn take_picture(&mut self, ctx: &Context) {
        /// Pixels of the picture along a side of a point of the window.
        const SCALE: usize = 2;
        let (Shot { snapshot, options, viewpoint }, size) = self.shot();
        let mut stage = Stage::new((size, SCALE), ctx.theme() == Theme::Dark, options);
        stage.see_from(viewpoint);
        let name = format!("{}-{:.3}s.png", files::stem(&snapshot.level.name), snapshot.time);
        match stage.first_picture(&snapshot).png() {
            Ok(bytes) => self.view.file = Some(FileRequest::Export(Export { name, bytes })),
            Err(why) => self.view.notice = Some(Notice::Trouble(format!("The picture could not be made: {why}"))),
        }
    }

    /// Starts and ends films, and asks where to save one that is finished.
    pub(in crate::app) fn record(&mut self, ctx: &Context) {
        for request in std::mem::take(&mut self.view.film_requests) {
            match (request, &mut self.recorder) {
                (FilmRequest::Start(format), None) => {
                    let (shot, size) = self.shot();
                    let fits = |axis: usize| LARGEST[axis] as f64 / size[axis] as f64;
                    let scale = fits(0).min(fits(1)).min(1.0);
                    // The sides of films are even.
                    let size = size.map(|side| (side as f64 * scale) as usize & !1);
                    let look = (ctx.theme() == Theme::Dark, self.view.pace.factor());
                    match Recorder::start(format, size, look, shot) {
                        Ok(recorder) => self.recorder = Some(recorder),
                        Err(why) => self.view.notice = Some(Notice::Trouble(format!("No film can be recorded: {why}"))),
                    }
                }
                (FilmRequest::Start(_), Some(_)) | (FilmRequest::Stop, None) => {}
                (FilmRequest::Stop, Some(recorder)) => recorder.stop(),
                (FilmRequest::Discard, _) => self.recorder = None,
            }
        }
        // Where another file is asked for, a finished film waits.
        let asks = self.dialogs.is_waiting() || self.view.file.is_some() || self.view.prompt.is_some();
        if let Some(film) = self.recorder.as_mut().filter(|_| !asks).and_then(Recorder::poll) {
            match (film, self.recorder.take()) {
                (Ok(bytes), Some(recorder)) => {
                    let (stem, ending) =
                        (files::stem(&self.snapshot.level.name), recorder.progress().format.extension());
                    let name = format!("{stem}-{:.3}s.{ending}", recorder.start);
                    self.view.file = Some(FileRequest::Export(Export { name, bytes }));
                }
                (Err(why), _) => self.view.notice = Some(Notice::Trouble(format!("The film could not be made: {why}"))),
                (Ok(_), None) => {}
            }
        }
        self.view.film = self.recorder.as_ref().map(Recorder::progress);
        if self.view.film.is_some() {
            ctx.request_repaint_after(std::time::Duration::from_millis(50));
        }
    }

    /// Adds the frame that is due after some steps \[s\].
    pub(in crate::app) fn film_steps(&mut self, steps: u64, step: f64) {
        if self.recorder.as_mut().is_some_and(|recorder| recorder.pass(steps as f64 * step, step)) {
            let (shot, _) = self.shot();
            if let Some(recorder) = &mut self.recorder {
                recorder.add(shot);
            }
        }
    }

    /// Takes owed steps \[s\] while `more` returns true, and the frames of a film on the way; returns how many were taken.
    pub(in crate::app) fn take_steps(&mut self, owed: u64, step: f64, more: &mut dyn FnMut() -> bool) -> u64 {
        let mut taken = 0;
        while taken < owed {
            let to_frame = self.recorder.as_mut().map_or(u64::MAX, |recorder| recorder.steps_to_frame(step));
            let to_end = self.sandbox.simulation().steps_to_end().filter(|_| self.comparison.is_none());
            let wanted = to_frame.min(owed - taken).min(to_end.unwrap_or(u64::MAX));
            if wanted == 0 {
                break;
            }
            let done = match &mut self.comparison {
                Some(panes) => panes.advance(&mut self.sandbox, wanted, more),
                None => self.sandbox.advance(wanted, more),
            };
            taken += done;
            self.film_steps(done, step);
            if to_end == Some(done) {
                self.apply(None, Command::SetRunning(false));
                break;
            }
            if done < wanted {
                break;
            }
        }
        taken
    }
}

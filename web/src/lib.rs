//! The page in the browser: the window on a canvas, and the states of levels, which are those of the program.
#![cfg(target_arch = "wasm32")]
#![warn(missing_docs)]

use gingerbread::{
    app::App,
    files,
    level::{Level, RunMode},
    levels, link,
    meshes::NoFiles,
    scene::Scene,
    simulation::Simulation,
};
use wasm_bindgen::prelude::*;

/// The window.
#[wasm_bindgen]
pub struct Page(eframe::WebRunner);

#[wasm_bindgen]
impl Page {
    /// A window that is not shown yet. From here on, a panic is written to the console.
    #[wasm_bindgen(constructor)]
    #[expect(clippy::new_without_default, reason = "a page makes one")]
    pub fn new() -> Self {
        Self(eframe::WebRunner::new())
    }

    /// Shows the window on a canvas, with the level in the address of the page if there is one.
    ///
    /// # Errors
    /// If there is no WebGL, or the first level cannot be built.
    pub async fn show(&self, canvas: web_sys::HtmlCanvasElement, address: String) -> Result<(), JsValue> {
        let create = move |cc: &eframe::CreationContext<'_>| {
            let mut app = App::new(cc, None)?;
            app.open_link(&address);
            Ok(Box::new(app) as Box<dyn eframe::App>)
        };
        self.0.start(canvas, eframe::WebOptions::default(), Box::new(create)).await
    }

    /// Opens the level in another address.
    pub fn open_link(&self, address: &str) {
        if let Some(mut app) = self.0.app_mut::<App>() {
            app.open_link(address);
        }
    }

    /// Opens a level from the text of its file.
    pub fn open_level(&self, text: &str) {
        if let Some(mut app) = self.0.app_mut::<App>() {
            app.open_text(text, "level");
        }
    }

    /// The level in the window with its present state, as a file of it has it; `undefined` if the window has stopped.
    pub fn level(&self) -> Option<String> {
        self.0.app_mut::<App>()?.level_text().ok()
    }

    /// A link to the level at its start, from `#` on.
    ///
    /// # Errors
    /// If the level does not fit into one.
    pub fn link(&self) -> Result<String, String> {
        let mut app = self.0.app_mut::<App>().ok_or("The window has stopped.")?;
        let level = app.level_text().and_then(|text| files::parse(&text, "level"));
        level.and_then(|level| link::fragment(&level)).map_err(|error| error.to_string())
    }

    /// Whether a replay came to the recorded state; `undefined` before its end, or if nothing was recorded.
    pub fn replayed(&self) -> Option<bool> {
        self.0.app_mut::<App>()?.snapshot().replayed
    }

    /// What went wrong, if the window has stopped.
    pub fn panic(&self) -> Option<String> {
        self.0.panic_summary().map(|summary| summary.message())
    }
}

/// File names of the built-in levels.
#[wasm_bindgen]
pub fn built_in_levels() -> Vec<String> {
    levels::BUILT_IN.iter().map(|(file, _)| (*file).to_owned()).collect()
}

/// Hash of the state of a built-in level after some seconds of simulated time.
///
/// # Errors
/// If there is no such level, or it cannot be built, or stops.
#[wasm_bindgen]
pub fn state_hash(name: &str, collide: bool, seconds: f64) -> Result<String, String> {
    let text = levels::built_in(name).ok_or_else(|| format!("There is no level {name}."))?;
    let mode = if collide { RunMode::Collide } else { RunMode::Simulate };
    let level = Level { mode, ..files::parse(text, name).map_err(|error| error.to_string())? };
    let scene = Scene::build(&level, mode, &NoFiles, None).map_err(|error| error.to_string())?;
    let mut simulation = Simulation::open(scene, &level, mode).map_err(|error| error.to_string())?;
    let steps = (seconds / simulation.scene().step).round() as u64;
    simulation.advance(steps, &mut || true);
    if let Some(fault) = simulation.fault() {
        return Err(fault.to_string());
    }
    Ok(format!("{:016x}", simulation.state().hash()))
}

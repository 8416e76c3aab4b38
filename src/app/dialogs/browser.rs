//! File dialogs of a browser. What is opened or dropped is read into memory, and what is saved is downloaded.

use super::{DialogResult, Purpose};
use crate::{
    app::making::ENDINGS,
    files::{FileError, browser},
};
use eframe::egui::{Context, DroppedFileHandle};
use std::{
    cell::RefCell,
    path::{Path, PathBuf},
    rc::Rc,
};
use wasm_bindgen::{JsCast as _, JsValue, closure::Closure};
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_sys::{Blob, HtmlAnchorElement, HtmlInputElement, Url};

/// State of the dialogs.
#[derive(Default)]
pub struct Dialogs {
    /// What a file is awaited for. A browser does not tell that a dialog was cancelled.
    open: Option<Purpose>,
    answered: Option<DialogResult>,
    /// The window, which takes a file in its next frame.
    ctx: Context,
    /// Files that were chosen, and those that were dropped, once they are read.
    chosen: Rc<RefCell<Vec<PathBuf>>>,
    dropped: Rc<RefCell<Vec<PathBuf>>>,
}

impl Dialogs {
    /// The same as the default.
    pub fn silent() -> Self {
        Self::default()
    }

    /// Opens a dialog for a file to open. A file to save has its suggested name at once.
    pub fn ask(&mut self, purpose: Purpose) {
        let is_asked = match &purpose {
            Purpose::Open => self.pick(&format!(".ron,.{}", ENDINGS.join(",."))),
            Purpose::OpenMesh => self.pick(&format!(".{}", ENDINGS.join(",."))),
            Purpose::OpenImage(_) => self.pick(".png"),
            Purpose::Save(name) => {
                self.answered = Some(DialogResult::Chosen(purpose.clone(), PathBuf::from(name)));
                return;
            }
            Purpose::Export(export) => {
                let path = PathBuf::from(&export.name);
                self.answered = Some(DialogResult::Chosen(purpose, path));
                return;
            }
        };
        match is_asked {
            Some(()) => self.open = Some(purpose),
            None => self.answered = Some(DialogResult::Unavailable(purpose)),
        }
    }

    /// Paths of dropped files whose contents have been read since the last call.
    pub fn paths_of(&self, ctx: &Context, dropped: &[DroppedFileHandle]) -> Vec<PathBuf> {
        if !dropped.is_empty() {
            let (dropped, arrived, ctx) = (dropped.to_vec(), Rc::clone(&self.dropped), ctx.clone());
            spawn_local(async move {
                let mut paths = Vec::new();
                for file in dropped {
                    if let Ok(bytes) = file.bytes_async().await {
                        browser::write(file.path(), &bytes);
                    }
                    // One that could not be read is told so when it is opened.
                    paths.push(file.path().to_path_buf());
                }
                arrived.borrow_mut().extend(paths);
                ctx.request_repaint();
            });
        }
        std::mem::take(&mut *self.dropped.borrow_mut())
    }

    /// Whether a result is expected that will surely come.
    pub const fn is_waiting(&self) -> bool {
        self.answered.is_some()
    }

    /// Returns the result of a dialog.
    pub fn poll(&mut self, ctx: &Context) -> Option<DialogResult> {
        self.ctx.clone_from(ctx);
        if let Some(answered) = self.answered.take() {
            return Some(answered);
        }
        let path = self.chosen.borrow_mut().pop()?;
        Some(DialogResult::Chosen(self.open.take()?, path))
    }

    /// Asks for a file with one of some endings. Its content is read, and then its name is among the chosen ones. `None` if there is no page.
    fn pick(&self, endings: &str) -> Option<()> {
        let (chosen, ctx) = (Rc::clone(&self.chosen), self.ctx.clone());
        let document = web_sys::window()?.document()?;
        let input: HtmlInputElement = document.create_element("input").ok()?.dyn_into().ok()?;
        input.set_type("file");
        input.set_accept(endings);
        let own = input.clone();
        let on_change = Closure::once_into_js(move || {
            let Some(file) = own.files().and_then(|files| files.get(0)) else { return };
            spawn_local(async move {
                let path = PathBuf::from(file.name());
                if let Ok(buffer) = JsFuture::from(file.array_buffer()).await {
                    browser::write(&path, &js_sys::Uint8Array::new(&buffer).to_vec());
                }
                chosen.borrow_mut().push(path);
                ctx.request_repaint();
            });
        });
        input.set_onchange(Some(on_change.unchecked_ref()));
        input.click();
        Some(())
    }
}

/// How the notice about a saved file begins.
pub const SAVED: &str = "Downloaded as";

/// Address of the page, without a level.
pub fn page() -> String {
    let address = web_sys::window().and_then(|window| window.location().href().ok()).unwrap_or_default();
    address.split_once('#').map_or(address.as_str(), |(page, _)| page).to_owned()
}

/// Downloads a saved file.
///
/// # Errors
/// [`FileError::Access`] if the browser refuses.
pub fn hand_over(path: &Path) -> Result<(), FileError> {
    let name = path.display().to_string();
    let given = browser::read_bytes(path)
        .and_then(|bytes| download(&name, &bytes).map_err(|error| format!("the browser refuses: {error:?}")));
    given.map_err(|why| FileError::Access { file: name, why })
}

fn download(name: &str, bytes: &[u8]) -> Result<(), JsValue> {
    let page = web_sys::window().and_then(|window| window.document()).ok_or("there is no page")?;
    let parts = js_sys::Array::of1(&js_sys::Uint8Array::from(bytes));
    let url = Url::create_object_url_with_blob(&Blob::new_with_u8_array_sequence(&parts)?)?;
    let link: HtmlAnchorElement = page.create_element("a")?.unchecked_into();
    link.set_href(&url);
    link.set_download(name);
    // Browsers read the content after this: it is kept until the page is closed.
    link.click();
    Ok(())
}

//! File dialogs: those of the system, or those of a browser.
//!
//! They are polled so that the window never blocks. Where there are none, as on a minimal system, the result is
//! [`DialogResult::Unavailable`], and the window shows a text input instead.

#[cfg(target_arch = "wasm32")]
mod browser;
#[cfg(not(target_arch = "wasm32"))]
mod native;

#[cfg(target_arch = "wasm32")]
pub use browser::{Dialogs, SAVED, hand_over, page};
#[cfg(not(target_arch = "wasm32"))]
pub use native::{Dialogs, SAVED, hand_over, page};

use super::panels::Export;
use std::path::PathBuf;

/// Purpose of a file dialog.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Purpose {
    /// Open a level.
    #[default]
    Open,
    /// Add a body whose mesh is in a file.
    OpenMesh,
    /// Put a picture on a net or membrane, by number: nets first.
    OpenImage(usize),
    /// Save the level. The field is the suggested name.
    Save(String),
    /// Save the data of a plot.
    Export(Export),
}

impl Purpose {
    /// Title of the dialog.
    pub const fn title(&self) -> &'static str {
        match self {
            Self::Open => "Open a level",
            Self::OpenMesh => "Add a body from a mesh, a drawing or a picture",
            Self::OpenImage(_) => "Open a picture (PNG)",
            Self::Save(_) => "Save the level",
            Self::Export(_) => "Save the file",
        }
    }

    /// Whether a file is read, not written.
    pub const fn reads(&self) -> bool {
        matches!(self, Self::Open | Self::OpenMesh | Self::OpenImage(_))
    }

    /// Suggested file name.
    pub fn name(&self) -> &str {
        match self {
            Self::Open | Self::OpenMesh | Self::OpenImage(_) => "",
            Self::Save(name) => name,
            Self::Export(export) => &export.name,
        }
    }
}

/// Result of a dialog.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DialogResult {
    /// This file was chosen.
    Chosen(Purpose, PathBuf),
    /// No native dialog is available.
    Unavailable(Purpose),
}

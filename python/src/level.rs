//! Levels.

use crate::value_error;
use gingerbread::{
    files,
    headless::{self, Overrides},
    level::{self, RunMode, Substeps},
    levels, link,
};
use pyo3::{prelude::*, types::PyDict};
use pythonize::Depythonizer;
use std::path::{Path, PathBuf};

/// Names of the built-in levels.
#[pyfunction]
pub fn built_in_levels() -> Vec<&'static str> {
    levels::BUILT_IN.iter().map(|(file, _)| file.strip_suffix(".ron").unwrap_or(file)).collect()
}

/// An error with the name of an argument before it.
fn named(argument: &str) -> impl Fn(String) -> PyErr {
    move |why| value_error(format!("{argument}: {why}"))
}

/// A level: bodies, nets, membranes, effects and settings. It does not change.
#[pyclass(frozen, eq, module = "gingerbread")]
#[derive(Clone, PartialEq)]
pub struct Level(pub level::Level);

#[pymethods]
impl Level {
    /// A level from a file, by the name of a built-in one, or from a link.
    #[new]
    fn new(path: PathBuf) -> PyResult<Self> {
        headless::read(&path).map(Self).map_err(value_error)
    }

    /// A level from the text of a file.
    #[staticmethod]
    fn from_text(text: &str) -> PyResult<Self> {
        files::parse(text, "level").map(Self).map_err(value_error)
    }

    /// A level from a dictionary with the names of the level format: `{"name": "Fall", "bodies": [...]}`.
    #[staticmethod]
    fn from_dict(level: &Bound<'_, PyDict>) -> PyResult<Self> {
        serde_path_to_error::deserialize(&mut Depythonizer::from_object(level)).map(Self).map_err(value_error)
    }

    /// The level as a dictionary with the names of the level format.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pythonize::pythonize(py, &self.0).map_err(value_error)
    }

    /// The text of a file of the level.
    fn to_text(&self) -> PyResult<String> {
        files::write(&self.0).map_err(value_error)
    }

    /// A link to the level, to follow the address of a page.
    fn to_link(&self) -> PyResult<String> {
        link::fragment(&self.0).map_err(value_error)
    }

    /// Saves the level.
    fn save(&self, path: PathBuf) -> PyResult<()> {
        files::save(&path, &self.0).map_err(value_error)
    }

    /// The level with another constitutive model of all bodies and membranes, another integrator, a longest step [s], or another mode
    /// (`"Simulate"` or `"Collide"`).
    #[pyo3(signature = (*, model=None, integrator=None, step=None, mode=None))]
    fn replace(
        &self,
        model: Option<&str>,
        integrator: Option<&str>,
        step: Option<f64>,
        mode: Option<&str>,
    ) -> PyResult<Self> {
        let overrides = Overrides {
            model: model.map(str::parse).transpose().map_err(named("model"))?,
            integrator: integrator.map(str::parse).transpose().map_err(named("integrator"))?,
            step: match step.map(Substeps::for_step) {
                Some(None) => return Err(value_error("step: expected a number of seconds, at most 1/60")),
                step => step.flatten(),
            },
        };
        let mut level = self.0.clone();
        overrides.apply(&mut level, Path::new(&self.0.name)).map_err(value_error)?;
        if let Some(mode) = mode {
            level.mode = match mode {
                "Simulate" => RunMode::Simulate,
                "Collide" => RunMode::Collide,
                _ => return Err(value_error("mode: expected \"Simulate\" or \"Collide\"")),
            };
        }
        Ok(Self(level))
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    fn __repr__(&self) -> String {
        format!("<Level {:?}>", self.0.name)
    }
}

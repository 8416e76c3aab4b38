//! Gingerbread for Python: levels, simulations, studies and pictures.
#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod level;
mod picture;
mod simulation;
mod study;

/// What `import gingerbread` shows.
#[pyo3::pymodule]
mod _gingerbread {
    #[pymodule_export]
    use super::{
        level::{Level, built_in_levels},
        picture::picture,
        simulation::Simulation,
        study::work_precision_csv,
    };
}

/// An error of Python with the message of another one.
fn value_error(error: impl ToString) -> pyo3::PyErr {
    pyo3::exceptions::PyValueError::new_err(error.to_string())
}

/// Calls a function now and then while something long goes on, so that Ctrl+C ends it.
struct Interruptible {
    asked: std::time::Instant,
    error: Option<pyo3::PyErr>,
}

impl Interruptible {
    /// Time between two looks.
    const INTERVAL: std::time::Duration = std::time::Duration::from_millis(50);

    fn new() -> Self {
        Self { asked: std::time::Instant::now(), error: None }
    }

    /// Whether to go on.
    fn goes_on(&mut self) -> bool {
        if self.asked.elapsed() >= Self::INTERVAL {
            self.error = pyo3::Python::attach(|py| py.check_signals()).err();
            self.asked = std::time::Instant::now();
        }
        self.error.is_none()
    }

    /// The interruption, if there was one.
    fn end(self) -> pyo3::PyResult<()> {
        self.error.map_or(Ok(()), Err)
    }
}

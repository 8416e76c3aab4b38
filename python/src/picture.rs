//! Pictures.

use crate::{level::Level, simulation::array, value_error};
use gingerbread::{
    app::{Options, Stage},
    command::Command,
    files::Disk,
    picture::Picture,
    sandbox::Sandbox,
    snapshot::Snapshot,
};
use pyo3::prelude::*;

/// A picture of a level at its start or where it was saved: an array of rows, columns, and red, green and blue in 0 to 255.
#[pyfunction]
#[pyo3(signature = (level, *, width=480, height=480, dark=false, wireframe=false))]
pub fn picture<'py>(
    py: Python<'py>,
    level: &Level,
    width: usize,
    height: usize,
    dark: bool,
    wireframe: bool,
) -> PyResult<Bound<'py, PyAny>> {
    if ![width, height].iter().all(|side| (16..=4096).contains(side)) {
        return Err(value_error("width and height: expected numbers in [16, 4096]"));
    }
    let level = level.0.clone();
    let bytes = py.detach(|| {
        let mode = level.mode;
        let mut sandbox = Sandbox::new(level, Box::new(Disk)).map_err(value_error)?;
        sandbox.apply(Command::SetMode(mode.into())).map_err(value_error)?;
        let options = Options { wireframe, ..Options::default() };
        let mut stage = Stage::new(([width, height], 1), dark, options);
        let mut snapshot = Snapshot::default();
        sandbox.snapshot(options.field, &mut snapshot);
        Ok::<_, PyErr>(rgb(&stage.first_picture(&snapshot)))
    })?;
    array(py, &bytes, ("uint8", Some(3)))?.call_method1("reshape", ((height, width, 3),))
}

/// The colours of a picture without their opacity, which is full.
fn rgb(picture: &Picture) -> Vec<u8> {
    picture.rgba.as_chunks::<4>().0.iter().flat_map(|[red, green, blue, _]| [*red, *green, *blue]).collect()
}

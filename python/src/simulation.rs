//! Running levels.

use crate::{Interruptible, level::Level, value_error};
use bytemuck::cast_slice;
use gingerbread::{
    effects::Grab,
    files::Disk,
    level,
    probe::Probe,
    scene::Scene,
    simulation, stability,
    study::{share_partitions, threads},
};
use pyo3::{
    prelude::*,
    types::{PyBytes, PyDict},
};
use std::sync::{Mutex, PoisonError};

/// A running level. Vertices and triangles have the order of the level: of all bodies, then of all nets, then of all membranes.
#[pyclass(module = "gingerbread")]
pub struct Simulation {
    /// Reached by `&mut self` alone: the check of pyo3 keeps two threads from using a simulation at once.
    run: Mutex<Run>,
}

struct Run {
    level: level::Level,
    simulation: simulation::Simulation,
    /// Where the level lists each vertex of the scene.
    listed: Vec<usize>,
}

#[pymethods]
impl Simulation {
    /// Builds a level and begins at its start, or where it was saved.
    #[new]
    fn new(py: Python<'_>, level: &Level) -> PyResult<Self> {
        let level = level.0.clone();
        py.detach(|| {
            let scene = Scene::build(&level, level.mode, &Disk, None).map_err(value_error)?;
            let simulation = simulation::Simulation::open(scene, &level, level.mode).map_err(value_error)?;
            let scene = simulation.scene();
            let vertices = 0..if scene.toy.is_some() { 0 } else { scene.vertices() };
            let listed = vertices.map(|vertex| scene.listed_vertex(vertex).unwrap_or(vertex)).collect();
            share_partitions(threads());
            Ok(Self { run: Mutex::new(Run { level, simulation, listed }) })
        })
    }

    /// Takes so many steps; returns how many were taken, which are fewer where time has stopped with a fault.
    #[pyo3(signature = (steps=1))]
    fn step(&mut self, py: Python<'_>, steps: u64) -> PyResult<u64> {
        let run = self.run();
        py.detach(|| {
            let mut interruptible = Interruptible::new();
            let taken = run.simulation.advance(steps, &mut || interruptible.goes_on());
            interruptible.end().map(|()| taken)
        })
    }

    /// Takes the steps of a time [s]; returns how many were taken.
    fn run_for(&mut self, py: Python<'_>, seconds: f64) -> PyResult<u64> {
        if !(0.0..1e9).contains(&seconds) {
            return Err(value_error("seconds: expected a number in [0, 1e9)"));
        }
        let steps = (seconds / self.dt()).round() as u64;
        self.step(py, steps)
    }

    /// Simulated time [s].
    #[getter]
    fn time(&mut self) -> f64 {
        self.run().simulation.state().time
    }

    /// Number of steps since the start.
    #[getter]
    fn steps(&mut self) -> u64 {
        self.run().simulation.state().steps
    }

    /// Length of a step [s].
    #[getter]
    fn dt(&mut self) -> f64 {
        self.run().simulation.scene().step
    }

    /// The longest stable step of symplectic Euler in the present state [s]; `None` where nothing limits it.
    #[getter]
    fn critical_step(&mut self) -> Option<f64> {
        let simulation = &self.run().simulation;
        stability::critical_step(simulation.scene(), simulation.state(), simulation.grab())
    }

    /// Positions [m]: a row for each vertex, or the numbers of a toy. The array is a copy.
    #[getter]
    fn positions<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let run = self.run();
        run.rows(py, &run.simulation.state().x)
    }

    /// Velocities [m/s]: a row for each vertex. The array is a copy.
    #[getter]
    fn velocities<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let run = self.run();
        run.rows(py, &run.simulation.state().v)
    }

    /// Masses of the vertices [kg].
    #[getter]
    fn masses<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let run = self.run();
        let scene = run.simulation.scene();
        let mut masses = vec![0.0; run.listed.len()];
        for (place, mass) in run.listed.iter().zip(scene.mass.iter().step_by(scene.dimension)) {
            masses[*place] = *mass;
        }
        array(py, cast_slice(&masses), ("float64", None))
    }

    /// Corners of all triangles of bodies and membranes, by the numbers of the vertices: a row for each triangle.
    #[getter]
    fn triangles<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let run = self.run();
        let scene = run.simulation.scene();
        let membranes = scene.membranes.iter().flat_map(|membrane| membrane.elements.corners());
        let all: Vec<_> = scene.triangles.iter().chain(membranes).collect();
        let mut corners = vec![[0_i64; 3]; all.len()];
        for (number, own) in all.into_iter().enumerate() {
            let place = scene.listed_triangle(number).unwrap_or(number);
            corners[place] = own.map(|corner| run.listed[corner as usize] as i64);
        }
        array(py, cast_slice(&corners), ("int64", Some(3)))
    }

    /// Energies [J] by kind, and their sum as `"total"`.
    #[getter]
    fn energies<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let energies = self.run().simulation.energies();
        let all = PyDict::new(py);
        for (name, value) in [
            ("kinetic", energies.kinetic),
            ("elastic", energies.elastic),
            ("contact", energies.contact),
            ("potential", energies.potential),
            ("total", energies.total()),
        ] {
            all.set_item(name, value)?;
        }
        Ok(all)
    }

    /// Numbers of a probe by their names, such as those of `"energy"`, `"momentum"`, `"vertex:12"` or `"triangle:7"`.
    fn probe<'py>(&mut self, py: Python<'py>, probe: &str) -> PyResult<Bound<'py, PyDict>> {
        let simulation = &self.run().simulation;
        let probe: Probe = probe.parse().map_err(value_error)?;
        probe.check(simulation.scene()).map_err(value_error)?;
        let all = PyDict::new(py);
        for (column, number) in probe.columns(simulation.scene()).iter().zip(probe.numbers(simulation)) {
            all.set_item(&column.name, number)?;
        }
        Ok(all)
    }

    /// Why time has stopped, or `None`.
    #[getter]
    fn fault(&mut self) -> Option<String> {
        self.run().simulation.fault().map(ToString::to_string)
    }

    /// Hash of positions, velocities and time: equal hashes are equal bits.
    #[getter]
    fn state_hash(&mut self) -> String {
        format!("{:016x}", self.run().simulation.state().hash())
    }

    /// Pulls a vertex towards a point [m] with the mouse spring of the level.
    fn pull(&mut self, vertex: usize, target: Vec<f64>) -> PyResult<()> {
        let run = self.run();
        let scene = run.simulation.scene();
        if target.len() != scene.dimension || target.iter().any(|at| !at.is_finite()) {
            return Err(value_error(format!("target: expected {} finite numbers", scene.dimension)));
        }
        let found = Some(vertex).filter(|vertex| *vertex < run.listed.len());
        let vertex = found.and_then(|vertex| scene.unlisted_vertex(vertex));
        let most = run.listed.len().saturating_sub(1);
        let vertex = vertex.ok_or_else(|| value_error(format!("vertex: expected a number from 0 to {most}")))?;
        let at = |axis: usize| target.get(axis).copied().unwrap_or(0.0);
        run.simulation.set_grab(Some(Grab { vertex, target: [at(0), at(1), at(2)] }));
        Ok(())
    }

    /// Ends the pull.
    fn release(&mut self) {
        self.run().simulation.set_grab(None);
    }

    /// The level with the present state: a simulation of it goes on to the same bits.
    fn saved(&mut self) -> PyResult<Level> {
        let run = self.run();
        let state = run.simulation.saved().ok_or_else(|| value_error("The state is not finite."))?;
        Ok(Level(level::Level { state: Some(state), ..run.level.clone() }))
    }

    fn __repr__(&mut self) -> String {
        let run = self.run();
        format!("<Simulation of {:?} at {:.6} s>", run.level.name, run.simulation.state().time)
    }
}

impl Simulation {
    fn run(&mut self) -> &mut Run {
        self.run.get_mut().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Run {
    /// Numbers of the scene as an array with one row for each vertex, or one row for a toy.
    fn rows<'py>(&self, py: Python<'py>, values: &[f64]) -> PyResult<Bound<'py, PyAny>> {
        let dimension = self.simulation.scene().dimension;
        let mut all = values.to_vec();
        for (place, own) in self.listed.iter().zip(values.chunks_exact(dimension)) {
            all[dimension * place..dimension * (place + 1)].copy_from_slice(own);
        }
        let columns = (!self.listed.is_empty()).then_some(dimension);
        array(py, cast_slice(&all), ("float64", columns))
    }
}

/// An array of NumPy of a type, with so many columns.
pub fn array<'py>(
    py: Python<'py>,
    bytes: &[u8],
    (kind, columns): (&str, Option<usize>),
) -> PyResult<Bound<'py, PyAny>> {
    let flat = py.import("numpy")?.call_method1("frombuffer", (PyBytes::new(py, bytes), kind))?;
    match columns {
        Some(columns) => flat.call_method1("reshape", ((-1, columns as isize),)),
        None => Ok(flat),
    }
}

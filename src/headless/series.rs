//! What is recorded while a run goes on: quantities as CSV, and states as frames or arrays.

use super::Frames;
use crate::{archive::States, probe::Probe, simulation::Simulation, table::Table};

/// What is recorded at equal intervals of simulated time: at the steps that end nearest to them.
pub struct Recording {
    /// Quantities.
    pub series: Option<Series>,
    /// States, in files of their own.
    pub frames: Option<Frames>,
    /// States, in one archive.
    pub states: Option<States>,
    /// Interval \[s\].
    every: f64,
    /// Steps taken before the first row, and rows so far.
    before: u64,
    rows: u64,
}

impl Recording {
    /// A recording without rows.
    pub fn new((series, frames): (Option<Series>, Option<Frames>), states: Option<States>, every: f64) -> Self {
        Self { series, frames, states, every, before: 0, rows: 0 }
    }

    /// Begins with a first row, if anything is recorded.
    pub fn begin(mut self, simulation: &Simulation) -> Option<Self> {
        let records = self.series.is_some() || self.frames.is_some() || self.states.is_some();
        self.before = simulation.state().steps;
        records.then(|| {
            self.record(simulation);
            self
        })
    }

    /// Number of steps from now to the next row; at least one.
    pub fn steps_to_row(&self, simulation: &Simulation) -> u64 {
        let due = (self.rows as f64 * self.every / simulation.scene().step).round() as u64;
        (self.before + due).saturating_sub(simulation.state().steps).max(1)
    }

    /// Adds a row.
    pub fn record(&mut self, simulation: &Simulation) {
        let step = simulation.scene().step;
        let taken = simulation.state().steps.saturating_sub(self.before);
        // Steps may be longer than the interval.
        while (self.rows as f64 * self.every / step).round() as u64 <= taken {
            self.rows += 1;
        }
        if let Some(series) = &mut self.series {
            series.record(simulation);
        }
        if let Some(frames) = &mut self.frames {
            frames.record(simulation);
        }
        if let Some(states) = &mut self.states {
            states.record(simulation.scene(), simulation.state(), &simulation.energies());
        }
    }
}

/// Rows of probes.
pub struct Series {
    probes: Vec<Probe>,
    table: Table,
}

impl Series {
    /// A table without rows.
    ///
    /// # Errors
    /// If the scene has not all probes.
    pub fn new(probes: &[Probe], simulation: &Simulation) -> Result<Self, String> {
        let scene = simulation.scene();
        probes.iter().try_for_each(|probe| probe.check(scene))?;
        let columns = probes.iter().flat_map(|probe| probe.columns(scene)).map(|column| column.name);
        let columns: Vec<_> = std::iter::once("time".to_owned()).chain(columns).collect();
        let table = Table::new(String::new(), &columns.iter().map(String::as_str).collect::<Vec<_>>());
        Ok(Self { probes: probes.to_vec(), table })
    }

    /// Adds a row.
    fn record(&mut self, simulation: &Simulation) {
        let numbers = self.probes.iter().flat_map(|probe| probe.numbers(simulation));
        // 17 significant digits restore the same bits.
        let numbers = std::iter::once(simulation.state().time).chain(numbers).map(|number| format!("{number:.16e}"));
        self.table.row(numbers);
    }

    /// The table after some lines.
    pub fn text(self, head: String) -> String {
        head + &self.table.text()
    }
}

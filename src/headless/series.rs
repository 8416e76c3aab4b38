//! Quantities of a run over time, as CSV.

use crate::{scene::Scene, simulation::Simulation, study::Moment, table::Table};
use std::{fmt, str::FromStr};

/// What is measured over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Probe {
    /// Energies by kind, and their sum \[J\].
    Energy,
    /// Linear and angular momentum.
    Momentum,
    /// Least det F of all triangles of bodies, and how many are inverted.
    Inversion,
    /// Position and velocity of a vertex, by its place in a saved state.
    Vertex(usize),
    /// The numbers of a toy, and the exact ones.
    Numbers,
}

impl FromStr for Probe {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = [Self::Energy, Self::Momentum, Self::Inversion, Self::Numbers];
        let vertex = || text.strip_prefix("vertex:")?.parse().ok().map(Self::Vertex);
        let found = known.into_iter().find(|probe| probe.to_string() == text).or_else(vertex);
        found.ok_or_else(|| "expected energy, momentum, min_j, vertex:NUMBER or, of a toy, numbers".to_owned())
    }
}

impl fmt::Display for Probe {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Energy => out.write_str("energy"),
            Self::Momentum => out.write_str("momentum"),
            Self::Inversion => out.write_str("min_j"),
            Self::Vertex(place) => write!(out, "vertex:{place}"),
            Self::Numbers => out.write_str("numbers"),
        }
    }
}

impl Probe {
    /// Checks that a scene has it.
    ///
    /// # Errors
    /// A sentence.
    pub fn check(self, scene: &Scene) -> Result<(), String> {
        let is_there = match self {
            Self::Numbers => scene.toy.is_some(),
            Self::Inversion => !scene.bodies.is_empty(),
            Self::Vertex(place) => scene.toy.is_none() && place < scene.vertices(),
            Self::Energy | Self::Momentum => scene.toy.is_none(),
        };
        let what = match self {
            Self::Vertex(_) if scene.toy.is_none() => format!("its vertices are 0 to {}", scene.vertices().max(1) - 1),
            _ if scene.toy.is_some() => "a toy has numbers alone".to_owned(),
            Self::Inversion => "it has no bodies".to_owned(),
            _ => "it is no toy".to_owned(),
        };
        if is_there { Ok(()) } else { Err(format!("there is no {self} in this level: {what}")) }
    }

    /// Names of its columns, with their units where a table does not say them: m, m/s, J, kg m/s, kg m²/s.
    fn columns(self, scene: &Scene) -> Vec<String> {
        let axes = &["x", "y", "z"][..scene.dimension];
        let named = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
        match self {
            Self::Energy => named(&["kinetic", "elastic", "contact", "potential", "energy"]),
            Self::Inversion => named(&["min_j", "inverted"]),
            Self::Momentum => {
                let turns: &[_] = if scene.dimension == 2 { &["z"] } else { axes };
                let linear = axes.iter().map(|axis| format!("momentum_{axis}"));
                linear.chain(turns.iter().map(|axis| format!("angular_momentum_{axis}"))).collect()
            }
            Self::Vertex(place) => {
                let kinds = ["", "v"].into_iter().flat_map(|kind| axes.iter().map(move |axis| (kind, axis)));
                kinds.map(|(kind, axis)| format!("vertex_{place}_{kind}{axis}")).collect()
            }
            Self::Numbers => {
                let columns = scene.toy.iter().flat_map(|toy| toy.kind().columns());
                let columns: Vec<_> = columns.map(str::to_owned).collect();
                let exact = columns.iter().map(|name| format!("exact_{name}"));
                columns.iter().cloned().chain(exact).collect()
            }
        }
    }

    /// Its numbers now.
    fn numbers(self, simulation: &Simulation) -> Vec<f64> {
        let (scene, state) = (simulation.scene(), simulation.state());
        match self {
            Self::Energy => {
                let energies = simulation.energies();
                vec![energies.kinetic, energies.elastic, energies.contact, energies.potential, energies.total()]
            }
            Self::Inversion => {
                let (least, inverted) = simulation.inversion();
                vec![least, inverted as f64]
            }
            Self::Momentum => {
                let Moment { momentum, angular, .. } = Moment::of(simulation, state.time);
                let turns = if scene.dimension == 2 { &angular[2..] } else { &angular[..] };
                momentum[..scene.dimension].iter().chain(turns).copied().collect()
            }
            Self::Vertex(place) => {
                let vertex = scene.unlisted_vertex(place).unwrap_or(place);
                let numbers = scene.dimension * vertex..scene.dimension * (vertex + 1);
                [&state.x, &state.v].into_iter().flat_map(|of| &of[numbers.clone()]).copied().collect()
            }
            Self::Numbers => {
                let exact = scene.toy.iter().flat_map(|toy| toy.kind().exact(state.time));
                state.x.iter().copied().chain(exact).collect()
            }
        }
    }
}

/// Rows of probes at equal intervals of simulated time: at the steps that end nearest to them.
pub struct Series {
    probes: Vec<Probe>,
    /// Interval \[s\].
    every: f64,
    /// Steps taken before the first row, and rows so far.
    before: u64,
    rows: u64,
    table: Table,
}

impl Series {
    /// A table with its first row.
    ///
    /// # Errors
    /// If the scene has not all probes.
    pub fn new(probes: &[Probe], every: f64, simulation: &Simulation) -> Result<Self, String> {
        let scene = simulation.scene();
        probes.iter().try_for_each(|probe| probe.check(scene))?;
        let columns = probes.iter().flat_map(|probe| probe.columns(scene));
        let columns: Vec<_> = std::iter::once("time".to_owned()).chain(columns).collect();
        let table = Table::new(String::new(), &columns.iter().map(String::as_str).collect::<Vec<_>>());
        let mut series = Self { probes: probes.to_vec(), every, before: simulation.state().steps, rows: 0, table };
        series.record(simulation);
        Ok(series)
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

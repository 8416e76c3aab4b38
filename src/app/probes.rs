//! Probes that the window keeps: what they measure now, and what they measured in the last frames.

use super::{canvas::ProbeMark, compare::Pane};
use crate::{
    probe::{Column, Probe},
    scene::Scene,
    simulation::Simulation,
    study::{Setting, head},
    table::Table,
};
use std::collections::VecDeque;

/// Most frames that are kept.
const KEPT: usize = 6000;

/// A place on the stage that is probed, by its number in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// A vertex.
    Vertex(usize),
    /// A triangle, by its number among those of all bodies and then all membranes.
    Triangle(usize),
}

impl Target {
    /// Its probe in a scene.
    pub fn probe(self, scene: &Scene) -> Option<Probe> {
        match self {
            Self::Vertex(vertex) => scene.listed_vertex(vertex).map(Probe::Vertex),
            Self::Triangle(triangle) => scene.listed_triangle(triangle).map(Probe::Triangle),
        }
    }

    /// The place of a probe in a scene.
    fn of(probe: Probe, scene: &Scene) -> Option<Self> {
        match probe {
            Probe::Vertex(place) | Probe::Forces(place) => scene.unlisted_vertex(place).map(Self::Vertex),
            Probe::Triangle(place) => scene.unlisted_triangle(place).map(Self::Triangle),
            _ => None,
        }
    }
}

/// A change of the probes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProbeRequest {
    /// Adds one.
    Add(Probe),
    /// Removes one, by its place in the list.
    Remove(usize),
    /// Draws a column of one over time, or no longer.
    Draw(usize, usize),
}

/// A probe with its numbers now.
#[derive(Clone, Debug)]
pub struct Reading {
    /// What is measured.
    pub probe: Probe,
    /// Its name in words.
    pub title: String,
    /// Where it is on the stage.
    pub target: Option<Target>,
    /// Its columns.
    pub columns: Vec<Column>,
    /// A number for each column.
    pub numbers: Vec<f64>,
    /// Which columns are drawn over time.
    pub drawn: Vec<bool>,
}

impl Reading {
    /// Its numbers as text, to be pasted: a line for each column.
    pub fn text(&self) -> String {
        let line = |(column, number): (&Column, &f64)| format!("{}\t{number:.16e}\t{}\n", column.name, column.unit);
        self.columns.iter().zip(&self.numbers).map(line).collect()
    }
}

/// The probes of the window.
#[derive(Default)]
pub struct Probes {
    readings: Vec<Reading>,
    /// Pane, generation and level that they were made for.
    pane: Pane,
    generation: u64,
    level: String,
    /// Times of the last frames \[s\], with the numbers of all probes; NaN where one was not there yet.
    rows: VecDeque<(f64, Vec<f64>)>,
}

impl Probes {
    /// The probes.
    pub fn readings(&self) -> &[Reading] {
        &self.readings
    }

    /// Marks of what is probed on the stage.
    pub fn marks(&self) -> impl Iterator<Item = ProbeMark> {
        self.readings.iter().filter_map(|reading| {
            let label = match reading.probe {
                Probe::Vertex(place) | Probe::Forces(place) => format!("v{place}"),
                Probe::Triangle(place) => format!("t{place}"),
                _ => return None,
            };
            Some(ProbeMark { target: reading.target?, label })
        })
    }

    /// Carries out a change. One that the scene does not have is not added.
    ///
    /// # Errors
    /// A sentence.
    pub fn carry_out(&mut self, request: ProbeRequest, simulation: &Simulation) -> Result<(), String> {
        match request {
            ProbeRequest::Add(probe) => {
                probe.check(simulation.scene())?;
                if self.readings.iter().all(|reading| reading.probe != probe) {
                    let reading = reading(probe, simulation);
                    for (_, row) in &mut self.rows {
                        row.resize(row.len() + reading.columns.len(), f64::NAN);
                    }
                    self.readings.push(reading);
                }
            }
            ProbeRequest::Remove(place) if place < self.readings.len() => {
                let first = self.first_column(place);
                let columns = first..first + self.readings.remove(place).columns.len();
                for (_, row) in &mut self.rows {
                    row.drain(columns.clone());
                }
            }
            ProbeRequest::Draw(place, column) => {
                let drawn = self.readings.get_mut(place).and_then(|reading| reading.drawn.get_mut(column));
                if let Some(drawn) = drawn {
                    *drawn = !*drawn;
                }
            }
            ProbeRequest::Remove(_) => {}
        }
        Ok(())
    }

    /// Measures. Probes of another level, and those that the scene no longer has, are removed.
    pub fn follow(&mut self, simulation: &Simulation, (pane, generation, level): (Pane, u64, &str)) {
        if self.readings.is_empty() {
            self.rows.clear();
        }
        if self.level != level {
            level.clone_into(&mut self.level);
            self.readings.clear();
            self.rows.clear();
        }
        if (self.pane, self.generation) != (pane, generation) {
            (self.pane, self.generation) = (pane, generation);
            self.rows.clear();
            let scene = simulation.scene();
            self.readings.retain(|reading| reading.probe.check(scene).is_ok());
            for known in &mut self.readings {
                let drawn = std::mem::take(&mut known.drawn);
                *known = reading(known.probe, simulation);
                if drawn.len() == known.drawn.len() {
                    known.drawn = drawn;
                }
            }
        }
        for reading in &mut self.readings {
            // Effects may be switched on and off.
            let columns = reading.probe.columns(simulation.scene());
            if columns != reading.columns {
                reading.drawn = vec![false; columns.len()];
                reading.columns = columns;
                self.rows.clear();
            }
            reading.numbers = reading.probe.numbers(simulation);
        }
        self.record(simulation.state().time);
    }

    /// Adds a row at a time \[s\]. Time that is gone back over is removed.
    fn record(&mut self, time: f64) {
        if self.readings.is_empty() {
            return;
        }
        while self.rows.back().is_some_and(|(last, _)| *last >= time) {
            self.rows.pop_back();
        }
        if self.rows.len() == KEPT {
            self.rows.pop_front();
        }
        let numbers = self.readings.iter().flat_map(|reading| reading.numbers.iter().copied());
        self.rows.push_back((time, numbers.collect()));
    }

    /// Place of the first column of a probe in a row.
    fn first_column(&self, place: usize) -> usize {
        self.readings[..place].iter().map(|reading| reading.columns.len()).sum()
    }

    /// The columns that are drawn: number of the probe, its column, and the place in a row.
    pub fn drawn(&self) -> impl Iterator<Item = (usize, &Column, usize)> {
        let columns = self.readings.iter().enumerate().flat_map(|(number, reading)| {
            reading.columns.iter().zip(&reading.drawn).map(move |(column, drawn)| (number, column, *drawn))
        });
        let drawn = columns.enumerate().filter(|(_, (.., drawn))| *drawn);
        drawn.map(|(place, (number, column, _))| (number, column, place))
    }

    /// Times \[s\] and numbers of the last frames, the oldest first.
    pub fn rows(&self) -> impl DoubleEndedIterator<Item = (f64, &[f64])> {
        self.rows.iter().map(|(time, row)| (*time, row.as_slice()))
    }

    /// The rows as comma-separated values; `level` is the level that was run.
    pub fn csv(&self, level: &crate::level::Level) -> String {
        let about = [
            ("stepped_by", Setting::of(level).label()),
            (
                "rows",
                "one for each frame of the window, of the scene as it ran, with all that was done to it".to_owned(),
            ),
        ];
        let columns =
            self.readings.iter().flat_map(|reading| reading.columns.iter().map(|column| column.name.as_str()));
        let columns: Vec<_> = std::iter::once("time").chain(columns).collect();
        let mut table = Table::new(head(&level.name, 1, &about), &columns);
        for (time, row) in self.rows() {
            let text = |number: &f64| if number.is_nan() { String::new() } else { format!("{number:.16e}") };
            table.row(std::iter::once(&time).chain(row).map(text));
        }
        table.text()
    }
}

/// A probe with its numbers now, none of which is drawn.
fn reading(probe: Probe, simulation: &Simulation) -> Reading {
    let scene = simulation.scene();
    let columns = probe.columns(scene);
    let (title, target) = (probe.title(scene), Target::of(probe, scene));
    let drawn = vec![false; columns.len()];
    Reading { probe, title, target, numbers: probe.numbers(simulation), drawn, columns }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a failing test should panic")]
mod tests {
    use super::*;
    use crate::{files, levels, meshes::NoFiles, sandbox::Sandbox};

    fn sandbox(name: &str) -> Sandbox {
        let level = files::parse(levels::built_in(name).unwrap(), name).unwrap();
        Sandbox::new(level, Box::new(NoFiles)).unwrap()
    }

    #[test]
    fn a_probe_that_comes_later_has_no_numbers_before() {
        let mut sandbox = sandbox("gingerbread");
        let mut probes = Probes::default();
        let follow = |probes: &mut Probes, sandbox: &Sandbox| probes.follow(sandbox.simulation(), (Pane::A, 1, "man"));
        follow(&mut probes, &sandbox);
        for probe in [Probe::Vertex(3), Probe::Momentum] {
            probes.carry_out(ProbeRequest::Add(probe), sandbox.simulation()).unwrap();
            follow(&mut probes, &sandbox);
            sandbox.apply(crate::command::Command::StepFrame).unwrap();
        }
        let rows: Vec<_> = probes.rows().map(|(_, row)| row.iter().filter(|number| number.is_nan()).count()).collect();
        assert_eq!(rows, [3, 0]);
        let csv = probes.csv(&sandbox.document().level);
        let line = csv.lines().find(|line| !line.starts_with('#')).unwrap();
        assert!(line.starts_with("time,vertex_3_x,vertex_3_y,vertex_3_vx"), "{line}");
        assert!(line.ends_with("momentum_x,momentum_y,angular_momentum_z"), "{line}");
        probes.carry_out(ProbeRequest::Remove(0), sandbox.simulation()).unwrap();
        assert!(probes.rows().all(|(_, row)| row.len() == 3));
    }

    #[test]
    fn time_that_is_gone_back_over_is_not_kept() {
        let mut sandbox = sandbox("gingerbread");
        let mut probes = Probes::default();
        probes.follow(sandbox.simulation(), (Pane::A, 1, "man"));
        probes.carry_out(ProbeRequest::Add(Probe::Energy), sandbox.simulation()).unwrap();
        for _ in 0..4 {
            sandbox.apply(crate::command::Command::StepFrame).unwrap();
            probes.follow(sandbox.simulation(), (Pane::A, 1, "man"));
        }
        assert_eq!(probes.rows().count(), 4);
        sandbox.apply(crate::command::Command::Reset).unwrap();
        probes.follow(sandbox.simulation(), (Pane::A, 1, "man"));
        assert_eq!(probes.rows().map(|(time, _)| time).collect::<Vec<_>>(), [0.0]);
    }

    #[test]
    fn another_level_has_no_probes_of_the_first() {
        let (man, net) = (sandbox("gingerbread"), sandbox("hanging_net"));
        let mut probes = Probes::default();
        probes.follow(man.simulation(), (Pane::A, 1, "man"));
        probes.carry_out(ProbeRequest::Add(Probe::Triangle(0)), man.simulation()).unwrap();
        assert!(probes.carry_out(ProbeRequest::Add(Probe::Triangle(0)), net.simulation()).is_err());
        probes.follow(net.simulation(), (Pane::A, 2, "man"));
        assert!(probes.readings().is_empty(), "a net has no triangles");
    }

    #[test]
    fn another_pane_has_rows_of_its_own_and_another_effect_its_own_columns() {
        let mut sandbox = sandbox("gingerbread");
        let mut probes = Probes::default();
        let follow = |probes: &mut Probes, sandbox: &Sandbox, pane| {
            probes.follow(sandbox.simulation(), (pane, 1, "man"));
            probes.readings().first().map_or_else(Vec::new, |reading| reading.columns.clone())
        };
        follow(&mut probes, &sandbox, Pane::A);
        probes.carry_out(ProbeRequest::Add(Probe::Forces(0)), sandbox.simulation()).unwrap();
        for _ in 0..2 {
            follow(&mut probes, &sandbox, Pane::A);
            sandbox.apply(crate::command::Command::StepFrame).unwrap();
        }
        assert_eq!(probes.rows().count(), 2);
        let before = follow(&mut probes, &sandbox, Pane::B);
        assert_eq!(probes.rows().count(), 1);
        // As many effects act, but not the same ones.
        let mut level = sandbox.document().level.clone();
        let place = |name: &str| level.effects.iter().position(|listed| listed.effect.name() == name).unwrap();
        let (spring, damping) = (place("MouseSpring"), place("Rayleigh"));
        level.effects[spring].switch = crate::level::Switch::Off;
        level.effects[damping].switch = crate::level::Switch::Auto;
        let other = Sandbox::new(level, Box::new(NoFiles)).unwrap();
        let after = follow(&mut probes, &other, Pane::B);
        assert!(after.len() == before.len() && after != before, "{after:?}");
    }
}

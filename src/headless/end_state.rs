//! Checks whether the end state of a run is physical.

use crate::{report::Energies, simulation::Simulation};
use serde::Serialize;

/// Greatest |det F| of a physical end state: a hundredfold stretch along both axes.
pub const GREATEST_J: f64 = 1e4;

/// Greatest relative energy gain of a physical end state.
/// It is relative to the kinetic and elastic energy at the start plus the energy stored at a strain of 1.
pub const GREATEST_GAIN: f64 = 1e5;

/// Start state of a run.
pub struct Beginning {
    /// det F of every triangle, body after body.
    ratios: Vec<f64>,
    energies: Energies,
    /// Elastic energy at a strain of about 1 [J].
    scale: f64,
}

/// Report of the end state of a run. Field names are stable.
#[derive(Debug, Default, PartialEq, Serialize)]
pub struct EndState {
    /// Whether the state is physical: everything is finite, neither energy nor det F is absurd, and no triangle is inverted that was
    /// not at the start. Otherwise the exit code is 3.
    pub physical: bool,
    /// Number of triangles inverted at the end that were not at the start.
    pub newly_inverted: usize,
    /// Number of triangles inverted both at the start and at the end.
    pub still_inverted: usize,
    /// Total energy at the end less that at the start [J]; null if it is not finite.
    pub energy_gain: f64,
    /// What is wrong or worth knowing, each a sentence.
    pub remarks: Vec<String>,
}

impl Beginning {
    /// Start state of a simulation before its first step.
    pub fn of(simulation: &Simulation) -> Self {
        let scene = simulation.scene();
        let scale = scene.parts.iter().map(|part| part.energy_scales()[1]).sum();
        Self { ratios: ratios(simulation), energies: simulation.energies(), scale }
    }
}

/// det F of every triangle, body after body.
fn ratios(simulation: &Simulation) -> Vec<f64> {
    let x = &simulation.state().x;
    simulation.scene().bodies.iter().flat_map(|body| body.elements.volume_ratios(x)).collect()
}

/// Name of a triangle of the whole scene in plain words.
fn name(simulation: &Simulation, triangle: usize) -> String {
    let mut first = 0;
    for body in &simulation.scene().bodies {
        let count = body.elements.corners().len();
        if triangle < first + count {
            return format!("triangle {} of {}", body.mesh.numbering().element_name(triangle - first), body.name);
        }
        first += count;
    }
    format!("triangle {triangle}")
}

impl EndState {
    /// Report of the present state of a simulation.
    pub fn of(beginning: &Beginning, simulation: &Simulation) -> Self {
        let (scene, state, now) = (simulation.scene(), simulation.state(), simulation.energies());
        let ratios = ratios(simulation);
        let mut remarks = Vec::new();
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        if !(finite(&state.x) && finite(&state.v) && now.total().is_finite() && finite(&ratios)) {
            remarks.push("positions, velocities or energies are not finite numbers".to_owned());
        }
        let energy_gain = now.total() - beginning.energies.total();
        let own = beginning.energies.kinetic + beginning.energies.elastic.abs() + beginning.scale;
        // A long fall gains a small share of the potential energy lost. That is the error of a scheme, not an
        // explosion.
        let falling = 1e-2 * (now.potential - beginning.energies.potential).abs();
        if scene.toy.is_none() && energy_gain > GREATEST_GAIN * own + falling {
            remarks.push(format!(
                "the energy grew by {energy_gain:.3e} J, which is {:.0e} times what the scene had",
                energy_gain / own
            ));
        }
        let both = || beginning.ratios.iter().zip(&ratios).enumerate();
        let absurd = both().filter(|(_, (start, end))| end.abs() > GREATEST_J * start.abs().max(1.0));
        if let Some((worst, (_, j))) = absurd.max_by(|(_, (_, a)), (_, (_, b))| a.abs().total_cmp(&b.abs())) {
            remarks.push(format!("{} has J = {j:.3e}, an absurd size", name(simulation, worst)));
        }
        let newly: Vec<_> = both().filter(|(_, (start, end))| **start > 0.0 && **end <= 0.0).collect();
        if let Some((worst, (_, j))) = newly.iter().min_by(|(_, (_, a)), (_, (_, b))| a.total_cmp(b)) {
            let worst = name(simulation, *worst);
            remarks.push(match newly.len() {
                1 => format!("{worst} is inverted (J = {j:.3e}) and was not at the start"),
                many => format!(
                    "{many} triangles are inverted that were not at the start; {worst} has the least J = {j:.3e}"
                ),
            });
        }
        let physical = remarks.is_empty();
        if !physical {
            remarks.push(
                "take more substeps or an implicit integrator, or a model that resists inversion, such as StableNeoHookean"
                    .to_owned(),
            );
        }
        let still: Vec<_> = both().filter(|(_, (start, end))| **start <= 0.0 && **end <= 0.0).collect();
        if let Some((first, (_, j))) = still.first() {
            let (first, verb) = (name(simulation, *first), if still.len() == 1 { "was" } else { "were" });
            let count = if still.len() == 1 { "1 triangle".to_owned() } else { format!("{} triangles", still.len()) };
            remarks.push(format!(
                "{count} inverted at the end {verb} inverted at the start already; the first is {first} (J = {j:.3e}); \
                 --untangle puts such bodies where they are free of folds"
            ));
        }
        Self { physical, newly_inverted: newly.len(), still_inverted: still.len(), energy_gain, remarks }
    }

    /// Message for standard error in one line. `None` if there is nothing to report.
    pub fn sentence(&self) -> Option<String> {
        let what = if self.physical { "the end state" } else { "the end state is not physical" };
        (!self.remarks.is_empty()).then(|| format!("{what}: {}", self.remarks.join("; ")))
    }
}

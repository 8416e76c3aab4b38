//! One run of a hard case with one model and one integrator.

use super::{AREA, Case, Expects, Fence, Lasts, Ledger, Method, Numbers, Verdict};
use crate::{
    level::{Level, Substeps, Toggle, frame},
    materials::Model,
    meshes::NoFiles,
    scene::{Scene, SceneError},
    simulation::Simulation,
    stability::StabilityProbe,
    untangle::{Tangle, untangled},
};

/// Run of a case with one constitutive model and one method.
pub struct Run {
    simulation: Simulation,
    method: Method,
    expects: Expects,
    frame: u64,
    /// Limits of the run: frames and steps.
    end: (u64, u64),
    substeps: u32,
    /// Share of the longest stable step, for explicit schemes.
    share: f64,
    probe: StabilityProbe,
    ledger: Ledger,
    fence: Fence,
    outside: f64,
}

/// Iterations for the longest stable step in every frame.
const ROUNDS: usize = 6;

/// Energy excess at which a run stops, relative to the greatest possible mechanical energy.
const HOPELESS: f64 = 1.0;

impl Run {
    /// Prepares a run of a case from its start.
    ///
    /// # Errors
    /// If its level cannot be built.
    pub fn new(case: &Case, model: Model, method: Method) -> Result<Self, SceneError> {
        let level = Level { substeps: Substeps::nearest(1.0), sleep: Toggle::Off, ..case.level(model, method) };
        let scene = Scene::build(&level, level.mode, &NoFiles, None)?;
        let fence = Fence::new(&level, &scene, case.within);
        let simulation = Simulation::open(scene, &level, level.mode)?;
        let end = match case.lasts {
            Lasts::Seconds(time) => (frame(time), u64::MAX),
            Lasts::Steps(steps) => (u64::MAX, u64::from(steps)),
        };
        Ok(Self {
            ledger: Ledger::new(simulation.scene(), simulation.energies()),
            simulation,
            method,
            expects: case.expects,
            frame: 0,
            end,
            substeps: 1,
            share: Method::SHARE,
            probe: StabilityProbe::default(),
            fence,
            outside: 0.0,
        })
    }

    /// Same run at another share of the longest stable step than [`Method::SHARE`], and without the guard.
    /// Steps are up to twice as short as this share. From 2 on, an explicit scheme must fail.
    #[must_use]
    pub fn unguarded_at(mut self, share: f64) -> Self {
        let scene = Scene { guard: false, ..self.simulation.scene().clone() };
        self.simulation.replace_scene(scene);
        Self { share, ..self }
    }

    /// Simulation of the run.
    pub const fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// Share of the run done.
    pub fn done(&self) -> f64 {
        let (frames, steps) = self.end;
        let by_frames = self.frame as f64 / frames as f64;
        by_frames.max(self.simulation.state().steps as f64 / steps as f64).min(1.0)
    }

    /// Advances by one frame. Returns the verdict when the run is over.
    ///
    /// # Errors
    /// If the script leads to a scene that cannot be built.
    pub fn advance(&mut self) -> Result<Option<Verdict>, SceneError> {
        let Self { simulation, ledger, .. } = self;
        simulation.perform_due(&mut |before, after| ledger.changed(before, after));
        if self.method.is_explicit() {
            self.adapt_step();
        }
        let steps = u64::from(self.substeps).min(self.end.1 - self.simulation.state().steps);
        self.simulation.advance(steps, &mut || true);
        self.frame += 1;
        self.ledger.record(self.simulation.energies());
        self.outside = self.outside.max(self.fence.beyond(&self.simulation.state().x));
        let over = self.frame >= self.end.0 || self.simulation.state().steps >= self.end.1;
        let hopeless = self.simulation.fault().is_some() || self.ledger.gain() > HOPELESS;
        Ok((over || hopeless).then(|| self.verdict()))
    }

    /// Verdict on the present state.
    pub fn verdict(&self) -> Verdict {
        let (scene, state) = (self.simulation.scene(), self.simulation.state());
        let off = |x: &[f64]| {
            let ratios = scene.bodies.iter().flat_map(|body| body.elements.volume_ratios(x));
            ratios.map(|ratio| (ratio - 1.0).abs()).fold(0.0, |worst: f64, off| if off > worst { off } else { worst })
        };
        let Tangle { inverted, wound } = Tangle::of_all(scene, &state.x);
        let home = self.expects == Expects::Home;
        let numbers = Numbers {
            gain: self.ledger.gain(),
            outside: self.outside,
            area: home.then(|| off(&state.x)),
            elastic: self.simulation.energies().elastic,
            inverted,
            wound,
            opens: home && untangled(scene, state).is_some_and(|free| off(&free.x) <= AREA),
            unsolved: self.simulation.counts().unconverged,
            time: state.time,
        };
        let fault = self.simulation.fault().map(ToString::to_string);
        Verdict::of(numbers, fault, self.method.energy_tolerance())
    }

    /// Shortens the step if the scene has become stiffer, and lengthens it if it is much softer.
    /// Between two frames the guard does the same.
    fn adapt_step(&mut self) {
        let (scene, state) = (self.simulation.scene(), self.simulation.state());
        let Some(limit) = self.probe.refine(scene, state, ROUNDS) else { return };
        let wanted = 1.0 / (60.0 * self.share * limit);
        let substeps = Substeps::nearest(wanted).get().next_power_of_two().min(Substeps::MAX);
        if substeps > self.substeps || 4 * substeps <= self.substeps {
            self.substeps = substeps;
            let scene = Scene { step: 1.0 / (60.0 * f64::from(substeps)), ..scene.clone() };
            self.change(|simulation| simulation.replace_scene(scene));
        }
    }

    /// Applies a change from outside and records it in the ledger.
    fn change(&mut self, change: impl FnOnce(&mut Simulation)) {
        let before = self.simulation.energies();
        change(&mut self.simulation);
        self.ledger.changed(before, self.simulation.energies());
    }
}

//! One run of a hard case with one model and one method: its steps, boundaries and energy balance.

use super::{AREA, Case, Expects, Lasts, Method, Numbers, Verdict};
use crate::{
    effects::EffectKind,
    guard::negligible,
    inversion_recovery::{Tangle, untangled},
    level::{Level, RunMode, Substeps, Switch, Toggle, When, frame},
    materials::Model,
    meshes::NoFiles,
    obstacles::Obstacle,
    quantity::Point,
    report::Energies,
    scene::{Scene, SceneError, extent},
    simulation::Simulation,
    stability::StabilityProbe,
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
        let work = self.simulation.work_of_obstacles();
        self.simulation.advance(steps, &mut || true);
        self.frame += 1;
        self.ledger.supply(self.simulation.work_of_obstacles() - work);
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
        let Some(limit) = self.probe.refine(scene, state, self.simulation.grab(), ROUNDS) else { return };
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

/// Boundaries that no vertex may cross: the walls of a level, the edges of its world, and a box.
pub struct Fence {
    obstacles: Vec<Box<dyn Obstacle>>,
    /// Lower left and upper right corners \[m\].
    boxes: Vec<[[f64; 2]; 2]>,
    /// Longest side of the bounding boxes of the bodies at rest \[m\].
    size: f64,
}

impl Fence {
    /// Boundaries of a level, and an additional box.
    pub fn new(level: &Level, scene: &Scene, within: Option<(Point, Point)>) -> Self {
        let mut obstacles = Vec::new();
        let mut boxes: Vec<_> = within.iter().map(|(least, greatest)| [least.get(), greatest.get()]).collect();
        let acts = |when: When| when == When::Always || level.mode == RunMode::Collide;
        for listed in level.effects.iter().filter(|listed| listed.switch == Switch::On && acts(listed.when)) {
            match &listed.effect {
                EffectKind::Boundary(edges) => boxes.push([edges.least.get(), edges.greatest.get()]),
                // A wall that cannot be built also prevents the scene.
                EffectKind::Walls(walls) => {
                    obstacles.extend(walls.obstacles.iter().filter_map(|kind| kind.kind().build().ok()));
                }
                _ => {}
            }
        }
        let sides = scene.bodies.iter().flat_map(|body| {
            let rest = &scene.rest[2 * body.vertices.start..2 * body.vertices.end];
            [0, 1].map(|axis| extent(rest, axis)).map(|(least, greatest)| greatest - least)
        });
        Self { obstacles, boxes, size: sides.fold(0.0, f64::max) }
    }

    /// Greatest distance of the points (flat, \[m\]) beyond the boundaries, as a share of the size of the bodies.
    pub fn beyond(&self, x: &[f64]) -> f64 {
        let mut farthest = 0.0_f64;
        for point in x.chunks_exact(2) {
            for [least, greatest] in &self.boxes {
                for axis in 0..2 {
                    farthest = farthest.max(least[axis] - point[axis]).max(point[axis] - greatest[axis]);
                }
            }
            for obstacle in &self.obstacles {
                let depth = obstacle.contact([point[0], point[1]]).map_or(0.0, |contact| -contact.distance);
                farthest = farthest.max(depth);
            }
        }
        farthest / self.size
    }
}

/// Energy balance of a run. Between two changes from outside nothing in a scene supplies energy.
///
/// With the mechanical energy M and the potential P, `M + P` cannot exceed the energy put in. That is the energy at
/// the start plus the gain or loss by every change from outside, and the work of moving obstacles. Energy dissipated before a change is subtracted, so
/// that it cannot hide an excess. The excess is relative to the greatest possible M, `put in - P`.
#[derive(Clone, Debug)]
pub struct Ledger {
    put_in: f64,
    scale: f64,
    gain: f64,
}

impl Ledger {
    /// Starts the balance with a scene and its energies.
    pub fn new(scene: &Scene, energies: Energies) -> Self {
        let mut ledger = Self { put_in: energies.total(), scale: negligible(scene), gain: 0.0 };
        ledger.record(energies);
        ledger
    }

    /// Records a change from outside.
    pub fn changed(&mut self, before: Energies, after: Energies) {
        self.record(before);
        self.put_in = self.put_in.min(before.total()) + after.total() - before.total();
        self.record(after);
    }

    /// Adds work of moving obstacles \[J\].
    pub fn supply(&mut self, work: f64) {
        self.put_in += work;
    }

    /// Records the present energies.
    pub fn record(&mut self, energies: Energies) {
        self.scale = self.scale.max(self.put_in - energies.potential);
        let gain = (energies.total() - self.put_in) / self.scale;
        // NaN counts as an infinite excess.
        self.gain = if gain.is_nan() { f64::INFINITY } else { self.gain.max(gain) };
    }

    /// Greatest excess over the energy put in, relative to the greatest possible mechanical energy.
    pub const fn gain(&self) -> f64 {
        self.gain
    }
}

use super::{AREA, Case, Deed, Expects, Fence, Lasts, Ledger, Method, Numbers, Verdict, act::frame};
use crate::{
    effects::{EffectKind, Grab},
    level::{Level, Side, Substeps, Toggle},
    materials::Model,
    meshes::NoFiles,
    quantity::Gravity,
    scene::{Scene, SceneError, extent, nearest_vertex},
    simulation::Simulation,
    stability::StabilityProbe,
    state::State,
    untangle::{Tangle, untangled},
};

/// A case on its way, with one constitutive model and one method.
pub struct Run {
    level: Level,
    simulation: Simulation,
    method: Method,
    expects: Expects,
    /// What is still to be done, and at which frame; the next is last.
    script: Vec<(u64, Deed)>,
    /// What is being done, and the frames left for it.
    doing: Vec<(u64, Deed)>,
    frame: u64,
    /// Frames, and at most so many steps.
    end: (u64, u64),
    substeps: u32,
    /// Share of the longest stable step that is taken, if the scheme is explicit.
    share: f64,
    probe: StabilityProbe,
    ledger: Ledger,
    fence: Fence,
    outside: f64,
}

/// Rounds of the iteration for the longest stable step, in every frame.
const ROUNDS: usize = 6;

/// More energy from nowhere than there could be: what goes on is not the scene any more.
const HOPELESS: f64 = 1.0;

impl Run {
    /// A case from its start.
    ///
    /// # Errors
    /// If its level cannot be built.
    pub fn new(case: &Case, model: Model, method: Method) -> Result<Self, SceneError> {
        let level = Level { substeps: Substeps::nearest(1.0), sleep: Toggle::Off, ..case.level(model, method) };
        let scene = Scene::build(&level, level.mode, &NoFiles, None)?;
        let fence = Fence::new(&level, &scene, case.within);
        let simulation = Simulation::open(scene, level.state.as_ref())?;
        let end = match case.lasts {
            Lasts::Seconds(time) => (frame(time), u64::MAX),
            Lasts::Steps(steps) => (u64::MAX, u64::from(steps)),
        };
        let frames = end.0.min(end.1);
        let acts = case.acts.iter().flat_map(|act| act.frames(frames).map(|frame| (frame, act.act.clone())));
        let mut script: Vec<_> = acts.collect();
        // Acts of one frame are done in the order of the file.
        script.sort_by_key(|(frame, _)| *frame);
        script.reverse();
        Ok(Self {
            ledger: Ledger::new(simulation.scene(), simulation.energies()),
            level,
            simulation,
            method,
            expects: case.expects,
            script,
            doing: Vec::new(),
            frame: 0,
            end,
            substeps: 1,
            share: Method::SHARE,
            probe: StabilityProbe::default(),
            fence,
            outside: 0.0,
        })
    }

    /// The same at another share of the longest stable step than [`Method::SHARE`], and without the guard. Steps are up to twice as
    /// short as that: from 2 on an explicit scheme has to fail.
    #[must_use]
    pub fn unguarded_at(mut self, share: f64) -> Self {
        self.level.guard = Toggle::Off;
        let scene = Scene { guard: false, ..self.simulation.scene().clone() };
        self.simulation.replace_scene(scene);
        Self { share, ..self }
    }

    /// What is run, to look at.
    pub const fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// Share of the run done.
    pub fn done(&self) -> f64 {
        let (frames, steps) = self.end;
        let by_frames = self.frame as f64 / frames as f64;
        by_frames.max(self.simulation.state().steps as f64 / steps as f64).min(1.0)
    }

    /// Goes on for a frame; gives the verdict when the run is over.
    ///
    /// # Errors
    /// If the script leads to a scene that cannot be built.
    pub fn advance(&mut self) -> Result<Option<Verdict>, SceneError> {
        while let Some((_, deed)) = self.script.pop_if(|(frame, _)| *frame <= self.frame) {
            self.begin(deed)?;
        }
        self.go_on();
        if self.method.is_explicit() {
            self.keep_pace();
        }
        let steps = u64::from(self.substeps).min(self.end.1 - self.simulation.state().steps);
        self.simulation.advance(steps, &mut || true);
        self.frame += 1;
        self.ledger.look(self.simulation.energies());
        self.outside = self.outside.max(self.fence.beyond(&self.simulation.state().x));
        let over = self.frame >= self.end.0 || self.simulation.state().steps >= self.end.1;
        let hopeless = self.simulation.fault().is_some() || self.ledger.gain() > HOPELESS;
        Ok((over || hopeless).then(|| self.verdict()))
    }

    /// Judges the state as it is now.
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

    /// Shortens the step where the scene has grown stiffer, and lengthens it where it is far softer. Between two frames the guard
    /// does the same.
    fn keep_pace(&mut self) {
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

    /// Changes something from outside and books it.
    fn change(&mut self, change: impl FnOnce(&mut Simulation)) {
        let before = self.simulation.energies();
        change(&mut self.simulation);
        self.ledger.changed(before, self.simulation.energies());
    }

    /// Does what takes no time, and begins what does.
    fn begin(&mut self, deed: Deed) -> Result<(), SceneError> {
        match deed {
            Deed::Grab(point) => {
                let x = &self.simulation.state().x;
                if let Some(vertex) = nearest_vertex(x, point.get()) {
                    let target = [x[2 * vertex], x[2 * vertex + 1]];
                    self.change(|simulation| simulation.set_grab(Some(Grab { vertex, target })));
                }
            }
            Deed::Release => self.change(|simulation| simulation.set_grab(None)),
            Deed::Pull { over, .. } | Deed::Turn { over, .. } => self.doing.push((frame(over).max(1), deed)),
            Deed::FlipGravity => {
                for listed in &mut self.level.effects {
                    if let EffectKind::Gravity(gravity) = &mut listed.effect {
                        let turned = |value: Gravity| Gravity::new(-value.get()).unwrap_or(value);
                        (gravity.down, gravity.right) = (turned(gravity.down), turned(gravity.right));
                    }
                }
                self.rebuild()?;
            }
            Deed::Free => {
                self.level.bodies.iter_mut().for_each(|body| body.pins.clear());
                self.level.nets.iter_mut().for_each(|net| net.pins.clear());
                self.rebuild()?;
            }
        }
        Ok(())
    }

    /// Makes the scene of the level as it is now; what moves stays.
    fn rebuild(&mut self) -> Result<(), SceneError> {
        let scene = Scene::build(&self.level, self.level.mode, &NoFiles, Some(self.simulation.scene()))?;
        let scene = Scene { step: self.simulation.scene().step, ..scene };
        self.change(|simulation| simulation.replace_scene(scene));
        Ok(())
    }

    /// Does a frame's part of everything that takes time.
    fn go_on(&mut self) {
        for (left, deed) in std::mem::take(&mut self.doing) {
            let share = 1.0 / left as f64;
            match deed {
                Deed::Pull { to, .. } => {
                    if let Some(Grab { vertex, target }) = self.simulation.grab() {
                        let to = to.get();
                        let target = [0, 1].map(|axis| target[axis] + share * (to[axis] - target[axis]));
                        self.change(|simulation| simulation.set_grab(Some(Grab { vertex, target })));
                    }
                }
                Deed::Turn { side, by, over } => {
                    let angle = by.get().to_radians() / frame(over).max(1) as f64;
                    let state = turned(&self.simulation, side, angle);
                    let grab = self.simulation.grab();
                    self.change(|simulation| {
                        simulation.set_state(state);
                        simulation.set_grab(grab);
                    });
                }
                _ => {}
            }
            if left > 1 {
                self.doing.push((left - 1, deed));
            }
        }
    }
}

/// The state with the pinned vertices of a side of the first body turned about their middle by an angle [rad].
fn turned(simulation: &Simulation, side: Side, angle: f64) -> State {
    let (scene, mut state) = (simulation.scene(), simulation.state().clone());
    let Some(body) = scene.bodies.first() else { return state };
    let (axis, greatest) = side.across();
    let (low, high) = extent(&scene.rest[2 * body.vertices.start..2 * body.vertices.end], axis);
    let edge = if greatest { high } else { low };
    let pins = scene.pins.iter().map(|pin| *pin as usize).filter(|pin| body.vertices.contains(pin));
    let on_edge: Vec<_> = pins.filter(|pin| (scene.rest[2 * pin + axis] - edge).abs() <= 1e-9 * (high - low)).collect();
    let count = on_edge.len() as f64;
    let [cx, cy] = [0, 1].map(|axis| on_edge.iter().map(|pin| state.x[2 * pin + axis]).sum::<f64>() / count);
    let (c, s) = (libm::cos(angle), libm::sin(angle));
    for pin in on_edge {
        let (x, y) = (state.x[2 * pin] - cx, state.x[2 * pin + 1] - cy);
        (state.x[2 * pin], state.x[2 * pin + 1]) = (cx + c * x - s * y, cy + s * x + c * y);
    }
    state
}

//! One run of a hard case with one model and one method: its steps, boundaries and measured numbers.

use super::{
    Account, Case, Expects, Lasts, Method, Numbers, Reference, STRAIN, Verdict,
    reference::{Comparison, Scale},
};
use crate::{
    contact::PlacedObstacle,
    effects::EffectKind,
    inversion_recovery::{Tangle, untangled},
    level::{Level, RunMode, Sleep, Substeps, When, frame},
    materials::Model,
    meshes::NoFiles,
    obstacles::ObstacleKind,
    quantity::Position,
    scene::{Scene, SceneError, extent},
    simulation::Simulation,
    stability::StabilityProbe,
};
use std::sync::Arc;

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
    /// Least and greatest number of steps in a frame.
    least: u32,
    most: u32,
    probe: StabilityProbe,
    account: Account,
    fence: Fence,
    outside: f64,
    crossings: Crossings,
    comparison: Option<(Arc<Reference>, Comparison)>,
}

/// Places where surfaces have crossed.
struct Crossings {
    /// Whether there were none at some time.
    free: bool,
    /// Greatest number since then, or the present one.
    count: usize,
}

impl Crossings {
    fn new(count: Option<usize>) -> Self {
        let count = count.unwrap_or(0);
        Self { free: count == 0, count }
    }

    fn record(&mut self, count: Option<usize>) {
        let count = count.unwrap_or(0);
        self.count = if self.free { self.count.max(count) } else { count };
        self.free |= count == 0;
    }
}

/// Iterations for the longest stable step in every frame.
const ROUNDS: usize = 6;

/// Greatest number of explicit steps in a frame. A scene that needs more is a failure of explicit schemes.
pub(super) const MOST: u32 = 1 << 14;

/// Energy from nowhere at which a run stops, relative to the energy put in.
const HOPELESS: f64 = 1.0;

impl Run {
    /// Prepares a run of a case from its start.
    ///
    /// # Errors
    /// If its level cannot be built.
    pub fn new(case: &Case, model: Model, method: Method) -> Result<Self, SceneError> {
        let level = Level { substeps: Substeps::nearest(1.0), sleep: Sleep::Off, ..case.level(model, method) };
        let scene = Scene::build(&level, level.mode, &NoFiles, None)?;
        let fence = Fence::new(&level, &scene, case.within);
        let simulation = Simulation::open(scene, &level, level.mode)?;
        let end = match case.lasts {
            Lasts::Seconds(time) => (frame(time), u64::MAX),
            Lasts::Steps(steps) => (u64::MAX, u64::from(steps)),
        };
        Ok(Self {
            account: Account::new(simulation.scene(), simulation.energies()),
            crossings: Crossings::new(simulation.count_crossings()),
            simulation,
            method,
            expects: case.expects,
            frame: 0,
            end,
            substeps: 1,
            share: Method::SHARE,
            least: 1,
            most: MOST,
            probe: StabilityProbe::default(),
            fence,
            outside: 0.0,
            comparison: None,
        })
    }

    /// Same run in steps so many times as short.
    #[must_use]
    pub fn finer(self, times: u32) -> Self {
        let share = self.share / f64::from(times);
        let end = (self.end.0, self.end.1.saturating_mul(u64::from(times)));
        let least = if self.method.is_explicit() { 1 } else { times };
        let most = MOST.saturating_mul(times).min(Substeps::MAX);
        Self { end, share, ..self }.within(least, most)
    }

    /// Same run with a least and a greatest number of steps in a frame.
    #[must_use]
    pub(super) fn within(mut self, least: u32, most: u32) -> Self {
        (self.least, self.most) = (least.min(most), most);
        self.set_substeps(self.least);
        self
    }

    /// Same run, compared with the reference motion of its case and model.
    #[must_use]
    pub fn compared_with(self, reference: Arc<Reference>) -> Self {
        let comparison = Some((reference, Comparison::new(self.scale())));
        Self { comparison, ..self }
    }

    pub(super) fn scale(&self) -> Scale {
        Scale::new(self.simulation.scene(), self.fence.size)
    }

    /// Same run at another share of the longest stable step than [`Method::SHARE`], and without the guard.
    /// Steps are up to four times as short as this share. From 4 on, an explicit scheme must fail.
    #[must_use]
    pub fn unguarded_at(mut self, share: f64) -> Self {
        let scene = Scene { guard: false, ..self.simulation.scene().clone() };
        self.simulation.replace_scene(scene);
        Self { share, ..self }
    }

    /// Energy put in so far (see [`Account`]) \[J\].
    pub(super) const fn put_in(&self) -> f64 {
        self.account.put_in()
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
        let Self { simulation, account, .. } = self;
        simulation.perform_due(&mut |before, after| account.changed(before, after));
        if self.method.is_explicit() {
            self.adapt_step();
        }
        let steps = u64::from(self.substeps).min(self.end.1 - self.simulation.state().steps);
        let work = self.simulation.work_of_obstacles();
        self.simulation.advance(steps, &mut || true);
        self.frame += 1;
        self.account.supply(self.simulation.work_of_obstacles() - work);
        self.account.record_steps(&mut self.simulation);
        self.outside = self.outside.max(self.fence.beyond(self.simulation.state().time, &self.simulation.state().x));
        self.crossings.record(self.simulation.count_crossings());
        if let Some((reference, comparison)) = &mut self.comparison {
            comparison.record(&self.simulation, reference);
        }
        let over = self.frame >= self.end.0 || self.simulation.state().steps >= self.end.1;
        let hopeless = self.simulation.fault().is_some() || self.account.gain() > HOPELESS;
        Ok((over || hopeless).then(|| self.verdict()))
    }

    /// Advances to the end. Returns the verdict.
    ///
    /// # Errors
    /// If the script leads to a scene that cannot be built.
    pub fn finish(&mut self) -> Result<Verdict, SceneError> {
        loop {
            if let Some(verdict) = self.advance()? {
                return Ok(verdict);
            }
        }
    }

    /// Verdict on the present state.
    pub fn verdict(&self) -> Verdict {
        let (scene, state) = (self.simulation.scene(), self.simulation.state());
        let Tangle { inverted, wound, .. } = Tangle::of_all(scene, &state.x);
        let home = self.expects == Expects::Home;
        let energies = self.simulation.energies();
        let mu_area: f64 = scene.parts.iter().map(|part| part.energy_scales()[0]).sum();
        let numbers = Numbers {
            gain: self.account.gain(),
            outside: self.outside,
            crossings: if self.crossings.free { self.crossings.count } else { 0 },
            tangled: if self.crossings.free { 0 } else { self.crossings.count },
            strain: home.then(|| greatest_strain(scene, &state.x)),
            speed: home.then(|| (2.0 * energies.kinetic / mu_area).sqrt()),
            elastic: energies.elastic,
            inverted,
            wound,
            opens: home && untangled(scene, state).is_some_and(|free| greatest_strain(scene, &free.x) <= STRAIN),
            unsolved: self.simulation.counts().unconverged,
            guarded: self.simulation.counts().guarded,
            time: state.time,
            distance: self.comparison.as_ref().and_then(|(_, comparison)| comparison.distance()),
            chaotic: self.comparison.as_ref().is_some_and(|(reference, _)| reference.is_chaotic()),
        };
        let fault = self.simulation.fault().map(ToString::to_string);
        Verdict::of(numbers, fault, self.method.energy_tolerance())
    }

    /// Shortens the step if the scene has become stiffer, and lengthens it if it is much softer.
    /// Within a frame the guard divides unstable steps.
    fn adapt_step(&mut self) {
        let (scene, state) = (self.simulation.scene(), self.simulation.state());
        let Some(limit) = self.probe.refine(scene, state, self.simulation.grab(), ROUNDS) else { return };
        let wanted = 1.0 / (60.0 * self.share * self.method.relative_limit() * limit);
        let substeps = Substeps::nearest(wanted).get().next_power_of_two().clamp(self.least, self.most);
        if substeps > self.substeps || 4 * substeps <= self.substeps {
            self.set_substeps(substeps);
        }
    }

    fn set_substeps(&mut self, substeps: u32) {
        self.substeps = substeps;
        let scene = Scene { step: 1.0 / (60.0 * f64::from(substeps)), ..self.simulation.scene().clone() };
        self.change(|simulation| simulation.replace_scene(scene));
    }

    /// Applies a change from outside and records it in the account.
    fn change(&mut self, change: impl FnOnce(&mut Simulation)) {
        let before = self.simulation.energies();
        change(&mut self.simulation);
        self.account.changed(before, self.simulation.energies());
    }
}

/// Greatest |s - 1| of the principal stretches s of all triangles.
fn greatest_strain(scene: &Scene, x: &[f64]) -> f64 {
    let in_plane = scene.bodies.iter().flat_map(|body| body.elements.gradients(x)).map(|(f, _)| f);
    let of_cloth = scene.membranes.iter().flat_map(|membrane| membrane.elements.gradients(x));
    let strains = in_plane.chain(of_cloth).map(|f| {
        // s1 + s2 and |s1 - s2|, the smaller stretch with the sign of det F.
        let sum = libm::hypot(f.m11 + f.m22, f.m21 - f.m12);
        let difference = libm::hypot(f.m11 - f.m22, f.m21 + f.m12);
        (0.5 * (sum + difference) - 1.0).abs().max((0.5 * (sum - difference) - 1.0).abs())
    });
    strains.fold(0.0, |most: f64, strain| if most.is_nan() || strain <= most { most } else { strain })
}

/// Boundaries that no vertex may cross: the walls of a level, the edges of its world, and a box.
pub struct Fence {
    /// Number of coordinates of a vertex.
    dimension: usize,
    obstacles: Vec<PlacedObstacle>,
    in_space: Vec<PlacedObstacle<3>>,
    /// Corners with the least and the greatest coordinates \[m\].
    boxes: Vec<[[f64; 3]; 2]>,
    /// Longest side of the bounding boxes of the bodies and membranes at rest, or of all nets where there are none \[m\].
    size: f64,
}

impl Fence {
    /// Boundaries of a level, and an additional box.
    pub fn new(level: &Level, scene: &Scene, within: Option<(Position, Position)>) -> Self {
        let (mut obstacles, mut in_space) = (Vec::new(), Vec::new());
        let mut boxes: Vec<_> = within.iter().map(|(least, greatest)| [least.get(), greatest.get()]).collect();
        let acts = |when: When| when == When::Always || level.mode == RunMode::Collide;
        for listed in level.effects.iter().filter(|listed| listed.switch.is_on() && acts(listed.when)) {
            match &listed.effect {
                EffectKind::Boundary(edges) => {
                    boxes.push([edges.least, edges.greatest].map(|corner| Position::Plane(corner).get()));
                }
                // A wall that cannot be built also prevents the scene.
                EffectKind::Walls(walls) => {
                    for kind in walls.obstacles.iter().map(ObstacleKind::kind) {
                        let motions = kind.motions();
                        if let Ok(obstacle) = kind.build() {
                            obstacles.push(PlacedObstacle { obstacle, motions });
                        } else if let Ok(obstacle) = kind.build_in_space(&scene.elements.surfaces) {
                            in_space.push(PlacedObstacle { obstacle, motions });
                        }
                    }
                }
                _ => {}
            }
        }
        let bodies = scene.bodies.iter().map(|body| &scene.rest[2 * body.vertices.start..2 * body.vertices.end]);
        let shapes = bodies.chain(scene.membranes.iter().map(|membrane| membrane.mesh.points().as_flattened()));
        let sides =
            shapes.flat_map(|flat| [0, 1].map(|axis| extent(flat, axis)).map(|(least, greatest)| greatest - least));
        let mut size = sides.fold(0.0, f64::max);
        if size == 0.0 {
            let along = |axis: usize| scene.rest.iter().skip(axis).step_by(scene.dimension).copied();
            let extent =
                |axis| along(axis).fold(f64::NEG_INFINITY, f64::max) - along(axis).fold(f64::INFINITY, f64::min);
            size = (0..scene.dimension).map(extent).fold(0.0, f64::max);
        }
        Self { dimension: scene.dimension, obstacles, in_space, boxes, size }
    }

    /// Greatest distance of the points (flat, \[m\]) beyond the boundaries at a time \[s\], as a share of the size of the bodies.
    pub fn beyond(&self, time: f64, x: &[f64]) -> f64 {
        let beyond_boxes = self.boxes.iter().flat_map(|[least, greatest]| {
            let axes = 0..self.dimension;
            let points = x.chunks_exact(self.dimension);
            points.flat_map(move |point| {
                axes.clone().map(|axis| (least[axis] - point[axis]).max(point[axis] - greatest[axis]))
            })
        });
        let farthest = beyond_boxes.fold(0.0, f64::max);
        let farthest = if self.dimension == 2 {
            farthest.max(deepest(&self.obstacles, time, x))
        } else {
            farthest.max(deepest(&self.in_space, time, x))
        };
        farthest / self.size
    }
}

/// Greatest depth of points (flat, \[m\]) inside obstacles at a time \[s\].
fn deepest<const D: usize>(obstacles: &[PlacedObstacle<D>], time: f64, x: &[f64]) -> f64 {
    let depths = obstacles.iter().flat_map(|placed| {
        let at = placed.at(time);
        x.as_chunks::<D>().0.iter().filter_map(move |point| {
            let point = at.as_ref().map_or(*point, |at| at.back(*point));
            placed.obstacle.contact(point).map(|contact| -contact.distance)
        })
    });
    depths.fold(0.0, f64::max)
}

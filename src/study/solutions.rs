//! Solutions without time steps: closed forms of scenes, and static equilibria.

use super::trial::Trial;
use crate::{
    effects::{Grab, Motion},
    scene::{Body, Scene, extent},
    solvers::{Equations, Newton, NewtonCounts, SparseMatrix, Tangent, Weights},
    stability::largest_eigenvalue,
    state::State,
    toys::ToyKind,
};

/// Closed form of a scene from a given time on.
#[derive(Clone)]
pub struct ClosedForm {
    /// Description in plain words.
    pub words: String,
    /// Positions from which motion is measured, for relative errors \[m\].
    pub(super) origin: Vec<f64>,
    solution: Solution,
}

#[derive(Clone)]
enum Solution {
    /// Exact solution of a toy, from time 0.
    Toy(ToyKind),
    /// `place + u (rest + swing cos wt + way sin wt)` of one particle with the unit vector u; all other particles are
    /// fixed.
    Oscillator { since: f64, free: usize, place: [f64; 2], u: [f64; 2], rest: f64, swing: f64, way: f64, omega: f64 },
    /// `x0 + v t + g t²/2`.
    FreeFall { since: f64, v: [f64; 2], g: [f64; 2] },
    /// Positions at rest \[m\].
    Rest(Vec<f64>),
}

impl ClosedForm {
    /// Closed form of a trial, if it has one.
    pub(super) fn of_trial(trial: &Trial) -> Option<Self> {
        let start = State { memory: Vec::new(), ..trial.start.clone() };
        let toy = toy(&trial.scene).filter(|_| start == trial.scene.start);
        toy.or_else(|| motion(&trial.scene, &start, trial.grab))
    }

    /// Closed form for the error of a running scene, if one is known.
    /// It is the exact motion of a toy since its start, a motion from the present time on, or the shape of a strip at
    /// rest.
    pub fn of_running(scene: &Scene, state: &State, grab: Option<Grab>) -> Option<Self> {
        let rest = || {
            let (words, x) = strip_at_rest(scene, state).filter(|_| grab.is_none())?;
            Some(Self { words, origin: scene.rest.clone(), solution: Solution::Rest(x) })
        };
        toy(scene).or_else(|| motion(scene, state, grab)).or_else(rest)
    }

    /// Positions at a simulated time \[m\].
    pub fn positions(&self, time: f64) -> Vec<f64> {
        match &self.solution {
            Solution::Toy(toy) => toy.kind().exact(time).to_vec(),
            &Solution::Oscillator { since, free, place, u, rest, swing, way, omega } => {
                let (sine, cosine) = libm::sincos(omega * (time - since));
                let s = rest + swing * cosine + way * sine;
                let mut x = self.origin.clone();
                (x[free], x[free + 1]) = (place[0] + s * u[0], place[1] + s * u[1]);
                x
            }
            Solution::FreeFall { since, v, g } => {
                let t = time - since;
                let moved = [0, 1].map(|axis| v[axis] * t + 0.5 * g[axis] * t * t);
                self.origin.iter().zip(moved.iter().cycle()).map(|(x, moved)| x + moved).collect()
            }
            Solution::Rest(x) => x.clone(),
        }
    }
}

/// Whether the scene has only these effects and elements.
fn only(scene: &Scene, names: &[&str]) -> bool {
    // A mouse spring without a grabbed vertex has no force.
    let known = |name: &str| name == "Mouse spring" || names.contains(&name);
    scene.effects.iter().all(|effect| known(effect.name()))
}

/// Exact solution of a toy.
fn toy(scene: &Scene) -> Option<ClosedForm> {
    let toy = scene.toy.clone()?;
    Some(ClosedForm {
        words: toy.kind().about().to_owned(),
        origin: scene.start.x.clone(),
        solution: Solution::Toy(toy),
    })
}

/// Oscillation or free fall from the given state on.
fn motion(scene: &Scene, start: &State, grab: Option<Grab>) -> Option<ClosedForm> {
    if grab.is_some() || start.x.is_empty() || start.v.len() != start.x.len() {
        return None;
    }
    oscillator(scene, start).or_else(|| free_fall(scene, start))
}

/// Oscillation of one particle along one spring: `s = s_e + (s0 - s_e) cos wt + v0/w sin wt`.
/// `w² = k/m` and `s_e = r + m g/k`. It holds as long as the particle does not reach the other end.
fn oscillator(scene: &Scene, start: &State) -> Option<ClosedForm> {
    let [net] = scene.nets.as_slice() else { return None };
    let ([link], [pin], true) = (net.springs.links(), scene.pins.as_slice(), scene.bodies.is_empty()) else {
        return None;
    };
    if start.x.len() != 4 || !only(scene, &["Springs", "Gravity"]) {
        return None;
    }
    let (fixed, free) = (2 * *pin as usize, 2 - 2 * *pin as usize);
    let d = [start.x[free] - start.x[fixed], start.x[free + 1] - start.x[fixed + 1]];
    let s0 = (d[0] * d[0] + d[1] * d[1]).sqrt();
    let u = [d[0] / s0, d[1] / s0];
    let along = |a: &[f64]| a[0] * u[0] + a[1] * u[1];
    let across = |a: &[f64]| (a[0] * u[1] - a[1] * u[0]).abs();
    let (a, v) = (acceleration(scene, start), &start.v[free..free + 2]);
    let straight = across(&a[free..]) <= 1e-12 * along(&a[free..]).abs() && across(v) <= 1e-12 * along(v).abs();
    let square = link.stiffness * scene.inverse_mass[free];
    // a = -w² (s0 - s_e): the acceleration at the start gives the position of rest.
    let (omega, swing) = (square.sqrt(), -along(&a[free..]) / square);
    let (rest, way) = (s0 - swing, along(v) / omega);
    if !straight || square <= 0.0 || rest <= (swing * swing + way * way).sqrt() {
        return None;
    }
    let place = [start.x[fixed], start.x[fixed + 1]];
    let solution = Solution::Oscillator { since: start.time, free, place, u, rest, swing, way, omega };
    let words = "harmonic oscillator, s_e + (s0 - s_e) cos wt + v0/w sin wt".to_owned();
    Some(ClosedForm { words, origin: start.x.clone(), solution })
}

/// Free fall of a body without stress under gravity alone: `x = x0 + v t + g t²/2`.
fn free_fall(scene: &Scene, start: &State) -> Option<ClosedForm> {
    let in_plane = scene.dimension == 2;
    if !in_plane || !only(scene, &["Elasticity", "Springs", "Gravity"]) || scene.inverse_mass.contains(&0.0) {
        return None;
    }
    let acceleration = acceleration(scene, start);
    let (g, v) = ([acceleration[0], acceleration[1]], [start.v[0], start.v[1]]);
    let size = g.iter().chain(&v).map(|value| value.abs()).fold(0.0, f64::max);
    let uniform = |values: &[f64], first: [f64; 2]| {
        values.chunks_exact(2).flatten().zip(first.iter().cycle()).all(|(a, b)| (a - b).abs() <= 1e-11 * size)
    };
    if size == 0.0 || !uniform(&acceleration, g) || !uniform(&start.v, v) {
        return None;
    }
    let solution = Solution::FreeFall { since: start.time, v, g };
    Some(ClosedForm { words: "free fall, x0 + v t + g t^2/2".to_owned(), origin: start.x.clone(), solution })
}

/// Force over mass, flat [m/s²].
fn acceleration(scene: &Scene, start: &State) -> Vec<f64> {
    let motion: Motion<'_> = scene.motion(start, None);
    let mut force = vec![0.0; start.x.len()];
    for effect in &scene.effects {
        effect.force(motion, &mut vec![0.0; effect.scratch()], &mut force);
    }
    force.iter().zip(&scene.inverse_mass).map(|(force, inverse_mass)| force * inverse_mass).collect()
}

/// Equilibrium of a strip whose ends slide on rollers: description in plain words and positions \[m\].
///
/// The ends are held at a stretch s and slide freely, so no force acts on the sides. The deformation gradient is
/// diag(w, s) throughout. The width w follows from zero lateral stress, `P11(diag(w, s)) = 0`
/// ([`Material::free_width`]). Linear triangles represent this shape exactly, so a scene at rest has only the error
/// of its solver. A third side, left or right, slides along y and fixes the position in x. Damping may act; other
/// forces may not.
fn strip_at_rest(scene: &Scene, state: &State) -> Option<(String, Vec<f64>)> {
    let [body] = scene.bodies.as_slice() else { return None };
    let alone = scene.nets.is_empty() && scene.pins.is_empty();
    if !alone || !only(scene, &["Elasticity", "Damping", "Drag"]) {
        return None;
    }
    let held = |vertex: u32, axis: usize| scene.inverse_mass[2 * vertex as usize + axis] == 0.0;
    let ((left, right), (bottom, top)) = (extent(&scene.rest, 0), extent(&scene.rest, 1));
    if !is_strip(body, &scene.rest, |vertex| held(vertex, 1)) {
        return None;
    }
    // Present coordinate of a side that is held in its normal direction.
    let place = |axis: usize, at: f64| {
        let on_side = |vertex: &u32| {
            let here = scene.rest[2 * *vertex as usize + axis];
            (here - at).abs() <= 1e-9 * (right - left) && held(*vertex, axis)
        };
        let vertex = (0..scene.rest.len() as u32 / 2).find(on_side)?;
        Some(state.x[2 * vertex as usize + axis])
    };
    let (low, high) = (place(1, bottom)?, place(1, top)?);
    let (fixed, anchor) = match (place(0, left), place(0, right)) {
        (Some(x), None) => (left, x),
        (None, Some(x)) => (right, x),
        _ => return None,
    };
    let stretch = (high - low) / (top - bottom);
    let width = body.elements.material().free_width(stretch)?;
    let moved = |point: &[f64]| [anchor + width * (point[0] - fixed), low + stretch * (point[1] - bottom)];
    let words = format!("strip at rest, {stretch:.4} times as high and {width:.4} times as wide");
    Some((words, scene.rest.chunks_exact(2).flat_map(moved).collect()))
}

/// Whether every edge of the boundary is vertical or held in its height.
fn is_strip(body: &Body, rest: &[f64], held: impl Fn(u32) -> bool) -> bool {
    let slack = 1e-9 * body.rest_height;
    body.boundary.iter().all(|edge| {
        let [a, b] = edge.map(|i| i as usize + body.vertices.start);
        (rest[2 * a] - rest[2 * b]).abs() <= slack || (held(a as u32) && held(b as u32))
    })
}

/// Static equilibrium from the start by Newton's method, under loads that act in full, and the counts of the solver. Walls are ignored.
///
/// Each round solves `f(x) = w m (x - x_before)` from the result of the previous round. w falls from a stiff value,
/// which is a long implicit step, to zero. Large deflections are thus reached without a jump to another equilibrium.
pub(super) fn rest(scene: &Scene) -> Option<(Vec<f64>, NewtonCounts)> {
    // Reactions of exact constraints are no derivatives of an energy.
    if scene.effects.iter().any(|effect| effect.constraints().is_some()) {
        return None;
    }
    let mut x = scene.start.x.clone();
    let scale = largest_eigenvalue(scene, &scene.start, None)?;
    let mut newton = Newton::default();
    let mut counts = NewtonCounts::NONE;
    let softer = |holding: &f64| if *holding > 1e-10 { Some(0.2 * holding) } else { None };
    for holding in std::iter::successors(Some(1e-4), softer).chain([0.0]) {
        let mut balance = Balance::new(scene, &x, holding * scale, 1e-6 * scale);
        let mut z = vec![0.0; x.len()];
        let round = newton.solve(&mut balance, &mut z);
        // Only the last round must converge.
        counts.unconverged = 0;
        counts.add(&round);
        if !z.iter().all(|z| z.is_finite()) {
            return None;
        }
        x.iter_mut().zip(&z).for_each(|(x, z)| *x += z);
    }
    Some((x, counts))
}

/// `w m z - f(x + z) = 0`.
struct Balance<'a> {
    scene: &'a Scene,
    from: Vec<f64>,
    x: Vec<f64>,
    still: Vec<f64>,
    scratch: Vec<f64>,
    /// w [1/s²].
    holding: f64,
    /// Time at which forces act \[s\].
    time: f64,
    inverse_weight: Vec<f64>,
}

impl<'a> Balance<'a> {
    fn new(scene: &'a Scene, from: &[f64], holding: f64, weight: f64) -> Self {
        Self {
            scene,
            from: from.to_vec(),
            x: from.to_vec(),
            still: vec![0.0; from.len()],
            scratch: vec![0.0; scene.scratch()],
            holding,
            time: scene.effects.iter().map(|effect| effect.ramp()).fold(0.0, f64::max),
            inverse_weight: scene.inverse_mass.iter().map(|inverse_mass| inverse_mass / weight).collect(),
        }
    }

    fn move_to(&mut self, z: &[f64]) {
        for ((x, from), z) in self.x.iter_mut().zip(&self.from).zip(z) {
            *x = from + z;
        }
    }

    fn motion(&self) -> Motion<'_> {
        let Scene { dimension, mass, inverse_mass, .. } = self.scene;
        let time = self.time;
        Motion { dimension: *dimension, x: &self.x, v: &self.still, mass, inverse_mass, time, ..Motion::NONE }
    }
}

impl Equations for Balance<'_> {
    fn residual(&mut self, z: &[f64], g: &mut [f64]) {
        self.move_to(z);
        g.fill(0.0);
        let mut scratch = std::mem::take(&mut self.scratch);
        for effect in &self.scene.effects {
            effect.force(self.motion(), &mut scratch[..effect.scratch()], g);
        }
        self.scratch = scratch;
        for (((g, z), mass), inverse) in g.iter_mut().zip(z).zip(&self.scene.mass).zip(&self.scene.inverse_mass) {
            *g = if *inverse == 0.0 { 0.0 } else { self.holding * mass * z - *g };
        }
    }

    fn block_size(&self) -> usize {
        self.scene.dimension
    }

    fn derivative(&mut self, z: &[f64], tangent: Tangent, matrix: &mut dyn SparseMatrix) {
        self.move_to(z);
        let weights = Weights { position: 1.0, velocity: 0.0, tangent };
        for effect in &self.scene.effects {
            effect.add_stiffness(self.motion(), weights, matrix);
        }
        matrix.add_to_diagonal(&|number| self.holding * self.scene.mass[number]);
    }

    fn sparsity_pattern(&self, add: &mut dyn FnMut(u32, u32)) {
        for effect in &self.scene.effects {
            effect.sparsity_pattern(add);
        }
    }

    fn inverse_weight(&self) -> &[f64] {
        &self.inverse_weight
    }

    fn other_start(&self, z: &mut [f64]) {
        z.fill(0.0);
    }

    /// 1e-9 of the greatest displacement, plus round-off of the coordinates \[m\].
    fn tolerance(&self, z: &[f64]) -> f64 {
        let greatest = |values: &[f64]| values.iter().fold(0.0_f64, |greatest, value| greatest.max(value.abs()));
        1e-9 * greatest(z) + 1e-13 * greatest(&self.x)
    }
}

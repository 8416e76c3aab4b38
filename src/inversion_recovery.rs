//! Inversion recovery: finds a shape without inverted triangles, folds and creases.
//!
//! Inverted triangles have restoring forces, and most tangled bodies recover by themselves. A body may also end in a
//! local minimum of its energy without inverted triangles: a vertex whose triangles go round it twice, or a crease that
//! nearly incompressible triangles lock. No small motion can undo it. [`untangled`] replaces such a shape.
//!
//! ```
//! use gingerbread::{files, levels, meshes::NoFiles, scene::Scene, inversion_recovery::Tangle};
//!
//! let level = files::parse(levels::built_in("jelly_disk").ok_or("there is no such level")?, "jelly_disk.ron")?;
//! let scene = Scene::build(&level, level.mode, &NoFiles, None)?;
//! assert!(!Tangle::of_all(&scene, &scene.rest).is_some());
//! // Mirrored, every triangle is inverted.
//! let mirrored: Vec<f64> = scene.rest.chunks(2).flat_map(|point| [-point[0], point[1]]).collect();
//! assert_eq!(Tangle::of_all(&scene, &mirrored).inverted, scene.triangles.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::{
    effects::Effect,
    elements::ElasticElements,
    materials::nearest_rotation,
    scene::{Body, Scene},
    solvers::{BlockMatrix, Factor},
    state::State,
};
use nalgebra::{Matrix2, Matrix4, Vector2};

/// Inverted triangles and folds of bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tangle {
    /// Number of inverted triangles, det F <= 0.
    pub inverted: usize,
    /// Number of folded vertices: interior ones with a winding number other than one, and boundary ones at which triangles lie
    /// over each other.
    pub wound: usize,
    /// Number of bodies in a metastable equilibrium: without inverted triangles and folds, and with elastic forces that balance
    /// in another shape than the one at rest.
    pub metastable: usize,
}

/// Least elastic energy of a metastable body, as a share of `mu` times its area at rest.
const METASTABLE_ENERGY: f64 = 1e-6;

/// Greatest work of the elastic forces of a metastable body over its displacements, as a share of its elastic energy.
const METASTABLE_WORK: f64 = 0.01;

impl Tangle {
    /// Counts the inverted triangles and folds of a body at flat positions of the whole scene \[m\].
    ///
    /// The winding number of a vertex is the number of crossings of a fixed ray from it by the edges of its triangles:
    /// plus one for each counter-clockwise crossing, minus one for each clockwise one. The triangles of a boundary vertex
    /// fill an angle. If none is inverted and the sum of their angles is above 2 pi, they lie over each other.
    pub fn of(scene: &Scene, body: &Body, x: &[f64]) -> Self {
        // Boundary vertices have no winding number.
        const BOUNDARY: i32 = i32::MIN / 2;
        let mut rounds = vec![0; body.vertices.len()];
        for vertex in body.boundary.as_flattened() {
            rounds[*vertex as usize] = BOUNDARY;
        }
        let mut angles = vec![0.0; body.vertices.len()];
        let mut inverted = 0;
        for triangle in body.elements.corners() {
            let points = triangle.map(|corner| Vector2::new(x[2 * corner as usize], x[2 * corner as usize + 1]));
            let area = (points[1] - points[0]).perp(&(points[2] - points[0]));
            inverted += usize::from(area <= 0.0);
            for corner in 0..3 {
                let vertex = triangle[corner] as usize - body.vertices.start;
                let next = [1, 2].map(|next| points[(corner + next) % 3]);
                if rounds[vertex] <= BOUNDARY / 2 {
                    let [one, other] = next.map(|point| point - points[corner]);
                    angles[vertex] += libm::atan2(one.perp(&other), one.dot(&other));
                    continue;
                }
                let [one, other] = next.map(|point| point.y >= points[corner].y);
                rounds[vertex] += i32::from(!one && other && area > 0.0) - i32::from(one && !other && area < 0.0);
            }
        }
        // An inverted triangle has a negative angle and is counted itself.
        let overlaps = |angle: &&f64| **angle > std::f64::consts::TAU * (1.0 + 1e-9);
        let wound = rounds.iter().filter(|rounds| **rounds != 1 && **rounds > BOUNDARY / 2).count()
            + angles.iter().filter(overlaps).count();
        let metastable = usize::from(inverted + wound == 0 && is_metastable(scene, body, x));
        Self { inverted, wound, metastable }
    }

    /// The sum over all bodies.
    pub fn of_all(scene: &Scene, x: &[f64]) -> Self {
        let bodies = scene.bodies.iter().map(|body| Self::of(scene, body, x));
        bodies.fold(Self::default(), |a, b| Self {
            inverted: a.inverted + b.inverted,
            wound: a.wound + b.wound,
            metastable: a.metastable + b.metastable,
        })
    }

    /// Whether there are inverted triangles, folds or metastable bodies.
    pub fn is_some(self) -> bool {
        self != Self::default()
    }
}

/// Whether the elastic forces `f` of a body balance in a shape with elastic energy `U`: the sum of `|f_i| |u_i|` is under
/// [`METASTABLE_WORK`] of `U`, with displacements `u` from the rest shape in its best rigid placement.
///
/// Near the rest shape `U` is half the work `-f . u` (Clapeyron's theorem), so the sum is at least `2 U`; so it is where
/// loads, pins or contact hold a body.
fn is_metastable(scene: &Scene, body: &Body, x: &[f64]) -> bool {
    let energy = body.elements.elastic_energy(x);
    if energy.is_nan() || energy <= METASTABLE_ENERGY * body.elements.energy_scales()[0] {
        return false;
    }
    let mut force = vec![0.0; x.len()];
    body.elements.elastic_force(x, &mut vec![0.0; body.elements.scratch()], &mut force);
    let fit = Fit::new(scene, x, body.vertices.clone().map(|vertex| (vertex, 1.0)));
    let works = body.vertices.clone().map(|vertex| {
        let displacement = at(x, vertex) - fit.place(at(&scene.rest, vertex));
        at(&force, vertex).norm() * displacement.norm()
    });
    works.sum::<f64>() <= METASTABLE_WORK * energy
}

/// The state with every tangled body replaced by a shape without folds; the others stay. `None` if none is tangled.
///
/// A body without pins takes its rest shape in the rigid placement that fits best, and keeps its momentum and angular
/// momentum. A pinned body takes the shape that minimises `sum of A |F - R|²` with one rotation R for all its
/// triangles, which is a convex problem with a unique solution, and its velocities become zero. If its pins themselves
/// are crossed, even that shape has folds.
pub fn untangled(scene: &Scene, state: &State) -> Option<State> {
    let mut found = None;
    for body in scene.bodies.iter().filter(|body| Tangle::of(scene, body, &state.x).is_some()) {
        // What was remembered belongs to the old shape.
        let forgotten = || State {
            memory: Vec::new(),
            slow_checks: Vec::new(),
            calm_positions: Vec::new(),
            anchors: Vec::new(),
            ..state.clone()
        };
        let state = found.get_or_insert_with(forgotten);
        let numbers = 2 * body.vertices.start..2 * body.vertices.end;
        if scene.inverse_mass[numbers].contains(&0.0) {
            spread(scene, body, state);
        } else {
            lay_out(scene, body, state);
        }
    }
    found
}

/// A rigid motion of the rest shape: points `centre + R (X - rest)`.
struct Fit {
    centre: Vector2<f64>,
    rest: Vector2<f64>,
    turn: Matrix2<f64>,
}

impl Fit {
    /// The best fit to the positions of these vertices, by weighted least squares (Kabsch's algorithm, whose rotation
    /// in two dimensions has a closed form).
    fn new(scene: &Scene, x: &[f64], weights: impl Iterator<Item = (usize, f64)> + Clone) -> Self {
        let mut sums = (0.0, Vector2::zeros(), Vector2::zeros());
        for (vertex, weight) in weights.clone() {
            sums = (sums.0 + weight, sums.1 + at(x, vertex) * weight, sums.2 + at(&scene.rest, vertex) * weight);
        }
        let (centre, rest) = (sums.1 / sums.0, sums.2 / sums.0);
        let products = weights
            .map(|(vertex, weight)| (at(x, vertex) - centre) * (at(&scene.rest, vertex) - rest).transpose() * weight);
        let (turn, _) = nearest_rotation((&products.sum::<Matrix2<f64>>()).into());
        Self { centre, rest, turn: turn.into() }
    }

    fn place(&self, rest: Vector2<f64>) -> Vector2<f64> {
        self.centre + self.turn * (rest - self.rest)
    }
}

/// Resets an unconstrained body to its rest shape with a rigid motion.
fn lay_out(scene: &Scene, body: &Body, state: &mut State) {
    let masses = body.vertices.clone().map(|vertex| (vertex, scene.mass[2 * vertex]));
    let fit = Fit::new(scene, &state.x, masses.clone());
    let (mut mass, mut momentum, mut spin, mut inertia) = (0.0, Vector2::zeros(), 0.0, 0.0);
    for (vertex, own) in masses {
        let velocity = at(&state.v, vertex);
        mass += own;
        momentum += velocity * own;
        spin += own * (at(&state.x, vertex) - fit.centre).perp(&velocity);
        inertia += own * (at(&scene.rest, vertex) - fit.rest).norm_squared();
    }
    let (velocity, spin) = (momentum / mass, spin / inertia);
    for vertex in body.vertices.clone() {
        let place = fit.place(at(&scene.rest, vertex));
        let arm = place - fit.centre;
        put(&mut state.x, vertex, place);
        put(&mut state.v, vertex, velocity + Vector2::new(-arm.y, arm.x) * spin);
    }
}

/// Resets a constrained body to the minimiser between its constraints.
fn spread(scene: &Scene, body: &Body, state: &mut State) {
    let free = |vertex: usize| [scene.inverse_mass[2 * vertex], scene.inverse_mass[2 * vertex + 1]];
    let held = body.vertices.clone().filter(|vertex| free(*vertex) == [0.0; 2]).map(|vertex| (vertex, 1.0));
    let all = body.vertices.clone().map(|vertex| (vertex, 1.0));
    // One point does not determine the rotation.
    let fit =
        if held.clone().nth(1).is_some() { Fit::new(scene, &state.x, held) } else { Fit::new(scene, &state.x, all) };
    let count = scene.rest.len();
    let mut matrix = {
        let mut pattern = Vec::new();
        for &[a, b, c] in body.elements.corners() {
            pattern.extend([[a, b], [a, c], [b, c]]);
        }
        BlockMatrix::new(count / 2, &pattern)
    };
    // The second derivative of A |F - R|² / 2, which is constant.
    body.elements.add_tangent(&scene.rest, 1.0, &mut matrix, |_, _| Matrix4::identity());
    let (mut away, mut weight) = (vec![0.0; count], vec![0.0; count]);
    for vertex in body.vertices.clone() {
        let place = fit.place(at(&scene.rest, vertex));
        for (axis, inverse_mass) in free(vertex).into_iter().enumerate() {
            let number = 2 * vertex + axis;
            state.v[number] = 0.0;
            if inverse_mass == 0.0 {
                // Constrained vertices deviate from the fit; the others follow.
                away[number] = place[axis] - state.x[number];
            } else {
                weight[number] = 1.0;
                state.x[number] = place[axis];
            }
        }
    }
    let mut change = vec![0.0; count];
    matrix.add_product(&away, &mut change);
    let Some(mut factor) = Factor::new(&matrix) else { return };
    // A body on rollers may translate along them: that displacement is zero.
    let holding = 1e-9;
    if factor.factorise(&matrix, &weight, holding) {
        factor.solve(&mut change);
        for number in (0..count).filter(|number| weight[*number] > 0.0) {
            state.x[number] += change[number];
        }
    }
}

fn at(flat: &[f64], vertex: usize) -> Vector2<f64> {
    Vector2::new(flat[2 * vertex], flat[2 * vertex + 1])
}

fn put(flat: &mut [f64], vertex: usize, value: Vector2<f64>) {
    (flat[2 * vertex], flat[2 * vertex + 1]) = (value.x, value.y);
}

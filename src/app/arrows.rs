//! Arrows on the stage: velocities, forces or principal stresses at points that are spread evenly over the scene; and loads on edges.

use crate::{probe::net_forces, sandbox::Sandbox, scene::Scene, snapshot::Snapshot, state::State};
use nalgebra::Matrix2;
use std::collections::BTreeSet;

/// Number of arrows along the longest side of a scene.
const ALONG: f64 = 17.0;

/// Length of the longest arrow, in distances between them.
const LONGEST: f64 = 1.5;

/// Length of the longest arrow of a load, as a share of the longest side of a scene, and least distance between two at the start, as a share
/// of that.
const LOAD_LENGTH: f64 = 0.08;
const LOAD_DISTANCE: f64 = 0.5;

/// What arrows show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ArrowKind {
    /// There are none.
    #[default]
    None,
    /// Velocities of vertices.
    Velocity,
    /// Sums of all forces on vertices.
    Force,
    /// Principal Cauchy stresses of the triangles of bodies.
    Stress,
}

impl ArrowKind {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::None, Self::Velocity, Self::Force, Self::Stress];

    /// Name in menus.
    pub const fn title(self) -> &'static str {
        match self {
            Self::None => "No arrows",
            Self::Velocity => "Velocities",
            Self::Force => "Net forces",
            Self::Stress => "Principal stresses",
        }
    }

    /// What it shows, in a sentence.
    pub const fn about(self) -> &'static str {
        match self {
            Self::None => "The stage without arrows.",
            Self::Velocity => "Velocities of vertices that are spread evenly over the scene.",
            Self::Force => {
                "The sum of all forces on a vertex, without that of a pin: mass times acceleration where the vertex is free."
            }
            Self::Stress => {
                "Principal Cauchy stresses of triangles of bodies in the plane: lines with arrows for tension, with bars for compression."
            }
        }
    }

    const fn unit(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Velocity => "m/s",
            Self::Force => "N",
            Self::Stress => "Pa",
        }
    }

    /// Whether a scene has it.
    pub const fn suits(self, now: &Snapshot) -> bool {
        match self {
            Self::None => true,
            Self::Velocity | Self::Force => now.toy.is_none(),
            Self::Stress => now.dimension == 2 && !now.bodies.is_empty(),
        }
    }
}

/// An arrow, or a line to both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrow {
    /// Where it begins, or its middle \[m\].
    pub at: [f64; 3],
    /// Its direction and its length on the stage; half of it of a line to both sides \[m\].
    pub along: [f64; 3],
    /// Of a line to both sides, whether it is tension.
    pub tension: Option<bool>,
}

/// The arrows of a moment.
#[derive(Clone, Default)]
pub struct Arrows {
    /// What they show, and the generation of the scene that their places belong to.
    shown: (ArrowKind, u64),
    places: Places,
    all: Vec<Arrow>,
    greatest: f64,
    loads: Vec<Arrow>,
    forces: Vec<f64>,
}

/// Vertices or triangles with an arrow.
#[derive(Clone, Default)]
struct Places {
    numbers: Vec<usize>,
    /// Distance between them \[m\].
    distance: f64,
}

impl Arrows {
    /// Takes the arrows of a kind of a running scene.
    pub fn follow(&mut self, kind: ArrowKind, sandbox: &Sandbox) {
        self.all.clear();
        self.greatest = 0.0;
        let (simulation, shown) = (sandbox.simulation(), (kind, sandbox.generation));
        let (scene, state) = (simulation.scene(), simulation.state());
        self.follow_loads(scene, state);
        if kind == ArrowKind::None || scene.toy.is_some() {
            return;
        }
        if self.shown != shown {
            self.shown = shown;
            self.places =
                if kind == ArrowKind::Stress { Places::of_triangles(scene) } else { Places::of_vertices(scene) };
        }
        match kind {
            ArrowKind::None => {}
            ArrowKind::Velocity => self.add_at_vertices(scene, &state.x, &state.v),
            ArrowKind::Force => self.add_at_vertices(scene, &state.x, &net_forces(simulation)),
            ArrowKind::Stress => self.add_in_triangles(scene, &state.x),
        }
        let length = |arrow: &Arrow| arrow.along.iter().map(|part| part * part).sum::<f64>().sqrt();
        self.greatest = self.all.iter().map(length).fold(0.0, f64::max);
        let scale = LONGEST * self.places.distance / self.greatest;
        for arrow in &mut self.all {
            let both = if arrow.tension.is_some() { 0.5 } else { 1.0 };
            arrow.along = arrow.along.map(|part| if scale.is_finite() { both * scale * part } else { 0.0 });
        }
    }

    /// Takes the loads on edges: some of the forces on vertices for the length of the loaded edges there, each drawn by its share in the greatest of
    /// its load. They stay at the same vertices.
    fn follow_loads(&mut self, scene: &Scene, state: &State) {
        self.loads.clear();
        for load in scene.effects.iter().filter(|effect| effect.is_load()) {
            self.forces.clear();
            self.forces.resize(state.x.len(), 0.0);
            load.force(scene.motion(state, None), &mut [], &mut self.forces);
            let forces: &mut [[f64; 2]] = self.forces.as_chunks_mut().0;
            let (x, starts): (&[[f64; 2]], &[[f64; 2]]) = (state.x.as_chunks().0, scene.start.x.as_chunks().0);
            let apart = |a: [f64; 2], b: [f64; 2]| libm::hypot(a[0] - b[0], a[1] - b[1]);
            let mut lengths = vec![0.0; forces.len()];
            for (body, edge) in scene.bodies.iter().flat_map(|body| body.boundary.iter().map(move |edge| (body, edge)))
            {
                let [a, b] = edge.map(|vertex| vertex as usize + body.vertices.start);
                if forces[a] != [0.0; 2] && forces[b] != [0.0; 2] {
                    lengths[a] += 0.5 * apart(x[a], x[b]);
                    lengths[b] += 0.5 * apart(x[a], x[b]);
                }
            }
            for (force, length) in forces.iter_mut().zip(&lengths) {
                *force = if *length > 0.0 { force.map(|part| part / length) } else { [0.0; 2] };
            }
            let greatest = forces.iter().map(|force| apart(*force, [0.0; 2])).fold(0.0, f64::max);
            let extent = |axis: usize| {
                let along = || starts.iter().map(|at| at[axis]);
                along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
            };
            let longest = LOAD_LENGTH * extent(0).max(extent(1));
            let mut taken: Vec<[f64; 2]> = Vec::new();
            for vertex in (0..forces.len()).filter(|vertex| lengths[*vertex] > 0.0) {
                if taken.iter().all(|other| apart(*other, starts[vertex]) >= LOAD_DISTANCE * longest) {
                    taken.push(starts[vertex]);
                    let ([x, y], [fx, fy]) = (x[vertex], forces[vertex].map(|part| part * longest / greatest));
                    self.loads.push(Arrow { at: [x, y, 0.0], along: [fx, fy, 0.0], tension: None });
                }
            }
        }
    }

    /// The loads on edges.
    pub fn loads(&self) -> &[Arrow] {
        &self.loads
    }

    /// The arrows.
    pub fn all(&self) -> &[Arrow] {
        &self.all
    }

    /// Greatest value, with its unit; `None` if there are no arrows.
    pub fn greatest(&self) -> Option<(f64, &'static str)> {
        (!self.all.is_empty()).then(|| (self.greatest, self.shown.0.unit()))
    }

    fn add_at_vertices(&mut self, scene: &Scene, x: &[f64], values: &[f64]) {
        let whole = |values: &[f64], vertex: usize| {
            let own = &values[scene.numbers(&(vertex..vertex + 1))];
            std::array::from_fn(|axis| own.get(axis).copied().unwrap_or(0.0))
        };
        let arrow = |vertex: &usize| Arrow { at: whole(x, *vertex), along: whole(values, *vertex), tension: None };
        self.all.extend(self.places.numbers.iter().map(arrow));
    }

    fn add_in_triangles(&mut self, scene: &Scene, x: &[f64]) {
        let mut places = self.places.numbers.iter().copied().peekable();
        let mut number = 0;
        for body in &scene.bodies {
            for (own, (f, _)) in body.elements.gradients(x).enumerate() {
                if places.next_if_eq(&number).is_some() {
                    let piola = body.elements.point_stress(x, own).piola;
                    let at = middle(scene, x, number);
                    let lines = principal(&(piola * f.transpose() / f.determinant()));
                    self.all.extend(lines.map(|(along, tension)| Arrow { at, along, tension: Some(tension) }));
                }
                number += 1;
            }
        }
    }
}

/// Both principal values of a symmetric matrix as vectors along their directions, and whether each is positive.
fn principal(s: &Matrix2<f64>) -> [([f64; 3], bool); 2] {
    let shear = 0.5 * (s.m12 + s.m21);
    let (mean, half) = (0.5 * (s.m11 + s.m22), 0.5 * (s.m11 - s.m22));
    let radius = libm::hypot(half, shear);
    let angle = 0.5 * libm::atan2(shear, half);
    let (cos, sin) = (libm::cos(angle), libm::sin(angle));
    let [first, second] = [mean + radius, mean - radius];
    [([first * cos, first * sin, 0.0], first > 0.0), ([-second * sin, second * cos, 0.0], second > 0.0)]
}

/// Middle of a triangle in the plane \[m\].
fn middle(scene: &Scene, x: &[f64], triangle: usize) -> [f64; 3] {
    let sum = |axis: usize| scene.triangles[triangle].iter().map(|vertex| x[2 * *vertex as usize + axis]).sum::<f64>();
    [sum(0) / 3.0, sum(1) / 3.0, 0.0]
}

impl Places {
    fn of_vertices(scene: &Scene) -> Self {
        let (x, size) = (&scene.start.x, scene.dimension);
        let points = x.chunks_exact(size).map(|own| std::array::from_fn(|axis| own.get(axis).copied().unwrap_or(0.0)));
        Self::spread(&points.collect::<Vec<_>>())
    }

    fn of_triangles(scene: &Scene) -> Self {
        let middles = (0..scene.triangles.len()).map(|triangle| middle(scene, &scene.start.x, triangle));
        Self::spread(&middles.collect::<Vec<_>>())
    }

    /// The first of some points \[m\] in each cell of a grid. They stay the same while the scene moves.
    fn spread(points: &[[f64; 3]]) -> Self {
        let extent = |axis: usize| {
            let along = || points.iter().map(|point| point[axis]);
            along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
        };
        let distance = (0..3).map(extent).fold(0.0, f64::max) / ALONG;
        let cell = |point: &[f64; 3]| point.map(|coordinate| libm::floor(coordinate / distance) as i64);
        let mut taken = BTreeSet::new();
        let numbers = (0..points.len()).filter(|number| taken.insert(cell(&points[*number]))).collect();
        Self { numbers, distance }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a failing test should panic")]
mod tests {
    use super::*;
    use crate::{files, levels, meshes::NoFiles};

    fn arrows(level: &str, kind: ArrowKind) -> (Sandbox, Arrows) {
        let level = files::parse(levels::built_in(level).unwrap(), level).unwrap();
        let mut sandbox = Sandbox::new(level, Box::new(NoFiles)).unwrap();
        sandbox.apply(crate::command::Command::SetRunning(true)).unwrap();
        sandbox.advance(60, &mut || true);
        let mut arrows = Arrows::default();
        arrows.follow(kind, &sandbox);
        (sandbox, arrows)
    }

    /// A load is drawn on its edge from the moment that it acts, along its force; a level without loads has none.
    #[test]
    fn loads_are_drawn_at_their_edges() {
        let (sandbox, arrows) = arrows("cook_membrane", ArrowKind::None);
        let loads = arrows.loads();
        assert!((4..20).contains(&loads.len()) && arrows.all().is_empty(), "{}", loads.len());
        let rest = &sandbox.simulation().scene().rest;
        let right = rest.iter().step_by(2).fold(0.0_f64, |a, b| a.max(*b));
        for Arrow { at, along, .. } in loads {
            assert!((at[0] - right).abs() < 0.01 && along[0] == 0.0 && along[1] > 0.0, "{at:?} {along:?}");
        }
        assert!(self::arrows("jelly_disk", ArrowKind::Force).1.loads().is_empty());
    }

    #[test]
    fn principal_stresses_are_those_of_the_matrix() {
        for (s11, s22, s12) in [(3.0, 1.0, 0.0), (1.0, 3.0, 0.5), (-2.0, 4.0, -1.5), (0.0, 0.0, 2.0), (-1.0, -1.0, 0.0)]
        {
            let s = Matrix2::new(s11, s12, s12, s22);
            let mut sum = Matrix2::zeros();
            for ([x, y, _], tension) in principal(&s) {
                let value = if tension { libm::hypot(x, y) } else { -libm::hypot(x, y) };
                let unit = nalgebra::Vector2::new(x, y) / libm::hypot(x, y).max(1e-300);
                sum += unit * unit.transpose() * value;
            }
            assert!((sum - s).norm() < 1e-12 * s.norm(), "{s} {sum}");
        }
    }

    /// In free fall all velocities are the same, and the net force is the weight.
    #[test]
    fn arrows_have_the_values_of_the_scene() {
        let (sandbox, shown) = arrows("gingerbread_house", ArrowKind::Velocity);
        let state = sandbox.simulation().state();
        let (greatest, unit) = shown.greatest().unwrap();
        assert!((greatest - state.v[1].abs()).abs() < 1e-3 * greatest && unit == "m/s", "{greatest} {}", state.v[1]);
        assert!((80..400).contains(&shown.all().len()), "{}", shown.all().len());
        assert!(shown.all().iter().all(|arrow| arrow.along[1] < 0.0 && arrow.tension.is_none()));
        let (sandbox, shown) = arrows("gingerbread_house", ArrowKind::Force);
        let mass = sandbox.simulation().scene().mass.iter().copied().fold(0.0, f64::max);
        let share = shown.greatest().unwrap().0 / (4.0 * mass);
        assert!((0.3..1.001).contains(&share), "{share} of the weight of the heaviest vertex");
        for kind in ArrowKind::ALL {
            assert!(arrows("pendulum", kind).1.greatest().is_none(), "a toy has none");
        }
        assert!(!arrows("cornell_cloth", ArrowKind::Velocity).1.all().is_empty());
    }

    /// The strip is pulled upwards and is free at its sides.
    #[test]
    fn a_stretched_strip_has_tension_along_it() {
        let (_, shown) = arrows("uniaxial_strip", ArrowKind::Stress);
        assert_eq!(shown.greatest().unwrap().1, "Pa");
        let length = |arrow: &Arrow| arrow.along[0].hypot(arrow.along[1]);
        let longest = shown.all().iter().max_by(|a, b| length(a).total_cmp(&length(b))).unwrap();
        for arrow in shown.all().iter().filter(|arrow| length(arrow) > 0.5 * length(longest)) {
            assert!(arrow.tension == Some(true) && arrow.along[1].abs() > 2.0 * arrow.along[0].abs(), "{arrow:?}");
        }
    }
}

//! What several test files share: random numbers that are the same on every run, and small scenes.
#![allow(dead_code, clippy::unwrap_used, reason = "each test file uses its own part, and a failing test should panic")]

pub mod folder;
pub mod physics;
pub mod studies;
pub mod systems;

use gingerbread::{
    command::{Command, Mode},
    elements::ElementKind,
    files,
    integrators::IntegratorKind,
    level::{Level, RunMode, Sleep, Toggle},
    materials::{Material, MaterialParameters, Model, Plane, Visitor},
    meshes::NoFiles,
    quantity::{Poisson, Young},
    sandbox::Sandbox,
    scene::Scene,
    simulation::Simulation,
    snapshot::{Field, Snapshot},
};
use nalgebra::{Matrix2, Vector2};

/// A fixed stream of irregular numbers (`SplitMix64`).
pub struct Random(pub u64);

impl Random {
    /// Uniform in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        low + (high - low) * ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A matrix with entries in [-2, 2) and a determinant in the range.
    pub fn gradient(&mut self, least: f64, greatest: f64) -> Matrix2<f64> {
        loop {
            let f = Matrix2::from_fn(|_, _| self.between(-2.0, 2.0));
            if (least..=greatest).contains(&f.determinant()) {
                return f;
            }
        }
    }
}

/// A rotation by an angle [rad].
pub fn rotation(angle: f64) -> Matrix2<f64> {
    Matrix2::new(angle.cos(), -angle.sin(), angle.sin(), angle.cos())
}

/// A level from its text.
pub fn level(text: &str) -> Level {
    files::parse(text, "test.ron").unwrap()
}

/// An integrator from its text in a level.
pub fn integrator(text: &str) -> IntegratorKind {
    level(&format!("(name: \"\", bodies: [], integrator: {text})")).integrator
}

/// A simulation with an integrator, without guard and sleep, in steps of a length [s].
pub fn started(base: &Level, scheme: &str, step: f64) -> Simulation {
    let level = Level { integrator: integrator(scheme), guard: Toggle::Off, sleep: Sleep::Off, ..base.clone() };
    let scene = Scene { step, ..Scene::build(&level, level.mode, &NoFiles, None).unwrap() };
    Simulation::open(scene, &level, level.mode).unwrap()
}

/// sin and cos of the angle of a slope with tan 0.5.
pub const SLOPE: [f64; 2] = [0.447_213_595_499_958, 0.894_427_190_999_916];

/// A level that ships, of fewer triangles, so that it runs quickly.
pub fn coarse(text: &str, file: &str) -> Level {
    const FEWER: [(&str, &str); 26] = [
        // The first three are of elements of six nodes, and of triangles beside them.
        ("columns: 16, rows: 2,", "columns: 8, rows: 1,"),
        ("columns: 32, rows: 2,", "columns: 8, rows: 1,"),
        ("columns: 32, rows: 4,", "columns: 16, rows: 2,"),
        ("columns: 127, rows: 127", "columns: 8, rows: 8"),
        ("columns: 128, rows: 8", "columns: 16, rows: 2"),
        ("columns: 128, rows: 4", "columns: 16, rows: 1"),
        ("resolution: 4000", "resolution: 200"),
        ("resolution: 3000", "resolution: 200"),
        ("resolution: 2000", "resolution: 150"),
        ("resolution: 1000", "resolution: 250"),
        ("resolution: 700", "resolution: 100"),
        ("radius: 0.045, rings: 5", "radius: 0.045, rings: 3"),
        ("resolution: 500", "resolution: 100"),
        ("columns: 64, rows: 8", "columns: 16, rows: 2"),
        ("columns: 60, rows: 6", "columns: 15, rows: 2"),
        ("columns: 19, rows: 39", "columns: 5, rows: 10"),
        ("rings: 14", "rings: 5"),
        ("resolution: 400", "resolution: 100"),
        ("rings: 4)", "rings: 2)"),
        ("columns: 42, rows: 13", "columns: 14, rows: 4"),
        ("radius: 0.06, rings: 5", "radius: 0.06, rings: 3"),
        ("resolution: 600", "resolution: 150"),
        ("columns: 21, rows: 14", "columns: 7, rows: 5"),
        ("columns: 31, rows: 31", "columns: 9, rows: 9"),
        ("columns: 12, rows: 12", "columns: 5, rows: 5"),
        ("columns: 16, rows: 16", "columns: 6, rows: 6"),
    ];
    let mut text = FEWER.iter().fold(text.to_owned(), |text, (many, few)| text.replace(many, few));
    // Elements of six nodes are four triangles each.
    if text.contains("element: ") {
        for many in ["resolution: 250", "resolution: 200", "resolution: 150"] {
            text = text.replace(many, "resolution: 100");
        }
    }
    files::parse(&text, file).unwrap()
}

/// A simulation of a level in its own mode.
pub fn simulation(level: &Level) -> Simulation {
    let scene = Scene::build(level, level.mode, &NoFiles, None).unwrap();
    Simulation::open(scene, level, level.mode).unwrap()
}

/// Saves a run in a level's text and opens it again.
pub fn reopened(run: &Simulation, level: &Level) -> Simulation {
    let saved = Level { state: run.saved(), ..level.clone() };
    simulation(&files::parse(&files::write(&saved).unwrap(), "saved.ron").unwrap())
}

/// Saves a run after 20 steps, opens it again, and lets both take 20 more: every bit must be equal.
pub fn continues_bit_for_bit(level: &Level) {
    let mut run = simulation(level);
    run.advance(20, &mut || true);
    let mut other = reopened(&run, level);
    for simulation in [&mut run, &mut other] {
        simulation.advance(20, &mut || true);
    }
    assert_eq!(run.state().hash(), other.state().hash(), "{}", level.integrator.name());
}

/// A level that ships.
pub fn built_in(name: &str) -> Level {
    files::parse(gingerbread::levels::built_in(name).unwrap(), name).unwrap()
}

/// A sandbox with a level that ships.
pub fn opened(name: &str) -> Sandbox {
    Sandbox::new(built_in(name), Box::new(NoFiles)).unwrap()
}

/// A sandbox in which a level is simulated.
pub fn running(level: Level) -> Sandbox {
    let mut sandbox = Sandbox::new(level, Box::new(NoFiles)).unwrap();
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    sandbox
}

/// An integrator by its name.
pub fn named(name: &str) -> IntegratorKind {
    IntegratorKind::all().into_iter().find(|kind| kind.name() == name).unwrap()
}

/// What a window would draw of it, without colours.
pub fn seen(sandbox: &Sandbox) -> Snapshot {
    let mut snapshot = Snapshot::default();
    sandbox.snapshot(Field::None, &mut snapshot);
    snapshot
}

/// A soft corotated material.
pub fn material(young: f64) -> MaterialParameters {
    let (young, poisson) = (Young::new(young).unwrap(), Poisson::new(0.2).unwrap());
    MaterialParameters::new(Model::Corotated, young, poisson, Plane::Strain).unwrap()
}

/// A scene of one small square sheet of 2 x 4 x 4 triangles, with more fields of the body and the level.
pub fn sheet(model: &str, body: &str, rest: &str) -> Level {
    level(&format!(
        "(name: \"sheet\", bodies: [(name: \"sheet\",
            mesh: Rectangle(width: 0.4, height: 0.4, columns: 4, rows: 4, diagonals: Alternating, corner: (0.3, 0.3)),
            material: (model: {model}, young: 100, poisson: 0.3, plane: Strain), mass: Density(1), {body})], {rest})"
    ))
}

/// The sheet of each model with each kind of element, with more fields of the body, and what it is.
pub fn sheets(body: &str) -> impl Iterator<Item = (String, Level)> {
    let all = models().flat_map(|model| ElementKind::ALL.map(|kind| (model, kind)));
    all.map(move |(model, kind)| (format!("{model} {kind:?}"), sheet(model, &format!("{body}element: {kind:?}"), "")))
}

/// A small sheet that is let go from a smooth stretch.
pub fn released(rest: &str) -> Level {
    released_of(1000, rest)
}

/// The same, of a stuff of this Young's modulus.
pub fn released_of(young: u32, rest: &str) -> Level {
    level(&format!(
        "(name: \"released\", substeps: 20, bodies: [(name: \"sheet\", stretch: (1.1, 0.95), mass: Density(1),
            mesh: Rectangle(width: 0.4, height: 0.3, columns: 4, rows: 3, diagonals: Alternating, corner: (0.3, 0.3)),
            material: (model: NeoHookean, young: {young}, poisson: 0.3, plane: Stress))], {rest})"
    ))
}

/// Names of all registered constitutive models.
pub fn models() -> impl Iterator<Item = &'static str> {
    gingerbread::materials::Model::ALL.iter().map(|model| model.name())
}

/// Whether two segments cross.
pub fn cross([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> bool {
    let side = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

/// No edge of a boundary crosses a side of an outline.
pub fn assert_apart(simulation: &Simulation, outline: &[[f64; 2]], what: &str) {
    let x = &simulation.state().x;
    let bodies = simulation.scene().bodies.iter();
    let edges = bodies.flat_map(|body| body.boundary.iter().map(|edge| edge.map(|i| i + body.vertices.start as u32)));
    for edge in edges {
        let ends = edge.map(|vertex| [x[2 * vertex as usize], x[2 * vertex as usize + 1]]);
        for (i, &corner) in outline.iter().enumerate() {
            let next = outline[(i + 1) % outline.len()];
            assert!(!cross(ends, [corner, next]), "{what}: edge {edge:?} at {ends:?} crosses {corner:?} to {next:?}");
        }
    }
}

/// The greatest difference of two lists, number by number.
pub fn greatest_gap(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Euclidean norm.
pub fn norm(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>().sqrt()
}

/// Forces at x are minus the differences of an energy, number by number, at the best of several steps.
pub fn assert_minus_derivative(x: &[f64], force: &[f64], energy: impl Fn(&[f64]) -> f64, what: &str) {
    for number in 0..x.len() {
        let error = |epsilon: f64| {
            let (mut ahead, mut behind) = (x.to_vec(), x.to_vec());
            ahead[number] += epsilon;
            behind[number] -= epsilon;
            let slope = (energy(&ahead) - energy(&behind)) / (2.0 * epsilon);
            (force[number] + slope).abs() / norm(force)
        };
        let best = (4..=7).map(|power| error(10.0_f64.powi(-power))).fold(f64::INFINITY, f64::min);
        assert!(best < 1e-8, "{what} {number}: {best:e}");
    }
}

/// How far minus the difference of forces along d is from the product of the stiffness with d, as a share of it, at the best of several
/// steps.
pub fn difference_error(x: &[f64], d: &[f64], product: &[f64], forces: impl Fn(&[f64]) -> Vec<f64>) -> f64 {
    let error = |epsilon: f64| {
        let along = |by: f64| forces(&x.iter().zip(d).map(|(x, d)| x + by * d).collect::<Vec<_>>());
        let (ahead, behind) = (along(epsilon), along(-epsilon));
        let change = ahead.iter().zip(&behind).map(|(a, b)| (b - a) / (2.0 * epsilon));
        norm(&change.zip(product).map(|(change, product)| change - product).collect::<Vec<_>>()) / norm(product)
    };
    (4..=9).map(|power| error(10.0_f64.powi(-power))).fold(f64::INFINITY, f64::min)
}

/// Forces at x have neither sum nor torque, but for round-off.
pub fn assert_balanced(x: &[f64], force: &[f64], what: &str) {
    let sum = |axis: usize| force.iter().skip(axis).step_by(2).sum::<f64>();
    let torque: f64 = x.chunks_exact(2).zip(force.chunks_exact(2)).map(|(x, f)| x[0] * f[1] - x[1] * f[0]).sum();
    let scale = norm(force);
    assert!(sum(0).abs() < 1e-14 * scale && sum(1).abs() < 1e-14 * scale, "{what}");
    assert!(torque.abs() < 1e-14 * scale, "{what}: {torque:e}");
}

/// Both modes.
pub const MODES: [RunMode; 2] = [RunMode::Simulate, RunMode::Collide];

/// Energy of the first body, and the forces `[f1 f2] = -A P D0⁻ᵀ` of one triangle after another.
pub fn one_by_one(simulation: &Simulation, x: &[f64]) -> (f64, Vec<f64>) {
    let elements = &simulation.scene().bodies[0].elements;
    elements.material().visit(OneByOne(simulation, x)).unwrap()
}

struct OneByOne<'a>(&'a Simulation, &'a [f64]);

impl Visitor for OneByOne<'_> {
    type Output = (f64, Vec<f64>);

    fn visit<M: Material>(self, material: &M) -> Self::Output {
        let Self(simulation, x) = self;
        let body = &simulation.scene().bodies[0];
        let edges = |points: &[f64], [a, b, c]: [u32; 3]| {
            let at = |i: u32| Vector2::new(points[2 * i as usize], points[2 * i as usize + 1]);
            Matrix2::from_columns(&[at(b) - at(a), at(c) - at(a)])
        };
        let (mut energy, mut force) = (0.0, vec![0.0; x.len()]);
        for &triangle in body.mesh.triangles() {
            let rest = edges(&simulation.scene().rest, triangle);
            let inverse = rest.try_inverse().unwrap();
            let (f, area) = (edges(x, triangle) * inverse, 0.5 * rest.determinant());
            energy += material.energy(&f) * area;
            let forces = material.stress(&f) * inverse.transpose() * -area;
            let (one, two) = (forces.column(0).into_owned(), forces.column(1).into_owned());
            for (corner, corner_force) in triangle.into_iter().zip([-one - two, one, two]) {
                force[2 * corner as usize] += corner_force.x;
                force[2 * corner as usize + 1] += corner_force.y;
            }
        }
        (energy, force)
    }
}

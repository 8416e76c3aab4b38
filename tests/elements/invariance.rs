//! Nature has no favourite axis and no numbers: a scene that is turned, mirrored or numbered otherwise does the same.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{Random, level, models, rotation, simulation};
use gingerbread::{meshes::NoFiles, simulation::Simulation, state::State};
use nalgebra::{Matrix2, Vector2};

/// Symplectic Euler is the fastest scheme, and the implicit ones solve equations.
const SCHEMES: [&str; 3] = ["SymplecticEuler", "ImplicitEuler", "Bdf2"];
/// Short enough for round-off not to be amplified by anything but the scheme.
const STEPS: u64 = 100;

/// A point about which everything is turned.
const MIDDLE: Vector2<f64> = Vector2::new(0.5, 0.5);

/// One way of writing the same scene down.
#[derive(Clone)]
struct Telling {
    /// Turned, or mirrored and turned, about the middle.
    turn: Matrix2<f64>,
    /// Whether the rest shape is turned as well.
    rest: bool,
    /// The number of each vertex.
    number: Vec<usize>,
    /// Triangles by the vertices' first numbers.
    triangles: Vec<[usize; 3]>,
}

/// An irregular disk.
struct Shape {
    points: Vec<Vector2<f64>>,
    triangles: Vec<[usize; 3]>,
}

impl Shape {
    fn new() -> Self {
        let text =
            "(name: \"\", bodies: [(name: \"\", mesh: Disk(radius: 0.12, centre: (0.5, 0.5), rings: 3), mass: Total(1),
            material: (model: Corotated, young: 1, poisson: 0))])";
        let mesh = level(text).bodies[0].mesh.kind().build(&NoFiles).unwrap();
        let mut random = Random(11);
        let mut moved = || random.between(-0.008, 0.008);
        Self {
            points: mesh.points().iter().map(|[x, y]| Vector2::new(x + moved(), y + moved())).collect(),
            triangles: mesh.triangles().iter().map(|corners| corners.map(|corner| corner as usize)).collect(),
        }
    }

    /// As it is.
    fn plain(&self) -> Telling {
        let number = (0..self.points.len()).collect();
        Telling { turn: Matrix2::identity(), rest: true, number, triangles: self.triangles.clone() }
    }
}

/// What a scene is about, written down for one telling.
struct Experiment {
    model: &'static str,
    scheme: &'static str,
    contact: bool,
    friction: f64,
    /// How far the floor's normal leans over.
    floor: f64,
    /// Whether there are obstacles with corners beside the floor.
    corners: bool,
}

impl Telling {
    fn point(&self, point: Vector2<f64>) -> Vector2<f64> {
        MIDDLE + self.turn * (point - MIDDLE)
    }

    fn back(&self, point: &[f64]) -> Vector2<f64> {
        MIDDLE + self.turn.transpose() * (Vector2::new(point[0], point[1]) - MIDDLE)
    }

    /// The direction of a box whose side had this one [degrees].
    fn side(&self, degrees: f64) -> f64 {
        let side = self.turn * Vector2::new(degrees.to_radians().cos(), degrees.to_radians().sin());
        side.y.atan2(side.x).to_degrees()
    }

    /// Walls in the way of a disk that comes from the middle, to the right and downwards.
    fn walls(&self, of: &Experiment) -> String {
        let point = |x: f64, y: f64| written(self.point(Vector2::new(x, y)));
        let floor = written(self.turn * Vector2::new(of.floor, 1.0));
        let side = self.side(20.0);
        let solids = format!(
            "Ball(centre: {}, radius: 0.05, eps: 0.01), Cuboid(centre: {}, width: 0.05, height: 0.2, turn: {side:?}, eps: 0.01),
             Polygon(points: [{}, {}, {}], eps: 0.01)",
            point(0.4, 0.34),
            point(0.72, 0.5),
            point(0.6, 0.3),
            point(0.67, 0.33),
            point(0.58, 0.405)
        );
        let solids = if of.corners { solids } else { String::new() };
        let floors = format!("Plane(point: {}, normal: {floor}, eps: 0.01)", point(0.5, 0.35));
        format!("(effect: Walls(obstacles: [{floors}, {solids}]))")
    }

    /// The scene, with the disk stretched and sheared, spinning and on its way.
    fn built(&self, of: &Experiment, shape: &Shape) -> Simulation {
        let at_rest = |point: &Vector2<f64>| if self.rest { self.point(*point) } else { *point };
        let mut points = vec![Vector2::zeros(); shape.points.len()];
        let mut state = State { x: vec![0.0; 2 * points.len()], v: vec![0.0; 2 * points.len()], ..State::default() };
        let deformed = Matrix2::new(1.1, 0.15, -0.05, 0.95);
        for (point, &number) in shape.points.iter().zip(&self.number) {
            points[number] = at_rest(point);
            let from = point - MIDDLE;
            let bent = deformed * from + Vector2::new(2.0 * from.y * from.y, -from.x * from.y);
            let x = MIDDLE + self.turn * bent;
            let v = self.turn * (Vector2::new(0.9, -1.7) + Vector2::new(-3.0 * bent.y, 3.0 * bent.x));
            state.x[2 * number..][..2].copy_from_slice(x.as_slice());
            state.v[2 * number..][..2].copy_from_slice(v.as_slice());
        }
        let points: Vec<_> = points.into_iter().map(written).collect();
        let triangles: Vec<_> =
            self.triangles.iter().map(|corners| corners.map(|corner| self.number[corner])).collect();
        let triangles: Vec<_> = triangles.iter().map(|[a, b, c]| format!("({a}, {b}, {c})")).collect();
        let gravity = self.turn * Vector2::new(1.0, -9.0);
        // What is held cannot get away from what it is held by.
        let pins =
            if of.contact { String::new() } else { format!("Vertex({}), Vertex({})", self.number[0], self.number[9]) };
        let coats =
            format!("(effect: Friction(coefficient: {:?})), (effect: Restitution(coefficient: 0.4))", of.friction);
        let walls = if of.contact { format!("{}, {coats}", self.walls(of)) } else { String::new() };
        let mut run = simulation(&level(&format!(
            "(name: \"\", substeps: 20, integrator: {}(), bodies: [(name: \"\", mesh: Points(points: [{}], triangles: [{}]),
                material: (model: {}, young: 1000, poisson: 0.3), mass: Density(10), pins: [{pins}])],
              effects: [(effect: Gravity(down: {:?}, right: {:?})), (effect: Rayleigh(mass: 0.5, stiffness: 0.0003)), {walls}])",
            of.scheme,
            points.join(", "),
            triangles.join(", "),
            of.model,
            -gravity.y,
            gravity.x
        )));
        for (v, inverse) in state.v.iter_mut().zip(&run.scene().inverse_mass) {
            *v = if *inverse == 0.0 { 0.0 } else { *v };
        }
        run.set_state(state);
        run
    }

    /// Positions and velocities after a moment, turned and numbered back.
    fn run(&self, of: &Experiment, shape: &Shape) -> Vec<Vector2<f64>> {
        let mut run = self.built(of, shape);
        let mut touched = false;
        for _ in 0..STEPS {
            assert_eq!(run.advance(1, &mut || true), 1, "{:?}", run.fault());
            touched |= !run.state().anchors.is_empty();
        }
        assert_eq!(touched, of.contact);
        let x = self.number.iter().map(|number| self.back(&run.state().x[2 * number..][..2]));
        let v = self.number.iter().map(|number| {
            let v = &run.state().v[2 * number..][..2];
            self.turn.transpose() * Vector2::new(v[0], v[1])
        });
        x.chain(v).collect()
    }
}

fn written(point: Vector2<f64>) -> String {
    format!("({:?}, {:?})", point.x, point.y)
}

fn farthest(a: &[Vector2<f64>], b: &[Vector2<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

/// Round-off on the way: a force is off by 2e-16 of what its parts are, which below the stability limit, h²k < 4m, moves a
/// velocity by 4 x 2e-16 m/h in each of 100 steps: 1e-10 m/s. The direction of a surface is known to 1e-9, the round-off of the
/// least distance that it is told by (1e-7 of the obstacle's size): a wall that takes 2 m/s is off by so much of it, and the
/// stiff skin and the bodies bend with it.
const FREE: f64 = 1e-10;
const AT_WALLS: f64 = 5e-7;

/// The same experiment told in other ways gives the same answer, for every model and scheme, free and among walls, smooth and
/// rough. Every two of model, scheme and walls meet once.
fn assert_same(corners: bool, others: impl Fn(&Shape, u32) -> Vec<Telling>) {
    let shape = Shape::new();
    for (walls, (contact, friction)) in [(false, 0.0), (true, 0.0), (true, 0.3)].into_iter().enumerate() {
        for (number, scheme) in SCHEMES.into_iter().enumerate() {
            let models = models().zip([0.0, 0.1].into_iter().cycle()).skip((walls + number) % 3).step_by(3);
            for (model, floor) in models {
                let of = Experiment { model, scheme, contact, friction, floor, corners };
                let plain = shape.plain().run(&of, &shape);
                for other in others(&shape, number as u32) {
                    let error = farthest(&plain, &other.run(&of, &shape));
                    let tolerance = if contact { AT_WALLS } else { FREE };
                    assert!(
                        error < tolerance,
                        "{scheme} {model} walls {contact} mu {friction}: {error:e} after {}",
                        other.turn
                    );
                }
            }
        }
    }
}

/// Angles all the way round, with and beside the axes [rad].
fn angles(of: u32) -> impl Iterator<Item = f64> {
    (0..6).map(move |turn| f64::from(90 * (turn % 4) + 37 * (turn / 4) + 11 * of * (turn % 3)).to_radians())
}

#[test]
fn a_scene_turned_by_any_angle_does_the_same() {
    assert_same(true, |shape, of| angles(of).map(|angle| Telling { turn: rotation(angle), ..shape.plain() }).collect());
}

#[test]
fn a_body_turned_away_from_its_rest_shape_feels_nothing_of_it() {
    assert_same(true, |shape, of| {
        angles(of).map(|angle| Telling { turn: rotation(angle), rest: false, ..shape.plain() }).collect()
    });
}

#[test]
fn a_mirrored_scene_does_the_mirrored_thing() {
    let mirror = Matrix2::new(-1.0, 0.0, 0.0, 1.0);
    assert_same(true, |shape, of| {
        angles(of).map(|angle| Telling { turn: rotation(angle) * mirror, ..shape.plain() }).collect()
    });
}

/// Where a corner presses on two edges at once they answer one after the other, in the order of the triangles: what obstacles
/// with corners do depends on it a little.
#[test]
fn it_does_not_matter_how_vertices_and_triangles_are_numbered() {
    assert_same(false, |shape, of| {
        let mut random = Random(u64::from(of));
        let mut shuffled = |count: usize| {
            let mut order: Vec<usize> = (0..count).collect();
            (1..count).for_each(|last| order.swap(last, random.between(0.0, last as f64 + 1.0) as usize));
            order
        };
        (0..3)
            .map(|_| {
                let (number, order) = (shuffled(shape.points.len()), shuffled(shape.triangles.len()));
                let turned = |at: usize| {
                    let mut corners = shape.triangles[at];
                    corners.rotate_left(at % 3);
                    corners
                };
                Telling { number, triangles: order.into_iter().map(turned).collect(), ..shape.plain() }
            })
            .collect()
    });
}

//! Random scenes of contact: bodies, or cloth in space, that meet each other, themselves and moving obstacles.

use super::random::{Draw, Variation};
use crate::{
    files::{self, FileError},
    level::Level,
    materials::Model,
};
use std::fmt::Write as _;

/// Bodies, at most.
const MOST: u32 = 4;

/// Lengths and speeds that a scene has in common, so that its parts meet within the steps of a run.
#[derive(Clone, Copy)]
struct Sizes {
    /// Greatest radius of a body \[m\].
    radius: f64,
    /// Greatest speed \[m/s\].
    speed: f64,
    /// Distance of neighbours at the start \[m\].
    distance: f64,
}

/// A scene in the level format: sizes, speeds up to 100 m/s, stiffness, density, skin, friction, step length and obstacles at random.
///
/// # Errors
/// If it is no level.
pub(super) fn scene<R: Iterator<Item = f64>>(model: Model, draw: &mut Draw<R>) -> Result<Level, FileError> {
    let substeps = 1_u32 << draw.count(0, 7);
    let seconds = Variation::STEPS as f64 / (60.0 * f64::from(substeps));
    let radius = 0.11 * draw.factor(0.6);
    // At least a radius in the time of a run.
    let speed = libm::pow(10.0, draw.between(-1.0, 2.0)).max(1.5 * radius / seconds);
    let distance = if draw.chance(0.1) { radius } else { 2.1 * radius + draw.between(0.0, 0.3) * speed * seconds };
    let sizes = Sizes { radius, speed, distance };
    let in_space = draw.chance(0.25);
    let parts = if in_space { membranes(sizes, model, draw) } else { bodies(sizes, model, draw) };
    let mut text = format!("(name: \"Random contact\", mode: Collide, substeps: {substeps}, {parts}, effects: [");
    if draw.chance(0.5) {
        text += "(effect: Gravity(down: 9.81)), ";
    }
    if draw.chance(0.5) {
        let stiffness = 1e-4 * draw.factor(1.0);
        // Writing to a string cannot fail.
        let _ = write!(text, "(effect: Rayleigh(mass: 0.1, stiffness: {stiffness})), ");
    }
    let (modulus, thickness) = (10.0 * draw.factor(1.0), 0.22 * draw.factor(0.65));
    let dissipation = if draw.chance(0.5) { draw.between(0.0, 2.0) } else { 0.0 };
    let _ = write!(
        text,
        "(effect: Contact(modulus: {modulus}, thickness: {thickness}, speed: {}, dissipation: {dissipation})), ",
        draw.between(0.0, speed),
    );
    if draw.chance(0.5) {
        let _ = write!(text, "(effect: Friction(coefficient: {})), ", draw.between(0.0, 1.5));
    }
    let obstacles = obstacles(sizes, in_space, draw);
    let _ = write!(text, "(effect: Walls(obstacles: [{obstacles}]))])");
    files::parse(&text, "random scene of contact")
}

/// Disks, rectangles and stars in the places of a grid, or over each other, that fly towards the middle.
fn bodies<R: Iterator<Item = f64>>(
    Sizes { radius, speed, distance }: Sizes,
    model: Model,
    draw: &mut Draw<R>,
) -> String {
    let mut text = "bodies: [".to_owned();
    for number in 0..draw.count(2, MOST) {
        let [x, y] = [number % 2, number / 2].map(|place| distance * (f64::from(place) - 0.5));
        let size = radius * draw.between(0.5, 1.0);
        let mesh = match draw.count(0, 2) {
            0 => format!("Disk(radius: {size}, rings: {}, centre: (0, 0))", draw.count(2, 5)),
            1 => {
                let (width, height) = (1.8 * size, 0.3 * size * draw.factor(0.4));
                let (corner, columns) = (format!("({}, {})", -0.5 * width, -0.5 * height), draw.count(3, 9));
                format!("Rectangle(width: {width}, height: {height}, columns: {columns}, rows: 3, corner: {corner})")
            }
            _ => star(size, draw),
        };
        let [to_x, to_y] = [x, y].map(|at| 0.5 * radius * draw.number() - at);
        let speed = speed * draw.between(0.1, 1.0) / libm::hypot(to_x, to_y).max(1e-6);
        let _ = write!(
            text,
            "(name: \"{number}\", mesh: {mesh}, place: (turn: {}, offset: ({x}, {y})), material: {}, mass: Density({}), \
             velocity: ({}, {}), spin: {}), ",
            180.0 * draw.number(),
            material(model, draw),
            300.0 * draw.factor(1.5),
            speed * to_x,
            speed * to_y,
            if draw.chance(0.3) { 50.0 * draw.number() } else { 0.0 },
        );
    }
    text + "]"
}

/// Outline with arms, which can touch each other.
fn star<R: Iterator<Item = f64>>(size: f64, draw: &mut Draw<R>) -> String {
    let arms = draw.count(3, 6);
    let mut text = "Outline(points: [".to_owned();
    for corner in 0..2 * arms {
        let radius = if corner % 2 == 0 { size * draw.between(0.7, 1.0) } else { size * draw.between(0.25, 0.5) };
        let angle = std::f64::consts::PI * f64::from(corner) / f64::from(arms);
        let _ = write!(text, "({}, {}), ", radius * libm::cos(angle), radius * libm::sin(angle));
    }
    text + "], resolution: 120)"
}

/// One or two sheets of cloth. The lower one flies up or, alone, down to the floor.
fn membranes<R: Iterator<Item = f64>>(
    Sizes { radius, speed, distance }: Sizes,
    model: Model,
    draw: &mut Draw<R>,
) -> String {
    let mut text = "membranes: [".to_owned();
    let count = draw.count(1, 2);
    for number in 0..count {
        let size = 4.0 * radius * draw.between(0.5, 1.0);
        let corner = format!("({0}, {0})", -0.5 * size);
        let (way, turn) = (if number + 1 < count { 1.0 } else { -1.0 }, 40.0 / f64::from(count));
        let _ = write!(
            text,
            "(name: \"{number}\", mesh: Rectangle(width: {size}, height: {size}, columns: {}, rows: {}, corner: {corner}), \
             material: {}, thickness: {}, mass: Density({}), space: (turn: ({}, {}, 0), offset: (0, {}, 0), \
             velocity: ({}, {}, 0))), ",
            draw.count(2, 7),
            draw.count(2, 7),
            material(model, draw),
            2e-3 * size * draw.factor(0.5),
            300.0 * draw.factor(0.5),
            90.0 + turn * draw.number(),
            180.0 * draw.number(),
            distance * f64::from(number),
            0.1 * speed * draw.number(),
            way * speed * draw.between(0.1, 1.0),
        );
    }
    text + "]"
}

fn material<R: Iterator<Item = f64>>(model: Model, draw: &mut Draw<R>) -> String {
    let (young, poisson) = (1e5 * draw.factor(2.0), draw.between(0.0, 0.49));
    format!("(model: {model:?}, young: {young}, poisson: {poisson}, plane: Stress)")
}

/// A floor, and up to two other obstacles, most of which move.
fn obstacles<R: Iterator<Item = f64>>(sizes: Sizes, in_space: bool, draw: &mut Draw<R>) -> String {
    let Sizes { radius, speed, distance } = sizes;
    let floor = if in_space { -distance } else { -distance - 2.0 * radius };
    let mut text = if in_space {
        format!("HalfSpace(point: (0, {floor}, 0), normal: (0, 1, 0), eps: {}), ", 0.05 * radius)
    } else {
        format!("Plane(point: (0, {floor}), normal: (0, 1), eps: {}), ", 0.05 * radius)
    };
    for _ in 0..draw.count(0, 2) {
        let angle = std::f64::consts::PI * draw.number();
        let way = [libm::cos(angle), libm::sin(angle)];
        let [x, y] = way.map(|way| way * (distance + 2.0 * radius) * draw.between(0.8, 1.2));
        let obstacle = obstacle([x, y], radius, in_space, draw);
        let speed = speed * draw.between(0.1, 1.0);
        let motion = match draw.count(0, 3) {
            0 => format!("Slide(velocity: ({}, {}))", -speed * way[0], -speed * way[1]),
            1 => {
                let period = 6.0 * libm::hypot(x, y) / speed;
                format!("Swing(way: ({}, {}), period: {period})", -0.8 * x, -0.8 * y)
            }
            2 => format!("Turn(about: (0, 0), spin: {})", speed / libm::hypot(x, y) * draw.number().signum()),
            _ => String::new(),
        };
        if motion.is_empty() {
            let _ = write!(text, "{obstacle}, ");
        } else {
            let _ = write!(text, "Moving(obstacle: {obstacle}, motions: [{motion}]), ");
        }
    }
    text
}

/// One about a place.
fn obstacle<R: Iterator<Item = f64>>([x, y]: [f64; 2], radius: f64, in_space: bool, draw: &mut Draw<R>) -> String {
    let (size, eps) = (radius * draw.factor(0.4), 0.05 * radius);
    match (in_space, draw.count(0, 2)) {
        (false, 0) => format!("Ball(centre: ({x}, {y}), radius: {size}, eps: {eps})"),
        (false, 1) => {
            let (height, turn) = (size * draw.factor(0.8), 90.0 * draw.number());
            format!("Cuboid(centre: ({x}, {y}), width: {size}, height: {height}, turn: {turn}, eps: {eps})")
        }
        (false, _) => {
            let corners = [[-1.0, -1.0], [1.0, -1.0], [0.1, 1.0], [0.0, -0.5]];
            let corners = corners.map(|[a, b]| format!("({}, {})", x + size * a, y + size * b));
            format!("Polygon(points: [{}], eps: {eps})", corners.join(", "))
        }
        (true, 0) => format!("Sphere(centre: ({x}, {y}, 0), radius: {size}, eps: {eps})"),
        (true, 1) => {
            format!("Block(centre: ({x}, {y}, 0), width: {size}, height: {size}, depth: {}, eps: {eps})", 4.0 * radius)
        }
        (true, _) => format!("Cylinder(centre: ({x}, {y}, 0), radius: {size}, height: {size}, eps: {eps})"),
    }
}

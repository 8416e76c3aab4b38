//! Axes of each vertex: normal and tangent of the wall that constrains it.

/// The first of a vertex's own axes, a unit vector; the second is a quarter turn from it. Two numbers a vertex, flat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Axis([f64; 2]);

/// A change of position or velocity below this share of it is round-off, and says nothing about a direction.
const ROUND_OFF: f64 = 1e-12;
/// How much two directions may differ and still count as one.
const SAME: f64 = 1e-6;

impl Axis {
    /// Those of the world.
    const WORLD: Self = Self([1.0, 0.0]);

    pub fn of(axes: &[f64], vertex: usize) -> Self {
        Self(pair(axes, vertex))
    }

    /// Whether they are those of the world.
    pub fn is_world(self) -> bool {
        self == Self::WORLD
    }

    /// A vector along these axes, from one along those of the world.
    pub fn into_own(self, [x, y]: [f64; 2]) -> [f64; 2] {
        let Self([c, s]) = self;
        if self.is_world() { [x, y] } else { [c * x + s * y, c * y - s * x] }
    }

    /// And back.
    pub fn out_of_own(self, [x, y]: [f64; 2]) -> [f64; 2] {
        let Self([c, s]) = self;
        if self.is_world() { [x, y] } else { [c * x - s * y, s * x + c * y] }
    }

    /// `one` along the axes that are held, `other` along the rest.
    pub fn mix(self, constrained: [bool; 2], one: [f64; 2], other: [f64; 2]) -> [f64; 2] {
        match constrained {
            [true, true] => one,
            [false, false] => other,
            _ => {
                let (one, other) = (self.into_own(one), self.into_own(other));
                self.out_of_own([0, 1].map(|k| if constrained[k] { one[k] } else { other[k] }))
            }
        }
    }
}

/// The two numbers of a vertex.
pub(super) fn pair(values: &[f64], vertex: usize) -> [f64; 2] {
    [values[2 * vertex], values[2 * vertex + 1]]
}

pub(super) fn put(values: &mut [f64], vertex: usize, value: [f64; 2]) {
    values[2 * vertex..][..2].copy_from_slice(&value);
}

pub(super) fn less(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

pub(super) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn length(a: [f64; 2]) -> f64 {
    dot(a, a).sqrt()
}

/// Gives every vertex the axes of the world.
pub(super) fn reset_axes(axes: &mut Vec<f64>, numbers: usize) {
    axes.clear();
    axes.extend(Axis::WORLD.0.into_iter().cycle().take(numbers));
}

/// Gives one vertex the axes of the world.
pub(super) fn reset_axis(axes: &mut [f64], vertex: usize) {
    put(axes, vertex, Axis::WORLD.0);
}

/// Takes flat vectors along the world's axes to each vertex's own.
pub(super) fn turn(axes: &[f64], values: &mut [f64]) {
    for (vertex, value) in values.chunks_exact_mut(2).enumerate() {
        value.copy_from_slice(&Axis::of(axes, vertex).into_own([value[0], value[1]]));
    }
}

/// Holds a vertex where constraints changed the end of a step: across a single `smooth` wall, or wholly. `numbers` are the
/// axes, 1/mass (zero where held) and accelerations, `end` positions and velocities, `predicted` what velocities and then
/// positions were before. Returns whether more is held than before.
pub(super) fn add_constraint(
    vertex: usize,
    (axes, inverse, z): (&mut [f64], &mut [f64], &mut [f64]),
    [x, v]: [&[f64]; 2],
    predicted: &[f64],
    smooth: bool,
) -> bool {
    let (x, v) = (pair(x, vertex), pair(v, vertex));
    let (predicted_v, predicted_x) = (pair(predicted, vertex), pair(&predicted[predicted.len() / 2..], vertex));
    let touched = [0, 1].map(|k| (x[k] != predicted_x[k] || v[k] != predicted_v[k]) && x[k].is_finite());
    let movable = [0, 1].map(|k| inverse[2 * vertex + k] != 0.0);
    let axis = Axis::of(axes, vertex);
    let mut added = [0, 1].map(|k| movable[k] && touched[k]);
    if !axis.is_world() {
        // Held across one wall already: what counts is a push along it.
        let pushed = |to: [f64; 2], from: [f64; 2]| {
            let change = less(to, from);
            axis.into_own(change)[1].abs() > SAME * length(change) + ROUND_OFF * length(from)
        };
        added = [false, movable[1] && (pushed(x, predicted_x) || pushed(v, predicted_v))];
    } else if smooth
        && added == [true; 2]
        && let Some(normal) = direction([x, predicted_x], [v, predicted_v])
    {
        put(axes, vertex, normal);
        put(z, vertex, Axis(normal).into_own(pair(z, vertex)));
        added = [true, false];
    }
    for k in (0..2).filter(|k| added[*k]) {
        inverse[2 * vertex + k] = 0.0;
    }
    added != [false; 2]
}

/// The one direction of a change of position and of velocity, each given as after and before; `None` if there are two, or
/// none that can be told.
fn direction([x, predicted_x]: [[f64; 2]; 2], [v, predicted_v]: [[f64; 2]; 2]) -> Option<[f64; 2]> {
    let told = |to: [f64; 2], from: [f64; 2]| {
        let (change, size) = (less(to, from), length(less(to, from)));
        (size > 1e3 * ROUND_OFF * length(from)).then(|| change.map(|change| change / size))
    };
    match (told(v, predicted_v), told(x, predicted_x)) {
        (Some(one), Some(other)) => ((one[0] * other[1] - one[1] * other[0]).abs() < SAME).then_some(one),
        (one, other) => one.or(other),
    }
}

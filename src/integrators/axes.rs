//! Local axes of each vertex: normal and tangent of the wall that constrains it.

/// The first local axis of a vertex, a unit vector; the second is rotated by 90°. Flat: two numbers a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Axis([f64; 2]);

/// A change of position or velocity below this fraction is round-off and has no direction.
const ROUND_OFF: f64 = 1e-12;
/// Greatest difference of two directions that count as equal.
const SAME: f64 = 1e-6;

impl Axis {
    /// The axes of the world.
    const WORLD: Self = Self([1.0, 0.0]);

    pub fn of(axes: &[f64], vertex: usize) -> Self {
        Self(pair(axes, vertex))
    }

    /// Whether they are the axes of the world.
    pub fn is_world(self) -> bool {
        self == Self::WORLD
    }

    /// Components of a vector along the local axes.
    pub fn into_own(self, [x, y]: [f64; 2]) -> [f64; 2] {
        let Self([c, s]) = self;
        if self.is_world() { [x, y] } else { [c * x + s * y, c * y - s * x] }
    }

    /// Inverse of [`Self::into_own`].
    pub fn out_of_own(self, [x, y]: [f64; 2]) -> [f64; 2] {
        let Self([c, s]) = self;
        if self.is_world() { [x, y] } else { [c * x - s * y, s * x + c * y] }
    }

    /// `one` along the constrained axes, `other` along the free ones.
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

/// Resets all vertices to the axes of the world.
pub(super) fn reset_axes(axes: &mut Vec<f64>, numbers: usize) {
    axes.clear();
    axes.extend(Axis::WORLD.0.into_iter().cycle().take(numbers));
}

/// Resets one vertex to the axes of the world.
pub(super) fn reset_axis(axes: &mut [f64], vertex: usize) {
    put(axes, vertex, Axis::WORLD.0);
}

/// Transforms flat vectors to the local axes of each vertex.
pub(super) fn turn(axes: &[f64], values: &mut [f64]) {
    for (vertex, value) in values.chunks_exact_mut(2).enumerate() {
        value.copy_from_slice(&Axis::of(axes, vertex).into_own([value[0], value[1]]));
    }
}

/// Constrains a vertex whose end of step constraints have changed: along the normal of a single `smooth` wall, or in
/// both coordinates. `numbers` are the axes, 1/mass (zero where constrained) and accelerations, `end` positions and
/// velocities, `predicted` the velocities and then positions before. Returns whether a constraint was added.
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
        // Constrained along one normal already: only a change along the tangent adds a constraint.
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

/// The common direction of the changes of position and velocity, each given as after and before; `None` if they differ
/// or are round-off.
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

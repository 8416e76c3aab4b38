//! A contact at one moment, as a weighted stencil of vertices, and what follows from it alike for every kind of contact.

use super::{
    Anchor, ContactName, Potential,
    friction::{limited, size},
};
use crate::{
    obstacles::Rigid,
    solvers::{Tangent, Weights},
};
use nalgebra::SMatrix;

/// Something that touches at one moment: up to N vertices with D coordinates and weights w, so that the gap is
/// `g = n . sum(w x) - g0` with the unit normal n and a constant g0.
///
/// Its energy per area is that of the [`Potential`] phi at g, and the force on a vertex `A p (1 - c dg/dt) w n - phi dA/dx` less the
/// friction `A q s`, with the traction q and the dissipation coefficient c. The slip is how far the place of the contact has moved along the surface since its anchor; it
/// has one component in the plane and two in space. s is its derivative by the position of the vertex. So forces between bodies leave linear and angular momentum as they are, because
/// neither the gap nor the slip changes where all vertices move rigidly.
#[derive(Clone, Copy, Debug)]
pub struct Touch<const D: usize = 2, const T: usize = 1, const N: usize = 3> {
    /// Name.
    pub name: ContactName,
    /// Its vertices, by their numbers in the scene: one that touches, and those of what it touches, such as the ends of an edge.
    pub vertices: [u32; N],
    /// Which of them take part, as an obstacle may take the place of the first or of the edge.
    pub members: Members,
    /// w.
    pub weights: [f64; N],
    /// n.
    pub normal: [f64; D],
    /// s of each vertex, by directions.
    pub slips: [[[f64; D]; T]; N],
    /// Area \[m²\], in the plane at a thickness of the sheet of 1 m; negative where the contact is subtracted because its neighbours count
    /// it twice.
    pub area: f64,
    /// Derivatives of the area by the positions of the vertices \[m\], where it depends on them.
    pub area_gradient: Option<[[f64; D]; N]>,
    /// How the surfaces act on each other.
    pub parameters: ContactParameters,
    /// g \[m\].
    pub gap: f64,
    /// Distance of the nearest points of both \[m\].
    pub distance: f64,
    /// dg/dt [m/s]: negative where the surfaces approach each other.
    pub approach: f64,
    /// Rate of the slip [m/s].
    pub sliding: [f64; T],
    /// Time over which the pressure is the mean, centred at this moment \[s\]; zero for the pressure at this moment.
    pub span: f64,
    /// Velocity of an obstacle at the contact [m/s].
    pub obstacle_velocity: [f64; D],
    /// How the gap curves.
    pub curvature: Curvature,
    /// Where along the surface it is.
    pub place: Place<D>,
    /// Slip since the anchor, and initial penetration, which the gap contains \[m\]; `None` for a new contact.
    pub memory: Option<([f64; T], f64)>,
    /// The anchor that these come from.
    pub kept: Option<Anchor>,
    /// Whether it leaves an anchor. What is subtracted, or has the same name as another contact, leaves none.
    pub keeps_anchor: bool,
}

/// How two surfaces act on each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactParameters {
    /// Potential of the skin.
    pub potential: Potential,
    /// c [s/m].
    pub dissipation: f64,
    /// mu.
    pub friction: f64,
    /// Speed at which the initial penetration decreases [m/s].
    pub depenetration_speed: f64,
}

/// Which vertices of a contact take part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Members {
    /// A vertex that touches an obstacle.
    Vertex,
    /// All but the first, whose place an obstacle takes: the ends of an edge that touches a corner of it, or the corners of a triangle that touches it in a
    /// point.
    Surface,
    /// All of them: a vertex and the ends of an edge, a vertex and the corners of a triangle, or the ends of two edges.
    Both,
}

/// Second derivative of a gap by the positions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Curvature {
    /// Zero, or omitted.
    Flat,
    /// Distance of a point from a line through an edge of this length \[m\].
    Edge(f64),
    /// Distance of two points.
    Points,
}

/// Where along a surface a contact is.
#[derive(Clone, Copy, Debug)]
pub enum Place<const D: usize = 2> {
    /// On an obstacle: how that is placed, and the position of the vertex \[m\].
    Obstacle(Rigid<D>, [f64; D]),
    /// At a length along a loop of a boundary at rest, of this length around \[m\]; and length now over length at rest.
    Loop {
        /// Length along the loop.
        along: f64,
        /// Length around.
        around: f64,
        /// Length now over length at rest.
        stretch: f64,
    },
    /// On cloth, by the position at rest.
    Cloth(ClothPlace),
}

/// Where on cloth a contact is.
#[derive(Clone, Copy, Debug, Default)]
pub struct ClothPlace {
    /// Position at rest \[m\], or any coordinates of the contact on its surfaces.
    pub point: [f64; 3],
    /// Derivative of each component of the slip by these coordinates.
    pub to: [[f64; 3]; 2],
    /// Derivative of these coordinates by each component of the slip.
    pub back: [[f64; 3]; 2],
}

impl ClothPlace {
    /// Makes `back` the inverse of `to` along the surface, unless the determinant is less than a tenth.
    pub(super) fn invert(&mut self) {
        /// Least determinant, which is one where the surface is level.
        const LEAST: f64 = 0.1;
        let [a, b] = self.to.map(|to| self.back.map(|back| dot(to, back)));
        let determinant = a[0] * b[1] - a[1] * b[0];
        if determinant > LEAST {
            let [one, other] = self.back;
            let along = |u: f64, w: f64| std::array::from_fn(|axis| (u * one[axis] + w * other[axis]) / determinant);
            self.back = [along(b[1], -b[0]), along(-a[1], a[0])];
        }
    }
}

/// Change of an edge, as a difference of its two ends, by vertex: those of [`Touch`] with an edge are the vertex and the ends.
const EDGE: [f64; 3] = [0.0, -1.0, 1.0];

impl<const D: usize, const T: usize, const N: usize> Touch<D, T, N> {
    /// Places in the stencil of the vertices that take part.
    pub const fn range(&self) -> std::ops::Range<usize> {
        match self.members {
            Members::Vertex => 0..1,
            Members::Surface => 1..N,
            Members::Both => 0..N,
        }
    }

    /// Adds the velocities of its vertices [m/s].
    pub fn add_velocities(&mut self, v: &[f64]) {
        for i in self.range() {
            let v = coordinates(v, self.vertices[i]);
            self.approach += self.weights[i] * dot(self.normal, v);
            for (sliding, slip) in self.sliding.iter_mut().zip(self.slips[i]) {
                *sliding += dot(slip, v);
            }
        }
    }

    /// Adds the velocity of an obstacle [m/s].
    pub fn add_obstacle(&mut self, velocity: [f64; D]) {
        let sign = if self.members == Members::Vertex { -1.0 } else { self.weights[0] };
        self.approach += sign * dot(self.normal, velocity);
        for (sliding, slip) in self.sliding.iter_mut().zip(self.slips[0]) {
            *sliding += sign * dot(slip, velocity);
        }
        self.obstacle_velocity = velocity;
    }

    /// p \[Pa\].
    pub fn pressure(&self) -> f64 {
        if self.span == 0.0 {
            return self.parameters.potential.pressure(self.gap);
        }
        self.mean_pressure()[0]
    }

    fn mean_pressure(&self) -> [f64; 3] {
        self.parameters.potential.mean_pressure(self.gap, self.span * self.approach)
    }

    /// Factor of the pressure by dissipation (Hunt and Crossley, 1975): `1 - c dg/dt`, never negative.
    fn damped(&self) -> f64 {
        (1.0 - self.parameters.dissipation * self.approach).max(0.0)
    }

    /// Greatest friction \[Pa\].
    fn limit(&self) -> f64 {
        self.parameters.friction * self.pressure() * self.damped()
    }

    /// Slip since the anchor \[m\]: a new contact has not slipped yet.
    fn slip(&self) -> [f64; T] {
        self.memory.map_or([0.0; T], |(u, _)| u)
    }

    /// Traction of friction, q \[Pa\].
    fn traction(&self) -> [f64; T] {
        limited(self.sticking(), self.limit())
    }

    /// q of a contact that sticks \[Pa\].
    fn sticking(&self) -> [f64; T] {
        let rate = self.parameters.dissipation * self.pressure();
        let (elastic, slip) = (self.parameters.potential.tangential_stiffness(), self.slip());
        std::array::from_fn(|way| elastic * slip[way] + rate * self.sliding[way])
    }

    /// Whether the surfaces have crossed.
    pub(super) fn is_inside(&self) -> bool {
        self.gap < self.memory.map_or(0.0, |(_, penetration)| penetration)
    }

    /// Energy \[J\].
    pub fn energy(&self) -> f64 {
        self.area * self.parameters.potential.energy(self.gap) + self.friction_energy()
    }

    /// Energy of the spring of friction \[J\].
    pub fn friction_energy(&self) -> f64 {
        let of = |(u, _): ([f64; T], f64)| self.parameters.potential.friction_energy(u, self.limit());
        self.area * self.memory.map_or(0.0, of)
    }

    /// Force \[N\] on each vertex.
    pub fn forces(&self) -> impl Iterator<Item = (usize, [f64; D])> {
        let normal = self.area * self.pressure() * self.damped();
        let slip = self.traction().map(|traction| -self.area * traction);
        self.range().map(move |i| {
            let n = normal * self.weights[i];
            let along =
                |axis: usize| (0..T).fold(n * self.normal[axis], |sum, way| sum + slip[way] * self.slips[i][way][axis]);
            let mut force = std::array::from_fn(along);
            if let Some(gradient) = self.area_gradient {
                let energy = self.parameters.potential.energy(self.gap);
                force.iter_mut().zip(gradient[i]).for_each(|(force, slope)| *force -= energy * slope);
            }
            (self.vertices[i] as usize, force)
        })
    }

    /// Power of a moving obstacle \[W\].
    pub fn power(&self) -> f64 {
        self.forces().map(|(_, force)| dot(force, self.obstacle_velocity)).sum()
    }

    /// Power taken from the motion \[W\]: by friction, a part of which its spring stores, and by the pressure beyond its energy.
    pub fn taken_power(&self) -> f64 {
        let normal = self.pressure() * self.approach * (1.0 - self.damped());
        self.area * (normal + dot(self.traction(), self.sliding))
    }

    /// Stiffness and damping of the force along the normal [N/m, N s/m].
    fn normal_stiffness(&self) -> [f64; 2] {
        let (area, damped, pressure) = (self.area, self.damped(), self.pressure());
        let damping = if damped > 0.0 { area * self.parameters.dissipation * pressure } else { 0.0 };
        if self.span == 0.0 {
            [area * damped * self.parameters.potential.stiffness(self.gap), damping]
        } else {
            let [_, by_gap, by_change] = self.mean_pressure();
            [-area * damped * by_gap, damping - area * damped * self.span * by_change]
        }
    }

    /// Stiffness and damping of friction [N/m, N s/m], and the direction in which it slides and has none. Across that direction the
    /// friction turns at a constant size. The change
    /// of the greatest friction with the pressure is omitted: it is not symmetric.
    fn slip_stiffness(&self) -> ([f64; 2], Option<[f64; T]>) {
        let (wanted, limit) = (self.sticking(), self.limit());
        let length = size(wanted);
        let sticks = length < limit;
        if !sticks && T == 1 {
            return ([0.0; 2], None);
        }
        let share = if sticks { 1.0 } else { limit / length.max(f64::MIN_POSITIVE) };
        // A new contact has no anchor to move from.
        let elastic = if self.memory.is_some() { self.parameters.potential.tangential_stiffness() } else { 0.0 };
        let both = [self.area * elastic, self.area * self.parameters.dissipation * self.pressure()];
        let direction = (!sticks).then(|| wanted.map(|wanted| wanted / length.max(f64::MIN_POSITIVE)));
        (both.map(|one| share * one), direction)
    }

    /// Greatest damping of the force [N s/m].
    pub fn damping(&self) -> f64 {
        let ([_, normal], ([_, slip], _)) = (self.normal_stiffness(), self.slip_stiffness());
        normal.max(slip)
    }

    /// Weighted stiffness and damping, ready to be taken apart into blocks. Also the exact tangent omits the change of the limit of friction, the curvature of
    /// contacts in space, and the second derivative of the area of two edges.
    pub fn linearised(&self, weights: Weights) -> Linearised<'_, D, T, N> {
        let weighted = |[stiffness, damping]: [f64; 2]| weights.position * stiffness + weights.velocity * damping;
        let (slip, slides) = self.slip_stiffness();
        let (normal, slip) = (weighted(self.normal_stiffness()), weighted(slip));
        let force = weights.position * self.area * self.pressure() * self.damped();
        match weights.tangent {
            Tangent::Exact => Linearised { touch: self, normal, slip, slides, force },
            // Terms of negative area and the curvature may be indefinite.
            _ => Linearised { touch: self, normal: normal.max(0.0), slip: slip.max(0.0), slides, force: 0.0 },
        }
    }

    /// Memory of the contact after a step of length h \[s\]: the anchor is dragged, and the initial penetration decreases, as long
    /// as the surfaces are nearer than a part of the thickness of the skin. Returns also that decrease \[m\].
    ///
    /// Steps never lead to a new contact at a negative gap. One that is found there is of surfaces that began inside each other, where
    /// another edge has become the nearest: it begins without a force.
    pub fn dragged(&self, h: f64) -> (Anchor, f64) {
        /// That part.
        const LEFT: f64 = 0.25;
        if self.is_new_inside() {
            return (self.begun(), 0.0);
        }
        let before = self.memory.map_or(0.0, |(_, penetration)| penetration);
        let missing = LEFT * self.parameters.potential.thickness - (self.gap - before);
        let decrease = (h * self.parameters.depenetration_speed).min(missing).min(before).max(0.0);
        (self.anchor(self.parameters.potential.dragged(self.slip(), self.limit()), before - decrease), decrease)
    }

    /// Energy that a decrease of its initial penetration \[m\] supplies \[J\].
    pub(super) fn supplied(&self, decrease: f64) -> f64 {
        let potential = self.parameters.potential;
        self.area * (potential.energy(self.gap - decrease) - potential.energy(self.gap))
    }

    /// Whether it has no memory at a negative gap.
    const fn is_new_inside(&self) -> bool {
        self.memory.is_none() && self.gap < 0.0
    }

    /// Memory of the contact in a state that no step led to: without memory it begins without a force. So does one whose obstacle was moved so far that
    /// the gap is negative in spite of its memory.
    pub fn begun(&self) -> Anchor {
        let penetration = self.memory.map_or(0.0, |(_, penetration)| penetration);
        let missing = self.parameters.potential.thickness - (self.gap - penetration);
        self.kept
            .filter(|kept| kept.contact == self.name && self.gap >= 0.0)
            .unwrap_or_else(|| self.anchor([0.0; T], missing))
    }

    /// Memory of the contact with a slip since the anchor and an initial penetration \[m\].
    fn anchor(&self, u: [f64; T], penetration: f64) -> Anchor {
        let mut point = [0.0; 3];
        match self.place {
            Place::Obstacle(at, x) => {
                let slipped = |axis: usize| (0..T).fold(x[axis], |x, way| x - u[way] * self.slips[0][way][axis]);
                point[..D].copy_from_slice(&at.back(std::array::from_fn(slipped)));
            }
            Place::Loop { along, stretch, .. } => point[0] = along - u[0] / stretch,
            Place::Cloth(ClothPlace { point: now, back, .. }) => {
                let slipped = |axis: usize| u.iter().zip(back).fold(now[axis], |at, (u, back)| at - u * back[axis]);
                point = std::array::from_fn(slipped);
            }
        }
        Anchor { contact: self.name, point, penetration }
    }

    /// Slip since an anchor \[m\].
    fn slip_since(&self, anchor: Anchor) -> [f64; T] {
        match self.place {
            Place::Obstacle(at, x) => {
                let from = at.point(std::array::from_fn(|axis| anchor.point[axis]));
                let gone = std::array::from_fn(|axis| x[axis] - from[axis]);
                self.slips[0].map(|slip| dot(gone, slip))
            }
            Place::Loop { along, around, stretch } => {
                let u = along - anchor.point[0];
                [stretch * (u - around * (u / around).round()); T]
            }
            Place::Cloth(ClothPlace { point, to, .. }) => {
                let gone: [f64; 3] = std::array::from_fn(|axis| point[axis] - anchor.point[axis]);
                std::array::from_fn(|way| dot(gone, to[way]))
            }
        }
    }

    /// Gives it an initial penetration \[m\] and no slip.
    pub(super) fn begin(&mut self, penetration: f64) {
        self.gap += penetration;
        self.memory = Some(([0.0; T], penetration));
    }

    /// Takes over the memory of an anchor.
    pub fn remember(&mut self, anchor: Anchor) {
        self.gap += anchor.penetration;
        (self.memory, self.kept) = (Some((self.slip_since(anchor), anchor.penetration)), Some(anchor));
    }

    /// Takes over the memory of a contact with a boundary. The anchors are those of this contact, and of it at the edges before
    /// and after: a contact that has none continues those of its neighbours, their mean where both have one.
    pub fn remember_along(&mut self, [own, before, after]: [Option<Anchor>; 3]) {
        if let (None, Some(one), Some(other)) = (own, before, after) {
            let [one_slip, other_slip] = [one, other].map(|anchor| self.slip_since(anchor));
            let u = std::array::from_fn(|way| 0.5 * (one_slip[way] + other_slip[way]));
            let penetration = 0.5 * (one.penetration + other.penetration);
            self.gap += penetration;
            (self.memory, self.kept) = (Some((u, penetration)), Some(one));
        } else if let Some(anchor) = own.or(before).or(after) {
            self.remember(anchor);
        }
    }
}

/// Stiffness of a contact.
pub struct Linearised<'a, const D: usize = 2, const T: usize = 1, const N: usize = 3> {
    touch: &'a Touch<D, T, N>,
    normal: f64,
    slip: f64,
    /// Direction of the slip without stiffness.
    slides: Option<[f64; T]>,
    /// Force along the normal, which turns with it.
    force: f64,
}

impl<const D: usize, const T: usize, const N: usize> Linearised<'_, D, T, N> {
    /// Block of two of its vertices.
    ///
    /// With the direction t of an edge of length L, the distance D, d = (0, -1, 1) and q = w t, the second derivative of the distance from it is
    /// `-((d n) q' + q (d n)')/L - D (d n) (d n)'/L²`, and that of the distance of two points `q q'/D`: both follow from
    /// `dn = -t (n . d x)/L` for the edge and `dn = t (t . w x)/D` for the points, in the plane.
    pub fn block(&self, i: usize, j: usize) -> SMatrix<f64, D, D> {
        let Touch { weights: w, normal, slips, distance, .. } = self.touch;
        let outer = |a: [f64; D], b: [f64; D]| SMatrix::<f64, D, D>::from_fn(|row, column| a[row] * b[column]);
        let block = outer(*normal, *normal) * (self.normal * w[i] * w[j]);
        let block = (0..T).fold(block, |block, way| block + outer(slips[i][way], slips[j][way]) * self.slip);
        let block = self.slides.map_or(block, |direction| {
            let along = |of: [[f64; D]; T]| -> [f64; D] {
                std::array::from_fn(|axis| (0..T).fold(0.0, |sum, way| sum + direction[way] * of[way][axis]))
            };
            block - outer(along(slips[i]), along(slips[j])) * self.slip
        });
        let mut along = [0.0; D];
        (along[0], along[1]) = (-normal[1], normal[0]);
        match self.touch.curvature {
            Curvature::Flat => block,
            Curvature::Edge(length) => {
                let turned = outer(*normal, along) * (EDGE[i] * w[j]) + outer(along, *normal) * (w[i] * EDGE[j]);
                let curved =
                    turned / length + outer(*normal, *normal) * (distance * EDGE[i] * EDGE[j] / (length * length));
                block + curved * self.force
            }
            Curvature::Points => block - outer(along, along) * (self.force * w[i] * w[j] / distance),
        }
    }
}

/// Length of a vector: by a square root alone, which is exact everywhere and faster than a careful `hypot`; surfaces are neither
/// as small nor as large as its range.
pub(super) fn length<const D: usize>(vector: [f64; D]) -> f64 {
    dot(vector, vector).sqrt()
}

/// Scalar product of two vectors.
pub(super) fn dot<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    (1..D).fold(a[0] * b[0], |sum, axis| sum + a[axis] * b[axis])
}

/// The two numbers of a vertex in the plane.
pub(super) fn vector(values: &[f64], vertex: u32) -> [f64; 2] {
    coordinates(values, vertex)
}

/// The numbers of a vertex.
pub(super) fn coordinates<const D: usize>(values: &[f64], vertex: u32) -> [f64; D] {
    let at = D * vertex as usize;
    std::array::from_fn(|axis| values[at + axis])
}

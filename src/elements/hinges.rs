//! Bending of a membrane about the edges that two triangles share.

use super::{
    Membranes,
    frame::{Vector, cross, dot, minus, plus, times},
};
use crate::{
    materials::Lame,
    simd::{Jet, LANES, Lanes, Real, Wide},
};
use pulp::{Arch, Simd, WithSimd};
use std::collections::BTreeMap;

/// No hinge: an edge of the boundary.
const NONE: u32 = u32::MAX;

/// The inner edges of a membrane and the bending stiffness of its triangles.
///
/// With `theta_i` the angle by which the surface is bent at the edge i of a triangle, `l_i` the length of the edge at rest, `t_i` the vector across it of
/// the same length, and A the area, the curvature of the triangle is
///
/// `K = sum_i theta_i/(2 A l_i) t_i t_i'`
///
/// where the angle of a boundary edge is that of the least energy, as no moment acts there (E. Oñate and F. Zárate, *Rotation-free triangular plate and shell elements*, International Journal for
/// Numerical Methods in Engineering 47, 2000; E. Grinspun, Y. Gingold, J. Reisman and D. Zorin, *Computing discrete shape operators on
/// general meshes*, Computer Graphics Forum 25, 2006). Its energy is that of Kirchhoff's plate,
///
/// `W = D/2 A ((1 - nu) K : K + nu (tr K)²)`, `D = E h³/(12 (1 - nu²))`,
///
/// a quadratic form of its three angles. A cylinder has its exact energy on meshes of rows of cells with one diagonal each. On crossed diagonals single
/// triangles do not have the curvature of the surface, and a strip is 8 % too stiff. (The curvature of the quadratic surface with the same three angles is exact in
/// every triangle, but does not keep a constant moment in equilibrium: with alternating diagonals a strip would be three times too soft.) Energies of single
/// hinges, `k theta² |e|²/A` (E. Grinspun and others, *Discrete shells*, Symposium on Computer Animation 2003), have one constant for all
/// directions, and are three times too stiff along the rows of a grid if they are right on average.
#[derive(Debug)]
pub struct Hinges {
    /// Ends a and b of each inner edge, the third corner of the triangle on its left, and that of the one on its right.
    edges: Vec<[u32; 4]>,
    triangles: Vec<Plate>,
    set: Arch,
}

/// The points of eight hinges, one in each lane, or vectors at them.
type Block = [[Lanes; 3]; 4];

/// Number of blocks gathered at a time: enough for scalar stores to complete before they are read as SIMD vectors.
const RUN_BLOCKS: usize = 4;
const RUN: usize = RUN_BLOCKS * LANES;

/// Bending of one triangle.
#[derive(Clone, Copy, Debug)]
struct Plate {
    /// The hinges of its edges.
    hinges: [u32; 3],
    /// Second derivatives of its energy by their angles \[J\].
    stiffness: [[f64; 3]; 3],
    /// The vertices of its hinges, each once; NONE in place of missing ones.
    vertices: [u32; 6],
}

impl Plate {
    /// Lets the angles of boundary edges, about which nothing bends the triangle, be those of the least energy: the Schur complement of their entries.
    fn release(&mut self) {
        for free in (0..3).filter(|place| self.hinges[*place] == NONE) {
            let (row, own) = (self.stiffness[free], self.stiffness[free][free]);
            if own > 0.0 {
                self.stiffness =
                    std::array::from_fn(|i| std::array::from_fn(|j| self.stiffness[i][j] - row[i] * row[j] / own));
            }
        }
    }

    fn find_vertices(&mut self, hinges: &[[u32; 4]]) {
        let mut count = 0;
        for corner in self.hinges.iter().filter_map(|hinge| hinges.get(*hinge as usize)).flatten() {
            if !self.vertices[..count].contains(corner) {
                self.vertices[count] = *corner;
                count += 1;
            }
        }
    }

    /// Gradients of its angles by its vertices, from those of all hinges by their four.
    fn slopes(&self, hinges: &[[u32; 4]], x: &[f64]) -> [[Vector<f64>; 6]; 3] {
        let mut slopes = [[[0.0; 3]; 6]; 3];
        for (slopes, hinge) in slopes.iter_mut().zip(self.hinges) {
            let Some(hinge) = hinges.get(hinge as usize) else { continue };
            for (corner, slope) in hinge.iter().zip(gradient(points(x, hinge))) {
                if let Some(place) = self.vertices.iter().position(|vertex| vertex == corner) {
                    slopes[place] = slope;
                }
            }
        }
        slopes
    }
}

impl Hinges {
    /// Hinges of a membrane with these positions at rest \[m\], where it is flat, and with a multiple of the rigidity that its material and
    /// thickness give it.
    pub fn new(membrane: &Membranes, rest: &[f64], factor: f64) -> Self {
        let Lame { mu, lambda } = membrane.material().lame();
        // Lame's parameters of plane stress have lambda = E nu/(1 - nu²), those of plane strain E nu/((1 + nu)(1 - 2 nu)); the faces of a plate are free.
        let poisson = if membrane.material().plane().is_stress() {
            lambda / (2.0 * mu + lambda)
        } else {
            lambda / (2.0 * (lambda + mu))
        };
        let modulus = 2.0 * mu / (1.0 - poisson);
        let thickness = membrane.thickness();
        let rigidity = factor * modulus * thickness * thickness * thickness / 12.0;
        let mut hinges: Vec<[u32; 4]> = Vec::new();
        // The edge of another triangle in the opposite direction, with the place of that edge.
        let mut open = BTreeMap::new();
        let mut triangles = Vec::new();
        for (number, corners) in membrane.corners().iter().enumerate() {
            let [a, b, c] = corners.map(|corner| rest.as_chunks().0[corner as usize]);
            let edges = [minus(b, a), minus(c, b), minus(a, c)];
            let mut plate =
                Plate { hinges: [NONE; 3], stiffness: stiffness(edges, rigidity, poisson), vertices: [NONE; 6] };
            for place in 0..3 {
                let [a, b, third] = [0, 1, 2].map(|turn| corners[(place + turn) % 3]);
                if let Some((other, at, across)) = open.remove(&(b, a)) {
                    let hinge = hinges.len() as u32;
                    hinges.push([b, a, across, third]);
                    plate.hinges[place] = hinge;
                    let other: &mut Plate = if other == number { &mut plate } else { &mut triangles[other] };
                    other.hinges[at] = hinge;
                } else {
                    open.insert((a, b), (number, place, third));
                }
            }
            triangles.push(plate);
        }
        for plate in &mut triangles {
            plate.release();
            plate.find_vertices(&hinges);
        }
        Self { edges: hinges, triangles, set: Arch::new() }
    }

    /// Number of hinges.
    pub const fn count(&self) -> usize {
        self.edges.len()
    }

    /// Stored energy at these positions \[J\].
    pub fn energy(&self, x: &[f64]) -> f64 {
        let of = |plate: &Plate| {
            let angles =
                plate.hinges.map(|hinge| self.edges.get(hinge as usize).map_or(0.0, |hinge| angle(points(x, hinge))));
            let moments = plate.stiffness.map(|row| dot(row, angles));
            0.5 * dot(moments, angles)
        };
        self.triangles.iter().map(of).sum()
    }

    /// Adds the force \[N\]; `scratch` has two numbers for each hinge.
    pub fn add_force(&self, x: &[f64], scratch: &mut [f64], force: &mut [f64]) {
        let (angles, moments) = scratch.split_at_mut(self.edges.len());
        self.set.dispatch(Angles { hinges: &self.edges, x, out: angles });
        self.find_moments(angles, moments);
        self.set.dispatch(Forces { hinges: &self.edges, x, moments, force });
    }

    /// Adds the change of the force by a displacement d \[m\], with the opposite sign, exactly.
    pub fn add_stiffness_times(&self, x: &[f64], d: &[f64], scratch: &mut [f64], product: &mut [f64]) {
        let (angles, moments) = scratch.split_at_mut(self.edges.len());
        self.set.dispatch(Angles { hinges: &self.edges, x, out: angles });
        self.find_moments(angles, moments);
        for (hinge, moment) in self.edges.iter().zip(&*moments) {
            let (at, along) = (points(x, hinge), points(d, hinge));
            let moved = std::array::from_fn(|corner| {
                std::array::from_fn(|axis| Jet { first: [along[corner][axis], 0.0], ..Jet::constant(at[corner][axis]) })
            });
            add(hinge, gradient(moved).map(|corner| corner.map(|along: Jet<f64>| along.first[0])), *moment, product);
        }
        for (change, hinge) in angles.iter_mut().zip(&self.edges) {
            let (slope, along) = (gradient(points(x, hinge)), points(d, hinge));
            *change = (0..4).map(|corner| dot(slope[corner], along[corner])).sum();
        }
        self.find_moments(angles, moments);
        for (hinge, moment) in self.edges.iter().zip(&*moments) {
            add(hinge, gradient(points(x, hinge)), *moment, product);
        }
    }

    /// Writes the derivatives of the energy by the angles \[J\].
    fn find_moments(&self, angles: &[f64], moments: &mut [f64]) {
        moments.fill(0.0);
        for Plate { hinges, stiffness, .. } in &self.triangles {
            let own = hinges.map(|hinge| angles.get(hinge as usize).copied().unwrap_or(0.0));
            for (hinge, row) in hinges.iter().zip(stiffness) {
                if let Some(moment) = moments.get_mut(*hinge as usize) {
                    *moment += dot(*row, own);
                }
            }
        }
    }

    /// Calls `add` for every pair of vertices whose forces depend on each other, in the order of [`Self::each_block`].
    pub fn each_pair(&self, add: &mut dyn FnMut(u32, u32)) {
        for plate in &self.triangles {
            let vertices = plate.vertices;
            for (place, b) in vertices.iter().enumerate().filter(|(_, b)| **b != NONE) {
                vertices[..place].iter().for_each(|a| add(*a, *b));
            }
        }
    }

    /// Calls `act` with the blocks of the Gauss-Newton part of the stiffness, `sum_ij M_ij grad theta_i grad theta_j'`, which is positive
    /// semidefinite: of a vertex with itself, and of pairs.
    pub fn each_block(&self, x: &[f64], mut act: impl FnMut([u32; 2], [Vector<f64>; 3])) {
        for plate in &self.triangles {
            let (stiffness, vertices, slopes) = (plate.stiffness, plate.vertices, plate.slopes(&self.edges, x));
            for (b, vertex_b) in vertices.iter().enumerate().filter(|(_, b)| **b != NONE) {
                let moments: [Vector<f64>; 3] = std::array::from_fn(|i| {
                    std::array::from_fn(|axis| (0..3).map(|j| stiffness[i][j] * slopes[j][b][axis]).sum())
                });
                for (a, vertex_a) in vertices.iter().enumerate().take(b + 1) {
                    let entry =
                        |row: usize, column: usize| (0..3).map(|i| slopes[i][a][row] * moments[i][column]).sum();
                    let block = std::array::from_fn(|row| std::array::from_fn(|column| entry(row, column)));
                    act([*vertex_a, *vertex_b], block);
                }
            }
        }
    }
}

/// Second derivatives of the energy of a triangle by its angles \[J\], from its edges at rest, one after the other around it \[m\].
fn stiffness(edges: [Vector<f64>; 3], rigidity: f64, poisson: f64) -> [[f64; 3]; 3] {
    let normal = cross(edges[0], edges[1]);
    let area = 0.5 * dot(normal, normal).sqrt();
    let inner = |i: usize, j: usize| dot(edges[i], edges[j]);
    let entry = |i: usize, j: usize| {
        // Vectors across the edges have the same products as the edges.
        let (shear, mean) = (inner(i, j) * inner(i, j), inner(i, i) * inner(j, j));
        rigidity * ((1.0 - poisson) * shear + poisson * mean) / (4.0 * area * mean.sqrt())
    };
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

/// Writes the angles of hinges.
struct Angles<'a> {
    hinges: &'a [[u32; 4]],
    x: &'a [f64],
    out: &'a mut [f64],
}

impl WithSimd for Angles<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) {
        let mut now = [Block::default(); RUN_BLOCKS];
        for (hinges, angles) in self.hinges.chunks(RUN).zip(self.out.chunks_mut(RUN)) {
            collect(hinges, self.x, &mut now);
            for block in &mut now {
                for part in 0..Wide::<S>::PARTS {
                    let [sine, cosine] = sine_and_cosine(load(set, block, part));
                    sine.store(&mut block[0][0], part);
                    cosine.store(&mut block[0][1], part);
                }
            }
            for (number, angle) in angles.iter_mut().enumerate() {
                let [sine, cosine, _] = &now[number / LANES][0];
                *angle = libm::atan2(sine[number % LANES], cosine[number % LANES]);
            }
        }
    }
}

/// Adds the forces of moments about hinges \[J\].
struct Forces<'a> {
    hinges: &'a [[u32; 4]],
    x: &'a [f64],
    moments: &'a [f64],
    force: &'a mut [f64],
}

impl WithSimd for Forces<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, set: S) {
        let (mut now, mut turning) = ([Block::default(); RUN_BLOCKS], [Lanes::default(); RUN_BLOCKS]);
        for (hinges, moments) in self.hinges.chunks(RUN).zip(self.moments.chunks(RUN)) {
            collect(hinges, self.x, &mut now);
            turning.as_flattened_mut()[..moments.len()].copy_from_slice(moments);
            for (block, moment) in now.iter_mut().zip(&turning) {
                for part in 0..Wide::<S>::PARTS {
                    let factor = -Wide::load(set, moment, part);
                    let slopes = gradient(load(set, block, part));
                    for (to, slope) in block.as_flattened_mut().iter_mut().zip(slopes.as_flattened()) {
                        (factor * *slope).store(to, part);
                    }
                }
            }
            for (number, hinge) in hinges.iter().enumerate() {
                let (block, lane) = (&now[number / LANES], number % LANES);
                for (corner, along) in hinge.iter().zip(block) {
                    let own = &mut self.force[3 * *corner as usize..][..3];
                    own.iter_mut().zip(along).for_each(|(own, along)| *own += along[lane]);
                }
            }
        }
    }
}

/// Points of some hinges, block by block.
#[inline(always)]
fn collect(hinges: &[[u32; 4]], x: &[f64], blocks: &mut [Block; RUN_BLOCKS]) {
    for (number, hinge) in hinges.iter().enumerate() {
        let (block, lane) = (&mut blocks[number / LANES], number % LANES);
        for (to, from) in block.as_flattened_mut().iter_mut().zip(points(x, hinge).as_flattened()) {
            to[lane] = *from;
        }
    }
}

#[inline(always)]
fn load<S: Simd>(set: S, [a, b, c, d]: &Block, part: usize) -> [Vector<Wide<S>>; 4] {
    [load_vector(set, a, part), load_vector(set, b, part), load_vector(set, c, part), load_vector(set, d, part)]
}

#[inline(always)]
fn load_vector<S: Simd>(set: S, [x, y, z]: &[Lanes; 3], part: usize) -> Vector<Wide<S>> {
    [Wide::load(set, x, part), Wide::load(set, y, part), Wide::load(set, z, part)]
}

/// Multiples of the sine and the cosine of [`angle`]. Those of an edge without length are those of zero.
#[inline(always)]
fn sine_and_cosine<R: Real>([a, b, left, right]: [Vector<R>; 4]) -> [R; 2] {
    let edge = minus(b, a);
    let (first, second) = (cross(edge, minus(left, a)), cross(minus(right, a), edge));
    let length = dot(edge, edge).sqrt();
    let (zero, one) = (length.of(0.0), length.of(1.0));
    let sine = dot(cross(first, second), edge) / length;
    [zero.if_less(length, sine, zero), zero.if_less(length, dot(first, second), one)]
}

/// Angle between two triangles, from the ends of their edge and their third corners; zero if flat, and between -pi and pi.
fn angle(points: [Vector<f64>; 4]) -> f64 {
    let [sine, cosine] = sine_and_cosine(points);
    libm::atan2(sine, cosine)
}

/// Gradient of [`angle`] by the four points: moved along its normal, a third corner at the height h above the edge turns its triangle
/// by 1/h; the ends of the edge balance that (R. Bridson, S. Marino and R. Fedkiw, *Simulation of clothing with folds and wrinkles*,
/// Symposium on Computer Animation 2003). Triangles without area have none.
#[inline(always)]
fn gradient<R: Real>([a, b, left, right]: [Vector<R>; 4]) -> [Vector<R>; 4] {
    let (edge, to_left, to_right) = (minus(b, a), minus(left, a), minus(right, a));
    let square = dot(edge, edge);
    let length = square.sqrt();
    let (by_left, by_right) = (across(cross(edge, to_left), length), across(cross(to_right, edge), length));
    let (s, t) = (share(dot(to_left, edge), square), share(dot(to_right, edge), square));
    let minus_one = square.of(-1.0);
    let by_b = times(plus(times(by_left, s), times(by_right, t)), minus_one);
    let by_a = times(plus(plus(by_left, by_right), by_b), minus_one);
    [by_a, by_b, by_left, by_right]
}

/// Minus a normal of any length, with that of an edge over its own; zero if it has none.
#[inline(always)]
fn across<R: Real>(normal: Vector<R>, length: R) -> Vector<R> {
    let (zero, size) = (length.of(0.0), dot(normal, normal));
    times(normal, -zero.if_less(size, length / size, zero))
}

/// Share of an edge, from a product with it and the square of its length; zero if it has none.
#[inline(always)]
fn share<R: Real>(along: R, square: R) -> R {
    let zero = square.of(0.0);
    zero.if_less(square, along / square, zero)
}

/// Adds multiples of vectors to the numbers of four vertices.
fn add(hinge: &[u32; 4], vectors: [Vector<f64>; 4], factor: f64, to: &mut [f64]) {
    for (corner, vector) in hinge.iter().zip(vectors) {
        let own = &mut to[3 * *corner as usize..][..3];
        own.iter_mut().zip(vector).for_each(|(own, along)| *own += factor * along);
    }
}

#[inline(always)]
fn points(x: &[f64], hinge: &[u32; 4]) -> [Vector<f64>; 4] {
    let all = x.as_chunks().0;
    hinge.map(|corner| all[corner as usize])
}

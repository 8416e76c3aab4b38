//! A kind of contact as a term of the physics, by all that touches at a moment.

use super::{
    Anchor, Pair, Touch,
    touch::{coordinates, dot},
};
use crate::{
    effects::Motion,
    solvers::{SparseMatrix, Tangent, Weights},
};

/// Contact by a potential: a term of the physics like an element. A kind of contact says what touches; everything else follows
/// from that.
pub trait ContactTerm<const D: usize = 2, const T: usize = 1, const N: usize = 3>: Send + Sync {
    /// Calls `act` for everything that touches.
    fn each(&self, motion: Motion<'_>, act: &mut dyn FnMut(&Touch<D, T, N>));

    /// The same for a state that no step led to: also what is deep inside something.
    fn each_at_start(&self, motion: Motion<'_>, act: &mut dyn FnMut(&Touch<D, T, N>)) {
        self.each(motion, act);
    }

    /// Reason why nothing can touch, if so.
    fn idle(&self, motion: Motion<'_>) -> Option<&'static str>;

    /// Greatest square of the angular frequency of a vertex on its fully compressed skin [1/s²].
    fn square_frequency(&self, motion: Motion<'_>) -> f64;

    /// Whether the surface that it touches may move by itself.
    fn moves(&self) -> bool {
        false
    }

    /// Sparsity pattern, as [`crate::effects::Effect::sparsity_pattern`], where these pairs of surfaces may be near each other.
    fn sparsity_pattern(&self, pairs: &[Pair], add: &mut dyn FnMut(u32, u32));

    /// Adds the weighted stiffness and damping.
    fn add_stiffness(&self, motion: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix);
}

impl<const D: usize, const T: usize, const N: usize> dyn ContactTerm<D, T, N> + '_ {
    /// Whether a skin is compressed.
    pub fn touches(&self, motion: Motion<'_>) -> bool {
        let mut touches = false;
        self.each(motion, &mut |touch| touches |= touch.pressure() > 0.0);
        touches
    }

    /// Power of moving obstacles on the bodies \[W\].
    pub fn power_of_obstacles(&self, motion: Motion<'_>) -> f64 {
        let mut power = 0.0;
        if self.moves() {
            self.each(motion, &mut |touch| power += touch.power());
        }
        power
    }

    /// Power taken from the motion by dissipation and friction \[W\], and energy that the springs of friction store \[J\].
    pub fn taken_power(&self, motion: Motion<'_>) -> [f64; 2] {
        let mut taken = [0.0; 2];
        self.each(motion, &mut |touch| {
            taken[0] += touch.taken_power();
            taken[1] += touch.friction_energy();
        });
        taken
    }

    /// Energy \[J\].
    pub fn energy(&self, motion: Motion<'_>) -> f64 {
        let mut energy = 0.0;
        self.each(motion, &mut |touch| energy += touch.energy());
        energy
    }

    /// Calls `act` for each vertex in contact with a force on it \[N\].
    fn each_force(&self, motion: Motion<'_>, mut act: impl FnMut(usize, [f64; D])) {
        self.each(motion, &mut |touch| touch.forces().for_each(|(vertex, force)| act(vertex, force)));
    }

    /// Calls `act` for each number of the force on a vertex in contact \[N\], by its place among all coordinates.
    pub fn each_number(&self, motion: Motion<'_>, act: &mut dyn FnMut(usize, f64)) {
        self.each_force(motion, |vertex, force| {
            force.into_iter().enumerate().for_each(|(axis, force)| act(D * vertex + axis, force));
        });
    }

    /// Adds the forces \[N\].
    pub fn force(&self, motion: Motion<'_>, force: &mut [f64]) {
        self.each_force(motion, |vertex, added| {
            force[D * vertex..].iter_mut().zip(added).for_each(|(force, added)| *force += added);
        });
    }

    /// Adds the product of the stiffness with a displacement \[N\].
    pub fn stiffness_times(&self, motion: Motion<'_>, d: &[f64], product: &mut [f64]) {
        let weights = Weights { position: 1.0, velocity: 0.0, tangent: Tangent::Exact };
        self.each(motion, &mut |touch| {
            let linearised = touch.linearised(weights);
            for i in touch.range() {
                for j in touch.range() {
                    let (d, block): ([f64; D], _) = (coordinates(d, touch.vertices[j]), linearised.block(i, j));
                    let at = D * touch.vertices[i] as usize;
                    for (row, product) in product[at..at + D].iter_mut().enumerate() {
                        *product += dot(std::array::from_fn(|column| block[(row, column)]), d);
                    }
                }
            }
        });
    }

    /// Rates of damping, as [`crate::effects::Effect::damping`].
    pub fn damping(&self, motion: Motion<'_>) -> [f64; 2] {
        let mut greatest = 0.0_f64;
        self.each(motion, &mut |touch| {
            let inverse = |i: usize| {
                let inverse: [f64; D] = coordinates(motion.inverse_mass, touch.vertices[i]);
                touch.weights[i].abs() * inverse.into_iter().fold(0.0, f64::max)
            };
            greatest = greatest.max(touch.damping() * touch.range().map(inverse).sum::<f64>());
        });
        [greatest, 0.0]
    }

    /// Adds the memory of all contacts after a step of length h \[s\]. Returns the energy that the
    /// decrease of initial penetration supplies \[J\].
    pub fn drag_anchors(&self, motion: Motion<'_>, h: f64, anchors: &mut Vec<Anchor>) -> f64 {
        let (mut supplied, mut last) = (0.0, None);
        self.each(motion, &mut |touch| {
            if touch.keeps_anchor {
                let (anchor, decrease) = touch.dragged(h);
                anchors.push(anchor);
                last = Some((touch.name, decrease));
            }
            // Terms with the name of the one before have its memory.
            match last {
                Some((name, decrease)) if decrease > 0.0 && name == touch.name => supplied += touch.supplied(decrease),
                _ => {}
            }
        });
        supplied
    }

    /// Adds the vertices of contacts in which surfaces have crossed: inside an obstacle or another body.
    pub fn add_inside(&self, motion: Motion<'_>, vertices: &mut Vec<u32>) {
        self.each(motion, &mut |touch| {
            if touch.keeps_anchor && touch.is_inside() {
                vertices.push(touch.vertices[touch.range().start]);
            }
        });
    }

    /// Adds the memory of all contacts of a state that was not stepped to.
    pub fn add_penetrations(&self, motion: Motion<'_>, anchors: &mut Vec<Anchor>) {
        self.each_at_start(motion, &mut |touch| {
            if touch.keeps_anchor {
                anchors.push(touch.begun());
            }
        });
    }
}

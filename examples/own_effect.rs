//! An effect of one's own, a constant wind, on a man whose head is pinned: `cargo run --example own_effect`.

use gingerbread::{
    effects::{Effect, EffectKind, EffectParameters, Gravity, Motion},
    elements::Elements,
    level::{BodyLevel, Level, MassLevel, Pin},
    materials::MaterialParameters,
    meshes::{Gingerbread, NoFiles},
    quantity::{Density, DragCoefficient, Quantity, VelocityX},
    scene::Scene,
    simulation::Simulation,
    solvers::{SparseMatrix, Weights},
};

/// Wind along x: `f = k (w - v)` on every vertex.
#[derive(Clone, Debug, PartialEq)]
pub struct Wind {
    /// w [m/s].
    pub speed: VelocityX,
    /// k [N s/m].
    pub coefficient: DragCoefficient,
}

impl EffectParameters for Wind {
    fn title(&self) -> &'static str {
        "Wind"
    }

    fn about(&self) -> &'static str {
        "f = k (w − v) on every vertex."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.speed, &mut self.coefficient]
    }

    fn build(&self, _: &Elements) -> Result<Box<dyn Effect>, String> {
        Ok(Box::new(Blowing { speed: self.speed.get(), coefficient: self.coefficient.get() }))
    }
}

/// The same, as a step needs it.
struct Blowing {
    speed: f64,
    coefficient: f64,
}

impl Effect for Blowing {
    fn name(&self) -> &'static str {
        "Wind"
    }

    fn elements(&self, motion: Motion<'_>) -> usize {
        motion.vertices()
    }

    /// The constant part k w of the force has a potential. Without it the energy check would take its work for energy from
    /// nowhere.
    fn energy(&self, motion: Motion<'_>) -> f64 {
        let along = motion.x.iter().step_by(motion.dimension).sum::<f64>();
        -self.coefficient * self.speed * along
    }

    fn force(&self, motion: Motion<'_>, _: &mut [f64], force: &mut [f64]) {
        let points = force.chunks_exact_mut(motion.dimension).zip(motion.v.chunks_exact(motion.dimension));
        for (force, v) in points {
            for (axis, (force, v)) in force.iter_mut().zip(v).enumerate() {
                *force += self.coefficient * (if axis == 0 { self.speed } else { 0.0 } - v);
            }
        }
    }

    /// `-df/dv = k`, for implicit schemes.
    fn add_stiffness(&self, _: Motion<'_>, weights: Weights, matrix: &mut dyn SparseMatrix) {
        matrix.add_to_diagonal(&|_| weights.velocity * self.coefficient);
    }

    /// So that the longest stable step is known: alpha is k over the least mass [1/s].
    fn damping(&self, motion: Motion<'_>) -> [f64; 2] {
        [self.coefficient * motion.inverse_mass.iter().fold(0.0, |most: f64, inverse| most.max(*inverse)), 0.0]
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let wind = Wind { speed: VelocityX::new(3.0)?, coefficient: DragCoefficient::new(0.05)? };
    let mass = MassLevel::Density(Density::new(100.0)?);
    let man = BodyLevel::new("man", Gingerbread::default(), MaterialParameters::default(), mass);
    let man = BodyLevel { pins: vec![Pin::Top], ..man };
    let level = Level::new("Windy").with_body(man).with_effect(Gravity::default());
    let level = level.with_effect(EffectKind::own("Wind", wind));
    let scene = Scene::build(&level, level.mode, &NoFiles, None)?;
    let mut simulation = Simulation::open(scene, &level, level.mode)?;
    for _ in 0..10 {
        simulation.advance(6 * u64::from(level.substeps.get()), &mut || true);
        let x = &simulation.state().x;
        let middle = x.iter().step_by(2).sum::<f64>() / (x.len() / 2) as f64;
        println!("{:.1} s: the middle is at x = {middle:.4} m", simulation.state().time);
    }
    simulation.fault().map_or(Ok(()), |fault| Err(fault.to_string().into()))
}

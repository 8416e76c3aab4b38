//! Effect: lengths of nets kept by projection of positions, in place of stiffness.

use super::{DuplicatePolicy, Effect, EffectParameters, Motion, ZERO};
use crate::{
    elements::Elements,
    meshes::Whole,
    nets::{Link, Role},
    quantity::{FlexionCorrection, Passes, Quantity, Separation, ShearCorrection, StructuralCorrection},
};
use serde::{Deserialize, Serialize};

/// After each step, every spring of the nets is brought to its rest length, one after another in the order of the net: for
/// a spring of length l, rest length r and unit vector u from its end a to its end b,
///
/// `x_a += s w_a/(w_a + w_b) (l - r) u`, `x_b -= s w_b/(w_a + w_b) (l - r) u`,
///
/// where w = 1/mass, so that a pinned end stays, and s is the share that is corrected. Equal masses move by half each
/// (T. Jakobsen, *Advanced Character Physics*, Game Developers Conference 2001; M. Müller and others, *Position Based
/// Dynamics*, Journal of Visual Communication and Image Representation 18, 2007). Velocities change by the displacement over
/// the length of the step.
///
/// Before that, once in a step, particles of nets that are nearer to each other than the separation are pushed apart to it by the same formula. This keeps a cloth from
/// passing through itself as long as no particle moves farther than half of the separation in a step, and the particles are nearer to each other than that.
///
/// It keeps linear momentum, and needs no short step however stiff the cloth is. It is no force: what it reaches depends on the number
/// of passes, on the order of the springs and on the length of the step, and the result does not converge as the step is refined. It does
/// not use the stiffness of the springs. The springs pull as well unless that is zero.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Projection {
    /// Passes over all springs in a step.
    #[serde(default = "one_pass")]
    pub passes: Whole<Passes>,
    /// s of structural springs.
    #[serde(default = "whole")]
    pub structural: StructuralCorrection,
    /// s of shear springs.
    #[serde(default = "whole_shear")]
    pub shear: ShearCorrection,
    /// s of flexion springs.
    #[serde(default = "whole_flexion")]
    pub flexion: FlexionCorrection,
    /// Distance to which particles are pushed apart before the springs are corrected; none at 0 \[m\].
    #[serde(default = "none", skip_serializing_if = "is_none")]
    pub separation: Separation,
    /// What pinned particles do.
    #[serde(default)]
    pub pins: ProjectedPins,
}

/// What pinned particles do while positions are projected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ProjectedPins {
    /// They stay, and the other end of a spring is corrected alone.
    #[default]
    Stay,
    /// They take part in the step and in the projection as if they were free, and are put back afterwards, as in the cloth
    /// of Princeton's course COS 426.
    PutBack,
}

const fn one_pass() -> Whole<Passes> {
    Whole::literal(Passes::literal(1.0))
}

const fn none() -> Separation {
    Separation::literal(0.0)
}

fn is_none(separation: &Separation) -> bool {
    *separation == none()
}

const fn whole() -> StructuralCorrection {
    StructuralCorrection::literal(1.0)
}

const fn whole_shear() -> ShearCorrection {
    ShearCorrection::literal(1.0)
}

const fn whole_flexion() -> FlexionCorrection {
    FlexionCorrection::literal(1.0)
}

impl Default for Projection {
    fn default() -> Self {
        Self {
            passes: one_pass(),
            structural: whole(),
            shear: whole_shear(),
            flexion: whole_flexion(),
            separation: none(),
            pins: ProjectedPins::Stay,
        }
    }
}

impl EffectParameters for Projection {
    fn title(&self) -> &'static str {
        "Projection"
    }

    fn about(&self) -> &'static str {
        "After each step every spring of a net is brought to its rest length: Δx_a = s w_a/(w_a + w_b) (l − r) u. In place of stiffness."
    }

    fn parameters(&mut self) -> Vec<&mut dyn Quantity> {
        vec![&mut self.passes, &mut self.structural, &mut self.shear, &mut self.flexion, &mut self.separation]
    }

    fn duplicate_policy(&self) -> DuplicatePolicy {
        DuplicatePolicy::Odd("more passes of one do the same")
    }

    fn build(&self, elements: &Elements) -> Result<Box<dyn Effect>, String> {
        if elements.springs.is_empty() {
            return Err("it acts on the springs of nets, and the level has no net".to_owned());
        }
        let share = |role| match role {
            Role::Structural => self.structural.get(),
            Role::Shear => self.shear.get(),
            Role::Flexion => self.flexion.get(),
        };
        let mut constraints = Vec::new();
        for (springs, numbering) in elements.springs.iter().zip(&elements.spring_numbers) {
            let mut listed: Vec<_> = springs.links().iter().enumerate().collect();
            listed.sort_unstable_by_key(|(place, _)| numbering.element_name(*place));
            let constraint =
                |(_, link): (usize, &Link)| Constraint { ends: link.ends, rest: link.rest, share: share(link.role) };
            constraints.extend(listed.into_iter().map(constraint).filter(|constraint| constraint.share > 0.0));
        }
        let separation = self.separation.get();
        let particles =
            elements.springs.iter().flat_map(|springs| springs.vertices().clone()).filter(|_| separation > 0.0);
        Ok(Box::new(LengthProjection {
            constraints,
            passes: self.passes.count(),
            particles: particles.map(|particle| particle as u32).collect(),
            separation,
            dimension: elements.springs[0].dimension(),
            puts_pins_back: self.pins == ProjectedPins::PutBack,
        }))
    }
}

/// A length that is kept.
#[derive(Clone, Copy, Debug)]
struct Constraint {
    ends: [u32; 2],
    /// r \[m\].
    rest: f64,
    /// s.
    share: f64,
}

/// A [`Projection`], built.
pub struct LengthProjection {
    /// In the order of their projection.
    constraints: Vec<Constraint>,
    passes: u32,
    /// Particles that are kept apart.
    particles: Vec<u32>,
    /// Their least distance \[m\].
    separation: f64,
    dimension: usize,
    puts_pins_back: bool,
}

impl LengthProjection {
    /// Moves positions \[m\], flat, apart and onto the lengths at rest, with 1/mass [1/kg] as weights. The scratch has the size
    /// that the effect states.
    pub fn project(&self, inverse_mass: &[f64], x: &mut [f64], scratch: &mut [f64]) {
        match self.dimension {
            2 => self.project_in::<2>(inverse_mass, x, scratch),
            _ => self.project_in::<3>(inverse_mass, x, scratch),
        }
    }

    fn project_in<const D: usize>(&self, inverse_mass: &[f64], x: &mut [f64], scratch: &mut [f64]) {
        self.separate::<D>(inverse_mass, x, scratch);
        for _ in 0..self.passes {
            for &Constraint { ends, rest, share } in &self.constraints {
                correct::<D>(inverse_mass, x, ends, |length| share * (1.0 - rest / length));
            }
        }
    }

    /// Pushes particles apart: those that are near along x, sorted along it.
    fn separate<const D: usize>(&self, inverse_mass: &[f64], x: &mut [f64], scratch: &mut [f64]) {
        let sorted = &mut scratch.as_chunks_mut::<2>().0[..self.particles.len()];
        for (entry, particle) in sorted.iter_mut().zip(&self.particles) {
            *entry = [x[D * *particle as usize], f64::from(*particle)];
        }
        sorted.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        for (place, [from, one]) in sorted.iter().enumerate() {
            // Particles move while others are corrected. Those that come near by that are parted in the next step.
            let near = sorted[place + 1..].iter().take_while(|[to, _]| to - from < 2.0 * self.separation);
            for [_, other] in near {
                let ends = [*one as u32, *other as u32];
                correct::<D>(inverse_mass, x, ends, |length| (1.0 - self.separation / length).min(0.0));
            }
        }
    }

    /// Whether pinned particles move in a step and are put back after the projection.
    pub const fn puts_pins_back(&self) -> bool {
        self.puts_pins_back
    }
}

/// Moves both ends along the line between them, together by a factor of their distance, in proportion to their inverse masses.
fn correct<const D: usize>(inverse_mass: &[f64], x: &mut [f64], ends: [u32; 2], factor: impl Fn(f64) -> f64) {
    let [a, b] = ends.map(|end| D * end as usize);
    let between: [f64; D] = std::array::from_fn(|axis| x[b + axis] - x[a + axis]);
    let length = between.iter().map(|along| along * along).sum::<f64>().sqrt();
    let weights = [inverse_mass[a], inverse_mass[b]];
    // Ends that coincide have no direction; pinned or sleeping ones do not move.
    if length == 0.0 || weights == [0.0; 2] {
        return;
    }
    let correction = factor(length) / (weights[0] + weights[1]);
    for axis in 0..D {
        let change = correction * between[axis];
        x[a + axis] += weights[0] * change;
        x[b + axis] -= weights[1] * change;
    }
}

impl Effect for LengthProjection {
    fn name(&self) -> &'static str {
        "Projection"
    }

    fn elements(&self, _: Motion<'_>) -> usize {
        self.constraints.len() * self.passes as usize + self.particles.len()
    }

    fn couples_parts(&self) -> bool {
        !self.particles.is_empty()
    }

    fn scratch(&self) -> usize {
        2 * self.particles.len()
    }

    fn idle(&self, _: Motion<'_>) -> Option<&'static str> {
        (self.constraints.is_empty() && self.particles.is_empty()).then_some(ZERO)
    }

    fn projection(&self) -> Option<&LengthProjection> {
        Some(self)
    }
}

//! Potential of a compressed skin, and the restitution that its dissipation leaves.

/// Energy of a skin that is compressed between a surface and an obstacle, by the gap g between them.
///
/// With the thickness d, s = g/d, y = 1 - s, u = min(1, y/b), q = max(0, y - b) and b = 1/2, for g < d, per area of the
/// surface:
///
/// - energy `phi = E d (b² (u⁴/4 - u⁵/10) + b q/2 + q²/2)` [J/m²],
/// - pressure `p = -dphi/dg = E (b (u³ - u⁴/2) + q)` \[Pa\],
/// - stiffness `d²phi/dg² = E/d (3 u² - 2 u³)` [Pa/m], at most E/d.
///
/// So the force is twice continuously differentiable where contact begins, error control and high orders work through
/// impacts, and a bounded stiffness bounds the step of explicit schemes. A barrier, which is infinite at g = 0, would need
/// shorter and shorter steps (Li et al., *Incremental Potential Contact*, ACM Transactions on Graphics 39, 2020).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Potential {
    /// E: modulus of the skin \[Pa\].
    pub modulus: f64,
    /// d: gap at which it begins to act \[m\].
    pub thickness: f64,
}

/// b: compression at which the stiffness has its full value.
const FULL: f64 = 0.5;

impl Potential {
    /// Tangential stiffness of the skin as a fraction of its greatest normal stiffness.
    const TANGENTIAL: f64 = 0.5;

    /// u and q.
    fn compression(self, gap: f64) -> [f64; 2] {
        let y = 1.0 - gap / self.thickness;
        [(y / FULL).clamp(0.0, 1.0), (y - FULL).max(0.0)]
    }

    /// Energy per area [J/m²] at a gap \[m\].
    pub fn energy(self, gap: f64) -> f64 {
        let [u, q] = self.compression(gap);
        let begun = FULL * FULL * u * u * u * u * (0.25 - 0.1 * u);
        self.modulus * self.thickness * (begun + 0.5 * q * (FULL + q))
    }

    /// Pressure \[Pa\] at a gap \[m\].
    pub fn pressure(self, gap: f64) -> f64 {
        let [u, q] = self.compression(gap);
        self.modulus * (FULL * u * u * u * (1.0 - 0.5 * u) + q)
    }

    /// Stiffness [Pa/m] at a gap \[m\]: the derivative of the pressure by the approach.
    pub fn stiffness(self, gap: f64) -> f64 {
        let [u, _] = self.compression(gap);
        self.greatest_stiffness() * u * u * (3.0 - 2.0 * u)
    }

    /// Mean pressure \[Pa\] while the gap changes by s around its value \[m\], as a difference quotient `-(phi(g + s/2) -
    /// phi(g - s/2))/s`: the work of this pressure is the change of the energy (Gonzalez, *Time Integration and Discrete
    /// Hamiltonian Systems*, Journal of Nonlinear Science 6, 1996). Also its derivatives by g and by s [Pa/m].
    pub fn mean_pressure(self, gap: f64, change: f64) -> [f64; 3] {
        /// Change below which the quotient would be round-off, as a fraction of the thickness.
        const SMALL: f64 = 1e-3;
        if change.abs() < SMALL * self.thickness {
            // Simpson's rule, whose error is that of the fourth power of the change.
            let [a, b] = [-0.5, 0.5].map(|share| self.pressure(gap + share * change));
            let mean = (a + 4.0 * self.pressure(gap) + b) / 6.0;
            return [mean, -self.stiffness(gap), 0.0];
        }
        let [a, b] = [-0.5, 0.5].map(|share| gap + share * change);
        let mean = (self.energy(a) - self.energy(b)) / change;
        let (a, b) = (self.pressure(a), self.pressure(b));
        [mean, (b - a) / change, (0.5 * (a + b) - mean) / change]
    }

    /// Greatest stiffness [Pa/m].
    pub const fn greatest_stiffness(self) -> f64 {
        self.modulus / self.thickness
    }

    /// Tangential stiffness of the spring of friction [Pa/m].
    pub const fn tangential_stiffness(self) -> f64 {
        Self::TANGENTIAL * self.greatest_stiffness()
    }
}

/// Coefficient of restitution e of a rigid mass that hits a skin at a speed v [m/s], whose pressure is `p (1 - c dg/dt)` with
/// the dissipation c [s/m]. It solves `c v (1 + e) = ln((1 + c v)/(1 - e c v))` (Hunt and Crossley, *Coefficient of
/// Restitution Interpreted as Damping in Vibroimpact*, Journal of Applied Mechanics 42, 1975; exact for any potential).
pub fn restitution(dissipation: f64, speed: f64) -> f64 {
    let a = dissipation * speed;
    if a < 1e-9 {
        return 1.0;
    }
    // The difference grows with e: bisection between 0 and the pole at e = 1/a.
    let (mut least, mut greatest) = (0.0, (1.0 / a).min(1.0));
    for _ in 0..60 {
        let e = 0.5 * (least + greatest);
        if libm::log((1.0 + a) / (1.0 - e * a)) < a * (1.0 + e) { least = e } else { greatest = e }
    }
    0.5 * (least + greatest)
}

/// Dissipation [s/m] that leaves a coefficient of restitution at a speed [m/s]; see [`restitution`]. Below e = 0.05 it is that of
/// 0.05: the dissipation would grow without bound.
pub fn dissipation(coefficient: f64, speed: f64) -> f64 {
    const LEAST: f64 = 0.05;
    let wanted = coefficient.max(LEAST);
    if wanted >= 1.0 || speed <= 0.0 {
        return 0.0;
    }
    // Restitution falls as dissipation grows: bisection of c v.
    let (mut least, mut greatest) = (0.0, 100.0);
    for _ in 0..60 {
        let a = 0.5 * (least + greatest);
        if restitution(a, 1.0) > wanted { least = a } else { greatest = a }
    }
    0.5 * (least + greatest) / speed
}

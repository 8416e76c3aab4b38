//! Verdict on a run of a hard case.

use super::reference::Distance;

/// Greatest |s - 1| of the principal stretches of a body that returned to its rest shape.
pub const STRAIN: f64 = 1e-3;

/// Greatest speed of bodies at rest (root mean square over the mass), relative to the speed of shear waves.
pub const SPEED: f64 = 1e-3;

/// Greatest distance from the reference of an accurate run.
pub const ACCURATE: f64 = 0.1;

/// Greatest distance beyond a wall, as a share of the size of the bodies.
pub const OUTSIDE: f64 = 1e-6;

/// Measured numbers of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Numbers {
    /// Greatest energy from nowhere, relative to the energy put in.
    pub gain: f64,
    /// Greatest distance beyond a wall, as a share of the size of the bodies.
    pub outside: f64,
    /// Greatest number of crossings of surfaces at the end of a frame, where contact has a potential; see
    /// [`count_crossings`](crate::contact::count_crossings). Where surfaces begin crossed, it counts since they came apart.
    pub crossings: usize,
    /// Number of crossings at the end, if surfaces began crossed and never came apart.
    pub tangled: usize,
    /// Greatest |s - 1| of the principal stretches at the end, if bodies should return to their rest shape.
    pub strain: Option<f64>,
    /// Speed at the end (root mean square over the mass), relative to that of shear waves, if bodies should come to rest.
    pub speed: Option<f64>,
    /// Elastic energy at the end \[J\].
    pub elastic: f64,
    /// Number of inverted triangles at the end.
    pub inverted: usize,
    /// Number of vertices at the end around which triangles lie folded over; see [`Tangle`](crate::inversion_recovery::Tangle).
    pub wound: usize,
    /// Whether untangling returns bodies to their expected rest shape.
    pub opens: bool,
    /// Steps whose equations were not solved to tolerance.
    pub unsolved: u64,
    /// Steps that the guard divided.
    pub guarded: u64,
    /// Simulated time at the end \[s\].
    pub time: f64,
    /// Greatest distance from the reference; `None` without a reference.
    pub distance: Option<Distance>,
    /// Whether the reference ends early because the motion is chaotic.
    pub chaotic: bool,
}

/// Reason why a run is not stable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// The simulation stopped.
    Stopped,
    /// The energy exceeded the energy put in.
    Energy,
    /// Something went through a wall.
    Outside,
    /// Surfaces crossed each other.
    Crossed,
    /// Surfaces that began crossed did not come apart.
    Tangled,
    /// Triangles are inverted at the end.
    Inverted,
    /// No triangle is inverted at the end, but triangles of a vertex lie over each other. No force separates them.
    Wound,
    /// Bodies are not in their rest shapes at the end.
    Strain,
    /// Bodies still move at the end.
    Motion,
}

/// Verdict on a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// Measured numbers.
    pub numbers: Numbers,
    /// Most severe failure. `None` if the run is stable.
    pub failure: Option<Failure>,
    /// Fault that stopped the simulation, if any.
    pub fault: Option<String>,
}

impl Verdict {
    /// Verdict on measured numbers with an energy tolerance.
    pub fn of(numbers: Numbers, fault: Option<String>, tolerance: f64) -> Self {
        let Numbers { gain, outside, crossings, tangled, strain, speed, inverted, wound, .. } = numbers;
        // NaN exceeds every limit.
        let within = |value: f64, limit: f64| value <= limit;
        let failure = if fault.is_some() {
            Some(Failure::Stopped)
        } else if !within(gain, tolerance) {
            Some(Failure::Energy)
        } else if !within(outside, OUTSIDE) {
            Some(Failure::Outside)
        } else if crossings > 0 {
            Some(Failure::Crossed)
        } else if tangled > 0 {
            Some(Failure::Tangled)
        } else if inverted > 0 {
            Some(Failure::Inverted)
        } else if wound > 0 {
            Some(Failure::Wound)
        } else if strain.is_some_and(|strain| !within(strain, STRAIN)) {
            Some(Failure::Strain)
        } else if speed.is_some_and(|speed| !within(speed, SPEED)) {
            Some(Failure::Motion)
        } else {
            None
        };
        Self { numbers, failure, fault }
    }

    /// Whether the run is stable.
    pub const fn is_stable(&self) -> bool {
        self.failure.is_none()
    }

    /// Whether the run is held: stable, and within [`ACCURATE`] of its reference, if there is one.
    pub fn held(&self) -> bool {
        self.is_stable() && self.numbers.distance.is_none_or(|distance| distance.share <= ACCURATE)
    }

    /// Number that decides about stability, with its name and unit.
    pub fn decided_by(&self) -> String {
        let Numbers { gain, outside, crossings, tangled, strain, speed, inverted, wound, time, opens, .. } =
            self.numbers;
        let opened = if opens { ", opened by Untangle" } else { "" };
        match (self.failure, strain, speed) {
            (Some(Failure::Stopped), ..) => format!("stopped at {time:.2} s"),
            (Some(Failure::Outside), ..) => format!("{} through a wall", Share(outside)),
            (Some(Failure::Crossed), ..) => format!("{} of surfaces", Count(crossings, "crossing", "crossings")),
            (Some(Failure::Tangled), ..) => format!("{} of surfaces left", Count(tangled, "crossing", "crossings")),
            (Some(Failure::Inverted), ..) => format!("{} inverted{opened}", Count(inverted, "triangle", "triangles")),
            (Some(Failure::Wound), ..) => format!("folded at {}{opened}", Count(wound, "vertex", "vertices")),
            (Some(Failure::Strain) | None, Some(strain), _) => format!("strain {}", Share(strain)),
            (Some(Failure::Motion), _, Some(speed)) => format!("speed {} of shear waves", Share(speed)),
            _ => format!("energy up by {}", Share(gain)),
        }
    }

    /// Distance from the reference in words.
    pub fn accuracy(&self) -> String {
        let Numbers { distance, chaotic, .. } = self.numbers;
        match distance {
            Some(Distance { share, quantity, until }) => {
                let why = if chaotic { ", then chaotic" } else { "" };
                format!("{} off in {} (to {until:.2} s{why})", Share(share), quantity.words())
            }
            None if chaotic => "chaotic".to_owned(),
            None => "no reference".to_owned(),
        }
    }
}

/// Count with its noun in singular and plural.
pub(super) struct Count(pub usize, pub &'static str, pub &'static str);

impl std::fmt::Display for Count {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self(count, one, many) = self;
        write!(out, "{count} {}", if *count == 1 { one } else { many })
    }
}

/// Share in per cent. Very small and very large values are shown as bounds.
struct Share(f64);

impl std::fmt::Display for Share {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let per_cent = 100.0 * self.0;
        if per_cent == 0.0 {
            write!(out, "0 %")
        } else if per_cent < 1e-4 {
            write!(out, "< 0.0001 %")
        } else if per_cent < 1.0 {
            write!(out, "{per_cent:.4} %")
        } else if per_cent < 99.0 || (101.0..=1000.0).contains(&per_cent) {
            write!(out, "{per_cent:.0} %")
        } else if per_cent <= 1000.0 {
            write!(out, "{per_cent:.2} %")
        } else {
            write!(out, "over 1000 %")
        }
    }
}

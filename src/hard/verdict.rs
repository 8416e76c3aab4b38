//! Verdict on a run of a hard case.

/// How far the area of any triangle may be off after coming home, as a share of it.
pub const AREA: f64 = 1e-3;

/// How far anything may be through a wall, as a share of the size of the bodies.
pub const OUTSIDE: f64 = 1e-6;

/// What was measured in a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Numbers {
    /// The most that the energy was above what was put in, as a share of what there could be.
    pub gain: f64,
    /// The farthest that anything was through a wall, as a share of the size of the bodies.
    pub outside: f64,
    /// Where bodies should come home: the greatest error of a triangle's area at the end, as a share of it.
    pub area: Option<f64>,
    /// Elastic energy at the end [J].
    pub elastic: f64,
    /// How many triangles were inverted at the end.
    pub inverted: usize,
    /// How many vertices inside a body had their triangles twice or more around them, or not around them at all, at the end.
    pub wound: usize,
    /// Whether untangling then brings bodies home that should be there.
    pub opens: bool,
    /// Steps whose equations were not solved to tolerance.
    pub unsolved: u64,
    /// Simulated time at the end [s].
    pub time: f64,
}

/// Why a case was not held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// The simulation could not go on.
    Stopped,
    /// Energy came from nowhere.
    Energy,
    /// Something went through a wall.
    Outside,
    /// Triangles are inside out at the end.
    Inverted,
    /// No triangle is inside out at the end, but those of a vertex go around it twice: nothing pulls them apart.
    Wound,
    /// Triangles are larger or smaller than at rest at the end.
    Area,
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// What was measured.
    pub numbers: Numbers,
    /// What went wrong first, of what is worst; nothing, if it was held.
    pub failure: Option<Failure>,
    /// Why the simulation stopped, if it did.
    pub fault: Option<String>,
}

impl Verdict {
    /// Judges what was measured, with the tolerance for the energy.
    pub fn of(numbers: Numbers, fault: Option<String>, tolerance: f64) -> Self {
        let Numbers { gain, outside, area, inverted, wound, .. } = numbers;
        // What is not a number is not below a limit either.
        let within = |value: f64, limit: f64| value <= limit;
        let failure = if fault.is_some() {
            Some(Failure::Stopped)
        } else if !within(gain, tolerance) {
            Some(Failure::Energy)
        } else if !within(outside, OUTSIDE) {
            Some(Failure::Outside)
        } else if area.is_some() && inverted > 0 {
            Some(Failure::Inverted)
        } else if area.is_some() && wound > 0 {
            Some(Failure::Wound)
        } else if area.is_some_and(|area| !within(area, AREA)) {
            Some(Failure::Area)
        } else {
            None
        };
        Self { numbers, failure, fault }
    }

    /// Whether the case was held.
    pub const fn held(&self) -> bool {
        self.failure.is_none()
    }

    /// The number that decided, with its name and unit.
    pub fn decided_by(&self) -> String {
        let Numbers { gain, outside, area, inverted, wound, time, opens, .. } = self.numbers;
        let opened = if opens { ", opened by Untangle" } else { "" };
        match (self.failure, area) {
            (Some(Failure::Stopped), _) => format!("stopped at {time:.2} s"),
            (Some(Failure::Outside), _) => format!("{} through a wall", Share(outside)),
            (Some(Failure::Inverted), _) => format!("{} inverted{opened}", Count(inverted, "triangle", "triangles")),
            (Some(Failure::Wound), _) => format!("folded at {}{opened}", Count(wound, "vertex", "vertices")),
            (Some(Failure::Area) | None, Some(area)) => format!("area off by {}", Share(area)),
            (Some(Failure::Energy | Failure::Area) | None, _) => format!("energy up by {}", Share(gain)),
        }
    }
}

/// So many of something.
pub(super) struct Count(pub usize, pub &'static str, pub &'static str);

impl std::fmt::Display for Count {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self(count, one, many) = self;
        write!(out, "{count} {}", if *count == 1 { one } else { many })
    }
}

/// A share in per cent, with what is below all limits as such.
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
        } else if per_cent <= 1000.0 {
            write!(out, "{per_cent:.0} %")
        } else {
            write!(out, "over 1000 %")
        }
    }
}

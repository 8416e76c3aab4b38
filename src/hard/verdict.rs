//! Verdict on a run of a hard case.

/// Greatest relative area error of a triangle in a body that returned to its rest shape.
pub const AREA: f64 = 1e-3;

/// Greatest distance beyond a wall, as a share of the size of the bodies.
pub const OUTSIDE: f64 = 1e-6;

/// Measured numbers of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Numbers {
    /// Greatest energy excess, relative to the greatest possible mechanical energy.
    pub gain: f64,
    /// Greatest distance beyond a wall, as a share of the size of the bodies.
    pub outside: f64,
    /// Greatest relative area error of a triangle at the end, if bodies should return to their rest shape.
    pub area: Option<f64>,
    /// Elastic energy at the end \[J\].
    pub elastic: f64,
    /// Number of inverted triangles at the end.
    pub inverted: usize,
    /// Number of inner vertices at the end whose triangles go around them twice or more, or not at all.
    pub wound: usize,
    /// Whether untangling returns bodies to their expected rest shape.
    pub opens: bool,
    /// Steps whose equations were not solved to tolerance.
    pub unsolved: u64,
    /// Simulated time at the end \[s\].
    pub time: f64,
}

/// Reason why a case was not held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// The simulation stopped.
    Stopped,
    /// The energy exceeded the energy put in.
    Energy,
    /// Something went through a wall.
    Outside,
    /// Triangles are inverted at the end.
    Inverted,
    /// No triangle is inverted at the end, but those of a vertex go around it twice. No force separates them.
    Wound,
    /// Triangles are larger or smaller than at rest at the end.
    Area,
}

/// Verdict on a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// Measured numbers.
    pub numbers: Numbers,
    /// Most severe failure. `None` if the case was held.
    pub failure: Option<Failure>,
    /// Fault that stopped the simulation, if any.
    pub fault: Option<String>,
}

impl Verdict {
    /// Verdict on measured numbers with an energy tolerance.
    pub fn of(numbers: Numbers, fault: Option<String>, tolerance: f64) -> Self {
        let Numbers { gain, outside, area, inverted, wound, .. } = numbers;
        // NaN exceeds every limit.
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

    /// Deciding number, with its name and unit.
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
        } else if per_cent <= 1000.0 {
            write!(out, "{per_cent:.0} %")
        } else {
            write!(out, "over 1000 %")
        }
    }
}

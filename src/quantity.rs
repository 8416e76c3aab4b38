//! Physical quantities with a checked value. Each type has its name, unit, allowed range and slider.
//! Level files and panels share these types, so an invalid number is refused in both.
//!
//! ```
//! use gingerbread::quantity::{Quantity as _, Young};
//!
//! let young = Young::new(1e5)?;
//! assert_eq!((young.get(), young.spec().unit), (1e5, "Pa"));
//! assert!(Young::new(-1.0).is_err());
//! # Ok::<(), gingerbread::quantity::OutOfRange>(())
//! ```

use std::ops::Bound;

/// Specification of a quantity, for error messages and sliders.
#[derive(Debug, PartialEq)]
pub struct Spec {
    /// Name in words, such as `Young's modulus`.
    pub name: &'static str,
    /// Unit symbol, such as `Pa`; empty for pure numbers.
    pub unit: &'static str,
    /// Smallest allowed value.
    pub lower: Bound<f64>,
    /// Largest allowed value.
    pub upper: Bound<f64>,
    /// Range of a slider. Values outside it but inside the bounds can still be typed.
    pub slider: (f64, f64),
    /// Whether a slider should be logarithmic.
    pub logarithmic: bool,
    /// One sentence with the formula, for tooltips.
    pub help: &'static str,
}

impl Spec {
    /// Whether the value is a number inside the bounds.
    pub const fn allows(&self, value: f64) -> bool {
        let above = match self.lower {
            Bound::Included(limit) => value >= limit,
            Bound::Excluded(limit) => value > limit,
            Bound::Unbounded => value > f64::NEG_INFINITY,
        };
        let below = match self.upper {
            Bound::Included(limit) => value <= limit,
            Bound::Excluded(limit) => value < limit,
            Bound::Unbounded => value < f64::INFINITY,
        };
        above && below
    }

    /// Bounds in words with their unit, such as `greater than 0 and at most 1e15 Pa`.
    pub fn range(&self) -> String {
        let lower = match self.lower {
            Bound::Included(limit) => Some(format!("at least {}", Short(limit))),
            Bound::Excluded(limit) => Some(format!("greater than {}", Short(limit))),
            Bound::Unbounded => None,
        };
        let upper = match self.upper {
            Bound::Included(limit) => Some(format!("at most {}", Short(limit))),
            Bound::Excluded(limit) => Some(format!("less than {}", Short(limit))),
            Bound::Unbounded => None,
        };
        let bounds: Vec<_> = lower.into_iter().chain(upper).collect();
        with_unit(&bounds.join(" and "), "", self.unit)
    }
}

/// Text of a number with the prefix and symbol of its unit: `30 kPa`, `45°`, and `5 /s` for `1/s`.
pub fn with_unit(number: &str, prefix: &str, unit: &str) -> String {
    let gap = if unit.is_empty() || unit == "%" || unit == "°" { "" } else { " " };
    let unit = unit.strip_prefix('1').filter(|rest| rest.starts_with('/')).unwrap_or(unit);
    format!("{number}{gap}{prefix}{unit}")
}

/// Number without trailing zeros: `1e15`, `0.5`.
struct Short(f64);

impl std::fmt::Display for Short {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let size = self.0.abs();
        if size != 0.0 && !(1e-3..1e5).contains(&size) {
            write!(out, "{:e}", self.0)
        } else {
            write!(out, "{}", self.0)
        }
    }
}

/// Error of a value that is outside the range of its quantity, or not a number.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{name} must be {range}, got {}", Short(*.value))]
pub struct OutOfRange {
    name: &'static str,
    range: String,
    value: f64,
}

/// Checked number without its type, as a slider needs it.
pub trait Quantity {
    /// Name, unit and range.
    fn spec(&self) -> &'static Spec;
    /// The value, in the unit of the spec.
    fn get(&self) -> f64;
    /// Replaces the value.
    ///
    /// # Errors
    /// [`OutOfRange`] if the value is not allowed. The old value is kept.
    fn set(&mut self, value: f64) -> Result<(), OutOfRange>;
}

macro_rules! quantities {
    ($($(#[doc = $help:literal])+ $Name:ident: $words:literal [$unit:literal] in $lower:expr, $upper:expr;
        slider $from:literal to $to:literal, $scale:ident;)+) => {$(
        $(#[doc = $help])+
        #[derive(Clone, Copy, Debug, PartialEq, PartialOrd, serde::Serialize, serde::Deserialize)]
        #[serde(try_from = "f64", into = "f64")]
        pub struct $Name(f64);

        impl $Name {
            /// Name, unit and range.
            pub const SPEC: Spec = Spec {
                name: $words,
                unit: $unit,
                lower: $lower,
                upper: $upper,
                slider: ($from, $to),
                logarithmic: quantities!(@$scale),
                help: concat!($($help),+),
            };

            /// A checked value, in the unit of [`Self::SPEC`].
            ///
            /// # Errors
            /// [`OutOfRange`] if the value is not in the allowed range, or not a number.
            pub fn new(value: f64) -> Result<Self, OutOfRange> {
                if Self::SPEC.allows(value) {
                    Ok(Self(value))
                } else {
                    Err(OutOfRange { name: Self::SPEC.name, range: Self::SPEC.range(), value })
                }
            }

            /// The value, in the unit of [`Self::SPEC`].
            pub const fn get(self) -> f64 {
                self.0
            }

            /// Constant value. In a constant, a value out of range does not compile.
            #[allow(dead_code, reason = "not every quantity has a default")]
            pub(crate) const fn literal(value: f64) -> Self {
                assert!(Self::SPEC.allows(value), "out of range");
                Self(value)
            }
        }

        impl TryFrom<f64> for $Name {
            type Error = OutOfRange;
            fn try_from(value: f64) -> Result<Self, OutOfRange> {
                Self::new(value)
            }
        }

        impl From<$Name> for f64 {
            fn from(value: $Name) -> f64 {
                value.0
            }
        }

        impl Quantity for $Name {
            fn spec(&self) -> &'static Spec {
                const { &Self::SPEC }
            }
            fn get(&self) -> f64 {
                self.0
            }
            fn set(&mut self, value: f64) -> Result<(), OutOfRange> {
                *self = Self::new(value)?;
                Ok(())
            }
        }
    )+};
    (@logarithmic) => { true };
    (@linear) => { false };
}

use Bound::{Excluded, Included};

quantities! {
    /// E: axial stress over axial strain of a thin bar, at small strain.
    Young: "Young's modulus" ["Pa"] in Excluded(0.0), Included(1e15); slider 1.0 to 1e6, logarithmic;
    /// nu: how much a bar narrows when it is pulled, as a share of how much it lengthens. Plane strain needs less than 0.5; plane stress allows 0.5.
    Poisson: "Poisson's ratio" [""] in Excluded(-1.0), Included(0.5); slider 0.0 to 0.49, linear;
    /// rho: mass per area of the sheet, whose thickness is 1 m.
    Density: "density" ["kg/m³"] in Excluded(0.0), Included(1e12); slider 1.0 to 1e4, logarithmic;
    /// Mass of the whole body, spread equally over its vertices.
    Mass: "total mass" ["kg"] in Excluded(0.0), Included(1e12); slider 0.1 to 1e3, logarithmic;
    /// A point's distance from the origin along one axis.
    Coordinate: "coordinate" ["m"] in Included(-1e15), Included(1e15); slider 0.0 to 1.0, linear;
    /// Simulated time since the start.
    Time: "time" ["s"] in Included(0.0), Included(1e12); slider 0.0 to 10.0, linear;
    /// Time for one swing to and fro.
    Period: "period" ["s"] in Excluded(0.0), Included(1e9); slider 0.1 to 10.0, logarithmic;
    /// L: distance from the pivot to the mass.
    Length: "length" ["m"] in Excluded(0.0), Included(1e9); slider 0.01 to 1.0, linear;
    /// Size of a field of a pattern.
    PatternSize: "pattern size" ["m"] in Excluded(0.0), Included(1e9); slider 0.01 to 1.0, logarithmic;
    /// Extent along x, before any turn.
    Width: "width" ["m"] in Excluded(0.0), Included(1e9); slider 0.01 to 1.0, linear;
    /// Extent along y, before any turn.
    Height: "height" ["m"] in Excluded(0.0), Included(1e9); slider 0.01 to 1.0, linear;
    /// Extent along z, before any turn.
    Depth: "depth" ["m"] in Excluded(0.0), Included(1e9); slider 0.01 to 1.0, linear;
    /// A factor that multiplies lengths.
    Factor: "factor" [""] in Excluded(0.0), Included(1e9); slider 0.5 to 2.0, logarithmic;
    /// How far vertices are moved irregularly at most, as a share of the size of their body.
    Noise: "noise" [""] in Included(0.0), Included(1.0); slider 0.0 to 0.1, linear;
    /// An angle, counter-clockwise.
    Angle: "angle" ["°"] in Included(-3600.0), Included(3600.0); slider -180.0 to 180.0, linear;
    /// Rate of change of a coordinate.
    Velocity: "velocity" ["m/s"] in Included(-1e9), Included(1e9); slider -10.0 to 10.0, linear;
    /// Velocity along x.
    VelocityX: "velocity along x" ["m/s"] in Included(-1e9), Included(1e9); slider -10.0 to 10.0, linear;
    /// Velocity along y.
    VelocityY: "velocity along y" ["m/s"] in Included(-1e9), Included(1e9); slider -10.0 to 10.0, linear;
    /// Rate of turning, counter-clockwise.
    Spin: "spin" ["rad/s"] in Included(-1e9), Included(1e9); slider -20.0 to 20.0, linear;
    /// Force along x over the area of an edge at rest.
    TractionX: "traction along x" ["Pa"] in Included(-1e15), Included(1e15); slider -1000.0 to 1000.0, linear;
    /// Force along y over the area of an edge at rest.
    TractionY: "traction along y" ["Pa"] in Included(-1e15), Included(1e15); slider -1000.0 to 1000.0, linear;
    /// p: force against an edge over its area, positive from outside.
    Pressure: "pressure" ["Pa"] in Included(-1e15), Included(1e15); slider -1000.0 to 1000.0, linear;
    /// A known value, in the unit of what is measured.
    KnownValue: "known value" [""] in Included(-1e15), Included(1e15); slider -1.0 to 1.0, linear;
    /// Greatest difference from a known value, in the same unit.
    Deviation: "tolerance" [""] in Included(0.0), Included(1e15); slider 0.0 to 1.0, linear;
    /// g: every free particle is accelerated by this much, whatever its mass.
    Gravity: "gravity" ["m/s²"] in Included(-1e6), Included(1e6); slider 0.0 to 20.0, linear;
    /// alpha: the force -alpha m v on every vertex; a free body loses its speed as exp(-alpha t).
    DampingRate: "mass damping" ["1/s"] in Included(0.0), Included(1e6); slider 0.0 to 20.0, linear;
    /// beta: a viscous stress beta C : dE/dt beside the elastic one; a rigid motion feels none of it.
    DampingTime: "stiffness damping" ["s"] in Included(0.0), Included(1e3); slider 0.0 to 0.01, linear;
    /// k: force over distance.
    Spring: "spring stiffness" ["N/m"] in Included(0.0), Included(1e12); slider 1.0 to 1e4, logarithmic;
    /// D: the share of its velocity that a vertex loses in a step, however long the step is.
    VerletDamping: "velocity damping" [""] in Included(0.0), Included(1.0); slider 0.0 to 0.1, linear;
    /// How large the error of an inner step may be, as a share of each position and velocity.
    RelativeTolerance: "relative tolerance" [""] in Included(1e-14), Included(1.0); slider 1e-10 to 1e-2, logarithmic;
    /// How large the error of an inner step may be beside that, in metres and in metres per second.
    AbsoluteTolerance: "absolute tolerance" [""] in Included(1e-15), Included(1.0); slider 1e-10 to 1e-2, logarithmic;
    /// How far what lies beside a sleeping region of a body may move before the region wakes, as a share of the size of the region.
    SleepTolerance: "sleep tolerance" [""] in Included(1e-9), Included(0.1); slider 1e-6 to 1e-2, logarithmic;
    /// k of the springs along the sides of cells: force over distance.
    StructuralSpring: "structural stiffness" ["N/m"] in Included(0.0), Included(1e12); slider 1.0 to 1e4, logarithmic;
    /// k of the springs along the diagonals of cells: force over distance.
    ShearSpring: "shear stiffness" ["N/m"] in Included(0.0), Included(1e12); slider 1.0 to 1e4, logarithmic;
    /// k of the springs between every other particle of a row: force over distance.
    FlexionSpring: "flexion stiffness" ["N/m"] in Included(0.0), Included(1e12); slider 1.0 to 1e4, logarithmic;
    /// r: the length at which a spring neither pulls nor pushes.
    RestLength: "rest length" ["m"] in Included(0.0), Included(1e9); slider 0.01 to 1.0, linear;
    /// Mass of each particle of a net.
    ParticleMass: "particle mass" ["kg"] in Excluded(0.0), Included(1e12); slider 0.001 to 10.0, logarithmic;
    /// k: the force -k v on every vertex, whatever its mass.
    DragCoefficient: "drag" ["N s/m"] in Included(0.0), Included(1e9); slider 0.0 to 1.0, linear;
    /// Distance from a centre.
    Radius: "radius" ["m"] in Excluded(0.0), Included(1e9); slider 0.01 to 0.5, linear;
    /// g of a pendulum: downwards.
    Weight: "gravity" ["m/s²"] in Excluded(0.0), Included(1e6); slider 0.5 to 20.0, linear;
    /// How far from hanging straight down a pendulum starts, at rest.
    Swing: "start angle" ["°"] in Excluded(0.0), Included(179.9); slider 1.0 to 179.0, linear;
    /// eps: how near a wall a vertex feels it.
    Reach: "contact reach" ["m"] in Included(0.0), Included(1e6); slider 0.0 to 0.05, linear;
    /// mu: the greatest friction force as a share of the force that presses a vertex to a wall.
    FrictionCoefficient: "friction" [""] in Included(0.0), Included(1e3); slider 0.0 to 1.0, linear;
    /// e: the share of its velocity towards a wall that a vertex gets back.
    RestitutionCoefficient: "restitution" [""] in Included(0.0), Included(1.0); slider 0.0 to 1.0, linear;
    /// Modulus of the skin as a multiple of Young's modulus: a stiffer skin is compressed less and needs shorter steps.
    SkinModulus: "skin modulus" ["E"] in Excluded(0.0), Included(1e6); slider 1.0 to 100.0, logarithmic;
    /// Thickness of the skin as a multiple of the mean length of the boundary edges.
    SkinThickness: "skin thickness" ["edges"] in Excluded(0.0), Included(1.0); slider 0.1 to 1.0, logarithmic;
    /// v: fastest impact that the skin stops within its thickness; its modulus is at least 6 rho v².
    ImpactSpeed: "fastest impact" ["m/s"] in Included(0.0), Included(1e6); slider 0.0 to 20.0, linear;
    /// c: the pressure of the skin is greater by the factor 1 + c v while it is compressed at the speed v.
    Dissipation: "dissipation" ["s/m"] in Included(0.0), Included(1e6); slider 0.0 to 10.0, linear;
    /// s: how hard squeezed triangles push back, as a share of 2 mu + lambda.
    CompressionStrength: "compression guard" [""] in Included(0.0), Included(1e6); slider 0.0 to 4.0, linear;
    /// About how many triangles a mesh should have: more are more accurate, and cost more.
    Triangles: "number of triangles" [""] in Included(100.0), Included(2e5); slider 200.0 to 20000.0, logarithmic;
    /// How far an outline may be moved to do with fewer points.
    Tolerance: "simplification" ["m"] in Included(0.0), Included(1e9); slider 0.0 to 0.05, linear;
    /// Thickness of a membrane at rest.
    Thickness: "thickness" ["m"] in Excluded(0.0), Included(1e6); slider 1e-4 to 0.1, logarithmic;
    /// Passes over all springs in a step: more keep the lengths better, and cost more.
    Passes: "passes" [""] in Included(1.0), Included(1000.0); slider 1.0 to 20.0, linear;
    /// Share of the change of length of springs along the sides of cells that is corrected in a pass.
    StructuralCorrection: "structural share" [""] in Included(0.0), Included(1.0); slider 0.0 to 1.0, linear;
    /// Share of the change of length of springs along the diagonals of cells that is corrected in a pass.
    ShearCorrection: "shear share" [""] in Included(0.0), Included(1.0); slider 0.0 to 1.0, linear;
    /// Share of the change of length of springs between every other particle of a row that is corrected in a pass.
    FlexionCorrection: "flexion share" [""] in Included(0.0), Included(1.0); slider 0.0 to 1.0, linear;
    /// Distance to which particles of nets are pushed apart; none at 0.
    Separation: "separation" ["m"] in Included(0.0), Included(1e9); slider 0.0 to 0.1, linear;
    /// w: speed of the air.
    WindSpeed: "wind speed" ["m/s"] in Included(0.0), Included(1e6); slider 0.0 to 20.0, linear;
    /// c: pressure on a face over the velocity of the air along its normal.
    FaceResistance: "resistance" ["Pa s/m"] in Included(0.0), Included(1e9); slider 0.001 to 10.0, logarithmic;
    /// s: share of the velocity of the cloth that the wind feels; at 0 moving cloth feels the wind of cloth at rest.
    OwnMotion: "own motion" [""] in Included(0.0), Included(1.0); slider 0.0 to 1.0, linear;
    /// g: share by which gusts change the speed of the wind.
    GustShare: "gusts" [""] in Included(0.0), Included(10.0); slider 0.0 to 1.0, linear;
    /// T: time from gust to gust.
    GustPeriod: "gust period" ["s"] in Excluded(0.0), Included(1e6); slider 0.1 to 10.0, logarithmic;
    /// b: root mean square of the turbulence as a share of the speed.
    TurbulenceShare: "turbulence" [""] in Included(0.0), Included(10.0); slider 0.0 to 1.0, linear;
    /// Largest wavelength of the turbulence.
    EddySize: "largest eddies" ["m"] in Excluded(0.0), Included(1e9); slider 0.1 to 2.0, logarithmic;
    /// G: circulation of a vortex about its axis.
    Circulation: "circulation" ["m²/s"] in Included(-1e9), Included(1e9); slider -20.0 to 20.0, linear;
    /// r0: the air turns fastest at 1.12 times this distance from the axis.
    CoreRadius: "core radius" ["m"] in Excluded(0.0), Included(1e9); slider 0.05 to 1.0, logarithmic;
    /// w: speed of the air along the axis.
    Updraft: "updraft" ["m/s"] in Included(-1e6), Included(1e6); slider -10.0 to 10.0, linear;
    /// r: drops in a second.
    DropRate: "drops" ["1/s"] in Included(0.0), Included(1e6); slider 0.0 to 500.0, linear;
    /// J: momentum that a drop gives to the cloth.
    DropImpulse: "drop impulse" ["N s"] in Included(0.0), Included(1e9); slider 1e-6 to 0.01, logarithmic;
    /// T: how long a drop pushes.
    DropDuration: "drop duration" ["s"] in Excluded(0.0), Included(1e3); slider 0.01 to 0.2, logarithmic;
    /// Rate at which a violated constraint returns, like a critically damped oscillator.
    RecoveryRate: "recovery rate" ["1/s"] in Included(0.0), Included(1e6); slider 0.0 to 60.0, linear;
    /// s: multiplies a force.
    ForceFactor: "force factor" [""] in Included(-1e9), Included(1e9); slider 0.0 to 2.0, linear;
    /// s: bending rigidity as a multiple of that of a plate of the material.
    BendingFactor: "bending factor" [""] in Included(0.0), Included(1e9); slider 0.0 to 2.0, linear;
    /// Equal cells along a side of a rectangle.
    Cells: "number of cells" [""] in Included(1.0), Included(1e6); slider 1.0 to 100.0, linear;
    /// Springs in a row.
    Springs: "number of springs" [""] in Included(1.0), Included(1e5); slider 1.0 to 50.0, linear;
    /// Rings of vertices about the centre of a disk.
    Rings: "number of rings" [""] in Included(1.0), Included(500.0); slider 1.0 to 50.0, linear;
}

/// A point or a vector in space, written `(x, y, z)` in level files.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SpacePoint(pub Coordinate, pub Coordinate, pub Coordinate);

impl SpacePoint {
    /// Coordinates \[m\].
    pub const fn get(self) -> [f64; 3] {
        [self.0.get(), self.1.get(), self.2.get()]
    }

    /// Checked point.
    ///
    /// # Errors
    /// [`OutOfRange`] if a coordinate is not finite.
    pub fn new([x, y, z]: [f64; 3]) -> Result<Self, OutOfRange> {
        Ok(Self(Coordinate::new(x)?, Coordinate::new(y)?, Coordinate::new(z)?))
    }
}

/// A point of a scene: of the plane, written `(x, y)` in level files, or in space, written `(x, y, z)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Position {
    /// Of the plane.
    Plane(Point),
    /// In space.
    Space(SpacePoint),
}

impl Position {
    /// Checked point with two or three coordinates \[m\]; `None` for another number, or if one is not finite.
    pub fn new(coordinates: &[f64]) -> Option<Self> {
        match *coordinates {
            [x, y] => Point::new([x, y]).ok().map(Self::Plane),
            [x, y, z] => SpacePoint::new([x, y, z]).ok().map(Self::Space),
            _ => None,
        }
    }

    /// Number of coordinates.
    pub const fn dimension(self) -> usize {
        match self {
            Self::Plane(_) => 2,
            Self::Space(_) => 3,
        }
    }

    /// Coordinates \[m\]; the third is zero in the plane.
    pub const fn get(self) -> [f64; 3] {
        match self {
            Self::Plane(point) => {
                let [x, y] = point.get();
                [x, y, 0.0]
            }
            Self::Space(point) => point.get(),
        }
    }

    /// Its coordinates alone \[m\].
    pub fn coordinates(self) -> impl Iterator<Item = f64> {
        self.get().into_iter().take(self.dimension())
    }
}

impl serde::Serialize for Position {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Plane(point) => point.serialize(to),
            Self::Space(point) => point.serialize(to),
        }
    }
}

impl<'de> serde::Deserialize<'de> for Position {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Coordinates;
        impl<'de> serde::de::Visitor<'de> for Coordinates {
            type Value = Position;

            fn expecting(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                out.write_str("a point (x, y) or (x, y, z)")
            }

            fn visit_seq<A: serde::de::SeqAccess<'de>>(self, mut all: A) -> Result<Position, A::Error> {
                let missing = |number: usize| serde::de::Error::invalid_length(number, &self);
                let x = all.next_element()?.ok_or_else(|| missing(0))?;
                let y = all.next_element()?.ok_or_else(|| missing(1))?;
                let z: Option<Coordinate> = all.next_element()?;
                Ok(z.map_or(Position::Plane(Point(x, y)), |z| Position::Space(SpacePoint(x, y, z))))
            }
        }
        from.deserialize_any(Coordinates)
    }
}

/// A point or a vector of the plane, written `(x, y)` in level files.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Point(pub Coordinate, pub Coordinate);

impl Point {
    /// Coordinates \[m\].
    pub const fn get(self) -> [f64; 2] {
        [self.0.get(), self.1.get()]
    }

    /// Checked point.
    ///
    /// # Errors
    /// [`OutOfRange`] if a coordinate is not finite.
    pub fn new([x, y]: [f64; 2]) -> Result<Self, OutOfRange> {
        Ok(Self(Coordinate::new(x)?, Coordinate::new(y)?))
    }
}

//! Probes: quantities of a running scene as columns of numbers, for the window and for tables over time.
//!
//! ```
//! use gingerbread::{files, levels, meshes::NoFiles, probe::Probe, sandbox::Sandbox};
//!
//! let level = files::parse(levels::built_in("gingerbread").ok_or("there is no such level")?, "gingerbread.ron")?;
//! let sandbox = Sandbox::new(level, Box::new(NoFiles))?;
//! let probe: Probe = "triangle:12".parse()?;
//! probe.check(sandbox.simulation().scene())?;
//! let columns = probe.columns(sandbox.simulation().scene());
//! let numbers = probe.numbers(sandbox.simulation());
//! let at = columns.iter().position(|column| column.name == "triangle_12_j").ok_or("there is no such column")?;
//! assert!((numbers[at] - 1.0).abs() < 1e-12, "at rest det F is 1");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::{
    elements::PointStress,
    scene::{Owner, Scene},
    simulation::Simulation,
};
use nalgebra::Matrix2;
use std::{fmt, str::FromStr};

/// What is measured. Vertices and triangles have the numbers that the level and its saved states give them: of all bodies, then of all nets,
/// then of all membranes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Probe {
    /// Energies by kind, and their sum \[J\].
    Energy,
    /// Linear and angular momentum.
    Momentum,
    /// Least det F of all triangles of bodies, and how many are inverted.
    Inversion,
    /// The force with which all pins hold their vertices \[N\].
    Reaction,
    /// Position, velocity and displacement from the start of a vertex.
    Vertex(usize),
    /// Forces on a vertex, by effect \[N\].
    Forces(usize),
    /// Deformation, strain and stress of a triangle.
    Triangle(usize),
    /// The numbers of a toy, and the exact ones.
    Numbers,
}

/// A column of a probe.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its name in tables, with that of its probe.
    pub name: String,
    /// Its symbol or name beside that of its probe.
    pub label: String,
    /// Symbol of its unit.
    pub unit: &'static str,
    /// What it is, if that needs words.
    pub about: &'static str,
    /// Whether it is one of many that few are interested in.
    pub is_detail: bool,
}

impl FromStr for Probe {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = Self::OF_ALL.into_iter().find(|probe| probe.to_string() == text);
        let numbered = || {
            let (kind, number) = text.split_once(':')?;
            let number = number.parse().ok()?;
            [Self::Vertex(number), Self::Forces(number), Self::Triangle(number)]
                .into_iter()
                .find(|probe| probe.kind() == kind)
        };
        known.or_else(numbered).ok_or_else(|| {
            "expected energy, momentum, min_j, reaction, vertex:NUMBER, forces:NUMBER, triangle:NUMBER or, of a toy, numbers"
                .to_owned()
        })
    }
}

impl fmt::Display for Probe {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Vertex(place) | Self::Forces(place) | Self::Triangle(place) => write!(out, "{}:{place}", self.kind()),
            _ => out.write_str(self.kind()),
        }
    }
}

/// Symbols of the axes.
const AXES: [&str; 3] = ["x", "y", "z"];

impl Probe {
    /// Those of a whole scene.
    pub const OF_ALL: [Self; 5] = [Self::Energy, Self::Momentum, Self::Inversion, Self::Reaction, Self::Numbers];

    /// Its name without a number.
    const fn kind(self) -> &'static str {
        match self {
            Self::Energy => "energy",
            Self::Momentum => "momentum",
            Self::Inversion => "min_j",
            Self::Reaction => "reaction",
            Self::Vertex(_) => "vertex",
            Self::Forces(_) => "forces",
            Self::Triangle(_) => "triangle",
            Self::Numbers => "numbers",
        }
    }

    /// Its name in words, with the part that it belongs to.
    pub fn title(self, scene: &Scene) -> String {
        let names: Vec<_> = scene.part_names().collect();
        let of = |part: usize, number: usize| match names.get(part) {
            Some(name) => format!("{number} of {name}"),
            None => number.to_string(),
        };
        let vertex = |place: usize| {
            let (owner, number) = scene.owner_of(scene.unlisted_vertex(place)?)?;
            let part = match owner {
                Owner::Body(number) => number,
                Owner::Net(number) => scene.bodies.len() + number,
                Owner::Membrane(number) => scene.bodies.len() + scene.nets.len() + number,
            };
            Some(of(part, number))
        };
        match self {
            Self::Energy => "Energies".to_owned(),
            Self::Momentum => "Momentum".to_owned(),
            Self::Inversion => "Smallest J".to_owned(),
            Self::Reaction => "Force of the pins".to_owned(),
            Self::Numbers => "Numbers".to_owned(),
            Self::Vertex(place) => format!("Vertex {}", vertex(place).unwrap_or_else(|| place.to_string())),
            Self::Forces(place) => format!("Forces on vertex {}", vertex(place).unwrap_or_else(|| place.to_string())),
            Self::Triangle(place) => match TriangleOf::find(scene, place) {
                Some(TriangleOf { part, number, .. }) => format!("Triangle {}", of(part, number)),
                None => format!("Triangle {place}"),
            },
        }
    }

    /// Checks that a scene has it.
    ///
    /// # Errors
    /// A sentence.
    pub fn check(self, scene: &Scene) -> Result<(), String> {
        let triangles = TriangleOf::count(scene);
        let is_there = match self {
            Self::Numbers => scene.toy.is_some(),
            Self::Inversion => !scene.bodies.is_empty(),
            Self::Vertex(place) | Self::Forces(place) => scene.toy.is_none() && place < scene.vertices(),
            Self::Triangle(place) => place < triangles,
            Self::Energy | Self::Momentum | Self::Reaction => scene.toy.is_none(),
        };
        let what = match self {
            Self::Vertex(_) | Self::Forces(_) if scene.toy.is_none() => {
                format!("its vertices are 0 to {}", scene.vertices().max(1) - 1)
            }
            _ if scene.toy.is_some() => "a toy has numbers alone".to_owned(),
            Self::Inversion => "it has no bodies".to_owned(),
            Self::Triangle(_) if triangles == 0 => "it has neither bodies nor membranes".to_owned(),
            Self::Triangle(_) => format!("its triangles are 0 to {}", triangles - 1),
            _ => "it is no toy".to_owned(),
        };
        if is_there { Ok(()) } else { Err(format!("there is no {self} in this level: {what}")) }
    }

    /// Its columns, in the order of its [`Self::numbers`].
    pub fn columns(self, scene: &Scene) -> Vec<Column> {
        let axes = &AXES[..scene.dimension];
        let prefix = match self {
            Self::Vertex(place) | Self::Forces(place) | Self::Triangle(place) => format!("{}_{place}_", self.kind()),
            _ => String::new(),
        };
        let column = |label: &str, unit| Column {
            name: format!("{prefix}{label}"),
            label: label.replace('_', " "),
            unit,
            about: "",
            is_detail: false,
        };
        let along =
            |kind: &str, unit| axes.iter().map(|axis| column(&format!("{kind}{axis}"), unit)).collect::<Vec<_>>();
        match self {
            Self::Energy => {
                ["kinetic", "elastic", "contact", "potential", "energy"].map(|label| column(label, "J")).into()
            }
            Self::Inversion => [column("min_j", ""), column("inverted", "")].into(),
            Self::Momentum => {
                let turns: &[_] = if scene.dimension == 2 { &["z"] } else { axes };
                let turns = turns.iter().map(|axis| column(&format!("angular_momentum_{axis}"), "kg m²/s"));
                along("momentum_", "kg m/s").into_iter().chain(turns).collect()
            }
            Self::Reaction => along("reaction_", "N"),
            Self::Vertex(_) => [along("", "m"), along("v", "m/s"), along("u", "m")].concat(),
            Self::Forces(_) => {
                let of_effect = |name: String| along(&format!("{name}_"), "N");
                let mut all: Vec<_> = names_of_effects(scene).into_iter().flat_map(of_effect).collect();
                all.extend(along("sum_", "N"));
                all
            }
            Self::Triangle(_) => {
                let columns = TRIANGLE.iter().enumerate();
                let of = |(place, (name, label, unit, about)): (usize, &'static (&str, &str, &str, &str))| Column {
                    label: (*label).to_owned(),
                    about,
                    is_detail: place >= MAIN,
                    ..column(name, unit)
                };
                columns.map(of).collect()
            }
            Self::Numbers => {
                let columns = || scene.toy.iter().flat_map(|toy| toy.kind().columns());
                let exact = columns().map(|name| column(&format!("exact_{name}"), ""));
                columns().map(|name| column(name, "")).chain(exact).collect()
            }
        }
    }

    /// Its numbers now; none where the scene does [not have it](Self::check).
    pub fn numbers(self, simulation: &Simulation) -> Vec<f64> {
        let (scene, state) = (simulation.scene(), simulation.state());
        let dimension = scene.dimension;
        match self {
            Self::Energy => {
                let energies = simulation.energies();
                vec![energies.kinetic, energies.elastic, energies.contact, energies.potential, energies.total()]
            }
            Self::Inversion => {
                let (least, inverted) = simulation.inversion();
                vec![least, inverted as f64]
            }
            Self::Momentum => {
                let [momentum, angular] = simulation.momenta();
                let turns = if dimension == 2 { &angular[2..] } else { &angular[..] };
                momentum[..dimension].iter().chain(turns).copied().collect()
            }
            Self::Reaction => {
                let forces = net_forces(simulation);
                let pinned = |axis: usize| scene.pins.iter().map(move |pin| dimension * *pin as usize + axis);
                (0..dimension).map(|axis| 0.0 - pinned(axis).map(|number| forces[number]).sum::<f64>()).collect()
            }
            Self::Vertex(place) => {
                let Some(own) = numbers_of(scene, place) else { return Vec::new() };
                let displacement = own.clone().map(|number| state.x[number] - scene.start.x[number]);
                state.x[own.clone()].iter().chain(&state.v[own.clone()]).copied().chain(displacement).collect()
            }
            Self::Forces(place) => {
                let Some(own) = numbers_of(scene, place) else { return Vec::new() };
                let mut all: Vec<_> = forces(simulation).flat_map(|forces| forces[own.clone()].to_vec()).collect();
                let sums: Vec<f64> =
                    (0..dimension).map(|axis| all.iter().skip(axis).step_by(dimension).sum()).collect();
                all.extend(sums);
                all
            }
            Self::Triangle(place) => TriangleOf::find(scene, place).map_or_else(Vec::new, |own| own.numbers(&state.x)),
            Self::Numbers => {
                let exact = scene.toy.iter().flat_map(|toy| toy.kind().exact(state.time));
                state.x.iter().copied().chain(exact).collect()
            }
        }
    }
}

/// Numbers of a vertex in flat vectors, by its place where the level lists all of them.
fn numbers_of(scene: &Scene, place: usize) -> Option<std::ops::Range<usize>> {
    let vertex = scene.unlisted_vertex(place)?;
    Some(scene.numbers(&(vertex..vertex + 1)))
}

/// Names of the effects of a scene, elements first, as they are in the names of columns; of several with a name, all after the first have
/// their number.
fn names_of_effects(scene: &Scene) -> Vec<String> {
    let plain = |name: &str| name.to_lowercase().replace(|c: char| !c.is_alphanumeric(), "_");
    let before = |end: usize| scene.effects[..end].iter().map(|effect| effect.name());
    let named = |(number, name): (usize, &str)| match before(number).filter(|other| *other == name).count() {
        0 => plain(name),
        count => format!("{}{}", plain(name), count + 1),
    };
    before(scene.effects.len()).enumerate().map(named).collect()
}

/// The forces of each effect on all vertices, elements first \[N\].
fn forces(simulation: &Simulation) -> impl Iterator<Item = Vec<f64>> {
    let (scene, state) = (simulation.scene(), simulation.state());
    let mut scratch = vec![0.0; scene.scratch()];
    let motion = scene.motion(state, simulation.grab());
    scene.effects.iter().map(move |effect| {
        let mut force = vec![0.0; state.x.len()];
        effect.force(motion, &mut scratch[..effect.scratch()], &mut force);
        force
    })
}

/// The sums of the forces of all effects on all vertices, flat, by the numbers of the scene \[N\]. Those of pins are not among them.
pub fn net_forces(simulation: &Simulation) -> Vec<f64> {
    forces(simulation).fold(vec![0.0; simulation.state().x.len()], |mut sum, forces| {
        sum.iter_mut().zip(forces).for_each(|(sum, force)| *sum += force);
        sum
    })
}

/// Columns of a triangle: name, symbol, unit, and what it is.
const TRIANGLE: [(&str, &str, &str, &str); 21] = [
    ("j", "J", "", "det F: area over rest area; negative where the triangle is inverted"),
    ("stretch1", "λ₁", "", "The greater principal stretch"),
    ("stretch2", "λ₂", "", "The smaller principal stretch; negative where the triangle is inverted"),
    ("von_mises", "Von Mises", "Pa", "Von Mises equivalent of the Cauchy stress"),
    ("pressure", "Pressure", "Pa", "-(σ₁₁ + σ₂₂ + σ₃₃)/3"),
    ("psi", "ψ", "J/m²", "Energy density of the rest area"),
    ("f11", "F₁₁", "", DEFORMATION),
    ("f12", "F₁₂", "", DEFORMATION),
    ("f21", "F₂₁", "", DEFORMATION),
    ("f22", "F₂₂", "", DEFORMATION),
    ("e11", "E₁₁", "", STRAIN),
    ("e12", "E₁₂", "", STRAIN),
    ("e22", "E₂₂", "", STRAIN),
    ("p11", "P₁₁", "Pa", PIOLA),
    ("p12", "P₁₂", "Pa", PIOLA),
    ("p21", "P₂₁", "Pa", PIOLA),
    ("p22", "P₂₂", "Pa", PIOLA),
    ("s11", "σ₁₁", "Pa", CAUCHY),
    ("s12", "σ₁₂", "Pa", CAUCHY),
    ("s22", "σ₂₂", "Pa", CAUCHY),
    ("s33", "σ₃₃", "Pa", "Cauchy stress through the thickness"),
];

const DEFORMATION: &str = "Deformation gradient; of a membrane in its own plane";
const STRAIN: &str = "Green strain (FᵀF - I)/2";
const PIOLA: &str = "First Piola-Kirchhoff stress ∂ψ/∂F";
const CAUCHY: &str = "Cauchy stress P Fᵀ/J";

/// Number of the columns of a triangle that come first, as most are interested in them.
const MAIN: usize = 6;

/// A triangle of a body or a membrane.
struct TriangleOf<'a> {
    scene: &'a Scene,
    /// Number of its body, or that of its membrane after all bodies and nets.
    part: usize,
    /// Its number there, as the level counts, and as the scene does.
    number: usize,
    own: usize,
}

impl<'a> TriangleOf<'a> {
    /// Number of all triangles.
    fn count(scene: &Scene) -> usize {
        let membranes = scene.membranes.iter().map(|membrane| membrane.elements.corners().len());
        scene.triangles.len() + membranes.sum::<usize>()
    }

    /// By its place where the level lists all of them.
    fn find(scene: &'a Scene, place: usize) -> Option<Self> {
        let triangle = scene.unlisted_triangle(place)?;
        let mut parts = scene.triangle_parts();
        let (part, first, _) = parts.find(|(_, first, mesh)| triangle < first + mesh.triangles().len())?;
        Some(Self { scene, part, number: place - first, own: triangle - first })
    }

    /// Its numbers at positions \[m\].
    fn numbers(&self, x: &[f64]) -> Vec<f64> {
        let others = self.scene.bodies.len() + self.scene.nets.len();
        if let Some(body) = self.scene.bodies.get(self.part) {
            row(&body.elements.gradient_of(x, self.own), body.elements.point_stress(x, self.own), 1.0)
        } else if let Some(membrane) = self.part.checked_sub(others).and_then(|part| self.scene.membranes.get(part)) {
            let f = membrane.elements.gradients(x).nth(self.own);
            f.map_or_else(Vec::new, |f| row(&f, membrane.elements.material().at(&f), membrane.elements.thickness()))
        } else {
            Vec::new()
        }
    }
}

/// The numbers of [`TRIANGLE`] at a deformation gradient with its stress, of a body as thick as this \[m\].
fn row(f: &Matrix2<f64>, point: PointStress, thickness: f64) -> Vec<f64> {
    let j = f.determinant();
    // The principal stretches are |q| + |r| and |q| - |r|, for the similar and the antisimilar part q and r of F.
    let q = libm::hypot(f.m11 + f.m22, f.m21 - f.m12) / 2.0;
    let r = libm::hypot(f.m11 - f.m22, f.m21 + f.m12) / 2.0;
    let strain = (f.transpose() * f - Matrix2::identity()) / 2.0;
    let (p, s) = (point.piola, point.piola * f.transpose() / j);
    let s33 = point.thickness / j;
    let pressure = -(s.m11 + s.m22 + s33) / 3.0;
    let mut all = vec![j, q + r, q - r, point.von_mises, pressure, point.energy * thickness];
    all.extend([f.m11, f.m12, f.m21, f.m22, strain.m11, strain.m12, strain.m22]);
    all.extend([p.m11, p.m12, p.m21, p.m22, s.m11, 0.5 * (s.m12 + s.m21), s.m22, s33]);
    debug_assert_eq!(all.len(), TRIANGLE.len());
    all
}

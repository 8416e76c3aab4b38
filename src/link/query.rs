//! Levels named in an address, with changes: `?level=gingerbread_house&model=n&young=3e4`.

use super::refused;
use crate::{
    effects::{EffectKind, Projection},
    files::{self, FileError},
    finish::{Colour, Pattern},
    integrators::IntegratorKind,
    level::{Level, RunMode, Substeps},
    levels,
    materials::{MaterialParameters, Model},
    meshes::{NoFiles, Pin},
    nets::NetKind,
    obstacles::ObstacleKind,
    quantity::{Coordinate, Gravity, Height, Point, Poisson, Width, Young},
    scene::Scene,
    study::with_triangles,
};
use percent_encoding::percent_decode_str;

/// How a page shows its level.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct View {
    /// The stage alone.
    pub embed: bool,
    /// With the edges of triangles and all springs.
    pub wireframe: bool,
    /// From where it is seen.
    pub camera: Option<Camera>,
}

/// From where a scene is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Camera {
    /// In the plane: the point in the middle \[m\], and the scale as a multiple of that at which the whole fits the stage.
    Plane([f64; 2], f64),
    /// In space: the point that the eye looks at and the radius about it that fills the stage \[m\], and the turn and the height of the eye
    /// \[rad\].
    Space([f64; 3], f64, [f64; 2]),
}

impl Camera {
    /// Number of coordinates of the scenes that it sees.
    pub const fn dimension(&self) -> usize {
        match self {
            Self::Plane(..) => 2,
            Self::Space(..) => 3,
        }
    }
}

/// Greatest coordinate of a camera \[m\], and greatest scale.
const FARTHEST: f64 = 1e12;

impl std::fmt::Display for Camera {
    /// As in an address, with as many digits as restore the same bits.
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let numbers = match *self {
            Self::Plane([x, y], scale) => vec![x, y, scale],
            Self::Space([x, y, z], radius, [yaw, pitch]) => vec![x, y, z, radius, yaw, pitch],
        };
        let texts: Vec<_> = numbers.iter().map(|number| format!("{number:e}")).collect();
        write!(out, "{}", texts.join(","))
    }
}

impl std::str::FromStr for Camera {
    type Err = ();

    fn from_str(text: &str) -> Result<Self, ()> {
        let number = |text: &str| text.parse().ok().filter(|number: &f64| number.abs() <= FARTHEST);
        let numbers: Vec<f64> = text.split(',').map(number).collect::<Option<_>>().ok_or(())?;
        match numbers[..] {
            [x, y, scale] if scale > 0.0 => Ok(Self::Plane([x, y], scale)),
            [x, y, z, radius, yaw, pitch] if radius > 0.0 => Ok(Self::Space([x, y, z], radius, [yaw, pitch])),
            _ => Err(()),
        }
    }
}

/// A change of a level, or of how it is shown.
struct Parameter {
    name: &'static str,
    /// What its values are.
    values: &'static str,
    change: Change,
}

enum Change {
    /// It names the level.
    Name,
    /// It changes any level.
    Any(fn(&mut Level, &str) -> Option<()>),
    /// It changes the cloth of Princeton's course.
    Princeton(fn(&mut Level, &str) -> Option<()>),
    /// It changes how a page shows the level, by values that are allowed.
    View(fn(&str) -> Option<()>),
}

/// All parameters, in the order in which they act.
const PARAMETERS: &[Parameter] = &[
    Parameter { name: "level", values: "the name of a built-in level", change: Change::Name },
    Parameter { name: "mode", values: "simulate or collide", change: Change::Any(mode) },
    Parameter { name: "model", values: "a constitutive model or its letter", change: Change::Any(model) },
    Parameter { name: "integrator", values: "an integrator, or e, t, r or i", change: Change::Any(integrator) },
    Parameter { name: "step", values: "the longest time step [s], at most 1/60", change: Change::Any(step) },
    Parameter { name: "young", values: "Young's modulus [Pa]", change: Change::Any(young) },
    Parameter { name: "poisson", values: "Poisson's ratio, from -1 to 0.5", change: Change::Any(poisson) },
    Parameter { name: "gravity", values: "true, false or an acceleration [m/s²]", change: Change::Any(gravity) },
    Parameter { name: "triangles", values: "about how many triangles all bodies have", change: Change::Any(triangles) },
    Parameter { name: "fabricLength", values: "a length from 1 to 10000 [m]", change: Change::Princeton(length) },
    Parameter { name: "object", values: "None, Sphere or Box", change: Change::Princeton(object) },
    Parameter { name: "movingSphere", values: "true or false", change: Change::Princeton(moving_sphere) },
    Parameter {
        name: "pinned",
        values: "None, Corners, OneEdge, TwoEdges, FourEdges or Random",
        change: Change::Princeton(pinned),
    },
    Parameter { name: "rain", values: "true or false", change: Change::Princeton(rain) },
    Parameter { name: "wind", values: "true or false", change: Change::Princeton(wind) },
    Parameter { name: "wave", values: "true or false", change: Change::Princeton(wave) },
    Parameter { name: "structuralSprings", values: "true or false", change: Change::Princeton(structural) },
    Parameter { name: "shearSprings", values: "true or false", change: Change::Princeton(shear) },
    Parameter { name: "bendingSprings", values: "true or false", change: Change::Princeton(bending) },
    Parameter { name: "avoidClothSelfIntersection", values: "true or false", change: Change::Princeton(separation) },
    Parameter { name: "clothColor", values: "six hexadecimal digits", change: Change::Princeton(colour) },
    Parameter { name: "showClothTexture", values: "true or false", change: Change::Princeton(texture) },
    Parameter { name: "wireframe", values: "true or false", change: Change::View(is_flag) },
    Parameter { name: "showConstraints", values: "true or false", change: Change::View(is_flag) },
    Parameter { name: "embed", values: "true or false", change: Change::View(is_flag) },
    Parameter {
        name: CAMERA,
        values: "x,y,scale in the plane, or x,y,z,radius,yaw,pitch in space",
        change: Change::View(is_camera),
    },
];

/// The parameters in an address: names, and values if they have some. Empty if it has no known one.
fn parameters(address: &str) -> Vec<(&str, String)> {
    let query = address.split_once('?').map_or("", |(_, query)| query.split('#').next().unwrap_or(""));
    let all: Vec<_> = query
        .split('&')
        .filter(|part| !part.is_empty())
        .map(|part| {
            part.split_once('=').map_or((part, String::new()), |(name, value)| {
                (name, percent_decode_str(value).decode_utf8_lossy().into_owned())
            })
        })
        .collect();
    let is_known = |name: &str| PARAMETERS.iter().any(|parameter| parameter.name == name);
    if all.iter().any(|(name, _)| is_known(name)) { all } else { Vec::new() }
}

/// Whether an address names a level.
pub(super) fn names_level(address: &str) -> bool {
    let is_shown_only = |name: &str| {
        PARAMETERS.iter().any(|parameter| parameter.name == name && matches!(parameter.change, Change::View(_)))
    };
    parameters(address).iter().any(|(name, _)| !is_shown_only(name))
}

/// The level that an address names.
pub(super) fn level(address: &str) -> Result<Level, FileError> {
    if address.len() > super::LONGEST {
        return Err(refused(format!("a link has {} kB at most", super::LONGEST >> 10)));
    }
    let given = parameters(address);
    let value_of = |name: &str| given.iter().find(|(own, _)| *own == name).map(|(_, value)| &**value);
    for (name, _) in &given {
        if !PARAMETERS.iter().any(|parameter| parameter.name == *name) {
            let known: Vec<_> = PARAMETERS.iter().map(|parameter| parameter.name).collect();
            return Err(refused(format!("there is no parameter {name}; those are: {}", known.join(", "))));
        }
        if given.iter().filter(|(other, _)| other == name).count() > 1 {
            return Err(refused(format!("{name} is there twice")));
        }
    }
    let name = value_of("level").unwrap_or(PRINCETON);
    let mut level = built_in(name).ok_or_else(|| {
        let names: Vec<_> = levels::BUILT_IN.iter().map(|(file, _)| file.trim_end_matches(".ron")).collect();
        refused(format!("level: there is no built-in level {name}; those are: {}", names.join(", ")))
    })?;
    for parameter in PARAMETERS {
        if let Some(value) = value_of(parameter.name) {
            parameter.set(&mut level, value)?;
        }
    }
    Ok(level)
}

/// Changes a level by a parameter of addresses, such as `young` or `model`.
///
/// # Errors
/// [`FileError::Access`] if there is no such parameter, if its value is wrong, or if the level does not have it.
pub fn set_parameter(level: &mut Level, name: &str, value: &str) -> Result<(), FileError> {
    let of_levels =
        || PARAMETERS.iter().filter(|parameter| matches!(parameter.change, Change::Any(_) | Change::Princeton(_)));
    let parameter = of_levels().find(|parameter| parameter.name == name).ok_or_else(|| {
        let known: Vec<_> = of_levels().map(|parameter| parameter.name).collect();
        refused(format!("there is no parameter {name}; those are: {}", known.join(", ")))
    })?;
    parameter.set(level, value)
}

impl Parameter {
    fn set(&self, level: &mut Level, value: &str) -> Result<(), FileError> {
        let Self { name, values, change } = self;
        let changed = match change {
            Change::Name => Some(()),
            Change::Any(change) => change(level, value),
            Change::Princeton(_) if projection(level).is_none() || sheet(level).is_none() => {
                return Err(refused(format!("{name}: only the cloths of Princeton's course have this parameter")));
            }
            Change::Princeton(change) => change(level, value),
            Change::View(allows) => allows(value),
        };
        changed.ok_or_else(|| refused(format!("{name}: expected {values}, and that the level has it; got {value:?}")))
    }
}

/// How a page shows the level in its address.
pub fn view(address: &str) -> View {
    let given = parameters(address);
    let is_on = |name: &str| given.iter().any(|(own, value)| *own == name && flag(value) == Some(true));
    let named = given.iter().find(|(own, _)| *own == CAMERA).map(|(_, value)| value.as_str());
    let camera = super::camera_text(address).or(named.map(Into::into)).and_then(|text| text.parse().ok());
    View { embed: is_on("embed"), wireframe: is_on("wireframe") || is_on("showConstraints"), camera }
}

/// Name of the parameter for the camera.
const CAMERA: &str = "camera";

fn is_flag(value: &str) -> Option<()> {
    flag(value).map(drop)
}

fn is_camera(value: &str) -> Option<()> {
    value.parse::<Camera>().ok().map(drop)
}

/// The level that parameters of Princeton's course change.
const PRINCETON: &str = "princeton_cloth";

fn built_in(name: &str) -> Option<Level> {
    files::parse(levels::built_in(name)?, name).ok()
}

fn flag(value: &str) -> Option<bool> {
    match value {
        "" | "true" => Some(true),
        "false" => Some(false),
        _ => None,
    }
}

fn mode(level: &mut Level, value: &str) -> Option<()> {
    level.mode = match value {
        "simulate" => RunMode::Simulate,
        "collide" => RunMode::Collide,
        _ => return None,
    };
    Some(())
}

fn model(level: &mut Level, value: &str) -> Option<()> {
    let has_material = !level.bodies.is_empty() || !level.membranes.is_empty();
    let model = value.parse::<Model>().ok().filter(|_| has_material)?;
    level.set_model(model).ok()
}

fn integrator(level: &mut Level, value: &str) -> Option<()> {
    level.integrator = value.parse::<IntegratorKind>().ok()?;
    Some(())
}

fn step(level: &mut Level, value: &str) -> Option<()> {
    level.substeps = Substeps::for_step(value.parse().ok()?)?;
    Some(())
}

fn triangles(level: &mut Level, value: &str) -> Option<()> {
    let wanted: f64 = value.parse().ok().filter(|wanted| (1.0..=200_000.0).contains(wanted))?;
    let scene = Scene::build(level, level.mode, &NoFiles, None).ok()?;
    let share = wanted / scene.triangles.len() as f64;
    *level = with_triangles(level, share).ok().filter(|_| share.is_finite())?;
    Some(())
}

fn young(level: &mut Level, value: &str) -> Option<()> {
    let young = Young::new(value.parse().ok()?).ok()?;
    each_material(level, |material| {
        MaterialParameters::new(material.model(), young, material.poisson(), material.plane()).ok()
    })
}

fn poisson(level: &mut Level, value: &str) -> Option<()> {
    let poisson = Poisson::new(value.parse().ok()?).ok()?;
    each_material(level, |material| {
        MaterialParameters::new(material.model(), material.young(), poisson, material.plane()).ok()
    })
}

/// Changes all materials, of which there must be one.
fn each_material(level: &mut Level, change: impl Fn(&MaterialParameters) -> Option<MaterialParameters>) -> Option<()> {
    let bodies = level.bodies.iter_mut().map(|body| &mut body.material);
    let mut all: Vec<_> = bodies.chain(level.membranes.iter_mut().map(|membrane| &mut membrane.material)).collect();
    for material in &mut all {
        **material = change(material)?;
    }
    (!all.is_empty()).then_some(())
}

fn gravity(level: &mut Level, value: &str) -> Option<()> {
    let is_gravity = |effect: &EffectKind| matches!(effect, EffectKind::Gravity(_));
    if let Some(is_on) = flag(value) {
        level.effects.retain(|effect| is_on || !is_gravity(&effect.effect));
        return Some(());
    }
    let down = Gravity::new(value.parse().ok()?).ok()?;
    let gravity = level.effects.iter_mut().find_map(|effect| match &mut effect.effect {
        EffectKind::Gravity(gravity) => Some(gravity),
        _ => None,
    })?;
    gravity.down = down;
    Some(())
}

/// The net of a cloth.
fn sheet(level: &mut Level) -> Option<&mut crate::nets::Sheet> {
    match &mut level.nets.first_mut()?.net {
        NetKind::Sheet(sheet) => Some(sheet),
        _ => None,
    }
}

fn projection(level: &mut Level) -> Option<&mut Projection> {
    level.effects.iter_mut().find_map(|effect| match &mut effect.effect {
        EffectKind::Projection(projection) => Some(projection),
        _ => None,
    })
}

/// Replaces the effects of a kind by those of another level of Princeton's course, or removes them.
fn take_effects(level: &mut Level, from: Option<&str>, is_kind: fn(&EffectKind) -> bool) -> Option<()> {
    level.effects.retain(|effect| !is_kind(&effect.effect));
    if let Some(from) = from {
        level.effects.extend(built_in(from)?.effects.into_iter().filter(|effect| is_kind(&effect.effect)));
    }
    Some(())
}

fn length(level: &mut Level, value: &str) -> Option<()> {
    let length: f64 = value.parse().ok().filter(|length| (1.0..=10_000.0).contains(length))?;
    let corner = Coordinate::new(-0.5 * length).ok()?;
    let sheet = sheet(level)?;
    (sheet.width, sheet.height) = (Width::new(length).ok()?, Height::new(length).ok()?);
    sheet.corner = Point(corner, corner);
    Some(())
}

fn object(level: &mut Level, value: &str) -> Option<()> {
    let from = match value {
        "None" => PRINCETON,
        "Sphere" => "princeton_sphere",
        "Box" => "princeton_box",
        _ => return None,
    };
    take_effects(level, Some(from), |effect| matches!(effect, EffectKind::Walls(_) | EffectKind::Friction(_)))?;
    for obstacle in obstacles(level) {
        if let ObstacleKind::Moving(moving) = obstacle {
            *obstacle = (*moving.obstacle).clone();
        }
    }
    Some(())
}

fn obstacles(level: &mut Level) -> impl Iterator<Item = &mut ObstacleKind> {
    level.effects.iter_mut().flat_map(|effect| match &mut effect.effect {
        EffectKind::Walls(walls) => walls.obstacles.iter_mut(),
        _ => [].iter_mut(),
    })
}

fn moving_sphere(level: &mut Level, value: &str) -> Option<()> {
    if !flag(value)? {
        return Some(());
    }
    let is_there = obstacles(level).any(|obstacle| matches!(obstacle, ObstacleKind::Sphere(_)));
    let walls: fn(&EffectKind) -> bool = |effect| matches!(effect, EffectKind::Walls(_));
    if is_there { take_effects(level, Some("princeton_sphere"), walls) } else { None }
}

fn pinned(level: &mut Level, value: &str) -> Option<()> {
    level.nets.first_mut()?.pins = match value {
        "None" => Vec::new(),
        "Corners" => vec![Pin::Corners],
        "OneEdge" => vec![Pin::Top],
        "TwoEdges" => vec![Pin::Top, Pin::Bottom],
        "FourEdges" => vec![Pin::Top, Pin::Bottom, Pin::Left, Pin::Right],
        "Random" => vec![Pin::Random { count: 10, seed: 1 }],
        _ => return None,
    };
    Some(())
}

fn rain(level: &mut Level, value: &str) -> Option<()> {
    let from = flag(value)?.then_some("princeton_rain");
    take_effects(level, from, |effect| matches!(effect, EffectKind::Rain(_)))
}

fn wind(level: &mut Level, value: &str) -> Option<()> {
    let from = flag(value)?.then_some("princeton_wind");
    take_effects(level, from, |effect| matches!(effect, EffectKind::Wind(_)))
}

/// The wave overrides the pins.
fn wave(level: &mut Level, value: &str) -> Option<()> {
    let is_on = flag(value)?;
    let from = is_on.then_some("princeton_wave");
    take_effects(level, from, |effect| matches!(effect, EffectKind::MovingPins(_)))?;
    if is_on {
        level.nets.first_mut()?.pins = built_in("princeton_wave")?.nets.swap_remove(0).pins;
    }
    Some(())
}

/// Switches the correction of a family of springs.
fn correct<Q: TryFrom<f64>>(level: &mut Level, value: &str, family: fn(&mut Projection) -> &mut Q) -> Option<()> {
    let share = if flag(value)? { 1.0 } else { 0.0 };
    *family(projection(level)?) = Q::try_from(share).ok()?;
    Some(())
}

fn structural(level: &mut Level, value: &str) -> Option<()> {
    correct(level, value, |projection| &mut projection.structural)
}

fn shear(level: &mut Level, value: &str) -> Option<()> {
    correct(level, value, |projection| &mut projection.shear)
}

fn bending(level: &mut Level, value: &str) -> Option<()> {
    correct(level, value, |projection| &mut projection.flexion)
}

/// Zero of a quantity that may be zero.
fn none<Q: TryFrom<f64>>() -> Option<Q> {
    Q::try_from(0.0).ok()
}

fn separation(level: &mut Level, value: &str) -> Option<()> {
    let separation = if flag(value)? { projection(&mut built_in("princeton_fold")?)?.separation } else { none()? };
    projection(level)?.separation = separation;
    Some(())
}

fn colour(level: &mut Level, value: &str) -> Option<()> {
    let digits = value.trim_start_matches('#').trim_start_matches("0x");
    level.nets.first_mut()?.finish.front = Some(Colour::try_from(format!("#{digits}")).ok()?);
    Some(())
}

fn texture(level: &mut Level, value: &str) -> Option<()> {
    if !flag(value)? {
        level.nets.first_mut()?.finish.pattern = Pattern::Plain;
    }
    Some(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a failing test should panic")]
mod tests {
    use super::*;
    use crate::{meshes::NoFiles, random, scene::Scene};

    fn of(query: &str) -> Level {
        level(query).unwrap()
    }

    #[test]
    fn a_named_level_is_changed_as_its_parameters_say() {
        let level = of(
            "https://page.example/?level=gingerbread_house&young=3e4&poisson=0.2&model=n&integrator=r&step=0.001&mode=simulate",
        );
        let material = level.bodies[0].material;
        assert_eq!((material.young().get(), material.poisson().get()), (3e4, 0.2));
        assert_eq!((material.model(), level.integrator.name()), (Model::NeoHookean, "RungeKutta4"));
        assert_eq!((level.substeps.get(), level.mode), (17, RunMode::Simulate));
        assert_eq!(of("?level=two_men&gravity=3").effects, {
            let mut level = built_in("two_men").unwrap();
            gravity(&mut level, "3").unwrap();
            level.effects
        });
    }

    /// The addresses that the course itself gives, and the levels of its scenes.
    #[test]
    fn addresses_of_the_princeton_course_give_its_scenes() {
        for (query, name) in [
            ("?pinned=Corners", "princeton_cloth"),
            ("?object=Sphere&movingSphere=true&pinned=None", "princeton_sphere"),
            ("?object=Box&pinned=None", "princeton_box"),
            ("?wind=true&pinned=OneEdge", "princeton_wind"),
            ("?rain=true", "princeton_rain"),
            ("?wave=true&pinned=FourEdges", "princeton_wave"),
        ] {
            let (own, shipped) = (of(query), built_in(name).unwrap());
            let sorted = |level: &Level| {
                let mut effects: Vec<_> = level.effects.iter().map(|effect| format!("{effect:?}")).collect();
                effects.sort_unstable();
                effects
            };
            assert_eq!((sorted(&own), &own.nets), (sorted(&shipped), &shipped.nets), "{query}");
        }
        let mut still = of("?structuralSprings=false&gravity=false&bendingSprings=false");
        assert_eq!(projection(&mut still).unwrap().structural.get(), 0.0);
        assert!(!still.effects.iter().any(|effect| matches!(effect.effect, EffectKind::Gravity(_))));
        let mut fold =
            of("?avoidClothSelfIntersection=true&fabricLength=800&clothColor=%23102030&showClothTexture=false");
        assert_eq!(projection(&mut fold).unwrap().separation.get(), 32.0);
        assert_eq!(sheet(&mut fold).unwrap(), sheet(&mut built_in("princeton_fold").unwrap()).unwrap());
        assert_eq!(fold.nets[0].finish.front, Some(Colour([16, 32, 48])));
        assert_eq!(fold.nets[0].finish.pattern, Pattern::Plain);
    }

    #[test]
    fn wrong_parameters_are_named_with_what_is_expected() {
        for (query, words) in [
            ("?level=nowhere", "there is no built-in level nowhere; those are: bar_vibration"),
            ("?level=chain&colour=red", "there is no parameter colour; those are: level, mode"),
            ("?level=chain&level=bead", "level is there twice"),
            ("?level=chain&young=1e5", "young: expected Young's modulus [Pa], and that the level has it"),
            ("?level=gingerbread&young=-1", "young: expected"),
            ("?level=gingerbread&model=rubber", "model: expected a constitutive model"),
            ("?level=gingerbread&step=1", "step: expected"),
            ("?level=gingerbread&step=nan", "step: expected"),
            ("?level=gingerbread&rain=true", "rain: only the cloths of Princeton's course"),
            ("?pinned=Everywhere", "pinned: expected None, Corners"),
            ("?movingSphere=true", "movingSphere: expected"),
            ("?rain=perhaps", "rain: expected true or false"),
            ("?rain=%ff%zz", "rain: expected true or false"),
            ("?level=chain&embed=2", "embed: expected true or false"),
        ] {
            let error = level(query).unwrap_err().to_string();
            assert!(error.contains(words), "{query}: {error}");
        }
    }

    #[test]
    fn addresses_without_a_level_stay_alone() {
        for address in
            ["", "https://page.example/", "?utm=1&level", "?embed", "?wireframe=true", "levels/a?.ron", "#level=x"]
        {
            assert_eq!(names_level(address), address.ends_with("&level"), "{address}");
        }
        assert_eq!(view("?level=chain&embed&wireframe=true"), View { embed: true, wireframe: true, camera: None });
        assert_eq!(view("?level=chain&embed=false#x?embed"), View::default());
    }

    /// Every value that a list of words offers gives a scene, alone and with others.
    #[test]
    fn every_word_gives_a_scene() {
        let mut numbers = random::stream(2).map(|number| 0.5 * (number + 1.0));
        let mut pick = |count: usize| (numbers.next().unwrap() * count as f64) as usize;
        let princeton: Vec<_> =
            PARAMETERS.iter().filter(|parameter| matches!(parameter.change, Change::Princeton(_))).collect();
        for _ in 0..60 {
            let mut query = "?object=Sphere".to_owned();
            for Parameter { name, values, .. } in &princeton {
                let words: Vec<_> = values.split([',', ' ']).filter(|word| !word.is_empty() && *word != "or").collect();
                let word = match *name {
                    "fabricLength" => "300",
                    "clothColor" => "ff8800",
                    _ => words[pick(words.len())],
                };
                if *name != "object" && pick(2) == 0 {
                    query.extend(["&", name, "=", word]);
                }
            }
            let level = of(&query);
            assert!(Scene::build(&level, level.mode, &NoFiles, None).is_ok(), "{query}");
        }
    }

    #[test]
    fn every_parameter_is_in_the_documentation() {
        let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/browser.md")).unwrap();
        for Parameter { name, .. } in PARAMETERS {
            assert!(page.contains(&format!("`{name}`")), "docs/browser.md does not name {name}");
        }
    }
}

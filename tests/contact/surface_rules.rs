//! Facts about surfaces with a friction of their own, and about bodies that do not touch each other.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{level, reopened};
use gingerbread::{
    contact::{FrictionRule, FrictionTable, Surface},
    files,
    integrators::IntegratorKind,
    level::{Level, Sleep, Toggle},
    meshes::NoFiles,
    scene::Scene,
    simulation::Simulation,
};

/// Two disks that fly at each other above a floor, and a net between them.
fn disks(effects: &str) -> Level {
    level(&format!(
        "(name: \"\", substeps: 40, guard: Off, bodies: [
            (name: \"left\", mesh: Disk(centre: (0.3, 0.53), radius: 0.1, rings: 4), velocity: (2, -1), material: (model: Corotated, young: 1000, poisson: 0.3, plane: Stress), mass: Density(100)),
            (name: \"right\", mesh: Disk(centre: (0.7, 0.52), radius: 0.12, rings: 4), velocity: (-2, -1), material: (model: NeoHookean, young: 2000, poisson: 0.3, plane: Stress), mass: Density(100))],
        nets: [(name: \"net\", net: Sheet(corner: (0.48, 0.45), width: 0.04, height: 0.15, columns: 2, rows: 8, structural: 100, shear: 50, flexion: 20), mass: 0.01)],
        effects: [(effect: Gravity(down: 2)), (effect: Rayleigh(mass: 1, stiffness: 0.001)), (effect: Walls(obstacles: [Plane(point: (0, 0.4), normal: (0, 1), eps: 0.001)])), {effects}])"
    ))
}

/// A level after some frames of 40 steps.
fn run(level: &Level, frames: u64) -> Simulation {
    let scene = Scene::build(level, level.mode, &NoFiles, None).unwrap();
    let mut simulation = Simulation::open(scene, level, level.mode).unwrap();
    simulation.advance(40 * frames, &mut || true);
    simulation
}

fn why(level: &Level) -> String {
    Scene::build(level, level.mode, &NoFiles, None).err().map(|error| error.to_string()).unwrap_or_default()
}

#[test]
fn a_rule_for_two_surfaces_comes_before_those_for_one() {
    let [ice, block, rubber] = [0, 1, 2].map(Surface::Owner);
    let rule = |one: Surface, other: Option<Surface>, coefficient: f64| FrictionRule {
        surfaces: vec![one],
        others: other.map(|other| vec![other]),
        coefficient,
    };
    let table = FrictionTable {
        coefficient: 0.4,
        rules: vec![
            rule(ice, None, 0.02),
            rule(rubber, None, 1.0),
            rule(rubber, Some(ice), 0.2),
            rule(block, Some(Surface::Obstacles), 0.6),
        ],
    };
    for ([one, other], coefficient) in [
        ([block, block], 0.4),
        ([block, Surface::Obstacles], 0.6),
        ([ice, block], 0.02),
        ([ice, Surface::Obstacles], 0.02),
        ([rubber, block], 1.0),
        ([rubber, ice], 0.2),
    ] {
        assert_eq!(table.between(one, other), coefficient);
        assert_eq!(table.between(other, one), coefficient);
    }
}

/// A rule that names a contact does what the same coefficient for all does to that body, and nothing to others; with every integrator.
#[test]
fn friction_of_a_surface_acts_where_it_is_named() {
    const FLOOR: &str = "on: \"obstacles\", ";
    for kind in IntegratorKind::all() {
        let ends = |friction: &str, contact: &str| {
            let friction = format!("(effect: Friction({friction})), {contact}");
            let mut level = Level { integrator: kind.clone(), ..disks(&friction) };
            level.bodies[1].velocity = level.bodies[0].velocity;
            let simulation = run(&level, 12);
            let right = simulation.scene().numbers(&simulation.scene().bodies[1].vertices);
            let own = |x: &[f64]| [x[..right.start].to_vec(), x[right.clone()].to_vec()];
            own(&simulation.state().x)
        };
        for contact in ["(effect: VelocityFilter())", ""] {
            let [rough, smooth] = ["coefficient: 0.8", "coefficient: 0"].map(|friction| ends(friction, contact));
            assert!(rough[0] != smooth[0] && rough[1] != smooth[1], "{}: both slide on the floor", kind.name());
            let apart = |one: &[f64], other: &[f64]| {
                one.iter().zip(other).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max)
            };
            // An impact of one body may restart a scheme for both, and a solver stops by the errors of all.
            let is_same = |end: &[f64], body: usize, of: &[Vec<f64>; 2]| {
                apart(end, &of[body]) < 0.05 * apart(&rough[body], &smooth[body])
            };
            for of in [FLOOR, ""] {
                let left = ends(&format!("coefficient: 0, surfaces: [(of: \"left\", {of}coefficient: 0.8)]"), contact);
                let as_named = is_same(&left[0], 0, &rough) && is_same(&left[1], 1, &smooth);
                assert!(as_named, "{} {contact} {of}", kind.name());
            }
            let others = "coefficient: 0.8, surfaces: [(of: \"left\", on: \"right\", coefficient: 0)]";
            assert!(ends(others, contact) == rough, "{} {contact}: they are far apart", kind.name());
        }
    }
}

/// Between two bodies the order of the names does not matter.
#[test]
fn friction_between_two_bodies_is_that_of_the_pair() {
    let end = |friction: &str| {
        let apart = "apart: [(\"net\", \"left\"), (\"net\", \"right\"), (\"left\", \"left\"), (\"right\", \"right\")]";
        let text = format!("(effect: Contact({apart})), (effect: Friction(coefficient: {friction}))");
        run(&disks(&text), 9).state().x.clone()
    };
    let on_floor =
        "(of: \"left\", on: \"obstacles\", coefficient: 0), (of: \"right\", on: \"obstacles\", coefficient: 0)";
    let [rough, smooth] = ["0.8", "0"].map(|all| end(&format!("{all}, surfaces: [{on_floor}]")));
    assert_ne!(rough, smooth, "they meet");
    for names in ["of: \"left\", on: \"right\"", "of: \"right\", on: \"left\"", "of: \"right\""] {
        assert_eq!(end(&format!("0, surfaces: [({names}, coefficient: 0.8), {on_floor}]")), rough, "{names}");
    }
}

/// Bodies that do not touch move as without contact, through each other, with every integrator and at any speed, and still touch
/// the floor. No crossing is counted.
#[test]
fn bodies_that_are_apart_pass_through_each_other() {
    const APART: &str = "(effect: Contact(apart: [(\"left\", \"right\"), (\"net\", \"left\"), (\"right\", \"net\")]))";
    for kind in IntegratorKind::all() {
        for speed in [2.0, 60.0] {
            let ends = |effects: &str| {
                let mut level = Level { integrator: kind.clone(), sleep: Sleep::Off, ..disks(effects) };
                let text = files::write(&level).unwrap();
                let text = text.replace("(2.0, -1.0)", &format!("({speed:?}, -1.0)"));
                level = files::parse(&text, "test.ron").unwrap();
                let simulation = run(&level, 8);
                let crossings = simulation.count_crossings();
                (simulation.state().x.clone(), crossings, simulation.counts().constrained)
            };
            let (apart, crossings, constrained) = ends(APART);
            let (without, _, by_floor) = ends("");
            assert!(apart == without, "{} at {speed} m/s", kind.name());
            assert_eq!((crossings, constrained), (Some(0), by_floor), "{} at {speed} m/s", kind.name());
        }
    }
    let both = run(&disks(APART), 8).state().x.clone();
    assert_ne!(run(&disks("(effect: Contact())"), 8).state().x, both, "otherwise they touch");
}

/// A level can say that a body does not touch itself: it folds through itself.
#[test]
fn a_body_named_twice_does_not_touch_itself() {
    let arms = |apart: &str| {
        let text = gingerbread::levels::built_in("folded_arms").unwrap();
        let level = level(&text.replacen("Contact(", &format!("Contact({apart}"), 1));
        assert!(files::write(&level).unwrap().contains("apart") != apart.is_empty());
        let name = level.bodies[0].name.clone();
        (run(&Level { guard: Toggle::Off, ..level }, 60).state().x.clone(), name)
    };
    let (touches, name) = arms("");
    let (passes, _) = arms(&format!("apart: [({name:?}, {name:?})], "));
    assert_ne!(touches, passes);
}

#[test]
fn rules_are_saved_and_names_are_checked() {
    let rules = "(effect: Contact(apart: [(\"net\", \"left\")])), (effect: Friction(coefficient: 0.3, surfaces: [(of: \"right\", on: \"obstacles\", coefficient: 0.7), (of: \"net\", coefficient: 0.1)]))";
    let level = Level { sleep: Sleep::Off, ..disks(rules) };
    assert_eq!(files::parse(&files::write(&level).unwrap(), "test.ron").unwrap(), level);
    let mut simulation = run(&level, 5);
    let mut saved = reopened(&simulation, &level);
    for run in [&mut simulation, &mut saved] {
        run.advance(200, &mut || true);
    }
    assert_eq!(simulation.state(), saved.state(), "continued from a file");
    for effect in [
        "Contact(apart: [(\"left\", \"nobody\")])",
        "Friction(coefficient: 0.1, surfaces: [(of: \"nobody\", coefficient: 0.1)])",
        "Friction(coefficient: 0.1, surfaces: [(of: \"left\", on: \"nobody\", coefficient: 0.1)])",
    ] {
        for switch in ["On", "Off"] {
            let told = why(&disks(&format!("(effect: {effect}, switch: {switch})")));
            assert!(told.contains("no body or net is called \"nobody\""), "{told}");
            assert!(told.contains("\"left\", \"right\", \"net\""), "{told}");
        }
    }
}

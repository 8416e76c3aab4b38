//! Only the effects that a scene calls for: what is not listed is not there, and what is listed works when it can matter.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{MODES, coarse, level, sheet, simulation};
use gingerbread::{
    effects::{Bounds, EffectKind, EffectParameters as _, Grab, Shape, Walls},
    integrators::IntegratorKind,
    level::{EffectLevel, Level, RunMode, Switch, When},
    levels::BUILT_IN,
    meshes::NoFiles,
    obstacles::{Ball, Cuboid, MotionKind, Moving, ObstacleKind, Plane, Surfaces},
    quantity::Quantity,
    report::EffectCost,
    scene::Scene,
    simulation::Simulation,
    state::State,
    study::Savings,
};
use std::time::Duration;

/// Two sliders of one thing with the same name could not be told apart, and `Length` says not which one.
#[test]
fn sliders_of_one_thing_say_what_they_are() {
    let names = |numbers: Vec<&mut dyn Quantity>| numbers.iter().map(|number| number.spec().name).collect::<Vec<_>>();
    let mut each = Vec::new();
    for mut kind in EffectKind::all() {
        each.extend(kind.kind_mut().groups().into_iter().map(|group| names(group.numbers)));
    }
    each.extend(ObstacleKind::all().iter_mut().map(|kind| names(kind.kind_mut().parameters())));
    each.extend(MotionKind::all().iter_mut().map(|kind| names(kind.kind_mut().parameters())));
    for names in each {
        let twice = names.iter().enumerate().find(|(number, name)| names[..*number].contains(name));
        assert_eq!(twice, None, "{names:?}");
        assert!(!names.contains(&"length") && !names.contains(&"coordinate"), "{names:?}");
    }
    assert_eq!(names(ObstacleKind::Ball(Ball::default()).kind_mut().parameters())[0], "radius");
    assert_eq!(names(ObstacleKind::Cuboid(Cuboid::default()).kind_mut().parameters())[..2], ["width", "height"]);
}

fn switched(level: &Level, switch: Switch) -> Level {
    let mut level = level.clone();
    level
        .effects
        .iter_mut()
        .for_each(|listed| listed.switch = if listed.switch.is_on() { switch } else { Switch::Off });
    level
}

/// What a hand does in each of these twentieths of a second: pulls a vertex along for a while, lets go, takes another.
fn hand(moment: u64, vertices: usize) -> Option<Grab> {
    let (pull, along) = (moment / 20, (moment % 20) as f64 / 12.0);
    let vertex = (pull as usize * 7 + 3) % vertices.max(1);
    let way = [0.45 - 0.3 * (pull % 4) as f64, 0.2 + 0.15 * (pull % 5) as f64];
    (along < 1.0 && vertices > 0)
        .then(|| Grab { vertex, target: [0.5 + along * way[0], 0.5 + along * (way[1] - 0.5), 0.0] })
}

/// Runs for so many twentieths of a second under the hand.
fn dragged(run: &mut Simulation, twentieths: u64) {
    let steps = (0.05 / run.scene().step).round() as u64;
    for moment in 0..twentieths {
        run.set_grab(hand(moment, run.state().v.len() / 2));
        run.advance(steps, &mut || true);
    }
}

/// The bookkeeping of one effect.
fn cost<'a>(run: &'a Simulation, name: &str) -> &'a EffectCost {
    run.costs().iter().find(|cost| cost.name == name).unwrap()
}

/// Both modes, where they differ.
fn modes(level: &Level) -> &'static [RunMode] {
    let differ = level.effects.iter().any(|listed| listed.when == When::Collide);
    if differ { &MODES } else { &MODES[..1] }
}

/// Each level runs five seconds under a hand, which pulls five times.
#[test]
fn skipping_idle_effects_changes_no_bit_in_any_level() {
    let one = |(file, text): &(&str, &str)| {
        let mut skipped = 0;
        let level = coarse(text, file);
        for &mode in modes(&level) {
            let level = Level { mode, ..level.clone() };
            let [mut on, mut auto] = [Switch::On, Switch::Auto].map(|switch| simulation(&switched(&level, switch)));
            for run in [&mut on, &mut auto] {
                dragged(run, 100);
            }
            assert!(on.scene().triangles.len() <= 600, "{file} is not coarse: this would take long");
            assert!(on.fault().is_none(), "{file}: {:?}", on.fault());
            assert_eq!(on.state(), auto.state(), "{file} {mode:?}");
            assert_eq!(on.counts(), auto.counts(), "{file} {mode:?}");
            assert!(on.costs().iter().all(|cost| cost.auto || cost.skipped == 0), "{file}");
            skipped += auto.costs().iter().map(|cost| cost.skipped).sum::<u64>();
        }
        skipped
    };
    let skipped = std::thread::scope(|threads| {
        let halves = BUILT_IN.chunks(BUILT_IN.len().div_ceil(2));
        let working = halves.map(|half| threads.spawn(move || half.iter().map(one).sum::<u64>())).collect::<Vec<_>>();
        working.into_iter().map(|work| work.join().unwrap()).sum::<u64>()
    });
    assert!(skipped > 200_000, "{skipped}");
}

/// A small sheet in the middle of the world with one effect more.
fn with(effect: &str) -> Simulation {
    simulation(&sheet("Corotated", "", &format!("substeps: 20, sleep: Off, effects: [{effect}]")))
}

/// Obstacles of one kind are numbered.
#[test]
fn wall_parameters_are_named_by_their_obstacle() {
    let ball = || ObstacleKind::Ball(Ball::default());
    let cuboid = Box::new(ObstacleKind::Cuboid(Cuboid::default()));
    let moving = Moving { obstacle: cuboid, ..Moving::default() };
    let mut walls =
        Walls { obstacles: vec![ball(), ObstacleKind::Plane(Plane::default()), ball(), ObstacleKind::Moving(moving)] };
    let names = |numbers: Vec<&mut dyn Quantity>| numbers.iter().map(|number| number.spec().name).collect::<Vec<_>>();
    let of_groups: Vec<_> =
        walls.groups().into_iter().map(|group| (group.title, group.solid, names(group.numbers))).collect();
    let titles: Vec<_> =
        of_groups.iter().map(|(title, solid, _)| (title.as_deref().unwrap(), solid.unwrap())).collect();
    assert_eq!(titles, [("Ball 1", 0), ("Ball 2", 1), ("Cuboid, moving", 2)]);
    assert_eq!(of_groups.into_iter().flat_map(|(_, _, names)| names).collect::<Vec<_>>(), names(walls.parameters()));
    let solids = walls.shapes(0.0, &Surfaces::default()).into_iter().filter(|shape| matches!(shape, Shape::Solid(_)));
    assert_eq!(solids.count(), 3);
}

/// A membrane and a net in space.
const CLOTH: &str = "(name: \"\", substeps: 20, sleep: Off,
    membranes: [(name: \"cloth\", mesh: Rectangle(width: 0.4, height: 0.2, columns: 4, rows: 2, diagonals: Alternating, corner: (0, 0)),
        material: (model: NeoHookean, young: 2000, poisson: 0.3, plane: Stress), thickness: 0.01, mass: Density(100))],
    nets: [(name: \"net\", net: Sheet(width: 0.4, height: 0.2, columns: 4, rows: 2, structural: 40, shear: 20, flexion: 10, corner: (0, 0)), mass: 0.01, space: ())])";

#[test]
fn an_idle_effect_is_not_called_and_says_why() {
    // Pins that move and constraints always act.
    let always = ["MovingPins", "Rods", "Wire"];
    for kind in EffectKind::all().into_iter().filter(|kind| !always.contains(&kind.name())) {
        let cloth = ["Projection", "Wind", "Vortex", "Rain", "Bending", "AbsoluteDamping"];
        let mut level = if cloth.contains(&kind.name()) {
            level(CLOTH)
        } else {
            sheet("Corotated", "", "substeps: 20, sleep: Off")
        };
        let mut effect = kind.clone();
        // Of no strength, nobody dragging, in the middle of the world: nothing here can matter.
        for quantity in effect.kind_mut().parameters() {
            let _ = quantity.set(0.0);
        }
        if let EffectKind::Walls(walls) = &mut effect {
            walls.obstacles = vec![ObstacleKind::Plane(Plane::default())];
        }
        level.effects.push(EffectLevel { effect, switch: Switch::Auto, when: When::Always });
        let mut run = simulation(&level);
        assert_eq!(run.advance(30, &mut || true), 30);
        let acting = run.costs().last().unwrap();
        assert_eq!((acting.calls, acting.elements), (0, 0), "{}", kind.name());
        let touching = ["Friction", "Restitution", "Contact"].contains(&kind.name());
        assert!(touching || (acting.skipped == 30 && acting.idle.is_some()), "{}: {acting:?}", kind.name());
        if let Some(last) = level.effects.last_mut() {
            last.switch = Switch::On;
        }
        let mut run = simulation(&level);
        run.advance(30, &mut || true);
        let acting = run.costs().last().unwrap();
        assert!(touching || (acting.calls == 30 && acting.skipped == 0 && acting.idle.is_none()), "{}", kind.name());
    }
}

#[test]
fn effects_not_listed_or_off_are_never_evaluated() {
    let mut bare = with("(effect: Gravity(down: 1))");
    bare.advance(200, &mut || true);
    let names: Vec<_> = bare.costs().iter().map(|cost| cost.name).collect();
    assert_eq!((names, bare.counts().constrained), (vec!["Elasticity", "Gravity"], 0));
    let off = "(effect: Walls(obstacles: [Plane(point: (0, 0.2), normal: (0, 1), eps: 0.01)]), switch: Off), (effect: Rayleigh(mass: 1), switch: Off),";
    let mut off = with(&format!("{off} (effect: Gravity(down: 1))"));
    off.advance(200, &mut || true);
    assert_eq!((off.costs(), off.state()), (bare.costs(), bare.state()), "what is off is as if it were not listed");
}

/// Walls are evaluated within the reach of the skin, and friction is part of them.
#[test]
fn walls_and_friction_are_evaluated_only_when_near() {
    let wall = "(effect: Walls(obstacles: [Plane(point: (0, 0.2), normal: (0, 1), eps: 0.01)])), (effect: Friction(coefficient: 0.5)),";
    let mut run = with(&format!("{wall} (effect: Gravity(down: 1))"));
    // It falls 7 cm to the skin, which is 0.3 of an edge of 10 cm thick: sqrt(2 * 0.07) s.
    let contact = (0.37 / run.scene().step) as u64;
    run.advance(contact - 30, &mut || true);
    for name in ["Walls", "Friction"] {
        assert_eq!((cost(&run, name).calls, cost(&run, name).skipped), (0, contact - 30), "{name}");
    }
    assert_eq!(cost(&run, "Walls").idle, Some("nothing within reach"));
    run.advance(60, &mut || true);
    assert!(cost(&run, "Walls").calls > 0 && cost(&run, "Walls").idle.is_none());
    assert_eq!(cost(&run, "Friction").idle, Some("part of contact"));
}

/// A body in a bowl is inside the box around the bowl, but not near its surface.
#[test]
fn a_polygon_is_out_of_reach_far_from_all_its_sides() {
    let bowl = "(effect: Walls(obstacles: [Polygon(points: [(-1, -1), (2, -1), (2, 2), (1.9, 2), (1.9, 0), (-0.9, 0), (-0.9, 2.1), (-1, 2.2)], eps: 0.01)])),";
    let mut run = with(bowl);
    run.advance(100, &mut || true);
    assert_eq!((cost(&run, "Walls").calls, cost(&run, "Walls").skipped), (0, 100));
    let inside = "(effect: Walls(obstacles: [Polygon(points: [(-1, -1), (2, -1), (2, 2), (-1, 2)], eps: 0.01)])),";
    let mut run = with(inside);
    run.advance(100, &mut || true);
    assert_eq!(cost(&run, "Walls").skipped, 0, "a body inside an obstacle is within its reach");
}

#[test]
fn every_scheme_skips_walls_out_of_reach() {
    let wall = "effects: [(effect: Gravity(down: 3)), (effect: Walls(obstacles: [Plane(point: (0, 0.2), normal: (0, 1), eps: 0.01)]))]";
    for kind in IntegratorKind::all() {
        let level = Level { integrator: kind.clone(), ..sheet("Corotated", "", &format!("substeps: 20, {wall}")) };
        let [mut on, mut auto] = [Switch::On, Switch::Auto].map(|switch| simulation(&switched(&level, switch)));
        for run in [&mut on, &mut auto] {
            run.advance(600, &mut || true);
        }
        assert_eq!(on.state(), auto.state(), "{}", kind.name());
        let walls = cost(&auto, "Walls");
        assert!(walls.skipped > 100 && walls.calls > 10, "{}: {walls:?}", kind.name());
    }
}

#[test]
fn an_effect_listed_twice_is_refused_or_warned_about() {
    let refused = |effects: &str| {
        let level = sheet("Corotated", "", &format!("effects: [{effects}]"));
        Scene::build(&level, level.mode, &NoFiles, None).err().map(|error| error.to_string()).unwrap_or_default()
    };
    let told = |effects: &str| {
        let level = sheet("Corotated", "", &format!("effects: [{effects}]"));
        Scene::build(&level, level.mode, &NoFiles, None).unwrap().messages.join("; ")
    };
    let edges = "(effect: Boundary(least: (0, 0), greatest: (1, 1))),";
    for kind in ["Friction(coefficient: 0.1)", "Restitution(coefficient: 0.1)", "Contact()"] {
        let why = refused(&format!("(effect: {kind}), {edges} (effect: {kind}, switch: Off)"));
        assert!(why.contains("effects 1 and 3") && why.contains("take one of them out"), "{why}");
    }
    let springs = told("(effect: MouseSpring(stiffness: 1)), (effect: MouseSpring(stiffness: 2))");
    assert!(springs.contains("Mouse spring is listed twice, as effects 1 and 2"), "{springs}");
    assert_eq!(told(&format!("{edges} {edges} (effect: Gravity(down: 1)), (effect: Gravity(down: 1))")), "");
    assert!(told("(effect: Friction(coefficient: 0.3))").contains("needs walls or a domain boundary"));
    assert!(told("(effect: Walls(obstacles: []))").contains("no obstacles"));
    let both = told(&format!("{edges} (effect: Contact()), (effect: VelocityFilter())"));
    assert!(both.contains("The contact potential does nothing"), "{both}");
}

#[test]
fn savings_compare_with_a_run_of_all_effects_forced() {
    let wall = "effects: [(effect: Gravity(down: 1)), (effect: MouseSpring(stiffness: 9)), (effect: Walls(obstacles: [Plane(point: (0, -9), normal: (0, 1), eps: 0.01)]))]";
    let level = sheet("Corotated", "", &format!("substeps: 20, {wall}"));
    let mut savings = Savings::new(&level, &NoFiles).unwrap();
    assert!(savings.each().is_empty() && savings.whole().is_none(), "nothing is guessed");
    while !savings.advance(Duration::MAX).finished {}
    let [own, forced] = savings.runs();
    assert_eq!((own.state().x == forced.state().x, own.state().v == forced.state().v), (true, true));
    for name in ["Mouse spring", "Walls"] {
        assert_eq!((cost(own, name).calls, cost(own, name).skipped), (0, 1200), "{name}");
        assert_eq!((cost(forced, name).calls, cost(forced, name).skipped), (1200, 0), "{name}");
        let saving = savings.each().into_iter().find(|saving| saving.name == name).unwrap();
        assert!(saving.own == 0.0 && saving.saved() > 0.0, "{saving:?}");
    }
    // A scene at rest sleeps in one of the two runs alone.
    let mut still = Savings::new(&sheet("Corotated", "", "substeps: 20"), &NoFiles).unwrap();
    while !still.advance(Duration::MAX).finished {}
    let [own, forced] = still.runs();
    assert!(own.counts().slept > 0 && forced.counts().slept == 0);
    assert!(own.counts().force_evaluations < forced.counts().force_evaluations);
}

/// A position or velocity that is not a number is in no box.
#[test]
fn a_state_is_in_a_box_only_if_every_vertex_is() {
    let bounds = Some(Bounds([[0.0, -1.0], [1.0, 2.0]]));
    // More than are looked at side by side, and some left over.
    for vertices in [0, 1, 7, 8, 21] {
        let corners = [0.0, -1.0, 1.0, 2.0];
        let x: Vec<_> = (0..2 * vertices).map(|number| corners[number % 4]).collect();
        let state = State { v: vec![0.5; x.len()], x, ..State::default() };
        assert!(state.is_within(bounds), "its edges belong to it");
        for number in 0..state.x.len() {
            for wrong in [2.0 + 1e-15 * 4.0, -1.0 - 1e-15, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let mut other = state.clone();
                other.x[number] = wrong;
                assert!(!other.is_within(bounds), "{wrong} at {number}");
            }
            let mut other = state.clone();
            other.v[number] = f64::NAN;
            assert!(!other.is_within(bounds));
        }
    }
}

//! Tests of the comparison without a window.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use super::*;
use crate::{
    command::{Mode, Pose},
    effects::{Drag, EffectKind},
    files,
    integrators::IntegratorKind,
    level::{Level, MassLevel, Substeps, Toggle},
    levels,
    materials::Model,
    meshes::{MeshKind, NoFiles},
    quantity::{Density, Quantity as _},
    study::Apart,
};

fn level(name: &str) -> Level {
    files::parse(levels::built_in(name).unwrap(), name).unwrap()
}

fn pair(name: &str) -> (Sandbox, Comparison) {
    let a = Sandbox::new(level(name), Box::new(NoFiles)).unwrap();
    let panes = Comparison::new(&a);
    (a, panes)
}

fn substeps(count: u32) -> Command {
    Command::SetSubsteps(Substeps::new(count).unwrap())
}

fn integrator(name: &str) -> IntegratorKind {
    IntegratorKind::all().into_iter().find(|kind| kind.name() == name).unwrap()
}

fn mesh(level: &Level, value: f64) -> MeshKind {
    let mut mesh = level.bodies[0].mesh.clone();
    mesh.kind_mut().parameters().last_mut().unwrap().set(value).unwrap();
    mesh
}

fn look(a: &Sandbox, panes: &mut Comparison) -> Snapshot {
    let mut seen = Snapshot::default();
    panes.update_snapshots(a, &mut seen, Field::None);
    seen
}

/// Runs for some frames of 1/60 s while the mouse pulls a vertex.
fn run_pulled(a: &mut Sandbox, panes: &mut Comparison, frames: u32) {
    let mut seen = Snapshot::default();
    panes.apply(a, Pane::A, Command::SetMode(Mode::Simulate)).unwrap();
    for frame in 0..frames {
        match frame % 20 {
            _ if a.simulation().scene().toy.is_some() => {}
            5 => panes.apply(a, Pane::A, Command::Grab(40, [0.9, 0.8, 0.0])).unwrap(),
            15 => panes.apply(a, Pane::B, Command::Release).unwrap(),
            _ => panes.apply(a, Pane::A, Command::Pull([0.9, 0.8 + 0.01 * f64::from(frame), 0.0])).unwrap(),
        }
        let rounds = (1.0 / 60.0 / panes.round_length(a)).round() as u64;
        assert_eq!(panes.advance(a, rounds, &mut || true), rounds);
        let times = [&*a, &panes.b].map(|sandbox| sandbox.simulation().state().time);
        assert!((times[0] - times[1]).abs() < 1e-12 * f64::from(frame + 1), "{times:?}");
        panes.update_snapshots(a, &mut seen, Field::None);
    }
}

#[test]
fn equal_panes_stay_equal_to_the_bit_whatever_is_pulled() {
    for name in ["gingerbread", "hanging_net"] {
        let (mut a, mut panes) = pair(name);
        run_pulled(&mut a, &mut panes, 40);
        assert_eq!(a.simulation().state(), panes.b.simulation().state(), "{name}");
        assert!(a.simulation().energies().kinetic > 0.0, "{name}: it moves");
        let apart = |moment: &Moment| moment.positions != Some(Apart::default()) || moment.energy != 0.0;
        assert!(!panes.record.moments().any(apart) && panes.record.moments().count() > 30, "{name}");
    }
}

#[test]
fn panes_with_other_steps_are_at_the_same_time_and_apart() {
    for count in [37, 50, 99, 400] {
        let (mut a, mut panes) = pair("gingerbread");
        panes.apply(&mut a, Pane::B, substeps(count)).unwrap();
        run_pulled(&mut a, &mut panes, 30);
        assert_eq!([a.shown.substeps.get(), panes.b.shown.substeps.get()], [100, count]);
        assert!(panes.record.last().unwrap().positions.unwrap().metres > 0.0, "{count}");
    }
}

#[test]
fn a_toy_is_compared_where_it_is_seen() {
    let (mut a, mut panes) = pair("circle");
    panes.apply(&mut a, Pane::B, Command::SetIntegrator(integrator("RungeKutta4"))).unwrap();
    run_pulled(&mut a, &mut panes, 60);
    let seen = look(&a, &mut panes);
    let [a, b] = [&seen, &panes.snapshot].map(|seen| seen.toy.as_ref().unwrap().at);
    assert!(a != b && panes.record.last().unwrap().positions.unwrap().metres > 0.0);
}

#[test]
fn who_has_no_time_left_shows_the_moment_that_both_shared() {
    let (mut a, mut panes) = pair("gingerbread");
    panes.apply(&mut a, Pane::B, substeps(37)).unwrap();
    panes.apply(&mut a, Pane::B, Command::SetRunning(true)).unwrap();
    assert_eq!(panes.advance(&mut a, 3, &mut || true), 3);
    let met = [&a, &panes.b].map(|sandbox| sandbox.simulation().state().clone());
    assert_eq!(panes.advance(&mut a, 1, &mut || false), 0);
    assert!(panes.is_between() && a.simulation().state() != &met[0]);
    // A change does not wait for the other pane: both return to their last common time.
    panes.apply(&mut a, Pane::A, Command::SetDamping(true)).unwrap();
    assert!(!panes.is_between());
    assert_eq!([&a, &panes.b].map(|sandbox| sandbox.simulation().state().clone()), met);
    // Short calls also complete a round.
    let mut frames = 0;
    while panes.advance(&mut a, 1, &mut || false) == 0 {
        frames += 1;
        assert!(frames < 100);
    }
    let times = [&a, &panes.b].map(|sandbox| sandbox.simulation().state().time);
    assert!(frames > 3 && (times[0] - times[1]).abs() < 1e-12 && times[0] > met[0].time);
}

/// A change of the experiment reaches both panes, a change of the method only the chosen one.
#[test]
fn commands_reach_both_panes_or_only_the_chosen_one() {
    let first = level("stretch_test");
    let body = &first.bodies[0];
    let material = body.material;
    let mut effect = first.effects[0].clone();
    effect.switch = if effect.switch.is_on() { crate::level::Switch::Off } else { crate::level::Switch::Auto };
    let mut young = material.young();
    young.set(2.0 * young.get()).unwrap();
    let stiffer =
        crate::materials::MaterialParameters::new(material.model(), young, material.poisson(), material.plane())
            .unwrap();
    let other = *Model::ALL.iter().find(|model| **model != body.material.model()).unwrap();
    let documents = [
        Command::SetModel(other),
        Command::SetMesh(0, mesh(&first, 9.0)),
        substeps(77),
        Command::SetIntegrator(integrator("Heun")),
        Command::SetMaterial(0, stiffer),
        Command::SetMass(0, MassLevel::Density(Density::new(123.0).unwrap())),
        Command::SetEffect(0, effect),
        Command::AddEffect(EffectKind::Drag(Drag::default())),
        Command::SetDamping(false),
        Command::TogglePin(3),
        Command::ClearPins,
        Command::SetPose(Pose::Compressed),
        Command::Open(Box::new(level("gingerbread"))),
    ];
    for command in documents {
        for from in Pane::BOTH {
            let (mut a, mut panes) = pair("stretch_test");
            panes.apply(&mut a, from, command.clone()).unwrap();
            let same = a.shown == panes.b.shown;
            let [changed, other] = [from, from.other()].map(|pane| {
                let shown = if pane == Pane::A { &a.shown } else { &panes.b.shown };
                **shown != Level { state: None, ..first.clone() }
            });
            let both = command.about() == About::Experiment;
            assert_eq!((changed, other, same), (true, both, both), "{command:?} in {from:?}");
            panes.apply(&mut a, from.other(), Command::Undo).unwrap();
            for sandbox in [&a, &panes.b] {
                assert_eq!(*sandbox.shown, Level { state: None, ..first.clone() }, "undo of {command:?}");
            }
        }
    }
}

#[test]
fn modes_time_and_the_hand_go_to_both() {
    let (mut a, mut panes) = pair("gingerbread");
    let both = |a: &Sandbox, panes: &Comparison, say: fn(&Sandbox) -> bool| [a, &panes.b].map(say) == [true, true];
    panes.apply(&mut a, Pane::B, Command::SetMode(Mode::Collide)).unwrap();
    assert!(both(&a, &panes, |sandbox| sandbox.mode == Mode::Collide && sandbox.running));
    panes.apply(&mut a, Pane::B, Command::SetRunning(false)).unwrap();
    assert!(both(&a, &panes, |sandbox| !sandbox.running));
    panes.apply(&mut a, Pane::B, substeps(50)).unwrap();
    panes.apply(&mut a, Pane::A, Command::StepOnce).unwrap();
    assert_eq!([&a, &panes.b].map(|sandbox| sandbox.simulation().state().steps), [2, 1]);
    assert!(both(&a, &panes, |sandbox| !sandbox.running));
    panes.apply(&mut a, Pane::A, Command::Grab(9, [0.1, 0.2, 0.0])).unwrap();
    assert!(both(&a, &panes, |sandbox| sandbox.simulation().grab().is_some()));
    panes.apply(&mut a, Pane::B, Command::Pull([0.3, 0.2, 0.0])).unwrap();
    assert!(both(&a, &panes, |sandbox| sandbox.simulation().grab().unwrap().target == [0.3, 0.2, 0.0]));
    panes.apply(&mut a, Pane::B, Command::Release).unwrap();
    panes.apply(&mut a, Pane::B, Command::Reset).unwrap();
    assert!(
        both(&a, &panes, |sandbox| sandbox.simulation().grab().is_none() && sandbox.simulation().state().time == 0.0)
    );
}

#[test]
fn a_material_keeps_the_model_of_each_pane() {
    let (mut a, mut panes) = pair("gingerbread");
    panes.apply(&mut a, Pane::B, Command::SetModel(Model::NeoHookean)).unwrap();
    let mut young = a.shown.bodies[0].material.young();
    young.set(4321.0).unwrap();
    let material = a.shown.bodies[0].material;
    let stiffer =
        crate::materials::MaterialParameters::new(material.model(), young, material.poisson(), material.plane())
            .unwrap();
    panes.apply(&mut a, Pane::A, Command::SetMaterial(0, stiffer)).unwrap();
    let [a, b] = [&a, &panes.b].map(|sandbox| sandbox.shown.bodies[0].material);
    assert_eq!((a.model(), b.model()), (Model::Corotated, Model::NeoHookean));
    assert_eq!((a.young().get(), b.young().get()), (4321.0, 4321.0));
}

#[test]
fn pins_and_pulls_keep_their_places_on_another_mesh() {
    let (mut a, mut panes) = pair("gingerbread");
    panes.apply(&mut a, Pane::A, Command::TogglePin(100)).unwrap();
    let coarse = mesh(&a.shown, 400.0);
    panes.apply(&mut a, Pane::B, Command::SetMesh(0, coarse)).unwrap();
    let place = |sandbox: &Sandbox, vertex: usize| {
        let rest = &sandbox.simulation().scene().rest;
        [rest[2 * vertex], rest[2 * vertex + 1]]
    };
    let near = |[a, b]: [f64; 2], [c, d]: [f64; 2]| (a - c).abs() + (b - d).abs() < 0.05;
    let pins =
        |sandbox: &Sandbox| sandbox.simulation().scene().pins.iter().map(|pin| *pin as usize).collect::<Vec<_>>();
    assert_eq!(pins(&panes.b).len(), 1);
    assert!(near(place(&a, 100), place(&panes.b, pins(&panes.b)[0])), "a pin stays at its place on another mesh");
    panes.apply(&mut a, Pane::A, Command::TogglePin(700)).unwrap();
    assert_eq!([pins(&a).len(), pins(&panes.b).len()], [2, 2]);
    assert!(pins(&panes.b).iter().any(|pin| near(place(&a, 700), place(&panes.b, *pin))));
    panes.apply(&mut a, Pane::A, Command::TogglePin(100)).unwrap();
    assert_eq!([pins(&a), vec![pins(&panes.b).len()]], [vec![700], vec![1]]);

    run_pulled(&mut a, &mut panes, 12);
    let grabs = [&a, &panes.b].map(|sandbox| sandbox.simulation().grab().unwrap());
    assert!(near(place(&a, grabs[0].vertex), place(&panes.b, grabs[1].vertex)));
    let apart = panes.record.last().unwrap().positions.unwrap().relative;
    assert!(apart > 0.0 && apart < 0.5, "two meshes move alike, but not equally: {apart}");
}

/// Paths and notes of vertices go to the same places of another mesh.
#[test]
fn paths_and_notes_keep_their_places_on_another_mesh() {
    let (mut a, mut panes) = pair("gingerbread");
    let coarse = mesh(&a.document().level, 300.0);
    panes.apply(&mut a, Pane::B, Command::SetMesh(0, coarse)).unwrap();
    let path = vec![(0.0, [0.0; 3]), (0.5, [0.1, 0.0, 0.0])];
    let last = a.simulation().scene().vertices() - 1;
    panes.apply(&mut a, Pane::A, Command::MoveAlong(last, path)).unwrap();
    panes.apply(&mut a, Pane::A, Command::AddNote(Spot::Vertex(last))).unwrap();
    let places = [&a, &panes.b].map(|sandbox| {
        let scene = sandbox.simulation().scene();
        let held = scene.held().next().unwrap();
        let [note] = sandbox.note_vertices()[..] else { unreachable!("there is one note") };
        assert_eq!(note, Some(held as usize));
        [0, 1].map(|axis| scene.rest[2 * held as usize + axis])
    });
    let gap = (places[0][0] - places[1][0]).hypot(places[0][1] - places[1][1]);
    assert!(gap < 0.03, "{places:?}");
}

#[test]
fn undo_of_a_model_puts_both_panes_back_to_where_they_were() {
    let (mut a, mut panes) = pair("gingerbread");
    run_pulled(&mut a, &mut panes, 12);
    let before = [&a, &panes.b].map(|sandbox| sandbox.simulation().state().clone());
    panes.apply(&mut a, Pane::B, Command::SetModel(Model::NeoHookean)).unwrap();
    assert_eq!([&a, &panes.b].map(|sandbox| sandbox.simulation().state().time), [0.0, 0.0], "both start over");
    assert_eq!(a.shown.bodies[0].material.model(), Model::Corotated);
    panes.apply(&mut a, Pane::A, Command::Undo).unwrap();
    assert_eq!([&a, &panes.b].map(|sandbox| sandbox.simulation().state().clone()), before);
    panes.apply(&mut a, Pane::A, Command::Redo).unwrap();
    assert_eq!([&a, &panes.b].map(|sandbox| sandbox.simulation().state().time), [0.0, 0.0]);
    assert_eq!(panes.b.shown.bodies[0].material.model(), Model::NeoHookean);
}

/// Both panes share one history of changes.
#[test]
fn one_slider_drag_is_one_undo_step_in_both_panes() {
    let a = &mut Sandbox::new(level("gingerbread"), Box::new(NoFiles)).unwrap();
    let first = a.shown.clone();
    a.apply(Command::TogglePin(5)).unwrap();
    let pinned = a.shown.clone();
    let mut panes = Comparison::new(a);
    for density in [200.0, 300.0, 400.0] {
        let mass = MassLevel::Density(Density::new(density).unwrap());
        panes.apply(a, Pane::B, Command::SetMass(0, mass)).unwrap();
    }
    panes.apply(a, Pane::B, substeps(50)).unwrap();
    panes.apply(a, Pane::B, Command::Undo).unwrap();
    assert_eq!(a.shown, panes.b.shown);
    panes.apply(a, Pane::B, Command::Undo).unwrap();
    assert!(a.shown == pinned && panes.b.shown == pinned);
    assert!(look(a, &mut panes).can_undo);
    panes.apply(a, Pane::B, Command::Undo).unwrap();
    assert!(a.shown == first && panes.b.shown == first);
    assert!(!look(a, &mut panes).can_undo);
    for _ in 0..3 {
        panes.apply(a, Pane::B, Command::Redo).unwrap();
    }
    assert_eq!([a.shown.substeps.get(), panes.b.shown.substeps.get()], [100, 50]);
    assert!(!look(a, &mut panes).can_redo);
}

/// The panels then show the pane with the fault.
#[test]
fn a_fault_in_one_pane_stops_both_at_the_same_time() {
    for count in [1, 2, 3] {
        let (mut a, mut panes) = pair("gingerbread_pulled");
        panes.choose(Pane::A);
        panes.apply(&mut a, Pane::B, substeps(count)).unwrap();
        panes.apply(&mut a, Pane::B, Command::SetGuard(Toggle::Off)).unwrap();
        panes.apply(&mut a, Pane::A, Command::SetMode(Mode::Collide)).unwrap();
        for _ in 0..600 {
            panes.advance(&mut a, 1, &mut || true);
        }
        assert!(panes.b.simulation().fault().is_some() && a.simulation().fault().is_none());
        assert!(!panes.is_live(&a) && !panes.is_between() && panes.chosen() == Pane::B);
        let seen = look(&a, &mut panes);
        assert!(!seen.running && panes.snapshot.time > 0.0);
        let behind = panes.snapshot.time - seen.time;
        assert!(behind > -1e-9 && behind < a.step_length(), "{count}: A goes as far as B has come, {behind}");
        panes.apply(&mut a, Pane::A, Command::Reset).unwrap();
        assert!(panes.is_live(&a), "starting over lets both run again");
    }
}

#[test]
fn choosing_one_model_ends_side_by_side_in_both_panes() {
    let (mut a, mut panes) = pair("stretch_test");
    panes.apply(&mut a, Pane::A, Command::SetSideBySide(true)).unwrap();
    assert_eq!([&a, &panes.b].map(|sandbox| sandbox.shown.bodies.len()), [Model::ALL.len(); 2]);
    panes.apply(&mut a, Pane::B, Command::SetModel(Model::NeoHookean)).unwrap();
    let only = |sandbox: &Sandbox| (sandbox.shown.bodies.len(), sandbox.shown.bodies[0].material.model());
    assert_eq!([&a, &panes.b].map(only), [(1, Model::Corotated), (1, Model::NeoHookean)]);
    panes.apply(&mut a, Pane::B, Command::Undo).unwrap();
    assert_eq!([&a, &panes.b].map(|sandbox| sandbox.shown.bodies.len()), [Model::ALL.len(); 2]);
}

#[test]
fn the_table_names_level_settings_and_units() {
    let (mut a, mut panes) = pair("gingerbread");
    panes.apply(&mut a, Pane::B, substeps(50)).unwrap();
    run_pulled(&mut a, &mut panes, 5);
    let text = panes.record.csv();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "# level: Gingerbread man");
    assert!(lines[1].contains("0.167 ms") && lines[2].contains("0.333 ms") && lines[2].contains("triangles"), "{text}");
    for name in ["commit", "processor", "threads", "reference"] {
        assert!(text.contains(&format!("# {name}: ")), "{name}: {text}");
    }
    let table: Vec<_> = lines.iter().filter(|line| !line.starts_with('#')).collect();
    assert_eq!(*table[0], "time_s,positions_m,positions_relative,energy_j,ms_a,ms_b");
    assert!(table.len() > 3 && table.iter().all(|line| line.split(',').count() == 6), "{text}");
}

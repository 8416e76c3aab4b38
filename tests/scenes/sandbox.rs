//! What commands do to a sandbox: modes, edits, undo, tests, and that a refused command changes nothing.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{level, material, opened, seen};
use gingerbread::{
    command::{Command, Mode},
    files,
    level::{EffectLevel, Level, MassLevel, Pin, Substeps, Switch},
    levels::built_in,
    materials::Model,
    meshes::NoFiles,
    quantity::Density,
    report::Counts,
    sandbox::Sandbox,
};

fn small() -> Sandbox {
    let text = "(name: \"small\", bodies: [(name: \"s\", mesh: Rectangle(width: 0.4, height: 0.4, columns: 3, rows: 3), mass: Total(1),
        stretch: (1.2, 1), material: (model: Corotated, young: 100, poisson: 0.3))],
        effects: [(effect: Gravity(down: 1), when: Collide), (effect: MouseSpring(stiffness: 50))])";
    Sandbox::new(level(text), Box::new(NoFiles)).unwrap()
}

fn run(sandbox: &mut Sandbox, steps: u64) {
    assert_eq!(sandbox.advance(steps, &mut || true), steps);
}

#[test]
fn it_starts_in_edit_mode_where_time_stands_still() {
    let mut sandbox = opened("gingerbread");
    assert_eq!(seen(&sandbox).mode, Mode::Edit);
    assert_eq!(sandbox.advance(100, &mut || true), 0);
    sandbox.apply(Command::SetRunning(true)).unwrap();
    assert_eq!((seen(&sandbox).mode, seen(&sandbox).running), (Mode::Simulate, true), "play goes to the level's mode");
    let mut house = opened("gingerbread_house");
    house.apply(Command::SetRunning(true)).unwrap();
    assert_eq!(seen(&house).mode, Mode::Collide);
}

#[test]
fn only_collide_mode_has_the_effects_kept_for_it() {
    let mut sandbox = small();
    let height = |sandbox: &Sandbox| seen(sandbox).positions.iter().skip(1).step_by(2).sum::<f64>();
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    let start = height(&sandbox);
    run(&mut sandbox, 100);
    assert!((height(&sandbox) - start).abs() < 1e-12, "no gravity in simulate mode");
    sandbox.apply(Command::SetMode(Mode::Collide)).unwrap();
    run(&mut sandbox, 100);
    assert!(height(&sandbox) < start - 1e-4, "gravity in collide mode");
}

#[test]
fn a_pull_draws_the_vertex_until_release() {
    let mut sandbox = small();
    assert!(sandbox.apply(Command::Grab(0, [0.0, 0.0, 0.0])).is_err(), "nothing can be pulled in edit mode");
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    sandbox.apply(Command::Grab(0, [-1.0, -1.0, 0.0])).unwrap();
    sandbox.apply(Command::Pull([-2.0, 0.0, 0.0])).unwrap();
    let before = seen(&sandbox);
    let pull = before.pull.unwrap();
    let distance = (before.positions[0] + 2.0).hypot(before.positions[1]);
    assert!(pull.vertex == 0 && pull.target == [-2.0, 0.0, 0.0] && (pull.force - 50.0 * distance).abs() < 1e-12);
    run(&mut sandbox, 200);
    assert!(seen(&sandbox).positions[0] < before.positions[0] - 0.01);
    sandbox.apply(Command::Release).unwrap();
    assert!(seen(&sandbox).pull.is_none());
    assert!(sandbox.apply(Command::Grab(999, [0.0, 0.0, 0.0])).is_err());
    assert!(sandbox.apply(Command::Grab(0, [f64::NAN, 0.0, 0.0])).is_err());
}

#[test]
fn choosing_a_model_starts_over_and_can_be_undone() {
    let mut sandbox = small();
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    run(&mut sandbox, 50);
    let moved = seen(&sandbox);
    for model in [Model::StVenantKirchhoff, Model::NeoHookean] {
        sandbox.apply(Command::SetModel(model)).unwrap();
        let now = seen(&sandbox);
        assert!(now.bodies.iter().all(|body| body.material.model() == Some(model)));
        assert!(now.positions == *now.start && now.energies.kinetic == 0.0 && now.time == 0.0);
        run(&mut sandbox, 10);
    }
    for _ in 0..2 {
        sandbox.apply(Command::Undo).unwrap();
    }
    let back = seen(&sandbox);
    assert_eq!((back.positions, back.bodies[0].material.model()), (moved.positions, Some(Model::Corotated)));
}

#[test]
fn pins_are_toggled_undone_redone_and_cleared() {
    let mut sandbox = small();
    for vertex in [5, 3, 5, 7] {
        sandbox.apply(Command::TogglePin(vertex)).unwrap();
    }
    assert_eq!(*seen(&sandbox).pins, [3, 7]);
    sandbox.apply(Command::Undo).unwrap();
    sandbox.apply(Command::Undo).unwrap();
    assert_eq!(*seen(&sandbox).pins, [3, 5]);
    sandbox.apply(Command::Redo).unwrap();
    assert_eq!(*seen(&sandbox).pins, [3]);
    assert!(seen(&sandbox).can_redo);
    sandbox.apply(Command::ClearPins).unwrap();
    assert!(seen(&sandbox).pins.is_empty() && !seen(&sandbox).can_redo, "a new edit ends what could be redone");
    assert!(sandbox.apply(Command::TogglePin(99)).is_err());
    sandbox.apply(Command::Undo).unwrap();
    assert_eq!(sandbox.saved().bodies[0].pins, [Pin::Vertex(3)]);
}

#[test]
fn a_pin_set_on_a_moving_body_holds_it_where_it_is() {
    let mut sandbox = small();
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    run(&mut sandbox, 30);
    sandbox.apply(Command::TogglePin(0)).unwrap();
    let held = seen(&sandbox).positions[..2].to_vec();
    run(&mut sandbox, 100);
    assert_eq!(seen(&sandbox).positions[..2], held[..]);
    assert_ne!(held[..], seen(&sandbox).start[..2], "it was not sent back");
}

#[test]
fn a_slider_acts_at_once_and_one_gesture_is_one_undo() {
    let mut sandbox = small();
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    run(&mut sandbox, 20);
    let before = seen(&sandbox).positions;
    for young in [200.0, 300.0, 400.0] {
        sandbox.apply(Command::SetMaterial(0, material(young))).unwrap();
    }
    sandbox.apply(Command::EndGesture).unwrap();
    sandbox.apply(Command::SetMaterial(0, material(500.0))).unwrap();
    let lame = |sandbox: &Sandbox| sandbox.simulation().scene().bodies[0].elements.material().lame().mu;
    assert!((lame(&sandbox) - 500.0 / 2.4).abs() < 1e-12, "mu = E / (2 (1 + nu)) at once");
    assert_eq!(seen(&sandbox).positions, before, "a slider does not move anything");
    sandbox.apply(Command::Undo).unwrap();
    assert!((lame(&sandbox) - 400.0 / 2.4).abs() < 1e-12);
    sandbox.apply(Command::Undo).unwrap();
    assert!((lame(&sandbox) - 100.0 / 2.6).abs() < 1e-12, "the whole gesture is gone");
    sandbox.apply(Command::SetMass(0, MassLevel::Density(Density::new(10.0).unwrap()))).unwrap();
    assert!((sandbox.simulation().scene().mass.iter().sum::<f64>() / 2.0 - 1.6).abs() < 1e-12);
    sandbox.apply(Command::SetSubsteps(Substeps::new(200).unwrap())).unwrap();
    assert!((sandbox.step_length() - 1.0 / 12000.0).abs() < 1e-18);
}

#[test]
fn effects_are_switched_and_damping_is_found_or_added() {
    let mut sandbox = small();
    let count = seen(&sandbox).level.effects.len();
    sandbox.apply(Command::SetDamping(true)).unwrap();
    assert!(seen(&sandbox).damping && seen(&sandbox).level.effects.len() == count + 1);
    sandbox.apply(Command::SetDamping(false)).unwrap();
    assert!(!seen(&sandbox).damping && seen(&sandbox).level.effects.len() == count + 1, "off, but still listed");
    let listed: EffectLevel = seen(&sandbox).level.effects[0].clone();
    sandbox.apply(Command::SetEffect(0, EffectLevel { switch: Switch::Off, ..listed })).unwrap();
    sandbox.apply(Command::SetMode(Mode::Collide)).unwrap();
    assert!(!sandbox.simulation().scene().effects.iter().any(|effect| effect.name() == "Gravity"));
    let listed = seen(&sandbox).level.effects[0].clone();
    assert!(sandbox.apply(Command::SetEffect(9, listed)).is_err());
}

#[test]
fn every_effect_can_be_added_acts_at_once_and_is_taken_back() {
    let mut refused = Vec::new();
    for kind in gingerbread::effects::EffectKind::all() {
        let mut sandbox = small();
        if let Err(why) = kind.fits(&sandbox.simulation().scene().elements) {
            let before = seen(&sandbox);
            let error = sandbox.apply(Command::AddEffect(kind.clone())).unwrap_err().to_string();
            assert!(error.contains(&why), "{error}");
            assert_eq!(seen(&sandbox).level, before.level, "{}", kind.name());
            refused.push(kind.name());
            continue;
        }
        let count = seen(&sandbox).level.effects.len();
        let acting = sandbox.simulation().scene().effects.len();
        sandbox.apply(Command::AddEffect(kind.clone())).unwrap();
        assert_eq!(seen(&sandbox).level.effects.last().map(|listed| &listed.effect), Some(&kind));
        assert_eq!(sandbox.simulation().scene().effects.len(), acting + 1, "{}", kind.name());
        sandbox.apply(Command::Undo).unwrap();
        assert_eq!(seen(&sandbox).level.effects.len(), count);
    }
    // What acts on nets and on cloth alone; the window's menu leaves them out.
    assert_eq!(refused, ["Projection", "Wind", "Vortex", "Rain", "Bending", "Rods", "AbsoluteDamping"]);
    assert!(opened("circle").apply(Command::AddEffect(gingerbread::effects::EffectKind::all().remove(0))).is_err());
}

#[test]
fn opening_a_level_can_be_undone_and_a_bad_one_changes_nothing() {
    let mut sandbox = small();
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    run(&mut sandbox, 40);
    let before = seen(&sandbox);
    let bad = Level { bodies: Vec::new(), ..Level::clone(&before.level) };
    assert!(sandbox.apply(Command::Open(Box::new(bad))).is_err());
    assert_eq!(seen(&sandbox).positions, before.positions);
    assert_eq!(seen(&sandbox).mode, Mode::Simulate);
    let other = files::parse(built_in("cantilever").unwrap(), "cantilever").unwrap();
    sandbox.apply(Command::Open(Box::new(other))).unwrap();
    assert_eq!((seen(&sandbox).level.name.as_str(), seen(&sandbox).mode), ("Cantilever", Mode::Edit));
    assert_ne!(seen(&sandbox).generation, before.generation);
    sandbox.apply(Command::Undo).unwrap();
    assert_eq!((seen(&sandbox).level.name.as_str(), seen(&sandbox).positions), ("small", before.positions));
    sandbox.apply(Command::Redo).unwrap();
    assert_eq!(seen(&sandbox).level.name, "Cantilever");
}

#[test]
fn reset_goes_back_to_the_start_and_keeps_the_edits() {
    let mut sandbox = small();
    sandbox.apply(Command::TogglePin(2)).unwrap();
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    run(&mut sandbox, 40);
    sandbox.apply(Command::Reset).unwrap();
    let now = seen(&sandbox);
    assert!(now.positions == *now.start && now.time == 0.0 && *now.pins == [2] && now.mode == Mode::Simulate);
    assert_eq!(sandbox.simulation().counts(), Counts::default(), "what was counted went with it");
}

#[test]
fn a_level_opens_the_same_whatever_was_shown_before() {
    let opened = |mode| {
        let mut sandbox = small();
        sandbox.apply(Command::SetMode(mode)).unwrap();
        sandbox.advance(40, &mut || true);
        let other = Level::clone(&seen(&small()).level);
        sandbox.apply(Command::Open(Box::new(other))).unwrap();
        let effects = sandbox.simulation().scene().effects.len();
        (effects, sandbox.simulation().energies(), sandbox.simulation().counts())
    };
    let new = small();
    let expected = (new.simulation().scene().effects.len(), new.simulation().energies(), Counts::default());
    for mode in [Mode::Edit, Mode::Simulate, Mode::Collide] {
        assert_eq!(opened(mode), expected, "{mode:?}");
    }
}

#[test]
fn a_fault_pauses_and_reset_takes_it_away() {
    let mut sandbox = small();
    sandbox.apply(Command::SetMaterial(0, material(1e13))).unwrap();
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    sandbox.advance(100_000, &mut || true);
    let fault = seen(&sandbox).fault.unwrap().to_string();
    assert!(fault.contains("stability limit") && !sandbox.is_live(), "{fault}");
    assert!(seen(&sandbox).positions.iter().all(|x| x.is_finite()));
    sandbox.apply(Command::Reset).unwrap();
    assert!(seen(&sandbox).fault.is_none() && sandbox.is_live());
}

#[test]
fn what_is_saved_goes_on_exactly() {
    let mut sandbox = small();
    sandbox.apply(Command::SetMode(Mode::Collide)).unwrap();
    run(&mut sandbox, 123);
    let saved = files::parse(&files::write(&sandbox.saved()).unwrap(), "saved").unwrap();
    assert_eq!(saved.bodies[0].mesh, seen(&sandbox).level.bodies[0].mesh);
    let mut again = Sandbox::new(saved, Box::new(NoFiles)).unwrap();
    again.apply(Command::SetRunning(true)).unwrap();
    assert_eq!(seen(&again).mode, Mode::Collide, "a level remembers how it was running");
    run(&mut again, 100);
    run(&mut sandbox, 100);
    assert_eq!(again.simulation().state(), sandbox.simulation().state());
}

#[test]
fn a_pull_survives_a_reset_and_a_change_of_mode() {
    let mut sandbox = small();
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    sandbox.apply(Command::Grab(0, [0.0, 0.0, 0.0])).unwrap();
    for command in [Command::Reset, Command::SetMode(Mode::Collide)] {
        sandbox.apply(command).unwrap();
        assert!(seen(&sandbox).pull.is_some());
    }
    sandbox.apply(Command::SetMode(Mode::Edit)).unwrap();
    assert!(seen(&sandbox).pull.is_none());
}

#[test]
fn opening_a_level_reads_its_mesh_file_again() {
    struct Changing(std::sync::atomic::AtomicBool);
    impl gingerbread::meshes::Files for Changing {
        fn read(&self, _: &std::path::Path) -> Result<String, String> {
            let more = self.0.fetch_xor(true, std::sync::atomic::Ordering::Relaxed);
            Ok(format!(
                "v 0 0\nv 1 0\nv 1 1\nv 0 1\nf 1 2 3\n{}",
                if more { "f 1 3 4\n" } else { "v -1 1\nf 1 3 4\nf 1 4 5\n" }
            ))
        }
    }
    let text = "(name: \"\", bodies: [(name: \"\", mesh: Obj(path: \"a.obj\"), mass: Total(1), material: (model: Corotated, young: 1, poisson: 0))])";
    let mut sandbox = Sandbox::new(level(text), Box::new(Changing(true.into()))).unwrap();
    assert_eq!(seen(&sandbox).triangles.len(), 2);
    sandbox.apply(Command::SetModel(Model::NeoHookean)).unwrap();
    assert_eq!(seen(&sandbox).triangles.len(), 2, "while a level is open its mesh stays");
    sandbox.apply(Command::Open(Box::new(level(text)))).unwrap();
    assert_eq!(seen(&sandbox).triangles.len(), 3);
}

#[test]
fn another_mesh_keeps_the_places_of_pins_and_can_be_undone() {
    for side_by_side in [false, true] {
        let mut sandbox = opened("stretch_test");
        sandbox.apply(Command::SetSideBySide(side_by_side)).unwrap();
        sandbox.apply(Command::TogglePin(400)).unwrap();
        sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
        run(&mut sandbox, 20);
        let before = seen(&sandbox);
        let places = |sandbox: &Sandbox| {
            let scene = sandbox.simulation().scene();
            scene.pins.iter().map(|pin| [0, 1].map(|axis| scene.rest[2 * *pin as usize + axis])).collect::<Vec<_>>()
        };
        let pinned = places(&sandbox);
        let mut mesh = before.level.bodies[0].mesh.clone();
        for number in mesh.kind_mut().parameters().into_iter().skip(2) {
            number.set(2.0 * number.get()).unwrap();
        }
        sandbox.apply(Command::SetMesh(0, mesh)).unwrap();
        let now = seen(&sandbox);
        assert!(now.triangles.len() == 4 * before.triangles.len() && now.time == 0.0);
        let near = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-9;
        let kept = places(&sandbox);
        assert!(kept.len() == pinned.len() && pinned.iter().all(|a| kept.iter().any(|b| near(a, b))), "{side_by_side}");
        sandbox.apply(Command::Undo).unwrap();
        let back = seen(&sandbox);
        assert_eq!((&back.level, &back.positions, back.time), (&before.level, &before.positions, before.time));
    }
}

#[test]
fn a_fork_continues_bit_equal_and_is_independent() {
    let mut first = small();
    first.apply(Command::SetRunning(true)).unwrap();
    run(&mut first, 30);
    first.apply(Command::Grab(3, [0.9, 0.9, 0.0])).unwrap();
    let mut fork = first.fork();
    run(&mut first, 30);
    run(&mut fork, 30);
    assert_eq!(first.simulation().state(), fork.simulation().state());
    let before = seen(&first);
    fork.apply(Command::SetModel(Model::NeoHookean)).unwrap();
    fork.apply(Command::TogglePin(1)).unwrap();
    run(&mut fork, 30);
    let now = seen(&first);
    assert_eq!((now.positions, now.level, now.can_undo), (before.positions, before.level, before.can_undo));
}

//! The guard against unstable steps, and turning time back.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{level, models, running, sheet, simulation};
use gingerbread::{
    command::Command,
    files,
    guard::{Guard, Verdict},
    hard::{Account, random::Outcome},
    integrators::IntegratorKind,
    level::{Level, Toggle},
    levels::BUILT_IN,
    report::Energies,
    rewind::Rewind,
    simulation::Simulation,
    stability::critical_step,
};

/// A stretched sheet let go, with a step that is so many times the stability limit at the start.
fn released(model: &str, share: f64, more: &str) -> Simulation {
    let mut run = simulation(&sheet(model, "stretch: (1.2, 1)", more));
    let mut scene = run.scene().clone();
    scene.step = share * critical_step(&scene, run.state(), None).unwrap();
    run.replace_scene(scene);
    run
}

/// The energy stays bounded; without the guard it explodes.
#[test]
fn the_guard_divides_steps_above_the_stability_limit() {
    for model in models() {
        for share in [1.05, 2.0, 7.0, 25.0] {
            let mut guarded = released(model, share, "");
            let before = guarded.energies().total();
            assert_eq!(guarded.advance(300, &mut || true), 300, "{model} {share}: {:?}", guarded.fault());
            let (counts, after) = (guarded.counts(), guarded.energies().total());
            assert!(counts.guarded > 0 && counts.retaken < counts.guarded, "{model} {share}: {counts:?}");
            assert!(after < 2.5 * before, "{model} {share}: {after} of {before}");
            let mut bare = released(model, share, "guard: Off");
            bare.advance(300, &mut || true);
            let after = bare.energies().total();
            assert!(bare.fault().is_some() || after > 100.0 * before, "{model} {share}: {after} of {before}");
            assert_eq!(bare.counts().guarded, 0);
        }
    }
}

/// Even 64 parts are not short enough; the fault says why.
#[test]
fn a_step_beyond_rescue_pauses_on_the_last_good_state() {
    let mut run = released("Corotated", 2000.0, "");
    let before = run.energies().total();
    run.advance(100, &mut || true);
    let fault = run.fault().unwrap().to_string();
    assert!(fault.contains("stability limit"), "{fault}");
    assert!(run.energies().total() < 2.5 * before && run.state().is_finite());
    assert!(run.counts().retaken <= 6, "{:?}", run.counts());
}

/// Damping by stiffness lowers the stability limit to a millionth of the step, inside a ball that moves and may supply energy.
#[test]
fn a_step_far_above_the_damping_limit_gains_no_energy() {
    let text = gingerbread::levels::built_in("rolling_pin").unwrap();
    let wild =
        text.replace("stiffness: 0.0005", "stiffness: 0.49999").replace("centre: (0.5, 0.195)", "centre: (0.5, 0)");
    assert_eq!(wild.matches("0.49999").count() + wild.matches("(0.5, 0)").count(), 2);
    let mut run = simulation(&level(&wild));
    let before = run.energies().total();
    let taken = run.advance(5, &mut || true);
    assert!(taken < 5 && run.fault().unwrap().to_string().contains("stability limit"), "{:?}", run.fault());
    assert!(
        run.energies().total() < 2.0 * before && run.inversion().0 > 0.5,
        "{} of {before} J",
        run.energies().total()
    );
    assert!(run.counts().retaken < 20, "{:?}", run.counts());
}

#[test]
fn a_net_is_guarded_too() {
    let text = "(name: \"\", substeps: 1, nets: [(name: \"wire\", net: Chain(from: (0, 0), to: (1, 0), springs: 2, stiffness: 1e6, rest: 0.4), mass: 1)])";
    let mut run = simulation(&level(text));
    let before = run.energies().total();
    assert_eq!(run.advance(600, &mut || true), 600);
    assert!(run.counts().guarded > 0 && run.energies().total() < 2.5 * before);
}

/// Slow growth is shown, as it is a property of a scheme, up to a bound on the sum of it. Longer steps of schemes that
/// are stable at no step end with a fault.
#[test]
fn energy_from_nowhere_is_bounded_over_a_run() {
    for (integrator, substeps, steps) in [("ForwardEuler", 20, 20_000_u64), ("Heun", 2, 60_000)] {
        let text = format!(
            "(name: \"\", substeps: {substeps}, integrator: {integrator}(), nets: [(name: \"s\", net: Chain(from: (0.2, 0.5),
                to: (0.8, 0.5), springs: 1, stiffness: 100, rest: 0.5), mass: 1)]"
        );
        let run = |more: &str| {
            let mut run = simulation(&level(&format!("{text}{more})")));
            let before = run.energies().total();
            run.advance(steps, &mut || true);
            (run.energies().total() / before, run)
        };
        let (bare, _) = run(", guard: Off");
        assert!(bare > 4.0, "{integrator} gains: {bare}");
        let (guarded, run) = run("");
        assert!(guarded > 1.5 && guarded < 1.001 + Guard::EXCESS, "{integrator}: {guarded}");
        assert!(run.counts().guarded > 0 || run.fault().is_some(), "{integrator}");
    }
}

/// Two sheets that meet at 30 m/s, one frame of 1/60 s a step, with forward Euler: the guard takes the steps of the impact again, in shorter ones that lose
/// less.
const MEETING: &str = r#"(name: "", mode: Collide, substeps: 1, integrator: ForwardEuler(), membranes: [
    (name: "0", mesh: Rectangle(width: 0.799929004837153, height: 0.799929004837153, columns: 4, rows: 5,
        corner: (-0.3999645024185765, -0.3999645024185765)),
        material: (model: StableNeoHookean, young: 46758.76482005433, poisson: 0.012181894683744757, plane: Stress),
        thickness: 0.0035577983508511776, mass: Density(271.63014025210816),
        space: (turn: (82.93966635130346, 148.3252940978855, 0), velocity: (-0.784440606999577, 16.279433259167103, 0))),
    (name: "1", mesh: Rectangle(width: 0.745996897411641, height: 0.745996897411641, columns: 6, rows: 7,
        corner: (-0.3729984487058205, -0.3729984487058205)),
        material: (model: StableNeoHookean, young: 12074.80951199637, poisson: 0.37604421525262294, plane: Stress),
        thickness: 0.0012947512096235033, mass: Density(308.22438250277105),
        space: (turn: (80.92366800643504, -34.07968556508422, 0), offset: (0, 4.786134216215713, 0),
            velocity: (-0.24798017886673818, -13.682694228284175, 0)))],
    effects: [(effect: Rayleigh(mass: 0.1, stiffness: 0.00015401558957579652)),
        (effect: Contact(modulus: 9.882994610210172, thickness: 0.0832536070025897, speed: 10.34636929685261, dissipation: 0))])"#;

/// What was lost in steps that were taken back is not lost, and so does not come from nowhere.
#[test]
fn an_account_forgets_steps_that_were_taken_back() {
    let mut run = simulation(&level(MEETING));
    let [mut account, mut of_all] = [0, 1].map(|_| Account::new(run.scene(), run.energies()));
    for _ in 0..11 {
        run.advance(1, &mut || true);
        run.check_energy();
        of_all.record(run.energies());
        account.record_steps(&mut run);
    }
    assert!(run.fault().is_none() && run.counts().retaken > 0);
    assert!(run.taken_back().is_none(), "it is told once");
    assert!(account.gain() > 0.0 && account.gain() < 0.8 * of_all.gain(), "{} {}", account.gain(), of_all.gain());
}

/// A bead on a narrow circle that is pulled, with forward Euler. The three shortest step lengths agree on a gain of energy, though nothing supplies it.
const NARROW: &str = r#"(name: "", substeps: 3, integrator: ForwardEuler(),
    nets: [(name: "beads", net: Links(points: [(0.5, 0.85), (0.6, 0.6)], springs: [(0, 1, 40.0, 0.2)]), mass: 0.1)],
    effects: [
        (effect: Wire(beads: [Vertex(0)], wire: Circle(centre: (0.5, 0.6), radius: 0.07259268460306158), recovery: 10.0)),
        (effect: MouseSpring(stiffness: 30.460962082890077))],
    actions: [(at: 0, action: Grab(0.3598982582334429, 0.7507236127275974)),
        (at: 0, action: Pull(to: (0.848202561493963, 0.1672687695827335), over: 0.2)), (at: 0.5, action: Release)])"#;

/// A beam that is pulled, with Heun's method above its limit. More energy seems available in attempts that are taken back, as they come near the mouse.
const FLUNG: &str = r#"(name: "", substeps: 19, integrator: Heun(),
    bodies: [(name: "beam", mesh: Rectangle(width: 0.8, height: 0.04, columns: 10, rows: 1, diagonals: Crossed, corner: (0.1, 0.5)),
        element: MeanDilatation, material: (model: Hencky, young: 723663.1507792507, poisson: 0.4009572722716257, plane: Stress),
        mass: Density(142.93727795713843), pins: [Left])],
    effects: [(effect: MouseSpring(stiffness: 1000))],
    actions: [(at: 0, action: Grab(0.232657125685364, 0.9763168927747756)),
        (at: 0, action: Pull(to: (0.4514758354052901, 0.5767273278906941), over: 0.2)), (at: 0.5, action: Release)])"#;

/// A double pendulum whose rods dissipate energy in steps that are taken back: more is available in those that replace them.
const RODS: &str = r#"(name: "", substeps: 3, integrator: LinearlyImplicitEuler(),
    nets: [(name: "pendulum", net: Links(points: [(0.5, 0.6), (0.7, 0.6), (0.7, 0.8)], springs: [(0, 1, 0.0, 0.2), (1, 2, 0.0, 0.2)]),
        mass: 0.1, pins: [Vertex(0)])],
    effects: [(effect: Gravity(down: 98.55710422925333)), (effect: Rods(recovery: 41.12753838028432))])"#;

/// Energy from nowhere stays within its bound, or the run stops with its cause: neither what attempts agree on nor what was available in attempts
/// that were taken back is energy of the scene.
#[test]
fn attempts_that_are_taken_back_put_nothing_in() {
    for (text, goes_on) in [(MEETING, true), (NARROW, false), (FLUNG, true), (RODS, true)] {
        let run = Outcome::of(&level(text));
        assert!(run.gain < Guard::EXCESS && run.finite, "{run:?} {text}");
        assert!(run.guarded > 0 || run.fault.is_some(), "{run:?} {text}");
        assert_eq!(run.fault.is_none(), goes_on, "{run:?} {text}");
    }
    // Where the step lengths first agree, in an attempt at step 34.
    assert!(Outcome::of(&level(NARROW)).steps < 34);
    // The first frame of the beam, in which the mouse rests, without the help of an account.
    let mut run = simulation(&level(FLUNG));
    run.perform_due(&mut |_, _| {});
    let (start, mut available) = (run.energies().total(), 0.0_f64);
    for _ in 0..18 {
        run.advance(1, &mut || true);
        run.check_energy();
        let now = run.energies();
        available = available.max(start - now.potential);
        assert!(now.total() - start <= Guard::EXCESS * available, "{now:?} {available}");
    }
}

/// An undamped cloth that shakes itself apart in the middle of a frame, in which the guard looks at the energy only when that of motion has grown. The
/// run goes back by up to 20 steps.
#[test]
fn a_run_that_stops_keeps_a_state_within_the_bound() {
    for substeps in [160, 240] {
        let text = format!(
            "(name: \"\", substeps: {substeps}, integrator: Heun(), sleep: Off,
            membranes: [(name: \"cloth\", mesh: Rectangle(width: 1e-6, height: 1e-6, columns: 4, rows: 4, diagonals: Alternating, corner: (0, 0)),
                material: (model: Corotated, young: 0.2, poisson: 0.3, plane: Stress), thickness: 1e-9, mass: Density(300),
                space: (turn: (20, 0, 0)), pins: [Top])],
            effects: [(effect: Gravity(down: 9.8)), (effect: Bending())])"
        );
        let [mut run, mut same] = [0, 1].map(|_| simulation(&level(&text)));
        run.advance(10 * substeps, &mut || true);
        assert!(run.fault().is_some() && run.state().steps > 0, "{substeps}");
        // Nothing but gravity puts energy in.
        let start = same.energies();
        let mut put_in = 0.0_f64;
        while same.state().steps < run.state().steps {
            same.advance(1, &mut || true);
            put_in = put_in.max(start.total() - same.energies().potential);
        }
        assert_eq!(run.state().x, same.state().x);
        let rise = run.energies().total() - start.total();
        assert!(rise <= Guard::EXCESS * put_in, "{substeps}: {rise} of {put_in}");
    }
}

/// The bound is above the least energy, not above that at the start. What is saved holds it.
#[test]
fn dissipated_energy_does_not_hide_energy_from_nowhere() {
    let scene = released("Corotated", 0.1, "").scene().clone();
    let moving = |kinetic| Energies { kinetic, ..Energies::default() };
    let mut guard = Guard::default();
    guard.begin(moving(10.0));
    assert!(guard.keeps_bound(&scene, moving(4.0)));
    let mut reopened = Guard::from(&guard.saved(0).unwrap());
    assert_eq!(reopened, guard);
    for guard in [&mut guard, &mut reopened] {
        assert!(guard.keeps_bound(&scene, moving(18.9)) && !guard.keeps_bound(&scene, moving(19.1)));
        assert!(!guard.keeps_bound(&scene, moving(f64::NAN)));
        // Work of a wall is no energy from nowhere.
        guard.supply(2.0);
        assert!(guard.keeps_bound(&scene, moving(21.1)));
    }
}

/// A step 9 times the stability limit, which 16 shorter ones would hold: a frame would have 960,000 of them.
#[test]
fn a_frame_is_divided_into_no_more_steps_than_a_level_may_have() {
    let run = |substeps: u32, mass: f64| {
        let text = format!(
            "(name: \"\", substeps: {substeps}, nets: [(name: \"s\", net: Chain(from: (0.2, 0.5), to: (0.8, 0.5), springs: 1,
                stiffness: 1e11, rest: 0.5), mass: {mass:e})])"
        );
        let mut run = simulation(&level(&text));
        run.advance(1000, &mut || true);
        run
    };
    // Steps 100 times as long for 10,000 times the mass.
    let (long, short) = (run(600, 1.0), run(60_000, 1e-4));
    assert!(long.fault().is_none() && long.guard_substeps() >= 16, "{:?}", long.fault());
    assert!(short.fault().is_some() && short.counts().retaken == 0, "{:?}", short.counts());
    assert_eq!([1.0, 30_000.0, 100_000.0].map(|count| Guard::most_level(1.0 / (60.0 * count))), [6, 1, 0]);
}

/// Energy of motion gives an explicit explosion away. Equations may be answered by a shape that stores more and hardly moves.
#[test]
fn after_every_implicit_step_it_looks_at_what_is_stored_too() {
    let sweeps = |integrator: &str, guard: &str| {
        let mut run = released("Corotated", 0.1, &format!("integrator: {integrator}(), guard: {guard}"));
        run.advance(1, &mut || true);
        let before = run.energy_evaluations();
        run.advance(50, &mut || true);
        run.energy_evaluations() - before
    };
    for integrator in ["ImplicitEuler", "Bdf2", "ImplicitMidpoint", "EnergyMomentum"] {
        assert_eq!((sweeps(integrator, "On"), sweeps(integrator, "Off")), (50, 0), "{integrator}");
    }
    assert!(sweeps("SymplecticEuler", "On") < 25);
}

#[test]
fn no_shipped_level_needs_it() {
    for (file, text) in BUILT_IN {
        let mut run = simulation(&files::parse(text, file).unwrap());
        let steps = (0.5 / run.scene().step).round() as u64;
        run.advance(steps, &mut || true);
        assert_eq!((run.counts().guarded, run.counts().retaken), (0, 0), "{file}");
    }
}

#[test]
fn it_changes_no_bit_however_steps_are_bunched() {
    let run = |bunch: u64| {
        let mut run = released("NeoHookean", 3.0, "");
        while run.state().steps < 400 {
            run.advance(bunch.min(400 - run.state().steps), &mut || true);
        }
        (run.state().clone(), run.counts())
    };
    assert_eq!(run(1), run(400));
    assert_eq!(run(7), run(400));
}

/// What the mouse puts in is no energy from nowhere.
#[test]
fn a_hard_pull_is_not_mistaken_for_an_explosion() {
    // What grows at every step, however short, is not stable with or without a mouse.
    let stable = |kind: &IntegratorKind| kind.kind().stability_limit() != Some(0.0);
    for integrator in IntegratorKind::all().into_iter().filter(stable) {
        let effects = "effects: [(effect: MouseSpring(stiffness: 50))]";
        let level = Level { integrator, ..sheet("Corotated", "", effects) };
        let mut run = simulation(&level);
        for frame in 0..60 {
            let target = [if frame % 2 == 0 { 3.0 } else { -2.0 }, 0.5, 0.0];
            run.set_grab(Some(gingerbread::effects::Grab { vertex: 3, target }));
            assert_eq!(run.advance(100, &mut || true), 100, "{}: {:?}", level.integrator.name(), run.fault());
        }
        assert_eq!(run.counts().guarded, 0, "{}", level.integrator.name());
    }
}

#[test]
fn time_can_be_turned_back_to_the_bits_it_had() {
    let mut sandbox = running(sheet("NeoHookean", "stretch: (1.2, 1)", ""));
    let mut seen = vec![sandbox.simulation().state().clone()];
    for _ in 0..30 {
        sandbox.advance(100, &mut || true);
        seen.push(sandbox.simulation().state().clone());
    }
    sandbox.apply(Command::Rewind(10.0 * Rewind::FRAME)).unwrap();
    assert_eq!(*sandbox.simulation().state(), seen[20]);
    assert!(!sandbox.is_live(), "it pauses there");
    sandbox.apply(Command::Rewind(4.0 * Rewind::FRAME)).unwrap();
    assert_eq!(*sandbox.simulation().state(), seen[16]);
    sandbox.apply(Command::Rewind(1e9)).unwrap();
    assert_eq!(*sandbox.simulation().state(), seen[0], "no farther than there is");
    sandbox.apply(Command::SetRunning(true)).unwrap();
    sandbox.advance(1600, &mut || true);
    assert_eq!(*sandbox.simulation().state(), seen[16], "and from there it goes as before");
}

#[test]
fn a_fault_can_be_turned_back_from_and_mended() {
    let mut level = sheet("Corotated", "stretch: (1.2, 1)", "");
    level.guard = Toggle::Off;
    let mut sandbox = running(level);
    sandbox.advance(1000, &mut || true);
    sandbox.apply(Command::SetSubsteps(gingerbread::level::Substeps::new(2).unwrap())).unwrap();
    sandbox.advance(1_000_000, &mut || true);
    assert!(sandbox.simulation().fault().is_some());
    sandbox.apply(Command::Rewind(1.0)).unwrap();
    assert!(sandbox.simulation().fault().is_none() && sandbox.simulation().inversion().1 == 0);
    sandbox.apply(Command::SetGuard(Toggle::On)).unwrap();
    sandbox.apply(Command::SetRunning(true)).unwrap();
    assert_eq!(sandbox.advance(100, &mut || true), 100);
}

#[test]
fn what_is_kept_ends_with_a_restart_and_stays_small() {
    let mut sandbox = running(sheet("Corotated", "", ""));
    assert!(sandbox.apply(Command::Rewind(1.0)).unwrap_err().to_string().contains("nothing to go back to"));
    for _ in 0..20 {
        sandbox.advance(6000, &mut || true);
    }
    assert!((sandbox.rewind_length() - Rewind::SECONDS).abs() < 0.1, "{}", sandbox.rewind_length());
    sandbox.apply(Command::Reset).unwrap();
    assert!(sandbox.apply(Command::Rewind(1.0)).unwrap_err().to_string().contains("nothing to go back to"));
    sandbox.advance(100, &mut || true);
    assert!(sandbox.rewind_length() < 0.1);
}

#[test]
fn single_steps_can_be_turned_back() {
    let mut sandbox = running(sheet("Corotated", "stretch: (1.2, 1)", ""));
    for _ in 0..3 {
        sandbox.apply(Command::StepOnce).unwrap();
    }
    assert_eq!(sandbox.simulation().state().steps, 3);
    sandbox.apply(Command::Rewind(1.0)).unwrap();
    assert_eq!(*sandbox.simulation().state(), sandbox.simulation().scene().start);
}

#[test]
fn time_is_never_turned_forth() {
    let mut sandbox = running(sheet("Corotated", "stretch: (1.2, 1)", ""));
    sandbox.advance(6000, &mut || true);
    let (mut rewind, late) = (Rewind::default(), sandbox.simulation());
    rewind.keep(late);
    let time = late.state().time;
    assert_eq!(rewind.back(0.5 * time, 0.1), None);
    assert_eq!(rewind.back(time, 0.1).as_ref(), Some(&late.restart()));
}

/// What an obstacle seems to give a body that explodes is no work: elements cannot store a million times what they do at a stretch of one.
#[test]
fn supplied_energy_does_not_excuse_an_explosion() {
    let run = simulation(&sheet("Corotated", "", ""));
    let before = Energies { elastic: 1.0, ..Energies::default() };
    let judged = |elastic: f64| {
        let mut guard = Guard::default();
        guard.begin(before);
        guard.supply(1e300);
        guard.judge(run.scene(), Some(before), Energies { elastic, ..before })
    };
    assert_eq!(judged(1e3), Verdict::Fine);
    assert_eq!(judged(1e15), Verdict::Unstable);
}

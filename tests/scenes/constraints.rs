//! Facts about rigid rods and beads on a wire.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{continues_bit_for_bit, integrator, level, simulation, started};
use gingerbread::{
    effects::{Rods, Wire},
    files,
    integrators::IntegratorKind,
    level::Level,
    simulation::Simulation,
};

const GRAVITY: &str = "(effect: Gravity(down: 9.8))";

/// Links of 0.5 m that start level; the first end is pinned.
fn chain(links: usize, space: &str, effects: &str) -> Level {
    let points: Vec<_> = (0..=links).map(|number| format!("({}, 1)", 0.5 * number as f64)).collect();
    let springs: Vec<_> = (0..links).map(|number| format!("({number}, {}, 0, 0.5)", number + 1)).collect();
    level(&format!(
        "(name: \"\", sleep: Off, nets: [(name: \"chain\", mass: 0.2, pins: [Vertex(0)], {space}
            net: Links(points: [{}], springs: [{}]))], effects: [{effects}])",
        points.join(", "),
        springs.join(", ")
    ))
}

/// Angle of a pendulum released level, from that direction, by the classical Runge-Kutta method in steps of 0.1 ms.
fn angle(length: f64, time: f64) -> f64 {
    let rate = |[angle, speed]: [f64; 2]| [speed, 9.8 / length * f64::cos(angle)];
    let (mut state, steps) = ([0.0, 0.0], (time / 1e-4).ceil());
    let h = time / steps;
    for _ in 0..steps as usize {
        let plus = |k: [f64; 2], by: f64| [state[0] + by * k[0], state[1] + by * k[1]];
        let one = rate(state);
        let two = rate(plus(one, 0.5 * h));
        let three = rate(plus(two, 0.5 * h));
        let four = rate(plus(three, h));
        state = [0, 1].map(|n| state[n] + h / 6.0 * (one[n] + 2.0 * two[n] + 2.0 * three[n] + four[n]));
    }
    state[0]
}

fn end_of(run: &Simulation) -> [f64; 2] {
    let (x, size) = (&run.state().x, run.scene().dimension);
    [x[x.len() - size], x[x.len() - size + 1]]
}

/// A rod and a circular wire, in the plane and in space, make the same pendulum. Every scheme follows it with its order.
#[test]
fn a_rod_is_a_pendulum_under_every_scheme() {
    let wire = |centre: &str| {
        format!("{GRAVITY}, (effect: Wire(beads: [Vertex(1)], wire: Circle(centre: {centre}, radius: 0.5)))")
    };
    for kind in IntegratorKind::all().iter().filter(|kind| kind.kind().order() > 0) {
        for (what, level) in [
            ("rod", chain(1, "", &format!("{GRAVITY}, (effect: Rods())"))),
            ("rod in space", chain(1, "space: (),", &format!("{GRAVITY}, (effect: Rods(of: \"chain\"))"))),
            ("wire", chain(1, "", &wire("(0, 1)"))),
            ("wire in space", chain(1, "space: (),", &wire("(0, 1, 0)"))),
        ] {
            let scheme = ron::to_string(kind).unwrap();
            let error = |step: f64| {
                let mut run = started(&level, &scheme, step);
                run.advance((0.8 / step).round() as u64, &mut || true);
                assert!(run.fault().is_none(), "{scheme}, {what}: {:?}", run.fault());
                let (time, [x, y]) = (run.state().time, end_of(&run));
                let known = angle(0.5, time);
                let ends = [0.5 * f64::cos(known), 1.0 - 0.5 * f64::sin(known)];
                f64::hypot(x - ends[0], y - ends[1])
            };
            let (coarse, fine) = (error(2e-3), error(1e-3));
            let most = if kind.kind().order() == 1 { 0.03 } else { 3e-4 };
            assert!(coarse < most && fine < most, "{scheme}, {what}: {coarse} m, {fine} m");
            // Errors of the highest orders are round-off.
            let order = kind.kind().order().min(2);
            let is_exact = kind.kind().order() > 2;
            let observed = (coarse / fine).log2();
            assert!(is_exact || observed > f64::from(order) - 0.3, "{scheme}, {what}: order {observed:.2}");
        }
    }
}

/// A double pendulum keeps its energy and its lengths, as exactly as the scheme is.
#[test]
fn a_double_pendulum_keeps_energy_and_lengths() {
    for (scheme, energy, length) in [
        ("RungeKutta4()", 1e-6, 1e-7),
        ("DormandPrince(relative: 1e-9, absolute: 1e-9)", 1e-6, 1e-7),
        ("ImplicitMidpoint()", 2e-3, 1e-4),
        ("SymplecticEuler()", 0.05, 5e-3),
    ] {
        let mut run = started(&chain(2, "", &format!("{GRAVITY}, (effect: Rods())")), scheme, 1e-3);
        let start = run.energies().total();
        let (mut change, mut longest) = (0.0_f64, 0.0_f64);
        for _ in 0..300 {
            run.advance(10, &mut || true);
            change = change.max((run.energies().total() - start).abs());
            let x = &run.state().x;
            for link in 0..2 {
                let [dx, dy] = [0, 1].map(|axis| x[2 * link + axis] - x[2 * link + 2 + axis]);
                longest = longest.max((f64::hypot(dx, dy) - 0.5).abs());
            }
        }
        // It could fall by 0.5 m and 1 m.
        let fall = 0.2 * 9.8 * 1.5;
        assert!(change < energy * fall && longest < length, "{scheme}: {change} J of {fall} J, {longest} m");
    }
}

/// A pendulum whose pin swings keeps its length, and the work of the pin through the rod is in the balance.
#[test]
fn rods_follow_pins_that_move() {
    let pins = "(effect: MovingPins(pins: [Vertex(0)], motions: [Swing(way: (0, 0.1), period: 0.8)]))";
    for (scheme, most) in [
        ("RungeKutta4()", 1e-6),
        ("DormandPrince(relative: 1e-9, absolute: 1e-9)", 1e-6),
        ("ImplicitMidpoint()", 1e-3),
        ("VelocityVerlet()", 1e-3),
    ] {
        let effects = format!("{GRAVITY}, (effect: Rods()), {pins}");
        let mut run = started(&chain(1, "", &effects), scheme, 1e-3);
        let start = run.energies().total();
        let (mut worst, mut missing, mut given) = (0.0_f64, 0.0_f64, 0.0_f64);
        for _ in 0..200 {
            run.advance(10, &mut || true);
            let x = &run.state().x;
            worst = worst.max((f64::hypot(x[2] - x[0], x[3] - x[1]) - 0.5).abs());
            let work = run.work_of_obstacles();
            missing = missing.max((run.energies().total() - start - work).abs());
            given = given.max(work.abs());
        }
        assert!(run.fault().is_none() && worst < most, "{scheme}: {worst} m");
        assert!(given > 0.1 && missing < 0.01 * given, "{scheme}: {missing} J of {given} J");
    }
}

/// The recovery of a bead that starts off its wire is supplied energy: the guard lets it go there.
#[test]
fn a_bead_goes_to_its_wire_under_the_guard() {
    for kind in IntegratorKind::all() {
        let text = "(name: \"\", substeps: 20, nets: [(name: \"net\", mass: 0.1, pins: [Vertex(1)],
                net: Links(points: [(0.6, 0.5), (0, 9)], springs: [(0, 1, 0, 1)]))],
            effects: [(effect: Wire(beads: [Vertex(0)], wire: Circle(centre: (0.5, 0.5), radius: 0.3)))])";
        let mut run = simulation(&Level { integrator: kind.clone(), ..level(text) });
        run.advance(2400, &mut || true);
        assert!(run.fault().is_none(), "{}: {:?}", kind.name(), run.fault());
        let x = &run.state().x;
        assert!((f64::hypot(x[0] - 0.5, x[1] - 0.5) - 0.3).abs() < 1e-3, "{}: {x:?}", kind.name());
    }
}

#[test]
fn a_misspelt_field_of_a_wire_is_refused_with_its_place() {
    let text = "(name: \"\",\n effects: [(effect: Wire(beads: [Vertex(0)], wire: Circle(center: (0, 0), radius: 1)))])";
    let error = files::parse(text, "mine.ron").unwrap_err().to_string();
    assert!(error.contains("mine.ron:2:") && error.contains("center"), "{error}");
}

/// A bead on a sloping wire falls with the share of gravity along it.
#[test]
fn a_bead_slides_down_a_straight_wire() {
    for (space, line) in
        [("", "through: (0.5, 1), along: (3, -4)"), ("space: (),", "through: (0.5, 1, 0), along: (3, -4, 0)")]
    {
        let wire = format!("{GRAVITY}, (effect: Wire(beads: [Vertex(1)], wire: Line({line})))");
        let mut run = started(&chain(1, space, &wire), "RungeKutta4()", 1e-3);
        run.advance(500, &mut || true);
        let (time, [x, y]) = (run.state().time, end_of(&run));
        let along = 0.5 * 9.8 * 0.8 * time * time;
        assert!((x - 0.5 - 0.6 * along).abs() < 1e-9 && (y - 1.0 + 0.8 * along).abs() < 1e-9, "({x}, {y})");
    }
}

/// A sheet whose springs are rods falls and folds like chain mail.
#[test]
fn a_sheet_of_rods_moves_under_every_scheme() {
    for kind in IntegratorKind::all() {
        let text = format!(
            "(name: \"\", nets: [(name: \"sheet\", mass: 0.01, pins: [Vertex(0)], space: (turn: (90, 0, 0)),
                net: Sheet(width: 0.4, height: 0.4, columns: 4, rows: 4, structural: 0, shear: 0, flexion: 0, corner: (0, 0)))],
            effects: [{GRAVITY}, (effect: Rayleigh(mass: 1)), (effect: Rods())])"
        );
        let mut run = started(&level(&text), &ron::to_string(&kind).unwrap(), 1e-3);
        let start = run.energies().total();
        run.advance(600, &mut || true);
        assert!(run.fault().is_none(), "{}: {:?}", kind.name(), run.fault());
        let (x, now) = (&run.state().x, run.energies());
        for link in run.scene().nets[0].springs.links().iter().filter(|link| (link.rest - 0.1).abs() < 1e-9) {
            let [a, b] = link.ends.map(|end| 3 * end as usize);
            let length = (0..3).map(|axis| (x[a + axis] - x[b + axis]).powi(2)).sum::<f64>().sqrt();
            let most = if kind.kind().order() == 1 { 0.02 } else { 3e-3 };
            assert!((length - 0.1).abs() < most, "{}: {length} m", kind.name());
        }
        assert!(now.total() < start + 0.01 * now.kinetic, "{}: {now:?}", kind.name());
    }
}

/// A chain of rods falls on a floor, where contact acts on it too.
#[test]
fn a_chain_of_rods_comes_to_rest_on_a_floor() {
    for scheme in ["SymplecticEuler()", "VelocityVerlet()", "ImplicitEuler()", "LinearlyImplicitEuler()", "Bdf2()"] {
        let effects = format!(
            "{GRAVITY}, (effect: Rayleigh(mass: 2)), (effect: Rods()), (effect: Boundary(least: (-9, 0.4), greatest: (9, 9)))"
        );
        let mut run = started(&chain(4, "", &effects), scheme, 1e-3);
        run.advance(6000, &mut || true);
        assert!(run.fault().is_none(), "{scheme}: {:?}", run.fault());
        let lowest = run.state().x.iter().skip(1).step_by(2).fold(f64::INFINITY, |least, y| least.min(*y));
        let energies = run.energies();
        assert!(
            lowest > 0.4 && energies.contact > 0.01 && energies.kinetic < 1e-3,
            "{scheme}: {lowest} m, {energies:?}"
        );
    }
}

#[test]
fn rods_and_beads_continue_bit_for_bit() {
    for scheme in ["SymplecticEuler()", "Bdf2()", "DormandPrince(relative: 1e-6, absolute: 1e-6)"] {
        let level = Level { integrator: integrator(scheme), ..chain(3, "", &format!("{GRAVITY}, (effect: Rods())")) };
        continues_bit_for_bit(&level);
    }
}

#[test]
fn wrong_wires_are_refused_in_words() {
    let refused = |effect: &str| {
        let text = format!(
            "(name: \"\", nets: [(name: \"net\", mass: 1, net: Chain(from: (0, 0), to: (1, 0), springs: 2, stiffness: 0))],
            effects: [(effect: {effect})])"
        );
        let level = files::parse(&text, "mine.ron").unwrap();
        let built = gingerbread::scene::Scene::build(&level, level.mode, &gingerbread::meshes::NoFiles, None);
        built.err().unwrap().to_string()
    };
    for (effect, words) in [
        (
            "Wire(beads: [Vertex(0)], wire: Line(through: (0, 0), along: (0, 0)))",
            "direction of its wire must not be zero",
        ),
        ("Wire(beads: [Vertex(0)], wire: Line(through: (0, 0, 1), along: (0, 0, 1)))", "needs 2 coordinates, got 3"),
        ("Wire(beads: [Vertex(0)], wire: Line(through: (0, 0), along: (0, 0, 1)))", "different dimensions"),
        ("Wire(beads: [], wire: Line(through: (0, 0), along: (1, 0)))", "names no vertex"),
        (
            "Wire(of: \"nut\", beads: [Vertex(0)], wire: Circle(centre: (0, 0), radius: 1))",
            "no body or net is called \"nut\"",
        ),
        (
            "Wire(beads: [Vertex(0)], wire: Circle(centre: (0, 0), radius: 1, axis: (1, 0, 0)))",
            "a circle in the plane has the axis z",
        ),
        ("Rods(of: \"nut\")", "no body or net is called \"nut\""),
    ] {
        let error = refused(effect);
        assert!(error.contains(words), "{effect}: {error}");
    }
    let sheet = chain(1, "", "(effect: Rods(of: \"sheet\"))");
    let net = "(name: \"sheet\", mass: 1, net: Sheet(width: 1, height: 1, columns: 20, rows: 20, structural: 1, shear: 0, flexion: 0, corner: (0, 0)))";
    let nets = level(&format!("(name: \"\", nets: [{net}])")).nets;
    let large = Level { nets, ..sheet };
    let built = gingerbread::scene::Scene::build(&large, large.mode, &gingerbread::meshes::NoFiles, None);
    assert!(built.err().unwrap().to_string().contains("expected at most 500 rods, got 840"));
    let net = simulation(&chain(1, "", "(effect: Rods())"));
    assert!(net.scene().effects.iter().any(|effect| effect.constraints().is_some()));
    let _ = (Rods::default(), Wire::default());
}

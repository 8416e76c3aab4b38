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
        ("Rods(of: \"nut\")", "no body or net is called \"nut\""),
    ] {
        let error = refused(effect);
        assert!(error.contains(words), "{effect}: {error}");
    }
    let net = simulation(&chain(1, "", "(effect: Rods())"));
    assert!(net.scene().effects.iter().any(|effect| effect.constraints().is_some()));
    let _ = (Rods::default(), Wire::default());
}

//! Facts about forces typed as formulas.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{continues_bit_for_bit, integrator, level, opened, seen, simulation};
use gingerbread::{
    command::{Command, Mode},
    effects::{BodyForce, EffectKind, Motion, PointFormula},
    files,
    integrators::IntegratorKind,
    level::Level,
    simulation::Simulation,
    solvers::{BlockMatrix, Tangent, Weights},
    stability,
};

/// A particle on a spring without stiffness.
fn particle(space: &str, at: &str, force: &str) -> Level {
    level(&format!(
        "(name: \"\", substeps: 17, sleep: Off, nets: [(name: \"net\", mass: 0.1, pins: [Vertex(1)], {space}
            net: Links(points: [{at}, (0, 9)], springs: [(0, 1, 0, 1)]))], effects: [(effect: BodyForce({force}))])"
    ))
}

fn with(kind: &IntegratorKind, level: Level) -> Simulation {
    simulation(&Level { integrator: kind.clone(), ..level })
}

/// `b = -k (x - 1)` along x and `-k y - 2 c vy` along y have the known solutions, under every integrator, and the work of the force is
/// the change of the kinetic energy.
#[test]
fn a_typed_spring_swings_as_its_solution_under_every_scheme() {
    for kind in IntegratorKind::all() {
        let spring = "x: \"-9*(x - 1)\", y: \"-4*y - 0.8*vy\"";
        let mut run = with(&kind, particle("", "(2, 1)", spring));
        let start = run.energies().kinetic;
        run.advance(1020, &mut || true);
        assert!(run.fault().is_none(), "{}: {:?}", kind.name(), run.fault());
        let (state, name) = (run.state(), kind.name());
        let t = state.time;
        let (decay, rate) = (0.4, (4.0_f64 - 0.16).sqrt());
        let known =
            [1.0 + f64::cos(3.0 * t), f64::exp(-decay * t) * (f64::cos(rate * t) + decay / rate * f64::sin(rate * t))];
        let tolerance = if kind.kind().order() == 1 { 2e-2 } else { 2e-5 };
        for (axis, known) in known.into_iter().enumerate() {
            // Schemes for forces without velocities are of first order in those.
            let tolerance = if axis == 1 { f64::max(tolerance, 1e-3) } else { tolerance };
            assert!((state.x[axis] - known).abs() < tolerance, "{name} along {axis}: {} for {known}", state.x[axis]);
        }
        let (work, gained) = (run.work_of_obstacles(), run.energies().kinetic - start);
        // Along x the kinetic energy swings between 0 and 0.45 J.
        assert!((work - gained).abs() < 0.01 * 0.45, "{name}: work {work} J, kinetic energy {gained} J");
    }
}

/// A force that turns about an axis and one that depends on time alone, in space.
#[test]
fn formulas_act_in_space() {
    let force = "x: \"-4*x\", y: \"-4*y\", z: \"6*t\"";
    let kind = integrator("RungeKutta4()");
    let mut run = with(&kind, particle("space: (),", "(1, 0)", force));
    run.advance(510, &mut || true);
    let (x, t) = (&run.state().x, run.state().time);
    let known = [f64::cos(2.0 * t), 0.0, t.powi(3)];
    known.iter().zip(x).for_each(|(known, x)| assert!((known - x).abs() < 1e-8, "{x} for {known}"));
}

/// A centre of attraction that is pinned has a formula without a value there; what is pinned needs none. A drag that is not smooth at rest lets
/// go.
#[test]
fn formulas_may_be_undefined_where_nothing_moves() {
    let centre = "x: \"-x/hypot(x, y)^3\", y: \"-y/hypot(x, y)^3\"";
    let drag = "x: \"-vx*hypot(vx, vy)\", y: \"-9.8 - vy*hypot(vx, vy)\"";
    for kind in IntegratorKind::all() {
        let orbit = level(&format!(
            "(name: \"\", substeps: 17, nets: [(name: \"net\", mass: 0.1, pins: [Vertex(1)], velocity: (0, 1),
                net: Links(points: [(1, 0), (0, 0)], springs: [(0, 1, 0, 1)]))], effects: [(effect: BodyForce({centre}))])"
        ));
        let mut run = with(&kind, orbit);
        run.advance(1020, &mut || true);
        let (x, t) = (&run.state().x, run.state().time);
        let gap = f64::hypot(x[0] - f64::cos(t), x[1] - f64::sin(t));
        assert!(run.fault().is_none() && gap < 0.02, "{}: {gap} m, {:?}", kind.name(), run.fault());
        let mut run = with(&kind, particle("", "(0, 0)", drag));
        run.advance(1020, &mut || true);
        // It falls as tanh, to 0.99998 of the speed at which drag and weight are equal.
        let (v, t) = (run.state().v[1], run.state().time);
        let known = -9.8_f64.sqrt() * f64::tanh(9.8_f64.sqrt() * t);
        assert!((v - known).abs() < 1e-3, "{}: {v} for {known} m/s", kind.name());
    }
}

/// The blocks of implicit steps are the symmetric part of the derivative, and its positive part where that is asked for.
#[test]
fn stiffness_is_the_symmetric_part_of_the_derivative() {
    let force = "x: \"-3*x*y - vx\", y: \"x^2 - 2*y + 0.5*vx\", z: \"sin(x) + z^3 - 2*vz\"";
    let run = simulation(&particle("space: (),", "(1.1, 0.3)", force));
    let scene = run.scene();
    let effect = scene.effects.iter().find(|effect| effect.name() == "BodyForce").unwrap();
    let v = [0.2, -0.1, 0.4, 0.0, 0.0, 0.0];
    let mut x = run.state().x.clone();
    x[2] = -0.7;
    let motion = |x: &[f64], v: &[f64]| {
        let mut force = vec![0.0; 6];
        let motion =
            Motion { dimension: 3, x, v, mass: &scene.mass, inverse_mass: &scene.inverse_mass, ..Motion::NONE };
        effect.force(motion, &mut [], &mut force);
        force
    };
    let slope = |of: usize, by: usize, is_velocity: bool| {
        let along = |step: f64| {
            let (mut x, mut v) = (x.clone(), v);
            if is_velocity {
                v[by] += step;
            } else {
                x[by] += step;
            }
            motion(&x, &v)[of]
        };
        (along(1e-6) - along(-1e-6)) / 2e-6
    };
    let weights = |tangent| Weights { position: 0.7, velocity: 0.3, tangent };
    let block = |tangent| {
        let mut matrix = BlockMatrix::<3>::new(2, &[]);
        let motion =
            Motion { dimension: 3, x: &x, v: &v, mass: &scene.mass, inverse_mass: &scene.inverse_mass, ..Motion::NONE };
        effect.add_stiffness(motion, weights(tangent), &mut matrix);
        let mut columns = [[0.0; 3]; 3];
        for (axis, column) in columns.iter_mut().enumerate() {
            let (mut unit, mut product) = ([0.0; 6], [0.0; 6]);
            unit[axis] = 1.0;
            matrix.add_product(&unit, &mut product);
            column.copy_from_slice(&product[..3]);
        }
        nalgebra::Matrix3::from(columns)
    };
    let exact = block(Tangent::Exact);
    for (row, column) in (0..3).flat_map(|row| (0..3).map(move |column| (row, column))) {
        let entry = |a, b| -(0.7 * slope(a, b, false) + 0.3 * slope(a, b, true));
        let known = 0.5 * (entry(row, column) + entry(column, row));
        assert!((exact[(row, column)] - known).abs() < 1e-8, "({row}, {column}): {} for {known}", exact[(row, column)]);
    }
    let known = |change: fn(f64) -> f64| {
        let mut eigen = exact.symmetric_eigen();
        assert!(eigen.eigenvalues.min() < -0.01, "{}", eigen.eigenvalues);
        eigen.eigenvalues.apply(|value| *value = change(*value));
        eigen.recompose()
    };
    assert!((block(Tangent::Definite) - known(|value| value.max(0.0))).norm() < 1e-12);
    assert!((block(Tangent::Absolute) - known(f64::abs)).norm() < 1e-12);
}

#[test]
fn the_gauge_knows_the_stiffness_of_a_formula() {
    let run = simulation(&particle("", "(0.2, 0)", "x: \"-1e4*x\", y: \"-1e4*y\""));
    let square = stability::largest_eigenvalue(run.scene(), run.state(), None).unwrap();
    assert!((square / 1e4 - 1.0).abs() < 1e-6, "{square}");
}

#[test]
fn a_force_with_velocities_and_time_continues_bit_for_bit() {
    continues_bit_for_bit(&particle("", "(2, 1)", "x: \"-9*x + 3*sin(5*t)\", y: \"-vy*abs(vy) - 9.8\""));
}

#[test]
fn wrong_formulas_are_refused_with_place_and_reason() {
    let text = |force: &str| format!("(name: \"\",\n    effects: [(effect: BodyForce({force}))],\n    bodies: [])");
    for (force, words) in [
        ("x: \"2*q\"", "there is no `q`; the names are x, y, z, vx, vy, vz, t"),
        ("x: \"2*(x\"", "expected `)`, found the end"),
        ("y: \"\"", "found the end"),
    ] {
        let error = files::parse(&text(force), "mine.ron").unwrap_err().to_string();
        assert!(error.contains("mine.ron:2:") && error.contains(words), "{error}");
    }
    let mut sandbox = opened("gingerbread");
    let before = seen(&sandbox).level;
    for (axis, formula, words) in
        [("x", "z", "no `z` in the plane"), ("x", "vz*2", "no `vz`"), ("z", "1", "no z in the plane")]
    {
        let mut force = BodyForce::default();
        let typed = PointFormula::new(formula).unwrap();
        if axis == "x" {
            force.x = typed;
        } else {
            force.z = typed;
        }
        let error = sandbox.apply(Command::AddEffect(EffectKind::BodyForce(force))).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
        assert_eq!(seen(&sandbox).level, before);
    }
    sandbox.apply(Command::AddEffect(EffectKind::BodyForce(BodyForce::default()))).unwrap();
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
}

/// A force without time lets a resting net sleep; one that depends on time does not.
#[test]
fn only_a_force_without_time_lets_nets_sleep() {
    for (formula, sleeps) in [("-1", true), ("-1 + 0*t", false)] {
        let mut run = simulation(&level(&format!(
            "(name: \"\", substeps: 20, nets: [(name: \"net\", mass: 0.1, pins: [Vertex(1)],
                net: Links(points: [(0, 8), (0, 9)], springs: [(0, 1, 100, 1)]))],
            effects: [(effect: Rayleigh(mass: 20)), (effect: BodyForce(y: \"{formula}\"))])"
        )));
        run.advance(20 * 60 * 4, &mut || true);
        assert_eq!(run.counts().slept > 0, sleeps, "{formula}: {:?}", run.counts());
    }
}

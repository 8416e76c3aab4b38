//! What probes measure: closed forms of a homogeneous stretch, the balance of momentum, and the fields of the window.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{level, opened};
use gingerbread::{
    command::{Command, Mode},
    elements::Field,
    meshes::NoFiles,
    probe::Probe,
    sandbox::Sandbox,
    simulation::Simulation,
    snapshot::Snapshot,
};

/// The number in a column of a probe.
fn number(simulation: &Simulation, probe: Probe, label: &str) -> f64 {
    let columns = probe.columns(simulation.scene());
    let place = columns.iter().position(|column| column.name.ends_with(label)).unwrap();
    probe.numbers(simulation)[place]
}

/// F = diag(1.2, 0.9) everywhere.
fn stretched() -> Sandbox {
    let text = "(name: \"sheet\", bodies: [(name: \"s\", mesh: Rectangle(width: 0.4, height: 0.4, columns: 3, rows: 3), mass: Total(1),
        stretch: (1.2, 0.9), material: (model: StVenantKirchhoff, young: 130, poisson: 0.3))])";
    Sandbox::new(level(text), Box::new(NoFiles)).unwrap()
}

#[test]
fn a_homogeneous_stretch_has_the_stress_of_its_formula() {
    let sandbox = stretched();
    let simulation = sandbox.simulation();
    // Lame's parameters of plane strain; E = diag(0.22, -0.095), S = lambda tr(E) I + 2 mu E, P = F S, sigma = P Fᵀ / J.
    let (lambda, mu) = (75.0, 50.0);
    let (strain, stretch) = ([0.22, -0.095], [1.2, 0.9]);
    let trace = strain[0] + strain[1];
    let second = strain.map(|e| lambda * trace + 2.0 * mu * e);
    let j = stretch[0] * stretch[1];
    let sigma = [0, 1].map(|i| stretch[i] * stretch[i] * second[i] / j);
    // Through the thickness F33 = 1, so that P33 = S33 = lambda tr(E).
    let sigma33 = lambda * trace / j;
    let squares: f64 = [(sigma[0] - sigma[1]), (sigma[1] - sigma33), (sigma33 - sigma[0])].iter().map(|d| d * d).sum();
    let energy = 0.5 * lambda * trace * trace + mu * (strain[0] * strain[0] + strain[1] * strain[1]);
    let expected = [
        ("_f11", 1.2),
        ("_f12", 0.0),
        ("_f21", 0.0),
        ("_f22", 0.9),
        ("_j", j),
        ("_stretch1", 1.2),
        ("_stretch2", 0.9),
        ("_e11", strain[0]),
        ("_e12", 0.0),
        ("_e22", strain[1]),
        ("_p11", stretch[0] * second[0]),
        ("_p12", 0.0),
        ("_p21", 0.0),
        ("_p22", stretch[1] * second[1]),
        ("_s11", sigma[0]),
        ("_s12", 0.0),
        ("_s22", sigma[1]),
        ("_s33", sigma33),
        ("_pressure", -(sigma[0] + sigma[1] + sigma33) / 3.0),
        ("_von_mises", (0.5 * squares).sqrt()),
        ("_psi", energy),
    ];
    assert_eq!(expected.len(), Probe::Triangle(0).columns(simulation.scene()).len());
    for triangle in 0..simulation.scene().triangles.len() {
        for (label, value) in expected {
            let found = number(simulation, Probe::Triangle(triangle), label);
            assert!((found - value).abs() < 1e-11, "{label} of triangle {triangle} is {found} and not {value}");
        }
    }
}

#[test]
fn a_triangle_that_was_turned_and_mirrored_has_a_negative_stretch() {
    let mut sandbox = stretched();
    let mut state = sandbox.simulation().state().clone();
    // A turn by 0.7 after a reflection: F = R diag(-1.2, 0.9).
    let (sin, cos) = 0.7_f64.sin_cos();
    for point in state.x.as_chunks_mut::<2>().0 {
        *point = [-cos * point[0] - sin * point[1], -sin * point[0] + cos * point[1]];
    }
    let mut simulation = Simulation::new(
        gingerbread::scene::Scene::build(
            &sandbox.document().level,
            gingerbread::level::RunMode::Simulate,
            &NoFiles,
            None,
        )
        .unwrap(),
        state,
    );
    simulation.count_anew();
    sandbox.apply(Command::Reset).unwrap();
    for (label, value) in [("_j", -1.08), ("_stretch1", 1.2), ("_stretch2", -0.9), ("_e11", 0.22), ("_e22", -0.095)] {
        let found = number(&simulation, Probe::Triangle(4), label);
        assert!((found - value).abs() < 1e-12, "{label} is {found} and not {value}");
    }
}

#[test]
fn triangles_have_the_numbers_that_colour_them() {
    for name in ["gingerbread", "gingerbread_house", "stretch_test", "toronto_cloth", "cloth_man"] {
        let mut sandbox = opened(name);
        sandbox.apply(Command::SetMode(Mode::Collide)).unwrap();
        sandbox.advance(20, &mut || true);
        for field in Field::ALL {
            let mut snapshot = Snapshot::default();
            sandbox.snapshot(field, &mut snapshot);
            let scene = sandbox.simulation().scene();
            let count = scene.triangle_parts().map(|(.., mesh)| mesh.triangles().len()).sum::<usize>();
            assert_eq!(snapshot.values.len(), if field == Field::None { 0 } else { count }, "{name} {field:?}");
            for (triangle, value) in snapshot.values.iter().enumerate().step_by(17) {
                let place = scene.listed_triangle(triangle).unwrap();
                assert_eq!(scene.unlisted_triangle(place), Some(triangle));
                let of = |label: &str| number(sandbox.simulation(), Probe::Triangle(place), label);
                let found = match field {
                    Field::Volume => of("_j"),
                    Field::EnergyDensity => of("_psi"),
                    Field::VonMises => of("_von_mises"),
                    Field::Stretch => of("_stretch1"),
                    Field::Pressure => of("_pressure"),
                    Field::PrincipalStress => {
                        let [x, y, xy] = ["_s11", "_s22", "_s12"].map(of);
                        nalgebra::Matrix2::new(x, xy, xy, y).symmetric_eigenvalues().max()
                    }
                    Field::None | Field::Speed | Field::Displacement | Field::StressError => continue,
                };
                let scale = snapshot.values.iter().fold(1e-6, |most: f64, value| most.max(value.abs()));
                assert!((found - value).abs() <= 1e-9 * scale, "{name}: {field:?} {found} {value}");
            }
        }
    }
}

#[test]
fn speed_and_displacement_are_means_of_corners() {
    let mut sandbox = opened("gingerbread_house");
    sandbox.apply(Command::SetMode(Mode::Collide)).unwrap();
    sandbox.advance(200, &mut || true);
    let mut snapshot = Snapshot::default();
    for (field, symbol) in [(Field::Speed, "v"), (Field::Displacement, "u")] {
        sandbox.snapshot(field, &mut snapshot);
        let scene = sandbox.simulation().scene();
        for (corners, value) in snapshot.triangles.iter().zip(&snapshot.values).step_by(31) {
            let of_corner = |corner: &u32| {
                let probe = Probe::Vertex(scene.listed_vertex(*corner as usize).unwrap());
                let [x, y] = ["x", "y"].map(|axis| number(sandbox.simulation(), probe, &format!("_{symbol}{axis}")));
                x.hypot(y)
            };
            let mean = corners.iter().map(of_corner).sum::<f64>() / 3.0;
            assert!(mean > 0.0 && (mean - value).abs() < 1e-12 * mean, "{field:?}: {value} and not {mean}");
        }
    }
}

#[test]
fn forces_on_a_vertex_give_its_acceleration() {
    for name in ["gingerbread", "cantilever", "hanging_net", "cornell_cloth"] {
        let mut sandbox = opened(name);
        let level = sandbox.document().level.clone();
        assert_eq!(level.integrator.name(), "SymplecticEuler", "{name}: another scheme has another first step");
        sandbox.apply(Command::SetMode(Mode::Collide)).unwrap();
        // Long enough for elastic forces to take part.
        sandbox.advance(300, &mut || true);
        let simulation = sandbox.simulation();
        let (scene, before) = (simulation.scene(), simulation.state().clone());
        let (dimension, step) = (scene.dimension, sandbox.step_length());
        let free =
            (0..scene.vertices()).find(|vertex| scene.inverse_mass[dimension * vertex] != 0.0 && vertex % 5 == 4);
        let vertex = free.unwrap();
        let place = scene.listed_vertex(vertex).unwrap();
        let mass = scene.mass[dimension * vertex];
        let forces = ["x", "y", "z"][..dimension].iter().map(|axis| format!("sum_{axis}"));
        let forces: Vec<_> = forces.map(|label| number(simulation, Probe::Forces(place), &label)).collect();
        sandbox.advance(1, &mut || true);
        let after = sandbox.simulation().state();
        for (axis, force) in forces.iter().enumerate() {
            let at = dimension * vertex + axis;
            let found = mass * (after.v[at] - before.v[at]) / step;
            assert!((found - force).abs() < 1e-8 * (1.0 + force.abs()), "{name}: {found} N and not {force} N");
        }
    }
}

/// The rate of all momentum is the weight and what the pins add: p' = R - M g.
#[test]
fn pins_carry_the_weight_and_the_rate_of_momentum() {
    let text = "(name: \"bar\", bodies: [(name: \"b\", mesh: Rectangle(width: 0.4, height: 0.1, columns: 6, rows: 3), mass: Total(2),
        place: (offset: (0.3, 0.5)), pins: [Vertex(0), Vertex(7), Vertex(14)], material: (model: NeoHookean, young: 1e4, poisson: 0.3))],
        effects: [(effect: Gravity(down: 9.81))])";
    let mut sandbox = Sandbox::new(level(text), Box::new(NoFiles)).unwrap();
    assert_eq!(sandbox.simulation().scene().pins.len(), 3);
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    for _ in 0..5 {
        sandbox.advance(40, &mut || true);
        let momentum = |sandbox: &Sandbox| {
            ["x", "y"].map(|axis| number(sandbox.simulation(), Probe::Momentum, &format!("momentum_{axis}")))
        };
        let before = momentum(&sandbox);
        let held = ["reaction_x", "reaction_y"].map(|label| number(sandbox.simulation(), Probe::Reaction, label));
        sandbox.advance(1, &mut || true);
        let after = momentum(&sandbox);
        for (axis, weight) in [0.0, 2.0 * 9.81].into_iter().enumerate() {
            let rate = (after[axis] - before[axis]) / sandbox.step_length();
            assert!((held[axis] - rate - weight).abs() < 1e-8 * 100.0, "{axis}: {} N", held[axis] - rate);
        }
    }
}

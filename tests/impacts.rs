//! Facts about what is fast, thin, rough or springy: nothing gets through anything, at any speed, under any scheme.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

mod common;

use common::{Random, level, simulation};
use gingerbread::{
    integrators::{Class, IntegratorKind},
    level::Level,
    simulation::Simulation,
};

/// A block of jelly, 0.2 m wide, of so many cells a side, among obstacles.
fn block(integrator: &str, substeps: u32, cells: u32, [x, y]: [f64; 2], [vx, vy]: [f64; 2], effects: &str) -> Level {
    level(&format!(
        "(name: \"block\", substeps: {substeps}, integrator: {integrator}(), bodies: [(name: \"block\",
            mesh: Rectangle(width: 0.2, height: 0.2, columns: {cells}, rows: {cells}, diagonals: Alternating, corner: ({x}, {y})),
            material: (model: Corotated, young: 100000, poisson: 0.3, plane: Strain), mass: Density(100),
            velocity: ({vx}, {vy}))], effects: [{effects}])"
    ))
}

/// Whether two segments cross.
fn cross([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> bool {
    let side = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

/// No edge of a boundary crosses a side of an outline.
fn assert_apart(simulation: &Simulation, outline: &[[f64; 2]], what: &str) {
    let x = &simulation.state().x;
    for &edge in simulation.scene().boundary.iter() {
        let ends = edge.map(|vertex| [x[2 * vertex as usize], x[2 * vertex as usize + 1]]);
        for (i, &corner) in outline.iter().enumerate() {
            let next = outline[(i + 1) % outline.len()];
            assert!(!cross(ends, [corner, next]), "{what}: edge {edge:?} at {ends:?} crosses {corner:?} to {next:?}");
        }
    }
}

fn kinetic_and_stored(simulation: &Simulation) -> f64 {
    simulation.energies().total()
}

/// What a block falls on from above, and the outline of it.
fn targets() -> Vec<(&'static str, Vec<[f64; 2]>)> {
    let round = |r: f64| {
        (0..48).map(|i| f64::from(i) * std::f64::consts::TAU / 48.0).map(|t| [r * t.cos(), r * t.sin()]).collect()
    };
    vec![
        ("Plane(point: (0, 0), normal: (0, 1), eps: 0.002)", vec![[-9.0, -1e-9], [9.0, -1e-9], [0.0, -9.0]]),
        (
            "Cuboid(centre: (0, -0.0005), width: 4, height: 0.001, eps: 0.002)",
            vec![[-2.0, -0.001], [2.0, -0.001], [2.0, 0.0], [-2.0, 0.0]],
        ),
        ("Ball(centre: (0, 0), radius: 0.01, eps: 0.002)", round(0.009_99)),
        (
            "Polygon(points: [(-0.004, -1), (0.004, -1), (0.001, 0)], eps: 0.002)",
            vec![[-0.004, -1.0], [0.004, -1.0], [0.001, 0.0]],
        ),
    ]
}

/// The tests of one scheme: with the step of a film for implicit ones, and both such a step and a fine one for the others.
fn substeps(kind: &IntegratorKind) -> &'static [u32] {
    if kind.kind().class() == Class::Implicit { &[1] } else { &[1, 200] }
}

#[test]
fn nothing_gets_through_anything_at_any_speed_under_any_scheme() {
    let mut random = Random(5);
    for kind in IntegratorKind::all() {
        for (target, outline) in targets() {
            for cells in [1, 5] {
                for speed in [1.0, 10.0, 100.0, 1000.0] {
                    for &substeps in substeps(&kind) {
                        let walls = format!("(effect: Gravity(down: 9.8)), (effect: Walls(obstacles: [{target}]))");
                        let at = [random.between(-0.19, -0.01), random.between(0.03, 0.4)];
                        let level = block(kind.name(), substeps, cells, at, [0.1 * speed, -speed], &walls);
                        let mut simulation = simulation(&level);
                        let what = format!("{} {target} {cells} cells {speed} m/s {substeps} substeps", kind.name());
                        for _ in 0..24.min(6 * substeps) {
                            simulation.advance(u64::from(substeps).div_ceil(40), &mut || true);
                            // A scheme may blow up by itself; how near things are is then no more than round-off.
                            let exploded = simulation.state().x.iter().any(|x| x.abs() > 1e5);
                            if exploded || simulation.fault().is_some() {
                                break;
                            }
                            assert_apart(&simulation, &outline, &what);
                        }
                    }
                }
            }
        }
    }
}

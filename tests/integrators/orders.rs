//! The declared order of every scheme is the measured one: on an oscillator, a sheet, the exact pendulum, the chain and the man.
#![allow(clippy::unwrap_used, reason = "a failing test should panic")]

use crate::common::{
    named,
    systems::{Oscillator, Rate, advance, assert_order, built, particle, run, swinging, without_control},
};
use gingerbread::{
    files,
    integrators::{Dynamics, IntegratorKind, Scheme, Workspace},
    level::Level,
    solvers::{SparseMatrix, Weights},
    state::State,
};
use nalgebra::Matrix2;

/// It is tested with and without damping.
#[test]
fn measured_order_matches_on_a_nonlinear_oscillator() {
    for damping in [0.0, 0.7] {
        let system = || Oscillator { square: 4.0, cubic: 0.8, damping, evaluations: 0 };
        let mut exact = particle();
        run(&without_control(named("DormandPrince")), &mut system(), &mut exact, 1e-3, 3000);
        for kind in IntegratorKind::all().into_iter().map(without_control) {
            // Low orders need short steps to be in their asymptotic range, high ones long steps to stay above round-off.
            let first = [0, 600, 150, 150, 40, 45][kind.kind().order() as usize];
            assert_order(&kind, &format!("oscillator, damping {damping},"), |refine| {
                let mut state = particle();
                run(&kind, &mut system(), &mut state, 3.0 / (first * refine) as f64, first * refine);
                (state.x[0] - exact.x[0]).hypot(state.x[1] - exact.x[1])
            });
        }
    }
}

#[test]
fn measured_order_matches_on_a_free_sheet() {
    let time = 0.1;
    let end = |kind: &IntegratorKind, steps: u64| {
        let mut simulation = swinging(kind, time / steps as f64);
        advance(&mut simulation, steps);
        simulation.state().x.clone()
    };
    let exact = end(&without_control(named("DormandPrince")), 3000);
    for kind in IntegratorKind::all().into_iter().map(without_control) {
        let first = [0, 400, 100, 100, 50, 50][kind.kind().order() as usize];
        assert_order(&kind, "sheet,", |refine| {
            let difference = end(&kind, first * refine).into_iter().zip(&exact).map(|(a, b)| (a - b) * (a - b));
            difference.sum::<f64>().sqrt()
        });
    }
}

/// `theta'' = -(g/L) sin theta` with g = L, as a point whose x is the angle.
struct Pendulum;

impl Dynamics for Pendulum {
    fn force(&mut self, _: f64, x: &[f64], _: &[f64], force: &mut [f64]) {
        force.copy_from_slice(&[-libm::sin(x[0]), 0.0]);
    }

    fn mass(&self) -> &[f64] {
        &[1.0; 2]
    }

    fn inverse_mass(&self) -> &[f64] {
        &[1.0; 2]
    }

    fn stiffness_times(&mut self, _: f64, x: &[f64], _: &[f64], d: &[f64], product: &mut [f64]) {
        product[0] += libm::cos(x[0]) * d[0];
    }

    fn block_size(&self) -> usize {
        2
    }

    fn sparsity_pattern(&self, _: &mut dyn FnMut(u32, u32)) {}

    fn add_stiffness(&mut self, _: f64, x: &[f64], _: &[f64], weights: Weights, matrix: &mut dyn SparseMatrix) {
        if let Some(matrix) = matrix.blocks::<2>() {
            matrix.diagonal(0, &(Matrix2::new(libm::cos(x[0]), 0.0, 0.0, 0.0) * weights.position));
        }
    }
}

/// Against the exact angle in Jacobi's elliptic functions, as the toy knows it.
#[test]
fn measured_order_matches_on_the_exact_pendulum() {
    let text = "(name: \"p\", integrator: Heun(), toy: Pendulum(length: 1, gravity: 1, start: 90))";
    let toy = files::parse(text, "pendulum").unwrap().toy.unwrap();
    let time = 3.0;
    let start = toy.kind().exact(0.0);
    let exact = toy.kind().exact(time)[0];
    for kind in IntegratorKind::all().into_iter().map(without_control) {
        let first = [0, 800, 150, 150, 40, 14][kind.kind().order() as usize];
        assert_order(&kind, "pendulum,", |refine| {
            let mut state = State { x: vec![start[0], 0.0], v: vec![start[1], 0.0], ..State::default() };
            let mut work = Workspace::default();
            let steps = first * refine;
            for _ in 0..steps {
                kind.kind().step(&mut Pendulum, &mut state, &mut work, time / steps as f64);
            }
            (state.x[0] - exact).abs()
        });
        let Scheme::First(scheme) = kind.kind().scheme() else { continue };
        assert_order(&kind, "pendulum as a toy,", |refine| {
            let mut state = State { x: start.to_vec(), ..State::default() };
            let mut work = Workspace::default();
            let steps = first * refine;
            for _ in 0..steps {
                scheme.step(&mut Rate(&toy), &mut state, &mut work, time / steps as f64);
            }
            (state.x[0] - exact).abs()
        });
    }
}

/// Where a level ends after a time, with steps of one length.
fn end(level: &Level, kind: &IntegratorKind, time: f64, steps: u64) -> Vec<f64> {
    let level = Level { integrator: kind.clone(), ..level.clone() };
    let mut simulation = built(&level, time / steps as f64);
    advance(&mut simulation, steps);
    simulation.state().x.clone()
}

/// The order of every scheme at the end of a time, against a far finer run.
fn assert_orders(what: &str, level: &Level, time: f64, first: [u64; 6], finest: u64) {
    let exact = end(level, &without_control(named("DormandPrince")), time, finest);
    for kind in IntegratorKind::all().into_iter().map(without_control) {
        assert_order(&kind, what, |refine| {
            let steps = first[kind.kind().order() as usize] * refine;
            let difference = end(level, &kind, time, steps).into_iter().zip(&exact).map(|(a, b)| (a - b) * (a - b));
            difference.sum::<f64>().sqrt()
        });
    }
}

#[test]
fn measured_order_matches_on_the_chain() {
    let text = gingerbread::levels::built_in("chain").unwrap();
    assert_orders("chain,", &files::parse(text, "chain").unwrap(), 1.0, [0, 3000, 600, 600, 150, 80], 6000);
}

#[test]
fn measured_order_matches_on_a_free_gingerbread_man() {
    let text =
        gingerbread::levels::built_in("gingerbread_pulled").unwrap().replace("resolution: 2000", "resolution: 100");
    assert_orders("gingerbread,", &files::parse(&text, "man").unwrap(), 0.1, [0, 400, 100, 100, 60, 20], 1000);
}

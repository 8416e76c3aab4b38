//! An integrator of one's own, Kutta's third-order scheme, and what it costs beside listed ones:
//! `cargo run --example own_integrator`.

use gingerbread::{
    files,
    integrators::{
        Class, FirstOrder, Heun, Integrator, IntegratorKind, Ode, RungeKutta4, Scheme, StepCounts, Workspace,
    },
    level::{Level, Substeps},
    levels,
    meshes::NoFiles,
    scene::Scene,
    simulation::Simulation,
    state::State,
};

/// Kutta's scheme of third order (Kutta, *Zeitschrift für Mathematik und Physik* 46, 1901).
#[derive(Clone, Debug, PartialEq)]
pub struct RungeKutta3;

impl Integrator for RungeKutta3 {
    fn title(&self) -> &'static str {
        "Runge-Kutta 3"
    }

    fn about(&self) -> &'static str {
        "Three forces a step, order 3."
    }

    fn order(&self) -> u32 {
        3
    }

    fn class(&self) -> Class {
        Class::Explicit
    }

    fn stability_limit(&self) -> Option<f64> {
        Some(3_f64.sqrt())
    }

    fn scheme(&self) -> Scheme<'_> {
        Scheme::First(self)
    }
}

impl FirstOrder for RungeKutta3 {
    fn step(&self, system: &mut dyn Ode, state: &mut State, workspace: &mut Workspace, h: f64) -> StepCounts {
        let [start, at, k1, k2, k3] = workspace.vectors(state.x.len() + state.v.len());
        state.copy_to(start);
        system.rate(0.0, start, k1);
        for ((at, start), k1) in at.iter_mut().zip(&*start).zip(&*k1) {
            *at = start + 0.5 * h * k1;
        }
        system.rate(0.5 * h, at, k2);
        for (((at, start), k1), k2) in at.iter_mut().zip(&*start).zip(&*k1).zip(&*k2) {
            *at = start + h * (2.0 * k2 - k1);
        }
        system.rate(h, at, k3);
        for ((((at, start), k1), k2), k3) in at.iter_mut().zip(&*start).zip(&*k1).zip(&*k2).zip(&*k3) {
            *at = start + h / 6.0 * (k1 + 4.0 * k2 + k3);
        }
        system.constrain(start, at);
        state.copy_from(at);
        StepCounts::ONE
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("{:>16} {:>12} {:>18}", "scheme", "forces", "energy gained [J]");
    let chain = files::parse(levels::built_in("chain").ok_or("there is no such level")?, "chain.ron")?;
    let own = IntegratorKind::own("RungeKutta3", RungeKutta3);
    for integrator in [Heun::default().into(), own, RungeKutta4::default().into()] {
        let level = Level { integrator, substeps: Substeps::new(50)?, ..chain.clone() };
        let scene = Scene::build(&level, level.mode, &NoFiles, None)?;
        let mut simulation = Simulation::open(scene, &level, level.mode)?;
        let before = simulation.energies().total();
        simulation.advance(60 * u64::from(level.substeps.get()), &mut || true);
        let (title, forces) = (level.integrator.kind().title(), simulation.counts().force_evaluations);
        println!("{title:>16.16} {forces:>12} {:>18.3e}", simulation.energies().total() - before);
    }
    Ok(())
}

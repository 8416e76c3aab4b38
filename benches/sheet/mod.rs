//! The sheet that steps are measured with: a unit square of n x n quads, density 1, E = 1e3, nu = 0.3 in plane strain, stretched 1.2
//! in x; or its lowest rows.

use gingerbread::{files, materials::Model, meshes::NoFiles, scene::Scene, simulation::Simulation};
use std::{
    thread,
    time::{Duration, Instant},
};

pub fn sheet(n: u32, model: Model) -> Simulation {
    simulation(strip([n, n], model))
}

pub fn simulation(scene: Scene) -> Simulation {
    let state = scene.start.clone();
    Simulation::new(scene, state)
}

/// The lowest rows of the square of as many rows as columns.
pub fn strip([columns, rows]: [u32; 2], model: Model) -> Scene {
    // The step follows the size of the triangles, so that every mesh is stable.
    let text = format!(
        "(name: \"sheet\", substeps: {}, bodies: [(name: \"sheet\", mass: Density(1), stretch: (1.2, 1),
          mesh: Rectangle(width: 1, height: {}, columns: {columns}, rows: {rows}, diagonals: Grid),
          material: (model: {}, young: 1000, poisson: 0.3, plane: Strain))])",
        10 * columns,
        f64::from(rows) / f64::from(columns),
        model.name()
    );
    let level = files::parse(&text, "sheet.ron").unwrap();
    Scene::build(&level, level.mode, &NoFiles, None).unwrap()
}

/// The steps of a motion that are timed.
#[derive(Clone, Copy)]
pub struct Lap {
    /// How many come before them: at the start the guard looks at every one.
    pub lead: u64,
    /// After how many the motion starts over, so that what is measured is always the same.
    pub end: u64,
}

impl Lap {
    /// Time of `steps` steps, which go on where the last ones ended.
    pub fn time(self, simulation: &mut Simulation, steps: u64) -> Duration {
        let mut time = Duration::ZERO;
        let mut left = steps;
        while left > 0 {
            let now = simulation.state().steps;
            if now < self.lead || now >= self.end {
                let start = simulation.scene().start.clone();
                simulation.set_state(start);
                assert_eq!(simulation.advance(self.lead, &mut || true), self.lead);
            }
            let count = left.min(self.end - simulation.state().steps);
            let begin = Instant::now();
            assert_eq!(simulation.advance(count, &mut || true), count);
            time += begin.elapsed();
            left -= count;
        }
        time
    }

    /// Time of `steps` steps of two at once.
    pub fn time_apart(self, simulations: &mut [Simulation; 2], steps: u64) -> Duration {
        let [one, other] = simulations;
        thread::scope(|scope| {
            let other = scope.spawn(|| self.time(other, steps));
            self.time(one, steps).max(other.join().unwrap())
        })
    }
}

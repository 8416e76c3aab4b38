//! Cost against size, as a table and as a picture: `cargo bench --bench sizes -- --csv sizes.csv --svg assets/sizes.svg`, half a minute
//! or a whole. Each number is the least of several, taken in turn.
//!
//! A unit sheet of n x n quads, density 1, E = 1e3, nu = 0.3, stretched 1.2 in x: steps of symplectic Euler at 0.4 of the stable step,
//! and the first step of 1/60 s of implicit Euler, whose equations are solved to tolerance.
#![allow(missing_docs, clippy::unwrap_used, reason = "a benchmark is not a library")]

use gingerbread::{
    files, materials::Model, meshes::NoFiles, scene::Scene, simulation::Simulation, stability::critical_step,
    state::State,
};
use plotters::prelude::*;
use rayon::ThreadPoolBuilder;
use std::{fmt::Write as _, fs, time::Instant};

const MODELS: [Model; 3] = [Model::Corotated, Model::NeoHookean, Model::StVenantKirchhoff];

/// Quads along a side: 512 to 999,698 triangles explicitly, to 200,978 implicitly.
const EXPLICIT: [u32; 11] = [16, 22, 32, 50, 71, 112, 158, 224, 354, 500, 707];
const IMPLICIT: [u32; 8] = [16, 22, 32, 50, 71, 112, 224, 317];

/// Time for one of several measurements of an explicit step [s].
const SLICE: f64 = 0.03;
const SLICES: usize = 6;

/// The step as a share of the longest stable one at rest: stretched sheets are stiffer, and the guard must not have to help.
const SHARE: f64 = 0.4;

/// Steps that are not timed: at the start the guard looks at every one.
const LEAD: u64 = 200;

fn sheet(n: u32, model: Model, integrator: &str) -> Scene {
    let text = format!(
        "(name: \"sheet\", substeps: 1, integrator: {integrator}(), bodies: [(name: \"sheet\", mass: Density(1), stretch: (1.2, 1),
          mesh: Rectangle(width: 1, height: 1, columns: {n}, rows: {n}, diagonals: Grid),
          material: (model: {}, young: 1000, poisson: 0.3, plane: Strain))])",
        model.name()
    );
    let level = files::parse(&text, "sheet.ron").unwrap();
    Scene::build(&level, level.mode, &NoFiles, None).unwrap()
}

/// Seconds of one run of this.
fn seconds(run: impl FnOnce()) -> f64 {
    let begin = Instant::now();
    run();
    begin.elapsed().as_secs_f64()
}

/// Times of a step [s], at triangles; of one kind, with one number of threads.
struct Curve {
    name: String,
    model: usize,
    threads: usize,
    points: Vec<(f64, f64)>,
}

impl Curve {
    fn new(name: &str, model: usize, threads: usize) -> Self {
        Self { name: name.to_owned(), model, threads, points: Vec::new() }
    }

    /// The power of the number of triangles that the time of a step grows with: the slope of a straight line through the logarithms.
    fn exponent(&self) -> f64 {
        let logs: Vec<_> = self.points.iter().map(|(n, t)| [n.ln(), t.ln()]).collect();
        let mean = |axis: usize| logs.iter().map(|point| point[axis]).sum::<f64>() / logs.len() as f64;
        let [x, y] = [mean(0), mean(1)];
        let along: f64 = logs.iter().map(|point| (point[0] - x) * (point[1] - y)).sum();
        along / logs.iter().map(|point| (point[0] - x) * (point[0] - x)).sum::<f64>()
    }
}

/// With one thread and, where the simulation lets two share the work, with two.
fn explicit(number: usize) -> [Curve; 2] {
    let mut curves = [1, 2].map(|threads| Curve::new("explicit", number, threads));
    // The longest stable step at rest is as long as a quad is wide, but for a factor.
    let small = sheet(EXPLICIT[2], MODELS[number], "SymplecticEuler");
    let rest = State { x: small.rest.clone(), ..small.start.clone() };
    let stable = critical_step(&small, &rest, None).unwrap() * f64::from(EXPLICIT[2]);
    for n in EXPLICIT {
        let mut scene = sheet(n, MODELS[number], "SymplecticEuler");
        scene.step = SHARE * stable / f64::from(n);
        let start = scene.start.clone();
        let mut simulations = [1, 2].map(|threads| {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut simulation = Simulation::new(scene.clone(), start.clone());
            assert_eq!(simulation.advance(LEAD, &mut || true), LEAD);
            (simulation, pool)
        });
        let triangles = f64::from(2 * n * n);
        let steps = ((SLICE / (5e-9 * triangles)) as u64).clamp(20, 2000);
        let mut least = [f64::INFINITY; 2];
        for _ in 0..SLICES {
            for ((simulation, pool), least) in simulations.iter_mut().zip(&mut least) {
                let time = pool.install(|| seconds(|| assert_eq!(simulation.advance(steps, &mut || true), steps)));
                *least = least.min(time / steps as f64);
            }
        }
        let shared = simulations[1].0.scene().bodies[0].elements.partitions() > 1;
        let guarded: u64 = simulations.iter().map(|(simulation, _)| simulation.counts().guarded).sum();
        if guarded > 0 {
            eprintln!("the guard took {guarded} steps in shorter ones: this costs more than a step");
        }
        for (curve, least) in curves.iter_mut().zip(least).filter(|(curve, _)| curve.threads == 1 || shared) {
            curve.points.push((triangles, least));
        }
        eprintln!("{} {triangles}: {:.2} ns per triangle", MODELS[number].name(), 1e9 * least[0] / triangles);
    }
    curves
}

fn implicit(number: usize) -> Curve {
    let mut curve = Curve::new("implicit", number, 1);
    for n in IMPLICIT {
        let scene = sheet(n, MODELS[number], "ImplicitEuler");
        let start = scene.start.clone();
        let mut simulation = Simulation::new(scene, start.clone());
        let mut least = f64::INFINITY;
        // The very first also settles where the entries of the factor are.
        for _ in 0..if n < 200 { 6 } else { 3 } {
            simulation.set_state(start.clone());
            least = least.min(seconds(|| assert_eq!(simulation.advance(1, &mut || true), 1)));
        }
        assert_eq!(simulation.counts().unconverged, 0);
        let triangles = f64::from(2 * n * n);
        curve.points.push((triangles, least));
        eprintln!("{} {triangles}: {:.2} ms per implicit step", MODELS[number].name(), 1e3 * least);
    }
    curve
}

fn csv(curves: &[Curve]) -> String {
    let mut text = String::from("scheme,model,threads,triangles,seconds_per_step,ns_per_triangle_step,exponent\n");
    for curve in curves {
        let (model, exponent) = (MODELS[curve.model].name(), curve.exponent());
        for (triangles, time) in &curve.points {
            let each = 1e9 * time / triangles;
            let _ =
                writeln!(text, "{},{model},{},{triangles},{time:e},{each:.3},{exponent:.3}", curve.name, curve.threads);
        }
    }
    text
}

const PAPER: RGBColor = RGBColor(0xFF, 0xFB, 0xF4);
const INK: RGBColor = RGBColor(0x4A, 0x2E, 0x1E);
const FAINT: RGBColor = RGBColor(0xE6, 0xDA, 0xCB);
const COLOURS: [RGBColor; 3] = [RGBColor(0xC0, 0x39, 0x2B), RGBColor(0x1F, 0x7A, 0x5A), RGBColor(0x2C, 0x5A, 0xA8)];

/// Two panels side by side, each with the exponents fitted over all its sizes, on paper of their own, so that they can be read on dark pages too.
fn draw(path: &str, curves: &[Curve]) {
    let area = SVGBackend::new(path, (1200, 520)).into_drawing_area();
    area.fill(&PAPER).unwrap();
    let (left, right) = area.split_horizontally(600);
    let (explicit, implicit): (Vec<_>, Vec<_>) = curves.iter().partition(|curve| curve.name == "explicit");
    let each = |(triangles, time): (f64, f64)| (triangles, 1e9 * time / triangles);
    let (above, below) = (SeriesLabelPosition::UpperLeft, SeriesLabelPosition::LowerRight);
    // The list of names has its place above what is nearly level, and below what rises.
    panel(&left, ["Explicit step, per triangle", "ns per triangle and step"], (above, [2.0, 5.0]), &explicit, each);
    panel(&right, ["Implicit step of 1/60 s", "seconds per step"], (below, [3.0, 2.0]), &implicit, |point| point);
    area.present().unwrap();
}

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

/// One of them, with so many times the room below and above its values.
fn panel(
    area: &Area<'_>,
    [title, unit]: [&str; 2],
    (names, [below, above]): (SeriesLabelPosition, [f64; 2]),
    curves: &[&Curve],
    value: impl Fn((f64, f64)) -> (f64, f64),
) {
    let values = || curves.iter().flat_map(|curve| &curve.points).map(|point| value(*point).1);
    let least = values().fold(f64::INFINITY, f64::min) / below;
    let greatest = values().fold(0.0, f64::max) * above;
    let text = |size: i32| ("sans-serif", size).into_font().color(&INK);
    let mut chart = ChartBuilder::on(area)
        .caption(title, text(20))
        .margin(16)
        .x_label_area_size(48)
        .y_label_area_size(64)
        .build_cartesian_2d((2e2..2e6).log_scale(), (least..greatest).log_scale())
        .unwrap();
    chart
        .configure_mesh()
        .x_desc("triangles N")
        .y_desc(unit)
        .axis_desc_style(text(16))
        .label_style(text(14))
        .axis_style(INK)
        .bold_line_style(FAINT)
        .light_line_style(PAPER)
        .x_label_formatter(&|number| thousands(*number))
        .y_label_formatter(&|number| format!("{number}"))
        .draw()
        .unwrap();
    for curve in curves {
        let colour = COLOURS[curve.model];
        let points: Vec<_> = curve.points.iter().copied().map(&value).collect();
        let dash = if curve.threads == 1 { (1, 0) } else { (6, 5) };
        let threads = ["one thread", "two threads"][curve.threads - 1];
        let label = format!("{}, {threads}: step ~ N^{:.2}", MODELS[curve.model].title(), curve.exponent());
        let style = colour.stroke_width(2);
        if dash.1 == 0 {
            chart.draw_series(LineSeries::new(points.clone(), style)).unwrap()
        } else {
            chart.draw_series(DashedLineSeries::new(points.clone(), dash.0, dash.1, style)).unwrap()
        }
        .label(label)
        .legend(move |(x, y)| {
            let ends = if dash.1 == 0 { vec![(x, y), (x + 24, y)] } else { vec![(x, y), (x + 9, y)] };
            PathElement::new(ends, style)
        });
        let fill = if curve.threads == 1 { colour.filled() } else { PAPER.filled() };
        chart.draw_series(points.iter().map(|point| Circle::new(*point, 4, fill))).unwrap();
        chart.draw_series(points.iter().map(|point| Circle::new(*point, 4, colour.stroke_width(2)))).unwrap();
    }
    chart
        .configure_series_labels()
        .position(names)
        .background_style(PAPER)
        .border_style(FAINT)
        .label_font(text(14))
        .draw()
        .unwrap();
}

/// 1,000,000 for a million.
fn thousands(number: f64) -> String {
    let digits = format!("{number:.0}");
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

fn main() {
    let arguments: Vec<_> = std::env::args().collect();
    let path = |name: &str| {
        let at = arguments.iter().position(|argument| argument == name)?;
        arguments.get(at + 1).cloned()
    };
    let (table, picture) = (path("--csv"), path("--svg"));
    if table.is_none() && picture.is_none() {
        println!("cost against size: cargo bench --bench sizes -- --csv OUT.csv --svg OUT.svg");
        return;
    }
    let mut curves: Vec<_> = (0..MODELS.len()).flat_map(explicit).collect();
    curves.extend((0..MODELS.len()).map(implicit));
    if let Some(path) = table {
        fs::write(path, csv(&curves)).unwrap();
    }
    if let Some(path) = picture {
        draw(&path, &curves);
    }
}

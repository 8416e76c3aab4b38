//! What a frame of the window takes beside stepping, without a display: the snapshot, and a whole frame from the input to the
//! triangles that the graphics card would get. `cargo bench --bench frame`.
//!
//! The level takes one step in a frame, so that nothing in it can be kept from the frame before. The window is 1280 x 800 points,
//! its plot holds the full ten seconds, and nothing is dragged.
#![allow(missing_docs, clippy::unwrap_used, reason = "a benchmark is not a library")]

use criterion::{BenchmarkGroup, Criterion, criterion_group, criterion_main, measurement::WallTime};
use eframe::{App as _, egui};
use egui::{Event, Key, Modifiers, Pos2, RawInput, Rect, vec2};
use egui_kittest::{Harness, kittest::Queryable as _};
use gingerbread::{
    app::App,
    command::{Command, Mode},
    files::{self, Disk},
    level::Level,
    meshes::NoFiles,
    sandbox::Sandbox,
    snapshot::{Field, Snapshot},
};
use std::time::{Duration, Instant};

/// Seconds from frame to frame.
const FRAME: f64 = 1.0 / 60.0;
/// Frames before anything is measured: the plot of the last ten seconds is full then.
const BEFORE: usize = 620;

/// A level of one body, about 10,000 triangles, which swings slowly and never rests.
fn level(mesh: &str) -> Level {
    let text = format!(
        "(name: \"frame\", substeps: 1, sleep: Off, bodies: [(name: \"body\", mesh: {mesh}, mass: Density(1), stretch: (1.1, 1),
          material: (model: Corotated, young: 0.1, poisson: 0.3, plane: Strain))], effects: [(effect: MouseSpring(stiffness: 1))])"
    );
    files::parse(&text, "frame.ron").unwrap()
}

/// A window of a level in which time runs, without a display.
struct Window {
    harness: Harness<'static, App>,
    frame: eframe::Frame,
    time: f64,
}

impl Window {
    /// With these switches of the panel clicked.
    fn new(level: Level, switches: &[&str]) -> Self {
        let mut harness = Harness::builder().with_size(vec2(1280.0, 800.0)).build_eframe(move |cc| {
            App::with_level(&cc.egui_ctx, level, Box::new(Disk)).unwrap().unhurried().without_dialogs()
        });
        harness.run_steps(3);
        harness.key_press_modifiers(Modifiers::NONE, Key::M);
        for switch in switches {
            harness.run_steps(3);
            harness.get_by_label(switch).click();
        }
        harness.run_steps(3);
        // Nobody reads the screen aloud.
        harness.ctx.disable_accesskit();
        let time = harness.ctx.input(|input| input.time);
        let mut window = Self { harness, frame: eframe::Frame::_new_kittest(), time };
        window.frames(BEFORE);
        window
    }

    /// Draws frames; returns how long that took.
    fn frames(&mut self, count: usize) -> Duration {
        let ctx = self.harness.ctx.clone();
        let app = self.harness.state_mut();
        let mut spent = Duration::ZERO;
        for _ in 0..count {
            self.time += FRAME;
            let input = RawInput {
                screen_rect: Some(Rect::from_min_size(Pos2::ZERO, vec2(1280.0, 800.0))),
                time: Some(self.time),
                predicted_dt: FRAME as f32,
                events: vec![Event::PointerGone],
                ..RawInput::default()
            };
            let begin = Instant::now();
            let output = ctx.run_ui(input, |ui| {
                app.logic(ui.ctx(), &mut self.frame);
                app.ui(ui, &mut self.frame);
            });
            std::hint::black_box(ctx.tessellate(output.shapes, output.pixels_per_point));
            spent += begin.elapsed();
        }
        spent
    }
}

/// Snapshots of a running sandbox, without its steps.
fn snapshots(sandbox: &mut Sandbox, field: Field, snapshot: &mut Snapshot, count: u64) -> Duration {
    (0..count)
        .map(|_| {
            sandbox.advance(1, &mut || true);
            let begin = Instant::now();
            sandbox.snapshot(field, snapshot);
            begin.elapsed()
        })
        .sum()
}

fn body(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, mesh: &str) {
    let mut sandbox = Sandbox::new(level(mesh), Box::new(NoFiles)).unwrap();
    sandbox.apply(Command::SetMode(Mode::Simulate)).unwrap();
    let mut snapshot = Snapshot::default();
    group.bench_function(format!("{name}, step alone"), |bencher| {
        bencher.iter(|| sandbox.advance(1, &mut || true));
    });
    for (field, what) in [(Field::None, "plain"), (Field::VonMises, "stress")] {
        group.bench_function(format!("{name}, snapshot, {what}"), |bencher| {
            bencher.iter_custom(|count| snapshots(&mut sandbox, field, &mut snapshot, count));
        });
    }
    let looks: [(&str, &[&str]); 4] = [
        ("plain", &[]),
        ("plain, edges", &["Wireframe"]),
        ("stress", &["Von Mises stress"]),
        ("stress, edges", &["Von Mises stress", "Wireframe"]),
    ];
    for (what, switches) in looks {
        let mut window = None;
        group.bench_function(format!("{name}, frame, {what}"), |bencher| {
            let window = window.get_or_insert_with(|| Window::new(level(mesh), switches));
            bencher.iter_custom(|count| window.frames(count as usize));
        });
    }
}

fn frame(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("frame");
    body(&mut group, "man", "Gingerbread(resolution: 10000)");
    body(&mut group, "sheet", "Rectangle(width: 0.6, height: 0.6, columns: 71, rows: 71, diagonals: Grid)");
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).measurement_time(Duration::from_secs(2)).warm_up_time(Duration::from_millis(300));
    targets = frame
}
criterion_main!(benches);

//! Shared parts of plots: logarithmic axes, colours and labels of integrators; and export of numbers as CSV, pictures as PNG.

use super::{FileRequest, Notice, View};
use crate::{
    app::{files::stem, language::tr, theme::Theme},
    integrators::IntegratorKind,
};
use eframe::egui::{
    Align2, Button, Color32, ColorImage, Context, Pos2, Rect, RichText, Stroke, TextStyle, Ui, Vec2,
    style::ScrollAnimation, vec2,
};
use egui_plot::{GridInput, GridMark, Plot};
use std::sync::{Arc, Mutex, PoisonError};

/// Creates a plot with two logarithmic axes. The plotted values are common logarithms.
pub fn log_log<'a>(name: &'static str, theme: &Theme) -> Plot<'a> {
    log_y(name, theme).x_grid_spacer(decades).x_axis_formatter(|mark, _| power_of_ten(mark.value))
}

/// Creates a plot with a logarithmic vertical axis. The plotted heights are common logarithms.
pub fn log_y<'a>(name: &'static str, theme: &Theme) -> Plot<'a> {
    Plot::new(name)
        .y_grid_spacer(decades)
        .y_axis_formatter(|mark, _| power_of_ten(mark.value))
        .grid_color(theme.line)
        .allow_scroll(false)
        .show_x(false)
        .show_y(false)
}

/// Creates a small plot of the last seconds, which follows simulated time and cannot be moved.
pub fn still<'a>(name: &'static str, height: f32, theme: &Theme) -> Plot<'a> {
    Plot::new(name)
        .height(height)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .allow_double_click_reset(false)
        .grid_color(theme.line)
        .show_x(false)
        .show_y(false)
}

/// Grid lines at every power of ten, or at every second, third, ... power.
fn decades(GridInput { bounds: (from, to), .. }: GridInput) -> Vec<GridMark> {
    let every = ((to - from) / 8.0).ceil().max(1.0);
    let (first, last) = ((from / every).ceil() as i64, (to / every).floor() as i64);
    (first..=last).map(|mark| GridMark { value: mark as f64 * every, step_size: every }).collect()
}

/// Round values for grid lines, at least two. Their distance is at most a share of the range, from 0.4 to 0.62.
pub fn heights((low, high): (f64, f64), share: f64) -> Vec<GridMark> {
    let most = share * (high - low);
    let power = 10f64.powf(most.log10().floor());
    let step = [5.0, 2.0, 1.0].into_iter().find(|lead| lead * power <= most).unwrap_or(1.0) * power;
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    (first..=last.min(first + 8)).map(|mark| GridMark { value: mark as f64 * step, step_size: step }).collect()
}

fn power_of_ten(exponent: f64) -> String {
    match exponent.round() as i32 {
        power @ -3..=4 => format!("{}", 10_f64.powi(power)),
        power => format!("1e{power}"),
    }
}

/// Colour of a scheme, the same in every plot.
pub fn color_of(integrator: &IntegratorKind, theme: &Theme) -> Color32 {
    let number = IntegratorKind::all().iter().position(|kind| kind.name() == integrator.name());
    // A kind from outside the crate comes after all others.
    let number = number.unwrap_or_else(|| IntegratorKind::all().len());
    let base = theme.series[number % theme.series.len()];
    // Colours after the first round are lighter or darker, so that twelve lines can be told apart.
    if number < theme.series.len() { base } else { base.lerp_to_gamma(theme.text, 0.45) }
}

/// Label of a point in a plot.
pub struct Label {
    /// Position of the point on the screen.
    pub at: Pos2,
    /// Text of the label.
    pub text: String,
    /// Colour of the line of the point.
    pub color: Color32,
}

/// Distance of a label from its point [points].
const GAP: f32 = 8.0;

/// Extra distance that is added to places left of the point, where the lines run [points].
const LEFT: f32 = 60.0;

/// Draws labels beside their points without overlap. A thin line leads to a label that had to move away.
pub fn write_labels(ui: &Ui, frame: Rect, labels: &[Label]) {
    let painter = ui.painter_at(frame);
    let font = TextStyle::Small.resolve(ui.style());
    let inside: Vec<_> = labels.iter().filter(|label| frame.contains(label.at)).collect();
    let lay = |label: &&Label| painter.layout_no_wrap(label.text.clone(), font.clone(), label.color);
    let galleys: Vec<_> = inside.iter().map(lay).collect();
    let wanted: Vec<_> = inside.iter().zip(&galleys).map(|(label, galley)| (label.at, galley.size())).collect();
    for ((label, galley), rect) in inside.iter().zip(galleys).zip(places(frame.shrink(2.0), &wanted)) {
        let near = rect.clamp(label.at);
        if near.distance(label.at) > 1.6 * GAP {
            painter.line_segment([label.at, near], Stroke::new(1.0, label.color.gamma_multiply(0.5)));
        }
        painter.galley(rect.left_top(), galley, label.color);
    }
}

/// Places for labels of these sizes: to the right of their points if there is room, else the nearest free place.
fn places(frame: Rect, wanted: &[(Pos2, Vec2)]) -> Vec<Rect> {
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    order.sort_by(|a, b| wanted[*a].0.y.total_cmp(&wanted[*b].0.y));
    let mut placed: Vec<(usize, Rect)> = Vec::new();
    for number in order {
        let (at, size) = wanted[number];
        let shifts = (0..40_u8).flat_map(|step| [1.0, -1.0].map(|sign| sign * f32::from(step) * 0.34 * size.y));
        let sides = [(Align2::LEFT_CENTER, GAP), (Align2::RIGHT_CENTER, -GAP)];
        let candidates =
            shifts.flat_map(|shift| sides.map(|(anchor, gap)| anchor.anchor_size(at + vec2(gap, shift), size)));
        let free = |rect: &Rect| {
            let points = wanted.iter().all(|(point, _)| !rect.contains(*point));
            frame.contains_rect(*rect) && points && placed.iter().all(|(_, other)| !rect.intersects(*other))
        };
        // The nearest free place, or beside the point if there is none.
        let distance = |rect: &Rect| rect.distance_to_pos(at) + if rect.center().x < at.x { LEFT } else { 0.0 };
        let best = candidates.filter(free).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let rect = best.unwrap_or_else(|| Align2::LEFT_CENTER.anchor_size(at + vec2(GAP, 0.0), size));
        placed.push((number, rect));
    }
    placed.sort_by_key(|(number, _)| *number);
    placed.into_iter().map(|(_, rect)| rect).collect()
}

/// A finished file that waits for a file name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Export {
    /// Suggested file name, with its extension.
    pub name: String,
    /// Content of the file.
    pub bytes: Vec<u8>,
}

/// The plots that can be exported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Figure {
    /// Energies of the last seconds.
    Energies,
    /// Errors of schemes against time.
    Accuracy,
    /// Errors of meshes against time.
    Meshes,
    /// Energy and momentum over time.
    Drift,
    /// Sources of error.
    Budget,
    /// Distance of two panes.
    Difference,
    /// Numbers of probes over time.
    Probes,
}

impl Figure {
    /// Title of the plot on buttons and in file names.
    const fn title(self) -> &'static str {
        match self {
            Self::Energies => "Energies",
            Self::Accuracy => "Accuracy",
            Self::Meshes => "Meshes",
            Self::Drift => "Drift",
            Self::Budget => "Budget",
            Self::Difference => "Difference",
            Self::Probes => "Probes",
        }
    }
}

/// A plot whose picture is being taken. It takes some frames until the pixels arrive.
pub struct Sitting {
    figure: Figure,
    name: String,
    /// Head of the table of the plot, which is stored in the file.
    about: String,
    /// Place of the plot in the last frame [points].
    rect: Option<Rect>,
    frames: u32,
    pixels: Arc<Mutex<Option<Arc<ColorImage>>>>,
}

/// Number of frames after which the picture is given up.
const TIMEOUT_FRAMES: u32 = 90;

/// Draws two small buttons in a right-to-left row: for the picture of a plot, and for its numbers.
pub fn export_buttons(ui: &mut Ui, view: &mut View, figure: Figure, level: &str, table: impl Fn() -> String) {
    let title = figure.title();
    let name = |extension: &str| format!("{}-{}.{extension}", stem(level), title.to_lowercase());
    let button = |ui: &mut Ui, text: &str, help: &str| {
        let button = Button::new(RichText::new(text).small()).small().min_size(Vec2::new(34.0, 20.0));
        ui.add(button).on_hover_text(tr(help)).accessible_name(format!("{title} as {text}"))
    };
    if button(ui, "PNG", "Saves the plot as a picture, as it looks now.").clicked() {
        let table = table();
        let about: Vec<_> = table.lines().filter_map(|line| line.strip_prefix("# ")).collect();
        let (about, pixels) = (about.join("\n"), Arc::default());
        view.sitting = Some(Sitting { figure, name: name("png"), about, rect: None, frames: 0, pixels });
    }
    let help =
        "Saves the numbers behind the plot as comma-separated values, with a header that says how they were computed.";
    if button(ui, "CSV", help).clicked() {
        view.file = Some(FileRequest::Export(Export { name: name("csv"), bytes: table().into_bytes() }));
    }
}

/// Takes the picture of a plot if it was requested; scrolls to the plot first. Call it after the plot was drawn.
pub fn pose(ui: &Ui, view: &mut View, figure: Figure, rect: Rect) {
    let Some(sitting) = view.sitting.as_mut().filter(|sitting| sitting.figure == figure) else { return };
    let before = sitting.rect.replace(rect.expand(4.0));
    if before.is_none() {
        ui.scroll_to_rect_animation(rect, None, ScrollAnimation::none());
    } else if sitting.frames == 2 {
        let (pixels, ctx) = (Arc::clone(&sitting.pixels), ui.ctx().clone());
        ui.ctx().request_screenshot(move |image| {
            *pixels.lock().unwrap_or_else(PoisonError::into_inner) = Some(image);
            ctx.request_repaint();
        });
    }
}

impl View {
    /// Whether a picture of this plot is being taken, so that nothing may cover the plot.
    pub fn poses(&self, figure: Figure) -> bool {
        self.sitting.as_ref().is_some_and(|sitting| sitting.figure == figure)
    }

    /// Whether a picture is being taken.
    pub const fn is_posing(&self) -> bool {
        self.sitting.is_some()
    }

    /// Counts the frames of a picture, and makes a file from its pixels when they have arrived.
    pub fn develop(&mut self, ctx: &Context) {
        let Some(sitting) = &mut self.sitting else { return };
        ctx.request_repaint();
        sitting.frames += 1;
        let image = sitting.pixels.lock().unwrap_or_else(PoisonError::into_inner).take();
        let file = match (image, sitting.rect) {
            (Some(image), Some(rect)) => png(&image, rect, ctx.pixels_per_point(), &sitting.about),
            _ if sitting.frames > TIMEOUT_FRAMES => Err("the window delivered no picture".to_owned()),
            _ => return,
        };
        match file {
            Ok(bytes) => {
                self.file = Some(FileRequest::Export(Export { name: std::mem::take(&mut sitting.name), bytes }));
            }
            Err(why) => self.notice = Some(Notice::Trouble(format!("The plot could not be drawn into a file: {why}"))),
        }
        self.sitting = None;
    }
}

/// Encodes the part `rect` [points] of a picture of the window as a PNG file with a text about it.
fn png(image: &ColorImage, rect: Rect, pixels_per_point: f32, about: &str) -> Result<Vec<u8>, String> {
    let [width, height] = image.size;
    let pixel = |at: f32, most: usize| ((at * pixels_per_point).round().max(0.0) as usize).min(most);
    let (left, right) = (pixel(rect.left(), width), pixel(rect.right(), width));
    let (top, bottom) = (pixel(rect.top(), height), pixel(rect.bottom(), height));
    if left >= right || top >= bottom {
        return Err("the plot is not visible".to_owned());
    }
    let rows = image.pixels.chunks_exact(width).take(bottom).skip(top);
    let rgb: Vec<u8> =
        rows.flat_map(|row| &row[left..right]).flat_map(|color| [color.r(), color.g(), color.b()]).collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, (right - left) as u32, (bottom - top) as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let said = |error: png::EncodingError| error.to_string();
    encoder.add_itxt_chunk("Description".to_owned(), about.to_owned()).map_err(said)?;
    let mut writer = encoder.write_header().map_err(said)?;
    writer.write_image_data(&rgb).map_err(said)?;
    writer.finish().map_err(said)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{Color32, pos2};

    #[test]
    fn names_of_lines_that_end_together_do_not_cover_each_other() {
        let frame = Rect::from_min_size(Pos2::ZERO, vec2(400.0, 300.0));
        let wanted: Vec<_> = (0..11_u8).map(|i| (pos2(300.0, 200.0 + f32::from(i)), vec2(90.0, 14.0))).collect();
        let rects = places(frame, &wanted);
        for (number, rect) in rects.iter().enumerate() {
            assert!(frame.contains_rect(*rect));
            assert!(rects[number + 1..].iter().all(|other| !rect.intersects(*other)));
        }
    }

    #[test]
    fn a_plot_has_two_marks_or_more_whatever_its_range() {
        for (low, high) in [(0.0, 1.06), (-0.4, 0.02), (-3e-9, 8e-9), (0.0, 212.0), (-5.3, 5.3), (0.0, 3.18)] {
            for (share, most) in [(0.62, 5), (0.4, 7)] {
                let marks = heights((low, high), share);
                assert!((2..=most).contains(&marks.len()), "{low} {high}: {marks:?}");
            }
        }
    }

    #[test]
    fn every_scheme_has_a_colour_of_its_own() {
        for mode in [eframe::egui::Theme::Dark, eframe::egui::Theme::Light] {
            let mut colors: Vec<_> =
                IntegratorKind::all().iter().map(|kind| color_of(kind, Theme::for_mode(mode)).to_array()).collect();
            let all = colors.len();
            colors.sort_unstable();
            colors.dedup();
            assert_eq!(colors.len(), all);
        }
    }

    /// A picture whose pixels contain their own coordinates.
    fn window() -> ColorImage {
        let pixels = (0..40 * 30).map(|i| Color32::from_rgb((i % 40) as u8, (i / 40) as u8, 7)).collect();
        ColorImage::new([40, 30], pixels)
    }

    #[test]
    fn a_picture_holds_only_the_plot_and_its_origin() {
        let rect = Rect::from_min_max(pos2(5.0, 3.0), pos2(15.0, 9.0));
        let bytes = png(&window(), rect, 2.0, "level: Chain\nthreads: 1").unwrap_or_default();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().ok();
        let reader = reader.as_mut();
        let mut pixels = vec![0; 20 * 12 * 3];
        let frame = reader.and_then(|reader| {
            let text = reader.info().utf8_text.first()?.get_text().ok()?;
            assert_eq!(text, "level: Chain\nthreads: 1");
            reader.next_frame(&mut pixels).ok()
        });
        assert_eq!(frame.map(|frame| (frame.width, frame.height)), Some((20, 12)));
        assert_eq!((&pixels[..3], &pixels[pixels.len() - 3..]), (&[10, 6, 7][..], &[29, 17, 7][..]));
    }

    #[test]
    fn a_plot_partly_outside_is_cut_and_one_outside_refused() {
        let half = Rect::from_min_max(pos2(30.0, 20.0), pos2(80.0, 80.0));
        assert!(png(&window(), half, 1.0, "").is_ok());
        let away = Rect::from_min_max(pos2(50.0, 0.0), pos2(80.0, 20.0));
        assert!(png(&window(), away, 1.0, "").is_err());
    }
}

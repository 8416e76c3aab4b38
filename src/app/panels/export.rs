//! Exports plots: numbers as CSV, pictures as PNG.

use super::{FileRequest, Notice, View};
use crate::app::files::stem;
use eframe::egui::{Button, ColorImage, Context, Rect, RichText, Ui, Vec2, style::ScrollAnimation};
use std::sync::{Arc, Mutex, PoisonError};

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
    /// Distance of two panes.
    Difference,
}

impl Figure {
    /// Title of the plot on buttons and in file names.
    const fn title(self) -> &'static str {
        match self {
            Self::Energies => "Energies",
            Self::Accuracy => "Accuracy",
            Self::Meshes => "Meshes",
            Self::Drift => "Drift",
            Self::Difference => "Difference",
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
pub fn buttons(ui: &mut Ui, view: &mut View, figure: Figure, level: &str, table: impl Fn() -> String) {
    let title = figure.title();
    let name = |extension: &str| format!("{}-{}.{extension}", stem(level), title.to_lowercase());
    let button = |ui: &mut Ui, text: &str, help: &str| {
        let button = Button::new(RichText::new(text).small()).small().min_size(Vec2::new(34.0, 20.0));
        ui.add(button).on_hover_text(help).accessible_name(format!("{title} as {text}"))
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

//! Shared parts of plots: logarithmic axes, colours and labels of integrators.

use crate::{app::theme::Theme, integrators::IntegratorKind};
use eframe::egui::{Align2, Color32, Pos2, Rect, Stroke, TextStyle, Ui, Vec2, vec2};
use egui_plot::{GridInput, GridMark, Plot};

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
    let number = IntegratorKind::all().iter().position(|kind| kind.name() == integrator.name()).unwrap_or(0);
    let base = theme.series[number % theme.series.len()];
    // Colours after the first round are lighter or darker, so that eleven lines can be told apart.
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

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::pos2;

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
}

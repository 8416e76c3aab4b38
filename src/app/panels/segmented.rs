//! Segmented buttons and icon buttons.

use super::icons::Icon;
use eframe::egui::{
    self, Color32, CornerRadius, Rect, Response, Role, Sense, Stroke, StrokeKind, TextStyle, Ui, WidgetInfo, vec2,
};

/// One part of a segmented control.
pub struct Segment<'a> {
    /// Visible text.
    pub text: &'a str,
    /// Accessible name and first line of the tooltip.
    pub name: &'a str,
    /// Explanation in the tooltip, with key and formula.
    pub about: &'a str,
    /// Whether the segment is selected.
    pub on: bool,
}

/// Height of the widgets in the toolbar [points].
pub const HEIGHT: f32 = 28.0;

/// Draws a segmented control and returns the clicked segment. `fill` stretches it over the available width.
pub fn segmented(ui: &mut Ui, salt: &str, segments: &[Segment<'_>], fill: bool) -> Option<usize> {
    let font = TextStyle::Button.resolve(ui.style());
    let color = ui.visuals().text_color();
    let galleys: Vec<_> = segments
        .iter()
        .map(|segment| ui.painter().layout_no_wrap(segment.text.to_owned(), font.clone(), color))
        .collect();
    let text: f32 = galleys.iter().map(|galley| galley.size().x).sum();
    let count = segments.len() as f32;
    let pad = if fill { ((ui.available_width() - text) / (2.0 * count)).max(4.0) } else { 11.0 };
    let height = if fill { 24.0 } else { HEIGHT };
    let (whole, _) = ui.allocate_exact_size(vec2(text + 2.0 * pad * count, height), Sense::hover());
    ui.painter().rect_filled(whole, 7.0, ui.visuals().extreme_bg_color);

    let mut clicked = None;
    let mut left = whole.left();
    for (index, (segment, galley)) in segments.iter().zip(galleys).enumerate() {
        let rect = Rect::from_min_size(egui::pos2(left, whole.top()), vec2(galley.size().x + 2.0 * pad, height));
        left = rect.right();
        let id = ui.make_persistent_id((salt, index));
        let response = ui.interact(rect, id, Sense::click());
        response.widget_info(|| WidgetInfo::selected(Role::RadioButton, ui.is_enabled(), segment.on, segment.name));
        let color = back(ui, &response, rect.shrink(2.0), segment.on);
        ui.painter().galley_with_override_text_color(rect.center() - 0.5 * galley.size(), galley, color);
        if tip(response, segment.name, segment.about).clicked() {
            clicked = Some(index);
        }
    }
    clicked
}

/// State of an icon button.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lit {
    /// Enabled and not selected.
    Off,
    /// Enabled and selected.
    On,
    /// Disabled.
    Disabled,
}

impl From<bool> for Lit {
    fn from(on: bool) -> Self {
        if on { Self::On } else { Self::Off }
    }
}

/// Draws an icon button.
pub fn icon_button(ui: &mut Ui, icon: Icon, name: &str, about: &str, lit: impl Into<Lit>) -> Response {
    let lit = lit.into();
    let sense = if lit == Lit::Disabled { Sense::hover() } else { Sense::click() };
    let (rect, response) = ui.allocate_exact_size(vec2(HEIGHT, HEIGHT), sense);
    response.widget_info(|| WidgetInfo::selected(Role::Button, lit != Lit::Disabled, lit == Lit::On, name));
    let color = match lit {
        Lit::Disabled => ui.visuals().weak_text_color().gamma_multiply(0.5),
        _ => back(ui, &response, rect.shrink(1.0), lit == Lit::On),
    };
    icon.paint(ui.painter(), rect.center(), color);
    tip(response, name, about)
}

/// Draws the background of a segment and returns its text colour.
fn back(ui: &Ui, response: &Response, rect: Rect, on: bool) -> Color32 {
    let lit = ui.ctx().animate_bool_with_time(response.id, on, 0.12);
    let radius = CornerRadius::same(6);
    let visuals = ui.visuals();
    if response.hovered() && !on {
        ui.painter().rect_filled(rect, radius, visuals.widgets.hovered.weak_bg_fill);
    }
    if lit > 0.0 {
        ui.painter().rect_filled(rect, radius, visuals.selection.bg_fill.gamma_multiply(lit));
    }
    if response.has_focus() {
        let stroke = Stroke::new(1.0, visuals.selection.stroke.color);
        ui.painter().rect_stroke(rect, radius, stroke, StrokeKind::Inside);
    }
    if on { visuals.selection.stroke.color } else { visuals.text_color() }
}

fn tip(response: Response, name: &str, about: &str) -> Response {
    let text = if about.is_empty() { name.to_owned() } else { format!("{name}\n{about}") };
    response.on_hover_text(text)
}

//! Controls of the panels: a slider with a number field for one quantity, segmented buttons, and buttons with icons.

use crate::{app::language::tr, app::numbers, effects::PointFormula, formula::Formula, quantity::Quantity};
use eframe::egui::{
    self, Color32, CornerRadius, DragValue, Mesh, Painter, Pos2, Rect, Response, RichText, Role, Sense, Shape, Slider,
    SliderClamping, Stroke, StrokeKind, TextEdit, TextStyle, Ui, Vec2, WidgetInfo, pos2, vec2,
};
use std::{
    cell::RefCell,
    f32::consts::{FRAC_PI_2, PI, TAU},
};

/// Options of a slider.
pub struct SliderOptions<'a> {
    /// Name in words.
    pub name: &'a str,
    /// Unit symbol.
    pub unit: &'a str,
    /// Range of the slider; other values can still be typed.
    pub range: (f64, f64),
    /// Whether the slider is logarithmic.
    pub logarithmic: bool,
    /// Formula and range, for the tooltip.
    pub help: &'a str,
}

/// Response of a slider.
#[derive(Debug, Default)]
pub struct SliderResponse {
    /// Whether the value has changed.
    pub changed: bool,
    /// Whether a drag or typing has ended: the next change is another gesture.
    pub ended: bool,
    /// Reason why a value was refused; the old value stays.
    pub refused: Option<String>,
}

impl SliderResponse {
    /// Merges the response of another slider.
    pub fn add(&mut self, other: Self) {
        self.changed |= other.changed;
        self.ended |= other.ended;
        self.refused = other.refused.or(self.refused.take());
    }
}

/// Draws a slider for any quantity; a value outside its range is refused.
pub fn quantity(ui: &mut Ui, quantity: &mut dyn Quantity) -> SliderResponse {
    named_quantity(ui, quantity.spec().name, quantity)
}

/// The same under another name.
pub fn named_quantity(ui: &mut Ui, name: &str, quantity: &mut dyn Quantity) -> SliderResponse {
    let spec = quantity.spec();
    let help = format!("{}\n{} {}.", tr(spec.help.trim()), tr("Allowed:"), spec.range());
    let options =
        SliderOptions { name, unit: spec.unit, range: spec.slider, logarithmic: spec.logarithmic, help: &help };
    let value = quantity.get();
    number(ui, &options, value, &mut |new| quantity.set(new).map_err(|error| error.to_string()))
}

/// The same for several, with their names.
pub fn named_quantities<'a>(
    ui: &mut Ui,
    numbers: impl IntoIterator<Item = (&'a str, &'a mut dyn Quantity)>,
) -> SliderResponse {
    let mut sum = SliderResponse::default();
    for (name, number) in numbers {
        sum.add(named_quantity(ui, name, number));
    }
    sum
}

/// Draws a field for a formula of a point, with its name and an error in words below it.
pub fn formula(ui: &mut Ui, name: &str, formula: &mut PointFormula) -> SliderResponse {
    let help = "A formula of x, y, z [m], vx, vy, vz [m/s] and t [s], such as -2*x^2 + sin(3*t). Functions: sin, cos, tan, \
                asin, acos, atan, atan2, sinh, cosh, tanh, exp, log, log10, sqrt, abs, sign, floor, min, max, hypot.";
    let before = formula.text().to_owned();
    formula_field(ui, (name, help), &before, |text| {
        let typed = PointFormula::new(text).map_err(|error| error.to_string())?;
        *formula = typed;
        Ok(())
    })
}

/// Draws a field for a formula, with its name and an error in words below it. `before` is its text; `accept` reads another one.
pub fn formula_field(
    ui: &mut Ui,
    (name, help): (&str, &str),
    before: &str,
    mut accept: impl FnMut(&str) -> Result<(), String>,
) -> SliderResponse {
    let mut outcome = SliderResponse::default();
    let id = ui.scope_id().with(("formula", name));
    // What was typed, and the formula that it was typed over: another one replaces it.
    let typed = ui.data(|data| data.get_temp::<[String; 2]>(id)).filter(|[over, _]| over == before);
    let mut text = typed.map_or_else(|| before.to_owned(), |[_, typed]| typed);
    let mut refused = None;
    ui.horizontal(|ui| {
        let label = ui.monospace(name).on_hover_text(tr(help));
        // A long formula takes several lines.
        let field = TextEdit::multiline(&mut text).desired_rows(1).return_key(None);
        let field = field.font(TextStyle::Monospace).desired_width(f32::INFINITY);
        let response = ui.add(field).labelled_by(label.id);
        if text != before {
            match accept(&text) {
                Ok(()) => outcome.changed = true,
                Err(why) => refused = Some(why),
            }
        }
        outcome.ended = response.lost_focus();
        let is_open = response.has_focus() || refused.is_some();
        let now = if outcome.changed { text.clone() } else { before.to_owned() };
        ui.data_mut(|data| {
            if is_open {
                data.insert_temp(id, [now, text]);
            } else {
                data.remove::<[String; 2]>(id);
            }
        });
        response.on_hover_text(tr(help));
    });
    if let Some(refused) = refused {
        ui.colored_label(ui.visuals().warn_fg_color, RichText::new(refused).small());
    }
    outcome
}

/// Draws a slider for a number; `set` may refuse a value.
pub fn number(
    ui: &mut Ui,
    options: &SliderOptions<'_>,
    value: f64,
    set: &mut dyn FnMut(f64) -> Result<(), String>,
) -> SliderResponse {
    let mut outcome = SliderResponse::default();
    let mut now = value;
    let mut take = |new: f64, outcome: &mut SliderResponse| match set(new) {
        Ok(()) => {
            now = new;
            outcome.changed = true;
        }
        Err(message) => outcome.refused = Some(message),
    };
    ui.push_id(options.name, |ui| {
        ui.spacing_mut().item_spacing.y = 1.0;
        if let Some(new) = typed(ui, options, value, &mut outcome) {
            take(new, &mut outcome);
        }
        if let Some(new) = dragged(ui, options, value, &mut outcome) {
            take(new, &mut outcome);
        }
        ui.add_space(5.0);
    });
    let _ = now;
    outcome
}

/// Draws the row with the name and the number field, and returns a new value.
pub fn typed(ui: &mut Ui, options: &SliderOptions<'_>, value: f64, outcome: &mut SliderResponse) -> Option<f64> {
    typed_as(ui, &capitalised(tr(options.name)), options, value, outcome)
}

/// The same with a shorter word in place of the name, where what is around it tells the rest.
pub fn typed_as(
    ui: &mut Ui,
    word: &str,
    options: &SliderOptions<'_>,
    value: f64,
    outcome: &mut SliderResponse,
) -> Option<f64> {
    let mut chosen = None;
    let not_a_number = RefCell::new(None);
    ui.horizontal(|ui| {
        let label = ui.label(word).on_hover_text(options.help);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let shown = numbers::si_edited(value, options.unit);
            let widget = DragValue::from_get_set(|new| {
                // A field that loses focus without a change must not round the value to the shown digits.
                if let Some(new) = new.filter(|new| Some(*new) != parse(&shown, options.unit)) {
                    chosen = Some(new);
                }
                chosen.unwrap_or(value)
            })
            .speed(if options.logarithmic { 0.01 * value.abs() } else { 0.002 * (options.range.1 - options.range.0) })
            .update_while_editing(false)
            .min_size(vec2(84.0, 20.0))
            .custom_formatter(|value, _| numbers::si_edited(value, options.unit))
            .custom_parser(|text| {
                let number = parse(text, options.unit);
                if number.is_none() {
                    *not_a_number.borrow_mut() = Some(text.trim().to_owned());
                }
                number
            });
            let response = ui.add(widget).labelled_by(label.id).accessible_name(capitalised(tr(options.name)));
            outcome.ended |= response.drag_stopped() || response.lost_focus();
            let typing = tr("Drag, or click to type, such as 30k, 2.5e4 or 1/3.");
            response.on_hover_text(format!("{}\n{typing}", options.help));
        });
    });
    if let Some(text) = not_a_number.take() {
        outcome.refused = Some(format!("{}: '{text}' is not a number", options.name));
    }
    chosen
}

/// Draws the slider below the number field, as wide as the panel, and returns a dragged value.
fn dragged(ui: &mut Ui, options: &SliderOptions<'_>, value: f64, outcome: &mut SliderResponse) -> Option<f64> {
    let mut chosen = None;
    ui.spacing_mut().interact_size.y = 16.0;
    ui.spacing_mut().slider_width = ui.available_width();
    let slider = Slider::from_get_set(options.range.0..=options.range.1, |new| {
        if new.is_some_and(|new| new != value) {
            chosen = new;
        }
        chosen.unwrap_or(value)
    })
    .logarithmic(options.logarithmic)
    .clamping(SliderClamping::Never)
    .show_value(false)
    .trailing_fill(true);
    let response = ui.add(slider).accessible_name(capitalised(tr(options.name)));
    // A key or an assistive tool changes the value without a drag: each change is one gesture.
    outcome.ended |= response.drag_stopped() || (response.changed() && !response.dragged());
    response.on_hover_text(options.help);
    chosen
}

/// Makes the first letter a capital: `young's modulus` becomes `Young's modulus`.
fn capitalised(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

/// Parses a number with or without SI prefix and unit, or calculates it: `30k`, `30 kPa`, `2.5e4`, `1/3`, `2*pi`.
fn parse(text: &str, unit: &str) -> Option<f64> {
    with_unit(text, unit).or_else(|| {
        let formula = Formula::parse(text, &[]).ok()?;
        Some(formula.value(&[])).filter(|value| value.is_finite())
    })
}

/// Parses a number with or without SI prefix and unit.
fn with_unit(text: &str, unit: &str) -> Option<f64> {
    let plain = |text: &str| text.replace('³', "3").replace('²', "2").replace('−', "-").replace(' ', "");
    // `5 1/s` and `5 /s` are the same; without a space `51/s` is 51 per second.
    let text = text.trim();
    let text = if unit.starts_with("1/") { text.strip_suffix(&format!(" {unit}")).unwrap_or(text) } else { text };
    let (text, unit) =
        (plain(text), plain(unit.strip_prefix('1').filter(|rest| rest.starts_with('/')).unwrap_or(unit)));
    if let Some(number) = text.strip_suffix(&unit).and_then(scaled) {
        return Some(number);
    }
    // The unit kg contains a prefix itself: `2 Mg` is 2000 kg.
    let gram = unit.strip_prefix('k').filter(|unit| unit.starts_with('g'));
    gram.and_then(|gram| text.strip_suffix(gram)).and_then(scaled).map_or_else(|| scaled(&text), |g| Some(g / 1e3))
}

/// Parses a number with an SI prefix. `nan` and `inf` are refused.
fn scaled(text: &str) -> Option<f64> {
    if let Ok(number) = text.parse::<f64>() {
        return Some(number).filter(|number| number.is_finite());
    }
    let last = text.chars().last()?;
    let power = match last {
        'p' => -12,
        'n' => -9,
        'u' | 'µ' | 'μ' => -6,
        'm' => -3,
        'k' | 'K' => 3,
        'M' => 6,
        'G' => 9,
        'T' => 12,
        'P' => 15,
        _ => return None,
    };
    let number = text[..text.len() - last.len_utf8()].parse::<f64>().ok()?;
    Some(number * 10f64.powi(power)).filter(|number| number.is_finite())
}

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
        .map(|segment| ui.painter().layout_no_wrap(tr(segment.text).to_owned(), font.clone(), color))
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
        response.widget_info(|| WidgetInfo::selected(Role::RadioButton, ui.is_enabled(), segment.on, tr(segment.name)));
        let color = back(ui, &response, rect.shrink(2.0), segment.on);
        ui.painter().galley_with_override_text_color(rect.center() - 0.5 * galley.size(), galley, color);
        if tip(response, tr(segment.name), tr(segment.about)).clicked() {
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
    response.widget_info(|| WidgetInfo::selected(Role::Button, lit != Lit::Disabled, lit == Lit::On, tr(name)));
    let color = match lit {
        Lit::Disabled => ui.visuals().weak_text_color().gamma_multiply(0.5),
        _ => back(ui, &response, rect.shrink(1.0), lit == Lit::On),
    };
    icon.paint(ui.painter(), rect.center(), color);
    tip(response, tr(name), tr(about))
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

/// Icon of a button.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Icon {
    /// Run.
    Play,
    /// Pause.
    Pause,
    /// Take one step.
    Step,
    /// Go back in time.
    Back,
    /// Start over.
    Reset,
    /// Undo.
    Undo,
    /// Redo.
    Redo,
    /// The whole screen.
    Whole,
    /// Light theme.
    Sun,
    /// Dark theme.
    Moon,
    /// Help.
    Help,
    /// The panel on the left.
    Left,
    /// The panel on the right.
    Right,
    /// Pictures and films of the stage.
    Camera,
    /// Close.
    Close,
}

impl Icon {
    /// Draws the icon centred at a point, 14 points wide.
    pub fn paint(self, painter: &Painter, at: Pos2, color: Color32) {
        let stroke = Stroke::new(1.6, color);
        let p = |x: f32, y: f32| at + vec2(x, y);
        match self {
            Self::Play => fill(painter, vec![p(-4.5, -6.0), p(6.5, 0.0), p(-4.5, 6.0)], color),
            Self::Pause => {
                for x in [-4.5, 1.5] {
                    fill(painter, vec![p(x, -5.5), p(x + 3.0, -5.5), p(x + 3.0, 5.5), p(x, 5.5)], color);
                }
            }
            Self::Step => {
                fill(painter, vec![p(-6.0, -5.5), p(2.5, 0.0), p(-6.0, 5.5)], color);
                fill(painter, vec![p(3.5, -5.5), p(6.0, -5.5), p(6.0, 5.5), p(3.5, 5.5)], color);
            }
            Self::Back => {
                for x in [-6.0, 0.5] {
                    fill(painter, vec![p(x, 0.0), p(x + 5.5, -5.5), p(x + 5.5, 5.5)], color);
                }
            }
            Self::Reset => {
                arc(painter, at, 5.5, -0.15 * PI, 1.35 * PI, stroke);
                head(painter, at + 5.5 * Vec2::angled(-0.15 * PI), -0.15 * PI - FRAC_PI_2, color);
            }
            Self::Undo | Self::Redo => turn_arrow(painter, at, self == Self::Undo, stroke),
            Self::Whole => {
                for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                    painter.line(vec![p(2.5 * x, 5.5 * y), p(6.5 * x, 5.5 * y), p(6.5 * x, 2.0 * y)], stroke);
                }
            }
            Self::Sun => sun(painter, at, stroke),
            Self::Moon => moon(painter, at, stroke),
            Self::Help => {
                arc(painter, p(0.0, -3.0), 3.3, -PI, 0.35 * PI, stroke);
                painter.line_segment([p(1.5, -0.1), p(0.0, 2.6)], stroke);
                painter.circle_filled(p(0.0, 5.8), 1.2, color);
            }
            Self::Left | Self::Right => {
                let corners = [p(-7.0, -5.5), p(7.0, -5.5), p(7.0, 5.5), p(-7.0, 5.5), p(-7.0, -5.5)];
                painter.line(corners.to_vec(), stroke);
                let x = if self == Self::Left { -7.0 } else { 2.0 };
                fill(painter, vec![p(x, -5.5), p(x + 5.0, -5.5), p(x + 5.0, 5.5), p(x, 5.5)], color);
            }
            Self::Camera => {
                let corners = [p(-7.0, -3.5), p(3.0, -3.5), p(3.0, 4.5), p(-7.0, 4.5), p(-7.0, -3.5)];
                painter.line(corners.to_vec(), stroke);
                fill(painter, vec![p(3.5, 0.5), p(7.5, -3.0), p(7.5, 4.0)], color);
                painter.circle_filled(p(-2.0, 0.5), 1.8, color);
            }
            Self::Close => {
                painter.line_segment([p(-4.0, -4.0), p(4.0, 4.0)], stroke);
                painter.line_segment([p(-4.0, 4.0), p(4.0, -4.0)], stroke);
            }
        }
    }
}

fn fill(painter: &Painter, points: Vec<Pos2>, color: Color32) {
    painter.add(Shape::convex_polygon(points, color, Stroke::NONE));
}

/// Draws an arc of a circle. Angles are measured clockwise from the right.
fn arc(painter: &Painter, center: Pos2, radius: f32, from: f32, to: f32, stroke: Stroke) {
    let points = (0..=24).map(|i| center + radius * Vec2::angled(egui::lerp(from..=to, i as f32 / 24.0)));
    painter.line(points.collect(), stroke);
}

/// Draws a small triangle at `tip` that points along `angle`.
fn head(painter: &Painter, tip: Pos2, angle: f32, color: Color32) {
    let (along, across) = (Vec2::angled(angle), Vec2::angled(angle + FRAC_PI_2));
    fill(painter, vec![tip + 3.6 * along, tip - 1.2 * along + 3.4 * across, tip - 1.2 * along - 3.4 * across], color);
}

fn turn_arrow(painter: &Painter, at: Pos2, left: bool, stroke: Stroke) {
    let side = if left { 1.0 } else { -1.0 };
    let p = |x: f32, y: f32| pos2(at.x + side * x, at.y + y);
    let bend = (0..=16).map(|i| {
        let angle = egui::lerp(-FRAC_PI_2..=FRAC_PI_2, i as f32 / 16.0);
        p(2.0 + 3.8 * angle.cos(), 1.2 + 3.8 * angle.sin())
    });
    let line = std::iter::once(p(-4.0, -2.6)).chain(bend).chain([p(-3.0, 5.0)]);
    painter.line(line.collect(), stroke);
    fill(painter, vec![p(-7.0, -2.6), p(-2.6, -6.2), p(-2.6, 1.0)], stroke.color);
}

fn sun(painter: &Painter, at: Pos2, stroke: Stroke) {
    painter.circle_filled(at, 3.4, stroke.color);
    for ray in 0..8 {
        let along = Vec2::angled(TAU * ray as f32 / 8.0);
        painter.line_segment([at + 5.0 * along, at + 7.2 * along], stroke);
    }
}

/// Draws a crescent: a disk minus another disk. It is not convex, so it is a strip of triangles between two arcs.
fn moon(painter: &Painter, at: Pos2, stroke: Stroke) {
    let (shift, outer, inner) = (vec2(3.0, -2.4), 6.4_f32, 5.4_f32);
    let apart = shift.length();
    // Angles at which the circles cross, seen from each centre and measured from the direction of the shift.
    let crossing = (apart * apart + outer * outer - inner * inner) / (2.0 * apart);
    let (from_outer, from_inner) = ((crossing / outer).acos(), ((crossing - apart) / inner).acos());
    let along = |middle: Pos2, radius: f32, first: f32, t: f32| {
        middle + radius * Vec2::angled(shift.angle() + egui::lerp(first..=TAU - first, t))
    };
    let mut mesh = Mesh::default();
    for i in 0..=24 {
        let t = i as f32 / 24.0;
        mesh.colored_vertex(along(at, outer, from_outer, t), stroke.color);
        mesh.colored_vertex(along(at + shift, inner, from_inner, t), stroke.color);
    }
    for i in 0..48 {
        mesh.add_triangle(i, i + 1, i + 2);
    }
    let rim = mesh.vertices.iter().step_by(2).chain(mesh.vertices.iter().skip(1).step_by(2).rev());
    let rim = rim.map(|vertex| vertex.pos).collect();
    painter.add(mesh);
    // The line along the rim smooths the edge, which the triangles alone do not.
    painter.add(Shape::closed_line(rim, Stroke::new(0.6, stroke.color)));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_can_be_typed_with_prefix_and_unit() {
        let cases = [
            ("30k", "Pa", 30e3),
            ("30 kPa", "Pa", 30e3),
            ("2.5e4", "Pa", 25e3),
            ("0.45", "", 0.45),
            ("5 ms", "s", 5e-3),
            ("3 mm", "m", 3e-3),
            ("3 m", "m", 3.0),
            ("100 kg/m3", "kg/m³", 100.0),
            ("2 Mg", "kg", 2000.0),
            ("−9.81", "m/s²", -9.81),
            ("5 /s", "1/s", 5.0),
            ("5 1/s", "1/s", 5.0),
            ("51/s", "1/s", 51.0),
            ("5", "1/s", 5.0),
            ("1/3", "", 1.0 / 3.0),
            ("2*pi", "rad/s", std::f64::consts::TAU),
            ("-(1 + 2^3) / 4", "m", -2.25),
        ];
        for (text, unit, value) in cases {
            let read = parse(text, unit);
            assert!(read.is_some_and(|read| (read - value).abs() <= 1e-12 * value.abs()), "{text}: {read:?}");
        }
        for text in ["soft", "nan", "NaN Pa", "inf", "-infinity", "1e999", "1e300 G", "1/0", "2*x", "(1"] {
            assert_eq!(parse(text, "Pa"), None, "{text}");
        }
    }

    #[test]
    fn what_is_shown_can_be_read_back() {
        for unit in ["", "Pa", "kg", "kg/m³", "m/s²", "N/m", "s", "1/s", "m"] {
            for value in [0.0, 1.23e-5, 0.45, 1.0, 9.81, 30e3, 1.23e9] {
                let read = parse(&numbers::si(value, unit), unit);
                assert!(read.is_some_and(|read| (read - value).abs() <= 6e-3 * value), "{value} {unit}: {read:?}");
            }
        }
    }
}

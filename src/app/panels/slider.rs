//! A slider with a number field for one quantity.

use crate::{app::numbers, quantity::Quantity};
use eframe::egui::{self, DragValue, Slider, SliderClamping, Ui, vec2};
use std::cell::RefCell;

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
    let spec = quantity.spec();
    let help = format!("{}\nAllowed: {}.", spec.help.trim(), spec.range());
    let options = SliderOptions {
        name: spec.name,
        unit: spec.unit,
        range: spec.slider,
        logarithmic: spec.logarithmic,
        help: &help,
    };
    let value = quantity.get();
    number(ui, &options, value, &mut |new| quantity.set(new).map_err(|error| error.to_string()))
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
fn typed(ui: &mut Ui, options: &SliderOptions<'_>, value: f64, outcome: &mut SliderResponse) -> Option<f64> {
    let mut chosen = None;
    let not_a_number = RefCell::new(None);
    ui.horizontal(|ui| {
        let label = ui.label(capitalised(options.name)).on_hover_text(options.help);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let shown = numbers::si(value, options.unit);
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
            .custom_formatter(|value, _| numbers::si(value, options.unit))
            .custom_parser(|text| {
                let number = parse(text, options.unit);
                if number.is_none() {
                    *not_a_number.borrow_mut() = Some(text.trim().to_owned());
                }
                number
            });
            let response = ui.add(widget).labelled_by(label.id);
            outcome.ended |= response.drag_stopped() || response.lost_focus();
            response.on_hover_text(format!("{}\nDrag, or click to type, such as 30k or 2.5e4.", options.help));
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
    let response = ui.add(slider).accessible_name(capitalised(options.name));
    // A key or an assistive tool changes the value without a drag: each change is one gesture.
    outcome.ended |= response.drag_stopped() || (response.changed() && !response.dragged());
    response.on_hover_text(options.help);
    chosen
}

/// Makes the first letter a capital: `young's modulus` becomes `Young's modulus`.
pub fn capitalised(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

/// Parses a number with or without SI prefix and unit: `30k`, `30 kPa`, `2.5e4`.
fn parse(text: &str, unit: &str) -> Option<f64> {
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
        ];
        for (text, unit, value) in cases {
            let read = parse(text, unit);
            assert!(read.is_some_and(|read| (read - value).abs() <= 1e-12 * value.abs()), "{text}: {read:?}");
        }
        for text in ["soft", "nan", "NaN Pa", "inf", "-infinity", "1e999", "1e300 G"] {
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

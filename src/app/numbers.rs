//! Formats numbers with three significant digits, or five where they can be edited, SI prefix and unit.

use crate::quantity::with_unit;

/// SI prefixes, smallest first, with their powers of ten.
const PREFIXES: [(i32, &str); 9] =
    [(-12, "p"), (-9, "n"), (-6, "µ"), (-3, "m"), (0, ""), (3, "k"), (6, "M"), (9, "G"), (12, "T")];

/// Digits of a number that is shown, and of one that can be edited.
const SHOWN: i32 = 3;
const EDITED: i32 = 5;

/// Formats a value with its unit for sentences and labels: `0.21 ms`, `30 kPa`, `1.25 J`. Trailing zeros are omitted.
pub fn si(value: f64, unit: &str) -> String {
    write(value, unit, true, SHOWN)
}

/// Formats a value with its unit for fields in which it is edited: as [`si`], with five digits where it has them.
pub fn si_edited(value: f64, unit: &str) -> String {
    write(value, unit, true, EDITED)
}

/// Formats a value with its unit for numbers that change: always three digits, and the same width in a monospace font for all
/// prefixes and signs.
pub fn si_fixed(value: f64, unit: &str) -> String {
    let text = write(value, unit, false, SHOWN);
    let (number, unit_now) = text.split_once(' ').unwrap_or((&text, ""));
    let slot = if unit.is_empty() { 0 } else { unit.chars().count() + usize::from(takes_prefix(unit)) };
    let gap = if unit.is_empty() { "" } else { " " };
    format!("{number:>6}{gap}{unit_now:<slot$}")
}

/// Divisor and unit with the prefix that suits a value, for rows of numbers that share one unit.
pub fn unit_for(value: f64, unit: &str) -> (f64, String) {
    let (power, prefix) = prefix(leading(value.abs(), SHOWN).1, unit);
    (10_f64.powi(power), format!("{prefix}{unit}"))
}

fn write(value: f64, unit: &str, trim: bool, count: i32) -> String {
    if value.is_nan() {
        return "no number".to_owned();
    }
    if value.is_infinite() {
        return with_unit(if value > 0.0 { "∞" } else { "−∞" }, "", unit);
    }
    let (digits, exponent) = leading(value.abs(), count);
    let sign = if value < 0.0 && digits > 0 { "−" } else { "" };
    let (power, prefix) = prefix(exponent, unit);
    let place = exponent - power;
    let number = if (-4..=5).contains(&place) {
        decimal(digits, place, count, trim)
    } else {
        format!("{}e{place}", decimal(digits, 0, count, trim))
    };
    with_unit(&format!("{sign}{number}"), prefix, unit)
}

/// Zero for a value that is at most its round-off, else the value.
pub fn or_zero(value: f64, round_off: f64) -> f64 {
    if value.abs() <= round_off { 0.0 } else { value }
}

/// The first `count` digits of a value, and its exponent, rounded once: three digits form a number from 100 to 999, or 0, and the value is
/// `d.dd * 10^exponent`.
fn leading(value: f64, count: i32) -> (u32, i32) {
    let text = format!("{value:.0$e}", (count - 1) as usize);
    let (mantissa, exponent) = text.split_once('e').unwrap_or(("0", "0"));
    let digits = mantissa.chars().filter(char::is_ascii_digit).filter_map(|digit| digit.to_digit(10));
    (digits.fold(0, |sum, digit| 10 * sum + digit), exponent.parse().unwrap_or(0))
}

/// Formats `digits`, of which there are `count`, times 10^(place + 1 - count).
fn decimal(digits: u32, place: i32, count: i32, trim: bool) -> String {
    let decimals = (count - 1 - place).max(0) as usize;
    let text = format!("{:.decimals$}", f64::from(digits) * 10_f64.powi(place + 1 - count));
    if trim && text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Whether a prefix of the unit is valid: not for squares, angles, counts and kilograms.
fn takes_prefix(unit: &str) -> bool {
    let first = unit.split('/').next().unwrap_or(unit);
    matches!(first, "s" | "m" | "N" | "J" | "Pa" | "W" | "Hz")
}

/// Power of ten and prefix that give a number from 1 to 999. Times and lengths begin at 0.1, as in `0.21 ms`, and spring stiffness
/// has no prefix from 0.1 to 999. Velocities and accelerations have none from 0.001 to 999 999.
fn prefix(exponent: i32, unit: &str) -> (i32, &'static str) {
    if !takes_prefix(unit) {
        return (0, "");
    }
    if matches!(unit, "m/s" | "m/s²") && (-3..=5).contains(&exponent) {
        return (0, "");
    }
    if unit == "N/m" && exponent == -1 {
        return (0, "");
    }
    let early = i32::from(matches!(unit, "s" | "m"));
    let power = (exponent + early).div_euclid(3) * 3;
    let power = if unit == "s" { power.min(0) } else { power }.clamp(-12, 12);
    PREFIXES.into_iter().find(|&(of, _)| of == power).unwrap_or((0, ""))
}

#[cfg(test)]
mod tests {
    use super::{or_zero, si, si_edited, si_fixed, unit_for};

    #[test]
    fn reads_like_prose() {
        for (value, unit, text) in [
            (0.000_21, "s", "0.21 ms"),
            (0.000_166_67, "s", "0.167 ms"),
            (30_000.0, "Pa", "30 kPa"),
            (1.25, "J", "1.25 J"),
            (-9.81, "m/s²", "−9.81 m/s²"),
            (999.9, "N", "1 kN"),
            (0.0, "N", "0 N"),
            (0.1185, "m", "0.118 m"),
            (0.01, "m", "10 mm"),
            (1000.0, "kg/m³", "1000 kg/m³"),
            (0.58, "", "0.58"),
            (1.0e-7, "", "1e-7"),
            (45.0, "°", "45°"),
            (100_000.0, "s", "100000 s"),
            (0.4, "m/s²", "0.4 m/s²"),
            (0.02, "m/s²", "0.02 m/s²"),
            (-1500.0, "m/s²", "−1500 m/s²"),
            (5e-6, "m/s²", "5 µm/s²"),
            (0.25, "m/s", "0.25 m/s"),
            (0.5, "N/m", "0.5 N/m"),
            (100.0, "N/m", "100 N/m"),
            (3000.0, "N/m", "3 kN/m"),
            (1.0, "1/s", "1 /s"),
            (f64::INFINITY, "J", "∞ J"),
            (f64::NAN, "J", "no number"),
        ] {
            assert_eq!(si(value, unit), text, "{value:e} {unit}");
        }
    }

    #[test]
    fn edited_numbers_keep_more_digits() {
        for (value, unit, text) in [
            (0.4999, "", "0.4999"),
            (0.3, "", "0.3"),
            (1.0 / 9.0, "", "0.11111"),
            (317_460.3, "Pa", "317.46 kPa"),
            (30_000.0, "Pa", "30 kPa"),
            (0.031, "m", "31 mm"),
            (1234.5, "kg/m³", "1234.5 kg/m³"),
            (999_999.0, "N", "1 MN"),
            (-9.80665, "m/s²", "−9.8066 m/s²"),
            (1.234_56e-7, "", "1.2346e-7"),
            (0.0, "N", "0 N"),
        ] {
            assert_eq!(si_edited(value, unit), text, "{value:e} {unit}");
        }
    }

    #[test]
    fn round_off_reads_as_zero() {
        assert_eq!(si(or_zero(7.4e-14, 1e-9), "Pa"), "0 Pa");
        assert_eq!(si(or_zero(-7.4e-8, 1e-9), "Pa"), "−74 nPa");
    }

    #[test]
    fn shares_a_unit() {
        assert_eq!(unit_for(2000.0, "J/m²"), (1000.0, "kJ/m²".to_owned()));
        assert_eq!(unit_for(2000.0, ""), (1.0, String::new()));
    }

    #[test]
    fn runs_without_jitter() {
        let width = si_fixed(1.0, "J").chars().count();
        for value in [0.0, -1.0, 12.345, -123.456, 0.001, 9999.0, 1.0e6, -1.0e-9] {
            assert_eq!(si_fixed(value, "J").chars().count(), width, "{}", si_fixed(value, "J"));
        }
        assert_eq!(si_fixed(1.0, "J"), "  1.00 J ");
        assert_eq!(si_fixed(0.5, ""), " 0.500");
    }
}

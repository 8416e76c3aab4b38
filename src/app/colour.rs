//! Colour maps of fields and their ranges.

use crate::{
    app::numbers::or_zero,
    snapshot::{Field, Snapshot},
};
use eframe::egui::Color32;
use std::sync::LazyLock;

/// Number of colours in a map.
const COLORS: usize = 256;

/// Time for which values must be small before the range shrinks \[s\].
const SHRINK_DELAY: f32 = 1.5;

/// Time constant of the change of the shown range \[s\].
const EASE: f32 = 0.12;

/// Share of the triangles above the upper end of the range, so that a few outliers do not determine it.
const OUTLIERS: f64 = 0.03;

static VIRIDIS: LazyLock<[Color32; COLORS]> = LazyLock::new(|| sampled(colorous::VIRIDIS, false));

/// Red for compression, blue for extension, pale at rest; the other way round for pressure.
static RED_BLUE: LazyLock<[Color32; COLORS]> = LazyLock::new(|| sampled(colorous::RED_BLUE, false));

fn sampled(gradient: colorous::Gradient, reversed: bool) -> [Color32; COLORS] {
    std::array::from_fn(|i| {
        let color = gradient.eval_rational(if reversed { COLORS - 1 - i } else { i }, COLORS);
        Color32::from_rgb(color.r, color.g, color.b)
    })
}

/// Colour scale of a field: a map and its range.
#[derive(Debug, Default)]
pub struct Scale {
    field: Field,
    generation: Option<u64>,
    /// Target of the range: a round number.
    goal: f64,
    /// Present range.
    high: f64,
    /// Time for which a smaller range would have sufficed \[s\], and the largest value in this time.
    below_time: f32,
    below_high: f64,
    sorted: Vec<f64>,
    /// Typical largest value of this scale, and of another scale that shares the range.
    typical: f64,
    heeded: f64,
}

impl Scale {
    /// Updates the range from the values of a frame of `dt` seconds, unless it is held. The range grows without delay and shrinks after
    /// `SHRINK_DELAY`.
    pub fn follow(&mut self, snapshot: &Snapshot, dt: f32, held: Option<f64>) {
        self.typical = self.typical_high(snapshot);
        if let Some(end) = held {
            (self.field, self.generation) = (snapshot.field, Some(snapshot.generation));
            (self.goal, self.high, self.below_time) = (end, end, 0.0);
            return;
        }
        let wanted = round_up(self.typical.max(self.heeded).max(floor(snapshot)));
        if self.field != snapshot.field || self.generation != Some(snapshot.generation) {
            (self.field, self.generation) = (snapshot.field, Some(snapshot.generation));
            (self.goal, self.high, self.below_time) = (wanted, wanted, 0.0);
            return;
        }
        if wanted > self.goal {
            self.goal = wanted;
        }
        if wanted < 0.45 * self.goal {
            self.below_high = if self.below_time > 0.0 { self.below_high.max(wanted) } else { wanted };
            self.below_time += dt;
        } else {
            self.below_time = 0.0;
        }
        if self.below_time > SHRINK_DELAY {
            (self.goal, self.below_time) = (self.below_high, 0.0);
        }
        let step = f64::from(1.0 - (-dt / EASE).exp());
        self.high *= (step * (self.goal / self.high).ln()).exp();
        if (self.high / self.goal - 1.0).abs() < 1e-3 {
            self.high = self.goal;
        }
    }

    /// Includes the values of another scale in the range, or no longer.
    pub fn heed(&mut self, other: Option<&Self>) {
        self.heeded = other.map_or(0.0, |other| other.typical);
    }

    /// Whether the range is changing.
    pub fn is_moving(&self) -> bool {
        self.field != Field::None && (self.high != self.goal || self.below_time > 0.0)
    }

    /// Distance of the ends from the value at rest.
    pub const fn end(&self) -> f64 {
        self.goal
    }

    /// Values at the two ends of the map.
    pub fn range(&self) -> [f64; 2] {
        match self.field {
            field if field.is_signed() => [field.rest() - self.high, field.rest() + self.high],
            _ => [0.0, self.high],
        }
    }

    /// Colours of values.
    pub fn colors(&self, values: &[f64]) -> impl Iterator<Item = Color32> {
        let ([low, high], map, rooted) = (self.range(), self.map(), self.field == Field::EnergyDensity);
        values.iter().map(move |value| picked(map, share_of(*value, [low, high], rooted)))
    }

    /// Position of a value on the map, from 0 to 1 within the range. Energy grows with the square of strain, so the map uses its square
    /// root, which distributes the colours evenly.
    pub fn share(&self, value: f64) -> f32 {
        share_of(value, self.range(), self.field == Field::EnergyDensity)
    }

    /// Colour at a position of the map from 0 to 1.
    pub fn at(&self, share: f32) -> Color32 {
        picked(self.map(), share)
    }

    fn map(&self) -> &'static [Color32; COLORS] {
        if self.field.is_signed() { &RED_BLUE } else { &VIRIDIS }
    }

    /// Value, or distance from rest, that all triangles but the outliers stay below.
    fn typical_high(&mut self, snapshot: &Snapshot) -> f64 {
        let rest = snapshot.field.rest();
        self.sorted.clear();
        self.sorted.extend(snapshot.values.iter().map(|value| (value - rest).abs()).filter(|size| size.is_finite()));
        let Some(last) = self.sorted.len().checked_sub(1) else { return 0.0 };
        let place = last - (last as f64 * OUTLIERS) as usize;
        let (_, high, _) = self.sorted.select_nth_unstable_by(place, f64::total_cmp);
        // The range of a ratio ends at 0 and 2; values beyond have the colours of the ends.
        if snapshot.field.rest() == 1.0 { high.min(1.0) } else { *high }
    }
}

/// Relative position of a value between two ends, or its square root.
fn share_of(value: f64, [low, high]: [f64; 2], rooted: bool) -> f32 {
    let share = (value - low) / (high - low);
    (if rooted { share.max(0.0).sqrt() } else { share }) as f32
}

/// Colour at a position of a map.
fn picked(map: &[Color32; COLORS], share: f32) -> Color32 {
    map[((share * COLORS as f32) as usize).min(COLORS - 1)]
}

/// Greatest Young's modulus of the scene \[Pa\].
fn stiffest(snapshot: &Snapshot) -> f64 {
    let bodies = snapshot.level.bodies.iter().map(|body| &body.material);
    let all = bodies.chain(snapshot.level.membranes.iter().map(|membrane| &membrane.material));
    all.map(|material| material.young().get()).fold(0.0, f64::max)
}

/// Smallest range: about a thousandth of strain, so that round-off at rest is not visible.
fn floor(snapshot: &Snapshot) -> f64 {
    let young = stiffest(snapshot).max(1e-9);
    match snapshot.field {
        Field::EnergyDensity => 1e-6 * young,
        Field::VonMises | Field::PrincipalStress | Field::Pressure => 1e-3 * young,
        Field::None | Field::Volume | Field::Stretch | Field::StressError => 0.01,
        Field::Speed | Field::Displacement => 1e-3,
    }
}

/// Value of the field for a label: zero if it is at most round-off of stresses at a strain of one.
pub fn reading(snapshot: &Snapshot, value: f64) -> f64 {
    let young = stiffest(snapshot);
    match snapshot.field {
        Field::EnergyDensity | Field::VonMises | Field::PrincipalStress | Field::Pressure => {
            or_zero(value, 1e-12 * young)
        }
        _ => value,
    }
}

/// Rounds up to 1, 2, 5, 10, 20, 50, ...
fn round_up(value: f64) -> f64 {
    let decade = 10_f64.powf(value.log10().floor());
    let factor = [1.0, 2.0, 5.0].into_iter().find(|factor| value <= factor * decade * 1.000_001).unwrap_or(10.0);
    factor * decade
}

/// Round values from `low` to `high`, both included if they are round: at most six intervals.
pub fn ticks([low, high]: [f64; 2]) -> impl Iterator<Item = f64> {
    let step = round_up((high - low) / 6.0).max(f64::MIN_POSITIVE);
    let (first, last) = ((low / step - 1e-6).ceil() as i64, (high / step + 1e-6).floor() as i64);
    (first..=last).map(move |i| i as f64 * step)
}

#[cfg(test)]
mod tests {
    use super::{Scale, reading, round_up, ticks};
    use crate::snapshot::{Field, Snapshot};

    #[test]
    fn round_off_of_stress_reads_as_zero() {
        let text = crate::levels::built_in("gingerbread").unwrap_or_default();
        let level = crate::files::parse(text, "gingerbread.ron").unwrap_or_default();
        let snapshot = Snapshot { level: level.into(), field: Field::VonMises, ..Snapshot::default() };
        let young = snapshot.level.bodies[0].material.young().get();
        assert_eq!([1e-16 * young, 1e-9 * young].map(|value| reading(&snapshot, value)), [0.0, 1e-9 * young]);
    }

    #[test]
    fn rounds_up() {
        for (value, round) in [(1.0, 1.0), (1.1, 2.0), (30.0, 50.0), (0.07, 0.1), (1e-9, 1e-9)] {
            assert!((round_up(value) / round - 1.0).abs() < 1e-9, "{value}");
        }
        let values: Vec<f64> = ticks([0.0, 50.0]).collect();
        assert_eq!(values, [0.0, 10.0, 20.0, 30.0, 40.0, 50.0]);
    }

    #[test]
    fn grows_at_once_and_shrinks_after_a_while() {
        let mut snapshot = Snapshot { field: Field::VonMises, values: vec![30.0; 9], ..Snapshot::default() };
        let mut scale = Scale::default();
        scale.follow(&snapshot, 0.02, None);
        assert_eq!(scale.range(), [0.0, 50.0]);
        snapshot.values.fill(1.0);
        (0..50).for_each(|_| scale.follow(&snapshot, 0.02, None));
        assert_eq!(scale.range(), [0.0, 50.0], "one second is too early");
        (0..150).for_each(|_| scale.follow(&snapshot, 0.02, None));
        assert_eq!(scale.range(), [0.0, 1.0]);
        assert!(!scale.is_moving());
    }

    #[test]
    fn a_held_range_follows_no_values() {
        let mut snapshot = Snapshot { field: Field::VonMises, values: vec![30.0; 9], ..Snapshot::default() };
        let mut scale = Scale::default();
        for value in [30.0, 1e9, 0.0] {
            snapshot.values.fill(value);
            scale.follow(&snapshot, 0.02, Some(7.0));
            assert_eq!((scale.range(), scale.is_moving()), ([0.0, 7.0], false), "{value}");
        }
        snapshot.field = Field::Volume;
        scale.follow(&snapshot, 0.02, Some(0.25));
        assert_eq!(scale.range(), [0.75, 1.25], "on both sides of the value at rest");
    }
}

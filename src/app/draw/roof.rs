//! Draws the roof of the house.

use super::house::{Baker, Kind, Side, THICKNESS, between, moved};
use eframe::egui::Color32;

/// Overhang of the roof beyond the walls [m].
const EAVES: f64 = 0.055;

/// Distance of scallops [m].
const SCALLOP: f64 = 0.052;

/// Slope of the roof on the inner face, from its lower to its upper end, with its outward direction.
struct Slope {
    low: [f64; 2],
    high: [f64; 2],
    out: [f64; 2],
    /// Whether the upper end is a ridge between two slopes.
    ridge: bool,
}

fn slopes(sides: &[Side]) -> impl Iterator<Item = Slope> {
    let count = sides.len();
    (0..count).filter(|&i| sides[i].kind == Kind::Roof).map(move |i| {
        let (before, here, after) = (&sides[(i + count - 1) % count], &sides[i], &sides[(i + 1) % count]);
        // In counter-clockwise order the right slope ascends and the left one descends.
        let climbs = here.ends[0][1] <= here.ends[1][1];
        let (low, high) = if climbs { (here.ends[0], here.ends[1]) } else { (here.ends[1], here.ends[0]) };
        let next = if climbs { after } else { before };
        Slope { low, high, out: here.out, ridge: next.kind == Kind::Roof }
    })
}

/// Draws all slopes and the decoration on the ridge.
pub fn roof(baker: &mut Baker<'_>, sides: &[Side]) {
    let theme = baker.view.theme;
    let ends: Vec<Slope> = slopes(sides).collect();
    for slope in &ends {
        boards(baker, slope);
    }
    for (color, lower) in [(theme.icing_shade, 0.006), (theme.icing, 0.0)] {
        for slope in &ends {
            blanket(baker, slope, color, lower);
        }
    }
    for slope in &ends {
        gumdrops(baker, slope);
    }
    if let Some(ridge) = ends.iter().find(|slope| slope.ridge) {
        let top = [ridge.high[0], ridge.high[1] + THICKNESS + 0.006];
        baker.disc(top, 0.026, theme.icing);
        baker.button([top[0], top[1] + 0.017], 0.02, theme.candy[0]);
    }
}

impl Slope {
    /// Point along the slope (0 at the wall, 1 at the top), moved outwards by a share of the thickness.
    fn at(&self, along: f64, out: f64) -> [f64; 2] {
        moved(between(self.low, self.high, along), self.out, out * THICKNESS)
    }

    fn length(&self) -> f64 {
        (self.high[0] - self.low[0]).hypot(self.high[1] - self.low[1]).max(1e-9)
    }

    /// Lower end of the roof, as a position along the slope.
    fn eaves(&self) -> f64 {
        -(EAVES + THICKNESS) / self.length()
    }

    /// Upper end at a share of the thickness: the slopes meet above the ridge.
    fn top(&self, out: f64) -> [f64; 2] {
        if self.ridge {
            [self.high[0], self.high[1] + out * THICKNESS / self.out[1].max(0.3)]
        } else {
            self.at(1.0, out)
        }
    }
}

/// Draws the dough.
fn boards(baker: &mut Baker<'_>, slope: &Slope) {
    let theme = baker.view.theme;
    baker.area(
        &[slope.at(slope.eaves(), 0.0), slope.at(slope.eaves(), 1.0), slope.top(1.0), slope.top(0.0)],
        theme.wall,
    );
    baker.line(&[slope.at(slope.eaves(), 0.06), slope.top(0.06)], 0.006, theme.wall_shade);
}

/// Draws the icing on top, with scallops of uneven length; `wider` extends it on all sides for its rim [m].
fn blanket(baker: &mut Baker<'_>, slope: &Slope, icing: Color32, wider: f32) {
    let low = slope.eaves() - 0.004;
    baker.line(&[slope.at(low, 1.05), slope.top(1.05)], 0.03 + wider, icing);
    let count = ((1.0 - low) * slope.length() / SCALLOP).round().max(1.0);
    for i in 0..=count as usize {
        let along = low + (1.0 - low) * i as f64 / count;
        let (radius, drop) = if i % 2 == 0 { (0.019, 0.82) } else { (0.0165, 0.92) };
        if along < 1.0 - 0.02 / slope.length() {
            baker.disc(slope.at(along, drop), radius + 0.5 * wider, icing);
        }
    }
}

/// Draws candy in the icing.
fn gumdrops(baker: &mut Baker<'_>, slope: &Slope) {
    let candy = baker.view.theme.candy;
    let low = slope.eaves();
    let count = ((1.0 - low) * slope.length() / (2.0 * SCALLOP)).floor().max(1.0);
    for i in 0..count as usize {
        let along = low + (1.0 - low) * (i as f64 + 0.35) / count;
        baker.button(slope.at(along, 1.12), 0.0095, candy[i % 2]);
    }
}

/// Draws a chimney on the right slope, behind the roof.
pub fn chimney(baker: &mut Baker<'_>, sides: &[Side]) {
    let theme = baker.view.theme;
    let Some(slope) = slopes(sides).find(|slope| slope.ridge && slope.out[0] > 0.2) else { return };
    let [x, y] = slope.at(0.45, 1.0);
    let (half, top) = (0.042, y + 0.12);
    baker.area(&[[x - half, y - 0.08], [x + half, y - 0.08], [x + half, top], [x - half, top]], theme.wall);
    baker.area(
        &[[x + 0.4 * half, y - 0.08], [x + half, y - 0.08], [x + half, top], [x + 0.4 * half, top]],
        theme.wall_shade,
    );
    for (color, wider) in [(theme.icing_shade, 0.0045), (theme.icing, 0.0)] {
        baker.line(&[[x - half, top], [x + half, top]], 0.026 + wider, color);
        for (at, drop) in [(-0.7, 0.014), (0.0, 0.022), (0.75, 0.012)] {
            baker.disc([x + at * half, top - drop], 0.012 + 0.5 * wider, color);
        }
    }
}

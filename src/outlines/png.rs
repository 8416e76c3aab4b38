//! Outlines of the dark areas of a picture.
//!
//! The lines are those of equal brightness halfway between black and white, by marching squares (Lorensen and Cline, *Marching Cubes*, 1987, in the plane): smooth edges
//! of areas are found more exactly than to a pixel.

use super::{FillRule, OutlineError, Shape, shapes, signed_area};
use crate::picture::Picture;
use std::collections::BTreeMap;

/// Length of a pixel \[m\].
const PIXEL: f64 = 1e-3;

/// Most pixels along a side.
const MOST_PIXELS: u32 = 4096;

/// Most sides between pixels that lines may cross: noise has more.
const MOST_SIDES: usize = 2_000_000;

/// Least area that is not taken for noise [pixels].
const LEAST_AREA: f64 = 6.0;

/// Greatest distance of a line from the one that is found [pixels].
const SMOOTHING: f64 = 0.35;

/// Darkness of pixels, 0 for white and 1 for black, with a border of one pixel that belongs to the ground.
struct Darkness {
    width: usize,
    height: usize,
    values: Vec<f64>,
}

/// Reads a picture. What is transparent is white. Where most of the border is dark, light areas are taken instead.
pub(super) fn read(bytes: &[u8]) -> Result<Vec<Shape>, OutlineError> {
    let darkness = darkness(bytes)?;
    let loops = contours(&darkness)?;
    let is_large = |points: &Vec<[f64; 2]>| signed_area(points).abs() >= LEAST_AREA;
    let loops: Vec<_> = loops.into_iter().filter(is_large).map(|points| in_metres(&points, darkness.height)).collect();
    shapes(&loops.into_iter().filter(|points| points.len() > 2).collect::<Vec<_>>(), FillRule::EvenOdd)
}

fn in_metres(points: &[[f64; 2]], height: usize) -> Vec<[f64; 2]> {
    let points = crate::meshes::simplified(points, SMOOTHING);
    points.iter().map(|[x, y]| [PIXEL * x, PIXEL * (height as f64 - y)]).collect()
}

fn darkness(bytes: &[u8]) -> Result<Darkness, OutlineError> {
    let picture = Picture::of_png(bytes, MOST_PIXELS).map_err(OutlineError::Broken)?;
    let [columns, rows] = picture.size;
    let dark = |pixel: &[u8; 4]| {
        let [red, green, blue, alpha] = pixel.map(f64::from);
        (1.0 - (0.299 * red + 0.587 * green + 0.114 * blue) / 255.0) * alpha / 255.0
    };
    let values: Vec<f64> = picture.rgba.as_chunks().0.iter().map(dark).collect();
    let on_border = |number: &usize| {
        let (column, row) = (number % columns, number / columns);
        column == 0 || row == 0 || column + 1 == columns || row + 1 == rows
    };
    let border: Vec<f64> = (0..values.len()).filter(on_border).map(|number| values[number]).collect();
    let is_dark_ground = 2 * border.iter().filter(|dark| **dark > 0.5).count() > border.len();
    let (width, height) = (columns + 2, rows + 2);
    let mut padded = vec![0.0; width * height];
    for (number, dark) in values.into_iter().enumerate() {
        padded[width * (number / columns + 1) + number % columns + 1] = if is_dark_ground { 1.0 - dark } else { dark };
    }
    Ok(Darkness { width, height, values: padded })
}

/// A side between two neighbouring pixels that a line crosses: the number of the first one, and whether the other one is below it rather than beside it.
type Side = (usize, bool);

/// Closed lines of equal darkness [pixels], with the dark side on their right as y points down.
fn contours(darkness: &Darkness) -> Result<Vec<Vec<[f64; 2]>>, OutlineError> {
    let Darkness { width, height, values } = darkness;
    // From the side by which a line enters a square of four pixels to that by which it leaves.
    let mut next: BTreeMap<Side, Side> = BTreeMap::new();
    let mut starts = Vec::new();
    for row in 0..height - 1 {
        if starts.len() > MOST_SIDES {
            return Err(OutlineError::TooLong);
        }
        for column in 0..width - 1 {
            let at = width * row + column;
            let corners = [at, at + 1, at + width + 1, at + width].map(|pixel| values[pixel] > 0.5);
            let sides = [(at, false), (at + 1, true), (at + width, false), (at, true)];
            // Sides in clockwise order; one from light to dark is where a line enters, one from dark to light where it leaves.
            let entering: Vec<usize> = (0..4).filter(|side| !corners[*side] && corners[(side + 1) % 4]).collect();
            let leaving = |from: usize| {
                (1..4).map(|turn| (from + turn) % 4).find(|side| corners[*side] && !corners[(side + 1) % 4])
            };
            for side in entering {
                if let Some(to) = leaving(side) {
                    next.insert(sides[side], sides[to]);
                    starts.push(sides[side]);
                }
            }
        }
    }
    let place = |(pixel, below): Side| {
        let other = if below { pixel + width } else { pixel + 1 };
        let share = (0.5 - values[pixel]) / (values[other] - values[pixel]);
        let (x, y) = ((pixel % width) as f64, (pixel / width) as f64);
        if below { [x, y + share] } else { [x + share, y] }
    };
    let mut lines = Vec::new();
    for start in starts {
        let (mut line, mut side) = (Vec::new(), start);
        while let Some(to) = next.remove(&side) {
            line.push(place(side));
            side = to;
        }
        if !line.is_empty() {
            lines.push(line);
        }
    }
    Ok(lines)
}

//! Limits the area that is filled in a frame.

use eframe::egui::{Pos2, Rect};

/// Maximum area that bodies and nets fill in a frame, relative to the area of the stage.
const MOST: f32 = 4.0;

/// Level of detail of a body or net.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// Everything.
    Full,
    /// The outline alone.
    Outline,
    /// A point for each vertex.
    Points,
}

/// Remaining area that can be filled in a frame.
pub struct Fill {
    stage: Rect,
    left: f32,
}

impl Fill {
    /// The area for a whole frame.
    pub fn new(stage: Rect) -> Self {
        Self { stage, left: MOST * stage.area() }
    }

    /// Returns the first detail whose area fits into the remaining area, and subtracts it. Points always fit.
    pub fn choose(&mut self, areas: [f32; 2]) -> Detail {
        for (detail, area) in [Detail::Full, Detail::Outline].into_iter().zip(areas) {
            if area <= self.left {
                self.left -= area;
                return detail;
            }
        }
        Detail::Points
    }

    /// Upper bound of the area of triangles on the stage [square points].
    pub fn triangles(&self, points: &[Pos2], triangles: &[[u32; 3]]) -> f32 {
        let area = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|corner| points[corner as usize]);
            let (u, v) = (b - a, c - a);
            let seen = Rect::from_points(&[a, b, c]).intersect(self.stage);
            if seen.is_negative() { 0.0 } else { (0.5 * (u.x * v.y - u.y * v.x)).abs().min(seen.area()) }
        };
        triangles.iter().map(area).sum()
    }

    /// Upper bound of the area of lines of a width on the stage [square points].
    pub fn lines(&self, points: &[Pos2], lines: impl IntoIterator<Item = [u32; 2]>, width: f32) -> f32 {
        let length = |ends: [u32; 2]| {
            let [a, b] = ends.map(|end| points[end as usize]);
            let seen = Rect::from_two_pos(a, b).intersect(self.stage);
            if seen.is_negative() { 0.0 } else { seen.size().length() }
        };
        width * lines.into_iter().map(length).sum::<f32>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{pos2, vec2};

    const STAGE: Rect = Rect::from_min_max(pos2(0.0, 0.0), pos2(100.0, 100.0));

    #[test]
    fn areas_are_clipped_to_the_stage() {
        let fill = Fill::new(STAGE);
        let points = [pos2(10.0, 10.0), pos2(30.0, 10.0), pos2(10.0, 40.0), pos2(1e5, -1e5), pos2(-1e5, 1e5)];
        assert_eq!(fill.triangles(&points, &[[0, 1, 2]]), 300.0);
        assert!(fill.triangles(&points, &[[0, 3, 4]]) <= STAGE.area());
        let aside = points.map(|point| point + vec2(200.0, 0.0));
        assert_eq!(fill.triangles(&aside, &[[0, 1, 2]]), 0.0);
        assert_eq!(fill.lines(&points, [[0, 1]], 2.0), 40.0);
        assert!(fill.lines(&points, [[3, 4]], 2.0) <= 2.0 * STAGE.size().length() + 1e-3);
    }

    #[test]
    fn a_spent_budget_leaves_outlines_and_then_points() {
        let mut fill = Fill::new(STAGE);
        assert_eq!(fill.choose([30_000.0, 100.0]), Detail::Full);
        assert_eq!(fill.choose([30_000.0, 100.0]), Detail::Outline);
        assert_eq!(fill.choose([30_000.0, 20_000.0]), Detail::Points);
    }
}

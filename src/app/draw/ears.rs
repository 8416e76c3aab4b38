//! Ear clipping: cuts a polygon into triangles.

use eframe::egui::Pos2;

/// Calls `triangle` with point numbers of triangles that fill an outline of either direction. An outline that crosses itself
/// is also filled, but not in a defined way.
pub fn cut(outline: &[Pos2], mut triangle: impl FnMut([u32; 3])) {
    let mut left: Vec<u32> = (0..outline.len() as u32).collect();
    let at = |i: u32| outline[i as usize];
    let turned: f32 = (0..outline.len()).map(|i| cross(Pos2::ZERO, outline[i], outline[(i + 1) % outline.len()])).sum();
    let sign = if turned < 0.0 { -1.0 } else { 1.0 };
    let mut start = 0;
    while left.len() > 3 {
        let count = left.len();
        let corner = |i: usize| [left[(i + count - 1) % count], left[i % count], left[(i + 1) % count]];
        let is_ear = |i: usize| {
            let [a, b, c] = corner(i).map(at);
            sign * cross(a, b, c) >= 0.0
                && !left.iter().any(|&p| !corner(i).contains(&p) && is_inside(at(p), [a, b, c], sign))
        };
        let ear = (start..start + count).find(|&i| is_ear(i)).unwrap_or(start);
        triangle(corner(ear));
        left.remove(ear % count);
        // Continuing behind the ear avoids that all triangles share one corner.
        start = ear % count;
    }
    if let [a, b, c] = left[..] {
        triangle([a, b, c]);
    }
}

fn cross(a: Pos2, b: Pos2, c: Pos2) -> f32 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

fn is_inside(point: Pos2, [a, b, c]: [Pos2; 3], sign: f32) -> bool {
    [(a, b), (b, c), (c, a)].into_iter().all(|(from, to)| sign * cross(from, to, point) > 0.0)
}

#[cfg(test)]
mod tests {
    use super::{cross, cut};
    use eframe::egui::pos2;

    #[test]
    fn fills_an_arrow_head() {
        let outline = [pos2(0.0, 0.0), pos2(2.0, 3.0), pos2(4.0, 0.0), pos2(2.0, 1.0)];
        let mut area = 0.0;
        cut(&outline, |corners| {
            let [a, b, c] = corners.map(|i| outline[i as usize]);
            area += 0.5 * cross(a, b, c).abs();
        });
        assert!((area - 4.0).abs() < 1e-6, "{area}");
    }
}

//! Plane polygons: crossings, containment, triangulation and simplification.

use super::mesh::{area, bounds, squared_distance, squared_distance_to_side};

/// Greatest number of corners for [`cut`], whose time may grow with their cube.
const MOST_CORNERS: usize = 200;

/// Sides of a polygon: pairs of neighbours, the last with the first.
pub(super) fn sides(corners: &[[f64; 2]]) -> impl Iterator<Item = [[f64; 2]; 2]> + Clone {
    corners.iter().zip(corners.iter().cycle().skip(1)).map(|(&from, &to)| [from, to])
}

/// Numbers of the corners that remain after merging.
/// A corner is left out if it is nearer than `near` \[m\] to the one kept before it, or to the first.
pub(crate) fn merged(corners: &[[f64; 2]], near: f64) -> Vec<usize> {
    let apart = |a: usize, b: usize| squared_distance(corners[a], corners[b]) > near * near;
    let mut kept: Vec<usize> = Vec::new();
    for corner in 0..corners.len() {
        if kept.last().is_none_or(|&last| apart(last, corner)) {
            kept.push(corner);
        }
    }
    while kept.len() > 1 && !apart(kept[0], kept[kept.len() - 1]) {
        kept.pop();
    }
    kept
}

/// Simplified polygon: no removed corner is farther than `tolerance` \[m\] from the remaining sides.
/// Sources: Ramer, "An iterative procedure for the polygonal approximation of plane curves", 1972; Douglas and
/// Peucker, 1973. If sides cross, the tolerance is halved until they do not.
pub(crate) fn simplified(corners: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let mut tolerance = tolerance;
    for _ in 0..MOST_HALVINGS {
        let kept = within(corners, tolerance);
        if kept.len() >= 3 && crossing(&kept).is_none() {
            return kept;
        }
        tolerance *= 0.5;
    }
    corners.to_vec()
}

/// Greatest number of halvings of a tolerance.
const MOST_HALVINGS: usize = 20;

/// One round of [`simplified`]: starts with two corners that are far apart, and splits every run at its farthest
/// corner.
fn within(corners: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let count = corners.len();
    let at = |corner: usize| corners[corner % count];
    let farthest = |from: [f64; 2]| {
        let square = |corner: &usize| squared_distance(from, corners[*corner]);
        (0..count).max_by(|a, b| square(a).total_cmp(&square(b))).unwrap_or(0)
    };
    let first = farthest(at(0));
    let second = farthest(at(first));
    let (first, second) = (first.min(second), first.max(second));
    let mut keep = vec![false; count];
    (keep[first], keep[second]) = (true, true);
    let mut runs = vec![[first, second], [second, first + count]];
    while let Some([from, to]) = runs.pop() {
        let square = |corner: &usize| squared_distance_to_side(at(from), at(to), at(*corner));
        let worst = (from + 1..to).max_by(|a, b| square(a).total_cmp(&square(b)));
        if let Some(worst) = worst.filter(|worst| square(worst) > tolerance * tolerance) {
            keep[worst % count] = true;
            runs.extend([[from, worst], [worst, to]]);
        }
    }
    corners.iter().zip(keep).filter(|(_, keep)| *keep).map(|(corner, _)| *corner).collect()
}

/// Signed area of a polygon \[m²\], positive counter-clockwise.
pub(crate) fn signed_area(corners: &[[f64; 2]]) -> f64 {
    let origin = corners.first().copied().unwrap_or_default();
    sides(corners).map(|[from, to]| area([origin, from, to])).sum()
}

/// Length of the boundary \[m\].
pub(super) fn perimeter(corners: &[[f64; 2]]) -> f64 {
    sides(corners).map(|[from, to]| squared_distance(from, to).sqrt()).sum()
}

/// Two sides, by their first corners, that meet without being neighbours, or that fold back onto each other.
pub(super) fn crossing(corners: &[[f64; 2]]) -> Option<(usize, usize)> {
    crossing_of_loops(&[corners])
}

/// The same for the sides of several polygons, whose corners are counted through.
pub(super) fn crossing_of_loops(loops: &[&[[f64; 2]]]) -> Option<(usize, usize)> {
    let sides: Vec<_> = loops.iter().flat_map(|corners| sides(corners)).collect();
    // The side after each one.
    let mut after = Vec::with_capacity(sides.len());
    for corners in loops {
        let (first, count) = (after.len(), corners.len());
        after.extend((1..=count).map(|next| first + next % count));
    }
    let [low, high] = bounds(sides.as_flattened());
    // A sweep along the longer axis meets the fewest sides at a time.
    let axis = usize::from(high[1] - low[1] > high[0] - low[0]);
    let left = |side: usize| sides[side][0][axis].min(sides[side][1][axis]);
    let right = |side: usize| sides[side][0][axis].max(sides[side][1][axis]);
    let mut order: Vec<usize> = (0..sides.len()).collect();
    order.sort_by(|&a, &b| left(a).total_cmp(&left(b)).then(a.cmp(&b)));
    for (index, &a) in order.iter().enumerate() {
        for &b in order[index + 1..].iter().take_while(|&&b| left(b) <= right(a)) {
            let (first, second) = (a.min(b), a.max(b));
            let touching = if after[first] == second {
                folds_back(sides[first][0], sides[first][1], sides[second][1])
            } else if after[second] == first {
                folds_back(sides[second][0], sides[second][1], sides[first][1])
            } else {
                intersect(sides[first], sides[second])
            };
            if touching {
                return Some((first, second));
            }
        }
    }
    None
}

/// Whether a point is within a polygon.
pub(crate) fn contains(corners: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let crosses =
        |[a, b]: &[[f64; 2]; 2]| (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
    sides(corners).filter(crosses).count() % 2 == 1
}

/// Whether the path from `a` over `b` to `c` has a zero side or reverses its direction.
fn folds_back(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> bool {
    let along = (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]);
    a == b || b == c || (area([a, b, c]) == 0.0 && along <= 0.0)
}

/// Whether two segments have a point in common.
fn intersect([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> bool {
    let between = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
        area([p, q, r]) == 0.0 && [0, 1].iter().all(|&k| p[k].min(q[k]) <= r[k] && r[k] <= p[k].max(q[k]))
    };
    let opposite = |p: f64, q: f64| (p > 0.0 && q < 0.0) || (p < 0.0 && q > 0.0);
    (opposite(area([a, b, c]), area([a, b, d])) && opposite(area([c, d, a]), area([c, d, b])))
        || between(a, b, c)
        || between(a, b, d)
        || between(c, d, a)
        || between(c, d, b)
}

/// Triangulates a polygon by cutting off ears. Triangles of corner numbers keep the direction of the corners.
/// `None` if its sides cross, or if it has too many corners.
pub(super) fn cut(corners: &[[f64; 2]]) -> Option<Vec<[usize; 3]>> {
    if corners.len() == 3 {
        return Some(vec![[0, 1, 2]]);
    }
    if corners.len() > MOST_CORNERS || crossing(corners).is_some() {
        return None;
    }
    let sign = if signed_area(corners) < 0.0 { -1.0 } else { 1.0 };
    let mut rest: Vec<usize> = (0..corners.len()).collect();
    let mut triangles = Vec::new();
    while rest.len() > 3 {
        let count = rest.len();
        let ear = (1..=count).find(|&tip| is_ear(corners, &rest, tip % count, sign))? % count;
        triangles.push([rest[(ear + count - 1) % count], rest[ear], rest[(ear + 1) % count]]);
        rest.remove(ear);
    }
    triangles.push([rest[0], rest[1], rest[2]]);
    Some(triangles)
}

/// Whether a corner is convex and its triangle contains no other corner.
fn is_ear(corners: &[[f64; 2]], rest: &[usize], tip: usize, sign: f64) -> bool {
    let count = rest.len();
    let ear = [rest[(tip + count - 1) % count], rest[tip], rest[(tip + 1) % count]];
    let [a, b, c] = ear.map(|corner| corners[corner]);
    let inside = |p: [f64; 2]| [[a, b, p], [b, c, p], [c, a, p]].iter().all(|&triangle| sign * area(triangle) >= 0.0);
    sign * area([a, b, c]) > 0.0 && !rest.iter().any(|&other| !ear.contains(&other) && inside(corners[other]))
}

/// `count` evenly spaced points along a polyline, both ends included; `count >= 2`.
pub(super) fn spaced(line: &[[f64; 2]], count: usize) -> Vec<[f64; 2]> {
    let mut lengths = vec![0.0];
    for pair in line.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + squared_distance(pair[0], pair[1]).sqrt());
    }
    let whole = lengths[lengths.len() - 1];
    let last = line.len() - 1;
    (0..count)
        .map(|index| {
            if index + 1 == count || last == 0 {
                return line[last];
            }
            let target = whole * index as f64 / (count - 1) as f64;
            let next = lengths.partition_point(|&length| length <= target).clamp(1, last);
            let (before, after) = (line[next - 1], line[next]);
            let share = (target - lengths[next - 1]) / (lengths[next] - lengths[next - 1]);
            [before[0] + share * (after[0] - before[0]), before[1] + share * (after[1] - before[1])]
        })
        .collect()
}

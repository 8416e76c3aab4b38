//! Boxes around vertices, in which constraints may be skipped.

/// Least and greatest corner of a box \[m\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds<const D: usize = 2>(pub [[f64; D]; 2]);

/// Enlargement of a box in powers of two of its size: greatest and least exponent.
const POWERS: (i32, i32) = (4, -8);

/// Numbers that are looked at side by side, multiples of two and of three: of few points, and of many with the widest vectors of the processor, which cost some time
/// to set up.
const WIDTHS: [usize; 2] = [12, 24];
const MANY: usize = 512;

/// The box around many flat points. A closure would not be compiled for the widest vectors.
struct Scan<'a, const D: usize>(&'a [f64]);

impl<const D: usize> pulp::WithSimd for Scan<'_, D> {
    type Output = Bounds<D>;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Bounds<D> {
        Bounds::scanned::<{ WIDTHS[1] }>(self.0)
    }
}

/// Widens least and greatest numbers by others, side by side.
#[inline(always)]
fn widen<const WIDTH: usize>([least, greatest]: &mut [[f64; WIDTH]; 2], chunk: &[f64; WIDTH]) {
    for (number, value) in chunk.iter().enumerate() {
        least[number] = if *value < least[number] { *value } else { least[number] };
        greatest[number] = if *value > greatest[number] { *value } else { greatest[number] };
    }
}

impl<const D: usize> Bounds<D> {
    /// Box around flat points.
    pub fn of(values: &[f64]) -> Self {
        if values.len() < MANY {
            Self::scanned::<{ WIDTHS[0] }>(values)
        } else {
            pulp::Arch::new().dispatch(Scan(values))
        }
    }

    #[inline(always)]
    fn scanned<const WIDTH: usize>(values: &[f64]) -> Self {
        let mut ends = [[f64::INFINITY; WIDTH], [f64::NEG_INFINITY; WIDTH]];
        let (chunks, rest) = values.as_chunks();
        for chunk in chunks {
            widen(&mut ends, chunk);
        }
        // The last ones are looked at again, together with the rest.
        match values.last_chunk() {
            Some(last) => widen(&mut ends, last),
            None => rest
                .iter()
                .enumerate()
                .for_each(|(number, value)| (ends[0][number], ends[1][number]) = (*value, *value)),
        }
        let mut bounds = [[f64::INFINITY; D], [f64::NEG_INFINITY; D]];
        for number in 0..WIDTH {
            let [low, high] = bounds.each_mut().map(|corner| &mut corner[number % D]);
            *low = if ends[0][number] < *low { ends[0][number] } else { *low };
            *high = if ends[1][number] > *high { ends[1][number] } else { *high };
        }
        Self(bounds)
    }

    /// Greatest magnitude of a coordinate of its corners.
    pub fn farthest(self) -> f64 {
        self.0.as_flattened().iter().fold(0.0, |most, along| along.abs().max(most))
    }

    /// The box around this one and another.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        let (Self([a, b]), Self([c, d])) = (self, other);
        Self([
            std::array::from_fn(|axis| if c[axis] < a[axis] { c[axis] } else { a[axis] }),
            std::array::from_fn(|axis| if d[axis] > b[axis] { d[axis] } else { b[axis] }),
        ])
    }

    /// The box around the image of this one under a map that keeps straight lines straight.
    #[must_use]
    pub fn mapped(self, map: impl Fn([f64; D]) -> [f64; D]) -> Self {
        let Self(ends) = self;
        let corner = |number: usize| map(std::array::from_fn(|axis| ends[number >> axis & 1][axis]));
        let none = Self([[f64::INFINITY; D], [f64::NEG_INFINITY; D]]);
        (0..1 << D).map(corner).fold(none, |bounds, corner| bounds.with(Self([corner; 2])))
    }

    /// The box with all its sides moved outwards by a length.
    #[must_use]
    pub fn grown(self, by: f64) -> Self {
        let Self([least, greatest]) = self;
        Self([least.map(|along| along - by), greatest.map(|along| along + by)])
    }

    /// Whether it has a point in common with another box.
    pub fn meets(self, Self([other_least, other_greatest]): Self) -> bool {
        let Self([least, greatest]) = self;
        (0..D).all(|axis| least[axis] <= other_greatest[axis] && other_least[axis] <= greatest[axis])
    }
}

impl Bounds {
    /// Box up to a distance from the origin along each axis \[m\].
    pub const fn up_to(distance: f64) -> Self {
        Self([[-distance; 2], [distance; 2]])
    }

    /// Box around the positions of all vertices before and after a step.
    pub fn around(before: &[f64], after: &[f64]) -> Self {
        let (mut least, mut greatest) = ([f64::INFINITY; 4], [f64::NEG_INFINITY; 4]);
        for (a, b) in before.chunks_exact(2).zip(after.chunks_exact(2)) {
            for (axis, value) in [a[0], a[1], b[0], b[1]].into_iter().enumerate() {
                least[axis] = if value < least[axis] { value } else { least[axis] };
                greatest[axis] = if value > greatest[axis] { value } else { greatest[axis] };
            }
        }
        Self([
            [0, 1].map(|axis| f64::min(least[axis], least[axis + 2])),
            [0, 1].map(|axis| f64::max(greatest[axis], greatest[axis + 2])),
        ])
    }

    /// Whether every one of these flat points lies in the box, its sides included.
    pub fn contains(self, x: &[f64]) -> bool {
        // Sums of numbers instead of conditions are vectorised.
        const COUNT: usize = 16;
        let [least, greatest] = self.0.map(|corner| std::array::from_fn::<f64, COUNT, _>(|number| corner[number % 2]));
        let beyond = |x: f64, least: f64, greatest: f64| {
            // NaN fails both comparisons.
            let (low, high) = (if x >= least { 0.0 } else { 1.0 }, if x <= greatest { 0.0 } else { 1.0 });
            low + high
        };
        let (chunks, rest) = x.as_chunks::<COUNT>();
        let outside = pulp::Arch::new().dispatch(|| {
            let mut outside = [0.0; COUNT];
            for chunk in chunks {
                for (number, sum) in outside.iter_mut().enumerate() {
                    *sum += beyond(chunk[number], least[number], greatest[number]);
                }
            }
            outside
        });
        let rest = rest.iter().zip(least.iter().zip(&greatest));
        outside.iter().sum::<f64>() == 0.0
            && rest.map(|(x, (least, greatest))| beyond(*x, *least, *greatest)).sum::<f64>() == 0.0
    }

    /// Length of its longer side, at least the smallest positive number.
    fn size(self) -> f64 {
        let Self([least, greatest]) = self;
        (0..2).map(|axis| greatest[axis] - least[axis]).fold(f64::MIN_POSITIVE, f64::max)
    }

    /// The box with some of its sides (left, bottom, right, top) moved outwards by a length.
    fn with_sides(self, [left, bottom, right, top]: [bool; 4], by: f64) -> Self {
        let Self([least, greatest]) = self;
        let moved = |side: bool| if side { by } else { 0.0 };
        Self([
            [least[0] - moved(left), least[1] - moved(bottom)],
            [greatest[0] + moved(right), greatest[1] + moved(top)],
        ])
    }

    /// The box enlarged as far as it stays clear, by powers of two of the size of the box `inner`.
    #[must_use]
    pub fn enlarged(self, inner: Self, is_clear: impl Fn(Self) -> bool) -> Self {
        let size = inner.size();
        let one = |side: usize| std::array::from_fn(|other| other == side);
        let mut bounds = self;
        for sides in std::iter::once([true; 4]).chain((0..4).map(one)) {
            for power in (POWERS.1..=POWERS.0).rev() {
                let larger = bounds.with_sides(sides, libm::ldexp(size, power));
                if is_clear(larger) {
                    bounds = larger;
                }
            }
        }
        bounds
    }

    /// A box much larger than this one, up to a distance from the origin, so that nothing leaves it soon; its corners are
    /// still exact to a small fraction of this one.
    #[must_use]
    pub fn surroundings(self, limit: f64) -> Self {
        let Self([least, greatest]) = self;
        let size = (0..2).map(|axis| greatest[axis] - least[axis]).fold(0.0, f64::max);
        let outer = self.grown(libm::ldexp(size, 20) + libm::ldexp(self.farthest(), -16));
        Self(outer.0.map(|corner| corner.map(|along| along.clamp(-limit, limit))))
    }

    /// Least distance that a point of this box can move without leaving the outer one, less a fraction for round-off in
    /// many steps.
    pub fn displacement_bound(self, outer: Self) -> f64 {
        let (Self(inner), Self(sides)) = (self, outer);
        let room = [0, 1].map(|axis| (inner[0][axis] - sides[0][axis]).min(sides[1][axis] - inner[1][axis]));
        room[0].min(room[1]) - 1e-6 * outer.farthest()
    }
}

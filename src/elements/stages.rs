//! Sums of corner forces at each vertex, stage by stage.

use super::{Scatter, gather::VertexRun};
use crate::simd::{Indexed16, Pairs, vector};
use pulp::{Arch, Simd, WithSimd};
use std::iter::repeat_n;
use wide::f64x2;

/// The stages that are still to be summed.
pub struct Stages<'a> {
    pub runs: &'a [VertexRun],
    pub vertices: &'a [u32],
    pub indices16: &'a [u16],
    pub indices32: &'a [u32],
    pub stage: u32,
    pub set: Arch,
}

impl<'a> Stages<'a> {
    /// Sums the corner forces of the vertices of the next stage, and scatters them.
    #[inline(always)]
    pub fn add<const N: usize>(&mut self, corners: [&[Pairs]; N], to: &mut impl Scatter<N>) {
        /// A closure might not be inlined and lose the instruction set.
        struct Next<'a, 'b, T, const N: usize>(&'a mut Stages<'b>, [&'a [Pairs]; N], &'a mut T);
        impl<T: Scatter<N>, const N: usize> WithSimd for Next<'_, '_, T, N> {
            type Output = ();

            #[inline(always)]
            fn with_simd<S: Simd>(self, set: S) {
                let Self(stages, corners, to) = self;
                match as_indexed16(&corners) {
                    Some(corners) if stages.indices32.is_empty() => stages.add_next(set, corners, to),
                    _ => stages.add_next(set, corners.map(<[Pairs]>::as_flattened), to),
                }
            }
        }
        self.set.dispatch(Next(self, corners, to));
    }

    #[inline(always)]
    fn add_next<S: Simd, C: Buffer<'a, N>, const N: usize>(&mut self, set: S, corners: C, to: &mut impl Scatter<N>) {
        while let Some((&VertexRun { stage, degree, count, dense }, runs)) = self.runs.split_first()
            && stage == self.stage
        {
            let (now, vertices) = self.vertices.split_at(count as usize);
            (self.runs, self.vertices) = (runs, vertices);
            let places = C::places(self);
            let (of_now, others) = places.split_at((degree * count) as usize);
            *places = others;
            /// One unrolled loop for each of these degrees, without checks; one for all others.
            macro_rules! loops {
                ($($DEGREE:literal)+) => {
                    match degree {
                        $($DEGREE if C::IS_NARROW && dense => {
                            let (fours, rest) = of_now.as_chunks::<$DEGREE>().0.as_chunks();
                            let first = now[0] as usize;
                            to.take_run(set, first, fours.iter().map(|four| sum_at_four(four, corners)), rest.iter().map(|places| sum_at(places, corners)));
                        })+
                        $($DEGREE if C::IS_NARROW => scatter(now, of_now.as_chunks::<$DEGREE>().0.iter().map(|places| sum_at(places, corners)), to),)+
                        0 => scatter(now, repeat_n([f64x2::ZERO; N], now.len()), to),
                        _ => scatter(now, of_now.chunks(degree as usize).map(|places| sum_at(places, corners)), to),
                    }
                };
            }
            loops!(2 3 4 5 6 7 8 12);
        }
        self.stage += 1;
    }
}

/// Corner forces of several stresses.
trait Buffer<'a, const N: usize>: Copy {
    /// Index type of a place.
    type Place: Copy + 'a;

    /// Whether places are 16-bit and need no check.
    const IS_NARROW: bool;

    /// The remaining places.
    fn places<'b>(stages: &'b mut Stages<'a>) -> &'b mut &'a [Self::Place];

    /// Force of a stress at a place.
    fn at(self, stress: usize, place: Self::Place) -> f64x2;
}

impl<'a, const N: usize> Buffer<'a, N> for [&[[f64; 2]]; N] {
    type Place = u32;

    const IS_NARROW: bool = false;

    #[inline(always)]
    fn places<'b>(stages: &'b mut Stages<'a>) -> &'b mut &'a [u32] {
        &mut stages.indices32
    }

    #[inline(always)]
    fn at(self, stress: usize, place: u32) -> f64x2 {
        f64x2::new(self[stress][place as usize / 2])
    }
}

impl<'a, const N: usize> Buffer<'a, N> for [&Indexed16; N] {
    type Place = u16;

    const IS_NARROW: bool = true;

    #[inline(always)]
    fn places<'b>(stages: &'b mut Stages<'a>) -> &'b mut &'a [u16] {
        &mut stages.indices16
    }

    #[inline(always)]
    fn at(self, stress: usize, place: u16) -> f64x2 {
        f64x2::new(vector(self[stress], place))
    }
}

/// The buffers as [`Indexed16`], if they are long enough.
#[inline(always)]
fn as_indexed16<'a, const N: usize>(corners: &[&'a [Pairs]; N]) -> Option<[&'a Indexed16; N]> {
    let indices16 = |corners: &'a [Pairs]| corners.as_flattened().as_flattened().first_chunk();
    let mut all = [indices16(corners.first()?)?; N];
    for (all, corners) in all.iter_mut().zip(corners) {
        *all = indices16(corners)?;
    }
    Some(all)
}

/// The sums over these places.
#[inline(always)]
fn sum_at<'a, C: Buffer<'a, N>, const N: usize>(places: &[C::Place], corners: C) -> [f64x2; N] {
    let mut sums = [f64x2::ZERO; N];
    for &place in places {
        for (stress, sum) in sums.iter_mut().enumerate() {
            *sum += corners.at(stress, place);
        }
    }
    sums
}

/// The sums of four vertices.
#[inline(always)]
fn sum_at_four<'a, C: Buffer<'a, N>, const D: usize, const N: usize>(
    places: &[[C::Place; D]; 4],
    corners: C,
) -> [[f64x2; N]; 4] {
    let [a, b, c, d] = places;
    [sum_at(a, corners), sum_at(b, corners), sum_at(c, corners), sum_at(d, corners)]
}

/// Scatters forces on these vertices.
#[inline(always)]
fn scatter<const N: usize>(vertices: &[u32], forces: impl Iterator<Item = [f64x2; N]>, to: &mut impl Scatter<N>) {
    to.take(vertices.iter().map(|vertex| *vertex as usize).zip(forces));
}

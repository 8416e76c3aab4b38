//! SIMD vectors of eight numbers, their instruction sets, and memory aligned for them.

use super::{Real, Split, logarithm};
use pulp::{Arch, Simd, WithSimd, bytemuck};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Numbers per block in memory: the greatest number of lanes of a vector register.
pub const LANES: usize = 8;

/// Block of numbers.
pub type Lanes = [f64; LANES];

/// Four numbers of each of eight elements, in element order.
pub type Quads = [[f64; 4]; LANES];

/// Vector of each of eight elements, in element order, or at their [`Order::place`] after [`Wide::store_pairs`].
pub type Pairs = [[f64; 2]; LANES];

/// Vector register of the instruction set `S`. Its size is a divisor of [`LANES`].
#[derive(Clone, Copy, Debug)]
pub struct Wide<S: Simd> {
    set: S,
    values: S::f64s,
}

impl<S: Simd> Wide<S> {
    /// Number of registers for [`LANES`] numbers.
    pub const PARTS: usize = LANES / S::F64_LANES;

    /// Loads one register of a block.
    #[inline(always)]
    pub fn load(set: S, from: &Lanes, part: usize) -> Self {
        Self { set, values: S::as_simd_f64s(from).0[part] }
    }

    /// Stores one register of a block.
    #[inline(always)]
    pub fn store(self, to: &mut Lanes, part: usize) {
        S::as_mut_simd_f64s(to).0[part] = self.values;
    }

    /// Loads the first, second, third and fourth numbers of one register of elements; lanes are in [`Order::lane`].
    #[inline(always)]
    pub fn load_quads(set: S, from: &Quads, part: usize) -> [Self; 4] {
        // No `map`: if it is not inlined, it loses the instruction set.
        let [a, b, c, d] = set.deinterleave_shfl_f64s(S::as_simd_f64s(from.as_flattened()).0.as_chunks().0[part]);
        [Self { set, values: a }, Self { set, values: b }, Self { set, values: c }, Self { set, values: d }]
    }

    /// Stores the first, second, third and fourth numbers of one register, those of each element at its
    /// [`Order::quad`].
    #[inline(always)]
    pub fn store_quads(numbers: [Self; 4], to: &mut Quads, part: usize) {
        let [a, b, c, d] = numbers;
        let quads = a.set.interleave_shfl_f64s([a.values, b.values, c.values, d.values]);
        S::as_mut_simd_f64s(to.as_flattened_mut()).0.as_chunks_mut().0[part] = quads;
    }

    /// Loads the x and y of one register of elements; lanes are in the [`Order::lane`] of pairs.
    #[inline(always)]
    pub fn load_pairs(set: S, from: &Pairs, part: usize) -> [Self; 2] {
        let [x, y] = set.deinterleave_shfl_f64s(S::as_simd_f64s(from.as_flattened()).0.as_chunks().0[part]);
        [Self { set, values: x }, Self { set, values: y }]
    }

    /// Stores vectors with these x and y.
    #[inline(always)]
    pub fn store_pairs(x: Self, y: Self, to: &mut Pairs, part: usize) {
        let pairs = x.set.interleave_shfl_f64s([x.values, y.values]);
        S::as_mut_simd_f64s(to.as_flattened_mut()).0.as_chunks_mut().0[part] = pairs;
    }

    /// Register with the same number in every lane.
    #[inline(always)]
    pub fn all(set: S, value: f64) -> Self {
        Self { set, values: set.splat_f64s(value) }
    }
}

impl<S: Simd> Neg for Wide<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { set: self.set, values: self.set.neg_f64s(self.values) }
    }
}

/// An operator between lanes, and between lanes and a constant.
macro_rules! operator {
    ($Trait:ident, $function:ident, $operation:ident) => {
        impl<S: Simd> $Trait for Wide<S> {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                Self { set: self.set, values: self.set.$operation(self.values, other.values) }
            }
        }

        impl<S: Simd> $Trait<f64> for Wide<S> {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: f64) -> Self {
                $Trait::$function(self, Self::all(self.set, other))
            }
        }
    };
}

operator!(Add, add, add_f64s);
operator!(Sub, sub, sub_f64s);
operator!(Mul, mul, mul_f64s);
operator!(Div, div, div_f64s);

impl<S: Simd> Real for Wide<S> {
    #[inline(always)]
    fn of(self, constant: f64) -> Self {
        Self::all(self.set, constant)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self { set: self.set, values: self.set.sqrt_f64s(self.values) }
    }

    #[inline(always)]
    fn if_less(self, than: Self, then: Self, otherwise: Self) -> Self {
        let less = self.set.less_than_f64s(self.values, than.values);
        Self { set: self.set, values: self.set.select_f64s(less, then.values, otherwise.values) }
    }

    #[inline(always)]
    fn all_less(self, than: Self) -> bool {
        let less = self.set.less_than_f64s(self.values, than.values);
        self.set.first_true_m64s(self.set.not_m64s(less)) == S::F64_LANES
    }

    #[inline(always)]
    fn logarithm(self) -> Self {
        logarithm::log(self)
    }

    #[inline(always)]
    fn logarithm_of_normal(self) -> Self {
        logarithm::of_normal(self)
    }

    #[inline(always)]
    fn exponential(mut self) -> Self {
        for bits in numbers(&mut self.values) {
            *bits = libm::exp(f64::from_bits(*bits)).to_bits();
        }
        self
    }
}

impl<S: Simd> Split for Wide<S> {
    #[inline(always)]
    fn split(self) -> (Self, Self) {
        let (mut m, mut k) = (self, self);
        for (m, k) in numbers(&mut m.values).iter_mut().zip(numbers(&mut k.values)) {
            [*m, *k] = logarithm::split(*m);
        }
        (m, k - logarithm::BIAS)
    }
}

/// The bits of each lane.
#[inline(always)]
fn numbers<V: bytemuck::Pod>(values: &mut V) -> &mut [u64] {
    bytemuck::cast_slice_mut(std::slice::from_mut(values))
}

/// Order of eight elements in registers. It depends on the shuffles of the instruction set.
#[derive(Clone, Copy, Debug)]
pub struct Order {
    /// The instruction set.
    pub set: Arch,
    /// Lane of each element after a load.
    pub lane: [usize; LANES],
    /// Place to which [`Wide::store_pairs`] writes its vector.
    pub place: [usize; LANES],
    /// Place to which [`Wide::store_quads`] writes its numbers.
    pub quad: [usize; LANES],
}

impl Order {
    /// Order of an instruction set for elements that [`Wide::load_quads`] reads.
    pub fn new(set: Arch) -> Self {
        Self::found(set, false)
    }

    /// Order of an instruction set for elements that [`Wide::load_pairs`] reads.
    pub fn of_pairs(set: Arch) -> Self {
        Self::found(set, true)
    }

    /// Determines the order by a trial.
    fn found(set: Arch, of_pairs: bool) -> Self {
        struct Try {
            of_pairs: bool,
        }
        impl WithSimd for Try {
            type Output = (Lanes, Pairs, Quads);

            #[inline(always)]
            fn with_simd<S: Simd>(self, set: S) -> Self::Output {
                let all_pairs = std::array::from_fn(|element| [element as f64; 2]);
                let all_quads = std::array::from_fn(|element| [element as f64; 4]);
                let (mut lanes, mut pairs, mut quads) = (Lanes::default(), Pairs::default(), Quads::default());
                for part in 0..Wide::<S>::PARTS {
                    let ([of_pair, _], [of_quad, ..]) =
                        (Wide::load_pairs(set, &all_pairs, part), Wide::load_quads(set, &all_quads, part));
                    let element = if self.of_pairs { of_pair } else { of_quad };
                    element.store(&mut lanes, part);
                    Wide::store_pairs(element, element, &mut pairs, part);
                    Wide::store_quads([element; 4], &mut quads, part);
                }
                (lanes, pairs, quads)
            }
        }
        let (lanes, pairs, quads) = set.dispatch(Try { of_pairs });
        let mut order = Self { set, lane: [0; LANES], place: [0; LANES], quad: [0; LANES] };
        for (at, ((element, [placed, _]), [quad, ..])) in lanes.into_iter().zip(pairs).zip(quads).enumerate() {
            order.lane[element as usize] = at;
            order.place[placed as usize] = at;
            order.quad[quad as usize] = at;
        }
        order
    }
}

/// Instruction sets of this processor, the narrowest first and the best, [`Arch::new`], last. All give the same bits.
pub fn sets() -> Vec<Arch> {
    let mut sets = vec![Arch::Scalar];
    #[cfg(target_arch = "x86_64")]
    {
        sets.extend(pulp::x86::V3::try_new().map(Arch::V3));
        sets.extend(pulp::x86::V4::try_new().map(Arch::V4));
    }
    let best = Arch::new();
    if sets.iter().all(|set| width(*set) != width(best)) {
        sets.push(best);
    }
    sets
}

/// Number of lanes of a vector register.
pub fn width(set: Arch) -> usize {
    struct Count;
    impl WithSimd for Count {
        type Output = usize;
        fn with_simd<S: Simd>(self, _: S) -> usize {
            S::F64_LANES
        }
    }
    set.dispatch(Count)
}

/// Bytes in a cache line.
const LINE: usize = 64;

/// Additional numbers that a buffer for [`lined`] needs.
pub const SPARE: usize = LINE / size_of::<f64>();

/// Part of a buffer from the first aligned number on. A SIMD load then lies in one cache line instead of two.
pub fn lined(values: &mut [f64]) -> &mut [f64] {
    let skip = values.as_ptr().align_offset(LINE).min(SPARE).min(values.len());
    &mut values[skip..]
}

/// Array that 16-bit indices address without a bounds check.
pub type Indexed16 = [f64; INDEXED16];

/// Length of [`Indexed16`]. A vector can begin at the greatest index.
pub const INDEXED16: usize = u16::MAX as usize + 2;

/// Vector at an index.
#[inline(always)]
pub fn vector(numbers: &Indexed16, place: u16) -> [f64; 2] {
    let place = usize::from(place);
    [numbers[place], numbers[place + 1]]
}

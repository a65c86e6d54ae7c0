//! Every operation in lanes equals the scalar one, with the instructions of each level and for any number of lanes.

use proptest::prelude::*;

use super::{F64s, LANES, Mask, Simd, SimdCode, SimdLevel, U64s};

/// The operands of some lanes. The results of all operations on them are compared bit by bit.
#[derive(Clone, Copy, Debug)]
struct Operands<const K: usize> {
    a: [f64; K],
    b: [f64; K],
    m: [u64; K],
    n: [u64; K],
}

/// The bits of a number, with those of [`f64::NAN`] for any NaN, whose sign and payload may vary.
fn bits(number: f64) -> u64 {
    if number.is_nan() { f64::NAN } else { number }.to_bits()
}

impl<const K: usize> Operands<K> {
    /// The results of the operations in one lane, computed without lanes.
    fn expected(self, lane: usize) -> Vec<u64> {
        let Self { a, b, m, n } = self;
        let (a, b, m, n) = (a[lane], b[lane], m[lane], n[lane]);
        let (less, below) = (a < b, m < n);
        let floats = [a + b, a - b, a * b, a / b, if a > b { a } else { b }, -a, a.abs(), if a < b { a } else { b }];
        let clipped = if 1.0 > a { 1.0 } else { a };
        let clipped = if 2.0 < clipped { 2.0 } else { clipped };
        let single = f64::from(a as f32 - 0.1);
        let lower = (m & 0xffff_ffff) * (n & 0xffff_ffff);
        let truths = [less, a <= b, a == b, a >= b, a > b, below, m == n, !less, less != below, less || below];
        let integers = [
            m.wrapping_add(n),
            m.wrapping_sub(n),
            m.wrapping_mul(n),
            lower,
            m & n,
            m | n,
            m ^ n,
            m << 7,
            m >> 58,
            m.rotate_right((n >> 58) as u32),
            m.wrapping_add(5),
            a.to_bits(),
            if below { m.wrapping_add(1) } else { m },
        ];
        let floats = floats.into_iter().chain([clipped, single, f64::from_bits(m), a * 0.5]).map(bits);
        floats.chain(integers).chain(truths.map(u64::from)).collect()
    }
}

impl<const K: usize> SimdCode for Operands<K> {
    const USES_AVX512: bool = true;

    /// The results of each lane, in the order of `expected`; those of `mul_add`, if it is one instruction; whether any
    /// a is less than its b; and a bit for each lane where it is.
    type Output = ([Vec<u64>; K], Option<[f64; K]>, bool, u8);

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let (a, b) = (F64s::new(simd, self.a), F64s::new(simd, self.b));
        let (m, n) = (U64s::new(simd, self.m), U64s::new(simd, self.n));
        let (less, below) = (a.less(b), m.less(n));
        let floats = [
            a + b,
            a - b,
            a * b,
            a / b,
            a.larger(b),
            a.negated(),
            a.abs(),
            less.select(a, b),
            a.clip(1.0, 2.0),
            (a.to_f32s() - 0.1).to_f64s(),
            F64s::from_bits(m),
            a * 0.5,
        ];
        let integers = [
            m + n,
            m - n,
            m * n,
            m.mul_lower(n),
            m & n,
            m | n,
            m ^ n,
            m.shift_left::<7>(),
            m.shift_right::<58>(),
            m.rotate_right(n.shift_right::<58>()),
            m + 5,
            a.to_bits(),
            m.incremented_where(below),
        ];
        let truths = [
            less,
            a.less_or_equal(b),
            a.equal(b),
            a.greater_or_equal(b),
            a.greater(b),
            below,
            m.equal(n),
            !less,
            less ^ below,
            less | below,
        ];
        let results = std::array::from_fn(|lane| {
            let floats = floats.iter().map(|numbers| bits(numbers.to_array()[lane]));
            let integers = integers.iter().map(|numbers| numbers.to_array()[lane]);
            let truths = truths.iter().map(|mask| mask.to_array()[lane].into());
            floats.chain(integers).chain(truths).collect()
        });
        (results, S::HAS_FMA.then(|| a.mul_add(b, 0.3).to_array()), less.any(), less.bits())
    }
}

fn check<const K: usize>(operands: Operands<K>) {
    for level in SimdLevel::available() {
        let (results, fused, any, less_bits) = level.run(operands);
        for (lane, results) in results.into_iter().enumerate() {
            assert_eq!(results, operands.expected(lane), "lane {lane} of {K}, {level:?}");
        }
        if let Some(fused) = fused {
            let expected = std::array::from_fn(|lane| operands.a[lane].mul_add(operands.b[lane], 0.3));
            assert_eq!(fused.map(bits), <[f64; K]>::map(expected, bits), "{level:?}");
        }
        let less = operands.a.iter().zip(&operands.b).map(|(a, b)| a < b);
        assert_eq!(any, less.clone().any(|less| less), "{level:?}");
        for (lane, less) in less.enumerate() {
            assert_eq!(less_bits >> lane & 1 != 0, less, "lane {lane} of {K}, {level:?}");
        }
    }
}

/// The columns of a table with `N` columns, and the row of each lane.
struct Columns<'a, const N: usize, const K: usize>(&'a [[f64; N]], [usize; K]);

impl<const N: usize, const K: usize> SimdCode for Columns<'_, N, K> {
    const USES_AVX512: bool = true;

    type Output = [[f64; K]; N];

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> [[f64; K]; N] {
        F64s::columns(simd, self.1.map(|row| &self.0[row])).map(F64s::to_array)
    }
}

fn check_columns<const N: usize, const K: usize>(rows: [usize; K]) {
    let table: Vec<[f64; N]> = (0..9).map(|row| std::array::from_fn(|column| (10 * row + column) as f64)).collect();
    for level in SimdLevel::available() {
        let columns = level.run(Columns(&table, rows));
        assert_eq!(columns, std::array::from_fn(|column| rows.map(|row| table[row][column])), "{level:?}");
    }
}

/// Sets each lane separately.
struct Setting;

impl SimdCode for Setting {
    const USES_AVX512: bool = true;

    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        for lane in 0..LANES {
            let (mut floats, mut integers) = (F64s::splat(simd, 1.0), U64s::splat(simd, 1));
            let mut mask = Mask::new(simd, [false; LANES]);
            floats.set(lane, 2.0);
            integers.set(lane, 2);
            mask.set(lane, true);
            let is_set: [bool; LANES] = std::array::from_fn(|other| other == lane);
            assert_eq!(floats.to_array(), is_set.map(|set| if set { 2.0 } else { 1.0 }));
            assert_eq!(integers.to_array(), is_set.map(|set| if set { 2 } else { 1 }));
            assert_eq!(mask.to_array(), is_set);
        }
    }
}

#[test]
fn a_lane_is_set_without_the_others() {
    for level in SimdLevel::available() {
        level.run(Setting);
    }
}

fn any_f64() -> impl Strategy<Value = f64> {
    prop_oneof![any::<f64>(), -3.0..3.0, prop::sample::select(&[0.0, -0.0, 1.0, 2.0, f64::NAN, f64::INFINITY])]
}

fn any_u64() -> impl Strategy<Value = u64> {
    prop_oneof![any::<u64>(), 0_u64..3, Just(u64::MAX)]
}

proptest! {
    #[test]
    fn operations_equal_those_without_lanes(
        a in prop::array::uniform8(any_f64()),
        b in prop::array::uniform8(any_f64()),
        m in prop::array::uniform8(any_u64()),
        n in prop::array::uniform8(any_u64()),
        same in prop::array::uniform8(any::<bool>()),
    ) {
        let b = std::array::from_fn(|lane| if same[lane] { a[lane] } else { b[lane] });
        let n = std::array::from_fn(|lane| if same[lane] { m[lane] } else { n[lane] });
        check(Operands { a, b, m, n });
        let [a1, b1] = [a, b].map(|numbers| [numbers[0]]);
        check(Operands { a: a1, b: b1, m: [m[0]], n: [n[0]] });
        let three = |numbers: [u64; LANES]| [numbers[0], numbers[1], numbers[2]];
        check(Operands { a: [a[0], a[1], a[2]], b: [b[0], b[1], b[2]], m: three(m), n: three(n) });
    }

    #[test]
    fn columns_are_those_of_the_rows(rows in prop::array::uniform8(0_usize..9)) {
        check_columns::<1, LANES>(rows);
        check_columns::<2, LANES>(rows);
        check_columns::<3, LANES>(rows);
        check_columns::<4, LANES>(rows);
        check_columns::<5, 3>([rows[0], rows[1], rows[2]]);
        check_columns::<2, 1>([rows[0]]);
    }
}

//! Random numbers, drawn as `numpy.random.Generator` draws them.

#![expect(unsafe_code, reason = "the bits come from functions in C")]

use std::marker::PhantomData;

use crate::Bitgen;

/// The random generator that a function of an environment receives. The same draws from `numpy.random.Generator` give
/// the same numbers.
#[derive(Debug)]
pub struct Generator<'a> {
    bitgen: Bitgen,
    /// Nobody else draws while the function runs.
    exclusive: PhantomData<&'a mut Bitgen>,
}

impl Generator<'_> {
    /// A generator that draws bits from a `bitgen_t`.
    ///
    /// # Safety
    /// The functions of `bitgen` may be called with its `state`, and nothing else calls them, during the lifetime of the
    /// generator.
    pub unsafe fn new(bitgen: Bitgen) -> Self {
        Self { bitgen, exclusive: PhantomData }
    }

    /// A float in [0, 1): `rng.random()`.
    #[inline]
    pub fn random(&mut self) -> f64 {
        // SAFETY: as `new` requires.
        unsafe { (self.bitgen.next_double)(self.bitgen.state) }
    }

    /// A float in [`low`, `high`): `rng.uniform(low, high)`.
    #[inline]
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.random()
    }

    /// An integer from `low` to `high` - 1: `rng.integers(low, high)`.
    ///
    /// # Panics
    /// If `low` is not less than `high`.
    pub fn integers(&mut self, low: i64, high: i64) -> i64 {
        assert!(low < high, "low must be less than high, got {low} and {high}");
        let largest = (high.wrapping_sub(low) as u64) - 1;
        let offset = if largest == 0 {
            0
        } else if let Ok(largest) = u32::try_from(largest) {
            u64::from(self.bounded_u32(largest))
        } else {
            self.bounded_u64(largest)
        };
        low.wrapping_add_unsigned(offset)
    }

    /// 64 random bits.
    #[inline]
    pub fn next_u64(&mut self) -> u64 {
        // SAFETY: as `new` requires.
        unsafe { (self.bitgen.next_uint64)(self.bitgen.state) }
    }

    /// 32 random bits: PCG64 draws 64 and keeps one half for the next call.
    #[inline]
    pub fn next_u32(&mut self) -> u32 {
        // SAFETY: as `new` requires.
        unsafe { (self.bitgen.next_uint32)(self.bitgen.state) }
    }

    /// An integer from 0 to `largest`, by multiplication and rejection (D. Lemire, "Fast random integer generation in an
    /// interval", 2019).
    fn bounded_u32(&mut self, largest: u32) -> u32 {
        let Some(count) = largest.checked_add(1) else { return self.next_u32() };
        let mut product = u64::from(self.next_u32()) * u64::from(count);
        if (product as u32) < count {
            let threshold = (u32::MAX - largest) % count;
            while (product as u32) < threshold {
                product = u64::from(self.next_u32()) * u64::from(count);
            }
        }
        (product >> 32) as u32
    }

    /// The same with 64 bits.
    fn bounded_u64(&mut self, largest: u64) -> u64 {
        let Some(count) = largest.checked_add(1) else { return self.next_u64() };
        let mut product = u128::from(self.next_u64()) * u128::from(count);
        if (product as u64) < count {
            let threshold = (u64::MAX - largest) % count;
            while (product as u64) < threshold {
                product = u128::from(self.next_u64()) * u128::from(count);
            }
        }
        (product >> 64) as u64
    }
}

//! The vector instructions that SIMD code is compiled for, chosen at run time.

use std::sync::atomic::{AtomicU8, Ordering};

use super::{Portable, Simd};

/// Set once by [`SimdLevel::restrict`].
static LIMIT: AtomicU8 = AtomicU8::new(SimdLimit::Avx512 as u8);

/// The widest vector instructions that [`SimdLevel::detect`] may return: tests compare them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum SimdLimit {
    /// The instructions that every processor of the target has.
    Plain,
    /// AVX2 and fused multiply-adds.
    Avx2,
    /// All instructions.
    Avx512,
}

impl SimdLimit {
    /// The limits that the environment variable `QTAB_SIMD` can name.
    pub const NAMES: [(&str, Self); 2] = [("plain", Self::Plain), ("avx2", Self::Avx2)];

    /// The limit with this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::NAMES.into_iter().find_map(|(known, limit)| (known == name).then_some(limit))
    }
}

/// Code that is compiled for each [`SimdLevel`]. All functions that it calls must be inlined.
pub(crate) trait SimdCode {
    /// Whether AVX-512 registers are worth another copy of the code.
    #[cfg_attr(not(target_arch = "x86_64"), expect(dead_code, reason = "other targets have no AVX-512"))]
    const USES_AVX512: bool = false;

    type Output;

    fn run<S: Simd>(self, simd: S) -> Self::Output;
}

/// The vector instructions that SIMD code may use. Results do not depend on it.
#[derive(Clone, Copy, Debug)]
pub struct SimdLevel(Level);

#[derive(Clone, Copy, Debug)]
enum Level {
    /// The instructions that every processor of the target has.
    Plain,
    /// AVX2 and fused multiply-adds. The value proves that this processor has them.
    #[cfg(target_arch = "x86_64")]
    Avx2(pulp::x86::V3),
    /// AVX-512 as well, in code that gains from it.
    #[cfg(target_arch = "x86_64")]
    Avx512(pulp::x86::V4),
}

impl SimdLevel {
    /// The instructions that every processor of the target has.
    pub const PLAIN: Self = Self(Level::Plain);

    /// The widest instructions that this processor has, up to the limit.
    #[inline]
    pub fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            let limit = LIMIT.load(Ordering::Relaxed);
            if limit > SimdLimit::Avx2 as u8
                && let Some(avx512) = pulp::x86::V4::try_new()
            {
                return Self(Level::Avx512(avx512));
            }
            if limit > SimdLimit::Plain as u8
                && let Some(avx2) = pulp::x86::V3::try_new()
            {
                return Self(Level::Avx2(avx2));
            }
        }
        Self::PLAIN
    }

    /// These instructions without AVX-512.
    #[inline]
    pub(crate) fn without_avx512(self) -> Self {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Level::Avx512(avx512) => Self(Level::Avx2(*avx512)),
            _ => self,
        }
    }

    /// All levels that this processor supports, the widest one last.
    #[cfg(test)]
    pub(crate) fn available() -> Vec<Self> {
        #[cfg_attr(not(target_arch = "x86_64"), expect(unused_mut, reason = "other targets have one level"))]
        let mut levels = vec![Self::PLAIN];
        #[cfg(target_arch = "x86_64")]
        {
            levels.extend(pulp::x86::V3::try_new().map(|avx2| Self(Level::Avx2(avx2))));
            levels.extend(pulp::x86::V4::try_new().map(|avx512| Self(Level::Avx512(avx512))));
        }
        levels
    }

    /// Sets the limit of [`detect`](Self::detect), for all threads.
    pub fn restrict(limit: SimdLimit) {
        LIMIT.store(limit as u8, Ordering::Relaxed);
    }

    /// Runs the code as compiled for these instructions.
    #[inline]
    pub(crate) fn run<C: SimdCode>(self, code: C) -> C::Output {
        match self.0 {
            Level::Plain => code.run(Portable),
            #[cfg(target_arch = "x86_64")]
            Level::Avx2(avx2) => pulp::Simd::vectorize(avx2, Dispatched(code, avx2)),
            #[cfg(target_arch = "x86_64")]
            Level::Avx512(avx512) => {
                if const { C::USES_AVX512 } {
                    pulp::Simd::vectorize(avx512, Dispatched(code, avx512))
                } else {
                    pulp::Simd::vectorize(*avx512, Dispatched(code, *avx512))
                }
            }
        }
    }
}

/// Code, and the instructions to run it with.
#[cfg(target_arch = "x86_64")]
struct Dispatched<C, S>(C, S);

#[cfg(target_arch = "x86_64")]
impl<C: SimdCode, S: Simd> pulp::NullaryFnOnce for Dispatched<C, S> {
    type Output = C::Output;

    #[inline(always)]
    fn call(self) -> C::Output {
        let Self(code, simd) = self;
        code.run(simd)
    }
}

//! Which vector instructions SIMD code is compiled for, chosen at run time.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use std::sync::atomic::{AtomicBool, Ordering};

/// Set once by [`SimdLevel::restrict_to_plain`].
static PLAIN_ONLY: AtomicBool = AtomicBool::new(false);

/// The vector instructions that SIMD code may use. Results do not depend on it.
#[derive(Clone, Copy, Debug)]
pub struct SimdLevel(Level);

#[derive(Clone, Copy, Debug)]
enum Level {
    /// Those that every processor of the target has.
    Plain,
    /// AVX2 and fused multiply-adds. The value is the proof that this processor has them.
    #[cfg(target_arch = "x86_64")]
    Avx2Fma(pulp::x86::V3),
}

impl SimdLevel {
    /// The instructions that every processor of the target has.
    pub const PLAIN: Self = Self(Level::Plain);

    /// The widest instructions that this processor has.
    #[inline]
    pub fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        if !PLAIN_ONLY.load(Ordering::Relaxed)
            && let Some(avx2_fma) = pulp::x86::V3::try_new()
        {
            return Self(Level::Avx2Fma(avx2_fma));
        }
        Self::PLAIN
    }

    /// From now on [`detect`](Self::detect) returns [`PLAIN`](Self::PLAIN), in all threads: tests compare both.
    pub fn restrict_to_plain() {
        PLAIN_ONLY.store(true, Ordering::Relaxed);
    }

    /// Runs the code that was compiled for these instructions.
    #[inline]
    pub(crate) fn run<C: SimdCode>(self, code: C) -> C::Output {
        match self.0 {
            Level::Plain => code.run::<false>(),
            #[cfg(target_arch = "x86_64")]
            Level::Avx2Fma(avx2_fma) => {
                struct Fused<C>(C);
                impl<C: SimdCode> pulp::NullaryFnOnce for Fused<C> {
                    type Output = C::Output;

                    #[inline(always)]
                    fn call(self) -> C::Output {
                        self.0.run::<true>()
                    }
                }
                pulp::Simd::vectorize(avx2_fma, Fused(code))
            }
        }
    }
}

/// Code that is compiled for each [`SimdLevel`]. All that it calls must be inlined.
pub(crate) trait SimdCode {
    type Output;

    /// With `FUSED`, `mul_add` is one instruction. Without, it can be a slow function of the C library.
    fn run<const FUSED: bool>(self) -> Self::Output;
}

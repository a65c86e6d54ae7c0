//! Code that is compiled for several instruction sets.

use super::Simd;

/// Code that is compiled for each [`SimdLevel`](super::SimdLevel). All that it calls must be inlined.
pub(crate) trait SimdCode {
    /// Whether registers of AVX-512 are worth a further copy of the code.
    #[cfg_attr(not(target_arch = "x86_64"), expect(dead_code, reason = "other targets have no AVX-512"))]
    const USES_AVX512: bool = false;

    type Output;

    fn run<S: Simd>(self, simd: S) -> Self::Output;
}

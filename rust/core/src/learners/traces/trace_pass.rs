//! The pass over eligible weights and their traces.

use crate::simd::{F64s, LANES, Simd, SimdCode};

/// The number of traces in a block of a pass. The number of traces is hard for the processor to predict, but the number
/// of blocks is not.
pub(super) const BLOCK: usize = 2 * LANES;

/// The smallest number of traces for which a pass gains from AVX-512. A shorter pass gains less than it costs on
/// processors that lower their clock for such instructions, which slows down the rest of the step.
pub(super) const LONG_PASS: usize = 256;

/// Adds to each weight a step times its trace if `APPLIES`, then multiplies the trace by a factor if `DECAYS`.
pub(super) struct TracePass<'a, const APPLIES: bool, const DECAYS: bool> {
    pub(super) values: &'a mut [f64],
    pub(super) traces: &'a mut [f64],
    /// α δ
    pub(super) step: f64,
    /// γλ
    pub(super) factor: f64,
    /// The cutoff: traces whose magnitudes the factor reduces to this value become 0, and the weights of zero traces do
    /// not change. `None` if no trace is 0 and none falls to the cutoff.
    pub(super) cutoff: Option<f64>,
}

/// Implemented for a reference, because the struct would be copied through memory at each step.
impl<const APPLIES: bool, const DECAYS: bool> SimdCode for &mut TracePass<'_, APPLIES, DECAYS> {
    const USES_AVX512: bool = true;

    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        if let Some(cutoff) = self.cutoff {
            self.blocks::<S, true>(simd, cutoff);
        } else {
            self.blocks::<S, false>(simd, 0.0);
        }
    }
}

impl<const APPLIES: bool, const DECAYS: bool> TracePass<'_, APPLIES, DECAYS> {
    #[inline(always)]
    fn blocks<S: Simd, const CUTS: bool>(&mut self, simd: S, cutoff: f64) {
        let splat = |number| F64s::<S, LANES>::splat(simd, number);
        let (step, factor, cutoff, zero) = (splat(self.step), splat(self.factor), splat(cutoff), splat(0.0));
        let blocks = self.values.as_chunks_mut::<BLOCK>().0.iter_mut().zip(self.traces.as_chunks_mut::<BLOCK>().0);
        for (values, traces) in blocks {
            for (values, traces) in values.as_chunks_mut().0.iter_mut().zip(traces.as_chunks_mut().0) {
                let before = F64s::new(simd, *traces);
                if APPLIES {
                    let change = step * before;
                    // Adding -0 changes no number, not even -0. Adding 0, or the product of 0 and an infinite step, can
                    // change one.
                    let change = if CUTS { before.equal(zero).select(splat(-0.0), change) } else { change };
                    *values = (F64s::new(simd, *values) + change).to_array();
                }
                if DECAYS {
                    let after = before * factor;
                    let falls = after.abs().less_or_equal(cutoff);
                    *traces = if CUTS { falls.select(zero, after) } else { after }.to_array();
                }
            }
        }
    }
}

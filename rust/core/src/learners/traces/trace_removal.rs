//! The removal of the weights whose traces have become 0.

use super::Traces;
use super::trace_pass::BLOCK;
use crate::simd::{F64s, LANES, Simd, SimdCode};

/// The number of places that are examined together, with a bit for each.
const GROUP: usize = u64::BITS as usize;

impl Traces {
    /// Removes the weights whose traces are 0, if enough places have come into use since the last removal. They are
    /// removed together, because the processor cannot predict in which steps traces become 0.
    #[inline(always)]
    pub(super) fn remove_zeros(&mut self, storage: &mut [f64]) {
        if self.smallest == 0.0 && self.count >= self.remove_zeros_at {
            self.remove_all_zeros(storage);
        }
    }

    #[inline(never)]
    fn remove_all_zeros(&mut self, storage: &mut [f64]) {
        self.level.run(ZeroRemoval { weights: self, storage });
        self.remove_zeros_at = self.count + self.count / 4 + BLOCK;
    }
}

/// Removes all weights whose traces are 0.
struct ZeroRemoval<'a> {
    weights: &'a mut Traces,
    storage: &'a mut [f64],
}

impl SimdCode for ZeroRemoval<'_> {
    type Output = ();

    /// Proceeds from the last place to the first, so that a weight that moves to a freed place has already been
    /// examined.
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { weights, storage } = self;
        for first in (0..weights.count).step_by(GROUP).rev() {
            let in_use = (weights.count - first).min(GROUP);
            let mut places = zeros(simd, &weights.z[first..]) & (u64::MAX >> (GROUP - in_use));
            while places != 0 {
                let place = places.ilog2();
                places ^= 1 << place;
                weights.remove(storage, first + place as usize);
            }
        }
    }
}

/// The first [`GROUP`] traces that are 0, as a bit mask.
#[inline(always)]
fn zeros<S: Simd>(simd: S, traces: &[f64]) -> u64 {
    let lanes = traces.as_chunks::<LANES>().0.iter().take(GROUP / LANES);
    lanes.enumerate().fold(0, |zeros, (index, traces)| {
        zeros | u64::from(F64s::new(simd, *traces).equal(0.0).bits()) << (LANES * index)
    })
}

//! Numbers aligned to a cache line.

use std::ops::{Deref, DerefMut};

use crate::memory::{AllocationError, with_capacity};

/// The number of values in a cache line.
const LINE: usize = 8;

/// The number of elements from the one at `index` to the next cache line. If the address changes later, passes over the
/// numbers take longer because vectors cross cache lines; the results are the same.
pub(super) fn padding(numbers: &[f64], index: usize) -> usize {
    numbers.as_ptr().wrapping_add(index).align_offset(LINE * size_of::<f64>()) % LINE
}

/// The maximum of [`padding`].
pub(super) const MAX_PADDING: usize = LINE - 1;

/// A vector whose first number begins a cache line, as long as it stays within its capacity.
#[derive(Clone, Debug)]
pub(super) struct AlignedVec {
    numbers: Vec<f64>,
    padding: usize,
}

impl AlignedVec {
    /// An empty vector with room for `capacity` numbers.
    pub(super) fn with_capacity(capacity: usize) -> Result<Self, AllocationError> {
        let mut numbers = with_capacity(capacity + MAX_PADDING)?;
        let padding = padding(&numbers, 0);
        numbers.resize(padding, 0.0);
        Ok(Self { numbers, padding })
    }

    /// Resizes the vector like [`Vec::resize`].
    pub(super) fn resize(&mut self, len: usize, number: f64) {
        self.numbers.resize(self.padding + len, number);
    }
}

impl Deref for AlignedVec {
    type Target = [f64];

    #[inline]
    fn deref(&self) -> &[f64] {
        &self.numbers[self.padding..]
    }
}

impl DerefMut for AlignedVec {
    #[inline]
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.numbers[self.padding..]
    }
}

//! Fallible allocation: the size that a user asks for may exceed the memory, and `Vec` would abort the process.

use std::collections::TryReserveError;
use std::error::Error;
use std::fmt;

pub use self::run_memory::{Growable, Growing, MemoryRoom, RunMemory};
use crate::StopFlag;

mod run_memory;

/// The number of values written between two checks of the stop flag; this takes a fraction of a millisecond.
const VALUES_BETWEEN_CHECKS: usize = 1 << 16;

/// The reason why memory was not allocated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AllocationError {
    /// The system could not allocate the memory.
    OutOfMemory {
        /// The number of additional bytes requested.
        bytes: usize,
    },
    /// The caller set the stop flag.
    Stopped,
    /// The memory that grows during training would exceed the caller's limit.
    LimitReached {
        /// The limit on all memory, in bytes.
        limit: u64,
        /// The kind of data that would exceed the limit.
        growing: Growing,
    },
    /// There are more values than 32-bit indices can address.
    TooManyEntries,
}

impl fmt::Display for AllocationError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfMemory { bytes } => write!(formatter, "could not allocate {bytes} more bytes"),
            Self::Stopped => write!(formatter, "the allocation was stopped"),
            Self::LimitReached { limit, .. } => write!(formatter, "the limit of {limit} bytes is reached"),
            Self::TooManyEntries => write!(formatter, "there are more values than 32-bit indices can address"),
        }
    }
}

impl Error for AllocationError {}

/// The error of a failed allocation of `additional` values of `T`.
pub fn out_of_memory<T>(additional: usize) -> impl FnOnce(TryReserveError) -> AllocationError {
    move |_| AllocationError::OutOfMemory { bytes: additional.saturating_mul(size_of::<T>()) }
}

/// Makes room for `additional` more values.
///
/// # Errors
/// `OutOfMemory`.
pub fn reserve<T>(values: &mut Vec<T>, additional: usize) -> Result<(), AllocationError> {
    values.try_reserve(additional).map_err(out_of_memory::<T>(additional))
}

/// Checks that 32-bit indices can address this many values and leave the largest index free as a marker.
///
/// # Errors
/// `TooManyEntries`.
pub fn check_indices(values: usize) -> Result<(), AllocationError> {
    if u32::try_from(values).is_ok() { Ok(()) } else { Err(AllocationError::TooManyEntries) }
}

/// An empty vector with room for `capacity` values.
///
/// # Errors
/// `OutOfMemory`.
pub fn with_capacity<T>(capacity: usize) -> Result<Vec<T>, AllocationError> {
    let mut values = Vec::new();
    values.try_reserve_exact(capacity).map_err(out_of_memory::<T>(capacity))?;
    Ok(values)
}

/// The values of an iterator of known length.
///
/// # Errors
/// `OutOfMemory`.
pub fn collect<T>(values: impl ExactSizeIterator<Item = T>) -> Result<Vec<T>, AllocationError> {
    let mut collected = with_capacity(values.len())?;
    collected.extend(values);
    Ok(collected)
}

/// `len` times the same value.
///
/// # Errors
/// `OutOfMemory`; `Stopped` after `stop` was set.
pub fn filled<T: Clone>(value: &T, len: usize, stop: &StopFlag<'_>) -> Result<Vec<T>, AllocationError> {
    from_fn(len, stop, || value.clone())
}

/// The results of `len` calls of a function.
///
/// # Errors
/// `OutOfMemory`; `Stopped` after `stop` was set.
pub fn from_fn<T>(len: usize, stop: &StopFlag<'_>, mut value: impl FnMut() -> T) -> Result<Vec<T>, AllocationError> {
    let mut values = with_capacity(len)?;
    while values.len() < len {
        let count = VALUES_BETWEEN_CHECKS.min(len - values.len());
        values.extend((0..count).map(|_| value()));
        if values.len() < len && stop.is_set() {
            return Err(AllocationError::Stopped);
        }
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_into_the_address_space_is_an_error() {
        let stop = StopFlag::new();
        assert_eq!(filled(&0_u8, usize::MAX, &stop), Err(AllocationError::OutOfMemory { bytes: usize::MAX }));
        assert_eq!(with_capacity::<f64>(1 << 60).map(|_| ()), Err(AllocationError::OutOfMemory { bytes: 1 << 63 }));
    }

    #[test]
    fn numbers_of_32_bits_tell_so_many_values_apart() {
        assert_eq!(check_indices(u32::MAX as usize), Ok(()));
        assert_eq!(check_indices(1 << 32), Err(AllocationError::TooManyEntries));
    }

    #[test]
    fn filling_stops_when_the_flag_is_set() {
        let stop = StopFlag::new();
        stop.set();
        assert_eq!(filled(&1.0, VALUES_BETWEEN_CHECKS, &stop).map(|values| values.len()), Ok(VALUES_BETWEEN_CHECKS));
        assert_eq!(filled(&1.0, VALUES_BETWEEN_CHECKS + 1, &stop), Err(AllocationError::Stopped));
    }
}

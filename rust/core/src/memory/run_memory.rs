//! A limit on the memory that grows during training.

use std::collections::{HashMap, TryReserveError, VecDeque};
use std::hash::{BuildHasher, Hash};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::{AllocationError, out_of_memory};

/// The kinds of data that grow during training, for error messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Growing {
    /// The recordings of the last episodes.
    Recordings,
    /// The data of a learner: the steps of an episode or the outcomes of its model.
    Learner,
}

/// The bytes that the runs of a call may still allocate for data that grows during training. All clones share the same
/// bytes.
#[derive(Clone, Debug)]
pub struct MemoryRoom {
    limit: u64,
    left: Arc<AtomicU64>,
}

impl MemoryRoom {
    /// `left` bytes. `limit` is the limit on all memory of the call, for error messages.
    pub fn new(limit: u64, left: u64) -> Self {
        Self { limit, left: Arc::new(AtomicU64::new(left)) }
    }

    /// No limit.
    pub fn unlimited() -> Self {
        Self::new(u64::MAX, u64::MAX)
    }

    /// The number of bytes left.
    pub fn left(&self) -> u64 {
        self.left.load(Ordering::Relaxed)
    }

    /// Takes bytes before they are allocated.
    ///
    /// # Errors
    /// `LimitReached`; nothing is taken.
    pub fn take(&self, bytes: u64, growing: Growing) -> Result<(), AllocationError> {
        let taken = self.left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(bytes));
        taken.map(drop).map_err(|_| AllocationError::LimitReached { limit: self.limit, growing })
    }

    /// Gives back bytes that were taken.
    pub fn give_back(&self, bytes: u64) {
        self.left.fetch_add(bytes, Ordering::Relaxed);
    }
}

/// The bytes that the learner of one run has taken. They are given back when the run is dropped.
#[derive(Debug)]
pub struct RunMemory {
    room: MemoryRoom,
    taken: u64,
}

impl RunMemory {
    /// The memory of a run that has not taken anything from `room` yet.
    pub fn new(room: MemoryRoom) -> Self {
        Self { room, taken: 0 }
    }

    /// Makes room for `additional` more values. The capacity doubles, so that values are rarely moved, unless that
    /// would take more than half of the bytes left for all runs.
    ///
    /// # Errors
    /// `LimitReached`, `OutOfMemory`.
    pub fn reserve(&mut self, values: &mut impl Growable, additional: usize) -> Result<(), AllocationError> {
        let (len, capacity) = (values.len(), values.capacity());
        let needed = len.saturating_add(additional);
        if needed <= capacity {
            return Ok(());
        }
        let affordable = self.room.left() / (2 * values.value_bytes().max(1));
        let doubled = (2 * capacity as u64).min((capacity as u64).saturating_add(affordable));
        let wanted = needed.max(doubled as usize);
        let bytes = ((wanted - capacity) as u64).saturating_mul(values.value_bytes());
        self.room.take(bytes, Growing::Learner)?;
        if let Err(error) = values.try_grow(wanted - len) {
            self.room.give_back(bytes);
            return Err(out_of_memory::<u8>(usize::try_from(bytes).unwrap_or(usize::MAX))(error));
        }
        self.taken += bytes;
        Ok(())
    }
}

impl Drop for RunMemory {
    fn drop(&mut self) {
        self.room.give_back(self.taken);
    }
}

/// A copy shares the room and starts with nothing taken.
impl Clone for RunMemory {
    fn clone(&self) -> Self {
        Self::new(self.room.clone())
    }
}

/// A collection that grows during training.
#[expect(clippy::len_without_is_empty, reason = "only its growth is of interest")]
pub trait Growable {
    /// The number of values.
    fn len(&self) -> usize;

    /// The number of values that it has room for.
    fn capacity(&self) -> usize;

    /// The size of a value in bytes.
    fn value_bytes(&self) -> u64;

    /// Makes room for `additional` more values.
    ///
    /// # Errors
    /// The memory could not be allocated.
    fn try_grow(&mut self, additional: usize) -> Result<(), TryReserveError>;
}

macro_rules! growable {
    ($(<$($parameter:ident),*> $collection:ty, $value:ty, $grow:ident;)*) => {$(
        impl<$($parameter),*> Growable for $collection {
            fn len(&self) -> usize {
                <$collection>::len(self)
            }

            fn capacity(&self) -> usize {
                <$collection>::capacity(self)
            }

            fn value_bytes(&self) -> u64 {
                size_of::<$value>() as u64
            }

            fn try_grow(&mut self, additional: usize) -> Result<(), TryReserveError> {
                self.$grow(additional)
            }
        }
    )*};
}

growable! {
    <T> Vec<T>, T, try_reserve_exact;
    <T> VecDeque<T>, T, try_reserve_exact;
}

impl<K: Eq + Hash, V, S: BuildHasher> Growable for HashMap<K, V, S> {
    fn len(&self) -> usize {
        Self::len(self)
    }

    fn capacity(&self) -> usize {
        Self::capacity(self)
    }

    /// Up to half of the slots are empty, and each has a byte of metadata.
    fn value_bytes(&self) -> u64 {
        2 * (size_of::<(K, V)>() as u64 + 1)
    }

    fn try_grow(&mut self, additional: usize) -> Result<(), TryReserveError> {
        self.try_reserve(additional)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_take_their_bytes_and_a_dropped_run_gives_them_back() {
        let room = MemoryRoom::new(1000, 400);
        let (mut memory, mut other) = (RunMemory::new(room.clone()), RunMemory::new(room.clone()));
        let (mut values, mut queue) = (Vec::<u64>::new(), VecDeque::<u64>::new());
        memory.reserve(&mut values, 10).expect("80 bytes");
        other.reserve(&mut queue, 10).expect("80 bytes");
        assert_eq!((values.capacity(), room.left()), (10, 240));
        values.extend(0..10);
        memory.reserve(&mut values, 1).expect("80 bytes");
        assert_eq!((values.capacity(), room.left()), (20, 160));
        values.extend(0..10);
        // Doubling the capacity would take all of the room.
        memory.reserve(&mut values, 1).expect("80 bytes");
        assert_eq!((values.capacity(), room.left()), (30, 80));
        let refused = AllocationError::LimitReached { limit: 1000, growing: Growing::Learner };
        assert_eq!(memory.reserve(&mut values, 100), Err(refused));
        drop(memory);
        assert_eq!(room.left(), 320);
    }

    #[test]
    fn what_does_not_fit_into_memory_takes_nothing() {
        let room = MemoryRoom::unlimited();
        let mut memory = RunMemory::new(room.clone());
        let refused = memory.reserve(&mut Vec::<u64>::new(), usize::MAX);
        assert!(matches!(refused, Err(AllocationError::LimitReached { .. } | AllocationError::OutOfMemory { .. })));
        assert_eq!(room.left(), u64::MAX);
    }
}

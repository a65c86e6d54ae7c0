//! The memory that a call of Python's may take.

use qtab_core::memory::MemoryRoom;

/// How many bytes the user permits, for messages, and how many of them are left for what grows during the runs.
pub(crate) type Memory = (u64, u64);

/// The room for what grows; without a limit, as much as there is.
pub(crate) fn room_of(memory: Option<Memory>) -> MemoryRoom {
    memory.map_or_else(MemoryRoom::unlimited, |(limit, left)| MemoryRoom::new(limit, left))
}

//! The training functions that Python calls: one run that Python can advance, or many runs at once.

mod env_spec;
mod estimate;
mod many;
mod results;
mod testbed;
mod trainer;

use qtab_core::memory::MemoryRoom;

use env_spec::EnvironmentSpec;
pub(crate) use estimate::estimate_values;
pub(crate) use many::train_many;
pub(crate) use testbed::run_testbeds;
pub(crate) use trainer::PyTrainer;

/// The work between two checks for signals: some 8192 steps of Q-learning on a grid, a fraction of a millisecond.
const WORK_BETWEEN_CHECKS: u64 = 8192;

/// The memory limit in bytes, for messages, and the number of bytes left for data that grows during the runs.
pub(crate) type Memory = (u64, u64);

/// The room for data that grows; unlimited without a limit.
fn room_of(memory: Option<Memory>) -> MemoryRoom {
    memory.map_or_else(MemoryRoom::unlimited, |(limit, left)| MemoryRoom::new(limit, left))
}

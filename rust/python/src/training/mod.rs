//! What Python calls to train: one run that it can advance, or many runs at once.

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

/// Signals are checked after this much work: some 8192 steps of Q-learning on a grid, a fraction of a millisecond.
const WORK_BETWEEN_CHECKS: u64 = 8192;

/// How many bytes the user permits, for messages, and how many of them are left for what grows during the runs.
pub(crate) type Memory = (u64, u64);

/// The room for what grows; without a limit, as much as there is.
fn room_of(memory: Option<Memory>) -> MemoryRoom {
    memory.map_or_else(MemoryRoom::unlimited, |(limit, left)| MemoryRoom::new(limit, left))
}

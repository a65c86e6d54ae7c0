//! Vector environments: many sub-environments of one kind, stepped together.

mod flags;
mod lane_states;
mod shard;
mod states;
mod step_buffers;
#[cfg(test)]
mod tests;
mod vector_env;

pub use lane_states::LaneStates;
pub use states::States;
pub use step_buffers::StepBuffers;
pub use vector_env::{Autoreset, VectorEnv};

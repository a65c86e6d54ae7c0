//! Vector environments: many sub-environments of one kind, stepped together.

mod autoreset;
mod shard;
mod step_buffers;
mod vector_config;
mod vector_env;

pub use autoreset::Autoreset;
pub use step_buffers::StepBuffers;
pub use vector_env::VectorEnv;

//! Values on a grid over the states of classic control, and the policies derived from them.

mod beam_search;
mod rollout;
mod tasks;
mod values;

pub use beam_search::beam_search;
pub use rollout::{Rollout, replay, rollouts};
pub use tasks::{GridTask, grid_torque};
pub use values::GridValues;

//! Values on a grid over the states of classic control, and the policies that follow from them.

mod acrobot;
mod beam_search;
mod cart_pole;
mod mountain_car;
mod pendulum;
mod rollout;
mod task;
mod values;

pub use beam_search::beam_search;
pub use pendulum::PendulumTask;
pub use rollout::{Rollout, replay, rollouts};
pub use task::GridTask;
pub use values::GridValues;

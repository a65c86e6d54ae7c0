//! Several runs trained together on one core, one per SIMD lane.
//!
//! A single run is bound by latency (the cosine's above all) and by mispredicted branches. A batch computes the physics
//! of several runs in SIMD registers and selects explored actions without a branch, and the chains of operations of the
//! runs overlap. Each run's results equal those of the same run trained alone, to the bit.

mod batch_loop;
mod batched_run;
mod episode_lanes;
mod simd_trainer;
#[cfg(test)]
mod tests;

pub use batched_run::BatchedRun;
pub use simd_trainer::SimdTrainer;

pub use crate::numeric::LANES;

use crate::envs::classic_control::{CartPole, MountainCar};
use crate::features::{Axis, Bins, Edges, Rounding};
use crate::schedules::Schedule;

/// `MountainCar` on a grid of rounded cells, with a constant learning rate.
pub type Article = SimdTrainer<MountainCar, Rounding<f32, [Axis<f32>; 2]>, 3, f64>;

/// `CartPole` on bins, with a scheduled learning rate.
pub type Balance = SimdTrainer<CartPole, Bins<f32, [Edges; 4]>, 2, Schedule>;

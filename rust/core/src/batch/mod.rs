//! Several runs trained together on one core, one per SIMD lane.
//!
//! A single run is bound by latency (above all that of the cosine) and by mispredicted branches. A batch computes the
//! physics of several runs in SIMD registers, draws their random numbers there and selects explored actions without a
//! branch. The dependency chains of the runs overlap. Each run's results equal those of the same run trained alone, to
//! the bit.

mod batch_loop;
mod batch_rule;
mod batched_run;
mod episode_lanes;
mod lane_values;
mod learning_steps;
mod row_buffers;
#[cfg(test)]
mod tests;
mod updates;

pub use batch_rule::{BatchRule, NextValue};
pub use batched_run::{BatchedRun, SimdTrainer};

pub use crate::simd::LANES;

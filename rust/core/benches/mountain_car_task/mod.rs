//! Shared parts of the benchmarks: the task of the article (`MountainCar` on its grid) and the random generators of
//! seed 0.

use qtab_core::envs::classic_control::MountainCar;
use qtab_core::features::{Axis, Features, Rounding};
use qtab_core::random::{Pcg64, SeedSequence};
use qtab_core::tasks::NativeTask;

/// Gymnasium's time limit.
pub(crate) const MAX_EPISODE_STEPS: u64 = 200;

pub(crate) type AnyGrid = Rounding<f32, [Axis<f32>; 2]>;
pub(crate) type MountainCarTask<F = AnyGrid> = NativeTask<MountainCar, F>;

#[allow(dead_code, reason = "not every benchmark program uses it")]
pub(crate) fn rounding() -> AnyGrid {
    Rounding::new([Axis::new(-1.2, 0.6, 10.0), Axis::new(-0.07, 0.07, 100.0)])
}

pub(crate) fn task<F: Features<[f32; 2]>>(features: F) -> MountainCarTask<F> {
    NativeTask::new(MountainCar::default(), features, Some(MAX_EPISODE_STEPS), Pcg64::new(&SeedSequence::new(&[0])))
}

/// The agent's generator of seed 0.
pub(crate) fn agent_rng() -> Pcg64 {
    Pcg64::new(&SeedSequence::new(&[0]).child(0))
}

//! Runs that estimate the values of a policy, compiled for their environment.

use std::sync::Arc;

use qtab_core::tasks::NativeTask;
use qtab_core::{Env, Features, StopFlag};

use super::factory::{Batching, Factory};
use super::pending::PendingRun;
use super::{AnyRecordings, RunFactory};
use crate::convert::Seed;
use crate::prediction::PredictionSpec;
use crate::rng::{BitGenerator, agent_pcg64, environment_rng};
use crate::spec::RunSpec;

/// Whether [`predicting`] has the runs of a spec.
pub(super) fn is_specialized(spec: &RunSpec, record: usize) -> bool {
    record == 0 && spec.bit_generator == BitGenerator::Pcg64 && !spec.terminate_on_truncation
}

/// Runs of any method; those of TD(0) are compiled for the method, too.
pub(super) fn predicting<E, F>(
    env: E,
    features: F,
    spec: &Arc<RunSpec>,
    prediction: &Arc<PredictionSpec>,
) -> Box<dyn RunFactory>
where
    E: Env<Action = usize, State: Send> + Clone + Send + Sync + 'static,
    F: Features<E::Observation, Active = [u32; 1]> + Clone + Send + Sync + 'static,
{
    let (spec, prediction) = (Arc::clone(spec), Arc::clone(prediction));
    let build = move |seed: &Seed, stop: &StopFlag<'_>| {
        prediction.check_states(features.len())?;
        let task = NativeTask::new(env.clone(), features.clone(), Some(spec.max_episode_steps), environment_rng(seed));
        let run = prediction.visit(&spec, stop, PendingRun { task, rng: agent_pcg64(seed) })?;
        Ok((run, AnyRecordings::None))
    };
    Box::new(Factory { build, batching: Batching::one_by_one() })
}

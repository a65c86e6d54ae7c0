//! Runs that estimate the values of a policy, compiled for their environment.

use std::sync::Arc;

use qtab_core::learners::LearnerVisitor;
use qtab_core::random::Pcg64;
use qtab_core::tasks::NativeTask;
use qtab_core::{Env, Features, Learner, StopFlag, Task, Trainer};

use super::factory::BoxedFactory;
use super::{AnyRecordings, Run, RunFactory};
use crate::convert::Seed;
use crate::error::RunError;
use crate::prediction::PredictionSpec;
use crate::rng::{agent_pcg64, environment_rng};
use crate::spec::RunSpec;

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
    Box::new(BoxedFactory(build))
}

/// A task and the agent's generator. With a learner, whatever its type, they become a boxed run.
struct PendingRun<T> {
    task: T,
    rng: Pcg64,
}

impl<T> LearnerVisitor<[u32; 1]> for PendingRun<T>
where
    T: Task<Active = [u32; 1], State: Send> + Send + 'static,
    RunError: From<T::Error>,
{
    type Output = Box<dyn Run>;

    fn visit<L: Learner<[u32; 1]> + Send + 'static>(self, learner: L) -> Box<dyn Run> {
        Box::new(Trainer::new(self.task, learner, self.rng))
    }
}

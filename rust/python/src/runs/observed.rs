//! Runs that estimate the values of a policy which reads the observations, or values over tilings.

use std::sync::Arc;

use pyo3::prelude::*;
use qtab_core::features::ActiveTiles;
use qtab_core::learners::TruncationHandling;
use qtab_core::prediction::{
    FromTask, ObservableTask, ObservationPolicy, PolicyTask, PredictionRule, Predictor, RowSets,
};
use qtab_core::random::AgentRng;
use qtab_core::tasks::{BoxedTask, NativeTask};
use qtab_core::{Env, StopFlag, Trainer};

use super::factory::{Batching, Factory};
use super::{AnyRecordings, Run, RunFactory};
use crate::convert::Seed;
use crate::error::RunError;
use crate::prediction::{BoxFeatures, ObservedVisitor, PredictionSpec};
use crate::rng::environment_rng;
use crate::spec::RunSpec;

/// Runs of any method in an environment whose observations are `M` float32 numbers.
pub(super) fn observed_box<E, const M: usize>(
    env: E,
    spec: &Arc<RunSpec>,
    prediction: &Arc<PredictionSpec>,
) -> PyResult<Box<dyn RunFactory>>
where
    E: Env<Action = usize, Observation = [f32; M], State: Send> + Clone + Send + Sync + 'static,
{
    let features = BoxFeatures::<f32>::new(&spec.discretizer, |bound| bound as f32)?;
    let (spec, prediction) = (Arc::clone(spec), Arc::clone(prediction));
    let build = move |seed: &Seed, stop: &StopFlag<'_>| {
        let task = NativeTask::new(env.clone(), features.clone(), Some(spec.max_episode_steps), environment_rng(seed));
        let policies = prediction.policies(&spec, |own| BoxFeatures::<f32>::new(own, |bound| bound as f32))?;
        Ok((observed_run(task, policies, seed, &spec, &prediction, stop)?, AnyRecordings::None))
    };
    Ok(Box::new(Factory { build, batching: Batching::one_by_one() }))
}

/// A run of any method on a task with a policy.
pub(super) fn observed_run<W, P>(
    task: W,
    policy: P,
    seed: &Seed,
    spec: &RunSpec,
    prediction: &PredictionSpec,
    stop: &StopFlag<'_>,
) -> PyResult<Box<dyn Run>>
where
    W: ObservableTask<Active = ActiveTiles, State: Send> + Send + 'static,
    P: ObservationPolicy<W::Observation, Error = RunError> + Send + 'static,
    RunError: From<W::Error>,
{
    let rng = spec.bit_generator.agent_rng(seed)?;
    // Only the policy draws numbers, and it is part of the task. The learner's generator is never used.
    let task = BoxedTask::new(PolicyTask { task, policy, rng: rng.clone() });
    prediction.visit_observed(spec, stop, PendingObservedRun { task, rng, terminate: spec.terminate_on_truncation })
}

/// All of a run but its learner.
struct PendingObservedRun {
    task: BoxedTask<qtab_core::prediction::Observed<ActiveTiles>, RunError>,
    rng: AgentRng,
    terminate: bool,
}

impl ObservedVisitor for PendingObservedRun {
    type Output = Box<dyn Run>;

    fn visit<S>(self, learner: Predictor<Box<dyn PredictionRule<S> + Send>, FromTask, S>) -> Box<dyn Run>
    where
        S: RowSets + Send + 'static,
    {
        let learner = TruncationHandling { learner, terminate: self.terminate, bonus: None };
        Box::new(Trainer::new(self.task, learner, self.rng))
    }
}

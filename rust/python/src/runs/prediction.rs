//! Runs that estimate the values of a policy.

use std::sync::Arc;

use pyo3::prelude::*;
use qtab_core::features::ActiveRows;
use qtab_core::learners::{LearnerVisitor, TransformedSteps};
use qtab_core::prediction::{
    FromTask, ObservableTask, ObservationPolicy, Observed, PolicyTask, PredictionRule, Predictor, RowSets,
};
use qtab_core::random::{AgentRng, Pcg64};
use qtab_core::tasks::{BoxedTask, NativeTask};
use qtab_core::{Env, Features, Learner, StopFlag, Task, Trainer};

use super::factory::BoxedFactory;
use super::tilings::{fixed_tiles, match_tilings};
use super::{AnyRecordings, Run, RunFactory};
use crate::convert::Seed;
use crate::error::RunError;
use crate::rng::{agent_pcg64, environment_rng};
use crate::spec::{BoxFeatures, DiscretizerSpec, ObservedVisitor, PredictionSpec, RunSpec};

/// Runs of any method over numbered states, compiled for their environment; those of TD(0) are compiled for the method, too.
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

/// Runs of any method in an environment whose observations are `M` float32 numbers.
pub(super) fn observed_box<E, const M: usize>(
    env: E,
    spec: &Arc<RunSpec>,
    prediction: &Arc<PredictionSpec>,
) -> PyResult<Box<dyn RunFactory>>
where
    E: Env<Action = usize, Observation = [f32; M], State: Send> + Clone + Send + Sync + 'static,
{
    Ok(match &spec.discretizer {
        // Fewer rows are copied at each step.
        DiscretizerSpec::Tiles(tiles) => match_tilings!(
            tiles.tilings,
            N => observed(env, fixed_tiles::<M, N>(tiles)?, spec, prediction),
            _ => observed(env, any_features(&spec.discretizer)?, spec, prediction),
        ),
        grid => observed(env, any_features(grid)?, spec, prediction),
    })
}

fn any_features(discretizer: &DiscretizerSpec) -> PyResult<BoxFeatures<f32>> {
    BoxFeatures::new(discretizer, |bound| bound as f32)
}

fn observed<E, F, const M: usize>(
    env: E,
    features: F,
    spec: &Arc<RunSpec>,
    prediction: &Arc<PredictionSpec>,
) -> Box<dyn RunFactory>
where
    E: Env<Action = usize, Observation = [f32; M], State: Send> + Clone + Send + Sync + 'static,
    F: Features<[f32; M], Active: Send + 'static> + Clone + Send + Sync + 'static,
{
    let (spec, prediction) = (Arc::clone(spec), Arc::clone(prediction));
    let build = move |seed: &Seed, stop: &StopFlag<'_>| {
        let task = NativeTask::new(env.clone(), features.clone(), Some(spec.max_episode_steps), environment_rng(seed));
        let policies = prediction.policies(&spec, |own| BoxFeatures::<f32>::new(own, |bound| bound as f32))?;
        Ok((observed_run(task, policies, seed, &spec, &prediction, stop)?, AnyRecordings::None))
    };
    Box::new(BoxedFactory(build))
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
    W: ObservableTask<Active: Send, State: Send> + Send + 'static,
    P: ObservationPolicy<W::Observation, Error = RunError> + Send + 'static,
    RunError: From<W::Error>,
{
    let rng = spec.bit_generator.agent_rng(seed)?;
    // Only the policy draws numbers, and it is part of the task. The learner's generator is never used.
    let task = BoxedTask::new(PolicyTask { task, policy, rng: rng.clone() });
    prediction.visit_observed(spec, stop, PendingObservedRun { task, rng, terminate: spec.terminate_on_truncation })
}

/// All of a run but its learner.
struct PendingObservedRun<R> {
    task: BoxedTask<Observed<R>, RunError>,
    rng: AgentRng,
    terminate: bool,
}

impl<R: ActiveRows + Send + 'static> ObservedVisitor for PendingObservedRun<R> {
    type Output = Box<dyn Run>;

    fn visit<S>(self, learner: Predictor<Box<dyn PredictionRule<S> + Send>, FromTask, S>) -> Box<dyn Run>
    where
        S: RowSets + Send + 'static,
    {
        let learner = TransformedSteps { learner, terminate: self.terminate, bonus: None };
        Box::new(Trainer::new(self.task, learner, self.rng))
    }
}

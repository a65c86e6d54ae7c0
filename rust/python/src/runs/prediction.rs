//! Runs that estimate the values of a policy: over numbered states, compiled for their environment, or over
//! observations.

use std::sync::Arc;

use pyo3::prelude::*;
use qtab_core::learners::TransformedSteps;
use qtab_core::prediction::{ObservableTask, ObservationPolicy, PolicyTask};
use qtab_core::tasks::{BoxedTask, NativeTask};
use qtab_core::{Env, Features, StopFlag, Trainer};

use super::factory::BoxedFactory;
use super::tilings::{fixed_tiles, match_tilings};
use super::{AnyRecordings, Run, RunFactory};
use crate::convert::Seed;
use crate::error::RunError;
use crate::rng::{agent_pcg64, environment_rng};
use crate::spec::{BoxFeatures, DiscretizerSpec, PolicyFeatures, PredictionSpec, RunSpec, match_capacity};

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
        let rng = agent_pcg64(seed);
        let run: Box<dyn Run> = match prediction.td_zero(&spec, stop)? {
            Some(learner) => Box::new(Trainer::new(task, learner, rng)),
            None => Box::new(Trainer::new(task, prediction.of_states(&spec, stop)?, rng)),
        };
        Ok((run, AnyRecordings::None))
    };
    Box::new(BoxedFactory(build))
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
        // With a fixed number of tilings, each step copies fewer rows.
        DiscretizerSpec::Tiles(tiles) => match_tilings!(
            tiles.tilings,
            N => factory(env, fixed_tiles::<M, N>(tiles)?, spec, prediction),
            _ => factory(env, any_features(&spec.discretizer)?, spec, prediction),
        ),
        DiscretizerSpec::Weighted(weighted) => match_capacity!(
            weighted.n_features(),
            ROOM => factory(env, weighted.basis::<f32, ROOM>()?, spec, prediction)
        ),
        grid => factory(env, any_features(grid)?, spec, prediction),
    })
}

fn any_features(discretizer: &DiscretizerSpec) -> PyResult<BoxFeatures<f32>> {
    BoxFeatures::new(discretizer, |bound| bound as f32)
}

fn factory<E, F, const M: usize>(
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
        let policies = prediction.policies(&spec, |own| PolicyFeatures::new(own, |bound| bound as f32))?;
        Ok((observed_run(task, policies, seed, &spec, &prediction, stop)?, AnyRecordings::None))
    };
    Box::new(BoxedFactory(build))
}

/// A run of any method on a task with a policy.
pub(crate) fn observed_run<W, P>(
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
    // Only the policy, which is part of the task, draws numbers. The learner's generator is never used.
    let task: BoxedTask<_, RunError> = BoxedTask::new(PolicyTask { task, policy, rng: rng.clone() });
    let learner = prediction.of_observations(spec, stop)?;
    let learner = TransformedSteps { learner, terminate: spec.terminate_on_truncation, bonus: None };
    Ok(Box::new(Trainer::new(task, learner, rng)))
}

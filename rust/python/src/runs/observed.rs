//! Runs that estimate the values of a policy which reads the observations, or values over tilings.

use std::sync::Arc;

use pyo3::prelude::*;
use qtab_core::features::{ActiveRows, FixedTileCoding};
use qtab_core::learners::TruncationHandling;
use qtab_core::prediction::{
    FromTask, ObservableTask, ObservationPolicy, Observed, PolicyTask, PredictionRule, Predictor, RowSets,
};
use qtab_core::random::AgentRng;
use qtab_core::tasks::{BoxedTask, NativeTask};
use qtab_core::{Env, Features, StopFlag, Trainer};

use super::factory::{Batching, Factory};
use super::{AnyRecordings, Run, RunFactory};
use crate::convert::Seed;
use crate::error::{RunError, invalid};
use crate::prediction::{BoxFeatures, ObservedVisitor, PredictionSpec};
use crate::rng::environment_rng;
use crate::spec::{DiscretizerSpec, RunSpec, TilesSpec};

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
        // Compiled for the usual numbers of tilings: fewer rows are copied at each step.
        DiscretizerSpec::Tiles(tiles) if tiles.tilings == 8 => {
            factory(env, fixed_tiles::<M, 8>(tiles)?, spec, prediction)
        }
        DiscretizerSpec::Tiles(tiles) if tiles.tilings == 16 => {
            factory(env, fixed_tiles::<M, 16>(tiles)?, spec, prediction)
        }
        DiscretizerSpec::Tiles(tiles) if tiles.tilings == 32 => {
            factory(env, fixed_tiles::<M, 32>(tiles)?, spec, prediction)
        }
        any => factory(env, BoxFeatures::<f32>::new(any, |bound| bound as f32)?, spec, prediction),
    })
}

/// Exactly `N` tilings of `M` components.
fn fixed_tiles<const M: usize, const N: usize>(tiles: &TilesSpec) -> PyResult<FixedTileCoding<f32, M, N>> {
    FixedTileCoding::new(&tiles.tile_coding())
        .ok_or_else(|| invalid("discretizer", format!("{N} tilings of {M} components"), "others"))
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
        let policies = prediction.policies(&spec, |own| BoxFeatures::<f32>::new(own, |bound| bound as f32))?;
        Ok((observed_run(task, policies, seed, &spec, &prediction, stop)?, AnyRecordings::None))
    };
    Box::new(Factory { build, batching: Batching::one_by_one() })
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
        let learner = TruncationHandling { learner, terminate: self.terminate, bonus: None };
        Box::new(Trainer::new(self.task, learner, self.rng))
    }
}

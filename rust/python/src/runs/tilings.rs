//! Runs with tile coding that are compiled for their types: the usual number of tilings, and learners that batches know.

use std::sync::Arc;

use pyo3::prelude::*;
use qtab_core::batch::{BatchRule, BatchedRun};
use qtab_core::envs::SimdEnv;
use qtab_core::features::{FixedTileCoding, FixedTiles};
use qtab_core::learners::{Agent, AnyAlgorithm, QLearning, Sarsa, TdLearner, UpdateRule};
use qtab_core::policies::EpsilonGreedy;
use qtab_core::random::Pcg64;
use qtab_core::schedules::LearningRate;
use qtab_core::tasks::NativeTask;
use qtab_core::{Env, Features, StopFlag, Trainer};

use super::factory::{Batching, Factory};
use super::specialized::{is_plain, plain_epsilon_greedy};
use super::{AnyRecordings, Run, RunFactory, generic_box};
use crate::convert::Seed;
use crate::rng::{agent_pcg64, environment_rng};
use crate::spec::{DiscretizerSpec, LearningRateSpec, RunSpec};

/// The usual number of tilings (Sutton & Barto, section 10.1).
const TILINGS: usize = 8;

type Tilings<const M: usize> = FixedTileCoding<f32, M, TILINGS>;
type TiledAgent<const N: usize> = Agent<N, EpsilonGreedy, LearningRate>;
type TiledRun<E, U, const M: usize, const N: usize> =
    Trainer<NativeTask<E, Tilings<M>>, TdLearner<U, TiledAgent<N>>, Pcg64>;

/// Runs of `N` actions that train in batches where the spec asks for Q-learning or Sarsa on the usual number of tilings; the
/// generic ones otherwise.
pub(crate) fn tiled_box<E, const M: usize, const N: usize>(
    env: E,
    spec: &Arc<RunSpec>,
    record: usize,
) -> PyResult<Box<dyn RunFactory>>
where
    E: SimdEnv<M> + Env<Observation = [f32; M], State: Send> + Send + Sync + 'static,
{
    if let DiscretizerSpec::Tiles(tiles) = &spec.discretizer
        && tiles.tilings as usize == TILINGS
        && let LearningRateSpec::Schedule(learning_rate) = spec.learning_rate
        && let Some(policy) = plain_epsilon_greedy(spec)
        && let Some(features) = Tilings::<M>::new(&tiles.tile_coding())
        && (record == 0 && !spec.count_visits && is_plain(&env, spec, N))
    {
        let learning_rate = LearningRate::scheduled(learning_rate.build(spec.episodes), TILINGS);
        let runs = TiledRuns::<E, M, N> { env, features, policy, learning_rate, spec: Arc::clone(spec) };
        match spec.algorithm {
            AnyAlgorithm::QLearning => return Ok(runs.with_rule(QLearning)),
            AnyAlgorithm::Sarsa => return Ok(runs.with_rule(Sarsa)),
            _ => {}
        }
    }
    generic_box(env, spec, record)
}

/// What the runs of a spec share.
struct TiledRuns<E, const M: usize, const N: usize> {
    env: E,
    features: Tilings<M>,
    policy: EpsilonGreedy,
    learning_rate: LearningRate,
    spec: Arc<RunSpec>,
}

impl<E, const M: usize, const N: usize> TiledRuns<E, M, N>
where
    E: SimdEnv<M> + Env<Observation = [f32; M], State: Send> + Send + Sync + 'static,
{
    fn with_rule<U>(self, rule: U) -> Box<dyn RunFactory>
    where
        U: UpdateRule<FixedTiles<TILINGS>, TiledAgent<N>> + BatchRule + Clone + Send + Sync + 'static,
        TiledRun<E, U, M, N>: Run + BatchedRun,
    {
        let Self { env, features, policy, learning_rate, spec } = self;
        let build = move |seed: &Seed, stop: &StopFlag<'_>| {
            let mut rng = agent_pcg64(seed);
            let agent = Agent {
                table: spec.initial_q.table((0, 1), (features.len(), N), &mut rng, stop)?,
                policy,
                learning_rate: learning_rate.clone(),
                discount: spec.discount,
                terminal_update: spec.terminal_update,
                masks: None,
            };
            let task = NativeTask::new(env, features.clone(), Some(spec.max_episode_steps), environment_rng(seed));
            Ok((Trainer::new(task, TdLearner { agent, rule: rule.clone() }, rng), AnyRecordings::None))
        };
        Box::new(Factory { build, batching: Batching::in_lanes() })
    }
}

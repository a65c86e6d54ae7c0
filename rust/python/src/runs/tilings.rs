//! Runs with tile coding that are compiled for their types: the usual number of tilings, and learners that batches know.

use std::sync::Arc;

use pyo3::prelude::*;
use qtab_core::Env;
use qtab_core::envs::SimdEnv;
use qtab_core::features::FixedTileCoding;
use qtab_core::learners::{AnyAlgorithm, QLearning, Sarsa};
use qtab_core::schedules::LearningRate;

use super::factory::Batching;
use super::specialized::{Builder, is_plain, plain_epsilon_greedy};
use super::{RunFactory, generic_box};
use crate::spec::{DiscretizerSpec, LearningRateSpec, RunSpec};

/// The usual number of tilings (Sutton & Barto, section 10.1).
const TILINGS: usize = 8;

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
        && let Some(features) = FixedTileCoding::<f32, M, TILINGS>::new(&tiles.tile_coding())
        && (record == 0 && !spec.count_visits && is_plain(&env, spec, N))
    {
        let learning_rate = LearningRate::scheduled(learning_rate.build(spec.episodes), TILINGS);
        let builder = Builder::<E, _, N> { env, features, spec: Arc::clone(spec) };
        match spec.algorithm {
            AnyAlgorithm::QLearning => {
                return Ok(builder.with_rule(QLearning, policy, learning_rate, Batching::in_lanes()));
            }
            AnyAlgorithm::Sarsa => return Ok(builder.with_rule(Sarsa, policy, learning_rate, Batching::in_lanes())),
            _ => {}
        }
    }
    generic_box(env, spec, record)
}

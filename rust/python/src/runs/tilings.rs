//! Tile coding compiled for the usual numbers of tilings, and runs of the learners that can be batched with it.

use std::sync::Arc;

use pyo3::prelude::*;
use qtab_core::Env;
use qtab_core::envs::SimdEnv;
use qtab_core::features::FixedTileCoding;
use qtab_core::learners::{AnyAlgorithm, ExpectedSarsa, QLearning, Sarsa};
use qtab_core::schedules::LearningRate;

use super::factory::advance_lanes;
use super::path::{PlainSpec, RunPath};
use super::specialized::{Builder, fits, plain_epsilon_greedy};
use super::{RunFactory, generic_box};
use crate::error::invalid;
use crate::spec::{DiscretizerSpec, LearningRateSpec, RunSpec, TilesSpec};

/// Evaluates an expression in which the constant `$n` is the number of tilings, or another expression if the number is
/// unusual. A usual number is a power of two that is at least four times the number of components (Sutton & Barto,
/// section 9.5.4).
macro_rules! match_tilings {
    ($tilings:expr, $n:ident => $compiled:expr, _ => $other:expr $(,)?) => {
        match $tilings {
            8 => {
                const $n: usize = 8;
                $compiled
            }
            16 => {
                const $n: usize = 16;
                $compiled
            }
            32 => {
                const $n: usize = 32;
                $compiled
            }
            _ => $other,
        }
    };
}

pub(super) use match_tilings;

/// Exactly `N` tilings of `M` components.
pub(super) fn fixed_tiles<const M: usize, const N: usize>(tiles: &TilesSpec) -> PyResult<FixedTileCoding<f32, M, N>> {
    FixedTileCoding::new(&tiles.tile_coding())
        .ok_or_else(|| invalid("discretizer", format!("{N} tilings of {M} components"), "others"))
}

/// Runs of `N` actions that train in batches if the spec asks for Q-learning, Sarsa or Expected Sarsa with a usual
/// number of tilings, otherwise generic runs.
pub(crate) fn tiled_box<E, const M: usize, const N: usize>(env: E, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>>
where
    E: SimdEnv<M> + Env<Observation = [f32; M], State: Send> + Send + Sync + 'static,
{
    let runs = match (&spec.discretizer, RunPath::of(spec)) {
        (DiscretizerSpec::Tiles(tiles), RunPath::Plain(plain)) => {
            match_tilings!(tiles.tilings, TILINGS => of_tilings::<E, M, N, TILINGS>(&env, tiles, plain), _ => None)
        }
        _ => None,
    };
    runs.map_or_else(|| generic_box(env, spec), Ok)
}

/// Runs with this many tilings; `None` if the spec asks for a combination that is not compiled.
fn of_tilings<E, const M: usize, const N: usize, const TILINGS: usize>(
    env: &E,
    tiles: &TilesSpec,
    spec: PlainSpec,
) -> Option<Box<dyn RunFactory>>
where
    E: SimdEnv<M> + Env<Observation = [f32; M], State: Send> + Send + Sync + 'static,
{
    if spec.count_visits || !fits(env, &spec, N) {
        return None;
    }
    let LearningRateSpec::Schedule(learning_rate) = spec.learning_rate else { return None };
    let policy = plain_epsilon_greedy(&spec)?;
    let features = fixed_tiles::<M, TILINGS>(tiles).ok()?;
    let learning_rate = LearningRate::scheduled(learning_rate.build(spec.episodes), TILINGS);
    let algorithm = spec.algorithm;
    let builder = Builder::<E, _, N> { env: *env, features, spec };
    match algorithm {
        AnyAlgorithm::QLearning => Some(builder.with_rule(QLearning, policy, learning_rate, Some(advance_lanes))),
        AnyAlgorithm::Sarsa => Some(builder.with_rule(Sarsa, policy, learning_rate, Some(advance_lanes))),
        AnyAlgorithm::ExpectedSarsa => {
            Some(builder.with_rule(ExpectedSarsa, policy, learning_rate, Some(advance_lanes)))
        }
        _ => None,
    }
}

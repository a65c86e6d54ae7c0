//! The training loop over the lanes of a batch.

use super::episode_lanes::EpisodeLanes;
use super::learning_steps::Shared;
use super::{BatchRule, NextValue, SimdTrainer};
use crate::envs::{Env, SimdEnv};
use crate::features::{BatchFeatures, LaneRows, OutOfBounds};
use crate::learners::{Agent, UpdateRule};
use crate::policies::EpsilonGreedy;
use crate::random::Pcg64Lanes;
use crate::schedules::StepSize;
use crate::simd::{Simd, SimdCode};
use crate::trainer::Budget;

/// Compatible runs and their budget, compiled for each [`SimdLevel`](crate::simd::SimdLevel).
pub(super) struct BatchLoop<'a, T, const K: usize> {
    pub(super) runs: &'a mut [T; K],
    pub(super) budget: Budget,
}

impl<E, F, A, U, const N: usize, const M: usize, const K: usize> SimdCode
    for BatchLoop<'_, SimdTrainer<E, F, N, A, U>, K>
where
    E: SimdEnv<M> + Env<Observation = [f32; M]>,
    F: BatchFeatures<M>,
    A: StepSize,
    U: BatchRule + UpdateRule<F::Active, Agent<N, EpsilonGreedy, A>>,
{
    /// Several rows are read and written one by one; whether the other operations gain or lose from AVX-512 depends on
    /// the processor.
    const USES_AVX512: bool = F::ActiveInLane::IS_SINGLE;

    /// The number of steps that the runs must take one by one because the next step leads one of them to an observation
    /// without a row; usually 0. A step is one unit of work.
    type Output = Result<u64, (usize, OutOfBounds)>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let Self { runs, budget } = self;
        let mut lanes = EpisodeLanes::<S, _, N, M, K>::begin(simd, runs)?;
        let mut rngs = Pcg64Lanes::new(simd, runs.each_ref().map(|run| &run.rng));
        let mut tables = [const { Vec::new() }; K];
        for (run, table) in runs.iter_mut().zip(&mut tables) {
            run.learner.agent.table.swap_storage(table);
        }
        let result = advance(runs, &mut tables, &mut lanes, &mut rngs, budget);
        lanes.choose_if_missing(&mut rngs);
        let divergence = lanes.divergence.to_array();
        for (lane, (run, table)) in runs.iter_mut().zip(&mut tables).enumerate() {
            run.learner.agent.table.swap_storage(table);
            run.rng = rngs.get(lane);
            run.learner.agent.table.check_finite(divergence[lane]);
            run.episode = lanes.get(lane);
        }
        result
    }
}

#[inline(always)]
fn advance<S, E, F, A, U, const N: usize, const M: usize, const K: usize>(
    runs: &mut [SimdTrainer<E, F, N, A, U>; K],
    tables: &mut [Vec<f64>; K],
    lanes: &mut EpisodeLanes<S, F::ActiveInLane, N, M, K>,
    rngs: &mut Pcg64Lanes<S, K>,
    budget: Budget,
) -> Result<u64, (usize, OutOfBounds)>
where
    S: Simd,
    E: SimdEnv<M> + Env<Observation = [f32; M]>,
    F: BatchFeatures<M>,
    A: StepSize,
    U: BatchRule + UpdateRule<F::Active, Agent<N, EpsilonGreedy, A>>,
{
    let max_episode_steps = runs[0].task.max_episode_steps;
    let Agent { discount, terminal_update, .. } = runs[0].learner.agent;
    let shared = Shared { env: runs[0].task.env, features: runs[0].task.features.clone(), discount, terminal_update };
    let mut steps_left = budget.work;
    while steps_left > 0 {
        // An episode takes a step even if its time limit is 0.
        let until_limit = lanes.elapsed.map(|elapsed| max_episode_steps.saturating_sub(elapsed).max(1));
        let most = until_limit.into_iter().fold(steps_left, u64::min);
        let stop = shared.learning_steps(runs, tables, lanes, rngs, most);
        steps_left -= stop.steps;
        for elapsed in &mut lanes.elapsed {
            *elapsed += stop.steps;
        }
        if stop.out_of_bounds {
            return Ok(steps_left);
        }
        let terminal = stop.terminal.unwrap_or([false; K]);
        let (episode_returns, divergence) = (lanes.episode_return.to_array(), lanes.divergence.to_array());
        let mut result = Ok(());
        let mut running = true;
        for lane in 0..K {
            if !terminal[lane] && lanes.elapsed[lane] < max_episode_steps {
                continue;
            }
            let run = &mut runs[lane];
            run.finish_episode(episode_returns[lane], lanes.elapsed[lane].cast_signed(), terminal[lane]);
            lanes.active[lane] = false;
            running &= run.episodes.returns.len() < budget.episodes && !divergence[lane].is_nan();
            if running {
                if let Err(error) = lanes.reset(lane, run, &tables[lane]) {
                    result = Err((lane, error));
                    running = false;
                } else if U::NEXT_VALUE == NextValue::OfNextAction {
                    lanes.choose_one(lane, rngs);
                }
            }
        }
        result?;
        if !running {
            break;
        }
    }
    Ok(0)
}

//! The training loop over the lanes of a batch.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use super::SimdTrainer;
use super::decisions::{BLOCK, Decisions};
use super::episode_lanes::EpisodeLanes;
use super::learning_steps::Shared;
use crate::envs::{Env, SimdEnv};
use crate::features::{BatchFeatures, OutOfBounds};
use crate::learners::Agent;
use crate::numeric::SimdCode;
use crate::random::PrefetchedPcg64;
use crate::schedules::StepSize;
use crate::trainer::Budget;

/// Compatible runs and their budget, compiled for each [`SimdLevel`](crate::numeric::SimdLevel).
pub(super) struct BatchLoop<'a, T, const K: usize> {
    pub(super) runs: &'a mut [T; K],
    pub(super) budget: Budget,
}

impl<E, F, A, const N: usize, const M: usize, const K: usize> SimdCode for BatchLoop<'_, SimdTrainer<E, F, N, A>, K>
where
    E: SimdEnv<M> + Env<Observation = [f32; M]>,
    F: BatchFeatures<M>,
    A: StepSize,
{
    /// How many steps the runs must take one by one, because the next step leads one of them to an observation without
    /// a row; usually 0. A step is one unit of work.
    type Output = Result<u64, (usize, OutOfBounds)>;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> Self::Output {
        let Self { runs, budget } = self;
        let mut rngs = runs.each_ref().map(|run| PrefetchedPcg64::new(&run.rng));
        let result = advance::<_, _, _, N, M, K, FUSED>(runs, &mut rngs, budget);
        for (run, rng) in runs.iter_mut().zip(rngs) {
            run.rng = rng.into_pcg64();
        }
        result
    }
}

#[inline(always)]
fn advance<E, F, A, const N: usize, const M: usize, const K: usize, const FUSED: bool>(
    runs: &mut [SimdTrainer<E, F, N, A>; K],
    rngs: &mut [PrefetchedPcg64; K],
    budget: Budget,
) -> Result<u64, (usize, OutOfBounds)>
where
    E: SimdEnv<M> + Env<Observation = [f32; M]>,
    F: BatchFeatures<M>,
    A: StepSize,
{
    let mut lanes = EpisodeLanes::<M, K>::begin(runs, rngs)?;
    let max_episode_steps = runs[0].task.max_episode_steps;
    let Agent { discount, terminal_update, .. } = runs[0].learner.agent;
    let shared = Shared { env: runs[0].task.env, features: runs[0].task.features.clone(), discount, terminal_update };
    let mut decisions = Decisions::new(rngs);
    let mut tables = [const { Vec::new() }; K];
    for lane in 0..K {
        runs[lane].learner.agent.table.swap_storage(&mut tables[lane]);
        decisions.draw::<N>(lane, 0, lanes.explore_from[lane], &mut rngs[lane]);
    }
    let mut result = Ok(0);
    let mut running = true;
    let mut steps_left = budget.work;
    // The number of steps of the block that have been taken.
    let mut taken = 0;
    while running && steps_left > 0 {
        // An episode takes a step even if its time limit is 0.
        let until_limit = lanes.elapsed.map(|elapsed| max_episode_steps.saturating_sub(elapsed).max(1));
        let most = until_limit.into_iter().fold(steps_left.min((BLOCK - taken) as u64), u64::min) as usize;
        let following = &decisions.actions[taken..][..most];
        let stop = shared.learning_steps::<A, N, M, K, FUSED>(runs, &mut tables, &mut lanes, following);
        taken += stop.steps;
        steps_left -= stop.steps as u64;
        for elapsed in &mut lanes.elapsed {
            *elapsed += stop.steps as u64;
        }
        if stop.out_of_bounds {
            result = Ok(steps_left);
            break;
        }
        let terminal = stop.terminal.unwrap_or([false; K]);
        for lane in 0..K {
            if !terminal[lane] && lanes.elapsed[lane] < max_episode_steps {
                continue;
            }
            // No action follows the last step.
            decisions.rewind::<N>(lane, taken - 1, lanes.explore_from[lane], &mut rngs[lane]);
            let run = &mut runs[lane];
            run.finish_episode(lanes.episode_return[lane], lanes.elapsed[lane].cast_signed(), terminal[lane]);
            lanes.active[lane] = false;
            running &= run.episodes.returns.len() < budget.episodes;
            if !running {
                continue;
            }
            run.learner.agent.table.swap_storage(&mut tables[lane]);
            let begun = run.begin_episode(&mut rngs[lane]);
            run.learner.agent.table.swap_storage(&mut tables[lane]);
            match begun {
                Ok(episode) => lanes.set(lane, &episode, run),
                Err(error) => {
                    result = Err((lane, error));
                    running = false;
                    continue;
                }
            }
            decisions.draw::<N>(lane, taken, lanes.explore_from[lane], &mut rngs[lane]);
        }
        if taken == BLOCK && running {
            taken = 0;
            for (lane, rng) in rngs.iter_mut().enumerate() {
                decisions.draw::<N>(lane, 0, lanes.explore_from[lane], rng);
            }
        }
    }
    for (lane, run) in runs.iter_mut().enumerate() {
        run.learner.agent.table.swap_storage(&mut tables[lane]);
        if lanes.active[lane] {
            decisions.rewind::<N>(lane, taken, lanes.explore_from[lane], &mut rngs[lane]);
        }
        run.episode = lanes.get::<E::State>(lane);
    }
    result
}

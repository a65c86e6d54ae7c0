//! The training loop over the lanes of a batch.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]
#![expect(clippy::needless_bitwise_bool, reason = "a lazy operator would be an unpredictable branch")]

use std::hint::select_unpredictable;

use super::SimdTrainer;
use super::episode_lanes::EpisodeLanes;
use crate::envs::{Env, SimdEnv};
use crate::features::{BatchFeatures, OutOfBounds};
use crate::learners::Agent;
use crate::numeric::cold_path;
use crate::q_table::TerminalUpdate;
use crate::random::PrefetchedPcg64;
use crate::schedules::StepSize;
use crate::trainer::Budget;

/// Compatible runs and their budget, as a closure that `pulp` compiles for each instruction set.
pub(super) struct BatchLoop<'a, T, const K: usize> {
    pub(super) runs: &'a mut [T; K],
    pub(super) budget: Budget,
}

impl<E, F, A, const N: usize, const M: usize, const K: usize> pulp::NullaryFnOnce
    for BatchLoop<'_, SimdTrainer<E, F, N, A>, K>
where
    E: SimdEnv<M> + Env<Observation = [f32; M]>,
    F: BatchFeatures<M>,
    A: StepSize,
{
    /// How many steps the runs must take one by one, because the next step leads one of them to an observation without
    /// a row; usually 0. A step is one unit of work.
    type Output = Result<u64, (usize, OutOfBounds)>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self { runs, budget } = self;
        let mut rngs = runs.each_ref().map(|run| PrefetchedPcg64::new(&run.rng));
        let result = advance(runs, &mut rngs, budget);
        for (run, rng) in runs.iter_mut().zip(rngs) {
            run.rng = rng.into_pcg64();
        }
        result
    }
}

#[inline(always)]
fn advance<E, F, A, const N: usize, const M: usize, const K: usize>(
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
    let env = runs[0].task.env;
    let features = runs[0].task.features.clone();
    let max_episode_steps = runs[0].task.max_episode_steps;
    let Agent { discount, terminal_update, .. } = runs[0].learner.agent;
    let mut result = Ok(0);
    let mut running = true;
    let mut steps = budget.work;
    while running && steps > 0 {
        let before = lanes.fields;
        let terminal = env.step_soa(&mut lanes.fields, &lanes.action);
        let observations = lanes.fields.map(|field| field.map(|number| number as f32));
        let Some(rows) = features.active_rows_batch(&observations) else {
            lanes.fields = before;
            result = Ok(steps);
            break;
        };
        steps -= 1;
        let next_row_starts = rows.map(|row| row * N);
        let mut done = [false; K];
        let mut any_done = false;
        for lane in 0..K {
            lanes.elapsed[lane] += 1;
            lanes.episode_return[lane] += env.reward(terminal[lane]);
            done[lane] = terminal[lane] | (lanes.elapsed[lane] >= max_episode_steps);
            any_done |= done[lane];
        }
        for lane in 0..K {
            let agent = &mut runs[lane].learner.agent;
            let (weight_index, next_row_start) = (lanes.row_start[lane] + lanes.action[lane], next_row_starts[lane]);
            agent.learning_rate.visit(weight_index);
            let learning_rate = agent.learning_rate.at(weight_index);
            let values = agent.table.values_mut();
            let value = values[weight_index];
            if terminal[lane] {
                cold_path();
                let reward = env.reward(true);
                values[weight_index] = match terminal_update {
                    TerminalUpdate::Assign => reward,
                    TerminalUpdate::Target => value + learning_rate * (reward - value),
                };
                continue;
            }
            let (_, largest) = argmax_and_maximum::<N>(values, next_row_start);
            values[weight_index] = value + learning_rate * ((env.reward(false) + discount * largest) - value);
            if done[lane] {
                cold_path();
                continue;
            }
            let (greedy, _) = argmax_and_maximum::<N>(values, next_row_start);
            let (explores, random) = rngs[lane].explore(lanes.greedy_below[lane], N as u32);
            lanes.action[lane] = select_unpredictable(explores, random as usize, greedy);
            lanes.row_start[lane] = next_row_start;
        }
        if any_done {
            for lane in (0..K).filter(|&lane| done[lane]) {
                let run = &mut runs[lane];
                let length = lanes.elapsed[lane].cast_signed();
                run.finish_episode(lanes.episode_return[lane], length, terminal[lane]);
                lanes.active[lane] = false;
                running &= run.episodes.returns.len() < budget.episodes;
                if !running {
                    continue;
                }
                match run.begin_episode(&mut rngs[lane]) {
                    Ok(episode) => lanes.set(lane, &episode, run),
                    Err(error) => {
                        result = Err((lane, error));
                        running = false;
                    }
                }
            }
        }
    }
    for (lane, run) in runs.iter_mut().enumerate() {
        run.episode = lanes.get::<E::State, N>(lane);
    }
    result
}

/// The argmax of a row, the first of equal values, and the maximum, without a branch.
#[inline(always)]
fn argmax_and_maximum<const N: usize>(values: &[f64], row_start: usize) -> (usize, f64) {
    let row = &values[row_start..][..N];
    let (mut best, mut largest) = (0, row[0]);
    for (action, &value) in row.iter().enumerate().skip(1) {
        let larger = value > largest;
        best = select_unpredictable(larger, action, best);
        largest = select_unpredictable(larger, value, largest);
    }
    (best, largest)
}

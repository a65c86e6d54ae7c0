//! The steps of a batch between two events: the end of an episode, of the drawn decisions or of the budget.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use super::SimdTrainer;
use super::episode_lanes::EpisodeLanes;
use crate::envs::{Env, SimdEnv};
use crate::features::BatchFeatures;
use crate::learners::Agent;
use crate::numeric::{cold_path, mask, select};
use crate::q_table::TerminalUpdate;
use crate::random::Pcg64Lanes;
use crate::schedules::StepSize;

/// What all runs of a batch share.
pub(super) struct Shared<E, F> {
    pub(super) env: E,
    pub(super) features: F,
    pub(super) discount: f64,
    pub(super) terminal_update: TerminalUpdate,
}

/// Where the steps stopped.
pub(super) struct Stop<const K: usize> {
    /// The number of steps that each lane took.
    pub(super) steps: u64,
    /// Which lanes reached a terminal state in the last step.
    pub(super) terminal: Option<[bool; K]>,
    /// Whether a further step would lead to an observation without a row.
    pub(super) out_of_bounds: bool,
}

impl<E, F> Shared<E, F> {
    /// Chooses an action, takes a step and learns from it, in every lane, up to `most` times. Stops early after a terminal
    /// state, or before an observation without a row. All is computed in lanes but for reading and writing the tables.
    #[inline(always)]
    pub(super) fn learning_steps<A, const N: usize, const M: usize, const K: usize, const FUSED: bool>(
        &self,
        runs: &mut [SimdTrainer<E, F, N, A>; K],
        tables: &mut [Vec<f64>; K],
        lanes: &mut EpisodeLanes<N, M, K>,
        rngs: &mut Pcg64Lanes<K>,
        most: u64,
    ) -> Stop<K>
    where
        E: SimdEnv<M> + Env<Observation = [f32; M]>,
        F: BatchFeatures<M>,
        A: StepSize,
    {
        let Self { env, features, discount, .. } = self;
        let tables = tables.each_mut().map(|values| values.as_chunks_mut::<N>().0);
        let uniform = runs.each_ref().map(|run| run.learner.agent.learning_rate.uniform());
        let is_uniform = uniform.iter().all(Option::is_some);
        let mut learning_rates = uniform.map(Option::unwrap_or_default);
        for steps in 0..most {
            if !lanes.actions_chosen {
                lanes.choose(rngs);
            }
            let before = lanes.fields;
            let terminal = env.step_soa::<FUSED, K>(&mut lanes.fields, &lanes.action);
            let observations = lanes.fields.map(|field| field.map(|number| number as f32));
            let Some(next_row) = features.active_rows_batch(&observations) else {
                cold_path();
                lanes.fields = before;
                return Stop { steps, terminal: None, out_of_bounds: true };
            };
            lanes.actions_chosen = false;
            let weight_index: [usize; K] = std::array::from_fn(|lane| lanes.row[lane] * N + lanes.action[lane]);
            if !is_uniform {
                for (lane, run) in runs.iter_mut().enumerate() {
                    let Agent { learning_rate, .. } = &mut run.learner.agent;
                    learning_rate.visit(weight_index[lane]);
                    learning_rates[lane] = learning_rate.at(weight_index[lane]);
                }
            }
            let mut next_values = [[0.0; K]; N];
            for lane in 0..K {
                let row = &tables[lane][next_row[lane]];
                for (values, &value) in next_values.iter_mut().zip(row) {
                    values[lane] = value;
                }
            }
            // A select between f64 would be an unpredictable branch where there are no vector registers.
            let mut value = lanes.values[0];
            for (action, values) in lanes.values.iter().enumerate().skip(1) {
                for lane in 0..K {
                    let is_chosen = mask(lanes.action[lane] == action);
                    value[lane] = f64::from_bits(select(is_chosen, values[lane].to_bits(), value[lane].to_bits()));
                }
            }
            let mut largest = next_values[0];
            for values in &next_values[1..] {
                for lane in 0..K {
                    largest[lane] = if values[lane] > largest[lane] { values[lane] } else { largest[lane] };
                }
            }
            let mut updated = [0.0; K];
            for lane in 0..K {
                let target = env.reward(false) + discount * largest[lane];
                updated[lane] = value[lane] + learning_rates[lane] * (target - value[lane]);
            }
            let any_terminal = terminal != [false; K];
            if any_terminal {
                cold_path();
                let reward = env.reward(true);
                for lane in (0..K).filter(|&lane| terminal[lane]) {
                    updated[lane] = match self.terminal_update {
                        TerminalUpdate::Assign => reward,
                        TerminalUpdate::Target => value[lane] + learning_rates[lane] * (reward - value[lane]),
                    };
                }
            }
            for lane in 0..K {
                tables[lane].as_flattened_mut()[weight_index[lane]] = updated[lane];
            }
            lanes.values = next_values;
            for (action, values) in lanes.values.iter_mut().enumerate() {
                for lane in 0..K {
                    // The update can have changed the next row.
                    let is_updated = next_row[lane] * N + action == weight_index[lane];
                    values[lane] = if is_updated { updated[lane] } else { values[lane] };
                }
            }
            lanes.row = next_row;
            if any_terminal {
                cold_path();
                for (episode_return, &terminal) in lanes.episode_return.iter_mut().zip(&terminal) {
                    *episode_return += env.reward(terminal);
                }
                return Stop { steps: steps + 1, terminal: Some(terminal), out_of_bounds: false };
            }
            for episode_return in &mut lanes.episode_return {
                *episode_return += env.reward(false);
            }
        }
        Stop { steps: most, terminal: None, out_of_bounds: false }
    }
}

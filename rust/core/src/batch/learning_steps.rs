//! The steps of a batch between two events: the end of an episode or of the budget.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use super::episode_lanes::EpisodeLanes;
use super::lane_values::{largest, values_of};
use super::updates::{update_rows, update_single_rows};
use super::{BatchRule, SimdTrainer};
use crate::envs::{Env, SimdEnv};
use crate::features::{BatchFeatures, LaneRows};
use crate::numeric::cold_path;
use crate::q_table::{TerminalUpdate, sum_rows};
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
    pub(super) fn learning_steps<A, U, const N: usize, const M: usize, const K: usize, const FUSED: bool>(
        &self,
        runs: &[SimdTrainer<E, F, N, A, U>; K],
        tables: &mut [Vec<f64>; K],
        lanes: &mut EpisodeLanes<F::ActiveInLane, N, M, K>,
        rngs: &mut Pcg64Lanes<K>,
        most: u64,
    ) -> Stop<K>
    where
        E: SimdEnv<M> + Env<Observation = [f32; M]>,
        F: BatchFeatures<M>,
        A: StepSize,
        U: BatchRule,
    {
        let mut tables = tables.each_mut().map(|values| values.as_chunks_mut::<N>().0);
        let step_sizes = runs.each_ref().map(|run| run.learner.agent.learning_rate.uniform().unwrap_or_default());
        for steps in 0..most {
            if !lanes.actions_chosen {
                lanes.choose(rngs);
            }
            let before = lanes.fields;
            let terminal = self.env.step_soa::<FUSED, K>(&mut lanes.fields, &lanes.action);
            let observations = lanes.fields.map(|field| field.map(|number| number as f32));
            let Some(next_rows) = self.features.active_rows_batch(&observations) else {
                cold_path();
                lanes.fields = before;
                return Stop { steps, terminal: None, out_of_bounds: true };
            };
            let any_terminal = terminal != [false; K];
            let mut rewards = [self.env.reward(false); K];
            if any_terminal {
                cold_path();
                rewards = terminal.map(|terminal| self.env.reward(terminal));
            }
            lanes.actions_chosen = false;
            let mut next_values = [[0.0; K]; N];
            for lane in 0..K {
                let sums = sum_rows(next_rows[lane].indices().map(|row| tables[lane][row]));
                for (values, value) in next_values.iter_mut().zip(sums) {
                    values[lane] = value;
                }
            }
            let value = values_of(&lanes.values, &lanes.action);
            let (rows, actions) = (lanes.rows, lanes.action);
            (lanes.rows, lanes.values) = (next_rows, next_values);
            let next_value = if U::ON_POLICY {
                lanes.choose_unless(&terminal, rngs);
                values_of(&next_values, &lanes.action)
            } else {
                largest(&next_values)
            };
            let mut errors = [0.0; K];
            for lane in 0..K {
                errors[lane] = rewards[lane] + self.discount * next_value[lane] - value[lane];
            }
            if any_terminal {
                cold_path();
                for lane in (0..K).filter(|&lane| terminal[lane]) {
                    errors[lane] = rewards[lane] - value[lane];
                }
            }
            if F::ActiveInLane::IS_SINGLE {
                let mut updated = [0.0; K];
                for lane in 0..K {
                    updated[lane] = value[lane] + step_sizes[lane] * errors[lane];
                }
                if any_terminal && self.terminal_update == TerminalUpdate::Assign {
                    cold_path();
                    for lane in (0..K).filter(|&lane| terminal[lane]) {
                        updated[lane] = rewards[lane];
                    }
                }
                update_single_rows(&mut tables, &rows, &actions, &updated, lanes);
            } else {
                let mut changes = [0.0; K];
                for lane in 0..K {
                    changes[lane] = step_sizes[lane] * errors[lane];
                    // As `QTable::check_finite`.
                    lanes.divergence[lane] += errors[lane] * 0.0;
                }
                update_rows(&mut tables, &rows, &actions, &changes, lanes);
            }
            for (episode_return, reward) in lanes.episode_return.iter_mut().zip(rewards) {
                *episode_return += reward;
            }
            if any_terminal {
                cold_path();
                return Stop { steps: steps + 1, terminal: Some(terminal), out_of_bounds: false };
            }
        }
        Stop { steps: most, terminal: None, out_of_bounds: false }
    }
}

//! The steps of a batch between two events: the end of an episode or of the budget.

use super::episode_lanes::EpisodeLanes;
use super::lane_values::{expected_values, largest, values_of, values_of_rows};
use super::updates::{update_rows, update_single_rows};
use super::{BatchRule, NextValue, SimdTrainer};
use crate::envs::{Env, SimdEnv};
use crate::features::{BatchFeatures, LaneRows};
use crate::numeric::cold_path;
use crate::q_table::TerminalUpdate;
use crate::random::Pcg64Lanes;
use crate::schedules::StepSize;
use crate::simd::{F64s, Simd, map};

/// The data that all runs of a batch share.
pub(super) struct Shared<E, F> {
    pub(super) env: E,
    pub(super) features: F,
    pub(super) discount: f64,
    pub(super) terminal_update: TerminalUpdate,
}

/// When and why the steps stopped.
pub(super) struct Stop<const K: usize> {
    /// The number of steps that each lane took.
    pub(super) steps: u64,
    /// Whether each lane reached a terminal state in the last step; `None` if no lane did.
    pub(super) terminal: Option<[bool; K]>,
    /// Whether a further step would lead to an observation without a row.
    pub(super) out_of_bounds: bool,
}

impl<E, F> Shared<E, F> {
    /// Chooses an action, takes a step and learns from it, in every lane, up to `most` times. Stops early after a
    /// terminal state, or before an observation without a row. Everything except reading and writing the tables is
    /// computed in lanes.
    #[inline(always)]
    pub(super) fn learning_steps<S, A, U, const N: usize, const M: usize, const K: usize>(
        &self,
        runs: &[SimdTrainer<E, F, N, A, U>; K],
        tables: &mut [Vec<f64>; K],
        lanes: &mut EpisodeLanes<S, F::ActiveInLane, N, M, K>,
        rngs: &mut Pcg64Lanes<S, K>,
        most: u64,
    ) -> Stop<K>
    where
        S: Simd,
        E: SimdEnv<M> + Env<Observation = [f32; M]>,
        F: BatchFeatures<M>,
        A: StepSize,
        U: BatchRule,
    {
        let simd = lanes.simd;
        let mut tables = tables.each_mut().map(|values| values.as_chunks_mut::<N>().0);
        let step_sizes = runs.each_ref().map(|run| run.learner.agent.learning_rate.uniform().unwrap_or_default());
        let step_sizes = F64s::new(simd, step_sizes);
        let probabilities = runs.each_ref().map(|run| run.learner.agent.policy.probabilities(N));
        let greedy_probability = F64s::new(simd, probabilities.map(|(greedy, _)| greedy));
        let other_probability = F64s::new(simd, probabilities.map(|(_, other)| other));
        let [reward, terminal_reward] = [false, true].map(|terminal| F64s::splat(simd, self.env.reward(terminal)));
        for steps in 0..most {
            if !lanes.actions_chosen {
                lanes.choose(rngs);
            }
            let before = lanes.fields;
            let terminal = self.env.step_batch(simd, &mut lanes.fields, lanes.action);
            let observations = map(lanes.fields, F64s::to_f32s);
            if !self.features.write_active_rows_batch(simd, observations, lanes.rows.next_mut()) {
                cold_path();
                lanes.fields = before;
                return Stop { steps, terminal: None, out_of_bounds: true };
            }
            let any_terminal = terminal.any();
            let rewards = terminal.select(terminal_reward, reward);
            let next_values = values_of_rows(simd, &tables, lanes.rows.next());
            let actions = lanes.action;
            let value = values_of(&lanes.values(), actions);
            lanes.actions_chosen = false;
            let next_value = match U::NEXT_VALUE {
                NextValue::OfNextAction => {
                    lanes.values = map(next_values, F64s::to_array);
                    lanes.choose_unless(terminal, rngs);
                    values_of(&next_values, lanes.action)
                }
                NextValue::Largest => largest(&next_values),
                NextValue::Expected => expected_values(simd, &next_values, greedy_probability, other_probability),
            };
            let mut errors = rewards + next_value * self.discount - value;
            if any_terminal {
                cold_path();
                errors = terminal.select(rewards - value, errors);
            }
            let changes = errors * step_sizes;
            let both_rows = [lanes.rows.current(), lanes.rows.next()];
            lanes.values = if F::ActiveInLane::IS_SINGLE {
                let mut updated = value + changes;
                if any_terminal && self.terminal_update == TerminalUpdate::Assign {
                    cold_path();
                    updated = terminal.select(rewards, updated);
                }
                update_single_rows(simd, &mut tables, both_rows, actions, updated, next_values)
            } else {
                // Makes the divergence NaN, as in `QTable::check_finite`.
                lanes.divergence = lanes.divergence + errors * 0.0;
                update_rows(&mut tables, both_rows, actions, changes, next_values)
            };
            lanes.rows.advance();
            lanes.episode_return = lanes.episode_return + rewards;
            if any_terminal {
                cold_path();
                return Stop { steps: steps + 1, terminal: Some(terminal.to_array()), out_of_bounds: false };
            }
        }
        Stop { steps: most, terminal: None, out_of_bounds: false }
    }
}

//! Actor-critic with eligibility traces (Sutton & Barto, the box in section 13.5).

use super::Critic;
use super::actor_critic::td_error;
use crate::StopFlag;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::features::ActiveFeatures;
use crate::learners::{Agent, UpdateRule, VALUES_PER_WORK, learn_borrowed};
use crate::memory::{AllocationError, RunMemory, filled, reserve};
use crate::q_table::QTable;
use crate::random::Rng;
use crate::tasks::Next;

/// Marks a row without traces.
const NONE: u32 = u32::MAX;

/// In each step, with the traces zʷ and zᶿ, which are 0 when an episode begins:
///
/// - δ = R + γ v̂(S′, w) - v̂(S, w)
/// - zʷ ← γλ zʷ + ∇v̂(S, w)
/// - zᶿ ← γλ zᶿ + I ∇ln π(A | S, θ)
/// - w ← w + αʷ δ zʷ
/// - θ ← θ + α δ zᶿ
/// - I ← γ I
///
/// Both traces have the same λ.
#[derive(Clone, Debug, PartialEq)]
pub struct ActorCriticLambda {
    critic: Critic,
    trace_decay: f64,
    /// I = γᵗ
    power: f64,
    /// The rows visited in this episode, in the order of their first visits.
    visited: Vec<u32>,
    /// The position of each row in `visited`, or `NONE`.
    positions: Vec<u32>,
    /// zʷ of the visited rows.
    value_traces: Vec<f64>,
    /// zᶿ of the visited rows, all actions of a row together.
    preference_traces: Vec<f64>,
}

impl ActorCriticLambda {
    /// An update rule with the trace decay λ.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn new(critic: Critic, trace_decay: f64, stop: &StopFlag<'_>) -> Result<Self, AllocationError> {
        let positions = filled(&NONE, critic.table.shape().0, stop)?;
        let (visited, value_traces, preference_traces) = (Vec::new(), Vec::new(), Vec::new());
        Ok(Self { critic, trace_decay, power: 1.0, visited, positions, value_traces, preference_traces })
    }

    /// The position of a row. Adds traces for a row that has none.
    #[inline]
    fn position(&mut self, row: u32, num_actions: usize) -> usize {
        let position = &mut self.positions[row as usize];
        if *position == NONE {
            *position = self.visited.len() as u32;
            self.visited.push(row);
            self.value_traces.push(0.0);
            self.preference_traces.resize(self.preference_traces.len() + num_actions, 0.0);
        }
        *position as usize
    }

    /// Makes room for the traces of all rows.
    fn make_room(&mut self, n_rows: usize, num_actions: usize) -> Result<(), AllocationError> {
        let missing = n_rows - self.visited.len();
        reserve(&mut self.visited, missing)?;
        reserve(&mut self.value_traces, missing)?;
        reserve(&mut self.preference_traces, missing * num_actions)
    }

    /// Discards the traces of the episode.
    fn clear(&mut self) {
        for &row in &self.visited {
            self.positions[row as usize] = NONE;
        }
        self.visited.clear();
        self.value_traces.clear();
        self.preference_traces.clear();
        self.power = 1.0;
    }
}

impl<R: Copy + ActiveFeatures> UpdateRule<R, Agent> for ActorCriticLambda {
    const HAS_CRITIC: bool = true;

    #[inline]
    fn learn(
        &mut self,
        agent: &mut Agent,
        state: R,
        action: usize,
        reward: f64,
        next: Next<R>,
        rng: &mut impl Rng,
    ) -> usize {
        let error = td_error(agent, &self.critic, state, reward, next);
        let num_actions = agent.table.num_actions();
        let decay = agent.discount * self.trace_decay;
        for trace in self.value_traces.iter_mut().chain(&mut self.preference_traces) {
            *trace *= decay;
        }
        // The value of an active row: 1 unless it is weighted, when all rows are active.
        let value_of = |row: u32| if R::WEIGHTED { state.values()[row as usize] } else { 1.0 };
        for &row in state.as_ref() {
            let position = self.position(row, num_actions);
            self.value_traces[position] += value_of(row);
        }
        let gradient = agent.log_gradient(state, action);
        for &row in state.as_ref() {
            let first = self.positions[row as usize] as usize * num_actions;
            for (trace, part) in self.preference_traces[first..][..num_actions].iter_mut().zip(gradient) {
                *trace += self.power * part * value_of(row);
            }
        }
        let step = agent.learning_rate.shared() * error;
        let traces = self.value_traces.iter().zip(self.preference_traces.chunks_exact(num_actions));
        for (&row, (value_trace, preference_traces)) in self.visited.iter().zip(traces) {
            let value_step = if R::WEIGHTED { self.critic.step_size_of(row) } else { self.critic.step_size };
            let step = if R::WEIGHTED { agent.learning_rate.of_row(row as usize) * error } else { step };
            self.critic.add(row, value_step * error * value_trace);
            for (action, trace) in preference_traces.iter().enumerate() {
                *agent.table.value_mut(row, action) += step * trace;
            }
        }
        self.power *= agent.discount;
        agent.next_action(next, rng)
    }

    #[inline]
    fn work(&self, row_work: u64) -> u64 {
        row_work + (self.value_traces.len() + self.preference_traces.len()) as u64 / VALUES_PER_WORK
    }

    /// The caller has already accounted for these bytes, which are those of a table.
    fn reserve(&mut self, agent: &mut Agent, _work: u64, _memory: &mut RunMemory) -> Result<(), AllocationError> {
        let (n_rows, num_actions) = agent.table.shape();
        self.make_room(n_rows, num_actions)
    }

    learn_borrowed!(Agent);

    fn second_table(&self) -> Option<&QTable> {
        Some(&self.critic.table)
    }

    fn second_table_mut(&mut self) -> Option<&mut QTable> {
        Some(&mut self.critic.table)
    }

    fn end_episode(&mut self, _agent: &mut Agent) {
        self.clear();
    }

    fn persist(
        &mut self,
        (num_rows, num_actions): (usize, usize),
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), CheckpointError> {
        let mut count = self.visited.len();
        checkpoint.index(&mut count, num_rows + 1, "number of rows")?;
        if checkpoint.is_restoring() {
            self.clear();
            self.make_room(num_rows, num_actions).map_err(|_| CheckpointError::OutOfMemory)?;
        }
        for index in 0..count {
            let mut row = self.visited.get(index).copied().unwrap_or_default();
            checkpoint.index_u32(&mut row, num_rows, "row")?;
            checkpoint.check(self.position(row, num_actions) == index, "row")?;
        }
        self.power.persist(checkpoint)?;
        self.value_traces.persist(checkpoint)?;
        self.preference_traces.persist(checkpoint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::test_support::{agent, rng};
    use crate::learners::{Learner, TdLearner};
    use crate::policies::AnyPolicy;

    #[test]
    fn an_error_updates_earlier_states_along_the_traces() {
        let agent = Agent { policy: AnyPolicy::softmax(1.0, 2), ..agent(&[0.0; 4]) };
        let critic = Critic::new(QTable::new(vec![1.0, 1.0, 4.0, 4.0], 2), 0.25, &agent.learning_rate);
        let rule = ActorCriticLambda::new(critic, 0.5, &StopFlag::new()).expect("two rows");
        let mut learner = TdLearner { agent, rule };
        learner.rule.make_room(2, 2).expect("two rows");
        // δ = 3 + 0.5 · 4 - 1
        learner.learn([0], 0, 3.0, Next::NonTerminal([1]), &mut rng());
        assert_eq!(learner.agent.table.values(), [1.0, -1.0, 0.0, 0.0]);
        // δ = 8 - 4, I = 0.5, and the first state's traces are a quarter of 1 and of ±0.5
        learner.learn([1], 0, 8.0, Next::Terminal, &mut rng());
        assert_eq!(learner.agent.table.values(), [1.25, -1.25, 0.5, -0.5]);
        assert_eq!(Learner::<[u32; 1]>::tables(&learner)[1], [2.25, 2.25, 5.0, 5.0]);
    }
}

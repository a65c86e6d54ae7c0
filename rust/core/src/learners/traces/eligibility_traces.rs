//! The operations of a learner on its traces, whatever its features.

use super::{TraceKind, Traces};
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::features::ActiveFeatures;
use crate::learners::{Agent, masked_values};
use crate::memory::AllocationError;
use crate::policies::{Policy, assert_takes};
use crate::q_table::QTable;
use crate::random::Rng;
use crate::schedules::LearningRate;
use crate::tasks::Next;

/// The traces z of an update rule: [`Traces`] for binary features, of which a few are active, and
/// [`DenseTraces`](super::dense_traces::DenseTraces) for weighted features, all of which are active.
pub(super) trait EligibilityTraces {
    /// Begins a step, in which values are read with the methods of this trait.
    fn begin_step(&mut self, table: &mut QTable);

    /// Changes the traces for a visit to (S, A). Returns Q(S, A).
    fn visit<R: ActiveFeatures>(&mut self, kind: TraceKind, table: &mut QTable, state: R, action: usize) -> f64;

    /// The action values of a state.
    fn action_values<'a, R: ActiveFeatures>(&self, table: &'a mut QTable, state: R) -> &'a [f64];

    /// Q(S, A).
    fn value<R: ActiveFeatures>(&self, table: &QTable, state: &R, action: usize) -> f64;

    /// γλ Σᵢ αᵢ zᵢ xᵢ, where `decay` is γλ and x belongs to (S, A).
    fn overlap<R: ActiveFeatures>(
        &self,
        table: &QTable,
        learning_rate: &LearningRate,
        pair: (&R, usize),
        decay: f64,
    ) -> f64;

    /// z ← z + increment x.
    fn add<R: ActiveFeatures>(&mut self, table: &mut QTable, pair: (&R, usize), increment: f64);

    /// w ← w + α δ z.
    fn apply_td_error(&mut self, table: &mut QTable, learning_rate: &LearningRate, error: f64);

    /// z ← γλ z, where `factor` is γλ; traces whose magnitudes fall to the cutoff become 0.
    fn decay(&mut self, table: &mut QTable, factor: f64);

    /// [`apply_td_error`](Self::apply_td_error) and [`decay`](Self::decay) in one pass.
    fn apply_td_error_and_decay(&mut self, table: &mut QTable, learning_rate: &LearningRate, error: f64, factor: f64);

    /// w ← w - α change x.
    fn subtract<R: ActiveFeatures>(
        &self,
        table: &mut QTable,
        learning_rate: &LearningRate,
        pair: (&R, usize),
        change: f64,
    );

    /// z ← 0.
    fn clear(&mut self, table: &mut QTable);

    /// Samples A′ in the next state S′ and returns it with Q(S′, A′); `None` if S′ is terminal. If the episode is
    /// truncated, A′ is sampled for its value and never taken.
    #[inline(always)]
    fn sample_next<R: ActiveFeatures>(
        &self,
        agent: &mut Agent,
        next: Next<R>,
        rng: &mut impl Rng,
    ) -> Option<(usize, f64)> {
        let (Next::NonTerminal(next_state) | Next::Truncated(next_state)) = next else { return None };
        assert_takes(&agent.policy, &next_state);
        let values = self.action_values(&mut agent.table, &next_state);
        let next_action = agent.policy.choose_in(
            next_state.as_ref(),
            masked_values::<0>(&mut agent.masks, next_state.as_ref(), values),
            rng,
        );
        Some((next_action, values[next_action]))
    }
}

impl Traces {
    /// The trace of a weight for features `R`: [`get`](Self::get) for binary features.
    #[inline]
    pub fn get_of<R: ActiveFeatures>(&self, weight_index: usize) -> f64 {
        if R::WEIGHTED { self.dense.get(weight_index) } else { self.get(weight_index) }
    }

    /// [`pass_len`](Self::pass_len) of the traces for features `R`.
    #[inline(always)]
    pub(super) fn pass_len_of<R: ActiveFeatures>(&self) -> usize {
        if R::WEIGHTED { self.dense.pass_len() } else { self.pass_len() }
    }

    /// [`clear`](Self::clear) for features `R`.
    #[inline(always)]
    pub(super) fn clear_of<R: ActiveFeatures>(&mut self, table: &mut QTable) {
        if R::WEIGHTED { self.dense.clear(table) } else { self.clear(table) }
    }

    /// [`reserve`](Self::reserve) for features `R`.
    pub(super) fn reserve_of<R: ActiveFeatures>(&mut self, table: &mut QTable) -> Result<(), AllocationError> {
        if R::WEIGHTED { self.dense.reserve(table) } else { self.reserve(table) }
    }

    /// Saves or restores the traces for features `R` and a table of so many rows and actions.
    pub(super) fn persist_of<R: ActiveFeatures>(
        &mut self,
        (num_rows, num_actions): (usize, usize),
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), CheckpointError> {
        if R::WEIGHTED { self.dense.persist(num_rows * num_actions, checkpoint) } else { self.persist(checkpoint) }
    }
}

impl EligibilityTraces for Traces {
    #[inline(always)]
    fn begin_step(&mut self, table: &mut QTable) {
        Self::begin_step(self, table);
    }

    #[inline(always)]
    fn visit<R: ActiveFeatures>(&mut self, kind: TraceKind, table: &mut QTable, state: R, action: usize) -> f64 {
        Self::visit(self, kind, table, state, action)
    }

    #[inline(always)]
    fn action_values<'a, R: ActiveFeatures>(&self, table: &'a mut QTable, state: R) -> &'a [f64] {
        Self::action_values(self, table, state)
    }

    #[inline(always)]
    fn value<R: ActiveFeatures>(&self, table: &QTable, state: &R, action: usize) -> f64 {
        Self::value(self, table, state.as_ref(), action)
    }

    /// One step size belongs to all weights.
    #[inline(always)]
    fn overlap<R: ActiveFeatures>(
        &self,
        table: &QTable,
        learning_rate: &LearningRate,
        (state, action): (&R, usize),
        decay: f64,
    ) -> f64 {
        learning_rate.shared() * decay * self.sum(table, state.as_ref(), action)
    }

    #[inline(always)]
    fn add<R: ActiveFeatures>(&mut self, table: &mut QTable, (state, action): (&R, usize), increment: f64) {
        self.update(table, state, action, |trace| trace + increment);
    }

    #[inline(always)]
    fn apply_td_error(&mut self, table: &mut QTable, learning_rate: &LearningRate, error: f64) {
        Self::apply_td_error(self, table, learning_rate, error);
    }

    #[inline(always)]
    fn decay(&mut self, table: &mut QTable, factor: f64) {
        Self::decay(self, table, factor);
    }

    #[inline(always)]
    fn apply_td_error_and_decay(&mut self, table: &mut QTable, learning_rate: &LearningRate, error: f64, factor: f64) {
        Self::apply_td_error_and_decay(self, table, learning_rate, error, factor);
    }

    #[inline(always)]
    fn subtract<R: ActiveFeatures>(
        &self,
        table: &mut QTable,
        learning_rate: &LearningRate,
        (state, action): (&R, usize),
        change: f64,
    ) {
        Self::subtract(self, table, state.as_ref(), action, learning_rate.shared() * change);
    }

    #[inline(always)]
    fn clear(&mut self, table: &mut QTable) {
        Self::clear(self, table);
    }
}

/// Implements what update rules with `traces` have in common for features `R`: learning from borrowed features, the work of a
/// pass, completing the table, and reserving memory.
macro_rules! has_traces {
    () => {
        $crate::learners::learn_borrowed!(Agent);

        #[inline]
        fn work(&self, row_work: u64) -> u64 {
            row_work + self.traces.pass_len_of::<R>() as u64 / $crate::learners::VALUES_PER_WORK
        }

        fn complete_tables(&mut self, agent: &mut Agent) {
            self.traces.complete_table(&mut agent.table);
        }

        fn reserve(
            &mut self,
            agent: &mut Agent,
            _work: u64,
            _memory: &mut $crate::memory::RunMemory,
        ) -> Result<(), $crate::memory::AllocationError> {
            self.traces.reserve_of::<R>(&mut agent.table)
        }
    };
}

pub(super) use has_traces;

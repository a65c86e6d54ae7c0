//! Eligibility traces, stored sparsely: a step takes time in proportion to the number of active traces, not to the size
//! of the table.

use super::eligible_weights::EligibleWeights;
use crate::StopFlag;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::learners::{Agent, masked_values};
use crate::memory::AllocationError;
use crate::policies::Policy;
use crate::q_table::QTable;
use crate::random::Rng;
use crate::schedules::{LearningRate, StepSize};
#[cfg(test)]
use crate::simd::SimdLevel;
use crate::tasks::Next;

/// The effect of a visit to a state-action pair on its traces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TraceKind {
    /// Adds 1 to the traces of the pair (Sutton & Barto, section 12.7).
    Accumulating,
    /// Sets the traces of the pair to 1 (S. Singh and R. Sutton, 1996).
    Replacing,
    /// Sets the traces of the pair to 1 and those of the other actions in that state to 0 (the same paper).
    Clearing,
}

/// The options of an algorithm with eligibility traces of a chosen kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TraceOptions {
    /// The effect of a visit on the traces.
    pub kind: TraceKind,
    /// The trace decay λ.
    pub decay: f64,
    /// Traces at or below this are dropped.
    pub cutoff: f64,
}

/// Replacing traces with λ = 0.9, none of which is dropped.
impl Default for TraceOptions {
    fn default() -> Self {
        Self { kind: TraceKind::Replacing, decay: 0.9, cutoff: 0.0 }
    }
}

/// The trace vector z, with one trace per weight. A trace whose magnitude falls to the cutoff becomes 0.
///
/// From [`begin_step`](Self::begin_step) until [`complete_table`](Self::complete_table), the values of the weights
/// whose traces are active are not in the rows of the table, and are read with [`action_values`](Self::action_values).
#[derive(Clone, Debug, PartialEq)]
pub struct Traces {
    eligible: EligibleWeights,
}

impl Traces {
    /// Traces of `weights` weights, all 0. There is room for all of them, so a step cannot run out of memory.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn new(weights: usize, cutoff: f64, stop: &StopFlag<'_>) -> Result<Self, AllocationError> {
        Ok(Self { eligible: EligibleWeights::new(weights, cutoff, stop)? })
    }

    /// Sets the instructions of passes over these traces. The default is the best of the machine.
    #[cfg(test)]
    pub(super) fn set_level(&mut self, level: SimdLevel) {
        (self.eligible.level, self.eligible.long_pass_level) = (level, level);
    }

    /// Makes room in the table for the values of the weights with traces.
    ///
    /// # Errors
    /// `OutOfMemory`.
    pub fn reserve<const N: usize>(&self, table: &mut QTable<N>) -> Result<(), AllocationError> {
        self.eligible.reserve(table)
    }

    /// The number of traces that a pass goes over: the active ones, and some that have become 0.
    pub fn pass_len(&self) -> usize {
        self.eligible.count
    }

    /// Whether no trace is active.
    #[cfg(test)]
    pub(in crate::learners) fn is_empty(&self) -> bool {
        self.eligible.num_eligible() == 0
    }

    /// The trace of a weight.
    #[inline(always)]
    pub fn get(&self, weight_index: usize) -> f64 {
        self.eligible.trace(weight_index)
    }

    /// The sum of the traces of a state-action pair, from left to right.
    #[inline(always)]
    pub fn sum<const N: usize>(&self, table: &QTable<N>, rows: &[u32], action: usize) -> f64 {
        rows.iter().fold(0.0, |sum, &row| sum + self.get(table.weight_index(row, action)))
    }

    /// Begins a step: the values of the weights whose traces are active move out of the rows of the table.
    #[inline(always)]
    pub fn begin_step<const N: usize>(&mut self, table: &mut QTable<N>) {
        self.eligible.move_out(table);
    }

    /// Changes the traces for a visit to a state-action pair. Returns Q(S, A).
    #[inline(always)]
    pub fn visit<const N: usize>(
        &mut self,
        kind: TraceKind,
        table: &mut QTable<N>,
        rows: impl AsRef<[u32]>,
        action: usize,
    ) -> f64 {
        if kind == TraceKind::Accumulating {
            return self.update(table, rows, action, |trace| trace + 1.0);
        }
        let value = self.replace(table, &rows, action);
        if kind == TraceKind::Clearing {
            for &row in rows.as_ref() {
                for other in (0..table.num_actions()).filter(|&other| other != action) {
                    self.eligible.remove_weight(table, table.weight_index(row, other));
                }
            }
        }
        value
    }

    /// Replaces the traces of a state-action pair by a function of each. They become active. Returns Q(S, A).
    #[inline(always)]
    pub fn update<const N: usize>(
        &mut self,
        table: &mut QTable<N>,
        rows: impl AsRef<[u32]>,
        action: usize,
        change: impl Fn(f64) -> f64,
    ) -> f64 {
        let num_actions = table.num_actions();
        let weights = rows.as_ref().iter().map(|&row| row as usize * num_actions + action);
        self.eligible.update(table, weights, change)
    }

    /// Sets the traces of a state-action pair to 1. Returns Q(S, A).
    #[inline(always)]
    fn replace<const N: usize>(&mut self, table: &mut QTable<N>, rows: impl AsRef<[u32]>, action: usize) -> f64 {
        let weights = weight_indices(rows.as_ref(), table.num_actions(), action);
        self.eligible.replace(table, weights)
    }

    /// The action values of a state, as [`QTable::action_values`].
    #[inline(always)]
    pub fn action_values<'a, const N: usize>(&self, table: &'a mut QTable<N>, rows: impl AsRef<[u32]>) -> &'a [f64] {
        table.values_at(self.eligible.slots(), &rows)
    }

    /// Q(S, A), as [`QTable::value`].
    #[inline(always)]
    pub fn value<const N: usize>(&self, table: &QTable<N>, rows: &[u32], action: usize) -> f64 {
        table.value_at(self.eligible.slots(), rows, action)
    }

    /// Samples A′ in the next state S′ and returns it with Q(S′, A′); `None` if S′ is terminal. If the episode is
    /// truncated, A′ is sampled for its value and never taken.
    #[inline(always)]
    pub fn sample_next<R: AsRef<[u32]>>(
        &self,
        agent: &mut Agent,
        next: Next<R>,
        rng: &mut impl Rng,
    ) -> Option<(usize, f64)> {
        let (Next::NonTerminal(next_state) | Next::Truncated(next_state)) = next else { return None };
        let values = self.action_values(&mut agent.table, &next_state);
        let next_action = agent.policy.choose_in(
            next_state.as_ref(),
            masked_values::<0>(&mut agent.masks, next_state.as_ref(), values),
            rng,
        );
        Some((next_action, values[next_action]))
    }

    /// Subtracts a number from the weights of a state-action pair, whose traces must be active.
    #[inline(always)]
    pub fn subtract<const N: usize>(&self, table: &mut QTable<N>, rows: &[u32], action: usize, number: f64) {
        for &row in rows {
            let slot = self.eligible.slots()[table.weight_index(row, action)];
            table.storage_mut()[slot as usize] -= number;
        }
    }

    /// w ← w + α δ z.
    #[inline(always)]
    pub fn apply_td_error<const N: usize>(&mut self, table: &mut QTable<N>, learning_rate: &LearningRate, error: f64) {
        match learning_rate.uniform() {
            Some(step_size) => self.eligible.apply(table, step_size * error),
            None => self.eligible.apply_each(table, |weight, trace| learning_rate.at(weight) * error * trace),
        }
    }

    /// z ← γλ z, where `factor` is γλ.
    #[inline(always)]
    pub fn decay<const N: usize>(&mut self, table: &mut QTable<N>, factor: f64) {
        self.eligible.decay(table, factor);
    }

    /// w ← w + α δ z and z ← γλ z in one pass.
    #[inline(always)]
    pub fn apply_td_error_and_decay<const N: usize>(
        &mut self,
        table: &mut QTable<N>,
        learning_rate: &LearningRate,
        error: f64,
        factor: f64,
    ) {
        if let Some(step_size) = learning_rate.uniform() {
            self.eligible.apply_and_decay(table, step_size * error, factor);
        } else {
            self.apply_td_error(table, learning_rate, error);
            self.decay(table, factor);
        }
    }

    /// z ← 0.
    pub fn clear<const N: usize>(&mut self, table: &mut QTable<N>) {
        self.eligible.clear(table);
    }

    /// Moves all values back into the rows of the table.
    pub fn complete_table<const N: usize>(&mut self, table: &mut QTable<N>) {
        self.eligible.move_back(table);
    }
}

/// The indices of the weights of a state-action pair: [`QTable::weight_index`] in 32 bits, which suffice for all
/// weights with traces, because a vector register holds more such indices.
#[inline(always)]
fn weight_indices(rows: &[u32], num_actions: usize, action: usize) -> impl ExactSizeIterator<Item = u32> {
    let (num_actions, action) = (num_actions as u32, action as u32);
    rows.iter().map(move |&row| row * num_actions + action)
}

/// Saves the active traces in the order of their weights, because their places depend on the history of the run.
impl Persist for Traces {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        let weights = self.eligible.num_weights();
        let mut count = self.eligible.num_eligible();
        checkpoint.index(&mut count, weights + 1, "number of traces")?;
        if !checkpoint.is_restoring() {
            for weight in 0..weights {
                let trace = self.get(weight);
                if trace != 0.0 {
                    persist_trace(checkpoint, weights, (weight as u32, trace))?;
                }
            }
            return Ok(());
        }
        self.eligible.discard();
        for _ in 0..count {
            let (weight, trace) = persist_trace(checkpoint, weights, (0, 0.0))?;
            if self.eligible.place(weight as usize).is_some() {
                return Err(CheckpointError::Invalid("weight of two traces"));
            }
            self.eligible.insert(weight, trace);
        }
        Ok(())
    }
}

/// Saves or restores the index of a weight and its trace.
fn persist_trace(
    checkpoint: &mut Checkpoint<'_>,
    weights: usize,
    (mut weight, mut trace): (u32, f64),
) -> Result<(u32, f64), CheckpointError> {
    checkpoint.index_u32(&mut weight, weights, "weight of a trace")?;
    trace.persist(checkpoint)?;
    Ok((weight, trace))
}

//! A model of a stochastic environment: how often each outcome followed each state-action pair.

use super::{DynaModel, Model, ModelEntry, PlanningProgress};
use crate::StopFlag;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::memory::{AllocationError, filled, reserve};
use crate::random::Rng;

/// The end of a list.
const NONE: u32 = u32::MAX;

/// What followed a pair, how often, and the next outcome of the same pair.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CountedOutcome {
    entry: ModelEntry,
    count: u32,
    after: u32,
}

/// The outcomes of each pair in the order in which they were first seen, with their counts.
#[derive(Clone, Debug, PartialEq)]
pub struct StochasticModel {
    /// Which pairs were tried, and in which order.
    tried: Model,
    /// The first outcome of each pair.
    first: Vec<u32>,
    /// How often each pair was tried.
    totals: Vec<u32>,
    outcomes: Vec<CountedOutcome>,
}

impl StochasticModel {
    /// An empty model, with room for all pairs.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn new(rows: usize, num_actions: usize, stop: &StopFlag<'_>) -> Result<Self, AllocationError> {
        let (pairs, tried) = (rows * num_actions, Model::new(rows, num_actions, stop)?);
        Ok(Self { tried, first: filled(&NONE, pairs, stop)?, totals: filled(&0, pairs, stop)?, outcomes: Vec::new() })
    }

    /// Counts an outcome so many times more.
    fn count(&mut self, pair: usize, entry: ModelEntry, times: u32) {
        self.totals[pair] = self.totals[pair].saturating_add(times);
        let (mut last, mut next) = (NONE, self.first[pair]);
        while next != NONE {
            let outcome = &mut self.outcomes[next as usize];
            if outcome.entry == entry {
                outcome.count = outcome.count.saturating_add(times);
                return;
            }
            (last, next) = (next, outcome.after);
        }
        let index = self.outcomes.len() as u32;
        self.outcomes.push(CountedOutcome { entry, count: times, after: NONE });
        if last == NONE {
            self.first[pair] = index;
        } else {
            self.outcomes[last as usize].after = index;
        }
    }

    /// The outcomes of a pair.
    fn of(&self, pair: usize) -> impl Iterator<Item = &CountedOutcome> {
        let at = |index: u32| self.outcomes.get(index as usize);
        std::iter::successors(at(self.first[pair]), move |outcome| at(outcome.after))
    }
}

impl DynaModel for StochasticModel {
    fn num_actions(&self) -> usize {
        self.tried.num_actions()
    }

    fn record(&mut self, row: u32, action: usize, entry: ModelEntry) {
        self.tried.record(row, action, entry);
        self.count(row as usize * self.tried.num_actions() + action, entry, 1);
    }

    #[inline]
    fn sample_state(&self, rng: &mut impl Rng) -> u32 {
        self.tried.sample_state(rng)
    }

    #[inline]
    fn sample_action(&self, row: u32, rng: &mut impl Rng) -> usize {
        self.tried.sample_action(row, rng)
    }

    /// Draws one `integers` of the number of times that the pair was tried.
    fn sample(&self, row: u32, action: usize, rng: &mut impl Rng) -> Option<ModelEntry> {
        let pair = row as usize * self.tried.num_actions() + action;
        let mut left = rng.integers(self.totals[pair].max(1));
        for outcome in self.of(pair) {
            if left < outcome.count {
                return Some(outcome.entry);
            }
            left -= outcome.count;
        }
        None
    }

    fn reserve(&mut self, transitions: u64) -> Result<(), AllocationError> {
        reserve(&mut self.outcomes, usize::try_from(transitions).unwrap_or(usize::MAX))
    }

    fn check_planning(&self, progress: &PlanningProgress) -> Result<(), CheckpointError> {
        self.tried.check_planning(progress)
    }
}

/// The outcomes of each pair that was tried, in the order of the pairs.
impl Persist for StochasticModel {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        const INVALID: CheckpointError = CheckpointError::Invalid("outcome of the model");
        self.tried.persist(checkpoint)?;
        let saved = if checkpoint.is_restoring() {
            self.first.fill(NONE);
            self.totals.fill(0);
            self.outcomes.clear();
            None
        } else {
            Some(self.clone())
        };
        let num_actions = self.tried.num_actions();
        let num_rows = self.first.len() / num_actions;
        for pair in 0..self.first.len() {
            if self.tried.entry((pair / num_actions) as u32, pair % num_actions).is_none() {
                continue;
            }
            let mut known = saved.iter().flat_map(|saved| saved.of(pair));
            let mut count = saved.as_ref().map_or(0, |saved| saved.of(pair).count());
            checkpoint.index(&mut count, usize::MAX, "number of outcomes")?;
            if count == 0 {
                return Err(INVALID);
            }
            for _ in 0..count {
                let empty = CountedOutcome { entry: ModelEntry { reward: 0.0, next: None }, count: 0, after: NONE };
                let CountedOutcome { entry: ModelEntry { mut reward, mut next }, mut count, .. } =
                    known.next().copied().unwrap_or(empty);
                (&mut reward, &mut next, &mut count).persist(checkpoint)?;
                if checkpoint.is_restoring() {
                    let in_table = next.is_none_or(|next| (next as usize) < num_rows);
                    if !in_table || count == 0 || self.totals[pair].checked_add(count).is_none() {
                        return Err(INVALID);
                    }
                    self.outcomes.try_reserve(1).map_err(|_| CheckpointError::OutOfMemory)?;
                    self.count(pair, ModelEntry { reward, next }, count);
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::common::test_support::rng;

    #[test]
    fn outcomes_are_sampled_as_often_as_they_were_seen() {
        let mut model = StochasticModel::new(2, 2, &StopFlag::new()).expect("a few pairs");
        let often = ModelEntry { reward: 1.0, next: Some(1) };
        let rare = ModelEntry { reward: 1.0, next: None };
        for entry in [often, rare, often, often] {
            model.record(0, 1, entry);
        }
        let mut rng = rng();
        let sampled = (0..4000).filter(|_| model.sample(0, 1, &mut rng) == Some(often)).count();
        assert!((2900..3100).contains(&sampled), "{sampled}");
        assert_eq!(model.sample(0, 0, &mut rng), None);
    }
}

//! Batch TD(0) (Sutton & Barto, section 6.3): all episodes so far, presented again and again until the values settle.

use std::collections::HashMap;

use super::{LinearValues, PredictionRule, PredictionStep};
use crate::learners::StepInParts;
use crate::memory::{AllocationError, RunMemory};
use crate::tasks::Next;

/// A value has settled when the sum of its errors in a presentation is at most this fraction of the largest sum of the
/// magnitudes of their terms since the last episode. Each row has its own sum, so large values of other rows do not
/// matter.
const SETTLED: f64 = 1e-12;
/// The number of transitions that are read in the time of one unit of work.
const TRANSITIONS_PER_WORK: u64 = 4;

/// The reward and the next row, which is `None` at a terminal state.
type Outcome = (f64, Option<u32>);

/// After each episode, until the values settle: v(s) ← v(s) + the mean of R + γ v(S′) - v(s) over all visits of s so
/// far.
///
/// The book instead sums the errors, multiplied by a small α. Both settle at the same values, those of the
/// maximum-likelihood model of the data. Equal transitions are counted, and read once per presentation.
#[derive(Clone, Debug, PartialEq)]
pub struct BatchTd {
    /// Each transition with the number of its occurrences, in the order of first occurrence.
    transitions: Vec<(u32, Outcome, f64)>,
    /// The index of each transition in the list, by its row, the bits of its reward, and its next row plus 1, or 0.
    places: HashMap<(u32, u64, u64), usize>,
    /// The number of visits of each row.
    visits: Vec<f64>,
    /// The sum of the errors of each row in this presentation.
    errors: Vec<f64>,
    /// The sum of the magnitudes of the terms of these errors.
    sizes: Vec<f64>,
    /// The largest of these sums since the last episode, so that values that fall to 0 settle, too.
    largest_sizes: Vec<f64>,
    /// Whether every row is known to lead to an end.
    leads_to_end: bool,
    /// The presentations since the last episode.
    settling: StepInParts,
}

impl BatchTd {
    /// Batch TD before the first episode. `rows` is the number of rows.
    pub fn new(rows: usize) -> Self {
        Self {
            transitions: Vec::new(),
            places: HashMap::new(),
            visits: vec![0.0; rows],
            errors: vec![0.0; rows],
            sizes: vec![0.0; rows],
            largest_sizes: vec![0.0; rows],
            leads_to_end: false,
            settling: StepInParts::new(),
        }
    }

    /// Presents all transitions once. Returns whether the values have settled.
    fn present(&mut self, values: &mut LinearValues) -> bool {
        self.errors.fill(0.0);
        self.sizes.fill(0.0);
        for &(row, (reward, next), count) in &self.transitions {
            let (row, value) = (row as usize, values.weights[row as usize]);
            let bootstrap = values.discount * next.map_or(0.0, |next| values.weights[next as usize]);
            self.errors[row] += count * (reward + bootstrap - value);
            self.sizes[row] += count * (reward.abs() + bootstrap.abs() + value.abs());
        }
        let (mut settled, mut finite) = (true, true);
        let sums = self.errors.iter().zip(&self.sizes).zip(&mut self.largest_sizes).zip(&self.visits);
        for (value, (((error, size), largest_size), &visits)) in values.weights.iter_mut().zip(sums) {
            if visits > 0.0 {
                *value += error / visits;
                *largest_size = largest_size.max(*size);
                settled &= error.abs() <= SETTLED * *largest_size;
                finite &= error.is_finite();
            }
        }
        if !finite {
            values.give_up();
        }
        settled || values.diverged()
    }

    /// Whether a path of transitions leads from each row to an end: a terminal state, or a row without transitions,
    /// whose value does not change. Otherwise, without discounting, the values grow forever.
    fn every_row_leads_to_an_end(&self) -> bool {
        let mut leads: Vec<bool> = self.visits.iter().map(|&visits| visits == 0.0).collect();
        let mut found = true;
        while found {
            found = false;
            for &(row, (_, next), _) in &self.transitions {
                if !leads[row as usize] && next.is_none_or(|next| leads[next as usize]) {
                    leads[row as usize] = true;
                    found = true;
                }
            }
        }
        leads.iter().all(|&leads| leads)
    }
}

impl PredictionRule for BatchTd {
    fn learn(&mut self, values: &mut LinearValues, step: PredictionStep) {
        let row = values.features.first(step.state) as u32;
        let next = match step.next {
            Next::NonTerminal(next) | Next::Truncated(next) => Some(values.features.first(next) as u32),
            Next::Terminal => None,
        };
        let key = (row, step.reward.to_bits(), next.map_or(0, |next| u64::from(next) + 1));
        let place = *self.places.entry(key).or_insert(self.transitions.len());
        if place == self.transitions.len() {
            self.transitions.push((row, (step.reward, next), 0.0));
        }
        self.transitions[place].2 += 1.0;
        self.visits[row as usize] += 1.0;
        if step.is_last() {
            self.leads_to_end = false;
            self.largest_sizes.fill(0.0);
            self.resume(values);
        } else {
            self.settling.clear();
        }
    }

    fn work(&self) -> u64 {
        1 + self.settling.work()
    }

    /// With continuous rewards, each step is a different transition.
    fn reserve(&mut self, steps: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        let steps = usize::try_from(steps).unwrap_or(usize::MAX);
        memory.reserve(&mut self.transitions, steps)?;
        memory.reserve(&mut self.places, steps)
    }

    fn is_unfinished(&self) -> bool {
        self.settling.is_unfinished()
    }

    fn resume(&mut self, values: &mut LinearValues) {
        let work = 1 + (self.transitions.len() + self.visits.len()) as u64 / TRANSITIONS_PER_WORK;
        let mut settling = self.settling;
        settling.advance(|| (work, !self.present(values)));
        self.settling = settling;
        // Most episodes settle in one call, and need no search.
        if self.settling.is_unfinished() && values.discount >= 1.0 && !self.leads_to_end {
            self.leads_to_end = self.every_row_leads_to_an_end();
            if !self.leads_to_end {
                values.give_up();
                self.settling.clear();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::{Growing, MemoryRoom};
    use crate::prediction::test_support::{last, predictor, step};

    #[test]
    fn without_an_end_the_values_diverge_unless_they_are_discounted() {
        for (discount, diverged) in [(1.0, true), (0.9, false)] {
            let mut learner = predictor(&[0.0, 0.0], BatchTd::new(2));
            learner.values.discount = discount;
            learner.rule.learn(&mut learner.values, step(0, -1.0, 1));
            let cut_off = PredictionStep { next: Next::Truncated(0), ..last(1, -1.0) };
            learner.rule.learn(&mut learner.values, cut_off);
            assert!(!learner.rule.settling.is_unfinished());
            assert_eq!(learner.values.diverged(), diverged);
        }
    }

    #[test]
    fn continuous_rewards_stop_at_the_memory_limit() {
        let (mut learner, mut memory) =
            (predictor(&[0.0, 0.0], BatchTd::new(2)), RunMemory::new(MemoryRoom::new(100_000, 100_000)));
        let mut stored = 0;
        let refused = loop {
            let reserved = learner.rule.reserve(100, &mut memory);
            if let Err(refused) = reserved {
                break refused;
            }
            for _ in 0..100 {
                stored += 1;
                learner.rule.learn(&mut learner.values, step(0, f64::from(stored), 1));
            }
        };
        assert_eq!(refused, AllocationError::LimitReached { limit: 100_000, growing: Growing::Learner });
        assert!((300..3000).contains(&stored), "{stored}");
    }

    #[test]
    fn a_row_settles_whatever_the_values_of_others() {
        let mut learner = predictor(&[0.0; 5], BatchTd::new(5));
        learner.values.discount = 1.0;
        learner.rule.learn(&mut learner.values, last(4, -1e13));
        for state in 0..3 {
            learner.rule.learn(&mut learner.values, step(state, -1.0, state + 1));
        }
        learner.rule.learn(&mut learner.values, last(3, -1.0));
        while learner.rule.settling.is_unfinished() {
            learner.rule.resume(&mut learner.values);
        }
        assert_eq!(learner.values.weights, [-4.0, -3.0, -2.0, -1.0, -1e13]);
    }

    /// Example 6.4: eight episodes. Batch TD finds V(A) = 3/4, whereas the average of the returns is 0.
    #[test]
    fn you_are_the_predictor() {
        let mut learner = predictor(&[0.0, 0.0], BatchTd::new(2));
        learner.values.discount = 1.0;
        let episodes = [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0];
        learner.rule.learn(&mut learner.values, step(0, 0.0, 1));
        learner.rule.learn(&mut learner.values, last(1, 0.0));
        for reward in episodes {
            learner.rule.learn(&mut learner.values, last(1, reward));
        }
        assert!(!learner.rule.settling.is_unfinished());
        for value in learner.values.weights {
            assert!((value - 0.75).abs() < 1e-11, "{value}");
        }
    }
}

//! The steps of an episode, for methods that learn at its end.

use super::{LinearValues, PredictionStep};
use crate::memory::{AllocationError, RunMemory};
use crate::tasks::Next;

/// A step of an episode, without the data that only some methods need: with the ratio of importance sampling, Monte
/// Carlo prediction took 18 % more time on a random walk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EpisodeVisit {
    pub(super) state: u32,
    /// Whether the state had not been visited before in this episode.
    pub(super) first: bool,
    pub(super) reward: f64,
}

/// The steps of an episode, and its returns once it is over.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Episode {
    pub(super) visits: Vec<EpisodeVisit>,
    /// G of each step, once the episode is over.
    pub(super) returns: Vec<f64>,
    /// For each state, the number of the last episode that visited it, counted from 1.
    last_visits: Vec<u64>,
    number: u64,
    /// The number of steps of the last finished episode, if no step has followed.
    finished: u64,
}

impl Episode {
    /// An episode without steps. `states` is the number of states; 0 if they are not numbered, so that all visits are
    /// first visits.
    pub(super) fn new(states: usize) -> Self {
        Self { last_visits: vec![0; states], number: 1, ..Self::default() }
    }

    /// Adds a step. Returns whether the episode is over.
    #[inline]
    pub(super) fn push(&mut self, step: PredictionStep) -> bool {
        self.finished = 0;
        let last = self.last_visits.get_mut(step.state as usize);
        let first = last.is_none_or(|last| std::mem::replace(last, self.number) != self.number);
        self.visits.push(EpisodeVisit { state: step.state, first, reward: step.reward });
        step.is_last()
    }

    /// Computes the λ-returns G of all steps, from the last one to the first, with the current values (Sutton & Barto,
    /// equations 12.2 and 12.3): G = R + γ [(1 - λ) v(S′) + λ G′]. With λ = 1 these are the returns. If the time limit
    /// cuts off the episode, the return ends with the value of the last state.
    pub(super) fn compute_returns(&mut self, values: &LinearValues, next: Next<u32>, trace_decay: f64) {
        let bootstrap = values.next_value(next);
        let (mut following, mut value) = (bootstrap, bootstrap);
        self.returns.resize(self.visits.len(), 0.0);
        let steps = self.visits.iter().zip(&mut self.returns).rev();
        // A separate loop: Monte Carlo prediction takes 3 % fewer instructions.
        if trace_decay == 1.0 {
            for (visit, target) in steps {
                following = visit.reward + values.discount * following;
                *target = following;
            }
            return;
        }
        for (visit, target) in steps {
            following = (1.0 - trace_decay) * value + trace_decay * following;
            value = values.value(visit.state);
            following = visit.reward + values.discount * following;
            *target = following;
        }
    }

    /// Discards the steps, for the next episode.
    #[inline]
    pub(super) fn clear(&mut self) {
        self.finished = self.visits.len() as u64;
        self.visits.clear();
        self.number += 1;
    }

    /// The work of the last step.
    #[inline]
    pub(super) fn work(&self) -> u64 {
        1 + self.finished
    }

    /// Reserves memory for this many more steps.
    pub(super) fn reserve(&mut self, steps: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        let (steps, count) = (usize::try_from(steps).unwrap_or(usize::MAX), self.visits.len());
        memory.reserve(&mut self.visits, steps)?;
        let missing = (count + steps).saturating_sub(self.returns.len());
        memory.reserve(&mut self.returns, missing)
    }
}

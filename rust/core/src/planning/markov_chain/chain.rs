//! The Markov chain of a policy on a transition table.

use crate::StopFlag;
use crate::memory::{filled, reserve, with_capacity};
use crate::planning::PlanningError;
use crate::planning::problem::Problem;
use crate::planning::stop_checks::StopChecks;

/// The discounted probabilities of the next states, and the expected reward, of each state.
#[derive(Clone, Debug)]
pub(in crate::planning) struct MarkovChain {
    pub(in crate::planning) discount: f64,
    /// The index of each state's first transition, followed by the number of transitions.
    starts: Vec<usize>,
    /// The next state of each transition, and its probability times the discount.
    transitions: Vec<(u32, f64)>,
    /// The expected reward of a step from each state.
    pub(in crate::planning) rewards: Vec<f64>,
    /// The expected magnitude of the reward of a step from each state.
    pub(super) reward_sizes: Vec<f64>,
    /// The number of outcomes of each state. Terminal outcomes have no transition.
    pub(super) outcomes: Vec<u32>,
    /// Whether an episode can end with the step from each state.
    may_end: Vec<bool>,
}

impl MarkovChain {
    /// `choices` returns the actions that the policy takes in a state, with their probabilities.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub(in crate::planning) fn new<Choices: Iterator<Item = (usize, f64)>>(
        problem: Problem<'_>,
        choices: impl Fn(usize) -> Choices,
    ) -> Result<Self, PlanningError> {
        let Problem { mdp, discount, stop } = problem;
        let num_states = mdp.num_states();
        let mut chain = Self {
            discount,
            starts: with_capacity(num_states + 1)?,
            transitions: Vec::new(),
            rewards: problem.zeros()?,
            reward_sizes: problem.zeros()?,
            outcomes: filled(&0, num_states, stop)?,
            may_end: filled(&false, num_states, stop)?,
        };
        let mut checks = problem.checks();
        for state in 0..num_states {
            chain.starts.push(chain.transitions.len());
            for (action, chosen) in choices(state) {
                for (probability, step) in mdp.outcomes(state, action) {
                    let weight = chosen * probability;
                    chain.rewards[state] += weight * step.reward;
                    chain.reward_sizes[state] += (weight * step.reward).abs();
                    chain.outcomes[state] += 1;
                    if step.terminated {
                        chain.may_end[state] |= weight > 0.0;
                    } else if weight * discount > 0.0 {
                        reserve(&mut chain.transitions, 1)?;
                        chain.transitions.push((step.state, weight * discount));
                    }
                }
            }
            checks.state()?;
        }
        chain.starts.push(chain.transitions.len());
        Ok(chain)
    }

    /// The number of states.
    pub(in crate::planning) fn num_states(&self) -> usize {
        self.rewards.len()
    }

    /// The next states of a state, and their probabilities times the discount.
    pub(super) fn next(&self, state: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.starts[state]..self.starts[state + 1];
        self.transitions[range].iter().map(|&(next, weight)| (next as usize, weight))
    }

    /// The states that only lead to each other and collect no reward. Without discounting their value is 0.
    pub(in crate::planning) fn staying(&self, stop: &StopFlag<'_>) -> Result<Vec<bool>, PlanningError> {
        let mut staying: Vec<bool> = with_capacity(self.num_states())?;
        staying.extend(self.reward_sizes.iter().map(|&size| size == 0.0));
        self.checks(stop).until_stable(self.num_states(), |state| {
            let leaves = staying[state] && self.next(state).any(|(next, _)| !staying[next]);
            staying[state] &= !leaves;
            leaves
        })?;
        Ok(staying)
    }

    /// The states from which an episode can end, or reach one of `goals`.
    pub(in crate::planning) fn reaching(
        &self,
        goals: &[bool],
        stop: &StopFlag<'_>,
    ) -> Result<Vec<bool>, PlanningError> {
        let mut reaching: Vec<bool> = with_capacity(self.num_states())?;
        reaching.extend(goals.iter().zip(&self.may_end).map(|(&goal, &ends)| goal || ends));
        self.checks(stop).until_stable(self.num_states(), |state| {
            let found = !reaching[state] && self.next(state).any(|(next, _)| reaching[next]);
            reaching[state] |= found;
            found
        })?;
        Ok(reaching)
    }

    /// The states that are reachable from a distribution, each after one that leads to it.
    pub(in crate::planning) fn reachable(
        &self,
        initial: &[f64],
        stop: &StopFlag<'_>,
    ) -> Result<Vec<usize>, PlanningError> {
        let mut checks = self.checks(stop);
        let mut reached = filled(&false, self.num_states(), stop)?;
        let mut states = with_capacity(self.num_states())?;
        for (state, &probability) in initial.iter().enumerate() {
            if probability > 0.0 {
                reached[state] = true;
                states.push(state);
            }
        }
        let mut visited = 0;
        while let Some(&state) = states.get(visited) {
            for (next, _) in self.next(state) {
                if !reached[next] {
                    reached[next] = true;
                    states.push(next);
                }
            }
            visited += 1;
            checks.state()?;
        }
        Ok(states)
    }

    /// The transitions reversed, without any other data.
    pub(in crate::planning) fn transposed(&self, stop: &StopFlag<'_>) -> Result<Self, PlanningError> {
        let num_states = self.num_states();
        let mut starts = filled(&0, num_states + 1, stop)?;
        for &(next, _) in &self.transitions {
            starts[next as usize + 1] += 1;
        }
        for state in 0..num_states {
            starts[state + 1] += starts[state];
        }
        let mut places = filled(&0, num_states, stop)?;
        places.copy_from_slice(&starts[..num_states]);
        let mut transitions = filled(&(0, 0.0), self.transitions.len(), stop)?;
        for state in 0..num_states {
            for (next, weight) in self.next(state) {
                transitions[places[next]] = (state as u32, weight);
                places[next] += 1;
            }
        }
        let zeros = || filled(&0.0, num_states, stop);
        Ok(Self {
            discount: self.discount,
            starts,
            transitions,
            rewards: zeros()?,
            reward_sizes: zeros()?,
            outcomes: filled(&0, num_states, stop)?,
            may_end: filled(&false, num_states, stop)?,
        })
    }

    /// c(s) + Σ γ p x(s′), summed from left to right, and the sum of the magnitudes of its terms.
    pub(super) fn sum(&self, state: usize, constant: f64, values: &[f64]) -> (f64, f64) {
        self.next(state).fold((constant, constant.abs()), |(sum, size), (next, weight)| {
            let term = weight * values[next];
            (sum + term, size + term.abs())
        })
    }

    pub(super) fn checks<'a>(&self, stop: &'a StopFlag<'a>) -> StopChecks<'a> {
        StopChecks::new(self.transitions.len(), self.num_states(), stop)
    }
}

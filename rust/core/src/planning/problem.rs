//! A planning problem, with the Bellman equations that all methods share.

use super::PlanningError;
use super::stop_checks::StopChecks;
use crate::StopFlag;
use crate::envs::Env;
use crate::envs::tabular::TabularMdp;
use crate::memory::{AllocationError, filled, with_capacity};

/// A table, the discount γ of its returns, and the flag that stops the planning.
#[derive(Clone, Copy)]
pub(super) struct Problem<'a> {
    pub(super) mdp: &'a TabularMdp,
    pub(super) discount: f64,
    pub(super) stop: &'a StopFlag<'a>,
}

impl<'a> Problem<'a> {
    /// A zero for each state.
    pub(super) fn zeros(&self) -> Result<Vec<f64>, AllocationError> {
        filled(&0.0, self.mdp.num_states(), self.stop)
    }

    /// Counts the work on the states, between checks of the flag.
    pub(super) fn checks(&self) -> StopChecks<'a> {
        StopChecks::new(self.mdp.num_outcomes(), self.mdp.num_states(), self.stop)
    }

    /// q(s, a) = Σ p (r + γ v(s′)), summed from left to right (Sutton & Barto, equation 4.6). Terminal states have the
    /// value 0.
    #[inline]
    pub(super) fn action_value(&self, state: usize, action: usize, values: &[f64]) -> f64 {
        let mut sum = 0.0;
        for (probability, step) in self.mdp.outcomes(state, action) {
            let next_value = if step.terminated { 0.0 } else { values[step.state as usize] };
            sum += probability * (step.reward + self.discount * next_value);
        }
        sum
    }

    /// Σ p (|r| + γ |v(s′)|): the sum of the magnitudes of an action value's terms.
    fn action_size(&self, state: usize, action: usize, values: &[f64]) -> f64 {
        let mut sum = 0.0;
        for (probability, step) in self.mdp.outcomes(state, action) {
            let next_value = if step.terminated { 0.0 } else { values[step.state as usize] };
            sum += probability * (step.reward.abs() + self.discount * next_value.abs());
        }
        sum
    }

    /// The magnitude of the terms of a state's largest action value, of the first one if several are equal. Those of
    /// other actions, such as large penalties, do not matter.
    pub(super) fn best_size(&self, state: usize, values: &[f64]) -> f64 {
        let value = |action: usize| self.action_value(state, action, values);
        let best = (1..self.mdp.num_actions()).fold((0, value(0)), |best, action| {
            let value = value(action);
            if value > best.1 { (action, value) } else { best }
        });
        self.action_size(state, best.0, values)
    }

    /// A bound on the error of an action value, given the errors of the state values. Actions tie if their values differ
    /// by less than the errors of both.
    pub(super) fn action_error(&self, state: usize, action: usize, values: &[f64], errors: &[f64]) -> f64 {
        let size = self.action_size(state, action, values).clamp(f64::MIN_POSITIVE, f64::MAX);
        let (mut outcomes, mut error) = (0.0, 0.0);
        for (probability, step) in self.mdp.outcomes(state, action) {
            let next_error = if step.terminated { 0.0 } else { errors[step.state as usize] };
            outcomes += 1.0;
            error += probability * self.discount * next_error;
        }
        error + f64::EPSILON * (2.0 + outcomes) * size
    }

    /// maxₐ q(s, a).
    #[inline]
    pub(super) fn best_value(&self, state: usize, values: &[f64]) -> f64 {
        (0..self.mdp.num_actions())
            .map(|action| self.action_value(state, action, values))
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// Σ π(a|s) q(s, a), summed from left to right (Sutton & Barto, equation 4.4). Actions with probability 0 are left
    /// out.
    #[inline]
    pub(super) fn expected_value(&self, policy: &[f64], state: usize, values: &[f64]) -> f64 {
        choices(self.mdp, policy, state)
            .fold(0.0, |sum, (action, probability)| sum + probability * self.action_value(state, action, values))
    }

    /// q(s, a) of all states and actions, the actions of state 0 first.
    ///
    /// # Errors
    /// `Overflow`; `OutOfMemory`; `Stopped` after the flag was set.
    pub(super) fn action_values(&self, values: &[f64]) -> Result<Vec<f64>, PlanningError> {
        let (mut checks, num_actions) = (self.checks(), self.mdp.num_actions());
        let mut q_values = with_capacity(self.mdp.num_states() * num_actions)?;
        for state in 0..self.mdp.num_states() {
            q_values.extend((0..num_actions).map(|action| self.action_value(state, action, values)));
            if q_values[state * num_actions..].iter().any(|value| !value.is_finite()) {
                return Err(PlanningError::Overflow(state));
            }
            checks.state()?;
        }
        Ok(q_values)
    }
}

/// q(s, a) of all states and actions, the actions of state 0 first.
///
/// # Errors
/// `Overflow`; `OutOfMemory`; `Stopped` after `stop` was set.
pub fn action_values(
    mdp: &TabularMdp,
    discount: f64,
    values: &[f64],
    stop: &StopFlag<'_>,
) -> Result<Vec<f64>, PlanningError> {
    Problem { mdp, discount, stop }.action_values(values)
}

/// The actions that a policy takes in a state, and their probabilities. `policy` holds π(a|s), the actions of state 0
/// first.
pub(super) fn choices<'a>(
    mdp: &TabularMdp,
    policy: &'a [f64],
    state: usize,
) -> impl Iterator<Item = (usize, f64)> + use<'a> {
    let row = &policy[state * mdp.num_actions()..][..mdp.num_actions()];
    row.iter().copied().enumerate().filter(|&(_, probability)| probability > 0.0)
}

/// The expected value of the initial state, summed from left to right.
pub(super) fn initial_value(mdp: &TabularMdp, values: &[f64]) -> f64 {
    mdp.initial_distribution().iter().zip(values).fold(0.0, |sum, (probability, value)| sum + probability * value)
}

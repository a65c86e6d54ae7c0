//! Planning by expected updates of single state-action pairs, and how they are distributed (Sutton & Barto, section 8.6).

use crate::StopFlag;

use super::bellman::action_value;
use super::stop_checks::StopChecks;
use super::{MAX_SWEEPS, PlanningError};
use crate::envs::Env;
use crate::envs::tabular::TabularMdp;
use crate::memory::{collect, filled, with_capacity};
use crate::numeric::{argmax, maximum};
use crate::policies::{AnyPolicy, Policy, TieBreaking};
use crate::random::Pcg64;
use crate::schedules::Schedule;

/// Values have converged when a sweep changes none by more than this fraction of the largest.
const CONVERGED: f64 = 1e-8;

/// Which state-action pairs are updated.
#[derive(Clone, Debug, PartialEq)]
pub enum UpdateDistribution {
    /// All pairs in turn, the actions of state 0 first.
    Uniform,
    /// Those that occur in simulated episodes under the ε-greedy policy with this ε. Ties are broken at random.
    OnPolicy(f64),
}

/// Q(s, a) ← Σ p (r + γ maxₐ′ Q(s′, a′)) for one pair after another (equation 8.1 and Figure 8.8).
#[derive(Clone, Debug)]
pub struct ExpectedUpdates {
    mdp: TabularMdp,
    discount: f64,
    q_values: Vec<f64>,
    /// The maximum of each row of `q_values`.
    values: Vec<f64>,
    source: Source,
    rng: Pcg64,
}

/// Where the next pair comes from.
#[derive(Clone, Debug)]
enum Source {
    /// The pair to update next.
    Uniform(usize),
    /// The state of the simulated episode; `None` between two episodes.
    OnPolicy(AnyPolicy, Option<u32>),
}

impl ExpectedUpdates {
    /// Planning before its first update, with values of 0.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn new(
        mdp: TabularMdp,
        discount: f64,
        distribution: &UpdateDistribution,
        rng: Pcg64,
        stop: &StopFlag<'_>,
    ) -> Result<Self, PlanningError> {
        let source = match *distribution {
            UpdateDistribution::Uniform => Source::Uniform(0),
            UpdateDistribution::OnPolicy(epsilon) => {
                let epsilon = Schedule::constant(epsilon);
                Source::OnPolicy(AnyPolicy::EpsilonGreedy { epsilon, ties: TieBreaking::Random }, None)
            }
        };
        let q_values = filled(&0.0, mdp.num_states() * mdp.num_actions(), stop)?;
        let values = filled(&0.0, mdp.num_states(), stop)?;
        Ok(Self { mdp, discount, q_values, values, source, rng })
    }

    /// The action values, the actions of state 0 first.
    pub fn q_values(&self) -> &[f64] {
        &self.q_values
    }

    /// Makes so many updates.
    ///
    /// # Errors
    /// `Stopped` after `stop` was set; the updates before are kept.
    pub fn advance(&mut self, updates: u64, stop: &StopFlag<'_>) -> Result<(), PlanningError> {
        let mut checks = StopChecks::new(&self.mdp, stop);
        let num_actions = self.mdp.num_actions();
        for _ in 0..updates {
            let (state, action) = match &mut self.source {
                Source::Uniform(pair) => {
                    let next = *pair;
                    *pair = if next + 1 == self.q_values.len() { 0 } else { next + 1 };
                    (next / num_actions, next % num_actions)
                }
                Source::OnPolicy(policy, current) => {
                    let state = current.unwrap_or_else(|| self.mdp.reset(&mut self.rng));
                    let row = &self.q_values[state as usize * num_actions..][..num_actions];
                    let action = policy.choose(row, &mut self.rng);
                    let transition = self.mdp.step(state, action, &mut self.rng);
                    *current = (!transition.terminated).then_some(transition.state);
                    (state as usize, action)
                }
            };
            let target = action_value(&self.mdp, state, action, self.discount, &self.values);
            self.q_values[state * num_actions + action] = target;
            self.values[state] = maximum(&self.q_values[state * num_actions..][..num_actions]);
            checks.state()?;
        }
        Ok(())
    }

    /// The expected return of the greedy policy from the initial states: of several best actions it takes the first.
    ///
    /// # Errors
    /// `NotConverged`; `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn greedy_return(&self, stop: &StopFlag<'_>) -> Result<f64, PlanningError> {
        let rows = self.q_values.chunks(self.mdp.num_actions());
        let policy: Vec<usize> = collect(rows.map(argmax))?;
        let states = self.reachable(&policy, stop)?;
        let mut values = collect(self.values.iter().copied())?;
        let mut checks = StopChecks::new(&self.mdp, stop);
        for _ in 0..MAX_SWEEPS {
            let (mut change, mut largest) = (0.0_f64, 0.0_f64);
            // A state is reached before those that follow it, so their new values are there first in this order.
            for &state in states.iter().rev() {
                let value = action_value(&self.mdp, state, policy[state], self.discount, &values);
                change = change.max((value - values[state]).abs());
                largest = largest.max(value.abs());
                values[state] = value;
                checks.state()?;
            }
            if change <= CONVERGED * largest {
                let starts = self.mdp.initial_distribution().iter().zip(&values);
                return Ok(starts.fold(0.0, |sum, (probability, value)| sum + probability * value));
            }
        }
        Err(PlanningError::NotConverged)
    }

    /// The states that a policy reaches from the initial ones.
    fn reachable(&self, policy: &[usize], stop: &StopFlag<'_>) -> Result<Vec<usize>, PlanningError> {
        let mut checks = StopChecks::new(&self.mdp, stop);
        let mut reached = filled(&false, policy.len(), stop)?;
        let mut states = with_capacity(policy.len())?;
        for (state, &probability) in self.mdp.initial_distribution().iter().enumerate() {
            if probability > 0.0 {
                reached[state] = true;
                states.push(state);
            }
        }
        let mut next = 0;
        while let Some(&state) = states.get(next) {
            for (probability, step) in self.mdp.outcomes(state, policy[state]) {
                let following = step.state as usize;
                if probability > 0.0 && !step.terminated && !reached[following] {
                    reached[following] = true;
                    states.push(following);
                }
            }
            next += 1;
            checks.state()?;
        }
        Ok(states)
    }
}

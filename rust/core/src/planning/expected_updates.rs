//! Planning by expected updates of single state-action pairs, and their distribution (Sutton & Barto, section 8.6).

use std::iter::once;

use super::PlanningError;
use super::markov_chain::MarkovChain;
use super::policy_evaluation::solve;
use super::problem::{Problem, initial_value};
use crate::StopFlag;
use crate::envs::Env;
use crate::envs::tabular::TabularMdp;
use crate::memory::{collect, filled};
use crate::numeric::{argmax, maximum};
use crate::policies::{AnyPolicy, Policy, TieBreaking};
use crate::random::Pcg64;
use crate::schedules::Schedule;

/// The distribution of updates over state-action pairs.
#[derive(Clone, Debug, PartialEq)]
pub enum UpdateDistribution {
    /// All pairs in turn, the actions of state 0 first.
    Uniform,
    /// The pairs that occur in simulated episodes under the ε-greedy policy with this ε. Ties are broken at random.
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

/// The source of the next pair.
#[derive(Clone, Debug)]
enum Source {
    /// The pair to update next.
    Uniform(usize),
    /// The state of the simulated episode; `None` between two episodes.
    OnPolicy(AnyPolicy, Option<u32>),
}

impl ExpectedUpdates {
    /// Planning before its first update, with all values 0.
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

    /// Makes this many updates.
    ///
    /// # Errors
    /// `Overflow`; `Stopped` after `stop` was set. The updates made before are kept.
    pub fn advance(&mut self, updates: u64, stop: &StopFlag<'_>) -> Result<(), PlanningError> {
        let problem = Problem { mdp: &self.mdp, discount: self.discount, stop };
        let mut checks = problem.checks();
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
            let target = problem.action_value(state, action, &self.values);
            if !target.is_finite() {
                return Err(PlanningError::Overflow(state));
            }
            self.q_values[state * num_actions + action] = target;
            self.values[state] = maximum(&self.q_values[state * num_actions..][..num_actions]);
            checks.state()?;
        }
        Ok(())
    }

    /// The expected return of the greedy policy from the initial states. Ties go to the first action.
    ///
    /// # Errors
    /// Without discounting `NoProperPolicy` if the policy collects rewards forever; `NotConverged`; `Overflow`;
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn greedy_return(&self, stop: &StopFlag<'_>) -> Result<f64, PlanningError> {
        let problem = Problem { mdp: &self.mdp, discount: self.discount, stop };
        let policy: Vec<usize> = collect(self.q_values.chunks(self.mdp.num_actions()).map(argmax))?;
        let chain = MarkovChain::new(problem, |state| once((policy[state], 1.0)))?;
        let states = chain.reachable(self.mdp.initial_distribution(), stop)?;
        let mut values = collect(self.values.iter().copied())?;
        solve(&chain, states, &mut values, stop)?;
        Ok(initial_value(&self.mdp, &values))
    }
}

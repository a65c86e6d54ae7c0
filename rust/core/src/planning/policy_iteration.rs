//! Policy iteration: evaluate and improve a policy until no action is better (Sutton & Barto, section 4.3).

use std::iter::once;

use crate::StopFlag;

use super::bellman::{action_error, action_values};
use super::best_policy::best_policy;
use super::endings::Endings;
use super::markov_chain::MarkovChain;
use super::policy_evaluation::evaluate;
use super::{MAX_SWEEPS, PlanningError, PolicyEvaluation};
use crate::envs::Env;
use crate::envs::tabular::TabularMdp;
use crate::memory::{collect, filled};
use crate::numeric::argmax;

/// A stationary policy and its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// The value of each state: the expected discounted return.
    pub values: Vec<f64>,
    /// The value of each state-action pair, the actions of state 0 first.
    pub q_values: Vec<f64>,
    /// The best action of each state.
    pub policy: Vec<usize>,
}

/// An optimal policy and its values.
///
/// Without discounting (`discount == 1`) the policy is the best proper one, that is, among those that end every episode.
/// The first policy is proper, and an improvement of a proper policy is proper too, or has an unbounded return
/// (D. Bertsekas and J. Tsitsiklis, "An analysis of stochastic shortest path problems", 1991). From states where no
/// policy can end the episode, the policy stays forever where there are no rewards, such as in walls, whose value is 0.
///
/// # Errors
/// Without discounting `NoProperPolicy` and `UnboundedReturn`; `NotConverged`; `Overflow`; `OutOfMemory`; `Stopped` after
/// `stop` was set.
pub fn policy_iteration(mdp: &TabularMdp, discount: f64, stop: &StopFlag<'_>) -> Result<Solution, PlanningError> {
    let endings = Endings::for_discount(mdp, discount, false, stop)?;
    let first = collect(endings.policy.iter().copied())?;
    let improved = improve(mdp, discount, first, filled(&0.0, mdp.num_states(), stop)?, &endings, stop)?;
    let (policy, evaluation) = improved.settled(mdp, discount, &endings, stop)?;
    let q_values = action_values(mdp, discount, &evaluation.values, stop)?;
    Ok(Solution { values: evaluation.values, q_values, policy })
}

/// A policy that no change of a single action improves.
pub(super) struct Improved {
    policy: Vec<usize>,
    evaluation: PolicyEvaluation,
    q_values: Vec<f64>,
}

impl Improved {
    /// Replaces the policy by a canonical one of the equally good policies, which does not depend on the search, and
    /// evaluates it.
    pub(super) fn settled(
        self,
        mdp: &TabularMdp,
        discount: f64,
        endings: &Endings,
        stop: &StopFlag<'_>,
    ) -> Result<(Vec<usize>, PolicyEvaluation), PlanningError> {
        let PolicyEvaluation { values, errors } = &self.evaluation;
        let best = best_policy(mdp, discount, values, errors, &self.q_values, endings, stop)?;
        if best == self.policy {
            return Ok((best, self.evaluation));
        }
        let evaluation = evaluate_actions(mdp, &best, discount, self.evaluation.values, stop)?;
        Ok((best, evaluation))
    }
}

/// Improves a policy until no action is better by more than rounding errors, so that equally good policies do not
/// alternate forever (the book's exercise 4.4). `guess` is an initial guess of the policy's values.
///
/// # Errors
/// Without discounting `NoProperPolicy` if the first policy collects rewards forever, and `UnboundedReturn` if a better
/// one does; otherwise as [`policy_iteration`].
pub(super) fn improve(
    mdp: &TabularMdp,
    discount: f64,
    mut policy: Vec<usize>,
    mut guess: Vec<f64>,
    endings: &Endings,
    stop: &StopFlag<'_>,
) -> Result<Improved, PlanningError> {
    for improvements in 0..MAX_SWEEPS {
        let evaluation = evaluate_actions(mdp, &policy, discount, guess, stop).map_err(|error| match error {
            PlanningError::NoProperPolicy(state) if improvements > 0 => PlanningError::UnboundedReturn(state),
            _ => error,
        })?;
        let q_values = action_values(mdp, discount, &evaluation.values, stop)?;
        let Some(better) = improvement(mdp, discount, &policy, &evaluation, &q_values, endings)? else {
            return Ok(Improved { policy, evaluation, q_values });
        };
        (policy, guess) = (better, evaluation.values);
    }
    Err(PlanningError::NotConverged { sweeps: MAX_SWEEPS })
}

/// One step of policy iteration: the values of a policy, and a better policy; `None` if no action is better by more
/// than rounding errors. Ties go to the first action.
///
/// # Errors
/// Without discounting `NoProperPolicy` if the policy collects rewards forever; `NotConverged`; `Overflow`;
/// `OutOfMemory`; `Stopped` after `stop` was set.
///
/// # Panics
/// If the policy does not have one action per state, or an action is out of range.
pub fn policy_improvement(
    mdp: &TabularMdp,
    policy: &[usize],
    discount: f64,
    stop: &StopFlag<'_>,
) -> Result<(Vec<f64>, Option<Vec<usize>>), PlanningError> {
    assert_eq!(policy.len(), mdp.num_states(), "a policy must have one action per state");
    let evaluation = evaluate_actions(mdp, policy, discount, filled(&0.0, mdp.num_states(), stop)?, stop)?;
    let q_values = action_values(mdp, discount, &evaluation.values, stop)?;
    let better = improvement(mdp, discount, policy, &evaluation, &q_values, &Endings::default())?;
    Ok((evaluation.values, better))
}

fn evaluate_actions(
    mdp: &TabularMdp,
    policy: &[usize],
    discount: f64,
    guess: Vec<f64>,
    stop: &StopFlag<'_>,
) -> Result<PolicyEvaluation, PlanningError> {
    let chain = MarkovChain::new(mdp, discount, stop, |state| once((policy[state], 1.0)))?;
    evaluate(&chain, discount, guess, stop)
}

/// The policy after every change to an action that is better by more than the errors of both action values.
fn improvement(
    mdp: &TabularMdp,
    discount: f64,
    policy: &[usize],
    PolicyEvaluation { values, errors }: &PolicyEvaluation,
    q_values: &[f64],
    endings: &Endings,
) -> Result<Option<Vec<usize>>, PlanningError> {
    let mut better = collect(policy.iter().copied())?;
    for (state, row) in q_values.chunks(mdp.num_actions()).enumerate() {
        let (best, taken) = (argmax(row), policy[state]);
        let error_of = |action| action_error(mdp, state, action, discount, values, errors);
        match endings.staying_action(state) {
            // All states that are worth less than staying without a reward start to stay in the same step, as they may
            // lead to each other.
            Some(staying) if values[state] < -errors[state] => better[state] = staying,
            _ if row[best] > row[taken] && row[best] - row[taken] > error_of(best) + error_of(taken) => {
                better[state] = best;
            }
            _ => {}
        }
    }
    Ok((better != policy).then_some(better))
}

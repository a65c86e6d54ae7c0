//! Policy iteration: evaluate and improve a policy until no action is better (Sutton & Barto, section 4.3).

use std::iter::once;

use super::best_policy::best_policy;
use super::endings::Endings;
use crate::StopFlag;
use crate::envs::Env;
use crate::envs::tabular::TabularMdp;
use crate::memory::collect;
use crate::numeric::argmax;
use crate::planning::markov_chain::MarkovChain;
use crate::planning::policy_evaluation::evaluate;
use crate::planning::problem::Problem;
use crate::planning::{MAX_SWEEPS, PlanningError, PolicyEvaluation};

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
    let problem = Problem { mdp, discount, stop };
    let endings = Endings::new(problem, false)?;
    let first = collect(endings.policy.iter().copied())?;
    let (policy, evaluation) = improve(problem, first, problem.zeros()?, &endings)?.settled(problem, &endings)?;
    let q_values = problem.action_values(&evaluation.values)?;
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
        problem: Problem<'_>,
        endings: &Endings,
    ) -> Result<(Vec<usize>, PolicyEvaluation), PlanningError> {
        let PolicyEvaluation { values, errors } = &self.evaluation;
        let best = best_policy(problem, values, errors, &self.q_values, endings)?;
        if best == self.policy {
            return Ok((best, self.evaluation));
        }
        let evaluation = evaluate_actions(problem, &best, self.evaluation.values)?;
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
    problem: Problem<'_>,
    mut policy: Vec<usize>,
    mut guess: Vec<f64>,
    endings: &Endings,
) -> Result<Improved, PlanningError> {
    for improvements in 0..MAX_SWEEPS {
        let evaluation = evaluate_actions(problem, &policy, guess).map_err(|error| match error {
            PlanningError::NoProperPolicy(state) if improvements > 0 => PlanningError::UnboundedReturn(state),
            _ => error,
        })?;
        let q_values = problem.action_values(&evaluation.values)?;
        let Some(better) = improvement(problem, &policy, &evaluation, &q_values, endings)? else {
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
    let problem = Problem { mdp, discount, stop };
    let evaluation = evaluate_actions(problem, policy, problem.zeros()?)?;
    let q_values = problem.action_values(&evaluation.values)?;
    let better = improvement(problem, policy, &evaluation, &q_values, &Endings::default())?;
    Ok((evaluation.values, better))
}

fn evaluate_actions(
    problem: Problem<'_>,
    policy: &[usize],
    guess: Vec<f64>,
) -> Result<PolicyEvaluation, PlanningError> {
    let chain = MarkovChain::new(problem, |state| once((policy[state], 1.0)))?;
    evaluate(&chain, guess, problem.stop)
}

/// The policy after every change to an action that is better by more than the errors of both action values.
fn improvement(
    problem: Problem<'_>,
    policy: &[usize],
    PolicyEvaluation { values, errors }: &PolicyEvaluation,
    q_values: &[f64],
    endings: &Endings,
) -> Result<Option<Vec<usize>>, PlanningError> {
    let mut better = collect(policy.iter().copied())?;
    for (state, row) in q_values.chunks(problem.mdp.num_actions()).enumerate() {
        let (best, taken) = (argmax(row), policy[state]);
        let error_of = |action| problem.action_error(state, action, values, errors);
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

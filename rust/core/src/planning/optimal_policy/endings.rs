//! The ends of episodes. Without discounting only policies that end them, or stop to collect rewards, have finite
//! values.

use crate::envs::Env;
use crate::memory::{collect, filled};
use crate::planning::PlanningError;
use crate::planning::problem::Problem;

/// The ends of episodes without discounting. The default is for discounted values, which always exist.
#[derive(Debug, Default)]
pub(super) struct Endings {
    /// For each state that can stay forever among such states without a reward, the first action that does so.
    staying: Vec<Option<usize>>,
    /// A policy that ends every episode, or stays in states without rewards.
    pub(super) policy: Vec<usize>,
}

impl Endings {
    /// With discounting, any policy will do. Without, a policy may stay without a reward only in states from which no
    /// policy can end the episode, unless `stays_anywhere`.
    ///
    /// # Errors
    /// Without discounting `NoProperPolicy` if, from some state, every policy collects rewards forever; `OutOfMemory`;
    /// `Stopped` after `stop` was set.
    pub(super) fn new(problem: Problem<'_>, stays_anywhere: bool) -> Result<Self, PlanningError> {
        let Problem { mdp, discount, stop } = problem;
        if discount < 1.0 {
            return Ok(Self { policy: filled(&0, mdp.num_states(), stop)?, ..Self::default() });
        }
        let ending = ending_actions(problem, filled(&None, mdp.num_states(), stop)?)?;
        let staying = staying_actions(problem, |state| stays_anywhere || ending[state].is_none())?;
        let policy = ending_actions(problem, collect(staying.iter().copied())?)?;
        if let Some(state) = policy.iter().position(Option::is_none) {
            return Err(PlanningError::NoProperPolicy(state));
        }
        Ok(Self { staying, policy: collect(policy.iter().map(|action| action.unwrap_or(0)))? })
    }

    /// The action with which a state stays forever without a reward.
    pub(super) fn staying_action(&self, state: usize) -> Option<usize> {
        self.staying.get(state).copied().flatten()
    }
}

/// For each state an action that may end the episode or lead to a state that has such an action, starting from the
/// `known` ones; `None` if there is none. Following these actions ends the episode with probability 1, or reaches a
/// known state, or a state from which no action leads to an end.
fn ending_actions(problem: Problem<'_>, known: Vec<Option<usize>>) -> Result<Vec<Option<usize>>, PlanningError> {
    let (mdp, mut ending) = (problem.mdp, known);
    problem.checks().until_stable(mdp.num_states(), |state| {
        let may_end = |&action: &usize| {
            mdp.outcomes(state, action).any(|(probability, step)| {
                probability > 0.0 && (step.terminated || ending[step.state as usize].is_some())
            })
        };
        if ending[state].is_none() {
            ending[state] = (0..mdp.num_actions()).find(may_end);
            return ending[state].is_some();
        }
        false
    })?;
    Ok(ending)
}

/// For each state of `within` that can stay forever among such states without a reward, the first action that does so.
fn staying_actions(problem: Problem<'_>, within: impl Fn(usize) -> bool) -> Result<Vec<Option<usize>>, PlanningError> {
    let mdp = problem.mdp;
    let mut staying = collect((0..mdp.num_states()).map(|state| within(state).then_some(0)))?;
    problem.checks().until_stable(mdp.num_states(), |state| {
        let Some(action) = staying[state] else { return false };
        let stays = |&action: &usize| {
            mdp.outcomes(state, action)
                .filter(|(probability, _)| *probability > 0.0)
                .all(|(_, step)| step.reward == 0.0 && (step.terminated || staying[step.state as usize].is_some()))
        };
        staying[state] = (action..mdp.num_actions()).find(stays);
        staying[state] != Some(action)
    })?;
    Ok(staying)
}

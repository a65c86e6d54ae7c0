//! How episodes end. Without discounting only policies that end them, or stop to collect rewards, have finite values.

use crate::StopFlag;

use super::PlanningError;
use super::stop_checks::StopChecks;
use crate::envs::Env;
use crate::envs::tabular::TabularMdp;
use crate::memory::{collect, filled};

/// How episodes end without discounting. The default is that of discounted values, which always exist.
#[derive(Debug, Default)]
pub(super) struct Endings {
    /// For each state that can stay forever among such states without a reward, the first action that does.
    staying: Vec<Option<usize>>,
    /// A policy that ends every episode, or stays where there are no rewards.
    pub(super) policy: Vec<usize>,
}

impl Endings {
    /// With a discount any policy will do. Without, policies may stay without a reward only where no policy can end the
    /// episode, unless `stays_anywhere`.
    ///
    /// # Errors
    /// Without discounting `NoProperPolicy` if from some state every policy collects rewards forever; `OutOfMemory`;
    /// `Stopped` after `stop` was set.
    pub(super) fn for_discount(
        mdp: &TabularMdp,
        discount: f64,
        stays_anywhere: bool,
        stop: &StopFlag<'_>,
    ) -> Result<Self, PlanningError> {
        if discount < 1.0 {
            return Ok(Self { policy: filled(&0, mdp.num_states(), stop)?, ..Self::default() });
        }
        let ending = ending_actions(mdp, filled(&None, mdp.num_states(), stop)?, stop)?;
        let staying = staying_actions(mdp, stop, |state| stays_anywhere || ending[state].is_none())?;
        let policy = ending_actions(mdp, collect(staying.iter().copied())?, stop)?;
        if let Some(state) = policy.iter().position(Option::is_none) {
            return Err(PlanningError::NoProperPolicy(state));
        }
        Ok(Self { staying, policy: collect(policy.iter().map(|action| action.unwrap_or(0)))? })
    }

    /// The action with which a state stays forever where there are no rewards.
    pub(super) fn staying_action(&self, state: usize) -> Option<usize> {
        self.staying.get(state).copied().flatten()
    }
}

/// For each state an action that may end the episode or lead to a state that has such an action, beginning with `known`
/// ones; `None` if no action does. Following it ends the episode with probability 1, or reaches a state of the known
/// ones, or one from which nothing ends it.
fn ending_actions(
    mdp: &TabularMdp,
    known: Vec<Option<usize>>,
    stop: &StopFlag<'_>,
) -> Result<Vec<Option<usize>>, PlanningError> {
    let mut ending = known;
    StopChecks::new(mdp, stop).until_stable(mdp.num_states(), |state| {
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

/// For each state of `within` that can stay forever among such states without a reward, the first action that does.
fn staying_actions(
    mdp: &TabularMdp,
    stop: &StopFlag<'_>,
    within: impl Fn(usize) -> bool,
) -> Result<Vec<Option<usize>>, PlanningError> {
    let mut staying = collect((0..mdp.num_states()).map(|state| within(state).then_some(0)))?;
    StopChecks::new(mdp, stop).until_stable(mdp.num_states(), |state| {
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

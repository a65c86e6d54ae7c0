//! Policies that end: without a discount only they have a value.

use crate::env::Env;
use crate::envs::Tabular;

/// For each state the first of the `allowed` actions that may end the episode, or lead to a state that is nearer to an
/// end; None where no allowed action ever does. Whoever follows it ends with probability 1.
pub(crate) fn towards(table: &Tabular, allowed: impl Fn(usize, usize) -> bool) -> Vec<Option<usize>> {
    let mut chosen: Vec<Option<usize>> = vec![None; table.states()];
    loop {
        let nearer: Vec<(usize, usize)> = (0..table.states())
            .filter(|&state| chosen[state].is_none())
            .filter_map(|state| {
                let leads = |&action: &usize| {
                    allowed(state, action)
                        && table.outcomes(state, action).any(|(probability, step)| {
                            probability > 0.0 && (step.terminated || chosen[step.state as usize].is_some())
                        })
                };
                (0..table.actions()).find(leads).map(|action| (state, action))
            })
            .collect();
        if nearer.is_empty() {
            return chosen;
        }
        for (state, action) in nearer {
            chosen[state] = Some(action);
        }
    }
}

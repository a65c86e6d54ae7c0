//! n-step tree backup (D. Precup, R. Sutton & S. Singh, 2000; Sutton & Barto, equation 7.16, and the box in section
//! 7.5).

use std::collections::VecDeque;

use super::{NStep, NStepMethod, NStepVisit, TargetPolicy};
use crate::features::{ActiveFeatures, ActiveRows};
use crate::learners::Agent;

/// Q(Sₜ, Aₜ) ← Q(Sₜ, Aₜ) + α [Gₜ - Q(Sₜ, Aₜ)] with the return, from the last of n steps backwards,
/// Gₜ = Rₜ₊₁ + γ [Σₐ π(a|Sₜ₊₁) Q(Sₜ₊₁, a) + π(Aₜ₊₁|Sₜ₊₁) (Gₜ₊₁ - Q(Sₜ₊₁, Aₜ₊₁))].
///
/// After the last step only the sum remains, or nothing if the state is terminal. π is the target policy; no importance
/// sampling is needed. With n = 1 this is Q-learning if π is greedy, and Expected Sarsa if π is the behaviour policy.
pub type NStepTreeBackup<R> = NStep<R, TreeBackup>;

/// The return of tree backup.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TreeBackup {
    target_policy: TargetPolicy,
}

impl<R: ActiveRows> NStep<R, TreeBackup> {
    /// Targets over `n` steps.
    ///
    /// # Panics
    /// If `n` is 0.
    pub fn new(n: usize, target_policy: TargetPolicy) -> Self {
        Self::with_method(TreeBackup { target_policy }, n)
    }
}

impl<R: ActiveRows> NStepMethod<R> for TreeBackup {
    type Memo = ();

    #[inline]
    fn memo<F: Copy + ActiveFeatures>(&self, _agent: &mut Agent, _rows: F, _action: usize) {}

    fn update<F: Copy + ActiveFeatures>(
        &self,
        agent: &mut Agent,
        visits: &VecDeque<NStepVisit<R, ()>>,
        following: Option<(F, usize)>,
    ) {
        let target = self.target_policy.backed_up(agent, visits, following, |probability, ()| probability);
        let NStepVisit { rows, action, .. } = &visits[0];
        agent.update(rows, *action, target);
    }

    #[inline]
    fn work(row_work: u64, visits: usize) -> u64 {
        row_work * (1 + visits as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::test_support::{agent, rng};
    use crate::learners::{Learner, TdLearner};
    use crate::tasks::Next;

    #[test]
    fn one_update_by_hand() {
        let rule = NStepTreeBackup::new(2, TargetPolicy::Greedy);
        let mut learner = TdLearner { agent: agent(&[1.0, 0.0, 2.0, 3.0, 4.0, 8.0]), rule };
        learner.first_action([0], &mut rng());
        learner.learn([0], 0, -1.0, Next::NonTerminal([1]), &mut rng());
        learner.learn([1], 1, -2.0, Next::NonTerminal([2]), &mut rng());
        // Action 1 is greedy in state 1: the return is -1 + 0.5 (-2 + 0.5 · 8) = 0.
        assert_eq!(learner.agent.table.values()[0], 0.5);
    }

    #[test]
    fn an_action_that_the_target_policy_does_not_take_cuts_the_return() {
        let rule = NStepTreeBackup::new(2, TargetPolicy::Greedy);
        let mut learner = TdLearner { agent: agent(&[1.0, 0.0, 2.0, 3.0, 4.0, 8.0]), rule };
        learner.first_action([0], &mut rng());
        learner.learn([0], 0, -1.0, Next::NonTerminal([1]), &mut rng());
        learner.learn([1], 0, -2.0, Next::NonTerminal([2]), &mut rng());
        // 1 + 0.5 (-1 + 0.5 · 3 - 1)
        assert_eq!(learner.agent.table.values()[0], 0.75);
    }
}

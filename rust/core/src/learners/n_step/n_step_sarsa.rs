//! n-step Sarsa (Sutton & Barto, equations 7.4 and 7.5, and the box in section 7.2).

use std::collections::VecDeque;

use super::{NStep, NStepMethod, NStepVisit};
use crate::features::{ActiveFeatures, ActiveRows};
use crate::learners::Agent;

/// Q(Sₜ, Aₜ) ← Q(Sₜ, Aₜ) + α [G - Q(Sₜ, Aₜ)] with the n-step return
/// G = Rₜ₊₁ + γ Rₜ₊₂ + … + γⁿ⁻¹ Rₜ₊ₙ + γⁿ Q(Sₜ₊ₙ, Aₜ₊ₙ).
///
/// The sum runs from left to right, and the powers of γ are a running product. At the end of an episode the last n
/// pairs are updated with shorter returns.
pub type NStepSarsa<R> = NStep<R, NStepReturn>;

/// The n-step return of Sarsa.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NStepReturn;

impl<R: ActiveRows> NStep<R, NStepReturn> {
    /// Targets of `n` rewards.
    ///
    /// # Panics
    /// If `n` is 0.
    pub fn new(n: usize) -> Self {
        Self::with_method(NStepReturn, n)
    }
}

impl<R: ActiveRows> NStepMethod<R> for NStepReturn {
    type Memo = ();

    #[inline]
    fn memo<F: Copy + ActiveFeatures>(&self, _agent: &mut Agent, _rows: F, _action: usize) {}

    #[expect(clippy::inline_always, reason = "a call takes 4 % more instructions per step on a grid")]
    #[inline(always)]
    fn update<F: Copy + ActiveFeatures>(
        &self,
        agent: &mut Agent,
        visits: &VecDeque<NStepVisit<R, ()>>,
        following: Option<(F, usize)>,
    ) {
        let (mut target, mut power) = (0.0, 1.0);
        for visit in visits {
            target += power * visit.reward;
            power *= agent.discount;
        }
        if let Some((rows, action)) = following {
            target += power * agent.value(rows, action);
        }
        if let Some(NStepVisit { rows, action, .. }) = visits.front() {
            // A few binary rows are copied: they would be read again after each change of the table.
            if R::WEIGHTED { agent.update(rows, *action, target) } else { agent.update(*rows, *action, target) }
        }
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
        let mut learner = TdLearner { agent: agent(&[1.0, 0.0, 2.0, 3.0, 4.0, 8.0]), rule: NStepSarsa::new(2) };
        assert_eq!(learner.learn([0], 0, -1.0, Next::NonTerminal([1]), &mut rng()), 1);
        assert_eq!(learner.agent.table.values()[0], 1.0);
        learner.learn([1], 1, -2.0, Next::NonTerminal([2]), &mut rng());
        // 1 + 0.5 (-1 + 0.5 · -2 + 0.25 · 8 - 1)
        assert_eq!(learner.agent.table.values()[0], 0.5);
    }

    #[test]
    fn the_last_pairs_are_updated_when_the_episode_ends() {
        let mut learner = TdLearner { agent: agent(&[1.0, 0.0, 2.0, 3.0]), rule: NStepSarsa::new(5) };
        learner.learn([0], 0, -1.0, Next::NonTerminal([1]), &mut rng());
        learner.learn([1], 1, -2.0, Next::Terminal, &mut rng());
        // 1 + 0.5 (-1 + 0.5 · -2 - 1), then 3 + 0.5 (-2 - 3)
        assert_eq!(learner.agent.table.values(), [-0.5, 0.0, 2.0, 0.5]);
    }
}

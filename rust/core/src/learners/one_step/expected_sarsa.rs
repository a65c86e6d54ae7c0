//! Expected Sarsa (H. van Seijen et al., 2009; Sutton & Barto, equation 6.9).

use crate::features::ActiveFeatures;
use crate::learners::{Agent, UpdateRule, learn_borrowed};
use crate::policies::Policy;
use crate::random::Rng;
use crate::schedules::StepSize;
use crate::tasks::Next;

/// Q(S, A) ← Q(S, A) + α [R + γ Σₐ π(a | S′) Q(S′, a) - Q(S, A)]. The next action is chosen after the update.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpectedSarsa;

impl<const N: usize, R, P, A> UpdateRule<R, Agent<N, P, A>> for ExpectedSarsa
where
    R: Copy + ActiveFeatures,
    P: Policy,
    A: StepSize,
{
    #[expect(clippy::inline_always, reason = "a call per step would take a tenth of its time")]
    #[inline(always)]
    fn learn(
        &mut self,
        agent: &mut Agent<N, P, A>,
        state: R,
        action: usize,
        reward: f64,
        next: Next<R>,
        rng: &mut impl Rng,
    ) -> usize {
        match next {
            Next::NonTerminal(next_state) | Next::Truncated(next_state) => {
                let target = reward + agent.discount * agent.expected_value(next_state);
                agent.update(state, action, target);
            }
            Next::Terminal => agent.update_terminal(state, action, reward),
        }
        agent.next_action(next, rng)
    }

    learn_borrowed!(Agent<N, P, A>);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::test_support::{agent, rng};
    use crate::learners::{Learner, TdLearner};
    use crate::policies::{AnyPolicy, TieBreaking};
    use crate::schedules::Schedule;

    #[test]
    fn one_update_by_hand() {
        let mut learner = TdLearner { agent: agent(&[1.0, 0.0, 2.0, 4.0]), rule: ExpectedSarsa };
        learner.agent.policy = AnyPolicy::EpsilonGreedy { epsilon: Schedule::constant(0.5), ties: TieBreaking::First };
        // 1 + 0.5 (-1 + 0.5 (2/4 + 3 · 4/4) - 1)
        learner.learn([0], 0, -1.0, Next::Truncated([1]), &mut rng());
        assert_eq!(learner.agent.table.values(), [0.875, 0.0, 2.0, 4.0]);
    }
}

//! Sarsa: on-policy temporal-difference control (G. Rummery and M. Niranjan, 1994; Sutton & Barto, equation 6.7).

use crate::features::ActiveFeatures;
use crate::learners::{Agent, UpdateRule, learn_borrowed};
use crate::policies::Policy;
use crate::random::Rng;
use crate::schedules::StepSize;
use crate::tasks::Next;

/// Q(S, A) ← Q(S, A) + α [R + γ Q(S′, A′) - Q(S, A)]. A′ is chosen before the update.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sarsa;

impl<const N: usize, R, P, A> UpdateRule<R, Agent<N, P, A>> for Sarsa
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
        let Some((next_state, next_action)) = agent.sample_next(next, rng) else {
            agent.update_terminal(state, action, reward);
            return 0;
        };
        let target = reward + agent.discount * agent.value(next_state, next_action);
        agent.update(state, action, target);
        next_action
    }

    learn_borrowed!(Agent<N, P, A>);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::test_support::{agent, rng};
    use crate::learners::{Learner, TdLearner};

    #[test]
    fn one_update_by_hand() {
        let mut learner = TdLearner { agent: agent(&[1.0, 0.0, 2.0, 3.0]), rule: Sarsa };
        // 1 + 0.5 (-1 + 0.5 · 3 - 1)
        assert_eq!(learner.learn([0], 0, -1.0, Next::NonTerminal([1]), &mut rng()), 1);
        assert_eq!(learner.agent.table.values(), [0.75, 0.0, 2.0, 3.0]);
    }

    #[test]
    fn a_truncated_episode_bootstraps_and_a_terminal_state_does_not() {
        let mut learner = TdLearner { agent: agent(&[1.0, 0.0, 2.0, 3.0]), rule: Sarsa };
        learner.learn([0], 0, -1.0, Next::Truncated([1]), &mut rng());
        learner.learn([1], 0, -1.0, Next::Terminal, &mut rng());
        // 2 + 0.5 (-1 - 2)
        assert_eq!(learner.agent.table.values(), [0.75, 0.0, 0.5, 3.0]);
    }
}

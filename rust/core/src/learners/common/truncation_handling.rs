//! What a time-out means to a learner (Pardo et al., "Time limits in reinforcement learning", 2018).

use super::Learner;
use crate::random::Rng;
use crate::tasks::Next;

/// A learner that may take time-outs for terminal states. Right is that they are none: nothing ends there but our
/// patience. The mistake is kept for those who want to show what it costs.
#[derive(Clone, Debug, PartialEq)]
pub struct TruncationHandling<L> {
    /// The learner.
    pub learner: L,
    /// Whether it takes them so.
    pub terminate: bool,
}

impl<R, L: Learner<R>> Learner<R> for TruncationHandling<L> {
    #[inline]
    fn first_action(&mut self, state: R, rng: &mut impl Rng) -> usize {
        self.learner.first_action(state, rng)
    }

    #[inline]
    fn learn(&mut self, state: R, action: usize, reward: f64, next: Next<R>, rng: &mut impl Rng) -> usize {
        let next = match next {
            Next::Truncated(_) if self.terminate => Next::Terminal,
            next => next,
        };
        self.learner.learn(state, action, reward, next, rng)
    }

    fn end_episode(&mut self) {
        self.learner.end_episode();
    }

    fn tables(&self) -> Vec<&[f64]> {
        self.learner.tables()
    }

    fn diverged(&self) -> bool {
        self.learner.diverged()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::Sarsa;
    use crate::learners::common::TdLearner;
    use crate::learners::common::test_support::{agent, rng};

    #[test]
    fn the_mistake_forgets_what_would_have_followed() {
        for (terminate, value) in [(false, 0.75), (true, 0.0)] {
            let mut learner = TruncationHandling {
                learner: TdLearner { agent: agent(&[1.0, 0.0, 2.0, 3.0]), rule: Sarsa },
                terminate,
            };
            learner.learn([0], 0, -1.0, Next::Truncated([1]), &mut rng());
            assert_eq!(learner.learner.agent.table.values()[0], value);
        }
    }
}

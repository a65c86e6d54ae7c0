//! First-visit Monte Carlo control, on-policy or with exploring starts (Sutton & Barto, the boxes in sections 5.3 and 5.4).

use super::{FirstVisits, step_of};
use crate::StopFlag;
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::learners::{Agent, UpdateRule};
use crate::memory::{AllocationError, RunMemory};
use crate::random::Rng;
use crate::tasks::Next;

/// After an episode, from its last step backwards:
///
/// 1. G ← γ G + R;
/// 2. unless the pair S, A occurs earlier in the episode: Q(S, A) ← Q(S, A) + α [G - Q(S, A)].
///
/// With α = 1/n at the n-th visit of a pair, Q is the average of the returns, as in the book. The returns of an episode that
/// was truncated end with the value of a sampled action in its last state.
///
/// With exploring starts, the first action of an episode is random, with equal probabilities, whatever the policy, which is
/// greedy in the book; the environment draws the first state.
#[derive(Clone, Debug, PartialEq)]
pub struct MonteCarloControl {
    visits: FirstVisits,
    exploring_starts: bool,
}

impl MonteCarloControl {
    /// An update rule before the first episode of at most `max_episode_steps` steps, on a table of so many pairs.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn new(
        pairs: usize,
        max_episode_steps: u64,
        exploring_starts: bool,
        stop: &StopFlag<'_>,
    ) -> Result<Self, AllocationError> {
        Ok(Self { visits: FirstVisits::new(pairs, max_episode_steps, stop)?, exploring_starts })
    }
}

impl<R: Copy + AsRef<[u32]>> UpdateRule<R, Agent> for MonteCarloControl {
    fn first_action(&mut self, agent: &mut Agent, state: R, rng: &mut impl Rng) -> Option<usize> {
        self.exploring_starts.then(|| agent.sample_action(state, rng))
    }

    #[inline]
    fn learn(
        &mut self,
        agent: &mut Agent,
        state: R,
        action: usize,
        reward: f64,
        next: Next<R>,
        rng: &mut impl Rng,
    ) -> usize {
        self.visits.learn(agent, step_of(&state, action, reward), next, rng)
    }

    #[inline]
    fn work(&self, _agent: &Agent) -> u64 {
        self.visits.steps().work()
    }

    fn reserve(&mut self, _agent: &mut Agent, work: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        self.visits.reserve(work, memory)
    }

    fn end_episode(&mut self, _agent: &mut Agent) {}

    fn abandon_episode(&mut self, agent: &mut Agent) {
        self.visits.abandon(agent);
    }

    fn persist(&mut self, shape: (usize, usize), checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.visits.persist(shape, checkpoint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::test_support::{agent, rng};
    use crate::learners::{Learner, TdLearner};

    #[test]
    fn only_the_first_visit_of_a_pair_is_updated() {
        let rule = MonteCarloControl::new(4, 9, false, &StopFlag::new()).expect("a few pairs");
        let mut learner = TdLearner { agent: agent(&[1.0, 0.0, 2.0, 3.0]), rule };
        for (state, reward) in [(0, -1.0), (1, -2.0), (0, -4.0)] {
            learner.learn([state], 0, reward, Next::NonTerminal([1]), &mut rng());
            assert_eq!(learner.agent.table.values(), [1.0, 0.0, 2.0, 3.0]);
        }
        learner.learn([1], 1, -8.0, Next::Terminal, &mut rng());
        // The returns, backwards: -8; -4 - 4 = -8 (state 0 again: not its first visit); -2 - 4 = -6; -1 - 3 = -4.
        assert_eq!(learner.agent.table.values(), [-1.5, 0.0, -2.0, -2.5]);
    }

    #[test]
    fn a_truncated_episode_ends_with_the_value_of_its_last_state() {
        let rule = MonteCarloControl::new(4, 9, false, &StopFlag::new()).expect("a few pairs");
        let mut learner = TdLearner { agent: agent(&[1.0, 0.0, 2.0, 3.0]), rule };
        learner.learn([0], 0, -1.0, Next::Truncated([1]), &mut rng());
        // 1 + 0.5 (-1 + 0.5 · 3 - 1)
        assert_eq!(learner.agent.table.values()[0], 0.75);
    }

    #[test]
    fn exploring_starts_draw_the_first_action_and_no_other() {
        let rule = MonteCarloControl::new(4, 9, true, &StopFlag::new()).expect("a few pairs");
        let mut learner = TdLearner { agent: agent(&[1.0, 0.0, 2.0, 3.0]), rule };
        let mut rng = rng();
        let first = (0..100).filter(|_| learner.first_action([0], &mut rng) == 0).count();
        assert!((20..80).contains(&first));
        assert!((0..8).all(|_| learner.learn([0], 0, -1.0, Next::NonTerminal([1]), &mut rng) == 1));
    }
}

//! First-visit Monte Carlo control, on-policy or with exploring starts (Sutton & Barto, the boxes in sections 5.3 and
//! 5.4).

use super::EpisodeSteps;
use crate::StopFlag;
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::features::ActiveFeatures;
use crate::learners::{Agent, UpdateRule, row_work, single_row};
use crate::memory::{AllocationError, RunMemory, filled};
use crate::random::Rng;
use crate::tasks::Next;

/// After an episode, from its last step backwards:
///
/// 1. G ← γ G + R;
/// 2. unless the pair S, A occurs earlier in the episode: Q(S, A) ← Q(S, A) + α [G - Q(S, A)].
///
/// With α = 1/n at the n-th visit to a pair, Q is the average of the returns, as in the book. The returns of a
/// truncated episode end with the value of a sampled action in its last state.
///
/// With exploring starts, the first action of an episode is uniformly random, whatever the policy (greedy in the book).
/// The environment draws the first state.
#[derive(Clone, Debug, PartialEq)]
pub struct MonteCarloControl {
    steps: EpisodeSteps<()>,
    /// The number of occurrences of each pair in the steps.
    occurrences: Vec<u32>,
    exploring_starts: bool,
}

impl MonteCarloControl {
    /// An update rule before the first episode of at most `max_episode_steps` steps, on a table of this many pairs.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn new(
        pairs: usize,
        max_episode_steps: u64,
        exploring_starts: bool,
        stop: &StopFlag<'_>,
    ) -> Result<Self, AllocationError> {
        let (steps, occurrences) = (EpisodeSteps::new(max_episode_steps), filled(&0, pairs, stop)?);
        Ok(Self { steps, occurrences, exploring_starts })
    }

    /// Learns from the steps of the episode, or from a part of them if there are many.
    fn learn_backwards(&mut self, agent: &mut Agent) {
        let Self { steps, occurrences, .. } = self;
        steps.learn_backwards(row_work(agent.table.num_actions()), |following, step| {
            *following = agent.discount * *following + step.reward;
            let earlier = &mut occurrences[agent.table.weight_index(step.row, step.action as usize)];
            *earlier -= 1;
            if *earlier == 0 {
                agent.update([step.row], step.action as usize, *following);
            }
            true
        });
    }
}

impl<R: Copy + ActiveFeatures> UpdateRule<R, Agent> for MonteCarloControl {
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
        let row = single_row(&state);
        self.steps.push(row, action, reward, (), agent.work());
        self.occurrences[agent.table.weight_index(row, action)] += 1;
        let following = agent.sample_next(next, rng);
        if !matches!(next, Next::NonTerminal(_)) {
            self.steps.following = following.map_or(0.0, |(rows, action)| agent.value(rows, action));
            self.learn_backwards(agent);
        }
        following.map_or(0, |(_, next_action)| next_action)
    }

    #[inline]
    fn work(&self, _row_work: u64) -> u64 {
        self.steps.work()
    }

    fn reserve(&mut self, _agent: &mut Agent, work: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        self.steps.reserve(work, memory)
    }

    #[inline]
    fn is_unfinished(&self) -> bool {
        self.steps.is_unfinished()
    }

    fn resume(&mut self, agent: &mut Agent, _next: Next<R>, _rng: &mut impl Rng) -> usize {
        self.learn_backwards(agent);
        0
    }

    fn end_episode(&mut self, agent: &mut Agent) {
        for step in self.steps.iter() {
            self.occurrences[agent.table.weight_index(step.row, step.action as usize)] = 0;
        }
        self.steps.clear();
    }

    fn persist(&mut self, shape: (usize, usize), checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.steps.persist(shape, checkpoint)?;
        if checkpoint.is_restoring() {
            self.occurrences.fill(0);
            for step in self.steps.iter() {
                self.occurrences[step.row as usize * shape.1 + step.action as usize] += 1;
            }
        }
        Ok(())
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

//! Off-policy Monte Carlo control by weighted importance sampling (Sutton & Barto, the box in section 5.7).

use super::EpisodeSteps;
use crate::StopFlag;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::features::ActiveFeatures;
use crate::learners::{Agent, UpdateRule, row_work, single_row};
use crate::memory::{AllocationError, RunMemory, filled};
use crate::numeric::{argmax, maximum};
use crate::random::Rng;
use crate::tasks::Next;

/// After an episode of the behaviour policy b, from its last step backwards, with W = 1 initially:
///
/// 1. G ← γ G + R, C(S, A) ← C(S, A) + W;
/// 2. Q(S, A) ← Q(S, A) + α W / C(S, A) [G - Q(S, A)], with α = 1 in the book;
/// 3. if A is not the greedy action, the first maximum of Q(S, ·), stop; else W ← W / b(A|S).
///
/// The target policy is greedy. The return of a truncated episode ends with the largest value of its last state.
#[derive(Clone, Debug, PartialEq)]
pub struct OffPolicyMonteCarlo {
    /// The steps, with the probabilities b(A|S) when the actions were chosen.
    steps: EpisodeSteps<f64>,
    /// The sums C of the weights of each pair.
    weights: Vec<f64>,
    /// The weight W.
    weight: f64,
    /// The probability b(A|S) of the next action.
    probability: f64,
    /// The learning rate α and the smallest step size.
    learning_rate: (f64, f64),
}

impl OffPolicyMonteCarlo {
    /// An update rule before the first episode of at most `max_episode_steps` steps, on a table of this many pairs.
    /// `learning_rate` holds α and the smallest step size.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn new(
        pairs: usize,
        max_episode_steps: u64,
        learning_rate: (f64, f64),
        stop: &StopFlag<'_>,
    ) -> Result<Self, AllocationError> {
        let (steps, weights) = (EpisodeSteps::new(max_episode_steps), filled(&0.0, pairs, stop)?);
        Ok(Self { steps, weights, weight: 1.0, probability: 1.0, learning_rate })
    }

    /// Samples an action, and stores its probability before any value changes.
    #[inline]
    fn choose(&mut self, agent: &mut Agent, state: impl Copy + ActiveFeatures, rng: &mut impl Rng) -> usize {
        let action = agent.choose(state, rng);
        self.probability = agent.probability(state, action);
        action
    }

    /// Learns from the steps of the episode, or from a part of them if there are many.
    fn learn_backwards(&mut self, agent: &mut Agent) {
        let Self { steps, weights, weight, learning_rate: (rate, least), .. } = self;
        steps.learn_backwards(row_work(agent.table.num_actions()), |following, step| {
            let action = step.action as usize;
            *following = agent.discount * *following + step.reward;
            let sum = &mut weights[agent.table.weight_index(step.row, action)];
            *sum += *weight;
            let step_size = (*rate * *weight / *sum).max(*least);
            // A weight can overflow.
            agent.table.check_finite(step_size);
            let value = agent.table.value_mut(step.row, action);
            *value += step_size * (*following - *value);
            *weight /= step.memo;
            argmax(agent.action_values([step.row])) == action
        });
    }
}

impl<R: Copy + ActiveFeatures> UpdateRule<R, Agent> for OffPolicyMonteCarlo {
    fn first_action(&mut self, agent: &mut Agent, state: R, rng: &mut impl Rng) -> Option<usize> {
        Some(self.choose(agent, state, rng))
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
        self.steps.push(single_row(&state), action, reward, self.probability, 2 * agent.work());
        match next {
            Next::NonTerminal(next_state) => return self.choose(agent, next_state, rng),
            Next::Truncated(next_state) => self.steps.following = maximum(agent.action_values(next_state)),
            Next::Terminal => self.steps.following = 0.0,
        }
        self.weight = 1.0;
        self.learn_backwards(agent);
        0
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

    fn end_episode(&mut self, _agent: &mut Agent) {
        self.steps.clear();
    }

    fn persist(&mut self, shape: (usize, usize), checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.steps.persist(shape, checkpoint)?;
        (&mut self.weight, &mut self.probability).persist(checkpoint)?;
        self.weights.persist(checkpoint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::test_support::{agent, rng};
    use crate::learners::{Learner, TdLearner};
    use crate::policies::AnyPolicy;

    #[test]
    fn returns_are_weighted_up_to_the_last_exploring_action() {
        let mut agent = agent(&[1.0, 0.0, 0.0, 0.0]);
        agent.policy = AnyPolicy::softmax(1.0, 2);
        let probability = agent.probability([1], 0);
        let rule = OffPolicyMonteCarlo::new(4, 9, (1.0, 0.0), &StopFlag::new()).expect("a few pairs");
        let mut learner = TdLearner { agent, rule };
        for (state, action, reward) in [(0, 0, 5.0), (0, 1, -4.0)] {
            // State 1 has equal values, so that its actions have the probability that is kept.
            learner.learn([state], action, reward, Next::NonTerminal([1]), &mut rng());
        }
        learner.learn([1], 0, 8.0, Next::Terminal, &mut rng());
        // Backwards: 8 with weight 1; -4 + 4 with weight 1 / b; action 1 is not greedy, so nothing before it is
        // learned.
        assert_eq!(probability, 0.5);
        assert_eq!(learner.agent.table.values(), [1.0, 0.0, 8.0, 0.0]);
        assert_eq!(learner.rule.weights, [0.0, 2.0, 1.0, 0.0]);
    }
}

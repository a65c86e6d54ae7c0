//! Transformations of the steps that a learner learns from: truncation as termination (F. Pardo et al., "Time limits in
//! reinforcement learning", 2018), and rewards with a bonus.

use super::{CountBonus, Learner};
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::delegate_learner;
use crate::features::{ActiveFeatures, assert_binary};
use crate::random::Rng;
use crate::tasks::Next;

/// A wrapper around a learner that transforms the steps it learns from: it can treat truncation as termination, and add
/// a bonus to the rewards. Treating truncation as termination is a mistake, because the update then ignores the value
/// of the next state. The option exists to show the cost of the mistake.
#[derive(Clone, Debug, PartialEq)]
pub struct TransformedSteps<L> {
    /// The learner.
    pub learner: L,
    /// Whether truncation is treated as termination.
    pub terminate: bool,
    /// The bonus added to the rewards, if any.
    pub bonus: Option<CountBonus>,
}

impl<L> TransformedSteps<L> {
    /// The next state as the learner receives it.
    #[inline(always)]
    fn as_learned<R>(&self, next: Next<R>) -> Next<R> {
        match next {
            Next::Truncated(_) if self.terminate => Next::Terminal,
            next => next,
        }
    }
}

impl<R: ActiveFeatures, L: Learner<R>> Learner<R> for TransformedSteps<L> {
    const HAS_VECTOR_PASSES: bool = L::HAS_VECTOR_PASSES;

    delegate_learner!(rest R, learner in Self { learner, .. });

    #[inline(always)]
    fn learn(&mut self, state: R, action: usize, reward: f64, next: Next<R>, rng: &mut impl Rng) -> usize {
        let next = self.as_learned(next);
        let reward = match &mut self.bonus {
            None => reward,
            Some(bonus) => {
                assert_binary::<R>();
                reward + bonus.visit(state.as_ref(), action)
            }
        };
        self.learner.learn(state, action, reward, next, rng)
    }

    #[inline(always)]
    fn learn_borrowed(&mut self, state: &R, action: usize, reward: f64, next: Next<&R>, rng: &mut impl Rng) -> usize
    where
        R: Copy,
    {
        if self.bonus.is_some() {
            return self.learn(*state, action, reward, next.copied(), rng);
        }
        let next = self.as_learned(next);
        self.learner.learn_borrowed(state, action, reward, next, rng)
    }

    fn resume(&mut self, next: Next<R>, rng: &mut impl Rng) -> usize {
        let next = self.as_learned(next);
        self.learner.resume(next, rng)
    }

    fn end_episode(&mut self) {
        self.learner.end_episode();
    }

    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.learner.persist(checkpoint)?;
        self.bonus.as_mut().map_or(Ok(()), |bonus| bonus.persist(checkpoint))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StopFlag;
    use crate::learners::Sarsa;
    use crate::learners::TdLearner;
    use crate::learners::test_support::{agent, features, rng};

    #[test]
    fn treating_truncation_as_termination_ignores_the_next_state() {
        for (terminate, value) in [(false, 0.75), (true, 0.0)] {
            let mut learner = TransformedSteps {
                learner: TdLearner { agent: agent(&[1.0, 0.0, 2.0, 3.0]), rule: Sarsa },
                terminate,
                bonus: None,
            };
            learner.learn([0], 0, -1.0, Next::Truncated([1]), &mut rng());
            assert_eq!(learner.learner.agent.table.values()[0], value);
        }
    }

    #[test]
    #[should_panic(expected = "needs binary features")]
    fn a_bonus_does_not_count_visits_to_weighted_features() {
        let learner = TdLearner { agent: agent(&[0.0; 4]), rule: Sarsa };
        let bonus = CountBonus::new(1.0, (2, 2), &StopFlag::new()).expect("a few counts");
        let mut learner = TransformedSteps { learner, terminate: false, bonus: Some(bonus) };
        learner.learn(features(), 0, -1.0, Next::Terminal, &mut rng());
    }
}

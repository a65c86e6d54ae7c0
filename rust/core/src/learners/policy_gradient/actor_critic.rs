//! One-step actor-critic (Sutton & Barto, the box in section 13.5).

use super::Critic;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::features::ActiveFeatures;
use crate::learners::{Agent, UpdateRule, learn_borrowed};
use crate::q_table::QTable;
use crate::random::Rng;
use crate::tasks::Next;

/// In each step:
///
/// - δ = R + γ v̂(S′, w) - v̂(S, w)
/// - w ← w + αʷ δ ∇v̂(S, w)
/// - θ ← θ + α I δ ∇ln π(A | S, θ)
/// - I ← γ I
#[derive(Clone, Debug, PartialEq)]
pub struct ActorCritic {
    critic: Critic,
    /// I = γᵗ
    power: f64,
}

impl ActorCritic {
    /// An update rule before the first episode.
    pub fn new(critic: Critic) -> Self {
        Self { critic, power: 1.0 }
    }
}

/// δ = R + γ v̂(S′, w) - v̂(S, w)
#[inline]
pub(super) fn td_error<R: Copy + ActiveFeatures>(
    agent: &mut Agent,
    critic: &Critic,
    state: R,
    reward: f64,
    next: Next<R>,
) -> f64 {
    let target = match next {
        Next::NonTerminal(next_state) | Next::Truncated(next_state) => {
            reward + agent.discount * critic.value(next_state)
        }
        Next::Terminal => reward,
    };
    let error = target - critic.value(state);
    agent.table.check_finite(error);
    error
}

impl<R: Copy + ActiveFeatures> UpdateRule<R, Agent> for ActorCritic {
    const HAS_CRITIC: bool = true;

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
        let error = td_error(agent, &self.critic, state, reward, next);
        self.critic.update(state, error);
        agent.ascend(state, action, self.power * error);
        self.power *= agent.discount;
        agent.next_action(next, rng)
    }

    learn_borrowed!(Agent);

    fn second_table(&self) -> Option<&QTable> {
        Some(&self.critic.table)
    }

    fn second_table_mut(&mut self) -> Option<&mut QTable> {
        Some(&mut self.critic.table)
    }

    fn end_episode(&mut self, _agent: &mut Agent) {
        self.power = 1.0;
    }

    fn persist(&mut self, _shape: (usize, usize), checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.power.persist(checkpoint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::test_support::{agent, rng};
    use crate::learners::{Learner, TdLearner};
    use crate::policies::AnyPolicy;

    #[test]
    fn two_steps_by_hand() {
        let agent = Agent { policy: AnyPolicy::softmax(1.0, 2), ..agent(&[0.0; 4]) };
        let critic = Critic::new(QTable::new(vec![1.0, 1.0, 4.0, 4.0], 2), 0.25, &agent.learning_rate);
        let mut learner = TdLearner { agent, rule: ActorCritic::new(critic) };
        // δ = 3 + 0.5 · 4 - 1
        learner.learn([0], 0, 3.0, Next::NonTerminal([1]), &mut rng());
        assert_eq!(Learner::<[u32; 1]>::tables(&learner), [&[1.0, -1.0, 0.0, 0.0], &[2.0, 2.0, 4.0, 4.0]]);
        // δ = 8 - 4, and I = 0.5
        learner.learn([1], 0, 8.0, Next::Terminal, &mut rng());
        assert_eq!(Learner::<[u32; 1]>::tables(&learner), [&[1.0, -1.0, 0.5, -0.5], &[2.0, 2.0, 5.0, 5.0]]);
    }
}

//! The gradient bandit algorithm (Sutton & Barto, equation 2.12).

use crate::StopFlag;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::features::ActiveFeatures;
use crate::learners::{Agent, UpdateRule, single_row};
use crate::memory::{AllocationError, filled};
use crate::random::Rng;
use crate::tasks::Next;

/// With the preferences H (the table), and π their softmax:
///
/// - H(A) ← H(A) + α (R - R̄) (1 - π(A))
/// - H(a) ← H(a) - α (R - R̄) π(a) for all a ≠ A
///
/// R̄ is the average of the earlier rewards in the state (R̄ = R the first time), or 0 without a baseline. The next
/// state is ignored, because an episode consists of one step.
#[derive(Clone, Debug, PartialEq)]
pub struct GradientBandit {
    /// The average reward of each state and the number of its rewards; empty without a baseline.
    averages: Vec<(f64, u64)>,
}

impl GradientBandit {
    /// An update rule for `n_rows` states.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn new(baseline: bool, n_rows: usize, stop: &StopFlag<'_>) -> Result<Self, AllocationError> {
        Ok(Self { averages: filled(&(0.0, 0), if baseline { n_rows } else { 0 }, stop)? })
    }

    /// Returns R̄ and then updates it with a reward; 0 without a baseline.
    #[inline]
    fn baseline(&mut self, row: u32, reward: f64) -> f64 {
        let Some((average, count)) = self.averages.get_mut(row as usize) else { return 0.0 };
        if *count == 0 {
            *average = reward;
        }
        let baseline = *average;
        *count += 1;
        *average += (reward - baseline) / *count as f64;
        baseline
    }
}

impl<R: Copy + ActiveFeatures> UpdateRule<R, Agent> for GradientBandit {
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
        let advantage = reward - self.baseline(single_row(&state), reward);
        agent.ascend(state, action, advantage);
        agent.next_action(next, rng)
    }

    fn persist(&mut self, _shape: (usize, usize), checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.averages.persist(checkpoint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::test_support::{agent, rng};
    use crate::learners::{Learner, TdLearner};
    use crate::policies::AnyPolicy;

    #[test]
    fn two_updates_by_hand() {
        let rule = GradientBandit::new(true, 1, &StopFlag::new()).expect("a state");
        let agent = Agent { policy: AnyPolicy::softmax(1.0, 2), ..agent(&[0.0, 0.0]) };
        let mut learner = TdLearner { agent, rule };
        learner.learn([0], 0, 3.0, Next::Terminal, &mut rng());
        assert_eq!(learner.agent.table.values(), [0.0, 0.0]);
        // The baseline is 3: 0.5 · (4 - 3) · (1 - 0.5)
        learner.learn([0], 0, 4.0, Next::Terminal, &mut rng());
        assert_eq!(learner.agent.table.values(), [0.25, -0.25]);
        assert_eq!(learner.rule.averages, [(3.5, 2)]);
    }
}

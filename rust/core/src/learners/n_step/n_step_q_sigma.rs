//! n-step Q(σ) (K. De Asis et al., 2018; Sutton & Barto, equation 7.17, and the box in section 7.6).

use std::collections::VecDeque;

use super::{NStep, NStepMethod, NStepVisit, TargetPolicy};
use crate::features::{ActiveFeatures, ActiveRows};
use crate::learners::Agent;

/// Q(Sₜ, Aₜ) ← Q(Sₜ, Aₜ) + α [Gₜ - Q(Sₜ, Aₜ)] with the return, from the last of n steps backwards,
/// Gₜ = Rₜ₊₁ + γ [Σₐ π(a|Sₜ₊₁) Q(Sₜ₊₁, a) + (σ ρ + (1 - σ) π(Aₜ₊₁|Sₜ₊₁)) (Gₜ₊₁ - Q(Sₜ₊₁, Aₜ₊₁))].
///
/// π is the target policy, and ρ = π(Aₜ₊₁|Sₜ₊₁) / b(Aₜ₊₁|Sₜ₊₁) is the importance sampling ratio at the time when the
/// behaviour policy b chose Aₜ₊₁. With σ = 0 this is tree backup; with σ = 1 it is Sarsa with importance sampling and
/// control variates.
pub type NStepQSigma<R> = NStep<R, QSigma>;

/// The return of Q(σ).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QSigma {
    sigma: f64,
    target_policy: TargetPolicy,
}

impl<R: ActiveRows> NStep<R, QSigma> {
    /// Targets over `n` steps, with the degree of sampling `sigma`.
    ///
    /// # Panics
    /// If `n` is 0.
    pub fn new(n: usize, sigma: f64, target_policy: TargetPolicy) -> Self {
        Self::with_method(QSigma { sigma, target_policy }, n)
    }
}

impl<R: ActiveRows> NStepMethod<R> for QSigma {
    /// The importance sampling ratio.
    type Memo = f64;

    fn memo<F: Copy + ActiveFeatures>(&self, agent: &mut Agent, rows: F, action: usize) -> f64 {
        self.target_policy.ratio(agent, rows, action)
    }

    fn update<F: Copy + ActiveFeatures>(
        &self,
        agent: &mut Agent,
        visits: &VecDeque<NStepVisit<R, f64>>,
        following: Option<(F, usize)>,
    ) {
        let weight = |probability: f64, ratio: &f64| self.sigma * ratio + (1.0 - self.sigma) * probability;
        let target = self.target_policy.backed_up(agent, visits, following, weight);
        // Ratios above 1 can push a value beyond the range of its targets.
        agent.table.check_finite(target);
        let NStepVisit { rows, action, .. } = &visits[0];
        agent.update(rows, *action, target);
    }

    #[inline]
    fn work(row_work: u64, visits: usize) -> u64 {
        row_work * (1 + visits as u64)
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
        let rule = NStepQSigma::new(2, 0.5, TargetPolicy::Greedy);
        let mut learner = TdLearner { agent: agent(&[1.0, 0.0, 2.0, 3.0, 4.0, 8.0]), rule };
        learner.first_action([0], &mut rng());
        learner.learn([0], 0, -1.0, Next::NonTerminal([1]), &mut rng());
        learner.learn([1], 1, -2.0, Next::NonTerminal([2]), &mut rng());
        // ρ = π = 1, so the return is that of tree backup: -1 + 0.5 (3 + 1 (2 - 3)) = 0.
        assert_eq!(learner.agent.table.values()[0], 0.5);
    }

    #[test]
    fn an_exploring_action_has_a_ratio_of_zero() {
        let mut agent = agent(&[2.0, 3.0]);
        agent.policy = crate::policies::AnyPolicy::softmax(1.0, 2);
        let method = QSigma { sigma: 1.0, target_policy: TargetPolicy::Greedy };
        let mut memo = |action| NStepMethod::<[u32; 1]>::memo(&method, &mut agent, [0], action);
        let (exploring, greedy) = (memo(0), memo(1));
        assert_eq!((exploring, greedy), (0.0, 1.0 / agent.probability([0], 1)));
    }
}

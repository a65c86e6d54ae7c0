//! The target policies of off-policy methods over n steps, and the return of their backups.

use std::collections::VecDeque;

use super::NStepVisit;
use crate::features::{ActiveFeatures, ActiveRows};
use crate::learners::Agent;
use crate::numeric::maximum;

/// The target policy π, whose values are learned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TargetPolicy {
    /// The greedy policy. An action that ties for the maximum is greedy.
    Greedy,
    /// The behaviour policy.
    Behavior,
}

impl TargetPolicy {
    /// Σₐ π(a|S) Q(S, a).
    #[inline]
    pub(in crate::learners) fn expected_value(self, agent: &mut Agent, rows: impl ActiveFeatures) -> f64 {
        match self {
            Self::Greedy => maximum(agent.action_values(rows)),
            Self::Behavior => agent.expected_value(rows),
        }
    }

    /// π(A|S).
    #[inline]
    pub(in crate::learners) fn probability(self, agent: &mut Agent, rows: impl ActiveFeatures, action: usize) -> f64 {
        match self {
            Self::Greedy => {
                let values = agent.action_values(rows);
                f64::from(u8::from(values[action] == maximum(values)))
            }
            Self::Behavior => agent.probability(rows, action),
        }
    }

    /// The importance sampling ratio π(A|S) / b(A|S).
    #[inline]
    pub(in crate::learners) fn ratio(self, agent: &mut Agent, rows: impl ActiveFeatures, action: usize) -> f64 {
        match self {
            Self::Greedy => self.probability(agent, &rows, action) / agent.probability(&rows, action),
            Self::Behavior => 1.0,
        }
    }

    /// The return of the first of these visits, computed from the last one backwards:
    /// Gₜ = Rₜ₊₁ + γ [Σₐ π(a|Sₜ₊₁) Q(Sₜ₊₁, a) + w (Gₜ₊₁ - Q(Sₜ₊₁, Aₜ₊₁))]. `weight` is w, given π(Aₜ₊₁|Sₜ₊₁) and the
    /// memo of the visit.
    #[inline]
    #[expect(clippy::needless_borrows_for_generic_args, reason = "features of hundreds of bytes would be copied")]
    pub(in crate::learners) fn backed_up<R: ActiveRows, M, F: ActiveFeatures>(
        self,
        agent: &mut Agent,
        visits: &VecDeque<NStepVisit<R, M>>,
        following: Option<(F, usize)>,
        weight: impl Fn(f64, &M) -> f64,
    ) -> f64 {
        let mut value = following.map(|(rows, _)| self.expected_value(agent, rows));
        let mut target = 0.0;
        for (index, visit) in visits.iter().enumerate().rev() {
            target = value.map_or(visit.reward, |value| visit.reward + agent.discount * value);
            if index > 0 {
                let weight = weight(self.probability(agent, &visit.rows, visit.action), &visit.memo);
                let correction = weight * (target - agent.value(&visit.rows, visit.action));
                value = Some(self.expected_value(agent, &visit.rows) + correction);
            }
        }
        target
    }
}

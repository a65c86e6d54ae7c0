//! A given policy, which does not change.

use std::sync::Arc;

use super::Behavior;
use crate::random::Rng;

/// The probability of each action in each state. Clones share them.
#[derive(Clone, Debug, PartialEq)]
pub struct FixedPolicy {
    num_actions: usize,
    probabilities: Arc<[f64]>,
    /// For each state, the cumulative probabilities, with infinity from the last possible action on.
    thresholds: Arc<[f64]>,
    /// The action of each state; `None` if any state has several.
    actions: Option<Arc<[u32]>>,
    /// The probabilities of the policy that is evaluated; empty if it is this policy.
    target: Arc<[f64]>,
}

impl FixedPolicy {
    /// `probabilities` holds π(a|s), the actions of state 0 first.
    ///
    /// # Panics
    /// If a state has no action with a positive probability.
    pub fn new(probabilities: Arc<[f64]>, num_actions: usize) -> Self {
        let (mut thresholds, mut actions) = (Vec::with_capacity(probabilities.len()), Vec::new());
        let mut deterministic = true;
        for (state, row) in probabilities.chunks(num_actions).enumerate() {
            let last = row.iter().rposition(|&probability| probability > 0.0);
            assert!(last.is_some(), "state {state} must have an action");
            let last = last.unwrap_or(0);
            let mut sum = 0.0;
            for (action, probability) in row.iter().enumerate() {
                sum += probability;
                thresholds.push(if action >= last { f64::INFINITY } else { sum });
            }
            deterministic &= row[..last].iter().all(|&probability| probability == 0.0);
            actions.push(last as u32);
        }
        let actions = deterministic.then(|| actions.into());
        Self { num_actions, probabilities, thresholds: thresholds.into(), actions, target: Arc::new([]) }
    }

    /// This policy as a behavior policy, with the probabilities of the target policy in the same form.
    #[must_use]
    pub fn evaluating(self, target: Arc<[f64]>) -> Self {
        Self { target, ..self }
    }

    /// Samples an action: the first whose cumulative probability exceeds one `random()`. A policy that is deterministic
    /// in every state draws nothing.
    #[inline]
    pub fn choose(&self, state: u32, rng: &mut impl Rng) -> usize {
        if let Some(actions) = &self.actions {
            return actions[state as usize] as usize;
        }
        let thresholds = &self.thresholds[state as usize * self.num_actions..][..self.num_actions];
        let random = rng.random();
        if let &[first, _] = thresholds {
            return usize::from(first <= random);
        }
        thresholds.iter().take_while(|&&threshold| threshold <= random).count()
    }
}

/// A policy over numbered states.
impl<R> Behavior<R> for FixedPolicy {
    const OF_STATES: bool = true;

    #[inline]
    fn action(&self, state: u32, _active: &R, rng: &mut impl Rng) -> usize {
        self.choose(state, rng)
    }

    /// Cannot panic, so that the compiler can drop it for methods that need no ratios.
    #[inline]
    fn ratio(&self, state: u32, _active: &R, action: usize) -> f64 {
        if self.target.is_empty() {
            return 1.0;
        }
        let pair = state as usize * self.num_actions + action;
        let probabilities = self.target.get(pair).zip(self.probabilities.get(pair));
        probabilities.map_or(1.0, |(target, behavior)| target / behavior)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::Learner;
    use crate::prediction::TdZero;
    use crate::prediction::test_support::{predictor, rng};
    use crate::random::NoRng;

    #[test]
    fn actions_of_probability_zero_are_never_chosen() {
        let policy = FixedPolicy::new([0.0, 0.3, 0.7, 0.0].into(), 4);
        let mut rng = rng();
        let mut counts = [0; 4];
        for _ in 0..10_000 {
            counts[policy.choose(0, &mut rng)] += 1;
        }
        assert_eq!((counts[0], counts[3]), (0, 0));
        assert!((2_800..3_200).contains(&counts[1]), "{counts:?}");
    }

    #[test]
    fn a_deterministic_policy_draws_nothing() {
        let policy = FixedPolicy::new([0.0, 1.0, 1.0, 0.0].into(), 2);
        assert_eq!([policy.choose(0, &mut NoRng), policy.choose(1, &mut NoRng)], [1, 0]);
        let mut learner = predictor(&[0.0; 2], TdZero);
        assert_eq!(Learner::<[u32; 1]>::first_action(&mut learner, [0], &mut NoRng), 0);
    }
}

//! The ε-greedy policy for a bandit: one state, in which only the value of the action that was taken changes.
//!
//! It draws and chooses as [`AnyPolicy`](super::AnyPolicy) does, but remembers what it need not compute again.

use super::tie_breaking::random_action;
use super::{Policy, TieBreaking};
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::numeric::argmax;
use crate::random::{Rng, TWO_POW_53};
use crate::schedules::Schedule;

/// The ε-greedy policy of a bandit.
///
/// It remembers the greedy action and a bound on the other values. As long as the value of the greedy action is above the
/// bound, no other value is read.
#[derive(Clone, Debug, PartialEq)]
pub struct SingleStateEpsilonGreedy {
    epsilon: Schedule,
    ties: TieBreaking,
    /// A draw of [`Rng::random_u53`] below it is greedy.
    greedy_below: u64,
    /// The action chosen last: the only one whose value has changed since.
    last: usize,
    /// The first action with the largest value.
    best: usize,
    /// No other action has a larger value; NaN if this is unknown.
    bound: f64,
}

impl SingleStateEpsilonGreedy {
    /// With the exploration rate ε.
    pub fn new(epsilon: Schedule, ties: TieBreaking) -> Self {
        Self { epsilon, ties, greedy_below: greedy_below(&epsilon), last: 0, best: 0, bound: f64::NAN }
    }

    /// Finds the largest value and the bound on the others.
    #[cold]
    fn search(&mut self, values: &[f64]) {
        self.best = argmax(values);
        let others = values.iter().enumerate().filter(|&(action, _)| action != self.best);
        self.bound = others.fold(f64::NEG_INFINITY, |bound, (_, &value)| if value > bound { value } else { bound });
    }

    /// Whether one action has the largest value, as far as the bound tells.
    #[inline]
    fn is_unique(&self, values: &[f64]) -> bool {
        values[self.best] > self.bound
    }
}

/// The threshold of [`Rng::random_u53`] for `rng.random() >= 1 - ε`. Multiplying by a power of two is exact.
fn greedy_below(epsilon: &Schedule) -> u64 {
    ((1.0 - epsilon.value()) * TWO_POW_53).ceil() as u64
}

/// Any action. A call, as its variables would take registers from the steps that do not explore.
#[inline(never)]
fn explore(num_actions: usize, rng: &mut impl Rng) -> usize {
    rng.integers(num_actions as u32) as usize
}

/// A random action among those with the largest value.
#[cold]
fn random_best(values: &[f64], largest: f64, rng: &mut impl Rng) -> usize {
    random_action(values, |&value| value == largest, rng)
}

impl Policy for SingleStateEpsilonGreedy {
    #[expect(clippy::inline_always, reason = "a call per step would take a tenth of its time")]
    #[inline(always)]
    fn choose(&mut self, values: &[f64], rng: &mut impl Rng) -> usize {
        let explores = rng.random_u53() >= self.greedy_below;
        if self.last != self.best && values[self.last] > self.bound {
            self.bound = values[self.last];
        }
        // With equal values each choice searches: which of them is the first, or how many there are, may have changed.
        if !self.is_unique(values) {
            self.search(values);
            if !explores && self.ties == TieBreaking::Random && !self.is_unique(values) {
                self.last = random_best(values, values[self.best], rng);
                return self.last;
            }
        }
        self.last = if explores { explore(values.len(), rng) } else { self.best };
        self.last
    }

    fn expected_value(&mut self, values: &[f64]) -> f64 {
        self.ties.expected_value(self.epsilon.value(), values.iter().copied())
    }

    fn probability(&mut self, values: &[f64], action: usize) -> f64 {
        self.ties.probability(self.epsilon.value(), values, values.len(), action)
    }

    /// Nothing is stored. Other values may be restored, so that the next choice searches.
    fn persist_counts(&mut self, _checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.bound = f64::NAN;
        (self.last, self.best) = (0, 0);
        Ok(())
    }

    #[inline]
    fn end_episode(&mut self) {
        if !self.epsilon.is_final() {
            self.epsilon.end_episode();
            self.greedy_below = greedy_below(&self.epsilon);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::StopFlag;
    use crate::policies::{AnyPolicy, SingleStateUcb, Ucb};
    use crate::random::{Pcg64, SeedSequence};

    /// Checks that two policies take the same actions with the same draws on a bandit whose rewards repeat, so that values
    /// are often equal. Step sizes of 1 / n and constant ones alternate between problems.
    fn check(mut one: impl Policy, mut other: impl Policy, rewards: &[f64], averages: bool, initial: f64) {
        let mut rngs = [(); 2].map(|()| Pcg64::new(&SeedSequence::new(&[5])));
        let (mut values, mut counts) = ([initial; 4], [0.0; 4]);
        for step in 0..400 {
            let actions = [one.choose_in(&[0], &values, &mut rngs[0]), other.choose_in(&[0], &values, &mut rngs[1])];
            assert_eq!(actions[0], actions[1], "step {step}, values {values:?}");
            let action = actions[0];
            let reward = rewards[(step + 3 * action) % rewards.len()];
            counts[action] += 1.0;
            values[action] += (reward - values[action]) * if averages { 1.0 / counts[action] } else { 0.25 };
            one.end_episode();
            other.end_episode();
            // A run may be saved at any time, and goes on.
            if step % 3 == 2 {
                one.persist_counts(&mut Checkpoint::save(&mut Vec::new())).expect("memory suffices");
            }
        }
        assert_eq!(rngs[0], rngs[1]);
    }

    fn ties(random: bool) -> TieBreaking {
        if random { TieBreaking::Random } else { TieBreaking::First }
    }

    proptest! {
        #[test]
        fn what_is_remembered_changes_no_epsilon_greedy_choice(
            rewards in prop::collection::vec(-2_i8..3, 1..40),
            epsilon in prop_oneof![Just(0.0), Just(1.0), 0.0..0.5],
            (random, averages, decays) in any::<(bool, bool, bool)>(),
            initial in -1_i8..4,
        ) {
            let (decaying, ties) = (Schedule::linear(epsilon, epsilon / 2.0, 200, 10), ties(random));
            let epsilon = if decays { decaying } else { Schedule::constant(epsilon) };
            let rewards: Vec<_> = rewards.iter().map(|&reward| f64::from(reward)).collect();
            let remembering = SingleStateEpsilonGreedy::new(epsilon, ties);
            check(remembering, AnyPolicy::EpsilonGreedy { epsilon, ties }, &rewards, averages, f64::from(initial));
        }

        #[test]
        fn approximate_bounds_change_no_choice_by_confidence_bounds(
            rewards in prop::collection::vec(-2_i8..3, 1..40),
            scale in prop_oneof![Just(1.0), Just(1e-309), Just(1e-13), Just(5e307)],
            confidence in prop_oneof![Just(0.0), 0.0..4.0, Just(1e-310), Just(1e300)],
            (random, averages) in any::<(bool, bool)>(),
            initial in -1_i8..4,
        ) {
            let ucb = Ucb::new(confidence, ties(random), (1, 4), &StopFlag::new()).expect("four counts");
            let rewards: Vec<_> = rewards.iter().map(|&reward| scale * f64::from(reward)).collect();
            check(SingleStateUcb::new(ucb.clone()), AnyPolicy::Ucb(ucb), &rewards, averages, f64::from(initial));
        }
    }
}

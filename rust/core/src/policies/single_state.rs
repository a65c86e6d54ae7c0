//! Policies for a bandit: one state, in which only the value of the action that was taken changes.
//!
//! They draw and choose as [`AnyPolicy`](super::AnyPolicy) does, but remember what they need not compute again.

use std::sync::LazyLock;

use super::tie_breaking::random_action;
use super::{Policy, TieBreaking, Ucb};
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::numeric::argmax;
use crate::random::Rng;
use crate::schedules::Schedule;

/// The ε-greedy policy of a bandit.
///
/// It remembers the greedy action and a bound on the other values. As long as the value of the greedy action is above the
/// bound, no other value is read.
#[derive(Clone, Debug, PartialEq)]
pub struct SingleStateEpsilonGreedy {
    epsilon: Schedule,
    ties: TieBreaking,
    /// The action chosen last: the only one whose value has changed since.
    last: usize,
    /// The first action with the largest value.
    best: usize,
    /// Its value; NaN if it is unknown.
    best_value: f64,
    /// No other action has a larger value.
    bound: f64,
}

impl SingleStateEpsilonGreedy {
    /// With the exploration rate ε.
    pub fn new(epsilon: Schedule, ties: TieBreaking) -> Self {
        Self { epsilon, ties, last: 0, best: 0, best_value: f64::NAN, bound: f64::NAN }
    }

    /// Finds the largest value and the bound on the others.
    #[cold]
    fn search(&mut self, values: &[f64]) {
        self.best = argmax(values);
        self.best_value = values[self.best];
        let others = values.iter().enumerate().filter(|&(action, _)| action != self.best);
        self.bound = others.fold(f64::NEG_INFINITY, |bound, (_, &value)| if value > bound { value } else { bound });
    }

    /// The greedy action.
    #[inline]
    fn greedy(&self, values: &[f64], rng: &mut impl Rng) -> usize {
        let is_unique = self.best_value > self.bound;
        if is_unique || self.ties == TieBreaking::First {
            return self.best;
        }
        random_action(values, |&value| value == self.best_value, rng)
    }
}

impl Policy for SingleStateEpsilonGreedy {
    #[expect(clippy::inline_always, reason = "a call per step would take a tenth of its time")]
    #[inline(always)]
    fn choose(&mut self, values: &[f64], rng: &mut impl Rng) -> usize {
        let explores = rng.random() >= 1.0 - self.epsilon.value();
        let changed = values[self.last];
        if self.last == self.best {
            self.best_value = changed;
        } else if changed > self.bound {
            self.bound = changed;
        }
        // With equal values each choice searches: which of them is the first, or how many there are, may have changed.
        let is_unique = self.best_value > self.bound;
        if !is_unique {
            self.search(values);
        }
        self.last = if explores { rng.integers(values.len() as u32) as usize } else { self.greedy(values, rng) };
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
        (self.best_value, self.bound) = (f64::NAN, f64::NAN);
        (self.last, self.best) = (0, 0);
        Ok(())
    }

    #[inline]
    fn end_episode(&mut self) {
        self.epsilon.end_episode();
    }
}

/// The logarithms of the first whole numbers, which all runs need.
static LOGS: LazyLock<[f64; 4096]> = LazyLock::new(|| std::array::from_fn(|number| (number as f64).ln()));

/// ln t
#[inline]
fn log_of(time: u64) -> f64 {
    match LOGS.get(time as usize) {
        Some(&log) => log,
        None => (time as f64).ln(),
    }
}

/// How much later a ceiling may be used, as a fraction of the time at which it was computed.
const HORIZON: f64 = 1.0 / 16.0;
/// More than the relative error of a logarithm.
const SLACK: f64 = 1e-12;

/// Upper-confidence-bound action selection for a bandit.
///
/// The confidence bound of an action that is not chosen grows slowly, with ln t. It is at most a ceiling, the bound at a
/// later time, so that only the bounds of actions with high ceilings are computed.
#[derive(Clone, Debug, PartialEq)]
pub struct SingleStateUcb {
    ucb: Ucb,
    /// Above the bound of each action until `horizon`.
    ceilings: Vec<f64>,
    /// The last time for which the ceilings hold.
    horizon: u64,
    /// (1 + `SLACK`) ln `horizon`
    log: f64,
    /// 1 + the number of choices.
    time: u64,
    /// The action chosen last: the only one whose value and count have changed since.
    last: usize,
}

impl SingleStateUcb {
    /// From the policy of a table with one row that has not chosen yet.
    pub fn new(ucb: Ucb) -> Self {
        Self { ceilings: Vec::new(), horizon: 0, log: 0.0, time: 1, last: 0, ucb }
    }

    /// Computes the ceilings anew. `log` of the horizon is raised by more than its error, and every other operation is
    /// rounded correctly and so never falls where its operands rise: no bound until then is above its ceiling.
    #[cold]
    fn raise(&mut self, values: &[f64]) {
        self.horizon = self.time + (self.time as f64 * HORIZON) as u64;
        self.log = (self.horizon as f64).ln() * (1.0 + SLACK);
        self.ceilings.clear();
        self.ceilings.extend((0..values.len()).map(|action| self.ucb.bound_at(self.log, action, values[action])));
    }

    /// The action with the largest bound; `None` if several have it.
    #[inline]
    fn unique_best(&self, values: &[f64]) -> Option<usize> {
        let log = log_of(self.time);
        let bound_of = |action: usize| self.ucb.bound_at(log, action, values[action]);
        let (mut best, mut largest, mut is_unique) = (self.last, bound_of(self.last), true);
        for (action, &ceiling) in self.ceilings.iter().enumerate() {
            if ceiling >= largest && action != self.last {
                let bound = bound_of(action);
                if bound >= largest {
                    is_unique = bound > largest;
                    (best, largest) = (action, bound);
                }
            }
        }
        // NaN is neither above nor below anything.
        (is_unique && largest < f64::INFINITY).then_some(best)
    }
}

impl Policy for SingleStateUcb {
    #[expect(clippy::inline_always, reason = "a call per step would take a tenth of its time")]
    #[inline(always)]
    fn choose(&mut self, values: &[f64], rng: &mut impl Rng) -> usize {
        if self.time > self.horizon {
            self.raise(values);
        } else {
            self.ceilings[self.last] = self.ucb.bound_at(self.log, self.last, values[self.last]);
        }
        self.last = match self.unique_best(values) {
            Some(action) => {
                self.ucb.count(0, action);
                action
            }
            None => self.ucb.choose(0, values, rng),
        };
        self.time += 1;
        self.last
    }

    fn expected_value(&mut self, values: &[f64]) -> f64 {
        self.ucb.expected_value(0, values)
    }

    /// It has counted its choice since; nothing that needs probabilities is combined with it.
    fn probability(&mut self, _values: &[f64], _action: usize) -> f64 {
        1.0
    }

    /// The counts are stored. Other values may be restored, so that the next choice computes the ceilings.
    fn persist_counts(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.ucb.persist_counts(checkpoint)?;
        (self.time, self.horizon) = (self.ucb.time(0), 0);
        Ok(())
    }

    #[inline]
    fn end_episode(&mut self) {}
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::StopFlag;
    use crate::policies::AnyPolicy;
    use crate::random::{Pcg64, SeedSequence};

    /// Checks that two policies take the same actions with the same draws on a bandit whose rewards repeat, so that values
    /// are often equal. Step sizes of 1 / n and constant ones alternate between problems.
    fn check(mut one: impl Policy, mut other: impl Policy, rewards: &[i8], averages: bool, initial: f64) {
        let mut rngs = [(); 2].map(|()| Pcg64::new(&SeedSequence::new(&[5])));
        let (mut values, mut counts) = ([initial; 4], [0.0; 4]);
        for step in 0..400 {
            let actions = [one.choose_in(&[0], &values, &mut rngs[0]), other.choose_in(&[0], &values, &mut rngs[1])];
            assert_eq!(actions[0], actions[1], "step {step}, values {values:?}");
            let action = actions[0];
            let reward = f64::from(rewards[(step + 3 * action) % rewards.len()]);
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
            (random, averages) in any::<(bool, bool)>(),
            initial in -1_i8..4,
        ) {
            let (epsilon, ties) = (Schedule::constant(epsilon), ties(random));
            let remembering = SingleStateEpsilonGreedy::new(epsilon, ties);
            check(remembering, AnyPolicy::EpsilonGreedy { epsilon, ties }, &rewards, averages, f64::from(initial));
        }

        #[test]
        fn ceilings_change_no_choice_by_confidence_bounds(
            rewards in prop::collection::vec(-2_i8..3, 1..40),
            confidence in prop_oneof![Just(0.0), 0.0..4.0],
            (random, averages) in any::<(bool, bool)>(),
            initial in -1_i8..4,
        ) {
            let ucb = Ucb::new(confidence, ties(random), (1, 4), &StopFlag::new()).expect("four counts");
            check(SingleStateUcb::new(ucb.clone()), AnyPolicy::Ucb(ucb), &rewards, averages, f64::from(initial));
        }
    }
}

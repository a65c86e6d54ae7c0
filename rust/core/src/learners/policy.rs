//! How actions are chosen from their values.

use std::hint::select_unpredictable;

use super::{EpsilonGreedy, Schedule};
use crate::random::Draw;
use crate::table::{first_maximum, maximum};

/// A way of choosing actions.
pub trait Policy {
    /// Chooses among the actions of these values.
    fn choose(&mut self, values: &[f64], draw: &mut impl Draw) -> usize;

    /// Σₐ π(a) Q(a), from the left: what the choice is worth on average.
    fn expected(&mut self, values: &[f64]) -> f64;

    /// Called after every episode.
    fn end_episode(&mut self);
}

impl Policy for EpsilonGreedy {
    #[inline]
    fn choose(&mut self, values: &[f64], draw: &mut impl Draw) -> usize {
        EpsilonGreedy::choose(self, values, draw)
    }

    #[inline]
    fn expected(&mut self, values: &[f64]) -> f64 {
        let any = self.epsilon() / values.len() as f64;
        let greedy = any + (1.0 - self.epsilon());
        let expected = |best| {
            sum(values
                .iter()
                .enumerate()
                .map(|(action, &value)| if action == best { greedy * value } else { any * value }))
        };
        // The answer for each action that might be the greedy one: for a few, sooner than to search first and add then.
        let best = first_maximum(values);
        (1..values.len())
            .fold(expected(0), |found, action| select_unpredictable(action == best, expected(action), found))
    }

    fn end_episode(&mut self) {
        EpsilonGreedy::end_episode(self);
    }
}

/// Which of several largest values is the greedy one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ties {
    /// The first, as `np.argmax` has it.
    First,
    /// Any of them, by one more draw; none where the largest is alone.
    Random,
}

impl Ties {
    #[inline]
    fn greedy(self, values: &[f64], draw: &mut impl Draw) -> usize {
        match self {
            Self::First => first_maximum(values),
            Self::Random => {
                let best = first_maximum(values);
                let largest = values[best];
                // Mostly it is alone, and no draw is due.
                let equals = values.iter().filter(|&&value| value == largest).count();
                if equals == 1 { best } else { any(values, |&value| value == largest, draw) }
            }
        }
    }

    /// Σₐ π(a) Q(a) of the ε-greedy policy over these values.
    #[inline]
    fn expected(self, epsilon: f64, values: impl Iterator<Item = f64> + Clone) -> f64 {
        let largest = values.clone().reduce(|largest, value| if value > largest { value } else { largest });
        let is_largest = |value| value == largest.unwrap_or(f64::NAN);
        let any = epsilon / values.clone().count() as f64;
        match self {
            Self::First => {
                let (greedy, mut found) = (any + (1.0 - epsilon), false);
                sum(values.map(|value| {
                    let first = is_largest(value) && !found;
                    found |= first;
                    (if first { greedy } else { any }) * value
                }))
            }
            Self::Random => {
                let equals = values.clone().filter(|&value| is_largest(value)).count();
                // A division less where it changes nothing.
                let share = if equals == 1 { 1.0 - epsilon } else { (1.0 - epsilon) / equals as f64 };
                let greedy = any + share;
                sum(values.map(|value| select_unpredictable(is_largest(value), greedy, any) * value))
            }
        }
    }
}

/// Any of the ways, chosen at run time.
#[derive(Clone, Debug, PartialEq)]
pub enum Behaviour {
    /// Mostly the greedy action, sometimes any (Sutton & Barto, section 2.2).
    EpsilonGreedy {
        /// ε.
        epsilon: Schedule,
        /// Which of several greedy actions.
        ties: Ties,
    },
    /// The same among the actions that a state has: a value of -∞ stands for one that it has not.
    EpsilonGreedyAmongSome {
        /// ε.
        epsilon: Schedule,
        /// Which of several greedy actions.
        ties: Ties,
    },
    /// Each action by exp(Q / τ) (Sutton & Barto, equation 2.11, with a temperature).
    Softmax(Softmax),
}

impl Behaviour {
    /// Softmax over so many actions.
    pub fn softmax(temperature: f64, actions: usize) -> Self {
        Self::Softmax(Softmax { temperature, shares: vec![0.0; actions] })
    }
}

impl Policy for Behaviour {
    /// One `random()` at every decision; then one `integers` where it explores, or to choose among equals.
    #[inline]
    fn choose(&mut self, values: &[f64], draw: &mut impl Draw) -> usize {
        match self {
            Self::EpsilonGreedy { epsilon, ties } => {
                if draw.random() >= 1.0 - epsilon.value() {
                    draw.integers(values.len() as u32) as usize
                } else {
                    ties.greedy(values, draw)
                }
            }
            Self::EpsilonGreedyAmongSome { epsilon, ties } => {
                if draw.random() >= 1.0 - epsilon.value() {
                    any(values, is_there, draw)
                } else {
                    ties.greedy(values, draw)
                }
            }
            Self::Softmax(softmax) => softmax.choose(values, draw),
        }
    }

    #[inline]
    fn expected(&mut self, values: &[f64]) -> f64 {
        match self {
            Self::EpsilonGreedy { epsilon, ties } => ties.expected(epsilon.value(), values.iter().copied()),
            Self::EpsilonGreedyAmongSome { epsilon, ties } => {
                ties.expected(epsilon.value(), values.iter().copied().filter(is_there))
            }
            Self::Softmax(softmax) => {
                sum(softmax.shares(values).iter().zip(values).map(|(share, value)| share * value))
            }
        }
    }

    fn end_episode(&mut self) {
        if let Self::EpsilonGreedy { epsilon, .. } | Self::EpsilonGreedyAmongSome { epsilon, .. } = self {
            epsilon.end_episode();
        }
    }
}

/// Each action by exp(Q / τ), shifted by the largest value so that nothing overflows.
#[derive(Clone, Debug, PartialEq)]
pub struct Softmax {
    temperature: f64,
    shares: Vec<f64>,
}

impl Softmax {
    fn shares(&mut self, values: &[f64]) -> &[f64] {
        let largest = maximum(values);
        for (share, value) in self.shares.iter_mut().zip(values) {
            *share = ((value - largest) / self.temperature).exp();
        }
        let total = sum(self.shares.iter().copied());
        for share in &mut self.shares {
            *share /= total;
        }
        &self.shares
    }

    fn choose(&mut self, values: &[f64], draw: &mut impl Draw) -> usize {
        let drawn = draw.random();
        let mut reached = 0.0;
        let shares = self.shares(values);
        // Rounding may leave the last sum a little below one.
        let chosen = shares.iter().position(|share| {
            reached += share;
            drawn < reached
        });
        chosen.unwrap_or(shares.len() - 1)
    }
}

/// Whether a state has the action of this value.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "filters hand out references")]
#[inline]
fn is_there(value: &f64) -> bool {
    *value != f64::NEG_INFINITY
}

/// Any of those that fit.
#[inline]
fn any(values: &[f64], fits: impl Fn(&f64) -> bool, draw: &mut impl Draw) -> usize {
    let fitting = || values.iter().enumerate().filter(|(_, value)| fits(value)).map(|(action, _)| action);
    // Where nothing equals the largest, it is NaN, and the run is about to stop.
    let chosen = draw.integers(fitting().count() as u32) as usize;
    fitting().nth(chosen).unwrap_or(0)
}

/// From the left, beginning with the first.
#[inline]
fn sum(mut numbers: impl Iterator<Item = f64>) -> f64 {
    let first = numbers.next().unwrap_or(0.0);
    numbers.fold(first, |total, number| total + number)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Pcg64, SeedSequence};

    fn greedy(ties: Ties) -> Behaviour {
        Behaviour::EpsilonGreedy { epsilon: Schedule::constant(0.25), ties }
    }

    #[test]
    fn the_expected_value_weighs_the_greedy_action_most() {
        // (1/16 + 3/4) 4 + 1/16 (2 + 0 - 1)
        assert_eq!(greedy(Ties::First).expected(&[2.0, 4.0, 0.0, -1.0]), 3.3125);
        assert_eq!(EpsilonGreedy::linear(0.25, 0.25, 1).expected(&[2.0, 4.0, 0.0, -1.0]), 3.3125);
    }

    #[test]
    fn softmax_weighs_by_the_exponential() {
        let mut softmax = Behaviour::softmax(1.0, 2);
        let expected = softmax.expected(&[0.0, 3.0_f64.ln()]);
        assert!((expected - 0.75 * 3.0_f64.ln()).abs() < 1e-15);
    }

    #[test]
    fn random_ties_take_each_of_the_largest_and_no_other() {
        let mut draw = Pcg64::new(&SeedSequence::new(&[1]));
        let mut counts = [0; 3];
        for _ in 0..1000 {
            counts[Ties::Random.greedy(&[1.0, 0.0, 1.0], &mut draw)] += 1;
        }
        assert!(counts[0] > 400 && counts[2] > 400 && counts[1] == 0);
    }

    #[test]
    fn an_action_that_is_not_there_is_neither_chosen_nor_counted() {
        let values = [2.0, f64::NEG_INFINITY, -1.0, f64::NEG_INFINITY];
        let mut some = Behaviour::EpsilonGreedyAmongSome { epsilon: Schedule::constant(1.0), ties: Ties::First };
        let mut draw = Pcg64::new(&SeedSequence::new(&[1]));
        let mut counts = [0; 4];
        for _ in 0..1000 {
            counts[some.choose(&values, &mut draw)] += 1;
        }
        assert!(counts[0] > 400 && counts[2] > 400 && counts[1] + counts[3] == 0);
        assert_eq!(some.expected(&values), 0.5);
    }

    #[test]
    fn a_lone_maximum_draws_nothing_more() {
        let mut draw = Pcg64::new(&SeedSequence::new(&[1]));
        let before = draw.clone();
        assert_eq!(Ties::Random.greedy(&[0.0, 2.0], &mut draw), 1);
        assert_eq!(draw, before);
    }
}

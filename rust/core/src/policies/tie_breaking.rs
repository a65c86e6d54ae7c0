//! The greedy action when several actions have the maximal value.

use std::hint::select_unpredictable;

use crate::numeric::{argmax, sum};
use crate::random::Rng;

/// The rule that selects the greedy action if several have the maximal value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TieBreaking {
    /// The first action: `np.argmax`.
    First,
    /// A random action, which takes one more draw. A unique maximum takes none.
    Random,
}

impl TieBreaking {
    /// The greedy action.
    #[expect(
        clippy::inline_always,
        reason = "where the number of actions is known, a call per step would take a third of its time"
    )]
    #[inline(always)]
    pub(super) fn greedy(self, values: &[f64], rng: &mut impl Rng) -> usize {
        match self {
            Self::First => argmax(values),
            Self::Random => {
                let best = argmax(values);
                let largest = values[best];
                let ties = values.iter().filter(|&&value| value == largest).count();
                if ties == 1 { best } else { tied_action(values, largest, ties, rng) }
            }
        }
    }

    /// The probability of an action under the ε-greedy policy over `count` available actions.
    #[inline]
    pub(super) fn probability(self, epsilon: f64, values: &[f64], count: usize, action: usize) -> f64 {
        let (best, other) = (argmax(values), epsilon / count as f64);
        match self {
            Self::First if action == best => other + (1.0 - epsilon),
            Self::Random if values[action] == values[best] => {
                let ties = values.iter().filter(|&&value| value == values[best]).count();
                other + (1.0 - epsilon) / ties as f64
            }
            _ => other,
        }
    }

    /// The expected value Σₐ π(a) Q(a) of the ε-greedy policy.
    #[inline]
    pub(super) fn expected_value(self, epsilon: f64, values: impl Iterator<Item = f64> + Clone) -> f64 {
        let largest = values.clone().reduce(|largest, value| if value > largest { value } else { largest });
        let largest = largest.unwrap_or(f64::NAN);
        let other = epsilon / values.clone().count() as f64;
        // The closures own their numbers: references would be read from memory for every action.
        match self {
            Self::First => {
                let (greedy, mut found) = (other + (1.0 - epsilon), false);
                sum(values.map(move |value| {
                    let first = value == largest && !found;
                    found |= first;
                    (if first { greedy } else { other }) * value
                }))
            }
            Self::Random => {
                let ties = values.clone().filter(|&value| value == largest).count();
                // Skips a division by 1, which takes time.
                let share = if ties == 1 { 1.0 - epsilon } else { (1.0 - epsilon) / ties as f64 };
                let greedy = other + share;
                sum(values.map(move |value| select_unpredictable(value == largest, greedy, other) * value))
            }
        }
    }
}

/// A random action among the `ties` actions with the maximal value.
#[inline]
fn tied_action(values: &[f64], largest: f64, ties: usize, rng: &mut impl Rng) -> usize {
    let (mut left, mut chosen) = (rng.integers(ties as u32) as usize, 0);
    // A branch would often be mispredicted, because the choice is random. If the maximum is NaN, no action has it: the
    // run has then diverged and stops after this episode.
    for (action, &value) in values.iter().enumerate() {
        let eligible = value == largest;
        chosen = select_unpredictable(eligible && left == 0, action, chosen);
        left = left.wrapping_sub(usize::from(eligible));
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Pcg64, SeedSequence};

    #[test]
    fn random_tie_breaking_chooses_each_maximum_and_nothing_else() {
        let mut rng = Pcg64::new(&SeedSequence::new(&[1]));
        let mut counts = [0; 3];
        for _ in 0..1000 {
            counts[TieBreaking::Random.greedy(&[1.0, 0.0, 1.0], &mut rng)] += 1;
        }
        assert!(counts[0] > 400 && counts[2] > 400 && counts[1] == 0);
    }

    #[test]
    fn a_unique_maximum_draws_nothing() {
        let mut rng = Pcg64::new(&SeedSequence::new(&[1]));
        let before = rng.clone();
        assert_eq!(TieBreaking::Random.greedy(&[0.0, 2.0], &mut rng), 1);
        assert_eq!(rng, before);
    }
}

//! Which of several equally good actions is the greedy one.

use std::hint::select_unpredictable;

use crate::numeric::{argmax, sum};
use crate::random::Rng;

/// Which of several largest values is the greedy one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TieBreaking {
    /// The first, as `np.argmax` has it.
    First,
    /// Any of them, by one more draw; none where the largest is alone.
    Random,
}

impl TieBreaking {
    #[inline]
    pub(super) fn greedy(self, values: &[f64], rng: &mut impl Rng) -> usize {
        match self {
            Self::First => argmax(values),
            Self::Random => {
                let best = argmax(values);
                let largest = values[best];
                // Mostly it is alone, and no draw is due.
                let equals = values.iter().filter(|&&value| value == largest).count();
                if equals == 1 { best } else { any(values, |&value| value == largest, rng) }
            }
        }
    }

    /// Σₐ π(a) Q(a) of the ε-greedy policy over these values.
    #[inline]
    pub(super) fn expected(self, epsilon: f64, values: impl Iterator<Item = f64> + Clone) -> f64 {
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

/// Any of those that fit.
#[inline]
pub(super) fn any(values: &[f64], fits: impl Fn(&f64) -> bool, rng: &mut impl Rng) -> usize {
    let fitting = || values.iter().enumerate().filter(|(_, value)| fits(value)).map(|(action, _)| action);
    // Where nothing equals the largest, it is NaN, and the run is about to stop.
    let chosen = rng.integers(fitting().count() as u32) as usize;
    fitting().nth(chosen).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Pcg64, SeedSequence};

    #[test]
    fn random_ties_take_each_of_the_largest_and_no_other() {
        let mut rng = Pcg64::new(&SeedSequence::new(&[1]));
        let mut counts = [0; 3];
        for _ in 0..1000 {
            counts[TieBreaking::Random.greedy(&[1.0, 0.0, 1.0], &mut rng)] += 1;
        }
        assert!(counts[0] > 400 && counts[2] > 400 && counts[1] == 0);
    }

    #[test]
    fn a_lone_maximum_draws_nothing_more() {
        let mut rng = Pcg64::new(&SeedSequence::new(&[1]));
        let before = rng.clone();
        assert_eq!(TieBreaking::Random.greedy(&[0.0, 2.0], &mut rng), 1);
        assert_eq!(rng, before);
    }
}

//! The steps of a table in which all state-action pairs have the same few thresholds.

use std::hint::select_unpredictable;
use std::iter::once;
use std::sync::Arc;

use super::outcome_distribution::ABOVE_ALL;
use crate::envs::Step;

/// Gymnasium's tables need no more, because an action fails with the same probability everywhere.
const MAX_THRESHOLDS: usize = 3;
/// The steps of larger tables do not fit into the caches, where storing them twice would cost more than it gains.
const MAX_STEPS: usize = 1 << 16;

/// The thresholds of all state-action pairs, and each pair's step for each interval between them.
///
/// The interval that a draw falls into does not depend on the pair, so the processor can find it before it knows the
/// action. The next state is then a single load away; otherwise that load would first wait for the thresholds of the
/// pair.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct IntervalSteps {
    /// In ascending order, padded with [`ABOVE_ALL`].
    thresholds: [u64; MAX_THRESHOLDS],
    /// The steps of all pairs for draws below the first threshold, then those for the next interval, and so on.
    steps: Arc<[Step<u32>]>,
    num_pairs: usize,
}

impl IntervalSteps {
    /// The steps of a table with these thresholds, in which `sample` finds the step of a pair for a draw. `None` if
    /// there are too many different thresholds, or too many steps.
    pub(super) fn new(num_pairs: usize, thresholds: &[u64], sample: impl Fn(usize, u64) -> Step<u32>) -> Option<Self> {
        let mut reached = Vec::new();
        for &threshold in thresholds {
            if threshold < ABOVE_ALL && !reached.contains(&threshold) {
                reached.push(threshold);
            }
            if reached.len() > MAX_THRESHOLDS {
                return None;
            }
        }
        if num_pairs * (reached.len() + 1) > MAX_STEPS {
            return None;
        }
        reached.sort_unstable();
        let starts = once(0).chain(reached.iter().copied());
        let steps = starts.flat_map(|start| (0..num_pairs).map(move |pair| (pair, start)));
        let steps = steps.map(|(pair, start)| sample(pair, start)).collect();
        let mut thresholds = [ABOVE_ALL; MAX_THRESHOLDS];
        thresholds[..reached.len()].copy_from_slice(&reached);
        Some(Self { thresholds, steps, num_pairs })
    }

    /// The step of a pair for a draw of 53 bits.
    #[expect(clippy::inline_always, reason = "a call per step would take a fifth of its time")]
    #[inline(always)]
    pub(super) fn step(&self, pair: usize, u53: u64) -> Step<u32> {
        // Branches would often be mispredicted.
        let sizes = self.thresholds.map(|threshold| select_unpredictable(threshold <= u53, self.num_pairs, 0));
        self.steps[sizes.iter().sum::<usize>() + pair]
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::envs::tabular::{Outcome, TabularMdp};
    use crate::envs::{Env, TransitionProbability};
    use crate::random::{Pcg64, SeedSequence};

    /// The step of a pair whose outcomes end at these thresholds.
    fn sample(pair: usize, thresholds: &[u64], u53: u64) -> Step<u32> {
        let outcome = thresholds.iter().filter(|&&threshold| threshold <= u53).count();
        Step { state: outcome as u32, reward: pair as f64, terminated: false }
    }

    #[test]
    fn each_draw_has_the_step_of_its_pair() {
        let pairs: [&[u64]; 3] = [&[10, 30, ABOVE_ALL], &[ABOVE_ALL], &[20, ABOVE_ALL]];
        let steps = IntervalSteps::new(3, &pairs.concat(), |pair, u53| sample(pair, pairs[pair], u53));
        let steps = steps.expect("three thresholds");
        for u53 in [0, 9, 10, 11, 19, 20, 29, 30, ABOVE_ALL - 1] {
            for (pair, thresholds) in pairs.iter().enumerate() {
                assert_eq!(steps.step(pair, u53), sample(pair, thresholds, u53), "pair {pair}, draw {u53}");
            }
        }
    }

    #[test]
    fn too_many_thresholds_or_steps_are_left_alone() {
        let step = |_, _| Step { state: 0, reward: 0.0, terminated: false };
        assert!(IntervalSteps::new(1, &[1, 2, 3, 3, ABOVE_ALL], step).is_some());
        assert!(IntervalSteps::new(1, &[1, 2, 3, 4], step).is_none());
        assert!(IntervalSteps::new(MAX_STEPS / 2, &[1], step).is_some());
        assert!(IntervalSteps::new(MAX_STEPS / 2 + 1, &[1], step).is_none());
    }

    proptest! {
        #[test]
        fn steps_by_interval_are_those_of_the_distribution_of_the_pair(
            kinds in [0..6_usize, 0..6],
            second_kind in prop::collection::vec(any::<bool>(), 4 * 3),
            rewards in prop::collection::vec(-9.0..9.0, 4),
            seed in any::<u32>(),
        ) {
            let third = 1.0 / 3.0;
            let distributions: [&[f64]; 6] =
                [&[1.0], &[third; 3], &[0.8, 0.1, 0.1], &[0.5, 0.5], &[0.0, 1.0], &[0.4, 0.3, 0.2, 0.1]];
            let outcome = |(state, (&probability, &reward))| {
                Outcome { probability, state, reward, terminated: state == 2 }
            };
            let distribution = |second: &bool| distributions[kinds[usize::from(*second)]].iter();
            let pairs: Vec<Vec<Outcome>> =
                second_kind.iter().map(|second| (0..).zip(distribution(second).zip(&rewards)).map(outcome).collect()).collect();
            let table = TabularMdp::new(3, &[0.25; 4], &pairs).expect("a valid table");
            let mut rng = Pcg64::new(&SeedSequence::new(&[seed]));
            for draw in 0..200 {
                let (state, action) = (draw % 4, (draw / 4 % 3) as usize);
                let (expected, _) = table.step_with_probability(state, action, &mut rng.clone());
                prop_assert_eq!(table.step(state, action, &mut rng), expected);
            }
        }
    }
}

//! The short corridor with switched actions (Sutton & Barto, Example 13.1).
//!
//! Three states lie in a row, and the goal is to the right of them. The actions right and left move as named, except in
//! the second state, where they are switched; left in the first state does nothing. All states have the same
//! observation.

use crate::envs::{Env, Step};
use crate::random::Rng;

/// The state with switched actions.
const SWITCHED: u32 = 1;
/// The terminal state.
const GOAL: u32 = 3;
/// The action "right"; the other is "left".
const RIGHT: usize = 1;

/// The corridor, which has no parameters. The reward of every step is -1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShortCorridor;

impl Env for ShortCorridor {
    type State = u32;
    type Action = usize;
    type Observation = u32;

    #[inline]
    fn num_actions(&self) -> usize {
        2
    }

    #[inline]
    fn reset(&self, _rng: &mut impl Rng) -> u32 {
        0
    }

    #[inline]
    fn step(&self, state: u32, action: usize, _rng: &mut impl Rng) -> Step<u32> {
        let to_the_right = (action == RIGHT) != (state == SWITCHED);
        let state = if to_the_right { state + 1 } else { state.saturating_sub(1) };
        Step { state, reward: -1.0, terminated: state == GOAL }
    }

    /// The observation 0, for every state.
    #[inline]
    fn observe(&self, _state: &u32) -> u32 {
        0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::NoRng;

    #[test]
    fn actions_are_switched_in_the_second_state() {
        let next = |state, action| ShortCorridor.step(state, action, &mut NoRng).state;
        assert_eq!([next(0, 0), next(0, 1)], [0, 1]);
        assert_eq!([next(1, 0), next(1, 1)], [2, 0]);
        assert_eq!([next(2, 0), next(2, 1)], [1, 3]);
        assert!(ShortCorridor.step(2, 1, &mut NoRng).terminated);
    }
}

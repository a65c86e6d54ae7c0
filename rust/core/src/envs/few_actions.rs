//! A few of an environment's continuous actions, numbered: what a table can choose from.

use crate::env::{Env, Step};
use crate::random::Draw;

/// An environment whose actions are those of a list, by their place in it.
#[derive(Clone, Debug, PartialEq)]
pub struct FewActions<E: Env> {
    /// The environment as it is.
    pub env: E,
    /// What its step takes.
    pub actions: Vec<E::Action>,
}

impl<E: Env> Env for FewActions<E> {
    type State = E::State;
    type Action = usize;
    type Observation = E::Observation;

    #[inline]
    fn actions(&self) -> usize {
        self.actions.len()
    }

    #[inline]
    fn reset(&self, draw: &mut impl Draw) -> E::State {
        self.env.reset(draw)
    }

    #[inline]
    fn step(&self, state: E::State, action: usize, draw: &mut impl Draw) -> Step<E::State> {
        self.env.step(state, self.actions[action], draw)
    }

    #[inline]
    fn observe(&self, state: &E::State) -> E::Observation {
        self.env.observe(state)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envs::{Pendulum, PendulumState, Scalar};
    use crate::random::{Pcg64, SeedSequence};

    #[test]
    fn an_action_is_the_one_of_its_place() {
        let few = FewActions { env: Pendulum::default(), actions: vec![Scalar::Single(-2.0), Scalar::Single(0.5)] };
        let state = PendulumState { theta: 1.0, theta_dot: 0.0 };
        let mut draw = Pcg64::new(&SeedSequence::new(&[0]));
        assert_eq!(few.actions(), 2);
        assert_eq!(few.step(state, 1, &mut draw), few.env.step(state, Scalar::Single(0.5), &mut draw));
        assert_ne!(few.step(state, 0, &mut draw), few.step(state, 1, &mut draw));
    }
}

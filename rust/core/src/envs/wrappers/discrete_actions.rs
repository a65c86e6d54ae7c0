//! A few of an environment's continuous actions, numbered: what a table can choose from.

use crate::envs::{Env, Step};
use crate::random::Rng;

/// An environment whose actions are those of a list, by their place in it.
#[derive(Clone, Debug, PartialEq)]
pub struct DiscreteActions<E: Env> {
    /// The environment as it is.
    pub env: E,
    /// What its step takes.
    pub actions: Vec<E::Action>,
}

impl<E: Env> Env for DiscreteActions<E> {
    type State = E::State;
    type Action = usize;
    type Observation = E::Observation;

    #[inline]
    fn num_actions(&self) -> usize {
        self.actions.len()
    }

    #[inline]
    fn reset(&self, rng: &mut impl Rng) -> E::State {
        self.env.reset(rng)
    }

    #[inline]
    fn step(&self, state: E::State, action: usize, rng: &mut impl Rng) -> Step<E::State> {
        self.env.step(state, self.actions[action], rng)
    }

    #[inline]
    fn observe(&self, state: &E::State) -> E::Observation {
        self.env.observe(state)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envs::classic_control::{Pendulum, PendulumState};
    use crate::numeric::Scalar;
    use crate::random::{Pcg64, SeedSequence};

    #[test]
    fn an_action_is_the_one_of_its_place() {
        let few =
            DiscreteActions { env: Pendulum::default(), actions: vec![Scalar::Single(-2.0), Scalar::Single(0.5)] };
        let state = PendulumState { theta: 1.0, theta_dot: 0.0 };
        let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
        assert_eq!(few.num_actions(), 2);
        assert_eq!(few.step(state, 1, &mut rng), few.env.step(state, Scalar::Single(0.5), &mut rng));
        assert_ne!(few.step(state, 0, &mut rng), few.step(state, 1, &mut rng));
    }
}

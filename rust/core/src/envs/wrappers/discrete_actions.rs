//! Discrete actions for an environment with continuous ones.

use crate::envs::{Env, Step};
use crate::random::Rng;

/// A wrapper whose discrete actions are indices into a list of continuous ones.
#[derive(Clone, Debug, PartialEq)]
pub struct DiscreteActions<E: Env> {
    /// The wrapped environment.
    pub env: E,
    /// The continuous action of each index.
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
    fn an_action_is_an_index_into_the_list() {
        let discrete =
            DiscreteActions { env: Pendulum::default(), actions: vec![Scalar::Single(-2.0), Scalar::Single(0.5)] };
        let state = PendulumState { theta: 1.0, theta_dot: 0.0 };
        let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
        assert_eq!(discrete.num_actions(), 2);
        assert_eq!(discrete.step(state, 1, &mut rng), discrete.env.step(state, Scalar::Single(0.5), &mut rng));
        assert_ne!(discrete.step(state, 0, &mut rng), discrete.step(state, 1, &mut rng));
    }
}

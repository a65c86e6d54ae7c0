//! An environment whose state includes the probability of the last step.

use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::envs::{Env, Step, TransitionProbability};
use crate::random::Rng;

/// A wrapper that adds the probability of the last step to the state, for `info["prob"]` of Gymnasium's toy text
/// environments.
#[derive(Clone, Debug, PartialEq)]
pub struct WithTransitionProbability<E>(pub E);

/// A state and the probability of the step that led to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransitionProbabilityState<S> {
    /// The state of the wrapped environment.
    pub state: S,
    /// The probability of the sampled outcome; 1 after a reset.
    pub probability: f64,
}

impl<S: Persist> Persist for TransitionProbabilityState<S> {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        (&mut self.state, &mut self.probability).persist(checkpoint)
    }
}

impl<E: TransitionProbability> Env for WithTransitionProbability<E> {
    type State = TransitionProbabilityState<E::State>;
    type Action = E::Action;
    type Observation = E::Observation;

    #[inline]
    fn num_actions(&self) -> usize {
        self.0.num_actions()
    }

    #[inline]
    fn reset(&self, rng: &mut impl Rng) -> Self::State {
        TransitionProbabilityState { state: self.0.reset(rng), probability: 1.0 }
    }

    #[inline]
    fn step(&self, state: Self::State, action: Self::Action, rng: &mut impl Rng) -> Step<Self::State> {
        let (Step { state, reward, terminated }, probability) = self.0.step_with_probability(state.state, action, rng);
        Step { state: TransitionProbabilityState { state, probability }, reward, terminated }
    }

    #[inline]
    fn observe(&self, state: &Self::State) -> Self::Observation {
        self.0.observe(&state.state)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envs::tabular::{Outcome, TabularMdp};
    use crate::random::{Pcg64, SeedSequence};

    #[test]
    fn the_state_holds_the_probability_of_the_step() {
        let outcome = |probability, state| Outcome { probability, state, reward: 0.0, terminated: false };
        let rows = [vec![outcome(0.25, 0), outcome(0.75, 1)], vec![outcome(1.0, 0)]];
        let table = TabularMdp::new(1, &[1.0, 0.0], &rows).expect("a valid table");
        let wrapped = WithTransitionProbability(table.clone());
        let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
        let mut state = wrapped.reset(&mut rng);
        assert_eq!(state, TransitionProbabilityState { state: 0, probability: 1.0 });
        for _ in 0..100 {
            let mut same = rng.clone();
            let step = wrapped.step(state, 0, &mut rng);
            assert_eq!(step.state.state, table.step(state.state, 0, &mut same).state);
            let expected = match (state.state, step.state.state) {
                (0, 0) => 0.25,
                (0, _) => 0.75,
                _ => 1.0,
            };
            assert_eq!(step.state.probability, expected);
            state = step.state;
        }
    }
}

//! Tables that say how likely what happened was, as Gymnasium's toy text does in its info.

use crate::env::{Env, Step};
use crate::random::Draw;

/// An environment whose steps have probabilities.
pub trait Tells: Env {
    /// One step, and how likely it was.
    fn tell(&self, state: Self::State, action: Self::Action, draw: &mut impl Draw) -> (Step<Self::State>, f64);
}

/// The same environment, whose state remembers how likely it was.
#[derive(Clone, Debug, PartialEq)]
pub struct Telling<E>(pub E);

/// A state, and how likely the step was that led to it; 1 after a reset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Told<S> {
    /// The environment's own state.
    pub state: S,
    /// Of what was drawn.
    pub probability: f64,
}

impl<E: Tells> Env for Telling<E> {
    type State = Told<E::State>;
    type Action = E::Action;
    type Observation = E::Observation;

    #[inline]
    fn actions(&self) -> usize {
        self.0.actions()
    }

    #[inline]
    fn reset(&self, draw: &mut impl Draw) -> Self::State {
        Told { state: self.0.reset(draw), probability: 1.0 }
    }

    #[inline]
    fn step(&self, state: Self::State, action: Self::Action, draw: &mut impl Draw) -> Step<Self::State> {
        let (Step { state, reward, terminated }, probability) = self.0.tell(state.state, action, draw);
        Step { state: Told { state, probability }, reward, terminated }
    }

    #[inline]
    fn observe(&self, state: &Self::State) -> Self::Observation {
        self.0.observe(&state.state)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envs::{Outcome, Tabular};
    use crate::random::{Pcg64, SeedSequence};

    #[test]
    fn what_happened_says_how_likely_it_was() {
        let outcome = |probability, state| Outcome { probability, state, reward: 0.0, terminated: false };
        let rows = [vec![outcome(0.25, 0), outcome(0.75, 1)], vec![outcome(1.0, 0)]];
        let table = Tabular::new(1, &[1.0, 0.0], &rows).expect("a table");
        let telling = Telling(table.clone());
        let mut draw = Pcg64::new(&SeedSequence::new(&[0]));
        let mut state = telling.reset(&mut draw);
        assert_eq!(state, Told { state: 0, probability: 1.0 });
        for _ in 0..100 {
            let mut same = draw.clone();
            let step = telling.step(state, 0, &mut draw);
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

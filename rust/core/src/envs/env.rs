//! The trait of all environments.

use crate::checkpoint::Persist;
use crate::random::Rng;

/// The result of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<S> {
    /// The next state.
    pub state: S,
    /// The reward.
    pub reward: f64,
    /// Whether the next state is terminal. Time limits belong to the task, not to the environment.
    pub terminated: bool,
}

/// The dynamics of an environment: frozen parameters in `self`, the state passed by value, the random generator passed
/// in.
pub trait Env {
    /// The part that changes from step to step.
    type State: Copy + Persist;
    /// An action: an index if the actions are discrete.
    type Action: Copy;
    /// An observation, in Gymnasium's dtype.
    type Observation;

    /// The number of actions, or 0 if they are continuous.
    fn num_actions(&self) -> usize;

    /// The initial state of an episode.
    fn reset(&self, rng: &mut impl Rng) -> Self::State;

    /// The default bounds of the initial state, named as Gymnasium's reset options. `None` if the environment has no
    /// such options.
    const RESET_BOUNDS: Option<[(&'static str, f64); 2]> = None;

    /// The initial state of an episode within other bounds. Without reset options, the same as `reset`.
    fn reset_within(&self, _bounds: [f64; 2], rng: &mut impl Rng) -> Self::State {
        self.reset(rng)
    }

    /// One step.
    ///
    /// # Panics
    /// May panic if the action is out of range. The caller checks actions that come from outside.
    fn step(&self, state: Self::State, action: Self::Action, rng: &mut impl Rng) -> Step<Self::State>;

    /// The observation of a state.
    fn observe(&self, state: &Self::State) -> Self::Observation;
}

/// An environment that knows the probability of each step, as Gymnasium's toy text environments report it in `info`.
pub trait TransitionProbability: Env {
    /// One step, and the probability of the sampled outcome.
    fn step_with_probability(
        &self,
        state: Self::State,
        action: Self::Action,
        rng: &mut impl Rng,
    ) -> (Step<Self::State>, f64);
}

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
///
/// ```
/// use qtab_core::envs::{Env, Step};
/// use qtab_core::random::{Pcg64, Rng, SeedSequence};
///
/// /// A coin to guess: each guess is an episode.
/// struct Coin {
///     heads: f64,
/// }
///
/// impl Env for Coin {
///     type State = (); // a struct is saved by `persist_struct!`
///     type Action = usize; // what learners choose
///     type Observation = usize; // a row of the table, with `features::Identity`
///
///     fn num_actions(&self) -> usize {
///         2
///     }
///
///     fn reset(&self, _rng: &mut impl Rng) {}
///
///     fn step(&self, _state: (), guess: usize, rng: &mut impl Rng) -> Step<()> {
///         let is_heads = rng.random() < self.heads;
///         let reward = if usize::from(is_heads) == guess { 1.0 } else { 0.0 };
///         Step { state: (), reward, terminated: true }
///     }
///
///     fn observe(&self, _state: &()) -> usize {
///         0
///     }
/// }
///
/// let mut rng = Pcg64::new(&SeedSequence::from(0));
/// assert_eq!(Coin { heads: 1.0 }.step((), 1, &mut rng).reward, 1.0);
/// ```
pub trait Env {
    /// The part that changes from step to step.
    type State: Copy + Persist;
    /// An action: an index, `usize`, if the actions are discrete. Learners need such environments.
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

impl<E: Env> Env for &E {
    type State = E::State;
    type Action = E::Action;
    type Observation = E::Observation;

    const RESET_BOUNDS: Option<[(&'static str, f64); 2]> = E::RESET_BOUNDS;

    #[inline]
    fn num_actions(&self) -> usize {
        E::num_actions(self)
    }

    #[inline]
    fn reset(&self, rng: &mut impl Rng) -> E::State {
        E::reset(self, rng)
    }

    #[inline]
    fn reset_within(&self, bounds: [f64; 2], rng: &mut impl Rng) -> E::State {
        E::reset_within(self, bounds, rng)
    }

    #[inline]
    fn step(&self, state: E::State, action: E::Action, rng: &mut impl Rng) -> Step<E::State> {
        E::step(self, state, action, rng)
    }

    #[inline]
    fn observe(&self, state: &E::State) -> E::Observation {
        E::observe(self, state)
    }
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

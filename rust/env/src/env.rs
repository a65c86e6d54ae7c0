//! The trait of environments that are written in Rust.

use crate::{Generator, Number};

/// An environment: its parameters, which do not change.
///
/// The state of an episode is passed to the functions and returned by them. They keep nothing between two calls, draw
/// random numbers only from the generator that they receive, and are called on several threads at the same time. A
/// function that panics ends the run with an error. This needs `panic = "unwind"`, Cargo's default.
pub trait Env: Send + Sync + 'static {
    /// The state of an episode: a number, an array, a tuple, or a struct that derives `Clone` and `Copy`. Its alignment
    /// is at most 16.
    ///
    /// Its bytes are stored when a run is saved within an episode, and another process restores them, so that a state
    /// contains no references or pointers to functions. Only this build of the library may read them. Bytes of padding
    /// are stored as well; they may differ between equal states.
    type State: Copy + Send + 'static;

    /// The type of an observation's numbers: `f32`, `f64` or `i64`. Observations of one `i64` are a Discrete space.
    type Number: Number;

    /// The number of actions, which are the integers from 0 on.
    fn num_actions(&self) -> usize;

    /// The lowest and the highest value of each number of an observation, inclusive; infinite ones for floats without a
    /// bound. The length is the size of an observation.
    fn observation_bounds(&self) -> Vec<(Self::Number, Self::Number)>;

    /// The time limit in steps; `None` for no limit.
    fn max_episode_steps(&self) -> Option<u32> {
        None
    }

    /// Whether [`action_mask`](Self::action_mask) writes masks.
    fn has_action_mask(&self) -> bool {
        false
    }

    /// The first state of an episode.
    fn reset(&self, rng: &mut Generator<'_>) -> Self::State;

    /// The result of an action, which is less than `num_actions`.
    fn step(&self, state: &Self::State, action: usize, rng: &mut Generator<'_>) -> Step<Self::State>;

    /// Writes the observation of a state.
    fn observe(&self, state: &Self::State, observation: &mut [Self::Number]);

    /// Writes the available actions of a state, of which every state that is not terminal has at least one.
    fn action_mask(&self, _state: &Self::State, mask: &mut [bool]) {
        mask.fill(true);
    }
}

/// The result of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<S> {
    /// The next state.
    pub state: S,
    /// The reward, a finite number.
    pub reward: f64,
    /// Whether the next state is terminal.
    pub terminated: bool,
    /// Whether the episode is cut off for a reason other than the time limit, which the caller keeps.
    pub truncated: bool,
}

impl<S> Step<S> {
    /// A step of an episode that is not cut off.
    pub fn new(state: S, reward: f64, terminated: bool) -> Self {
        Self { state, reward, terminated, truncated: false }
    }
}

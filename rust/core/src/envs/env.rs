//! What an environment is: frozen parameters in `self`, the state by value, the draws passed in.

use std::sync::Arc;

use crate::random::Rng;

/// What one step brings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<S> {
    /// The state after the step.
    pub state: S,
    /// The reward of the step.
    pub reward: f64,
    /// Whether the state after the step is terminal (a time-out is not the environment's to say).
    pub terminated: bool,
}

/// An environment: physics without a clock, a renderer or a generator of its own.
pub trait Env {
    /// All that changes from step to step.
    type State: Copy;
    /// What `step` takes: an index for discrete actions.
    type Action: Copy;
    /// What the agent sees, in the dtype in which Gymnasium hands it out.
    type Observation;

    /// How many actions there are; 0 where they are continuous.
    fn num_actions(&self) -> usize;

    /// The first state of an episode.
    fn reset(&self, rng: &mut impl Rng) -> Self::State;

    /// The two numbers between which first states lie, under the names of Gymnasium's reset options.
    const RESET_BOUNDS: Option<[(&'static str, f64); 2]> = None;

    /// The first state of an episode between other numbers than `START`'s; where it has none, any first state.
    fn reset_within(&self, _start: [f64; 2], rng: &mut impl Rng) -> Self::State {
        self.reset(rng)
    }

    /// One step of the dynamics.
    ///
    /// # Panics
    /// It may, where the action is none of the environment's: whoever takes actions from outside checks them.
    fn step(&self, state: Self::State, action: Self::Action, rng: &mut impl Rng) -> Step<Self::State>;

    /// One step in each of several lanes: its state moves on, its reward and its end are put in their places. Those that
    /// are `idle` keep their states, whatever their actions are. It may be computed in another way where wide registers
    /// pay, never with other results than `step`'s.
    #[inline]
    fn step_batch(
        &self,
        states: &mut [Self::State],
        actions: &[Self::Action],
        rngs: &mut [impl Rng],
        rewards: &mut [f64],
        terminated: &mut [bool],
        inactive: &[bool],
    ) {
        let places = rewards.iter_mut().zip(terminated).zip(inactive);
        for (((state, &action), rng), ((reward, end), &inactive)) in
            states.iter_mut().zip(actions).zip(rngs).zip(places)
        {
            if !inactive {
                let step = self.step(*state, action, rng);
                (*state, *reward, *end) = (step.state, step.reward, step.terminated);
            }
        }
    }

    /// What the agent sees of a state.
    fn observe(&self, state: &Self::State) -> Self::Observation;
}

/// A shared environment: many runs in an environment with a large table need it only once.
impl<E: Env + ?Sized> Env for Arc<E> {
    type State = E::State;
    type Action = E::Action;
    type Observation = E::Observation;

    const RESET_BOUNDS: Option<[(&'static str, f64); 2]> = E::RESET_BOUNDS;

    #[inline]
    fn num_actions(&self) -> usize {
        (**self).num_actions()
    }

    #[inline]
    fn reset(&self, rng: &mut impl Rng) -> Self::State {
        (**self).reset(rng)
    }

    #[inline]
    fn reset_within(&self, bounds: [f64; 2], rng: &mut impl Rng) -> Self::State {
        (**self).reset_within(bounds, rng)
    }

    #[expect(clippy::inline_always, reason = "a call a step costs a fifth of it")]
    #[inline(always)]
    fn step(&self, state: Self::State, action: Self::Action, rng: &mut impl Rng) -> Step<Self::State> {
        (**self).step(state, action, rng)
    }

    #[inline]
    fn step_batch(
        &self,
        states: &mut [Self::State],
        actions: &[Self::Action],
        rngs: &mut [impl Rng],
        rewards: &mut [f64],
        terminated: &mut [bool],
        inactive: &[bool],
    ) {
        (**self).step_batch(states, actions, rngs, rewards, terminated, inactive);
    }

    #[inline]
    fn observe(&self, state: &Self::State) -> Self::Observation {
        (**self).observe(state)
    }
}

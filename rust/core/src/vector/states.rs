//! The storage of the states of the sub-environments, and their steps.

use super::StepBuffers;
use crate::StopFlag;
use crate::envs::Env;
use crate::memory::{AllocationError, filled};
use crate::random::Rng;

/// The states of several sub-environments, in the layout in which they are stepped.
pub trait States<E: Env>: Sized {
    /// `size` sub-environments in the same state.
    ///
    /// # Errors
    /// `OutOfMemory`.
    fn new(state: E::State, size: usize) -> Result<Self, AllocationError>;

    /// The state of a sub-environment.
    fn get(&self, index: usize) -> E::State;

    /// Replaces the state of a sub-environment.
    fn set(&mut self, index: usize, state: E::State);

    /// One step of each sub-environment, with the results of [`Env::step`], which do not include `truncated`. The `inactive` ones await a reset: their
    /// generators are not used, and their states and outputs are unspecified.
    ///
    /// # Panics
    /// May panic if an action is out of range.
    fn step(
        &mut self,
        env: &E,
        actions: &[E::Action],
        rngs: &mut [impl Rng],
        inactive: &[bool],
        buffers: &mut StepBuffers<'_, E::Observation>,
    );
}

/// States stored in a row and stepped one by one.
impl<E: Env> States<E> for Vec<E::State> {
    fn new(state: E::State, size: usize) -> Result<Self, AllocationError> {
        filled(&state, size, &StopFlag::new())
    }

    fn get(&self, index: usize) -> E::State {
        self[index]
    }

    fn set(&mut self, index: usize, state: E::State) {
        self[index] = state;
    }

    fn step(
        &mut self,
        env: &E,
        actions: &[E::Action],
        rngs: &mut [impl Rng],
        inactive: &[bool],
        buffers: &mut StepBuffers<'_, E::Observation>,
    ) {
        let inputs = self.iter_mut().zip(actions).zip(rngs.iter_mut().zip(inactive));
        let StepBuffers { observations, rewards, terminated, .. } = buffers;
        let outputs = observations.iter_mut().zip(rewards.iter_mut()).zip(terminated.iter_mut());
        for (((state, &action), (rng, &inactive)), ((observation, reward), terminated)) in inputs.zip(outputs) {
            if !inactive {
                let step = env.step(*state, action, rng);
                (*state, *reward, *terminated) = (step.state, step.reward, step.terminated);
                *observation = env.observe(state);
            }
        }
    }
}

//! The sub-environments that one thread steps.

use super::flags::{self, CHUNK, Flags};
use super::vector_env::VectorConfig;
use super::{Autoreset, States, StepBuffers};
use crate::StopFlag;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::envs::Env;
use crate::memory::{AllocationError, filled, with_capacity};
use crate::random::Rng;

/// The episodes of the sub-environments that one thread steps.
#[derive(Clone, Debug)]
pub(super) struct Shard<E: Env, S> {
    states: S,
    /// The number of steps taken.
    steps: u64,
    /// The value of `steps` when each episode began. Differences wrap around: a restored episode can have begun before
    /// the first step.
    begun: Vec<u64>,
    /// For each chunk, a lower bound on the `begun` of its episodes: no episode reaches the time limit before this
    /// bound does.
    earliest: Vec<u64>,
    /// Whether each episode has ended and has not been reset yet.
    pub(super) done: Vec<bool>,
    /// With `Autoreset::SameStep`, the index and the last state of each episode that ended in the last step. It has
    /// capacity for all sub-environments, so that a step allocates nothing.
    pub(super) final_states: Vec<(usize, E::State)>,
}

impl<E: Env, S: States<E>> Shard<E, S> {
    /// `size` sub-environments that await their first reset. `placeholder` fills the states until then.
    pub(super) fn new(placeholder: E::State, size: usize) -> Result<Self, AllocationError> {
        let stop = StopFlag::new();
        Ok(Self {
            states: S::new(placeholder, size)?,
            steps: 0,
            begun: filled(&0, size, &stop)?,
            earliest: filled(&0, size.div_ceil(CHUNK), &stop)?,
            done: filled(&false, size, &stop)?,
            final_states: with_capacity(size)?,
        })
    }

    pub(super) fn states(&self) -> impl Iterator<Item = E::State> + Clone {
        (0..self.done.len()).map(|index| self.state(index))
    }

    pub(super) fn state(&self, index: usize) -> E::State {
        self.states.get(index)
    }

    pub(super) fn elapsed(&self, index: usize) -> u64 {
        self.steps.wrapping_sub(self.begun[index])
    }

    /// Saves or restores the episodes. The flags of episodes that ended in the last step are not included.
    pub(super) fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        if checkpoint.is_restoring() {
            self.final_states.clear();
        }
        for index in 0..self.done.len() {
            let (mut state, mut elapsed) = (self.state(index), self.elapsed(index));
            (&mut state, &mut elapsed, &mut self.done[index]).persist(checkpoint)?;
            self.states.set(index, state);
            self.begun[index] = self.steps.wrapping_sub(elapsed);
        }
        (0..self.earliest.len()).for_each(|chunk| self.find_earliest(chunk));
        Ok(())
    }

    /// Begins an episode in this state.
    pub(super) fn begin(&mut self, index: usize, state: E::State) {
        self.states.set(index, state);
        self.begun[index] = self.steps;
        self.done[index] = false;
    }

    fn find_earliest(&mut self, chunk: usize) {
        let steps = self.steps;
        let begun = self.begun.chunks(CHUNK).nth(chunk).into_iter().flatten();
        let longest = begun.map(|&begun| steps.wrapping_sub(begun)).max();
        self.earliest[chunk] = steps.wrapping_sub(longest.unwrap_or(0));
    }

    /// One step of all sub-environments.
    pub(super) fn step(
        &mut self,
        env: &E,
        config: VectorConfig,
        actions: &[E::Action],
        rngs: &mut [impl Rng],
        mut buffers: StepBuffers<'_, E::Observation>,
    ) {
        self.final_states.clear();
        let resets_done = config.autoreset == Autoreset::NextStep;
        assert!(resets_done || !self.done.contains(&true), "a finished episode must be reset before the next step");
        self.states.step(env, actions, rngs, &self.done, &mut buffers);
        let StepBuffers { observations, rewards, terminated, truncated } = buffers;
        self.steps = self.steps.wrapping_add(1);
        for chunk in 0..self.earliest.len() {
            let range = chunk * CHUNK..self.done.len().min((chunk + 1) * CHUNK);
            let (terminated, truncated) = (&mut terminated[range.clone()], &mut truncated[range.clone()]);
            let was_done = flags::read(&self.done[range.clone()]);
            // An episode that had ended before this step cannot end in it.
            let terminations = flags::read(terminated) & !was_done;
            let truncations = self.find_truncations(chunk, config.max_episode_steps) & !was_done;
            let ended = terminations | truncations;
            flags::write(truncations, truncated);
            if (was_done | ended) == 0 {
                continue;
            }
            flags::write(terminations, terminated);
            let resets = match config.autoreset {
                Autoreset::NextStep => was_done,
                Autoreset::SameStep => ended,
                Autoreset::Disabled => 0,
            };
            flags::write(ended, &mut self.done[range.clone()]);
            for index in flags::lanes(resets).map(|lane| range.start + lane) {
                if resets_done {
                    rewards[index] = 0.0;
                } else {
                    self.final_states.push((index, self.state(index)));
                }
                let state = env.reset(&mut rngs[index]);
                observations[index] = env.observe(&state);
                self.begin(index, state);
            }
        }
    }

    /// The episodes of the chunk that have reached the time limit.
    #[inline]
    fn find_truncations(&mut self, chunk: usize, limit: u64) -> Flags {
        if self.steps.wrapping_sub(self.earliest[chunk]) < limit {
            return 0;
        }
        self.find_earliest(chunk);
        let begun = self.begun.chunks(CHUNK).nth(chunk).unwrap_or_default();
        let mut truncated = [false; CHUNK];
        for (truncated, begun) in truncated.iter_mut().zip(begun) {
            *truncated = self.steps.wrapping_sub(*begun) >= limit;
        }
        flags::read(&truncated)
    }
}

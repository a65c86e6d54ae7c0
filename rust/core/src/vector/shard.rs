//! The sub-environments that one thread steps.

use std::ops::Range;

use super::vector_config::VectorConfig;
use super::{Autoreset, StepBuffers};
use crate::StopFlag;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::envs::Env;
use crate::memory::{AllocationError, filled, with_capacity};
use crate::random::Rng;

/// So many sub-environments are looked through together for episodes that end.
const CHUNK: usize = 16;

/// The episodes of the sub-environments that one thread steps, as a structure of arrays.
#[derive(Clone, Debug)]
pub(super) struct Shard<S> {
    states: Vec<S>,
    /// The number of steps since the last reset.
    elapsed: Vec<u64>,
    /// Whether the episode has ended without a reset since.
    done: Vec<bool>,
    /// With `Autoreset::SameStep`, the index and the last state of each episode that ended in the last step. It has
    /// capacity for all sub-environments, so that a step allocates nothing.
    final_states: Vec<(usize, S)>,
}

impl<S: Copy> Shard<S> {
    /// `size` sub-environments that await their first reset. `placeholder` fills the states until then.
    pub(super) fn new(placeholder: S, size: usize) -> Result<Self, AllocationError> {
        let stop = StopFlag::new();
        Ok(Self {
            states: filled(&placeholder, size, &stop)?,
            elapsed: filled(&0, size, &stop)?,
            done: filled(&false, size, &stop)?,
            final_states: with_capacity(size)?,
        })
    }

    pub(super) fn states(&self) -> impl Iterator<Item = &S> + Clone {
        self.states.iter()
    }

    pub(super) fn state(&self, index: usize) -> &S {
        &self.states[index]
    }

    pub(super) fn elapsed(&self, index: usize) -> u64 {
        self.elapsed[index]
    }

    pub(super) fn is_done(&self, index: usize) -> bool {
        self.done[index]
    }

    pub(super) fn done(&self) -> impl Iterator<Item = bool> {
        self.done.iter().copied()
    }

    pub(super) fn final_states(&self) -> &[(usize, S)] {
        &self.final_states
    }

    /// Saves or restores the episodes. Which of them ended in the last step is not part of it.
    pub(super) fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError>
    where
        S: Persist,
    {
        if checkpoint.is_restoring() {
            self.final_states.clear();
        }
        for ((state, elapsed), done) in self.states.iter_mut().zip(&mut self.elapsed).zip(&mut self.done) {
            (state, elapsed, done).persist(checkpoint)?;
        }
        Ok(())
    }

    /// Begins an episode in this state.
    pub(super) fn begin(&mut self, index: usize, state: S) {
        self.states[index] = state;
        self.elapsed[index] = 0;
        self.done[index] = false;
    }

    /// One step of all sub-environments.
    pub(super) fn step<E: Env<State = S>>(
        &mut self,
        env: &E,
        config: VectorConfig,
        actions: &[E::Action],
        rngs: &mut [impl Rng],
        buffers: StepBuffers<'_, E::Observation>,
    ) {
        let StepBuffers { observations, rewards, terminated, truncated } = buffers;
        self.final_states.clear();
        let resets_done = config.autoreset == Autoreset::NextStep;
        assert!(resets_done || !self.done.contains(&true), "a finished episode must be reset before the next step");
        env.step_batch(&mut self.states, actions, rngs, rewards, terminated, &self.done);
        for first in (0..rngs.len()).step_by(CHUNK) {
            let chunk = first..rngs.len().min(first + CHUNK);
            if !self.count_steps(chunk.clone(), config.max_episode_steps, terminated, truncated) {
                continue;
            }
            for index in chunk {
                if self.done[index] {
                    self.begin(index, env.reset(&mut rngs[index]));
                    (rewards[index], terminated[index], truncated[index]) = (0.0, false, false);
                    continue;
                }
                self.done[index] = terminated[index] || truncated[index];
                if self.done[index] && config.autoreset == Autoreset::SameStep {
                    self.final_states.push((index, self.states[index]));
                    self.begin(index, env.reset(&mut rngs[index]));
                }
            }
        }
        for (observation, state) in observations.iter_mut().zip(&self.states) {
            *observation = env.observe(state);
        }
    }

    /// Counts a step of these sub-environments and finds those at the time limit. Returns whether an episode ends or has
    /// ended. Most chunks have none, and are done after this loop, which has no branch.
    fn count_steps(&mut self, chunk: Range<usize>, limit: u64, terminated: &[bool], truncated: &mut [bool]) -> bool {
        let flags = truncated[chunk.clone()].iter_mut().zip(&terminated[chunk.clone()]).zip(&self.done[chunk.clone()]);
        let mut any = false;
        for (elapsed, ((truncated, terminated), done)) in self.elapsed[chunk].iter_mut().zip(flags) {
            *elapsed += 1;
            *truncated = *elapsed >= limit;
            any |= *truncated | terminated | done;
        }
        any
    }
}

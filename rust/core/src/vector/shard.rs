//! The sub-environments that one thread steps.

use super::Autoreset;
use super::StepBuffers;
use super::vector_config::VectorConfig;
use crate::envs::Env;
use crate::random::Rng;

/// Where their episodes stand, field by field.
#[derive(Clone, Debug)]
pub(super) struct Shard<S> {
    states: Vec<S>,
    elapsed: Vec<u64>,
    done: Vec<bool>,
    /// The states in which episodes ended in the last step, where they were reset at once; there is room for all.
    final_states: Vec<(usize, S)>,
}

impl<S: Copy> Shard<S> {
    pub(super) fn new(state: S, size: usize) -> Self {
        Self {
            states: vec![state; size],
            elapsed: vec![0; size],
            done: vec![false; size],
            final_states: Vec::with_capacity(size),
        }
    }

    pub(super) fn states(&self) -> impl Iterator<Item = &S> + Clone {
        self.states.iter()
    }

    pub(super) fn state(&self, lane: usize) -> &S {
        &self.states[lane]
    }

    pub(super) fn elapsed(&self, lane: usize) -> u64 {
        self.elapsed[lane]
    }

    pub(super) fn is_done(&self, lane: usize) -> bool {
        self.done[lane]
    }

    pub(super) fn done(&self) -> impl Iterator<Item = bool> {
        self.done.iter().copied()
    }

    pub(super) fn final_states(&self) -> &[(usize, S)] {
        &self.final_states
    }

    pub(super) fn begin(&mut self, lane: usize, state: S) {
        self.states[lane] = state;
        self.elapsed[lane] = 0;
        self.done[lane] = false;
    }

    pub(super) fn step<E: Env<State = S>>(
        &mut self,
        env: &E,
        config: VectorConfig,
        actions: &[E::Action],
        rngs: &mut [impl Rng],
        batch: StepBuffers<'_, E::Observation>,
    ) {
        let StepBuffers { observations, rewards, terminated, truncated } = batch;
        self.final_states.clear();
        let waits = config.autoreset == Autoreset::NextStep;
        assert!(waits || !self.done.contains(&true), "an episode that is over cannot go on");
        env.step_batch(&mut self.states, actions, rngs, rewards, terminated, &self.done);
        for (lane, rng) in rngs.iter_mut().enumerate() {
            if self.done[lane] {
                self.begin(lane, env.reset(rng));
                (rewards[lane], terminated[lane], truncated[lane]) = (0.0, false, false);
                continue;
            }
            self.elapsed[lane] += 1;
            truncated[lane] = self.elapsed[lane] >= config.max_episode_steps;
            self.done[lane] = terminated[lane] || truncated[lane];
            if self.done[lane] && config.autoreset == Autoreset::SameStep {
                self.final_states.push((lane, self.states[lane]));
                self.begin(lane, env.reset(rng));
            }
        }
        for (observation, state) in observations.iter_mut().zip(&self.states) {
            *observation = env.observe(state);
        }
    }
}

//! The sub-environments that one thread steps.

use super::{Autoreset, Batch, Rules};
use crate::env::Env;
use crate::random::Draw;

/// Where their episodes stand, field by field.
#[derive(Clone, Debug)]
pub(super) struct Block<S> {
    states: Vec<S>,
    elapsed: Vec<u64>,
    over: Vec<bool>,
    /// The states in which episodes ended in the last step, where they were reset at once; there is room for all.
    finals: Vec<(usize, S)>,
}

impl<S: Copy> Block<S> {
    pub(super) fn new(state: S, size: usize) -> Self {
        Self {
            states: vec![state; size],
            elapsed: vec![0; size],
            over: vec![false; size],
            finals: Vec::with_capacity(size),
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

    pub(super) fn is_over(&self, lane: usize) -> bool {
        self.over[lane]
    }

    pub(super) fn over(&self) -> impl Iterator<Item = bool> {
        self.over.iter().copied()
    }

    pub(super) fn finals(&self) -> &[(usize, S)] {
        &self.finals
    }

    pub(super) fn begin(&mut self, lane: usize, state: S) {
        self.states[lane] = state;
        self.elapsed[lane] = 0;
        self.over[lane] = false;
    }

    pub(super) fn step<E: Env<State = S>>(
        &mut self,
        env: &E,
        rules: Rules,
        actions: &[E::Action],
        draws: &mut [impl Draw],
        batch: Batch<'_, E::Observation>,
    ) {
        let Batch { observations, rewards, terminated, truncated } = batch;
        self.finals.clear();
        let waits = rules.autoreset == Autoreset::NextStep;
        assert!(waits || !self.over.contains(&true), "an episode that is over cannot go on");
        env.step_lanes(&mut self.states, actions, draws, rewards, terminated, &self.over);
        for (lane, draw) in draws.iter_mut().enumerate() {
            if self.over[lane] {
                self.begin(lane, env.reset(draw));
                (rewards[lane], terminated[lane], truncated[lane]) = (0.0, false, false);
                continue;
            }
            self.elapsed[lane] += 1;
            truncated[lane] = self.elapsed[lane] >= rules.limit;
            self.over[lane] = terminated[lane] || truncated[lane];
            if self.over[lane] && rules.autoreset == Autoreset::SameStep {
                self.finals.push((lane, self.states[lane]));
                self.begin(lane, env.reset(draw));
            }
        }
        for (observation, state) in observations.iter_mut().zip(&self.states) {
            *observation = env.observe(state);
        }
    }
}

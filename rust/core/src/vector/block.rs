//! The sub-environments that one thread steps.

use std::ops::Range;

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
        let mut lane = 0;
        while lane < self.states.len() {
            if self.over[lane] && rules.autoreset == Autoreset::NextStep {
                self.begin(lane, env.reset(&mut draws[lane]));
                (rewards[lane], terminated[lane], truncated[lane]) = (0.0, false, false);
                lane += 1;
                continue;
            }
            // All those before the next that is over, side by side.
            let waiting = self.over[lane + 1..].iter().position(|&over| over && rules.autoreset == Autoreset::NextStep);
            let end = waiting.map_or(self.states.len(), |waiting| lane + 1 + waiting);
            let side = lane..end;
            env.step_lanes(
                &mut self.states[side.clone()],
                &actions[side.clone()],
                &mut draws[side.clone()],
                &mut rewards[side.clone()],
                &mut terminated[side.clone()],
            );
            let any = self.tick(side.clone(), rules.limit, &terminated[side.clone()], &mut truncated[side.clone()]);
            if any && rules.autoreset == Autoreset::SameStep {
                for lane in side {
                    if self.over[lane] {
                        self.finals.push((lane, self.states[lane]));
                        self.begin(lane, env.reset(&mut draws[lane]));
                    }
                }
            }
            lane = end;
        }
        for (observation, state) in observations.iter_mut().zip(&self.states) {
            *observation = env.observe(state);
        }
    }

    /// Moves clocks on; whether any episode is over.
    fn tick(&mut self, side: Range<usize>, limit: u64, terminated: &[bool], truncated: &mut [bool]) -> bool {
        let mut any = false;
        let clocks = self.elapsed[side.clone()].iter_mut().zip(&mut self.over[side]);
        for ((elapsed, over), (&terminated, truncated)) in clocks.zip(terminated.iter().zip(truncated)) {
            *elapsed += 1;
            *truncated = *elapsed >= limit;
            *over = terminated || *truncated;
            any |= *over;
        }
        any
    }
}

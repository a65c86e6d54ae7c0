//! The unfinished episodes of a batch, field by field.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use super::SimdTrainer;
use crate::envs::{Env, SimdEnv, gather, scatter};
use crate::features::{BatchFeatures, OutOfBounds};
use crate::numeric::{argmax, argmax_without_branch, select};
use crate::random::{Pcg64Lanes, explore_from};
use crate::schedules::StepSize;
use crate::tasks::{Task, TimedState};
use crate::trainer::EpisodeState;

/// One episode per lane, as a structure of arrays.
pub(super) struct EpisodeLanes<const N: usize, const M: usize, const K: usize> {
    /// Whether the lane holds an episode.
    pub(super) active: [bool; K],
    /// The components of the states.
    pub(super) fields: [[f64; K]; M],
    pub(super) elapsed: [u64; K],
    /// The row of the current state.
    pub(super) row: [usize; K],
    /// The values of that row, action by action.
    pub(super) values: [[f64; K]; N],
    pub(super) action: [usize; K],
    /// Whether `action` is the action to take next, rather than the one taken last.
    pub(super) actions_chosen: bool,
    pub(super) episode_return: [f64; K],
    /// What [`explore_from`] returns for `1 - epsilon`.
    pub(super) explore_from: [u64; K],
}

type Episode<S> = EpisodeState<TimedState<S>, [u32; 1]>;

impl<const N: usize, const M: usize, const K: usize> EpisodeLanes<N, M, K> {
    /// Takes over the unfinished episode of each run, or begins one.
    pub(super) fn begin<E, F, A>(runs: &mut [SimdTrainer<E, F, N, A>; K]) -> Result<Self, (usize, OutOfBounds)>
    where
        E: SimdEnv<M> + Env<Observation = [f32; M]>,
        F: BatchFeatures<M>,
        A: StepSize,
    {
        for (lane, run) in runs.iter_mut().enumerate() {
            if run.episode.is_none() {
                let mut rng = run.rng.clone();
                run.episode = Some(run.begin_episode(&mut rng).map_err(|error| (lane, error))?);
                run.rng = rng;
            }
        }
        let mut lanes = Self {
            active: [false; K],
            fields: [[0.0; K]; M],
            elapsed: [0; K],
            row: [0; K],
            values: [[0.0; K]; N],
            action: [0; K],
            actions_chosen: true,
            episode_return: [0.0; K],
            explore_from: [0; K],
        };
        for (lane, run) in runs.iter_mut().enumerate() {
            if let Some(EpisodeState { state, active, action, episode_return, .. }) = run.episode.take() {
                lanes.set(lane, state, active, run, run.learner.agent.table.values());
                (lanes.action[lane], lanes.episode_return[lane]) = (action, episode_return);
            }
        }
        Ok(lanes)
    }

    /// Begins an episode in a lane, whose first action is to be chosen.
    pub(super) fn reset<E, F, A>(
        &mut self,
        lane: usize,
        run: &mut SimdTrainer<E, F, N, A>,
        table: &[f64],
    ) -> Result<(), OutOfBounds>
    where
        E: SimdEnv<M> + Env<Observation = [f32; M]>,
        F: BatchFeatures<M>,
    {
        let (state, active) = run.task.reset()?;
        self.set(lane, state, active, run, table);
        self.episode_return[lane] = 0.0;
        Ok(())
    }

    fn set<E, F, A>(
        &mut self,
        lane: usize,
        TimedState { state, elapsed }: TimedState<E::State>,
        [row]: [u32; 1],
        run: &SimdTrainer<E, F, N, A>,
        table: &[f64],
    ) where
        E: SimdEnv<M>,
        F: BatchFeatures<M>,
    {
        self.active[lane] = true;
        scatter(&mut self.fields, lane, state);
        self.elapsed[lane] = elapsed;
        self.row[lane] = row as usize;
        for (values, value) in self.values.iter_mut().zip(table.as_chunks::<N>().0[row as usize]) {
            values[lane] = value;
        }
        self.explore_from[lane] = explore_from(1.0 - run.learner.agent.policy.epsilon());
    }

    /// Chooses the next action of every lane.
    #[inline(always)]
    pub(super) fn choose(&mut self, rngs: &mut Pcg64Lanes<K>) {
        let decisions = rngs.explore(&self.explore_from, N as u32);
        for lane in 0..K {
            let greedy = argmax_without_branch(self.values.each_ref().map(|values| values[lane]));
            self.action[lane] = select(decisions.explores[lane], decisions.random[lane] as u64, greedy as u64) as usize;
        }
        self.actions_chosen = true;
    }

    /// Chooses the next actions of the active lanes, unless they are chosen.
    pub(super) fn choose_if_missing(&mut self, rngs: &mut Pcg64Lanes<K>) {
        if self.actions_chosen {
            return;
        }
        for lane in (0..K).filter(|&lane| self.active[lane]) {
            let random = rngs.explore_one(lane, self.explore_from[lane], N as u32);
            self.action[lane] = random.unwrap_or_else(|| argmax(&self.values.map(|values| values[lane])));
        }
        self.actions_chosen = true;
    }

    /// The episode of a lane.
    pub(super) fn get<S: From<[f64; M]>>(&self, lane: usize) -> Option<Episode<S>> {
        self.active[lane].then(|| EpisodeState {
            state: TimedState { state: gather(&self.fields, lane), elapsed: self.elapsed[lane] },
            active: [self.row[lane] as u32],
            action: self.action[lane],
            episode_return: self.episode_return[lane],
            length: self.elapsed[lane].cast_signed(),
            unfinished: None,
        })
    }
}

//! The unfinished episodes of a batch, field by field.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use super::SimdTrainer;
use crate::envs::{Env, SimdEnv, gather, scatter};
use crate::features::{BatchFeatures, LaneRows, OutOfBounds};
use crate::learners::{Agent, UpdateRule};
use crate::numeric::{argmax, argmax_without_branch, cold_path, select};
use crate::policies::EpsilonGreedy;
use crate::q_table::sum_rows;
use crate::random::{Pcg64Lanes, explore_from};
use crate::schedules::StepSize;
use crate::tasks::{Task, TimedState};
use crate::trainer::EpisodeState;

/// One episode per lane, as a structure of arrays.
pub(super) struct EpisodeLanes<R, const N: usize, const M: usize, const K: usize> {
    /// Whether the lane holds an episode.
    pub(super) active: [bool; K],
    /// The components of the states.
    pub(super) fields: [[f64; K]; M],
    pub(super) elapsed: [u64; K],
    /// The active rows of the current states.
    pub(super) rows: [R; K],
    /// Their values, action by action.
    pub(super) values: [[f64; K]; N],
    pub(super) action: [usize; K],
    /// Whether `action` is the action to take next, rather than the one taken last.
    pub(super) actions_chosen: bool,
    pub(super) episode_return: [f64; K],
    /// What [`explore_from`] returns for `1 - epsilon`.
    pub(super) explore_from: [u64; K],
    /// 0, or NaN after an error that was infinite or NaN.
    pub(super) divergence: [f64; K],
}

impl<R: LaneRows, const N: usize, const M: usize, const K: usize> EpisodeLanes<R, N, M, K> {
    /// Takes over the unfinished episode of each run, or begins one.
    pub(super) fn begin<E, F, A, U>(runs: &mut [SimdTrainer<E, F, N, A, U>; K]) -> Result<Self, (usize, OutOfBounds)>
    where
        E: SimdEnv<M> + Env<Observation = [f32; M]>,
        F: BatchFeatures<M, ActiveInLane = R, Active = R::Active>,
        A: StepSize,
        U: UpdateRule<R::Active, Agent<N, EpsilonGreedy, A>>,
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
            rows: [R::default(); K],
            values: [[0.0; K]; N],
            action: [0; K],
            actions_chosen: true,
            episode_return: [0.0; K],
            explore_from: [0; K],
            divergence: [0.0; K],
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
    pub(super) fn reset<E, F, A, U>(
        &mut self,
        lane: usize,
        run: &mut SimdTrainer<E, F, N, A, U>,
        table: &[f64],
    ) -> Result<(), OutOfBounds>
    where
        E: SimdEnv<M> + Env<Observation = [f32; M]>,
        F: BatchFeatures<M, ActiveInLane = R, Active = R::Active>,
    {
        let (state, active) = run.task.reset()?;
        self.set(lane, state, active, run, table);
        self.episode_return[lane] = 0.0;
        Ok(())
    }

    fn set<E, F, A, U>(
        &mut self,
        lane: usize,
        TimedState { state, elapsed }: TimedState<E::State>,
        active: R::Active,
        run: &SimdTrainer<E, F, N, A, U>,
        table: &[f64],
    ) where
        E: SimdEnv<M>,
        F: BatchFeatures<M, ActiveInLane = R, Active = R::Active>,
    {
        self.active[lane] = true;
        scatter(&mut self.fields, lane, state);
        self.elapsed[lane] = elapsed;
        self.rows[lane] = R::new(active);
        let values = sum_rows(self.rows[lane].indices().map(|row| table.as_chunks::<N>().0[row]));
        for (lanes, value) in self.values.iter_mut().zip(values) {
            lanes[lane] = value;
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

    /// Chooses the next action of every lane whose state is not terminal. The others draw nothing.
    #[inline(always)]
    pub(super) fn choose_unless(&mut self, terminal: &[bool; K], rngs: &mut Pcg64Lanes<K>) {
        let any_terminal = *terminal != [false; K];
        let before = any_terminal.then(|| rngs.clone());
        self.choose(rngs);
        if let Some(before) = before {
            cold_path();
            for lane in (0..K).filter(|&lane| terminal[lane]) {
                rngs.set(lane, &before.get(lane));
            }
        }
    }

    /// Chooses the next action of a lane.
    pub(super) fn choose_one(&mut self, lane: usize, rngs: &mut Pcg64Lanes<K>) {
        let random = rngs.explore_one(lane, self.explore_from[lane], N as u32);
        self.action[lane] = random.unwrap_or_else(|| argmax(&self.values.map(|values| values[lane])));
    }

    /// Chooses the next actions of the active lanes, unless they are chosen.
    pub(super) fn choose_if_missing(&mut self, rngs: &mut Pcg64Lanes<K>) {
        if self.actions_chosen {
            return;
        }
        let active = self.active;
        for lane in (0..K).filter(|&lane| active[lane]) {
            self.choose_one(lane, rngs);
        }
        self.actions_chosen = true;
    }

    /// The episode of a lane.
    pub(super) fn get<S: From<[f64; M]>>(&self, lane: usize) -> Option<EpisodeState<TimedState<S>, R::Active>> {
        self.active[lane].then(|| EpisodeState {
            state: TimedState { state: gather(&self.fields, lane), elapsed: self.elapsed[lane] },
            active: self.rows[lane].active(),
            action: self.action[lane],
            episode_return: self.episode_return[lane],
            length: self.elapsed[lane].cast_signed(),
            unfinished: None,
        })
    }
}

//! The unfinished episodes of a batch, field by field.

use super::SimdTrainer;
use super::lane_values::argmax_in_lanes;
use super::row_buffers::RowBuffers;
use crate::envs::{Env, SimdEnv};
use crate::features::{BatchFeatures, LaneRows, OutOfBounds};
use crate::learners::{Agent, UpdateRule};
use crate::numeric::{argmax, cold_path};
use crate::policies::EpsilonGreedy;
use crate::q_table::sum_rows;
use crate::random::{Pcg64Lanes, explore_from};
use crate::schedules::StepSize;
use crate::simd::{F64s, Mask, Simd, U64s, map};
use crate::tasks::{Task, TimedState};
use crate::trainer::EpisodeState;

/// One episode per lane, as a structure of arrays.
pub(super) struct EpisodeLanes<S: Simd, R, const N: usize, const M: usize, const K: usize> {
    pub(super) simd: S,
    /// Whether the lane holds an episode.
    pub(super) active: [bool; K],
    /// The components of the states.
    pub(super) fields: [F64s<S, K>; M],
    pub(super) elapsed: [u64; K],
    pub(super) rows: RowBuffers<R, K>,
    /// The values of the current rows, action by action.
    pub(super) values: [[f64; K]; N],
    pub(super) action: U64s<S, K>,
    /// Whether `action` is the action to take next, rather than the one taken last.
    pub(super) actions_chosen: bool,
    pub(super) episode_return: F64s<S, K>,
    /// The result of [`explore_from`] for `1 - epsilon`.
    pub(super) explore_from: U64s<S, K>,
    /// 0, or NaN after an error that was infinite or NaN.
    pub(super) divergence: F64s<S, K>,
}

impl<S: Simd, R: LaneRows, const N: usize, const M: usize, const K: usize> EpisodeLanes<S, R, N, M, K> {
    /// Takes over the unfinished episode of each run, or begins one.
    pub(super) fn begin<E, F, A, U>(
        simd: S,
        runs: &mut [SimdTrainer<E, F, N, A, U>; K],
    ) -> Result<Self, (usize, OutOfBounds)>
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
        let (zero, zero_u64) = (F64s::splat(simd, 0.0), U64s::splat(simd, 0));
        let mut lanes = Self {
            simd,
            active: [false; K],
            fields: [zero; M],
            elapsed: [0; K],
            rows: RowBuffers::new(),
            values: [[0.0; K]; N],
            action: zero_u64,
            actions_chosen: true,
            episode_return: zero,
            explore_from: zero_u64,
            divergence: zero,
        };
        for (lane, run) in runs.iter_mut().enumerate() {
            if let Some(EpisodeState { state, active, action, episode_return, .. }) = run.episode.take() {
                lanes.set(lane, state, active, run, run.learner.agent.table.values());
                lanes.action.set(lane, action as u64);
                lanes.episode_return.set(lane, episode_return);
            }
        }
        Ok(lanes)
    }

    /// Begins an episode in a lane. Its first action is not chosen yet.
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
        self.episode_return.set(lane, 0.0);
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
        for (field, number) in self.fields.iter_mut().zip(state.into()) {
            field.set(lane, number);
        }
        self.elapsed[lane] = elapsed;
        let rows = R::new(active);
        self.rows.current_mut()[lane] = rows;
        let values = sum_rows(rows.indices().map(|row| table.as_chunks::<N>().0[row]));
        for (lanes, value) in self.values.iter_mut().zip(values) {
            lanes[lane] = value;
        }
        self.explore_from.set(lane, explore_from(1.0 - run.learner.agent.policy.epsilon()));
    }

    /// The values of the active rows, action by action.
    #[inline(always)]
    pub(super) fn values(&self) -> [F64s<S, K>; N] {
        map(self.values, |values| F64s::new(self.simd, values))
    }

    /// Chooses the next action of every lane.
    #[inline(always)]
    pub(super) fn choose(&mut self, rngs: &mut Pcg64Lanes<S, K>) {
        let decisions = rngs.explore(self.simd, self.explore_from, N as u32);
        self.action = decisions.explores.select(decisions.random, argmax_in_lanes(self.simd, &self.values()));
        self.actions_chosen = true;
    }

    /// Chooses the next action of every lane whose state is not terminal. The others draw nothing.
    #[inline(always)]
    pub(super) fn choose_unless(&mut self, terminal: Mask<S, K>, rngs: &mut Pcg64Lanes<S, K>) {
        let before = terminal.any().then(|| rngs.clone());
        self.choose(rngs);
        if let Some(before) = before {
            cold_path();
            let terminal = terminal.to_array();
            for lane in (0..K).filter(|&lane| terminal[lane]) {
                rngs.set(lane, &before.get(lane));
            }
        }
    }

    /// Chooses the next action of a lane.
    pub(super) fn choose_one(&mut self, lane: usize, rngs: &mut Pcg64Lanes<S, K>) {
        let random = rngs.explore_one(lane, self.explore_from.to_array()[lane], N as u32);
        let action = random.unwrap_or_else(|| argmax(&self.values.map(|values| values[lane])));
        self.action.set(lane, action as u64);
    }

    /// Chooses the next actions of the active lanes, unless they are already chosen.
    pub(super) fn choose_if_missing(&mut self, rngs: &mut Pcg64Lanes<S, K>) {
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
    pub(super) fn get<T: From<[f64; M]>>(&self, lane: usize) -> Option<EpisodeState<TimedState<T>, R::Active>> {
        let state = self.fields.map(|field| field.to_array()[lane]).into();
        self.active[lane].then(|| EpisodeState {
            state: TimedState { state, elapsed: self.elapsed[lane] },
            active: self.rows.current()[lane].active(),
            action: self.action.to_array()[lane] as usize,
            episode_return: self.episode_return.to_array()[lane],
            length: self.elapsed[lane].cast_signed(),
            unfinished: None,
        })
    }
}

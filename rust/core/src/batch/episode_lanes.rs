//! The unfinished episodes of a batch, field by field.

use super::SimdTrainer;
use crate::envs::{Env, SimdEnv, gather, scatter};
use crate::features::{BatchFeatures, OutOfBounds};
use crate::random::PrefetchedPcg64;
use crate::schedules::StepSize;
use crate::tasks::TimedState;
use crate::trainer::EpisodeState;

/// One episode per lane, as a structure of arrays.
pub(super) struct EpisodeLanes<const M: usize, const K: usize> {
    /// Whether the lane holds an episode.
    pub(super) active: [bool; K],
    /// The components of the states.
    pub(super) fields: [[f64; K]; M],
    pub(super) elapsed: [u64; K],
    /// The row of the current state.
    pub(super) row: [usize; K],
    pub(super) action: [usize; K],
    pub(super) episode_return: [f64; K],
    /// What [`PrefetchedPcg64::explore_from`] returns for `1 - epsilon`.
    pub(super) explore_from: [u64; K],
}

type Episode<S> = EpisodeState<TimedState<S>, [u32; 1]>;

impl<const M: usize, const K: usize> EpisodeLanes<M, K> {
    /// Takes over the unfinished episode of each run, or begins one.
    pub(super) fn begin<E, F, A, const N: usize>(
        runs: &mut [SimdTrainer<E, F, N, A>; K],
        rngs: &mut [PrefetchedPcg64; K],
    ) -> Result<Self, (usize, OutOfBounds)>
    where
        E: SimdEnv<M> + Env<Observation = [f32; M]>,
        F: BatchFeatures<M>,
        A: StepSize,
    {
        for (lane, (run, rng)) in runs.iter_mut().zip(rngs).enumerate() {
            if run.episode.is_none() {
                run.episode = Some(run.begin_episode(rng).map_err(|error| (lane, error))?);
            }
        }
        let mut lanes = Self {
            active: [false; K],
            fields: [[0.0; K]; M],
            elapsed: [0; K],
            row: [0; K],
            action: [0; K],
            episode_return: [0.0; K],
            explore_from: [0; K],
        };
        for (lane, run) in runs.iter_mut().enumerate() {
            if let Some(episode) = run.episode.take() {
                lanes.set(lane, &episode, run);
            }
        }
        Ok(lanes)
    }

    /// Puts an episode into a lane.
    pub(super) fn set<E, F, A, const N: usize>(
        &mut self,
        lane: usize,
        episode: &Episode<E::State>,
        run: &SimdTrainer<E, F, N, A>,
    ) where
        E: SimdEnv<M>,
        F: BatchFeatures<M>,
    {
        self.active[lane] = true;
        scatter(&mut self.fields, lane, episode.state.state);
        self.elapsed[lane] = episode.state.elapsed;
        self.row[lane] = episode.active[0] as usize;
        self.action[lane] = episode.action;
        self.episode_return[lane] = episode.episode_return;
        self.explore_from[lane] = PrefetchedPcg64::explore_from(1.0 - run.learner.agent.policy.epsilon());
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

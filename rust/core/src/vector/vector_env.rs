//! A vector environment.

use std::fmt;
use std::sync::{Mutex, PoisonError};
use std::thread;

use super::shard::Shard;
use super::{States, StepBuffers};
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::envs::Env;
use crate::memory::AllocationError;
use crate::random::{NoRng, Rng};

/// The reset of a sub-environment after its episode ends: Gymnasium's `AutoresetMode`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Autoreset {
    /// The next step resets the sub-environment and ignores its action.
    NextStep,
    /// The same step resets the sub-environment. Its last state is in [`VectorEnv::final_states`].
    SameStep,
    /// The caller must reset the sub-environment before the next step.
    Disabled,
}

/// The settings that all sub-environments share.
#[derive(Clone, Copy, Debug)]
pub(super) struct VectorConfig {
    pub(super) max_episode_steps: u64,
    pub(super) autoreset: Autoreset,
}

/// Several sub-environments of one kind that step together, each with a random generator and a step count. The results
/// equal those of the same environments stepped one by one. `S` stores the states: `LaneStates` steps them in SIMD
/// lanes.
#[derive(Clone)]
pub struct VectorEnv<E: Env, S = Vec<<E as Env>::State>> {
    env: E,
    config: VectorConfig,
    /// One shard per thread.
    shards: Vec<Shard<E, S>>,
    /// The number of sub-environments per shard. The last shard can have fewer.
    shard_len: usize,
}

impl<E: Env<State: fmt::Debug> + fmt::Debug, S: fmt::Debug> fmt::Debug for VectorEnv<E, S> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { env, config, shards, .. } = self;
        formatter.debug_struct("VectorEnv").field("env", env).field("config", config).field("shards", shards).finish()
    }
}

impl<E: Env, S: States<E>> VectorEnv<E, S> {
    /// `size` sub-environments, stepped by `threads` threads. Each sub-environment must be reset before the first step.
    /// The number of threads does not change the results. Episodes are truncated after `max_episode_steps` steps.
    ///
    /// # Errors
    /// `OutOfMemory`.
    pub fn new(
        env: E,
        size: usize,
        max_episode_steps: Option<u64>,
        autoreset: Autoreset,
        threads: usize,
    ) -> Result<Self, AllocationError> {
        let shard_len = size.div_ceil(threads.max(1)).max(1);
        let placeholder = env.reset(&mut NoRng);
        let new_shard = |first: usize| Shard::new(placeholder, shard_len.min(size - first));
        let shards = (0..size).step_by(shard_len).map(new_shard).collect::<Result<_, _>>()?;
        let config = VectorConfig { max_episode_steps: max_episode_steps.unwrap_or(u64::MAX), autoreset };
        Ok(Self { env, config, shards, shard_len })
    }

    /// The environment, which all sub-environments share.
    pub fn env(&self) -> &E {
        &self.env
    }

    /// The states of all sub-environments.
    pub fn states(&self) -> impl Iterator<Item = E::State> + Clone {
        self.shards.iter().flat_map(Shard::states)
    }

    /// The number of threads.
    pub fn threads(&self) -> usize {
        self.shards.len()
    }

    /// The state of a sub-environment.
    pub fn state(&self, index: usize) -> E::State {
        self.shards[index / self.shard_len].state(index % self.shard_len)
    }

    /// The number of steps since the last reset of a sub-environment.
    pub fn elapsed(&self, index: usize) -> u64 {
        self.shards[index / self.shard_len].elapsed(index % self.shard_len)
    }

    /// Whether the episode of a sub-environment has ended and has not been reset yet.
    pub fn is_done(&self, index: usize) -> bool {
        self.shards[index / self.shard_len].done[index % self.shard_len]
    }

    /// [`is_done`](Self::is_done) of all sub-environments.
    pub fn done(&self) -> impl Iterator<Item = bool> {
        self.shards.iter().flat_map(|shard| shard.done.iter().copied())
    }

    /// With [`Autoreset::SameStep`], the index and the last state of each sub-environment whose episode ended in the
    /// last step.
    pub fn final_states(&self) -> impl Iterator<Item = (usize, &E::State)> + Clone {
        let shards = self.shards.iter().enumerate();
        shards.flat_map(move |(shard_index, shard)| {
            shard.final_states.iter().map(move |(index, state)| (shard_index * self.shard_len + index, state))
        })
    }

    /// Begins an episode in a sub-environment, with its initial state within these bounds or the environment's default
    /// bounds.
    pub fn reset(&mut self, index: usize, bounds: Option<[f64; 2]>, rng: &mut impl Rng) {
        let state = match bounds {
            Some(bounds) => self.env.reset_within(bounds, rng),
            None => self.env.reset(rng),
        };
        self.shards[index / self.shard_len].begin(index % self.shard_len, state);
    }

    /// Saves the episodes of all sub-environments, or restores them in a vector environment of the same environment and
    /// size. The number of threads may differ. The [`final_states`](Self::final_states) are not saved.
    ///
    /// # Errors
    /// The bytes are damaged, or belong to another vector environment. This vector environment is then unusable.
    pub fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.shards.iter_mut().try_for_each(|shard| shard.persist(checkpoint))
    }

    /// Writes the current observations.
    pub fn observe(&self, observations: &mut [E::Observation]) {
        for (observation, state) in observations.iter_mut().zip(self.states()) {
            *observation = self.env.observe(&state);
        }
    }

    /// One step of all sub-environments. It does not allocate memory, except for threads if there are several.
    ///
    /// # Panics
    /// With [`Autoreset::Disabled`], if an episode has ended. May panic if an action is out of range.
    pub fn step<R>(&mut self, actions: &[E::Action], rngs: &mut [R], buffers: StepBuffers<'_, E::Observation>)
    where
        R: Rng + Send,
        E: Sync,
        S: Send,
        E::State: Send,
        E::Action: Sync,
        E::Observation: Send,
    {
        let (env, config, shard_len) = (&self.env, self.config, self.shard_len);
        if let [shard] = &mut self.shards[..] {
            return shard.step(env, config, actions, rngs, buffers);
        }
        let chunks = actions.chunks(shard_len).zip(rngs.chunks_mut(shard_len)).zip(buffers.chunks(shard_len));
        let jobs: Vec<_> = self
            .shards
            .iter_mut()
            .zip(chunks)
            .map(|(shard, ((actions, rngs), buffers))| {
                Mutex::new(Some(move || shard.step(env, config, actions, rngs, buffers)))
            })
            .collect();
        thread::scope(|scope| {
            let mut refused = false;
            for job in jobs.iter().skip(1) {
                // The system may refuse a thread. The calling thread then does its share.
                refused |= thread::Builder::new().spawn_scoped(scope, || run_once(job)).is_err();
            }
            jobs.iter().take(if refused { jobs.len() } else { 1 }).for_each(run_once);
        });
    }
}

/// Runs a job, unless another thread has taken it.
fn run_once<J: FnOnce()>(job: &Mutex<Option<J>>) {
    let job = job.lock().unwrap_or_else(PoisonError::into_inner).take();
    if let Some(job) = job {
        job();
    }
}

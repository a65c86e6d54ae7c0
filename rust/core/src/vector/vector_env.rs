//! A vector environment.

use std::sync::{Mutex, PoisonError};
use std::thread;

use super::shard::Shard;
use super::vector_config::VectorConfig;
use super::{Autoreset, StepBuffers};
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::envs::Env;
use crate::memory::AllocationError;
use crate::random::{NoRng, Rng};

/// Several sub-environments of one kind that step together, each with a random generator and a step count. Their
/// results are those of the same environments stepped one by one.
#[derive(Clone, Debug)]
pub struct VectorEnv<E: Env> {
    env: E,
    config: VectorConfig,
    /// One shard per thread.
    shards: Vec<Shard<E::State>>,
    /// The number of sub-environments per shard. The last shard can have fewer.
    shard_len: usize,
}

impl<E: Env> VectorEnv<E> {
    /// `size` sub-environments, stepped by `threads` threads, each of which must be reset before the first step. The
    /// number of threads does not change the results. Episodes are truncated after `max_episode_steps` steps.
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

    /// The environment of all sub-environments.
    pub fn env(&self) -> &E {
        &self.env
    }

    /// The states of all sub-environments.
    pub fn states(&self) -> impl Iterator<Item = &E::State> + Clone {
        self.shards.iter().flat_map(Shard::states)
    }

    /// The number of threads.
    pub fn threads(&self) -> usize {
        self.shards.len()
    }

    /// The state of a sub-environment.
    pub fn state(&self, index: usize) -> &E::State {
        self.shards[index / self.shard_len].state(index % self.shard_len)
    }

    /// The number of steps since the last reset of a sub-environment.
    pub fn elapsed(&self, index: usize) -> u64 {
        self.shards[index / self.shard_len].elapsed(index % self.shard_len)
    }

    /// Whether the episode of a sub-environment has ended without a reset since.
    pub fn is_done(&self, index: usize) -> bool {
        self.shards[index / self.shard_len].is_done(index % self.shard_len)
    }

    /// [`is_done`](Self::is_done) of all sub-environments.
    pub fn done(&self) -> impl Iterator<Item = bool> {
        self.shards.iter().flat_map(Shard::done)
    }

    /// With [`Autoreset::SameStep`], the index and the last state of each sub-environment whose episode ended in the last
    /// step.
    pub fn final_states(&self) -> impl Iterator<Item = (usize, &E::State)> + Clone {
        let shards = self.shards.iter().enumerate();
        shards.flat_map(move |(shard_index, shard)| {
            shard.final_states().iter().map(move |(index, state)| (shard_index * self.shard_len + index, state))
        })
    }

    /// Begins an episode in a sub-environment, within these bounds or the environment's default ones.
    pub fn reset(&mut self, index: usize, bounds: Option<[f64; 2]>, rng: &mut impl Rng) {
        let state = match bounds {
            Some(bounds) => self.env.reset_within(bounds, rng),
            None => self.env.reset(rng),
        };
        self.shards[index / self.shard_len].begin(index % self.shard_len, state);
    }

    /// Saves the episodes of all sub-environments, or restores them in a vector environment of the same environment and
    /// size. The number of threads can be another, and [`final_states`](Self::final_states) are left out.
    ///
    /// # Errors
    /// The bytes are damaged, or belong to another vector environment. This one is then useless.
    pub fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.shards.iter_mut().try_for_each(|shard| shard.persist(checkpoint))
    }

    /// Writes the current observations.
    pub fn observe(&self, observations: &mut [E::Observation]) {
        for (observation, state) in observations.iter_mut().zip(self.states()) {
            *observation = self.env.observe(state);
        }
    }

    /// One step of all sub-environments. It allocates nothing, except for threads if there are several.
    ///
    /// # Panics
    /// With [`Autoreset::Disabled`], if an episode has ended. May panic if an action is out of range.
    pub fn step<R>(&mut self, actions: &[E::Action], rngs: &mut [R], buffers: StepBuffers<'_, E::Observation>)
    where
        R: Rng + Send,
        E: Sync,
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
                // Threads may run out. The calling thread then does their share.
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::envs::classic_control::{Acrobot, CartPole, MountainCar};
    use crate::random::{Pcg64, Rng, SeedSequence};

    const STEPS: usize = 60;

    /// One generator per sub-environment.
    fn generators(size: usize) -> Vec<Pcg64> {
        (0..size as u32).map(|seed| Pcg64::new(&SeedSequence::new(&[seed]))).collect()
    }

    /// Compares a vector environment with a loop over single environments.
    fn check<E>(env: &E, size: usize, threads: usize, limit: u64, autoreset: Autoreset, seed: u32)
    where
        E: Env<Action = usize, Observation: Send + Default + Copy + PartialEq + std::fmt::Debug> + Clone + Sync,
        E::State: Send + PartialEq + std::fmt::Debug,
    {
        let mut vector = VectorEnv::new(env.clone(), size, Some(limit), autoreset, threads).expect("it fits");
        let (mut rngs, mut reference_rngs) = (generators(size), generators(size));
        let mut states: Vec<_> = reference_rngs.iter_mut().map(|rng| env.reset(rng)).collect();
        let mut elapsed = vec![0; size];
        let mut done = vec![false; size];
        (0..size).for_each(|index| vector.reset(index, None, &mut rngs[index]));
        let mut action_rng = Pcg64::new(&SeedSequence::new(&[seed, 1]));
        let mut observations = vec![E::Observation::default(); size];
        let (mut rewards, mut terminated, mut truncated) = (vec![0.0; size], vec![false; size], vec![false; size]);
        for _ in 0..STEPS {
            let actions: Vec<_> = (0..size).map(|_| action_rng.integers(env.num_actions() as u32) as usize).collect();
            let buffers = StepBuffers {
                observations: &mut observations,
                rewards: &mut rewards,
                terminated: &mut terminated,
                truncated: &mut truncated,
            };
            vector.step(&actions, &mut rngs, buffers);
            let mut final_states = Vec::new();
            for index in 0..size {
                let mut expected = (0.0, false, false);
                if done[index] && autoreset == Autoreset::NextStep {
                    (states[index], elapsed[index], done[index]) = (env.reset(&mut reference_rngs[index]), 0, false);
                } else {
                    let step = env.step(states[index], actions[index], &mut reference_rngs[index]);
                    states[index] = step.state;
                    elapsed[index] += 1;
                    expected = (step.reward, step.terminated, elapsed[index] >= limit);
                    done[index] = expected.1 || expected.2;
                    if done[index] && autoreset == Autoreset::SameStep {
                        final_states.push((index, states[index]));
                        (states[index], elapsed[index], done[index]) =
                            (env.reset(&mut reference_rngs[index]), 0, false);
                    }
                }
                assert_eq!((rewards[index], terminated[index], truncated[index]), expected);
                assert_eq!(observations[index], env.observe(&states[index]));
            }
            assert!(vector.states().eq(&states));
            assert!((0..size).all(|index| vector.elapsed(index) == elapsed[index]));
            assert!(vector.done().eq(done.iter().copied()));
            assert!(vector.final_states().map(|(index, state)| (index, *state)).eq(final_states));
            assert_eq!(rngs, reference_rngs);
            for index in (0..size).filter(|_| autoreset == Autoreset::Disabled) {
                if !done[index] {
                    continue;
                }
                vector.reset(index, None, &mut rngs[index]);
                (states[index], elapsed[index], done[index]) = (env.reset(&mut reference_rngs[index]), 0, false);
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]

        #[test]
        fn a_vector_environment_equals_single_environments(
            size in 1_usize..40,
            threads in 1_usize..5,
            limit in 1_u64..50,
            autoreset in prop_oneof![Just(Autoreset::NextStep), Just(Autoreset::SameStep), Just(Autoreset::Disabled)],
            seed in any::<u32>(),
            (force, goal_position) in prop_oneof![Just((0.001, 0.5)), (0.0..0.02, -1.2..0.5)],
        ) {
            let car = MountainCar { goal_position, force, ..MountainCar::default() };
            check(&car, size, threads, limit, autoreset, seed);
            check(&CartPole::default(), size, threads, limit, autoreset, seed);
            check(&Acrobot { torque_noise_max: 1.0, ..Acrobot::default() }, size, threads, limit, autoreset, seed);
        }
    }

    #[test]
    fn a_restored_vector_environment_continues_with_other_threads() {
        let new =
            |threads| VectorEnv::new(CartPole::default(), 7, Some(9), Autoreset::NextStep, threads).expect("it fits");
        let step = |vector: &mut VectorEnv<CartPole>, rngs: &mut [Pcg64]| {
            let (mut observations, mut rewards) = ([[0.0; 4]; 7], [0.0; 7]);
            let (mut terminated, mut truncated) = ([false; 7], [false; 7]);
            let buffers = StepBuffers {
                observations: &mut observations,
                rewards: &mut rewards,
                terminated: &mut terminated,
                truncated: &mut truncated,
            };
            vector.step(&[1; 7], rngs, buffers);
            (observations, rewards, terminated, truncated)
        };
        let (mut saved, mut rngs) = (new(3), generators(7));
        (0..7).for_each(|index| saved.reset(index, None, &mut rngs[index]));
        for _ in 0..9 {
            step(&mut saved, &mut rngs);
        }

        let mut bytes = Vec::new();
        saved.persist(&mut Checkpoint::save(&mut bytes)).expect("memory suffices");
        let (mut restored, mut same_rngs) = (new(1), rngs.clone());
        let mut checkpoint = Checkpoint::restore(&bytes);
        restored.persist(&mut checkpoint).expect("the bytes are complete");
        checkpoint.finish().expect("all bytes were read");
        for _ in 0..30 {
            assert_eq!(step(&mut saved, &mut rngs), step(&mut restored, &mut same_rngs));
        }
        let mut cut = Checkpoint::restore(&bytes[..bytes.len() - 1]);
        assert_eq!(restored.persist(&mut cut), Err(CheckpointError::Truncated));
    }

    #[test]
    fn zero_sub_environments_are_allowed() {
        let mut empty = VectorEnv::new(CartPole::default(), 0, None, Autoreset::NextStep, 2).expect("it fits");
        let buffers = StepBuffers { observations: &mut [], rewards: &mut [], terminated: &mut [], truncated: &mut [] };
        empty.step(&[], &mut [] as &mut [Pcg64], buffers);
        assert_eq!(empty.states().count(), 0);
    }
}

//! Many sub-environments of one kind that are stepped together, each with its own stream and its own clock.

use super::Autoreset;
use super::StepBuffers;
use super::shard::Shard;
use super::vector_config::VectorConfig;
use std::thread;

use crate::envs::Env;
use crate::random::{NoRng, Rng};

/// The states of all sub-environments, in as many shards as threads step them.
#[derive(Clone, Debug)]
pub struct VectorEnv<E: Env> {
    env: E,
    config: VectorConfig,
    shards: Vec<Shard<E::State>>,
    /// How many sub-environments a shard has; the last may have fewer.
    length: usize,
}

impl<E: Env> VectorEnv<E> {
    /// `size` sub-environments, to be reset before anything else. `threads` step them, and the results are the same for
    /// any number; no episode is longer than `max_episode_steps`.
    pub fn new(env: E, size: usize, max_episode_steps: Option<u64>, autoreset: Autoreset, threads: usize) -> Self {
        let length = size.div_ceil(threads.max(1)).max(1);
        let placeholder = env.reset(&mut NoRng);
        let shards = (0..size).step_by(length).map(|first| Shard::new(placeholder, length.min(size - first))).collect();
        Self {
            env,
            config: VectorConfig { max_episode_steps: max_episode_steps.unwrap_or(u64::MAX), autoreset },
            shards,
            length,
        }
    }

    /// The environment that each of them is.
    pub fn env(&self) -> &E {
        &self.env
    }

    /// The state of each, in their order.
    pub fn states(&self) -> impl Iterator<Item = &E::State> + Clone {
        self.shards.iter().flat_map(Shard::states)
    }

    /// How many threads step them.
    pub fn threads(&self) -> usize {
        self.shards.len()
    }

    /// The state of one of them.
    pub fn state(&self, lane: usize) -> &E::State {
        self.shards[lane / self.length].state(lane % self.length)
    }

    /// How many steps its episode has had.
    pub fn elapsed(&self, lane: usize) -> u64 {
        self.shards[lane / self.length].elapsed(lane % self.length)
    }

    /// Whether its episode is over and it was not reset since.
    pub fn is_done(&self, lane: usize) -> bool {
        self.shards[lane / self.length].is_done(lane % self.length)
    }

    /// Whether the episode of each is over.
    pub fn done(&self) -> impl Iterator<Item = bool> {
        self.shards.iter().flat_map(Shard::done)
    }

    /// With [`Autoreset::SameStep`], the episodes that the last step ended: which sub-environment, and its last state.
    pub fn final_states(&self) -> impl Iterator<Item = (usize, &E::State)> + Clone {
        let shards = self.shards.iter().enumerate();
        shards.flat_map(move |(index, shard)| {
            shard.final_states().iter().map(move |(lane, state)| (index * self.length + lane, state))
        })
    }

    /// Begins a new episode in one sub-environment, between the environment's own bounds if there are no others.
    pub fn reset(&mut self, lane: usize, start: Option<[f64; 2]>, rng: &mut impl Rng) {
        let state = match start {
            Some(start) => self.env.reset_within(start, rng),
            None => self.env.reset(rng),
        };
        self.shards[lane / self.length].begin(lane % self.length, state);
    }

    /// What each shows.
    pub fn observe(&self, observations: &mut [E::Observation]) {
        for (observation, state) in observations.iter_mut().zip(self.states()) {
            *observation = self.env.observe(state);
        }
    }

    /// One step of all of them. Nothing is allocated, but for threads where there is more than one.
    ///
    /// # Panics
    /// With [`Autoreset::Disabled`], where an episode is over; and it may where an action is none of the environment's.
    pub fn step<D>(&mut self, actions: &[E::Action], rngs: &mut [D], batch: StepBuffers<'_, E::Observation>)
    where
        D: Rng + Send,
        E: Sync,
        E::State: Send,
        E::Action: Sync,
        E::Observation: Send,
    {
        let (env, config, length) = (&self.env, self.config, self.length);
        if let [shard] = &mut self.shards[..] {
            return shard.step(env, config, actions, rngs, batch);
        }
        let batches = batch.chunks(length);
        let lanes = self.shards.iter_mut().zip(actions.chunks(length)).zip(rngs.chunks_mut(length)).zip(batches);
        thread::scope(|scope| {
            let mut lanes =
                lanes.map(|(((shard, actions), rngs), batch)| move || shard.step(env, config, actions, rngs, batch));
            let own = lanes.next();
            for work in lanes {
                scope.spawn(work);
            }
            // One of them is the caller's.
            if let Some(work) = own {
                work();
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::envs::classic_control::{Acrobot, CartPole, MountainCar};
    use crate::random::{Pcg64, Rng, SeedSequence};

    const STEPS: usize = 60;

    fn streams(size: usize) -> Vec<Pcg64> {
        (0..size as u32).map(|seed| Pcg64::new(&SeedSequence::new(&[seed]))).collect()
    }

    /// What the lone loop brings: sub-environment by sub-environment, step by step.
    fn check<E>(env: &E, size: usize, threads: usize, limit: u64, autoreset: Autoreset, seed: u32)
    where
        E: Env<Action = usize, Observation: Send + Default + Copy + PartialEq + std::fmt::Debug> + Clone + Sync,
        E::State: Send + PartialEq + std::fmt::Debug,
    {
        let mut vector = VectorEnv::new(env.clone(), size, Some(limit), autoreset, threads);
        let (mut rngs, mut own) = (streams(size), streams(size));
        let mut states: Vec<_> = own.iter_mut().map(|rng| env.reset(rng)).collect();
        let mut elapsed = vec![0; size];
        let mut done = vec![false; size];
        (0..size).for_each(|lane| vector.reset(lane, None, &mut rngs[lane]));
        let mut choose = Pcg64::new(&SeedSequence::new(&[seed, 1]));
        let mut observations = vec![E::Observation::default(); size];
        let (mut rewards, mut terminated, mut truncated) = (vec![0.0; size], vec![false; size], vec![false; size]);
        for _ in 0..STEPS {
            let actions: Vec<_> = (0..size).map(|_| choose.integers(env.num_actions() as u32) as usize).collect();
            let batch = StepBuffers {
                observations: &mut observations,
                rewards: &mut rewards,
                terminated: &mut terminated,
                truncated: &mut truncated,
            };
            vector.step(&actions, &mut rngs, batch);
            let mut final_states = Vec::new();
            for lane in 0..size {
                let mut expected = (0.0, false, false);
                if done[lane] && autoreset == Autoreset::NextStep {
                    (states[lane], elapsed[lane], done[lane]) = (env.reset(&mut own[lane]), 0, false);
                } else {
                    let step = env.step(states[lane], actions[lane], &mut own[lane]);
                    states[lane] = step.state;
                    elapsed[lane] += 1;
                    expected = (step.reward, step.terminated, elapsed[lane] >= limit);
                    done[lane] = expected.1 || expected.2;
                    if done[lane] && autoreset == Autoreset::SameStep {
                        final_states.push((lane, states[lane]));
                        (states[lane], elapsed[lane], done[lane]) = (env.reset(&mut own[lane]), 0, false);
                    }
                }
                assert_eq!((rewards[lane], terminated[lane], truncated[lane]), expected);
                assert_eq!(observations[lane], env.observe(&states[lane]));
            }
            assert!(vector.states().eq(&states));
            assert!((0..size).all(|lane| vector.elapsed(lane) == elapsed[lane]));
            assert!(vector.done().eq(done.iter().copied()));
            assert!(vector.final_states().map(|(lane, state)| (lane, *state)).eq(final_states));
            assert_eq!(rngs, own);
            for lane in (0..size).filter(|_| autoreset == Autoreset::Disabled) {
                if !done[lane] {
                    continue;
                }
                vector.reset(lane, None, &mut rngs[lane]);
                (states[lane], elapsed[lane], done[lane]) = (env.reset(&mut own[lane]), 0, false);
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]

        #[test]
        fn each_sub_environment_is_as_it_would_be_alone(
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
    fn no_sub_environments_are_no_trouble() {
        let mut none = VectorEnv::new(CartPole::default(), 0, None, Autoreset::NextStep, 2);
        let batch = StepBuffers { observations: &mut [], rewards: &mut [], terminated: &mut [], truncated: &mut [] };
        none.step(&[], &mut [] as &mut [Pcg64], batch);
        assert_eq!(none.states().count(), 0);
    }
}

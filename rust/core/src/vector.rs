//! Many sub-environments of one kind that are stepped together, each with its own stream and its own clock.

mod block;

use std::thread;

use block::Block;

use crate::env::Env;
use crate::random::{Draw, NoDraw};

/// What becomes of a sub-environment whose episode is over: Gymnasium's `AutoresetMode`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Autoreset {
    /// Its next step is a reset, whatever its action.
    NextStep,
    /// It is reset at once; what it showed last is among the [`Vector::finals`].
    SameStep,
    /// Nothing: it must be reset before it is stepped again.
    Disabled,
}

/// What a step brings, a place for each sub-environment.
#[derive(Debug)]
pub struct Batch<'a, O> {
    /// What each shows after the step.
    pub observations: &'a mut [O],
    /// 0 for a step that was a reset.
    pub rewards: &'a mut [f64],
    /// Whether each has come to a terminal state …
    pub terminated: &'a mut [bool],
    /// … or to its time limit. Both may be.
    pub truncated: &'a mut [bool],
}

/// What all sub-environments have in common besides their physics.
#[derive(Clone, Copy, Debug)]
struct Rules {
    limit: u64,
    autoreset: Autoreset,
}

/// The states of all sub-environments, in as many blocks as threads step them.
#[derive(Clone, Debug)]
pub struct Vector<E: Env> {
    env: E,
    rules: Rules,
    blocks: Vec<Block<E::State>>,
    /// How many sub-environments a block has; the last may have fewer.
    length: usize,
}

impl<E: Env> Vector<E> {
    /// `size` sub-environments, to be reset before anything else. `threads` step them, and the results are the same for
    /// any number; no episode is longer than `max_episode_steps`.
    pub fn new(env: E, size: usize, max_episode_steps: Option<u64>, autoreset: Autoreset, threads: usize) -> Self {
        let length = size.div_ceil(threads.max(1)).max(1);
        let nowhere = env.reset(&mut NoDraw);
        let blocks = (0..size).step_by(length).map(|first| Block::new(nowhere, length.min(size - first))).collect();
        Self { env, rules: Rules { limit: max_episode_steps.unwrap_or(u64::MAX), autoreset }, blocks, length }
    }

    /// The environment that each of them is.
    pub fn env(&self) -> &E {
        &self.env
    }

    /// The state of each, in their order.
    pub fn states(&self) -> impl Iterator<Item = &E::State> + Clone {
        self.blocks.iter().flat_map(Block::states)
    }

    /// How many threads step them.
    pub fn threads(&self) -> usize {
        self.blocks.len()
    }

    /// The state of one of them.
    pub fn state(&self, lane: usize) -> &E::State {
        self.blocks[lane / self.length].state(lane % self.length)
    }

    /// How many steps its episode has had.
    pub fn elapsed(&self, lane: usize) -> u64 {
        self.blocks[lane / self.length].elapsed(lane % self.length)
    }

    /// Whether its episode is over and it was not reset since.
    pub fn is_over(&self, lane: usize) -> bool {
        self.blocks[lane / self.length].is_over(lane % self.length)
    }

    /// Whether the episode of each is over.
    pub fn over(&self) -> impl Iterator<Item = bool> {
        self.blocks.iter().flat_map(Block::over)
    }

    /// With [`Autoreset::SameStep`], the episodes that the last step ended: which sub-environment, and its last state.
    pub fn finals(&self) -> impl Iterator<Item = (usize, &E::State)> + Clone {
        let blocks = self.blocks.iter().enumerate();
        blocks.flat_map(move |(block, lanes)| {
            lanes.finals().iter().map(move |(lane, state)| (block * self.length + lane, state))
        })
    }

    /// Begins a new episode in one sub-environment, between the environment's own bounds if there are no others.
    pub fn reset(&mut self, lane: usize, start: Option<[f64; 2]>, draw: &mut impl Draw) {
        let state = match start {
            Some(start) => self.env.reset_between(start, draw),
            None => self.env.reset(draw),
        };
        self.blocks[lane / self.length].begin(lane % self.length, state);
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
    pub fn step<D>(&mut self, actions: &[E::Action], draws: &mut [D], batch: Batch<'_, E::Observation>)
    where
        D: Draw + Send,
        E: Sync,
        E::State: Send,
        E::Action: Sync,
        E::Observation: Send,
    {
        let (env, rules, length) = (&self.env, self.rules, self.length);
        if let [block] = &mut self.blocks[..] {
            return block.step(env, rules, actions, draws, batch);
        }
        let batches = batch.chunks(length);
        let lanes = self.blocks.iter_mut().zip(actions.chunks(length)).zip(draws.chunks_mut(length)).zip(batches);
        thread::scope(|scope| {
            let mut lanes =
                lanes.map(|(((block, actions), draws), batch)| move || block.step(env, rules, actions, draws, batch));
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

impl<'a, O> Batch<'a, O> {
    /// The places of each block.
    fn chunks(self, length: usize) -> impl Iterator<Item = Batch<'a, O>> {
        let places = self.observations.chunks_mut(length).zip(self.rewards.chunks_mut(length));
        let ends = self.terminated.chunks_mut(length).zip(self.truncated.chunks_mut(length));
        places.zip(ends).map(|((observations, rewards), (terminated, truncated))| Batch {
            observations,
            rewards,
            terminated,
            truncated,
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::envs::{Acrobot, CartPole, MountainCar};
    use crate::random::{Pcg64, SeedSequence};

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
        let mut vector = Vector::new(env.clone(), size, Some(limit), autoreset, threads);
        let (mut draws, mut own) = (streams(size), streams(size));
        let mut states: Vec<_> = own.iter_mut().map(|draw| env.reset(draw)).collect();
        let mut elapsed = vec![0; size];
        let mut over = vec![false; size];
        (0..size).for_each(|lane| vector.reset(lane, None, &mut draws[lane]));
        let mut choose = Pcg64::new(&SeedSequence::new(&[seed, 1]));
        let mut observations = vec![E::Observation::default(); size];
        let (mut rewards, mut terminated, mut truncated) = (vec![0.0; size], vec![false; size], vec![false; size]);
        for _ in 0..STEPS {
            let actions: Vec<_> = (0..size).map(|_| choose.integers(env.actions() as u32) as usize).collect();
            let batch = Batch {
                observations: &mut observations,
                rewards: &mut rewards,
                terminated: &mut terminated,
                truncated: &mut truncated,
            };
            vector.step(&actions, &mut draws, batch);
            let mut finals = Vec::new();
            for lane in 0..size {
                let mut expected = (0.0, false, false);
                if over[lane] && autoreset == Autoreset::NextStep {
                    (states[lane], elapsed[lane], over[lane]) = (env.reset(&mut own[lane]), 0, false);
                } else {
                    let step = env.step(states[lane], actions[lane], &mut own[lane]);
                    states[lane] = step.state;
                    elapsed[lane] += 1;
                    expected = (step.reward, step.terminated, elapsed[lane] >= limit);
                    over[lane] = expected.1 || expected.2;
                    if over[lane] && autoreset == Autoreset::SameStep {
                        finals.push((lane, states[lane]));
                        (states[lane], elapsed[lane], over[lane]) = (env.reset(&mut own[lane]), 0, false);
                    }
                }
                assert_eq!((rewards[lane], terminated[lane], truncated[lane]), expected);
                assert_eq!(observations[lane], env.observe(&states[lane]));
            }
            assert!(vector.states().eq(&states));
            assert!((0..size).all(|lane| vector.elapsed(lane) == elapsed[lane]));
            assert!(vector.over().eq(over.iter().copied()));
            assert!(vector.finals().map(|(lane, state)| (lane, *state)).eq(finals));
            assert_eq!(draws, own);
            for lane in (0..size).filter(|_| autoreset == Autoreset::Disabled) {
                if !over[lane] {
                    continue;
                }
                vector.reset(lane, None, &mut draws[lane]);
                (states[lane], elapsed[lane], over[lane]) = (env.reset(&mut own[lane]), 0, false);
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
        let mut none = Vector::new(CartPole::default(), 0, None, Autoreset::NextStep, 2);
        let batch = Batch { observations: &mut [], rewards: &mut [], terminated: &mut [], truncated: &mut [] };
        none.step(&[], &mut [] as &mut [Pcg64], batch);
        assert_eq!(none.states().count(), 0);
    }
}

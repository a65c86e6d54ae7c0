//! Compares vector environments with single environments.

use proptest::prelude::*;

use super::{Autoreset, LaneStates, States, StepBuffers, VectorEnv};
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::envs::Env;
use crate::envs::classic_control::{Acrobot, AcrobotState, CartPole, CartPoleState, MountainCar};
use crate::random::{Pcg64, Rng, SeedSequence};

const STEPS: usize = 60;

type PoleLanes = VectorEnv<CartPole, LaneStates<4>>;

/// One generator per sub-environment.
fn generators(size: usize) -> Vec<Pcg64> {
    (0..size as u32).map(|seed| Pcg64::new(&SeedSequence::new(&[seed]))).collect()
}

/// Compares a vector environment with a loop over single environments.
fn check<E, S>(env: &E, size: usize, threads: usize, limit: u64, autoreset: Autoreset, seed: u32)
where
    E: Env<Action = usize, Observation: Send + Default + Copy + PartialEq + std::fmt::Debug> + Clone + Sync,
    E::State: Send + PartialEq + std::fmt::Debug,
    S: States<E> + Send,
{
    let mut vector =
        VectorEnv::<_, S>::new(env.clone(), size, Some(limit), autoreset, threads).expect("a small vector environment");
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
                    (states[index], elapsed[index], done[index]) = (env.reset(&mut reference_rngs[index]), 0, false);
                }
            }
            assert_eq!((rewards[index], terminated[index], truncated[index]), expected);
            assert_eq!(observations[index], env.observe(&states[index]));
        }
        assert!(vector.states().eq(states.iter().copied()));
        assert!((0..size).all(|index| vector.elapsed(index) == elapsed[index]));
        assert!(vector.done().eq(done.iter().copied()));
        assert!(vector.final_states().map(|(index, &state)| (index, state)).eq(final_states));
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
        check::<_, LaneStates<2>>(&car, size, threads, limit, autoreset, seed);
        check::<_, LaneStates<4>>(&CartPole::default(), size, threads, limit, autoreset, seed);
        check::<_, Vec<CartPoleState>>(&CartPole::default(), size, threads, limit, autoreset, seed);
        check::<_, Vec<AcrobotState>>(&Acrobot { torque_noise_max: 1.0, ..Acrobot::default() }, size, threads, limit, autoreset, seed);
    }
}

#[test]
fn a_restored_vector_environment_continues_with_other_threads() {
    let new = |threads| {
        PoleLanes::new(CartPole::default(), 7, Some(9), Autoreset::NextStep, threads)
            .expect("a small vector environment")
    };
    let step = |vector: &mut PoleLanes, rngs: &mut [Pcg64]| {
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
    let mut empty =
        PoleLanes::new(CartPole::default(), 0, None, Autoreset::NextStep, 2).expect("a small vector environment");
    let buffers = StepBuffers { observations: &mut [], rewards: &mut [], terminated: &mut [], truncated: &mut [] };
    empty.step(&[], &mut [] as &mut [Pcg64], buffers);
    assert_eq!(empty.states().count(), 0);
}

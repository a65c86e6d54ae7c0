//! The time per step of a sub-environment in a vector environment on one thread.
//!
//! `cargo bench --bench vector`. Finished episodes are reset in the same step.

mod benchmarks;

use benchmarks::Benchmarks;
use qtab_core::Env;
use qtab_core::envs::SimdEnv;
use qtab_core::envs::classic_control::{CartPole, MountainCar};
use qtab_core::random::{Pcg64, Rng, SeedSequence};
use qtab_core::vector::{Autoreset, LaneStates, StepBuffers, VectorEnv};

const NUM_ENVS: usize = 4096;
const LIMIT: u64 = 200;

fn step<E, const M: usize>(benchmarks: &mut Benchmarks, name: &str, env: E)
where
    E: SimdEnv<M> + Env<Observation = [f32; M], State: Send> + Sync,
{
    let mut rngs: Vec<_> = (0..NUM_ENVS as u32).map(|seed| Pcg64::new(&SeedSequence::new(&[seed]))).collect();
    let actions: Vec<_> = rngs.iter_mut().map(|rng| rng.integers(env.num_actions() as u32) as usize).collect();
    let mut vector = VectorEnv::<_, LaneStates<M>>::new(env, NUM_ENVS, Some(LIMIT), Autoreset::SameStep, 1)
        .expect("a small vector environment");
    rngs.iter_mut().enumerate().for_each(|(index, rng)| vector.reset(index, None, rng));
    let (mut observations, mut rewards) = (vec![[0.0; M]; NUM_ENVS], vec![0.0; NUM_ENVS]);
    let (mut terminated, mut truncated) = (vec![false; NUM_ENVS], vec![false; NUM_ENVS]);
    benchmarks.add("vector", name, || {
        let buffers = StepBuffers {
            observations: &mut observations,
            rewards: &mut rewards,
            terminated: &mut terminated,
            truncated: &mut truncated,
        };
        vector.step(&actions, &mut rngs, buffers);
        NUM_ENVS as u64
    });
}

fn main() {
    let mut benchmarks = Benchmarks::from_env();
    step(&mut benchmarks, "MountainCar", MountainCar::default());
    step(&mut benchmarks, "CartPole", CartPole::default());
    benchmarks.finish();
}

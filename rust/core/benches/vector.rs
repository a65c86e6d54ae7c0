//! What a step of a sub-environment costs, where many are stepped together on one thread.
//!
//! `cargo bench --bench vector`. Episodes that end begin anew in the same step.

use criterion::{Criterion, Throughput};
use qtab_core::Env;
use qtab_core::envs::{CartPole, MountainCar};
use qtab_core::random::{Draw, Pcg64, SeedSequence};
use qtab_core::vector::{Autoreset, Batch, Vector};

const LANES: usize = 4096;
const LIMIT: u64 = 200;

fn step<E>(criterion: &mut Criterion, name: &str, env: E)
where
    E: Env<Action = usize, Observation: Copy + Default + Send, State: Send> + Sync,
{
    let mut draws: Vec<_> = (0..LANES as u32).map(|seed| Pcg64::new(&SeedSequence::new(&[seed]))).collect();
    let actions: Vec<_> = draws.iter_mut().map(|draw| draw.integers(env.actions() as u32) as usize).collect();
    let mut vector = Vector::new(env, LANES, Some(LIMIT), Autoreset::SameStep, 1);
    draws.iter_mut().enumerate().for_each(|(lane, draw)| vector.reset(lane, None, draw));
    let (mut observations, mut rewards) = (vec![E::Observation::default(); LANES], vec![0.0; LANES]);
    let (mut terminated, mut truncated) = (vec![false; LANES], vec![false; LANES]);
    let mut group = criterion.benchmark_group("vector");
    group.throughput(Throughput::Elements(LANES as u64));
    group.bench_function(name, |bencher| {
        bencher.iter(|| {
            let batch = Batch {
                observations: &mut observations,
                rewards: &mut rewards,
                terminated: &mut terminated,
                truncated: &mut truncated,
            };
            vector.step(&actions, &mut draws, batch);
        });
    });
    group.finish();
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    step(&mut criterion, "MountainCar", MountainCar::default());
    step(&mut criterion, "CartPole", CartPole::default());
    criterion.final_summary();
}

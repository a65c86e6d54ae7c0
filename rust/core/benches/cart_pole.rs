//! The speed of `CartPole` in steps per second: the parts of a step, and the training run of the environment's default
//! preset in the Python package.
//!
//! `cargo bench --bench cart_pole`, or `cargo bench --bench cart_pole -- run` for the training run only.

mod benchmarks;
mod runs;

use std::hint::black_box;

use benchmarks::Benchmarks;
use qtab_core::envs::classic_control::{CartPole, CartPoleState};
use qtab_core::features::{Bins, Edges};
use qtab_core::learners::{Agent, QLearning, TdLearner};
use qtab_core::policies::EpsilonGreedy;
use qtab_core::random::{Pcg64, Rng, SeedSequence};
use qtab_core::schedules::Schedule;
use qtab_core::tasks::NativeTask;
use qtab_core::{Budget, Env, Features, Trainer};
use runs::{agent, train, train_batch};

const MAX_EPISODE_STEPS: u64 = 500;
const EPISODES: usize = 1000;
/// Small enough for the first-level cache, large enough that a branch predictor cannot memorize it.
const BATCH: usize = 4096;

type CartPoleBins = Bins<f32, [Edges; 4]>;
type Run = Trainer<NativeTask<CartPole, CartPoleBins>, TdLearner<QLearning, Agent<2, EpsilonGreedy, Schedule>>, Pcg64>;

fn bins() -> CartPoleBins {
    Bins::new([
        Edges::equal_width(-2.4_f32, 2.4, 3),
        Edges::equal_width(-2.0_f32, 2.0, 3),
        Edges::equal_width(-0.21_f32, 0.21, 6),
        Edges::equal_width(-2.0_f32, 2.0, 6),
    ])
}

/// Random states and actions.
fn states(rng: &mut Pcg64) -> Vec<(CartPoleState, usize)> {
    let limits = [2.4, 2.0, 0.21, 2.0];
    let state = |rng: &mut Pcg64| limits.map(|limit| rng.uniform(-limit, limit)).into();
    (0..BATCH).map(|_| (state(rng), rng.integers(2) as usize)).collect()
}

/// One step of many independent cart-poles.
fn physics(benchmarks: &mut Benchmarks) {
    let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
    let (pole, states) = (CartPole::default(), states(&mut rng));
    benchmarks.add("CartPole", "physics", || {
        for &(state, action) in &states {
            black_box(pole.step(state, action, &mut rng));
        }
        BATCH as u64
    });
}

/// Converts observations to rows.
fn discretizer(benchmarks: &mut Benchmarks) {
    let (pole, bins) = (CartPole::default(), bins());
    let states = states(&mut Pcg64::new(&SeedSequence::new(&[0])));
    let observations: Vec<_> = states.iter().map(|(state, _)| pole.observe(state)).collect();
    benchmarks.add("CartPole", "bins", || {
        for observation in &observations {
            let _ = black_box(bins.active_rows(observation));
        }
        BATCH as u64
    });
}

fn run(seed: u32) -> Run {
    let (seed, features) = (SeedSequence::new(&[seed]), bins());
    let shape = (Features::<[f32; 4]>::len(&features), 2);
    let policy = EpsilonGreedy::linear(0.2, 0.0, EPISODES as u64);
    let agent = agent(shape, 50.0, policy, Schedule::linear(0.5, 0.0, EPISODES as u64, 0), 0.999);
    let task = NativeTask::new(CartPole::default(), features, Some(MAX_EPISODE_STEPS), Pcg64::new(&seed));
    Trainer::new(task, TdLearner { agent, rule: QLearning }, Pcg64::new(&seed.child(0)))
}

fn training(benchmarks: &mut Benchmarks) {
    let budget = Budget { episodes: EPISODES, work: u64::MAX };
    benchmarks.add("CartPole", "run", || train(run(0), budget));
    benchmarks.add("CartPole", "run, a batch of 8 on one core", || train_batch(run, budget));
}

fn main() {
    let mut benchmarks = Benchmarks::from_env();
    physics(&mut benchmarks);
    discretizer(&mut benchmarks);
    training(&mut benchmarks);
    benchmarks.finish();
}

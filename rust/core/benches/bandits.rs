//! The time per step of bandit algorithms on the 10-armed testbed, and of the draws that a step needs.
//!
//! `cargo bench --bench bandits`. The runs have the same types as in the Python package.

mod benchmarks;
mod runs;

use std::hint::black_box;

use benchmarks::Benchmarks;
use qtab_core::features::OutOfBounds;
use qtab_core::learners::{Agent, GradientBandit, QLearning, TdLearner, TransformedSteps, UpdateRule};
use qtab_core::policies::{AnyPolicy, TieBreaking, Ucb};
use qtab_core::random::{AgentRng, Pcg64, Rng, SeedSequence};
use qtab_core::schedules::{LearningRate, Schedule};
use qtab_core::tasks::{BoxedTask, KArmedBandit, Testbed};
use qtab_core::{Budget, StopFlag, Trainer};
use runs::{agent, train};

/// The message for allocations, which are small here.
const FITS: &str = "small allocations succeed";

const GROUP: &str = "10-armed testbed";
const STEPS: usize = 1000;
const ACTIONS: usize = 10;
const TESTBED: Testbed = Testbed { num_actions: ACTIONS, mean: 0.0, deviation: 1.0, random_walk: 0.0 };
const EPSILON: f64 = 0.1;
const CONFIDENCE: f64 = 2.0;

fn run<U: UpdateRule<[u32; 1], Agent>>(policy: AnyPolicy, learning_rate: LearningRate, rule: U, seed: u32) -> u64 {
    let seed = SeedSequence::new(&[seed]);
    let task: BoxedTask<[u32; 1], OutOfBounds> = BoxedTask::new(KArmedBandit::new(TESTBED, Pcg64::new(&seed)));
    let agent = agent((1, ACTIONS), 0.0, policy, learning_rate, 1.0);
    let learner = TransformedSteps { learner: TdLearner { agent, rule }, terminate: false, bonus: None };
    let rng = AgentRng::pcg64(&seed.child(0));
    train(Trainer::new(task, learner, rng), Budget { episodes: STEPS, work: u64::MAX })
}

/// Adds the benchmark of a learner on a new problem for each run, one seed after the other: with a single problem,
/// branches would be predicted too well.
fn bench<U>(benchmarks: &mut Benchmarks, name: &str, parts: impl Fn() -> (AnyPolicy, LearningRate, U))
where
    U: UpdateRule<[u32; 1], Agent>,
{
    let mut seed = 0;
    benchmarks.add(GROUP, name, || {
        seed += 1;
        let (policy, learning_rate, rule) = parts();
        run(policy, learning_rate, rule, seed)
    });
}

fn averages() -> LearningRate {
    LearningRate::by_visit_count(1.0, 0.0, ACTIONS, 1, &StopFlag::new()).expect(FITS)
}

fn main() {
    let mut benchmarks = Benchmarks::from_env();
    let ties = TieBreaking::Random;
    let seed = SeedSequence::new(&[0]);
    let (mut environment, mut agent_rng) = (Pcg64::new(&seed), Pcg64::new(&seed.child(0)));
    benchmarks.add(GROUP, "draws: a reward, and whether to explore", || {
        black_box((0..STEPS).map(|_| environment.standard_normal() + agent_rng.random()).sum::<f64>());
        STEPS as u64
    });
    bench(&mut benchmarks, "ε-greedy", || {
        (AnyPolicy::EpsilonGreedy { epsilon: Schedule::constant(EPSILON), ties }, averages(), QLearning)
    });
    bench(&mut benchmarks, "upper confidence bounds", || {
        let ucb = Ucb::new(CONFIDENCE, ties, (1, ACTIONS), &StopFlag::new()).expect(FITS);
        (AnyPolicy::Ucb(ucb), averages(), QLearning)
    });
    benchmarks.add(GROUP, "draws and ten exponentials", || {
        let exponentials = |scale: f64| (0..ACTIONS).map(|action| (-scale * action as f64).exp()).sum::<f64>();
        let step = |_| environment.standard_normal() + exponentials(agent_rng.random());
        black_box((0..STEPS).map(step).sum::<f64>());
        STEPS as u64
    });
    bench(&mut benchmarks, "gradient bandit", || {
        let learning_rate = LearningRate::scheduled(Schedule::constant(0.1), 1);
        let rule = GradientBandit::new(true, 1, &StopFlag::new()).expect(FITS);
        (AnyPolicy::softmax(1.0, ACTIONS), learning_rate, rule)
    });
    benchmarks.finish();
}

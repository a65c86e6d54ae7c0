//! The time per step of bandit algorithms on the 10-armed testbed, and of the draws that a step cannot do without.
//!
//! `cargo bench --bench bandits`. "at run time" is a run whose policy and learning rate are chosen at run time.

mod benchmarks;

use std::hint::black_box;

use benchmarks::Benchmarks;
use qtab_core::learners::{Agent, GradientBandit, QLearning, TdLearner};
use qtab_core::policies::{AnyPolicy, Policy, SingleStateEpsilonGreedy, SingleStateUcb, TieBreaking, Ucb};
use qtab_core::q_table::TerminalUpdate;
use qtab_core::random::{Pcg64, Rng, SeedSequence};
use qtab_core::schedules::{LearningRate, Schedule, StepSize, VisitRate};
use qtab_core::tasks::{KArmedBandit, Testbed};
use qtab_core::{Budget, Learner, QTable, StopFlag, Trainer};

/// What the benchmarks store is small.
const FITS: &str = "it fits into memory";

const GROUP: &str = "10-armed testbed";
const STEPS: usize = 1000;
const ACTIONS: usize = 10;
const TESTBED: Testbed = Testbed { num_actions: ACTIONS, mean: 0.0, deviation: 1.0, random_walk: 0.0 };
const EPSILON: f64 = 0.1;
const CONFIDENCE: f64 = 2.0;

/// The generators of the environment and of the agent of a seed.
fn generators(seed: u32) -> [Pcg64; 2] {
    let seed = SeedSequence::new(&[seed]);
    [Pcg64::new(&seed), Pcg64::new(&seed.child(0))]
}

fn run<L: Learner<[u32; 1]>>(learner: L, seed: u32) -> f64 {
    let [environment, agent] = generators(seed);
    let mut trainer = Trainer::new(KArmedBandit::new(TESTBED, environment), learner, agent);
    trainer.advance(Budget { episodes: STEPS, work: u64::MAX }).expect("a bandit has no bounds to leave");
    trainer.episodes().returns.iter().sum()
}

/// Adds the benchmark of a learner on the problems of one seed after the other: with one problem, branches would be predicted too well.
fn bench<L: Learner<[u32; 1]>>(benchmarks: &mut Benchmarks, name: &str, learner: impl Fn() -> L) {
    let mut seed = 0;
    benchmarks.add(GROUP, name, || {
        seed += 1;
        black_box(run(learner(), seed));
        STEPS as u64
    });
}

fn agent<const N: usize, P: Policy, A: StepSize>(policy: P, learning_rate: A) -> Agent<N, P, A> {
    let table = QTable::new(vec![0.0; ACTIONS], ACTIONS);
    Agent { table, policy, learning_rate, discount: 1.0, terminal_update: TerminalUpdate::Target, masks: None }
}

fn ucb() -> Ucb {
    Ucb::new(CONFIDENCE, TieBreaking::Random, (1, ACTIONS), &StopFlag::new()).expect(FITS)
}

fn averages() -> VisitRate {
    VisitRate::new(1.0, 0.0, ACTIONS, &StopFlag::new()).expect(FITS)
}

fn averages_at_run_time() -> LearningRate {
    LearningRate::by_visit_count(1.0, 0.0, ACTIONS, 1, &StopFlag::new()).expect(FITS)
}

fn main() {
    let mut benchmarks = Benchmarks::from_env();
    let (rule, epsilon, ties) = (QLearning, Schedule::constant(EPSILON), TieBreaking::Random);
    let [mut environment, mut agent_rng] = generators(0);
    benchmarks.add(GROUP, "draws: a reward, and whether to explore", || {
        black_box((0..STEPS).map(|_| environment.standard_normal() + agent_rng.random()).sum::<f64>());
        STEPS as u64
    });
    bench(&mut benchmarks, "ε-greedy", || TdLearner {
        agent: agent::<ACTIONS, _, _>(SingleStateEpsilonGreedy::new(epsilon, ties), averages()),
        rule,
    });
    bench(&mut benchmarks, "ε-greedy, at run time", || {
        let policy = AnyPolicy::EpsilonGreedy { epsilon, ties };
        TdLearner { agent: agent::<0, _, _>(policy, averages_at_run_time()), rule }
    });
    bench(&mut benchmarks, "upper confidence bounds", || TdLearner {
        agent: agent::<ACTIONS, _, _>(SingleStateUcb::new(ucb()), averages()),
        rule,
    });
    bench(&mut benchmarks, "upper confidence bounds, at run time", || TdLearner {
        agent: agent::<0, _, _>(AnyPolicy::Ucb(ucb()), averages_at_run_time()),
        rule,
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
        TdLearner { agent: agent::<0, _, _>(AnyPolicy::softmax(1.0, ACTIONS), learning_rate), rule }
    });
    benchmarks.finish();
}

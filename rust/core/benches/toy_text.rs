//! The time per step of Q-learning on Gymnasium's tables.
//!
//! `cargo bench --bench toy_text`, or `cargo bench --bench toy_text -- FrozenLake` for one table only.

mod benchmarks;
mod runs;

use benchmarks::Benchmarks;
use qtab_core::envs::tabular::TabularMdp;
use qtab_core::envs::toy_text::{LakeRewards, TaxiMap, cliff_walking, frozen_lake, taxi_table};
use qtab_core::features::Identity;
use qtab_core::learners::{Agent, QLearning, TdLearner};
use qtab_core::policies::EpsilonGreedy;
use qtab_core::random::{Pcg64, SeedSequence};
use qtab_core::tasks::NativeTask;
use qtab_core::{Budget, Trainer};
use runs::{agent, train};

const LAKE_MAP: [&[u8]; 4] = [b"SFFF", b"FHFH", b"FFFH", b"HFFG"];
const TAXI_MAP: TaxiMap = [
    *b"+---------+",
    *b"|R: | : :G|",
    *b"| : | : : |",
    *b"| : : : : |",
    *b"| | : | : |",
    *b"|Y| : |B: |",
    *b"+---------+",
];

type Run<const N: usize> =
    Trainer<NativeTask<TabularMdp, Identity>, TdLearner<QLearning, Agent<N, EpsilonGreedy, f64>>, Pcg64>;

/// A table of `N` actions, its time limit, and the settings of the environment's default preset in the Python package.
struct Table<const N: usize> {
    name: &'static str,
    mdp: TabularMdp,
    max_episode_steps: u64,
    learning_rate: f64,
    discount: f64,
    epsilon: f64,
    episodes: usize,
}

impl<const N: usize> Table<N> {
    fn run(&self) -> Run<N> {
        let seed = SeedSequence::new(&[0]);
        let states = self.mdp.num_states();
        let policy = EpsilonGreedy::linear(self.epsilon, 0.0, self.episodes as u64);
        let agent = agent((states, N), 0.0, policy, self.learning_rate, self.discount);
        let features = Identity(states as u32);
        let task = NativeTask::new(self.mdp.clone(), features, Some(self.max_episode_steps), Pcg64::new(&seed));
        Trainer::new(task, TdLearner { agent, rule: QLearning }, Pcg64::new(&seed.child(0)))
    }

    fn add(&self, benchmarks: &mut Benchmarks) {
        let budget = Budget { episodes: self.episodes, work: u64::MAX };
        benchmarks.add(self.name, "Q-learning", || train(self.run(), budget));
    }
}

fn main() {
    let mut benchmarks = Benchmarks::from_env();
    let rewards = LakeRewards { goal: 1.0, hole: 0.0, frozen: 0.0 };
    let map = LAKE_MAP.map(<[u8]>::to_vec);
    let lake = frozen_lake(&map, Some(1.0 / 3.0), rewards).expect("a valid map");
    let cliff = cliff_walking(false).expect("a valid table");
    let taxi = taxi_table(&TAXI_MAP, None).expect("a valid map");
    let lake = Table::<4> {
        name: "FrozenLake",
        mdp: lake,
        max_episode_steps: 100,
        learning_rate: 0.05,
        discount: 0.99,
        epsilon: 1.0,
        episodes: 20_000,
    };
    let cliff = Table::<4> {
        name: "CliffWalking",
        mdp: cliff,
        max_episode_steps: u64::MAX,
        learning_rate: 0.5,
        discount: 1.0,
        epsilon: 0.1,
        episodes: 500,
    };
    let taxi = Table::<6> {
        name: "Taxi",
        mdp: taxi,
        max_episode_steps: 200,
        learning_rate: 0.5,
        discount: 0.99,
        epsilon: 0.1,
        episodes: 10_000,
    };
    lake.add(&mut benchmarks);
    cliff.add(&mut benchmarks);
    taxi.add(&mut benchmarks);
    benchmarks.finish();
}

//! The time per step of each learner on `MountainCar`, on a grid and on eight tilings.
//!
//! `cargo bench --bench learners`, or `cargo bench --bench learners -- tilings` for the tilings only. All learners use
//! a policy and a learning rate chosen at run time.

mod benchmarks;
mod mountain_car_task;
mod runs;

use std::fmt::Debug;

use benchmarks::Benchmarks;
use mountain_car_task::{MountainCarTask, rounding, task};
use qtab_core::batch::BatchRule;
use qtab_core::features::{Features, FixedTileCoding, FixedTiles, OutOfBounds, TileCoding};
use qtab_core::learners::{
    Agent, DoubleQLearning, DynaQ, DynaQPlus, ExpectedSarsa, Model, NStepSarsa, QLearning, Sarsa, SarsaLambda,
    TdLearner, TraceKind, Traces, TrueOnlineSarsaLambda, UpdateRule, WatkinsQLambda,
};
use qtab_core::policies::{AnyPolicy, EpsilonGreedy, TieBreaking};
use qtab_core::random::{Pcg64, SeedSequence};
use qtab_core::schedules::{LearningRate, Schedule};
use qtab_core::tasks::BoxedTask;
use qtab_core::{Budget, StopFlag, Task, Trainer};
use runs::{agent, train, train_batch};

/// The message for allocations, which are small here.
const FITS: &str = "small allocations succeed";

const EPISODES: usize = 100;
const BUDGET: Budget = Budget { episodes: EPISODES, work: u64::MAX };
const ACTIONS: usize = 3;
const TILINGS: usize = 8;
const TRACE_DECAY: f64 = 0.9;
const CUTOFF: f64 = 1e-3;

/// The settings of Sutton & Barto, section 10.1. Values of 0 are optimistic, so that ε can be 0.
fn optimistic_agent(rows: usize, n_active: usize) -> Agent {
    let policy = AnyPolicy::EpsilonGreedy { epsilon: Schedule::constant(0.0), ties: TieBreaking::First };
    agent((rows, ACTIONS), 0.0, policy, LearningRate::scheduled(Schedule::constant(0.3), n_active), 1.0)
}

/// The benchmarks of all learners with the same features.
struct Bench<'a, F> {
    benchmarks: &'a mut Benchmarks,
    group: &'static str,
    features: F,
    n_active: usize,
}

impl<F> Bench<'_, F>
where
    F: Features<[f32; 2]> + Clone,
    MountainCarTask<F>: Task<Active = F::Active, Error: Debug>,
{
    /// Benchmarks a learner given by its update rule.
    fn rule<U: UpdateRule<F::Active, Agent>>(&mut self, name: &str, rule: impl Fn(&Agent) -> U) {
        let (features, n_active) = (&self.features, self.n_active);
        let run = || {
            let agent = optimistic_agent(features.len(), n_active);
            let learner = TdLearner { rule: rule(&agent), agent };
            train(Trainer::new(task(features.clone()), learner, mountain_car_task::agent_rng()), BUDGET)
        };
        self.benchmarks.add(self.group, name, run);
    }

    /// Benchmarks all learners that work with any features.
    fn all(&mut self) {
        let traces =
            |agent: &Agent, cutoff| Traces::new(agent.table.values().len(), cutoff, &StopFlag::new()).expect(FITS);
        let (kind, trace_decay) = (TraceKind::Replacing, TRACE_DECAY);
        self.rule("Q-learning", |_| QLearning);
        self.rule("Sarsa", |_| Sarsa);
        self.rule("Expected Sarsa", |_| ExpectedSarsa);
        self.rule("Double Q-learning", |agent| DoubleQLearning::new(agent.learning_rate.clone(), agent.table.clone()));
        self.rule("4-step Sarsa", |_| NStepSarsa::new(4));
        self.rule("Sarsa(0.9)", |agent| SarsaLambda { traces: traces(agent, 0.0), kind, trace_decay });
        self.rule("Sarsa(0.9), cut off", |agent| SarsaLambda { traces: traces(agent, CUTOFF), kind, trace_decay });
        self.rule("true online Sarsa(0.9)", |agent| TrueOnlineSarsaLambda::new(traces(agent, 0.0), trace_decay));
        self.rule("Watkins's Q(0.9)", |agent| WatkinsQLambda { traces: traces(agent, 0.0), kind, trace_decay });
    }
}

fn grid(benchmarks: &mut Benchmarks) {
    let mut grid = Bench { benchmarks, group: "grid", features: rounding(), n_active: 1 };
    grid.all();
    let model =
        |agent: &Agent| Model::new(agent.table.values().len() / ACTIONS, ACTIONS, &StopFlag::new()).expect(FITS);
    grid.rule("Dyna-Q, 10 steps planned", |agent| DynaQ::new(model(agent), 10));
    grid.rule("Dyna-Q+, 10 steps planned", |agent| {
        DynaQPlus::new(model(agent), 10, 1e-3, &StopFlag::new()).expect(FITS)
    });
}

/// `N` tilings of the car's box.
fn tile_coding<const N: usize>() -> FixedTileCoding<f32, 2, N> {
    let bounds = [[-1.2_f32, -0.07], [0.6, 0.07]].map(|bound| bound.map(f64::from));
    let tiles = TileCoding::<f32, N>::new(&bounds[0], &bounds[1], &[8, 8], N as u32);
    FixedTileCoding::new(&tiles).expect("the numbers of tilings and components match")
}

fn tilings(benchmarks: &mut Benchmarks) {
    let mut tilings = Bench { benchmarks, group: "tilings", features: tile_coding::<TILINGS>(), n_active: TILINGS };
    tilings.all();
    boxed_tilings::<TILINGS>(benchmarks, "8 tilings, boxed");
    compiled_tilings(benchmarks, "Q-learning", &QLearning);
    compiled_tilings(benchmarks, "Sarsa", &Sarsa);
    boxed_tilings::<16>(benchmarks, "16 tilings, boxed");
    boxed_tilings::<32>(benchmarks, "32 tilings, boxed");
}

/// Benchmarks a learner compiled for its policy and its learning rate: a single run, and a batch of runs on one core.
fn compiled_tilings<U>(benchmarks: &mut Benchmarks, name: &str, rule: &U)
where
    U: UpdateRule<FixedTiles<TILINGS>, Agent<ACTIONS, EpsilonGreedy, f64>> + BatchRule + Clone,
{
    let run = |seed| {
        let features = tile_coding::<TILINGS>();
        let shape = (Features::<[f32; 2]>::len(&features), ACTIONS);
        let policy = EpsilonGreedy::linear(0.1, 0.0, EPISODES as u64);
        let agent = agent(shape, 0.0, policy, 0.3 / TILINGS as f64, 1.0);
        let rng = Pcg64::new(&SeedSequence::new(&[seed]).child(0));
        Trainer::new(task(features), TdLearner { agent, rule: rule.clone() }, rng)
    };
    let group = "8 tilings, compiled for the policy";
    benchmarks.add(group, name, || train(run(0), BUDGET));
    benchmarks.add(group, &format!("{name}, a batch of 8 on one core"), || train_batch(run, BUDGET));
}

/// Benchmarks learners on a boxed task, as the Python package runs them.
fn boxed_tilings<const N: usize>(benchmarks: &mut Benchmarks, group: &'static str) {
    type Boxed<const N: usize> = BoxedTask<<FixedTileCoding<f32, 2, N> as Features<[f32; 2]>>::Active, OutOfBounds>;
    let features = tile_coding::<N>();
    let mut add = |name, cutoff: Option<f64>| {
        let run = || {
            let agent = optimistic_agent(Features::<[f32; 2]>::len(&features), N);
            let boxed: Boxed<N> = BoxedTask::new(task(features.clone()));
            let rng = mountain_car_task::agent_rng();
            if let Some(cutoff) = cutoff {
                let traces = Traces::new(agent.table.values().len(), cutoff, &StopFlag::new()).expect(FITS);
                let rule = SarsaLambda { traces, kind: TraceKind::Replacing, trace_decay: TRACE_DECAY };
                train(Trainer::new(boxed, TdLearner { agent, rule }, rng), BUDGET)
            } else {
                train(Trainer::new(boxed, TdLearner { agent, rule: QLearning }, rng), BUDGET)
            }
        };
        benchmarks.add(group, name, run);
    };
    add("Q-learning", None);
    add("Sarsa(0.9)", Some(0.0));
    add("Sarsa(0.9), cut off", Some(CUTOFF));
}

fn main() {
    let mut benchmarks = Benchmarks::from_env();
    grid(&mut benchmarks);
    tilings(&mut benchmarks);
    benchmarks.finish();
}

//! The time per step of learners on `MountainCar` with a Fourier basis.
//!
//! `cargo bench --bench weighted`. The steps of `cargo bench --bench learners -- boxed` are those of tile coding. The programs
//! are separate, so that neither changes what the compiler inlines into the other.

mod benchmarks;
mod mountain_car_task;
mod runs;

use benchmarks::Benchmarks;
use mountain_car_task::{agent_rng, task};
use qtab_core::features::{FeatureVector, FourierBasis, OutOfBounds};
use qtab_core::learners::{
    Agent, QLearning, Sarsa, SarsaLambda, TdLearner, TraceKind, Traces, TrueOnlineSarsaLambda, UpdateRule,
};
use qtab_core::policies::{AnyPolicy, TieBreaking};
use qtab_core::schedules::{LearningRate, Schedule};
use qtab_core::tasks::BoxedTask;
use qtab_core::{Budget, StopFlag, Trainer};
use runs::{agent, train};

const BUDGET: Budget = Budget { episodes: 100, work: u64::MAX };
const ACTIONS: usize = 3;
const TRACE_DECAY: f64 = 0.9;
/// The capacity of the features.
const ROOM: usize = 64;

/// Benchmarks a learner with the coupled Fourier basis of order 5, 36 features, on a boxed task, as the Python package runs
/// it. Weights of 0 are optimistic, so that ε can be 0.
fn rule<U: UpdateRule<FeatureVector<ROOM>, Agent>>(
    benchmarks: &mut Benchmarks,
    name: &str,
    rule: impl Fn(&Agent) -> U,
) {
    let basis = FourierBasis::<f32, ROOM>::try_new(&[-1.2, -0.07], &[0.6, 0.07], 5, true, true).expect("36 features");
    let run = || {
        let policy = AnyPolicy::EpsilonGreedy { epsilon: Schedule::constant(0.0), ties: TieBreaking::First };
        let learning_rate = LearningRate::scaled_by_row(Schedule::constant(0.005), basis.divisors());
        let agent: Agent = agent((basis.n_features(), ACTIONS), 0.0, policy, learning_rate, 1.0);
        let boxed: BoxedTask<FeatureVector<ROOM>, OutOfBounds> = BoxedTask::new(task(basis.clone()));
        train(Trainer::new(boxed, TdLearner { rule: rule(&agent), agent }, agent_rng()), BUDGET)
    };
    benchmarks.add("36 Fourier features, boxed", name, run);
}

fn main() {
    let mut benchmarks = Benchmarks::from_env();
    let traces = |agent: &Agent| {
        Traces::new(agent.table.values().len(), 0.0, &StopFlag::new()).expect("small allocations succeed")
    };
    rule(&mut benchmarks, "Q-learning", |_| QLearning);
    rule(&mut benchmarks, "Sarsa", |_| Sarsa);
    rule(&mut benchmarks, "Sarsa(0.9)", |agent| SarsaLambda {
        traces: traces(agent),
        kind: TraceKind::Accumulating,
        trace_decay: TRACE_DECAY,
    });
    rule(&mut benchmarks, "true online Sarsa(0.9)", |agent| TrueOnlineSarsaLambda::new(traces(agent), TRACE_DECAY));
    benchmarks.finish();
}

//! The time per step of prediction compared with that of Q-learning with random actions, in the same environments.
//!
//! `cargo bench --bench prediction`. "boxed" is a run whose task and method are chosen at run time.

mod benchmarks;
mod runs;

use std::fmt::Debug;

use benchmarks::Benchmarks;
use qtab_core::envs::tabular::{Outcome, TabularMdp};
use qtab_core::features::{Identity, OutOfBounds};
use qtab_core::learners::{Agent, QLearning, TdLearner, TransformedSteps};
use qtab_core::policies::{AnyPolicy, TieBreaking};
use qtab_core::prediction::{
    FixedPolicy, LinearValues, OfflineLambdaReturn, PredictionRule, Predictor, StateFeatures, TdLambda, TdZero,
};
use qtab_core::random::{AgentRng, Pcg64, Rng, SeedSequence};
use qtab_core::schedules::{LearningRate, Schedule};
use qtab_core::tasks::{BoxedTask, NativeTask};
use qtab_core::{Budget, Env, Learner, Task, Trainer};
use runs::{agent, train};

const EPISODES: usize = 100;
const MAX_EPISODE_STEPS: u64 = 10_000;
/// The number of steps for which methods that look back reserve memory.
const MOST_STEPS: u64 = EPISODES as u64 * MAX_EPISODE_STEPS;
const LEARNING_RATE: f64 = 0.1;

/// A method that is chosen at run time.
type Method = dyn PredictionRule + Send;

/// A table given by the step from each state and action. Episodes end in the terminal states.
fn table(states: i64, start: usize, terminal: &[i64], actions: usize, step: impl Fn(i64, usize) -> i64) -> TabularMdp {
    let row = |pair: usize| {
        let (state, action) = ((pair / actions).cast_signed() as i64, pair % actions);
        let next = if terminal.contains(&state) { state } else { step(state, action) };
        vec![Outcome { probability: 1.0, state: next, reward: -1.0, terminated: terminal.contains(&next) }]
    };
    let rows: Vec<_> = (0..states as usize * actions).map(row).collect();
    let mut initial = vec![0.0; states as usize];
    initial[start] = 1.0;
    TabularMdp::new(actions, &initial, &rows).expect("a valid table")
}

/// The 19-state random walk, with a terminal state at each end.
fn random_walk() -> TabularMdp {
    table(21, 10, &[0, 20], 2, |state, action| if action == 0 { state - 1 } else { state + 1 })
}

/// A grid world of 10 by 10 cells, from one corner to the opposite one.
fn grid_world() -> TabularMdp {
    table(100, 0, &[99], 4, |state, action| {
        let (row, column) = (state / 10, state % 10);
        let (row, column) = match action {
            0 => (row - 1, column),
            1 => (row, column + 1),
            2 => (row + 1, column),
            _ => (row, column - 1),
        };
        10 * row.clamp(0, 9) + column.clamp(0, 9)
    })
}

/// A random policy in an environment.
struct Problem {
    env: TabularMdp,
}

impl Problem {
    fn task(&self) -> NativeTask<TabularMdp, Identity> {
        let features = Identity(self.env.num_states() as u32);
        NativeTask::new(self.env.clone(), features, Some(MAX_EPISODE_STEPS), Pcg64::new(&SeedSequence::new(&[0])))
    }

    fn boxed(&self) -> BoxedTask<[u32; 1], OutOfBounds> {
        BoxedTask::new(self.task())
    }

    fn predictor<U: ?Sized>(&self, rule: Box<U>) -> Predictor<U> {
        let (states, actions) = (self.env.num_states(), self.env.num_actions());
        let rows = (0..states as u32).collect();
        let rows = StateFeatures::of_states(rows, 1, states).expect("a row for each state");
        let learning_rate = LearningRate::scheduled(Schedule::constant(LEARNING_RATE), 1);
        let values = LinearValues::new(vec![0.0; states], rows, learning_rate, 1.0);
        Predictor::new(values, FixedPolicy::new(vec![1.0 / actions as f64; states * actions].into(), actions), rule)
    }

    /// Random actions, so that the episodes are those of the random policy.
    fn q_learning<const N: usize, A>(&self, learning_rate: A) -> TdLearner<QLearning, Agent<N, AnyPolicy, A>> {
        let actions = self.env.num_actions();
        let policy = AnyPolicy::EpsilonGreedy { epsilon: Schedule::constant(1.0), ties: TieBreaking::First };
        let agent = agent((self.env.num_states(), actions), 0.0, policy, learning_rate, 1.0);
        TdLearner { agent, rule: QLearning }
    }
}

/// Adds the benchmark of a run.
fn bench<T, L, R>(benchmarks: &mut Benchmarks, group: &str, name: &str, parts: impl Fn() -> (T, L, R))
where
    T: Task<Error: Debug>,
    L: Learner<T::Active>,
    R: Rng + Clone,
{
    let run = || {
        let (task, learner, rng) = parts();
        train(Trainer::new(task, learner, rng), Budget { episodes: EPISODES, work: MOST_STEPS })
    };
    benchmarks.add(group, name, run);
}

/// Benchmarks all runs in one environment with `N` actions.
fn compare<const N: usize>(benchmarks: &mut Benchmarks, group: &str, env: TabularMdp) {
    let problem = Problem { env };
    let seed = SeedSequence::new(&[0]);
    let (rng, any_rng) = (Pcg64::new(&seed.child(0)), AgentRng::pcg64(&seed));
    let scheduled = || LearningRate::scheduled(Schedule::constant(LEARNING_RATE), 1);
    bench(benchmarks, group, "Q-learning", || (problem.task(), problem.q_learning::<N, _>(LEARNING_RATE), rng.clone()));
    bench(benchmarks, group, "TD(0)", || (problem.task(), problem.predictor(Box::new(TdZero)), rng.clone()));
    bench(benchmarks, group, "TD(0.8)", || {
        let rule: Box<Method> = Box::new(TdLambda::new(0.8, problem.env.num_states()));
        (problem.task(), problem.predictor(rule), rng.clone())
    });
    bench(benchmarks, group, "Monte Carlo", || {
        let rule: Box<Method> = Box::new(OfflineLambdaReturn::monte_carlo(false, problem.env.num_states()));
        (problem.task(), problem.predictor(rule), rng.clone())
    });
    bench(benchmarks, group, "Q-learning, boxed", || {
        let learner = problem.q_learning::<0, _>(scheduled());
        (problem.boxed(), TransformedSteps { learner, terminate: false, bonus: None }, any_rng.clone())
    });
    bench(benchmarks, group, "TD(0), boxed", || {
        let rule: Box<Method> = Box::new(TdZero);
        let learner = problem.predictor(rule);
        (problem.boxed(), TransformedSteps { learner, terminate: false, bonus: None }, any_rng.clone())
    });
}

fn main() {
    let mut benchmarks = Benchmarks::from_env();
    compare::<2>(&mut benchmarks, "random walk of 19 states", random_walk());
    compare::<4>(&mut benchmarks, "grid world of 10 x 10 cells", grid_world());
    benchmarks.finish();
}

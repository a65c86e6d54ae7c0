//! One-step learners on the cells of any task, compiled for the task: without a boxed task and learner, a step takes two
//! thirds of the time.

use pyo3::prelude::*;
use qtab_core::learners::{Agent, AnyAlgorithm, ExpectedSarsa, QLearning, Sarsa, TdLearner, UpdateRule};
use qtab_core::policies::EpsilonGreedy;
use qtab_core::schedules::Schedule;
use qtab_core::{StopFlag, Task, Trainer};

use super::factory::factory;
use super::path::{PlainSpec, RunPath};
use super::specialized::plain_epsilon_greedy;
use super::{Run, RunFactory};
use crate::convert::Seed;
use crate::error::RunError;
use crate::rng::agent_pcg64;
use crate::spec::{LearningRateSpec, RunSpec};

/// A learner with `N` actions, or with any number if `N` is 0.
type OneStepLearner<U, const N: usize> = TdLearner<U, Agent<N, EpsilonGreedy, Schedule>>;

/// Runs of Q-learning, Sarsa or Expected Sarsa with ε-greedy exploration; `None` if the spec asks for something else.
/// `n_rows` is the number of cells.
///
/// Q-learning with 2 to 4 actions is compiled for their number: on a mountain car in C, a step takes 360 instructions
/// instead of 411.
pub(crate) fn one_step_runs<W, B>(new_task: B, n_rows: usize, spec: &RunSpec) -> Option<Box<dyn RunFactory>>
where
    W: Task<Active = [u32; 1], State: Send> + Send + 'static,
    RunError: From<W::Error>,
    B: Fn(&Seed) -> PyResult<W> + Send + Sync + 'static,
{
    let RunPath::Plain(plain) = RunPath::of(spec) else { return None };
    match plain.algorithm {
        AnyAlgorithm::QLearning => match plain.num_actions {
            2 => with_rule::<_, _, _, 2>(QLearning, new_task, n_rows, plain),
            3 => with_rule::<_, _, _, 3>(QLearning, new_task, n_rows, plain),
            4 => with_rule::<_, _, _, 4>(QLearning, new_task, n_rows, plain),
            _ => with_rule::<_, _, _, 0>(QLearning, new_task, n_rows, plain),
        },
        AnyAlgorithm::Sarsa => with_rule::<_, _, _, 0>(Sarsa, new_task, n_rows, plain),
        AnyAlgorithm::ExpectedSarsa => with_rule::<_, _, _, 0>(ExpectedSarsa, new_task, n_rows, plain),
        _ => None,
    }
}

fn with_rule<U, W, B, const N: usize>(
    rule: U,
    new_task: B,
    n_rows: usize,
    spec: PlainSpec,
) -> Option<Box<dyn RunFactory>>
where
    U: UpdateRule<[u32; 1], Agent<N, EpsilonGreedy, Schedule>> + Clone + Send + Sync + 'static,
    W: Task<Active = [u32; 1], State: Send> + Send + 'static,
    RunError: From<W::Error>,
    B: Fn(&Seed) -> PyResult<W> + Send + Sync + 'static,
    Trainer<W, OneStepLearner<U, N>, qtab_core::random::Pcg64>: Run,
{
    let policy = plain_epsilon_greedy(&spec)?;
    let PlainSpec {
        num_actions,
        // The task was made with it.
        max_episode_steps: _,
        // The rule is that of the algorithm.
        algorithm: _,
        // As above.
        policy: _,
        learning_rate: LearningRateSpec::Schedule(learning_rate),
        discount,
        initial_q,
        terminal_update,
        terminate_on_truncation: false,
        episodes,
        count_visits: false,
    } = spec
    else {
        return None;
    };
    let learning_rate = learning_rate.build(episodes);
    let build = move |seed: &Seed, stop: &StopFlag<'_>| {
        let task = new_task(seed)?;
        let mut rng = agent_pcg64(seed);
        let agent = Agent {
            table: initial_q.table((0, 1), (n_rows, num_actions), &mut rng, stop)?,
            policy,
            learning_rate,
            discount,
            terminal_update,
            masks: None,
        };
        Ok(Trainer::new(task, TdLearner { agent, rule: rule.clone() }, rng))
    };
    Some(factory(build, None))
}

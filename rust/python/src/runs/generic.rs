//! Runs of any learner on any task, boxed: what is not worth compiling for its types.

use std::sync::Arc;

use pyo3::prelude::*;
use qtab_core::features::{ActiveRows, FixedTileCoding, MAX_TILINGS};
use qtab_core::learners::{
    Agent, DifferentialQLearning, DifferentialSarsa, DoubleQLearning, DynaQ, DynaQPlus, ExpectedSarsa, Model,
    MonteCarlo, MonteCarloEs, NStepQSigma, NStepSarsa, NStepTreeBackup, OffPolicyMonteCarlo, PrioritizedSweeping,
    QLearning, Sarsa, SarsaLambda, StochasticModel, TdLearner, Traces, TrueOnlineSarsaLambda, TruncationHandling,
    UpdateRule, WatkinsQLambda,
};
use qtab_core::random::AgentRng;
use qtab_core::tasks::{BoxedTask, EpisodeRecorder, NativeTask, Recordings, RngSnapshot, VisitCounter};
use qtab_core::{Env, Features, Learner, StopFlag, Task, Trainer, TrainingError};

use super::agent::generic_agent;
use super::factory::{Batching, Factory};
use super::{AnyRecordings, Run, RunFactory};
use crate::convert::Seed;
use crate::error::{RunError, allocation, invalid};
use crate::rng::environment_rng;
use crate::spec::{AlgorithmSpec, DiscretizerSpec, LearningRateSpec, RunSpec, TilesSpec, TraceSpec};

/// Runs in an environment whose observations are `M` float32 numbers, with any discretizer of a Box.
pub(crate) fn generic_box<E, const M: usize>(
    env: E,
    spec: &Arc<RunSpec>,
    record: usize,
) -> PyResult<Box<dyn RunFactory>>
where
    E: Env<Action = usize, Observation = [f32; M], State: Send> + Clone + Send + Sync + 'static,
{
    let (_, dimensions) = spec.discretizer.box_space()?;
    if dimensions != M {
        return Err(invalid("discretizer", format!("one for observations of {M} components"), dimensions));
    }
    match &spec.discretizer {
        // Compiled for the usual numbers of tilings, but not once more for what is rarely asked for besides.
        DiscretizerSpec::Tiles(tiles) if record == 0 && !spec.count_visits => match tiles.tilings {
            8 => fixed_tilings::<E, M, 8>(env, tiles, spec),
            16 => fixed_tilings::<E, M, 16>(env, tiles, spec),
            32 => fixed_tilings::<E, M, 32>(env, tiles, spec),
            _ => generic(env, tiles.tile_coding::<f32, MAX_TILINGS>(), spec, record),
        },
        DiscretizerSpec::Tiles(tiles) => generic(env, tiles.tile_coding::<f32, MAX_TILINGS>(), spec, record),
        grid => generic(env, grid.grid(|bound| bound as f32)?, spec, record),
    }
}

/// Runs with exactly `N` tilings, without recordings and visit counts.
fn fixed_tilings<E, const M: usize, const N: usize>(
    env: E,
    tiles: &TilesSpec,
    spec: &Arc<RunSpec>,
) -> PyResult<Box<dyn RunFactory>>
where
    E: Env<Action = usize, Observation = [f32; M], State: Send> + Clone + Send + Sync + 'static,
{
    let Some(features) = FixedTileCoding::<f32, M, N>::new(&tiles.tile_coding()) else {
        return Err(invalid("discretizer", format!("{N} tilings of {M} components"), "others"));
    };
    check_actions(&env, spec)?;
    let (spec, shape) = (Arc::clone(spec), (features.len(), N));
    let build = move |seed: &Seed, stop: &StopFlag<'_>| {
        let task = NativeTask::new(env.clone(), features.clone(), Some(spec.max_episode_steps), environment_rng(seed));
        let rng = spec.bit_generator.agent_rng(seed)?;
        Ok((build_learner(BoxedTask::new(task), shape, rng, &spec, stop)?, AnyRecordings::None))
    };
    Ok(Box::new(Factory { build, batching: Batching::one_by_one() }))
}

/// Refuses a spec for another number of actions.
fn check_actions(env: &impl Env, spec: &RunSpec) -> PyResult<()> {
    if spec.num_actions == env.num_actions() {
        return Ok(());
    }
    Err(invalid("num_actions", format!("{}, the environment's", env.num_actions()), spec.num_actions))
}

/// Runs in an environment with any features.
pub(crate) fn generic<E, F>(env: E, features: F, spec: &Arc<RunSpec>, record: usize) -> PyResult<Box<dyn RunFactory>>
where
    E: Env<Action = usize, State: Send> + Clone + Send + Sync + 'static,
    F: Features<E::Observation, Active: Send> + Clone + Send + Sync + 'static,
{
    check_actions(&env, spec)?;
    let (spec, shape) = (Arc::clone(spec), (features.len(), spec.discretizer.n_active()));
    let build = move |seed: &Seed, stop: &StopFlag<'_>| {
        let task = NativeTask::new(env.clone(), features.clone(), Some(spec.max_episode_steps), environment_rng(seed));
        boxed_run(task, shape, seed, &spec, (record, stop), AnyRecordings::Native)
    };
    Ok(Box::new(Factory { build, batching: Batching::one_by_one() }))
}

/// A run of any learner, with recordings if asked for. `shape` is the number of rows and of active rows.
pub(super) fn boxed_run<W>(
    task: W,
    shape: (usize, usize),
    seed: &Seed,
    spec: &RunSpec,
    (record, stop): (usize, &StopFlag<'_>),
    keep: impl FnOnce(Recordings<W::Snapshot>) -> AnyRecordings,
) -> PyResult<(Box<dyn Run>, AnyRecordings)>
where
    W: RngSnapshot + Task<Active: Send, State: Send> + Send + 'static,
    W::Snapshot: Send,
    RunError: From<W::Error> + From<TrainingError<W::Error>>,
{
    let (task, recordings) = if record == 0 {
        (boxed_task(task, shape, spec, stop)?, AnyRecordings::None)
    } else {
        let (task, recordings) = EpisodeRecorder::new(task, record, spec.max_recorded_actions);
        (boxed_task(task, shape, spec, stop)?, keep(recordings))
    };
    let rng = spec.bit_generator.agent_rng(seed)?;
    Ok((build_learner(task, shape, rng, spec, stop)?, recordings))
}

/// A boxed task, which counts visits if the spec asks for it.
fn boxed_task<W>(
    task: W,
    (n_rows, _): (usize, usize),
    spec: &RunSpec,
    stop: &StopFlag<'_>,
) -> PyResult<BoxedTask<W::Active, RunError>>
where
    W: Task<Active: Send, State: Send> + Send + 'static,
    RunError: From<W::Error>,
{
    if spec.count_visits {
        let counter = VisitCounter::new(task, n_rows, spec.num_actions, stop).map_err(allocation)?;
        Ok(BoxedTask::new(counter))
    } else {
        Ok(BoxedTask::new(task))
    }
}

/// Any learner on a boxed task, with a generator chosen at run time: compiled once for each kind of active rows.
fn build_learner<R>(
    task: BoxedTask<R, RunError>,
    (n_rows, n_active): (usize, usize),
    mut rng: AgentRng,
    spec: &RunSpec,
    stop: &StopFlag<'_>,
) -> PyResult<Box<dyn Run>>
where
    R: ActiveRows + Send + 'static,
{
    let agent = generic_agent(spec, n_rows, n_active, &mut rng, stop)?;
    let weights = agent.table.values().len();
    let new_model = || Model::new(n_rows, spec.num_actions, stop).map_err(allocation);
    let new_traces = |cutoff: f64| Traces::new(weights, cutoff, stop).map_err(allocation);
    let limit = spec.max_episode_steps;
    // Known when this is compiled, so that what needs a table is left out of the code for several rows.
    let single_row = size_of::<R>() == size_of::<u32>();
    Ok(match spec.algorithm {
        algorithm if !single_row && algorithm.needs_table() => {
            return Err(invalid("discretizer", "one with one active row, for an algorithm for tables", "'tiles'"));
        }
        AlgorithmSpec::QLearning => with_rule(task, agent, QLearning, rng, spec),
        AlgorithmSpec::Sarsa => with_rule(task, agent, Sarsa, rng, spec),
        AlgorithmSpec::ExpectedSarsa => with_rule(task, agent, ExpectedSarsa, rng, spec),
        AlgorithmSpec::DoubleQLearning => {
            let second = spec.initial_q.table((1, 2), (n_rows, spec.num_actions), &mut rng, stop)?;
            into_run(task, DoubleQLearning::new(agent, second), rng, spec)
        }
        AlgorithmSpec::NStepSarsa { n_steps } => with_rule(task, agent, NStepSarsa::new(n_steps), rng, spec),
        AlgorithmSpec::SarsaLambda(TraceSpec { kind, decay, cutoff }) => {
            with_rule(task, agent, SarsaLambda { traces: new_traces(cutoff)?, kind, trace_decay: decay }, rng, spec)
        }
        AlgorithmSpec::TrueOnlineSarsaLambda { trace_decay, trace_cutoff } => {
            with_rule(task, agent, TrueOnlineSarsaLambda::new(new_traces(trace_cutoff)?, trace_decay), rng, spec)
        }
        AlgorithmSpec::WatkinsQLambda(TraceSpec { kind, decay, cutoff }) => {
            with_rule(task, agent, WatkinsQLambda { traces: new_traces(cutoff)?, kind, trace_decay: decay }, rng, spec)
        }
        AlgorithmSpec::DynaQ { planning_steps, stochastic: false } => {
            with_rule(task, agent, DynaQ::new(new_model()?, planning_steps), rng, spec)
        }
        AlgorithmSpec::DynaQ { planning_steps, stochastic: true } => {
            let model = StochasticModel::new(n_rows, spec.num_actions, stop).map_err(allocation)?;
            with_rule(task, agent, DynaQ::new(model, planning_steps), rng, spec)
        }
        AlgorithmSpec::DynaQPlus { planning_steps, time_weight } => {
            let rule = DynaQPlus::new(new_model()?, planning_steps, time_weight, stop).map_err(allocation)?;
            with_rule(task, agent, rule, rng, spec)
        }
        AlgorithmSpec::MonteCarlo => {
            with_rule(task, agent, MonteCarlo::new(weights, limit, stop).map_err(allocation)?, rng, spec)
        }
        AlgorithmSpec::MonteCarloEs => {
            with_rule(task, agent, MonteCarloEs::new(weights, limit, stop).map_err(allocation)?, rng, spec)
        }
        AlgorithmSpec::OffPolicyMonteCarlo => {
            let LearningRateSpec::Visits { value, minimum } = spec.learning_rate else {
                return Err(invalid("learning_rate", "'visits' for off-policy Monte Carlo", "a schedule"));
            };
            let rule = OffPolicyMonteCarlo::new(weights, limit, (value, minimum), stop).map_err(allocation)?;
            with_rule(task, agent, rule, rng, spec)
        }
        AlgorithmSpec::NStepTreeBackup { n_steps, target_policy } => {
            with_rule(task, agent, NStepTreeBackup::new(n_steps, target_policy), rng, spec)
        }
        AlgorithmSpec::NStepQSigma { n_steps, sigma, target_policy } => {
            with_rule(task, agent, NStepQSigma::new(n_steps, sigma, target_policy), rng, spec)
        }
        AlgorithmSpec::PrioritizedSweeping { planning_steps, priority_threshold } => {
            let rule = PrioritizedSweeping::new(new_model()?, planning_steps, priority_threshold, stop);
            with_rule(task, agent, rule.map_err(allocation)?, rng, spec)
        }
        AlgorithmSpec::DifferentialSarsa { reward_learning_rate } => {
            with_rule(task, agent, DifferentialSarsa::new(reward_learning_rate), rng, spec)
        }
        AlgorithmSpec::DifferentialQLearning { reward_learning_rate } => {
            with_rule(task, agent, DifferentialQLearning::new(reward_learning_rate), rng, spec)
        }
    })
}

fn with_rule<R, U>(task: BoxedTask<R, RunError>, agent: Agent, rule: U, rng: AgentRng, spec: &RunSpec) -> Box<dyn Run>
where
    R: ActiveRows + Send + 'static,
    U: UpdateRule<R, Agent> + Send + 'static,
{
    into_run(task, TdLearner { agent, rule }, rng, spec)
}

fn into_run<R, L>(task: BoxedTask<R, RunError>, learner: L, rng: AgentRng, spec: &RunSpec) -> Box<dyn Run>
where
    R: ActiveRows + Send + 'static,
    L: Learner<R> + Send + 'static,
{
    let learner = TruncationHandling { learner, terminate: spec.terminate_on_truncation };
    Box::new(Trainer::new(task, learner, rng))
}

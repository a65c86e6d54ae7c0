//! The choice of a learner, on a world that was chosen before: the hot combinations whole, every other one boxed.

use pyo3::prelude::*;
use qtab_core::learners;
use qtab_core::learners::{
    Agent, DoubleQLearning, DynaQ, DynaQPlus, ExpectedSarsa, NStepSarsa, QLearning, Sarsa, SarsaLambda, TdLearner,
    TrueOnlineSarsaLambda, TruncationHandling, UpdateRule, WatkinsQLambda,
};
use qtab_core::policies::Policy;
use qtab_core::random::{AgentRng, Pcg64};
use qtab_core::schedules::Schedule;
use qtab_core::tasks::{BoxedTask, EpisodeRecorder, Recordings, RngSnapshot};
use qtab_core::{Learner, Task, Trainer};

use crate::failure::Failure;
use crate::plan::{Plan, given, unknown};
use crate::run::Run;

/// The last episodes of a run, where it was asked to keep them.
pub(crate) enum Kept {
    Nothing,
    Native(Recordings<(u64, Option<u32>)>),
    Python(Recordings<Py<PyAny>>),
}

/// A run that has not begun.
pub(crate) struct Built {
    pub(crate) run: Box<dyn Run>,
    pub(crate) kept: Kept,
    /// Whether it steps Python, and so stays on the calling thread, attached.
    pub(crate) attached: bool,
}

/// The combinations that are compiled whole: a table of so many actions, learned as in the article, or by its next of
/// kin.
pub(crate) fn whole<W, P, const N: usize>(
    world: W,
    agent: Agent<N, P, Schedule>,
    draw: Pcg64,
    plan: &Plan<'_>,
) -> Box<dyn Run>
where
    W: Task<Active = [u32; 1], State: Send, Error: Into<Failure>> + Send + 'static,
    P: Policy + Send + 'static,
{
    match plan.algorithm.name.as_str() {
        "sarsa" => Box::new(Trainer::new(world, TdLearner { agent, rule: Sarsa }, draw)),
        "expected_sarsa" => Box::new(Trainer::new(world, TdLearner { agent, rule: ExpectedSarsa }, draw)),
        _ if plan.learning_rate.is_constant() => {
            // The article's type, which is batched.
            let Agent { table, policy, learning_rate, discount, terminal_update } = agent;
            let agent = Agent { table, policy, learning_rate: learning_rate.value(), discount, terminal_update };
            Box::new(Trainer::new(world, TdLearner { agent, rule: QLearning }, draw))
        }
        _ => Box::new(Trainer::new(world, TdLearner { agent, rule: QLearning }, draw)),
    }
}

/// A run of any learner, recorded where that was asked for.
pub(crate) fn boxed<W>(
    world: W,
    rows: usize,
    lit: usize,
    draw: AgentRng,
    plan: &Plan<'_>,
    kept: impl FnOnce(Recordings<W::Snapshot>) -> Kept,
    attached: bool,
) -> PyResult<Built>
where
    W: RngSnapshot + Task<Active: Send, State: Send, Error: Into<Failure>> + Send + 'static,
    W::Snapshot: Send,
    Failure: From<W::Error>,
{
    let (world, kept) = if plan.record == 0 {
        (BoxedTask::<W::Active, Failure>::new(world), Kept::Nothing)
    } else {
        let (world, recordings) = EpisodeRecorder::new(world, plan.record);
        (BoxedTask::new(world), kept(recordings))
    };
    Ok(Built { run: learning(world, rows, lit, draw, plan)?, kept, attached })
}

/// Any learner in a boxed world, with a stream chosen at run time: compiled once for each kind of rows.
fn learning<R>(
    world: BoxedTask<R, Failure>,
    rows: usize,
    lit: usize,
    mut draw: AgentRng,
    plan: &Plan<'_>,
) -> PyResult<Box<dyn Run>>
where
    R: Copy + AsRef<[u32]> + Send + 'static,
{
    let algorithm = &plan.algorithm;
    if algorithm.name == "double_q_learning" {
        let agent = plan.agent(2, rows, lit, &mut draw)?;
        let second = plan.table((1, 2), rows, &mut draw)?;
        return Ok(start(world, DoubleQLearning::new(agent, second), draw, plan));
    }
    let agent = plan.agent(1, rows, lit, &mut draw)?;
    let trace_decay = || given("trace_decay", algorithm.trace_decay);
    // A model of pairs needs a table.
    let model = || {
        if lit == 1 { Ok(learners::Model::new(rows, plan.actions)) } else { Err(unknown("algorithm", &algorithm.name)) }
    };
    let planning_steps = || given("planning_steps", algorithm.planning_steps);
    Ok(match algorithm.name.as_str() {
        "q_learning" => control(world, agent, QLearning, draw, plan),
        "sarsa" => control(world, agent, Sarsa, draw, plan),
        "expected_sarsa" => control(world, agent, ExpectedSarsa, draw, plan),
        "n_step_sarsa" => control(world, agent, NStepSarsa::new(given("n_steps", algorithm.n_steps)?), draw, plan),
        "sarsa_lambda" => {
            let (traces, kind) = (algorithm.no_traces(&agent)?, algorithm.trace()?);
            control(world, agent, SarsaLambda { traces, kind, trace_decay: trace_decay()? }, draw, plan)
        }
        "watkins_q_lambda" => {
            let (traces, kind) = (algorithm.no_traces(&agent)?, algorithm.trace()?);
            control(world, agent, WatkinsQLambda { traces, kind, trace_decay: trace_decay()? }, draw, plan)
        }
        "true_online_sarsa_lambda" => {
            let traces = algorithm.no_traces(&agent)?;
            control(world, agent, TrueOnlineSarsaLambda::new(traces, trace_decay()?), draw, plan)
        }
        "dyna_q" => control(world, agent, DynaQ { model: model()?, planning_steps: planning_steps()? }, draw, plan),
        "dyna_q_plus" => {
            let time_weight = given("time_weight", algorithm.time_weight)?;
            control(world, agent, DynaQPlus::new(model()?, planning_steps()?, time_weight), draw, plan)
        }
        other => return Err(unknown("algorithm", other)),
    })
}

fn control<R, U>(world: BoxedTask<R, Failure>, agent: Agent, rule: U, draw: AgentRng, plan: &Plan<'_>) -> Box<dyn Run>
where
    R: Copy + AsRef<[u32]> + Send + 'static,
    U: UpdateRule<R, Agent> + Send + 'static,
{
    start(world, TdLearner { agent, rule }, draw, plan)
}

fn start<R, L>(world: BoxedTask<R, Failure>, learner: L, draw: AgentRng, plan: &Plan<'_>) -> Box<dyn Run>
where
    R: Copy + AsRef<[u32]> + Send + 'static,
    L: Learner<R> + Send + 'static,
{
    let learner = TruncationHandling { learner, terminate: plan.on_truncation == "terminate" };
    Box::new(Trainer::new(world, learner, draw))
}

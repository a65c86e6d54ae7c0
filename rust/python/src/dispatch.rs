//! Python's choice into a trainer: the hot combination whole, every other one through a boxed world.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use qtab_core::features::{Features, MOST_TILINGS, Real, Rounding};
use qtab_core::learners::{
    self, Agent, Control, DoubleQLearning, DynaQ, DynaQPlus, ExpectedSarsa, NStepSarsa, Policy, QLearning, Rule, Sarsa,
    SarsaLambda, TimeOuts, TrueOnlineSarsaLambda, WatkinsQLambda,
};
use qtab_core::random::{Pcg64, Stream};
use qtab_core::worlds::{Boxed, Native, Recorded, Recordings, Start};
use qtab_core::{Learner, Trainer, World};

use crate::failure::Failure;
use crate::finite::{Bias, Process, Rules};
use crate::model::Model;
use crate::observation::{Floats, Integers};
use crate::plan::{Discretizer, Plan, given, unknown};
use crate::python_world::{PythonEnvironment, PythonWorld};
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

/// A run of a model in Rust, its constants as they are.
pub(crate) fn native(model: Model, plan: &Plan<'_>) -> PyResult<Built> {
    let Model::MountainCar(env) = model else {
        return Err(PyValueError::new_err("model must be 'MountainCar' to be trained in Rust"));
    };
    let mut draw = plan.stream()?;
    let (limit, stream) = (plan.max_episode_steps, plan.environment_stream());
    match &plan.features {
        Discretizer::Rounding { scale } => {
            let grid = plan.plane(scale)?;
            let rows = Features::<[f32; 2]>::len(&grid);
            let world = Native::new(env, grid, limit, stream);
            if let (Stream::Pcg64(draw), 0) = (&mut draw, plan.record)
                && let Some(agent) = plan.article::<3>(rows, draw)?
            {
                return Ok(Built {
                    run: whole(world, agent, draw.clone(), plan),
                    kept: Kept::Nothing,
                    attached: false,
                });
            }
            boxed(world, rows, 1, draw, plan, Kept::Native, false)
        }
        // Eight tilings are the usual number.
        Discretizer::Tiles { tilings: lit @ ..=8, .. } => {
            let tiles = plan.tiles::<f32, 8>()?;
            let rows = Features::<[f32; 2]>::len(&tiles);
            boxed(Native::new(env, tiles, limit, stream), rows, *lit as usize, draw, plan, Kept::Native, false)
        }
        Discretizer::Tiles { tilings: lit, .. } => {
            let tiles = plan.tiles::<f32, MOST_TILINGS>()?;
            let rows = Features::<[f32; 2]>::len(&tiles);
            boxed(Native::new(env, tiles, limit, stream), rows, *lit as usize, draw, plan, Kept::Native, false)
        }
        Discretizer::Cells { .. } => Err(unknown("discretizer", "identity")),
    }
}

/// The combinations that are compiled whole: a table of so many actions, learned as in the article, or by its next of
/// kin.
pub(crate) fn whole<W, P, const N: usize>(
    world: W,
    agent: Agent<N, P, f64>,
    draw: Pcg64,
    plan: &Plan<'_>,
) -> Box<dyn Run>
where
    W: World<Rows = [u32; 1], State: Send, Error: Into<Failure>> + Send + 'static,
    P: Policy + Send + 'static,
{
    match plan.algorithm.name.as_str() {
        "sarsa" => Box::new(Trainer::new(world, Control { agent, rule: Sarsa }, draw)),
        "expected_sarsa" => Box::new(Trainer::new(world, Control { agent, rule: ExpectedSarsa }, draw)),
        _ => Box::new(Trainer::new(world, Control { agent, rule: QLearning }, draw)),
    }
}

/// A run that steps a Python environment.
pub(crate) fn python(environment: PythonEnvironment, plan: &Plan<'_>) -> PyResult<Built> {
    if let Discretizer::Cells { first, counts, scalar } = &plan.features {
        let axes: Vec<_> = first.iter().copied().zip(counts.iter().copied()).collect();
        let (rows, draw) = (axes.iter().map(|&(_, count)| count as usize).product(), plan.stream()?);
        let world = PythonWorld::new(environment, Integers { axes, scalar: *scalar }, plan);
        boxed(world, rows, 1, draw, plan, Kept::Python, true)
    } else if plan.single {
        python_of(environment, plan, |bound| bound as f32)
    } else {
        python_of(environment, plan, |bound| bound)
    }
}

fn python_of<T>(environment: PythonEnvironment, plan: &Plan<'_>, dtype: impl Fn(f64) -> T) -> PyResult<Built>
where
    T: Real + numpy::Element + 'static,
{
    let draw = plan.stream()?;
    match &plan.features {
        Discretizer::Rounding { scale } => {
            let grid = Rounding::new(plan.axes(scale, dtype));
            let rows = Features::<[T]>::len(&grid);
            let world = PythonWorld::new(environment, Floats::new(grid, plan.low.len()), plan);
            boxed(world, rows, 1, draw, plan, Kept::Python, true)
        }
        Discretizer::Tiles { tilings: lit, .. } => {
            let tiles = plan.tiles::<T, MOST_TILINGS>()?;
            let rows = Features::<[T]>::len(&tiles);
            let world = PythonWorld::new(environment, Floats::new(tiles, plan.low.len()), plan);
            boxed(world, rows, *lit as usize, draw, plan, Kept::Python, true)
        }
        Discretizer::Cells { .. } => Err(unknown("discretizer", "identity")),
    }
}

pub(crate) fn boxed<W>(
    world: W,
    rows: usize,
    lit: usize,
    draw: Stream,
    plan: &Plan<'_>,
    kept: impl FnOnce(Recordings<W::Start>) -> Kept,
    attached: bool,
) -> PyResult<Built>
where
    W: Start + World<Rows: Send, State: Send, Error: Into<Failure>> + Send + 'static,
    W::Start: Send,
    Failure: From<W::Error>,
{
    let (world, kept) = if plan.record == 0 {
        (Boxed::<W::Rows, Failure>::new(world), Kept::Nothing)
    } else {
        let (world, recordings) = Recorded::new(world, plan.record);
        (Boxed::new(world), kept(recordings))
    };
    Ok(Built { run: learning(world, rows, lit, draw, plan)?, kept, attached })
}

/// Any learner in a boxed world, with a stream chosen at run time: compiled once for each kind of rows.
fn learning<R>(
    world: Boxed<R, Failure>,
    rows: usize,
    lit: usize,
    mut draw: Stream,
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

fn control<R, U>(world: Boxed<R, Failure>, agent: Agent, rule: U, draw: Stream, plan: &Plan<'_>) -> Box<dyn Run>
where
    R: Copy + AsRef<[u32]> + Send + 'static,
    U: Rule<R, Agent> + Send + 'static,
{
    start(world, Control { agent, rule }, draw, plan)
}

fn start<R, L>(world: Boxed<R, Failure>, learner: L, draw: Stream, plan: &Plan<'_>) -> Box<dyn Run>
where
    R: Copy + AsRef<[u32]> + Send + 'static,
    L: Learner<R> + Send + 'static,
{
    let learner = TimeOuts { learner, terminate: plan.on_truncation == "terminate" };
    Box::new(Trainer::new(world, learner, draw))
}

/// What a plan is run on: the name of a model with its constants, or an environment.
pub(crate) fn build(environment: &Bound<'_, PyAny>, plan: &Plan<'_>) -> PyResult<Built> {
    if let Ok(model) = environment.extract::<Description>() {
        return native(model.resolve()?, plan);
    }
    if let Ok(process) = environment.extract::<Process>() {
        return process.build(environment.py(), plan);
    }
    if let Ok(rules) = environment.extract::<Rules>() {
        return rules.build(plan);
    }
    if let Ok(bias) = environment.extract::<Bias>() {
        return bias.build(plan);
    }
    match environment.extract::<PythonEnvironment>() {
        Ok(environment) => python(environment, plan),
        Err(error) => Err(PyTypeError::new_err(format!("no environment to train on: {error}"))),
    }
}

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Description {
    model: String,
    parameters: std::collections::HashMap<String, f64>,
}

impl Description {
    fn resolve(self) -> PyResult<Model> {
        let mut model = Model::new(&self.model)?;
        for (name, value) in self.parameters {
            let parameter = model.constants().parameter(&name);
            *parameter.ok_or_else(|| PyValueError::new_err(format!("the model has no parameter {name:?}")))? = value;
        }
        Ok(model)
    }
}

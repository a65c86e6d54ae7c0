//! Boxed runs of any learner on any task, for combinations that are not worth compiling separately.

use std::sync::Arc;

use pyo3::prelude::*;
use qtab_core::features::{ActiveFeatures, ActiveRows, MAX_TILINGS};
use qtab_core::learners::{CountBonus, LearnerVisitor, TransformedSteps};
use qtab_core::random::AgentRng;
use qtab_core::tasks::{BoxedTask, EpisodeRecorder, NativeTask, Recordings, RngSnapshot, TimeAware, VisitCounter};
use qtab_core::{Env, Features, Learner, StopFlag, Task, Trainer, TrainingError};

use super::agent::generic_agent;
use super::factory::BoxedFactory;
use super::path::RunPath;
use super::prediction::observed_box;
use super::tilings::{fixed_tiles, match_tilings};
use super::{AnyRecordings, Run, RunFactory};
use crate::convert::Seed;
use crate::error::{RunError, allocation, invalid};
use crate::rng::environment_rng;
use crate::spec::{DiscretizerSpec, RunSpec, TilesSpec, match_capacity};

/// The number of bytes of a recorded action: in Rust, in the list that Python reads, and in Python's recording.
const RECORDED_ACTION_BYTES: u64 = 4 + 8 + 8;

/// Runs in an environment whose observations are `M` float32 numbers, with any discretizer of a Box.
pub(crate) fn generic_box<E, const M: usize>(env: E, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>>
where
    E: Env<Action = usize, Observation = [f32; M], State: Send> + Clone + Send + Sync + 'static,
{
    let (_, dimensions) = spec.discretizer.box_space()?;
    if dimensions != M {
        return Err(invalid("discretizer", format!("one for observations of {M} components"), dimensions));
    }
    let path = RunPath::of(spec);
    if let RunPath::ObservedPrediction(prediction) = &path {
        check_actions(env.num_actions(), spec)?;
        return observed_box(env, spec, prediction);
    }
    match &spec.discretizer {
        // Compiled for the usual numbers of tilings, but not again for rare combinations with wrappers.
        DiscretizerSpec::Tiles(tiles) if !path.has_wrappers() => match_tilings!(
            tiles.tilings,
            N => fixed_tilings::<E, M, N>(env, tiles, spec),
            _ => generic(env, tiles.tile_coding::<f32, MAX_TILINGS>(), spec),
        ),
        DiscretizerSpec::Tiles(tiles) => generic(env, tiles.tile_coding::<f32, MAX_TILINGS>(), spec),
        DiscretizerSpec::Weighted(features) => match_capacity!(
            features.n_features(),
            ROOM => generic(env, features.basis::<f32, ROOM>()?, spec)
        ),
        grid => generic(env, grid.grid(|bound| bound as f32)?, spec),
    }
}

/// Runs with exactly `N` tilings, in a task without wrappers.
fn fixed_tilings<E, const M: usize, const N: usize>(
    env: E,
    tiles: &TilesSpec,
    spec: &Arc<RunSpec>,
) -> PyResult<Box<dyn RunFactory>>
where
    E: Env<Action = usize, Observation = [f32; M], State: Send> + Clone + Send + Sync + 'static,
{
    let features = fixed_tiles::<M, N>(tiles)?;
    check_actions(env.num_actions(), spec)?;
    let (spec, shape) = (Arc::clone(spec), (features.len(), N));
    let build = move |seed: &Seed, stop: &StopFlag<'_>| {
        let task = NativeTask::new(env.clone(), features.clone(), Some(spec.max_episode_steps), environment_rng(seed));
        let rng = spec.bit_generator.agent_rng(seed)?;
        Ok((build_learner(BoxedTask::new(task), shape, rng, &spec, stop)?, AnyRecordings::None))
    };
    Ok(Box::new(BoxedFactory(build)))
}

/// Checks that the spec has the environment's number of actions.
pub(crate) fn check_actions(num_actions: usize, spec: &RunSpec) -> PyResult<()> {
    if spec.num_actions == num_actions {
        return Ok(());
    }
    Err(invalid("num_actions", format!("{num_actions}, the environment's"), spec.num_actions))
}

/// Runs in an environment with any features.
pub(crate) fn generic<E, F>(env: E, features: F, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>>
where
    E: Env<Action = usize, State: Send> + Clone + Send + Sync + 'static,
    F: Features<E::Observation, Active: Send> + Clone + Send + Sync + 'static,
{
    check_actions(env.num_actions(), spec)?;
    let (spec, shape) = (Arc::clone(spec), (features.len(), spec.discretizer.n_active()));
    let build = move |seed: &Seed, stop: &StopFlag<'_>| {
        let task = NativeTask::new(env.clone(), features.clone(), Some(spec.max_episode_steps), environment_rng(seed));
        boxed_run(task, shape, seed, &spec, stop, AnyRecordings::Native)
    };
    Ok(Box::new(BoxedFactory(build)))
}

/// Boxed runs of a task built from a seed. `shape` is the number of rows and of active rows.
pub(crate) fn boxed_factory<W>(
    new_task: impl Fn(&Seed) -> W + Send + Sync + 'static,
    shape: (usize, usize),
    spec: &Arc<RunSpec>,
    keep: fn(Recordings<W::Snapshot>) -> AnyRecordings,
) -> Box<dyn RunFactory>
where
    W: RngSnapshot + Task<Active: Send, State: Send> + Send + 'static,
    W::Snapshot: Send + 'static,
    RunError: From<W::Error> + From<TrainingError<W::Error>>,
{
    let spec = Arc::clone(spec);
    let build = move |seed: &Seed, stop: &StopFlag<'_>| boxed_run(new_task(seed), shape, seed, &spec, stop, keep);
    Box::new(BoxedFactory(build))
}

/// A run of any learner, with recordings if the spec asks for them. `shape` is the number of rows and of active rows.
pub(crate) fn boxed_run<W>(
    task: W,
    shape: (usize, usize),
    seed: &Seed,
    spec: &RunSpec,
    stop: &StopFlag<'_>,
    keep: impl FnOnce(Recordings<W::Snapshot>) -> AnyRecordings,
) -> PyResult<(Box<dyn Run>, AnyRecordings)>
where
    W: RngSnapshot + Task<Active: Send, State: Send> + Send + 'static,
    W::Snapshot: Send,
    RunError: From<W::Error> + From<TrainingError<W::Error>>,
{
    if spec.record == 0 {
        return Ok((run_of(task, shape, seed, spec, stop)?, AnyRecordings::None));
    }
    let (task, recordings) = EpisodeRecorder::new(task, spec.record, (spec.room.clone(), RECORDED_ACTION_BYTES));
    Ok((run_of(task, shape, seed, spec, stop)?, keep(recordings)))
}

/// A run of any learner, without recordings other than those of the task.
fn run_of<W>(task: W, shape: (usize, usize), seed: &Seed, spec: &RunSpec, stop: &StopFlag<'_>) -> PyResult<Box<dyn Run>>
where
    W: Task<Active: Send, State: Send> + Send + 'static,
    RunError: From<W::Error>,
{
    if W::Active::WEIGHTED {
        // Again, because visits are not counted in the spec that was parsed.
        spec.check_weighted()?;
    }
    let rng = spec.bit_generator.agent_rng(seed)?;
    // What `check_weighted` refuses is not compiled for weighted features: each condition is known to the compiler.
    if spec.time_aware && !W::Active::WEIGHTED {
        return time_aware_run(BoxedTask::new(task), shape.0, rng, spec, stop);
    }
    build_learner(boxed_task(task, shape, spec, stop)?, shape, rng, spec, stop)
}

/// A run with rows for each step. The task is boxed first, so that this is compiled once for each kind of active rows.
fn time_aware_run<R: ActiveRows + Send + 'static>(
    task: BoxedTask<R, RunError>,
    n_rows: usize,
    rng: AgentRng,
    spec: &RunSpec,
    stop: &StopFlag<'_>,
) -> PyResult<Box<dyn Run>> {
    let Some(task) = TimeAware::new(task, n_rows, spec.max_episode_steps) else {
        let got = format!("{n_rows} cells of {} steps each", spec.max_episode_steps);
        return Err(invalid("time_aware", "a table of fewer than 2**32 rows", got));
    };
    let shape = (task.n_rows(), 1);
    build_learner(boxed_task(task, shape, spec, stop)?, shape, rng, spec, stop)
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
    if spec.count_visits && !W::Active::WEIGHTED {
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
    if let Some(prediction) = &spec.prediction {
        if R::WEIGHTED {
            return Err(invalid("policies", "those of observations for weighted features", "those of states"));
        }
        if n_active != 1 {
            return Err(invalid("discretizer", "one with a cell for each observation", "tile coding"));
        }
        prediction.check_states(n_rows)?;
        let predictor = prediction.of_states(spec, stop)?;
        let run = BoxedRun { task, rng, terminate: spec.terminate_on_truncation, bonus: None };
        return Ok(run.visit(predictor));
    }
    let agent = generic_agent(spec, n_rows, n_active, &mut rng, stop)?;
    // The generator draws both tables before the run takes ownership of it.
    let second_table = match spec.algorithm.n_tables() {
        1 => None,
        _ if spec.algorithm.value_learning_rate().is_some() => {
            Some(spec.initial_q.critic_table((n_rows, spec.num_actions), stop)?)
        }
        tables => Some(spec.initial_q.table((1, tables), (n_rows, spec.num_actions), &mut rng, stop)?),
    };
    let bonus = match spec.count_bonus {
        0.0 => None,
        weight => Some(CountBonus::new(weight, (n_rows, spec.num_actions), stop).map_err(allocation)?),
    };
    let run = BoxedRun { task, rng, terminate: spec.terminate_on_truncation, bonus };
    let run = spec.algorithm.learner::<R, _>(agent, second_table, stop, run).map_err(allocation)?;
    run.ok_or_else(|| invalid("discretizer", "one with one active row, for this algorithm", "'tiles'"))
}

/// A run without its learner.
struct BoxedRun<R> {
    task: BoxedTask<R, RunError>,
    rng: AgentRng,
    terminate: bool,
    bonus: Option<CountBonus>,
}

impl<R: ActiveRows + Send + 'static> LearnerVisitor<R> for BoxedRun<R> {
    type Output = Box<dyn Run>;

    fn visit<L: Learner<R> + Send + 'static>(self, learner: L) -> Box<dyn Run> {
        let learner = TransformedSteps { learner, terminate: self.terminate, bonus: self.bonus };
        Box::new(Trainer::new(self.task, learner, self.rng))
    }
}

//! The environments of Sutton & Barto's book.

use std::sync::Arc;

use pyo3::prelude::*;
use qtab_core::envs::tabular::{
    Ground, MAXIMIZATION_BIAS_STATES, MaximizationBias, Racetrack, ShortCorridor, TabularMdp,
};
use qtab_core::features::Identity;
use qtab_core::tasks::{ChangingTask, KArmedBandit, Testbed};
use qtab_core::{Env, StopFlag};

use super::native_env::NativeEnv;
use super::toy_text::table_of;
use crate::convert::Seed;
use crate::error::{allocation, invalid};
use crate::rng::environment_rng;
use crate::runs::{AnyRecordings, BoxedFactory, RunFactory, boxed_factory, boxed_run, check_actions, generic};
use crate::spec::RunSpec;

/// `qtab/KArmedBandit-v0`, the k-armed bandit testbed.
pub(super) fn k_armed_bandit(env: &Bound<'_, PyAny>) -> PyResult<Arc<dyn NativeEnv>> {
    Ok(Arc::new(Testbed {
        num_actions: env.getattr("k")?.extract()?,
        mean: env.getattr("mean")?.extract()?,
        deviation: env.getattr("deviation")?.extract()?,
        random_walk: env.getattr("random_walk")?.extract()?,
    }))
}

impl NativeEnv for Testbed {
    fn runs(&self, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        spec.discretizer.check_identity(1)?;
        check_actions(self.num_actions, spec)?;
        let testbed = *self;
        let new_task = move |seed: &Seed| KArmedBandit::new(testbed, environment_rng(seed));
        Ok(boxed_factory(new_task, (1, 1), spec, AnyRecordings::Native))
    }

    fn testbed_runs(&self, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        spec.discretizer.check_identity(1)?;
        check_actions(self.num_actions, spec)?;
        let (testbed, spec) = (*self, Arc::clone(spec));
        let build = move |seed: &Seed, stop: &StopFlag<'_>| {
            let mut task = KArmedBandit::new(testbed, environment_rng(seed));
            let optimal = task.record(spec.episodes as usize).map_err(allocation)?;
            let (run, _) = boxed_run(task, (1, 1), seed, &spec, stop, AnyRecordings::Native)?;
            Ok((run, AnyRecordings::OptimalActions(optimal)))
        };
        Ok(Box::new(BoxedFactory(build)))
    }
}

/// `qtab/MaximizationBias-v0`, the example of maximization bias.
pub(super) fn maximization_bias(env: &Bound<'_, PyAny>) -> PyResult<Arc<dyn NativeEnv>> {
    Ok(Arc::new(MaximizationBias {
        num_actions: env.getattr("actions")?.extract()?,
        mean: env.getattr("mean")?.extract()?,
        standard_deviation: env.getattr("deviation")?.extract()?,
    }))
}

impl NativeEnv for MaximizationBias {
    fn runs(&self, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        spec.discretizer.check_identity(MAXIMIZATION_BIAS_STATES as usize)?;
        generic(*self, Identity(MAXIMIZATION_BIAS_STATES), spec)
    }
}

/// `qtab/BlockingMaze-v0` and `qtab/ShortcutMaze-v0`, mazes that change after a number of steps.
pub(super) fn changing_maze(env: &Bound<'_, PyAny>) -> PyResult<Arc<dyn NativeEnv>> {
    let (before, after): (Bound<'_, PyAny>, Bound<'_, PyAny>) = env.getattr("mazes")?.extract()?;
    let tables = [table_of(&before)?, table_of(&after)?];
    if tables[0].num_states() != tables[1].num_states() || tables[0].num_actions() != tables[1].num_actions() {
        return Err(invalid("mazes", "two with the same states and actions", "others"));
    }
    Ok(Arc::new(ChangingMaze { tables, change_after: env.getattr("change_after")?.extract()? }))
}

struct ChangingMaze {
    /// The table before the change, and the one after it.
    tables: [TabularMdp; 2],
    change_after: u64,
}

impl NativeEnv for ChangingMaze {
    fn runs(&self, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        let (tables, change_after, limit) = (self.tables.clone(), self.change_after, spec.max_episode_steps);
        let num_states = tables[0].num_states();
        spec.discretizer.check_identity(num_states)?;
        check_actions(tables[0].num_actions(), spec)?;
        let new_task = move |seed: &Seed| ChangingTask::new(tables.clone(), change_after, limit, environment_rng(seed));
        Ok(boxed_factory(new_task, (num_states, 1), spec, AnyRecordings::Native))
    }
}

/// `qtab/Racetrack-v0`, the racetrack of Exercise 5.12.
pub(super) fn racetrack(env: &Bound<'_, PyAny>) -> PyResult<Arc<dyn NativeEnv>> {
    let rows: Vec<String> = env.getattr("layout")?.extract()?;
    let columns = rows.first().map_or(0, String::len);
    let ground: Vec<Ground> = rows.iter().flat_map(|row| row.bytes()).map(ground).collect();
    let is_rectangle = rows.iter().all(|row| row.len() == columns);
    let failure = env.getattr("failure")?.extract()?;
    let track = u32::try_from(columns).ok().and_then(|columns| Racetrack::new(&ground, columns, failure));
    match track.filter(|_| is_rectangle) {
        Some(track) => Ok(Arc::new(track)),
        None => Err(invalid("layout", "rows of the same length with a starting line", "other rows")),
    }
}

fn ground(cell: u8) -> Ground {
    match cell {
        b'.' => Ground::Track,
        b'S' => Ground::Start,
        b'F' => Ground::Finish,
        _ => Ground::Off,
    }
}

impl NativeEnv for Racetrack {
    fn runs(&self, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        spec.discretizer.check_identity(self.num_states() as usize)?;
        generic(self.clone(), Identity(self.num_states()), spec)
    }
}

/// `qtab/ShortCorridor-v0`, the short corridor with switched actions.
#[expect(clippy::unnecessary_wraps, reason = "the registry has functions that may fail")]
pub(super) fn short_corridor(_env: &Bound<'_, PyAny>) -> PyResult<Arc<dyn NativeEnv>> {
    Ok(Arc::new(ShortCorridor))
}

impl NativeEnv for ShortCorridor {
    fn runs(&self, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        spec.discretizer.check_identity(1)?;
        generic(ShortCorridor, Identity(1), spec)
    }
}

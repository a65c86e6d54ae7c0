//! The environments of Sutton & Barto's book.

use std::sync::Arc;

use pyo3::intern;
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
pub(super) struct KArmedBanditEnv(Testbed);

impl KArmedBanditEnv {
    pub(super) fn from_gymnasium(env: &Bound<'_, PyAny>) -> PyResult<Arc<dyn NativeEnv>> {
        let py = env.py();
        Ok(Arc::new(Self(Testbed {
            num_actions: env.getattr(intern!(py, "k"))?.extract()?,
            mean: env.getattr(intern!(py, "mean"))?.extract()?,
            deviation: env.getattr(intern!(py, "deviation"))?.extract()?,
            random_walk: env.getattr(intern!(py, "random_walk"))?.extract()?,
        })))
    }
}

impl NativeEnv for KArmedBanditEnv {
    fn runs(&self, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        spec.discretizer.check_identity(1)?;
        check_actions(self.0.num_actions, spec)?;
        let testbed = self.0;
        let new_task = move |seed: &Seed| KArmedBandit::new(testbed, environment_rng(seed));
        Ok(boxed_factory(new_task, (1, 1), spec, AnyRecordings::Native))
    }

    fn testbed_runs(&self, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        spec.discretizer.check_identity(1)?;
        check_actions(self.0.num_actions, spec)?;
        let (testbed, spec) = (self.0, Arc::clone(spec));
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
pub(super) struct MaximizationBiasEnv(MaximizationBias);

impl MaximizationBiasEnv {
    pub(super) fn from_gymnasium(env: &Bound<'_, PyAny>) -> PyResult<Arc<dyn NativeEnv>> {
        let py = env.py();
        Ok(Arc::new(Self(MaximizationBias {
            num_actions: env.getattr(intern!(py, "actions"))?.extract()?,
            mean: env.getattr(intern!(py, "mean"))?.extract()?,
            standard_deviation: env.getattr(intern!(py, "deviation"))?.extract()?,
        })))
    }
}

impl NativeEnv for MaximizationBiasEnv {
    fn runs(&self, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        spec.discretizer.check_identity(MAXIMIZATION_BIAS_STATES as usize)?;
        generic(self.0, Identity(MAXIMIZATION_BIAS_STATES), spec)
    }
}

/// `qtab/BlockingMaze-v0` and `qtab/ShortcutMaze-v0`, mazes that change after a number of steps.
pub(super) struct ChangingMazeEnv {
    /// The table before the change, and the one after it.
    tables: [TabularMdp; 2],
    change_after: u64,
}

impl ChangingMazeEnv {
    pub(super) fn from_gymnasium(env: &Bound<'_, PyAny>) -> PyResult<Arc<dyn NativeEnv>> {
        let py = env.py();
        let (before, after): (Bound<'_, PyAny>, Bound<'_, PyAny>) = env.getattr(intern!(py, "mazes"))?.extract()?;
        let tables = [table_of(&before)?, table_of(&after)?];
        if tables[0].num_states() != tables[1].num_states() || tables[0].num_actions() != tables[1].num_actions() {
            return Err(invalid("mazes", "two with the same states and actions", "others"));
        }
        Ok(Arc::new(Self { tables, change_after: env.getattr(intern!(py, "change_after"))?.extract()? }))
    }
}

impl NativeEnv for ChangingMazeEnv {
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
pub(super) struct RacetrackEnv(Racetrack);

impl RacetrackEnv {
    pub(super) fn from_gymnasium(env: &Bound<'_, PyAny>) -> PyResult<Arc<dyn NativeEnv>> {
        let py = env.py();
        let rows: Vec<String> = env.getattr(intern!(py, "layout"))?.extract()?;
        let columns = rows.first().map_or(0, String::len);
        let ground: Vec<Ground> = rows.iter().flat_map(|row| row.bytes()).map(ground).collect();
        let is_rectangle = rows.iter().all(|row| row.len() == columns);
        let failure = env.getattr(intern!(py, "failure"))?.extract()?;
        let track = u32::try_from(columns).ok().and_then(|columns| Racetrack::new(&ground, columns, failure));
        let track = track.filter(|_| is_rectangle);
        track
            .map(|track| Arc::new(Self(track)) as Arc<dyn NativeEnv>)
            .ok_or_else(|| invalid("layout", "rows of the same length with a starting line", "other rows"))
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

impl NativeEnv for RacetrackEnv {
    fn runs(&self, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        spec.discretizer.check_identity(self.0.num_states() as usize)?;
        generic(self.0.clone(), Identity(self.0.num_states()), spec)
    }
}

/// `qtab/ShortCorridor-v0`, the short corridor with switched actions.
pub(super) struct ShortCorridorEnv;

impl ShortCorridorEnv {
    #[expect(clippy::unnecessary_wraps, reason = "the registry has functions that may fail")]
    pub(super) fn from_gymnasium(_env: &Bound<'_, PyAny>) -> PyResult<Arc<dyn NativeEnv>> {
        Ok(Arc::new(Self))
    }
}

impl NativeEnv for ShortCorridorEnv {
    fn runs(&self, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        spec.discretizer.check_identity(1)?;
        generic(ShortCorridor, Identity(1), spec)
    }
}

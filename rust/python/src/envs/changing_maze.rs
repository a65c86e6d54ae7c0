//! `qtab/BlockingMaze-v0` and `qtab/ShortcutMaze-v0`, mazes that change after a number of steps.

use std::sync::Arc;

use pyo3::intern;
use pyo3::prelude::*;
use qtab_core::Env;
use qtab_core::envs::tabular::TabularMdp;
use qtab_core::tasks::ChangingTask;

use super::native_env::NativeEnv;
use super::toy_text::table_of;
use crate::convert::Seed;
use crate::error::invalid;
use crate::rng::environment_rng;
use crate::runs::{AnyRecordings, RunFactory, boxed_factory};
use crate::spec::RunSpec;

pub(crate) struct ChangingMazeEnv {
    /// The table before the change, and the one after it.
    tables: [TabularMdp; 2],
    change_after: u64,
}

impl ChangingMazeEnv {
    pub(crate) fn from_gymnasium(env: &Bound<'_, PyAny>) -> PyResult<Arc<dyn NativeEnv>> {
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
        spec.discretizer.check_identity(tables[0].num_states())?;
        let (num_actions, num_states) = (tables[0].num_actions(), tables[0].num_states());
        if spec.num_actions != num_actions {
            return Err(invalid("num_actions", format!("{num_actions}, the environment's"), spec.num_actions));
        }
        let new_task = move |seed: &Seed| ChangingTask::new(tables.clone(), change_after, limit, environment_rng(seed));
        Ok(boxed_factory(new_task, (num_states, 1), spec, AnyRecordings::Native))
    }
}

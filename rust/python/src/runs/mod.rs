//! Training runs of every type behind one interface, and their construction from a spec.

mod action_mask;
mod agent;
mod answers;
mod factory;
mod generic;
mod one_step;
mod path;
mod prediction;
mod python_env;
mod python_task;
mod run;
mod specialized;
mod tilings;

pub(crate) use factory::{BoxedFactory, RunBatch, RunFactory};
pub(crate) use generic::{boxed_factory, boxed_run, check_actions, generic, generic_box};
pub(crate) use one_step::one_step_runs;
pub(crate) use prediction::observed_run;
pub(crate) use python_env::PythonEnv;
pub(crate) use python_task::python_task;
pub(crate) use run::{AnyRecordings, BuiltRun, Run, check_tables};
pub(crate) use specialized::{OneStepBatching, specialized};
pub(crate) use tilings::tiled_box;

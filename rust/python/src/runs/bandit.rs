//! Runs on the k-armed testbed that record whether the optimal action was taken.

use std::sync::Arc;

use qtab_core::StopFlag;
use qtab_core::tasks::{KArmedBandit, Testbed};

use super::factory::BoxedFactory;
use super::generic::boxed_run;
use super::{AnyRecordings, RunFactory};
use crate::convert::Seed;
use crate::error::allocation;
use crate::rng::environment_rng;
use crate::spec::RunSpec;

/// Runs with the numbers of training, which also record in which episodes the optimal action was taken.
pub(crate) fn testbed_runs(testbed: Testbed, spec: &Arc<RunSpec>) -> Box<dyn RunFactory> {
    let spec = Arc::clone(spec);
    let build = move |seed: &Seed, stop: &StopFlag<'_>| {
        let mut task = KArmedBandit::new(testbed, environment_rng(seed));
        let optimal = task.record(spec.episodes as usize).map_err(allocation)?;
        let (run, _) = boxed_run(task, (1, 1), seed, &spec, stop, AnyRecordings::Native)?;
        Ok((run, AnyRecordings::OptimalActions(optimal)))
    };
    Box::new(BoxedFactory(build))
}

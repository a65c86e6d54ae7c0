//! `qtab/KArmedBandit-v0`, the k-armed bandit testbed.

use std::sync::Arc;

use pyo3::intern;
use pyo3::prelude::*;
use qtab_core::tasks::{KArmedBandit, Testbed};

use super::native_env::NativeEnv;
use crate::convert::Seed;
use crate::error::invalid;
use crate::rng::environment_rng;
use crate::runs::{AnyRecordings, RunFactory, boxed_factory, testbed_runs};
use crate::spec::RunSpec;

pub(crate) struct KArmedBanditEnv(Testbed);

impl KArmedBanditEnv {
    pub(crate) fn from_gymnasium(env: &Bound<'_, PyAny>) -> PyResult<Arc<dyn NativeEnv>> {
        Ok(Arc::new(Self(testbed(env)?)))
    }
}

/// The distribution that an environment draws its problem from.
fn testbed(env: &Bound<'_, PyAny>) -> PyResult<Testbed> {
    let py = env.py();
    Ok(Testbed {
        num_actions: env.getattr(intern!(py, "k"))?.extract()?,
        mean: env.getattr(intern!(py, "mean"))?.extract()?,
        deviation: env.getattr(intern!(py, "deviation"))?.extract()?,
        random_walk: env.getattr(intern!(py, "random_walk"))?.extract()?,
    })
}

impl NativeEnv for KArmedBanditEnv {
    fn runs(&self, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        self.check(spec)?;
        let testbed = self.0;
        let new_task = move |seed: &Seed| KArmedBandit::new(testbed, environment_rng(seed));
        Ok(boxed_factory(new_task, (1, 1), spec, AnyRecordings::Native))
    }

    fn testbed_runs(&self, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        self.check(spec)?;
        Ok(testbed_runs(self.0, spec))
    }
}

impl KArmedBanditEnv {
    /// Refuses a spec for other spaces.
    fn check(&self, spec: &RunSpec) -> PyResult<()> {
        spec.discretizer.check_identity(1)?;
        if spec.num_actions == self.0.num_actions {
            return Ok(());
        }
        Err(invalid("num_actions", format!("{}, the environment's", self.0.num_actions), spec.num_actions))
    }
}

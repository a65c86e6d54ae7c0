//! Environments fully described by their table `P`: `FrozenLake-v1`, `CliffWalking-v1`, `qtab.TabularEnv`.

use std::sync::Arc;

use pyo3::exceptions::PyValueError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use qtab_core::Env;
use qtab_core::envs::tabular::TabularMdp;
use qtab_core::envs::wrappers::{TransitionProbabilityState, WithTransitionProbability};
use qtab_core::features::Identity;
use qtab_core::planning::Mdp;

use super::super::gymnasium::render_if_human;
use super::super::native_env::NativeEnv;
use super::sampling::{begin_episode, python_int, reset_fallback, sample_transition, set_snapshot, step_fallback};
use super::transition_table::table_of;
use crate::runs::{OneStepBatching, RunFactory, specialized};
use crate::spec::RunSpec;
use crate::vector::{DynVectorEnv, EnvInfo, TransitionInfo, VectorOptions, native_vector_env};

/// An environment with a transition table, which all runs share.
pub(crate) fn table_env(env: &Bound<'_, PyAny>) -> PyResult<Arc<dyn NativeEnv>> {
    Ok(Arc::new(table_of(env)?))
}

/// One row for each state of a table, which must agree with the spec.
pub(super) fn identity(table: &TabularMdp, spec: &RunSpec) -> PyResult<Identity> {
    spec.discretizer.check_identity(table.num_states())?;
    let states = u32::try_from(table.num_states());
    states.map(Identity).map_err(|_| PyValueError::new_err("P must have fewer than 2**32 states"))
}

/// Runs on a table, compiled for the numbers of actions that occur in Gymnasium's tables.
pub(super) fn table_runs(table: TabularMdp, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
    let features = identity(&table, spec)?;
    if table.num_actions() == 4 {
        specialized::<_, _, 4>(table, features, spec, OneStepBatching::one_by_one())
    } else {
        specialized::<_, _, 6>(table, features, spec, OneStepBatching::one_by_one())
    }
}

impl NativeEnv for TabularMdp {
    fn runs(&self, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        table_runs(self.clone(), spec)
    }

    fn vector_env(&self, py: Python<'_>, options: VectorOptions) -> PyResult<Option<Box<dyn DynVectorEnv>>> {
        let transition = TransitionInfo {
            probability: |state: &TransitionProbabilityState<u32>| state.probability,
            integer_after_reset: true,
            action_masks: None,
        };
        let info = EnvInfo { envs_per_thread: 16_384, transition: Some(transition), snapshot, terminal_counter: None };
        native_vector_env::<_, Vec<_>>(py, WithTransitionProbability(self.clone()), info, options).map(Some)
    }

    fn mdp(&self) -> PyResult<Option<Mdp>> {
        Ok(Some(self.clone().into()))
    }
}

fn snapshot(
    attributes: &Bound<'_, PyDict>,
    _env: &WithTransitionProbability<TabularMdp>,
    state: &TransitionProbabilityState<u32>,
    last_action: Option<usize>,
) -> PyResult<()> {
    set_snapshot(attributes, state.state, last_action)
}

/// The base of the Gymnasium-facing classes whose environments are fully described by their table.
#[pyclass(subclass, frozen, name = "ToyText", module = "qtab._core")]
pub(crate) struct PyToyText;

#[pymethods]
impl PyToyText {
    #[new]
    #[pyo3(signature = (*_args, **_kwargs))]
    fn new(_args: &Bound<'_, PyTuple>, _kwargs: Option<&Bound<'_, PyDict>>) -> Self {
        Self
    }

    /// Draws the initial state from the environment's generator; returns the result of `reset`.
    #[pyo3(name = "_native_reset")]
    fn native_reset<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let Some(state) = begin_episode(slf)? else { return reset_fallback(slf) };
        render_if_human(slf)?;
        let info = PyDict::new(py);
        info.set_item(intern!(py, "prob"), 1)?;
        Ok((python_int(state)?, info).into_pyobject(py)?.into_any())
    }

    /// One step, with Gymnasium's return types.
    fn step<'py>(slf: &Bound<'py, Self>, action: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let Some(sampled) = sample_transition(slf, action, |_| true)? else { return step_fallback(slf, action) };
        slf.setattr(intern!(py, "s"), &sampled.state)?;
        slf.setattr(intern!(py, "lastaction"), action)?;
        render_if_human(slf)?;
        let info = PyDict::new(py);
        info.set_item(intern!(py, "prob"), sampled.probability)?;
        let answer = (python_int(sampled.state)?, sampled.reward, sampled.terminated, false, info);
        Ok(answer.into_pyobject(py)?.into_any())
    }
}

//! A Python environment, stepped by a learner.

use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyInt, PyTuple};

use super::action_mask::MaskSource;
use crate::spec::Fields;

/// The number of discrete actions that are cached as Python objects; others are created when they are taken.
const KEPT_ACTIONS: usize = 1024;

/// A Python environment, the arguments for its actions, and the source of its action masks.
pub(crate) struct PythonEnv {
    env: Py<PyAny>,
    /// Its method `step`, looked up once per episode; None before the first.
    step: Option<Py<PyAny>>,
    /// The environment's number for the first action, `Discrete.start`.
    first_action: i64,
    /// The arguments of `step` for the first actions of a discrete space.
    kept: Vec<Py<PyTuple>>,
    /// The actions of any other space: arrays, or tuples and dicts; empty for a discrete space.
    actions: Vec<Py<PyAny>>,
    pub(super) masks: MaskSource,
}

impl PythonEnv {
    pub(crate) fn parse(fields: &Fields<'_>) -> PyResult<Self> {
        Ok(Self {
            env: fields.any("env")?.unbind(),
            step: None,
            first_action: fields.get("first_action")?,
            kept: Vec::new(),
            actions: fields.get("actions")?,
            masks: MaskSource::parse(&fields.nested("action_mask")?)?,
        })
    }

    /// Makes the arguments of `step` for the first `num_actions` actions, up to `KEPT_ACTIONS`.
    pub(super) fn keep_actions(&mut self, py: Python<'_>, num_actions: usize) -> PyResult<()> {
        if self.actions.is_empty() {
            let kept = (0..num_actions.min(KEPT_ACTIONS)).map(|index| Ok(self.discrete(py, index)?.unbind()));
            self.kept = kept.collect::<PyResult<_>>()?;
        }
        Ok(())
    }

    pub(super) fn bind<'py>(&self, py: Python<'py>) -> &Bound<'py, PyAny> {
        self.env.bind(py)
    }

    /// Calls `reset`, with a seed if one is given.
    pub(super) fn reset<'py>(&mut self, py: Python<'py>, seed: Option<&Py<PyAny>>) -> PyResult<Bound<'py, PyAny>> {
        let arguments = PyDict::new(py);
        if let Some(seed) = seed {
            arguments.set_item(intern!(py, "seed"), seed)?;
        }
        let answer = self.env.bind(py).call_method(intern!(py, "reset"), (), Some(&arguments))?;
        self.step = Some(self.env.bind(py).getattr(intern!(py, "step"))?.unbind());
        Ok(answer)
    }

    /// Calls `step` with the action of a column of the table.
    pub(super) fn step<'py>(&self, py: Python<'py>, action: usize) -> PyResult<Bound<'py, PyAny>> {
        let Some(step) = &self.step else { unreachable!("a trainer resets a task before it steps it") };
        let step = step.bind(py);
        if let Some(arguments) = self.kept.get(action) {
            return step.call1(arguments.bind(py));
        }
        match self.actions.get(action) {
            Some(action) => step.call1((fresh(action.bind(py))?,)),
            None => step.call1(self.discrete(py, action)?),
        }
    }

    /// The arguments of `step` for an action of a discrete space.
    fn discrete<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyTuple>> {
        (self.first_action.saturating_add_unsigned(index as u64),).into_pyobject(py)
    }
}

/// A copy of an action, since the environment may write to its arrays.
fn fresh<'py>(action: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    if action.is_instance_of::<PyInt>() {
        return Ok(action.clone());
    }
    if let Ok(parts) = action.cast::<PyTuple>() {
        let parts = parts.iter().map(|part| fresh(&part)).collect::<PyResult<Vec<_>>>()?;
        return Ok(PyTuple::new(action.py(), parts)?.into_any());
    }
    if let Ok(parts) = action.cast::<PyDict>() {
        let copies = PyDict::new(action.py());
        for (key, part) in parts {
            copies.set_item(key, fresh(&part)?)?;
        }
        return Ok(copies.into_any());
    }
    action.call_method0(intern!(action.py(), "copy"))
}

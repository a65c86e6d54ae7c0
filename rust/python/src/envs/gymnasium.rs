//! Helpers shared by the Gymnasium-facing classes: access to their generator, and Gymnasium's errors.

use pyo3::exceptions::PyAttributeError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyString, PyType};

/// The environment's generator, which the user may have replaced.
pub(super) fn generator<'py>(env: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    env.getattr(intern!(env.py(), "np_random"))
}

/// Whether a generator is exactly `numpy.random.Generator`, so that one call for many numbers draws the same as many
/// calls.
pub(super) fn is_numpy_generator(generator: &Bound<'_, PyAny>) -> bool {
    static GENERATOR: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let class = GENERATOR.import(generator.py(), "numpy.random", "Generator");
    class.is_ok_and(|class| generator.is_exact_instance(class))
}

/// An attribute that the first reset sets. Raises Gymnasium's `ResetNeeded` if it is missing.
pub(super) fn attribute_after_reset<'py>(
    env: &Bound<'py, PyAny>,
    name: &Bound<'py, PyString>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = env.py();
    env.getattr(name).map_err(|error| {
        if error.is_instance_of::<PyAttributeError>(py) {
            reset_needed(py, "Cannot call env.step() before calling env.reset()")
        } else {
            error
        }
    })
}

/// `gymnasium.error.ResetNeeded`
pub(super) fn reset_needed(py: Python<'_>, message: impl Into<String>) -> PyErr {
    let class = py.import(intern!(py, "gymnasium.error")).and_then(|module| module.getattr("ResetNeeded"));
    match class.and_then(|class| Ok(class.cast_into::<PyType>()?)) {
        Ok(class) => PyErr::from_type(class, message.into()),
        Err(error) => error,
    }
}

/// Renders a frame if `render_mode` is "human".
pub(super) fn render_if_human(env: &Bound<'_, PyAny>) -> PyResult<()> {
    let mode = env.getattr(intern!(env.py(), "render_mode"))?;
    if !mode.is_none() && mode.eq(intern!(env.py(), "human"))? {
        env.call_method0(intern!(env.py(), "render"))?;
    }
    Ok(())
}

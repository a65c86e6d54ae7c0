//! What steps Gymnasium's toy text: its own attributes, read anew at each step, so that whatever was assigned or edited
//! counts; its own generator, called in Python. What is odd in any way steps in Gymnasium's code.

use numpy::{PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyAttributeError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyInt, PyList, PyString, PyTuple, PyType};

use crate::numbers::double;

/// The base of the environments that are no more than their table `P`.
#[pyclass(subclass, frozen, module = "qtab._core")]
pub(crate) struct Table;

#[pymethods]
impl Table {
    #[new]
    #[pyo3(signature = (*_args, **_kwargs))]
    fn new(_args: &Bound<'_, PyTuple>, _kwargs: Option<&Bound<'_, PyDict>>) -> Self {
        Self
    }

    /// The first state, from the generator as it stands; what `reset` returns.
    fn begin<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let Some(state) = draw_first(slf)? else { return begin_in_python(slf) };
        slf.setattr(intern!(py, "s"), &state)?;
        slf.setattr(intern!(py, "lastaction"), py.None())?;
        watch(slf)?;
        let info = PyDict::new(py);
        info.set_item(intern!(py, "prob"), 1)?;
        Ok((python_int(state)?, info).into_pyobject(py)?.into_any())
    }

    /// One step, with the types that Gymnasium returns.
    fn step<'py>(slf: &Bound<'py, Self>, action: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let Some(landing) = draw(slf, action, |_| true)? else { return in_python(slf, action) };
        slf.setattr(intern!(py, "s"), &landing.state)?;
        slf.setattr(intern!(py, "lastaction"), action)?;
        watch(slf)?;
        let info = PyDict::new(py);
        info.set_item(intern!(py, "prob"), landing.probability)?;
        let answer = (python_int(landing.state)?, landing.reward, landing.terminated, false, info);
        Ok(answer.into_pyobject(py)?.into_any())
    }
}

/// The entry of `P` that was drawn, its objects as they stand there.
pub(crate) struct Landing<'py> {
    pub(crate) probability: Bound<'py, PyAny>,
    pub(crate) state: Bound<'py, PyAny>,
    pub(crate) reward: Bound<'py, PyAny>,
    pub(crate) terminated: Bound<'py, PyAny>,
}

/// Gymnasium's `categorical_sample` of `P[s][action]`; None before anything was drawn or changed, where an entry is
/// not as Gymnasium's are or its state not `fit`.
pub(crate) fn draw<'py>(
    env: &Bound<'py, PyAny>,
    action: &Bound<'py, PyAny>,
    fit: impl Fn(&Bound<'py, PyAny>) -> bool,
) -> PyResult<Option<Landing<'py>>> {
    let py = env.py();
    let here = reset(env, intern!(py, "s"))?;
    // What fails here fails in Gymnasium's code, too, and says so there.
    let found =
        env.getattr(intern!(py, "P")).and_then(|table| table.get_item(here)).and_then(|row| row.get_item(action));
    let Some(outcomes) = found.ok().and_then(|outcomes| outcomes.cast_into_exact::<PyList>().ok()) else {
        return Ok(None);
    };
    for outcome in &outcomes {
        let Ok(outcome) = outcome.cast_into_exact::<PyTuple>() else { return Ok(None) };
        if outcome.len() != 4 || !probability(&outcome)?.is_finite() || !fit(&outcome.get_item(1)?) {
            return Ok(None);
        }
    }
    if outcomes.is_empty() {
        return Ok(None);
    }
    let random: f64 = generator(env)?.call_method0(intern!(py, "random"))?.extract()?;
    let (mut sum, mut chosen) = (0.0, None);
    for outcome in &outcomes {
        let outcome = outcome.cast_into::<PyTuple>()?;
        sum += probability(&outcome)?;
        if sum > random {
            chosen = Some(outcome);
            break;
        }
    }
    let chosen = match chosen {
        Some(outcome) => outcome,
        None => outcomes.get_item(0)?.cast_into()?,
    };
    let (probability, state, reward, terminated) = chosen.extract()?;
    Ok(Some(Landing { probability, state, reward, terminated }))
}

/// Gymnasium's `categorical_sample` of `initial_state_distrib`, an `np.int64`; None before anything was drawn, where that
/// is no row of float64.
pub(crate) fn draw_first<'py>(env: &Bound<'py, PyAny>) -> PyResult<Option<Bound<'py, PyAny>>> {
    let py = env.py();
    let Some(weights) = env.getattr_opt(intern!(py, "initial_state_distrib"))? else { return Ok(None) };
    let Ok(weights) = weights.cast_into::<PyArray1<f64>>() else { return Ok(None) };
    let Ok(weights) = weights.try_readonly() else { return Ok(None) };
    if weights.is_empty() {
        return Ok(None);
    }
    let random: f64 = generator(env)?.call_method0(intern!(py, "random"))?.extract()?;
    let mut sum = 0.0;
    let chosen = weights.as_array().iter().position(|weight| {
        sum += weight;
        sum > random
    });
    let state = chosen.and_then(|state| i64::try_from(state).ok()).unwrap_or(0);
    PyArray1::from_slice(py, &[state]).get_item(0).map(Some)
}

/// Of an outcome; NaN for what sums otherwise than floats.
fn probability(outcome: &Bound<'_, PyTuple>) -> PyResult<f64> {
    Ok(double(&outcome.get_item(0)?).unwrap_or(f64::NAN))
}

/// The attribute that the first reset makes.
pub(crate) fn reset<'py>(env: &Bound<'py, PyAny>, name: &Bound<'py, PyString>) -> PyResult<Bound<'py, PyAny>> {
    let py = env.py();
    env.getattr(name).map_err(|error| {
        if !error.is_instance_of::<PyAttributeError>(py) {
            return error;
        }
        let text = "Cannot call env.step() before calling env.reset()";
        let class = py.import(intern!(py, "gymnasium.error")).and_then(|module| module.getattr("ResetNeeded"));
        match class.and_then(|class| Ok(class.cast_into::<PyType>()?)) {
            Ok(class) => PyErr::from_type(class, text),
            Err(error) => error,
        }
    })
}

/// The user's own generator.
pub(crate) fn generator<'py>(env: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    env.getattr(intern!(env.py(), "np_random"))
}

/// The reset in Gymnasium's code, its generator seeded before.
pub(crate) fn begin_in_python<'py>(env: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    env.call_method0(intern!(env.py(), "reset_in_python"))
}

/// The step in Gymnasium's code.
pub(crate) fn in_python<'py>(env: &Bound<'py, PyAny>, action: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    env.call_method1(intern!(env.py(), "step_in_python"), (action,))
}

/// Draws a frame where a person watches.
pub(crate) fn watch(env: &Bound<'_, PyAny>) -> PyResult<()> {
    let mode = env.getattr(intern!(env.py(), "render_mode"))?;
    if !mode.is_none() && mode.eq(intern!(env.py(), "human"))? {
        env.call_method0(intern!(env.py(), "render"))?;
    }
    Ok(())
}

/// `int(value)`
pub(crate) fn python_int(value: Bound<'_, PyAny>) -> PyResult<Bound<'_, PyAny>> {
    if value.is_exact_instance_of::<PyInt>() {
        return Ok(value);
    }
    value.py().get_type::<PyInt>().call1((value,))
}

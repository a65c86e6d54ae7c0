//! The return values of a Python environment's methods, checked against Gymnasium's API.

use pyo3::Borrowed;
use pyo3::exceptions::{PyOverflowError, PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyBytes, PyDict, PyFloat, PyString, PyTuple};

/// The return value of `step`.
pub(super) struct Answer<'a, 'py> {
    pub(super) observation: Borrowed<'a, 'py, PyAny>,
    pub(super) reward: f64,
    pub(super) terminated: bool,
    pub(super) truncated: bool,
    pub(super) info: Borrowed<'a, 'py, PyAny>,
}

impl<'a, 'py> Answer<'a, 'py> {
    /// Unpacks the return value of `env.step`.
    pub(super) fn of_step(env: &Bound<'py, PyAny>, answer: &'a Bound<'py, PyAny>) -> PyResult<Self> {
        let expected = "a tuple (observation, reward, terminated, truncated, info)";
        let values = tuple_of(env, "step", expected, 5, answer)?;
        Ok(Self {
            observation: values.get_borrowed_item(0)?,
            reward: finite(env, &*values.get_borrowed_item(1)?)?,
            terminated: flag(env, "terminated", &*values.get_borrowed_item(2)?)?,
            truncated: flag(env, "truncated", &*values.get_borrowed_item(3)?)?,
            info: values.get_borrowed_item(4)?,
        })
    }
}

/// Unpacks the return value of `env.reset`.
pub(super) fn of_reset<'py>(
    env: &Bound<'py, PyAny>,
    answer: &Bound<'py, PyAny>,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
    let expected = "a tuple (observation, info)";
    let values = tuple_of(env, "reset", expected, 2, answer)?;
    let info = values.get_item(1)?;
    if !info.is_instance_of::<PyDict>() {
        // An observation of two components, as `reset` returned it before Gymnasium.
        return Err(wrong_type(env, "reset", "a dict as the info", &info));
    }
    Ok((values.get_item(0)?, info))
}

fn tuple_of<'a, 'py>(
    env: &Bound<'py, PyAny>,
    method: &str,
    expected: &str,
    length: usize,
    answer: &'a Bound<'py, PyAny>,
) -> PyResult<&'a Bound<'py, PyTuple>> {
    let Ok(values) = answer.cast::<PyTuple>() else {
        return Err(wrong_type(env, method, expected, answer));
    };
    if values.len() != length {
        let got = format!("a tuple of {}: {}", values.len(), shortened(answer));
        return Err(PyValueError::new_err(message(env, method, expected, &got)));
    }
    Ok(values)
}

fn finite(env: &Bound<'_, PyAny>, reward: &Bound<'_, PyAny>) -> PyResult<f64> {
    let expected = "a finite number as the reward";
    let number = match reward.cast_exact::<PyFloat>() {
        Ok(number) => number.value(),
        // A string has no `__float__`, and an array of several numbers refuses the conversion.
        Err(_) => reward.extract::<f64>().map_err(|error| {
            if error.is_instance_of::<PyOverflowError>(reward.py()) {
                return PyValueError::new_err(message(env, "step", expected, &shortened(reward)));
            }
            wrong_type(env, "step", expected, reward)
        })?,
    };
    if number.is_finite() {
        return Ok(number);
    }
    Err(PyValueError::new_err(message(env, "step", expected, &shortened(reward))))
}

/// A bool of Python, `NumPy` or an array library (without dimensions), or the integer 0 or 1.
fn flag(env: &Bound<'_, PyAny>, name: &str, value: &Bound<'_, PyAny>) -> PyResult<bool> {
    if let Ok(flag) = value.cast_exact::<PyBool>() {
        return Ok(flag.is_true());
    }
    let py = value.py();
    let is_number = value.hasattr(intern!(py, "__index__"))? || value.hasattr(intern!(py, "dtype"))?;
    let is_text = value.is_instance_of::<PyString>() || value.is_instance_of::<PyBytes>();
    let truth = value.is_truthy();
    match truth {
        Ok(truth) if is_number && !is_text && value.eq(truth).unwrap_or(false) => Ok(truth),
        _ => Err(wrong_type(env, "step", &format!("a bool as {name}"), value)),
    }
}

fn wrong_type(env: &Bound<'_, PyAny>, method: &str, expected: &str, got: &Bound<'_, PyAny>) -> PyErr {
    PyTypeError::new_err(message(env, method, expected, &shortened(got)))
}

fn message(env: &Bound<'_, PyAny>, method: &str, expected: &str, got: &str) -> String {
    let name = named(env);
    format!("{method} of {name} must return {expected}, as Gymnasium's API requires, got {got}")
}

/// The environment's name in messages.
pub(super) fn named(env: &Bound<'_, PyAny>) -> String {
    env.str().map_or_else(|_| "the environment".into(), |name| name.to_string())
}

/// The largest number of characters of a value that a message shows.
const SHOWN: usize = 80;

pub(super) fn shortened(value: &Bound<'_, PyAny>) -> String {
    let text = value.repr().map_or_else(|_| "an object without a repr".into(), |text| text.to_string());
    if text.chars().count() <= SHOWN {
        return text;
    }
    let start: String = text.chars().take(SHOWN).collect();
    format!("{start}...")
}

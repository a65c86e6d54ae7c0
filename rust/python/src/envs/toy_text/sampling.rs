//! Steps of Gymnasium's toy text. Each step reads Gymnasium's attributes again, so that assignments and edits take
//! effect, and draws from the environment's generator in Python. Values of other types than Gymnasium's step in
//! Gymnasium's code.

use numpy::{PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyInt, PyList, PyTuple};

use super::super::gymnasium::{attribute_after_reset, generator};
use crate::convert::{double, small_array};

/// The sampled transition, as it stands in `P`.
pub(super) struct SampledTransition<'py> {
    pub(super) probability: Bound<'py, PyAny>,
    pub(super) state: Bound<'py, PyAny>,
    pub(super) reward: Bound<'py, PyAny>,
    pub(super) terminated: Bound<'py, PyAny>,
}

/// Gymnasium's `categorical_sample` of `P[s][action]`. Returns None, and neither draws nor changes anything, if an
/// entry has other types than Gymnasium's, or its next state is not `valid`.
pub(super) fn sample_transition<'py>(
    env: &Bound<'py, PyAny>,
    action: &Bound<'py, PyAny>,
    valid: impl Fn(&Bound<'py, PyAny>) -> bool,
) -> PyResult<Option<SampledTransition<'py>>> {
    let py = env.py();
    let state = attribute_after_reset(env, intern!(py, "s"))?;
    // Any failure here also occurs in Gymnasium's code, with Gymnasium's error.
    let found =
        env.getattr(intern!(py, "P")).and_then(|table| table.get_item(state)).and_then(|row| row.get_item(action));
    let Some(outcomes) = found.ok().and_then(|outcomes| outcomes.cast_into_exact::<PyList>().ok()) else {
        return Ok(None);
    };
    for outcome in &outcomes {
        let Ok(outcome) = outcome.cast_into_exact::<PyTuple>() else { return Ok(None) };
        if outcome.len() != 4 || !probability(&outcome)?.is_finite() || !valid(&outcome.get_item(1)?) {
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
    Ok(Some(SampledTransition { probability, state, reward, terminated }))
}

/// Draws the initial state, and writes it and the absence of a last action. Returns None, and changes nothing, if the
/// distribution is not a float64 array.
pub(super) fn begin_episode<'py>(env: &Bound<'py, PyAny>) -> PyResult<Option<Bound<'py, PyAny>>> {
    let py = env.py();
    let Some(state) = sample_initial(env)? else { return Ok(None) };
    env.setattr(intern!(py, "s"), &state)?;
    env.setattr(intern!(py, "lastaction"), py.None())?;
    Ok(Some(state))
}

/// Gymnasium's `categorical_sample` of `initial_state_distrib`, an `np.int64`; None as for `begin_episode`.
fn sample_initial<'py>(env: &Bound<'py, PyAny>) -> PyResult<Option<Bound<'py, PyAny>>> {
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
    small_array(py, &[state]).get_item(0).map(Some)
}

/// The probability of an outcome; NaN for types that Python adds differently from floats.
fn probability(outcome: &Bound<'_, PyTuple>) -> PyResult<f64> {
    Ok(double(&outcome.get_item(0)?).unwrap_or(f64::NAN))
}

/// The reset in Gymnasium's code, after seeding the generator.
pub(super) fn reset_fallback<'py>(env: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    env.call_method0(intern!(env.py(), "_reset_in_python"))
}

/// The step in Gymnasium's code.
pub(super) fn step_fallback<'py>(env: &Bound<'py, PyAny>, action: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    env.call_method1(intern!(env.py(), "_step_in_python"), (action,))
}

/// `int(value)`
pub(super) fn python_int(value: Bound<'_, PyAny>) -> PyResult<Bound<'_, PyAny>> {
    if value.is_exact_instance_of::<PyInt>() {
        return Ok(value);
    }
    value.py().get_type::<PyInt>().call1((value,))
}

/// Writes the attributes that Gymnasium's table environments have: the state, and the last action.
pub(super) fn set_snapshot(attributes: &Bound<'_, PyDict>, state: u32, last_action: Option<usize>) -> PyResult<()> {
    let py = attributes.py();
    attributes.set_item(intern!(py, "s"), state)?;
    let action = last_action.map(|action| crate::vector::BatchAction::to_python(action, py)).transpose()?;
    attributes.set_item(intern!(py, "lastaction"), action)
}

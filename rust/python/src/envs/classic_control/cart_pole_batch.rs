//! The physics of Gymnasium's `CartPoleVectorEnv`, whose state is one array of all cart-poles.

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use qtab_core::StopFlag;
use qtab_core::envs::classic_control::CartPole;
use qtab_core::memory::{filled, with_capacity};

use super::dyn_env::read_parameters;
use super::numpy_uses_libm;
use crate::error::allocation;

/// `NumPy` warns of what it computes with larger numbers, so it computes with them.
const LARGEST: f64 = 1e6;

/// The next state, and whether it is terminal.
type NextStates<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<bool>>);

/// One step of all cart-poles, with the parameters that the attributes of `env` have. `state` is a (4, n) array of float64,
/// `actions` an (n,) array of int64. Returns the next state in a new array, and whether it is terminal; None for what Rust
/// would not compute as `NumPy` does, or where `NumPy` would warn.
#[pyfunction]
pub(crate) fn step_cart_poles<'py>(
    env: &Bound<'py, PyAny>,
    state: &Bound<'py, PyAny>,
    actions: &Bound<'py, PyAny>,
) -> PyResult<Option<NextStates<'py>>> {
    let py = env.py();
    let (Ok(state), Ok(actions)) = (state.cast::<PyArray2<f64>>(), actions.cast::<PyArray1<i64>>()) else {
        return Ok(None);
    };
    let mut cart_pole = CartPole::default();
    if !numpy_uses_libm(py)? || read_parameters(&mut cart_pole, env)?.is_some() {
        return Ok(None);
    }
    let count = actions.len();
    if state.shape() != [4, count] {
        return Ok(None);
    }
    let (state, actions) = (state.try_readonly()?, actions.try_readonly()?);
    let (Ok(numbers), Ok(actions)) = (state.as_slice(), actions.as_slice()) else { return Ok(None) };
    let supported =
        numbers.iter().all(|number| number.abs() <= LARGEST) && actions.iter().all(|&action| action >> 1 == 0);
    if !supported {
        return Ok(None);
    }

    let mut next = with_capacity(numbers.len()).map_err(allocation)?;
    next.extend_from_slice(numbers);
    let mut terminated = filled(&false, count, &StopFlag::new()).map_err(allocation)?;
    let (x, rest) = next.split_at_mut(count);
    let (x_dot, rest) = rest.split_at_mut(count);
    let (theta, theta_dot) = rest.split_at_mut(count);
    cart_pole.step_arrays([x, x_dot, theta, theta_dot], actions, &mut terminated);
    if !next.iter().all(|number| number.is_finite()) {
        return Ok(None);
    }
    Ok(Some((PyArray1::from_vec(py, next).reshape([4, count])?, PyArray1::from_vec(py, terminated))))
}

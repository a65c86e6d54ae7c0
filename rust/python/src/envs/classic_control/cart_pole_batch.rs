//! The physics of Gymnasium's `CartPoleVectorEnv`, whose state is one array of all cart-poles.

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use qtab_core::Env;
use qtab_core::StopFlag;
use qtab_core::envs::classic_control::{CartPole, CartPoleState};
use qtab_core::memory::{collect, filled};
use qtab_core::random::NoRng;

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

    let stop = StopFlag::new();
    let state_of = |index: usize| CartPoleState::from(std::array::from_fn(|field| numbers[field * count + index]));
    let mut states: Vec<CartPoleState> = collect((0..count).map(state_of)).map_err(allocation)?;
    let actions = collect(actions.iter().map(|&action| action as usize)).map_err(allocation)?;
    let mut rewards = filled(&0.0, count, &stop).map_err(allocation)?;
    let mut terminated = filled(&false, count, &stop).map_err(allocation)?;
    let inactive = filled(&false, count, &stop).map_err(allocation)?;
    let no_rngs: &mut [NoRng] = &mut [];
    cart_pole.step_batch(&mut states, &actions, no_rngs, &mut rewards, &mut terminated, &inactive);

    let mut next = filled(&0.0, numbers.len(), &stop).map_err(allocation)?;
    for (index, &state) in states.iter().enumerate() {
        for (field, number) in <[f64; 4]>::from(state).into_iter().enumerate() {
            next[field * count + index] = number;
        }
    }
    if !next.iter().all(|number| number.is_finite()) {
        return Ok(None);
    }
    Ok(Some((PyArray1::from_vec(py, next).reshape([4, count])?, PyArray1::from_vec(py, terminated))))
}

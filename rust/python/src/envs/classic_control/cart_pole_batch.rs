//! The physics of Gymnasium's `CartPoleVectorEnv`, whose state is a single array of all cart-poles.

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use qtab_core::StopFlag;
use qtab_core::envs::classic_control::CartPole;
use qtab_core::memory::{AllocationError, collect, filled, with_capacity};

use super::dyn_env::read_parameters;
use super::numpy_uses_libm;
use crate::error::allocation;

/// With larger numbers `NumPy` may warn, so `NumPy` takes those steps.
const LARGEST: f64 = 1e6;

/// The next states, their rewards, whether they are terminal, and the indices of those to reset.
type NextStates<'py> =
    (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f32>>, Bound<'py, PyArray1<bool>>, Bound<'py, PyArray1<i64>>);

/// One step of all cart-poles, with the parameters in the attributes of `env`. `state` is a (4, n) array of float64,
/// `actions` an (n,) array of int64, and `done` an (n,) array that tells whether the episode ended in the previous
/// step: its reward is then 0, and the caller resets it. Returns None if Rust would not compute the numbers of `NumPy`,
/// or if `NumPy` would warn.
#[pyfunction]
pub(crate) fn step_cart_poles<'py>(
    env: &Bound<'py, PyAny>,
    state: &Bound<'py, PyAny>,
    actions: &Bound<'py, PyAny>,
    done: &Bound<'py, PyAny>,
) -> PyResult<Option<NextStates<'py>>> {
    let py = env.py();
    let (Ok(state), Ok(actions), Ok(done)) =
        (state.cast::<PyArray2<f64>>(), actions.cast::<PyArray1<i64>>(), done.cast::<PyArray1<bool>>())
    else {
        return Ok(None);
    };
    let mut cart_pole = CartPole::default();
    if !numpy_uses_libm(py)? || read_parameters(&mut cart_pole, env)?.is_some() {
        return Ok(None);
    }
    let count = actions.len();
    if state.shape() != [4, count] || !state.is_c_contiguous() || done.len() != count {
        return Ok(None);
    }
    let (state, actions, done) = (state.try_readonly()?, actions.try_readonly()?, done.try_readonly()?);
    let (Ok(numbers), Ok(actions), Ok(done)) = (state.as_slice(), actions.as_slice(), done.as_slice()) else {
        return Ok(None);
    };
    // The union of all bits, without a branch for each action, which would keep the compiler from using SIMD.
    if actions.iter().fold(0, |bits, action| bits | action) >> 1 != 0 {
        return Ok(None);
    }

    let mut next = with_capacity(numbers.len()).map_err(allocation)?;
    next.extend_from_slice(numbers);
    let mut terminated = filled(&false, count, &StopFlag::new()).map_err(allocation)?;
    let (x, rest) = next.split_at_mut(count);
    let (x_dot, rest) = rest.split_at_mut(count);
    let (theta, theta_dot) = rest.split_at_mut(count);
    if !cart_pole.step_arrays([x, x_dot, theta, theta_dot], actions, &mut terminated, LARGEST) {
        return Ok(None);
    }
    let mut rewards = rewards(&cart_pole, &terminated).map_err(allocation)?;
    let mut over = Vec::new();
    for index in (0..count).filter(|&index| done[index]) {
        (rewards[index], terminated[index]) = (0.0, false);
        over.push(index.cast_signed() as i64);
    }
    let state = PyArray1::from_vec(py, next).reshape([4, count])?;
    Ok(Some((state, PyArray1::from_vec(py, rewards), PyArray1::from_vec(py, terminated), PyArray1::from_vec(py, over))))
}

/// The rewards of Gymnasium's `CartPoleVectorEnv`. With the book's rewards they are `-terminated`, so 0 has a sign.
fn rewards(cart_pole: &CartPole, terminated: &[bool]) -> Result<Vec<f32>, AllocationError> {
    collect(terminated.iter().map(
        |&terminated| {
            if cart_pole.sutton_barto_reward { -f32::from(u8::from(terminated)) } else { 1.0 }
        },
    ))
}

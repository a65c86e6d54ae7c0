//! Resets of Gymnasium's classes: the core's reset, with numbers from the user's generator.

use numpy::{PyArray1, PyArrayMethods};
use pyo3::intern;
use pyo3::prelude::*;
use qtab_core::Env;
use qtab_core::random::Rng;

use crate::convert::small_array;

pub(crate) struct ResetResult<'py> {
    pub(crate) state: Bound<'py, PyAny>,
    pub(crate) observation: Bound<'py, PyArray1<f32>>,
}

pub(super) type ResetOutcome<'py> = PyResult<Option<ResetResult<'py>>>;

/// The reset of an environment whose initial state is float64 in Gymnasium and takes `draws` random floats.
pub(super) fn reset_f64<'py, E, const N: usize, const M: usize>(
    env: &E,
    draws: usize,
    generator: &Bound<'py, PyAny>,
) -> ResetOutcome<'py>
where
    E: Env<Observation = [f32; M], State: Into<[f64; N]>>,
{
    let (state, observation) = reset(env, draws, generator)?;
    Ok(Some(ResetResult { state: small_array(generator.py(), &state.into()).into_any(), observation }))
}

/// The initial state, and its observation.
pub(super) fn reset<'py, E, const M: usize>(
    env: &E,
    draws: usize,
    generator: &Bound<'py, PyAny>,
) -> PyResult<(E::State, Bound<'py, PyArray1<f32>>)>
where
    E: Env<Observation = [f32; M]>,
{
    let py = generator.py();
    // One call for all numbers is faster than one call each, and draws the same numbers.
    let numbers = generator.call_method1(intern!(py, "random"), (draws,))?.cast_into::<PyArray1<f64>>()?.to_vec()?;
    let state = env.reset(&mut PresetDraws(numbers.into_iter()));
    Ok((state, small_array(py, &env.observe(&state))))
}

/// A generator that returns numbers drawn beforehand.
struct PresetDraws(std::vec::IntoIter<f64>);

impl Rng for PresetDraws {
    fn random(&mut self) -> f64 {
        self.0.next().unwrap_or_default()
    }

    /// No initial state of classic control uses integers.
    fn integers(&mut self, _below: u32) -> u32 {
        0
    }
}

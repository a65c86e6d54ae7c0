//! The beginning of an episode of classic control: the model's own reset, its draws from the user's generator.

use numpy::{PyArray1, PyArrayMethods};
use pyo3::intern;
use pyo3::prelude::*;
use qtab_core::env::Env;
use qtab_core::random::Draw;

use crate::model::Model;

/// What a reset in Rust brings.
pub(crate) struct Begun<'py> {
    pub(crate) state: Bound<'py, PyArray1<f64>>,
    pub(crate) observation: Bound<'py, PyArray1<f32>>,
}

impl Model {
    /// The first state as Gymnasium's class draws it; None leaves it to Gymnasium's code, nothing drawn.
    pub(crate) fn begin<'py>(&self, generator: &Bound<'py, PyAny>) -> PyResult<Option<Begun<'py>>> {
        match self {
            Self::MountainCar(env) => begun(env, 1, generator).map(Some),
            Self::CartPole(env) => begun(env, 4, generator).map(Some),
            Self::Pendulum(env) => begun(env, 2, generator).map(Some),
            Self::ContinuousMountainCar(env) => begun(env, 1, generator).map(Some),
            // Its first state is float32, whose sine NumPy computes in another way.
            Self::Acrobot(_) => Ok(None),
        }
    }
}

fn begun<'py, E, const N: usize, const M: usize>(
    env: &E,
    draws: usize,
    generator: &Bound<'py, PyAny>,
) -> PyResult<Begun<'py>>
where
    E: Env<Observation = [f32; M], State: Into<[f64; N]>>,
{
    let py = generator.py();
    // All at once come sooner than one after the other, and are the same.
    let numbers = generator.call_method1(intern!(py, "random"), (draws,))?.cast_into::<PyArray1<f64>>()?.to_vec()?;
    let state = env.reset(&mut Drawn(numbers.into_iter()));
    let observation = PyArray1::from_slice(py, &env.observe(&state));
    Ok(Begun { state: PyArray1::from_slice(py, &state.into()), observation })
}

/// As many numbers as the model's reset takes.
struct Drawn(std::vec::IntoIter<f64>);

impl Draw for Drawn {
    fn random(&mut self) -> f64 {
        self.0.next().unwrap_or_default()
    }

    /// No first state of classic control takes integers.
    fn integers(&mut self, _below: u32) -> u32 {
        0
    }
}

//! The beginning of an episode of classic control: the model's own reset, its draws from the user's generator.

use numpy::{PyArray1, PyArrayMethods};
use pyo3::intern;
use pyo3::prelude::*;
use qtab_core::Env;
use qtab_core::envs::classic_control::Acrobot;
use qtab_core::random::Rng;

use crate::model::Model;
use crate::trigonometry::single_precision;

/// What a reset in Rust brings.
pub(crate) struct Begun<'py> {
    pub(crate) state: Bound<'py, PyAny>,
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
            Self::Acrobot(env) => {
                let Some(single) = single_precision(generator.py())? else { return Ok(None) };
                let (state, observation) = drawn(&Acrobot { f32_cos_sin: single, ..*env }, 4, generator)?;
                // Its first state is float32.
                let state = PyArray1::from_iter(generator.py(), <[f64; 4]>::from(state).map(|angle| angle as f32));
                Ok(Some(Begun { state: state.into_any(), observation }))
            }
        }
    }
}

/// A first state that Gymnasium keeps in float64.
fn begun<'py, E, const N: usize, const M: usize>(
    env: &E,
    draws: usize,
    generator: &Bound<'py, PyAny>,
) -> PyResult<Begun<'py>>
where
    E: Env<Observation = [f32; M], State: Into<[f64; N]>>,
{
    let (state, observation) = drawn(env, draws, generator)?;
    Ok(Begun { state: PyArray1::from_slice(generator.py(), &state.into()).into_any(), observation })
}

fn drawn<'py, E, const M: usize>(
    env: &E,
    draws: usize,
    generator: &Bound<'py, PyAny>,
) -> PyResult<(E::State, Bound<'py, PyArray1<f32>>)>
where
    E: Env<Observation = [f32; M]>,
{
    let py = generator.py();
    // All at once come sooner than one after the other, and are the same.
    let numbers = generator.call_method1(intern!(py, "random"), (draws,))?.cast_into::<PyArray1<f64>>()?.to_vec()?;
    let state = env.reset(&mut Drawn(numbers.into_iter()));
    Ok((state, PyArray1::from_slice(py, &env.observe(&state))))
}

/// As many numbers as the model's reset takes.
struct Drawn(std::vec::IntoIter<f64>);

impl Rng for Drawn {
    fn random(&mut self) -> f64 {
        self.0.next().unwrap_or_default()
    }

    /// No first state of classic control takes integers.
    fn integers(&mut self, _below: u32) -> u32 {
        0
    }
}

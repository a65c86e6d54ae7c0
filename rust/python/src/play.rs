//! What it takes to step a model as Gymnasium's class does: its types, and what else it changes.

use numpy::PyArray1;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat};
use qtab_core::Env;
use qtab_core::envs::Step;
use qtab_core::numeric::Scalar;
use qtab_core::random::NoRng;

use crate::model::Model;
use crate::numbers::{Values, double, force, index, numpy_scalar};

/// The state of an episode.
pub(crate) enum State {
    /// Never assigned.
    Missing,
    /// As a step in Rust left it, zeros behind: an array of f64 in Gymnasium.
    Rust([f64; 4]),
    /// Assigned from Python, or handed out to it. An array can be written to, so it is read anew at each step.
    Python(Py<PyAny>),
}

/// What a step in Rust brings.
pub(crate) struct Played<'py> {
    pub(crate) state: State,
    pub(crate) observation: Bound<'py, PyAny>,
    pub(crate) reward: Bound<'py, PyAny>,
    pub(crate) terminated: bool,
    /// Whether no number ran over.
    finite: bool,
}

impl Model {
    /// One step as Gymnasium's class takes it; None leaves it to Gymnasium's code, nothing having changed.
    pub(crate) fn play<'py>(
        &self,
        face: &Bound<'py, PyAny>,
        values: &Values,
        action: &Bound<'py, PyAny>,
    ) -> PyResult<Option<Played<'py>>> {
        let py = face.py();
        match self {
            Self::MountainCar(env) => {
                let Some((state, action)) = values.doubles().zip(index(action, env.num_actions())) else {
                    return Ok(None);
                };
                let step = env.step(<[f64; 2]>::into(state), action, &mut NoRng);
                Ok(played(py, env, step).if_finite())
            }
            Self::CartPole(env) => {
                let Some((state, action)) = values.doubles().zip(index(action, env.num_actions())) else {
                    return Ok(None);
                };
                let step = env.step(<[f64; 4]>::into(state), action, &mut NoRng);
                let played = played(py, env, step).if_finite();
                if played.is_some() && step.terminated {
                    face.setattr(intern!(py, "steps_beyond_terminated"), 0)?;
                }
                Ok(played)
            }
            Self::Acrobot(env) => {
                let torque = face.getattr(intern!(py, "AVAIL_TORQUE"))?.get_item(action)?;
                let Some(mut torque) = double(&torque) else { return Ok(None) };
                let state = <[f64; 4]>::into(values.numbers());
                let most = env.torque_noise_max;
                if most > 0.0 {
                    let generator = face.getattr(intern!(py, "np_random"))?;
                    torque += generator.call_method1(intern!(py, "uniform"), (-most, most))?.extract::<f64>()?;
                    // What was drawn is drawn: no second try in Python.
                    return Ok(Some(played(py, env, env.transition(state, torque))));
                }
                Ok(played(py, env, env.transition(state, torque)).if_finite())
            }
            Self::Pendulum(env) => {
                let Some((state, u)) = values.double_array().zip(force(action)) else { return Ok(None) };
                let step = env.step(<[f64; 2]>::into(state), u, &mut NoRng);
                let Some(mut played) = played(py, env, step).if_finite() else { return Ok(None) };
                played.reward = numpy_scalar(py, Scalar::Double(step.reward))?;
                // For rendering. Straight to its place, since no constant changes.
                let attributes = face.getattr(intern!(py, "__dict__"))?.cast_into::<PyDict>()?;
                attributes.set_item(intern!(py, "last_u"), numpy_scalar(py, env.torque(u))?)?;
                Ok(Some(played))
            }
            Self::ContinuousMountainCar(env) => {
                let Some((state, action)) = values.scalars().zip(force(action)) else { return Ok(None) };
                let step = env.step(<[Scalar; 2]>::into(state), action, &mut NoRng);
                let mut played = played::<_, 2, 2>(py, env, step);
                // Gymnasium hands out its state itself.
                played.state = State::Python(played.observation.clone().unbind());
                Ok(played.if_finite())
            }
        }
    }
}

/// A step whose state is kept as f64 and whose reward is a Python float.
fn played<'py, E, const N: usize, const M: usize>(py: Python<'py>, env: &E, step: Step<E::State>) -> Played<'py>
where
    E: Env<Observation = [f32; M], State: Into<[f64; N]>>,
{
    let mut state = [0.0; 4];
    state[..N].copy_from_slice(&step.state.into());
    let observation = env.observe(&step.state);
    Played {
        state: State::Rust(state),
        observation: PyArray1::from_slice(py, &observation).into_any(),
        reward: PyFloat::new(py, step.reward).into_any(),
        terminated: step.terminated,
        finite: step.reward.is_finite() && observation.iter().all(|number| number.is_finite()),
    }
}

impl Played<'_> {
    /// Where numbers run over, Python and `NumPy` warn or raise: Gymnasium's code is to do so.
    fn if_finite(self) -> Option<Self> {
        self.finite.then_some(self)
    }
}

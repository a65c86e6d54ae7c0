//! The environments that Rust knows, by name: one variant each, and what it takes to step it as Gymnasium does.

use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat};
use qtab_core::env::{Env, Parameters, Step, Switch};
use qtab_core::envs::{Acrobot, CartPole, ContinuousMountainCar, MountainCar, Pendulum, Scalar};
use qtab_core::random::NoDraw;

use crate::numbers::{Values, double, force, index, numpy_scalar};
use crate::physics::{Physics, State};

/// An environment chosen at run time.
#[derive(Clone, Copy)]
pub(crate) enum Model {
    MountainCar(MountainCar),
    CartPole(CartPole),
    Acrobot(Acrobot),
    Pendulum(Pendulum),
    ContinuousMountainCar(ContinuousMountainCar),
}

/// How Gymnasium's class behaves, besides its constants.
pub(crate) struct Habits {
    /// How many numbers make its state …
    pub(crate) state: usize,
    /// … and whether it keeps them in a tuple, not in an array.
    pub(crate) tuple: bool,
    /// How many actions its step accepts, where it asks its action space.
    pub(crate) actions: Option<usize>,
    /// Whether its step calls `np.sin` or `np.cos`.
    pub(crate) trigonometry: bool,
    /// The attribute that is None while an episode is under way.
    pub(crate) none: Option<&'static str>,
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

/// The constants of a model, whatever its type.
pub(crate) trait Constants {
    fn names(&self) -> &'static [&'static str];
    fn switches(&self) -> &'static [Switch];
    fn parameter(&mut self, name: &str) -> Option<&mut f64>;
    fn switch(&mut self, name: &str) -> Option<&mut bool>;
}

impl<P: Parameters> Constants for P {
    fn names(&self) -> &'static [&'static str] {
        P::NAMES
    }
    fn switches(&self) -> &'static [Switch] {
        P::SWITCHES
    }
    fn parameter(&mut self, name: &str) -> Option<&mut f64> {
        Parameters::parameter(self, name)
    }
    fn switch(&mut self, name: &str) -> Option<&mut bool> {
        Parameters::switch(self, name)
    }
}

impl Model {
    pub(crate) fn new(name: &str) -> PyResult<Self> {
        Ok(match name {
            "MountainCar" => Self::MountainCar(MountainCar::default()),
            "CartPole" => Self::CartPole(CartPole::default()),
            "Acrobot" => Self::Acrobot(Acrobot::default()),
            "Pendulum" => Self::Pendulum(Pendulum::default()),
            "ContinuousMountainCar" => Self::ContinuousMountainCar(ContinuousMountainCar::default()),
            _ => return Err(PyValueError::new_err(format!("model must be one that Rust knows, got {name:?}"))),
        })
    }

    pub(crate) fn constants(&mut self) -> &mut dyn Constants {
        match self {
            Self::MountainCar(env) => env,
            Self::CartPole(env) => env,
            Self::Acrobot(env) => env,
            Self::Pendulum(env) => env,
            Self::ContinuousMountainCar(env) => env,
        }
    }

    pub(crate) fn habits(&self) -> Habits {
        let habits = Habits { state: 2, tuple: false, actions: None, trigonometry: true, none: None };
        match self {
            Self::MountainCar(env) => {
                Habits { tuple: true, actions: Some(env.actions()), trigonometry: false, ..habits }
            }
            Self::CartPole(env) => {
                Habits { state: 4, actions: Some(env.actions()), none: Some("steps_beyond_terminated"), ..habits }
            }
            Self::Acrobot(_) => Habits { state: 4, ..habits },
            Self::Pendulum(_) => habits,
            Self::ContinuousMountainCar(_) => Habits { trigonometry: false, ..habits },
        }
    }

    /// One step as Gymnasium's class takes it; None leaves it to Gymnasium's code, nothing having changed.
    pub(crate) fn play<'py>(
        &self,
        face: &Bound<'py, Physics>,
        values: &Values,
        action: &Bound<'py, PyAny>,
    ) -> PyResult<Option<Played<'py>>> {
        let py = face.py();
        match self {
            Self::MountainCar(env) => {
                let Some((state, action)) = values.doubles().zip(index(action, env.actions())) else { return Ok(None) };
                let step = env.step(<[f64; 2]>::into(state), action, &mut NoDraw);
                Ok(played(py, env, step).if_finite())
            }
            Self::CartPole(env) => {
                let Some((state, action)) = values.doubles().zip(index(action, env.actions())) else { return Ok(None) };
                let step = env.step(<[f64; 4]>::into(state), action, &mut NoDraw);
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
                    return Ok(Some(played(py, env, env.swing(state, torque))));
                }
                Ok(played(py, env, env.swing(state, torque)).if_finite())
            }
            Self::Pendulum(env) => {
                let Some((state, u)) = values.double_array().zip(force(action)) else { return Ok(None) };
                let step = env.step(<[f64; 2]>::into(state), u, &mut NoDraw);
                let Some(mut played) = played(py, env, step).if_finite() else { return Ok(None) };
                played.reward = numpy_scalar(py, Scalar::Double(step.reward))?;
                // For rendering. Straight to its place, since no constant changes.
                let attributes = face.getattr(intern!(py, "__dict__"))?.cast_into::<PyDict>()?;
                attributes.set_item(intern!(py, "last_u"), numpy_scalar(py, env.torque(u))?)?;
                Ok(Some(played))
            }
            Self::ContinuousMountainCar(env) => {
                let Some((state, action)) = values.scalars().zip(force(action)) else { return Ok(None) };
                let step = env.step(<[Scalar; 2]>::into(state), action, &mut NoDraw);
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

/// The names of a model's constants, as Gymnasium spells its attributes.
#[pyfunction]
pub(crate) fn parameter_names(model: &str) -> PyResult<Vec<&'static str>> {
    Ok(Model::new(model)?.constants().names().to_vec())
}

//! The environments that Rust knows, by name: one variant each.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use qtab_core::Env;
use qtab_core::envs::classic_control::{Acrobot, CartPole, ContinuousMountainCar, MountainCar, Pendulum};
use qtab_core::envs::{Flag, Parameters};

use crate::numbers::constant;

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

/// The constants of a model, whatever its type.
pub(crate) trait Constants {
    fn names(&self) -> &'static [&'static str];
    fn switches(&self) -> &'static [Flag];
    fn parameter(&mut self, name: &str) -> Option<&mut f64>;
    fn switch(&mut self, name: &str) -> Option<&mut bool>;
}

impl<P: Parameters> Constants for P {
    fn names(&self) -> &'static [&'static str] {
        P::NAMES
    }
    fn switches(&self) -> &'static [Flag] {
        P::FLAGS
    }
    fn parameter(&mut self, name: &str) -> Option<&mut f64> {
        Parameters::parameter(self, name)
    }
    fn switch(&mut self, name: &str) -> Option<&mut bool> {
        Parameters::flag(self, name)
    }
}

/// Gymnasium's name for the torques of Acrobot's actions.
pub(crate) const TORQUES: &str = "AVAIL_TORQUE";

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

    /// Takes on the constants of Gymnasium's environment; returns the name of one that Rust does not stand for.
    pub(crate) fn read(&mut self, environment: &Bound<'_, PyAny>) -> PyResult<Option<&'static str>> {
        let constants = self.constants();
        for &name in constants.names() {
            let value = environment.getattr_opt(name)?;
            let (Some(parameter), Some(number)) = (constants.parameter(name), value.and_then(|value| constant(&value)))
            else {
                return Ok(Some(name));
            };
            *parameter = number;
        }
        for switch in constants.switches() {
            let value = environment.getattr_opt(switch.name)?;
            let (Some(on), Some(value)) = (constants.switch(switch.name), value) else { return Ok(Some(switch.name)) };
            *on = switch.true_value.map_or_else(|| value.is_truthy(), |word| value.eq(word))?;
        }
        Ok(None)
    }

    pub(crate) fn habits(&self) -> Habits {
        let habits = Habits { state: 2, tuple: false, actions: None, trigonometry: true, none: None };
        match self {
            Self::MountainCar(env) => {
                Habits { tuple: true, actions: Some(env.num_actions()), trigonometry: false, ..habits }
            }
            Self::CartPole(env) => {
                Habits { state: 4, actions: Some(env.num_actions()), none: Some("steps_beyond_terminated"), ..habits }
            }
            Self::Acrobot(_) => Habits { state: 4, ..habits },
            Self::Pendulum(_) => habits,
            Self::ContinuousMountainCar(_) => Habits { trigonometry: false, ..habits },
        }
    }
}

/// The names of all that is constant in a model, as Gymnasium spells its attributes.
#[pyfunction]
pub(crate) fn parameter_names(model: &str) -> PyResult<Vec<&'static str>> {
    let mut model = Model::new(model)?;
    let torques = matches!(model, Model::Acrobot(_)).then_some(TORQUES);
    let constants = model.constants();
    let switches = constants.switches().iter().map(|switch| switch.name);
    Ok(constants.names().iter().copied().chain(switches).chain(torques).collect())
}

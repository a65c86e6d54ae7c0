//! The environments that Rust knows, by name: one variant and one arm each.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use qtab_core::env::Parameters;
use qtab_core::envs::MountainCar;

/// An environment chosen at run time.
#[derive(Clone, Copy)]
pub(crate) enum Model {
    MountainCar(MountainCar),
}

impl Model {
    pub(crate) fn new(name: &str) -> PyResult<Self> {
        match name {
            "MountainCar" => Ok(Self::MountainCar(MountainCar::default())),
            _ => Err(PyValueError::new_err(format!("model must be 'MountainCar', got {name:?}"))),
        }
    }

    pub(crate) fn parameter(&mut self, name: &str) -> PyResult<&mut f64> {
        match self {
            Self::MountainCar(env) => env.parameter(name),
        }
        .ok_or_else(|| PyValueError::new_err(format!("the environment has no parameter {name:?}")))
    }

    fn names(self) -> &'static [&'static str] {
        match self {
            Self::MountainCar(_) => MountainCar::NAMES,
        }
    }
}

/// The names of a model's constants, as Gymnasium spells its attributes.
#[pyfunction]
pub(crate) fn parameter_names(model: &str) -> PyResult<Vec<&'static str>> {
    Ok(Model::new(model)?.names().to_vec())
}

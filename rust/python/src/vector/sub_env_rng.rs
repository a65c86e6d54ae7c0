//! The random generators of sub-environments.

use pyo3::intern;
use pyo3::prelude::*;
use qtab_core::checkpoint::{Checkpoint, CheckpointError, Persist};
use qtab_core::random::{Pcg64, Rng};

use crate::convert::Seed;
use crate::rng::environment_rng;

/// A sub-environment's `np_random`: a generator in Rust until Python reads it, then a `NumPy` generator, so that the
/// two never diverge.
pub(crate) enum SubEnvRng {
    Native(Pcg64),
    /// A `numpy.random.Generator`.
    Python(Py<PyAny>),
}

impl SubEnvRng {
    /// The generator of `env.reset(seed=seed)`.
    pub(crate) fn new(seed: &Seed) -> Self {
        Self::Native(environment_rng(seed))
    }
}

/// The number returned by a method of `NumPy`'s generator. The call fails only if memory runs out, which a generator
/// cannot report.
fn returned<T: Default + for<'a, 'py> FromPyObject<'a, 'py, Error: Into<PyErr>>>(
    py: Python<'_>,
    number: PyResult<Bound<'_, PyAny>>,
) -> T {
    number.and_then(|number| number.extract().map_err(Into::into)).unwrap_or_else(|error| {
        error.write_unraisable(py, None);
        T::default()
    })
}

impl Rng for SubEnvRng {
    #[inline]
    fn random(&mut self) -> f64 {
        match self {
            Self::Native(rng) => rng.random(),
            Self::Python(generator) => {
                Python::attach(|py| returned(py, generator.bind(py).call_method0(intern!(py, "random"))))
            }
        }
    }

    #[inline]
    fn integers(&mut self, below: u32) -> u32 {
        match self {
            Self::Native(rng) => rng.integers(below),
            Self::Python(generator) => Python::attach(|py| {
                returned(py, generator.bind(py).call_method1(intern!(py, "integers"), (0, below.max(1))))
            }),
        }
    }
}

/// For a generator in Rust, its position, restored into a generator of the same seed. For a Python generator, only that
/// it is one: Python copies and pickles it.
impl Persist for SubEnvRng {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        let mut native = matches!(self, Self::Native(_));
        native.persist(checkpoint)?;
        match self {
            Self::Native(rng) if native => rng.persist(checkpoint),
            _ => Ok(()),
        }
    }
}

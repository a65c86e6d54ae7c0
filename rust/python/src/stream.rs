//! The streams, for those who want to hold them against `NumPy`'s.

use std::sync::{Mutex, PoisonError};

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use qtab_core::random;
use qtab_core::random::{Pcg64, Rng, SeedSequence};

/// The agent's stream: `NumPy`'s generator of that name, with the draws that learners make.
#[pyclass(frozen, module = "qtab._core")]
pub(crate) struct Stream(Mutex<random::AgentRng>);

/// `seed` comes as 32-bit words, least significant first.
pub(crate) fn agent_stream(bit_generator: &str, seed: &[u32]) -> PyResult<random::AgentRng> {
    match (bit_generator, seed) {
        ("PCG64", _) => Ok(random::AgentRng::pcg64(&SeedSequence::new(seed))),
        ("MT19937", &[seed]) => Ok(random::AgentRng::mt19937(seed)),
        ("MT19937", _) => Err(PyValueError::new_err("seed must lie in 0 to 2**32 - 1 for MT19937")),
        _ => Err(PyValueError::new_err(format!("bit_generator must be 'PCG64' or 'MT19937', got {bit_generator:?}"))),
    }
}

/// `env.reset(seed=seed)`'s generator.
pub(crate) fn environment_stream(seed: &[u32]) -> Pcg64 {
    Pcg64::new(&SeedSequence::new(seed))
}

impl Stream {
    fn with<T>(&self, draw: impl FnOnce(&mut random::AgentRng) -> T) -> T {
        draw(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

#[pymethods]
impl Stream {
    #[new]
    fn new(bit_generator: &str, seed: Vec<u32>) -> PyResult<Self> {
        Ok(Self(Mutex::new(agent_stream(bit_generator, &seed)?)))
    }

    fn random(&self) -> f64 {
        self.with(Rng::random)
    }

    fn integers(&self, below: u32) -> u32 {
        self.with(|stream| stream.integers(below))
    }

    fn uniform(&self, low: f64, high: f64) -> f64 {
        self.with(|stream| stream.uniform(low, high))
    }
}

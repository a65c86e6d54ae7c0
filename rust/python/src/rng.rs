//! Random generators: the environment's and the agent's, seeded like `NumPy`'s.

use std::sync::Mutex;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use qtab_core::random::{AgentRng, Pcg64, Rng, SeedSequence};

use crate::convert::Seed;
use crate::error::invalid;
use crate::locks::lock;

/// The agent's bit generator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BitGenerator {
    Pcg64,
    Mt19937,
}

impl BitGenerator {
    /// The bit generators by their `NumPy` names.
    pub(crate) const WORDS: &'static [(&'static str, Self)] = &[("PCG64", Self::Pcg64), ("MT19937", Self::Mt19937)];

    /// The agent's generator.
    pub(crate) fn agent_rng(self, seed: &Seed) -> PyResult<AgentRng> {
        match (self, seed.words()) {
            (Self::Pcg64, _) => Ok(AgentRng::Pcg64(agent_pcg64(seed))),
            (Self::Mt19937, &[word]) => Ok(AgentRng::mt19937(word)),
            (Self::Mt19937, _) => Err(PyValueError::new_err("seed must lie in 0 to 2**32 - 1 for MT19937")),
        }
    }
}

/// The agent's generator of kind PCG64.
pub(crate) fn agent_pcg64(seed: &Seed) -> Pcg64 {
    Pcg64::new(&SeedSequence::new(seed.words()).child(0))
}

/// The generator of `env.reset(seed=seed)`.
pub(crate) fn environment_rng(seed: &Seed) -> Pcg64 {
    Pcg64::new(&SeedSequence::new(seed.words()))
}

/// The agent's generator, for comparison with `NumPy`'s.
#[pyclass(frozen, name = "AgentRng", module = "qtab._core")]
pub(crate) struct PyAgentRng(Mutex<AgentRng>);

impl PyAgentRng {
    fn with<T>(&self, draw: impl FnOnce(&mut AgentRng) -> T) -> T {
        draw(&mut lock(&self.0))
    }
}

#[pymethods]
impl PyAgentRng {
    #[new]
    fn new(bit_generator: &str, seed: Seed) -> PyResult<Self> {
        let found = BitGenerator::WORDS.iter().find(|(word, _)| *word == bit_generator);
        let &(_, kind) =
            found.ok_or_else(|| invalid("bit_generator", "'PCG64' or 'MT19937'", format!("'{bit_generator}'")))?;
        Ok(Self(Mutex::new(kind.agent_rng(&seed)?)))
    }

    /// A float in [0, 1).
    fn random(&self) -> f64 {
        self.with(Rng::random)
    }

    /// An integer from 0 to `below` - 1.
    fn integers(&self, below: u32) -> u32 {
        self.with(|rng| rng.integers(below))
    }

    /// A float in [`low`, `high`).
    fn uniform(&self, low: f64, high: f64) -> f64 {
        self.with(|rng| rng.uniform(low, high))
    }
}

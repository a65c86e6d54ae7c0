//! The agent's random generator, chosen at run time.

use super::{Mt19937, Pcg64, Rng, SeedSequence};
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};

/// The agent's random generator, one variant per bit generator.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AgentRng {
    /// `numpy.random.Generator(PCG64(…))`
    Pcg64(Pcg64),
    /// `numpy.random.RandomState(seed)`
    Mt19937(Box<Mt19937>),
}

impl AgentRng {
    /// PCG64 for an agent: `default_rng(SeedSequence(seed).spawn(1)[0])`.
    pub fn pcg64(seed: &SeedSequence) -> Self {
        Self::Pcg64(Pcg64::new(&seed.child(0)))
    }

    /// MT19937 for an agent: `RandomState(seed)`.
    pub fn mt19937(seed: u32) -> Self {
        Self::Mt19937(Box::new(Mt19937::new(seed)))
    }
}

impl Rng for AgentRng {
    #[inline]
    fn random(&mut self) -> f64 {
        match self {
            Self::Pcg64(rng) => rng.random(),
            Self::Mt19937(rng) => rng.random(),
        }
    }

    #[inline]
    fn integers(&mut self, below: u32) -> u32 {
        match self {
            Self::Pcg64(rng) => rng.integers(below),
            Self::Mt19937(rng) => rng.integers(below),
        }
    }

    fn seed_fingerprint(&self) -> Option<u64> {
        match self {
            Self::Pcg64(rng) => rng.seed_fingerprint(),
            Self::Mt19937(rng) => rng.seed_fingerprint(),
        }
    }
}

impl Persist for AgentRng {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        match self {
            Self::Pcg64(rng) => rng.persist(checkpoint),
            Self::Mt19937(rng) => rng.persist(checkpoint),
        }
    }
}

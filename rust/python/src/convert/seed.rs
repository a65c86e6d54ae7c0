//! Seeds: Python integers of any size.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyInt};
use qtab_core::memory::with_capacity;

use crate::error::allocation;

/// The number of seeds that are read between two checks for signals.
const SEEDS_BETWEEN_CHECKS: usize = 1 << 16;

/// A non-negative integer as 32-bit words, least significant first; zero is one word.
#[derive(Clone, Debug)]
pub(crate) enum Seed {
    /// Up to 64 bits: the words, and their number. It needs no allocation, as there may be millions of seeds.
    Small([u32; 2], u8),
    Large(Vec<u32>),
}

impl Seed {
    pub(crate) fn from_words(words: Vec<u32>) -> Self {
        Self::Large(words)
    }

    pub(crate) fn words(&self) -> &[u32] {
        match self {
            Self::Small(words, count) => &words[..usize::from(*count)],
            Self::Large(words) => words,
        }
    }

    /// The seed as a Python `int`.
    pub(crate) fn to_python<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let bytes: Vec<u8> = self.words().iter().flat_map(|word| word.to_le_bytes()).collect();
        py.get_type::<PyInt>().call_method1(intern!(py, "from_bytes"), (PyBytes::new(py, &bytes), "little"))
    }
}

impl<'py> FromPyObject<'_, 'py> for Seed {
    type Error = PyErr;

    fn extract(seed: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(small) = seed.extract::<u64>() {
            let (low, high) = (small as u32, (small >> 32) as u32);
            return Ok(Self::Small([low, high], if high == 0 { 1 } else { 2 }));
        }
        let py = seed.py();
        if !seed.is_instance_of::<PyInt>() {
            return Err(PyTypeError::new_err(format!("seed must be an integer, got {}", seed.repr()?)));
        }
        if seed.lt(0)? {
            return Err(PyValueError::new_err(format!("seed must be a non-negative integer, got {}", seed.repr()?)));
        }
        let bits: usize = seed.call_method0(intern!(py, "bit_length"))?.extract()?;
        let bytes: Vec<u8> =
            seed.call_method1(intern!(py, "to_bytes"), (bits.div_ceil(32) * 4, "little"))?.extract()?;
        Ok(Self::Large(bytes.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word)).collect()))
    }
}

/// The seeds of many runs.
pub(crate) struct Seeds(pub(crate) Vec<Seed>);

impl<'py> FromPyObject<'_, 'py> for Seeds {
    type Error = PyErr;

    fn extract(seeds: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let mut extracted = with_capacity(seeds.len()?).map_err(allocation)?;
        for seed in seeds.try_iter()? {
            if extracted.len() == extracted.capacity() {
                break;
            }
            extracted.push(seed?.extract()?);
            if extracted.len() % SEEDS_BETWEEN_CHECKS == 0 {
                seeds.py().check_signals()?;
            }
        }
        Ok(Self(extracted))
    }
}

//! Seeds: Python integers of any size.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyInt};

/// A non-negative integer as 32-bit words, least significant first; zero is one word.
#[derive(Clone, Debug)]
pub(crate) struct Seed(Vec<u32>);

impl Seed {
    pub(crate) fn from_words(words: Vec<u32>) -> Self {
        Self(words)
    }

    pub(crate) fn words(&self) -> &[u32] {
        &self.0
    }

    /// The seed as a Python `int`.
    pub(crate) fn to_python<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let bytes: Vec<u8> = self.0.iter().flat_map(|word| word.to_le_bytes()).collect();
        py.get_type::<PyInt>().call_method1(intern!(py, "from_bytes"), (PyBytes::new(py, &bytes), "little"))
    }
}

impl<'py> FromPyObject<'_, 'py> for Seed {
    type Error = PyErr;

    fn extract(seed: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(small) = seed.extract::<u64>() {
            let (low, high) = (small as u32, (small >> 32) as u32);
            return Ok(Self(if high == 0 { vec![low] } else { vec![low, high] }));
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
        Ok(Self(bytes.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word)).collect()))
    }
}

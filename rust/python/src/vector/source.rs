//! Where a sub-environment's random numbers come from.

use pyo3::intern;
use pyo3::prelude::*;
use qtab_core::random::{Pcg64, Rng, SeedSequence};

/// Its `np_random`: ours as long as nobody has seen it, `NumPy`'s own from then on, so that the two never part.
pub(super) enum Source {
    Own(Pcg64),
    /// A `numpy.random.Generator`.
    Python(Py<PyAny>),
}

impl Source {
    /// The stream of `env.reset(seed=seed)`; the seed comes as 32-bit words.
    pub(super) fn new(seed: &[u32]) -> Self {
        Self::Own(Pcg64::new(&SeedSequence::new(seed)))
    }
}

/// What a draw of `NumPy`'s returns; it fails only where memory ends, which a stream cannot say.
fn drawn<T: Default + for<'a, 'py> FromPyObject<'a, 'py, Error: Into<PyErr>>>(
    py: Python<'_>,
    number: PyResult<Bound<'_, PyAny>>,
) -> T {
    number.and_then(|number| number.extract().map_err(Into::into)).unwrap_or_else(|error| {
        error.write_unraisable(py, None);
        T::default()
    })
}

impl Rng for Source {
    #[inline]
    fn random(&mut self) -> f64 {
        match self {
            Self::Own(stream) => stream.random(),
            Self::Python(generator) => {
                Python::attach(|py| drawn(py, generator.bind(py).call_method0(intern!(py, "random"))))
            }
        }
    }

    #[inline]
    fn integers(&mut self, below: u32) -> u32 {
        match self {
            Self::Own(stream) => stream.integers(below),
            Self::Python(generator) => Python::attach(|py| {
                drawn(py, generator.bind(py).call_method1(intern!(py, "integers"), (0, below.max(1))))
            }),
        }
    }
}

/// A non-negative integer of Python's as 32-bit words, least significant first; zero is one word.
pub(super) fn words(seed: &Bound<'_, PyAny>) -> PyResult<Vec<u32>> {
    if let Ok(small) = seed.extract::<u64>() {
        let (low, high) = (small as u32, (small >> 32) as u32);
        return Ok(if high == 0 { vec![low] } else { vec![low, high] });
    }
    let bits: usize = seed.call_method0(intern!(seed.py(), "bit_length"))?.extract()?;
    let bytes: Vec<u8> =
        seed.call_method1(intern!(seed.py(), "to_bytes"), (bits.div_ceil(32) * 4, "little"))?.extract()?;
    Ok(bytes.as_chunks::<4>().0.iter().map(|word| u32::from_le_bytes(*word)).collect())
}

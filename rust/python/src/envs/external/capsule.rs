//! The two capsules of this interface: an environment, and a bit generator of `NumPy`.

#![expect(unsafe_code, reason = "a capsule holds an address, and its name gives the type")]

use std::ffi::CStr;

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use qtab_env::Bitgen;
use qtab_env::host::{Environment, RandomBits};

/// The name of the capsule of a `qtab_env`.
const ENVIRONMENT: &CStr = c"qtab.env.1";

/// The name of the capsule of a `bitgen_t`.
const BIT_GENERATOR: &CStr = c"BitGenerator";

/// Reads and checks the environment of a capsule. It is valid as long as the capsule lives.
pub(super) fn environment_of(capsule: &Bound<'_, PyAny>) -> PyResult<Environment> {
    let capsule = capsule.cast::<PyCapsule>().map_err(|_| {
        let got = capsule.get_type().to_string();
        PyTypeError::new_err(format!("__qtab_env__() must return a capsule named 'qtab.env.1', got {got}"))
    })?;
    let address = capsule.pointer_checked(Some(ENVIRONMENT)).map_err(|_| {
        PyValueError::new_err("__qtab_env__() must return a capsule named 'qtab.env.1', got one of another name")
    })?;
    // SAFETY: the name promises a `qtab_env` that keeps the rules of the header while the capsule lives.
    let environment = unsafe { Environment::new(address.as_ptr().cast()) };
    environment.map_err(|error| PyValueError::new_err(error.to_string()))
}

/// Calls a function with the random bits of a bit generator of `NumPy`, such as `np.random.PCG64(0)`. The caller holds
/// its lock.
pub(super) fn with_bits_of<T>(
    bit_generator: &Bound<'_, PyAny>,
    function: impl FnOnce(&mut RandomBits<'_>) -> T,
) -> PyResult<T> {
    let capsule = bit_generator.getattr("capsule")?.cast_into::<PyCapsule>()?;
    let address = capsule.pointer_checked(Some(BIT_GENERATOR))?;
    // SAFETY: the name promises a `bitgen_t`.
    let bitgen = unsafe { *address.as_ptr().cast::<Bitgen>() };
    // SAFETY: the bit generator lives during the call, and its lock keeps other threads from using it.
    Ok(function(&mut unsafe { RandomBits::from_bitgen(bitgen) }))
}

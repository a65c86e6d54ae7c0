//! Arithmetic with the rounding of Python, `NumPy` and the platform's C library, and numeric helpers.

mod argmax;
mod cold_path;
pub(crate) mod cosine;
mod float;
mod numpy_f32_cos_sin;
mod python_float;
mod scalar;
mod sum;

pub(crate) use argmax::{argmax, maximum};
pub(crate) use cold_path::cold_path;
pub use float::Float;
pub use numpy_f32_cos_sin::numpy_f32_cos_sin;
pub(crate) use python_float::{clip, modulo, squared};
pub use scalar::Scalar;
pub(crate) use sum::sum;

/// How many lanes the SIMD code computes at once: eight f64 numbers fill two registers of AVX2.
pub const LANES: usize = 8;

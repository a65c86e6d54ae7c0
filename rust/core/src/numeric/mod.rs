//! Arithmetic that rounds as Python, `NumPy` and the platform's C library do, and small numeric helpers.

mod argmax;
mod cold_path;
mod cos_sin;
pub(crate) mod cosine;
mod float;
mod numpy_f32_cos_sin;
mod python_float;
mod scalar;
mod sum;

pub(crate) use argmax::{argmax, maximum};
pub(crate) use cold_path::cold_path;
pub(crate) use cos_sin::cos_sin;
pub use float::Float;
pub use numpy_f32_cos_sin::numpy_f32_cos_sin;
pub(crate) use python_float::{clip, modulo, squared};
pub use scalar::Scalar;
pub(crate) use sum::sum;

//! Arithmetic that rounds like Python, `NumPy` and the platform's C library, and small numeric helpers.

mod argmax;
mod cos_sin;
pub(crate) mod cosine;
mod float;
mod numpy_f32_cos_sin;
mod python_float;
mod scalar;
mod sum;

pub(crate) use argmax::maximum;
pub use argmax::{argmax, argmax_with_nan};
pub(crate) use cos_sin::cos_sin;
pub use float::Float;
pub use numpy_f32_cos_sin::numpy_f32_cos_sin;
pub(crate) use python_float::{clip, modulo, squared};
pub use scalar::Scalar;
pub use sum::sum_products;
pub(crate) use sum::{sum, sum_row_products};

/// Marks the branch that calls it as rare, so that the compiler keeps it a branch. The processor then predicts it,
/// whereas a conditional move would make every step wait for the comparison. To be replaced by `std::hint::cold_path`
/// once the minimum supported Rust version has it.
#[cold]
pub(crate) fn cold_path() {}

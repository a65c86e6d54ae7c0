//! Numbers in SIMD lanes, and the instructions that compute with them.
//!
//! Code for lanes is written once, for any [`Simd`]: with [`F64s`], [`F32s`], [`U64s`] and [`Mask`], which hold a
//! number or a truth value for each of `K` lanes. It is compiled for the instruction sets of [`SimdLevel`], and the
//! processor's best is chosen at run time. Every operation rounds like its scalar counterpart, so the results do not
//! depend on the instruction set.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod floats;
mod instructions;
mod integers;
mod lane_type;
mod level;
mod mask;
mod operations;
mod portable;
#[cfg(target_arch = "x86_64")]
mod registers;
#[cfg(test)]
mod tests;

pub use floats::{F32s, F64s};
pub use instructions::Simd;
pub use integers::U64s;
pub(crate) use lane_type::map;
pub(crate) use level::SimdCode;
pub use level::{SimdLevel, SimdLimit};
pub use mask::Mask;
pub use portable::Portable;

/// The number of SIMD lanes computed together: eight f64 numbers fill two AVX2 registers, or one AVX-512 register.
pub const LANES: usize = 8;

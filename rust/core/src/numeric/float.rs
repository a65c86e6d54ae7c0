//! The floating-point dtypes of Gymnasium's `Box` spaces.

use std::ops::{Add, Div, Mul, Sub};

/// f32 or f64. Under `NumPy` 2's promotion rules, arithmetic on a `Box` stays in the dtype of its bounds.
pub trait Float:
    Copy
    + PartialOrd
    + Into<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Send
    + Sync
{
    /// The representable number nearest to an integer.
    fn from_count(count: u32) -> Self;
}

impl Float for f32 {
    #[inline]
    fn from_count(count: u32) -> Self {
        count as f32
    }
}

impl Float for f64 {
    #[inline]
    fn from_count(count: u32) -> Self {
        f64::from(count)
    }
}

//! The types of the numbers of an observation.

use crate::table::{FLOAT32, FLOAT64, INT64};

/// A number of an observation: `f32`, `f64` or `i64`.
pub trait Number: sealed::Sealed + Copy + Default + PartialEq + Send + Sync + 'static {
    /// The value of `observation_type` for this type.
    const TYPE: u32;

    /// The number as a bound, which is a float64.
    fn to_f64(self) -> f64;

    /// Whether it is finite.
    fn is_finite(self) -> bool {
        self.to_f64().is_finite()
    }
}

impl Number for f32 {
    const TYPE: u32 = FLOAT32;

    fn to_f64(self) -> f64 {
        f64::from(self)
    }
}

impl Number for f64 {
    const TYPE: u32 = FLOAT64;

    fn to_f64(self) -> f64 {
        self
    }
}

impl Number for i64 {
    const TYPE: u32 = INT64;

    fn to_f64(self) -> f64 {
        self as f64
    }
}

mod sealed {
    /// Every bit pattern is a valid value of these types, so that a buffer may be passed to C as it is.
    pub trait Sealed {}

    impl Sealed for f32 {}
    impl Sealed for f64 {}
    impl Sealed for i64 {}
}

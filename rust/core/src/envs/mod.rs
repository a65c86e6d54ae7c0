//! The environments, one a file.

pub(crate) mod mountain_car;

pub use mountain_car::{MountainCar, MountainCarState};

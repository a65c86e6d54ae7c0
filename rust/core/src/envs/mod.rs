//! The environments, one a file.

mod mountain_car;

pub use mountain_car::{MountainCar, MountainCarState};

//! The environments, one a file.

mod acrobot;
mod cart_pole;
mod continuous_mountain_car;
pub(crate) mod mountain_car;
mod numpy;
mod pendulum;

pub use acrobot::{Acrobot, AcrobotState};
pub use cart_pole::{CartPole, CartPoleState};
pub use continuous_mountain_car::{ContinuousMountainCar, ContinuousMountainCarState};
pub use mountain_car::{MountainCar, MountainCarState};
pub use numpy::Scalar;
pub use pendulum::{Pendulum, PendulumState};

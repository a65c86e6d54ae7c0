//! The environments of `gymnasium.envs.classic_control`.

mod acrobot;
mod cart_pole;
mod cart_pole_arrays;
mod continuous_mountain_car;
mod mountain_car;
mod mountain_car_simd;
mod pendulum;

pub use acrobot::{Acrobot, AcrobotState};
pub use cart_pole::{CartPole, CartPoleState};
pub use continuous_mountain_car::{ContinuousMountainCar, ContinuousMountainCarState};
pub use mountain_car::{MountainCar, MountainCarState};
pub use pendulum::{Pendulum, PendulumState};

//! The environments, one a file.

mod acrobot;
mod blackjack;
mod cart_pole;
mod continuous_mountain_car;
mod few_actions;
mod maximization_bias;
pub(crate) mod mountain_car;
mod numpy;
mod pendulum;
mod tabular;
mod taxi;
mod telling;
pub(crate) mod wide;

pub use acrobot::{Acrobot, AcrobotState};
pub use blackjack::{Blackjack, BlackjackState, DEALER_STICKS, DECK, Dealing, Dealt, Hand};
pub use cart_pole::{CartPole, CartPoleState};
pub use continuous_mountain_car::{ContinuousMountainCar, ContinuousMountainCarState};
pub use few_actions::FewActions;
pub use maximization_bias::{MaximizationBias, STATES as MAXIMIZATION_BIAS_STATES};
pub use mountain_car::{MountainCar, MountainCarState};
pub use numpy::{Scalar, small_cosine_and_sine};
pub use pendulum::{Pendulum, PendulumState};
pub use tabular::{BadTable, Outcome, TOLERANCE, Tabular};
pub use taxi::{Taxi, TaxiState};
pub use telling::{Telling, Tells, Told};
pub use wide::Wide;

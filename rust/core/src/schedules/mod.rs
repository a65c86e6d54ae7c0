//! Schedules: rates that change over a run, such as the exploration rate ε and the learning rate α.

mod learning_rate;
mod schedule;
mod step_size;
mod update_log;

pub use learning_rate::LearningRate;
pub use schedule::Schedule;
pub use step_size::StepSize;
pub use update_log::{LoggedUpdate, UpdateLog};

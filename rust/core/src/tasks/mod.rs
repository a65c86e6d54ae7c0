//! Tasks: an environment, its features and its time limit, with which a learner interacts.

mod boxed_task;
mod changing_task;
mod episode_recorder;
mod k_armed_bandit;
mod native_task;
mod task;
mod time_aware;
mod visit_counter;

pub use boxed_task::BoxedTask;
pub use changing_task::ChangingTask;
pub use episode_recorder::{EpisodeRecorder, Recording, Recordings};
pub use k_armed_bandit::{KArmedBandit, OptimalActions, Testbed};
pub use native_task::{NativeTask, TimedState};
pub use task::{Next, NextKind, RngSnapshot, Task, Transition};
pub use time_aware::TimeAware;
pub use visit_counter::{CountedState, VisitCounter};

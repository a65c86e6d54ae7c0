//! Methods whose targets are returns of n steps (Sutton & Barto, chapter 7).

mod method;
mod n_step_q_sigma;
mod n_step_sarsa;
mod n_step_tree_backup;
mod target_policy;

pub use method::{NStep, NStepMethod, NStepVisit};
pub use n_step_q_sigma::{NStepQSigma, QSigma};
pub use n_step_sarsa::{NStepReturn, NStepSarsa};
pub use n_step_tree_backup::{NStepTreeBackup, TreeBackup};
pub use target_policy::TargetPolicy;

//! What Python calls to train: one run that it can advance, or many runs at once.

mod env_spec;
mod many;
mod results;
mod trainer;

pub(crate) use many::train_many;
pub(crate) use trainer::PyTrainer;

/// Signals are checked after this many steps: a fraction of a millisecond.
const STEPS_BETWEEN_CHECKS: u64 = 8192;

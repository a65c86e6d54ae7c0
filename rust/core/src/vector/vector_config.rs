//! The settings that all sub-environments share.

use super::Autoreset;

/// The time limit and the autoreset mode.
#[derive(Clone, Copy, Debug)]
pub(super) struct VectorConfig {
    pub(super) max_episode_steps: u64,
    pub(super) autoreset: Autoreset,
}

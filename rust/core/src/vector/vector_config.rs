//! The settings that all sub-environments share.

use super::Autoreset;

/// The settings that all sub-environments share.
#[derive(Clone, Copy, Debug)]
pub(super) struct VectorConfig {
    pub(super) max_episode_steps: u64,
    pub(super) autoreset: Autoreset,
}

//! The policy of a learner.

use super::{ABOVE_ZERO, ScheduleSpec, SettingSource};
use crate::StopFlag;
use crate::memory::AllocationError;
use crate::policies::{AnyPolicy, TieBreaking, Ucb};

/// A policy with its settings.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PolicySpec {
    /// A random action with probability ε, otherwise a greedy one.
    EpsilonGreedy {
        /// The exploration rate ε.
        epsilon: ScheduleSpec,
        /// The choice among several greedy actions.
        ties: TieBreaking,
    },
    /// Each action with probability proportional to exp(Q / temperature).
    Softmax {
        /// The temperature τ, above 0.
        temperature: f64,
    },
    /// The action with the largest upper confidence bound of its value.
    Ucb {
        /// The weight c of the bound.
        confidence: f64,
        /// The choice among several such actions.
        ties: TieBreaking,
    },
}

#[derive(Clone, Copy)]
enum PolicyKind {
    EpsilonGreedy,
    Softmax,
    Ucb,
}

impl PolicySpec {
    /// The policy of a run of `episodes` episodes.
    ///
    /// # Errors
    /// If a setting is missing or invalid.
    pub fn parse<S: SettingSource>(settings: &S, episodes: u64) -> Result<Self, S::Error> {
        let kinds =
            [("epsilon_greedy", PolicyKind::EpsilonGreedy), ("softmax", PolicyKind::Softmax), ("ucb", PolicyKind::Ucb)];
        let ties = || settings.word("ties", &[("first", TieBreaking::First), ("random", TieBreaking::Random)]);
        Ok(match settings.word("exploration", &kinds)? {
            PolicyKind::EpsilonGreedy => {
                Self::EpsilonGreedy { epsilon: ScheduleSpec::epsilon(settings, episodes)?, ties: ties()? }
            }
            PolicyKind::Softmax => Self::Softmax { temperature: settings.number("temperature", ABOVE_ZERO, f64::MAX)? },
            PolicyKind::Ucb => Self::Ucb { confidence: settings.number("confidence", 0.0, f64::MAX)?, ties: ties()? },
        })
    }

    /// The policy for a table of `shape` (rows, actions), in which some states may lack actions.
    ///
    /// # Errors
    /// If the counts of the visits, which UCB needs, do not fit into memory.
    pub fn build(
        &self,
        episodes: u64,
        shape: (usize, usize),
        has_masks: bool,
        stop: &StopFlag<'_>,
    ) -> Result<AnyPolicy, AllocationError> {
        Ok(match *self {
            Self::Ucb { confidence, ties } => AnyPolicy::Ucb(Ucb::new(confidence, ties, shape, stop)?),
            Self::Softmax { temperature } => AnyPolicy::softmax(temperature, shape.1),
            Self::EpsilonGreedy { epsilon, ties } if has_masks => {
                AnyPolicy::MaskedEpsilonGreedy { epsilon: epsilon.build(episodes), ties }
            }
            Self::EpsilonGreedy { epsilon, ties } => {
                AnyPolicy::EpsilonGreedy { epsilon: epsilon.build(episodes), ties }
            }
        })
    }
}

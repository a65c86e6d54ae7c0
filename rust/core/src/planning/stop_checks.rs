//! When planning looks at the stop flag.

use super::PlanningError;
use crate::StopFlag;
use crate::envs::tabular::TabularMdp;

/// How many outcomes are read between two looks at the flag: a fraction of a millisecond.
const OUTCOMES_BETWEEN_CHECKS: usize = 1 << 16;

/// Counts the work on a table's states, so that a sweep over a large table can be stopped as well.
pub(super) struct StopChecks<'a> {
    stop: &'a StopFlag<'a>,
    /// The mean number of outcomes of a state.
    outcomes: usize,
    counted: usize,
}

impl<'a> StopChecks<'a> {
    /// Counts for a table.
    pub(super) fn new(mdp: &TabularMdp, stop: &'a StopFlag<'a>) -> Self {
        Self { stop, outcomes: 1 + mdp.num_outcomes() / mdp.num_states(), counted: 0 }
    }

    /// Counts one state.
    ///
    /// # Errors
    /// `Stopped` after the flag was set.
    #[inline]
    pub(super) fn state(&mut self) -> Result<(), PlanningError> {
        self.counted += self.outcomes;
        if self.counted < OUTCOMES_BETWEEN_CHECKS {
            return Ok(());
        }
        self.counted = 0;
        self.now()
    }

    /// Looks at the flag.
    ///
    /// # Errors
    /// `Stopped` after the flag was set.
    pub(super) fn now(&self) -> Result<(), PlanningError> {
        if self.stop.is_set() { Err(PlanningError::Stopped) } else { Ok(()) }
    }
}

//! Checks of the stop flag during planning.

use super::PlanningError;
use crate::StopFlag;

/// The number of outcomes that are read between two checks of the flag: a fraction of a millisecond.
const OUTCOMES_BETWEEN_CHECKS: usize = 1 << 16;

/// Counts the work on a table's states, so that even a sweep over a large table can be stopped.
pub(super) struct StopChecks<'a> {
    stop: &'a StopFlag<'a>,
    /// The mean number of outcomes of a state.
    outcomes: usize,
    counted: usize,
}

impl<'a> StopChecks<'a> {
    /// Counts the work on `num_states` states with `num_outcomes` outcomes in total.
    pub(super) fn new(num_outcomes: usize, num_states: usize, stop: &'a StopFlag<'a>) -> Self {
        Self { stop, outcomes: 1 + num_outcomes / num_states, counted: 0 }
    }

    /// Visits all states repeatedly until a sweep changes nothing. `visit` returns whether it changed something.
    ///
    /// # Errors
    /// `Stopped` after the flag was set.
    pub(super) fn until_stable(
        &mut self,
        num_states: usize,
        mut visit: impl FnMut(usize) -> bool,
    ) -> Result<(), PlanningError> {
        let (mut changed, mut forwards) = (true, true);
        while changed {
            changed = false;
            for index in 0..num_states {
                // In both directions, so that a corridor takes few sweeps, in whichever direction its states are
                // numbered.
                changed |= visit(if forwards { index } else { num_states - 1 - index });
                self.state()?;
            }
            forwards = !forwards;
        }
        Ok(())
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

    /// Checks the flag.
    ///
    /// # Errors
    /// `Stopped` after the flag was set.
    pub(super) fn now(&self) -> Result<(), PlanningError> {
        if self.stop.is_set() { Err(PlanningError::Stopped) } else { Ok(()) }
    }
}

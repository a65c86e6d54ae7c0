//! Steps of the task, prepared in advance where a learner has much to do between them.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use super::Trainer;
use crate::learners::Learner;
use crate::tasks::{NextKind, Task, Transition};

/// Active rows of at most this many bytes are copied in registers.
const IN_REGISTERS: usize = 32;

impl<T: Task, L: Learner<T::Active>, R> Trainer<T, L, R> {
    /// Prepares the first [`step`](Self::step) from a state.
    #[inline(always)]
    pub(super) fn prepare_step(&mut self, state: &T::State) {
        if L::HAS_VECTOR_PASSES {
            self.task.prepare_step(state);
        }
    }

    /// Whether to call [`step_into`](Self::step_into) instead of [`step`](Self::step).
    pub(super) const WRITES_ROWS: bool = L::HAS_VECTOR_PASSES && size_of::<T::Active>() > IN_REGISTERS;

    /// [`Task::step`]. It prepares the step after it, so that the processor computes that while the learner learns: the
    /// passes over the traces are long enough.
    #[inline(always)]
    pub(super) fn step(&mut self, state: &mut T::State, action: usize) -> Result<Transition<T::Active>, T::Error> {
        if !L::HAS_VECTOR_PASSES {
            return self.task.step(state, action);
        }
        let transition = self.task.step_prepared(state, action)?;
        self.task.prepare_step(state);
        Ok(transition)
    }

    /// The same, which writes the active rows. A result that holds many rows would be copied through memory, in pieces
    /// that differ from copy to copy, and the processor would wait for each.
    #[inline(always)]
    pub(super) fn step_into(
        &mut self,
        state: &mut T::State,
        action: usize,
        active: &mut T::Active,
    ) -> Result<(f64, NextKind), T::Error> {
        let next = self.task.step_into(state, action, active)?;
        self.task.prepare_step(state);
        Ok(next)
    }
}

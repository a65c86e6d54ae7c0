//! A task that is never saved: the page makes no checkpoints, and the code for those of every task would make its module
//! larger.

use qtab_core::Task;
use qtab_core::checkpoint::{Checkpoint, CheckpointError, RunIdentity};
use qtab_core::tasks::{NextKind, Transition};

/// A task without checkpoints.
pub(super) struct Unsaved<T>(pub(super) T);

impl<T: Task> Task for Unsaved<T> {
    type State = T::State;
    type Active = T::Active;
    type Error = T::Error;

    const USES_VECTORS: bool = T::USES_VECTORS;

    fn reset(&mut self) -> Result<(T::State, T::Active), T::Error> {
        self.0.reset()
    }

    #[inline]
    fn step(&mut self, state: &mut T::State, action: usize) -> Result<Transition<T::Active>, T::Error> {
        self.0.step(state, action)
    }

    #[inline]
    fn step_into(
        &mut self,
        state: &mut T::State,
        action: usize,
        active: &mut T::Active,
    ) -> Result<(f64, NextKind), T::Error> {
        self.0.step_into(state, action, active)
    }

    fn visits(&self) -> Option<&[i64]> {
        self.0.visits()
    }

    fn active_rows(&self, _state: &T::State) -> Result<T::Active, T::Error> {
        unreachable!("only a run that was saved is restored")
    }

    fn identify(&self, _identity: &mut RunIdentity) {}

    fn persist(
        &mut self,
        _state: Option<&mut T::State>,
        _checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), CheckpointError> {
        Err(CheckpointError::Invalid("task, which is never saved"))
    }
}

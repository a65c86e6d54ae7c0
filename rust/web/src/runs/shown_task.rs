//! A task that exposes the state of its environment, and can count the visits to the cells of a map.

use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, PoisonError};

use qtab_core::checkpoint::{Checkpoint, CheckpointError};
use qtab_core::features::{Features, OutOfBounds};
use qtab_core::memory::{AllocationError, filled};
use qtab_core::tasks::{NativeTask, TimedState, Transition};
use qtab_core::{Env, StopFlag, Task};

use super::subject::Numbers;
use crate::map::Cells;
use crate::updates::CellLeft;

/// The counts of each action in each cell of a map.
pub(super) struct CellVisits {
    cells: Arc<Cells>,
    num_actions: usize,
    counts: Vec<i64>,
    /// Where a watch reads the cell that a step has left.
    left: Option<CellLeft>,
}

impl CellVisits {
    pub(super) fn new(
        cells: &Arc<Cells>,
        num_actions: usize,
        left: Option<CellLeft>,
        stop: &StopFlag<'_>,
    ) -> Result<Self, AllocationError> {
        let counts = filled(&0, cells.count() * num_actions, stop)?;
        Ok(Self { cells: Arc::clone(cells), num_actions, counts, left })
    }

    fn count(&mut self, observation: &impl Numbers, action: usize) {
        let cell = self.cells.cell(&observation.numbers());
        self.counts[cell * self.num_actions + action] += 1;
        if let Some(left) = &self.left {
            left.store(cell, Ordering::Relaxed);
        }
    }
}

/// A task that exposes the state of its environment after each step.
pub(super) struct ShownTask<E: Env, F> {
    env: E,
    task: NativeTask<E, F>,
    last_state: Arc<Mutex<Option<E::State>>>,
    pub(super) visits: Option<CellVisits>,
}

impl<E: Env, F> ShownTask<E, F> {
    pub(super) fn new(env: E, task: NativeTask<E, F>) -> Self {
        Self { env, task, last_state: Arc::default(), visits: None }
    }

    /// The state after the last step.
    pub(super) fn last_state(&self) -> Arc<Mutex<Option<E::State>>> {
        Arc::clone(&self.last_state)
    }

    fn show(&self, state: E::State) {
        *self.last_state.lock().unwrap_or_else(PoisonError::into_inner) = Some(state);
    }
}

impl<E: Env<Action = usize, Observation: Numbers>, F: Features<E::Observation>> Task for ShownTask<E, F> {
    type State = TimedState<E::State>;
    type Active = F::Active;
    type Error = OutOfBounds;

    fn reset(&mut self) -> Result<(Self::State, F::Active), OutOfBounds> {
        let (state, active) = self.task.reset()?;
        self.show(state.state);
        Ok((state, active))
    }

    #[inline]
    fn step(&mut self, state: &mut Self::State, action: usize) -> Result<Transition<F::Active>, OutOfBounds> {
        if let Some(visits) = &mut self.visits {
            visits.count(&self.env.observe(&state.state), action);
        }
        let transition = self.task.step(state, action)?;
        self.show(state.state);
        Ok(transition)
    }

    fn visits(&self) -> Option<&[i64]> {
        self.visits.as_ref().map(|visits| &visits.counts[..])
    }

    fn active_rows(&self, state: &Self::State) -> Result<F::Active, OutOfBounds> {
        self.task.active_rows(state)
    }

    fn persist(
        &mut self,
        state: Option<&mut Self::State>,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), CheckpointError> {
        self.task.persist(state, checkpoint)
    }
}

//! Recordings of the last episodes, with all that a replay needs.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use super::{Next, RngSnapshot, Task, Transition};
use crate::checkpoint::{Checkpoint, CheckpointError};

/// A finished episode that can be replayed.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording<S> {
    /// The random generator before the reset.
    pub snapshot: S,
    /// The actions taken.
    pub actions: Vec<u32>,
}

/// The last finished episodes, oldest first, shared by the recorder and its reader.
pub type Recordings<S> = Arc<Mutex<VecDeque<Recording<S>>>>;

/// A wrapper around a task that records the last finished episodes.
#[derive(Debug)]
pub struct EpisodeRecorder<T: RngSnapshot> {
    task: T,
    capacity: usize,
    current: Option<Recording<T::Snapshot>>,
    finished: Recordings<T::Snapshot>,
}

impl<T: RngSnapshot> EpisodeRecorder<T> {
    /// Records the last `capacity` finished episodes of `task`. Returns the recorder and the recordings.
    pub fn new(task: T, capacity: usize) -> (Self, Recordings<T::Snapshot>) {
        let finished = Arc::default();
        (Self { task, capacity, current: None, finished: Arc::clone(&finished) }, finished)
    }

    fn finish(&mut self) {
        if let Some(recording) = self.current.take() {
            let mut finished = self.finished.lock().unwrap_or_else(PoisonError::into_inner);
            finished.push_back(recording);
            while finished.len() > self.capacity {
                finished.pop_front();
            }
        }
    }
}

impl<T: RngSnapshot> Task for EpisodeRecorder<T> {
    type State = T::State;
    type Active = T::Active;
    type Error = T::Error;

    fn reset(&mut self) -> Result<(T::State, T::Active), T::Error> {
        self.current = Some(Recording { snapshot: self.task.rng_snapshot()?, actions: Vec::new() });
        self.task.reset()
    }

    fn step(&mut self, state: &mut T::State, action: usize) -> Result<Transition<T::Active>, T::Error> {
        let transition = self.task.step(state, action)?;
        if let Some(recording) = &mut self.current {
            recording.actions.push(action as u32);
        }
        if !matches!(transition.next, Next::NonTerminal(_)) {
            self.finish();
        }
        Ok(transition)
    }

    fn active_rows(&self, state: &T::State) -> Result<T::Active, T::Error> {
        self.task.active_rows(state)
    }

    fn resumes_episodes(&self) -> bool {
        self.task.resumes_episodes()
    }

    /// Recordings are not part of it: an episode that is resumed in the middle is not recorded.
    fn persist(
        &mut self,
        state: Option<&mut T::State>,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), CheckpointError> {
        if checkpoint.is_restoring() {
            self.current = None;
        }
        self.task.persist(state, checkpoint)
    }
}

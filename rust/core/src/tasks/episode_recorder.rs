//! Recordings of the last episodes, with all that a replay needs.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use super::{Next, RngSnapshot, Task, Transition};
use crate::TrainingError;
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::memory::{AllocationError, Growing, MemoryRoom, out_of_memory, reserve};

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
    room: MemoryRoom,
    /// How many bytes of the room a recorded action takes, in the copies that are made of it, too.
    action_bytes: u64,
    current: Option<Recording<T::Snapshot>>,
    finished: Recordings<T::Snapshot>,
}

impl<T: RngSnapshot> EpisodeRecorder<T> {
    /// Records the last `capacity` finished episodes of `task`, as long as there is room for them and for the unfinished
    /// one, with `action_bytes` for each action. Returns the recorder and the recordings.
    pub fn new(task: T, capacity: usize, (room, action_bytes): (MemoryRoom, u64)) -> (Self, Recordings<T::Snapshot>) {
        let finished = Arc::default();
        (Self { task, capacity, room, action_bytes, current: None, finished: Arc::clone(&finished) }, finished)
    }

    fn record(&mut self, action: usize) -> Result<(), AllocationError> {
        let Some(recording) = &mut self.current else { return Ok(()) };
        self.room.take(self.action_bytes, Growing::Recordings)?;
        reserve(&mut recording.actions, 1)?;
        recording.actions.push(action as u32);
        Ok(())
    }

    fn finish(&mut self) -> Result<(), AllocationError> {
        if let Some(recording) = self.current.take() {
            let mut finished = self.finished.lock().unwrap_or_else(PoisonError::into_inner);
            finished.try_reserve(1).map_err(out_of_memory::<Recording<T::Snapshot>>(1))?;
            finished.push_back(recording);
            while finished.len() > self.capacity {
                let actions = finished.pop_front().map_or(0, |oldest| oldest.actions.len() as u64);
                self.room.give_back(actions * self.action_bytes);
            }
        }
        Ok(())
    }
}

impl<T: RngSnapshot> Task for EpisodeRecorder<T> {
    type State = T::State;
    type Active = T::Active;
    type Error = TrainingError<T::Error>;

    fn reset(&mut self) -> Result<(T::State, T::Active), Self::Error> {
        let snapshot = self.task.rng_snapshot().map_err(TrainingError::Task)?;
        self.current = Some(Recording { snapshot, actions: Vec::new() });
        self.task.reset().map_err(TrainingError::Task)
    }

    fn step(&mut self, state: &mut T::State, action: usize) -> Result<Transition<T::Active>, Self::Error> {
        let transition = self.task.step(state, action).map_err(TrainingError::Task)?;
        self.record(action)?;
        if !matches!(transition.next, Next::NonTerminal(_)) {
            self.finish()?;
        }
        Ok(transition)
    }

    fn step_work(&self) -> u64 {
        self.task.step_work()
    }

    #[inline]
    fn action_mask(&self) -> Option<&[bool]> {
        self.task.action_mask()
    }

    fn active_rows(&self, state: &T::State) -> Result<T::Active, Self::Error> {
        self.task.active_rows(state).map_err(TrainingError::Task)
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

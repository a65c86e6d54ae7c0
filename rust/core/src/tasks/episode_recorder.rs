//! Recordings of the last episodes, with everything that a replay needs.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use super::{Next, RngSnapshot, Task, Transition};
use crate::TrainingError;
use crate::checkpoint::{Checkpoint, CheckpointError, RunIdentity};
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
    /// The memory in bytes that a recorded action takes, including its copies.
    action_bytes: u64,
    current: Option<Recording<T::Snapshot>>,
    finished: Recordings<T::Snapshot>,
}

impl<T: RngSnapshot> EpisodeRecorder<T> {
    /// Records the last `capacity` finished episodes of `task`, as long as there is memory for them and for the
    /// unfinished one, at `action_bytes` per action. Returns the recorder and the recordings.
    pub fn new(task: T, capacity: usize, (room, action_bytes): (MemoryRoom, u64)) -> (Self, Recordings<T::Snapshot>) {
        let finished = Arc::default();
        (Self { task, capacity, room, action_bytes, current: None, finished: Arc::clone(&finished) }, finished)
    }

    fn record(&mut self, action: usize) -> Result<(), AllocationError> {
        let Some(recording) = &mut self.current else { return Ok(()) };
        reserve(&mut recording.actions, 1)?;
        self.room.take(self.action_bytes, Growing::Recordings)?;
        recording.actions.push(action as u32);
        Ok(())
    }

    fn finish(&mut self) -> Result<(), AllocationError> {
        if let Some(recording) = self.current.take() {
            let mut finished = self.finished.lock().unwrap_or_else(PoisonError::into_inner);
            finished.try_reserve(1).map_err(out_of_memory::<Recording<T::Snapshot>>(1))?;
            finished.push_back(recording);
            while finished.len() > self.capacity {
                let oldest = finished.pop_front();
                self.give_back(oldest.as_ref());
            }
        }
        Ok(())
    }

    /// Gives back the bytes of a recording that is discarded.
    fn give_back(&self, recording: Option<&Recording<T::Snapshot>>) {
        let actions = recording.map_or(0, |recording| recording.actions.len() as u64);
        self.room.give_back(actions * self.action_bytes);
    }
}

impl<T: RngSnapshot> Task for EpisodeRecorder<T> {
    type State = T::State;
    type Active = T::Active;
    type Error = TrainingError<T::Error>;

    fn reset(&mut self) -> Result<(T::State, T::Active), Self::Error> {
        let snapshot = self.task.rng_snapshot().map_err(TrainingError::Task)?;
        // A failed episode leaves its recording here.
        let abandoned = self.current.replace(Recording { snapshot, actions: Vec::new() });
        self.give_back(abandoned.as_ref());
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

    fn shape(&self) -> Option<(usize, usize)> {
        self.task.shape()
    }

    fn identify(&self, identity: &mut RunIdentity) {
        identity.add_type::<Self>("task");
        self.task.identify(identity);
    }

    fn resumes_episodes(&self) -> bool {
        self.task.resumes_episodes()
    }

    /// Recordings are not saved: an episode that is resumed midway is not recorded.
    fn persist(
        &mut self,
        state: Option<&mut T::State>,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), CheckpointError> {
        if checkpoint.is_restoring() {
            let discarded = self.current.take();
            self.give_back(discarded.as_ref());
        }
        self.task.persist(state, checkpoint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two steps to the end of an episode; the step with the given number fails.
    struct FailingTask {
        steps: u64,
        failing: u64,
    }

    impl RngSnapshot for FailingTask {
        type Snapshot = ();

        fn rng_snapshot(&self) -> Result<(), ()> {
            Ok(())
        }
    }

    impl Task for FailingTask {
        type State = u64;
        type Active = [u32; 1];
        type Error = ();

        fn reset(&mut self) -> Result<(u64, [u32; 1]), ()> {
            Ok((0, [0]))
        }

        fn step(&mut self, state: &mut u64, _action: usize) -> Result<Transition<[u32; 1]>, ()> {
            self.steps += 1;
            *state += 1;
            let next = if *state == 2 { Next::Terminal } else { Next::NonTerminal([0]) };
            if self.steps == self.failing { Err(()) } else { Ok(Transition { reward: 0.0, next }) }
        }

        fn active_rows(&self, _state: &u64) -> Result<[u32; 1], ()> {
            Ok([0])
        }

        fn persist(&mut self, _: Option<&mut u64>, _: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
            Ok(())
        }
    }

    #[test]
    fn the_room_of_discarded_recordings_is_given_back() {
        let room = MemoryRoom::new(1000, 1000);
        let (mut recorder, recordings) =
            EpisodeRecorder::new(FailingTask { steps: 0, failing: 4 }, 1, (room.clone(), 10));
        let mut left = Vec::new();
        for _ in 0..4 {
            let (mut state, _) = recorder.reset().expect("a reset never fails");
            while state < 2 && recorder.step(&mut state, 0).is_ok() {}
            left.push(room.left());
        }
        // The second episode fails after one step; its action is given back when the third begins.
        assert_eq!(left, [980, 970, 980, 980]);
        assert_eq!(recordings.lock().unwrap_or_else(PoisonError::into_inner).len(), 1);
    }
}

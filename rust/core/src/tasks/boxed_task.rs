//! Any task behind one type.

use super::{Task, Transition};
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::features::ActiveRows;

/// A task together with the state of its episode, so that the type of the state is hidden.
struct StatefulTask<T: Task> {
    task: T,
    state: Option<T::State>,
}

/// [`Task`] without the state, for trait objects. `R` holds the active rows, `X` is the error.
trait DynTask<R, X> {
    fn reset(&mut self) -> Result<R, X>;
    fn step(&mut self, action: usize) -> Result<Transition<R>, X>;
    fn action_mask(&self) -> Option<&[bool]>;
    fn visits(&self) -> Option<&[i64]>;
    fn active_rows(&self) -> Result<R, X>;
    fn resumes_episodes(&self) -> bool;
    fn persist(&mut self, in_episode: bool, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError>;
}

impl<T: Task, X: From<T::Error>> DynTask<T::Active, X> for StatefulTask<T> {
    fn reset(&mut self) -> Result<T::Active, X> {
        let (state, active) = self.task.reset()?;
        self.state = Some(state);
        Ok(active)
    }

    fn step(&mut self, action: usize) -> Result<Transition<T::Active>, X> {
        let Some(state) = &mut self.state else { unreachable!("a trainer resets a task before it steps it") };
        Ok(self.task.step(state, action)?)
    }

    fn action_mask(&self) -> Option<&[bool]> {
        self.task.action_mask()
    }

    fn visits(&self) -> Option<&[i64]> {
        self.task.visits()
    }

    fn active_rows(&self) -> Result<T::Active, X> {
        let Some(state) = &self.state else { unreachable!("a trainer asks for the rows of an episode that has begun") };
        Ok(self.task.active_rows(state)?)
    }

    fn resumes_episodes(&self) -> bool {
        self.task.resumes_episodes()
    }

    fn persist(&mut self, in_episode: bool, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.task.persist(self.state.as_mut().filter(|_| in_episode), checkpoint)
    }
}

/// A boxed task with active rows `R` and errors `X`: generic code is compiled once for all tasks behind it.
pub struct BoxedTask<R, X> {
    task: Box<dyn DynTask<R, X> + Send>,
    step_work: u64,
    /// Whether the task has action masks. Where it has none, no call is made to ask for them.
    has_masks: bool,
}

impl<R: ActiveRows + 'static, X: 'static> BoxedTask<R, X> {
    /// Boxes a task and converts its errors to `X`.
    pub fn new<T>(task: T) -> Self
    where
        T: Task<Active = R, State: Send> + Send + 'static,
        X: From<T::Error>,
    {
        Self {
            step_work: task.step_work(),
            has_masks: task.action_mask().is_some(),
            task: Box::new(StatefulTask { task, state: None }),
        }
    }
}

impl<R: ActiveRows, X> Task for BoxedTask<R, X> {
    type State = ();
    type Active = R;
    type Error = X;

    fn reset(&mut self) -> Result<((), R), X> {
        Ok(((), self.task.reset()?))
    }

    fn step(&mut self, (): &mut (), action: usize) -> Result<Transition<R>, X> {
        self.task.step(action)
    }

    #[inline]
    fn step_work(&self) -> u64 {
        self.step_work
    }

    #[inline]
    fn action_mask(&self) -> Option<&[bool]> {
        if self.has_masks { self.task.action_mask() } else { None }
    }

    fn visits(&self) -> Option<&[i64]> {
        self.task.visits()
    }

    fn active_rows(&self, (): &()) -> Result<R, X> {
        self.task.active_rows()
    }

    fn resumes_episodes(&self) -> bool {
        self.task.resumes_episodes()
    }

    fn persist(&mut self, state: Option<&mut ()>, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.task.persist(state.is_some(), checkpoint)
    }
}

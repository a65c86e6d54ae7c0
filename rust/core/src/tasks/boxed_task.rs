//! Any task behind one type.

use super::{NextKind, Task, Transition};
use crate::checkpoint::{Checkpoint, CheckpointError, RunIdentity};
use crate::features::ActiveRows;
use crate::simd::{Simd, SimdCode, SimdLevel};

/// A task together with the state of its episode, so that the type of the state is hidden.
struct StatefulTask<T: Task, X> {
    task: T,
    state: Option<T::State>,
    error: Option<X>,
    /// The vector instructions that the steps are compiled for. The training loop that calls the steps does not know
    /// it.
    level: SimdLevel,
}

/// [`Task`] without the state, for trait objects. `R` holds the active rows, `X` is the error.
trait DynTask<R, X> {
    fn reset(&mut self) -> Result<R, X>;
    /// Takes a step and writes the active rows, which are unspecified after a terminal state. Returns the reward and
    /// the kind of the next state in registers. A [`Transition`] would be copied from one layout to another, and read
    /// across the words in which it was written. `None` means that the step has failed and the task has stored the
    /// error.
    fn step(&mut self, action: usize, active: &mut R) -> (f64, Option<NextKind>);
    /// The error of the failed step.
    fn take_error(&mut self) -> X;
    fn action_mask(&self) -> Option<&[bool]>;
    fn visits(&self) -> Option<&[i64]>;
    fn active_rows(&self) -> Result<R, X>;
    fn shape(&self) -> Option<(usize, usize)>;
    fn identify(&self, identity: &mut RunIdentity);
    fn resumes_episodes(&self) -> bool;
    fn persist(&mut self, in_episode: bool, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError>;
}

/// A step, compiled for each [`SimdLevel`].
struct StepCode<'a, T: Task, X> {
    task: &'a mut T,
    state: &'a mut T::State,
    error: &'a mut Option<X>,
    action: usize,
    active: &'a mut T::Active,
}

impl<T: Task, X: From<T::Error>> SimdCode for StepCode<'_, T, X> {
    type Output = (f64, Option<NextKind>);

    #[inline(always)]
    fn run<S: Simd>(self, _simd: S) -> (f64, Option<NextKind>) {
        match self.task.step_into(self.state, self.action, self.active) {
            Ok((reward, next)) => (reward, Some(next)),
            Err(error) => {
                *self.error = Some(error.into());
                (0.0, None)
            }
        }
    }
}

impl<T: Task, X: From<T::Error>> DynTask<T::Active, X> for StatefulTask<T, X> {
    fn reset(&mut self) -> Result<T::Active, X> {
        let (state, active) = self.task.reset()?;
        self.state = Some(state);
        Ok(active)
    }

    fn step(&mut self, action: usize, active: &mut T::Active) -> (f64, Option<NextKind>) {
        let Some(state) = &mut self.state else { unreachable!("a trainer resets a task before it steps it") };
        let step = StepCode { task: &mut self.task, state, error: &mut self.error, action, active };
        if T::USES_VECTORS { self.level.run(step) } else { SimdLevel::PLAIN.run(step) }
    }

    fn take_error(&mut self) -> X {
        let Some(error) = self.error.take() else { unreachable!("the step has failed") };
        error
    }

    fn action_mask(&self) -> Option<&[bool]> {
        self.task.action_mask()
    }

    fn visits(&self) -> Option<&[i64]> {
        self.task.visits()
    }

    fn active_rows(&self) -> Result<T::Active, X> {
        let Some(state) = &self.state else {
            unreachable!("a trainer only asks for the rows of an unfinished episode")
        };
        Ok(self.task.active_rows(state)?)
    }

    fn shape(&self) -> Option<(usize, usize)> {
        self.task.shape()
    }

    fn identify(&self, identity: &mut RunIdentity) {
        self.task.identify(identity);
    }

    fn resumes_episodes(&self) -> bool {
        self.task.resumes_episodes()
    }

    fn persist(&mut self, in_episode: bool, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.task.persist(self.state.as_mut().filter(|_| in_episode), checkpoint)
    }
}

/// A boxed task with active rows `R` and errors `X`: generic code is compiled only once for all boxed tasks.
pub struct BoxedTask<R, X> {
    task: Box<dyn DynTask<R, X> + Send>,
    /// The active rows that the last step wrote; `None` before the first reset.
    active: Option<R>,
    step_work: u64,
    /// Whether the task has action masks. If not, the dynamic call is skipped.
    has_masks: bool,
}

impl<R: ActiveRows + 'static, X: Send + 'static> BoxedTask<R, X> {
    /// Boxes a task and converts its errors to `X`.
    pub fn new<T>(task: T) -> Self
    where
        T: Task<Active = R, State: Send> + Send + 'static,
        X: From<T::Error>,
    {
        Self {
            step_work: task.step_work(),
            has_masks: task.action_mask().is_some(),
            task: Box::new(StatefulTask { task, state: None, error: None, level: SimdLevel::detect() }),
            active: None,
        }
    }
}

impl<R: ActiveRows, X> Task for BoxedTask<R, X> {
    type State = ();
    type Active = R;
    type Error = X;

    fn reset(&mut self) -> Result<((), R), X> {
        let active = self.task.reset()?;
        self.active = Some(active);
        Ok(((), active))
    }

    #[inline(always)]
    fn step(&mut self, (): &mut (), action: usize) -> Result<Transition<R>, X> {
        let Some(active) = &mut self.active else { unreachable!("a trainer resets a task before it steps it") };
        let (reward, next) = self.task.step(action, active);
        match next {
            Some(next) => Ok(Transition { reward, next: next.with_rows(*active) }),
            None => Err(self.task.take_error()),
        }
    }

    #[inline(always)]
    fn step_into(&mut self, (): &mut (), action: usize, active: &mut R) -> Result<(f64, NextKind), X> {
        let (reward, next) = self.task.step(action, active);
        next.map(|next| (reward, next)).ok_or_else(|| self.task.take_error())
    }

    #[inline(always)]
    fn step_work(&self) -> u64 {
        self.step_work
    }

    #[inline(always)]
    fn action_mask(&self) -> Option<&[bool]> {
        if self.has_masks { self.task.action_mask() } else { None }
    }

    fn visits(&self) -> Option<&[i64]> {
        self.task.visits()
    }

    fn active_rows(&self, (): &()) -> Result<R, X> {
        self.task.active_rows()
    }

    fn shape(&self) -> Option<(usize, usize)> {
        self.task.shape()
    }

    fn identify(&self, identity: &mut RunIdentity) {
        self.task.identify(identity);
    }

    fn resumes_episodes(&self) -> bool {
        self.task.resumes_episodes()
    }

    fn persist(&mut self, state: Option<&mut ()>, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.task.persist(state.is_some(), checkpoint)
    }
}

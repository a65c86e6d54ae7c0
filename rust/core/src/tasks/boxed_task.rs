//! Any world behind one type: what is not worth compiling whole goes through here.

use super::{Task, Transition};

/// A world that keeps its own place, so that its state's type does not show.
struct StatefulTask<W: Task> {
    task: W,
    state: Option<W::State>,
}

trait DynTask<R, X> {
    fn reset(&mut self) -> Result<R, X>;
    fn step(&mut self, action: usize) -> Result<Transition<R>, X>;
}

impl<W: Task, X: From<W::Error>> DynTask<W::Active, X> for StatefulTask<W> {
    fn reset(&mut self) -> Result<W::Active, X> {
        let (state, rows) = self.task.reset()?;
        self.state = Some(state);
        Ok(rows)
    }

    fn step(&mut self, action: usize) -> Result<Transition<W::Active>, X> {
        let Some(state) = &mut self.state else { unreachable!("a trainer resets before it steps") };
        Ok(self.task.step(state, action)?)
    }
}

/// A boxed world with rows `R` and errors `X`.
pub struct BoxedTask<R, X> {
    steps: Box<dyn DynTask<R, X> + Send>,
}

impl<R: Copy + AsRef<[u32]> + 'static, X: 'static> BoxedTask<R, X> {
    /// Boxes a world; its errors become `X`.
    pub fn new<W>(task: W) -> Self
    where
        W: Task<Active = R, State: Send> + Send + 'static,
        X: From<W::Error>,
    {
        Self { steps: Box::new(StatefulTask { task, state: None }) }
    }
}

impl<R: Copy + AsRef<[u32]>, X> Task for BoxedTask<R, X> {
    type State = ();
    type Active = R;
    type Error = X;

    fn reset(&mut self) -> Result<((), R), X> {
        Ok(((), self.steps.reset()?))
    }

    fn step(&mut self, (): &mut (), action: usize) -> Result<Transition<R>, X> {
        self.steps.step(action)
    }
}

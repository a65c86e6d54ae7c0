//! Any world behind one type: what is not worth compiling whole goes through here.

use crate::world::{Transition, World};

/// A world that keeps its own place, so that its state's type does not show.
struct Kept<W: World> {
    world: W,
    state: Option<W::State>,
}

trait Steps<R, X> {
    fn reset(&mut self) -> Result<R, X>;
    fn step(&mut self, action: usize) -> Result<Transition<R>, X>;
}

impl<W: World, X: From<W::Error>> Steps<W::Rows, X> for Kept<W> {
    fn reset(&mut self) -> Result<W::Rows, X> {
        let (state, rows) = self.world.reset()?;
        self.state = Some(state);
        Ok(rows)
    }

    fn step(&mut self, action: usize) -> Result<Transition<W::Rows>, X> {
        let Some(state) = &mut self.state else { unreachable!("a trainer resets before it steps") };
        Ok(self.world.step(state, action)?)
    }
}

/// A boxed world with rows `R` and errors `X`.
pub struct Boxed<R, X> {
    steps: Box<dyn Steps<R, X> + Send>,
}

impl<R: Copy + AsRef<[u32]> + 'static, X: 'static> Boxed<R, X> {
    /// Boxes a world; its errors become `X`.
    pub fn new<W>(world: W) -> Self
    where
        W: World<Rows = R, State: Send> + Send + 'static,
        X: From<W::Error>,
    {
        Self { steps: Box::new(Kept { world, state: None }) }
    }
}

impl<R: Copy + AsRef<[u32]>, X> World for Boxed<R, X> {
    type State = ();
    type Rows = R;
    type Error = X;

    fn reset(&mut self) -> Result<((), R), X> {
        Ok(((), self.steps.reset()?))
    }

    fn step(&mut self, (): &mut (), action: usize) -> Result<Transition<R>, X> {
        self.steps.step(action)
    }
}

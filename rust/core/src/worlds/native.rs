//! An environment of this crate, with its features, its time limit and its stream.

use crate::env::Env;
use crate::features::{Features, Outside};
use crate::random::Pcg64;
use crate::world::{Next, Transition, World};

/// Gymnasium's `TimeLimit` around an environment, its observations as rows.
#[derive(Clone, Debug)]
pub struct Native<E, F> {
    pub(crate) env: E,
    pub(crate) features: F,
    pub(crate) max_episode_steps: u64,
    draw: Pcg64,
}

impl<E, F> Native<E, F> {
    /// `draw` is the environment's own stream, seeded as `env.reset(seed=…)` seeds it. No limit means none.
    pub fn new(env: E, features: F, max_episode_steps: Option<u64>, draw: Pcg64) -> Self {
        Self { env, features, max_episode_steps: max_episode_steps.unwrap_or(u64::MAX), draw }
    }

    /// The environment's stream.
    pub fn draw(&self) -> &Pcg64 {
        &self.draw
    }
}

/// Where an episode stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Position<S> {
    /// The environment's state.
    pub state: S,
    /// The steps taken since its reset.
    pub elapsed: u64,
}

impl<E, F> World for Native<E, F>
where
    E: Env<Action = usize>,
    F: Features<E::Observation>,
{
    type State = Position<E::State>;
    type Rows = F::Rows;
    type Error = Outside;

    #[inline]
    fn reset(&mut self) -> Result<(Self::State, F::Rows), Outside> {
        let state = self.env.reset(&mut self.draw);
        Ok((Position { state, elapsed: 0 }, self.features.rows(&self.env.observe(&state))?))
    }

    #[expect(clippy::inline_always, reason = "a call a step costs a fifth of it")]
    #[inline(always)]
    fn step(&mut self, position: &mut Self::State, action: usize) -> Result<Transition<F::Rows>, Outside> {
        let step = self.env.step(position.state, action, &mut self.draw);
        *position = Position { state: step.state, elapsed: position.elapsed + 1 };
        // A terminal observation needs no row, but an observation outside the space is an error there too.
        let rows = self.features.rows(&self.env.observe(&step.state))?;
        let next = if step.terminated {
            Next::Terminal
        } else if position.elapsed >= self.max_episode_steps {
            Next::TimedOut(rows)
        } else {
            Next::Goes(rows)
        };
        Ok(Transition { reward: step.reward, next })
    }
}

//! Tasks that run without Python.

use super::{NextKind, RngSnapshot, Task, Transition};
use crate::checkpoint::{Checkpoint, CheckpointError, Persist, RunIdentity};
use crate::envs::{Env, Step};
use crate::features::{Features, OutOfBounds};
use crate::random::{Pcg64, Rng};

/// An environment of this crate with its features, its time limit (Gymnasium's `TimeLimit`) and its random generator.
#[derive(Clone, Debug)]
pub struct NativeTask<E, F> {
    pub(crate) env: E,
    pub(crate) features: F,
    pub(crate) max_episode_steps: u64,
    pub(crate) rng: Pcg64,
}

impl<E, F> NativeTask<E, F> {
    /// `rng` is the environment's generator, seeded as `env.reset(seed=…)` seeds it. `None` means no time limit.
    pub fn new(env: E, features: F, max_episode_steps: Option<u64>, rng: Pcg64) -> Self {
        Self { env, features, max_episode_steps: max_episode_steps.unwrap_or(u64::MAX), rng }
    }

    /// The environment.
    pub fn env(&self) -> &E {
        &self.env
    }

    /// The features.
    pub fn features(&self) -> &F {
        &self.features
    }

    /// The maximum number of steps of an episode; `None` if there is no limit.
    pub fn max_episode_steps(&self) -> Option<u64> {
        Some(self.max_episode_steps).filter(|&steps| steps < u64::MAX)
    }
}

/// The state of an environment and the number of steps taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedState<S> {
    /// The environment's state.
    pub state: S,
    /// The steps taken since the reset.
    pub elapsed: u64,
}

impl<E, F> Task for NativeTask<E, F>
where
    E: Env<Action = usize>,
    F: Features<E::Observation>,
{
    type State = TimedState<E::State>;
    type Active = F::Active;
    type Error = OutOfBounds;

    const USES_VECTORS: bool = F::USES_VECTORS;

    #[inline]
    fn reset(&mut self) -> Result<(Self::State, F::Active), OutOfBounds> {
        let state = self.env.reset(&mut self.rng);
        Ok((TimedState { state, elapsed: 0 }, self.features.active_rows(&self.env.observe(&state))?))
    }

    #[expect(clippy::inline_always, reason = "a call per step would take a fifth of its time")]
    #[inline(always)]
    fn step(&mut self, state: &mut Self::State, action: usize) -> Result<Transition<F::Active>, OutOfBounds> {
        let step = self.env.step(state.state, action, &mut self.rng);
        self.transition(state, step)
    }

    #[expect(clippy::inline_always, reason = "as for `step`")]
    #[inline(always)]
    fn step_into(
        &mut self,
        state: &mut Self::State,
        action: usize,
        active: &mut F::Active,
    ) -> Result<(f64, NextKind), OutOfBounds> {
        let step = self.env.step(state.state, action, &mut self.rng);
        *state = TimedState { state: step.state, elapsed: state.elapsed + 1 };
        self.features.write_active_rows(&self.env.observe(&step.state), active)?;
        Ok((step.reward, NextKind::after(step.terminated, state.elapsed, self.max_episode_steps)))
    }

    fn shape(&self) -> Option<(usize, usize)> {
        Some((self.features.len(), self.env.num_actions()))
    }

    fn identify(&self, identity: &mut RunIdentity) {
        identity.add_type::<Self>("task");
        identity.add("time limit", self.max_episode_steps);
        let seed = self.rng.seed_fingerprint().unwrap_or_default();
        identity.add("seed of the environment's generator, as a fingerprint", format_args!("{seed:016x}"));
    }

    fn active_rows(&self, state: &Self::State) -> Result<F::Active, OutOfBounds> {
        self.features.active_rows(&self.env.observe(&state.state))
    }

    fn persist(
        &mut self,
        state: Option<&mut Self::State>,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), CheckpointError> {
        self.rng.persist(checkpoint)?;
        let Some(TimedState { state, elapsed }) = state else { return Ok(()) };
        (state, &mut *elapsed).persist(checkpoint)?;
        checkpoint.check(*elapsed <= self.max_episode_steps, "number of steps taken")
    }
}

impl<E, F> NativeTask<E, F>
where
    E: Env<Action = usize>,
    F: Features<E::Observation>,
{
    /// The transition of one step of the environment. Updates the state.
    #[expect(clippy::inline_always, reason = "as for `step`")]
    #[inline(always)]
    fn transition(
        &self,
        state: &mut TimedState<E::State>,
        step: Step<E::State>,
    ) -> Result<Transition<F::Active>, OutOfBounds> {
        *state = TimedState { state: step.state, elapsed: state.elapsed + 1 };
        // A terminal observation needs no row, but an observation outside the observation space is still an error.
        let active = self.features.active_rows(&self.env.observe(&step.state))?;
        Ok(Transition {
            reward: step.reward,
            next: NextKind::after(step.terminated, state.elapsed, self.max_episode_steps).with_rows(active),
        })
    }
}

/// The snapshot is the number of 64-bit words drawn since seeding, and the buffered 32-bit half.
impl<E: Env<Action = usize>, F: Features<E::Observation>> RngSnapshot for NativeTask<E, F> {
    type Snapshot = (u64, Option<u32>);

    fn rng_snapshot(&self) -> Result<Self::Snapshot, Self::Error> {
        Ok((self.rng.words_drawn(), self.rng.buffered_u32()))
    }
}

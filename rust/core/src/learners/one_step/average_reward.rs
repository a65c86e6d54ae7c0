//! The average reward of a continuing task (Sutton & Barto, section 10.3).

use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::features::{ActiveRows, persist_rows};
use crate::learners::Agent;

/// The estimate R̄ of the average reward, updated by the differential errors.
///
/// A continuing task does not end. If an environment terminates, its next reset counts as a transition from the
/// terminal state to the first state of the next episode, which takes no time. The last update of an episode waits for
/// this transition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::learners) struct AverageReward<R> {
    value: f64,
    /// The step size β.
    step_size: f64,
    /// The last state, action and reward before a terminal state.
    waiting: Option<(R, usize, f64)>,
}

impl<R: ActiveRows> AverageReward<R> {
    pub(in crate::learners) fn new(step_size: f64) -> Self {
        Self { value: 0.0, step_size, waiting: None }
    }

    pub(in crate::learners) fn value(&self) -> f64 {
        self.value
    }

    /// δ = R - R̄ + `following` - Q(S, A), R̄ ← R̄ + β δ, Q(S, A) ← Q(S, A) + α δ.
    #[inline]
    pub(in crate::learners) fn learn(
        &mut self,
        agent: &mut Agent,
        (state, action, reward): (R, usize, f64),
        following: f64,
    ) {
        let target = (reward - self.value) + following;
        let error = target - agent.value(state, action);
        // These values are not discounted, so they can grow without bound.
        agent.table.check_finite(error);
        self.value += self.step_size * error;
        agent.update(state, action, target);
    }

    /// Stores the last step of an episode until the next episode begins.
    #[inline]
    pub(in crate::learners) fn wait(&mut self, step: (R, usize, f64)) {
        self.waiting = Some(step);
    }

    /// Takes out the step that waits for the first state of this episode.
    #[inline]
    pub(in crate::learners) fn take_waiting(&mut self) -> Option<(R, usize, f64)> {
        self.waiting.take()
    }

    pub(in crate::learners) fn persist(
        &mut self,
        (num_rows, num_actions): (usize, usize),
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), CheckpointError> {
        let mut waits = self.waiting.is_some();
        (&mut self.value, &mut waits).persist(checkpoint)?;
        self.waiting = if waits {
            let rows = persist_rows(self.waiting.map(|(rows, ..)| rows), num_rows, checkpoint)?;
            let (mut action, mut reward) = self.waiting.map_or((0, 0.0), |(_, action, reward)| (action, reward));
            checkpoint.index(&mut action, num_actions, "action")?;
            reward.persist(checkpoint)?;
            Some((rows, action, reward))
        } else {
            None
        };
        Ok(())
    }
}

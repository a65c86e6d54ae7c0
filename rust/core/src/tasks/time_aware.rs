//! The number of steps taken as a part of the state, as in Gymnasium's `TimeAwareObservation` (F. Pardo et al., "Time
//! limits in reinforcement learning", 2018).

use super::{Next, Task, TimedState, Transition};
use crate::checkpoint::{Checkpoint, CheckpointError, Persist, RunIdentity};
use crate::features::{ActiveFeatures, assert_binary};

/// A wrapper around a task with one active row, which is not weighted, with separate rows for each step before the time
/// limit: the table has `max_episode_steps` times as many rows, beginning with those of an episode's first step.
///
/// There are no rows for the state after the last step: the next state of a truncated episode is reported with the rows
/// of the last step, and a learner must treat it as terminal.
#[derive(Clone, Debug)]
pub struct TimeAware<T> {
    task: T,
    /// The number of rows of the task.
    rows: u32,
    /// The time limit.
    max_episode_steps: u64,
    /// Whether the last step reached the time limit, after which there is no state with an action mask.
    at_limit: bool,
}

impl<T> TimeAware<T> {
    /// `rows` is the number of rows of `task`, which ends episodes after `max_episode_steps` at the latest. `None` if
    /// the table would have 2³² rows or more.
    pub fn new(task: T, rows: usize, max_episode_steps: u64) -> Option<Self> {
        let all = (rows as u64).checked_mul(max_episode_steps)?;
        u32::try_from(all).ok()?;
        Some(Self { task, rows: u32::try_from(rows).ok()?, max_episode_steps, at_limit: false })
    }

    /// The number of rows of the table.
    pub fn n_rows(&self) -> usize {
        self.rows as usize * self.max_episode_steps as usize
    }

    /// The row in this table of a row of the task, after `elapsed` steps.
    ///
    /// # Panics
    /// For weighted features.
    fn at<R: ActiveFeatures>(&self, active: R, elapsed: u64) -> [u32; 1] {
        assert_binary::<R>();
        let step = elapsed.min(self.max_episode_steps - 1) as u32;
        [step * self.rows + active.as_ref()[0]]
    }
}

impl<T: Task> Task for TimeAware<T> {
    type State = TimedState<T::State>;
    type Active = [u32; 1];
    type Error = T::Error;

    fn reset(&mut self) -> Result<(Self::State, [u32; 1]), T::Error> {
        let (state, active) = self.task.reset()?;
        self.at_limit = false;
        Ok((TimedState { state, elapsed: 0 }, self.at(active, 0)))
    }

    fn step(&mut self, timed: &mut Self::State, action: usize) -> Result<Transition<[u32; 1]>, T::Error> {
        let Transition { reward, next } = self.task.step(&mut timed.state, action)?;
        timed.elapsed += 1;
        self.at_limit = timed.elapsed >= self.max_episode_steps;
        let next = match next {
            Next::NonTerminal(active) => Next::NonTerminal(self.at(active, timed.elapsed)),
            Next::Truncated(active) => Next::Truncated(self.at(active, timed.elapsed)),
            Next::Terminal => Next::Terminal,
        };
        Ok(Transition { reward, next })
    }

    #[inline]
    fn step_work(&self) -> u64 {
        self.task.step_work()
    }

    fn action_mask(&self) -> Option<&[bool]> {
        if self.at_limit { None } else { self.task.action_mask() }
    }

    fn active_rows(&self, timed: &Self::State) -> Result<[u32; 1], T::Error> {
        Ok(self.at(self.task.active_rows(&timed.state)?, timed.elapsed))
    }

    fn shape(&self) -> Option<(usize, usize)> {
        self.task.shape().map(|(_, num_actions)| (self.n_rows(), num_actions))
    }

    fn identify(&self, identity: &mut RunIdentity) {
        identity.add_type::<Self>("task");
        self.task.identify(identity);
    }

    fn resumes_episodes(&self) -> bool {
        self.task.resumes_episodes()
    }

    fn persist(
        &mut self,
        timed: Option<&mut Self::State>,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), CheckpointError> {
        let Some(timed) = timed else { return self.task.persist(None, checkpoint) };
        self.task.persist(Some(&mut timed.state), checkpoint)?;
        timed.elapsed.persist(checkpoint)?;
        // The limit is reached while the learner still learns from the last step.
        self.at_limit = timed.elapsed >= self.max_episode_steps;
        checkpoint.check(timed.elapsed <= self.max_episode_steps, "number of steps taken")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envs::classic_control::MountainCar;
    use crate::envs::tabular::{Outcome, TabularMdp};
    use crate::features::{FourierBasis, Identity, OutOfBounds};
    use crate::random::{Pcg64, SeedSequence};
    use crate::tasks::NativeTask;

    /// Two states, one action, which leads to the other state; a time limit of 3 steps.
    fn task() -> TimeAware<NativeTask<TabularMdp, Identity>> {
        let to = |state| vec![Outcome { probability: 1.0, state, reward: 1.0, terminated: false }];
        let table = TabularMdp::new(1, &[1.0, 0.0], &[to(1), to(0)]).expect("a valid table");
        let task = NativeTask::new(table, Identity(2), Some(3), Pcg64::new(&SeedSequence::new(&[0])));
        TimeAware::new(task, 2, 3).expect("a small table")
    }

    #[test]
    fn each_step_before_the_limit_has_rows_of_its_own() -> Result<(), OutOfBounds> {
        let mut task = task();
        assert_eq!(task.n_rows(), 6);
        for _ in 0..2 {
            let (mut state, first) = task.reset()?;
            assert_eq!(first, [0]);
            assert_eq!(task.step(&mut state, 0)?.next, Next::NonTerminal([3]));
            assert_eq!(task.step(&mut state, 0)?.next, Next::NonTerminal([4]));
            assert_eq!(task.active_rows(&state), Ok([4]));
            assert_eq!(task.step(&mut state, 0)?.next, Next::Truncated([5]));
        }
        Ok(())
    }

    #[test]
    fn the_number_of_steps_is_restored() -> Result<(), OutOfBounds> {
        let (mut stopped, mut resumed, mut bytes) = (task(), task(), Vec::new());
        let (mut state, _) = stopped.reset()?;
        stopped.step(&mut state, 0)?;
        stopped.persist(Some(&mut state), &mut Checkpoint::save(&mut bytes)).expect("memory suffices");
        let (mut restored, _) = task().reset()?;
        resumed.persist(Some(&mut restored), &mut Checkpoint::restore(&bytes)).expect("the bytes are complete");
        assert_eq!(restored, state);
        Ok(())
    }

    #[test]
    #[should_panic(expected = "needs binary features")]
    fn weighted_features_have_no_row_of_their_own_for_a_step() {
        let basis = FourierBasis::<f32, 4>::try_new(&[-1.2, -0.07], &[0.6, 0.07], 1, true, false).expect("4 features");
        let rng = Pcg64::new(&SeedSequence::new(&[0]));
        let task = NativeTask::new(MountainCar::default(), basis, Some(3), rng);
        let _ = TimeAware::new(task, 4, 3).expect("a small table").reset();
    }

    #[test]
    fn a_table_of_too_many_rows_is_refused() {
        assert!(TimeAware::new((), 1 << 20, 1 << 12).is_none());
        assert!(TimeAware::new((), 2, u64::MAX).is_none());
    }
}

//! Counts of the visits to each state-action pair.

use super::{Next, Task, Transition};
use crate::StopFlag;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist, RunIdentity};
use crate::features::assert_binary;
use crate::memory::{AllocationError, filled};

/// A wrapper around a task that counts how often each action was taken in each row of the table.
#[derive(Clone, Debug)]
pub struct VisitCounter<T> {
    task: T,
    num_actions: usize,
    /// One count for each weight of the table, row by row.
    visits: Vec<i64>,
}

impl<T: Task> VisitCounter<T> {
    /// Counts the steps of `task`, whose table has `rows` rows of `num_actions` values.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    ///
    /// # Panics
    /// For weighted features, all of whose rows are active in every state.
    pub fn new(task: T, rows: usize, num_actions: usize, stop: &StopFlag<'_>) -> Result<Self, AllocationError> {
        assert_binary::<T::Active>();
        Ok(Self { task, num_actions, visits: filled(&0, rows * num_actions, stop)? })
    }
}

/// The state of a task and its active rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CountedState<S, R> {
    state: S,
    active: R,
}

impl<T: Task> Task for VisitCounter<T> {
    type State = CountedState<T::State, T::Active>;
    type Active = T::Active;
    type Error = T::Error;

    #[inline]
    fn reset(&mut self) -> Result<(Self::State, T::Active), T::Error> {
        let (state, active) = self.task.reset()?;
        Ok((CountedState { state, active }, active))
    }

    /// A failed step is not counted, because nothing is learned from it.
    #[expect(clippy::inline_always, reason = "a call per step would take a fifth of its time")]
    #[inline(always)]
    fn step(&mut self, counted: &mut Self::State, action: usize) -> Result<Transition<T::Active>, T::Error> {
        let transition = self.task.step(&mut counted.state, action)?;
        for &row in counted.active.as_ref() {
            self.visits[row as usize * self.num_actions + action] += 1;
        }
        if let Next::NonTerminal(next_active) = transition.next {
            counted.active = next_active;
        }
        Ok(transition)
    }

    #[inline]
    fn step_work(&self) -> u64 {
        self.task.step_work()
    }

    #[inline]
    fn action_mask(&self) -> Option<&[bool]> {
        self.task.action_mask()
    }

    fn visits(&self) -> Option<&[i64]> {
        Some(&self.visits)
    }

    fn active_rows(&self, counted: &Self::State) -> Result<T::Active, T::Error> {
        self.task.active_rows(&counted.state)
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

    fn persist(
        &mut self,
        counted: Option<&mut Self::State>,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), CheckpointError> {
        self.visits.persist(checkpoint)?;
        let Some(counted) = counted else { return self.task.persist(None, checkpoint) };
        self.task.persist(Some(&mut counted.state), checkpoint)?;
        if checkpoint.is_restoring() {
            let rows = self.task.active_rows(&counted.state);
            counted.active = rows.map_err(|_| CheckpointError::Invalid("state of the environment"))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envs::classic_control::MountainCar;
    use crate::features::FourierBasis;
    use crate::random::{Pcg64, SeedSequence};
    use crate::tasks::NativeTask;

    /// Two tilings of three states; the episode ends in the third.
    struct Corridor;

    impl Task for Corridor {
        type State = u32;
        type Active = [u32; 2];
        type Error = ();

        fn reset(&mut self) -> Result<(u32, [u32; 2]), ()> {
            Ok((0, [0, 3]))
        }

        fn step(&mut self, state: &mut u32, action: usize) -> Result<Transition<[u32; 2]>, ()> {
            if action > 1 {
                return Err(());
            }
            *state += action as u32;
            let next = if *state == 2 { Next::Terminal } else { Next::NonTerminal([*state, *state + 3]) };
            Ok(Transition { reward: -1.0, next })
        }

        fn active_rows(&self, state: &u32) -> Result<[u32; 2], ()> {
            Ok([*state, *state + 3])
        }

        fn persist(&mut self, state: Option<&mut u32>, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
            state.map_or(Ok(()), |state| state.persist(checkpoint))
        }
    }

    #[test]
    fn every_step_counts_in_each_active_row() -> Result<(), ()> {
        let mut task = VisitCounter::new(Corridor, 6, 2, &StopFlag::new()).expect("a few counts");
        for _ in 0..2 {
            let (mut state, active) = task.reset()?;
            assert_eq!(active, [0, 3]);
            for action in [0, 1, 1] {
                task.step(&mut state, action)?;
            }
        }
        let one_tiling = [2, 2, 0, 2, 0, 0];
        assert_eq!(task.visits(), Some([one_tiling, one_tiling].as_flattened()));
        Ok(())
    }

    #[test]
    #[should_panic(expected = "needs binary features")]
    fn visits_to_weighted_features_are_not_counted() {
        let basis = FourierBasis::<f32, 4>::try_new(&[-1.2, -0.07], &[0.6, 0.07], 1, true, false).expect("4 features");
        let rng = Pcg64::new(&SeedSequence::new(&[0]));
        let task = NativeTask::new(MountainCar::default(), basis, Some(3), rng);
        let _ = VisitCounter::new(task, 4, 3, &StopFlag::new());
    }

    #[test]
    fn a_step_that_fails_is_not_counted() -> Result<(), ()> {
        let mut task = VisitCounter::new(Corridor, 6, 3, &StopFlag::new()).expect("a few counts");
        let (mut state, _) = task.reset()?;
        assert_eq!(task.step(&mut state, 2), Err(()));
        assert_eq!(task.visits(), Some([0; 18].as_slice()));
        Ok(())
    }
}

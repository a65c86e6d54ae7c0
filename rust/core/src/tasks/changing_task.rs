//! A task whose environment changes after a number of steps (Sutton & Barto, section 8.3).

use super::{NextKind, RngSnapshot, Task, TimedState, Transition};
use crate::checkpoint::{Checkpoint, CheckpointError, Persist, RunIdentity};
use crate::envs::Env;
use crate::envs::tabular::TabularMdp;
use crate::features::OutOfBounds;
use crate::random::{Pcg64, Rng};

/// Two transition tables with the same states: one for the first steps of a run, counted over all episodes, the other
/// for all later ones. Each state has its own row.
#[derive(Clone, Debug, PartialEq)]
pub struct ChangingTask {
    tables: [TabularMdp; 2],
    /// The number of steps with the first table.
    change_after: u64,
    max_episode_steps: u64,
    /// The number of steps taken since the start of the run.
    total_steps: u64,
    rng: Pcg64,
}

impl ChangingTask {
    /// `rng` is the environment's generator, seeded as `env.reset(seed=…)` seeds it.
    ///
    /// # Panics
    /// If the tables differ in their number of states.
    pub fn new(tables: [TabularMdp; 2], change_after: u64, max_episode_steps: u64, rng: Pcg64) -> Self {
        assert!(tables[0].num_states() == tables[1].num_states(), "both tables must have the same states");
        Self { tables, change_after, max_episode_steps, total_steps: 0, rng }
    }

    /// The index of the table of the next step.
    #[inline]
    fn current(&self) -> usize {
        usize::from(self.total_steps >= self.change_after)
    }
}

impl Task for ChangingTask {
    type State = TimedState<u32>;
    type Active = [u32; 1];
    type Error = OutOfBounds;

    fn reset(&mut self) -> Result<(Self::State, [u32; 1]), OutOfBounds> {
        let state = self.tables[self.current()].reset(&mut self.rng);
        Ok((TimedState { state, elapsed: 0 }, [state]))
    }

    fn step(&mut self, state: &mut Self::State, action: usize) -> Result<Transition<[u32; 1]>, OutOfBounds> {
        let step = self.tables[self.current()].step(state.state, action, &mut self.rng);
        self.total_steps += 1;
        *state = TimedState { state: step.state, elapsed: state.elapsed + 1 };
        let next = NextKind::after(step.terminated, state.elapsed, self.max_episode_steps);
        Ok(Transition { reward: step.reward, next: next.with_rows([step.state]) })
    }

    fn active_rows(&self, state: &Self::State) -> Result<[u32; 1], OutOfBounds> {
        Ok([state.state])
    }

    fn shape(&self) -> Option<(usize, usize)> {
        Some((self.tables[0].num_states(), self.tables[0].num_actions()))
    }

    fn identify(&self, identity: &mut RunIdentity) {
        identity.add_type::<Self>("task");
        identity.add("time limit", self.max_episode_steps);
        identity.add("steps before the change", self.change_after);
        let seed = self.rng.seed_fingerprint().unwrap_or_default();
        identity.add("seed of the environment's generator, as a fingerprint", format_args!("{seed:016x}"));
    }

    fn persist(
        &mut self,
        state: Option<&mut Self::State>,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), CheckpointError> {
        (&mut self.rng, &mut self.total_steps).persist(checkpoint)?;
        let Some(TimedState { state, elapsed }) = state else { return Ok(()) };
        checkpoint.index_u32(state, self.tables[0].num_states(), "state of the environment")?;
        elapsed.persist(checkpoint)?;
        checkpoint.check(*elapsed <= self.max_episode_steps, "number of steps taken")
    }
}

/// The snapshot is that of a [`NativeTask`](super::NativeTask).
impl RngSnapshot for ChangingTask {
    type Snapshot = (u64, Option<u32>);

    fn rng_snapshot(&self) -> Result<Self::Snapshot, OutOfBounds> {
        Ok((self.rng.words_drawn(), self.rng.buffered_u32()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envs::tabular::Outcome;
    use crate::random::SeedSequence;
    use crate::tasks::Next;

    /// Two states, one action: it stays in the state, or moves to the other state and ends the episode.
    fn table(moves: bool) -> TabularMdp {
        let to = |state: i64| {
            let state = if moves { 1 - state } else { state };
            vec![Outcome { probability: 1.0, state, reward: 0.0, terminated: moves }]
        };
        TabularMdp::new(1, &[1.0, 0.0], &[to(0), to(1)]).expect("a valid table")
    }

    fn task() -> ChangingTask {
        ChangingTask::new([table(false), table(true)], 3, 2, Pcg64::new(&SeedSequence::new(&[0])))
    }

    #[test]
    fn the_change_comes_after_so_many_steps_of_all_episodes() -> Result<(), OutOfBounds> {
        let mut task = task();
        let (mut state, _) = task.reset()?;
        assert_eq!(task.step(&mut state, 0)?.next, Next::NonTerminal([0]));
        assert_eq!(task.step(&mut state, 0)?.next, Next::Truncated([0]));
        (state, _) = task.reset()?;
        assert_eq!(task.step(&mut state, 0)?.next, Next::NonTerminal([0]));
        assert_eq!(task.step(&mut state, 0)?.next, Next::Terminal);
        Ok(())
    }

    #[test]
    fn the_number_of_steps_is_restored() -> Result<(), OutOfBounds> {
        let (mut stopped, mut resumed, mut bytes) = (task(), task(), Vec::new());
        let (mut state, _) = stopped.reset()?;
        stopped.step(&mut state, 0)?;
        stopped.persist(Some(&mut state), &mut Checkpoint::save(&mut bytes)).expect("memory suffices");
        let mut restored = TimedState { state: 1, elapsed: 0 };
        resumed.persist(Some(&mut restored), &mut Checkpoint::restore(&bytes)).expect("the bytes are complete");
        assert_eq!((resumed, restored), (stopped, state));
        Ok(())
    }
}

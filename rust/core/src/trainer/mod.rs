//! A training run, and the only training loop.

mod advance_loop;
mod borrowed_steps;
mod builder;
mod checkpoint;
mod episode_log;
mod evaluate;
mod load_error;
mod save;
#[cfg(test)]
mod tests;
mod train;

use self::advance_loop::AdvanceLoop;
pub use self::builder::{AnyTrainer, TrainerBuilder};
pub use self::episode_log::EpisodeLog;
pub use self::evaluate::{EvaluationError, evaluate};
pub use self::load_error::LoadError;
use crate::checkpoint::RunIdentity;
use crate::errors::TrainingError;
use crate::learners::Learner;
use crate::memory::{AllocationError, MemoryRoom, RunMemory};
use crate::random::Rng;
use crate::tasks::{Next, Task, Transition};

/// The largest size in bytes of active rows that are copied in registers.
const IN_REGISTERS: usize = 32;

/// The limits of a call of `advance`, which stops at the first limit that it reaches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// The number of finished episodes, counted from the start of the run.
    pub episodes: usize,
    /// The work, counted from the call. A step of a one-step learner on a grid counts as 1, and other steps count in
    /// proportion to their cost; see [`Learner::work`]. A call ends after the step that uses up its work.
    pub work: u64,
}

impl Budget {
    /// No limit but this number of finished episodes, counted from the start of the run. Learners that store every step
    /// reserve memory for all the work of a call: [`Trainer::train`] calls [`Trainer::advance`] with little work at a
    /// time, and so does a loop around `advance` with [`with_work`](Self::with_work).
    pub const fn episodes(episodes: usize) -> Self {
        Self { episodes, work: u64::MAX }
    }

    /// The same number of episodes, and at most this much work in one call.
    #[must_use]
    pub const fn with_work(self, work: u64) -> Self {
        Self { work, ..self }
    }
}

/// An unfinished episode.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EpisodeState<S, R> {
    pub(crate) state: S,
    /// The active rows of the state.
    pub(crate) active: R,
    /// The action to take next.
    pub(crate) action: usize,
    pub(crate) episode_return: f64,
    pub(crate) length: i64,
    /// The next state of the last step, if the learner has not finished learning from that step.
    pub(crate) unfinished: Option<Next<R>>,
}

/// A task, a learner and the agent's random generator.
#[derive(Clone, Debug)]
pub struct Trainer<T: Task, L, R> {
    pub(crate) task: T,
    pub(crate) learner: L,
    pub(crate) rng: R,
    pub(crate) episodes: EpisodeLog,
    pub(crate) episode: Option<EpisodeState<T::State, T::Active>>,
    /// Whether the last episode failed and was abandoned.
    pub(crate) abandoned: bool,
    /// The memory that the learner may still take while it trains.
    memory: RunMemory,
    /// The settings that the types and shapes of the run do not show.
    pub(crate) identity: RunIdentity,
}

impl<T: Task, L: Learner<T::Active>, R: Rng + Clone> Trainer<T, L, R> {
    /// A run that has not taken a step yet. [`try_new`](Self::try_new) also checks that the learner fits the task, and
    /// [`builder`](Trainer::builder) makes both.
    pub fn new(task: T, learner: L, rng: R) -> Self {
        let memory = RunMemory::new(MemoryRoom::unlimited());
        let (episodes, identity) = (EpisodeLog::default(), RunIdentity::default());
        Self { task, learner, rng, episodes, episode: None, abandoned: false, memory, identity }
    }

    /// Limits the memory that the learner takes from now on.
    pub fn limit_memory(&mut self, room: MemoryRoom) {
        self.memory = RunMemory::new(room);
    }

    /// The task.
    pub fn task(&self) -> &T {
        &self.task
    }

    /// The learner.
    pub fn learner(&self) -> &L {
        &self.learner
    }

    /// The finished episodes.
    pub fn episodes(&self) -> &EpisodeLog {
        &self.episodes
    }

    /// The index, from 0, of the unfinished episode, or of the last finished one if there is none.
    pub fn last_episode(&self) -> usize {
        let finished = self.episodes.returns.len();
        if self.episode.is_some() { finished } else { finished.saturating_sub(1) }
    }

    /// The unfinished episode, if there is one: its return and its number of steps so far, and the action to take next.
    pub fn unfinished_episode(&self) -> Option<(f64, i64, usize)> {
        self.episode.as_ref().map(|episode| (episode.episode_return, episode.length, episode.action))
    }

    /// Takes the finished episodes out. The run cannot be continued afterwards.
    pub fn take_episodes(&mut self) -> EpisodeLog {
        std::mem::take(&mut self.episodes)
    }

    /// Trains until the budget is used up. The next call resumes exactly where this one stopped.
    ///
    /// # Errors
    /// - The task's error. The episode is abandoned and not counted.
    /// - `Allocation` if the data of the run exceeds the memory or its limit.
    /// - `Diverged` if the action values have overflowed. Training stops after that episode, and every later call returns
    ///   the error again. Overflows are found in the values that the learner reads, and with one active row only by
    ///   learners with traces or a critic: there, a step size of at most 1 keeps the values within their targets.
    ///
    /// After the other errors, everything learned before is kept.
    pub fn advance(&mut self, budget: Budget) -> Result<(), TrainingError<T::Error>> {
        self.advance_or_stop(budget)?;
        self.check_divergence()
    }

    /// The error of a learner that has diverged.
    pub(crate) fn check_divergence(&self) -> Result<(), TrainingError<T::Error>> {
        if self.learner.diverged() { Err(TrainingError::Diverged { episode: self.last_episode() }) } else { Ok(()) }
    }

    /// [`advance`](Self::advance), which stops without an error if the learner has diverged.
    pub(crate) fn advance_or_stop(&mut self, budget: Budget) -> Result<(), TrainingError<T::Error>> {
        self.reserve(budget)?;
        // The generator and the episode are local variables: behind `self` each step would load and store them.
        let mut rng = self.rng.clone();
        let result = AdvanceLoop { trainer: self, rng: &mut rng, budget }.dispatch();
        self.rng = rng;
        self.abandoned = result.is_err();
        if self.abandoned {
            // The next episode must not learn from the steps of the failed one.
            self.learner.abandon_episode();
        }
        self.learner.complete_tables();
        result.map_err(TrainingError::Task)
    }

    /// Makes room for the data that the run can store within a budget.
    pub(crate) fn reserve(&mut self, budget: Budget) -> Result<(), AllocationError> {
        self.episodes.reserve(budget)?;
        self.learner.reserve(budget.work, &mut self.memory)
    }

    /// Whether the task writes the active rows of a step instead of returning them. A result with many rows would be
    /// copied through memory, in pieces that differ from copy to copy, and the processor would wait for each copy: with
    /// 8 to 32 tilings and a boxed task, a quarter of the run's time, although the number of instructions is the same
    /// within 2 %.
    const WRITES_ROWS: bool = size_of::<T::Active>() > IN_REGISTERS;

    #[inline(always)]
    fn advance_with(&mut self, rng: &mut R, budget: Budget) -> Result<(), T::Error> {
        let mut work = i64::try_from(budget.work).unwrap_or(i64::MAX);
        while work > 0
            && self.episodes.returns.len() < budget.episodes
            && (self.learner.is_unfinished() || !self.learner.diverged())
        {
            let episode = match self.episode.take() {
                Some(episode @ EpisodeState { unfinished: Some(next), .. }) => {
                    self.resume_step(episode, next, rng);
                    work -= self.learner.work().cast_signed();
                    continue;
                }
                Some(episode) => episode,
                None => self.begin_episode(rng)?,
            };
            let EpisodeState { mut state, mut active, mut action, mut episode_return, mut length, .. } = episode;
            loop {
                let transition = if Self::WRITES_ROWS {
                    let mut next_active = active;
                    let (reward, next) = self.task.step_into(&mut state, action, &mut next_active)?;
                    Transition { reward, next: next.with_rows(next_active) }
                } else {
                    self.task.step(&mut state, action)?
                };
                if let Some(mask) = self.task.action_mask()
                    && let Next::NonTerminal(next_state) | Next::Truncated(next_state) = transition.next
                {
                    self.learner.set_action_mask(next_state, mask);
                }
                episode_return += transition.reward;
                length += 1;
                action = self.learner.learn(active, action, transition.reward, transition.next, rng);
                work -= (self.learner.work() + self.task.step_work()).cast_signed();
                if self.learner.is_unfinished() {
                    let unfinished = Some(transition.next);
                    self.episode = Some(EpisodeState { state, active, action, episode_return, length, unfinished });
                    break;
                }
                match transition.next {
                    Next::NonTerminal(next_active) => active = next_active,
                    Next::Truncated(_) => {
                        self.finish_episode(episode_return, length, false);
                        break;
                    }
                    Next::Terminal => {
                        self.finish_episode(episode_return, length, true);
                        break;
                    }
                }
                if work <= 0 {
                    let unfinished = None;
                    self.episode = Some(EpisodeState { state, active, action, episode_return, length, unfinished });
                    break;
                }
            }
        }
        Ok(())
    }

    /// Continues learning from a step that the learner left unfinished.
    #[cold]
    fn resume_step(&mut self, mut episode: EpisodeState<T::State, T::Active>, next: Next<T::Active>, rng: &mut R) {
        episode.action = self.learner.resume(next, rng);
        if self.learner.is_unfinished() {
            self.episode = Some(episode);
            return;
        }
        match next {
            Next::NonTerminal(active) => self.episode = Some(EpisodeState { active, unfinished: None, ..episode }),
            Next::Truncated(_) => self.finish_episode(episode.episode_return, episode.length, false),
            Next::Terminal => self.finish_episode(episode.episode_return, episode.length, true),
        }
    }

    pub(crate) fn begin_episode(&mut self, rng: &mut impl Rng) -> Result<EpisodeState<T::State, T::Active>, T::Error> {
        let (state, active) = self.task.reset()?;
        if let Some(mask) = self.task.action_mask() {
            self.learner.set_action_mask(active, mask);
        }
        let action = self.learner.first_action(active, rng);
        Ok(EpisodeState { state, active, action, episode_return: 0.0, length: 0, unfinished: None })
    }

    pub(crate) fn finish_episode(&mut self, episode_return: f64, length: i64, terminated: bool) {
        self.learner.end_episode();
        self.episodes.push(episode_return, length, terminated);
    }
}

//! The training loop with weighted features.

use super::{Budget, EpisodeState, Trainer};
use crate::learners::Learner;
use crate::random::Rng;
use crate::tasks::{Next, NextKind, Task};

impl<T: Task, L: Learner<T::Active>, R: Rng + Clone> Trainer<T, L, R> {
    /// [`advance_with`](Self::advance_with), without copies of the features. It is a separate function because a choice
    /// between both kinds of steps in one loop costs steps on a grid 4 % more instructions.
    #[inline(always)]
    pub(super) fn advance_borrowed(&mut self, rng: &mut R, budget: Budget) -> Result<(), T::Error> {
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
            self.take_borrowed_steps(episode, rng, &mut work)?;
        }
        Ok(())
    }

    /// The steps of an episode with weighted features, until it ends or the work is done. The features of a state have
    /// hundreds of bytes: the learner borrows them, and those of two states take turns in the same memory.
    #[inline(always)]
    fn take_borrowed_steps(
        &mut self,
        episode: EpisodeState<T::State, T::Active>,
        rng: &mut R,
        work: &mut i64,
    ) -> Result<(), T::Error> {
        let EpisodeState { mut state, active, mut action, mut episode_return, mut length, .. } = episode;
        let mut features = [active; 2];
        let [active, next_active] = &mut features;
        let (mut active, mut next_active) = (active, next_active);
        loop {
            let (reward, kind) = self.task.step_into(&mut state, action, next_active)?;
            let next = kind.with_rows(&*next_active);
            if let Some(mask) = self.task.action_mask()
                && let Next::NonTerminal(next_state) | Next::Truncated(next_state) = next
            {
                self.learner.set_action_mask(*next_state, mask);
            }
            episode_return += reward;
            length += 1;
            action = self.learner.learn_borrowed(active, action, reward, next, rng);
            *work -= (self.learner.work() + self.task.step_work()).cast_signed();
            let unfinished = self.learner.is_unfinished().then(|| next.copied());
            if unfinished.is_none() {
                if kind != NextKind::NonTerminal {
                    self.finish_episode(episode_return, length, kind == NextKind::Terminal);
                    return Ok(());
                }
                std::mem::swap(&mut active, &mut next_active);
            }
            if unfinished.is_some() || *work <= 0 {
                self.episode =
                    Some(EpisodeState { state, active: *active, action, episode_return, length, unfinished });
                return Ok(());
            }
        }
    }
}
